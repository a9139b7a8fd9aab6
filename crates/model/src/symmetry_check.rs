//! Whether everything about a body that is cut at a plane of symmetry is its own mirror image.
//!
//! What is not may still have a mirror image on the other side, as a ball beside the plane has: then there are two of it, and the problem
//! is symmetric after all. A weight across the plane, or a ball through which the plane passes beside its centre, has none: a part of the
//! body cannot stand for the whole.

use crate::load::{Curve, Load, Motion};
use crate::obstacle::{Obstacle, Shape};
use crate::problem::Problem;
use crate::range_check::CaseError;
use crate::symmetry::SymmetryPlane;

/// What is this close to a plane, relative to the body's extent, lies in it: decks and meshes have six digits and more.
const CLOSE: f64 = 1e-6;

/// A component that is smaller than this share of its vector is rounding.
const ROUNDING: f64 = 1e-9;

/// A part of a problem, by its number in the problem's list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProblemPart {
    /// Of the supports.
    Support(usize),
    /// Of the loads.
    Load(usize),
    /// Of the obstacles.
    Obstacle(usize),
}

/// A part of a problem that is not its own mirror image.
#[derive(Clone, Debug, PartialEq)]
pub struct Asymmetry {
    /// What it is.
    pub part: ProblemPart,
    /// The plane.
    pub plane: SymmetryPlane,
    /// Whether there are two of it, one on either side; otherwise the part that is modelled cannot stand for the whole.
    pub is_twofold: bool,
    /// In words what it does, e.g. `it acts along y, across the plane of symmetry y = 0`.
    pub why: String,
}

/// What to do about a part of an actuator's half that breaks its plane of symmetry.
pub(crate) const WHOLE_ACTUATOR: &str = "set actuator.part = \"whole\"";

impl Asymmetry {
    /// The refusal of what is written under a key.
    pub(crate) fn refusal(&self, key: String, value: String, remedy: &str) -> CaseError {
        CaseError { key, value, allowed: format!("{}; {remedy}", self.why) }
    }
}

/// Where a box is with respect to a plane of symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxSide {
    /// It is its own mirror image as far as the body goes, or all of it on the modelled side up to the plane.
    Symmetric,
    /// On the modelled side, away from the plane: there are two of it.
    Twofold,
    /// On the side that is not modelled.
    Beyond,
    /// On both, and not alike.
    Uneven,
}

/// An interval of distances from a plane, positive on the modelled side, mm.
type Interval = [f64; 2];

impl Problem {
    /// What breaks planes of symmetry, and of what there are two.
    pub fn asymmetries(&self) -> Vec<Asymmetry> {
        self.symmetry.iter().flat_map(|plane| self.asymmetries_at(plane)).collect()
    }

    /// Where a box, given by two corners, is with respect to a plane at which the body is cut.
    pub fn box_side(&self, plane: &SymmetryPlane, [one, other]: [[f64; 3]; 2]) -> BoxSide {
        let (side, close) = (self.modelled_side(plane), self.close());
        let [a, b] = [one, other].map(|corner| side * (corner[plane.axis] - plane.at));
        let far = self.mesh.nodes.iter().map(|x| side * (x[plane.axis] - plane.at)).fold(0.0, f64::max);
        let [low, high] = [a.min(b).max(-far), a.max(b).min(far)];
        match () {
            () if high <= close => BoxSide::Beyond,
            () if low > close => BoxSide::Twofold,
            () if low.abs() <= close || (low + high).abs() <= 2.0 * close => BoxSide::Symmetric,
            () => BoxSide::Uneven,
        }
    }

    fn close(&self) -> f64 {
        CLOSE * self.mesh.extent()
    }

    /// 1 if the modelled part has the greater coordinates, −1 if it has the smaller ones.
    pub fn modelled_side(&self, plane: &SymmetryPlane) -> f64 {
        let farthest = self.mesh.nodes.iter().map(|x| x[plane.axis] - plane.at);
        farthest.max_by(|a, b| a.abs().total_cmp(&b.abs())).map_or(1.0, f64::signum)
    }

