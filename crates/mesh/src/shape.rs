//! Shape functions and their reference gradients (Zienkiewicz & Taylor, *The Finite Element Method*, vol. 1, ch. 4).

use crate::element::ElementKind;
use crate::face::FaceKind;
pub use crate::face::FaceShape;

/// Evaluates the shape functions of a solid element.
///
/// `xi` is the reference point. `values` (one per node) and `gradients` (∂Nᵢ/∂ξ, one per node) are overwritten.
///
/// # Panics
/// If the slices are shorter than the element's number of nodes.
pub fn evaluate(kind: ElementKind, xi: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    (kind.shape)(xi, values, gradients);
}

/// Shape functions of a solid element as owned vectors: values and gradients, one per node.
pub fn tabulate(kind: ElementKind, xi: [f64; 3]) -> (Vec<f64>, Vec<[f64; 3]>) {
    let mut values = vec![0.0; kind.num_nodes()];
    let mut gradients = vec![[0.0; 3]; kind.num_nodes()];
    evaluate(kind, xi, &mut values, &mut gradients);
    (values, gradients)
}

/// Evaluates the shape functions of a face at the reference point `xi`.
pub fn evaluate_face(kind: FaceKind, xi: [f64; 2]) -> FaceShape {
    (kind.shape)(xi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_are_one_at_their_own_node_and_zero_at_the_others() {
        for kind in ElementKind::ALL {
            for (i, &xi) in kind.nodes.iter().enumerate() {
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
        for kind in ElementKind::ALL {
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
        for kind in FaceKind::ALL {
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
        for kind in ElementKind::ALL {
            let nodes = kind.nodes;
            let centroid: [f64; 3] =
                std::array::from_fn(|i| nodes.iter().map(|n| n[i]).sum::<f64>() / nodes.len() as f64);
            for face in 0..kind.num_faces() {
                let face_kind = kind.face_kind(face);
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
