//! Planes of symmetry: what is modelled is a half, a quarter or an eighth of the body.
//!
//! Who knows of a plane: the half of an actuator (`part = "half"`), and a model file's support with `symmetry = true`. A support alone is
//! none: nodes that are held along one axis may as well stand on a table.

use crate::obstacle::{Obstacle, Shape};

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

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Curve, Motion};

    #[test]
    fn a_mirror_image_is_on_the_other_side() {
        let plane = SymmetryPlane { axis: 1, at: 5.0, support: 0 };
        assert_eq!(plane.mirror_point([1.0, 2.0, 3.0]), [1.0, 8.0, 3.0]);
        assert_eq!(plane.mirror_vector([1.0, 2.0, 3.0]), [1.0, -2.0, 3.0]);
        assert_eq!(plane.mirror_moment([1.0, 2.0, 3.0]), [-1.0, 2.0, -3.0]);
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
                    penetration_tolerance: None,
                    interference_until: None,
                };
                assert_eq!(symmetry.is_symmetry_of(&obstacle), expected, "{obstacle:?}");
                obstacle.motion = Some(Motion { displacement: [0.0, 1.0, 0.0], curve: Curve::Proportional(1.0) });
                assert!(!symmetry.is_symmetry_of(&obstacle), "{obstacle:?}");
            }
        }
    }
}
