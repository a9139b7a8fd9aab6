//! Newton-Raphson at one load, and the load stepping around it (Fig. 3 of the paper, Steps 1–8).

use std::time::Instant;

use pneuflex_assembly::Request;
use pneuflex_factor::Parallelism;
use pneuflex_model::{MPA_PER_KPA, Problem, Solver};

use crate::history::{Cause, Event, Failure, IterationRecord, LandedState, PathReport, Timing};
use crate::system::{AssembleError, SetupError, System};

/// A correction this much larger than the body is no use.
const RUNAWAY: f64 = 1e3;

/// Corrections are shortened where they would drive walls deeper than this into each other, mm.
const DEEP: f64 = 0.2;

/// An equilibrium, the start of the next step.
#[derive(Clone, Debug)]
struct State {
    pressure_kpa: f64,
    displacement: Vec<[f64; 3]>,
    multipliers: Vec<f64>,
    contact_points: usize,
}

/// Follows equilibria of one problem from rest.
pub struct Path<'a> {
    system: System,
    settings: &'a Solver,
    observer: &'a mut dyn FnMut(Event<'_>),
    begin: Instant,
    state: State,
    /// The factor belongs to the present state's tangent, so it predicts the next one.
    has_factor: bool,
    /// Displacement per kPa at the beginning of the last accepted step, and that step's size, kPa.
    last_tangent: Option<(Vec<[f64; 3]>, f64)>,
    size: f64,
    step: usize,
    iterations: usize,
}

/// What [`Path::newton`] needs to know of an attempt that converged.
struct Converged {
    state: State,
    iterations: usize,
    /// Displacement per kPa at the beginning of the step.
    tangent: Vec<[f64; 3]>,
}

