//! Rigid obstacles as the page draws them: what is endless ends a little beyond the body.

use pneuflex_model::{LoadParameter, Obstacle, Shape};
use serde::Serialize;

use crate::error::ReportError;
use crate::report::Report;
use crate::series::Series;

/// How far planes and cylinders go on beyond the body, relative to its size.
const MARGIN: f64 = 0.15;

/// An obstacle of the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drawn<'a> {
    /// Its name.
    pub name: &'a str,
    /// `plane`, `sphere`, `cylinder` or `cuboid`.
    pub shape: &'static str,
    /// Centre of what is drawn before it is moved, mm, relative to the point that the body's nodes are relative to.
    pub centre: [f64; 3],
    /// Its own axes, orthogonal and of length 1, one per row; the third one is a plane's normal or a cylinder's axis.
    pub axes: [[f64; 3]; 3],
    /// Lengths of what is drawn along these axes, mm.
    pub size: [f64; 3],
    /// Radius of a cuboid's edges, mm.
    pub edge_radius: f64,
    /// Whether the body is inside.
    pub hollow: bool,
    /// By axis, whether there is a mirror image of it beyond the plane of symmetry that is normal to the axis; it may be its own.
    pub mirrored: [bool; 3],
    /// Time and offset, mm, where its motion begins, bends and ends; empty if it stays in place.
    pub path: Vec<[f64; 4]>,
}

/// The obstacles of a report whose body is drawn relative to `origin`.
///
/// # Errors
/// An obstacle of numbers so large that it cannot be drawn.
pub fn drawn<'a>(report: &Report<'a>, series: &Series, origin: [f64; 3]) -> Result<Vec<Drawn<'a>>, ReportError> {
    report.problem.obstacles.iter().map(|obstacle| draw((report, series), obstacle, origin)).collect()
}

fn draw<'a>(
    (report, series): (&Report<'a>, &Series),
    obstacle: &'a Obstacle,
    origin: [f64; 3],
) -> Result<Drawn<'a>, ReportError> {
    let drawn = Drawn {
        name: &obstacle.name,
        shape: "",
        centre: obstacle.shape.reference_point(),
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        size: [0.0; 3],
        edge_radius: 0.0,
        hollow: false,
        mirrored: std::array::from_fn(|axis| {
            report.problem.symmetry.iter().any(|plane| plane.axis == axis && !plane.is_symmetry_of(obstacle))
        }),
        path: path(report, series, obstacle),
    };
    let mut drawn = match obstacle.shape {
        Shape::Plane { point, normal } => {
            let axes = frame(normal);
            let passed = Passed::of(report, obstacle, &axes);
            // Beside the body, in the plane.
            let place = [passed.middle(0), passed.middle(1), dot(point, axes[2])];
            let size = [passed.length(0), passed.length(1), 0.0];
            Drawn { shape: "plane", centre: combine(place, &axes), axes, size, ..drawn }
        }
        Shape::Sphere { radius, is_hollow, .. } => {
            Drawn { shape: "sphere", size: [2.0 * radius; 3], hollow: is_hollow, ..drawn }
        }
        Shape::Cylinder { point, axis, radius, is_hollow } => {
            let axes = frame(axis);
            let passed = Passed::of(report, obstacle, &axes);
            let place = [dot(point, axes[0]), dot(point, axes[1]), passed.middle(2)];
            let size = [2.0 * radius, 2.0 * radius, passed.length(2)];
            Drawn { shape: "cylinder", centre: combine(place, &axes), axes, size, hollow: is_hollow, ..drawn }
        }
        Shape::Cuboid { size, axes, edge_radius, .. } => Drawn { shape: "cuboid", axes, size, edge_radius, ..drawn },
    };
    drawn.centre = std::array::from_fn(|d| drawn.centre[d] - origin[d]);
    let numbers = [drawn.centre, drawn.size].into_iter().chain(drawn.axes).flatten();
    let is_finite = numbers.chain(drawn.path.iter().copied().flatten()).all(|x| (x as f32).is_finite());
    if is_finite { Ok(drawn) } else { Err(ReportError::NotFinite(format!("the obstacle `{}`", obstacle.name))) }
}

/// What an obstacle sees of the body: the least and the greatest coordinates of all its nodes at all computed times, seen from the
/// obstacle as it moves.
struct Passed {
    range: [[f64; 2]; 3],
}

