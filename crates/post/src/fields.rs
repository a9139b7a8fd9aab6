//! The pictures of a state: the body with its stresses, and the walls with their contact.

use pneuflex_model::Problem;

use crate::contact::ContactState;
use crate::error::{PostError, check};
use crate::stress::{StressField, von_mises};
use crate::vtu::{Field, Grid};

/// The body in its reference position with `displacement` (mm), `cauchy_stress` and `von_mises` (MPa) at the nodes and
/// the hydrostatic `pressure` (MPa, compression positive) of the elements. `time` is the air pressure in kPa.
///
/// The von Mises stress is the one of the averaged tensor, so that it belongs to the stress shown.
///
/// # Errors
/// Displacements of the wrong length or with a number that is not finite.
pub fn body(problem: &Problem, displacement: &[f64], stress: &StressField, time: f64) -> Result<Grid, PostError> {
    check("displacement", displacement, problem.num_dofs())?;
    let mesh = &problem.mesh;
    let nodal = stress.at_nodes(problem);
    let mut grid = Grid { points: mesh.nodes.clone(), time, ..Grid::default() };
    for element in 0..mesh.num_elements() {
        grid.push_cell(mesh.kind.vtk_cell_type(), mesh.element(element).iter().copied());
    }
    grid.point_data = vec![
        Field::vector("displacement", displacement.to_vec()),
        Field::scalar("von_mises", nodal.iter().map(|s| von_mises(*s)).collect()),
        Field::symmetric_tensor("cauchy_stress", nodal.as_flattened().to_vec()),
    ];
    grid.cell_data = vec![Field::scalar("pressure", stress.element_pressures())];
    Ok(grid)
}

/// The facing walls of all gaps in their reference position with `displacement` (mm), `contact_traction` (the traction
/// the opposite wall exerts, MPa) and `contact_gap` (signed distance from the opposite wall, mm; negative where they
/// pass through each other) at the nodes, and the number of the `gap` (from 1) and `side` (0 slave, 1 master) of the
/// faces. `None` if the body has no gaps.
///
/// # Errors
/// Displacements of the wrong length or with a number that is not finite.
pub fn contact_walls(
    problem: &Problem,
    displacement: &[f64],
    contact: &ContactState,
    time: f64,
) -> Result<Option<Grid>, PostError> {
    check("displacement", displacement, problem.num_dofs())?;
    let mesh = &problem.mesh;
    let mut grid = Grid { time, ..Grid::default() };
    let (mut gap, mut side) = (Vec::new(), Vec::new());
    let mut number = vec![u32::MAX; mesh.num_nodes()];
    let mut nodes = Vec::new();
    for (i, pair) in problem.contact_pairs.iter().enumerate() {
        let master = if pair.is_self() { &[] } else { &pair.master[..] };
        for (which, &facet) in pair.slave.iter().map(|f| (0.0, f)).chain(master.iter().map(|f| (1.0, f))) {
            let local: Vec<u32> = mesh
                .facet_nodes(facet)
                .into_iter()
                .map(|node| {
                    let n = &mut number[node as usize];
                    if *n == u32::MAX {
                        *n = nodes.len() as u32;
                        nodes.push(node as usize);
                    }
                    *n
                })
                .collect();
            grid.push_cell(mesh.face_kind().vtk_cell_type(), local);
            gap.push((i + 1) as f64);
            side.push(which);
        }
    }
    if nodes.is_empty() {
        return Ok(None);
    }
    let traction = contact.nodal_traction(problem);
    let gaps: Vec<f64> = nodes.iter().map(|&n| contact.nodal_gap[n].unwrap_or(0.0)).collect();
    grid.points = nodes.iter().map(|&n| mesh.nodes[n]).collect();
    grid.point_data = vec![
        Field::vector("displacement", nodes.iter().flat_map(|&n| displacement[3 * n..3 * n + 3].to_vec()).collect()),
        Field::vector("contact_traction", nodes.iter().flat_map(|&n| traction[n]).collect()),
        Field::scalar("contact_gap", gaps),
    ];
    grid.cell_data = vec![Field::scalar("gap", gap), Field::scalar("side", side)];
    Ok(Some(grid))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};
    use crate::{contact, stress};

    #[test]
    fn grids_hold_the_whole_body_and_both_walls() {
        let problem = two_chambers(2.0);
        let u = displacement_of(&problem, |x| [if x[0] <= 8.0 { 2.1 } else { 0.0 } * x[2] / 13.0, 0.0, 0.0]);
        let stress = stress::recover(&problem, &u).unwrap();
        let grid = body(&problem, &u, &stress, 5.0).unwrap();
        assert_eq!((grid.points.len(), grid.cell_types.len()), (problem.mesh.num_nodes(), problem.mesh.num_elements()));
        grid.to_vtu().unwrap();
        let contact = contact::evaluate(&problem, &u).unwrap();
        let walls = contact_walls(&problem, &u, &contact, 5.0).unwrap().unwrap();
        let pair = &problem.contact_pairs[0];
        assert_eq!(walls.cell_types.len(), pair.slave.len() + pair.master.len());
        walls.to_vtu().unwrap();
    }
}
