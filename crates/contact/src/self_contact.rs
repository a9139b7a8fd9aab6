//! Which feet of a surface's own points count as contact.
//!
//! A surface that may touch itself is near itself everywhere: every point lies on its own face and next to its neighbours, and behind
//! it, through the wall, lies the wall's other side, which looks like a face that the point has passed through. A foot counts if
//!
//! 1. it is not on the point's own face. The faces beside that one count as others do: at a crease that closes from its bottom, as at the corner of a cavity
//!    that is sucked in, they are the first that touch;
//! 2. the deformed normals oppose each other clearly, n_s · n_m < −½. Surfaces that touch are parallel there; of the two faces beside a right-angled edge
//!    that touches, one has −0.7 or less. So the points of faces that only stand beside the touching one do not count once more;
//! 3. the point is no deeper behind the foot's face than a twentieth of their distance at rest, wherever the way from point to foot at
//!    rest starts into the body, N_s · (X_m − X_s) < 0; between faces that share a node also where it goes along the surface, since a flat face that is
//!    bent into a sharp ridge has normals like those of a closed crease;
//! 4. no face between the two looks away from the point: if one with n_s · n > 0 is nearer and the point lies in front of it, then the
//!    point is outside of the body that the foot belongs to, and the foot is on that body's far side;
//! 5. where it lies beyond the edges of its face, no face beside that one has the point straight in front of it. Faces are continued to bridge
//!    the wedge behind a ridge; a point in front of the face that follows is not in it, also if that face does not count by the other rules. The
//!    continuation of a face that is bent, at the corner of a cavity that is sucked in, otherwise comes before the points beside it.
//!
//! The third rule tells a wall's other side from contact by what the material does, not by a length chosen beforehand. What lies
//! across the wall at rest is the wall's thickness t away; for it to be found less than t/20 behind, the wall would have to be
//! thinned to a twentieth, which for an incompressible material is an equibiaxial stretch of 4.5. A true contact of this kind, of a strip
//! rolled up until its lower side meets its upper one, joins points that are many thicknesses apart at rest: with 20 mm between them it is
//! found to a depth of 1 mm. Faces that look at each other across a slit, and parts of one flat face that are folded together, have a way
//! that starts out of the body or along it, and the rule does not bind them.

use std::collections::BTreeSet;

use pneuflex_mesh::shape;

use crate::broad_phase::Bounds;
use crate::projection::{EDGE_TOLERANCE, EXTENSION, Projection, cross, dot, face_geometry, sub, unit_normal};
use crate::surface::Surface;

/// Largest share of their distance at rest that a point may lie behind a foot across its own body.
pub const DEPTH_SHARE: f64 = 0.05;

/// How far faces are continued to see whether a point lies in front of them: further than those that it may touch, so that beside
/// the edge of a wall its near side blocks whatever its far side would.
pub const BLOCKING_EXTENSION: f64 = 2.0 * EXTENSION;

/// Normals oppose each other if their product is below this.
const OPPOSED: f64 = -0.5;

/// Ways that start at less than this slope into the body start along its surface.
const ALONG: f64 = 1e-6;

/// Directions of normals of a face: around `axis` within `half_angle`.
#[derive(Clone, Copy, Debug)]
pub struct NormalCone {
    axis: [f64; 3],
    half_angle: f64,
}

/// Room for what the normals at the corners do not show of a face's normals, as a factor and in radians.
const CONE_FACTOR: f64 = 1.5;
const CONE_ROOM: f64 = 0.05;

impl NormalCone {
    /// The cone of a face's normals, from those at its corners.
    pub fn of(surface: &Surface, face: usize, positions: &[[f64; 3]]) -> Self {
        let kind = surface.kind(face);
        let n = kind.num_nodes();
        let nodes = &surface.face_positions(face, positions)[..n];
        let at = |xi| unit_normal(&face_geometry(nodes, &shape::evaluate_face(kind, xi)).tangents).0;
        let axis = at(kind.centre());
        let half_angle = kind.corners().iter().map(|&xi| angle(axis, at(xi))).fold(0.0, f64::max);
        Self { axis, half_angle: CONE_FACTOR * half_angle + CONE_ROOM }
    }

    /// Whether all normals are within 60 degrees of the one at the centre.
    pub fn is_narrow(&self) -> bool {
        self.half_angle < std::f64::consts::FRAC_PI_3
    }

    /// Whether a way along the axis of at least `along` against all normals, and `longest` as a whole at the most, goes against each of them.
    fn is_against(&self, along: f64, longest: f64) -> bool {
        along * self.half_angle.cos() > longest * (self.half_angle.sin() + ALONG)
    }

    /// Whether no normal of one face opposes one of the other.
    pub fn never_opposes(&self, other: &Self) -> bool {
        angle(self.axis, other.axis) + self.half_angle + other.half_angle < OPPOSED.acos()
    }
}

/// Angle between unit vectors, exact for small ones, too.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let c = cross(a, b);
    dot(c, c).sqrt().atan2(dot(a, b))
}

/// Whether the surfaces have a node in common, so that the rules of this module apply.
pub fn share_nodes(slave: &Surface, master: &Surface) -> bool {
    let nodes = |surface: &Surface| -> BTreeSet<u32> {
        (0..surface.num_faces()).flat_map(|face| surface.face(face).to_vec()).collect()
    };
    !nodes(slave).is_disjoint(&nodes(master))
}

