//! The boundary of a deformed body as small plane pieces with what is needed to colour them.

use std::collections::BTreeMap;

use pneuflex_mesh::{FaceKind, Outline, shape};
use pneuflex_model::{Image, Problem};

use pneuflex_mesh::vector::{Vec3, cross, dot, norm, sub};
use pneuflex_post::surface::{Bounds, Patch};

use super::view::unit;

/// A corner of the pieces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    /// Deformed position, mm.
    pub position: Vec3,
    /// Outward unit normal.
    pub normal: Vec3,
    /// Reference coordinates on the face.
    pub xi: [f64; 2],
    /// Interpolated field; 0 without one.
    pub value: f64,
}

/// A face of the boundary.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    /// Family of the face.
    pub kind: FaceKind,
    /// Corners of the pieces, `pieces + 1` along each direction (on triangles one fewer from row to row), ξ running fastest.
    pub vertices: Vec<Vertex>,
    /// Pieces along each direction.
    pub pieces: usize,
    /// Whether the body has an edge of its own at each edge (in the order of [`pneuflex_mesh::face::FaceFamily::edges`]); otherwise it goes on smoothly.
    pub is_edge: [bool; 4],
    /// Whether it is of the body; of an obstacle otherwise.
    pub is_of_body: bool,
}

/// The boundary of a deformed body.
#[derive(Clone, Debug)]
pub(crate) struct Skin {
    /// Faces.
    pub faces: Vec<Face>,
    /// A box around them.
    pub bounds: Bounds,
}

/// Faces that meet at more than this angle at rest have an edge of the body between them, degrees.
const CREASE_DEG: f64 = 20.0;

/// A node of an image.
type Corner = (u32, u8);

/// A face beside an edge, which of its edges that is, and its normal at rest.
type Side = (usize, usize, Vec3);

impl Skin {
    /// The boundary of a body: of the modelled part, or of some images of it together, which meet in planes of symmetry.
    ///
    /// `values` is a nodal field. Lengths are taken for granted.
    pub fn new(problem: &Problem, displacement: &[[f64; 3]], values: Option<&[f64]>, images: &[Image]) -> Self {
        let mesh = &problem.mesh;
        // A bit for each plane that the node lies in.
        let mut on_planes = vec![0_u8; mesh.num_nodes()];
        if images.len() > 1 {
            for (bit, plane) in problem.symmetry.iter().enumerate() {
                problem.supports[plane.support].nodes.iter().for_each(|&node| on_planes[node as usize] |= 1 << bit);
            }
        }
        let table = |kind: FaceKind| -> (usize, Vec<_>) {
            let pieces = if kind.is_linear() { 3 } else { 6 };
            (pieces, grid(kind, pieces).into_iter().map(|xi| (xi, shape::evaluate_face(kind, xi))).collect())
        };
        let mut tables: BTreeMap<usize, _> = BTreeMap::new();
        let mut faces = Vec::new();
        let mut meeting: BTreeMap<[Corner; 2], Vec<Side>> = BTreeMap::new();
        for facet in mesh.boundary_facets() {
            let numbers = mesh.facet_nodes(facet);
            if numbers.iter().fold(u8::MAX, |planes, &n| planes & on_planes[n as usize]) != 0 {
                continue;
            }
            let kind = mesh.face_kind(facet);
            let (pieces, table) = tables.entry(kind.num_nodes()).or_insert_with(|| table(kind));
            let patch = Patch::new(mesh, facet, Some(displacement));
            let rest = unit(Patch::new(mesh, facet, None).at(kind.centre()).area_vector);
            for (number, image) in images.iter().enumerate() {
                let vertices = table
                    .iter()
                    .map(|(xi, shape)| {
                        let point = patch.at(*xi);
                        let value = values.map_or(0.0, |v| {
                            numbers.iter().zip(shape.values.iter()).map(|(&n, s)| s * v[n as usize]).sum()
                        });
                        let normal = image.vector(unit(point.area_vector));
                        Vertex { position: image.point(point.position), normal, xi: *xi, value }
                    })
                    .collect();
                // An image of a node in a plane is that of the image on the other side.
                let corner = |i: usize| (numbers[i], number as u8 & !on_planes[numbers[i] as usize]);
                for (edge, corners) in kind.edges().enumerate() {
                    let mut key = corners.map(corner);
                    key.sort_unstable();
                    meeting.entry(key).or_default().push((faces.len(), edge, image.vector(rest)));
                }
                faces.push(Face { kind, vertices, pieces: *pieces, is_edge: [false; 4], is_of_body: true });
            }
        }
        let limit = CREASE_DEG.to_radians().cos();
        for sharing in meeting.values() {
            let is_smooth = sharing.len() == 2 && dot(sharing[0].2, sharing[1].2) > limit;
            for &(face, edge, _) in sharing {
                faces[face].is_edge[edge] = !is_smooth;
            }
        }
        let bounds = faces
            .iter()
            .flat_map(|f: &Face| &f.vertices)
            .fold(Bounds::EMPTY, |b, v| b.join(&Bounds { low: v.position, high: v.position }));
        Self { faces, bounds }
    }

