//! Deformed faces: positions, normals and the closest point on a face.

use pneuflex_mesh::{FaceKind, Facet, Mesh, Outline, shape};

use pneuflex_mesh::vector::{Vec3, cross, dot, norm, sub};

/// A face in its deformed (or reference) position.
#[derive(Clone, Debug)]
pub struct Patch {
    kind: FaceKind,
    nodes: [Vec3; 9],
}

/// A point of a face.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position, mm.
    pub position: Vec3,
    /// r_ξ × r_η, not normalised: its length is the area element.
    pub area_vector: Vec3,
}

/// The closest point of a face.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Reference coordinates on the face.
    pub xi: [f64; 2],
    /// Distance from the point that was projected, mm.
    pub distance: f64,
    /// Distance along the unit normal at the closest point, mm; negative behind the face.
    pub normal_distance: f64,
}

impl Patch {
    /// The face in the state with the given displacements (mm, one entry per node); `None` for the reference position.
    pub fn new(mesh: &Mesh, facet: Facet, displacement: Option<&[[f64; 3]]>) -> Self {
        let mut nodes = [[0.0; 3]; 9];
        for (position, node) in nodes.iter_mut().zip(mesh.facet_nodes(facet)) {
            *position = mesh.nodes[node as usize];
            if let Some(values) = displacement {
                let u = values[node as usize];
                for d in 0..3 {
                    position[d] += u[d];
                }
            }
        }
        Self { kind: mesh.face_kind(facet), nodes }
    }

    /// Nodes of the face.
    pub fn nodes(&self) -> &[Vec3] {
        &self.nodes[..self.kind.num_nodes()]
    }

    /// Family of the face.
    pub fn kind(&self) -> FaceKind {
        self.kind
    }

    /// Position of the face's centre.
    pub fn centre(&self) -> Vec3 {
        self.at(self.kind.centre()).position
    }

    /// Position and area vector at a reference point.
    pub fn at(&self, xi: [f64; 2]) -> SurfacePoint {
        let shape = shape::evaluate_face(self.kind, xi);
        let (mut position, mut tangent) = ([0.0; 3], [[0.0; 3]; 2]);
        for (i, node) in self.nodes().iter().enumerate() {
            for d in 0..3 {
                position[d] += shape.values[i] * node[d];
                tangent[0][d] += shape.gradients[i][0] * node[d];
                tangent[1][d] += shape.gradients[i][1] * node[d];
            }
        }
        SurfacePoint { position, area_vector: cross(tangent[0], tangent[1]) }
    }

    /// A box around the face. Quadratic faces bulge beyond their nodes: their box is widened by a quarter.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::around(self.nodes());
        if !self.kind.is_linear() {
            let widest = (0..3).map(|d| bounds.high[d] - bounds.low[d]).fold(0.0, f64::max);
            for d in 0..3 {
                bounds.low[d] -= 0.25 * widest;
                bounds.high[d] += 0.25 * widest;
            }
        }
        bounds
    }

    /// The closest point of the face, by Newton's method from its centre on ½‖r − r(ξ, η)‖² within the reference face.
    ///
    /// On the square, a step that leaves it is cut off at its edge, and a coordinate at an edge that pulls outwards is held
    /// there. On the triangle, every step goes to the minimum of the quadratic model over the triangle.
    pub fn closest(&self, point: Vec3) -> Projection {
        const ITERATIONS: usize = 30;
        let mut xi = self.kind.centre();
        let mut projection = self.projection(point, xi);
        for _ in 0..ITERATIONS {
            let (gradient, hessian) = self.derivatives(point, xi);
            let is_triangle = self.kind.outline == Outline::Triangle;
            let step = if is_triangle {
                hessian.step_in_triangle(gradient, xi)
            } else {
                let held: [bool; 2] = std::array::from_fn(|a| xi[a].abs() >= 1.0 && gradient[a] * xi[a] <= 0.0);
                match held {
                    [true, true] => break,
                    [true, false] => [0.0, -gradient[1] / hessian.gauss[2]],
                    [false, true] => [-gradient[0] / hessian.gauss[0], 0.0],
                    [false, false] => hessian.step(gradient),
                }
            };
            // A Newton step on a strongly curved face may go uphill: shorten it then.
            let mut length = 1.0;
            let (next, candidate) = loop {
                let next: [f64; 2] = std::array::from_fn(|a| xi[a] + length * step[a]);
                let next = if is_triangle { next } else { next.map(|x| x.clamp(-1.0, 1.0)) };
                let candidate = self.projection(point, next);
                if candidate.distance <= projection.distance || length < 1e-3 {
                    break (next, candidate);
                }
                length *= 0.5;
            };
            let moved = (next[0] - xi[0]).abs().max((next[1] - xi[1]).abs());
            if candidate.distance > projection.distance {
                break;
            }
            (xi, projection) = (next, candidate);
            if moved < 1e-10 {
                break;
            }
        }
        projection
    }

    fn projection(&self, point: Vec3, xi: [f64; 2]) -> Projection {
        let here = self.at(xi);
        let offset = sub(point, here.position);
        let length = norm(here.area_vector);
        let normal_distance = if length > 0.0 { dot(offset, here.area_vector) / length } else { 0.0 };
        Projection { xi, distance: norm(offset), normal_distance }
    }

    /// Gradient of ½‖r − r(ξ, η)‖², and its Hessian with and without the curvature of the face.
    fn derivatives(&self, point: Vec3, xi: [f64; 2]) -> ([f64; 2], Hessian) {
        let shape = shape::evaluate_face(self.kind, xi);
        let mut offset = point;
        let (mut first, mut second) = ([[0.0; 3]; 2], [[0.0; 3]; 3]);
        for (i, node) in self.nodes().iter().enumerate() {
            for d in 0..3 {
                offset[d] -= shape.values[i] * node[d];
                for a in 0..2 {
                    first[a][d] += shape.gradients[i][a] * node[d];
                }
                for a in 0..3 {
                    second[a][d] += shape.hessians[i][a] * node[d];
                }
            }
        }
        let gauss = [dot(first[0], first[0]), dot(first[0], first[1]), dot(first[1], first[1])];
        let full = std::array::from_fn(|a| gauss[a] - dot(offset, second[a]));
        ([-dot(offset, first[0]), -dot(offset, first[1])], Hessian { gauss, full })
    }
}

