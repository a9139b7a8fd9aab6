//! Matrices to exercise and to time a factorisation: lattices with the topology of hollow actuators.
//!
//! The matrices are symmetric positive definite by construction (each clique adds a positive semi-definite coupling,
//! the diagonal a little more), cheap to make, and have the graph of the real ones; only the graph matters for time.

use crate::pattern::BlockPattern;

/// A matrix on a block pattern.
#[derive(Debug, Clone)]
pub struct BlockMatrix {
    /// The node graph.
    pub pattern: BlockPattern,
    /// `B × B` values per block (layout: [`BlockPattern`]).
    pub values: Vec<f64>,
    /// Position of the nodes, in cell lengths.
    pub positions: Vec<[f64; 3]>,
}

/// Shape functions of the lattice's cells, as far as the node graph is concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// 8 nodes: a node couples to its 26 neighbours.
    Hex8,
    /// 27 nodes: corner nodes couple to 124 others.
    Hex27,
}

/// A long box of `cells[0] × cells[1] × cells[2]` cells, hollowed by a row of chambers along the first axis.
///
/// The proportions are those of a bellows actuator: chambers 6 cells long every 8 cells, walls one cell thick (two at
/// the bottom), a channel between the chambers. `refinement` divides every cell into `refinement³`, `B` is the number
/// of unknowns per node. `[82, 10, 13]` cells make 26 thousand unknowns of 3 per node at `refinement` 1.
pub fn hollow_lattice<const B: usize>(cells: [usize; 3], refinement: usize, cell: Cell) -> BlockMatrix {
    let r = refinement.max(1);
    let fine = cells.map(|count| count * r);
    let solid = |fine_cell: [usize; 3]| {
        let [x, y, z] = fine_cell.map(|index| index / r);
        let between_end_caps = x >= 2 && x + 2 < cells[0];
        let between_side_walls = y >= 1 && y + 1 < cells[1];
        let in_chamber = x % 8 < 6 && between_side_walls && z >= 2 && z + 1 < cells[2];
        let in_channel = y.abs_diff(cells[1] / 2) <= 1 && (2..4).contains(&z) && z + 1 < cells[2];
        !(between_end_caps && (in_chamber || in_channel))
    };
    let order = match cell {
        Cell::Hex8 => 1,
        Cell::Hex27 => 2,
    };
    lattice_matrix::<B>(fine, order, solid)
}

/// A full box of cells: see [`hollow_lattice`].
pub fn solid_lattice<const B: usize>(cells: [usize; 3], cell: Cell) -> BlockMatrix {
    let order = match cell {
        Cell::Hex8 => 1,
        Cell::Hex27 => 2,
    };
    lattice_matrix::<B>(cells, order, |_| true)
}

fn lattice_matrix<const B: usize>(cells: [usize; 3], order: usize, solid: impl Fn([usize; 3]) -> bool) -> BlockMatrix {
    let lattice = cells.map(|count| count * order + 1);
    let mut node_at = vec![u32::MAX; lattice.iter().product()];
    let mut positions = Vec::new();
    let mut cliques = Vec::new();
    for x in 0..cells[0] {
        for y in 0..cells[1] {
            for z in 0..cells[2] {
                if !solid([x, y, z]) {
                    continue;
                }
                for a in x * order..=(x + 1) * order {
                    for b in y * order..=(y + 1) * order {
                        for c in z * order..=(z + 1) * order {
                            let node = &mut node_at[(a * lattice[1] + b) * lattice[2] + c];
                            if *node == u32::MAX {
                                *node = positions.len() as u32;
                                positions.push([a, b, c].map(|i| i as f64 / order as f64));
                            }
                            cliques.push(*node);
                        }
                    }
                }
            }
        }
    }
    let pattern = BlockPattern::from_cliques(positions.len(), cliques.chunks_exact((order + 1).pow(3)));
    let values = positive_definite_values::<B>(&pattern, 1e-3, 1);
    BlockMatrix { pattern, values, positions }
}

/// Random values that make the matrix positive definite: diagonally dominant by `shift`, reproducible from `seed`.
pub fn positive_definite_values<const B: usize>(pattern: &BlockPattern, shift: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let mut values = vec![0.0; pattern.num_blocks() * B * B];
    let mut dominance = vec![shift; pattern.num_nodes() * B];
    for j in 0..pattern.num_nodes() {
        let first = pattern.column_offsets()[j];
        for (k, &i) in pattern.column(j).iter().enumerate() {
            let block = &mut values[(first + k) * B * B..(first + k + 1) * B * B];
            for c in 0..B {
                for r in 0..B {
                    let on_diagonal = i as usize == j;
                    if on_diagonal && r <= c {
                        continue;
                    }
                    let value = random.symmetric();
                    block[c * B + r] = value;
                    if on_diagonal {
                        block[r * B + c] = value;
                    }
                    dominance[i as usize * B + r] += value.abs();
                    dominance[j * B + c] += value.abs();
                }
            }
        }
    }
    for j in 0..pattern.num_nodes() {
        for c in 0..B {
            values[pattern.column_offsets()[j] * B * B + c * B + c] = dominance[j * B + c];
        }
    }
    values
}

/// Reproducible pseudo-random numbers (xorshift of Marsaglia 2003, multiplied as by Vigna 2016).
#[derive(Debug, Clone)]
pub struct Random {
    state: u64,
}

impl Random {
    /// A generator whose sequence is fixed by `seed`.
    pub fn new(seed: u64) -> Self {
        Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1 }
    }

    /// Uniform in `[-1, 1)`.
    pub fn symmetric(&mut self) -> f64 {
        self.state ^= self.state >> 12;
        self.state ^= self.state << 25;
        self.state ^= self.state >> 27;
        let bits = self.state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }
}
