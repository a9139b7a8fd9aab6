//! Contact as a contribution: an adapter around the contact crate.

use std::sync::Arc;

use pneuflex_contact::{
    ContactBlock, ContactModel, ContactPoint, Partner, Touching, evaluate_block, predicted_tractions,
};
use pneuflex_mesh::Mesh;
use pneuflex_model::load::Motion;
use pneuflex_model::{Curve, LoadParameter, Problem};

use crate::contribution::{Contribution, Mixed, Position, Prediction, RigidMotion, Tractions, Unilateral};
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// The face pairs that touch at the position taken last.
#[derive(Clone, Debug)]
pub struct ContactForces {
    model: ContactModel,
    mesh: Arc<Mesh>,
    /// What touches.
    touching: Touching,
    /// Where they were found: positions of the nodes, mm,
    positions: Vec<[f64; 3]>,
    /// and on the load path.
    parameter: LoadParameter,
    /// Traction of every contact point in the tangent's geometric term, MPa; and where surfaces are cut along each other's edges, how
    /// often they were in this solution, and at which displacement they were last (mm, three per node).
    stored: Vec<f64>,
    /// Mean distance of the nodes, mm.
    spacing: f64,
}

/// Surfaces that have moved by more than this share of the nodes' spacing are cut along each other's edges again,
const CUT_AGAIN: f64 = 0.02;

/// and a few times those that have moved by more than this one.
const CUT_FINER: f64 = 1e-4;
const MOST_FINE_CUTS: f64 = 4.0;

impl ContactForces {
    /// The contact of a problem, at rest.
    pub fn of(problem: &Problem) -> Self {
        let model = ContactModel::of(problem);
        let cut = if model.is_cut() { 1 + problem.num_dofs() } else { 0 };
        let stored = vec![0.0; model.num_points() + cut];
        Self {
            model,
            mesh: problem.mesh.clone(),
            touching: Touching::default(),
            positions: Vec::new(),
            parameter: LoadParameter::default(),
            stored,
            spacing: problem.mesh.mean_node_spacing(),
        }
    }

    /// Tractions of all points.
    fn carried(&self) -> &[f64] {
        &self.stored[..self.model.num_points()]
    }

    /// On the way to an equilibrium, surfaces that have moved since are cut along each other's edges again: as often as they have moved far,
    /// and a few times after small corrections. From then on Newton's method has a fixed energy before it.
    fn cut_where_moved(&mut self, displacement: &[[f64; 3]]) {
        let points = self.model.num_points();
        let Some((&cuts, at)) = self.stored[points..].split_first() else { return };
        let moved = displacement.as_flattened().iter().zip(at).fold(0.0, |most: f64, (u, v)| most.max((u - v).abs()));
        let is_small = moved <= CUT_AGAIN * self.spacing;
        let is_due = cuts == 0.0 || !is_small || (cuts < MOST_FINE_CUTS && moved > CUT_FINER * self.spacing);
        if is_due {
            // The first one of a solution, and those after large corrections, leave all fine ones to come.
            self.cut(displacement, if is_small { cuts + 1.0 } else { 1.0 });
        }
    }

    /// Cuts surfaces along each other's edges at a displacement, where they are cut at all; so many times in this solution.
    fn cut(&mut self, displacement: &[[f64; 3]], times: f64) {
        let points = self.model.num_points();
        let Some((cuts, at)) = self.stored[points..].split_first_mut() else { return };
        *cuts = times;
        at.copy_from_slice(displacement.as_flattened());
        self.model.cut(&self.mesh.deformed(displacement));
    }

    /// Touching pairs of faces at the position taken last.
    pub fn touching(&self) -> &[ContactBlock] {
        &self.touching.blocks
    }

    fn found_at(&self, displacement: &[[f64; 3]]) -> Touching {
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
        if position.is_on_the_way {
            self.cut_where_moved(position.displacement);
        }
        let kept = if position.is_on_the_way { self.model.kept_distances(self.carried()) } else { Vec::new() };
        self.touching = self.model.search_keeping(&self.positions, &kept);
        self.touching.carry(&self.model, &self.stored[..self.model.num_points()]);
    }

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        Some(self)
    }

    fn begin_step(&mut self, displacement: &[[f64; 3]]) {
        self.cut(displacement, 1.0);
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
        let points = self.model.num_points();
        self.stored[..points].fill(0.0);
        if let Some(correction) = &prediction.correction {
            let own = self.touching.blocks.iter().filter(|block| self.model.averaging(block.partner).is_none());
            for block in own {
                let predicted = predicted_tractions(&self.model, block, &self.positions, correction, prediction.motion);
                for (number, traction) in predicted {
                    self.stored[number] = traction;
                }
            }
            for gap in &self.touching.averages {
                let change = self.model.allowed_change(gap.number, prediction.motion);
                self.stored[gap.number] = gap.predicted_traction(correction, change);
            }
        } else {
            for (number, traction, _) in self.found_at(&prediction.displacement).tractions(&self.model) {
                self.stored[number] = traction;
            }
        }
        // A solution begins.
        if prediction.correction.is_none() || prediction.motion.is_some() {
            self.stored[points..].iter_mut().take(1).for_each(|cuts| *cuts = 0.0);
        }
    }

    fn num_stored(&self) -> usize {
        self.stored.len()
    }

    fn stored(&self) -> &[f64] {
        &self.stored
    }

    fn restore(&mut self, stored: &[f64]) {
        self.stored.copy_from_slice(stored);
        if let Some((_, at)) = self.stored[self.model.num_points()..].split_first() {
            let at: Vec<[f64; 3]> = at.as_chunks().0.to_vec();
            self.model.cut(&self.mesh.deformed(&at));
        }
    }
}

