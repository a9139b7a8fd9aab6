//! Exact derivatives of an equilibrium's results by everything that its problem is made of (theory §18): lengths, constants, loads, obstacles.
//!
//! With the unknowns u and y, r(u, y; θ) = 0 and g(u, y; θ) = 0, and a result J(u, y; θ), the Lagrangian L = J − Λ·r − μ·g has at the
//! equilibrium the derivative dL/dθ = dJ/dθ for frozen u and y if Λ and μ solve the transposed linear system once. What depends on θ then is
//! told by problems with other numbers: no formula of a length or a constant is needed, L is a smooth function of one number.
//!
//! What is frozen are the free displacements; held ones are where supports of the other problem put them, and what follows others follows.
//! Contact is frozen in what touches ([`ContactModel::following`]). The path that led to the equilibrium does not enter.

use pneuflex_assembly::contribution as of_contributions;
use pneuflex_assembly::{BorderedEquation, Contribution, Elimination, LocalBlock, LocalError, Position, Request};
use pneuflex_contact::{ContactModel, Partner, Touching, evaluate_block};
use pneuflex_factor::Parallelism;
use pneuflex_model::{LoadParameter, Pressure, Problem};
use rayon::prelude::*;

use crate::contributions::{CavityPressures, contributions_of};
use crate::failure::Cause;
use crate::history::ConvergedState;
use crate::state::{State, dot};
use crate::system::System;
use crate::tangent_solver::{Assembled, Tangent};

/// A result, linearised at an equilibrium: J, or what of it is no function that the caller evaluates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objective {
    /// ∂J/∂u of what the caller evaluates, per mm, one entry per node; empty for none.
    pub by_displacement: Vec<[f64; 3]>,
    /// ∂J/∂p by the pressure of every cavity, per MPa; empty for none.
    pub by_pressure: Vec<f64>,
    /// Weights of the supports' forces on the body at held degrees of freedom, one entry per node; empty for none.
    pub reactions: Vec<[f64; 3]>,
    /// Weights of the body's force on obstacles, by their numbers.
    pub obstacles: Vec<(usize, [f64; 3])>,
    /// Weight of the energy of the solid.
    pub energy: f64,
}

/// What a result feels of the equations: the solution of the transposed system.
#[derive(Clone, Debug, PartialEq)]
pub struct Multipliers {
    /// Λ, per N, one entry per node; minus the weight of the reaction at held degrees of freedom.
    displacement: Vec<[f64; 3]>,
    /// μ of the unknowns beside the displacements.
    bordered: Vec<f64>,
    obstacles: Vec<(usize, [f64; 3])>,
    energy: f64,
}

/// An equilibrium with the exact tangent there, factorised.
pub struct Linearised {
    problem: Problem,
    system: System,
    tangent: Tangent,
    equations: Vec<BorderedEquation>,
    state: State,
    contact: ContactModel,
    touching: Touching,
    supplies: CavityPressures,
}

/// Another problem at the frozen unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Frozen {
    /// Displacements there, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Pressure in every cavity.
    pub cavity_pressures: Vec<Pressure>,
    /// For every result the part of its Lagrangian that the caller does not evaluate: weighted forces and energies less Λ·r + μ·g.
    pub lagrangians: Vec<f64>,
}

impl Linearised {
    /// The equilibrium of a problem. What is left of its residual is taken away by one correction.
    ///
    /// # Errors
    /// A tangent that cannot be factorised or solved with.
    pub fn at(problem: &Problem, equilibrium: &ConvergedState) -> Result<Self, Cause> {
        let supplies = CavityPressures::of(problem)?;
        let bordered = supplies.unknowns(&equilibrium.cavity_pressures);
        let mut state = State::new(equilibrium.parameter, equilibrium.displacement.clone(), bordered);
        let mut system = System::at(problem, &state, Parallelism::Threads)?;
        // Multipliers of equations come from the correction, in which they are linear.
        state.bordered.resize(system.num_bordered(), 0.0);
        // Not the stresses that Newton's method carries, but those of the state itself.
        system.predict(&state.displacement, None);
        let (assembled, mut tangent) = system.tangent(&state)?;
        let correction = system.solve(&tangent, &assembled, None)?;
        add(&mut state.displacement, 1.0, &correction.displacement);
        state.bordered.iter_mut().zip(&correction.bordered).for_each(|(y, change)| *y += change);
        tangent.transpose();
        let mut contact = ContactModel::of(problem);
        contact.set_parameter(state.parameter);
        let touching = contact.search(&problem.mesh.deformed(&state.displacement));
        let (problem, equations) = (problem.clone(), assembled.equations);
        Ok(Self { problem, system, tangent, equations, state, contact, touching, supplies })
    }

