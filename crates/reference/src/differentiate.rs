//! Scalar functions of a few linear combinations of the unknowns, differentiated automatically.
//!
//! Every energy of the theory is a sum over integration points, and at each point depends on a handful of numbers that
//! are linear in the unknowns x: the deformation gradient, a point of a face and its tangents, the corners of a facet.
//! So with v = v₀ + C x the derivatives are Cᵀ ∂e/∂v and Cᵀ ∂²e/∂v² C, where those of e(v) come from dual numbers.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use num_dual::{Dual64, DualNum, HyperDual64};

/// A number that may carry derivatives: `f64` itself or any dual number over `f64`.
pub trait Dual: DualNum<Primitive = f64> + Copy {}
impl<T: DualNum<Primitive = f64> + Copy> Dual for T {}

/// A scalar function e(v) of `N` numbers.
pub trait Energy<const N: usize> {
    /// e(v), N·mm.
    fn energy<D: Dual>(&self, v: &[D; N]) -> D;
}

/// v = offset + matrix · x\[dofs\].
#[derive(Clone, Debug)]
pub struct LinearMap<const N: usize> {
    /// Which entries of x the numbers depend on.
    pub dofs: Vec<usize>,
    /// v at x = 0.
    pub offset: [f64; N],
    /// C, of shape (N, number of dofs).
    pub matrix: DMatrix<f64>,
}

impl<const N: usize> LinearMap<N> {
    /// The numbers v at x.
    pub fn apply(&self, x: &[f64]) -> SVector<f64, N> {
        SVector::from_fn(|i, _| {
            let product = |(j, &dof): (usize, &usize)| self.matrix[(i, j)] * x[dof];
            self.offset[i] + self.dofs.iter().enumerate().map(product).sum::<f64>()
        })
    }

    /// Vectors Σₐ cₖₐ rₐ of nodal positions r = X + u, one for every row of coefficients, stacked.
    ///
    /// `nodes` are the nodes a, `coefficients[k][a]` the weights, `positions` the reference positions X of all nodes.
    /// The unknowns are the displacements of these nodes; N is three times the number of rows.
    pub fn of_positions(nodes: &[u32], positions: &[[f64; 3]], coefficients: &[Vec<f64>]) -> Self {
        let dofs = nodes.iter().flat_map(|&n| (0..3).map(move |axis| 3 * n as usize + axis)).collect();
        let matrix = DMatrix::from_fn(N, 3 * nodes.len(), |row, column| {
            if row % 3 == column % 3 { coefficients[row / 3][column / 3] } else { 0.0 }
        });
        let offset = std::array::from_fn(|row| {
            nodes.iter().zip(&coefficients[row / 3]).map(|(&n, c)| c * positions[n as usize][row % 3]).sum()
        });
        Self { dofs, offset, matrix }
    }
}

/// One integration point's share of an energy: e(v(x)).
#[derive(Clone, Debug)]
pub struct Term<const N: usize, E> {
    /// e(v).
    pub energy: E,
    /// v(x).
    pub map: LinearMap<N>,
}

/// Value and derivatives of something with an energy, added to what is there already.
pub trait Differentiable {
    /// e(x), N·mm.
    fn value(&self, x: &[f64]) -> f64;
    /// Adds `scale` · ∂e/∂x.
    fn add_gradient(&self, x: &[f64], scale: f64, gradient: &mut DVector<f64>);
    /// Adds `scale` · ∂²e/∂x².
    fn add_hessian(&self, x: &[f64], scale: f64, hessian: &mut DMatrix<f64>);
}

impl<const N: usize, E: Energy<N>> Differentiable for Term<N, E> {
    fn value(&self, x: &[f64]) -> f64 {
        let v = self.map.apply(x);
        self.energy.energy(&v.into())
    }

    fn add_gradient(&self, x: &[f64], scale: f64, gradient: &mut DVector<f64>) {
        let (_, g) = gradient_of(&self.energy, &self.map.apply(x));
        let local = self.map.matrix.tr_mul(&g) * scale;
        for (&dof, value) in self.map.dofs.iter().zip(local.iter()) {
            gradient[dof] += value;
        }
    }

    fn add_hessian(&self, x: &[f64], scale: f64, hessian: &mut DMatrix<f64>) {
        let (_, _, h) = hessian_of(&self.energy, &self.map.apply(x));
        let local = self.map.matrix.tr_mul(&(h * scale * &self.map.matrix));
        for (j, &column) in self.map.dofs.iter().enumerate() {
            for (i, &row) in self.map.dofs.iter().enumerate() {
                hessian[(row, column)] += local[(i, j)];
            }
        }
    }
}

/// e and ∂e/∂v at v: the ε part of e(v + ε eᵢ).
pub fn gradient_of<const N: usize>(energy: &impl Energy<N>, v: &SVector<f64, N>) -> (f64, SVector<f64, N>) {
    let mut value = 0.0;
    let gradient = SVector::from_fn(|i, _| {
        let along = |k: usize| Dual64::new(v[k], if k == i { 1.0 } else { 0.0 });
        let e = energy.energy(&std::array::from_fn(along));
        value = e.re;
        e.eps
    });
    (value, gradient)
}

/// e, ∂e/∂v and ∂²e/∂v² at v: the ε₁ε₂ part of e(v + ε₁ eᵢ + ε₂ eⱼ), pair by pair.
pub fn hessian_of<const N: usize>(
    energy: &impl Energy<N>,
    v: &SVector<f64, N>,
) -> (f64, SVector<f64, N>, SMatrix<f64, N, N>) {
    let (mut value, mut gradient, mut hessian) = (0.0, SVector::zeros(), SMatrix::zeros());
    for i in 0..N {
        for j in 0..=i {
            let is = |k: usize, l: usize| if k == l { 1.0 } else { 0.0 };
            let along = |k: usize| HyperDual64::new(v[k], is(k, i), is(k, j), 0.0);
            let e = energy.energy(&std::array::from_fn(along));
            (value, gradient[i]) = (e.re, e.eps1);
            (hessian[(i, j)], hessian[(j, i)]) = (e.eps1eps2, e.eps1eps2);
        }
    }
    (value, gradient, hessian)
}

/// a · b.
pub fn dot<D: Dual>(a: [D; 3], b: [D; 3]) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross<D: Dual>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a − b.
pub fn minus<D: Dual>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// a / |a|.
pub fn normalised<D: Dual>(a: [D; 3]) -> [D; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// The k-th of the vectors stacked in v.
pub fn vector<D: Dual>(v: &[D], k: usize) -> [D; 3] {
    [v[3 * k], v[3 * k + 1], v[3 * k + 2]]
}
