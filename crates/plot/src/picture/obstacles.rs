//! Rigid obstacles beside a body, as faces of the same kind as its skin.

use pneuflex_mesh::FaceKind;
use pneuflex_mesh::vector::{Vec3, cross, dot, norm};
use pneuflex_model::{LoadParameter, Obstacle, Problem, Shape};
use pneuflex_post::surface::Bounds;

use super::skin::{Face, Vertex};
use super::view::unit;

/// Pieces of a face along each direction: round ones look round.
const PIECES: usize = 24;

/// How far what is endless goes on beyond the body, as a share of its size.
const BEYOND: f64 = 0.15;

/// Half of the thickness of what stands for a plane, as a share of half its length.
const THICKNESS: f64 = 0.01;

/// Which part of a half model's world is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Extent {
    /// All of it, what stands beside a plane of symmetry once.
    Part,
    /// All of it, with the mirror images of what stands beside planes of symmetry.
    Whole,
    /// What lies on the modelled side of a plane y = const, above it.
    Section(f64),
}

/// The obstacles of a body that fills a box, at a position on the load path. What the body is inside of is left out: it would hide it.
pub(crate) fn faces(problem: &Problem, at: LoadParameter, body: &Bounds, extent: Extent) -> Vec<Face> {
    let mut all = Vec::new();
    for obstacle in &problem.obstacles {
        let mut own = surface(obstacle, at, body);
        match extent {
            Extent::Part => {}
            Extent::Whole => {
                for plane in problem.symmetry.iter().filter(|plane| !plane.is_symmetry_of(obstacle)) {
                    let mut other = own.clone();
                    for vertex in other.iter_mut().flat_map(|face| &mut face.vertices) {
                        vertex.position = plane.mirror_point(vertex.position);
                        vertex.normal = plane.mirror_vector(vertex.normal);
                    }
                    own.extend(other);
                }
            }
            Extent::Section(plane) => {
                for vertex in own.iter_mut().flat_map(|face| &mut face.vertices) {
                    if vertex.position[1] < plane {
                        // The cut is flat.
                        vertex.position[1] = plane;
                        vertex.normal = [0.0, -1.0, 0.0];
                    }
                }
            }
        }
        all.extend(own);
    }
    all
}

/// The surface of an obstacle as triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObstacleSurface {
    /// Corners, mm, with their outward unit normals.
    pub corners: Vec<[Vec3; 2]>,
    /// Corners of the triangles, which look outwards.
    pub triangles: Vec<[u32; 3]>,
}

/// An obstacle at a position on the load path, beside a body around which there are points. What is endless ends a little beyond them; what
/// the body is inside of has no surface, which would hide it.
pub fn obstacle_surface(obstacle: &Obstacle, at: LoadParameter, points: &[Vec3]) -> ObstacleSurface {
    let mut found = ObstacleSurface::default();
    for face in surface(obstacle, at, &Bounds::around(points)) {
        let first = found.corners.len() as u32;
        found.triangles.extend(face.triangles().into_iter().map(|triangle| {
            let [a, b, c] = triangle.map(|i| face.vertices[i].position);
            let area = cross(std::array::from_fn(|d| b[d] - a[d]), std::array::from_fn(|d| c[d] - a[d]));
            let [i, j, k] = triangle.map(|i| first + i as u32);
            if dot(area, face.vertices[triangle[0]].normal) < 0.0 { [i, k, j] } else { [i, j, k] }
        }));
        found.corners.extend(face.vertices.iter().map(|vertex| [vertex.position, vertex.normal]));
    }
    found
}

