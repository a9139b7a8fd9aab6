//! How thin the walls of a body are.

use pneuflex_mesh::vector::{Vec3, bounds, dot, norm, ray_meets};

use super::{Surface, centre, unit_normal};

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
        let boxes = self.boxes();
        let step = self.triangles.len().div_ceil(MOST).max(1);
        let mut thinnest: Option<Wall> = None;
        for triangle in (0..self.triangles.len()).step_by(step) {
            let normal = normals[triangle];
            if norm(normal) == 0.0 {
                continue;
            }
            let (from, inward) = (centre(self.corners(triangle)), normal.map(|t| -t));
            // Nothing beyond the thinnest wall so far is of interest.
            let reach = thinnest.map_or(self.diagonal(), |wall| wall.thickness);
            let [low, high] = bounds([from, std::array::from_fn(|d| from[d] + reach * inward[d])]).unwrap_or_default();
            let is_near = |[from, to]: &[Vec3; 2]| (0..3).all(|d| from[d] <= high[d] && low[d] <= to[d]);
            let near = (0..boxes.len()).filter(|&other| other != triangle && is_near(&boxes[other]));
            let met = near.filter_map(|other| {
                let along = ray_meets(from, inward, self.corners(other)).filter(|along| *along > smallest)?;
                Some((along, other))
            });
            let Some((thickness, other)) = met.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            if thickness < reach && dot(normal, normals[other]) < OPPOSITE {
                let at = std::array::from_fn(|d| from[d] + 0.5 * thickness * inward[d]);
                thinnest = Some(Wall { thickness, at });
            }
        }
        thinnest
    }
}
