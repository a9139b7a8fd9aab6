//! Scatter of block results into the residual vector and the node-blocked matrix.

use std::cmp::Ordering;
use std::sync::Arc;

use pneuflex_factor::BlockPattern;
use rayon::prelude::*;

use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// Blocks computed in one go; large enough to keep all threads busy, small enough to stay in cache.
const BATCH: usize = 256;

/// Sums over all contributions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Totals {
    /// Energy, mJ.
    pub energy: f64,
    /// Residual, N, one entry per node.
    pub residual: Vec<[f64; 3]>,
    /// Tangent, N/mm, 9 values per block of the pattern.
    pub tangent: Vec<f64>,
}

/// A node pair's values are added as they are.
const PLAIN: u32 = 1;

/// A node pair's values are added transposed.
const TRANSPOSED: u32 = 2;

/// Where the node pairs of a contribution's blocks go in the matrix: position · 4, plus [`PLAIN`], [`TRANSPOSED`], or both for the pair
/// of two places at which a block has the same node.
#[derive(Clone, Debug, Default)]
struct ScatterMap {
    offsets: Vec<usize>,
    positions: Vec<u32>,
}

/// The pattern of the matrix and the way into it for a fixed list of contributions.
#[derive(Clone, Debug)]
pub struct Assembler {
    pattern: Arc<BlockPattern>,
    maps: Vec<ScatterMap>,
    buffers: [Vec<LocalBlock>; 2],
}

impl Assembler {
    /// Pattern for the given contributions and additional groups of nodes that are to be coupled.
    pub fn new(num_nodes: usize, contributions: &[&dyn LocalContribution], extra: &[Vec<u32>]) -> Self {
        let cliques = contributions
            .iter()
            .flat_map(|c| (0..c.num_blocks()).map(|block| c.nodes(block)))
            .chain(extra.iter().map(Vec::as_slice));
        let pattern = BlockPattern::from_cliques(num_nodes, cliques);
        let maps = contributions
            .iter()
            .map(|c| ScatterMap::new(*c, &pattern).expect("the pattern was made from these blocks"))
            .collect();
        Self { pattern: Arc::new(pattern), maps, buffers: Default::default() }
    }

    /// Pattern of the matrix.
    pub fn pattern(&self) -> &Arc<BlockPattern> {
        &self.pattern
    }

    /// Whether all node pairs of a contribution fit into the pattern.
    pub fn covers(&self, contribution: &dyn LocalContribution) -> bool {
        ScatterMap::new(contribution, &self.pattern).is_some()
    }

    /// Clears `totals` to the sizes of this assembler.
    pub fn reset(&self, totals: &mut Totals, request: Request) {
        totals.energy = 0.0;
        totals.residual.clear();
        totals.residual.resize(self.pattern.num_nodes(), [0.0; 3]);
        if request == Request::Tangent {
            totals.tangent.clear();
            totals.tangent.resize(9 * self.pattern.num_blocks(), 0.0);
        }
    }

    /// Adds contribution `index` of the list given to [`Assembler::new`].
    ///
    /// # Errors
    /// The error of the first block that cannot be evaluated; `totals` is then incomplete.
    ///
    /// # Panics
    /// If `index` is out of range or the contribution's blocks have changed their nodes.
    pub fn add(
        &mut self,
        index: usize,
        contribution: &dyn LocalContribution,
        displacement: &[[f64; 3]],
        request: Request,
        totals: &mut Totals,
    ) -> Result<(), LocalError> {
        let [front, back] = &mut self.buffers;
        add_with_map(contribution, &self.maps[index], displacement, request, totals, front, back)
    }

    /// Adds a contribution whose blocks change from call to call, such as contact.
    ///
    /// # Errors
    /// As [`Assembler::add`].
    ///
    /// # Panics
    /// If the pattern does not cover the contribution, see [`Assembler::covers`].
    pub fn add_changing(
        &mut self,
        contribution: &dyn LocalContribution,
        displacement: &[[f64; 3]],
        request: Request,
        totals: &mut Totals,
    ) -> Result<(), LocalError> {
        let map = if request == Request::Tangent {
            ScatterMap::new(contribution, &self.pattern).expect("callers check that the pattern covers the blocks")
        } else {
            ScatterMap::default()
        };
        let [front, back] = &mut self.buffers;
        add_with_map(contribution, &map, displacement, request, totals, front, back)
    }
}

