//! Shape functions from nothing but the nodes' reference coordinates.
//!
//! Every family on [−1, 1]ᵈ is spanned by the monomials ξᵃ ηᵇ ζᶜ with exponents up to 2 of which at most `q` may be 2:
//! q = 0 gives hex8 and quad4, q = 1 the serendipity families hex20 and quad8, q = d the full ones hex27 and quad9.
//! tet10 and tri6 on the unit simplex are spanned by the monomials of total degree up to 2, tet15 and tri7 by these and sums of others.
//! Nᵢ(ξⱼ) = δᵢⱼ then fixes the coefficients: the inverse of the Vandermonde matrix of the nodes.

use nalgebra::DMatrix;
use pneuflex_mesh::{ElementKind, FaceKind, Facet};
use pneuflex_model::Problem;

use crate::elements::{self, Span};
use crate::error::ReferenceError;

use crate::differentiate::Dual;

/// Shape functions of an element (`DIM` = 3) or a face (`DIM` = 2).
#[derive(Clone, Debug)]
pub struct ShapeFunctions<const DIM: usize> {
    // Sums of monomials, by their exponents.
    functions: Vec<Vec<[usize; DIM]>>,
    // Row i holds the coefficients of Nᵢ.
    coefficients: DMatrix<f64>,
}

impl ShapeFunctions<3> {
    /// Shape functions of a solid element; `None` if they are not determined by the nodes.
    pub fn of_element(kind: ElementKind) -> Option<Self> {
        Self::from_nodes(kind.nodes, elements::span_of_element(kind))
    }
}

impl ShapeFunctions<2> {
    /// Shape functions of a face; `None` if they are not determined by the nodes.
    pub fn of_face(kind: FaceKind) -> Option<Self> {
        Self::from_nodes(kind.nodes, elements::span_of_face(kind))
    }
}

/// Family and shape functions of a face of a problem's mesh.
///
/// # Errors
/// Functions that are not determined by the nodes.
pub fn face_functions(problem: &Problem, facet: Facet) -> Result<(FaceKind, ShapeFunctions<2>), ReferenceError> {
    let kind = problem.mesh.face_kind(facet);
    let found = problem.mesh.kind_of(facet.element as usize);
    let wrong = || ReferenceError::WrongElement { formulation: problem.formulation, found };
    Ok((kind, ShapeFunctions::of_face(kind).ok_or_else(wrong)?))
}

impl<const DIM: usize> ShapeFunctions<DIM> {
    fn from_nodes(nodes: &[[f64; DIM]], span: Span) -> Option<Self> {
        let functions: Vec<Vec<[usize; DIM]>> = span.functions();
        let monomial = |exponents: &[usize; DIM], i: usize| -> f64 {
            (0..DIM).map(|d| nodes[i][d].powi(exponents[d] as i32)).product()
        };
        let vandermonde = DMatrix::from_fn(functions.len(), nodes.len(), |m, i| {
            functions[m].iter().map(|exponents| monomial(exponents, i)).sum()
        });
        vandermonde.try_inverse().map(|coefficients| Self { functions, coefficients })
    }

    /// Number of nodes.
    pub fn num_nodes(&self) -> usize {
        self.coefficients.nrows()
    }

    /// Derivatives of all Nᵢ at `xi`, `orders[d]` times with respect to coordinate d; all zero for the values themselves.
    pub fn derivatives<D: Dual>(&self, orders: [usize; DIM], xi: &[D; DIM]) -> Vec<D> {
        let monomial = |exponents: &[usize; DIM]| {
            (0..DIM).fold(D::from(1.0), |product, d| product * power(xi[d], exponents[d], orders[d]))
        };
        let sum = |terms: &Vec<[usize; DIM]>| terms.iter().fold(D::from(0.0), |sum, term| sum + monomial(term));
        let functions: Vec<D> = self.functions.iter().map(sum).collect();
        (0..self.num_nodes())
            .map(|i| {
                functions.iter().zip(self.coefficients.row(i).iter()).fold(D::from(0.0), |sum, (m, &c)| sum + *m * c)
            })
            .collect()
    }

    /// Nᵢ at `xi`.
    pub fn values(&self, xi: &[f64; DIM]) -> Vec<f64> {
        self.derivatives([0; DIM], xi)
    }

    /// ∂Nᵢ/∂ξ at `xi`.
    pub fn gradients(&self, xi: &[f64; DIM]) -> Vec<[f64; DIM]> {
        let along: Vec<Vec<f64>> = (0..DIM)
            .map(|d| {
                let mut orders = [0; DIM];
                orders[d] = 1;
                self.derivatives(orders, xi)
            })
            .collect();
        (0..self.num_nodes()).map(|i| std::array::from_fn(|d| along[d][i])).collect()
    }
}

/// dᵏ/dxᵏ of xᵃ for a ≤ 2.
fn power<D: Dual>(x: D, exponent: usize, order: usize) -> D {
    match (exponent, order) {
        (0, 0) => D::from(1.0),
        (1, 0) => x,
        (2, 0) => x * x,
        (1, 1) => D::from(1.0),
        (2, 1) => x * 2.0,
        (2, 2) => D::from(2.0),
        _ => D::from(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_are_one_at_their_node_and_sum_to_one() {
        for kind in ElementKind::ALL {
            let shape = ShapeFunctions::of_element(kind).unwrap();
            for (j, node) in kind.nodes.iter().enumerate() {
                for (i, value) in shape.values(node).iter().enumerate() {
                    assert!((value - f64::from(i == j)).abs() < 1e-13, "{kind:?} N{i} at node {j}: {value}");
                }
            }
            let sum: f64 = shape.values(&[0.3, -0.2, 0.7]).iter().sum();
            assert!((sum - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn a_face_is_the_trace_of_its_element() {
        for kind in ElementKind::ALL {
            let (shape, nodes) = (ShapeFunctions::of_element(kind).unwrap(), kind.nodes);
            for local in 0..kind.num_faces() {
                let face = ShapeFunctions::of_face(kind.face_kind(local)).unwrap();
                let on_face = face.values(&[0.3, 0.6]);
                let ids = kind.face_nodes(local);
                let point: [f64; 3] =
                    std::array::from_fn(|d| ids.iter().zip(&on_face).map(|(&n, v)| v * nodes[n][d]).sum());
                let in_element = shape.values(&point);
                for (&n, v) in ids.iter().zip(&on_face) {
                    assert!((in_element[n] - v).abs() < 1e-13, "{kind:?} face {local}");
                }
            }
        }
    }

    #[test]
    fn derivatives_match_finite_differences() {
        let (h, xi) = (1e-5_f64, [0.31, -0.47]);
        for kind in [FaceKind::Quad9, FaceKind::Tri6, FaceKind::Tri7] {
            let shape = ShapeFunctions::of_face(kind).unwrap();
            for (orders, d) in [[0, 0], [1, 0], [0, 1]].into_iter().flat_map(|orders| [(orders, 0), (orders, 1)]) {
                let (mut low, mut high, mut next) = (xi, xi, orders);
                low[d] -= h;
                high[d] += h;
                next[d] += 1;
                let (low, high) = (shape.derivatives(orders, &low), shape.derivatives(orders, &high));
                for (i, exact) in shape.derivatives(next, &xi).iter().enumerate() {
                    assert!((exact - (high[i] - low[i]) / (2.0 * h)).abs() < 1e-9);
                }
            }
        }
    }
}