    /// Displacements of the equilibrium, mm, one entry per node.
    pub fn displacement(&self) -> &[[f64; 3]] {
        &self.state.displacement
    }

    /// The multipliers of a result: one solution with the transposed tangent.
    ///
    /// # Errors
    /// If the unsymmetric part of the tangent is too much for its factor, or the equations contradict each other.
    pub fn multipliers(&self, objective: &Objective) -> Result<Multipliers, Cause> {
        let Self { system, tangent, equations, state, .. } = self;
        let u = &state.displacement;
        let mut slope = vec![[0.0; 3]; u.len()];
        slope.iter_mut().zip(&objective.by_displacement).for_each(|(slope, own)| *slope = *own);
        if objective.energy != 0.0 {
            add(&mut slope, objective.energy, &self.forces_of_solid()?);
        }
        add(&mut slope, 1.0, &self.slope_of_obstacles(objective));
        system.condense(&mut slope);
        // Every unknown pressure is that of a cavity; multipliers of equations are no results.
        let unknown = self.supplies.unknowns_of(&objective.by_pressure);
        let mut by_unknown: Vec<f64> =
            unknown.into_iter().chain(std::iter::repeat(0.0)).take(equations.len()).collect();
        let mut reactions = vec![[0.0; 3]; u.len()];
        if !objective.reactions.is_empty() {
            let weights = objective.reactions.as_flattened().iter().zip(system.held());
            let pairs = reactions.as_flattened_mut().iter_mut().zip(weights);
            pairs.for_each(|(weight, (given, held))| *weight = if *held { *given } else { 0.0 });
            add(&mut slope, 1.0, &system.transposed_product(tangent, u, &reactions)?);
            for (slope, equation) in by_unknown.iter_mut().zip(equations) {
                *slope += dot(&equation.column, &reactions);
            }
        }
        // [Kᵀ sB; Bᵀ h] [λ; μ], written for sμ as an unknown that acts along B.
        let transposed = equations.iter().zip(&by_unknown).map(|(equation, slope)| BorderedEquation {
            value: -slope,
            along_column: 1.0,
            by_unknown: equation.by_unknown / equation.along_column,
            ..equation.clone()
        });
        let residual = slope.iter().map(|s| s.map(|x| -x)).collect();
        let assembled = Assembled { residual, equations: transposed.collect(), ..Assembled::default() };
        let solution = tangent.solve(&assembled, None, None)?;
        let mut displacement = solution.displacement;
        add(&mut displacement, -1.0, &reactions);
        system.expand(&mut displacement);
        let scaled = solution.bordered.iter().zip(equations).map(|(unknown, equation)| unknown / equation.along_column);
        Ok(Multipliers {
            displacement,
            bordered: scaled.collect(),
            obstacles: objective.obstacles.clone(),
            energy: objective.energy,
        })
    }

