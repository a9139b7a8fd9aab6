//! From where a body is seen.

use pneuflex_mesh::vector::{Vec3, cross, dot, norm, sub};

/// A direction of view; z points up on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the viewer stands, turned from +x towards +y, degrees; −90 looks along +y at the symmetry plane of a half
    /// model.
    pub azimuth_deg: f64,
    /// How high the viewer stands, degrees above the x–y plane.
    pub elevation_deg: f64,
    /// Distance of the viewer from the middle of the body, in sizes of the body; `None` for parallel rays.
    pub distance: Option<f64>,
}

impl View {
    /// Parallel rays, looking at the symmetry plane of a half model from the front, to the right and above.
    pub const SECTION: Self = Self { azimuth_deg: -62.0, elevation_deg: 24.0, distance: None };

    /// Straight at the symmetry plane: lengths in x and z are true.
    pub const SIDE: Self = Self { azimuth_deg: -90.0, elevation_deg: 0.0, distance: None };

    /// Parallel rays on the outer side of a half model, or a whole one.
    pub const OUTSIDE: Self = Self { azimuth_deg: 58.0, elevation_deg: 28.0, distance: None };
}

/// A view at a scene: where the viewer stands and which axes his picture has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    right: Vec3,
    up: Vec3,
    /// From the scene to the viewer.
    toward: Vec3,
    centre: Vec3,
    /// Distance of the viewer from the centre, mm; infinite for parallel rays.
    distance: f64,
}

/// A point as seen: x to the right and y up on the plane through the scene's centre, mm, and how far behind it, mm.
///
/// Depth is a straight function of x and y on any plane, also in perspective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    pub x: f64,
    pub y: f64,
    pub depth: f64,
}

impl Camera {
    /// The camera of a view at a scene with a centre and a size, mm.
    pub fn new(view: &View, centre: Vec3, size: f64) -> Self {
        let (sin_a, cos_a) = view.azimuth_deg.to_radians().sin_cos();
        // Straight from above there would be no up.
        let (sin_e, cos_e) = view.elevation_deg.clamp(-89.9, 89.9).to_radians().sin_cos();
        let toward = [cos_e * cos_a, cos_e * sin_a, sin_e];
        let right = unit(cross([0.0, 0.0, 1.0], toward));
        // Nearer than a body's size the viewer would stand in it.
        let distance = view.distance.map_or(f64::INFINITY, |d| d.max(1.2) * size);
        Self { right, up: cross(toward, right), toward, centre, distance }
    }

    /// A point as seen.
    pub fn see(&self, point: Vec3) -> Seen {
        let r = sub(point, self.centre);
        let behind = -dot(r, self.toward);
        let shrink = if self.distance.is_finite() { self.distance / (self.distance + behind) } else { 1.0 };
        Seen { x: shrink * dot(r, self.right), y: shrink * dot(r, self.up), depth: shrink * behind }
    }

    /// Unit vector from a point to the viewer.
    pub fn toward(&self, point: Vec3) -> Vec3 {
        if !self.distance.is_finite() {
            return self.toward;
        }
        let eye: Vec3 = std::array::from_fn(|d| self.centre[d] + self.distance * self.toward[d]);
        unit(sub(eye, point))
    }

    /// A lamp over the viewer's left shoulder: unit vector towards it.
    pub fn lamp(&self) -> Vec3 {
        unit(std::array::from_fn(|d| 0.75 * self.toward[d] + 0.5 * self.up[d] - 0.3 * self.right[d]))
    }

    /// A direction as seen by a viewer far away.
    pub fn direction(&self, direction: Vec3) -> [f64; 2] {
        [dot(direction, self.right), dot(direction, self.up)]
    }
}

pub(crate) fn unit(v: Vec3) -> Vec3 {
    let length = norm(v);
    if length > 0.0 { v.map(|x| x / length) } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_side_view_shows_x_to_the_right_and_z_up() {
        let camera = Camera::new(&View::SIDE, [0.0; 3], 10.0);
        let seen = camera.see([3.0, 2.0, 5.0]);
        assert!((seen.x - 3.0).abs() < 1e-12 && (seen.y - 5.0).abs() < 1e-12 && (seen.depth - 2.0).abs() < 1e-12);
    }

    #[test]
    fn from_behind_right_and_left_change_sides() {
        let view = View { azimuth_deg: 90.0, ..View::SIDE };
        let seen = Camera::new(&view, [0.0; 3], 10.0).see([3.0, 2.0, 5.0]);
        assert!((seen.x + 3.0).abs() < 1e-12 && (seen.y - 5.0).abs() < 1e-12 && (seen.depth + 2.0).abs() < 1e-12);
    }

    #[test]
    fn in_perspective_planes_stay_planes() {
        let view = View { distance: Some(3.0), ..View::SECTION };
        let camera = Camera::new(&view, [1.0, 2.0, 3.0], 10.0);
        let (a, b) = ([0.0, 1.0, 2.0], [6.0, -3.0, 9.0]);
        let [sa, sb] = [a, b].map(|p| camera.see(p));
        for share in [0.2, 0.5, 0.9] {
            let seen = camera.see(std::array::from_fn(|d| a[d] + share * (b[d] - a[d])));
            let along = (seen.x - sa.x) / (sb.x - sa.x);
            assert!((sa.y + along * (sb.y - sa.y) - seen.y).abs() < 1e-9);
            assert!((sa.depth + along * (sb.depth - sa.depth) - seen.depth).abs() < 1e-9);
        }
        // What is nearer looks larger.
        let toward = camera.toward([1.0, 2.0, 3.0]);
        let near: Vec3 = std::array::from_fn(|d| [1.0, 2.0, 3.0][d] + 5.0 * toward[d]);
        assert!(camera.see(near).depth < 0.0);
    }
}
