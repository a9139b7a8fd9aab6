//! Errors of the reference solver.

use pneuflex_mesh::ElementKind;
use pneuflex_model::{Formulation, LoadParameter, OpenCavity};

/// A part of a problem that the reference solver does not model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unmodelled {
    /// A surface that is kept from passing through itself, or through one with which it has nodes in common: the rules by which
    /// the production path tells contact from neighbourhood.
    #[error("self-contact")]
    SelfContact,
    /// Contact with multipliers that are updated until nothing penetrates.
    #[error("contact without penetration (augmented Lagrangian)")]
    PenetrationTolerance,
    /// An overlap at rest that is pressed out.
    #[error("interference (an overlap at rest that is pressed out)")]
    Interference,
    /// Gaps that are averaged.
    #[error("mortar contact (contact.method = \"mortar\")")]
    Mortar,
    /// Nodes that keep their distance, and surfaces that are glued.
    #[error("rigid bodies and glued surfaces")]
    Rigid,
    /// The full invariant in a law that is defined by the isochoric ones.
    #[error("the full invariant in a law other than Yeoh's and neo-Hooke's")]
    FullInvariant,
}

/// Why the reference solver cannot set up or solve a problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// A part of the problem that would be left out.
    #[error("not modelled by the reference solver: {part} ({name})")]
    NotModelled {
        /// What it is.
        part: Unmodelled,
        /// Name of the contact pair or region, or the key, that asks for it.
        name: String,
    },
    /// A cavity with a given volume or gas that encloses no volume.
    #[error(transparent)]
    OpenCavity(#[from] OpenCavity),
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
    #[error("no convergence between the load parameters {from} and {to}: {cause}")]
    NotConverged {
        /// Last position on the load path with an equilibrium.
        from: LoadParameter,
        /// Position aimed at.
        to: LoadParameter,
        /// What happened in the last attempt.
        cause: String,
    },
}
