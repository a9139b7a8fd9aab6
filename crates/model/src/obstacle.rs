//! Rigid bodies that a deformable one may touch.

use pneuflex_mesh::Facet;

use crate::load::Motion;
use crate::quantity::LoadParameter;

/// A rigid body without friction that some faces must not enter.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Name in reports.
    pub name: String,
    /// Its shape at rest.
    pub shape: Shape,
    /// Faces that carry the contact points.
    pub facets: Vec<Facet>,
    /// Penalty stiffness k, N/mm³.
    pub stiffness: f64,
    /// How it is moved, without turning; `None` if it stays in place.
    pub motion: Option<Motion>,
    /// Whether results hold the force on it.
    pub report_force: bool,
    /// Largest depth at requested loads, mm; `None` for that of the problem's contact.
    pub penetration_tolerance: Option<f64>,
    /// Position on the load path by which what it overlaps of the body at rest has been pressed out of it, evenly from rest on; `None` if it must
    /// not overlap the body.
    pub interference_until: Option<LoadParameter>,
}

/// The shape of an obstacle, mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The half-space behind a plane.
    Plane {
        /// A point of the plane.
        point: [f64; 3],
        /// Normal out of the half-space, of any length but 0.
        normal: [f64; 3],
    },
    /// A ball, or everything but a ball.
    Sphere {
        /// Centre.
        centre: [f64; 3],
        /// Radius.
        radius: f64,
        /// Whether the body is inside: the obstacle is what is left of space.
        is_hollow: bool,
    },
    /// An endless cylinder, or everything but a cylinder: a tube.
    Cylinder {
        /// A point of the axis.
        point: [f64; 3],
        /// Direction of the axis, of any length but 0.
        axis: [f64; 3],
        /// Radius.
        radius: f64,
        /// Whether the body is inside: the obstacle is what is left of space.
        is_hollow: bool,
    },
    /// A cuboid.
    Cuboid {
        /// Centre.
        centre: [f64; 3],
        /// Lengths of its edges along its own axes.
        size: [f64; 3],
        /// Its own axes before it is moved, one per row: orthogonal and of length 1.
        axes: [[f64; 3]; 3],
        /// Radius with which its edges and corners are rounded, less than half of every edge; 0 for sharp ones.
        edge_radius: f64,
    },
}

impl Shape {
    /// The point that an obstacle's moment refers to before it is moved: its centre, or the given point of a plane or an axis.
    pub fn reference_point(&self) -> [f64; 3] {
        match *self {
            Self::Plane { point, .. } | Self::Cylinder { point, .. } => point,
            Self::Sphere { centre, .. } | Self::Cuboid { centre, .. } => centre,
        }
    }
}

impl Shape {
    /// Greatest depth below its surface, mm: a point deeper than this has passed through its middle. Infinite for what has no other side.
    pub fn greatest_depth(&self) -> f64 {
        match self {
            Self::Sphere { radius, is_hollow: false, .. } | Self::Cylinder { radius, is_hollow: false, .. } => *radius,
            Self::Cuboid { size, .. } => 0.5 * size.iter().copied().fold(f64::INFINITY, f64::min),
            Self::Plane { .. } | Self::Sphere { .. } | Self::Cylinder { .. } => f64::INFINITY,
        }
    }
}

impl Obstacle {
    /// By how much it has moved at a position on the load path, mm.
    pub fn offset(&self, parameter: LoadParameter) -> [f64; 3] {
        let Some(motion) = &self.motion else { return [0.0; 3] };
        let factor = motion.curve.at(parameter);
        motion.displacement.map(|x| factor * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::Curve;

    #[test]
    fn obstacles_move_with_their_curve() {
        let shape = Shape::Sphere { centre: [1.0, 2.0, 3.0], radius: 1.0, is_hollow: false };
        let motion = Motion { displacement: [0.0, 2.0, -4.0], curve: Curve::Proportional(0.1) };
        let mut obstacle = Obstacle {
            name: "ball".into(),
            shape,
            facets: Vec::new(),
            stiffness: 4.0,
            motion: Some(motion),
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        };
        assert_eq!(obstacle.offset(LoadParameter(5.0)), [0.0, 1.0, -2.0]);
        assert_eq!(obstacle.shape.reference_point(), [1.0, 2.0, 3.0]);
        obstacle.motion = None;
        assert_eq!(obstacle.offset(LoadParameter(5.0)), [0.0; 3]);
    }
}
