//! The part of a pressure's tangent that is not symmetric (theory §4.3).
//!
//! The derivative of ∫ w·p n dS on a deformed surface is symmetric but for a term along its rim: with tangents r_ξ, r_η and integration by
//! parts, its skew part is ½ p ∮ w·(δu × dr), around the outward normal (Schweizerhof & Ramm 1984, *Computers & Structures* 18, 1099). [`crate::FollowerPressure`] adds
//! the symmetric part; here is the rest. It vanishes for closed surfaces, and on rims whose nodes are held in the plane they lie in.

use std::sync::Arc;

use pneuflex_mesh::quadrature::gauss_legendre;
use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::Pressure;

/// What is small enough to be rounding, relative to the largest coupling.
const ROUNDING: f64 = 1e-9;

/// The rim of a surface.
#[derive(Clone, Debug)]
pub struct BoundaryTerm {
    mesh: Arc<Mesh>,
    edges: Vec<Vec<u32>>,
}

/// Forces on nodes that follow from displacements of others: r_a += δu_b × v.
#[derive(Clone, Debug, Default)]
pub struct Couplings {
    entries: Vec<(u32, u32, [f64; 3])>,
}

impl BoundaryTerm {
    /// The rim of some of a mesh's facets.
    pub fn new(mesh: impl Into<Arc<Mesh>>, facets: &[Facet]) -> Self {
        let mesh = mesh.into();
        Self { edges: mesh.rim(facets), mesh }
    }

    /// Adds the couplings under a pressure at a displacement (mm).
    pub fn couple(&self, pressure: Pressure, displacement: &[[f64; 3]], couplings: &mut Couplings) {
        // N_a N_b dr is of degree 5 at the most.
        let rule = gauss_legendre(3);
        for edge in &self.edges {
            let at = |node: u32| -> [f64; 3] {
                std::array::from_fn(|k| self.mesh.nodes[node as usize][k] + displacement[node as usize][k])
            };
            for &(xi, weight) in &rule {
                let (values, slopes) = evaluate(edge.len(), xi);
                let mut tangent = [0.0; 3];
                for (&node, slope) in edge.iter().zip(&slopes) {
                    let x = at(node);
                    for k in 0..3 {
                        tangent[k] += slope * x[k];
                    }
                }
                for (&a, na) in edge.iter().zip(&values) {
                    for (&b, nb) in edge.iter().zip(&values) {
                        couplings.entries.push((a, b, tangent.map(|t| 0.5 * pressure.mpa() * weight * na * nb * t)));
                    }
                }
            }
        }
    }
}

impl Couplings {
    /// Adds up the entries of the same nodes; nothing is left if none couples two free degrees of freedom.
    pub fn condensed(mut self, held: &[bool]) -> Self {
        self.entries.sort_by_key(|entry| (entry.0, entry.1));
        let sum = |same: &[(u32, u32, [f64; 3])]| {
            let v: [f64; 3] = std::array::from_fn(|k| same.iter().map(|entry| entry.2[k]).sum());
            (same[0].0, same[0].1, v)
        };
        let entries: Vec<_> = self.entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).map(sum).collect();
        let largest = entries.iter().flat_map(|entry| entry.2).fold(0.0_f64, |a, b| a.max(b.abs()));
        let is_felt = |&(a, b, v): &(u32, u32, [f64; 3])| {
            let free = |node: u32, axis: usize| !held[3 * node as usize + axis];
            // The component v_k couples the two other axes.
            (0..3).any(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                v[k].abs() > ROUNDING * largest && ((free(a, i) && free(b, j)) || (free(a, j) && free(b, i)))
            })
        };
        if entries.iter().any(is_felt) { Self { entries } } else { Self::default() }
    }

    /// The transposed matrix. Every coupling is skew in the axes and has a partner with a and b exchanged, so that it is the negative.
    pub fn transposed(mut self) -> Self {
        self.entries.iter_mut().for_each(|entry| entry.2 = entry.2.map(|v| -v));
        self
    }

    /// Whether there is nothing to add.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Adds the product with a vector, three entries per node.
    pub fn add_product(&self, vector: &[f64], product: &mut [f64]) {
        for &(a, b, v) in &self.entries {
            let (a, b) = (3 * a as usize, 3 * b as usize);
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                product[a + k] += vector[b + i] * v[j] - vector[b + j] * v[i];
            }
        }
    }
}

/// Shape functions of an edge, ends first, and their derivatives at ξ in [−1, 1].
fn evaluate(num_nodes: usize, xi: f64) -> ([f64; 3], [f64; 3]) {
    if num_nodes == 2 {
        ([0.5 * (1.0 - xi), 0.5 * (1.0 + xi), 0.0], [-0.5, 0.5, 0.0])
    } else {
        ([0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi], [xi - 0.5, xi + 0.5, -2.0 * xi])
    }
}
