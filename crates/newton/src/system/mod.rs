//! The equations of one problem: what its contributions sum up to at a state, and the tangent there.
//!
//! The order of things is in the types: [`System::tangent`] assembles and factorises, what it returns solves; [`System::residual`]
//! assembles for a tangent that is at hand.

use std::sync::Arc;
use std::time::Instant;

use pneuflex_assembly::{
    Assembler, Contribution, Elimination, Position, Prediction, Request, RigidMotion, Totals, Unilateral,
};
use pneuflex_factor::{FactorError, Parallelism, Symbolic};
use pneuflex_mesh::Mesh;
use pneuflex_model::{LoadParameter, Problem};

use crate::contributions::contributions_of;
use crate::error::{AssembleError, SetupError};
use crate::linearisation::{self, Linearisation};
use crate::rotation_update::{Extent, RotationUpdate};
use crate::state::{Correction, State};
use crate::tangent_solver::{Assembled, Buffers, Tangent};
use crate::timing::Timing;

mod assembling;
mod measures;
mod room;

pub(crate) use assembling::unilateral;

/// Corrections that move no node further than this share of the nodes' spacing are applied straight: the next one makes up for their
/// second-order part.
const STRAIGHT_BELOW: f64 = 1e-3;

/// The discretised equations of a [`Problem`] with everything that is reused from iteration to iteration.
pub struct System {
    pub(crate) contributions: Vec<Box<dyn Contribution>>,
    assembler: Assembler,
    symbolic: Arc<Symbolic<3>>,
    /// `None` where displacements do not move.
    rotation_update: Option<RotationUpdate>,
    totals: Totals,
    held: Arc<[bool]>,
    elimination: Arc<Elimination>,
    /// For every degree of freedom whether the tangent has no equation for it: it is held, or follows others.
    fixed: Arc<[bool]>,
    num_bordered: usize,
    /// Mean spacing of the nodes, mm.
    spacing: f64,
    parallelism: Parallelism,
    /// Memory of the last tangent.
    buffers: Option<Buffers>,
    /// Columns −K⁻¹B, if what was assembled last is a tangent.
    responses: Option<Vec<Vec<f64>>>,
    /// Seconds spent so far.
    pub timing: Timing,
}

impl System {
    /// Sets up the equations of a problem.
    ///
    /// # Errors
    /// [`SetupError`] if an element is degenerate, a cavity open or the body is not held.
    pub fn new(problem: &Problem, parallelism: Parallelism) -> Result<Self, SetupError> {
        Self::of(problem, false, parallelism)
    }

    /// The same with dampers, if it is one that may snap (`is_damped`).
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(problem: &Problem, is_damped: bool, parallelism: Parallelism) -> Result<Self, SetupError> {
        let held = problem.held_dofs();
        let (elimination, left) = Elimination::of(&problem.equations, problem.mesh.num_nodes(), &held);
        let contributions = contributions_of(problem, &left, is_damped)?;
        Self::with_contributions(&problem.mesh, (held, elimination), contributions, parallelism)
    }

    /// Sets up the equations of a list of contributions on a mesh; `held` says for every degree of freedom (3 · node + axis) whether its
    /// displacement is prescribed, the elimination which follows others.
    ///
    /// # Errors
    /// [`SetupError::Factor`] if the body is not held, or the structure of the equations cannot be analysed.
    pub fn with_contributions(
        mesh: &Arc<Mesh>,
        (held, elimination): (Vec<bool>, Elimination),
        contributions: Vec<Box<dyn Contribution>>,
        parallelism: Parallelism,
    ) -> Result<Self, SetupError> {
        let start = Instant::now();
        let rotation_update = Some(RotationUpdate::new(mesh, &held, parallelism)?);
        let system = Self::with_room(mesh, (held, elimination), contributions, &[], parallelism)?;
        let timing = Timing { factor_s: start.elapsed().as_secs_f64(), ..Timing::default() };
        Ok(Self { rotation_update, timing, ..system })
    }

