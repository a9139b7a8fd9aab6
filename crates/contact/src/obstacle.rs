//! Signed distance of rigid obstacles with its normal and its second derivative.
//!
//! For a sphere or cylinder of radius R with the vector v from its centre or axis, r = ‖v‖ and e = v/r: φ = r − R, ∇φ = e,
//! ∇²φ = (P − e eᵀ)/r, where P projects onto the space of v; the hollow ones are the negative of that. For a cuboid the point is
//! brought to the cuboid's own axes, q; with half edges h, less the radius ρ of its edges, v = q − clamp(q, −h, h):
//!
//! * outside of the box h: φ = ‖v‖ − ρ, with P projecting onto the axes along which q lies outside: one at a face, two at an edge,
//!   three at a corner;
//! * inside: φ = max(|qᵢ| − hᵢ) − ρ, the normal is that axis. It jumps where two faces are equally near. The energy ½ k φ² is
//!   continuous there, its force is not; rounded edges have no such jump as long as nothing is deeper than their radius.

use pneuflex_model::Shape;

use crate::projection::dot;

/// Signed distance from an obstacle and its derivatives by position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// φ, mm: negative inside.
    pub value: f64,
    /// ∇φ, the unit normal out of the obstacle.
    pub normal: [f64; 3],
    /// ∇²φ, 1/mm.
    pub hessian: [[f64; 3]; 3],
}

/// Signed distance of a point from a shape that was moved by `offset` (mm).
pub fn distance(shape: &Shape, offset: [f64; 3], point: [f64; 3]) -> Distance {
    let from = |origin: [f64; 3]| -> [f64; 3] { std::array::from_fn(|d| point[d] - origin[d] - offset[d]) };
    match shape {
        Shape::Plane { point: origin, normal } => {
            let normal = normalised(*normal);
            Distance { value: dot(from(*origin), normal), normal, hessian: [[0.0; 3]; 3] }
        }
        Shape::Sphere { centre, radius, is_hollow } => round(from(*centre), IDENTITY, *radius, *is_hollow),
        Shape::Cylinder { point: origin, axis, radius, is_hollow } => {
            let (v, axis) = (from(*origin), normalised(*axis));
            let along = dot(v, axis);
            let across =
                std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) - axis[i] * axis[j]));
            round(std::array::from_fn(|d| v[d] - along * axis[d]), across, *radius, *is_hollow)
        }
        Shape::Cuboid { centre, size, axes, edge_radius } => {
            let v = from(*centre);
            let local = cuboid(axes.map(|axis| dot(axis, v)), size.map(|s| 0.5 * s - edge_radius), *edge_radius);
            let turned =
                |x: [f64; 3]| -> [f64; 3] { std::array::from_fn(|d| (0..3).map(|axis| axes[axis][d] * x[axis]).sum()) };
            let half = local.hessian.map(turned);
            let hessian: [[f64; 3]; 3] = std::array::from_fn(|i| turned([half[0][i], half[1][i], half[2][i]]));
            Distance { normal: turned(local.normal), hessian, ..local }
        }
    }
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Distance from a sphere or cylinder; `v` lies in the space onto which `across` projects.
fn round(v: [f64; 3], across: [[f64; 3]; 3], radius: f64, is_hollow: bool) -> Distance {
    let sign = if is_hollow { -1.0 } else { 1.0 };
    let r = dot(v, v).sqrt();
    if r <= f64::EPSILON * radius {
        // In the middle every direction is as good; any row of the projector that is not zero is one.
        let row = across.into_iter().max_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b))).unwrap_or(across[0]);
        return Distance { value: -sign * radius, normal: normalised(row), hessian: [[0.0; 3]; 3] };
    }
    let e = v.map(|x| x / r);
    let hessian = std::array::from_fn(|i| std::array::from_fn(|j| sign * (across[i][j] - e[i] * e[j]) / r));
    Distance { value: sign * (r - radius), normal: e.map(|x| sign * x), hessian }
}

/// Distance from a cuboid with half edges `half`, grown by `radius`, around the origin.
fn cuboid(q: [f64; 3], half: [f64; 3], radius: f64) -> Distance {
    let beyond: [f64; 3] = std::array::from_fn(|d| q[d] - q[d].clamp(-half[d], half[d]));
    let r = dot(beyond, beyond).sqrt();
    if r > 0.0 {
        let e = beyond.map(|x| x / r);
        let is_free = beyond.map(|x| f64::from(u8::from(x != 0.0)));
        let hessian =
            std::array::from_fn(|i| std::array::from_fn(|j| (if i == j { is_free[i] } else { 0.0 } - e[i] * e[j]) / r));
        // Along one axis alone the difference above is rounding.
        let hessian = if is_free.iter().sum::<f64>() < 2.0 { [[0.0; 3]; 3] } else { hessian };
        return Distance { value: r - radius, normal: e, hessian };
    }
    let depth: [f64; 3] = std::array::from_fn(|d| q[d].abs() - half[d]);
    let nearest = (0..3).fold(0, |best, d| if depth[d] > depth[best] { d } else { best });
    let mut normal = [0.0; 3];
    normal[nearest] = if q[nearest] < 0.0 { -1.0 } else { 1.0 };
    Distance { value: depth[nearest] - radius, normal, hessian: [[0.0; 3]; 3] }
}