impl Unilateral for ContactForces {
    fn num_points(&self) -> usize {
        self.model.num_points()
    }

    fn num_active(&self) -> usize {
        self.touching.num_active(&self.model)
    }

    fn near_nodes(&self) -> Vec<Vec<u32>> {
        // Points that are kept in contact may be further away than what is near.
        let Touching { blocks, averages } = &self.touching;
        let touching = blocks.iter().map(|block| &block.nodes).chain(averages.iter().map(|gap| &gap.nodes)).cloned();
        self.model.near_face_pairs(&self.positions).into_iter().chain(touching).collect()
    }

    fn deepest_penetration(&mut self, position: Position<'_>) -> f64 {
        self.model.set_parameter(position.parameter);
        let deepest = self.model.deepest(&self.found_at(position.displacement));
        self.model.set_parameter(self.parameter);
        deepest
    }

    fn passed_through(&self, ends: [Position<'_>; 2]) -> Option<String> {
        let [before, after] = ends.map(|position| self.mesh.deformed(position.displacement));
        let passed = self.model.passed_through(ends.map(|position| position.parameter), [&before, &after]);
        passed.map(|obstacle| obstacle.name.clone())
    }

    fn motions(&self) -> Vec<RigidMotion> {
        let of_obstacle = |(number, motion): (usize, &Motion)| {
            let mut column = vec![[0.0; 3]; self.mesh.num_nodes()];
            for block in self.touching.blocks.iter().filter(|block| block.partner == Partner::Obstacle(number)) {
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
        let of_overlaps = |until: LoadParameter| {
            let mut column = vec![[0.0; 3]; self.mesh.num_nodes()];
            for (node, force) in self.model.overlap_forces(&self.touching, &self.positions, until) {
                (0..3).for_each(|k| column[node as usize][k] += force[k]);
            }
            RigidMotion { curve: Curve::Table(vec![[0.0, 1.0], [until.0, 0.0]]), column }
        };
        let of_obstacles = self.model.motions().map(of_obstacle);
        of_obstacles.chain(self.model.overlaps_until().into_iter().map(of_overlaps)).collect()
    }

    fn tractions(&self, displacement: &[[f64; 3]]) -> Tractions {
        let tolerances = self.model.tolerances();
        let positions = self.mesh.deformed(displacement);
        let mut touching = self.model.search(&positions);
        let mut found = Tractions { values: vec![0.0; self.model.num_points()], ..Tractions::default() };
        touching.blocks.retain(|block| {
            let stuck = self.model.stuck(block, &positions);
            // What they had before an obstacle came so deep is taken away.
            let multiplier = |point: &ContactPoint| self.model.multipliers().get(point.number).copied();
            if stuck.is_some() && block.points.iter().filter_map(multiplier).any(|multiplier| multiplier > 0.0) {
                found.excess = f64::INFINITY;
            }
            if let Some((depth, name)) = stuck
                && found.stuck.as_ref().is_none_or(|(deepest, _)| depth > *deepest)
            {
                found.stuck = Some((depth, name.to_owned()));
            }
            stuck.is_none()
        });
        for (number, traction, distance) in touching.tractions(&self.model) {
            found.values[number] = traction;
            found.distance = found.distance.max(distance.abs());
            found.excess = found.excess.max(distance.abs() / tolerances[number]);
        }
        found
    }

    fn is_augmented(&self) -> bool {
        self.model.tolerances().iter().any(|tolerance| tolerance.is_finite())
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
        self.touching.blocks.len() + self.touching.averages.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        let Touching { blocks, averages } = &self.touching;
        blocks.get(block).map_or_else(|| averages[block - blocks.len()].nodes.as_slice(), |block| &block.nodes)
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
        let Touching { blocks, averages } = &self.touching;
        let Some(faces) = blocks.get(block) else {
            let gap = &averages[block - blocks.len()];
            out.energy += gap.energy();
            if with_tangent {
                let pairs =
                    gap.gradient.iter().enumerate().flat_map(|(a, g)| gap.gradient[..=a].iter().map(move |h| (g, h)));
                for (values, (of_row, of_column)) in out.tangent.iter_mut().zip(pairs) {
                    for (k, value) in values.iter_mut().enumerate() {
                        *value += gap.tangent_factor() * of_row[k % 3] * of_column[k / 3];
                    }
                }
            }
            return Ok(());
        };
        let result = evaluate_block(&self.model, faces, &self.positions, with_tangent);
        out.energy += result.energy;
        for (r, value) in out.residual.iter_mut().zip(result.residual.chunks_exact(3)) {
            for k in 0..3 {
                r[k] += value[k];
            }
        }
        if with_tangent {
            let n = faces.nodes.len();
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
