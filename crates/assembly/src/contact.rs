//! Contact as a contribution: an adapter around the contact crate.

use std::sync::Arc;

use pneuflex_contact::{ContactBlock, ContactModel, Partner, evaluate_block, predicted_tractions};
use pneuflex_mesh::Mesh;
use pneuflex_model::load::Motion;
use pneuflex_model::{LoadParameter, Problem};

use crate::contribution::{Contribution, Mixed, Position, Prediction, RigidMotion, Unilateral};
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// The face pairs that touch at the position taken last.
#[derive(Clone, Debug)]
pub struct ContactForces {
    model: ContactModel,
    mesh: Arc<Mesh>,
    /// Touching pairs of faces.
    blocks: Vec<ContactBlock>,
    /// Where they were found: positions of the nodes, mm,
    positions: Vec<[f64; 3]>,
    /// and on the load path.
    parameter: LoadParameter,
    /// Traction of every contact point in the tangent's geometric term, MPa.
    carried: Vec<f64>,
}

impl ContactForces {
    /// The contact of a problem, at rest.
    pub fn of(problem: &Problem) -> Self {
        let model = ContactModel::of(problem);
        let carried = vec![0.0; model.num_points()];
        Self {
            model,
            mesh: problem.mesh.clone(),
            blocks: Vec::new(),
            positions: Vec::new(),
            parameter: LoadParameter::default(),
            carried,
        }
    }

    /// Touching pairs of faces at the position taken last.
    pub fn touching(&self) -> &[ContactBlock] {
        &self.blocks
    }

    fn found_at(&self, displacement: &[[f64; 3]]) -> Vec<ContactBlock> {
        self.model.search(&self.mesh.deformed(displacement))
    }
}

impl Contribution for ContactForces {
    fn name(&self) -> &'static str {
        "contact"
    }

    fn set_position(&mut self, position: Position<'_>) {
        self.parameter = position.parameter;
        self.model.set_parameter(position.parameter);
        self.positions = self.mesh.deformed(position.displacement);
        let kept = if position.is_on_the_way { self.model.kept_distances(&self.carried) } else { Vec::new() };
        self.blocks = self.model.search_keeping(&self.positions, &kept);
        for point in self.blocks.iter_mut().flat_map(|block| &mut block.points) {
            point.traction = self.carried[point.number];
        }
    }

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        Some(self)
    }

    fn mixed(&mut self) -> Option<&mut dyn Mixed> {
        Some(self)
    }

    fn unilateral(&self) -> Option<&dyn Unilateral> {
        Some(self)
    }

    fn unilateral_mut(&mut self) -> Option<&mut dyn Unilateral> {
        Some(self)
    }
}

impl Mixed for ContactForces {
    fn predict(&mut self, prediction: &Arc<Prediction>) {
        self.carried.fill(0.0);
        if let Some(correction) = &prediction.correction {
            let moved = prediction.motion.map_or_else(Vec::new, |[from, to]| self.model.moved(from, to));
            for block in &self.blocks {
                let predicted = predicted_tractions(&self.model, block, &self.positions, correction, &moved);
                for (number, traction) in predicted {
                    self.carried[number] = traction;
                }
            }
        } else {
            for point in self.found_at(&prediction.displacement).iter().flat_map(|block| &block.points) {
                self.carried[point.number] = point.traction;
            }
        }
    }

    fn stored(&self) -> &[f64] {
        &self.carried
    }

    fn restore(&mut self, stresses: &[f64]) {
        self.carried.copy_from_slice(stresses);
    }
}

impl Unilateral for ContactForces {
    fn num_points(&self) -> usize {
        self.model.num_points()
    }

    fn num_active(&self) -> usize {
        self.blocks.iter().map(|block| block.points.len()).sum()
    }

    fn near_nodes(&self) -> Vec<Vec<u32>> {
        // Points that are kept in contact may be further away than what is near.
        let touching = self.blocks.iter().map(|block| block.nodes.clone());
        self.model.near_face_pairs(&self.positions).into_iter().chain(touching).collect()
    }

    fn deepest_penetration(&mut self, position: Position<'_>) -> f64 {
        self.model.set_parameter(position.parameter);
        let blocks = self.found_at(position.displacement);
        self.model.set_parameter(self.parameter);
        blocks.iter().flat_map(|block| &block.points).fold(0.0, |deepest, point| deepest.max(-point.distance))
    }

    fn passed_through(&self, ends: [Position<'_>; 2]) -> Option<String> {
        let [before, after] = ends.map(|position| self.mesh.deformed(position.displacement));
        let passed = self.model.passed_through(ends.map(|position| position.parameter), [&before, &after]);
        passed.map(|obstacle| obstacle.name.clone())
    }

    fn motions(&self) -> Vec<RigidMotion> {
        let of_obstacle = |(number, motion): (usize, &Motion)| {
            let mut column = vec![[0.0; 3]; self.mesh.num_nodes()];
            for block in self.blocks.iter().filter(|block| block.partner == Partner::Obstacle(number)) {
                // A point that moves with the obstacle feels nothing: what the obstacle does is minus what the whole block would.
                let tangent = evaluate_block(&self.model, block, &self.positions, true).tangent;
                let size = 3 * block.nodes.len();
                for (row, of_row) in tangent.chunks_exact(size).enumerate() {
                    let change: f64 = of_row.iter().enumerate().map(|(j, k)| k * motion.displacement[j % 3]).sum();
                    column[block.nodes[row / 3] as usize][row % 3] -= change;
                }
            }
            RigidMotion { curve: motion.curve.clone(), column }
        };
        self.model.motions().map(of_obstacle).collect()
    }

    fn tractions(&self, displacement: &[[f64; 3]]) -> (Vec<f64>, f64) {
        let mut tractions = vec![0.0; self.model.num_points()];
        let mut distance: f64 = 0.0;
        for point in self.found_at(displacement).iter().flat_map(|block| &block.points) {
            tractions[point.number] = point.traction;
            distance = distance.max(point.distance.abs());
        }
        (tractions, distance)
    }

    fn multipliers(&self) -> &[f64] {
        self.model.multipliers()
    }

    fn set_multipliers(&mut self, multipliers: Vec<f64>) {
        self.model.set_multipliers(multipliers);
    }
}

impl LocalContribution for ContactForces {
    fn num_blocks(&self) -> usize {
        self.blocks.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        &self.blocks[block].nodes
    }

    /// The blocks are valid at the position taken last only; `displacement` is not used.
    fn evaluate(
        &self,
        block: usize,
        _displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let with_tangent = request == Request::Tangent;
        let result = evaluate_block(&self.model, &self.blocks[block], &self.positions, with_tangent);
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
