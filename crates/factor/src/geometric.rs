//! Nested dissection by planes, for meshes whose node positions are known.
//!
//! A subdomain is cut across a coordinate axis where the cut is smallest: every position along every axis is tried, so
//! the cuts find the hollow cross-sections and avoid the solid ones. George's dissection of regular meshes (1973) with
//! sliding cuts; on lattices it beats the general multilevel method in both fill and time.

use crate::error::FactorError;
use crate::minimum_degree::minimum_degree;
use crate::pattern::{Adjacency, BlockPattern};

/// Subdomains up to this size are ordered by minimum degree.
const LEAF: usize = 24;
/// Smaller part of a cut, at least this fraction of the nodes.
const SMALLEST_PART: f64 = 0.2;
/// Axes along which a subdomain is shorter than this fraction of its largest extent are not cut across.
const SHORT_AXIS: f64 = 0.4;

/// Elimination order of the nodes of `graph` at the given positions.
pub(crate) fn geometric_dissection(graph: &Adjacency, positions: &[[f64; 3]]) -> Result<Vec<u32>, FactorError> {
    let num_nodes = positions.len();
    let mut dissection = Dissection {
        graph,
        positions,
        subdomain: vec![0; num_nodes],
        rank: vec![0; num_nodes],
        current: 0,
        order: Vec::with_capacity(num_nodes),
    };
    dissection.order_nodes((0..num_nodes as u32).collect())?;
    Ok(dissection.order)
}

struct Dissection<'a> {
    graph: &'a Adjacency,
    positions: &'a [[f64; 3]],
    /// Label of the last subdomain each node was seen in.
    subdomain: Vec<u32>,
    /// Position of each node along the axis under consideration.
    rank: Vec<u32>,
    current: u32,
    order: Vec<u32>,
}

/// A cut before the node of rank `rank`; the separator consists of the nodes of one side that touch the other.
struct Cut {
    cost: f64,
    axis: usize,
    rank: usize,
    separator_below: bool,
}

impl Dissection<'_> {
    /// Appends the nodes: first the two parts, last the separator.
    fn order_nodes(&mut self, mut nodes: Vec<u32>) -> Result<(), FactorError> {
        if nodes.len() <= LEAF {
            return self.order_leaf(&nodes);
        }
        self.enter(&nodes);
        let Some(cut) = self.best_cut(&mut nodes) else {
            return self.order_leaf(&nodes);
        };
        self.sort_along(&mut nodes, cut.axis);
        let (mut below, mut above, mut separator) = (Vec::new(), Vec::new(), Vec::new());
        for (rank, &node) in nodes.iter().enumerate() {
            let is_below = rank < cut.rank;
            let crosses = is_below == cut.separator_below
                && self.neighbour_ranks(node).any(|other| (other < cut.rank) != is_below);
            match (crosses, is_below) {
                (true, _) => separator.push(node),
                (false, true) => below.push(node),
                (false, false) => above.push(node),
            }
        }
        drop(nodes);
        self.order_nodes(below)?;
        self.order_nodes(above)?;
        self.order.append(&mut separator);
        Ok(())
    }

    /// Marks the nodes as the current subdomain.
    fn enter(&mut self, nodes: &[u32]) {
        self.current += 1;
        for &node in nodes {
            self.subdomain[node as usize] = self.current;
        }
    }

    fn sort_along(&mut self, nodes: &mut [u32], axis: usize) {
        let positions = self.positions;
        nodes.sort_unstable_by(|&a, &b| {
            let along = |node: u32| positions[node as usize][axis];
            along(a).total_cmp(&along(b)).then(a.cmp(&b))
        });
        for (rank, &node) in nodes.iter().enumerate() {
            self.rank[node as usize] = rank as u32;
        }
    }

    /// Ranks of a node's neighbours in the current subdomain.
    fn neighbour_ranks(&self, node: u32) -> impl Iterator<Item = usize> {
        (self.graph.neighbours(node).iter())
            .filter(|&&other| self.subdomain[other as usize] == self.current)
            .map(|&other| self.rank[other as usize] as usize)
    }

    /// The cut with the smallest separator, slightly preferring equal parts; reorders `nodes`.
    fn best_cut(&mut self, nodes: &mut [u32]) -> Option<Cut> {
        let extents = [0, 1, 2].map(|axis| {
            let along = || nodes.iter().map(|&node| self.positions[node as usize][axis]);
            along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
        });
        let largest = extents.into_iter().fold(0.0, f64::max);
        let mut best: Option<Cut> = None;
        for axis in 0..3 {
            if extents[axis] < SHORT_AXIS * largest {
                continue;
            }
            self.sort_along(nodes, axis);
            self.improve_cut(nodes, axis, &mut best);
        }
        best
    }

    /// Slides a cut along an axis, counting the nodes on either side that touch the other.
    fn improve_cut(&self, nodes: &[u32], axis: usize, best: &mut Option<Cut>) {
        let n = nodes.len();
        // Changes of the two counts as the cut moves past each rank.
        let mut below_change = vec![0i64; n + 1];
        let mut above_change = vec![0i64; n + 1];
        for (rank, &node) in nodes.iter().enumerate() {
            let (first, last) = self
                .neighbour_ranks(node)
                .fold((rank, rank), |(first, last), other| (first.min(other), last.max(other)));
            below_change[rank + 1] += 1;
            below_change[last + 1] -= 1;
            above_change[first + 1] += 1;
            above_change[rank + 1] -= 1;
        }
        let (mut touching_below, mut touching_above) = (0, 0);
        for rank in 0..n {
            touching_below += below_change[rank];
            touching_above += above_change[rank];
            for separator_below in [true, false] {
                let (below, above) = (rank as f64, (n - rank) as f64);
                let (separator, below, above) = match separator_below {
                    true => (touching_below as f64, below - touching_below as f64, above),
                    false => (touching_above as f64, below, above - touching_above as f64),
                };
                let imbalance = (below - above) / n as f64;
                let cost = separator * (1.0 + imbalance * imbalance);
                if below.min(above) >= SMALLEST_PART * n as f64 && best.as_ref().is_none_or(|best| cost < best.cost) {
                    *best = Some(Cut { cost, axis, rank, separator_below });
                }
            }
        }
    }

    fn order_leaf(&mut self, nodes: &[u32]) -> Result<(), FactorError> {
        self.enter(nodes);
        for (rank, &node) in nodes.iter().enumerate() {
            self.rank[node as usize] = rank as u32;
        }
        let mut offsets = vec![0];
        let mut rows = Vec::new();
        for (rank, &node) in nodes.iter().enumerate() {
            let start = rows.len();
            rows.push(rank as u32);
            rows.extend(self.neighbour_ranks(node).filter(|&other| other > rank).map(|other| other as u32));
            rows[start..].sort_unstable();
            offsets.push(rows.len());
        }
        let order = minimum_degree(&BlockPattern::new(offsets, rows)?)?;
        self.order.extend(order.into_iter().map(|rank| nodes[rank as usize]));
        Ok(())
    }
}
