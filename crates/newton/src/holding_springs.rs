//! Springs that help what only contact holds until contact does; `path/release` makes them carry nothing. Dampers for bodies that snap, which
//! `path/snap` makes rest.

use pneuflex_model::Problem;

use crate::rigid_motion::{LoosePart, loose_parts};

/// Stiffness of a part's springs in all, as a share of μ times its size: what contact that has closed is much stiffer than.
const STIFFNESS: f64 = 1e-3;

/// Springs at the nodes of parts that only contact holds: node, stiffness in N/mm.
pub fn springs_of(problem: &Problem) -> Vec<(u32, f64)> {
    let softest = softest(problem);
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

/// Dampers at all nodes of a body: node, damping constant μ V/l² with the node's share V of the volume and the body's extent l. Pseudo-time has no
/// unit; the body's slowest motions take about one of it.
pub fn dampers_of(problem: &Problem) -> Vec<(u32, f64)> {
    let mesh = &problem.mesh;
    let mut volumes = vec![0.0; mesh.num_nodes()];
    for element in 0..mesh.num_elements() {
        let nodes = mesh.element(element);
        let share = mesh.volume_of([element as u32]) / nodes.len() as f64;
        nodes.iter().for_each(|&node| volumes[node as usize] += share);
    }
    let constant = softest(problem) / mesh.extent().powi(2);
    (0..).zip(volumes).map(|(node, volume)| (node, constant * volume)).collect()
}

fn softest(problem: &Problem) -> f64 {
    problem.materials().0.iter().map(|material| material.shear_modulus()).fold(f64::INFINITY, f64::min)
}
