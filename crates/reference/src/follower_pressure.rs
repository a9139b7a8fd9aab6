//! Pressure on faces whose rim is anywhere: there is no potential, but the virtual work is still a scalar (theory §4).
//!
//! With the normals n out of the solid, a pressure p does the virtual work −p ∫ n · δr da = −p ∫ (r_ξ × r_η) · δr dξ dη. It is
//! linear in δr: its derivative by δr is the force, the derivative of that by r the tangent, which is not symmetric where the rim
//! is free.

use nalgebra::{DMatrix, DVector};
use pneuflex_mesh::Facet;
use pneuflex_model::Problem;

use crate::differentiate::{Dual, Energy, LinearMap, cross, dot, gradient_of, hessian_of, vector};
use crate::elements;
use crate::error::ReferenceError;
use crate::shape::face_functions;

/// Minus the virtual work of a unit pressure at one facet point; v holds δr, r_ξ, r_η.
#[derive(Clone, Debug)]
struct VirtualWork {
    weight: f64,
}

impl Energy<9> for VirtualWork {
    fn energy<D: Dual>(&self, v: &[D; 9]) -> D {
        dot(vector(v, 0), cross(vector(v, 1), vector(v, 2))) * self.weight
    }
}

/// Faces under a pressure that follows them.
#[derive(Clone, Debug)]
pub struct FollowerPressure {
    num_dofs: usize,
    // The maps give r, r_ξ, r_η; the coefficients of δr are those of r.
    points: Vec<(VirtualWork, LinearMap<9>)>,
}

impl FollowerPressure {
    /// Pressure on some facets of the problem's mesh.
    ///
    /// # Errors
    /// An element family without a formulation.
    pub fn new(problem: &Problem, facets: &[Facet]) -> Result<Self, ReferenceError> {
        let mesh = &problem.mesh;
        let mut points = Vec::new();
        for &facet in facets {
            let (kind, shape) = face_functions(problem, facet)?;
            for (xi, weight) in elements::face_rule(kind) {
                let rows = [[0, 0], [1, 0], [0, 1]].map(|orders| shape.derivatives(orders, &xi));
                let map = LinearMap::of_positions(&mesh.facet_nodes(facet), &mesh.nodes, &rows);
                points.push((VirtualWork { weight }, map));
            }
        }
        Ok(Self { num_dofs: problem.num_dofs(), points })
    }

    /// Minus the forces of the pressure `p` (MPa) at displacements `u`, N.
    pub fn gradient(&self, u: &[f64], p: f64) -> DVector<f64> {
        let mut gradient = DVector::zeros(self.num_dofs);
        for (work, map) in &self.points {
            let (_, by_v) = gradient_of(work, &map.apply(u));
            let local = map.matrix.rows(0, 3).tr_mul(&by_v.rows(0, 3)) * p;
            map.dofs.iter().zip(local.iter()).for_each(|(&dof, value)| gradient[dof] += value);
        }
        gradient
    }

    /// The derivative of [`Self::gradient`] by `u`, N/mm.
    pub fn tangent(&self, u: &[f64], p: f64) -> DMatrix<f64> {
        let mut tangent = DMatrix::zeros(self.num_dofs, self.num_dofs);
        for (work, map) in &self.points {
            let (_, _, by_v) = hessian_of(work, &map.apply(u));
            let change_of_normal = by_v.view((0, 3), (3, 6)) * map.matrix.rows(3, 6);
            let local = map.matrix.rows(0, 3).tr_mul(&change_of_normal) * p;
            for (j, &column) in map.dofs.iter().enumerate() {
                for (i, &row) in map.dofs.iter().enumerate() {
                    tangent[(row, column)] += local[(i, j)];
                }
            }
        }
        tangent
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_model::{Formulation, Invariant};

    use super::*;
    use crate::pressure::{AirModel, CLOSED};
    use crate::testing::{block, body, material, noise};

    #[test]
    fn the_tangent_is_the_derivative_of_the_forces_and_symmetric_on_closed_surfaces_only() {
        for formulation in Formulation::ALL {
            let mesh = block(formulation, [1.0, 1.2, 0.8], [2, 1, 1], 0.05);
            let problem = body(mesh, formulation, material(Invariant::Isochoric));
            let all = problem.mesh.boundary_facets();
            for (facets, is_closed) in [(&all[..], true), (&all[1..4], false)] {
                let pressure = FollowerPressure::new(&problem, facets).unwrap();
                let u = noise(problem.num_dofs(), 0.1);
                let (force, tangent) = (pressure.gradient(&u, 0.3), pressure.tangent(&u, 0.3));
                assert!(force.norm() > 1e-2);
                let direction = DVector::from_fn(u.len(), |i, _| (i as f64 * 1.7).sin());
                let at = |t: f64| -> Vec<f64> { u.iter().zip(direction.iter()).map(|(u, d)| u + t * d).collect() };
                let change = (pressure.gradient(&at(1e-5), 0.3) - pressure.gradient(&at(-1e-5), 0.3)) / 2e-5;
                let exact = &tangent * &direction;
                assert!((change - &exact).norm() < 1e-8 * exact.norm());
                let skew = (&tangent - tangent.transpose()).norm() / tangent.norm();
                assert_eq!(skew < 1e-12, is_closed, "{formulation}: {skew:.1e}");
                // Behind a closed surface there is a potential, with the same forces.
                if is_closed {
                    let air = AirModel::new(&problem, facets, CLOSED, 0.0).unwrap();
                    assert!((air.gradient(&u, 0.3) - &force).norm() < 1e-13 * force.norm());
                }
            }
        }
    }
}