impl Passed {
    fn of(report: &Report<'_>, obstacle: &Obstacle, axes: &[[f64; 3]; 3]) -> Self {
        let nodes = &report.problem.mesh.nodes;
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        let mut add = |x: [f64; 3], offset: [f64; 3]| {
            let x = std::array::from_fn(|d| x[d] - offset[d]);
            for (axis, [low, high]) in axes.iter().zip(&mut range) {
                *low = low.min(dot(x, *axis));
                *high = high.max(dot(x, *axis));
            }
        };
        let images = report.problem.images();
        let mut add_all = |x: [f64; 3], offset| images.iter().for_each(|image| add(image.point(x), offset));
        let at_rest = obstacle.offset(LoadParameter::default());
        nodes.iter().for_each(|&x| add_all(x, at_rest));
        for state in report.states.into_iter().flatten() {
            let offset = obstacle.offset(LoadParameter(state.time));
            for (x, u) in nodes.iter().zip(&state.displacement) {
                add_all(std::array::from_fn(|d| x[d] + u[d]), offset);
            }
        }
        Self { range }
    }

    fn middle(&self, axis: usize) -> f64 {
        let [low, high] = self.range[axis];
        0.5 * (low + high)
    }

    /// Length along an axis, with a margin at either end.
    fn length(&self, axis: usize) -> f64 {
        let length = |[low, high]: [f64; 2]| high - low;
        let diagonal = self.range.iter().map(|&range| length(range).powi(2)).sum::<f64>().sqrt();
        length(self.range[axis]) + 2.0 * MARGIN * diagonal
    }
}

/// The corners of an obstacle's path up to the last computed time; its places at the states where the path turned back.
fn path(report: &Report<'_>, series: &Series, obstacle: &Obstacle) -> Vec<[f64; 4]> {
    let Some(motion) = &obstacle.motion else { return Vec::new() };
    let place = |(&time, &parameter): (&f64, &f64)| {
        let [x, y, z] = obstacle.offset(LoadParameter(parameter));
        [time, x, y, z]
    };
    if let Some(parameters) = &series.parameters {
        return series.times.iter().zip(parameters).map(place).collect();
    }
    let end = report.summary.reached().last().map_or(0.0, |(time, _)| time);
    let corners = motion.curve.corners().map(|LoadParameter(at)| at).filter(|at| (0.0..end).contains(at) && *at > 0.0);
    let times = std::iter::once(0.0).chain(corners).chain((end > 0.0).then_some(end));
    let corner = |time: f64| {
        let [x, y, z] = obstacle.offset(LoadParameter(time));
        [time, x, y, z]
    };
    times.map(corner).collect()
}

/// A right-handed frame whose third axis has a given direction; the first one is as close to x as it can be.
fn frame(direction: [f64; 3]) -> [[f64; 3]; 3] {
    let n = unit(direction);
    // x itself is of no use for a direction along it.
    let start = if n[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let along = dot(start, n);
    let u = unit(std::array::from_fn(|d| start[d] - along * n[d]));
    let v = [n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]];
    [u, v, n]
}

