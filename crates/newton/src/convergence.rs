//! When a state counts as an equilibrium.

use pneuflex_assembly::LocalError;
use pneuflex_mesh::Mesh;
use pneuflex_model::{Material, Problem, Solver};

use crate::bordered;
use crate::globalisation::Measures;
use crate::state::State;
use crate::system::System;
use crate::tangent_solver::Assembled;
use crate::tuning::Tuning;

/// Residuals below this share of [`Scales::force`] are rounding: it bounds the relative tolerance from below where the load is tiny.
const RESIDUAL_FLOOR: f64 = 1e-9;

/// Rounding is accepted in the residual up to this multiple of the tolerance asked for.
const MOST_ROUNDING: f64 = 10.0;

/// Unknowns up to which the tolerance of the correction's norm can be met whatever the rounding. Beyond, rounding makes the norm
/// grow with the root of their number.
const FEW_UNKNOWNS: f64 = 1e4;

/// What is known of the body before anything is solved. What the solver calls small or large is measured by it, so that nothing depends on
/// the unit of length or force.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Largest extent of the body, mm.
    pub size: f64,
    /// Mean spacing h of the nodes, mm.
    pub length: f64,
    /// Force on a square with this side under a stress of the shear modulus μ, N: μ h², with the stiffest material's.
    pub force: f64,
    /// Residual that rounding leaves per mm of the body's extent, N/mm.
    pub(crate) rounding_per_mm: f64,
    /// Stretching by a correction after which the state is good enough to go on from.
    pub inexact_stretch: f64,
}

impl Scales {
    /// Those of a problem.
    pub fn of(problem: &Problem, tuning: &Tuning) -> Self {
        let materials = problem.materials().0;
        let bulk_modulus = materials.iter().map(|material| material.bulk_modulus).fold(0.0, f64::max);
        let shear_modulus = materials.iter().map(|material| material.shear_modulus()).fold(0.0, f64::max);
        let (nodes, length) = (problem.mesh.num_nodes() as f64, problem.mesh.mean_node_spacing());
        Self {
            size: problem.mesh.extent(),
            length,
            force: shear_modulus * length * length,
            rounding_per_mm: f64::EPSILON * bulk_modulus * problem.mesh.mean_element_size() * nodes.sqrt(),
            inexact_stretch: inexact_stretch(&materials, tuning),
        }
    }

    /// The same for a body that is stretched as far as at a displacement. Where an edge is σ times as long as at rest, faces may be σ² times
    /// as large, and a layer that keeps its volume σ² times as thin: the same rounding of positions makes σ⁴ times the force.
    pub(crate) fn stretched(self, mesh: &Mesh, displacement: &[[f64; 3]]) -> Self {
        let length = |[a, b]: [usize; 2], displacement: &[[f64; 3]]| {
            let at = |node: usize, k: usize| mesh.nodes[node][k] + displacement[node][k];
            (0..3).map(|k| (at(a, k) - at(b, k)).powi(2)).sum::<f64>()
        };
        let rest = vec![[0.0; 3]; displacement.len()];
        let squared = (0..mesh.num_elements()).flat_map(|element| mesh.element(element).windows(2)).map(|pair| {
            let ends = [pair[0] as usize, pair[1] as usize];
            length(ends, displacement) / length(ends, &rest)
        });
        let most = squared.filter(|ratio| ratio.is_finite()).fold(1.0, f64::max);
        Self { rounding_per_mm: self.rounding_per_mm * most * most, ..self }
    }

    #[cfg(test)]
    pub(crate) fn of_unit_cube() -> Self {
        Self { size: 1.0, length: 1.0, force: 1.0, rounding_per_mm: 0.0, inexact_stretch: 0.05 }
    }

    /// Residual that nothing is small against, N.
    pub fn negligible_force(&self) -> f64 {
        RESIDUAL_FLOOR * self.force
    }

    /// Residual norm that rounding leaves, N: positions x are known to ε|x|, their gradients to ε|x|/h with the element size h,
    /// pressures to κ ε|x|/h, and forces on an element to κ ε|x| h; over n nodes that adds up to √n times as much.
    fn rounding(&self, displacement: &[[f64; 3]]) -> f64 {
        let largest = displacement.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        self.rounding_per_mm * (self.size + largest)
    }
}

fn inexact_stretch(materials: &[&Material], tuning: &Tuning) -> f64 {
    let least = tuning.inexact_modulus_ratio;
    let ratio = materials.iter().map(|m| m.bulk_modulus / m.shear_modulus()).fold(least, f64::max);
    tuning.inexact_stretch * least / ratio
}

/// The tolerances of one attempt.
#[derive(Clone, Copy, Debug)]
pub struct Criteria {
    /// Norm of the loads at the guess, N.
    pub load: f64,
    /// Residual that rounding leaves, N.
    rounding: f64,
    tolerance: f64,
    /// What a correction cannot fall below once the residual is rounding.
    rounded_tolerance: f64,
    residual_tolerance: f64,
    /// Residual that nothing is small against, N.
    floor: f64,
    /// Whether supports, obstacles or cavities drive the body: what the loads were at the guess says little then.
    is_driven: bool,
}

