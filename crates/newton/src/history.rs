//! What a run reports: iterations, landed states, failures, timing. Plain data.

use std::fmt;

use pneuflex_factor::FactorError;
use pneuflex_model::Clock;
use serde::{Deserialize, Serialize};

use crate::checkpoint::Checkpoint;
use crate::path::ResumeError;
use crate::system::SetupError;

/// One Newton iteration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IterationRecord {
    /// Load step, from 1; rejected attempts count.
    pub step: usize,
    /// Iteration within the step, from 1: the number of tangents factorised.
    pub iteration: usize,
    /// Whether this correction is one of a new tangent; otherwise the factor of the iteration was used again.
    pub new_tangent: bool,
    /// Time of the attempt.
    pub time: f64,
    /// ‖\[Δq; Δλ\]‖, mm and N.
    pub correction: f64,
    /// Norm of the residual over the free degrees of freedom before the correction, N.
    pub residual: f64,
    /// The same relative to the norm of the pressure forces.
    pub relative_residual: f64,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Negative pivots of the tangent; 0 when it is positive definite.
    pub negative_pivots: usize,
    /// Seconds since the run began.
    pub elapsed_s: f64,
}

/// An equilibrium at one of the requested times.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergedState {
    /// Requested time: the pressure in kPa for actuators.
    pub time: f64,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Forces of the supports on the body, N, one entry per node, zero at free degrees of freedom: −λ of R + Φᵀλ = 0.
    pub reaction: Vec<[f64; 3]>,
    /// Newton iterations spent since the previous landing, rejected attempts included.
    pub iterations: usize,
    /// Load steps accepted since the previous landing.
    pub load_steps: usize,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Pressure in every cavity above the atmosphere's, MPa.
    pub cavity_pressures: Vec<f64>,
    /// Multipliers of all contact points, MPa; empty for a plain penalty.
    pub contact_multipliers: Vec<f64>,
    /// How the contact's multipliers came about; `None` for a plain penalty.
    pub augmentation: Option<Augmentation>,
}

/// The contact of a state as an augmented Lagrangian left it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Augmentation {
    /// How often the multipliers were brought up to date.
    pub count: usize,
    /// Largest distance |d| of a contact point that carries traction, mm.
    pub distance: f64,
    /// Why it is above the tolerance, if it is.
    pub failure: Option<String>,
}

/// What an observer is told while a path is followed.
#[derive(Clone, Debug)]
pub enum Event<'a> {
    /// A load step is attempted.
    StepStarted {
        /// Load step, from 1.
        step: usize,
        /// Time aimed at.
        time: f64,
    },
    /// An iteration is done.
    Iteration(&'a IterationRecord),
    /// An attempt failed; the step is halved.
    StepRejected {
        /// Load step, from 1.
        step: usize,
        /// Time aimed at.
        time: f64,
        /// Why.
        cause: &'a Cause,
    },
    /// A load step is done; the path can be resumed from here.
    StepAccepted(&'a Checkpoint),
    /// A requested time is reached.
    Converged(&'a ConvergedState),
}

/// Why a step failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Cause {
    /// An element turned inside out.
    #[error("element {element} is inverted (det F = {jacobian:.3e} at its integration point {point})")]
    Inversion {
        /// Element number.
        element: usize,
        /// Integration point.
        point: usize,
        /// det F.
        jacobian: f64,
    },
    /// The iteration did not converge in the allowed number of iterations.
    #[error(
        "no convergence in {iterations} iterations (last correction {correction:.3e}, residual {residual:.3e} N; \
         largest residual at node {node})"
    )]
    TooManyIterations {
        /// Iterations done.
        iterations: usize,
        /// Last ‖\[Δq; Δλ\]‖.
        correction: f64,
        /// Last residual norm, N.
        residual: f64,
        /// Node with the largest residual.
        node: usize,
    },
    /// The iteration ran away.
    #[error("the iteration diverged (correction {correction:.3e})")]
    Diverged {
        /// Last ‖\[Δq; Δλ\]‖.
        correction: f64,
    },
    /// The set of touching points keeps changing.
    #[error("the contact does not settle (between {least} and {most} touching points over the last iterations)")]
    ContactChatter {
        /// Fewest touching points.
        least: usize,
        /// Most touching points.
        most: usize,
    },
    /// The tangent of an equilibrium is indefinite: the body is unstable there.
    #[error("the tangent at the equilibrium is indefinite ({negative_pivots} negative pivots): an instability")]
    IndefiniteTangent {
        /// Number of negative pivots.
        negative_pivots: usize,
    },
    /// The equations of the problem cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The path cannot go on from its checkpoint.
    #[error(transparent)]
    Resume(#[from] ResumeError),
    /// The tangent cannot be factorised.
    #[error("the tangent is singular: {0}")]
    SingularTangent(#[from] FactorError),
    /// Equations that no displacement satisfies, or that say the same twice.
    #[error("the linear equations or the cavities' volumes contradict or repeat each other")]
    Contradiction,
    /// Somebody asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// A path that could not be followed to its end; everything landed on before was reported by [`Event::Converged`].
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Time of the last equilibrium.
    pub reached: f64,
    /// Time of the last failed attempt.
    pub attempted: f64,
    /// Why the last attempt failed.
    pub cause: Cause,
    /// How firm the last equilibrium is.
    pub stability: Stability,
    /// What times stand for.
    pub clock: Clock,
}

/// How firm an equilibrium is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stability {
    /// Largest stretching per pressure at any point, relative to the one at the beginning of the path. It grows without limit
    /// towards a limit point, beyond which there is no equilibrium at a higher pressure nearby.
    pub softening: f64,
    /// Negative pivots of the tangent there: the number of motions that would release energy.
    pub negative_pivots: usize,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [reached, attempted] = [self.reached, self.attempted].map(|time| self.clock.words(time));
        match &self.cause {
            Cause::Interrupted => write!(f, "interrupted at {reached}"),
            cause => {
                write!(f, "not converged: the path stops at {reached}, the step to {attempted} failed: {cause}")
            }
        }
    }
}

impl std::error::Error for Failure {}

/// Seconds spent, by kind of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Residual and tangent of solid and pressure.
    pub assembly_s: f64,
    /// Analysis and numerical factorisation.
    pub factor_s: f64,
    /// Triangular solves and rotation-aware increments.
    pub solve_s: f64,
    /// Contact search, forces and tangent.
    pub contact_s: f64,
    /// The whole path.
    pub total_s: f64,
}

/// A path that was followed to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct PathReport {
    /// Newton iterations in all, rejected attempts included.
    pub iterations: usize,
    /// Seconds spent.
    pub timing: Timing,
}
