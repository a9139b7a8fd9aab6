//! Deformed faces: positions, normals and the closest point on a face.

use pneuflex_mesh::{FaceKind, Facet, Mesh, shape};

use crate::vector::{Vec3, at_node, cross, dot, norm, sub};

/// A face in its deformed (or reference) position.
#[derive(Clone, Debug)]
pub(crate) struct Patch {
    kind: FaceKind,
    nodes: [Vec3; 9],
}

/// A point of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    /// Position, mm.
    pub position: Vec3,
    /// r_ξ × r_η, not normalised: its length is the area element.
    pub area_vector: Vec3,
}

/// The closest point of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    /// Reference coordinates on the face.
    pub xi: [f64; 2],
    /// Distance from the point that was projected, mm.
    pub distance: f64,
    /// Distance along the unit normal at the closest point, mm; negative behind the face.
    pub normal_distance: f64,
}

impl Patch {
    /// The face in the state with the given displacements (three per node); `None` for the reference position.
    pub fn new(mesh: &Mesh, facet: Facet, displacement: Option<&[f64]>) -> Self {
        let mut nodes = [[0.0; 3]; 9];
        for (position, node) in nodes.iter_mut().zip(mesh.facet_nodes(facet)) {
            *position = mesh.nodes[node as usize];
            if let Some(values) = displacement {
                let u = at_node(values, node);
                for d in 0..3 {
                    position[d] += u[d];
                }
            }
        }
        Self { kind: mesh.face_kind(), nodes }
    }

    /// Nodes of the face.
    pub fn nodes(&self) -> &[Vec3] {
        &self.nodes[..self.kind.num_nodes()]
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
        if self.kind != FaceKind::Quad4 {
            let widest = (0..3).map(|d| bounds.high[d] - bounds.low[d]).fold(0.0, f64::max);
            for d in 0..3 {
                bounds.low[d] -= 0.25 * widest;
                bounds.high[d] += 0.25 * widest;
            }
        }
        bounds
    }

    /// The closest point of the face, by Newton's method on ½‖r − r(ξ, η)‖² within the reference square.
    ///
    /// A step that leaves the square is cut off at its edge; a coordinate at an edge that pulls outwards is held there.
    /// Faces are quadrilaterals.
    pub fn closest(&self, point: Vec3, start: [f64; 2]) -> Projection {
        const ITERATIONS: usize = 30;
        let mut xi = start.map(|x| x.clamp(-1.0, 1.0));
        let mut projection = self.projection(point, xi);
        for _ in 0..ITERATIONS {
            let (gradient, hessian) = self.derivatives(point, xi);
            let held: [bool; 2] = std::array::from_fn(|a| xi[a].abs() >= 1.0 && gradient[a] * xi[a] <= 0.0);
            let step = match held {
                [true, true] => break,
                [true, false] => [0.0, -gradient[1] / hessian.gauss[2]],
                [false, true] => [-gradient[0] / hessian.gauss[0], 0.0],
                [false, false] => hessian.step(gradient),
            };
            // A Newton step on a strongly curved face may go uphill: shorten it then.
            let mut length = 1.0;
            let (next, candidate) = loop {
                let next: [f64; 2] = std::array::from_fn(|a| (xi[a] + length * step[a]).clamp(-1.0, 1.0));
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
    /// Newton step, with the full Hessian where it is safely positive definite.
    fn step(&self, gradient: [f64; 2]) -> [f64; 2] {
        let determinant = |h: [f64; 3]| h[0] * h[2] - h[1] * h[1];
        let safe = self.full[0] > 0.0 && determinant(self.full) > 0.05 * determinant(self.gauss);
        let h = if safe { self.full } else { self.gauss };
        let d = determinant(h);
        [-(h[2] * gradient[0] - h[1] * gradient[1]) / d, -(h[0] * gradient[1] - h[1] * gradient[0]) / d]
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub low: Vec3,
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
