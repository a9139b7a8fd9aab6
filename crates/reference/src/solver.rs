//! Everything together: the potential, its derivatives, and load paths by plain Newton steps (theory §6, Fig. 3).

use nalgebra::{DMatrix, DVector};
use pneuflex_model::load::Load;
use pneuflex_model::{Curve, LinearEquation, LoadParameter, Motion, Problem, Support};

use crate::cavity::CavityModel;
use crate::conservative_load::ConservativeLoads;
use crate::contact::ContactModel;
use crate::error::{ReferenceError, Unmodelled};
use crate::follower_pressure::FollowerPressure;
use crate::kkt::{Constraint, KktSystem};
use crate::obstacle::ObstacleModel;
use crate::pressure;
use crate::solid::SolidModel;

/// The reference solver of one problem.
#[derive(Clone, Debug)]
pub struct ReferenceSolver {
    solid: SolidModel,
    cavities: Vec<CavityModel>,
    // On faces that are no cavity's, with the pressure in MPa.
    pressures: Vec<(FollowerPressure, Curve)>,
    loads: ConservativeLoads,
    contact: ContactModel,
    obstacles: Vec<ObstacleModel>,
    supports: Vec<Support>,
    held: Vec<usize>,
    equations: Vec<LinearEquation>,
}

/// When Newton's method has converged and when it gives up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// ‖\[Δq; Δλ\]‖ (mm, N) below this ends the iteration.
    pub tolerance: f64,
    /// Iterations after which a load step is halved.
    pub max_iterations: usize,
    /// Largest step of the load parameter.
    pub max_step: f64,
    /// A step smaller than this fraction of the way from one requested position to the next is not tried.
    pub min_fraction: f64,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_iterations: 20, max_step: 10.0, min_fraction: 0.002 }
    }
}

/// An equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceState {
    /// Position on the load path.
    pub parameter: LoadParameter,
    /// Displacements, mm, three per node.
    pub displacement: Vec<f64>,
    /// Multipliers λ, N, three per node, zero where nothing is held: R(q) + Φᵀλ = 0, so λ is the force of the body on
    /// its support. See [`Self::reaction`] for the opposite.
    pub multiplier: Vec<f64>,
    /// Pressure in every cavity above the atmosphere's, MPa.
    pub cavity_pressure: Vec<f64>,
    /// Element pressures p (mean normal stress, positive in tension), MPa, see [`SolidModel::pressures`].
    pub element_pressure: Vec<f64>,
    /// ‖\[Δq; Δλ\]‖ of the iterations since the previous requested position, failed attempts included.
    pub corrections: Vec<f64>,
}

impl ReferenceState {
    /// Newton iterations since the previous requested position, failed attempts included.
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
    /// A part of the problem that is not modelled ([`crate::Unmodelled`]), and those of the contributions: [`SolidModel::new`],
    /// [`CavityModel::new`], [`ContactModel::new`].
    pub fn new(problem: &Problem) -> Result<Self, ReferenceError> {
        Self::with_volume_weights(problem, pressure::ACROSS_Y)
    }

