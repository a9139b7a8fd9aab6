//! Planes of symmetry: what is modelled is a half, a quarter or an eighth of the body.
//!
//! Who knows of a plane: the half of an actuator (`part = "half"`), and a model file's support with `symmetry = true`. A support alone is
//! none: nodes that are held along one axis may as well stand on a table.

use crate::obstacle::{Obstacle, Shape};
use crate::problem::Problem;

/// What is this close to a plane, relative to the body's extent, lies in it: decks and meshes have six digits and more.
const CLOSE: f64 = 1e-6;

/// An obstacle counts as its own mirror image that is this close to it, in mm or relative to 1.
const SYMMETRY: f64 = 1e-9;

/// A plane normal to an axis at which the body is cut: the other part is the mirror image of the modelled one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetryPlane {
    /// Axis that the plane is normal to: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Its coordinate along that axis, mm.
    pub at: f64,
    /// Index of the support that holds the nodes in it.
    pub support: usize,
}

/// Why the nodes of a support are no plane of symmetry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSymmetry {
    /// It is moved, or held along another number of axes than one.
    #[error("nodes in a plane of symmetry are held along one axis, normal to it, and are not moved")]
    Axes,
    /// They do not lie in one plane normal to the axis.
    #[error("the nodes must lie in one plane {axis} = const; theirs are from {low} to {high} mm")]
    NotFlat {
        /// The axis.
        axis: char,
        /// Least coordinate along it, mm.
        low: f64,
        /// Greatest coordinate along it, mm.
        high: f64,
    },
    /// There is something of the body on either side.
    #[error("the body must lie on one side of the plane {0}: it is on both")]
    BothSides(String),
    /// Not all nodes in the plane are held.
    #[error("all nodes of the body in the plane {plane} must be in the set: {missing} are not")]
    NotAll {
        /// The plane.
        plane: String,
        /// Nodes in it that are not held.
        missing: usize,
    },
    /// There is one normal to that axis already.
    #[error("there is a plane of symmetry {0} already, and one for every axis at the most")]
    Second(String),
}

impl SymmetryPlane {
    /// The plane in words, e.g. `y = 0`.
    pub fn words(&self) -> String {
        format!("{} = {}", self.axis_name(), crate::number::rounded(self.at))
    }

    /// Name of the axis that it is normal to.
    pub fn axis_name(&self) -> char {
        ['x', 'y', 'z'][self.axis.min(2)]
    }

    /// The mirror image of a point.
    pub fn mirror_point(&self, mut point: [f64; 3]) -> [f64; 3] {
        point[self.axis] = 2.0 * self.at - point[self.axis];
        point
    }

    /// The mirror image of a displacement or a force.
    pub fn mirror_vector(&self, mut vector: [f64; 3]) -> [f64; 3] {
        vector[self.axis] = -vector[self.axis];
        vector
    }

    /// The mirror image of a moment, which turns the other way.
    pub fn mirror_moment(&self, moment: [f64; 3]) -> [f64; 3] {
        self.mirror_vector(moment).map(|m| -m)
    }

    /// Whether an obstacle is its own mirror image, wherever it moves; otherwise there are two of it.
    pub fn is_symmetry_of(&self, obstacle: &Obstacle) -> bool {
        let is_zero = |x: f64| x.abs() <= SYMMETRY;
        let is_within = |point: [f64; 3]| is_zero((point[self.axis] - self.at) / (1.0 + self.at.abs()));
        let stays = obstacle.motion.as_ref().is_none_or(|motion| is_zero(motion.displacement[self.axis]));
        let is_normal = |direction: [f64; 3]| (0..3).filter(|&d| d != self.axis).all(|d| is_zero(direction[d]));
        stays
            && match obstacle.shape {
                Shape::Plane { normal, .. } => is_zero(unit(normal)[self.axis]),
                Shape::Sphere { centre, .. } => is_within(centre),
                Shape::Cylinder { point, axis, .. } => {
                    let axis = unit(axis);
                    is_normal(axis) || is_zero(axis[self.axis]) && is_within(point)
                }
                Shape::Cuboid { centre, axes, .. } => is_within(centre) && axes.into_iter().any(is_normal),
            }
    }
}

