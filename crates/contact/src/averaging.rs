//! Gaps averaged around the corners of a slave surface's faces (mortar contact, theory §5.9).
//!
//! The traction on the slave is Σ t_A Φ_A, with the functions Φ_A of its faces' corners that are linear on triangles and bilinear on
//! quadrangles, whatever the order of the faces (Puso, Laursen & Solberg 2008): they are positive, add up to one, and are few enough for the
//! displacements to satisfy. What a corner is kept from is the mean
//!
//! ```text
//! g_A = 1/W_A ∫ Φ_A φ(d) dA₀,   W_A = ∫ Φ_A dA₀,   t_A = ⟨λ_A − k g_A⟩,   Π = ½ k Σ W_A ⟨λ_A/k − g_A⟩²
//! φ(d) = d for d ≤ 0,   d − d²/4c for d < 2c,   c beyond
//! ```
//!
//! The bounded distance φ is ours: plain d would let one corner's far points speak for the near ones, so that what is smaller than a face
//! sinks into it. Points without a partner are far, too.

use std::collections::BTreeMap;

use pneuflex_mesh::{FaceKind, Outline, shape};

use crate::projection::{face_geometry, unit_normal};
use crate::surface::Surface;

/// c as a share of the faces' size: a gap closes where what is near is nearer than this on the mean.
const FAR: f64 = 0.02;

/// The corners of a surface's faces with what they average over.
#[derive(Clone, Debug)]
pub struct Averaging {
    /// Numbers of every face's corners among the surface's.
    of_face: Vec<(FaceKind, [usize; 4])>,
    /// W, mm².
    weights: Vec<f64>,
    /// c, mm.
    bounds: Vec<f64>,
}

/// φ(d) with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// φ, mm.
    pub value: f64,
    /// φ′.
    pub slope: f64,
    /// φ″, 1/mm.
    pub curvature: f64,
}

impl Bounded {
    /// At a distance d, with the bound c.
    pub fn at(distance: f64, bound: f64) -> Self {
        if distance <= 0.0 {
            Self { value: distance, slope: 1.0, curvature: 0.0 }
        } else if distance < 2.0 * bound {
            let share = distance / (2.0 * bound);
            Self { value: distance * (1.0 - 0.5 * share), slope: 1.0 - share, curvature: -0.5 / bound }
        } else {
            Self { value: bound, slope: 0.0, curvature: 0.0 }
        }
    }
}

impl Averaging {
    /// Of a surface with nodes at rest at `nodes`; areas are multiplied by `share`.
    pub fn of(surface: &Surface, nodes: &[[f64; 3]], share: f64) -> Self {
        let mut numbers: BTreeMap<u32, usize> = BTreeMap::new();
        let mut of_face = Vec::with_capacity(surface.num_faces());
        let (mut weights, mut sizes): (Vec<f64>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
        for face in 0..surface.num_faces() {
            let kind = surface.kind(face);
            let mut corners = [0; 4];
            for (corner, &node) in corners.iter_mut().zip(&surface.face(face)[..kind.num_corners()]) {
                *corner = *numbers.entry(node).or_insert_with(|| {
                    weights.push(0.0);
                    sizes.push([0.0; 2]);
                    weights.len() - 1
                });
            }
            let positions = &surface.face_positions(face, nodes)[..kind.num_nodes()];
            let mut area = 0.0;
            for (xi, weight) in kind.contact_rule() {
                let geometry = face_geometry(positions, &shape::evaluate_face(kind, xi));
                let part = weight * unit_normal(&geometry.tangents).1;
                area += part;
                for (&corner, value) in corners.iter().zip(corner_functions(kind, xi)).take(kind.num_corners()) {
                    weights[corner] += share * part * value;
                }
            }
            // The edge of a square or of half a square.
            let size = if kind.outline == Outline::Triangle { (2.0 * area).sqrt() } else { area.sqrt() };
            for &corner in &corners[..kind.num_corners()] {
                sizes[corner] = [sizes[corner][0] + area * size, sizes[corner][1] + area];
            }
            of_face.push((kind, corners));
        }
        let bounds = sizes.iter().map(|[sum, area]| FAR * sum / area).collect();
        Self { of_face, weights, bounds }
    }

    /// Number of corners.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// W of a corner, mm².
    pub fn weight(&self, corner: usize) -> f64 {
        self.weights[corner]
    }

    /// c of a corner, mm.
    pub fn bound(&self, corner: usize) -> f64 {
        self.bounds[corner]
    }

    /// Points that are further away than this are far for every corner, mm.
    pub fn farthest(&self) -> f64 {
        2.0 * self.bounds.iter().copied().fold(0.0, f64::max)
    }

    /// Corners of a face with their functions at a point of it.
    pub fn shares(&self, face: usize, xi: [f64; 2]) -> impl Iterator<Item = (usize, f64)> + use<> {
        let (kind, corners) = self.of_face[face];
        corners.into_iter().zip(corner_functions(kind, xi)).take(kind.num_corners())
    }
}

fn corner_functions(kind: FaceKind, [x, y]: [f64; 2]) -> [f64; 4] {
    match kind.outline {
        Outline::Triangle => [1.0 - x - y, x, y, 0.0],
        Outline::Square => {
            let values = shape::evaluate_face(FaceKind::Quad4, [x, y]).values;
            [values[0], values[1], values[2], values[3]]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounded_distance_and_its_derivatives() {
        let (bound, h) = (0.3, 1e-6);
        for distance in [-0.7, -1e-3, 0.1, 0.4, 0.599, 0.7] {
            let [low, here, high] = [distance - h, distance, distance + h].map(|d| Bounded::at(d, bound));
            assert!(((high.value - low.value) / (2.0 * h) - here.slope).abs() < 1e-5);
            assert!(((high.slope - low.slope) / (2.0 * h) - here.curvature).abs() < 1e-5);
            assert!(here.value <= bound && here.value <= distance);
        }
        assert_eq!(Bounded::at(-0.7, bound).value, -0.7);
        assert_eq!(Bounded::at(0.7, bound).value, bound);
    }
}