/// Second derivatives (ξξ, ξη, ηη) of half the squared distance.
struct Hessian {
    gauss: [f64; 3],
    full: [f64; 3],
}

impl Hessian {
    /// The full Hessian where it is safely positive definite, otherwise the one without the curvature.
    fn definite(&self) -> [f64; 3] {
        let determinant = |h: [f64; 3]| h[0] * h[2] - h[1] * h[1];
        let safe = self.full[0] > 0.0 && determinant(self.full) > 0.05 * determinant(self.gauss);
        if safe { self.full } else { self.gauss }
    }

    /// Newton step.
    fn step(&self, gradient: [f64; 2]) -> [f64; 2] {
        let h = self.definite();
        let d = h[0] * h[2] - h[1] * h[1];
        [-(h[2] * gradient[0] - h[1] * gradient[1]) / d, -(h[0] * gradient[1] - h[1] * gradient[0]) / d]
    }

    /// Step from `xi` to the minimum of the quadratic model over the reference triangle.
    fn step_in_triangle(&self, gradient: [f64; 2], xi: [f64; 2]) -> [f64; 2] {
        let step = self.step(gradient);
        let target = [xi[0] + step[0], xi[1] + step[1]];
        if target[0] >= 0.0 && target[1] >= 0.0 && target[0] + target[1] <= 1.0 {
            return step;
        }
        let h = self.definite();
        let times = |s: [f64; 2]| [h[0] * s[0] + h[1] * s[1], h[1] * s[0] + h[2] * s[1]];
        let product = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let model = |s: [f64; 2]| product(gradient, s) + 0.5 * product(s, times(s));
        // The model is convex: its minimum is then on an edge. An edge is a corner and a direction.
        let edges = [([0.0, 0.0], [1.0, 0.0]), ([1.0, 0.0], [-1.0, 1.0]), ([0.0, 1.0], [0.0, -1.0])];
        edges
            .map(|(corner, along)| {
                let to_corner = [corner[0] - xi[0], corner[1] - xi[1]];
                let slope = product(gradient, along) + product(along, times(to_corner));
                let t = (-slope / product(along, times(along))).clamp(0.0, 1.0);
                [to_corner[0] + t * along[0], to_corner[1] + t * along[1]]
            })
            .into_iter()
            .min_by(|a, b| model(*a).total_cmp(&model(*b)))
            .unwrap_or([0.0; 2])
    }
}

