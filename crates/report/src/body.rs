//! The body as the page draws it: the mesh's nodes and elements, completed so that every face has a node in its middle.

use std::collections::BTreeMap;

use pneuflex_mesh::family::ElementFamily;
use pneuflex_mesh::{Mesh, shape};

/// Nodes and elements that can be divided into tetrahedra.
#[derive(Clone, Debug)]
pub struct Body {
    /// Element family: one that can be divided.
    pub family: &'static ElementFamily,
    /// Reference positions, mm: the mesh's nodes in their order, then the added ones.
    pub nodes: Vec<[f64; 3]>,
    /// Node numbers, `family.num_nodes()` per element.
    pub connectivity: Vec<u32>,
    /// The added nodes as weighted sums of the mesh's.
    added: Vec<Vec<(u32, f64)>>,
}

impl Body {
    /// The body of a mesh. Elements that lack nodes in their faces and centres (`hex20`) get them, where their shape functions have the
    /// element's own position; all other families stay as they are.
    pub fn new(mesh: &Mesh) -> Self {
        let mut body = Self {
            family: mesh.kind.family(),
            nodes: mesh.nodes.clone(),
            connectivity: mesh.connectivity.clone(),
            added: Vec::new(),
        };
        if let Some(family) = mesh.kind.completed_by {
            body.family = family();
            body.complete(mesh);
        }
        body
    }

    fn complete(&mut self, mesh: &Mesh) {
        self.connectivity.clear();
        let (centre_weights, _) = shape::tabulate(mesh.kind, mesh.kind.centre());
        // Two elements share the node of a face, which is known by its corners.
        let mut in_faces: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for element in 0..mesh.num_elements() {
            let own = mesh.element(element);
            self.connectivity.extend(own);
            for face in 0..mesh.kind.num_faces() {
                let nodes: Vec<u32> = mesh.kind.face_nodes(face).iter().map(|&n| own[n]).collect();
                let kind = mesh.kind.face_kind(face);
                let mut key = nodes[..kind.num_corners()].to_vec();
                key.sort_unstable();
                let node = match in_faces.get(&key) {
                    Some(&node) => node,
                    None => {
                        let weights = shape::evaluate_face(kind, kind.centre()).values;
                        self.add(nodes.iter().copied().zip(weights).collect())
                    }
                };
                in_faces.insert(key, node);
                self.connectivity.push(node);
            }
            let centre = self.add(own.iter().copied().zip(centre_weights.iter().copied()).collect());
            self.connectivity.push(centre);
        }
    }

    fn add(&mut self, sum: Vec<(u32, f64)>) -> u32 {
        let position = |d: usize| sum.iter().map(|&(n, w)| w * self.nodes[n as usize][d]).sum();
        let position = std::array::from_fn(position);
        self.nodes.push(position);
        self.added.push(sum);
        (self.nodes.len() - 1) as u32
    }

    /// Values at the mesh's nodes followed by those at the added ones, `width` per node.
    pub fn completed(&self, values: &[f64], width: usize) -> Vec<f64> {
        let mut all = values.to_vec();
        for sum in &self.added {
            for d in 0..width {
                all.push(sum.iter().map(|&(n, w)| w * values[width * n as usize + d]).sum());
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subdivision::{tetrahedra, volume};
    use crate::testing::two_chambers;
    use pneuflex_model::Formulation;

    #[test]
    fn the_tetrahedra_of_every_family_add_up_to_the_mesh() {
        for formulation in Formulation::ALL {
            let mesh = two_chambers(formulation).mesh;
            let body = Body::new(&mesh);
            let parts = tetrahedra(body.family);
            let sum: f64 = (body.connectivity.chunks(body.family.num_nodes()))
                .flat_map(|element| parts.iter().map(move |part| part.map(|n| element[usize::from(n)])))
                .map(|part| volume(part.map(|n| body.nodes[n as usize])))
                .sum();
            assert!((sum / mesh.volume() - 1.0).abs() < 1e-12, "{formulation}: {sum} {}", mesh.volume());
        }
    }

    #[test]
    fn the_nodes_added_to_hex20_are_those_of_hex27_and_carry_quadratic_fields() {
        let body = Body::new(&two_chambers(Formulation::Hex20).mesh);
        let whole = two_chambers(Formulation::Hex27).mesh;
        let key = |x: &[f64; 3]| x.map(|c| (c * 1e6).round() as i64);
        let sorted = |nodes: &[[f64; 3]]| {
            let mut keys: Vec<_> = nodes.iter().map(key).collect();
            keys.sort_unstable();
            keys
        };
        assert_eq!(sorted(&body.nodes), sorted(&whole.nodes));
        let field = |x: &[f64; 3]| 1.0 + x[0] * x[2] - 0.3 * x[1] * x[1] + 2.0 * x[1];
        let known = body.nodes.len() - body.added.len();
        let values: Vec<f64> = body.nodes[..known].iter().map(field).collect();
        for (value, x) in body.completed(&values, 1).iter().zip(&body.nodes) {
            assert!((value - field(x)).abs() < 1e-9);
        }
    }
}
