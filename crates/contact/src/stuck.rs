//! Faces that an obstacle has reached where supports hold them: no traction takes those out of it.

use crate::contact_block::{ContactBlock, Partner};
use crate::model::ContactModel;
use crate::obstacle::distance;

/// A node gives way to an obstacle if more than this share of the normal (its square) lies along free axes.
const FREE: f64 = 0.01;

impl ContactModel {
    /// How deep an obstacle is at nodes of a face that supports hold against it, mm, and its name, if that is deeper than its points may be. A
    /// multiplier of such a face's points would grow without an end.
    pub fn stuck(&self, block: &ContactBlock, positions: &[[f64; 3]]) -> Option<(f64, &str)> {
        let Partner::Obstacle(number) = block.partner else { return None };
        let rigid = &self.obstacles[number];
        let depth_of_held = |&node: &u32| {
            let found = distance(&rigid.obstacle.shape, rigid.offset, positions[node as usize]);
            let held = self.held.get(3 * node as usize..3 * node as usize + 3).unwrap_or(&[false; 3]);
            let free: f64 = found.normal.iter().zip(held).filter(|(_, held)| !**held).map(|(n, _)| n * n).sum();
            if free > FREE { 0.0 } else { -found.value }
        };
        let depth = block.nodes.iter().map(depth_of_held).fold(0.0, f64::max);
        (depth > rigid.tolerance?).then_some((depth, rigid.obstacle.name.as_str()))
    }
}
