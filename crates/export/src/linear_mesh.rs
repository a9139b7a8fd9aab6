//! The solid at rest as a mesh of linear elements for simulators of robots: the corners of the elements, in mm, the images of a part included.
//!
//! Hexahedra stay what they are where a format has room for them; everything else is divided into tetrahedra. An element is the cone of its
//! corner with the lowest number over the faces opposite, and a face is divided from its own corner with the lowest number: neighbours agree
//! on the face they share, whatever they are.

use std::collections::BTreeMap;
use std::fmt::Write;

use pneuflex_mesh::family::ReferenceBody;
use pneuflex_mesh::vector::{Vec3, cross, dot, sub};
use pneuflex_model::Problem;

use crate::error::ExportError;

/// Elements with so many nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// Tetrahedra; their volumes are positive.
    Tetrahedra(Vec<[u32; 4]>),
    /// Hexahedra in VTK's order.
    Hexahedra(Vec<[u32; 8]>),
}

/// A mesh of linear elements.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearMesh {
    /// Nodes, mm.
    pub nodes: Vec<Vec3>,
    /// Elements.
    pub cells: Cells,
}

/// Corners of a hexahedron in the order of its mirror image.
const TURNED: [usize; 8] = [4, 5, 6, 7, 0, 1, 2, 3];

impl LinearMesh {
    /// The mesh of a problem: hexahedra where the body consists of nothing else and they are allowed, else tetrahedra.
    ///
    /// # Errors
    /// [`ExportError::Warped`].
    pub fn new(problem: &Problem, allows_hexahedra: bool) -> Result<Self, ExportError> {
        let mesh = &problem.mesh;
        let images = problem.images();
        let is_hexahedron = |element| mesh.kind_of(element).body == ReferenceBody::Hexahedron;
        let keeps = allows_hexahedra && (0..mesh.num_elements()).all(is_hexahedron);
        let mut nodes: Vec<Vec3> = Vec::new();
        let mut known: BTreeMap<(u32, [u64; 3]), u32> = BTreeMap::new();
        let (mut tetrahedra, mut hexahedra) = (Vec::new(), Vec::new());
        for image in &images {
            for element in 0..mesh.num_elements() {
                let corners: Vec<u32> = mesh
                    .corners(element)
                    .iter()
                    .map(|&node| {
                        let at = image.point(mesh.nodes[node as usize]).map(|x| x + 0.0);
                        *known.entry((node, at.map(f64::to_bits))).or_insert_with(|| {
                            nodes.push(at);
                            (nodes.len() - 1) as u32
                        })
                    })
                    .collect();
                if keeps {
                    let order = |i: usize| if image.is_turned() { TURNED[i] } else { i };
                    hexahedra.push(std::array::from_fn(|i| corners[order(i)]));
                    continue;
                }
                let kind = mesh.kind_of(element);
                let faces = kind
                    .faces
                    .iter()
                    .map(|face| face.nodes[..face.kind.num_corners()].iter().map(|&i| corners[i]).collect());
                for mut part in divided(&corners, faces) {
                    if image.is_turned() {
                        part.swap(1, 2);
                    }
                    if volume(part.map(|node| nodes[node as usize])) <= 0.0 {
                        return Err(ExportError::Warped { element: element + 1 });
                    }
                    tetrahedra.push(part);
                }
            }
        }
        Ok(Self { nodes, cells: if keeps { Cells::Hexahedra(hexahedra) } else { Cells::Tetrahedra(tetrahedra) } })
    }

    /// As a legacy VTK file, which SOFA reads.
    pub fn vtk(&self) -> String {
        let mut text =
            String::from("# vtk DataFile Version 2.0\nby pneuflex, lengths in mm\nASCII\nDATASET UNSTRUCTURED_GRID\n");
        let _ = writeln!(text, "POINTS {} double", self.nodes.len());
        self.nodes.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
        let (cells, kind) = self.rows();
        let width = cells.first().map_or(0, |cell| cell.len());
        let _ = writeln!(text, "CELLS {} {}", cells.len(), cells.len() * (width + 1));
        for cell in &cells {
            let numbers: Vec<String> = cell.iter().map(u32::to_string).collect();
            let _ = writeln!(text, "{width} {}", numbers.join(" "));
        }
        let _ = writeln!(text, "CELL_TYPES {}", cells.len());
        cells.iter().for_each(|_| text += &format!("{}\n", kind.vtk));
        text
    }

