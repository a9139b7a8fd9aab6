//! Integration of what meets a slave face: its points, piece by piece between the edges of the faces opposite (theory §5.9).
//!
//! An integral over a slave face of what its points feel of a master surface has kinks along the edges of the master's faces. So the slave
//! face is cut along these edges, seen in its own mean plane, and every piece has integration points of its own (Puso & Laursen 2004). The
//! pieces fill the slave face whatever the master looks like: where faces lie over each other or are curved, the cuts are not where the kinks
//! are, and the integral is that of a finer rule, no more.

use pneuflex_mesh::{FaceKind, Outline, quadrature, shape};

use crate::projection::{cross, dot, face_geometry, sub, unit_normal};

/// A point of a slave face with the area at rest that it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Reference coordinates on the slave face.
    pub xi: [f64; 2],
    /// mm².
    pub area: f64,
}

type Point = [f64; 2];

/// Pieces smaller than this share of the face are left out.
const NOTHING: f64 = 1e-12;

/// Corners nearer to a cut than this share of the face's size lie on it. Kinks that are so near to a cut cost the square of this; points of
/// thinner slivers would change from face to face with every small motion.
const ON_A_CUT: f64 = 1e-4;

/// Corners of a face must turn by more than this share of its size squared.
const FLAT: f64 = 1e-6;

/// A face in more pieces than this is not cut further.
const MOST_PIECES: usize = 64;

/// Integration points of a slave face with nodes at `nodes`, at rest at `rest`, against the corners of the master faces that are near.
/// Areas are multiplied by `share`. A face that is bent too much to be seen in its plane has the points of the multiple-point rule.
pub fn samples(kind: FaceKind, positions: [&[[f64; 3]]; 2], masters: &[&[[f64; 3]]], share: f64) -> Vec<Sample> {
    samples_of(&Rule::of(kind), kind, positions, masters, share)
}

/// The same with enough points, however few the pieces, for the mass matrix of the face's shape functions to be regular.
pub fn samples_for_masses(kind: FaceKind, nodes: &[[f64; 3]], masters: &[&[[f64; 3]]]) -> Vec<Sample> {
    let rule = Rule { triangle: quadrature::triangle_16(), ..Rule::of(kind) };
    samples_of(&rule, kind, [nodes; 2], masters, 1.0)
}

fn samples_of(
    rule: &Rule,
    kind: FaceKind,
    [nodes, rest]: [&[[f64; 3]]; 2],
    masters: &[&[[f64; 3]]],
    share: f64,
) -> Vec<Sample> {
    let area_at = |xi| share * unit_normal(&face_geometry(rest, &shape::evaluate_face(kind, xi)).tangents).1;
    let plane = Plane::of(kind, nodes);
    let corners: Vec<Point> = nodes[..kind.num_corners()].iter().map(|&x| plane.seen(x)).collect();
    let size = area(&corners);
    if !is_convex(&corners, size) {
        let rule = kind.contact_rule();
        return rule.into_iter().map(|(xi, weight)| Sample { xi, area: weight * area_at(xi) }).collect();
    }
    let mut pieces = vec![corners.clone()];
    for master in masters {
        let mut outline: Vec<Point> = master.iter().map(|&x| plane.seen(x)).collect();
        let turned = area(&outline);
        if turned < 0.0 {
            outline.reverse();
        }
        if pieces.len() < MOST_PIECES && is_convex(&outline, turned.abs()) && overlap(&outline, &corners) {
            pieces = cut(pieces, &outline, size);
        }
    }
    let mut samples = Vec::new();
    for piece in &pieces {
        rule.each(piece, |x, weight| {
            let (xi, determinant) = reference_point(&corners, x);
            samples.push(Sample { xi, area: weight / determinant * area_at(xi) });
        });
    }
    samples
}

/// The plane through a face's centre.
struct Plane {
    origin: [f64; 3],
    axes: [[f64; 3]; 2],
}

impl Plane {
    fn of(kind: FaceKind, nodes: &[[f64; 3]]) -> Self {
        let centre = face_geometry(nodes, &shape::evaluate_face(kind, kind.centre()));
        let normal = unit_normal(&centre.tangents).0;
        let length = dot(centre.tangents[0], centre.tangents[0]).sqrt();
        let first = centre.tangents[0].map(|x| x / length);
        Self { origin: centre.position, axes: [first, cross(normal, first)] }
    }