    /// A typical length of the faces' sides, mm.
    pub fn face_size(&self) -> f64 {
        let side = |f: &Face| norm(sub(f.vertices[f.pieces].position, f.vertices[0].position));
        self.faces.iter().map(side).sum::<f64>() / self.faces.len().max(1) as f64
    }
}

/// Reference coordinates of the corners of the pieces, in the order of [`Face::vertices`].
fn grid(kind: FaceKind, pieces: usize) -> Vec<[f64; 2]> {
    let rows = (0..=pieces).flat_map(|j| {
        let last = if kind.outline == Outline::Triangle { pieces - j } else { pieces };
        (0..=last).map(move |i| [i, j])
    });
    rows.map(|at| {
        at.map(|k| {
            let share = k as f64 / pieces as f64;
            if kind.outline == Outline::Triangle { share } else { 2.0 * share - 1.0 }
        })
    })
    .collect()
}

impl Face {
    /// The pieces as triangles of vertex numbers, turned like the face.
    pub fn triangles(&self) -> Vec<[usize; 3]> {
        if self.kind.outline == Outline::Triangle {
            self.pieces_of_triangle()
        } else {
            self.pieces_of_quadrilateral().collect()
        }
    }

    fn pieces_of_triangle(&self) -> Vec<[usize; 3]> {
        let mut pieces = Vec::new();
        let mut start = 0;
        for length in (1..=self.pieces).rev() {
            // This row has `length` + 1 vertices, the next one `length`.
            let next = start + length + 1;
            for i in 0..length {
                pieces.push([start + i, start + i + 1, next + i]);
                if i + 1 < length {
                    pieces.push([start + i + 1, next + i + 1, next + i]);
                }
            }
            start = next;
        }
        pieces
    }

    fn pieces_of_quadrilateral(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let n = self.pieces;
        (0..n).flat_map(move |j| (0..n).map(move |i| j * (n + 1) + i)).flat_map(move |a| {
            let [b, c, d] = [a + 1, a + n + 2, a + n + 1];
            // The shorter diagonal, for the better shape.
            let length = |p: usize, q: usize| {
                let r = sub(self.vertices[p].position, self.vertices[q].position);
                dot(r, r)
            };
            if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        })
    }
}

/// Unit normal of a triangle, outwards.
pub(crate) fn triangle_normal(corners: [Vec3; 3]) -> Vec3 {
    unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{two_chambers, with_formulation};
    use pneuflex_model::Formulation;

    /// ⅓ ∮ r·n dS over the triangles of the skin.
    fn volume(skin: &Skin) -> f64 {
        let triangle = |face: &Face, t: [usize; 3]| {
            let [a, b, c] = t.map(|i| face.vertices[i].position);
            dot(a, cross(b, c)) / 6.0
        };
        skin.faces.iter().map(|f| f.triangles().into_iter().map(|t| triangle(f, t)).sum::<f64>()).sum()
    }

    #[test]
    fn the_skin_is_closed_and_looks_outwards() {
        for problem in [two_chambers(2.0), with_formulation(3.0, Formulation::Tet15)] {
            let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
            assert!((volume(&Skin::new(&problem, &zero, None, &[Image::default()])) - 1268.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_other_half_has_no_wall_between() {
        let problem = two_chambers(2.0);
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let whole = Skin::new(&problem, &zero, None, &problem.images());
        // Mirrored faces are turned the wrong way round as lists of corners: count the volume by side.
        let (one, other): (Vec<&Face>, Vec<&Face>) =
            whole.faces.iter().partition(|f| f.vertices.iter().map(|v| v.position[1]).sum::<f64>() > 0.0);
        assert_eq!(one.len(), other.len());
        assert_eq!((whole.bounds.low[1], whole.bounds.high[1]), (-10.0, 10.0));
        let in_plane = |f: &Face| f.vertices.iter().all(|v| v.position[1].abs() < 1e-9);
        assert!(!whole.faces.iter().any(in_plane));
        // The bottom goes on smoothly through the symmetry plane.
        let bottom = whole.faces.iter().find(|f| {
            f.vertices.iter().all(|v| v.position[2].abs() < 1e-9 && v.position[1] <= 2.0 && v.position[1] >= 0.0)
        });
        let face = bottom.unwrap();
        let at_plane = (0..4).find(|&e| {
            let n = face.pieces;
            let corners = [0, n, (n + 1) * (n + 1) - 1, n * (n + 1)];
            [corners[e], corners[(e + 1) % 4]].iter().all(|&v| face.vertices[v].position[1].abs() < 1e-9)
        });
        assert!(!face.is_edge[at_plane.unwrap()]);
    }
}
