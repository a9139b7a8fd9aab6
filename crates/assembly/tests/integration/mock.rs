//! Contributions that know no mechanics: blocks of integers, whose sums are exact in any order, and those sums written down naively.
//!
//! Naively: every block's whole symmetric matrix, both triangles, is added entry by entry to a dense one.

use nalgebra::DMatrix;
use pneuflex_assembly::{Assembler, LocalBlock, LocalContribution, LocalError, Request, Totals};
use pneuflex_factor::BlockPattern;

pub const REQUESTS: [Request; 3] = [Request::Energy, Request::Residual, Request::Tangent];

/// Blocks that the assembler computes in one go.
pub const BATCH: usize = 256;

/// What buffers are dirty with. Sums of it and integers are exact.
pub const NOISE: f64 = 1234.5625;

/// Blocks with the given nodes, whose values are small multiples of a unit.
pub struct Mock {
    blocks: Vec<Vec<u32>>,
    unit: f64,
    seed: u64,
}

impl Mock {
    /// Values of whole numbers.
    pub fn of_integers(seed: u64, blocks: &[&[u32]]) -> Self {
        Self { blocks: blocks.iter().map(|nodes| nodes.to_vec()).collect(), unit: 1.0, seed }
    }

    /// Many blocks of different nodes each, some of them in descending order.
    pub fn of_many(seed: u64, count: usize, nodes_per_block: u32, num_nodes: u32, unit: f64) -> Self {
        let nodes = |block: u32| {
            let mut nodes: Vec<u32> = (0..nodes_per_block).map(|a| (7 * block + 3 * a) % num_nodes).collect();
            nodes.sort_unstable();
            if block.is_multiple_of(3) {
                nodes.reverse();
            }
            nodes
        };
        Self { blocks: (0..count as u32).map(nodes).collect(), unit, seed }
    }

    /// From −9 to 9 units, in no order.
    fn number(&self, block: usize, row: usize, column: usize) -> f64 {
        let key = self.seed + 100 * (row as u64 + 100 * (column as u64 + 100 * block as u64));
        let mixed = key.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.unit * (((mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 33) % 19) as f64 - 9.0 * self.unit
    }

    fn energy(&self, block: usize) -> f64 {
        self.number(block, 98, 98)
    }

    /// Of the block's degree of freedom `dof`; shows whether the displacement has come through.
    fn residual(&self, block: usize, dof: usize, displacement: &[[f64; 3]]) -> f64 {
        self.number(block, dof, 99) + displacement[self.blocks[block][dof / 3] as usize][dof % 3]
    }

    /// By two degrees of freedom of the block, whichever comes first.
    pub fn tangent(&self, block: usize, row: usize, column: usize) -> f64 {
        self.number(block, row.max(column), row.min(column))
    }
}

impl LocalContribution for Mock {
    fn num_blocks(&self) -> usize {
        self.blocks.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        &self.blocks[block]
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let n = self.blocks[block].len();
        let residual = vec![[0.0; 3]; if request >= Request::Residual { n } else { 0 }];
        let tangent = vec![[0.0; 9]; if request == Request::Tangent { n * (n + 1) / 2 } else { 0 }];
        assert_eq!(*out, LocalBlock { energy: 0.0, residual, tangent }, "the buffer is not clean");
        out.energy = self.energy(block);
        for (a, r) in out.residual.iter_mut().enumerate() {
            *r = std::array::from_fn(|i| self.residual(block, 3 * a + i, displacement));
        }
        let pairs = (0..n).flat_map(|a| (0..=a).map(move |b| (a, b)));
        for ((a, b), values) in pairs.zip(&mut out.tangent) {
            *values = std::array::from_fn(|k| self.tangent(block, 3 * a + k % 3, 3 * b + k / 3));
        }
        Ok(())
    }
}

/// Energy, residual and the whole tangent.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    pub energy: f64,
    pub residual: Vec<[f64; 3]>,
    pub tangent: DMatrix<f64>,
}

impl Dense {
    pub fn zero(num_nodes: usize) -> Self {
        Self { energy: 0.0, residual: vec![[0.0; 3]; num_nodes], tangent: DMatrix::zeros(3 * num_nodes, 3 * num_nodes) }
    }

    /// Adds one block of a mock, entry by entry.
    pub fn add(&mut self, mock: &Mock, block: usize, displacement: &[[f64; 3]]) {
        let dof = |local: usize| 3 * mock.blocks[block][local / 3] as usize + local % 3;
        let count = 3 * mock.blocks[block].len();
        self.energy += mock.energy(block);
        for row in 0..count {
            self.residual.as_flattened_mut()[dof(row)] += mock.residual(block, row, displacement);
            for column in 0..count {
                self.tangent[(dof(row), dof(column))] += mock.tangent(block, row, column);
            }
        }
    }

    pub fn sum(mocks: &[&Mock], displacement: &[[f64; 3]]) -> Self {
        let mut dense = Self::zero(displacement.len());
        for mock in mocks {
            (0..mock.num_blocks()).for_each(|block| dense.add(mock, block, displacement));
        }
        dense
    }

    /// What an assembler has summed, both triangles.
    pub fn of(pattern: &BlockPattern, totals: &Totals) -> Self {
        let mut dense =
            Self { energy: totals.energy, residual: totals.residual.clone(), ..Self::zero(pattern.num_nodes()) };
        assert_eq!(totals.tangent.len(), 9 * pattern.num_blocks());
        let mut blocks = totals.tangent.chunks_exact(9);
        for column in 0..pattern.num_nodes() {
            for &row in pattern.column(column) {
                for (k, &value) in blocks.next().unwrap().iter().enumerate() {
                    let (i, j) = (3 * row as usize + k % 3, 3 * column + k / 3);
                    dense.tangent[(i, j)] = value;
                    // Blocks on the diagonal are stored whole.
                    if row as usize != column {
                        dense.tangent[(j, i)] = value;
                    }
                }
            }
        }
        dense
    }

    pub fn bits(&self) -> Vec<u64> {
        let values = std::iter::once(&self.energy).chain(self.residual.as_flattened()).chain(self.tangent.as_slice());
        values.map(|value| value.to_bits()).collect()
    }
}

/// Displacements of integers.
pub fn displacement(num_nodes: usize) -> Vec<[f64; 3]> {
    (0..num_nodes).map(|node| std::array::from_fn(|k| ((5 * node + 2 * k) % 7) as f64 - 3.0)).collect()
}

pub fn assembler_of(mocks: &[&Mock], num_nodes: usize) -> Assembler {
    let contributions: Vec<&dyn LocalContribution> = mocks.iter().map(|&mock| mock as &dyn LocalContribution).collect();
    Assembler::new(num_nodes, &contributions, &[])
}

pub fn assemble(assembler: &mut Assembler, mocks: &[&Mock], u: &[[f64; 3]]) -> Dense {
    let mut totals = Totals::default();
    assembler.reset(&mut totals, Request::Tangent);
    for (index, mock) in mocks.iter().enumerate() {
        assembler.add(index, *mock, u, Request::Tangent, &mut totals).unwrap();
    }
    Dense::of(assembler.pattern(), &totals)
}
