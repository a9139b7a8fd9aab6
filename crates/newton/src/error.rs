//! What can go wrong with the equations of a problem.

use pneuflex_assembly::LocalError;
use pneuflex_assembly::solid::DegenerateElement;
use pneuflex_factor::FactorError;
use pneuflex_factor::gmres::NotConverged;
use pneuflex_model::OpenCavity;

/// A problem that cannot be set up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// An element of the mesh has no volume.
    #[error(transparent)]
    Degenerate(#[from] DegenerateElement),
    /// The structure of the equations cannot be analysed, or part of the body is not held.
    #[error("the equations cannot be set up: {0}")]
    Factor(#[from] FactorError),
    /// The volume of a cavity is asked for that is open.
    #[error(transparent)]
    Cavity(#[from] OpenCavity),
    /// Surfaces are to be glued, but not by equations yet.
    #[error("tie {0} is not written as equations")]
    Tie(String),
}

/// Why a state could not be assembled, or its equations not be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AssembleError {
    /// An element is turned inside out.
    #[error(transparent)]
    Local(#[from] LocalError),
    /// The pattern with the new contacts cannot be analysed, or the tangent is singular.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// The unsymmetric part of the tangent is too much for the factor of the symmetric one.
    #[error(transparent)]
    Unsymmetric(#[from] NotConverged),
    /// Equations that no displacement satisfies, or that say the same twice.
    #[error("the linear equations or the cavities' volumes contradict or repeat each other")]
    Contradiction,
}

/// A checkpoint that belongs to another problem, or is damaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the checkpoint does not fit the problem: {0}")]
pub struct Misfit(pub(crate) &'static str);

/// A path that cannot go on from a checkpoint.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResumeError {
    /// It belongs to another problem.
    #[error(transparent)]
    Misfit(#[from] Misfit),
    /// Its tangent cannot be made again.
    #[error("the checkpoint's tangent cannot be made again: {0}")]
    Tangent(#[from] AssembleError),
}