impl Problem {
    /// Makes the plane in which the nodes of a support are held one of symmetry.
    ///
    /// # Errors
    /// [`NoSymmetry`] if the nodes lie in no such plane, the body is not cut by it, or there is one for that axis already.
    pub fn declare_symmetry(&mut self, support: usize) -> Result<SymmetryPlane, NoSymmetry> {
        let held = self.supports.get(support).ok_or(NoSymmetry::Axes)?;
        let axes: Vec<usize> = (0..3).filter(|&axis| held.axes[axis]).collect();
        let (&[axis], None) = (&axes[..], &held.motion) else { return Err(NoSymmetry::Axes) };
        let along = |node: usize| self.mesh.nodes[node][axis];
        let (low, high) = range(held.nodes.iter().map(|&node| along(node as usize)));
        let close = CLOSE * self.mesh.extent();
        let plane = SymmetryPlane { axis, at: snapped(0.5 * (low + high), close), support };
        if high - low > 2.0 * close {
            return Err(NoSymmetry::NotFlat { axis: plane.axis_name(), low, high });
        }
        if let Some(other) = self.symmetry.iter().find(|other| other.axis == axis) {
            return Err(NoSymmetry::Second(other.words()));
        }
        // Nodes of no element are no part of the body.
        let mut is_body = vec![false; self.mesh.num_nodes()];
        self.mesh.connectivity.iter().for_each(|&node| is_body[node as usize] = true);
        let body = || (0..self.mesh.num_nodes()).filter(|&node| is_body[node]);
        let (least, greatest) = range(body().map(along));
        if least < plane.at - close && greatest > plane.at + close {
            return Err(NoSymmetry::BothSides(plane.words()));
        }
        let mut is_held = vec![false; self.mesh.num_nodes()];
        held.nodes.iter().for_each(|&node| is_held[node as usize] = true);
        let missing = body().filter(|&node| (along(node) - plane.at).abs() <= close && !is_held[node]).count();
        if missing > 0 {
            return Err(NoSymmetry::NotAll { plane: plane.words(), missing });
        }
        self.symmetry.push(plane);
        Ok(plane)
    }

    /// How many modelled parts make the whole body: 1, 2, 4 or 8.
    pub fn parts_of_whole(&self) -> usize {
        1 << self.symmetry.len()
    }

    /// What is modelled: `whole`, `half`, `quarter` or `eighth`.
    pub fn modelled_part(&self) -> &'static str {
        ["whole", "half", "quarter", "eighth"][self.symmetry.len().min(3)]
    }

    /// A force on the whole body from that on the modelled part: across a plane of symmetry the parts' forces cancel.
    pub fn whole_force(&self, force: [f64; 3]) -> [f64; 3] {
        self.symmetry.iter().fold(force, |force, plane| {
            let mut sum = force.map(|f| 2.0 * f);
            sum[plane.axis] = 0.0;
            sum
        })
    }
}

