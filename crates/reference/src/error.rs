//! Errors of the reference solver.

use pneuflex_mesh::ElementKind;
use pneuflex_model::Formulation;

/// Why the reference solver cannot set up or solve a problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// The formulation asks for another element family than the mesh has.
    #[error("formulation {formulation} does not fit a mesh of {found:?} elements")]
    WrongElement {
        /// Formulation of the problem.
        formulation: Formulation,
        /// Family of the mesh.
        found: ElementKind,
    },
    /// An element has no positive volume at one of its integration points.
    #[error("element {element} is inverted in the reference configuration: det ∂X/∂ξ = {jacobian:.3e}")]
    InvertedElement {
        /// Element number.
        element: usize,
        /// Smallest det ∂X/∂ξ found, mm³.
        jacobian: f64,
    },
    /// Single-point contact needs as many master as slave facets.
    #[error("contact pair {pair}: {slave} slave facets but {master} master facets, single-point contact pairs them")]
    UnpairedFacets {
        /// Name of the pair.
        pair: String,
        /// Number of slave facets.
        slave: usize,
        /// Number of master facets.
        master: usize,
    },
    /// A list has the wrong number of entries.
    #[error("{what} has {found} entries instead of {expected}")]
    WrongLength {
        /// Which list.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },
    /// Load steps became too small without Newton's method converging.
    #[error("no convergence between {from_kpa} and {to_kpa} kPa: {cause}")]
    NotConverged {
        /// Last pressure with an equilibrium, kPa.
        from_kpa: f64,
        /// Pressure aimed at, kPa.
        to_kpa: f64,
        /// What happened in the last attempt.
        cause: String,
    },
}