    fn asymmetries_at(&self, plane: &SymmetryPlane) -> Vec<Asymmetry> {
        let (axis, name, words) = (plane.axis, plane.axis_name(), plane.words());
        let mut found = Vec::new();
        let mut add = |part, is_twofold, why| found.push(Asymmetry { part, plane: *plane, is_twofold, why });
        let is_across = |vector: &[f64; 3]| {
            let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            vector[axis].abs() > ROUNDING * length
        };
        let close = self.close();
        let is_in_plane = |node: &u32| (self.mesh.nodes[*node as usize][axis] - plane.at).abs() <= close;
        for (number, support) in self.supports.iter().enumerate() {
            let Some(motion) = support.motion.as_ref().filter(|motion| motion.displacement[axis] != 0.0) else {
                continue;
            };
            if support.axes[axis] && !motion.curve.is_zero() {
                let touches = support.nodes.iter().any(is_in_plane);
                let why = if touches {
                    format!("it moves nodes of the plane of symmetry {words} along {name}, out of that plane")
                } else {
                    format!(
                        "it moves along {name}: its mirror image beyond the plane of symmetry {words} moves the other way"
                    )
                };
                add(ProblemPart::Support(number), !touches, why);
            }
        }
        for (number, load) in self.loads.iter().enumerate() {
            let touches = match load {
                _ if load.curve().is_zero() => continue,
                Load::Force { nodes, force, .. } if is_across(force) => nodes.iter().any(|(node, _)| is_in_plane(node)),
                Load::Traction { facets, traction, .. } if is_across(traction) => {
                    facets.iter().any(|&facet| self.mesh.facet_nodes(facet).iter().any(is_in_plane))
                }
                // All of the body has a weight.
                Load::Gravity { acceleration, .. } if is_across(acceleration) => true,
                _ => continue,
            };
            let why = if touches {
                format!("it acts along {name}, across the plane of symmetry {words}")
            } else {
                format!(
                    "it acts along {name}: its mirror image beyond the plane of symmetry {words} acts the other way"
                )
            };
            add(ProblemPart::Load(number), !touches, why);
        }
        for (number, obstacle) in self.obstacles.iter().enumerate() {
            if plane.is_symmetry_of(obstacle) {
                continue;
            }
            let [low, high] = reach(obstacle, plane, self.modelled_side(plane));
            let (is_twofold, why) = if low >= -close {
                (true, format!("there are two of it, one on either side of the plane of symmetry {words}"))
            } else if high <= close {
                (
                    false,
                    format!(
                        "it lies beyond the plane of symmetry {words}, where nothing is modelled that could meet it"
                    ),
                )
            } else {
                (false, format!("the plane of symmetry {words} cuts it, and it is not its own mirror image"))
            };
            add(ProblemPart::Obstacle(number), is_twofold, why);
        }
        found
    }
}

impl Load {
    /// Its factor, or value, along the load path.
    pub fn curve(&self) -> &Curve {
        match self {
            Self::Force { curve, .. }
            | Self::Traction { curve, .. }
            | Self::Pressure { curve, .. }
            | Self::Gravity { curve, .. } => curve,
        }
    }
}

impl Curve {
    /// Whether it is zero everywhere.
    pub fn is_zero(&self) -> bool {
        match self {
            Self::Proportional(slope) => *slope == 0.0,
            Self::Table(points) => points.iter().all(|point| point[1] == 0.0),
        }
    }
}

