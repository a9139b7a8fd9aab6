//! Overlaps at rest that are meant (interference fits, theory §5.10): how much of each is left on the way to the position where it is gone.

use pneuflex_model::LoadParameter;

use crate::contact_block::{ContactBlock, ContactPoint};
use crate::model::ContactModel;
use crate::potential::distance_gradient;
use crate::touching::Touching;

/// What the points of a surface overlap its partner by at rest.
#[derive(Clone, Debug)]
pub(crate) struct Overlap {
    /// Number of the first point.
    first: usize,
    /// Depth of every point, mm; 0 where it does not overlap.
    depths: Vec<f64>,
    /// Where it is gone.
    until: LoadParameter,
}

impl Overlap {
    fn of(&self, number: usize) -> f64 {
        number.checked_sub(self.first).and_then(|index| self.depths.get(index)).copied().unwrap_or(0.0)
    }

    /// Share that is left at a position on the load path.
    fn left(&self, parameter: LoadParameter) -> f64 {
        if parameter < self.until { (1.0 - parameter.0 / self.until.0).min(1.0) } else { 0.0 }
    }
}

impl ContactModel {
    /// The same with the overlaps at rest that are meant.
    pub(crate) fn with_overlaps(mut self) -> Self {
        let of_pairs =
            self.surface_pairs.iter().map(|pair| (pair.first_point, pair.num_points(), pair.interference_until));
        let of_obstacles = (self.obstacles.iter())
            .map(|rigid| (rigid.first_point, rigid.points.areas.len(), rigid.obstacle.interference_until));
        let meant: Vec<(usize, usize, LoadParameter)> =
            (of_pairs.chain(of_obstacles)).filter_map(|(first, count, until)| Some((first, count, until?))).collect();
        if meant.is_empty() {
            return self;
        }
        let depths = self.depths_at_rest();
        let of_surface = |(first, count, until): (usize, usize, LoadParameter)| {
            let depths = depths[first..first + count].to_vec();
            Overlap { first, depths, until }
        };
        self.overlaps = meant.into_iter().map(of_surface).collect();
        self
    }

    /// How deep every point is at rest, mm, where obstacles begin; 0 where it is beside its partner.
    fn depths_at_rest(&self) -> Vec<f64> {
        let mut model = self.clone();
        let rest = self.mesh.nodes.clone();
        model.cut(&rest);
        let mut depths = vec![0.0; model.num_points()];
        let touching: Touching = model.search(&rest);
        for (number, _, distance) in touching.tractions(&model) {
            depths[number] = (-distance).max(0.0);
        }
        depths
    }

    /// The deepest point of every surface pair of the problem at rest that is not meant to overlap, mm, by the pair's number; of a surface
    /// from itself none.
    pub fn overlapping_pairs(&self) -> Vec<(usize, f64)> {
        let depths = self.depths_at_rest();
        let others =
            self.surface_pairs.iter().filter(|pair| pair.interference_until.is_none() && !pair.is_self_contact);
        let deepest = |first: usize, count: usize| depths[first..first + count].iter().copied().fold(0.0, f64::max);
        others.map(|pair| (pair.pair, deepest(pair.first_point, pair.num_points()))).collect()
    }

    /// Positions on the load path by which overlaps are gone, each once.
    pub fn overlaps_until(&self) -> Vec<LoadParameter> {
        let mut found: Vec<LoadParameter> = Vec::new();
        for Overlap { until, .. } in &self.overlaps {
            if !found.contains(until) {
                found.push(*until);
            }
        }
        found
    }

    /// What a point overlaps its partner by at rest, mm, if that is gone at `until`.
    pub(crate) fn overlap_until(&self, number: usize, until: LoadParameter) -> f64 {
        let own = self.overlaps.iter().filter(|overlap| overlap.until == until);
        own.map(|overlap| overlap.of(number)).sum()
    }

    /// How deep a point may still be, mm.
    pub(crate) fn allowed(&self, number: usize, parameter: LoadParameter) -> f64 {
        self.overlaps.iter().map(|overlap| overlap.left(parameter) * overlap.of(number)).sum()
    }

    /// By how much what a point may overlap changes between two positions on the load path, mm.
    pub fn allowed_change(&self, number: usize, motion: Option<[LoadParameter; 2]>) -> f64 {
        motion.map_or(0.0, |[from, to]| self.allowed(number, to) - self.allowed(number, from))
    }

    /// Largest depth of a point beyond what it may still overlap, mm; 0 where nothing touches.
    pub fn deepest(&self, touching: &Touching) -> f64 {
        let of_block = |block: &ContactBlock| {
            // Points of averages have no number of their own: the deepest of their surface speaks for them.
            let most = self.averaging(block.partner).map(|(_, first)| self.most_allowed(first));
            let depth = |point: &ContactPoint| {
                -point.distance - most.unwrap_or_else(|| self.allowed(point.number, self.parameter))
            };
            block.points.iter().map(depth).fold(0.0, f64::max)
        };
        touching.blocks.iter().map(of_block).fold(0.0, f64::max)
    }

    fn most_allowed(&self, first: usize) -> f64 {
        let own = self.overlaps.iter().filter(|overlap| overlap.first == first);
        own.map(|overlap| overlap.left(self.parameter) * overlap.depths.iter().copied().fold(0.0, f64::max)).sum()
    }

    /// Change of the contact forces per unit of the share that is left of the overlaps which are gone at `until`, N: node and force, in any
    /// order. `positions` are those at which `touching` was found.
    pub fn overlap_forces(
        &self,
        touching: &Touching,
        positions: &[[f64; 3]],
        until: LoadParameter,
    ) -> Vec<(u32, [f64; 3])> {
        let mut found = Vec::new();
        for block in touching.blocks.iter().filter(|block| self.averaging(block.partner).is_none()) {
            for point in &block.points {
                let factor = self.stiffness(block.partner) * point.area * self.overlap_until(point.number, until);
                if factor > 0.0 {
                    let gradient = distance_gradient(self, block, point, positions);
                    let of_nodes = block.nodes.iter().zip(gradient.as_chunks::<3>().0);
                    found.extend(of_nodes.map(|(&node, g)| (node, g.map(|x| factor * x))));
                }
            }
        }
        for gap in &touching.averages {
            let factor = gap.tangent_factor() * self.overlap_until(gap.number, until);
            let of_nodes = gap.nodes.iter().zip(&gap.gradient).filter(|_| factor > 0.0);
            found.extend(of_nodes.map(|(&node, g)| (node, g.map(|x| factor * x))));
        }
        found
    }
}
