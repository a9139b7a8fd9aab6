//! Families of faces, the two-dimensional traces of solid elements. A family is one [`FaceFamily`] below.
//!
//! Nodes are numbered corners first, then mid-edges in the order of the corners, then the centre.

use std::ops::{Deref, Index};

use serde::{Deserialize, Serialize};

use crate::polynomial::quadratic_line;
use crate::quadrature;

/// Family of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FaceKind {
    /// Bilinear quadrilateral.
    Quad4,
    /// Serendipity quadratic quadrilateral.
    Quad8,
    /// Biquadratic quadrilateral.
    Quad9,
    /// Quadratic triangle.
    Tri6,
    /// Quadratic triangle with a node at its centre.
    Tri7,
}

/// What the reference face looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outline {
    /// \[−1, 1\]².
    Square,
    /// The unit triangle.
    Triangle,
}

/// What a family of faces is.
#[derive(Debug)]
pub struct FaceFamily {
    /// The reference face.
    pub outline: Outline,
    /// Reference coordinates of the nodes.
    pub nodes: &'static [[f64; 2]],
    /// Shape functions with their derivatives at a reference point.
    pub shape: fn([f64; 2]) -> FaceShape,
    /// Rule for integrals over faces with geometry and pressure of the family.
    pub rule: fn() -> Vec<([f64; 2], f64)>,
    /// By how much of their nodes' extent faces may exceed it: half of what Σ|Nᵢ| exceeds 1 by, or more.
    pub bulge: f64,
    /// Cell type number of the VTK file formats.
    pub vtk_cell_type: u8,
    /// Number of Gmsh's element type; `None` if there is none.
    pub gmsh_type: Option<i32>,
}

impl FaceKind {
    /// What the family is.
    pub const fn family(self) -> &'static FaceFamily {
        match self {
            Self::Quad4 => &QUAD4,
            Self::Quad8 => &QUAD8,
            Self::Quad9 => &QUAD9,
            Self::Tri6 => &TRI6,
            Self::Tri7 => &TRI7,
        }
    }

    /// All families.
    pub const ALL: [Self; 5] = [Self::Quad4, Self::Quad8, Self::Quad9, Self::Tri6, Self::Tri7];
}

/// One value for each family of faces.
#[derive(Clone, Debug)]
pub struct PerFaceKind<T>([T; FaceKind::ALL.len()]);

impl<T> PerFaceKind<T> {
    /// The value of each family.
    pub fn new(value: impl FnMut(FaceKind) -> T) -> Self {
        Self(FaceKind::ALL.map(value))
    }
}

impl<T> Index<FaceKind> for PerFaceKind<T> {
    type Output = T;

    fn index(&self, kind: FaceKind) -> &T {
        &self.0[kind as usize]
    }
}

impl Deref for FaceKind {
    type Target = FaceFamily;

    fn deref(&self) -> &FaceFamily {
        self.family()
    }
}

static QUAD4: FaceFamily = FaceFamily {
    outline: Outline::Square,
    nodes: QUAD_NODES.split_at(4).0,
    shape: quad4,
    rule: || quadrature::quadrilateral(2),
    bulge: 0.0,
    vtk_cell_type: 9,
    gmsh_type: Some(3),
};

static QUAD8: FaceFamily = FaceFamily {
    outline: Outline::Square,
    nodes: QUAD_NODES.split_at(8).0,
    shape: quad8,
    rule: || quadrature::quadrilateral(3),
    // Σ|N| ≤ 2.
    bulge: 0.5,
    vtk_cell_type: 23,
    gmsh_type: Some(16),
};

static QUAD9: FaceFamily = FaceFamily {
    outline: Outline::Square,
    nodes: &QUAD_NODES,
    shape: quad9,
    rule: || quadrature::quadrilateral(3),
    // Σ|N| ≤ 25/16.
    bulge: 0.5,
    vtk_cell_type: 28,
    gmsh_type: Some(10),
};