/// Centre of cell (i, j) of a reference face divided into n × n equal cells. The cells of a triangle are cut by lines
/// parallel to its sides: those with i + j < n stand upright, the others fill the places between, on their heads.
pub fn cell_centre(kind: FaceKind, n: usize, [i, j]: [usize; 2]) -> [f64; 2] {
    match kind.outline {
        Outline::Triangle if i + j < n => [i, j].map(|k| (k as f64 + 1.0 / 3.0) / n as f64),
        Outline::Triangle => [n - 1 - i, n - 1 - j].map(|k| (k as f64 + 2.0 / 3.0) / n as f64),
        Outline::Square => [i, j].map(|k| (2 * k + 1) as f64 / n as f64 - 1.0),
    }
}

/// Distance of a reference point from the edges, in their order and in reference coordinates; the fourth of a triangle is
/// infinitely far.
pub fn edge_distances(kind: FaceKind, [xi, eta]: [f64; 2]) -> [f64; 4] {
    match kind.outline {
        Outline::Triangle => [eta, 1.0 - xi - eta, xi, f64::INFINITY],
        Outline::Square => [1.0 + eta, 1.0 - xi, 1.0 - eta, 1.0 + xi],
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Least coordinates, mm.
    pub low: Vec3,
    /// Greatest coordinates, mm.
    pub high: Vec3,
}

impl Bounds {
    /// The smallest box around some points.
    pub fn around(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, p| b.join(&Self { low: *p, high: *p }))
    }

    /// A box that holds nothing.
    pub const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    /// The smallest box around both.
    pub fn join(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|d| self.low[d].min(other.low[d])),
            high: std::array::from_fn(|d| self.high[d].max(other.high[d])),
        }
    }

    /// Distance of a point from the box; 0 inside.
    pub fn distance(&self, point: Vec3) -> f64 {
        norm(std::array::from_fn(|d| (self.low[d] - point[d]).max(point[d] - self.high[d]).max(0.0)))
    }

    /// Centre of the box.
    pub fn centre(&self) -> Vec3 {
        std::array::from_fn(|d| 0.5 * (self.low[d] + self.high[d]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curved triangle above the xy plane.
    fn curved() -> Patch {
        let mut nodes = [[0.0; 3]; 9];
        let reference = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
        for (node, [x, y]) in nodes.iter_mut().zip(reference) {
            *node = [2.0 * x + 0.1 * y, 1.5 * y - 0.2 * x * x, 0.3 * x * (1.0 - y) - 0.4 * y * y];
        }
        Patch { kind: FaceKind::Tri6, nodes }
    }

    #[test]
    fn the_closest_point_of_a_triangle_is_that_of_a_dense_sampling() {
        let patch = curved();
        let mut seen = [0; 4];
        for point in
            [[0.8, 0.4, 0.5], [0.9, -0.7, 0.2], [1.9, 1.4, -0.3], [-0.6, 0.5, 0.1], [3.0, -0.5, 0.4], [0.1, 2.4, 0.0]]
        {
            let found = patch.closest(point);
            const N: usize = 300;
            let mut best = f64::INFINITY;
            for i in 0..=N {
                for j in 0..=N - i {
                    best = best.min(norm(sub(point, patch.at([i, j].map(|k| k as f64 / N as f64)).position)));
                }
            }
            assert!(found.distance <= best + 1e-12 && best - found.distance < 1e-3, "{point:?}: {found:?}, {best}");
            let distances = edge_distances(FaceKind::Tri6, found.xi);
            seen[distances.iter().filter(|d| **d < 1e-12).count()] += 1;
        }
        assert!(seen[0] > 0 && seen[1] > 1 && seen[2] > 1, "inside, on edges, at corners: {seen:?}");
    }

    #[test]
    fn cells_of_a_triangle_fill_it() {
        const N: usize = 12;
        let centres: Vec<[f64; 2]> = (0..N * N).map(|k| cell_centre(FaceKind::Tri6, N, [k / N, k % N])).collect();
        // The centres of equal cells integrate linear functions exactly: centroid and area.
        for d in 0..2 {
            let mean = centres.iter().map(|c| c[d]).sum::<f64>() / (N * N) as f64;
            assert!((mean - 1.0 / 3.0).abs() < 1e-12);
        }
        let nearest = (0..centres.len())
            .flat_map(|a| (0..a).map(move |b| (a, b)))
            .map(|(a, b)| (centres[a][0] - centres[b][0]).hypot(centres[a][1] - centres[b][1]))
            .fold(f64::INFINITY, f64::min);
        assert!(nearest > 0.4 / N as f64);
    }
}
