//! Nodes inside of obstacles that supports hold there: no traction takes them out.

use pneuflex_model::{LoadParameter, Problem, Shape};

use crate::contact_block::{ContactBlock, Partner};
use crate::model::ContactModel;
use crate::obstacle::distance;

/// A node gives way to an obstacle if more than this share of the normal (its square) lies along free axes.
const FREE: f64 = 0.01;

/// A node inside of an obstacle that supports hold against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldInside {
    /// Number of the obstacle.
    pub obstacle: usize,
    /// Number of the node.
    pub node: u32,
    /// How deep it is, mm.
    pub depth: f64,
}

/// The deepest node, at a position on the load path, that supports hold inside of an obstacle which its faces may touch; `None` if there is
/// none. Nodes count whose distance the supports alone say: those held along all axes, and before a plane those held along its normal.
pub fn deepest_held(problem: &Problem, at: LoadParameter) -> Option<HeldInside> {
    let (held, moved) = (problem.held_dofs(), problem.held_displacement(at));
    let mut deepest: Option<HeldInside> = None;
    for (number, obstacle) in problem.obstacles.iter().enumerate() {
        let (is_flat, offset) = (matches!(obstacle.shape, Shape::Plane { .. }), obstacle.offset(at));
        for node in obstacle.facets.iter().flat_map(|&facet| problem.mesh.facet_nodes(facet)) {
            let index = node as usize;
            let axes = [0, 1, 2].map(|axis| held[3 * index + axis]);
            if !is_flat && axes != [true; 3] {
                continue;
            }
            let place = std::array::from_fn(|k| problem.mesh.nodes[index][k] + moved[index][k]);
            let depth = depth_if_held(&obstacle.shape, offset, place, axes);
            if depth > deepest.map_or(0.0, |deepest| deepest.depth) {
                deepest = Some(HeldInside { obstacle: number, node, depth });
            }
        }
    }
    deepest
}

/// How deep a place is inside of a shape that was moved by `offset`, mm; zero outside, and where it can give way along axes that are not held.
fn depth_if_held(shape: &Shape, offset: [f64; 3], place: [f64; 3], held: [bool; 3]) -> f64 {
    let found = distance(shape, offset, place);
    let free: f64 = found.normal.iter().zip(held).filter(|(_, held)| !held).map(|(n, _)| n * n).sum();
    if free > FREE { 0.0 } else { (-found.value).max(0.0) }
}

impl ContactModel {
    /// How deep an obstacle is at nodes of a face that supports hold against it, mm, and its name, if that is deeper than its points may be. A
    /// multiplier of such a face's points would grow without an end.
    pub fn stuck(&self, block: &ContactBlock, positions: &[[f64; 3]]) -> Option<(f64, &str)> {
        let Partner::Obstacle(number) = block.partner else { return None };
        let rigid = &self.obstacles[number];
        let depth_of = |&node: &u32| {
            let axes = [0, 1, 2].map(|axis| self.held.get(3 * node as usize + axis).copied().unwrap_or(false));
            depth_if_held(&rigid.obstacle.shape, rigid.offset, positions[node as usize], axes)
        };
        let depth = block.nodes.iter().map(depth_of).fold(0.0, f64::max);
        (depth > rigid.tolerance?).then_some((depth, rigid.obstacle.name.as_str()))
    }
}