    /// As a mesh of Gmsh, version 2.2, which MuJoCo reads if there are tetrahedra alone.
    pub fn msh(&self) -> String {
        let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", self.nodes.len());
        for (number, [x, y, z]) in self.nodes.iter().enumerate() {
            let _ = writeln!(text, "{} {x} {y} {z}", number + 1);
        }
        let (cells, kind) = self.rows();
        let _ = writeln!(text, "$EndNodes\n$Elements\n{}", cells.len());
        for (number, cell) in cells.iter().enumerate() {
            let nodes: Vec<String> = cell.iter().map(|node| (node + 1).to_string()).collect();
            let _ = writeln!(text, "{} {} 2 1 1 {}", number + 1, kind.gmsh, nodes.join(" "));
        }
        text + "$EndElements\n"
    }

    fn rows(&self) -> (Vec<&[u32]>, Numbers) {
        match &self.cells {
            Cells::Tetrahedra(cells) => (cells.iter().map(|cell| &cell[..]).collect(), Numbers { vtk: 10, gmsh: 4 }),
            Cells::Hexahedra(cells) => (cells.iter().map(|cell| &cell[..]).collect(), Numbers { vtk: 12, gmsh: 5 }),
        }
    }
}

/// What formats call a kind of element.
struct Numbers {
    vtk: u8,
    gmsh: u8,
}

/// The tetrahedra of a convex element with corners and faces; the faces' normals, by the right hand, point out of it.
fn divided(corners: &[u32], faces: impl Iterator<Item = Vec<u32>>) -> Vec<[u32; 4]> {
    let Some(&tip) = corners.iter().min() else { return Vec::new() };
    let mut parts = Vec::new();
    for mut face in faces.filter(|face| !face.contains(&tip)) {
        let least = (0..face.len()).min_by_key(|&i| face[i]).unwrap_or(0);
        face.rotate_left(least);
        parts.extend(face[1..].windows(2).map(|two| [tip, face[0], two[0], two[1]]));
    }
    parts
}

fn volume([a, b, c, d]: [Vec3; 4]) -> f64 {
    dot(sub(b, a), cross(sub(c, a), sub(d, a))) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{is_closed, quarter, two_chambers};
    use pneuflex_model::Formulation;

    fn volume_of(mesh: &LinearMesh) -> f64 {
        let Cells::Tetrahedra(cells) = &mesh.cells else { panic!("no tetrahedra") };
        cells.iter().map(|cell| volume(cell.map(|node| mesh.nodes[node as usize]))).sum()
    }

    /// Faces of tetrahedra that belong to one of them only.
    fn boundary(cells: &[[u32; 4]]) -> Vec<[u32; 3]> {
        let mut faces: BTreeMap<[u32; 3], Vec<[u32; 3]>> = BTreeMap::new();
        for &[a, b, c, d] in cells {
            for face in [[a, c, b], [a, b, d], [b, c, d], [a, d, c]] {
                let mut key = face;
                key.sort_unstable();
                faces.entry(key).or_default().push(face);
            }
        }
        assert!(faces.values().all(|found| found.len() <= 2));
        faces.into_values().filter(|found| found.len() == 1).map(|found| found[0]).collect()
    }

    #[test]
    fn tetrahedra_of_every_family_fill_the_whole_body_and_fit_together() {
        for formulation in Formulation::ALL {
            let mesh = LinearMesh::new(&two_chambers(formulation), false).unwrap();
            assert!((volume_of(&mesh) / 2536.0 - 1.0).abs() < 1e-12, "{formulation}");
            let Cells::Tetrahedra(cells) = &mesh.cells else { panic!() };
            is_closed(&boundary(cells)).unwrap();
        }
        let mesh = LinearMesh::new(&quarter(), false).unwrap();
        assert!((volume_of(&mesh) - 96.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_written_is_read_again() {
        let problem = two_chambers(Formulation::Hex27);
        let whole = LinearMesh::new(&problem, true).unwrap();
        let Cells::Hexahedra(cells) = &whole.cells else { panic!("no hexahedra") };
        assert_eq!(cells.len(), 2 * problem.mesh.num_elements());
        let tetrahedra = LinearMesh::new(&problem, false).unwrap();
        for (name, text, expected) in [
            ("a.vtk", whole.vtk(), 2536.0),
            ("b.vtk", tetrahedra.vtk(), 2536.0),
            ("a.msh", tetrahedra.msh(), 2536.0),
            ("b.msh", whole.msh(), 2536.0),
        ] {
            let read = if name.ends_with("vtk") { pneuflex_deck::vtk::read } else { pneuflex_deck::msh::read };
            let mesh = read(name, text.as_bytes()).unwrap().mesh;
            assert!((mesh.volume() / expected - 1.0).abs() < 1e-12, "{name}");
        }
    }
}