    fn seen(&self, x: [f64; 3]) -> Point {
        self.axes.map(|axis| dot(sub(x, self.origin), axis))
    }
}

/// Twice the area of the triangle a b c, positive if it turns to the left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn area(polygon: &[Point]) -> f64 {
    (2..polygon.len()).map(|i| 0.5 * turn(polygon[0], polygon[i - 1], polygon[i])).sum()
}

/// Whether a polygon turns to the left at every corner; false for what is not finite, too.
fn is_convex(polygon: &[Point], size: f64) -> bool {
    let n = polygon.len();
    size > 0.0 && (0..n).all(|i| turn(polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]) > FLAT * size)
}

fn overlap(a: &[Point], b: &[Point]) -> bool {
    let range = |polygon: &[Point], d: usize| {
        polygon.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x[d]), high.max(x[d])])
    };
    (0..2).all(|d| {
        let ([a0, a1], [b0, b1]) = (range(a, d), range(b, d));
        a0 < b1 && b0 < a1
    })
}

/// Cuts pieces along the outline of a convex polygon: what is inside of it, and what is outside.
fn cut(pieces: Vec<Vec<Point>>, outline: &[Point], size: f64) -> Vec<Vec<Point>> {
    let mut all = Vec::new();
    for piece in pieces {
        if !overlap(&piece, outline) {
            all.push(piece);
            continue;
        }
        let mut inside = piece;
        for (i, &from) in outline.iter().enumerate() {
            let to = outline[(i + 1) % outline.len()];
            let [left, right] = split(&inside, from, to, size);
            if area(&right) > NOTHING * size {
                all.push(right);
            }
            inside = left;
            if area(&inside) <= NOTHING * size {
                break;
            }
        }
        if area(&inside) > NOTHING * size {
            all.push(inside);
        }
    }
    all
}

/// What of a convex polygon lies on the left and on the right of a line.
fn split(polygon: &[Point], from: Point, to: Point, size: f64) -> [Vec<Point>; 2] {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let near = ON_A_CUT * size.sqrt();
    let side: Vec<f64> = polygon
        .iter()
        .map(|&x| turn(from, to, x) / length)
        .map(|distance| if distance.abs() < near { 0.0 } else { distance })
        .collect();
    // What has corners on the line only has no inside there; it would be counted with both parts.
    if side.iter().all(|&side| side >= 0.0) {
        return [polygon.to_vec(), Vec::new()];
    }
    if side.iter().all(|&side| side <= 0.0) {
        return [Vec::new(), polygon.to_vec()];
    }
    let mut parts = [Vec::new(), Vec::new()];
    for (i, &x) in polygon.iter().enumerate() {
        let next = (i + 1) % polygon.len();
        if side[i] >= 0.0 {
            parts[0].push(x);
        }
        if side[i] <= 0.0 {
            parts[1].push(x);
        }
        if side[i] * side[next] < 0.0 {
            let share = side[i] / (side[i] - side[next]);
            let crossing = std::array::from_fn(|d| x[d] + share * (polygon[next][d] - x[d]));
            parts[0].push(crossing);
            parts[1].push(crossing);
        }
    }
    parts
}

/// Rules for triangles and quadrangles that integrate the product of a corner's share and a shape function exactly on straight faces.
struct Rule {
    triangle: Vec<([f64; 2], f64)>,
    square: Vec<([f64; 2], f64)>,
}

impl Rule {
    fn of(kind: FaceKind) -> Self {
        // Degree 4 does for products of bilinear functions, and of linear with quadratic ones; biquadratic ones take 6.
        let is_low = kind.is_linear() || kind.outline == Outline::Triangle;
        let triangle = if is_low { quadrature::triangle_6() } else { quadrature::triangle_16() };
        Self { triangle, square: quadrature::quadrilateral(3) }
    }

