//! Shape functions and their reference gradients (Zienkiewicz & Taylor, *The Finite Element Method*, vol. 1, ch. 4).

use crate::element::{ElementKind, FaceKind};

/// Evaluates the shape functions of a solid element.
///
/// `xi` is the reference point. `values` (one per node) and `gradients` (∂Nᵢ/∂ξ, one per node) are overwritten.
///
/// # Panics
/// If the slices are shorter than the element's number of nodes.
pub fn evaluate(kind: ElementKind, xi: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    match kind {
        ElementKind::Hex8 => hex8(xi, values, gradients),
        ElementKind::Hex20 => hex20(xi, values, gradients),
        ElementKind::Hex27 => hex27(xi, values, gradients),
        ElementKind::Tet10 => tet10(xi, values, gradients),
    }
}

/// Shape functions of a solid element as owned vectors: values and gradients, one per node.
pub fn tabulate(kind: ElementKind, xi: [f64; 3]) -> (Vec<f64>, Vec<[f64; 3]>) {
    let mut values = vec![0.0; kind.num_nodes()];
    let mut gradients = vec![[0.0; 3]; kind.num_nodes()];
    evaluate(kind, xi, &mut values, &mut gradients);
    (values, gradients)
}

/// Values, first and second derivatives of face shape functions at one point.
///
/// Only the first `num_nodes` entries are meaningful; the fixed size avoids allocation in the contact search.
#[derive(Clone, Copy, Debug)]
pub struct FaceShape {
    /// Nᵢ.
    pub values: [f64; 9],
    /// \[∂Nᵢ/∂ξ, ∂Nᵢ/∂η\].
    pub gradients: [[f64; 2]; 9],
    /// \[∂²Nᵢ/∂ξ², ∂²Nᵢ/∂ξ∂η, ∂²Nᵢ/∂η²\].
    pub hessians: [[f64; 3]; 9],
}

/// Evaluates the shape functions of a face at the reference point `xi`.
pub fn evaluate_face(kind: FaceKind, xi: [f64; 2]) -> FaceShape {
    match kind {
        FaceKind::Quad4 => quad4(xi),
        FaceKind::Quad8 => quad8(xi),
        FaceKind::Quad9 => quad9(xi),
        FaceKind::Tri6 => tri6(xi),
    }
}

