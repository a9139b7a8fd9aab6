//! Corners whose average gaps are closed: their energy and its part of the tangent; the forces are their points'.

use std::collections::BTreeMap;

use crate::averaging::{Averaging, Bounded};
use crate::contact_block::ContactBlock;
use crate::model::ContactModel;
use crate::narrow_phase::kept_at;
use crate::potential::distance_gradient;

/// A corner of a slave surface whose gap is closed on the mean, see [`crate::averaging`].
#[derive(Clone, Debug, PartialEq)]
pub struct AverageGap {
    /// Number of the corner among all points of the model, see [`ContactModel::num_points`].
    pub number: usize,
    /// Reference area W that it stands for, mm².
    pub weight: f64,
    /// g, mm; negative is penetration.
    pub distance: f64,
    /// λ/k less what may still overlap, mm.
    pub shift: f64,
    /// λ − k g, MPa.
    pub traction: f64,
    /// Penalty stiffness k, N/mm³.
    pub stiffness: f64,
    /// Nodes of all faces with points that g depends on, in ascending order.
    pub nodes: Vec<u32>,
    /// ∂g/∂x of these nodes.
    pub gradient: Vec<[f64; 3]>,
}

impl AverageGap {
    /// ½ k W (g − λ/k)², mJ.
    pub fn energy(&self) -> f64 {
        0.5 * self.stiffness * self.weight * (self.distance - self.shift).powi(2)
    }

    /// k W: the tangent's part is this times the gradient's product with itself, N/mm.
    pub fn tangent_factor(&self) -> f64 {
        self.stiffness * self.weight
    }

    /// What the linearised gap predicts for the traction, MPa: ⟨λ − k (g + ∇g·δu)⟩; of an overlap, `change` mm more may be left.
    pub fn predicted_traction(&self, correction: &[[f64; 3]], change: f64) -> f64 {
        let mut distance = self.distance - self.shift + change;
        for (&node, gradient) in self.nodes.iter().zip(&self.gradient) {
            distance += (0..3).map(|k| gradient[k] * correction[node as usize][k]).sum::<f64>();
        }
        (-self.stiffness * distance).max(0.0)
    }
}

/// A corner on the way to its average.
#[derive(Clone, Debug, Default)]
struct Sum {
    /// ∫ Φ (c − φ) dA₀.
    nearness: f64,
    /// The points that it is made of: block, point, Φ, φ(d).
    terms: Vec<(usize, usize, f64, Bounded)>,
}

/// Finds the corners whose gaps are closed among the points of blocks of averaged contact, gives the points their tractions, and leaves out
/// blocks without any.
pub fn close_gaps(
    model: &ContactModel,
    blocks: &mut Vec<ContactBlock>,
    positions: &[[f64; 3]],
    kept: &[f64],
) -> Vec<AverageGap> {
    let mut sums: BTreeMap<usize, (usize, Sum)> = BTreeMap::new();
    for (block_number, block) in blocks.iter().enumerate() {
        let Some((averaging, first)) = model.averaging(block.partner) else { continue };
        for (point_number, point) in block.points.iter().enumerate() {
            for (corner, share) in averaging.shares(block.slave_face, point.slave_xi) {
                let bound = averaging.bound(corner);
                let phi = Bounded::at(point.distance, bound);
                if phi.slope == 0.0 || share <= 0.0 {
                    continue;
                }
                let entry = sums.entry(first + corner);
                let (_, sum) = entry.or_insert_with(|| (corner, Sum::default()));
                sum.nearness += share * point.area * (bound - phi.value);
                sum.terms.push((block_number, point_number, share, phi));
            }
        }
    }
    let mut gaps = Vec::new();
    for (number, (corner, sum)) in sums {
        let partner = blocks[sum.terms[0].0].partner;
        let Some((averaging, _)) = model.averaging(partner) else { continue };
        let (stiffness, weight) = (model.stiffness(partner), averaging.weight(corner));
        let shift = model.shift(number, stiffness);
        let distance = averaging.bound(corner) - sum.nearness / weight;
        if distance >= model.touching + shift + kept_at(kept, number) {
            continue;
        }
        let traction = -stiffness * (distance - shift);
        let mut gradient: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
        for &(block_number, point_number, share, phi) in &sum.terms {
            let block = &mut blocks[block_number];
            block.points[point_number].add(traction * share, phi);
            let point = block.points[point_number];
            let of_point = distance_gradient(model, block, &point, positions);
            let factor = share * point.area * phi.slope / weight;
            for (&node, by_node) in block.nodes.iter().zip(of_point.as_chunks::<3>().0) {
                let entry = gradient.entry(node).or_default();
                *entry = std::array::from_fn(|k| entry[k] + factor * by_node[k]);
            }
        }
        let (nodes, gradient) = gradient.into_iter().unzip();
        gaps.push(AverageGap { number, weight, distance, shift, traction, stiffness, nodes, gradient });
    }
    blocks.retain_mut(|block| {
        if model.averaging(block.partner).is_some() {
            block.points.retain(|point| point.traction != 0.0 || point.stiffness != 0.0);
        }
        !block.points.is_empty()
    });
    gaps
}

/// Nodes that the averages of corners may couple: for every corner those of all blocks with a point that belongs to it.
pub fn coupled_nodes(model: &ContactModel, blocks: &[ContactBlock]) -> Vec<Vec<u32>> {
    let mut of_corner: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for block in blocks {
        let Some((averaging, first)) = model.averaging(block.partner) else { continue };
        for point in &block.points {
            for (corner, _) in averaging.shares(block.slave_face, point.slave_xi) {
                of_corner.entry(first + corner).or_default().extend(&block.nodes);
            }
        }
    }
    let mut groups: Vec<Vec<u32>> = of_corner.into_values().collect();
    for group in &mut groups {
        group.sort_unstable();
        group.dedup();
    }
    groups
}

/// Puts the carried tractions of corners in the place of their own in the points' geometric terms.
pub fn carry(averaging: &Averaging, first: usize, block: &mut ContactBlock, carried: &[f64]) {
    for point in &mut block.points {
        (point.carried, point.stiffness) = (0.0, 0.0);
        for (corner, share) in averaging.shares(block.slave_face, point.slave_xi) {
            let phi = Bounded::at(point.distance, averaging.bound(corner));
            point.carried += carried[first + corner] * share * phi.slope;
            point.stiffness -= carried[first + corner] * share * phi.curvature;
        }
    }
}
