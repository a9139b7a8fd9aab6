//! Closest-point projection onto a face (theory §5; Wriggers, *Computational Contact Mechanics*, ch. 4).

use pneuflex_mesh::{FaceKind, Outline, shape, shape::FaceShape};

/// How far beyond its edges a face is continued where no face is hit: bridges the wedge between two faces that form a ridge.
pub const EXTENSION: f64 = 0.1;

/// Allowance for points on an edge.
pub const EDGE_TOLERANCE: f64 = 1e-9;

const MAX_ITERATIONS: usize = 30;
const TOLERANCE: f64 = 1e-13;

/// Foot of a point on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Reference coordinates of the foot on the face.
    pub xi: [f64; 2],
    /// Signed distance d = (r_s − r_m)·n_m, mm; negative is penetration.
    pub distance: f64,
    /// Unit normal n_m of the face at the foot, out of the master's solid.
    pub normal: [f64; 3],
    /// How far the foot lies outside the face: 0 inside, otherwise the excess of a reference coordinate.
    pub excess: f64,
}

/// Position, tangents and second derivatives of a face at a point.
#[derive(Clone, Copy, Debug)]
pub struct FaceGeometry {
    /// Position.
    pub position: [f64; 3],
    /// r_ξ, r_η.
    pub tangents: [[f64; 3]; 2],
    /// r_ξξ, r_ξη, r_ηη.
    pub curvatures: [[f64; 3]; 3],
}

/// Geometry of a face with nodes at `nodes` where its shape functions are `shape`.
pub fn face_geometry(nodes: &[[f64; 3]], shape: &FaceShape) -> FaceGeometry {
    let mut geometry = FaceGeometry { position: [0.0; 3], tangents: [[0.0; 3]; 2], curvatures: [[0.0; 3]; 3] };
    for (i, node) in nodes.iter().enumerate() {
        for d in 0..3 {
            geometry.position[d] += shape.values[i] * node[d];
            for a in 0..2 {
                geometry.tangents[a][d] += shape.gradients[i][a] * node[d];
            }
            for a in 0..3 {
                geometry.curvatures[a][d] += shape.hessians[i][a] * node[d];
            }
        }
    }
    geometry
}

/// Unit normal (r_ξ × r_η)/‖·‖ and the length ‖r_ξ × r_η‖.
pub fn unit_normal(tangents: &[[f64; 3]; 2]) -> ([f64; 3], f64) {
    let c = cross(tangents[0], tangents[1]);
    let length = dot(c, c).sqrt();
    (c.map(|x| x / length), length)
}

/// How far reference coordinates lie outside the face.
pub fn excess(kind: FaceKind, [x, y]: [f64; 2]) -> f64 {
    match kind.outline {
        Outline::Triangle => (-x).max(-y).max(x + y - 1.0).max(0.0),
        Outline::Square => (x.abs() - 1.0).max(y.abs() - 1.0).max(0.0),
    }
}

/// Projects `point` on a face by Newton's method on ½‖r_s − r_m(ξ, η)‖², started at the face's centre.
///
/// `nodes` are the positions of the face's nodes. `None` if the iteration leaves the face for good or does not converge.
pub fn project(kind: FaceKind, nodes: &[[f64; 3]], point: [f64; 3]) -> Option<Projection> {
    let mut xi = kind.centre();
    for iteration in 0..MAX_ITERATIONS {
        let geometry = face_geometry(nodes, &shape::evaluate_face(kind, xi));
        let gap = sub(point, geometry.position);
        let [a, b] = geometry.tangents;
        let gradient = [dot(gap, a), dot(gap, b)];
        let [raa, rab, rbb] = geometry.curvatures;
        let full = [dot(a, a) - dot(gap, raa), dot(a, b) - dot(gap, rab), dot(b, b) - dot(gap, rbb)];
        // Far from the face the exact Hessian may be indefinite; its first part always gives a descent direction.
        let is_convex = full[0] > 0.0 && full[0] * full[2] > full[1] * full[1];
        let [haa, hab, hbb] = if is_convex { full } else { [dot(a, a), dot(a, b), dot(b, b)] };
        let determinant = haa * hbb - hab * hab;
        let step = [
            (hbb * gradient[0] - hab * gradient[1]) / determinant,
            (haa * gradient[1] - hab * gradient[0]) / determinant,
        ];
        let size = step[0].abs().max(step[1].abs());
        if !size.is_finite() {
            return None;
        }
        // Long steps are shortened: shape functions mean little far outside the face.
        let factor = if size > 1.0 { 1.0 / size } else { 1.0 };
        xi = [xi[0] + factor * step[0], xi[1] + factor * step[1]];
        if iteration >= 2 && excess(kind, xi) > 1.0 {
            return None;
        }
        if size < TOLERANCE {
            let geometry = face_geometry(nodes, &shape::evaluate_face(kind, xi));
            let (normal, _) = unit_normal(&geometry.tangents);
            let distance = dot(sub(point, geometry.position), normal);
            return Some(Projection { xi, distance, normal, excess: excess(kind, xi) });
        }
    }
    None
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: [[f64; 3]; 4] = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [0.0, 2.0, 1.0]];

    #[test]
    fn a_point_above_a_flat_face_projects_straight_down() {
        let foot = project(FaceKind::Quad4, &FLAT, [0.5, 1.5, 1.3]).unwrap();
        assert!((foot.xi[0] + 0.5).abs() < 1e-14 && (foot.xi[1] - 0.5).abs() < 1e-14);
        assert!((foot.distance - 0.3).abs() < 1e-14 && foot.excess == 0.0);
        let below = project(FaceKind::Quad4, &FLAT, [0.5, 1.5, 0.8]).unwrap();
        assert!((below.distance + 0.2).abs() < 1e-14);
    }

    #[test]
    fn the_foot_on_a_warped_face_is_the_closest_of_a_dense_sampling() {
        let warped = [[0.0, 0.0, 0.0], [2.0, 0.1, 0.4], [2.2, 1.9, -0.2], [-0.1, 2.0, 0.5]];
        let point = [1.1, 0.7, 0.6];
        let foot = project(FaceKind::Quad4, &warped, point).unwrap();
        let distance = |xi: [f64; 2]| {
            let g = face_geometry(&warped, &shape::evaluate_face(FaceKind::Quad4, xi));
            let s = sub(point, g.position);
            dot(s, s).sqrt()
        };
        let mut best = f64::INFINITY;
        for i in 0..=400 {
            for j in 0..=400 {
                best = best.min(distance([i as f64 / 200.0 - 1.0, j as f64 / 200.0 - 1.0]));
            }
        }
        assert!(distance(foot.xi) <= best && (foot.distance.abs() - best).abs() < 1e-4);
    }

    #[test]
    fn points_far_beside_the_face_have_no_foot_on_it() {
        assert!(project(FaceKind::Quad4, &FLAT, [9.0, 1.0, 1.0]).is_none_or(|foot| foot.excess > 1.0));
        assert!(project(FaceKind::Quad4, &FLAT, [f64::NAN, 1.0, 1.0]).is_none());
    }
}
