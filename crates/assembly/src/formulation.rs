//! Integration rules and pressure modes of the element formulations.
//!
//! | formulation | deviatoric points | volumetric points | pressure modes ψ |
//! |---|---|---|---|
//! | `hex8-sri` (the paper's) | 2 × 2 × 2 | the centre, with the element's whole volume | 1 |
//! | `hex8-q1p0` | 2 × 2 × 2 | 2 × 2 × 2 | 1 |
//! | `hex20` | 14 (Irons) | 14 (Irons) | 1, ξ, η, ζ |
//! | `hex27` | 3 × 3 × 3 | 3 × 3 × 3 | 1, ξ, η, ζ |
//! | `tet10` | 4 (degree 2) | 8 (degree 3) | 1 |
//! | `tet15` | 14 (degree 5) | 14 | 1, ξ, η, ζ |
//! | `wedge21` | 7 × 3 (degree 5) | 7 × 3 | 1, ξ, η, ζ |
//!
//! All have the volumetric energy ½ κ θᵀ M⁻¹ θ with θᵢ = ∫ ψᵢ (J − 1) dV and Mᵢⱼ = ∫ ψᵢ ψⱼ dV; for one mode that is
//! ½ κ (J̄ − 1)² V.
//!
//! # Tetrahedra
//!
//! `tet10` is the pair P2–P0: continuous quadratic displacements and a pressure constant in each element. The constant pressure
//! bounds the order of the strains to O(h). In the plane the pair is inf-sup stable, because mid-edge nodes control the
//! flux through every side; in space P2 lacks the nodes at the centres of faces that would do this (Boffi, Brezzi & Fortin
//! 2013, *Mixed Finite Element Methods and Applications*, ch. 8). Measured on Kuhn's tetrahedra
//! (`tests/integration/eigenvalues.rs`), the inf-sup constant falls like h, as that of `hex8-q1p0` does: there is no locking, as
//! pressures are few (6 per 24 displacements), but pressures of single elements may oscillate, so read them averaged at the nodes.
//!
//! On straight-sided tetrahedra the gradients are linear, and four points integrate the stiffness at rest exactly. But the
//! isochoric energy is blind to conformal maps, of which three are quadratic (2 (a·X) X − a |X|²), and their change of
//! volume has the mean zero about the centroid, so the constant pressure is blind to them, too: with the two energies
//! alone a free element has nine zero eigenvalues, whatever the rule. So a part κ_f of the bulk modulus, the shear modulus at rest
//! (`Formulation::fluctuation_modulus`), is integrated at the four points, ½ κ_f ∫ (J − 1)² dV, and κ − κ_f is left for the mean: together
//! ½ κ (J̄ − 1)² V + ½ κ_f ∫ (J − J̄)² dV. That leaves six zero eigenvalues, and cannot lock, as κ_f does not grow with κ.
//!
//! det ∂r/∂ξ is a cubic: the eight points integrate θ exactly, also on curved elements.
//!
//! `tet15` has the bubbles that P2 lacks, in faces and cells, and a linear pressure: it is inf-sup stable. So is `wedge21`, the triangle with
//! its bubble times a line, and bodies of `hex27`, `wedge21` and `tet15`.
//!
//! # Full invariant
//!
//! At rest the pressure is −2 C₁₀ then, which multiplies the second derivative of J at every point, while κ sees the projection of J only:
//! where the modes see nothing, 8 C₂₀ − ⅓ μ is left of the energy of a change of volume. Where that is negative, quadratic elements have
//! as much in κ_f (theory §10).

use pneuflex_mesh::{
    ElementKind,
    mesh::{cofactor, determinant},
    shape,
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
    /// Whether the deviatoric and the volumetric points are the same.
    pub shares_points: bool,
}

/// One integration point of the reference element.
#[derive(Clone, Debug)]
pub struct IntegrationPoint {
    /// Reference coordinates.
    pub xi: [f64; 3],
    /// Weight on the reference element.
    pub weight: f64,
    /// Nᵢ, one per node.
    pub values: Vec<f64>,
    /// ∂Nᵢ/∂ξ, one per node.
    pub gradients: Vec<[f64; 3]>,
    /// The same, direction by direction in groups of [`LANES`] nodes, filled up with zeros.
    pub lanes: Vec<[f64; LANES]>,
    /// Pressure modes ψ = (1, ξ, η, ζ).
    pub modes: [f64; 4],
}

/// Nodes that the kernels handle together.
pub const LANES: usize = 4;

impl ReferenceElement {
    /// The tables of a formulation.
    pub fn new(formulation: Formulation) -> Self {
        let kind = formulation.element;
        let (deviatoric, volumetric) = ((formulation.deviatoric_rule)(), (formulation.volumetric_rule)());
        Self {
            kind,
            shares_points: deviatoric == volumetric,
            deviatoric: tabulate(kind, deviatoric),
            volumetric: tabulate(kind, volumetric),
            num_modes: formulation.num_modes,
            is_centre_only: formulation.is_centre_only,
        }
    }
}

/// Tables of an element family at the points of a rule.
pub fn tabulate(kind: ElementKind, rule: Vec<([f64; 3], f64)>) -> Vec<IntegrationPoint> {
    rule.into_iter()
        .map(|(xi, weight)| {
            let (values, gradients) = shape::tabulate(kind, xi);
            let groups = gradients.len().div_ceil(LANES);
            let mut lanes = vec![[0.0; LANES]; 3 * groups];
            for (a, gradient) in gradients.iter().enumerate() {
                for k in 0..3 {
                    lanes[k * groups + a / LANES][a % LANES] = gradient[k];
                }
            }
            IntegrationPoint { xi, weight, values, gradients, lanes, modes: [1.0, xi[0], xi[1], xi[2]] }
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
