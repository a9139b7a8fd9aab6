//! What supports hold inside of an obstacle. Nothing there gives way, so that no body can keep out of the obstacle: a penalty lets it in, with a
//! force that grows with its stiffness, and the elements beside the support are sheared the more, the smaller they are.

use pneuflex_model::{LoadParameter, Problem};
use pneuflex_post::contact::{HeldInside, deepest_held};

/// Depths up to this share of the nodes' spacing are not worth a word.
const SHALLOW: f64 = 0.1;

/// At depths beyond this share of the nodes' spacing the elements beside the support follow no more.
const DEEP: f64 = 0.5;

/// Places that are looked at between two corners of the motions.
const PARTS: usize = 16;

/// Where on the load path it begins and where it is deepest, for motions with the given corners up to an `end`; `None` if nothing held comes
/// into an obstacle.
pub fn way_in(
    problem: &Problem,
    mut corners: Vec<LoadParameter>,
    end: LoadParameter,
) -> Option<(LoadParameter, LoadParameter)> {
    if problem.obstacles.is_empty() {
        return None;
    }
    corners.push(LoadParameter::default());
    corners.retain(|at| *at <= end);
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    let between = |ends: &[LoadParameter]| {
        let [from, to] = [ends[0].0, ends[1].0];
        (1..=PARTS).map(move |part| LoadParameter(from + (to - from) * part as f64 / PARTS as f64)).collect::<Vec<_>>()
    };
    let places: Vec<LoadParameter> = corners[..1].iter().copied().chain(corners.windows(2).flat_map(between)).collect();
    let is_in = |at: LoadParameter| depth(problem, at) > SHALLOW * problem.mesh.mean_node_spacing();
    let first = places.iter().position(|&at| is_in(at))?;
    let mut bounds = [places[first.saturating_sub(1)].0, places[first].0];
    while bounds[1] - bounds[0] > 1e-6 * end.0 {
        let middle = 0.5 * (bounds[0] + bounds[1]);
        bounds[usize::from(is_in(LoadParameter(middle)))] = middle;
    }
    let deepest = places.iter().copied().max_by(|&a, &b| depth(problem, a).total_cmp(&depth(problem, b)))?;
    Some((LoadParameter(bounds[1]), deepest))
}

/// How deep it is at a position on the load path, mm; 0 if nothing is.
pub fn depth(problem: &Problem, at: LoadParameter) -> f64 {
    inside(problem, at).map_or(0.0, |found| found.depth)
}

/// Whether it is so deep that the mesh does not follow.
pub fn is_deep(problem: &Problem, at: LoadParameter) -> bool {
    depth(problem, at) > DEEP * problem.mesh.mean_node_spacing()
}

/// What is to be said of it at a position on the load path.
pub fn words(problem: &Problem, at: LoadParameter) -> Option<String> {
    let HeldInside { obstacle, node, depth } = inside(problem, at)?;
    let [x, y, z] = problem.mesh.nodes[node as usize];
    Some(format!(
        "the obstacle {} comes into what supports hold, at {} {depth:.3} mm deep near ({x:.2}, {y:.2}, {z:.2}) mm; nothing gives way there, so \
         that its force and the stress beside the support follow from the contact's stiffness and the size of the elements",
        problem.obstacles[obstacle].name,
        problem.clock.words(at)
    ))
}

/// Overlaps that are meant are no such thing until they are to be gone.
fn inside(problem: &Problem, at: LoadParameter) -> Option<HeldInside> {
    let is_meant = |until: LoadParameter| at < until;
    deepest_held(problem, at)
        .filter(|found| !problem.obstacles[found.obstacle].interference_until.is_some_and(is_meant))
}

#[cfg(test)]
pub mod tests {
    use pneuflex_mesh::lattice::Lattice;
    use pneuflex_model::{Clock, Curve, Formulation, Law, Motion, Obstacle, Shape, Support};

    use super::*;

    const END: LoadParameter = LoadParameter(2.0);

    /// A bar along x that is clamped at x = 0, and a plane 0.25 mm below it that moves in the second half of the time.
    pub fn bar(normal: [f64; 3], displacement: [f64; 3]) -> Problem {
        let mesh =
            Lattice::uniform([0.0; 3], [8.0, 2.0, 2.0], [8, 2, 2]).mesh_all(Formulation::Hex8Q1p0.element_kind());
        let facets = mesh.select_facets(|x| x[2] < 1e-9);
        let nodes = mesh.select_nodes(|x| x[0] < 1e-9);
        let mut problem = Problem::body(mesh, Formulation::Hex8Q1p0, Law::NeoHooke { c10: 0.1 }.into());
        problem.clock = Clock::Steps;
        problem.supports = vec![Support { name: "clamp".into(), nodes, axes: [true; 3], motion: None }];
        let curve = Curve::Table(vec![[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]]);
        problem.obstacles = vec![Obstacle {
            name: "table".into(),
            shape: Shape::Plane { point: [0.0, 0.0, -0.25], normal },
            facets,
            stiffness: 1.0,
            motion: Some(Motion { displacement, curve }),
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        }];
        problem
    }

    fn way(problem: &Problem) -> Option<(LoadParameter, LoadParameter)> {
        way_in(problem, vec![LoadParameter(1.0), END, LoadParameter(3.0)], END)
    }

    #[test]
    fn an_obstacle_that_rises_into_the_clamp_is_found_where_it_does() {
        let problem = bar([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        let (since, deepest) = way(&problem).unwrap();
        let shallow = SHALLOW * problem.mesh.mean_node_spacing();
        assert!((since.0 - (1.25 + shallow)).abs() < 1e-5, "{since:?}");
        assert_eq!(deepest, END);
        assert!((depth(&problem, END) - 0.75).abs() < 1e-9);
        assert_eq!(depth(&problem, LoadParameter(1.0)), 0.0);
        let words = words(&problem, END).unwrap();
        assert!(words.contains("obstacle table") && words.contains("at time 2 0.750 mm deep near (0.00"), "{words}");
    }

    /// What meets the body at its free end only, comes less far, or meets what it is to press out of the body first.
    #[test]
    fn what_keeps_clear_of_the_clamp_is_not() {
        assert_eq!(way(&bar([-0.2, 0.0, 1.0], [0.0, 0.0, 0.2])), None);
        assert_eq!(way(&bar([0.0, 0.0, 1.0], [0.0, 0.0, 0.25])), None);
        let mut pressed_out = bar([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        pressed_out.obstacles[0].interference_until = Some(LoadParameter(2.5));
        assert_eq!(way(&pressed_out), None);
    }

    /// A roller gives way along its plane, and not against it.
    #[test]
    fn only_what_is_held_against_the_obstacle_counts() {
        let mut problem = bar([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        problem.supports[0].axes = [true, true, false];
        assert_eq!(way(&problem), None);
        problem.supports[0].axes = [false, false, true];
        assert!(way(&problem).is_some());
        // Where a ball is seen from a roller nobody knows beforehand.
        problem.obstacles[0].shape = Shape::Sphere { centre: [0.0, 1.0, -3.25], radius: 3.0, is_hollow: false };
        assert_eq!(way(&problem), None);
        problem.supports[0].axes = [true; 3];
        assert!(way(&problem).is_some());
        // Supports that go with the obstacle.
        let motion = problem.obstacles[0].motion.clone();
        problem.supports[0].motion = motion;
        assert_eq!(way(&problem), None);
    }
}
