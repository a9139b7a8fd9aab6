//! How the sums over the contributions are formed: their positions, blocks and equations, condensed where linear equations are eliminated.

use std::sync::Arc;
use std::time::Instant;

use pneuflex_assembly::{Assembler, BorderedEquation, CondensedBlocks, Contribution, Couplings, Elimination};
use pneuflex_assembly::{LocalContribution, LocalError, Position, Request, Totals, Unilateral};
use pneuflex_factor::{FactorError, Ordering, Symbolic};

use pneuflex_model::LoadParameter;

use super::System;
use crate::state::State;
use crate::tangent_solver::Assembled;
use crate::timing::Timing;

impl System {
    /// The contributions take a position; contact takes it with the obstacles at `obstacles` on the load path.
    pub(super) fn take_position(&mut self, position: Position<'_>, obstacles: LoadParameter) {
        let mut bordered = position.bordered;
        for contribution in &mut self.contributions {
            let start = Instant::now();
            let own = split(&mut bordered, contribution.as_ref());
            let parameter = if contribution.unilateral().is_some() { obstacles } else { position.parameter };
            contribution.set_position(Position { bordered: own, parameter, ..position });
            *clock_of(&mut self.timing, contribution.as_ref()) += start.elapsed().as_secs_f64();
        }
    }

    /// Extends the tangent's pattern where contact has come to pairs of faces that it has no room for.
    pub(super) fn make_room_for_contact(&mut self) -> Result<(), FactorError> {
        let start = Instant::now();
        let changing = || self.contributions.iter().filter(|c| c.unilateral().is_some()).filter_map(|c| c.blocks());
        let is_covered =
            changing().all(|blocks| self.assembler.covers(&CondensedBlocks::new(blocks, &self.elimination)));
        if is_covered {
            self.timing.contact_s += start.elapsed().as_secs_f64();
            return Ok(());
        }
        let mut near: Vec<Vec<u32>> = unilateral(&self.contributions).flat_map(Unilateral::near_nodes).collect();
        for group in &mut near {
            if let Some(more) = self.elimination.with_masters(group) {
                *group = more;
            }
        }
        let nodes = self.assembler.pattern().num_nodes();
        self.assembler = assembler_of(nodes, &self.contributions, &self.elimination, &near);
        self.timing.contact_s += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.symbolic = Arc::new(Symbolic::analyze(self.assembler.pattern(), Ordering::default())?);
        self.timing.factor_s += start.elapsed().as_secs_f64();
        Ok(())
    }

    pub(super) fn assemble(&mut self, state: &State, request: Request) -> Result<Assembled, LocalError> {
        let Self { contributions, assembler, totals, timing, elimination, .. } = self;
        let u = &state.displacement;
        assembler.reset(totals, request);
        let mut equations: Vec<BorderedEquation> = Vec::new();
        let (mut index, mut contact_points) = (0, 0);
        for contribution in contributions.iter() {
            let start = Instant::now();
            if let Some(blocks) = contribution.blocks() {
                let blocks = CondensedBlocks::new(blocks, elimination);
                if has_fixed_blocks(contribution.as_ref()) {
                    assembler.add(index, &blocks, u, request, totals)?;
                    index += 1;
                } else {
                    assembler.add_changing(&blocks, u, request, totals)?;
                }
            }
            contribution.add_forces(&mut totals.residual);
            equations.extend(contribution.bordered_equations(u));
            contact_points += contribution.unilateral().map_or(0, Unilateral::num_active);
            *clock_of(timing, contribution.as_ref()) += start.elapsed().as_secs_f64();
        }
        elimination.condense(totals.residual.as_flattened_mut());
        equations.iter_mut().for_each(|equation| elimination.condense(equation.column.as_flattened_mut()));
        Ok(Assembled { energy: totals.energy, residual: totals.residual.clone(), equations, contact_points })
    }

    /// Residual and equations of some of the contributions at a state, which they take. None of them may be contact.
    pub(super) fn forces_of(
        &mut self,
        state: &State,
        counts: impl Fn(&dyn Contribution) -> bool,
    ) -> Result<Assembled, LocalError> {
        let mut totals = Totals::default();
        self.assembler.reset(&mut totals, Request::Residual);
        let mut equations = Vec::new();
        let mut index = 0;
        let mut bordered = &state.bordered[..];
        for contribution in &mut self.contributions {
            let own = split(&mut bordered, contribution.as_ref());
            if counts(contribution.as_ref()) {
                contribution.set_position(Position { bordered: own, ..state.position() });
                if let Some(blocks) = contribution.blocks() {
                    let blocks = CondensedBlocks::new(blocks, &self.elimination);
                    self.assembler.add(index, &blocks, &state.displacement, Request::Residual, &mut totals)?;
                }
                contribution.add_forces(&mut totals.residual);
                equations.extend(contribution.bordered_equations(&state.displacement));
            }
            index += usize::from(has_fixed_blocks(contribution.as_ref()));
        }
        self.elimination.condense(totals.residual.as_flattened_mut());
        equations.iter_mut().for_each(|equation| self.elimination.condense(equation.column.as_flattened_mut()));
        Ok(Assembled { residual: totals.residual, equations, ..Assembled::default() })
    }

    /// The tangent's unsymmetric part between free degrees of freedom.
    pub(super) fn couplings(&self, displacement: &[[f64; 3]]) -> Couplings {
        let mut couplings = Couplings::default();
        for contribution in &self.contributions {
            contribution.add_couplings(displacement, &mut couplings);
        }
        couplings.condensed(&self.held)
    }
}

/// This contribution's own of the unknowns beside the displacements.
pub(super) fn split<'a>(bordered: &mut &'a [f64], contribution: &dyn Contribution) -> &'a [f64] {
    let (own, rest) = bordered.split_at(contribution.num_bordered().min(bordered.len()));
    *bordered = rest;
    own
}

/// Whether its blocks have the same nodes at every position.
pub(super) fn has_fixed_blocks(contribution: &dyn Contribution) -> bool {
    contribution.unilateral().is_none() && contribution.blocks().is_some()
}

/// The way into the matrix for what does not change its nodes from assembly to assembly, with room for further groups of nodes.
pub(super) fn assembler_of(
    num_nodes: usize,
    contributions: &[Box<dyn Contribution>],
    elimination: &Elimination,
    near: &[Vec<u32>],
) -> Assembler {
    let fixed = contributions.iter().filter(|contribution| has_fixed_blocks(contribution.as_ref()));
    let blocks = fixed.filter_map(|contribution| contribution.blocks());
    let blocks: Vec<_> = blocks.map(|blocks| CondensedBlocks::new(blocks, elimination)).collect();
    let blocks: Vec<&dyn LocalContribution> = blocks.iter().map(|blocks| blocks as _).collect();
    Assembler::new(num_nodes, &blocks, near)
}

pub(crate) fn unilateral(contributions: &[Box<dyn Contribution>]) -> impl Iterator<Item = &dyn Unilateral> {
    contributions.iter().filter_map(|contribution| contribution.unilateral())
}

fn clock_of<'a>(timing: &'a mut Timing, contribution: &dyn Contribution) -> &'a mut f64 {
    if contribution.unilateral().is_some() { &mut timing.contact_s } else { &mut timing.assembly_s }
}