/// Where an obstacle is at any time, as distances from a plane, mm.
fn reach(obstacle: &Obstacle, plane: &SymmetryPlane, side: f64) -> Interval {
    let axis = plane.axis;
    let around = |point: [f64; 3], radius: f64| {
        let at = side * (point[axis] - plane.at);
        [at - radius, at + radius]
    };
    const ALL: Interval = [f64::NEG_INFINITY, f64::INFINITY];
    let [low, high] = match &obstacle.shape {
        Shape::Sphere { is_hollow: true, .. } | Shape::Cylinder { is_hollow: true, .. } => ALL,
        Shape::Sphere { centre, radius, .. } => around(*centre, *radius),
        Shape::Cylinder { point, axis: along, radius, .. } => {
            let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            if along[axis].abs() <= ROUNDING * length { around(*point, *radius) } else { ALL }
        }
        Shape::Cuboid { centre, size, axes, .. } => {
            around(*centre, axes.iter().zip(size).map(|(own, edge)| 0.5 * (own[axis] * edge).abs()).sum())
        }
        Shape::Plane { point, normal } => {
            let across = (0..3).filter(|&d| d != axis).map(|d| normal[d] * normal[d]).sum::<f64>().sqrt();
            let [at, _] = around(*point, 0.0);
            match side * normal[axis] {
                _ if across > ROUNDING * normal[axis].abs() => ALL,
                // The solid side is the one that the normal does not point to.
                normal if normal > 0.0 => [f64::NEG_INFINITY, at],
                _ => [at, f64::INFINITY],
            }
        }
    };
    let [back, forth] = obstacle.motion.as_ref().map_or([0.0; 2], |motion| travel(motion, axis, side));
    [low + back, high + forth]
}