static TRI6: FaceFamily = FaceFamily {
    outline: Outline::Triangle,
    nodes: TRI_NODES.split_at(6).0,
    shape: tri6,
    rule: quadrature::triangle_6,
    // Σ|N| ≤ 5/3.
    bulge: 0.5,
    vtk_cell_type: 22,
    gmsh_type: Some(9),
};

static TRI7: FaceFamily = FaceFamily {
    outline: Outline::Triangle,
    nodes: &TRI_NODES,
    shape: tri7,
    // The volume behind a face has degree 7.
    rule: quadrature::triangle_16,
    // Σ|N| ≤ 5/3.
    bulge: 0.5,
    // Lagrange's triangle of any order, of which that with seven nodes is one.
    vtk_cell_type: 69,
    gmsh_type: None,
};

impl FaceFamily {
    /// Number of nodes of one face.
    pub const fn num_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number of corners, and of edges.
    pub const fn num_corners(&self) -> usize {
        match self.outline {
            Outline::Square => 4,
            Outline::Triangle => 3,
        }
    }

    /// Reference coordinates of the corners.
    pub fn corners(&self) -> &'static [[f64; 2]] {
        &self.nodes[..self.num_corners()]
    }

    /// Corners at the ends of every edge.
    pub fn edges(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let corners = self.num_corners();
        (0..corners).map(move |i| [i, (i + 1) % corners])
    }

    /// Number of the node in the middle of an edge; `None` where edges are straight.
    pub const fn middle_of_edge(&self, edge: usize) -> Option<usize> {
        let node = self.num_corners() + edge;
        if self.is_linear() { None } else { Some(node) }
    }

    /// Whether corners are all that it has.
    pub const fn is_linear(&self) -> bool {
        self.nodes.len() == self.num_corners()
    }

    /// Reference coordinates of the face's centre.
    pub const fn centre(&self) -> [f64; 2] {
        match self.outline {
            Outline::Square => [0.0, 0.0],
            Outline::Triangle => [1.0 / 3.0, 1.0 / 3.0],
        }
    }

    /// Area of the reference face.
    pub const fn reference_area(&self) -> f64 {
        match self.outline {
            Outline::Square => 4.0,
            Outline::Triangle => 0.5,
        }
    }

    /// The multiple-point contact rule: 4 × 4 Gauss points on a face (theory §5).
    pub fn contact_rule(&self) -> Vec<([f64; 2], f64)> {
        match self.outline {
            Outline::Square => quadrature::quadrilateral(4),
            Outline::Triangle => quadrature::triangle_16(),
        }
    }
}

/// Values, first and second derivatives of face shape functions at one point.
///
/// Only the first `num_nodes` entries are meaningful; the fixed size avoids allocation in the contact search.
#[derive(Clone, Copy, Debug)]
pub struct FaceShape {
    /// Nᵢ.
    pub values: [f64; 9],
    /// \[∂Nᵢ/∂ξ, ∂Nᵢ/∂η\].
    pub gradients: [[f64; 2]; 9],
    /// \[∂²Nᵢ/∂ξ², ∂²Nᵢ/∂ξ∂η, ∂²Nᵢ/∂η²\].
    pub hessians: [[f64; 3]; 9],
}

const EMPTY_FACE: FaceShape = FaceShape { values: [0.0; 9], gradients: [[0.0; 2]; 9], hessians: [[0.0; 3]; 9] };