    /// The same with other weights for the cavities' volumes, see [`pressure`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_volume_weights(problem: &Problem, axes: [f64; 3]) -> Result<Self, ReferenceError> {
        let Problem {
            // By all contributions.
            mesh: _,
            formulation: _,
            // By `SolidModel` and, for weights, by `ConservativeLoads`.
            material: _,
            regions: _,
            supports,
            equations,
            distances,
            ties,
            cavities,
            loads,
            // By `ContactModel`.
            contact: _,
            contact_pairs: _,
            obstacles,
            // How results of the whole body follow from those of a part.
            symmetry: _,
            // Words for the load parameter.
            clock: _,
            given: _,
        } = problem;
        if !(distances.is_empty() && ties.is_empty()) {
            return Err(ReferenceError::NotModelled { part: Unmodelled::Rigid, name: "distances, ties".into() });
        }
        let held = problem.held_dofs().iter().enumerate().filter(|(_, held)| **held).map(|(dof, _)| dof).collect();
        let pressures = loads.iter().filter_map(|load| match load {
            Load::Pressure { facets, curve } => {
                Some(FollowerPressure::new(problem, facets).map(|p| (p, curve.clone())))
            }
            // By `ConservativeLoads`.
            Load::Force { .. } | Load::Traction { .. } | Load::Gravity { .. } => None,
        });
        Ok(Self {
            solid: SolidModel::new(problem)?,
            cavities: cavities.iter().map(|c| CavityModel::new(problem, c, axes)).collect::<Result<_, _>>()?,
            pressures: pressures.collect::<Result<_, _>>()?,
            loads: ConservativeLoads::new(problem)?,
            contact: ContactModel::new(problem)?,
            obstacles: obstacles.iter().map(|o| ObstacleModel::new(problem, o)).collect::<Result<_, _>>()?,
            supports: supports.clone(),
            held,
            equations: equations.clone(),
        })
    }

    /// The solid's contribution.
    pub fn solid(&self) -> &SolidModel {
        &self.solid
    }

    /// The cavities' contributions.
    pub fn cavities(&self) -> &[CavityModel] {
        &self.cavities
    }

    /// The contribution of contact.
    pub fn contact(&self) -> &ContactModel {
        &self.contact
    }

    /// The obstacles' contributions.
    pub fn obstacles(&self) -> &[ObstacleModel] {
        &self.obstacles
    }

    /// Held degrees of freedom (3 · node + axis) in ascending order: the first rows of Φ.
    pub fn held(&self) -> &[usize] {
        &self.held
    }

    /// The whole primal potential at displacements `u`, N·mm; pressure on surfaces that enclose no volume has none.
    pub fn energy(&self, u: &[f64], parameter: LoadParameter) -> f64 {
        let fluids: f64 = self.cavities.iter().map(|cavity| cavity.energy(u, parameter)).sum();
        let obstacles: f64 = self.obstacles.iter().map(|obstacle| obstacle.energy(u, parameter)).sum();
        let loads = self.loads.forces(parameter).dot(&DVector::from_column_slice(u));
        self.solid.energy(u) + fluids - loads + self.contact.energy(u) + obstacles
    }

    /// R = ∂energy/∂u = Q_k − Q_p − Q_c, with the forces of all pressures, N.
    pub fn gradient(&self, u: &[f64], parameter: LoadParameter) -> DVector<f64> {
        self.solid.gradient(u) + self.gradient_but_solid(u, parameter)
    }

    /// K = ∂R/∂u, N/mm.
    pub fn hessian(&self, u: &[f64], parameter: LoadParameter) -> DMatrix<f64> {
        self.solid.hessian(u) + self.hessian_but_solid(u, parameter)
    }

    fn gradient_but_solid(&self, u: &[f64], parameter: LoadParameter) -> DVector<f64> {
        let mut gradient = self.contact.gradient(u) - self.loads.forces(parameter);
        self.cavities.iter().for_each(|cavity| gradient += cavity.gradient(u, parameter));
        self.pressures.iter().for_each(|(faces, curve)| gradient += faces.gradient(u, curve.at(parameter)));
        self.obstacles.iter().for_each(|obstacle| gradient += obstacle.gradient(u, parameter));
        gradient
    }

    fn hessian_but_solid(&self, u: &[f64], parameter: LoadParameter) -> DMatrix<f64> {
        let mut hessian = self.contact.hessian(u);
        self.cavities.iter().for_each(|cavity| hessian += cavity.tangent(u, parameter));
        self.pressures.iter().for_each(|(faces, curve)| hessian += faces.tangent(u, curve.at(parameter)));
        self.obstacles.iter().for_each(|obstacle| hessian += obstacle.hessian(u, parameter));
        hessian
    }

    /// Displacements that the supports prescribe at a position on the load path, mm, three per node; 0 at free degrees of freedom.
    pub fn prescribed(&self, parameter: LoadParameter) -> Vec<f64> {
        let mut prescribed = vec![0.0; self.solid.num_dofs()];
        for Support { name: _, nodes, axes, motion } in &self.supports {
            let Some(Motion { displacement, curve }) = motion else { continue };
            for &node in nodes {
                for axis in (0..3).filter(|&axis| axes[axis]) {
                    prescribed[3 * node as usize + axis] = curve.at(parameter) * displacement[axis];
                }
            }
        }
        prescribed
    }

    /// What is constrained: held degrees of freedom, linear equations, volumes of liquids.
    fn constraints(&self, u: &[f64], parameter: LoadParameter, prescribed: &[f64]) -> Vec<Constraint> {
        let held = |&dof: &usize| Constraint { value: u[dof] - prescribed[dof], gradient: vec![(dof, 1.0)] };
        let equation = |LinearEquation { terms, value }: &LinearEquation| {
            let gradient: Vec<(usize, f64)> =
                terms.iter().map(|&(node, axis, c)| (3 * node as usize + usize::from(axis), c)).collect();
            let sum: f64 = gradient.iter().map(|&(dof, c)| c * u[dof]).sum();
            Constraint { value: sum - value.at(parameter), gradient }
        };
        let liquids = self.cavities.iter().filter_map(|cavity| cavity.constraint(u, parameter));
        self.held.iter().map(held).chain(self.equations.iter().map(equation)).chain(liquids).collect()
    }

    /// Number of rows of Φ: held degrees of freedom, linear equations, volumes of liquids.
    pub fn num_constraints(&self) -> usize {
        self.held.len() + self.equations.len() + self.liquids().count()
    }

    fn liquids(&self) -> impl Iterator<Item = &CavityModel> {
        self.cavities.iter().filter(|cavity| cavity.is_constrained())
    }

    /// The Newton system at displacements `u`, element pressures `element_pressure` (MPa) and multipliers λ of the constraints:
    /// those of [`Self::held`], of the linear equations, of the volumes of liquids. `prescribed` are displacements of held degrees of
    /// freedom, mm, three per node; those of free ones are ignored.
    ///
    /// # Errors
    /// A list of the wrong length.
    pub fn kkt_system(
        &self,
        u: &[f64],
        element_pressure: &[f64],
        lambda: &[f64],
        parameter: LoadParameter,
        prescribed: &[f64],
    ) -> Result<KktSystem, ReferenceError> {
        let n = self.solid.num_dofs();
        check("the displacement vector", u, n)?;
        check("the vector of element pressures", element_pressure, self.solid.num_pressures())?;
        check("the vector of multipliers", lambda, self.num_constraints())?;
        check("the vector of prescribed displacements", prescribed, n)?;

        let mut gradient = self.solid.saddle_gradient(u, element_pressure);
        let mut forces = gradient.rows_mut(0, n);
        forces += self.gradient_but_solid(u, parameter);
        let mut hessian = self.solid.saddle_hessian(u, element_pressure);
        let mut stiffness = hessian.view_mut((0, 0), (n, n));
        stiffness += self.hessian_but_solid(u, parameter);
        for (liquid, &multiplier) in self.liquids().zip(self.of_liquids(lambda)) {
            stiffness += liquid.curvature(u, multiplier);
        }
        Ok(KktSystem::new(&hessian, &gradient, &self.constraints(u, parameter, prescribed), lambda))
    }

    /// The last of the multipliers.
    fn of_liquids<'a>(&self, lambda: &'a [f64]) -> &'a [f64] {
        &lambda[self.held.len() + self.equations.len()..]
    }

    /// Equilibria at the given positions on the load path in turn, from rest at 0.
    ///
    /// The way to every position is divided into equal steps, which are halved after a failure and stay so up to that position.
    ///
    /// # Errors
    /// No convergence.
    pub fn follow_path(
        &self,
        parameters: &[impl Into<LoadParameter> + Copy],
        options: &PathOptions,
    ) -> Result<Vec<ReferenceState>, ReferenceError> {
        let mut unknowns = Unknowns {
            u: vec![0.0; self.solid.num_dofs()],
            p: vec![0.0; self.solid.num_pressures()],
            lambda: vec![0.0; self.num_constraints()],
        };
        let mut start = LoadParameter::default();
        let mut states = Vec::new();
        for &target in parameters {
            let (target, mut corrections) = (target.into(), Vec::new());
            let way = target - start;
            let at = |fraction: f64| if fraction < 1.0 { start + fraction * way } else { target };
            // Fractions of the way from `start` to `target`.
            let (mut done, mut stride) = (0.0, 1.0 / (way.abs() / options.max_step).ceil().max(1.0));
            while done < 1.0 {
                let next: f64 = done + stride;
                let next = if next > 1.0 - 1e-9 { 1.0 } else { next };
                match self.newton(unknowns.clone(), at(next), options, &mut corrections)? {
                    Ok(converged) => (unknowns, done) = (converged, next),
                    Err(cause) => {
                        stride /= 2.0;
                        if stride < options.min_fraction {
                            return Err(ReferenceError::NotConverged { from: at(done), to: at(next), cause });
                        }
                    }
                }
            }
            states.push(self.state(&unknowns, target, corrections));
            start = target;
        }
        Ok(states)
    }

    /// One equilibrium by plain Newton steps; the inner error says why there is none.
    fn newton(
        &self,
        mut unknowns: Unknowns,
        parameter: LoadParameter,
        options: &PathOptions,
        corrections: &mut Vec<f64>,
    ) -> Result<Result<Unknowns, String>, ReferenceError> {
        let (n, m) = (unknowns.u.len(), unknowns.p.len());
        let prescribed = self.prescribed(parameter);
        for _ in 0..options.max_iterations {
            let system = self.kkt_system(&unknowns.u, &unknowns.p, &unknowns.lambda, parameter, &prescribed)?;
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

    fn state(&self, unknowns: &Unknowns, parameter: LoadParameter, corrections: Vec<f64>) -> ReferenceState {
        let Unknowns { u, p, lambda } = unknowns;
        let mut multiplier = vec![0.0; self.solid.num_dofs()];
        self.held.iter().zip(lambda).for_each(|(&dof, &lambda)| multiplier[dof] = lambda);
        let mut liquids = self.of_liquids(lambda).iter();
        let pressure = |cavity: &CavityModel| {
            let multiplier = if cavity.is_constrained() { liquids.next() } else { None };
            multiplier.map_or_else(|| cavity.pressure(u, parameter), |multiplier| -multiplier)
        };
        ReferenceState {
            parameter,
            displacement: u.clone(),
            multiplier,
            cavity_pressure: self.cavities.iter().map(pressure).collect(),
            element_pressure: p.clone(),
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
