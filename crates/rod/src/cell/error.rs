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
    /// Its chambers are not alike.
    #[error(
        "actuator.{key} differs from chamber to chamber: a rod is identified from two chambers that are repeated all along it; give one number for all"
    )]
    Differ {
        /// The first length that differs.
        key: &'static str,
    },
    /// The air of its chambers has pressures of their own.
    #[error("load.chamber_factor: a rod has one pressure all along it; leave it out")]
    OwnPressures,
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

impl CellError {
    /// The key of the case that it is about, if it is about one.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Geometry(error) => Some(format!("actuator.{}", error.key)),
            Self::NoGap => Some("actuator.gap".into()),
            Self::Differ { key } => Some(format!("actuator.{key}")),
            Self::OwnPressures => Some("load.chamber_factor".into()),
            _ => None,
        }
    }
}
