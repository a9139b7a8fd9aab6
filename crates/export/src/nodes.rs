//! Fields at the nodes of the mesh as a table.

use std::fmt::Write;

use pneuflex_model::{Clock, Problem};
use pneuflex_report::state::State;

/// Names of the columns after the first one, which is the pressure or the time.
const COLUMNS: &str = "node,x_mm,y_mm,z_mm,ux_mm,uy_mm,uz_mm,von_mises_mpa,contact_pressure_mpa";

/// What the states of a problem stand at.
pub fn parameter(problem: &Problem) -> &'static str {
    match problem.clock {
        Clock::Pressure => "pressure_kpa",
        Clock::Steps => "time",
    }
}

/// The text of a CSV file with a row for every node of every state: its number from 1, its place at rest, its displacement, the fields.
pub fn csv(problem: &Problem, states: &[&State]) -> String {
    let mut text = format!("{},{COLUMNS}\n", parameter(problem));
    for state in states {
        for (node, [x, y, z]) in problem.mesh.nodes.iter().enumerate() {
            let [ux, uy, uz] = state.displacement[node];
            let (stress, contact) = (state.von_mises[node], state.contact_pressure[node]);
            let _ = writeln!(text, "{},{},{x},{y},{z},{ux},{uy},{uz},{stress},{contact}", state.time, node + 1);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{states, two_chambers};
    use pneuflex_model::Formulation;

    #[test]
    fn every_node_of_every_state_has_a_row_with_all_digits() {
        let problem = two_chambers(Formulation::Hex8Sri);
        let states = states(&problem, &[0.1, 0.7]);
        let text = csv(&problem, &states.iter().collect::<Vec<_>>());
        let nodes = problem.mesh.num_nodes();
        assert!(text.starts_with("pressure_kpa,node,x_mm,") && text.lines().count() == 1 + 2 * nodes);
        let last: Vec<f64> = text.lines().last().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
        let (node, state) = (nodes - 1, &states[1]);
        let expected = [
            &[state.time, nodes as f64],
            &problem.mesh.nodes[node][..],
            &state.displacement[node],
            &[state.von_mises[node], 0.0],
        ];
        assert_eq!(last, expected.concat());
    }
}
