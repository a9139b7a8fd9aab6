//! Everything together: the potential, its derivatives, and load paths by plain Newton steps (theory §6, Fig. 3).

use nalgebra::{DMatrix, DVector};
use pneuflex_model::{MPA_PER_KPA, Problem};

use crate::contact::ContactModel;
use crate::error::ReferenceError;
use crate::kkt::KktSystem;
use crate::pressure::{self, AirModel};
use crate::solid::SolidModel;

/// The reference solver of one problem.
#[derive(Clone, Debug)]
pub struct ReferenceSolver {
    solid: SolidModel,
    air: AirModel,
    contact: ContactModel,
    held: Vec<usize>,
}

/// What a state on a path is loaded with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Load {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// Displacements of held degrees of freedom, mm: three per node, those of free ones are ignored; empty for all zero.
    pub prescribed: Vec<f64>,
}

/// When Newton's method has converged and when it gives up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// ‖\[Δq; Δλ\]‖ (mm, N) below this ends the iteration.
    pub tolerance: f64,
    /// Iterations after which a load step is halved.
    pub max_iterations: usize,
    /// Largest pressure step, kPa.
    pub max_step_kpa: f64,
    /// A step smaller than this fraction of the way from one requested load to the next is not tried.
    pub min_fraction: f64,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_iterations: 20, max_step_kpa: 10.0, min_fraction: 0.002 }
    }
}

/// An equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceState {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// Displacements, mm, three per node.
    pub displacement: Vec<f64>,
    /// Multipliers λ, N, three per node, zero where nothing is held: R(q) + Φᵀλ = 0, so λ is the force of the body on
    /// its support. See [`Self::reaction`] for the opposite.
    pub multiplier: Vec<f64>,
    /// Element pressures p (mean normal stress, positive in tension), MPa, see [`SolidModel::pressures`].
    pub element_pressure: Vec<f64>,
    /// ‖\[Δq; Δλ\]‖ of the iterations since the previous requested load, failed attempts included.
    pub corrections: Vec<f64>,
}

impl ReferenceState {
    /// Newton iterations since the previous requested load, failed attempts included.
    pub fn iterations(&self) -> usize {
        self.corrections.len()
    }

    /// Forces of the supports on the body, N, three per node: −λ.
    pub fn reaction(&self) -> Vec<f64> {
        self.multiplier.iter().map(|lambda| -lambda).collect()
    }

    /// Sum over all nodes of [`Self::reaction`], N: x, y, z.
    pub fn reaction_resultant(&self) -> [f64; 3] {
        std::array::from_fn(|axis| -self.multiplier.iter().skip(axis).step_by(3).sum::<f64>())
    }
}

/// Unknowns of the Newton iteration.
#[derive(Clone, Debug)]
struct Unknowns {
    u: Vec<f64>,
    p: Vec<f64>,
    lambda: Vec<f64>,
}

impl ReferenceSolver {
    /// Prepares all contributions.
    ///
    /// # Errors
    /// See [`SolidModel::new`], [`AirModel::new`], [`ContactModel::new`].
    pub fn new(problem: &Problem) -> Result<Self, ReferenceError> {
        Self::with_volume_weights(problem, pressure::CLOSED)
    }

