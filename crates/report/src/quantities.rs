//! Quantities that have no plot of their own, for plots of any of them over any other: components of vectors.

use std::collections::BTreeMap;

use crate::curves::{Curve, Plot, Rows};
use crate::summary::Found;

/// Components of the displacements of probes, of reactions and of the forces on obstacles; what a state lacks is left out.
pub fn more(rows: &Rows<'_>) -> Vec<Plot> {
    let displacements = components(rows, "displacement", "mm", |found| &found.probes, |u| Some(*u));
    let reactions = components(rows, "reaction", "N", |found| &found.reactions, |force| Some(*force));
    let forces = components(rows, "force on it", "N", |found| &found.obstacles, |obstacle| obstacle.force_n);
    displacements.into_iter().chain(reactions).chain(forces).collect()
}

fn components<T>(
    rows: &Rows<'_>,
    what: &str,
    unit: &'static str,
    of: impl Fn(&Found) -> &BTreeMap<String, T>,
    vector: impl Fn(&T) -> Option<[f64; 3]>,
) -> Vec<Plot> {
    let Some(first) = rows.first_state() else { return Vec::new() };
    let plot = |name: &String| {
        let vectors = rows.vectors(Some([0.0; 3]), |found| of(found).get(name).and_then(&vector))?;
        let curve = |(d, axis): (usize, &str)| Curve {
            name: format!("{what} {axis}"),
            values: vectors.iter().map(|vector| vector.map(|vector| vector[d])).collect(),
        };
        let curves = ["x", "y", "z"].into_iter().enumerate().map(curve).collect();
        Some(Plot { curves, ..Plot::single(name, unit, Vec::new()) })
    };
    of(first).keys().filter_map(plot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::summary_json;
    use serde_json::json;

    #[test]
    fn vectors_have_their_components_and_what_a_step_lacks_is_left_out() {
        let mut summary = summary_json(&[1.0, 2.0]);
        summary["steps"][0]["obstacles"] = json!({"ball": {"force_n": [1.0, 2.0, 3.0]}});
        summary["steps"][0]["reactions"] = json!({"clamp": [0.0, 0.0, 5.0]});
        summary["steps"][1]["reactions"] = json!({"clamp": [0.0, 0.0, 7.0]});
        let problem = crate::testing::two_chambers(pneuflex_model::Formulation::Hex8Sri);
        let summary = serde_json::from_value(summary).unwrap();
        let report =
            crate::Report { title: "", about: "", inputs: &[], problem: &problem, summary: &summary, states: None };
        let found = more(&Rows::of(&report, &[0.0, 1.0, 2.0]));
        let names: Vec<&str> = found.iter().map(|plot| &plot.name[..]).collect();
        assert_eq!(names, ["tip", "clamp"]);
        let last = &found[1].curves[2];
        assert_eq!((&last.name[..], &last.values[..]), ("reaction z", &[0.0, 5.0, 7.0].map(Some)[..]));
        assert_eq!(found[0].curves[2].values, [0.0, -0.5, -1.0].map(Some));
    }
}
