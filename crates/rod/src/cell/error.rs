//! Why a cell gives no samples.

use pneuflex_mesh::GeometryError;
use pneuflex_newton::{Cause, Failure, SetupError};
use pneuflex_post::PostError;

/// Why a cell gives no samples.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CellError {
    /// Its lengths make no body.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Its neighbours share a wall.
    #[error(
        "actuator.gap = 0: a rod is identified from chambers that only the base joins, and these share a wall; give a gap"
    )]
    NoGap,
    /// Its equations cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A pressure is not reached.
    #[error(transparent)]
    Path(#[from] Failure),
    /// Nothing can be derived from an equilibrium.
    #[error(transparent)]
    Derived(#[from] PostError),
    /// No equilibrium is found where its end is moved to.
    #[error("the cell's end could not be moved: {0}")]
    NotMoved(Cause),
    /// Its end cannot be freed of forces.
    #[error("bent back at {pressure_kpa} kPa the cell does not become free of forces")]
    NotBalanced {
        /// Pressure, kPa.
        pressure_kpa: f64,
    },
    /// A moment bends its end as far as one likes.
    #[error("the cell's end has no stiffness")]
    NoStiffness,
    /// Bent back as far as is tried, its chambers do not touch.
    #[error("at {pressure_kpa} kPa the chambers do not touch within {turn:.2} rad")]
    NoContact {
        /// Pressure, kPa.
        pressure_kpa: f64,
        /// Rotation of its end, rad.
        turn: f64,
    },
    /// The middles of the chambers lie beyond the mesh.
    #[error("the mesh does not reach the chambers' middles")]
    ShortMesh,
}
