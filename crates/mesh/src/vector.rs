//! The few operations on vectors, boxes and triangles that are needed outside of the numerics.

/// A vector or a point in space.
pub type Vec3 = [f64; 3];

/// a − b.
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] - b[i])
}

/// a · b.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Length of a.
pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Angle between two directions, degrees; 180 if one of them is none.
pub fn angle_between(a: Vec3, b: Vec3) -> f64 {
    let lengths = norm(a) * norm(b);
    if lengths > 0.0 { (dot(a, b) / lengths).clamp(-1.0, 1.0).acos().to_degrees() } else { 180.0 }
}

/// Least and greatest coordinates of some points; `None` of none.
pub fn bounds(points: impl IntoIterator<Item = Vec3>) -> Option<[Vec3; 2]> {
    points.into_iter().fold(None, |found: Option<[Vec3; 2]>, x| {
        let [low, high] = found.unwrap_or([x, x]);
        Some([std::array::from_fn(|d| low[d].min(x[d])), std::array::from_fn(|d| high[d].max(x[d]))])
    })
}

/// The axis along which a box is longest: 0, 1, 2 for x, y, z; the first of equal ones.
pub fn longest_axis([low, high]: [Vec3; 2]) -> usize {
    let length = |d: usize| high[d] - low[d];
    (1..3).fold(0, |longest, d| if length(d) > length(longest) * (1.0 + 1e-9) { d } else { longest })
}

/// How far along a direction a ray meets a triangle, in the direction's lengths, negative behind its start; `None` if it passes by or is
/// parallel to it (Möller & Trumbore 1997).
pub fn ray_meets(from: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let (u, v) = (sub(b, a), sub(c, a));
    let p = cross(direction, v);
    let determinant = dot(u, p);
    if determinant.abs() <= 1e-12 * norm(u) * norm(v) * norm(direction) {
        return None;
    }
    let t = sub(from, a);
    let first = dot(t, p) / determinant;
    let q = cross(t, u);
    let second = dot(direction, q) / determinant;
    (first >= 0.0 && second >= 0.0 && first + second <= 1.0).then(|| dot(v, q) / determinant)
}

/// Distance of a point from a triangle.
pub fn distance_to_triangle(point: Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    let normal = cross(sub(b, a), sub(c, a));
    let size = norm(normal);
    let edges = [[a, b], [b, c], [c, a]];
    let is_inside = |[from, to]: [Vec3; 2]| dot(cross(sub(to, from), sub(point, from)), normal) >= 0.0;
    if size > 0.0 && edges.into_iter().all(is_inside) {
        return (dot(sub(point, a), normal) / size).abs();
    }
    let to_edge = |[from, to]: [Vec3; 2]| {
        let (along, off) = (sub(to, from), sub(point, from));
        let share = (dot(off, along) / dot(along, along)).clamp(0.0, 1.0);
        norm(std::array::from_fn(|d| off[d] - share * along[d]))
    };
    edges.into_iter().map(to_edge).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [Vec3; 3] = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 2.0, 1.0]];

    #[test]
    fn a_ray_meets_a_triangle_before_it_or_behind_it_or_passes_by() {
        let up = [0.0, 0.0, 0.5];
        assert_eq!(ray_meets([0.5, 0.5, 0.0], up, TRIANGLE), Some(2.0));
        assert_eq!(ray_meets([0.5, 0.5, 2.0], up, TRIANGLE), Some(-2.0));
        assert_eq!(ray_meets([1.5, 1.5, 0.0], up, TRIANGLE), None);
        assert_eq!(ray_meets([0.5, 0.5, 1.0], [1.0, 0.0, 0.0], TRIANGLE), None);
    }

    #[test]
    fn the_nearest_point_of_a_triangle_is_inside_on_an_edge_or_at_a_corner() {
        for (point, expected) in [([0.5, 0.5, 3.0], 2.0), ([1.0, -3.0, 1.0], 3.0), ([5.0, 0.0, 5.0], 5.0)] {
            assert!((distance_to_triangle(point, TRIANGLE) - expected).abs() < 1e-14, "{point:?}");
        }
    }

    #[test]
    fn boxes_hold_their_points_and_are_long_along_an_axis() {
        let found = bounds(TRIANGLE).unwrap();
        assert_eq!(found, [[0.0, 0.0, 1.0], [2.0, 2.0, 1.0]]);
        assert_eq!((bounds([]), longest_axis(found), longest_axis([[0.0; 3], [1.0, 2.0, 5.0]])), (None, 0, 2));
    }
}
