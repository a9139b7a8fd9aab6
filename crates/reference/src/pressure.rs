//! Air pressure as a follower load: the energy −p V_air (theory §4).
//!
//! The facets' normals n point out of the solid, into the air, so V_air = −⅓ ∮ r · n dS. More generally
//! V_air = −∮ (a x n_x + b y n_y + c z n_z) dS with a + b + c = 1. The weights matter only where the loaded surface is
//! open, cut by a plane: the plane's own share must vanish. With a third each that holds for planes through the origin,
//! such as the symmetry plane y = 0 of the half model. For any other plane across an axis, give that axis the weight 0.
//! With all weight on y and y counted from the plane of symmetry y = const, walls that end in planes of symmetry across any axis
//! enclose the right volume ([`ACROSS_Y`]); and its gradient has no forces on the rim but those of the pressure.

use nalgebra::{DMatrix, DVector};
use pneuflex_mesh::Facet;
use pneuflex_model::Problem;

use crate::differentiate::{Differentiable, Dual, Energy, LinearMap, Term, cross, vector};
use crate::elements;
use crate::error::ReferenceError;
use crate::shape::face_functions;

/// Weights (a, b, c) of a closed surface, or one cut by planes through the origin only.
pub const CLOSED: [f64; 3] = [1.0 / 3.0; 3];

/// Weights (a, b, c) of a surface that ends in planes of symmetry, at most one of them across y.
pub const ACROSS_Y: [f64; 3] = [0.0, 1.0, 0.0];

/// One facet point's share of V_air; v holds r, r_ξ, r_η.
#[derive(Clone, Debug)]
struct VolumePoint {
    weight: f64,
    axes: [f64; 3],
    // Coordinate y of the plane of symmetry, mm.
    plane_y: f64,
}

impl Energy<9> for VolumePoint {
    fn energy<D: Dual>(&self, v: &[D; 9]) -> D {
        let (mut r, n) = (vector(v, 0), cross(vector(v, 1), vector(v, 2)));
        r[1] -= self.plane_y;
        (0..3).fold(D::from(0.0), |sum, i| sum - r[i] * n[i] * (self.axes[i] * self.weight))
    }
}

/// The air behind a surface.
#[derive(Clone, Debug)]
pub struct AirModel {
    num_dofs: usize,
    terms: Vec<Term<9, VolumePoint>>,
}

impl AirModel {
    /// Air behind some facets of the problem's mesh, with the volume weights `axes` (a, b, c), see [`CLOSED`], and y counted from
    /// `plane_y` (mm).
    ///
    /// The rules are exact ([`elements::face_rule`]).
    ///
    /// # Errors
    /// An element family without a formulation.
    pub fn new(problem: &Problem, facets: &[Facet], axes: [f64; 3], plane_y: f64) -> Result<Self, ReferenceError> {
        let mesh = &problem.mesh;
        let mut terms = Vec::new();
        for &facet in facets {
            let (kind, shape) = face_functions(problem, facet)?;
            for (xi, weight) in elements::face_rule(kind) {
                let rows = [[0, 0], [1, 0], [0, 1]].map(|orders| shape.derivatives(orders, &xi));
                let map = LinearMap::of_positions(&mesh.facet_nodes(facet), &mesh.nodes, &rows);
                terms.push(Term { energy: VolumePoint { weight, axes, plane_y }, map });
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

#[cfg(test)]
mod tests {
    use pneuflex_mesh::{Actuator, Part};
    use pneuflex_model::{ContactMethod, Formulation};

    use super::*;
    use crate::testing::{block, body, check_derivatives, displacement, material, noise, two_chambers};

    #[test]
    fn air_of_the_half_model_has_its_volume_at_rest_and_under_affine_maps() {
        for formulation in Formulation::ALL {
            let problem = two_chambers([8.0, 9.0, 8.0], 2.0, formulation, ContactMethod::None);
            let air = AirModel::new(&problem, &problem.cavity_facets(), CLOSED, 0.0).unwrap();
            // Two cavities, the channel's open part below them and its roofed part between them.
            let volume = 2.0 * 6.0 * 9.0 * 8.0 + 2.0 * 12.0 + 4.0;
            assert!((air.volume(&vec![0.0; problem.num_dofs()]) - volume).abs() < 1e-9);
            // y = 0 stays a plane through the origin; determinant 1.1 · 0.9 · 1.3.
            let u = displacement(&problem.mesh, |[x, y, z]| {
                [1.1 * x + 0.2 * y + 0.1 * z + 5.0, 0.9 * y, 0.3 * y + 1.3 * z - 2.0]
            });
            assert!((air.volume(&u) - volume * 1.1 * 0.9 * 1.3).abs() < 1e-9);
        }
    }

    #[test]
    fn work_of_the_pressure_is_pressure_times_change_of_volume() {
        let problem = two_chambers([8.0, 9.0, 8.0], 2.0, Formulation::Hex20, ContactMethod::None);
        let air = AirModel::new(&problem, &problem.cavity_facets(), CLOSED, 0.0).unwrap();
        let (u, p) = (noise(problem.num_dofs(), 0.2), 0.035);
        // ∫ Q_p · du along a straight path; forces are quadratic in the path's parameter, two Gauss points are exact.
        let work: f64 = crate::quadrature::gauss(2)
            .iter()
            .map(|&(t, w)| {
                let at: Vec<f64> = u.iter().map(|u| 0.5 * (1.0 + t) * u).collect();
                -0.5 * w * air.gradient(&at, p).dot(&DVector::from_column_slice(&u))
            })
            .sum();
        let change = air.volume(&u) - air.volume(&vec![0.0; u.len()]);
        assert!(change.abs() > 1.0 && (work - p * change).abs() < 1e-12, "{work}, {}", p * change);
    }

    #[test]
    fn derivatives_in_a_deformed_state() {
        for formulation in Formulation::ALL {
            let mesh = block(formulation, [1.0, 1.2, 0.8], [2, 1, 1], 0.05);
            let mut problem = body(mesh, formulation, material(pneuflex_model::Invariant::Isochoric));
            let open = problem.mesh.boundary_facets()[1..4].to_vec();
            problem.inflate("open", open);
            let air = AirModel::new(&problem, &problem.cavity_facets(), CLOSED, 0.0).unwrap();
            let u = noise(problem.num_dofs(), 0.1);
            check_derivatives(|u| air.energy(u, 0.3), |u| air.gradient(u, 0.3), |u| air.hessian(u, 0.3), &u);
        }
    }

    /// A closed surface has no resultant, whatever its shape; here the cavities of a whole model.
    #[test]
    fn a_closed_cavity_has_no_resultant() {
        let actuator = Actuator { part: Part::Whole, ..Actuator::two_chambers() };
        let problem = pneuflex_model::Problem::from_actuator(
            &actuator,
            &pneuflex_mesh::MeshSize::per_axis([8.0, 9.0, 8.0]),
            Formulation::Hex8Sri,
            pneuflex_model::Material::default(),
            pneuflex_model::Contact::default(),
        )
        .unwrap();
        let air = AirModel::new(&problem, &problem.cavity_facets(), CLOSED, 0.0).unwrap();
        let force = air.gradient(&noise(problem.num_dofs(), 0.3), 1.0);
        assert!(force.norm() > 1.0);
        for axis in 0..3 {
            assert!(force.iter().skip(axis).step_by(3).sum::<f64>().abs() < 1e-10);
        }
    }
}