impl Criteria {
    /// The tolerances for an attempt that starts at a state.
    ///
    /// # Errors
    /// [`LocalError`] of a load that cannot be evaluated.
    pub fn new(
        system: &mut System,
        settings: &Solver,
        scales: &Scales,
        start: &State,
        has_motion: bool,
    ) -> Result<Self, LocalError> {
        let load = system.load_norm(start)?.max(f64::MIN_POSITIVE);
        let unknowns = system.held().iter().filter(|held| !**held).count() as f64;
        Ok(Self {
            load,
            rounding: scales.rounding(&start.displacement).min(MOST_ROUNDING * settings.residual_tolerance * load),
            tolerance: settings.tolerance,
            rounded_tolerance: settings.tolerance * (unknowns / FEW_UNKNOWNS).sqrt().max(1.0),
            residual_tolerance: settings.residual_tolerance,
            floor: scales.negligible_force(),
            is_driven: has_motion || !start.bordered.is_empty(),
        })
    }

    /// Whether there are loads at all; otherwise supports alone drive the body.
    pub fn has_load(&self) -> bool {
        self.load > f64::MIN_POSITIVE
    }

    /// What residuals are compared with where the supports' forces have a norm (N).
    pub fn scale(&self, supports: f64) -> f64 {
        let driven = if self.is_driven { supports } else { 0.0 };
        self.load.max(driven).max(self.floor)
    }

    /// Residual that an equilibrium may have where the supports' forces have a norm (N).
    pub fn allowed(&self, supports: f64) -> f64 {
        (self.residual_tolerance * self.scale(supports)).max(self.rounding).max(self.floor)
    }

    /// Whether a correction is small enough for the residual after it to be worth a look.
    pub fn may_be_met(&self, last: &Measures) -> bool {
        last.norm < self.tolerance || (last.residual <= self.rounding && last.norm < self.rounded_tolerance)
    }

    /// Whether what was assembled at a state is small enough.
    ///
    /// # Errors
    /// [`LocalError`] of a load that cannot be evaluated.
    pub fn are_met(&self, system: &mut System, state: &State, assembled: &Assembled) -> Result<bool, LocalError> {
        if bordered::violation(&assembled.equations) > self.residual_tolerance {
            return Ok(false);
        }
        let driven =
            if self.is_driven { system.load_norm(state)?.max(system.held_norm(&assembled.residual)) } else { 0.0 };
        let tolerance = self.residual_tolerance * self.load.max(driven);
        Ok(system.free_norm(&assembled.residual) <= tolerance.max(self.rounding).max(self.floor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Springs, cube};

    #[test]
    fn a_state_is_an_equilibrium_when_residual_and_constraint_are_small() {
        let mesh = cube();
        let settings = Solver::default();
        let mut system = Springs::new(&mesh, 4.0).system(&mesh);
        let mut state = State::at_rest(8, 0).moved_to(2.0.into());
        let criteria = Criteria::new(&mut system, &settings, &Scales::of_unit_cube(), &state, false).unwrap();
        // 2 N along x at seven free nodes.
        assert!((criteria.load - 28.0_f64.sqrt()).abs() < 1e-12, "{}", criteria.load);
        let assembled = system.residual(&state).unwrap();
        assert!(!criteria.are_met(&mut system, &state, &assembled).unwrap());
        state.displacement[1..].fill([0.5, 0.0, 0.0]);
        let assembled = system.residual(&state).unwrap();
        assert!(criteria.are_met(&mut system, &state, &assembled).unwrap());

        // Without its multiplier a constraint leaves forces; with it and the wrong sum it is violated.
        let mut system = Springs::new(&mesh, 4.0).constrained().system(&mesh);
        let mut state = State::new(1.4, vec![[0.2, 0.0, 0.0]; 8], vec![-0.8]);
        state.displacement[0] = [0.0; 3];
        let criteria = Criteria::new(&mut system, &settings, &Scales::of_unit_cube(), &state, false).unwrap();
        let assembled = system.residual(&state).unwrap();
        assert!(criteria.are_met(&mut system, &state, &assembled).unwrap());
        let elsewhere = state.moved_to(1.5.into());
        let assembled = system.residual(&elsewhere).unwrap();
        assert!(!criteria.are_met(&mut system, &elsewhere, &assembled).unwrap());
    }

    #[test]
    fn a_correction_that_is_no_number_is_never_small() {
        let mesh = cube();
        let mut system = Springs::new(&mesh, 4.0).system(&mesh);
        let state = State::at_rest(8, 0).moved_to(2.0.into());
        let criteria = Criteria::new(&mut system, &Solver::default(), &Scales::of_unit_cube(), &state, false).unwrap();
        for norm in [f64::NAN, f64::INFINITY, 1.0] {
            assert!(!criteria.may_be_met(&Measures { norm, ..Measures::default() }), "{norm}");
        }
        assert!(criteria.may_be_met(&Measures::default()));
    }
}