fn normalised(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Vec<Shape> {
        let (s, c) = 0.4_f64.sin_cos();
        let turned = [[c, s, 0.0], [-s * 0.6, c * 0.6, 0.8], [s * 0.8, -c * 0.8, 0.6]];
        let cuboid =
            |axes, edge_radius| Shape::Cuboid { centre: [0.2, -0.1, 0.3], size: [2.0, 1.5, 1.0], axes, edge_radius };
        let mut shapes = vec![
            Shape::Plane { point: [0.1, 0.2, 0.3], normal: [1.0, -2.0, 0.5] },
            cuboid(IDENTITY, 0.0),
            cuboid(turned, 0.0),
            cuboid(turned, 0.3),
        ];
        for is_hollow in [false, true] {
            shapes.push(Shape::Sphere { centre: [0.2, 0.1, -0.3], radius: 1.2, is_hollow });
            shapes.push(Shape::Cylinder { point: [0.3, 0.0, 0.0], axis: [0.2, 0.5, 2.0], radius: 0.9, is_hollow });
        }
        shapes
    }

    fn points() -> impl Iterator<Item = [f64; 3]> {
        (0..1000).map(|i| {
            std::array::from_fn(|d| -2.0 + 4.0 * ((i as f64 * [0.819_172_513, 0.671_043_607, 0.549_700_478][d]) % 1.0))
        })
    }

    /// Normal and second derivative against differences, inside and outside; the normal is of length 1.
    #[test]
    fn derivatives_are_those_of_the_distance() {
        let offset = [0.05, -0.02, 0.1];
        for shape in shapes() {
            let (mut inside, mut curved) = (0, 0);
            for point in points() {
                let here = distance(&shape, offset, point);
                inside += usize::from(here.value < 0.0);
                curved += usize::from(here.hessian.iter().flatten().any(|x| x.abs() > 0.1));
                assert!((dot(here.normal, here.normal) - 1.0).abs() < 1e-12);
                let h = 1e-5;
                let shifted = |axis: usize, by: f64| {
                    let mut moved = point;
                    moved[axis] += by;
                    distance(&shape, offset, moved)
                };
                for axis in 0..3 {
                    let (low, high) = (shifted(axis, -h), shifted(axis, h));
                    let turn: f64 = (0..3).map(|d| (high.normal[d] - low.normal[d]).abs()).sum();
                    if turn > 0.1 {
                        continue; // Across an edge of the inside's nearest face.
                    }
                    assert!(((high.value - low.value) / (2.0 * h) - here.normal[axis]).abs() < 1e-5, "{shape:?}");
                    // Second differences across the border of an edge's region are not derivatives.
                    if low.hessian.iter().flatten().zip(high.hessian.iter().flatten()).any(|(a, b)| (a - b).abs() > 0.1)
                    {
                        continue;
                    }
                    for d in 0..3 {
                        let slope = (high.normal[d] - low.normal[d]) / (2.0 * h);
                        assert!((slope - here.hessian[d][axis]).abs() < 1e-4, "{shape:?} {point:?}");
                    }
                }
            }
            assert!(inside > 30, "{shape:?}");
            assert!(matches!(shape, Shape::Plane { .. }) || curved > 30, "{shape:?}: nothing to differentiate");
        }
    }

    /// The surface of a sharp cuboid sampled densely: distance of outer and inner points.
    #[test]
    fn the_distance_of_a_cuboid_is_that_of_its_nearest_surface_point() {
        let shape = Shape::Cuboid { centre: [0.0; 3], size: [2.0, 1.5, 1.0], axes: IDENTITY, edge_radius: 0.0 };
        let half = [1.0, 0.75, 0.5];
        let n = 60;
        for point in points().take(40) {
            let mut best = f64::INFINITY;
            for axis in 0..3 {
                for side in [-1.0, 1.0] {
                    for i in 0..=n {
                        for j in 0..=n {
                            let mut on: [f64; 3] = [0.0; 3];
                            on[axis] = side * half[axis];
                            let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
                            on[(axis + 1) % 3] = at(i) * half[(axis + 1) % 3];
                            on[(axis + 2) % 3] = at(j) * half[(axis + 2) % 3];
                            let gap: [f64; 3] = std::array::from_fn(|d| on[d] - point[d]);
                            best = best.min(dot(gap, gap).sqrt());
                        }
                    }
                }
            }
            let found = distance(&shape, [0.0; 3], point);
            let is_inside = (0..3).all(|d| point[d].abs() < half[d]);
            assert_eq!(found.value < 0.0, is_inside);
            assert!((found.value.abs() - best).abs() < 0.03, "{point:?}: {found:?} {best}");
        }
    }

    #[test]
    fn the_middle_of_a_ball_has_some_normal() {
        for is_hollow in [false, true] {
            let ball = Shape::Sphere { centre: [1.0; 3], radius: 2.0, is_hollow };
            let found = distance(&ball, [0.0; 3], [1.0; 3]);
            assert_eq!(found.value, if is_hollow { 2.0 } else { -2.0 });
            assert!((dot(found.normal, found.normal) - 1.0).abs() < 1e-12);
        }
    }
}