    /// For every degree of freedom (3 · node + axis) whether it is held.
    pub fn held(&self) -> &[bool] {
        &self.held
    }

    /// Number of unknowns beside the displacements, see [`State::bordered`].
    pub fn num_bordered(&self) -> usize {
        self.num_bordered
    }

    /// Energy, residual and equations at a state.
    ///
    /// # Errors
    /// [`AssembleError::Local`] naming the element that is turned inside out.
    pub fn residual(&mut self, state: &State) -> Result<Assembled, AssembleError> {
        self.take_position(state.position(), state.parameter);
        self.responses = None;
        Ok(self.assemble(state, Request::Residual)?)
    }

    /// The same on the way to an equilibrium: contact keeps the points for which the linear system predicts traction, as the tangent does.
    ///
    /// # Errors
    /// As [`Self::residual`].
    pub fn residual_on_the_way(&mut self, state: &State) -> Result<Assembled, AssembleError> {
        self.take_position(Position { is_on_the_way: true, ..state.position() }, state.parameter);
        self.responses = None;
        Ok(self.assemble(state, Request::Residual)?)
    }

    /// The residual that is to be expected at another position on the load path: the loads are those there, the obstacles' motion up to there
    /// counts as far as the tangent feels it. With the obstacles at their new places instead, the guess would be hit by the penalty of
    /// their whole motion.
    ///
    /// # Errors
    /// As [`Self::residual`].
    pub fn residual_ahead(
        &mut self,
        tangent: &Tangent,
        start: &State,
        wanted: LoadParameter,
    ) -> Result<Assembled, AssembleError> {
        let ahead = start.moved_to(wanted);
        self.take_position(ahead.position(), start.parameter);
        self.responses = None;
        let mut assembled = self.assemble(&ahead, Request::Residual)?;
        for RigidMotion { curve, column } in tangent.motions() {
            let change = curve.at(wanted) - curve.at(start.parameter);
            for (r, c) in assembled.residual.iter_mut().zip(column) {
                *r = std::array::from_fn(|k| r[k] + change * c[k]);
            }
        }
        Ok(assembled)
    }

    /// The same and the tangent, factorised.
    ///
    /// # Errors
    /// An element turned inside out, or a singular tangent.
    pub fn tangent(&mut self, state: &State) -> Result<(Assembled, Tangent), AssembleError> {
        self.responses = None;
        let start = Instant::now();
        let linearisation = self.next_linearisation(state);
        self.timing.assembly_s += start.elapsed().as_secs_f64();
        self.take_position(Position { is_on_the_way: true, ..state.position() }, state.parameter);
        self.make_room_for_contact()?;
        let mut buffers = self.buffers.take().unwrap_or_else(|| Buffers::new(&self.symbolic));
        if !Arc::ptr_eq(&buffers.symbolic, &self.symbolic) {
            buffers.set_symbolic(&self.symbolic);
        }
        std::mem::swap(&mut self.totals.tangent, &mut buffers.values);
        let assembled = self.assemble(state, Request::Tangent);
        std::mem::swap(&mut self.totals.tangent, &mut buffers.values);
        let assembled = match assembled {
            Ok(assembled) => assembled,
            Err(error) => {
                self.buffers = Some(buffers);
                return Err(error.into());
            }
        };
        let start = Instant::now();
        let constraints = (Arc::clone(&self.fixed), Arc::clone(&self.elimination));
        let unsymmetric = (self.couplings(&state.displacement), constraints);
        let mut motions: Vec<RigidMotion> = unilateral(&self.contributions).flat_map(Unilateral::motions).collect();
        motions.iter_mut().for_each(|motion| self.elimination.condense(motion.column.as_flattened_mut()));
        self.timing.assembly_s += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let pattern = Arc::clone(self.assembler.pattern());
        let factorised = Tangent::new(pattern, buffers, unsymmetric, (linearisation, motions), self.parallelism);
        self.timing.factor_s += start.elapsed().as_secs_f64();
        let mut tangent = factorised.map_err(|ended| {
            let (error, buffers) = *ended;
            self.buffers = Some(buffers);
            error
        })?;
        let start = Instant::now();
        if !assembled.equations.is_empty() {
            self.responses = Some(tangent.responses(&assembled.equations)?);
        }
        tangent.judge_inertia(&assembled.equations, self.responses.as_deref());
        self.timing.solve_s += start.elapsed().as_secs_f64();
        Ok((assembled, tangent))
    }

