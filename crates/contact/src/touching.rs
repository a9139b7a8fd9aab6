//! All that touches at some positions.

use crate::average_gap::{AverageGap, carry};
use crate::contact_block::ContactBlock;
use crate::model::ContactModel;

/// All that touches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touching {
    /// Touching points by faces.
    pub blocks: Vec<ContactBlock>,
    /// Corners whose gaps are closed on the mean, in the order of their numbers; none without averaged contact.
    pub averages: Vec<AverageGap>,
}

impl Touching {
    /// Number of points and corners that are kept apart.
    pub fn num_active(&self, model: &ContactModel) -> usize {
        let own = self.blocks.iter().filter(|block| model.averaging(block.partner).is_none());
        own.map(|block| block.points.len()).sum::<usize>() + self.averages.len()
    }

    /// Traction and distance of every point and corner that is kept apart, with its number: λ − k d (MPa), d (mm).
    pub fn tractions<'a>(&'a self, model: &'a ContactModel) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
        let own = self.blocks.iter().filter(|block| model.averaging(block.partner).is_none());
        let of_points = own.flat_map(|block| &block.points).map(|point| (point.number, point.traction, point.distance));
        of_points.chain(self.averages.iter().map(|gap| (gap.number, gap.traction, gap.distance)))
    }

    /// Tractions (MPa, one entry per point or corner of the model) take the place of their own in the tangent's geometric term.
    pub fn carry(&mut self, model: &ContactModel, tractions: &[f64]) {
        for block in &mut self.blocks {
            match model.averaging(block.partner) {
                Some((averaging, first)) => carry(averaging, first, block, tractions),
                None => block.points.iter_mut().for_each(|point| point.carried = tractions[point.number]),
            }
        }
    }
}
