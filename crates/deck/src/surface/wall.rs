//! How thin the walls of a body are.

use super::{Surface, Vec3, centre, dot, norm, ray_meets, unit_normal};

/// Walls are measured behind so many triangles at the most, evenly among all.
const MOST: usize = 3000;

/// The other side of a wall looks the other way: largest cosine of the angle between the normals.
const OPPOSITE: f64 = -0.8;

/// A wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Distance of its sides.
    pub thickness: f64,
    /// A point in its middle.
    pub at: [f64; 3],
}

impl Surface {
    /// The thinnest wall of the body that a surface bounds whose triangles look away from the solid: the shortest way through it, straight
    /// into a triangle, to one that looks the other way. `None` if nothing of it is a wall.
    pub fn thinnest_wall(&self) -> Option<Wall> {
        let normals: Vec<Vec3> =
            (0..self.triangles.len()).map(|triangle| unit_normal(self.corners(triangle))).collect();
        let smallest = 1e-7 * self.diagonal();
        let step = self.triangles.len().div_ceil(MOST).max(1);
        let behind = |triangle: usize| {
            let normal = normals[triangle];
            if norm(normal) == 0.0 {
                return None;
            }
            let (from, inward) = (centre(self.corners(triangle)), normal.map(|t| -t));
            let met = (0..self.triangles.len()).filter(|&other| other != triangle).filter_map(|other| {
                let along = ray_meets(from, inward, self.corners(other)).filter(|along| *along > smallest)?;
                Some((along, other))
            });
            let (thickness, other) = met.min_by(|a, b| a.0.total_cmp(&b.0))?;
            let at = std::array::from_fn(|d| from[d] + 0.5 * thickness * inward[d]);
            (dot(normal, normals[other]) < OPPOSITE).then_some(Wall { thickness, at })
        };
        let walls = (0..self.triangles.len()).step_by(step).filter_map(behind);
        walls.min_by(|a, b| a.thickness.total_cmp(&b.thickness))
    }
}
