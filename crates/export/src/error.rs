//! Why something cannot be written.

use pneuflex_mesh::GeometryError;

/// A result that a format cannot hold, or that there is none of.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// More than the format counts.
    #[error("{what}: more than the format can count")]
    TooLarge {
        /// What there is so much of.
        what: &'static str,
    },
    /// An element that is not convex enough to be divided into tetrahedra.
    #[error("element {element} is too warped to be divided into linear tetrahedra")]
    Warped {
        /// Its number, from 1.
        element: usize,
    },
    /// Cavities that nothing joins.
    #[error(
        "the cavities are not joined by a channel (actuator.channel.half_width is 0): nothing would hold their cores"
    )]
    NoChannel,
    /// A wall of the mould that is none.
    #[error("a mould with walls of {0} mm: expected a positive number")]
    Wall(f64),
    /// Lengths that make no body.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A picture of another size than the first one, or none at all.
    #[error("an animation needs pictures of one size")]
    Pictures,
    /// Whatever else a library says.
    #[error("{0}")]
    Format(String),
}
