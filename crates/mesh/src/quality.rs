//! How well elements are shaped: the scaled Jacobian.
//!
//! At a corner with the edges e₁, e₂, e₃ it is det(e₁, e₂, e₃) / (|e₁| |e₂| |e₃|), times √2 for tetrahedra and 2/√3 for wedges; the least of an
//! element's corners counts. It is 1 for bricks, regular tetrahedra and straight wedges with equal sides, 0 for flat elements, and less where the element is turned inside out. (Stimpson et
//! al. 2007, *The Verdict geometric quality library*, SAND2007-1751; of quadratic elements the corners.)

use crate::element::ElementKind;
use crate::family::ReferenceBody;
use crate::mesh::{Facet, Mesh, determinant};

impl Mesh {
    /// Scaled Jacobian of every element.
    pub fn scaled_jacobians(&self) -> impl Iterator<Item = f64> + '_ {
        let corners = self.per_kind(corners_with_edges);
        (0..self.num_elements()).map(move |element| {
            let (nodes, corners) = (self.element(element), &corners[self.kind_of(element)]);
            let at = |local: usize| self.nodes[nodes[local] as usize];
            let of_corner = |(corner, ends, scale): &(usize, [usize; 3], f64)| {
                let edges = ends.map(|end| edge(at(*corner), at(end)));
                scale * normalised_determinant(edges)
            };
            corners.iter().map(of_corner).fold(f64::INFINITY, f64::min)
        })
    }

    /// Thickness of the element behind a face, mm: its volume over the face's area, both through the corners.
    pub fn thickness_behind(&self, facet: Facet) -> f64 {
        let corners = self.face_kind(facet).num_corners();
        let at: Vec<[f64; 3]> =
            self.facet_nodes(facet)[..corners].iter().map(|&node| self.nodes[node as usize]).collect();
        let triangle = |pair: &[[f64; 3]]| {
            let [a, b] = [pair[0], pair[1]].map(|x| edge(at[0], x));
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        let area: f64 = at[1..].windows(2).map(triangle).sum();
        // A tetrahedron on a face is three times as high as a prism of its volume; a wedge is twice as high on a quadrilateral.
        let shape = match (self.kind_of(facet.element as usize).body, corners) {
            (ReferenceBody::Hexahedron, _) | (ReferenceBody::Wedge, 3) => 1.0,
            (ReferenceBody::Wedge, _) => 2.0,
            (ReferenceBody::Tetrahedron, _) => 3.0,
        };
        shape * self.volume_of([facet.element]) / area
    }

    /// Share of the elements that reach from one side of the body to the other: two of their faces without a common node are on its surface.
    pub fn share_of_single_layers(&self) -> f64 {
        let boundary = self.boundary_facets();
        let is_through = |facets: &&[Facet]| {
            let nodes: Vec<Vec<u32>> = facets.iter().map(|&facet| self.facet_nodes(facet)).collect();
            let is_apart = |a: &Vec<u32>, b: &Vec<u32>| !a.iter().any(|node| b.contains(node));
            nodes.iter().enumerate().any(|(i, a)| nodes[..i].iter().any(|b| is_apart(a, b)))
        };
        let through = boundary.chunk_by(|a, b| a.element == b.element).filter(is_through).count();
        through as f64 / self.num_elements().max(1) as f64
    }
}

/// Every corner of an element with its three neighbours, and the sign and factor of their determinant.
fn corners_with_edges(family: ElementKind) -> Vec<(usize, [usize; 3], f64)> {
    let of_corner = |corner: usize| {
        let end = |&[a, b]: &[usize; 2]| if a == corner { Some(b) } else { (b == corner).then_some(a) };
        let ends: Vec<usize> = family.edges.iter().filter_map(end).collect();
        let &[a, b, c] = ends.as_slice() else { return None };
        let reference = [a, b, c].map(|end| edge(family.nodes[corner], family.nodes[end]));
        let factor = match family.body {
            ReferenceBody::Hexahedron => 1.0,
            ReferenceBody::Tetrahedron => std::f64::consts::SQRT_2,
            ReferenceBody::Wedge => 2.0 / 3.0_f64.sqrt(),
        };
        Some((corner, [a, b, c], factor * determinant(&reference).signum()))
    };
    (0..family.num_corners()).filter_map(of_corner).collect()
}

fn edge(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| to[k] - from[k])
}

/// 0 where an edge has no length.
fn normalised_determinant(edges: [[f64; 3]; 3]) -> f64 {
    let lengths = edges.iter().map(|e| e.iter().map(|x| x * x).sum::<f64>().sqrt()).product::<f64>();
    let value = determinant(&edges) / lengths;
    if value.is_finite() { value } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Lattice;

    #[test]
    fn bricks_are_good_and_flat_elements_are_not() {
        for kind in ElementKind::ALL {
            let mesh = Lattice::uniform([0.0; 3], [3.0, 2.0, 1.0], [2, 2, 1]).mesh_all(kind);
            let worst = |mesh: &Mesh| mesh.scaled_jacobians().fold(f64::INFINITY, f64::min);
            let is_brick = kind.body == ReferenceBody::Hexahedron;
            assert!(if is_brick { (worst(&mesh) - 1.0).abs() < 1e-12 } else { (0.3..0.9).contains(&worst(&mesh)) });
            // A rotation and another unit change nothing, flattening does.
            let turned = mesh.clone().map_nodes(|[x, y, z]| [1e-3 * z, 1e-3 * x, 1e-3 * y]);
            assert!((worst(&turned) - worst(&mesh)).abs() < 1e-12);
            let sheared = mesh.clone().map_nodes(|[x, y, z]| [x + 20.0 * z, y, z]);
            assert!((0.0..0.1).contains(&worst(&sheared)), "{kind:?} {}", worst(&sheared));
            let mirrored = mesh.map_nodes(|[x, y, z]| [-x, y, z]);
            assert!(worst(&mirrored) < 0.0);
        }
    }

    #[test]
    fn walls_of_one_element_and_their_thickness_are_found() {
        for kind in ElementKind::ALL {
            let wall = Lattice::uniform([0.0; 3], [4.0, 4.0, 1.0], [4, 4, 1]).mesh_all(kind);
            let roof = wall.select_facets(|x| x[2] == 1.0);
            let has_layers = kind.body != ReferenceBody::Tetrahedron;
            assert!(roof.iter().all(|&facet| (wall.thickness_behind(facet) - 1.0).abs() < 1e-12), "{kind:?}");
            assert_eq!(wall.share_of_single_layers(), if has_layers { 1.0 } else { 0.0 });
            if kind.body == ReferenceBody::Wedge {
                // Two on each side of a cell: both are half as thick as the cell in the mean.
                let side = wall.select_facets(|x| x[0] == 0.0);
                assert!(side.iter().all(|&facet| (wall.thickness_behind(facet) - 1.0).abs() < 1e-12), "{kind:?}");
            }
            let two = Lattice::uniform([0.0; 3], [4.0, 4.0, 1.0], [4, 4, 2]).mesh_all(kind);
            assert_eq!(two.share_of_single_layers(), 0.0);
        }
    }

    #[test]
    fn a_regular_tetrahedron_has_one() {
        let mut mesh = Lattice::uniform([0.0; 3], [1.0; 3], [1, 1, 1]).mesh_all(ElementKind::Tet10);
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        for (&node, at) in mesh.element(0).to_vec()[..4].iter().zip(corners) {
            mesh.nodes[node as usize] = at;
        }
        assert!((mesh.scaled_jacobians().next().unwrap().abs() - 1.0).abs() < 1e-12);
    }
}