    /// Takes back the memory of a tangent that is not needed any more.
    pub fn recycle(&mut self, tangent: Option<Tangent>) {
        if let Some(tangent) = tangent {
            self.buffers = Some(tangent.into_buffers());
        }
    }

    /// Makes the tangent of an earlier linearisation again. Its lists must have this problem's lengths.
    ///
    /// # Errors
    /// An element turned inside out or a singular tangent, which an earlier linearisation of the same problem has not.
    pub fn restore(&mut self, linearisation: &Linearisation) -> Result<Tangent, AssembleError> {
        self.carry(linearisation);
        Ok(self.tangent(&linearisation.state())?.1)
    }

    /// Correction from K δu + B δy = −r and the equations of the unknowns δy beside the displacements, for what was assembled last.
    /// `prescribed` are the changes wanted at held degrees of freedom, mm, one entry per node.
    ///
    /// # Errors
    /// If the unsymmetric part of the tangent is too much for its factor, or the equations contradict each other.
    pub fn solve(
        &mut self,
        tangent: &Tangent,
        assembled: &Assembled,
        prescribed: Option<&[[f64; 3]]>,
    ) -> Result<Correction, AssembleError> {
        let start = Instant::now();
        let mut correction = tangent.solve(assembled, prescribed, self.responses.as_deref());
        if let Ok(correction) = &mut correction {
            self.elimination.expand(&mut correction.displacement);
        }
        self.timing.solve_s += start.elapsed().as_secs_f64();
        correction
    }

    /// Multipliers λ = −(r + K δu + B δy) of the held degrees of freedom after a correction, N, three per node; zero at free ones.
    ///
    /// # Errors
    /// If the correction is that of another problem.
    pub fn multipliers(
        &mut self,
        tangent: &Tangent,
        assembled: &Assembled,
        correction: &Correction,
    ) -> Result<Vec<f64>, FactorError> {
        let start = Instant::now();
        let multipliers = tangent.multipliers(assembled, correction);
        self.timing.solve_s += start.elapsed().as_secs_f64();
        multipliers
    }

    /// Applies a correction found at a state: the mixed linearisation's stresses follow, displacements move by its rotation update.
    ///
    /// # Errors
    /// [`AssembleError::Local`] if the state before the correction is turned inside out.
    pub fn apply(&mut self, state: &mut State, correction: &Correction) -> Result<(), AssembleError> {
        self.predict(&state.displacement, Some(&correction.displacement));
        self.move_by(state, correction)
    }

    /// The same without the stresses.
    ///
    /// # Errors
    /// As [`Self::apply`].
    pub fn move_by(&mut self, state: &mut State, correction: &Correction) -> Result<(), AssembleError> {
        let start = Instant::now();
        let is_small = correction.largest() < STRAIGHT_BELOW * self.spacing;
        let moved = match self.rotation_update.as_mut().filter(|_| !is_small) {
            Some(rotation_update) => rotation_update.apply(&mut state.displacement, &correction.displacement),
            None => {
                let pairs =
                    state.displacement.as_flattened_mut().iter_mut().zip(correction.displacement.as_flattened());
                pairs.for_each(|(u, delta)| *u += delta);
                Ok(())
            }
        };
        self.elimination.expand(&mut state.displacement);
        for (value, delta) in state.bordered.iter_mut().zip(&correction.bordered) {
            *value += delta;
        }
        self.timing.solve_s += start.elapsed().as_secs_f64();
        moved
    }