    /// A problem with other numbers, on a mesh with the same elements, at the frozen unknowns and a position on its load path; with the
    /// Lagrangians of some results, but for what is the same here: they are for differences. `None` where a point that touches has no foot on its face any more.
    ///
    /// # Errors
    /// An element that is turned inside out, or has no volume.
    pub fn frozen(
        &self,
        problem: &Problem,
        parameter: LoadParameter,
        results: &[Multipliers],
    ) -> Result<Option<Frozen>, Cause> {
        let held = problem.held_dofs();
        let (elimination, left) = Elimination::of(&problem.equations, problem.mesh.num_nodes(), &held);
        let mut displacement = self.state.displacement.clone();
        let wanted = problem.held_displacement(parameter);
        let pairs = displacement.as_flattened_mut().iter_mut().zip(wanted.as_flattened()).zip(&held);
        pairs.filter(|(_, held)| **held).for_each(|((u, wanted), _)| *u = *wanted);
        elimination.expand(&mut displacement);
        let state = State::new(parameter, displacement, self.state.bordered.clone());
        let mut lagrangians = vec![0.0; results.len()];
        let [counts_solid, counts_contact] = self.has_changed(problem, &state);
        let mut bordered = &state.bordered[..];
        for mut contribution in contributions_of(problem, &left, false)? {
            let own = bordered.split_off(..contribution.num_bordered()).unwrap_or_default();
            let of_bordered = [state.bordered.len() - bordered.len() - own.len(), own.len()];
            let counts = contribution.name() != SOLID || counts_solid;
            if counts && contribution.unilateral().is_none() {
                contribution.set_position(Position { bordered: own, ..state.position() });
                add_contribution(contribution.as_ref(), &state.displacement, of_bordered, results, &mut lagrangians)?;
            }
        }
        let cavity_pressures = CavityPressures::of(problem)?.at(&state);
        if !counts_contact {
            return Ok(Some(Frozen { displacement: state.displacement, cavity_pressures, lagrangians }));
        }
        let mut contact = ContactModel::of(problem);
        contact.set_parameter(parameter);
        let positions = problem.mesh.deformed(&state.displacement);
        let Some(blocks) = contact.following(&self.touching, &positions) else { return Ok(None) };
        for block in &blocks {
            let forces = evaluate_block(&contact, block, &positions, false).residual;
            for (lagrangian, result) in lagrangians.iter_mut().zip(results) {
                let weight = weight_of(block.partner, &result.obstacles);
                for (&node, force) in block.nodes.iter().zip(forces.chunks_exact(3)) {
                    let multiplier = result.displacement[node as usize];
                    *lagrangian += (0..3).map(|k| (weight[k] - multiplier[k]) * force[k]).sum::<f64>();
                }
            }
        }
        Ok(Some(Frozen { displacement: state.displacement, cavity_pressures, lagrangians }))
    }

    /// Whether the solid and the contact of another problem, at a state of it, have other forces.
    fn has_changed(&self, problem: &Problem, state: &State) -> [bool; 2] {
        let base = &self.problem;
        let has_moved = state.displacement != self.state.displacement || problem.mesh.nodes != base.mesh.nodes;
        let has_materials = problem.material != base.material || problem.regions != base.regions;
        let has_law = problem.contact != base.contact
            || problem.contact_pairs != base.contact_pairs
            || problem.obstacles != base.obstacles
            || state.parameter != self.state.parameter;
        [has_moved || has_materials, has_moved || has_law]
    }

    /// Slope of a result's Lagrangian by the positions of the nodes at rest, displacements staying what they are, per mm, one entry per node; without
    /// what the caller evaluates. `None` where something depends on them in another way than by elements, pressures and contact: conservative
    /// loads, volumes at rest.
    ///
    /// # Errors
    /// An element that is turned inside out.
    pub fn shape_slope(&self, result: &Multipliers) -> Result<Option<Vec<[f64; 3]>>, Cause> {
        let u = &self.state.displacement;
        let frozen =
            of_contributions::Frozen { displacement: u, multipliers: &result.displacement, energy: result.energy };
        let mut slope = vec![[0.0; 3]; u.len()];
        for contribution in self.system.contributions.iter().filter(|contribution| contribution.unilateral().is_none())
        {
            if !contribution.add_shape_slope(&frozen, &mut slope)? {
                return Ok(None);
            }
        }
        let positions = self.positions();
        for block in &self.touching.blocks {
            let weight = weight_of(block.partner, &result.obstacles);
            let multiplier = |node: &u32| -> [f64; 3] {
                std::array::from_fn(|k| weight[k] - result.displacement[*node as usize][k])
            };
            let multipliers: Vec<[f64; 3]> = block.nodes.iter().map(multiplier).collect();
            let own = self.contact.shape_slope(block, &positions, &multipliers);
            for (&node, own) in block.nodes.iter().zip(own) {
                (0..3).for_each(|k| slope[node as usize][k] += own[k]);
            }
        }
        Ok(Some(slope))
    }

    /// Positions of the nodes in the equilibrium, mm.
    fn positions(&self) -> Vec<[f64; 3]> {
        let pairs = self.contact.rest().iter().zip(&self.state.displacement);
        pairs.map(|(x, u)| std::array::from_fn(|k| x[k] + u[k])).collect()
    }