fn quad4([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    for (i, [a, b]) in QUAD_NODES[..4].iter().copied().enumerate() {
        shape.values[i] = 0.25 * (1.0 + a * x) * (1.0 + b * y);
        shape.gradients[i] = [0.25 * a * (1.0 + b * y), 0.25 * b * (1.0 + a * x)];
        shape.hessians[i] = [0.0, 0.25 * a * b, 0.0];
    }
    shape
}

fn quad8([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    for (i, [a, b]) in QUAD_NODES[..8].iter().copied().enumerate() {
        let (u, v) = (1.0 + a * x, 1.0 + b * y);
        if i < 4 {
            let s = a * x + b * y - 1.0;
            shape.values[i] = 0.25 * u * v * s;
            shape.gradients[i] = [0.25 * a * v * (s + u), 0.25 * b * u * (s + v)];
            shape.hessians[i] = [0.5 * a * a * v, 0.25 * a * b * (s + u + v), 0.5 * b * b * u];
        } else if a == 0.0 {
            let q = 1.0 - x * x;
            shape.values[i] = 0.5 * q * v;
            shape.gradients[i] = [-x * v, 0.5 * q * b];
            shape.hessians[i] = [-v, -x * b, 0.0];
        } else {
            let q = 1.0 - y * y;
            shape.values[i] = 0.5 * u * q;
            shape.gradients[i] = [0.5 * a * q, -y * u];
            shape.hessians[i] = [0.0, -y * a, -u];
        }
    }
    shape
}

fn quad9([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    let (p, q) = (quadratic_line(x), quadratic_line(y));
    for (i, signs) in QUAD_NODES.iter().enumerate() {
        let [a, b] = signs.map(|s| (s + 1.0) as usize);
        let (u, v) = (p[a], q[b]);
        shape.values[i] = u[0] * v[0];
        shape.gradients[i] = [u[1] * v[0], u[0] * v[1]];
        shape.hessians[i] = [u[2] * v[0], u[1] * v[1], u[0] * v[2]];
    }
    shape
}

fn tri6([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = EMPTY_FACE;
    let l = [1.0 - x - y, x, y];
    const D: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    for i in 0..3 {
        shape.values[i] = l[i] * (2.0 * l[i] - 1.0);
        shape.gradients[i] = D[i].map(|d| d * (4.0 * l[i] - 1.0));
        shape.hessians[i] = [4.0 * D[i][0] * D[i][0], 4.0 * D[i][0] * D[i][1], 4.0 * D[i][1] * D[i][1]];
    }
    for (e, [a, b]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
        shape.values[3 + e] = 4.0 * l[a] * l[b];
        shape.gradients[3 + e] = std::array::from_fn(|i| 4.0 * (D[a][i] * l[b] + l[a] * D[b][i]));
        shape.hessians[3 + e] =
            [8.0 * D[a][0] * D[b][0], 4.0 * (D[a][0] * D[b][1] + D[a][1] * D[b][0]), 8.0 * D[a][1] * D[b][1]];
    }
    shape
}

/// P2 and the bubble B = 27 λ₀ λ₁ λ₂, of which corners have 1/9 and mid-edges −4/9, so that they vanish at the centre.
fn tri7([x, y]: [f64; 2]) -> FaceShape {
    let mut shape = tri6([x, y]);
    let l = [1.0 - x - y, x, y];
    const D: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let twice = |i: usize, j: usize| -> f64 {
        let of = |a: usize, b: usize, c: usize| (D[a][i] * D[b][j] + D[b][i] * D[a][j]) * l[c];
        27.0 * (of(0, 1, 2) + of(1, 2, 0) + of(2, 0, 1))
    };
    shape.values[6] = 27.0 * l[0] * l[1] * l[2];
    shape.gradients[6] =
        std::array::from_fn(|k| 27.0 * (D[0][k] * l[1] * l[2] + l[0] * D[1][k] * l[2] + l[0] * l[1] * D[2][k]));
    shape.hessians[6] = [twice(0, 0), twice(0, 1), twice(1, 1)];
    for node in 0..6 {
        let share = if node < 3 { 1.0 / 9.0 } else { -4.0 / 9.0 };
        shape.values[node] += share * shape.values[6];
        for k in 0..2 {
            shape.gradients[node][k] += share * shape.gradients[6][k];
        }
        for k in 0..3 {
            shape.hessians[node][k] += share * shape.hessians[6][k];
        }
    }
    shape
}

static TRI_NODES: [[f64; 2]; 7] =
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5], [1.0 / 3.0, 1.0 / 3.0]];

static QUAD_NODES: [[f64; 2]; 9] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];