    /// Lets the next tangent carry the stresses that the linear system, assembled at `displacement`, makes of them under a correction; or
    /// without one those of that displacement itself.
    pub fn predict(&mut self, displacement: &[[f64; 3]], correction: Option<&[[f64; 3]]>) {
        let start = Instant::now();
        let (displacement, correction) = (displacement.to_vec(), correction.map(<[_]>::to_vec));
        linearisation::predict(&mut self.contributions, Prediction { displacement, correction, motion: None });
        self.timing.solve_s += start.elapsed().as_secs_f64();
    }

    /// The same for a guess from a state: obstacles move with it up to another position on the load path.
    pub fn predict_ahead(&mut self, start: &State, guess: &Correction, aim: LoadParameter) {
        let begin = Instant::now();
        let (displacement, correction) = (start.displacement.clone(), Some(guess.displacement.clone()));
        let motion = Some([start.parameter, aim]);
        linearisation::predict(&mut self.contributions, Prediction { displacement, correction, motion });
        self.timing.solve_s += begin.elapsed().as_secs_f64();
    }

    /// The tangent that is assembled next, at a state, by what it is made from.
    pub fn next_linearisation(&mut self, state: &State) -> Linearisation {
        Linearisation::next(&mut self.contributions, state)
    }

    /// Lets the next tangent carry the stresses of a linearisation. Its lists must have this problem's lengths.
    pub fn carry(&mut self, linearisation: &Linearisation) {
        linearisation.restore(&mut self.contributions);
    }

    /// How much a correction deforms the body at a displacement.
    pub fn extent(&mut self, displacement: &[[f64; 3]], correction: &[[f64; 3]]) -> Extent {
        let start = Instant::now();
        let unknown = Extent { stretch: f64::INFINITY, angle: f64::INFINITY };
        let rotation_update = self.rotation_update.as_ref();
        let extent = rotation_update.map_or(unknown, |update| update.extent(displacement, correction));
        self.timing.solve_s += start.elapsed().as_secs_f64();
        extent
    }

    /// The slaves of a nodal field follow their masters.
    pub(crate) fn expand(&self, field: &mut [[f64; 3]]) {
        self.elimination.expand(field);
    }

    /// Masters take what acts on their slaves.
    pub(crate) fn condense(&self, forces: &mut [[f64; 3]]) {
        self.elimination.condense(forces.as_flattened_mut());
    }

    /// Tells the contributions that a step begins at a state.
    pub fn begin_step(&mut self, state: &State) {
        self.contributions.iter_mut().for_each(|contribution| contribution.begin_step(&state.displacement));
    }

    /// Dampers take 1/Δτ of the step of pseudo-time that follows; 0 lets them rest.
    pub fn damp(&mut self, rate: f64) {
        self.contributions.iter_mut().for_each(|contribution| contribution.damp(rate));
    }

    /// Norm of the forces at a displacement that must have vanished where results are wanted, N; `None` if there are none of the kind.
    pub fn vanishing_force(&self, displacement: &[[f64; 3]]) -> Option<f64> {
        self.vanishing_forces(displacement).map(|forces| self.free_norm(&forces))
    }

    /// These forces, N, one entry per node.
    pub fn vanishing_forces(&self, displacement: &[[f64; 3]]) -> Option<Vec<[f64; 3]>> {
        let found = self.contributions.iter().filter_map(|contribution| contribution.vanishing_forces(displacement));
        let mut sum: Option<Vec<[f64; 3]>> = None;
        for (node, force) in found.flatten() {
            let sum = sum.get_or_insert_with(|| vec![[0.0; 3]; displacement.len()]);
            (0..3).for_each(|k| sum[node as usize][k] += force[k]);
        }
        sum
    }

    /// The contributions' history follows to the position taken last.
    pub fn commit(&mut self) {
        self.contributions.iter_mut().for_each(|contribution| contribution.commit());
    }

    /// The contributions' history goes back to the last state of equilibrium.
    pub fn revert(&mut self) {
        self.contributions.iter_mut().for_each(|contribution| contribution.revert());
    }
}