/// Zero for a coordinate that is zero but for rounding.
fn snapped(at: f64, close: f64) -> f64 {
    if at.abs() <= close { 0.0 } else { at }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Contact, Curve, Formulation, Material, Motion, Support};
    use pneuflex_mesh::actuator::Part;
    use pneuflex_mesh::{Actuator, MeshSize};

    fn chambers(part: Part) -> Problem {
        let actuator = Actuator { part, ..Actuator::two_chambers() };
        let (size, material) = (MeshSize::uniform(4.0), Material::default());
        Problem::from_actuator(&actuator, &size, Formulation::Hex8Sri, material, Contact::default()).unwrap()
    }

    fn support(problem: &Problem, axes: [bool; 3], holds: impl Fn([f64; 3]) -> bool) -> Support {
        Support { name: "s".into(), nodes: problem.mesh.select_nodes(holds), axes, motion: None }
    }

    #[test]
    fn a_half_knows_its_plane_and_what_the_whole_carries() {
        let half = chambers(Part::Half);
        assert_eq!(half.symmetry, [SymmetryPlane { axis: 1, at: 0.0, support: 1 }]);
        assert_eq!((half.parts_of_whole(), half.modelled_part(), &*half.symmetry[0].words()), (2, "half", "y = 0"));
        assert_eq!(half.whole_force([1.0, 2.0, 3.0]), [2.0, 0.0, 6.0]);
        let plane = SymmetryPlane { axis: 1, at: 5.0, support: 0 };
        assert_eq!(plane.mirror_point([1.0, 2.0, 3.0]), [1.0, 8.0, 3.0]);
        assert_eq!(plane.mirror_vector([1.0, 2.0, 3.0]), [1.0, -2.0, 3.0]);
        assert_eq!(plane.mirror_moment([1.0, 2.0, 3.0]), [-1.0, 2.0, -3.0]);
        let whole = chambers(Part::Whole);
        assert_eq!((whole.parts_of_whole(), whole.modelled_part()), (1, "whole"));
        assert_eq!(whole.whole_force([1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn a_plane_is_one_only_where_the_whole_body_ends_in_it() {
        let mut problem = chambers(Part::Whole);
        let y = [false, true, false];
        let wrong = [
            (support(&problem, [true, true, false], |x| x[1] < -9.9), NoSymmetry::Axes),
            (support(&problem, y, |x| x[1] < 0.0), NoSymmetry::NotFlat { axis: 'y', low: -10.0, high: 0.0 }),
            (support(&problem, y, |x| x[1] == 0.0), NoSymmetry::BothSides("y = 0".into())),
            (
                support(&problem, y, |x| x[1] == -10.0 && x[2] < 1.0),
                NoSymmetry::NotAll { plane: "y = -10".into(), missing: 0 },
            ),
        ];
        for (support, expected) in wrong {
            problem.supports.push(support);
            let error = problem.declare_symmetry(problem.supports.len() - 1).unwrap_err();
            assert_eq!(std::mem::discriminant(&error), std::mem::discriminant(&expected), "{error}");
        }
        let moved = Motion { displacement: [0.0; 3], curve: Curve::ZERO };
        let plane = support(&problem, y, |x| x[1] == -10.0);
        problem.supports.push(Support { motion: Some(moved), ..plane.clone() });
        assert_eq!(problem.declare_symmetry(problem.supports.len() - 1), Err(NoSymmetry::Axes));
        problem.supports.push(plane);
        let last = problem.supports.len() - 1;
        assert_eq!(problem.declare_symmetry(last), Ok(SymmetryPlane { axis: 1, at: -10.0, support: last }));
        assert_eq!(problem.declare_symmetry(last), Err(NoSymmetry::Second("y = -10".into())));
        assert_eq!(problem.declare_symmetry(99), Err(NoSymmetry::Axes));
    }

    #[test]
    fn obstacles_beside_a_plane_have_a_mirror_image() {
        let upright = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let cuboid = |y: f64| Shape::Cuboid { centre: [0.0, y, -9.0], size: [1.0; 3], axes: upright, edge_radius: 0.1 };
        let cylinder = |y: f64, axis| Shape::Cylinder { point: [0.0, y, -9.0], axis, radius: 1.0, is_hollow: false };
        let plane = |normal| Shape::Plane { point: [0.0, 3.0, -9.0], normal };
        let sphere = |y| Shape::Sphere { centre: [0.0, y, 0.0], radius: 1.0, is_hollow: false };
        for at in [0.0, 7.0] {
            for (shape, expected) in [
                (cuboid(at), true),
                (cuboid(at + 2.0), false),
                (cylinder(at + 2.0, [0.0, 5.0, 0.0]), true),
                (cylinder(at, [3.0, 0.0, 4.0]), true),
                (cylinder(at, [0.0, 1.0, 1.0]), false),
                (cylinder(at + 2.0, [0.0, 0.0, 1.0]), false),
                (plane([1.0, 0.0, 1.0]), true),
                (plane([0.0, 1.0, 1.0]), false),
                (sphere(at), true),
                (sphere(at - 1.0), false),
            ] {
                let symmetry = SymmetryPlane { axis: 1, at, support: 0 };
                let mut obstacle = Obstacle {
                    name: "o".into(),
                    shape,
                    facets: Vec::new(),
                    stiffness: 1.0,
                    motion: None,
                    report_force: true,
                };
                assert_eq!(symmetry.is_symmetry_of(&obstacle), expected, "{obstacle:?}");
                obstacle.motion = Some(Motion { displacement: [0.0, 1.0, 0.0], curve: Curve::Proportional(1.0) });
                assert!(!symmetry.is_symmetry_of(&obstacle), "{obstacle:?}");
            }
        }
    }
}