impl<'a> Path<'a> {
    /// Starts at rest.
    ///
    /// # Errors
    /// [`SetupError`] if the equations cannot be set up.
    pub fn new(
        problem: &Problem,
        settings: &'a Solver,
        observer: &'a mut dyn FnMut(Event<'_>),
    ) -> Result<Self, SetupError> {
        let begin = Instant::now();
        let system = System::new(problem, Parallelism::Threads)?;
        let n = problem.mesh.num_nodes();
        let size = (0..3)
            .map(|d| {
                let (low, high) = problem
                    .mesh
                    .nodes
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x[d]), b.max(x[d])));
                high - low
            })
            .fold(0.0, f64::max);
        let state = State {
            pressure_kpa: 0.0,
            displacement: vec![[0.0; 3]; n],
            multipliers: vec![0.0; 3 * n],
            contact_points: 0,
        };
        Ok(Self {
            system,
            settings,
            observer,
            begin,
            state,
            has_factor: false,
            last_tangent: None,
            size,
            step: 0,
            iterations: 0,
        })
    }

    /// Newton iterations so far, those of rejected attempts included.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Seconds spent so far.
    pub fn timing(&self) -> Timing {
        Timing { total_s: self.begin.elapsed().as_secs_f64(), ..self.system.timing }
    }

    /// Displacements of the present equilibrium, mm.
    pub fn displacement(&self) -> &[[f64; 3]] {
        &self.state.displacement
    }

    /// The system, e.g. for its energies.
    pub fn system(&mut self) -> &mut System {
        &mut self.system
    }

    /// Steps from the present equilibrium to `pressure_kpa` and lands on it exactly.
    ///
    /// # Errors
    /// [`Failure`] when the step falls below its least size; the present equilibrium is then the last one reached.
    pub fn advance_to(&mut self, pressure_kpa: f64) -> Result<LandedState, Failure> {
        let iterations_before = self.iterations;
        let mut load_steps = 0;
        let mut size = self.settings.first_step_kpa.max(self.settings.min_step_kpa);
        if self.state.pressure_kpa > 0.0 {
            size = self.settings.max_step_kpa;
        }
        while self.state.pressure_kpa < pressure_kpa {
            let start = self.state.pressure_kpa;
            let remaining = pressure_kpa - start;
            // A last step that would leave a crumb takes it along.
            let target = if remaining <= 1.01 * size { pressure_kpa } else { start + size };
            self.step += 1;
            (self.observer)(Event::StepStarted { step: self.step, pressure_kpa: target });
            match self.newton(target, None) {
                Ok(converged) => {
                    load_steps += 1;
                    if converged.iterations <= 8 {
                        size = (2.0 * (target - start)).min(self.settings.max_step_kpa);
                    }
                    self.last_tangent = Some((converged.tangent, target - start));
                    self.state = converged.state;
                }
                Err(cause) => {
                    (self.observer)(Event::StepRejected { step: self.step, pressure_kpa: target, cause: &cause });
                    self.has_factor = false;
                    size = 0.5 * (target - start);
                    if size < self.settings.min_step_kpa {
                        return Err(Failure { reached_kpa: start, attempted_kpa: target, cause });
                    }
                }
            }
        }
        Ok(self.land(self.iterations - iterations_before, load_steps))
    }

    /// One step to given displacements of the held degrees of freedom (mm, one entry per node) at the present pressure.
    ///
    /// # Errors
    /// The cause, if the step does not converge; there is no halving.
    pub fn impose(&mut self, held_displacement: &[[f64; 3]]) -> Result<LandedState, Cause> {
        let before = self.iterations;
        self.step += 1;
        let change: Vec<[f64; 3]> = held_displacement
            .iter()
            .zip(&self.state.displacement)
            .map(|(target, now)| std::array::from_fn(|k| target[k] - now[k]))
            .collect();
        self.has_factor = false;
        let converged = self.newton(self.state.pressure_kpa, Some(change))?;
        self.state = converged.state;
        Ok(self.land(self.iterations - before, 1))
    }

    fn land(&self, iterations: usize, load_steps: usize) -> LandedState {
        LandedState {
            pressure_kpa: self.state.pressure_kpa,
            displacement: self.state.displacement.as_flattened().to_vec(),
            reaction: self.state.multipliers.iter().map(|lambda| -lambda).collect(),
            iterations,
            load_steps,
            contact_points: self.state.contact_points,
        }
    }

    /// Newton's method at one pressure, from the present equilibrium.
    fn newton(&mut self, pressure_kpa: f64, mut imposed: Option<Vec<[f64; 3]>>) -> Result<Converged, Cause> {
        let pressure = pressure_kpa * MPA_PER_KPA;
        let mut u = self.state.displacement.clone();
        let mut multipliers = self.state.multipliers.clone();
        self.system.carry_pressures(&u);
        let load = self.system.load_norm(&u, pressure).max(f64::MIN_POSITIVE);

        let mut tangent = Vec::new();
        if self.has_factor && imposed.is_none() {
            // Tangent predictor with the factor of the present equilibrium.
            self.system.assemble(&u, pressure, Request::Residual).map_err(Cause::from)?;
            let correction = self.system.solve(None).map_err(Cause::from)?;
            tangent = scaled(&correction, 1.0 / (pressure_kpa - self.state.pressure_kpa));
            self.limited_correction(&mut u, &correction)?;
        }
        self.has_factor = false;

        let (mut least, mut most) = (usize::MAX, 0);
        let mut last = (f64::INFINITY, f64::INFINITY);
        for iteration in 1..=self.settings.max_iterations {
            self.iterations += 1;
            self.system.assemble(&u, pressure, Request::Tangent).map_err(Cause::from)?;
            let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
            let inertia = self.system.factorize().map_err(Cause::from)?;
            let correction = self.system.solve(imposed.take().as_deref()).map_err(Cause::from)?;
            if tangent.is_empty() {
                tangent = scaled(&correction, 1.0 / (pressure_kpa - self.state.pressure_kpa));
            }
            let updated = self.system.multipliers(&correction).map_err(Cause::from)?;
            let squared: f64 = correction.as_flattened().iter().map(|x| x * x).sum::<f64>()
                + updated.iter().zip(&multipliers).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            let norm = squared.sqrt();
            multipliers = updated;
            let touching = self.system.contact_points();
            let record = IterationRecord {
                step: self.step,
                iteration,
                pressure_kpa,
                correction: norm,
                residual,
                relative_residual: residual / load,
                contact_points: touching,
                negative_pivots: inertia.negative,
                elapsed_s: self.begin.elapsed().as_secs_f64(),
            };
            (self.observer)(Event::Iteration(&record));
            let largest = correction.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            if !norm.is_finite() || largest > RUNAWAY * self.size {
                return Err(Cause::Diverged { correction: norm });
            }
            last = (norm, residual);
            if iteration + 6 > self.settings.max_iterations {
                (least, most) = (least.min(touching), most.max(touching));
            }
            self.limited_correction(&mut u, &correction)?;

            if norm < self.settings.tolerance {
                self.system.assemble(&u, pressure, Request::Residual).map_err(Cause::from)?;
                let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
                if residual <= self.settings.residual_tolerance * load {
                    if inertia.negative > 0 {
                        return Err(Cause::IndefiniteTangent { negative_pivots: inertia.negative });
                    }
                    // Reactions of the final state, not of its linearisation.
                    for ((value, r), held) in
                        multipliers.iter_mut().zip(self.system.totals().residual.as_flattened()).zip(self.system.held())
                    {
                        *value = if *held { -r } else { 0.0 };
                    }
                    let contact_points = self.system.contact_points();
                    self.has_factor = true;
                    let state = State { pressure_kpa, displacement: u, multipliers, contact_points };
                    return Ok(Converged { state, iterations: iteration, tangent });
                }
            }
        }
        if most > least && last.0 < 1.0 {
            return Err(Cause::ContactChatter { least, most });
        }
        Err(Cause::TooManyIterations {
            iterations: self.settings.max_iterations,
            correction: last.0,
            residual: last.1,
            node: self.largest_residual_node(),
        })
    }

    /// Applies a correction, shortened if it would drive walls deep into each other.
    fn limited_correction(&mut self, u: &mut Vec<[f64; 3]>, correction: &[[f64; 3]]) -> Result<(), Cause> {
        let allowed = self.system.deepest_penetration(u).max(DEEP);
        let mut factor = 1.0;
        loop {
            let shortened = scaled(correction, factor);
            let mut trial = u.clone();
            self.system.warp(&mut trial, &shortened).map_err(Cause::from)?;
            if factor < 0.3 || self.system.deepest_penetration(&trial) <= allowed {
                self.system.carry(u, &shortened);
                *u = trial;
                return Ok(());
            }
            factor *= 0.7;
        }
    }

    fn largest_residual_node(&self) -> usize {
        let held = self.system.held();
        let size =
            |node: usize, r: &[f64; 3]| -> f64 { (0..3).filter(|k| !held[3 * node + k]).map(|k| r[k] * r[k]).sum() };
        let residual = &self.system.totals().residual;
        (0..residual.len()).max_by(|&a, &b| size(a, &residual[a]).total_cmp(&size(b, &residual[b]))).unwrap_or(0)
    }
}

