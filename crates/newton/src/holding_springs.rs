//! Springs that help what only contact holds until contact does; `path/release` makes them carry nothing.

use pneuflex_model::Problem;

use crate::rigid_motion::{LoosePart, loose_parts};

/// Stiffness of a part's springs in all, as a share of μ times its size: what contact that has closed is much stiffer than.
const STIFFNESS: f64 = 1e-3;

/// Springs at the nodes of parts that only contact holds: node, stiffness in N/mm.
pub fn springs_of(problem: &Problem) -> Vec<(u32, f64)> {
    let softest = problem.materials().0.iter().map(|material| material.shear_modulus()).fold(f64::INFINITY, f64::min);
    let of_part = |part: LoosePart| {
        let mut nodes: Vec<u32> =
            part.elements.iter().flat_map(|&element| problem.mesh.element(element as usize)).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let each = STIFFNESS * softest * 2.0 * part.motions.size / nodes.len() as f64;
        nodes.into_iter().map(move |node| (node, each))
    };
    let held = |part: &LoosePart| part.may_be_held_by_contact;
    loose_parts(problem).into_iter().filter(held).flat_map(of_part).collect()
}
