//! Closest points of facets, and the penalty of a distance.

use pneuflex_mesh::{FaceKind, Outline};

use crate::differentiate::{Dual, cross, dot, minus, normalised};
use crate::shape::ShapeFunctions;

/// Convergence of the projection in (ξ, η).
const PROJECTION_TOLERANCE: f64 = 1e-12;
const PROJECTION_ITERATIONS: usize = 50;

/// ½ k A ⟨−d⟩² with the stiffness k A, N/mm.
pub fn penalty<D: Dual>(stiffness: f64, d: D) -> D {
    if d < 0.0 { d * d * (0.5 * stiffness) } else { D::from(0.0) }
}

/// d = (r_s − r_m) · n_m.
pub fn distance<D: Dual>(slave: [D; 3], master: [D; 3], along_xi: [D; 3], along_eta: [D; 3]) -> D {
    dot(minus(slave, master), normalised(cross(along_xi, along_eta)))
}

/// Σ cₐ rₐ.
pub fn interpolate<D: Dual>(nodes: &[[D; 3]], coefficients: &[D]) -> [D; 3] {
    std::array::from_fn(|i| nodes.iter().zip(coefficients).fold(D::from(0.0), |sum, (r, &c)| sum + r[i] * c))
}

/// Newton step of minimising ½ ‖r_s − r_m(ξ, η)‖² over the facet's (extended) surface.
pub fn projection_step<D: Dual>(shape: &ShapeFunctions<2>, slave: [D; 3], nodes: &[[D; 3]], xi: &[D; 2]) -> [D; 2] {
    let r = |orders: [usize; 2]| interpolate(nodes, &shape.derivatives(orders, xi));
    let offset = minus(r([0, 0]), slave);
    let tangents = [r([1, 0]), r([0, 1])];
    let curvatures = [r([2, 0]), r([1, 1]), r([0, 2])];
    let g = tangents.map(|t| dot(offset, t));
    let h = |a: usize, b: usize| dot(tangents[a], tangents[b]) + dot(offset, curvatures[a + b]);
    let determinant = h(0, 0) * h(1, 1) - h(0, 1) * h(0, 1);
    [(h(0, 1) * g[1] - h(1, 1) * g[0]) / determinant, (h(0, 1) * g[0] - h(0, 0) * g[1]) / determinant]
}

/// Closest point of the facet's extended surface by Newton's method from `start`; `None` without convergence.
pub fn project(shape: &ShapeFunctions<2>, start: [f64; 2], r_s: [f64; 3], nodes: &[[f64; 3]]) -> Option<[f64; 2]> {
    let mut xi = start;
    for _ in 0..PROJECTION_ITERATIONS {
        let step = projection_step(shape, r_s, nodes, &xi);
        xi = [xi[0] + step[0], xi[1] + step[1]];
        if step.iter().all(|s| s.abs() < PROJECTION_TOLERANCE) {
            return Some(xi);
        }
    }
    None
}

/// (ξ, η) of a facet's centre.
pub fn centre(kind: FaceKind) -> [f64; 2] {
    if kind.outline == Outline::Triangle { [1.0 / 3.0; 2] } else { [0.0; 2] }
}

/// How far (ξ, η) lies outside the facet; negative inside.
pub fn excess(kind: FaceKind, &[xi, eta]: &[f64; 2]) -> f64 {
    let over_sides = match kind.outline {
        Outline::Triangle => [-xi, -eta, xi + eta - 1.0],
        Outline::Square => [xi.abs() - 1.0, eta.abs() - 1.0, -1.0],
    };
    over_sides.into_iter().fold(f64::NEG_INFINITY, f64::max)
}