/// The range of a motion along an axis, mm.
fn travel(motion: &Motion, axis: usize, side: f64) -> Interval {
    let whole = side * motion.displacement[axis];
    let factors: Vec<f64> = match &motion.curve {
        _ if whole == 0.0 => Vec::new(),
        // Nobody knows here where the load path ends.
        Curve::Proportional(slope) => vec![0.0, slope * f64::INFINITY],
        Curve::Table(points) => points.iter().map(|point| point[1]).collect(),
    };
    let range = factors.into_iter().map(|factor| factor * whole).filter(|x| !x.is_nan());
    let range = range.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    if range[0] > range[1] { [0.0; 2] } else { range }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Contact, Formulation, Material, Support};
    use pneuflex_mesh::{Actuator, MeshSize};

    fn half() -> Problem {
        let (size, material) = (MeshSize::uniform(4.0), Material::default());
        Problem::from_actuator(&Actuator::two_chambers(), &size, Formulation::Hex8Sri, material, Contact::default())
            .unwrap()
    }

    /// Whether something stands for two, is refused, or is right as it is.
    fn verdict(problem: &Problem) -> Option<bool> {
        let found = problem.asymmetries();
        assert!(found.len() < 2, "{found:?}");
        found.first().map(|asymmetry| asymmetry.is_twofold)
    }

    const ONE: Curve = Curve::Proportional(1.0);

    #[test]
    fn loads_across_a_plane_break_it_unless_they_have_a_mirror_image() {
        let half = half();
        let (end, side) = (half.mesh.node_set("end_face").to_vec(), half.mesh.select_nodes(|x| x[1] > 9.9));
        let faces = half.mesh.select_facets(|x| x[1] > 9.9);
        let with = |load: Load| verdict(&Problem { loads: vec![load], ..half.clone() });
        let force = |nodes: &[u32], force| Load::Force {
            nodes: nodes.iter().map(|&node| (node, 1.0)).collect(),
            force,
            curve: ONE,
        };
        assert_eq!(with(force(&end, [0.0, 1.0, 0.0])), Some(false));
        assert_eq!(with(force(&end, [1.0, 1e-12, 1.0])), None);
        assert_eq!(with(force(&side, [0.0, 1.0, 0.0])), Some(true));
        let gravity = |acceleration| Load::Gravity { elements: None, acceleration, curve: ONE };
        assert_eq!(with(gravity([0.0, -9810.0, 0.0])), Some(false));
        assert_eq!(with(gravity([0.0, 0.0, -9810.0])), None);
        let traction = |facets: &[_]| Load::Traction { facets: facets.to_vec(), traction: [0.0, 1.0, 0.0], curve: ONE };
        assert_eq!(with(traction(&faces)), Some(true));
        assert_eq!(with(traction(half.mesh.facet_set("end_face"))), Some(false));
        assert_eq!(with(Load::Pressure { facets: faces, curve: ONE }), None);
        let moved = |nodes: &[u32], axes, displacement| {
            let motion = Some(Motion { displacement, curve: ONE });
            let support = Support { name: "moved".into(), nodes: nodes.to_vec(), axes, motion };
            verdict(&Problem { supports: half.supports.iter().cloned().chain([support]).collect(), ..half.clone() })
        };
        assert_eq!(moved(&end, [true; 3], [0.0, 2.0, 0.0]), Some(false));
        assert_eq!(moved(&end, [true, false, true], [0.0, 2.0, 0.0]), None);
        assert_eq!(moved(&side, [true; 3], [0.0, 2.0, 0.0]), Some(true));
        assert_eq!(moved(&end, [true; 3], [1.0, 0.0, 0.0]), None);
        let whole = Problem { symmetry: Vec::new(), loads: vec![gravity([0.0, 1.0, 0.0])], ..half.clone() };
        assert_eq!(verdict(&whole), None);
    }

    #[test]
    fn obstacles_are_their_own_image_or_two_or_refused() {
        let half = half();
        let with = |shape: Shape, moved: [f64; 3]| {
            let curve = Curve::Table(vec![[0.0, 0.0], [1.0, 1.0]]);
            let motion = Some(Motion { displacement: moved, curve });
            let (name, facets) = ("o".into(), Vec::new());
            let obstacle = Obstacle {
                name,
                shape,
                facets,
                stiffness: 1.0,
                motion,
                report_force: true,
                penetration_tolerance: None,
                interference_until: None,
            };
            verdict(&Problem { obstacles: vec![obstacle], ..half.clone() })
        };
        let ball = |y| Shape::Sphere { centre: [9.0, y, -6.0], radius: 5.0, is_hollow: false };
        let (rest, across) = ([0.0; 3], [0.0, 4.0, 0.0]);
        for (y, moved, expected) in [
            (0.0, rest, None),
            (-6.0, rest, Some(false)),
            (6.0, rest, Some(true)),
            (2.0, rest, Some(false)),
            (0.0, across, Some(false)),
            (-9.5, across, Some(false)),
            (5.5, across, Some(true)),
            (-8.0, across, Some(false)),
        ] {
            assert_eq!(with(ball(y), moved), expected, "ball at {y}");
        }
        let wall = |y, normal| Shape::Plane { point: [0.0, y, -1.0], normal };
        assert_eq!(with(wall(12.0, [0.0, -1.0, 0.0]), rest), Some(true));
        assert_eq!(with(wall(-12.0, [0.0, 1.0, 0.0]), rest), Some(false));
        assert_eq!(with(wall(3.0, [0.0, 0.0, 1.0]), rest), None);
        assert_eq!(with(wall(3.0, [0.0, 0.1, 1.0]), rest), Some(false));
        let rod = |axis, is_hollow| Shape::Cylinder { point: [9.0, 6.0, -6.0], axis, radius: 5.0, is_hollow };
        assert_eq!(with(rod([1.0, 0.0, 0.0], false), rest), Some(true));
        assert_eq!(with(rod([0.0, 1.0, 0.0], false), rest), None);
        assert_eq!(with(rod([0.0, 1.0, 1.0], false), rest), Some(false));
        assert_eq!(with(rod([1.0, 0.0, 0.0], true), rest), Some(false));
    }

    #[test]
    fn boxes_are_alike_on_both_sides_or_not() {
        let half = half();
        let plane = half.symmetry[0];
        let side = |a: f64, b: f64| half.box_side(&plane, [[0.0, a, 0.0], [18.0, b, 1.0]]);
        for (a, b) in [(-10.0, 10.0), (10.0, -99.0), (-3.0, 3.0), (0.0, 10.0), (0.0, 2.0)] {
            assert_eq!(side(a, b), BoxSide::Symmetric, "{a} {b}");
        }
        assert_eq!(
            (side(2.0, 5.0), side(-9.0, 0.0), side(-3.0, 10.0)),
            (BoxSide::Twofold, BoxSide::Beyond, BoxSide::Uneven)
        );
    }
}
