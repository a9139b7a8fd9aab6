//! How a surface is stretched around a corner: polynomials fitted to the stretch at its faces' best points.

use pneuflex_mesh::{FaceKind, Outline, shape};

use crate::stress::solve_positive_definite;
use pneuflex_mesh::vector::{Vec3, cross, dot, norm, sub};

/// A symmetric tensor of the surface as a matrix: U_s², the deformed metric in the reference tangents.
pub type Tensor = [[f64; 3]; 3];

/// A measured U_s² of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub position: Vec3,
    pub normal: Vec3,
    pub tensor: Tensor,
}

impl Sample {
    pub fn mirrored(&self, axis: usize, at: f64) -> Self {
        let sign = |d: usize| if d == axis { -1.0 } else { 1.0 };
        let mut position = self.position;
        position[axis] = 2.0 * at - position[axis];
        let normal = std::array::from_fn(|d| sign(d) * self.normal[d]);
        let tensor = std::array::from_fn(|i| std::array::from_fn(|j| sign(i) * sign(j) * self.tensor[i][j]));
        Self { position, normal, tensor }
    }
}

/// Polynomials for the components of U_s² in the tangent plane at a corner.
pub struct Patch {
    centre: Vec3,
    pub normal: Vec3,
    pub axes: [Vec3; 2],
    size: f64,
    /// Of xx, yy and xy.
    coefficients: [[f64; TERMS]; 3],
}

pub const TERMS: usize = 6;

/// Weight of what samples do not tell apart, by the degree of the term: the lower one is taken.
const RIDGE: [f64; TERMS] = [0.0, 1e-10, 1e-10, 1e-8, 1e-8, 1e-8];

impl Patch {
    pub fn fit(centre: Vec3, normal: Vec3, samples: &[Sample], is_quadratic: bool) -> Option<Self> {
        let axes = plane(normal);
        let size = samples.iter().map(|sample| norm(sub(sample.position, centre))).fold(0.0, f64::max);
        let mut patch = Self { centre, normal, axes, size, coefficients: [[0.0; TERMS]; 3] };
        let (mut matrix, mut sides) = ([[0.0; TERMS]; TERMS], [[0.0; TERMS]; 3]);
        for sample in samples {
            let terms = patch.terms(sample.position);
            let turned = axes.map(|axis| turn(axis, normal, sample.normal));
            let component = |p: usize, q: usize| {
                (0..3)
                    .map(|i| turned[p][i] * (0..3).map(|j| sample.tensor[i][j] * turned[q][j]).sum::<f64>())
                    .sum::<f64>()
            };
            let values = [component(0, 0), component(1, 1), component(0, 1)];
            for i in 0..TERMS {
                (0..TERMS).for_each(|j| matrix[i][j] += terms[i] * terms[j]);
                (0..3).for_each(|c| sides[c][i] += terms[i] * values[c]);
            }
        }
        for i in 0..TERMS {
            let is_left_out = !is_quadratic && i > 2;
            matrix[i][i] += samples.len() as f64 * if is_left_out { 1e12 } else { RIDGE[i] };
        }
        patch.coefficients = sides.map(|side| solve_positive_definite(matrix, side));
        patch.coefficients.as_flattened().iter().all(|c| c.is_finite()).then_some(patch)
    }

    fn terms(&self, position: Vec3) -> [f64; TERMS] {
        let way = sub(position, self.centre);
        let [x, y] = self.axes.map(|axis| dot(axis, way) / self.size);
        [1.0, x, y, x * x, x * y, y * y]
    }

    pub fn value(&self, position: Vec3) -> [f64; 3] {
        let terms = self.terms(position);
        self.coefficients.map(|own| own.iter().zip(terms).map(|(c, t)| c * t).sum())
    }
}

/// Points of a face at which its stretch is most exact (Barlow 1976).
pub fn sampling_points(kind: FaceKind) -> Vec<[f64; 2]> {
    match (kind.is_linear(), kind.outline) {
        (true, _) => vec![kind.centre()],
        (false, Outline::Square) => {
            let a = 1.0 / 3.0_f64.sqrt();
            vec![[-a, -a], [a, -a], [a, a], [-a, a]]
        }
        (false, Outline::Triangle) => vec![[1.0 / 6.0, 1.0 / 6.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0]],
    }
}

/// Position and tangents of a face at a reference point.
pub fn tangents(kind: FaceKind, nodes: &[u32], positions: &[[f64; 3]], xi: [f64; 2]) -> [Vec3; 3] {
    let shape = shape::evaluate_face(kind, xi);
    let mut sums = [[0.0; 3]; 3];
    for (i, &node) in nodes.iter().enumerate() {
        let factors = [shape.values[i], shape.gradients[i][0], shape.gradients[i][1]];
        for (sum, factor) in sums.iter_mut().zip(factors) {
            (0..3).for_each(|d| sum[d] += factor * positions[node as usize][d]);
        }
    }
    sums
}

pub fn area_vector(kind: FaceKind, nodes: &[u32], positions: &[[f64; 3]], xi: [f64; 2]) -> Vec3 {
    let [_, a, b] = tangents(kind, nodes, positions, xi);
    cross(a, b)
}

/// The vectors in the plane of two tangents whose products with these are 1 and 0.
pub fn dual([a, b]: [Vec3; 2], normal: Vec3) -> [Vec3; 2] {
    let area = dot(cross(a, b), normal);
    [cross(b, normal), cross(normal, a)].map(|v| v.map(|x| x / area))
}

pub fn unit(v: Vec3) -> Vec3 {
    let length = norm(v);
    v.map(|x| x / length)
}

/// Two unit vectors that make a right-handed triad with a normal.
pub fn plane(normal: Vec3) -> [Vec3; 2] {
    let smallest = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or_default();
    let axis = std::array::from_fn(|d| f64::from(u8::from(d == smallest)));
    let first = unit(cross(axis, normal));
    [first, cross(normal, first)]
}

/// A vector turned as the shortest rotation turns one unit normal into another, which is not opposite to it.
pub fn turn(v: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let axis = cross(from, to);
    let across = cross(axis, v);
    let share = dot(axis, v) / (1.0 + dot(from, to));
    let cosine = dot(from, to);
    std::array::from_fn(|d| cosine * v[d] + across[d] + share * axis[d])
}