    /// Tells the points of a convex polygon with their areas: it is taken as a fan of quadrangles and at most one triangle.
    fn each(&self, polygon: &[Point], mut tell: impl FnMut(Point, f64)) {
        let mut last = 1;
        while last + 1 < polygon.len() {
            if let Some(&fourth) = polygon.get(last + 2) {
                let corners = [polygon[0], polygon[last], polygon[last + 1], fourth];
                for &(xi, weight) in &self.square {
                    let (x, determinant) = bilinear(&corners, xi);
                    tell(x, weight * determinant);
                }
                last += 2;
            } else {
                let [a, b, c] = [polygon[0], polygon[last], polygon[last + 1]];
                for &([r, s], weight) in &self.triangle {
                    let x = std::array::from_fn(|d| a[d] + r * (b[d] - a[d]) + s * (c[d] - a[d]));
                    tell(x, weight * turn(a, b, c));
                }
                last += 1;
            }
        }
    }
}

/// Position and determinant of the bilinear map of the square \[−1, 1\]² at a point.
fn bilinear(corners: &[Point], xi: [f64; 2]) -> (Point, f64) {
    let (x, [a, b]) = bilinear_with_tangents(corners, xi);
    (x, a[0] * b[1] - a[1] * b[0])
}

fn bilinear_with_tangents(corners: &[Point], xi: [f64; 2]) -> (Point, [Point; 2]) {
    let shape = shape::evaluate_face(FaceKind::Quad4, xi);
    let sum = |of: &dyn Fn(usize) -> f64| -> Point {
        std::array::from_fn(|d| corners.iter().enumerate().map(|(i, corner)| of(i) * corner[d]).sum())
    };
    (sum(&|i| shape.values[i]), [sum(&|i| shape.gradients[i][0]), sum(&|i| shape.gradients[i][1])])
}

