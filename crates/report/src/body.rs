//! The body as the page draws it: the mesh's nodes and elements, completed so that every face has a node in its middle.

use std::collections::BTreeMap;

use pneuflex_mesh::family::ElementFamily;
use pneuflex_mesh::{ElementKind, Mesh, shape};

/// Nodes and elements that can be divided into tetrahedra.
#[derive(Clone, Debug)]
pub struct Body {
    /// Reference positions, mm: the mesh's nodes in their order, then the added ones.
    pub nodes: Vec<[f64; 3]>,
    /// Family of every element: one that can be divided.
    families: Vec<&'static ElementFamily>,
    /// Node numbers, element by element.
    connectivity: Vec<u32>,
    /// Where the nodes of every element begin, and where the last one's end.
    starts: Vec<usize>,
    /// The added nodes as weighted sums of the mesh's.
    added: Vec<Vec<(u32, f64)>>,
}

/// The elements of one family.
#[derive(Clone, Debug)]
pub struct Block {
    /// The family.
    pub family: &'static ElementFamily,
    /// Numbers of the elements in the mesh.
    pub elements: Vec<u32>,
    /// Node numbers, `family.num_nodes()` per element.
    pub connectivity: Vec<u32>,
}

impl Body {
    /// The body of a mesh. Elements that lack nodes in their faces and centres (`hex20`) get them, where their shape functions have the
    /// element's own position; all other families stay as they are.
    pub fn new(mesh: &Mesh) -> Self {
        let mut body = Self {
            nodes: mesh.nodes.clone(),
            families: Vec::with_capacity(mesh.num_elements()),
            connectivity: Vec::with_capacity(mesh.connectivity.len()),
            starts: vec![0],
            added: Vec::new(),
        };
        // Two elements share the node of a face, which is known by its corners.
        let mut in_faces: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for element in 0..mesh.num_elements() {
            let kind = mesh.kind_of(element);
            match kind.completed_by {
                Some(family) => body.complete(mesh.element(element), kind, family(), &mut in_faces),
                None => {
                    body.families.push(kind.family());
                    body.connectivity.extend(mesh.element(element));
                }
            }
            body.starts.push(body.connectivity.len());
        }
        body
    }

    /// Family and nodes of an element.
    pub fn element(&self, element: usize) -> (&'static ElementFamily, &[u32]) {
        (self.families[element], &self.connectivity[self.starts[element]..self.starts[element + 1]])
    }

    /// The elements of every family, in their order.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks: Vec<Block> = Vec::new();
        for element in 0..self.families.len() {
            let (family, nodes) = self.element(element);
            match blocks.iter_mut().find(|block| std::ptr::eq(block.family, family)) {
                Some(block) => {
                    block.elements.push(element as u32);
                    block.connectivity.extend(nodes);
                }
                None => {
                    blocks.push(Block { family, elements: vec![element as u32], connectivity: nodes.to_vec() });
                }
            }
        }
        blocks
    }

    fn complete(
        &mut self,
        own: &[u32],
        kind: ElementKind,
        family: &'static ElementFamily,
        in_faces: &mut BTreeMap<Vec<u32>, u32>,
    ) {
        let place =
            |local| family.place_of(&kind, local).expect("the completed family has all nodes of the poorer one");
        let mut all: Vec<Option<u32>> = vec![None; family.num_nodes()];
        own.iter().enumerate().for_each(|(local, &node)| all[place(local)] = Some(node));
        for face in 0..kind.num_faces() {
            let Some(&centre) = family.face_nodes(face).iter().find(|&&local| all[local].is_none()) else { continue };
            let nodes: Vec<u32> = kind.face_nodes(face).iter().map(|&n| own[n]).collect();
            let kind = kind.face_kind(face);
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
            all[centre] = Some(node);
        }
        for local in 0..all.len() {
            let node = all[local].unwrap_or_else(|| {
                let (weights, _) = shape::tabulate(kind, family.nodes[local]);
                self.add(own.iter().copied().zip(weights).collect())
            });
            self.connectivity.push(node);
        }
        self.families.push(family);
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
            let of_block = |block: &Block| -> f64 {
                let parts = tetrahedra(block.family);
                (block.connectivity.chunks(block.family.num_nodes()))
                    .flat_map(|element| parts.iter().map(move |part| part.map(|n| element[usize::from(n)])))
                    .map(|part| volume(part.map(|n| body.nodes[n as usize])))
                    .sum()
            };
            let sum: f64 = body.blocks().iter().map(of_block).sum();
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
