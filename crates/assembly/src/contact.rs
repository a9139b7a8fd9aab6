//! Touching faces as a contribution: an adapter around the contact crate.

use pneuflex_contact::{ContactBlock, ContactModel, evaluate_block};

use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// The face pairs that touch at one set of displacements. Valid at those displacements only.
#[derive(Clone, Debug)]
pub struct Contact<'a> {
    model: &'a ContactModel,
    /// Touching pairs of faces.
    pub blocks: Vec<ContactBlock>,
    positions: Vec<[f64; 3]>,
}

impl<'a> Contact<'a> {
    /// Searches the touching pairs at `positions` (mm).
    pub fn search(model: &'a ContactModel, positions: Vec<[f64; 3]>) -> Self {
        Self { model, blocks: model.search(&positions), positions }
    }

    /// Number of touching points.
    pub fn num_points(&self) -> usize {
        self.blocks.iter().map(|block| block.points.len()).sum()
    }
}

impl LocalContribution for Contact<'_> {
    fn num_blocks(&self) -> usize {
        self.blocks.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        &self.blocks[block].nodes
    }

    fn evaluate(
        &self,
        block: usize,
        _displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let with_tangent = request == Request::Tangent;
        let result = evaluate_block(self.model, &self.blocks[block], &self.positions, with_tangent);
        out.energy += result.energy;
        for (r, value) in out.residual.iter_mut().zip(result.residual.chunks_exact(3)) {
            for k in 0..3 {
                r[k] += value[k];
            }
        }
        if with_tangent {
            let n = self.blocks[block].nodes.len();
            let mut pair = 0;
            for a in 0..n {
                for b in 0..=a {
                    for j in 0..3 {
                        for i in 0..3 {
                            out.tangent[pair][3 * j + i] += result.tangent[(3 * a + i) * 3 * n + 3 * b + j];
                        }
                    }
                    pair += 1;
                }
            }
        }
        Ok(())
    }
}
