//! Why a step failed, and a path that could not be followed to its end.

use std::fmt;

use pneuflex_assembly::LocalError;
use pneuflex_factor::{FactorError, gmres};
use pneuflex_model::{Clock, LoadParameter};

use crate::error::{AssembleError, ResumeError, SetupError};
use crate::unstable_motion::UnstableMotions;

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
    /// Rounding leaves a larger residual than the tolerance allows: no correction makes it smaller.
    #[error(
        "rounding leaves a residual of {residual:.1e} N, which is {relative:.1e} of the forces, and no correction makes it smaller"
    )]
    Rounding {
        /// Residual norm, N.
        residual: f64,
        /// The same as a share of what residuals are compared with.
        relative: f64,
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
        /// Whether the body is stable with some of these points and unstable with others.
        becomes_unstable: bool,
    },
    /// The body came out of an obstacle on the other side.
    #[error("the step would carry the body through the obstacle `{obstacle}`")]
    PassedThrough {
        /// Its name.
        obstacle: String,
    },
    /// What only contact was to hold is held by nothing.
    #[error("nothing holds the body but the springs that were added until contact does: they carry {force:.3e} N")]
    HeldBySprings {
        /// Norm of their forces, N.
        force: f64,
    },
    /// The tangent of an equilibrium is indefinite: the body is unstable there.
    #[error("the tangent at the equilibrium is indefinite ({negative_pivots} negative pivots): an instability")]
    IndefiniteTangent {
        /// Number of negative pivots.
        negative_pivots: usize,
        /// The motions that release energy, if they were found.
        motions: Option<Box<UnstableMotions>>,
    },
    /// What a step along the path led to does not lie on it.
    #[error("the step leads to another branch of equilibria")]
    OtherBranch,
    /// The equations of the problem cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The path cannot go on from its checkpoint.
    #[error(transparent)]
    Resume(#[from] ResumeError),
    /// There is not enough memory for the tangent's factor.
    #[error("{0}")]
    OutOfMemory(FactorError),
    /// The tangent cannot be factorised.
    #[error("the tangent is singular: {0}")]
    SingularTangent(FactorError),
    /// The unsymmetric part of the tangent is too much for its factor.
    #[error(transparent)]
    Unsymmetric(#[from] gmres::NotConverged),
    /// Equations that no displacement satisfies, or that say the same twice.
    #[error("the linear equations or the cavities' volumes contradict or repeat each other")]
    Contradiction,
    /// Somebody asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// A path that could not be followed to its end; every state before was reported by [`Event::Converged`](crate::Event::Converged).
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Position of the last equilibrium.
    pub reached: LoadParameter,
    /// Position of the last failed attempt.
    pub attempted: LoadParameter,
    /// Why the last attempt failed.
    pub cause: Cause,
    /// How firm the last equilibrium is.
    pub stability: Stability,
    /// What the load parameter counts.
    pub clock: Clock,
    /// Whether the path had gone beyond a limit point.
    pub is_past_limit: bool,
}

impl From<AssembleError> for Cause {
    fn from(error: AssembleError) -> Self {
        match error {
            AssembleError::Local(local) => local.into(),
            AssembleError::Factor(factor) => factor.into(),
            AssembleError::Unsymmetric(unsymmetric) => unsymmetric.into(),
            AssembleError::Contradiction => Self::Contradiction,
        }
    }
}

impl From<FactorError> for Cause {
    fn from(error: FactorError) -> Self {
        match error {
            FactorError::OutOfMemory { .. } => Self::OutOfMemory(error),
            _ => Self::SingularTangent(error),
        }
    }
}

impl From<LocalError> for Cause {
    fn from(e: LocalError) -> Self {
        Self::Inversion { element: e.block, point: e.point, jacobian: e.jacobian }
    }
}

impl Failure {
    /// A path that could not begin.
    pub fn at_rest(clock: Clock, attempted: LoadParameter, cause: Cause) -> Self {
        let (reached, stability) = (LoadParameter::default(), Stability::default());
        Self { reached, attempted, cause, stability, clock, is_past_limit: false }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [reached, attempted] = [self.reached, self.attempted].map(|parameter| self.clock.words(parameter));
        match &self.cause {
            Cause::Interrupted => write!(f, "interrupted at {reached}"),
            cause => {
                write!(f, "not converged: the path stops at {reached}, the step to {attempted} failed: {cause}")
            }
        }
    }
}

impl std::error::Error for Failure {}

/// How firm an equilibrium is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stability {
    /// Largest stretching at any point per change of the forces, relative to the one at the beginning of the path; `None` if it is not
    /// known. It grows without limit towards a limit point, beyond which there is no equilibrium at a higher load nearby.
    pub softening: Option<f64>,
    /// Negative eigenvalues of the tangent there: the number of motions that would release energy.
    pub negative_pivots: usize,
    /// These motions, if they were found; where there are none, the one in which the body gives way to a small change of its loads.
    pub motions: Option<Box<UnstableMotions>>,
}
