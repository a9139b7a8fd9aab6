//! What can be refused only when the body is there, whatever kind of file it came from, and before anything is solved or written.

use pneuflex_mesh::LENGTHS;
use pneuflex_model::{CaseError, Probe, Problem};
use pneuflex_post::contact;

/// Share of the nodes' spacing by which an obstacle that just touches may overlap the body: by rounding, and where a curved face bulges
/// between its nodes. The first step presses the body out of it.
const MOST_OVERLAP: f64 = 1e-3;

/// What is this close to a plane, relative to the body's extent, lies in it.
const CLOSE: f64 = 1e-6;

/// A body that is too small or too large to be one, obstacles and surfaces that overlap it at rest, and probes that are not on it.
pub fn refusals(problem: &Problem, probes: &[Probe]) -> Vec<CaseError> {
    if let Some(error) = size(problem) {
        return vec![error];
    }
    let mut found = far_probes(problem, probes);
    if found.is_empty() {
        found = mirrored_probes(problem, probes);
    }
    overlap(problem).or_else(|| overlapping_surfaces(problem)).into_iter().chain(found).collect()
}

/// A body whose coordinates are no lengths of a body.
fn size(problem: &Problem) -> Option<CaseError> {
    let [shortest, longest] = LENGTHS;
    // A damaged number is the largest of all: `f64::max` would pass over it.
    let larger = |most: f64, x: &f64| if most.is_nan() || x.abs() <= most { most } else { x.abs() };
    let largest = problem.mesh.nodes.as_flattened().iter().fold(0.0, larger);
    (!(shortest..=longest).contains(&largest)).then(|| CaseError {
        key: "model.file".into(),
        value: format!("a body with coordinates up to {largest:e}"),
        allowed: format!("must be from {shortest:e} to {longest:e} mm; model.scale is for meshes in other units"),
    })
}

/// The first obstacle that overlaps the body at rest, if there is one: no load path could begin there.
fn overlap(problem: &Problem) -> Option<CaseError> {
    if problem.obstacles.is_empty() {
        return None;
    }
    let at_rest = contact::evaluate(problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).ok()?;
    let most = MOST_OVERLAP * problem.mesh.mean_node_spacing();
    let deep = |(number, found): &(usize, &contact::ObstacleForce)| {
        problem.obstacles[*number].interference_until.is_none() && found.max_penetration_mm > most
    };
    let (number, found) = at_rest.obstacles.iter().enumerate().find(deep)?;
    let allowed = format!(
        "it overlaps the body at rest by {:.4} mm; put it beside the body, and let it move there (displacement in a model \
         file), or say interference = true if it is to be pressed out of it",
        found.max_penetration_mm
    );
    Some(CaseError { key: format!("obstacle[{number}].name"), value: format!("{:?}", found.name), allowed })
}

/// The first pair of surfaces that overlap at rest, if there is one.
fn overlapping_surfaces(problem: &Problem) -> Option<CaseError> {
    if problem.contact_pairs.is_empty() {
        return None;
    }
    let most = MOST_OVERLAP * problem.mesh.mean_node_spacing();
    let overlapping = contact::overlapping_pairs(problem);
    let (number, depth) = overlapping.into_iter().find(|(_, depth)| *depth > most)?;
    let allowed = format!(
        "its surfaces overlap at rest by {depth:.4} mm; put them beside each other; where they are meant to be pressed out of each \
         other, say interference = true in a [[contact]] of a model file (instead of a *CONTACT PAIR of its deck)"
    );
    let name = &problem.contact_pairs[number].name;
    Some(CaseError { key: "contact".into(), value: format!("{name:?}"), allowed })
}

/// Probes beyond a plane of symmetry would read the nearest node in it.
fn mirrored_probes(problem: &Problem, probes: &[Probe]) -> Vec<CaseError> {
    let mut found = Vec::new();
    for (number, probe) in probes.iter().enumerate() {
        for plane in &problem.symmetry {
            let beyond = problem.modelled_side(plane) * (plane.at - probe.at[plane.axis]);
            if beyond > CLOSE * problem.mesh.extent() {
                let [x, y, z] = plane.mirror_point(probe.at);
                let allowed = format!(
                    "it lies beyond the plane of symmetry {}: its mirror image ({x}, {y}, {z}) moves in the same way, with the other sign \
                     along {}; put the probe there, or model the whole body",
                    plane.words(),
                    plane.axis_name()
                );
                found.push(CaseError { key: format!("probe[{number}].at"), value: format!("{:?}", probe.at), allowed });
            }
        }
    }
    found
}