/// Whether two faces have a node in common.
pub fn are_neighbours(a: &[u32], b: &[u32]) -> bool {
    a.iter().any(|node| b.contains(node))
}

/// A point of the slave, at rest and now.
#[derive(Clone, Copy, Debug)]
pub struct SlavePoint {
    /// Position at rest, mm.
    pub at_rest: [f64; 3],
    /// Unit normal at rest.
    pub normal_at_rest: [f64; 3],
    /// Unit normal now.
    pub normal: [f64; 3],
}

/// Whether a foot on another face counts by the second and third rule; `foot_at_rest` is its position at rest, `is_neighbour` says whether the face shares
/// a node with the point's.
pub fn counts(point: &SlavePoint, foot: &Projection, foot_at_rest: [f64; 3], is_neighbour: bool) -> bool {
    let way = sub(foot_at_rest, point.at_rest);
    let length = dot(way, way).sqrt();
    let least_slope = if is_neighbour { ALONG } else { -ALONG };
    let is_bound = dot(way, point.normal_at_rest) < least_slope * length;
    dot(point.normal, foot.normal) < OPPOSED && !(is_bound && foot.distance < -DEPTH_SHARE * length)
}

/// A face at rest, for [`is_across`]: of a slave as it is, of a master with its continuation.
#[derive(Clone, Debug)]
pub struct FaceAtRest {
    cone: NormalCone,
    bounds: Bounds,
}

impl FaceAtRest {
    /// A face at its positions at rest, continued beyond its edges by `extension` of its reference coordinates.
    pub fn of(surface: &Surface, face: usize, rest: &[[f64; 3]], extension: f64) -> Self {
        let [low, high] = surface.bounding_box(face, rest);
        let room: [f64; 3] = std::array::from_fn(|d| (surface.kind(face).bulge + 2.0 * extension) * (high[d] - low[d]));
        let bounds = [std::array::from_fn(|d| low[d] - room[d]), std::array::from_fn(|d| high[d] + room[d])];
        Self { cone: NormalCone::of(surface, face, rest), bounds }
    }
}

/// Whether the third rule excludes every foot on a master face of every point of a slave face that lies behind it by at least `depth`, mm: as
/// the other side of a wall does, which is near all the time.
///
/// The ways at rest are those between the two boxes. All of them start into the body, and none is as long as the depth allows.
pub fn is_across(slave: &FaceAtRest, master: &FaceAtRest, depth: f64) -> bool {
    let [low, high] =
        [0, 1].map(|end| std::array::from_fn::<f64, 3, _>(|d| master.bounds[end][d] - slave.bounds[1 - end][d]));
    let longest: f64 = (0..3).map(|d| low[d].abs().max(high[d].abs()).powi(2)).sum::<f64>().sqrt();
    // The least way against the axis between any two points of the boxes.
    let along: f64 = (0..3).map(|d| (-slave.cone.axis[d] * low[d]).min(-slave.cone.axis[d] * high[d])).sum();
    depth > DEPTH_SHARE * longest && slave.cone.is_against(along, longest)
}

/// Whether a foot beside the edge of another face shows that a point is in front of this one's face, and not in the wedge behind the edge.
/// Faces further away than `reach` are not looked at, mm.
pub fn covers(foot: &Projection, reach: f64) -> bool {
    foot.excess <= EDGE_TOLERANCE && foot.distance > 0.0 && foot.distance <= reach
}

/// Whether a foot of a point with the unit normal `normal` shows that the point is outside of what lies further behind it than `depth`.
pub fn blocks(normal: [f64; 3], foot: &Projection, depth: f64) -> bool {
    foot.excess <= BLOCKING_EXTENSION && dot(normal, foot.normal) > 0.0 && foot.distance > 0.0 && foot.distance < depth
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::ElementKind;
    use pneuflex_mesh::lattice::Lattice;

    use super::*;
    use crate::projection::EXTENSION;

    /// Two plates, 1 mm thick, over each other with 1 mm between them.
    #[test]
    fn what_lies_across_a_wall_is_told_from_what_lies_across_a_slit() {
        for kind in ElementKind::ALL {
            let mut lattice = Lattice::uniform([0.0; 3], [2.0, 2.0, 3.0], [1, 1, 3]);
            lattice.lines[2] = vec![0.0, 1.0, 2.0, 3.0];
            let mesh = lattice.mesh(kind, |cell| cell[2] != 1).mesh;
            let face = |axis: usize, at: f64, room: f64| {
                let surface = Surface::new(&mesh, &mesh.select_facets(|x| (x[axis] - at).abs() < 1e-9));
                FaceAtRest::of(&surface, 0, &mesh.nodes, room)
            };
            let top = face(2, 1.0, 0.0);
            assert!(is_across(&top, &face(2, 0.0, EXTENSION), 1.0), "{kind:?}: the other side of the wall");
            assert!(!is_across(&top, &face(2, 0.0, EXTENSION), 0.05), "{kind:?}: a wall thinned to a twentieth");
            assert!(!is_across(&top, &face(2, 2.0, EXTENSION), 1.0), "{kind:?}: the other side of the slit");
            assert!(!is_across(&top, &face(2, 3.0, EXTENSION), 1.0), "{kind:?}: out of the body and through the next");
            assert!(!is_across(&top, &face(0, 2.0, EXTENSION), 1.0), "{kind:?}: beside an edge");
        }
    }
}
