//! Quantities that have no plot of their own, for plots of any of them over any other: components of vectors.

use std::collections::BTreeMap;

use crate::series::{Curve, Plot};
use crate::summary::{Reached, Summary};

/// Components of the displacements of probes, of reactions and of the forces on obstacles, zero at rest and at every reached step; what a
/// step lacks is left out.
pub fn more(summary: &Summary) -> Vec<Plot> {
    let displacements = components(summary, "displacement", "mm", |reached| &reached.probes, |u| Some(*u));
    let reactions = components(summary, "reaction", "N", |reached| &reached.reactions, |force| Some(*force));
    let forces = components(summary, "force on it", "N", |reached| &reached.obstacles, |obstacle| obstacle.force_n);
    displacements.into_iter().chain(reactions).chain(forces).collect()
}

fn components<T>(
    summary: &Summary,
    what: &str,
    unit: &'static str,
    of: impl Fn(&Reached) -> &BTreeMap<String, T>,
    vector: impl Fn(&T) -> Option<[f64; 3]>,
) -> Vec<Plot> {
    let Some((_, first)) = summary.reached().next() else { return Vec::new() };
    let plot = |name: &String| {
        let steps = summary.reached().map(|(_, reached)| vector(of(reached).get(name)?));
        let vectors: Vec<[f64; 3]> = std::iter::once(Some([0.0; 3])).chain(steps).collect::<Option<_>>()?;
        let curve = |(d, axis): (usize, &str)| Curve {
            name: format!("{what} {axis}"),
            values: vectors.iter().map(|vector| vector[d]).collect(),
        };
        let curves = ["x", "y", "z"].into_iter().enumerate().map(curve).collect();
        Some(Plot { name: name.clone(), unit, from_zero: true, over: None, curves })
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
        let found = more(&serde_json::from_value(summary).unwrap());
        let names: Vec<&str> = found.iter().map(|plot| &plot.name[..]).collect();
        assert_eq!(names, ["tip", "clamp"]);
        let last = &found[1].curves[2];
        assert_eq!((&last.name[..], &last.values[..]), ("reaction z", &[0.0, 5.0, 7.0][..]));
        assert_eq!(found[0].curves[2].values, [0.0, -0.5, -1.0]);
    }
}
