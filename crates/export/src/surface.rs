//! The surface of the whole body as triangles through all its nodes.

use std::collections::BTreeMap;

use pneuflex_mesh::vector::{Vec3, cross, norm, sub};
use pneuflex_model::{Image, Problem};
use pneuflex_report::body::Body;
use pneuflex_report::regions::Regions;
use pneuflex_report::skin::{Side, Skin};

/// Normals that look across a plane of symmetry by no more than this, the sine of 20°, belong to a surface that goes on smoothly there.
const SMOOTH: f64 = 0.342;

/// A corner of triangles: a node of the modelled part, on one of its images. A node at a sharp edge has a corner for each side of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Corner {
    node: u32,
    image: usize,
}

/// The surface of a body, the images of a part included.
#[derive(Clone, Debug)]
pub struct Surface {
    body: Body,
    images: Vec<Image>,
    corners: Vec<Corner>,
    /// Corners of the triangles; their normals point out of the body. Those that the air touches come last.
    pub triangles: Vec<[u32; 3]>,
    /// Number of triangles that the air does not touch.
    pub outside: usize,
}

impl Surface {
    /// The surface of a problem's body.
    pub fn new(problem: &Problem) -> Self {
        let mesh = &problem.mesh;
        let body = Body::new(mesh);
        let planes: Vec<&[u32]> =
            problem.symmetry.iter().map(|plane| &problem.supports[plane.support].nodes[..]).collect();
        let skin = Skin::new(mesh, &problem.cavity_facets(), &planes, &Regions::default(), &body);
        let images = problem.images();
        let corners = (0..images.len()).flat_map(|image| skin.vertices.iter().map(move |&node| Corner { node, image }));
        let mut triangles = Vec::with_capacity(images.len() * skin.triangles.len());
        for side in [Side::Outside, Side::Air] {
            for (number, image) in images.iter().enumerate() {
                let first = (number * skin.vertices.len()) as u32;
                triangles.extend(skin.triangles_of(side).map(|[a, b, c]| {
                    let [b, c] = if image.is_turned() { [c, b] } else { [b, c] };
                    [a, b, c].map(|corner| first + corner)
                }));
            }
        }
        let outside = images.len() * skin.triangles_of(Side::Outside).count();
        Self { corners: corners.collect(), outside, triangles, body, images }
    }

    /// Number of corners.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is nothing of it.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Places of the corners, mm, at displacements of the mesh's nodes; `None` for the body at rest.
    pub fn positions(&self, displacement: Option<&[Vec3]>) -> Vec<Vec3> {
        let moved = displacement.map(|u| self.body.completed(u.as_flattened(), 3));
        let place = |corner: &Corner| {
            let node = corner.node as usize;
            let u = moved.as_ref().map_or([0.0; 3], |u| std::array::from_fn(|d| u[3 * node + d]));
            let at: Vec3 = std::array::from_fn(|d| self.body.nodes[node][d] + u[d]);
            self.images[corner.image].point(at)
        };
        self.corners.iter().map(place).collect()
    }

    /// Values of a field of the mesh's nodes at the corners. Between the nodes of `hex20` a field may overshoot below zero, which none of those
    /// shown can be.
    pub fn values(&self, field: &[f64]) -> Vec<f64> {
        let all = self.body.completed(field, 1);
        self.corners.iter().map(|corner| all[corner.node as usize].max(0.0)).collect()
    }

    /// Unit normals at the corners, by the areas of the triangles around them.
    pub fn normals(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let mut sums = vec![[0.0; 3]; self.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
            let area = cross(sub(b, a), sub(c, a));
            for corner in triangle {
                (0..3).for_each(|d| sums[*corner as usize][d] += area[d]);
            }
        }
        // A surface that goes on smoothly beyond a plane of symmetry is normal to it.
        let planes = self.images.last().map_or(&[][..], Image::planes);
        let extent = self.body.nodes.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        for (sum, corner) in sums.iter_mut().zip(&self.corners) {
            let length = norm(*sum);
            let rest = self.body.nodes[corner.node as usize];
            for plane in planes.iter().filter(|plane| (rest[plane.axis] - plane.at).abs() <= 1e-9 * extent) {
                if sum[plane.axis].abs() < SMOOTH * length {
                    sum[plane.axis] = 0.0;
                }
            }
            let length = norm(*sum);
            // A corner of nothing but slivers has none of its own.
            *sum = if length > 0.0 { sum.map(|x| x / length) } else { [0.0, 0.0, 1.0] };
        }
        sums
    }

    /// The corners without doubles: for each its number among those that lie at different places of the body, and how many these are. Both
    /// sides of a sharp edge, and both images of a node in a plane of symmetry, are one there.
    pub fn welded(&self) -> (Vec<u32>, usize) {
        let mut known: BTreeMap<(u32, [u64; 3]), u32> = BTreeMap::new();
        let numbers = self.corners.iter().map(|corner| {
            // Images of a node in the plane are the node itself, but for the sign of zero.
            let rest = self.images[corner.image].point(self.body.nodes[corner.node as usize]);
            let key = (corner.node, rest.map(|x| (x + 0.0).to_bits()));
            let next = known.len() as u32;
            *known.entry(key).or_insert(next)
        });
        let numbers: Vec<u32> = numbers.collect();
        (numbers, known.len())
    }
}

/// Volume inside of a closed surface, mm³.
pub fn volume(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let cone = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
        let n = cross(b, c);
        (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6.0
    };
    triangles.iter().map(cone).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bent, is_closed, quarter, two_chambers};
    use pneuflex_model::Formulation;

    #[test]
    fn the_whole_body_is_closed_and_as_large_as_it_should_be() {
        let volume_of_half = 1268.0;
        for formulation in Formulation::ALL {
            let problem = two_chambers(formulation);
            let surface = Surface::new(&problem);
            let (numbers, _) = surface.welded();
            let triangles: Vec<_> = surface.triangles.iter().map(|t| t.map(|c| numbers[c as usize])).collect();
            is_closed(&triangles).unwrap();
            let rest = surface.positions(None);
            let found = volume(&rest, &surface.triangles);
            assert!((found / (2.0 * volume_of_half) - 1.0).abs() < 1e-12, "{formulation}: {found}");
            // Displaced, the images still meet in the plane.
            let u = bent(&problem, 1.0);
            let moved = surface.positions(Some(&u));
            let mut places: BTreeMap<u32, Vec3> = BTreeMap::new();
            for (number, place) in numbers.iter().zip(&moved) {
                let known = places.entry(*number).or_insert(*place);
                assert!(norm(sub(*known, *place)) < 1e-12);
            }
        }
    }

    #[test]
    fn four_images_of_a_quarter_make_a_block() {
        let problem = quarter();
        let surface = Surface::new(&problem);
        let (numbers, count) = surface.welded();
        let triangles: Vec<_> = surface.triangles.iter().map(|t| t.map(|c| numbers[c as usize])).collect();
        is_closed(&triangles).unwrap();
        let rest = surface.positions(None);
        assert!((volume(&rest, &surface.triangles) - 4.0 * problem.mesh.volume()).abs() < 1e-9);
        assert!(count < numbers.len());
        // Normals of a flat side stay normal to it at the planes.
        let normals = surface.normals(&rest);
        assert!(normals.iter().all(|n| n.iter().filter(|x| x.abs() > 1e-12).count() == 1), "axes");
    }
}
