//! Integration rules and pressure modes of the element formulations.
//!
//! | formulation | deviatoric points | volumetric points | pressure modes ψ |
//! |---|---|---|---|
//! | `hex8-sri` (the paper's) | 2 × 2 × 2 | the centre, with the element's whole volume | 1 |
//! | `hex8-q1p0` | 2 × 2 × 2 | 2 × 2 × 2 | 1 |
//! | `hex20` | 2 × 2 × 2 | 3 × 3 × 3 | 1, ξ, η, ζ |
//! | `hex27` | 3 × 3 × 3 | 3 × 3 × 3 | 1, ξ, η, ζ |
//!
//! All have the volumetric energy ½ κ θᵀ M⁻¹ θ with θᵢ = ∫ ψᵢ (J − 1) dV and Mᵢⱼ = ∫ ψᵢ ψⱼ dV; for one mode that is
//! ½ κ (J̄ − 1)² V.

use pneuflex_mesh::{ElementKind, quadrature, shape};
use pneuflex_model::Formulation;

/// Shape functions tabulated at the integration points of a formulation.
#[derive(Clone, Debug)]
pub struct ReferenceElement {
    /// Element family.
    pub kind: ElementKind,
    /// Points of the deviatoric energy.
    pub deviatoric: Vec<IntegrationPoint>,
    /// Points of the volumetric energy.
    pub volumetric: Vec<IntegrationPoint>,
    /// Number of pressure modes: 1 or 4.
    pub num_modes: usize,
    /// Whether the single volumetric point stands for the element's whole volume.
    pub is_centre_only: bool,
}

/// One integration point of the reference element.
#[derive(Clone, Debug)]
pub struct IntegrationPoint {
    /// Reference coordinates.
    pub xi: [f64; 3],
    /// Weight on the reference element.
    pub weight: f64,
    /// ∂Nᵢ/∂ξ, one per node.
    pub gradients: Vec<[f64; 3]>,
    /// Pressure modes ψ = (1, ξ, η, ζ).
    pub modes: [f64; 4],
}

impl ReferenceElement {
    /// The tables of a formulation.
    pub fn new(formulation: Formulation) -> Self {
        let kind = formulation.element_kind();
        let (deviatoric, volumetric, num_modes) = match formulation {
            Formulation::Hex8Sri => (quadrature::hexahedron(2), vec![([0.0; 3], 8.0)], 1),
            Formulation::Hex8Q1p0 => (quadrature::hexahedron(2), quadrature::hexahedron(2), 1),
            Formulation::Hex20 => (quadrature::hexahedron(2), quadrature::hexahedron(3), 4),
            Formulation::Hex27 => (quadrature::hexahedron(3), quadrature::hexahedron(3), 4),
        };
        let table = |rule: Vec<([f64; 3], f64)>| {
            rule.into_iter()
                .map(|(xi, weight)| IntegrationPoint {
                    xi,
                    weight,
                    gradients: shape::tabulate(kind, xi).1,
                    modes: [1.0, xi[0], xi[1], xi[2]],
                })
                .collect()
        };
        Self {
            kind,
            deviatoric: table(deviatoric),
            volumetric: table(volumetric),
            num_modes,
            is_centre_only: formulation == Formulation::Hex8Sri,
        }
    }
}
