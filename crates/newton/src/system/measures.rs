//! What a state is measured by: norms of forces, the path's rate, energies.

use pneuflex_assembly::{Contribution, Couplings, LocalError, Request, RigidMotion, Totals};
use pneuflex_factor::FactorError;

use super::System;
use crate::error::AssembleError;
use crate::state::{Correction, State, difference};
use crate::tangent_solver::Tangent;

impl System {
    /// Norm of the loads on the free degrees of freedom at a state, N: the scale of the residual.
    ///
    /// # Errors
    /// [`LocalError`] of a load that cannot be evaluated.
    pub fn load_norm(&mut self, state: &State) -> Result<f64, LocalError> {
        let loads = self.forces_of(state, |contribution| contribution.is_load())?;
        Ok(self.free_norm(&loads.residual))
    }

    /// The change of all unknowns per change of the load parameter, K⁻¹ of the change of everything that it drives: loads, equations, supports
    /// (`held` are the changes of their displacements, mm, one entry per node) and obstacles. `change` is the change of the parameter that it is
    /// taken over; between the corners of their curves all these are linear in it. Contact stays at the position it took last.
    ///
    /// # Errors
    /// As [`Self::solve`], or a load that cannot be evaluated.
    pub fn rate(
        &mut self,
        tangent: &Tangent,
        state: &State,
        change: f64,
        held: Option<&[[f64; 3]]>,
    ) -> Result<Correction, AssembleError> {
        let is_driven = |contribution: &dyn Contribution| contribution.is_load() || contribution.num_bordered() > 0;
        let next = state.parameter + change;
        let mut ahead = self.forces_of(&state.moved_to(next), is_driven)?;
        // The contributions are back where they were.
        let here = self.forces_of(state, is_driven)?;
        ahead.residual = difference(&ahead.residual, &here.residual);
        ahead.equations.iter_mut().zip(&here.equations).for_each(|(equation, here)| equation.value -= here.value);
        for RigidMotion { curve, column } in tangent.motions() {
            let moved = curve.at(next) - curve.at(state.parameter);
            for (r, c) in ahead.residual.iter_mut().zip(column) {
                *r = std::array::from_fn(|k| r[k] + moved * c[k]);
            }
        }
        Ok(self.solve(tangent, &ahead, held)?.scaled(1.0 / change))
    }

    /// Kᵀ times a nodal field at a displacement, over all degrees of freedom. What follows others counts by those.
    ///
    /// Of the unsymmetric part a tangent keeps what couples free degrees of freedom; here it is all of it, as a force on a held one depends on
    /// the free ones beside it.
    ///
    /// # Errors
    /// If the tangent is that of another problem.
    pub(crate) fn transposed_product(
        &self,
        tangent: &Tangent,
        displacement: &[[f64; 3]],
        field: &[[f64; 3]],
    ) -> Result<Vec<[f64; 3]>, FactorError> {
        let mut product = tangent.symmetric_product(field.as_flattened())?;
        let mut couplings = Couplings::default();
        for contribution in &self.contributions {
            contribution.add_couplings(displacement, &mut couplings);
        }
        let mut expanded = field.to_vec();
        self.elimination.expand(&mut expanded);
        let mut unsymmetric = vec![0.0; product.len()];
        couplings.transposed().add_product(expanded.as_flattened(), &mut unsymmetric);
        self.elimination.condense(&mut unsymmetric);
        product.iter_mut().zip(unsymmetric).for_each(|(force, more)| *force += more);
        Ok(product.as_chunks().0.to_vec())
    }

    /// Norm of a nodal field over the free degrees of freedom.
    pub fn free_norm(&self, field: &[[f64; 3]]) -> f64 {
        norm_where(field, &self.held, false)
    }

    /// Norm of a nodal field over the held degrees of freedom.
    pub fn held_norm(&self, field: &[[f64; 3]]) -> f64 {
        norm_where(field, &self.held, true)
    }

    /// A nodal field, zero at held degrees of freedom.
    pub fn free_part(&self, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut free = field.to_vec();
        let pairs = free.as_flattened_mut().iter_mut().zip(&self.held[..]);
        pairs.for_each(|(x, held)| *x = if *held { 0.0 } else { *x });
        free
    }

    /// Energy of every contribution at a state, mJ, by its name.
    ///
    /// # Errors
    /// [`LocalError`] naming the element that is turned inside out.
    pub fn energies(&mut self, state: &State) -> Result<Vec<(&'static str, f64)>, LocalError> {
        self.take_position(state.position(), state.parameter);
        let mut energies = Vec::new();
        for contribution in &self.contributions {
            let mut totals = Totals::default();
            self.assembler.reset(&mut totals, Request::Energy);
            if let Some(blocks) = contribution.blocks() {
                self.assembler.add_changing(blocks, &state.displacement, Request::Energy, &mut totals)?;
            }
            energies.push((contribution.name(), totals.energy));
        }
        Ok(energies)
    }
}

fn norm_where(field: &[[f64; 3]], held: &[bool], is_held: bool) -> f64 {
    let entries = field.as_flattened().iter().zip(held).filter(|(_, held)| **held == is_held);
    entries.map(|(x, _)| x * x).sum::<f64>().sqrt()
}