/// Σ place\[i\] axes\[i\].
fn combine(place: [f64; 3], axes: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|d| (0..3).map(|i| place[i] * axes[i][d]).sum())
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::State;
    use crate::summary::Summary;
    use crate::testing::{displaced, summary_json, two_chambers};
    use pneuflex_model::load::Motion;
    use pneuflex_model::{Curve, Formulation};

    fn obstacle(shape: Shape, motion: Option<Motion>) -> Obstacle {
        Obstacle {
            name: "o".into(),
            shape,
            facets: Vec::new(),
            stiffness: 1.0,
            motion,
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        }
    }

    fn by(displacement: [f64; 3], curve: Curve) -> Option<Motion> {
        Some(Motion { displacement, curve })
    }

    /// What is drawn of obstacles around two chambers that go down by 5 mm until time 2.
    fn with_drawn(obstacles: Vec<Obstacle>, mirrored: bool, check: impl Fn(Result<Vec<Drawn<'_>>, ReportError>)) {
        let mut problem = two_chambers(Formulation::Hex8Sri);
        problem.obstacles = obstacles;
        if !mirrored {
            problem.symmetry.clear();
        }
        let summary: Summary = serde_json::from_value(summary_json(&[2.0])).unwrap();
        let nodes = vec![0.0; problem.mesh.num_nodes()];
        let state = State {
            time: 2.0,
            displacement: displaced(&problem, |_| [0.0, 0.0, -5.0]),
            von_mises: nodes.clone(),
            stress: vec![[0.0; 6]; problem.mesh.num_nodes()],
            contact_pressure: nodes,
        };
        let states = [state];
        let (title, about, inputs) = ("", "", &[]);
        let report = Report { title, about, inputs, problem: &problem, summary: &summary, states: Some(&states) };
        let series = crate::series::of(&report).unwrap();
        check(drawn(&report, &series, [10.0, 0.0, 0.0]));
    }

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    /// The actuator is 18 mm long, 20 mm wide and 13 mm high.
    #[test]
    fn what_is_endless_ends_a_little_beyond_the_body_wherever_it_goes() {
        let far = [1e3, -4e2, -7.0];
        let plane = obstacle(Shape::Plane { point: far, normal: [0.0, 0.0, 3.0] }, None);
        let tube = Shape::Cylinder { point: [2.0, 500.0, 6.0], axis: [0.0, -2.0, 0.0], radius: 40.0, is_hollow: true };
        let falling = by([0.0, 0.0, -5.0], Curve::Proportional(0.5));
        let wall = obstacle(Shape::Plane { point: [-1.0, 0.0, 0.0], normal: [1.0, 0.0, 0.0] }, falling);
        with_drawn(vec![plane, obstacle(tube, None), wall], true, |found| {
            let found = found.unwrap();
            let margin = 2.0 * MARGIN * (18_f64.powi(2) + 20_f64.powi(2) + 18_f64.powi(2)).sqrt();
            assert_eq!((found[0].shape, found[1].shape, found[1].hollow), ("plane", "cylinder", true));
            assert!(close(found[0].centre, [9.0 - 10.0, 0.0, -7.0]), "{:?}", found[0]);
            assert!(close(found[0].size, [18.0 + margin, 20.0 + margin, 0.0]), "{:?}", found[0]);
            assert!(close(found[1].centre, [2.0 - 10.0, 0.0, 6.0]) && close(found[1].axes[2], [0.0, -1.0, 0.0]));
            assert!(close(found[1].size, [80.0, 80.0, 20.0 + margin]), "{:?}", found[1]);
            // Seen from the wall, which falls with it, the body stays where it is.
            let still = 2.0 * MARGIN * (18_f64.powi(2) + 20_f64.powi(2) + 13_f64.powi(2)).sqrt();
            assert!(close(found[2].size, [20.0 + still, 13.0 + still, 0.0]), "{:?}", found[2]);
            assert!(close(found[2].centre, [-11.0, 0.0, 6.5]), "{:?}", found[2]);
            for axes in found.iter().map(|drawn| drawn.axes) {
                let [u, v, n] = axes;
                let volume = dot(u, [v[1] * n[2] - v[2] * n[1], v[2] * n[0] - v[0] * n[2], v[0] * n[1] - v[1] * n[0]]);
                assert!((volume - 1.0).abs() < 1e-12, "{axes:?}");
            }
        });
    }

    #[test]
    fn paths_have_the_corners_of_their_curves_up_to_the_last_computed_time() {
        let ball = Shape::Sphere { centre: [10.0, 0.0, -9.0], radius: 3.0, is_hollow: false };
        let table = Curve::Table(vec![[0.0, 0.0], [0.5, 0.0], [1.5, 1.0], [3.0, 4.0]]);
        let moving = obstacle(ball.clone(), by([0.0, 0.0, 2.0], table));
        with_drawn(vec![moving, obstacle(ball, None)], true, |found| {
            let found = found.unwrap();
            let at = |time: f64, z: f64| [time, 0.0, 0.0, z];
            assert_eq!(found[0].path, [at(0.0, 0.0), at(0.5, 0.0), at(1.5, 2.0), at(2.0, 4.0)]);
            assert!(found[1].path.is_empty() && close(found[1].centre, [0.0, 0.0, -9.0]));
            assert_eq!(found[1].size, [6.0; 3]);
        });
    }

    #[test]
    fn obstacles_beside_the_plane_of_symmetry_have_a_mirror_image() {
        let sphere = |y: f64| Shape::Sphere { centre: [10.0, y, -9.0], radius: 1.0, is_hollow: false };
        for (y, is_half, expected) in [(0.0, true, false), (2.0, true, true), (2.0, false, false)] {
            with_drawn(vec![obstacle(sphere(y), None)], is_half, |found| {
                assert_eq!(found.unwrap()[0].mirrored, [false, expected, false], "{y} {is_half}");
            });
        }
    }

    #[test]
    fn obstacles_beyond_all_numbers_are_refused() {
        let huge = Shape::Sphere { centre: [0.0, 0.0, -1e300], radius: 1e299, is_hollow: false };
        with_drawn(vec![obstacle(huge, None)], false, |found| {
            assert_eq!(found, Err(ReportError::NotFinite("the obstacle `o`".into())));
        });
    }
}
