//! What one contribution to the energy offers.

/// What is asked of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Request {
    /// Energy only.
    Energy,
    /// Energy and residual.
    Residual,
    /// Energy, residual and tangent.
    Tangent,
}

/// Result of one block. The buffers are reused from block to block; [`LocalBlock::reset`] clears them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LocalBlock {
    /// Energy, mJ (N·mm).
    pub energy: f64,
    /// Derivative of the energy by the block's nodal positions, N; one entry per node.
    pub residual: Vec<[f64; 3]>,
    /// Lower triangle of the tangent by node pairs, N/mm: block (a, b), a ≥ b, stands at a(a+1)/2 + b and holds the
    /// 3 × 3 matrix ∂residual_a/∂x_b column by column.
    pub tangent: Vec<[f64; 9]>,
}

impl LocalBlock {
    /// Clears the buffers for a block with `nodes` nodes.
    pub fn reset(&mut self, nodes: usize, request: Request) {
        self.energy = 0.0;
        self.residual.clear();
        self.tangent.clear();
        if request >= Request::Residual {
            self.residual.resize(nodes, [0.0; 3]);
        }
        if request == Request::Tangent {
            self.tangent.resize(nodes * (nodes + 1) / 2, [0.0; 9]);
        }
    }
}

/// Why a block cannot be evaluated: its material is turned inside out, or deformed so far that its energy overflows.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("block {block} is turned inside out: det F = {jacobian:.3e} at its integration point {point}")]
pub struct LocalError {
    /// Block (element) number.
    pub block: usize,
    /// Integration point within it.
    pub point: usize,
    /// The offending det F.
    pub jacobian: f64,
}

/// A contribution to the total energy, as a list of blocks.
pub trait LocalContribution: Sync {
    /// Number of blocks.
    fn num_blocks(&self) -> usize;

    /// Node numbers of a block, in any order; one may be there more than once.
    fn nodes(&self, block: usize) -> &[u32];

    /// Evaluates a block at nodal displacements `displacement` (mm, one entry per mesh node) into `out`, which the
    /// caller has reset.
    ///
    /// # Errors
    /// [`LocalError`] if the material is turned inside out, or so far deformed that its energy is no finite number.
    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError>;
}