/// Reference coordinates of a point within a convex face given by its corners, and the determinant of the map there.
fn reference_point(corners: &[Point], x: Point) -> ([f64; 2], f64) {
    const MAX_ITERATIONS: usize = 30;
    let solve = |[a, b]: [Point; 2], rest: Point| {
        let determinant = a[0] * b[1] - a[1] * b[0];
        let step = [(rest[0] * b[1] - rest[1] * b[0]) / determinant, (a[0] * rest[1] - a[1] * rest[0]) / determinant];
        (step, determinant)
    };
    if let [a, b, c] = *corners {
        let edge = |to: Point| std::array::from_fn(|d| to[d] - a[d]);
        return solve([edge(b), edge(c)], edge(x));
    }
    let mut xi = [0.0; 2];
    let mut determinant = 1.0;
    for _ in 0..MAX_ITERATIONS {
        let (at, tangents) = bilinear_with_tangents(corners, xi);
        let (step, here) = solve(tangents, std::array::from_fn(|d| x[d] - at[d]));
        determinant = here;
        xi = [xi[0] + step[0], xi[1] + step[1]].map(|x| x.clamp(-1.0, 1.0));
        if step[0].abs().max(step[1].abs()) < 1e-13 {
            break;
        }
    }
    (xi, determinant)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A face of every family that is skewed but flat, with the nodes on its straight edges.
    fn skewed(kind: FaceKind) -> Vec<[f64; 3]> {
        let corners: &[Point] = match kind.outline {
            Outline::Square => &[[0.0, 0.1], [1.9, 0.0], [2.2, 1.7], [-0.2, 2.0]],
            Outline::Triangle => &[[0.0, 0.1], [1.9, 0.0], [-0.2, 2.0]],
        };
        let place = |[x, y]: [f64; 2]| {
            let at = match kind.outline {
                Outline::Square => bilinear(corners, [x, y]).0,
                Outline::Triangle => {
                    std::array::from_fn(|d| corners[0][d] * (1.0 - x - y) + corners[1][d] * x + corners[2][d] * y)
                }
            };
            [at[0], at[1], 0.3]
        };
        kind.nodes.iter().map(|&xi| place(xi)).collect()
    }

    fn grid(step: f64) -> Vec<Vec<[f64; 3]>> {
        let mut faces = Vec::new();
        for i in -2..4 {
            for j in -2..4 {
                // Seen from the other side, turned a little.
                let at = |i: i32, j: i32| {
                    let (x, y) = (step * f64::from(i), step * f64::from(j));
                    [x + 0.2 * y, y - 0.1 * x, 0.4]
                };
                faces.push(vec![at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
            }
        }
        faces
    }

    /// Every face is filled exactly, and polynomials over it are integrated as without cuts.
    #[test]
    fn pieces_fill_the_face() {
        for kind in FaceKind::ALL {
            let nodes = skewed(kind);
            let faces = grid(0.83);
            let masters: Vec<&[[f64; 3]]> = faces.iter().map(Vec::as_slice).collect();
            let cut = samples(kind, [&nodes, &nodes], &masters, 1.0);
            let whole = samples(kind, [&nodes, &nodes], &[], 1.0);
            assert!(cut.len() > 4 * whole.len(), "{kind:?}: nothing is cut");
            let integral = |of: &[Sample], power: [i32; 2]| -> f64 {
                of.iter()
                    .map(|sample| {
                        let x = face_geometry(&nodes, &shape::evaluate_face(kind, sample.xi)).position;
                        sample.area * x[0].powi(power[0]) * x[1].powi(power[1])
                    })
                    .sum()
            };
            for power in [[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [0, 3]] {
                let (a, b) = (integral(&cut, power), integral(&whole, power));
                assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{kind:?} {power:?}: {a} {b}");
            }
        }
    }

    /// Faces that match up to less than what counts as being on a cut, turned and moved a little.
    #[test]
    fn pieces_of_faces_that_nearly_match_fill_the_face() {
        let nodes = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        for offset in [0.0, 1e-12, 3e-9, 1e-5, 9e-5, 1.1e-4, 1e-3] {
            let at = |i: i32, j: i32| {
                let (x, y) = (f64::from(i), f64::from(j));
                [x + offset * (1.0 + y), y - offset * (1.0 + 0.5 * x), 0.1]
            };
            let face = |i, j| vec![at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            let faces: Vec<_> = (-1..2).flat_map(|i| (-1..2).map(move |j| (i, j))).map(|(i, j)| face(i, j)).collect();
            let masters: Vec<&[[f64; 3]]> = faces.iter().map(Vec::as_slice).collect();
            let found = samples(FaceKind::Quad4, [&nodes, &nodes], &masters, 1.0);
            let area: f64 = found.iter().map(|sample| sample.area).sum();
            assert!((area - 1.0).abs() < 1e-7, "{offset}: {area}");
            assert!(offset < 1e-3 || found.len() > 9, "{offset}: nothing is cut");
        }
    }

    /// The master's share of a uniform pressure: what a single rule over the slave face gets wrong by per cents.
    #[test]
    fn a_kinked_function_is_integrated_exactly() {
        let nodes = skewed(FaceKind::Quad4);
        let faces = grid(0.83);
        let masters: Vec<&[[f64; 3]]> = faces.iter().map(Vec::as_slice).collect();
        // |u| of a master line u = 0, in the grid's own coordinates: piecewise linear.
        let kinked = |x: [f64; 3]| ((x[0] - 0.2 * x[1]) / 1.02).abs().max(0.83) - 0.83;
        let integral = |of: &[Sample]| -> f64 {
            let at = |xi| face_geometry(&nodes, &shape::evaluate_face(FaceKind::Quad4, xi)).position;
            of.iter().map(|sample| sample.area * kinked(at(sample.xi))).sum()
        };
        let exact = {
            // A midpoint rule as fine as it takes.
            let n = 2000;
            let at = |i: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let (xi, weight) = ([at(i), at(j)], 4.0 / (n * n) as f64);
                    let geometry = face_geometry(&nodes, &shape::evaluate_face(FaceKind::Quad4, xi));
                    sum += weight * unit_normal(&geometry.tangents).1 * kinked(geometry.position);
                }
            }
            sum
        };
        let (cut, whole) = (
            integral(&samples(FaceKind::Quad4, [&nodes, &nodes], &masters, 1.0)),
            integral(&samples(FaceKind::Quad4, [&nodes, &nodes], &[], 1.0)),
        );
        assert!((cut - exact).abs() < 1e-6, "{cut} {exact}");
        assert!((whole - exact).abs() > 1e-3, "the check would be empty: {whole} {exact}");
    }

    #[test]
    fn a_folded_face_keeps_the_plain_rule() {
        let mut nodes = skewed(FaceKind::Quad4);
        nodes[2] = [0.3, 0.3, 0.3];
        let found = samples(FaceKind::Quad4, [&nodes, &skewed(FaceKind::Quad4)], &[], 0.5);
        assert_eq!(found.len(), 16);
    }
}