fn hex8([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    for (i, [a, b, c]) in HEX_SIGNS[..8].iter().copied().enumerate() {
        let (u, v, w) = (1.0 + a * x, 1.0 + b * y, 1.0 + c * z);
        values[i] = 0.125 * u * v * w;
        gradients[i] = [0.125 * a * v * w, 0.125 * b * u * w, 0.125 * c * u * v];
    }
}

fn hex20([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    for (i, [a, b, c]) in HEX_SIGNS[..20].iter().copied().enumerate() {
        let (u, v, w) = (1.0 + a * x, 1.0 + b * y, 1.0 + c * z);
        if i < 8 {
            let s = a * x + b * y + c * z - 2.0;
            values[i] = 0.125 * u * v * w * s;
            gradients[i] = [0.125 * a * v * w * (s + u), 0.125 * b * u * w * (s + v), 0.125 * c * u * v * (s + w)];
        } else if a == 0.0 {
            let q = 1.0 - x * x;
            values[i] = 0.25 * q * v * w;
            gradients[i] = [-0.5 * x * v * w, 0.25 * q * b * w, 0.25 * q * v * c];
        } else if b == 0.0 {
            let q = 1.0 - y * y;
            values[i] = 0.25 * u * q * w;
            gradients[i] = [0.25 * a * q * w, -0.5 * y * u * w, 0.25 * u * q * c];
        } else {
            let q = 1.0 - z * z;
            values[i] = 0.25 * u * v * q;
            gradients[i] = [0.25 * a * v * q, 0.25 * u * b * q, -0.5 * z * u * v];
        }
    }
}

fn hex27(xi: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    let line: [[[f64; 3]; 3]; 3] = std::array::from_fn(|d| quadratic_line(xi[d]));
    for (i, signs) in HEX_SIGNS.iter().enumerate() {
        // Position of the node along each axis: −1, 0, +1 become 0, 1, 2.
        let [a, b, c] = signs.map(|s| (s + 1.0) as usize);
        let (u, v, w) = (line[0][a], line[1][b], line[2][c]);
        values[i] = u[0] * v[0] * w[0];
        gradients[i] = [u[1] * v[0] * w[0], u[0] * v[1] * w[0], u[0] * v[0] * w[1]];
    }
}

fn tet10([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    let l = [1.0 - x - y - z, x, y, z];
    const D: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for i in 0..4 {
        values[i] = l[i] * (2.0 * l[i] - 1.0);
        gradients[i] = D[i].map(|d| d * (4.0 * l[i] - 1.0));
    }
    for (e, &[a, b]) in crate::element::TET_EDGES.iter().enumerate() {
        values[4 + e] = 4.0 * l[a] * l[b];
        gradients[4 + e] = std::array::from_fn(|i| 4.0 * (D[a][i] * l[b] + l[a] * D[b][i]));
    }
}

/// Quadratic Lagrange polynomials through −1, 0, 1: \[value, first, second derivative\] of each.
fn quadratic_line(t: f64) -> [[f64; 3]; 3] {
    [[0.5 * t * (t - 1.0), t - 0.5, 1.0], [1.0 - t * t, -2.0 * t, -2.0], [0.5 * t * (t + 1.0), t + 0.5, 1.0]]
}

const EMPTY_FACE: FaceShape = FaceShape { values: [0.0; 9], gradients: [[0.0; 2]; 9], hessians: [[0.0; 3]; 9] };

fn quad4([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    for (i, [a, b]) in QUAD_SIGNS[..4].iter().copied().enumerate() {
        shape.values[i] = 0.25 * (1.0 + a * x) * (1.0 + b * y);
        shape.gradients[i] = [0.25 * a * (1.0 + b * y), 0.25 * b * (1.0 + a * x)];
        shape.hessians[i] = [0.0, 0.25 * a * b, 0.0];
    }
    shape
}

fn quad8([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    for (i, [a, b]) in QUAD_SIGNS[..8].iter().copied().enumerate() {
        let (u, v) = (1.0 + a * x, 1.0 + b * y);
        if i < 4 {
            let s = a * x + b * y - 1.0;
            shape.values[i] = 0.25 * u * v * s;
            shape.gradients[i] = [0.25 * a * v * (s + u), 0.25 * b * u * (s + v)];
            shape.hessians[i] = [0.5 * a * a * v, 0.25 * a * b * (s + u + v), 0.5 * b * b * u];
        } else if a == 0.0 {
            let q = 1.0 - x * x;
            shape.values[i] = 0.5 * q * v;
            shape.gradients[i] = [-x * v, 0.5 * q * b];
            shape.hessians[i] = [-v, -x * b, 0.0];
        } else {
            let q = 1.0 - y * y;
            shape.values[i] = 0.5 * u * q;
            shape.gradients[i] = [0.5 * a * q, -y * u];
            shape.hessians[i] = [0.0, -y * a, -u];
        }
    }
    shape
}

fn quad9([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    let (p, q) = (quadratic_line(x), quadratic_line(y));
    for (i, signs) in QUAD_SIGNS.iter().enumerate() {
        let [a, b] = signs.map(|s| (s + 1.0) as usize);
        let (u, v) = (p[a], q[b]);
        shape.values[i] = u[0] * v[0];
        shape.gradients[i] = [u[1] * v[0], u[0] * v[1]];
        shape.hessians[i] = [u[2] * v[0], u[1] * v[1], u[0] * v[2]];
    }
    shape
}

fn tri6([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    let l = [1.0 - x - y, x, y];
    const D: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    for i in 0..3 {
        shape.values[i] = l[i] * (2.0 * l[i] - 1.0);
        shape.gradients[i] = D[i].map(|d| d * (4.0 * l[i] - 1.0));
        shape.hessians[i] = [4.0 * D[i][0] * D[i][0], 4.0 * D[i][0] * D[i][1], 4.0 * D[i][1] * D[i][1]];
    }
    for (e, [a, b]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
        shape.values[3 + e] = 4.0 * l[a] * l[b];
        shape.gradients[3 + e] = std::array::from_fn(|i| 4.0 * (D[a][i] * l[b] + l[a] * D[b][i]));
        shape.hessians[3 + e] =
            [8.0 * D[a][0] * D[b][0], 4.0 * (D[a][0] * D[b][1] + D[a][1] * D[b][0]), 8.0 * D[a][1] * D[b][1]];
    }
    shape
}

const HEX_SIGNS: [[f64; 3]; 27] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
];

const QUAD_SIGNS: [[f64; 2]; 9] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [ElementKind; 4] = [ElementKind::Hex8, ElementKind::Hex20, ElementKind::Hex27, ElementKind::Tet10];
    const FACES: [FaceKind; 4] = [FaceKind::Quad4, FaceKind::Quad8, FaceKind::Quad9, FaceKind::Tri6];

    #[test]
    fn shape_functions_are_one_at_their_own_node_and_zero_at_the_others() {
        for kind in KINDS {
            for (i, xi) in kind.reference_nodes().into_iter().enumerate() {
                let (values, _) = tabulate(kind, xi);
                for (j, value) in values.iter().enumerate() {
                    let expected = if i == j { 1.0 } else { 0.0 };
                    assert!((value - expected).abs() < 1e-14, "{kind:?} N{j} at node {i}: {value}");
                }
            }
        }
    }

    #[test]
    fn gradients_match_finite_differences() {
        let (xi, h) = ([0.21, 0.17, 0.33], 1e-6);
        for kind in KINDS {
            let (values, gradients) = tabulate(kind, xi);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            for axis in 0..3 {
                let mut step = [xi, xi];
                step[0][axis] -= h;
                step[1][axis] += h;
                let [(low, _), (high, _)] = step.map(|point| tabulate(kind, point));
                for i in 0..kind.num_nodes() {
                    let difference = (high[i] - low[i]) / (2.0 * h);
                    assert!((gradients[i][axis] - difference).abs() < 1e-9, "{kind:?} node {i} axis {axis}");
                }
            }
        }
    }

    #[test]
    fn face_derivatives_match_finite_differences() {
        let (xi, h) = ([0.21, 0.37], 1e-6);
        for kind in FACES {
            let here = evaluate_face(kind, xi);
            for axis in 0..2 {
                let mut step = [xi, xi];
                step[0][axis] -= h;
                step[1][axis] += h;
                let [low, high] = step.map(|point| evaluate_face(kind, point));
                for i in 0..kind.num_nodes() {
                    let slope = (high.values[i] - low.values[i]) / (2.0 * h);
                    assert!((here.gradients[i][axis] - slope).abs() < 1e-9, "{kind:?} node {i}");
                    for other in 0..2 {
                        let curvature = (high.gradients[i][other] - low.gradients[i][other]) / (2.0 * h);
                        assert!((here.hessians[i][axis + other] - curvature).abs() < 1e-8, "{kind:?} node {i}");
                    }
                }
            }
        }
    }

    #[test]
    fn faces_are_the_trace_of_the_element_and_point_outwards() {
        for kind in KINDS {
            let nodes = kind.reference_nodes();
            let centroid: [f64; 3] =
                std::array::from_fn(|i| nodes.iter().map(|n| n[i]).sum::<f64>() / nodes.len() as f64);
            for face in 0..kind.num_faces() {
                let face_kind = kind.face_kind();
                let local = kind.face_nodes(face);
                assert_eq!(local.len(), face_kind.num_nodes());
                let shape = evaluate_face(face_kind, [0.2, 0.3]);
                let point: [f64; 3] =
                    std::array::from_fn(|i| local.iter().zip(shape.values).map(|(&n, v)| nodes[n][i] * v).sum());
                // On the face only the face's own functions are non-zero, and they agree.
                let (values, _) = tabulate(kind, point);
                for (n, value) in values.iter().enumerate() {
                    let expected = local.iter().position(|&l| l == n).map_or(0.0, |l| shape.values[l]);
                    assert!((value - expected).abs() < 1e-14, "{kind:?} face {face} node {n}");
                }
                let tangent = |axis: usize| -> [f64; 3] {
                    std::array::from_fn(|i| {
                        local.iter().zip(shape.gradients).map(|(&n, g)| nodes[n][i] * g[axis]).sum()
                    })
                };
                let (a, b) = (tangent(0), tangent(1));
                let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                let outward: f64 = (0..3).map(|i| normal[i] * (point[i] - centroid[i])).sum();
                assert!(outward > 0.1, "{kind:?} face {face} points inwards");
            }
        }
    }
}
