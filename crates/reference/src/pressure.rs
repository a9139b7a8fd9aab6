//! Air pressure as a follower load: the energy −p V_air (theory §4).
//!
//! The facets' normals n point out of the solid, into the air, so V_air = −⅓ ∮ r · n dS. More generally
//! V_air = −∮ (a x n_x + b y n_y + c z n_z) dS with a + b + c = 1. The weights matter only where the loaded surface is
//! open, cut by a plane: the plane's own share must vanish. With a third each that holds for planes through the origin,
//! such as the symmetry plane y = 0 of the half model. For any other plane across an axis, give that axis the weight 0.

use nalgebra::{DMatrix, DVector};
use pneuflex_model::Problem;

use crate::differentiate::{Differentiable, Dual, Energy, LinearMap, Term, cross, vector};
use crate::error::ReferenceError;
use crate::quadrature;
use crate::shape::ShapeFunctions;

/// Weights (a, b, c) of a closed surface, or one cut by planes through the origin only.
pub const CLOSED: [f64; 3] = [1.0 / 3.0; 3];

/// One facet point's share of V_air; v holds r, r_ξ, r_η.
#[derive(Clone, Debug)]
struct VolumePoint {
    weight: f64,
    axes: [f64; 3],
}

impl Energy<9> for VolumePoint {
    fn energy<D: Dual>(&self, v: &[D; 9]) -> D {
        let (r, n) = (vector(v, 0), cross(vector(v, 1), vector(v, 2)));
        (0..3).fold(D::from(0.0), |sum, i| sum - r[i] * n[i] * (self.axes[i] * self.weight))
    }
}

/// The air in the cavities.
#[derive(Clone, Debug)]
pub struct AirModel {
    num_dofs: usize,
    terms: Vec<Term<9, VolumePoint>>,
}

impl AirModel {
    /// Air behind the problem's pressure facets, with the volume weights `axes` (a, b, c); see [`CLOSED`].
    ///
    /// The rules are exact: 2×2 points on quad4, 3×3 on quad8 and quad9.
    ///
    /// # Errors
    /// An element family without a formulation.
    pub fn new(problem: &Problem, axes: [f64; 3]) -> Result<Self, ReferenceError> {
        let mesh = &problem.mesh;
        let wrong = ReferenceError::WrongElement { formulation: problem.formulation, found: mesh.kind };
        let shape = ShapeFunctions::of_face(mesh.face_kind()).ok_or(wrong)?;
        let rule = quadrature::tensor(if mesh.kind.is_quadratic() { 3 } else { 2 });
        let mut terms = Vec::new();
        for &facet in &problem.pressure_facets {
            for (xi, weight) in &rule {
                let rows = [[0, 0], [1, 0], [0, 1]].map(|orders| shape.derivatives(orders, xi));
                let map = LinearMap::of_positions(&mesh.facet_nodes(facet), &mesh.nodes, &rows);
                terms.push(Term { energy: VolumePoint { weight: *weight, axes }, map });
            }
        }
        Ok(Self { num_dofs: problem.num_dofs(), terms })
    }

    /// V_air at displacements `u`, mm³.
    pub fn volume(&self, u: &[f64]) -> f64 {
        self.terms.iter().map(|term| term.value(u)).sum()
    }

    /// −p V_air, N·mm; `p` in MPa.
    pub fn energy(&self, u: &[f64], p: f64) -> f64 {
        -p * self.volume(u)
    }

    /// ∂energy/∂u, N: minus the pressure forces, −Q_p of theory §6.
    pub fn gradient(&self, u: &[f64], p: f64) -> DVector<f64> {
        let mut gradient = DVector::zeros(self.num_dofs);
        self.terms.iter().for_each(|term| term.add_gradient(u, -p, &mut gradient));
        gradient
    }

    /// ∂²energy/∂u², N/mm.
    pub fn hessian(&self, u: &[f64], p: f64) -> DMatrix<f64> {
        let mut hessian = DMatrix::zeros(self.num_dofs, self.num_dofs);
        self.terms.iter().for_each(|term| term.add_hessian(u, -p, &mut hessian));
        hessian
    }
}