fn surface(obstacle: &Obstacle, at: LoadParameter, body: &Bounds) -> Vec<Face> {
    let offset = obstacle.offset(at);
    let moved = |x: Vec3| -> Vec3 { std::array::from_fn(|d| x[d] + offset[d]) };
    match obstacle.shape {
        Shape::Plane { point, normal } => {
            // A slab below it, so that it is seen from the side, too, and not from behind, where it would hide the body.
            let axes = frame(normal);
            let reach = [0, 1].map(|k| passed(body, axes[k]));
            let half = [reach[0].half(), reach[1].half(), THICKNESS * reach[0].half().max(reach[1].half())];
            let middle = along(&axes, [reach[0].at(0.0), reach[1].at(0.0), dot(moved(point), axes[2]) - half[2]]);
            let place = |x: Vec3, normal| (std::array::from_fn(|d| middle[d] + x[d]), normal);
            let mut slab = sides(axes, half, [true; 4], place);
            slab.retain(|face| dot(face.vertices[0].normal, axes[2]) > -0.5);
            slab
        }
        Shape::Sphere { is_hollow: true, .. } | Shape::Cylinder { is_hollow: true, .. } => Vec::new(),
        Shape::Sphere { centre, radius, .. } => {
            let centre = moved(centre);
            let on_ball = move |x: Vec3| {
                let normal = unit(x);
                (std::array::from_fn(|d| centre[d] + radius * normal[d]), normal)
            };
            sides([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [1.0; 3], [false; 4], |x, _| on_ball(x))
        }
        Shape::Cylinder { point, axis, radius, .. } => {
            let axes = frame(axis);
            let (middle, reach) = (moved(point), passed(body, axes[2]));
            let quarters = (0..4).map(|quarter| {
                patch([true, false, true, false], |[a, b]| {
                    let angle = (f64::from(quarter) + 0.5 * (a + 1.0)) * std::f64::consts::FRAC_PI_2;
                    let normal: Vec3 = std::array::from_fn(|d| angle.cos() * axes[0][d] + angle.sin() * axes[1][d]);
                    let height = reach.at(b) - dot(middle, axes[2]);
                    (std::array::from_fn(|d| middle[d] + radius * normal[d] + height * axes[2][d]), normal)
                })
            });
            quarters.collect()
        }
        Shape::Cuboid { centre, size, axes, .. } => {
            let centre = moved(centre);
            sides(axes, size.map(|s| 0.5 * s), [true; 4], |x, normal| {
                (std::array::from_fn(|d| centre[d] + x[d]), normal)
            })
        }
    }
}

/// The six sides of a box around the origin; `place` has a point of the box and its outward normal.
fn sides(axes: [Vec3; 3], half: Vec3, is_edge: [bool; 4], place: impl Fn(Vec3, Vec3) -> (Vec3, Vec3)) -> Vec<Face> {
    let mut faces = Vec::new();
    for k in 0..3 {
        for side in [-1.0, 1.0] {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            let normal = axes[k].map(|x| side * x);
            faces.push(patch(is_edge, |[a, b]| {
                let point = std::array::from_fn(|d| {
                    side * half[k] * axes[k][d] + a * half[u] * axes[u][d] + b * half[v] * axes[v][d]
                });
                place(point, normal)
            }));
        }
    }
    faces
}

/// A face over −1 … 1 along two directions; `place` gives a point and its outward normal.
fn patch(is_edge: [bool; 4], place: impl Fn([f64; 2]) -> (Vec3, Vec3)) -> Face {
    let at = |i: usize| 2.0 * i as f64 / PIECES as f64 - 1.0;
    let grid = (0..=PIECES).flat_map(|j| (0..=PIECES).map(move |i| [at(i), at(j)]));
    let vertices = grid.map(|xi| {
        let (position, normal) = place(xi);
        Vertex { position, normal, xi, value: 0.0 }
    });
    Face { kind: FaceKind::Quad4, vertices: vertices.collect(), pieces: PIECES, is_edge, is_of_body: false }
}

/// An interval.
#[derive(Clone, Copy)]
struct Reach {
    low: f64,
    high: f64,
}

impl Reach {
    fn half(self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// The place at −1 … 1 of it.
    fn at(self, share: f64) -> f64 {
        0.5 * (self.low + self.high) + share * self.half()
    }
}

/// What of a direction a box passes, and a little more.
fn passed(body: &Bounds, direction: Vec3) -> Reach {
    let corner = |i: usize| std::array::from_fn(|d| if i >> d & 1 == 0 { body.low[d] } else { body.high[d] });
    let heights = (0..8).map(|i| dot(corner(i), direction));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
    let more = BEYOND * norm(std::array::from_fn(|d| body.high[d] - body.low[d]));
    Reach { low: low - more, high: high + more }
}

/// Orthogonal axes of which the third one has a direction.
fn frame(direction: Vec3) -> [Vec3; 3] {
    let third = unit(direction);
    // The axis that is furthest from it.
    let far = (0..3).fold(0, |far, d| if third[d].abs() < third[far].abs() { d } else { far });
    let first = unit(cross(std::array::from_fn(|d| if d == far { 1.0 } else { 0.0 }), third));
    [first, cross(third, first), third]
}

/// A sum of axes.
fn along(axes: &[Vec3; 3], shares: Vec3) -> Vec3 {
    std::array::from_fn(|d| (0..3).map(|k| shares[k] * axes[k][d]).sum())
}

#[cfg(test)]
mod tests {
    use pneuflex_model::{Curve, Motion, SymmetryPlane};

    use super::*;
    use crate::testing::two_chambers;

    fn thing(shape: Shape, motion: Option<Motion>) -> Obstacle {
        let facets = Vec::new();
        let (stiffness, report_force) = (1.0, true);
        let (penetration_tolerance, interference_until) = (None, None);
        Obstacle {
            name: "thing".into(),
            shape,
            facets,
            stiffness,
            motion,
            report_force,
            penetration_tolerance,
            interference_until,
        }
    }

    #[test]
    fn what_is_drawn_is_the_surface_where_it_has_moved_to() {
        let body = Bounds { low: [0.0, -10.0, 0.0], high: [20.0, 10.0, 15.0] };
        let motion = || Some(Motion { displacement: [0.0, 0.0, 2.0], curve: Curve::Proportional(0.5) });
        let at = LoadParameter(4.0);
        let (centre, radius) = ([5.0, 1.0, -8.0], 3.0);
        let size = [2.0, 4.0, 6.0];
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let from = |x: Vec3| -> Vec3 { [x[0] - 5.0, x[1] - 1.0, x[2] + 4.0] };
        let shapes: [(Shape, &dyn Fn(Vec3) -> f64); 4] = [
            (Shape::Sphere { centre, radius, is_hollow: false }, &|x| norm(from(x)) - radius),
            (Shape::Cylinder { point: centre, axis: [0.0, 2.0, 0.0], radius, is_hollow: false }, &|x| {
                from(x)[0].hypot(from(x)[2]) - radius
            }),
            (Shape::Cuboid { centre, size, axes, edge_radius: 0.1 }, &|x| {
                (0..3).map(|d| from(x)[d].abs() - 0.5 * size[d]).fold(f64::NEG_INFINITY, f64::max)
            }),
            (Shape::Plane { point: centre, normal: [0.0, 0.0, 3.0] }, &|x| from(x)[2].max(0.0)),
        ];
        for (shape, distance) in shapes {
            let faces = surface(&thing(shape.clone(), motion()), at, &body);
            let vertices = || faces.iter().flat_map(|face| &face.vertices);
            assert!(!faces.is_empty() && vertices().all(|v| distance(v.position).abs() < 1e-9), "{shape:?}");
            assert!(vertices().all(|v| (norm(v.normal) - 1.0).abs() < 1e-9), "{shape:?}");
            let found = obstacle_surface(&thing(shape.clone(), motion()), at, &[body.low, body.high]);
            let outwards = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| found.corners[i as usize]);
                let edge = |to: [Vec3; 2]| std::array::from_fn(|d| to[0][d] - a[0][d]);
                dot(cross(edge(b), edge(c)), a[1]) >= 0.0
            };
            assert!(found.triangles.len() > 1000 && found.triangles.iter().all(outwards), "{shape:?}");
        }
        // What is endless reaches beyond the body; one does not look at a plane from behind, nor through a tube.
        let plane = surface(&thing(Shape::Plane { point: centre, normal: [0.0, 0.0, 1.0] }, None), at, &body);
        let reach = plane.iter().flat_map(|face| &face.vertices).map(|v| v.position[0]);
        assert!(reach.clone().fold(f64::INFINITY, f64::min) < 0.0 && reach.fold(0.0, f64::max) > 20.0);
        assert!(plane.iter().flat_map(|face| &face.vertices).all(|v| v.normal[2] > -0.5));
        assert!(surface(&thing(Shape::Sphere { centre, radius: 99.0, is_hollow: true }, None), at, &body).is_empty());
    }

    #[test]
    fn beside_a_plane_of_symmetry_there_are_two_and_a_section_shows_one_side() {
        let mut problem = two_chambers(2.0);
        problem.symmetry = vec![SymmetryPlane { axis: 1, at: 0.0, support: 0 }];
        let body = Bounds { low: [0.0; 3], high: [20.0, 10.0, 15.0] };
        let count = |y: f64, extent: Extent| {
            let shape = Shape::Sphere { centre: [5.0, y, -4.0], radius: 3.0, is_hollow: false };
            let problem = Problem { obstacles: vec![thing(shape, None)], ..problem.clone() };
            let faces = faces(&problem, LoadParameter(0.0), &body, extent);
            let least = faces.iter().flat_map(|face| &face.vertices).map(|v| v.position[1]).fold(9.0, f64::min);
            (faces.len(), least)
        };
        let near =
            |(count, least): (usize, f64), (expected, y): (usize, f64)| count == expected && (least - y).abs() < 1e-9;
        assert!(near(count(0.0, Extent::Part), (6, -3.0)) && near(count(0.0, Extent::Whole), (6, -3.0)));
        assert!(near(count(5.0, Extent::Part), (6, 2.0)) && near(count(5.0, Extent::Whole), (12, -8.0)));
        assert!(near(count(0.0, Extent::Section(0.0)), (6, 0.0)));
    }
}