    /// Internal forces of the solid, N, one entry per node.
    fn forces_of_solid(&self) -> Result<Vec<[f64; 3]>, LocalError> {
        let u = &self.state.displacement;
        let mut forces = vec![[0.0; 3]; u.len()];
        let mut local = LocalBlock::default();
        let solid = self.system.contributions.iter().filter(|contribution| contribution.name() == SOLID);
        for blocks in solid.filter_map(|contribution| contribution.blocks()) {
            for block in 0..blocks.num_blocks() {
                local.reset(blocks.nodes(block).len(), Request::Residual);
                blocks.evaluate(block, u, Request::Residual, &mut local)?;
                for (&node, force) in blocks.nodes(block).iter().zip(&local.residual) {
                    (0..3).for_each(|k| forces[node as usize][k] += force[k]);
                }
            }
        }
        Ok(forces)
    }

    /// ∂J/∂u of the weighted forces on obstacles, one entry per node.
    fn slope_of_obstacles(&self, objective: &Objective) -> Vec<[f64; 3]> {
        let mut slope = vec![[0.0; 3]; self.state.displacement.len()];
        if objective.obstacles.is_empty() {
            return slope;
        }
        let positions = self.positions();
        for block in &self.touching.blocks {
            let weight = weight_of(block.partner, &objective.obstacles);
            if weight == [0.0; 3] {
                continue;
            }
            let tangent = evaluate_block(&self.contact, block, &positions, true).tangent;
            let size = 3 * block.nodes.len();
            for (row, of_row) in tangent.chunks_exact(size).enumerate() {
                let change: f64 = of_row.iter().enumerate().map(|(j, k)| k * weight[j % 3]).sum();
                slope[block.nodes[row / 3] as usize][row % 3] += change;
            }
        }
        slope
    }
}

/// Name of the contribution whose energy is that of the solid.
const SOLID: &str = "solid";

/// Weight of the force on what a block touches.
fn weight_of(partner: Partner, obstacles: &[(usize, [f64; 3])]) -> [f64; 3] {
    let of_partner = obstacles.iter().filter(|(number, _)| partner == Partner::Obstacle(*number));
    of_partner.fold([0.0; 3], |sum, (_, weight)| std::array::from_fn(|k| sum[k] + weight[k]))
}

/// Adds what a contribution at a displacement has in the Lagrangians; its own unknowns begin at the first and are as many as the second of
/// `of_bordered`.
fn add_contribution(
    contribution: &dyn Contribution,
    u: &[[f64; 3]],
    [first, count]: [usize; 2],
    results: &[Multipliers],
    lagrangians: &mut [f64],
) -> Result<(), LocalError> {
    if let Some(blocks) = contribution.blocks() {
        let is_solid = contribution.name() == SOLID;
        let of_block = |local: &mut LocalBlock, block: usize| {
            let nodes = blocks.nodes(block);
            local.reset(nodes.len(), Request::Residual);
            blocks.evaluate(block, u, Request::Residual, local)?;
            let of_result = |result: &Multipliers| {
                let energy = if is_solid { result.energy * local.energy } else { 0.0 };
                let pairs = nodes.iter().zip(&local.residual);
                energy - pairs.map(|(&node, r)| product(&result.displacement[node as usize], r)).sum::<f64>()
            };
            Ok(results.iter().map(of_result).collect::<Vec<f64>>())
        };
        let found = (0..blocks.num_blocks()).into_par_iter().with_min_len(8).map_init(LocalBlock::default, of_block);
        // Added up in the order of the blocks, whatever the threads did first.
        for of_block in found.collect::<Vec<Result<Vec<f64>, LocalError>>>() {
            lagrangians.iter_mut().zip(of_block?).for_each(|(lagrangian, own)| *lagrangian += own);
        }
    }
    let mut forces = vec![[0.0; 3]; u.len()];
    contribution.add_forces(&mut forces);
    let equations = if count > 0 { contribution.bordered_equations(u) } else { Vec::new() };
    for (lagrangian, result) in lagrangians.iter_mut().zip(results) {
        *lagrangian -= dot(&forces, &result.displacement);
        for (mu, equation) in result.bordered[first..first + count].iter().zip(&equations) {
            *lagrangian -= mu * equation.value;
        }
    }
    Ok(())
}

fn product(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(sum: &mut [[f64; 3]], factor: f64, other: &[[f64; 3]]) {
    let pairs = sum.as_flattened_mut().iter_mut().zip(other.as_flattened());
    pairs.for_each(|(sum, more)| *sum += factor * more);
}