/// A probe reads the nearest node. One that is further away than the body is long was meant for another body, or is in another unit.
fn far_probes(problem: &Problem, probes: &[Probe]) -> Vec<CaseError> {
    let mesh = &problem.mesh;
    let extent = mesh.extent();
    let far = |(number, probe): (usize, &Probe)| {
        let (node, distance) = mesh.nearest_node(probe.at)?;
        let is_far = distance > extent || distance.is_nan();
        let [x, y, z] = mesh.nodes[node];
        is_far.then(|| CaseError {
            key: format!("probe[{number}].at"),
            value: format!("{:?}", probe.at),
            allowed: format!(
                "must be a point of the body, mm: the nearest node is at ({x:.4}, {y:.4}, {z:.4}), {distance:.3e} mm away, and the body \
                 is {extent:.4} mm long"
            ),
        })
    };
    probes.iter().enumerate().filter_map(far).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding, and curved faces that bulge between their nodes, are no reason not to start.
    #[test]
    fn an_obstacle_may_overlap_by_a_share_of_an_element_and_the_path_begins() {
        let at_with = |height: f64, key: &str| {
            let plane = format!(
                "\n[[obstacle]]\nname = \"table\"\nshape = \"plane\"\nfaces = \"bottom\"\nnormal = [0, 0, 1]\npoint = [0, 0, {height}]\n{key}\n"
            );
            let mut study = crate::Study::from_text("case.toml", &(crate::template::two_chambers() + &plane)).unwrap();
            let quick = [("mesh.size", "3"), ("mesh.element", "hex8-q1p0"), ("load.pressure_kpa", "[5]")];
            study.set_all(quick.map(|(key, value)| crate::Change::new(key, value))).unwrap();
            study.build()
        };
        let at = |height: f64| at_with(height, "");
        let tip = |height: f64| at(height).unwrap().solve().unwrap().states[0].probes["tip"][2];
        let (beside, touching, overlapping) = (tip(-1e-9), tip(0.0), tip(1e-4));
        assert!(
            (touching - beside).abs() < 1e-6 && (overlapping - touching).abs() < 2e-3,
            "{beside} {touching} {overlapping}"
        );
        let refused = at(0.1).unwrap_err().to_string();
        assert!(
            refused.contains("overlaps the body at rest by 0.1000 mm") && refused.contains("say interference = true"),
            "{refused}"
        );
        let meant = at_with(0.1, "interference = true").unwrap().solve().unwrap();
        assert!(meant.states[0].obstacles["table"].force_n[2] < 0.0);
    }

    /// Surfaces that overlap are told apart from those that touch, and may be meant to.
    #[test]
    fn surfaces_that_overlap_are_refused_unless_they_are_meant_to() {
        let gap = |gap: f64, said: &str| {
            let case = toml::from_str::<pneuflex_model::Case>(&crate::template::two_chambers()).unwrap();
            let mut problem = Problem::from_case(&case).unwrap();
            let mesh = std::sync::Arc::unwrap_or_clone(problem.mesh.clone());
            let middle = case.actuator.gap.at(0);
            let walls = mesh.facet_set("gap_1_left").to_vec();
            let wall: std::collections::BTreeSet<u32> =
                walls.iter().flat_map(|&facet| mesh.facet_nodes(facet)).collect();
            // The wall beside the gap is moved into the other one.
            let nodes = mesh.nodes.iter().enumerate().map(|(node, x)| {
                let moves = wall.contains(&(node as u32));
                [x[0] + if moves { middle - gap } else { 0.0 }, x[1], x[2]]
            });
            let nodes = nodes.collect();
            problem.mesh = pneuflex_mesh::Mesh { nodes, ..mesh }.into();
            problem.contact_pairs[0].interference_until = said.parse().ok().map(pneuflex_model::LoadParameter);
            refusals(&problem, &[])
        };
        assert!(gap(1e-3, "").is_empty() && gap(-0.05, "1").is_empty());
        let refused = gap(-0.05, "");
        assert!(
            refused[0].allowed.contains("overlap at rest by 0.05")
                && refused[0].allowed.contains("interference = true")
        );
    }

    #[test]
    fn a_body_beyond_all_lengths_is_refused() {
        let case = toml::from_str(&crate::template::two_chambers()).unwrap();
        let problem = Problem::from_case(&case).unwrap();
        let scaled = |factor: f64| {
            let mesh = std::sync::Arc::unwrap_or_clone(problem.mesh.clone()).map_nodes(|x| x.map(|t| factor * t));
            refusals(&Problem { mesh: mesh.into(), ..problem.clone() }, &[]).len()
        };
        assert_eq!([1.0, 1e-3, 1e3].map(scaled), [0; 3]);
        assert_eq!([0.0, 1e-9, 1e9, 1e99, f64::INFINITY, f64::NAN].map(scaled), [1; 6]);
        // A single damaged number, whose volume would be said to be NaN mm3.
        for damaged in [f64::NAN, f64::NEG_INFINITY] {
            let mut mesh = std::sync::Arc::unwrap_or_clone(problem.mesh.clone());
            mesh.nodes[7][1] = damaged;
            assert_eq!(refusals(&Problem { mesh: mesh.into(), ..problem.clone() }, &[]).len(), 1);
        }
    }

    #[test]
    fn a_probe_beyond_the_body_is_refused_wherever_it_is() {
        let case = toml::from_str(&crate::template::two_chambers()).unwrap();
        let problem = Problem::from_case(&case).unwrap();
        let refused = |at| refusals(&problem, &[Probe { name: "p".into(), at }]).len();
        assert_eq!([[18.0, 0.0, 0.0], [18.0, 0.0, -9.0], [30.0, 0.0, 0.0]].map(refused), [0, 0, 0]);
        assert_eq!([[1e300, 0.0, 0.0], [18.0, 1e9, 0.0], [0.0, 0.0, -50.0], [f64::NAN; 3]].map(refused), [1; 4]);
        assert_eq!([[18.0, -1.0, 0.0], [18.0, -1e-7, 0.0], [18.0, 10.0, 0.0]].map(refused), [1, 0, 0]);
    }
}
