//! Integration rules and pressure modes of the element formulations.
//!
//! | formulation | deviatoric points | volumetric points | pressure modes ψ |
//! |---|---|---|---|
//! | `hex8-sri` (the paper's) | 2 × 2 × 2 | the centre, with the element's whole volume | 1 |
//! | `hex8-q1p0` | 2 × 2 × 2 | 2 × 2 × 2 | 1 |
//! | `hex20` | 14 (Irons) | 14 (Irons) | 1, ξ, η, ζ |
//! | `hex27` | 3 × 3 × 3 | 3 × 3 × 3 | 1, ξ, η, ζ |
//!
//! All have the volumetric energy ½ κ θᵀ M⁻¹ θ with θᵢ = ∫ ψᵢ (J − 1) dV and Mᵢⱼ = ∫ ψᵢ ψⱼ dV; for one mode that is
//! ½ κ (J̄ − 1)² V.

use pneuflex_mesh::{
    ElementKind,
    mesh::{cofactor, determinant},
    quadrature, shape,
};
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
            Formulation::Hex20 => (quadrature::hexahedron_14(), quadrature::hexahedron_14(), 4),
            Formulation::Hex27 => (quadrature::hexahedron(3), quadrature::hexahedron(3), 4),
        };
        Self {
            kind,
            deviatoric: tabulate(kind, deviatoric),
            volumetric: tabulate(kind, volumetric),
            num_modes,
            is_centre_only: formulation == Formulation::Hex8Sri,
        }
    }
}

/// Tables of an element family at the points of a rule.
pub fn tabulate(kind: ElementKind, rule: Vec<([f64; 3], f64)>) -> Vec<IntegrationPoint> {
    rule.into_iter()
        .map(|(xi, weight)| IntegrationPoint {
            xi,
            weight,
            gradients: shape::tabulate(kind, xi).1,
            modes: [1.0, xi[0], xi[1], xi[2]],
        })
        .collect()
}

/// Gradients ∂N/∂X of an element with reference node positions `x`, and the volume (mm³) its integration point stands for.
///
/// # Panics
/// If the point's table is not that of an element with `N` nodes.
#[inline]
pub fn reference_gradients<const N: usize>(x: &[[f64; 3]; N], point: &IntegrationPoint) -> ([[f64; 3]; N], f64) {
    let table: &[[f64; 3]; N] = point.gradients[..].try_into().expect("tables have one gradient per node");
    let mut jacobian = [[0.0; 3]; 3];
    for a in 0..N {
        for i in 0..3 {
            for j in 0..3 {
                jacobian[i][j] += x[a][i] * table[a][j];
            }
        }
    }
    // ∇N = J⁻ᵀ ∂N/∂ξ = cof(J) ∂N/∂ξ / det J.
    let cof = cofactor(&jacobian);
    let det = determinant(&jacobian);
    let scale = 1.0 / det;
    let gradients = std::array::from_fn(|a| {
        std::array::from_fn(|i| scale * (cof[i][0] * table[a][0] + cof[i][1] * table[a][1] + cof[i][2] * table[a][2]))
    });
    (gradients, point.weight * det)
}

/// Gradient `[i][j] = ∂uᵢ/∂Xⱼ` of a field with nodal values `u`.
#[inline]
pub fn displacement_gradient<const N: usize>(u: &[[f64; 3]; N], gradients: &[[f64; 3]; N]) -> [[f64; 3]; 3] {
    let mut h = [[0.0; 3]; 3];
    for a in 0..N {
        for i in 0..3 {
            for j in 0..3 {
                h[i][j] += u[a][i] * gradients[a][j];
            }
        }
    }
    h
}