impl ScatterMap {
    /// `None` if a node pair is missing in the pattern.
    fn new(contribution: &dyn LocalContribution, pattern: &BlockPattern) -> Option<Self> {
        let mut map = Self { offsets: vec![0], positions: Vec::new() };
        for block in 0..contribution.num_blocks() {
            let nodes = contribution.nodes(block);
            for (a, &row) in nodes.iter().enumerate() {
                for (b, &column) in nodes[..=a].iter().enumerate() {
                    let ways = match row.cmp(&column) {
                        Ordering::Greater => PLAIN,
                        Ordering::Less => TRANSPOSED,
                        Ordering::Equal if a == b => PLAIN,
                        Ordering::Equal => PLAIN | TRANSPOSED,
                    };
                    let (i, j) = (row.max(column) as usize, row.min(column) as usize);
                    map.positions.push(4 * pattern.position(i, j)? as u32 + ways);
                }
            }
            map.offsets.push(map.positions.len());
        }
        Some(map)
    }
}

/// Computes the next batch while the previous one is added in block order.
fn add_with_map(
    contribution: &dyn LocalContribution,
    map: &ScatterMap,
    displacement: &[[f64; 3]],
    request: Request,
    totals: &mut Totals,
    front: &mut Vec<LocalBlock>,
    back: &mut Vec<LocalBlock>,
) -> Result<(), LocalError> {
    let count = contribution.num_blocks();
    let compute = |start: usize, buffer: &mut Vec<LocalBlock>| -> Result<(), LocalError> {
        let size = BATCH.min(count - start);
        if buffer.len() < size {
            buffer.resize_with(size, LocalBlock::default);
        }
        let results = buffer[..size].par_iter_mut().with_min_len(8).enumerate().map(|(i, out)| {
            out.reset(contribution.nodes(start + i).len(), request);
            contribution.evaluate(start + i, displacement, request, out)
        });
        // The first error in block order, whatever the threads did first.
        results.collect::<Vec<_>>().into_iter().collect()
    };
    if count == 0 {
        return Ok(());
    }
    compute(0, front)?;
    let mut start = 0;
    loop {
        let next = start + BATCH;
        let scatter = |totals: &mut Totals, buffer: &[LocalBlock]| {
            for (i, local) in buffer[..BATCH.min(count - start)].iter().enumerate() {
                scatter_block(local, contribution.nodes(start + i), start + i, map, request, totals);
            }
        };
        if next >= count {
            scatter(totals, front);
            return Ok(());
        }
        let (result, ()) = rayon::join(|| compute(next, back), || scatter(totals, front));
        result?;
        std::mem::swap(front, back);
        start = next;
    }
}

fn scatter_block(
    local: &LocalBlock,
    nodes: &[u32],
    block: usize,
    map: &ScatterMap,
    request: Request,
    totals: &mut Totals,
) {
    totals.energy += local.energy;
    for (&node, r) in nodes.iter().zip(&local.residual) {
        for k in 0..3 {
            totals.residual[node as usize][k] += r[k];
        }
    }
    if request < Request::Tangent {
        return;
    }
    let positions = &map.positions[map.offsets[block]..map.offsets[block + 1]];
    for (&code, values) in positions.iter().zip(&local.tangent) {
        let start = 9 * (code / 4) as usize;
        let target = &mut totals.tangent[start..start + 9];
        if code & PLAIN != 0 {
            for k in 0..9 {
                target[k] += values[k];
            }
        }
        if code & TRANSPOSED != 0 {
            for i in 0..3 {
                for j in 0..3 {
                    target[3 * j + i] += values[3 * i + j];
                }
            }
        }
    }
}