    /// The same for a loaded surface cut by a plane that does not go through the origin, see [`pressure`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_volume_weights(problem: &Problem, axes: [f64; 3]) -> Result<Self, ReferenceError> {
        let held = problem.held_dofs().iter().enumerate().filter(|(_, held)| **held).map(|(dof, _)| dof).collect();
        Ok(Self {
            solid: SolidModel::new(problem)?,
            air: AirModel::new(problem, axes)?,
            contact: ContactModel::new(problem)?,
            held,
        })
    }

    /// The solid's contribution.
    pub fn solid(&self) -> &SolidModel {
        &self.solid
    }

    /// The air's contribution.
    pub fn air(&self) -> &AirModel {
        &self.air
    }

    /// The contribution of contact.
    pub fn contact(&self) -> &ContactModel {
        &self.contact
    }

    /// Held degrees of freedom (3 · node + axis) in ascending order: the rows of Φ.
    pub fn held(&self) -> &[usize] {
        &self.held
    }

    /// The whole primal potential at displacements `u` and air pressure `p` in MPa, N·mm.
    pub fn energy(&self, u: &[f64], p: f64) -> f64 {
        self.solid.energy(u) + self.air.energy(u, p) + self.contact.energy(u)
    }

    /// R = ∂energy/∂u = Q_k − Q_p − Q_c, N.
    pub fn gradient(&self, u: &[f64], p: f64) -> DVector<f64> {
        self.solid.gradient(u) + self.air.gradient(u, p) + self.contact.gradient(u)
    }

    /// K = ∂R/∂u, N/mm.
    pub fn hessian(&self, u: &[f64], p: f64) -> DMatrix<f64> {
        self.solid.hessian(u) + self.air.hessian(u, p) + self.contact.hessian(u)
    }

    /// The Newton system at displacements `u`, element pressures `element_pressure` (MPa) and multipliers λ in the order
    /// of [`Self::held`].
    ///
    /// # Errors
    /// A list, or the load's prescribed displacements, of the wrong length.
    pub fn kkt_system(
        &self,
        u: &[f64],
        element_pressure: &[f64],
        lambda: &[f64],
        load: &Load,
    ) -> Result<KktSystem, ReferenceError> {
        let n = self.solid.num_dofs();
        check("the displacement vector", u, n)?;
        check("the vector of element pressures", element_pressure, self.solid.num_pressures())?;
        check("the vector of multipliers", lambda, self.held.len())?;
        let prescribed = self.prescribed(load)?;

        let p = load.pressure_kpa * MPA_PER_KPA;
        let mut gradient = self.solid.saddle_gradient(u, element_pressure);
        let mut forces = gradient.rows_mut(0, n);
        forces += self.air.gradient(u, p) + self.contact.gradient(u);
        let mut hessian = self.solid.saddle_hessian(u, element_pressure);
        let mut stiffness = hessian.view_mut((0, 0), (n, n));
        stiffness += self.air.hessian(u, p) + self.contact.hessian(u);
        let defect: Vec<f64> = self.held.iter().zip(&prescribed).map(|(&dof, value)| u[dof] - value).collect();
        Ok(KktSystem::new(&hessian, &gradient, &self.held, &defect, lambda))
    }

    /// Equilibria at increasing pressures, from rest, with nothing moved by its supports.
    ///
    /// # Errors
    /// See [`Self::follow`].
    pub fn follow_path(
        &self,
        pressures_kpa: &[f64],
        options: &PathOptions,
    ) -> Result<Vec<ReferenceState>, ReferenceError> {
        let load = |&pressure_kpa: &f64| Load { pressure_kpa, prescribed: Vec::new() };
        self.follow(&pressures_kpa.iter().map(load).collect::<Vec<_>>(), options)
    }

    /// Equilibria at the given loads in turn, from rest.
    ///
    /// The way to every load is divided into equal steps, which are halved after a failure and stay so up to that load.
    ///
    /// # Errors
    /// Prescribed displacements of the wrong length, or no convergence.
    pub fn follow(&self, loads: &[Load], options: &PathOptions) -> Result<Vec<ReferenceState>, ReferenceError> {
        let mut unknowns = Unknowns {
            u: vec![0.0; self.solid.num_dofs()],
            p: vec![0.0; self.solid.num_pressures()],
            lambda: vec![0.0; self.held.len()],
        };
        let mut start = Load::default();
        let mut states = Vec::new();
        for target in loads {
            let mut corrections = Vec::new();
            // Fractions of the way from `start` to `target`.
            let way = (target.pressure_kpa - start.pressure_kpa).abs();
            let (mut done, mut stride) = (0.0, 1.0 / (way / options.max_step_kpa).ceil().max(1.0));
            while done < 1.0 {
                let next: f64 = done + stride;
                let next = if next > 1.0 - 1e-9 { 1.0 } else { next };
                let load = self.between(&start, target, next)?;
                match self.newton(unknowns.clone(), &load, options, &mut corrections)? {
                    Ok(converged) => (unknowns, done) = (converged, next),
                    Err(cause) => {
                        stride /= 2.0;
                        if stride < options.min_fraction {
                            let from_kpa = self.between(&start, target, done)?.pressure_kpa;
                            return Err(ReferenceError::NotConverged { from_kpa, to_kpa: load.pressure_kpa, cause });
                        }
                    }
                }
            }
            states.push(self.state(&unknowns, target.pressure_kpa, corrections));
            start = target.clone();
        }
        Ok(states)
    }

    /// One equilibrium by plain Newton steps; the inner error says why there is none.
    fn newton(
        &self,
        mut unknowns: Unknowns,
        load: &Load,
        options: &PathOptions,
        corrections: &mut Vec<f64>,
    ) -> Result<Result<Unknowns, String>, ReferenceError> {
        let (n, m) = (unknowns.u.len(), unknowns.p.len());
        for _ in 0..options.max_iterations {
            let system = self.kkt_system(&unknowns.u, &unknowns.p, &unknowns.lambda, load)?;
            let Some(step) = system.solve() else {
                return Ok(Err("the Newton system is singular or not finite".into()));
            };
            add(&mut unknowns.u, &step.as_slice()[..n]);
            add(&mut unknowns.p, &step.as_slice()[n..n + m]);
            add(&mut unknowns.lambda, &step.as_slice()[n + m..]);
            // ‖[Δq; Δλ]‖: the paper has no pressures among its unknowns.
            let correction = step.rows(0, n).norm().hypot(step.rows(n + m, unknowns.lambda.len()).norm());
            corrections.push(correction);
            if correction < options.tolerance {
                let smallest = self.solid.smallest_jacobian(&unknowns.u);
                return Ok(if smallest > 0.0 {
                    Ok(unknowns)
                } else {
                    Err(format!("an element has J = {smallest:.3e}"))
                });
            }
        }
        Ok(Err(format!("{} Newton iterations were not enough", options.max_iterations)))
    }

    fn between(&self, start: &Load, target: &Load, fraction: f64) -> Result<Load, ReferenceError> {
        let blend = |a: f64, b: f64| if fraction < 1.0 { a + fraction * (b - a) } else { b };
        let mut prescribed = vec![0.0; self.solid.num_dofs()];
        let ends = self.prescribed(start)?.into_iter().zip(self.prescribed(target)?);
        for (&dof, (a, b)) in self.held.iter().zip(ends) {
            prescribed[dof] = blend(a, b);
        }
        Ok(Load { pressure_kpa: blend(start.pressure_kpa, target.pressure_kpa), prescribed })
    }

    /// Prescribed displacements of the held degrees of freedom, in their order.
    fn prescribed(&self, load: &Load) -> Result<Vec<f64>, ReferenceError> {
        if load.prescribed.is_empty() {
            return Ok(vec![0.0; self.held.len()]);
        }
        check("the vector of prescribed displacements", &load.prescribed, self.solid.num_dofs())?;
        Ok(self.held.iter().map(|&dof| load.prescribed[dof]).collect())
    }

    fn state(&self, unknowns: &Unknowns, pressure_kpa: f64, corrections: Vec<f64>) -> ReferenceState {
        let mut multiplier = vec![0.0; self.solid.num_dofs()];
        for (&dof, &lambda) in self.held.iter().zip(&unknowns.lambda) {
            multiplier[dof] = lambda;
        }
        ReferenceState {
            pressure_kpa,
            displacement: unknowns.u.clone(),
            multiplier,
            element_pressure: unknowns.p.clone(),
            corrections,
        }
    }
}

fn add(x: &mut [f64], step: &[f64]) {
    x.iter_mut().zip(step).for_each(|(x, dx)| *x += dx);
}

fn check(what: &'static str, list: &[f64], expected: usize) -> Result<(), ReferenceError> {
    if list.len() == expected { Ok(()) } else { Err(ReferenceError::WrongLength { what, found: list.len(), expected }) }
}