fn scaled(field: &[[f64; 3]], factor: f64) -> Vec<[f64; 3]> {
    field.iter().map(|x| x.map(|t| factor * t)).collect()
}

impl From<AssembleError> for Cause {
    fn from(error: AssembleError) -> Self {
        match error {
            AssembleError::Local(local) => local.into(),
            AssembleError::Factor(factor) => factor.into(),
        }
    }
}

impl From<pneuflex_assembly::LocalError> for Cause {
    fn from(e: pneuflex_assembly::LocalError) -> Self {
        Self::Inversion { element: e.block, point: e.point, jacobian: e.jacobian }
    }
}

impl From<pneuflex_factor::FactorError> for Cause {
    fn from(error: pneuflex_factor::FactorError) -> Self {
        Self::SingularTangent(error.to_string())
    }
}

/// Follows the equilibrium path from rest through the given pressures (kPa, increasing), landing on each exactly.
///
/// # Errors
/// [`Failure`] when the load step falls below its least size, with what the run had cost; the observer has seen every
/// state landed on before.
pub fn follow_path(
    problem: &Problem,
    pressures_kpa: &[f64],
    settings: &Solver,
    observer: &mut dyn FnMut(Event<'_>),
) -> Result<PathReport, (Failure, PathReport)> {
    let mut path = match Path::new(problem, settings, observer) {
        Ok(path) => path,
        Err(error) => {
            let cause = Cause::SingularTangent(error.to_string());
            let failure =
                Failure { reached_kpa: 0.0, attempted_kpa: pressures_kpa.first().copied().unwrap_or(0.0), cause };
            return Err((failure, PathReport { iterations: 0, timing: Timing::default() }));
        }
    };
    for &pressure in pressures_kpa {
        match path.advance_to(pressure) {
            Ok(landed) => (path.observer)(Event::Landed(&landed)),
            Err(failure) => {
                return Err((failure, PathReport { iterations: path.iterations, timing: path.timing() }));
            }
        }
    }
    Ok(PathReport { iterations: path.iterations, timing: path.timing() })
}
