//! The rotation update of displacements (theory §12; as in the rotation-strain warping of Huang et al. 2011).
//!
//! A Newton correction δu of a bending body is mostly rotation, and a rotation applied along straight lines stretches
//! everything. So the correction's gradient is taken as a rate: with D = δF F⁻¹ the deformation gradient aimed at is
//! `F* = exp(skew D) (1 + sym D) F`, and the new nodal positions are those whose gradient comes closest to it,
//! Σ ‖∇x − F*‖² dV → min with the held degrees of freedom where the linear correction puts them: one scalar Laplacian per set
//! of held axes, factorised once per mesh. What is added to the linear correction is of second order in it, so
//! Newton's method keeps its order.

use std::collections::BTreeMap;
use std::sync::Arc;

use pneuflex_assembly::formulation::{IntegrationPoint, displacement_gradient, reference_gradients, tabulate};
use pneuflex_assembly::{Assembler, LocalBlock, LocalContribution, LocalError, Request, Totals};
use pneuflex_factor::{BlockPattern, Factor, FactorError, Ordering, Parallelism, Symbolic};
use pneuflex_mesh::{Mesh, PerKind, with_num_nodes};
use rayon::prelude::*;

use crate::error::AssembleError;

/// The Laplacians of a mesh, factorised.
pub struct RotationUpdate {
    mesh: Arc<Mesh>,
    points: PerKind<Vec<IntegrationPoint>>,
    assembler: Assembler,
    totals: Totals,
    /// Factor for each axis, shared between axes that hold the same nodes.
    factors: Vec<Factor<1>>,
    factor_of_axis: [usize; 3],
    held: Vec<bool>,
}

impl RotationUpdate {
    /// Factorises the Laplacians for a mesh with the given held degrees of freedom (3 · node + axis). Where a part of the body is not
    /// held along an axis, its first node goes along that axis where the linear correction puts it.
    ///
    /// # Errors
    /// If a Laplacian is singular, which that of a mesh without loose nodes is not.
    pub fn new(mesh: &Arc<Mesh>, held: &[bool], parallelism: Parallelism) -> Result<Self, FactorError> {
        let held = &with_a_held_node_in_every_part(mesh, held);
        let points = mesh.per_kind(|kind| tabulate(kind, (kind.volume_rule)()));
        let pattern = BlockPattern::from_cliques(mesh.num_nodes(), (0..mesh.num_elements()).map(|e| mesh.element(e)));
        let values = laplacian(mesh, &points, &pattern);
        let symbolic = Arc::new(Symbolic::<1>::analyze(&pattern, Ordering::default())?);
        let mut factors = Vec::new();
        let mut known: BTreeMap<Vec<bool>, usize> = BTreeMap::new();
        let mut factor_of_axis = [0; 3];
        for (axis, slot) in factor_of_axis.iter_mut().enumerate() {
            let mask: Vec<bool> = held.iter().skip(axis).step_by(3).copied().collect();
            *slot = match known.get(&mask) {
                Some(&index) => index,
                None => {
                    let mut factor = Factor::new(Arc::clone(&symbolic));
                    factor.factorize(&values, &mask, parallelism)?;
                    factors.push(factor);
                    known.insert(mask, factors.len() - 1);
                    factors.len() - 1
                }
            };
        }
        let assembler = Assembler::new(mesh.num_nodes(), &[], &[]);
        Ok(Self {
            mesh: Arc::clone(mesh),
            points,
            assembler,
            totals: Totals::default(),
            factors,
            factor_of_axis,
            held: held.to_vec(),
        })
    }

    /// Adds to `displacement` the correction δu, bent into a rotation where it is one.
    ///
    /// # Errors
    /// If the state before the correction is turned inside out.
    pub fn apply(&mut self, displacement: &mut [[f64; 3]], correction: &[[f64; 3]]) -> Result<(), AssembleError> {
        let rotation = Rotation { mesh: &self.mesh, points: &self.points, correction };
        self.assembler.reset(&mut self.totals, Request::Residual);
        self.assembler.add_changing(&rotation, displacement, Request::Residual, &mut self.totals)?;
        let n = displacement.len();
        for (index, factor) in self.factors.iter().enumerate() {
            // Axes with the same factor are solved together.
            let axes: Vec<usize> = (0..3).filter(|&axis| self.factor_of_axis[axis] == index).collect();
            let mut rhs: Vec<f64> = axes
                .iter()
                .flat_map(|&axis| (0..n).map(move |node| (node, axis)))
                .map(|(node, axis)| if self.held[3 * node + axis] { 0.0 } else { self.totals.residual[node][axis] })
                .collect();
            factor.solve_in_place(&mut rhs, axes.len())?;
            for (&axis, values) in axes.iter().zip(rhs.chunks_exact(n)) {
                for (node, value) in values.iter().enumerate() {
                    displacement[node][axis] += correction[node][axis] + value;
                }
            }
        }
        Ok(())
    }
}

/// How much a correction deforms: largest values over the integration points, of D = δF F⁻¹ = S + W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// ‖S‖, the stretching.
    pub stretch: f64,
    /// Angle of exp W, radians.
    pub angle: f64,
}

impl Extent {
    /// Whether either is larger than a bound's.
    pub fn exceeds(&self, bound: &Self) -> bool {
        self.stretch > bound.stretch || self.angle > bound.angle
    }

    fn max(self, other: Self) -> Self {
        Self { stretch: self.stretch.max(other.stretch), angle: self.angle.max(other.angle) }
    }
}

impl RotationUpdate {
    /// Extent of a correction at a displacement.
    pub fn extent(&self, displacement: &[[f64; 3]], correction: &[[f64; 3]]) -> Extent {
        let of_element = |element| with_num_nodes!(self.mesh.kind_of(element), N => self.extent_in::<N>(element, displacement, correction));
        (0..self.mesh.num_elements())
            .into_par_iter()
            .with_min_len(64)
            .map(of_element)
            .reduce(Extent::default, Extent::max)
    }

    fn extent_in<const N: usize>(&self, element: usize, displacement: &[[f64; 3]], correction: &[[f64; 3]]) -> Extent {
        let nodes = self.mesh.element(element);
        let [x, u, delta]: [[[f64; 3]; N]; 3] = [&self.mesh.nodes[..], displacement, correction]
            .map(|field| std::array::from_fn(|a| field[nodes[a] as usize]));
        let mut extent = Extent::default();
        for point in &self.points[self.mesh.kind_of(element)] {
            let (gradients, _) = reference_gradients(&x, point);
            let mut f = displacement_gradient(&u, &gradients);
            for i in 0..3 {
                f[i][i] += 1.0;
            }
            let Some(rate) = rate(&f, &displacement_gradient(&delta, &gradients)) else { continue };
            let stretch: f64 =
                (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).map(|(i, j)| rate.stretching(i, j).powi(2)).sum();
            let angle: f64 = rate.axis.iter().map(|a| a * a).sum();
            extent = extent.max(Extent { stretch: stretch.sqrt(), angle: angle.sqrt() });
        }
        extent
    }
}

/// Marks a node of every part of a mesh and every axis along which none of its nodes is held.
fn with_a_held_node_in_every_part(mesh: &Mesh, held: &[bool]) -> Vec<bool> {
    let mut held = held.to_vec();
    let first = mesh.parts();
    let mut is_held = vec![[false; 3]; mesh.num_nodes()];
    for node in 0..mesh.num_nodes() {
        for axis in 0..3 {
            is_held[first[node]][axis] |= held[3 * node + axis];
        }
    }
    for node in (0..mesh.num_nodes()).filter(|&node| first[node] == node) {
        for axis in 0..3 {
            held[3 * node + axis] |= !is_held[node][axis];
        }
    }
    held
}

/// ∫ ∇N_a·∇N_b dV.
fn laplacian(mesh: &Mesh, points: &PerKind<Vec<IntegrationPoint>>, pattern: &BlockPattern) -> Vec<f64> {
    let mut values = vec![0.0; pattern.num_blocks()];
    for element in 0..mesh.num_elements() {
        let nodes = mesh.element(element);
        for point in &points[mesh.kind_of(element)] {
            // The widest element sets the buffer; narrower ones use its beginning.
            let (gradients, volume) = gradients_of(mesh, element, point);
            for a in 0..nodes.len() {
                for b in 0..=a {
                    let (i, j) = (nodes[a].max(nodes[b]) as usize, nodes[a].min(nodes[b]) as usize);
                    let product: f64 = (0..3).map(|k| gradients[a][k] * gradients[b][k]).sum();
                    if let Some(position) = pattern.position(i, j) {
                        values[position] += volume * product;
                    }
                }
            }
        }
    }
    values
}

fn gradients_of(mesh: &Mesh, element: usize, point: &IntegrationPoint) -> (Vec<[f64; 3]>, f64) {
    fn sized<const N: usize>(mesh: &Mesh, element: usize, point: &IntegrationPoint) -> (Vec<[f64; 3]>, f64) {
        let nodes = mesh.element(element);
        let x: [[f64; 3]; N] = std::array::from_fn(|a| mesh.nodes[nodes[a] as usize]);
        let (gradients, volume) = reference_gradients(&x, point);
        (gradients.to_vec(), volume)
    }
    with_num_nodes!(mesh.kind_of(element), N => sized::<N>(mesh, element, point))
}

/// Right-hand side ∫ (F* − F − δF) ∇N dV, as the residual of a contribution.
struct Rotation<'a> {
    mesh: &'a Mesh,
    points: &'a PerKind<Vec<IntegrationPoint>>,
    correction: &'a [[f64; 3]],
}

impl Rotation<'_> {
    fn evaluate_nodes<const N: usize>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let nodes = self.mesh.element(element);
        let x: [[f64; 3]; N] = std::array::from_fn(|a| self.mesh.nodes[nodes[a] as usize]);
        let u: [[f64; 3]; N] = std::array::from_fn(|a| displacement[nodes[a] as usize]);
        let delta: [[f64; 3]; N] = std::array::from_fn(|a| self.correction[nodes[a] as usize]);
        for (index, point) in self.points[self.mesh.kind_of(element)].iter().enumerate() {
            let (gradients, volume) = reference_gradients(&x, point);
            let mut f = displacement_gradient(&u, &gradients);
            for i in 0..3 {
                f[i][i] += 1.0;
            }
            let delta_f = displacement_gradient(&delta, &gradients);
            let excess = second_order_part(&f, &delta_f).ok_or_else(|| LocalError {
                block: element,
                point: index,
                jacobian: pneuflex_mesh::mesh::determinant(&f),
            })?;
            for a in 0..N {
                for i in 0..3 {
                    out.residual[a][i] += volume
                        * (excess[i][0] * gradients[a][0]
                            + excess[i][1] * gradients[a][1]
                            + excess[i][2] * gradients[a][2]);
                }
            }
        }
        Ok(())
    }
}

impl LocalContribution for Rotation<'_> {
    fn num_blocks(&self) -> usize {
        self.mesh.num_elements()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        self.mesh.element(block)
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        _request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        with_num_nodes!(self.mesh.kind_of(block), N => self.evaluate_nodes::<N>(block, displacement, out))
    }
}

/// D = δF F⁻¹ = S + W.
pub(crate) struct Rate {
    d: [[f64; 3]; 3],
    /// Axis of W times its angle.
    axis: [f64; 3],
}

impl Rate {
    /// Component of S.
    pub(crate) fn stretching(&self, i: usize, j: usize) -> f64 {
        0.5 * (self.d[i][j] + self.d[j][i])
    }
}

/// D of a change of F; `None` if F is singular.
pub(crate) fn rate(f: &[[f64; 3]; 3], delta_f: &[[f64; 3]; 3]) -> Option<Rate> {
    let det = pneuflex_mesh::mesh::determinant(f);
    if !(det.abs() > 1e-12 && det.is_finite()) {
        return None;
    }
    let cof = pneuflex_mesh::mesh::cofactor(f);
    // F⁻¹ = cofᵀ / det.
    let d: [[f64; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| delta_f[i][k] * cof[j][k]).sum::<f64>() / det));
    let axis = [0.5 * (d[2][1] - d[1][2]), 0.5 * (d[0][2] - d[2][0]), 0.5 * (d[1][0] - d[0][1])];
    Some(Rate { d, axis })
}

/// F* − F − δF = \[(R − 1 − W) + (R − 1) S\] F with D = δF F⁻¹ = S + W and R = exp W; `None` if F is singular.
fn second_order_part(f: &[[f64; 3]; 3], delta_f: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let rate = rate(f, delta_f)?;
    let axis = rate.axis;
    let angle_squared = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
    let angle = angle_squared.sqrt();
    // sin θ/θ − 1 and (1 − cos θ)/θ², by series where they would cancel.
    let (sine, cosine) = if angle < 1e-3 {
        (-angle_squared / 6.0, 0.5 - angle_squared / 24.0)
    } else {
        (angle.sin() / angle - 1.0, (1.0 - angle.cos()) / angle_squared)
    };
    let w = [[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]];
    // R − 1 − W, with W² = a aᵀ − θ² 1.
    let beyond: [[f64; 3]; 3] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let square = axis[i] * axis[j] - if i == j { angle_squared } else { 0.0 };
            sine * w[i][j] + cosine * square
        })
    });
    let mut sum = beyond;
    for i in 0..3 {
        for j in 0..3 {
            sum[i][j] += (0..3).map(|k| (beyond[i][k] + w[i][k]) * rate.stretching(k, j)).sum::<f64>();
        }
    }
    Some(std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| sum[i][k] * f[k][j]).sum())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::ElementKind;
    use pneuflex_mesh::lattice::Lattice;

    #[test]
    fn a_rotation_rate_becomes_a_rotation() {
        let mesh = Arc::new(Lattice::uniform([0.0; 3], [3.0, 1.0, 1.0], [6, 2, 2]).mesh_all(ElementKind::Hex8));
        // Held at a single node only: the Laplacian needs no more.
        let mut held = vec![false; 3 * mesh.num_nodes()];
        held[..3].fill(true);
        let mut update = RotationUpdate::new(&mesh, &held, Parallelism::Serial).unwrap();
        // A quarter turn about z, applied as its rate at rest: straight along the tangents.
        let angle = std::f64::consts::FRAC_PI_2;
        let rate: Vec<[f64; 3]> = mesh.nodes.iter().map(|x| [-angle * x[1], angle * x[0], 0.0]).collect();
        let mut u = vec![[0.0; 3]; mesh.num_nodes()];
        update.apply(&mut u, &rate).unwrap();
        for (x, u) in mesh.nodes.iter().zip(&u) {
            let turned = [-x[1], x[0], x[2]];
            for k in 0..3 {
                assert!((x[k] + u[k] - turned[k]).abs() < 1e-12, "{x:?} {u:?}");
            }
        }
    }

    #[test]
    fn the_extent_tells_stretching_from_rotation() {
        let mesh = Arc::new(Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [3, 2, 2]).mesh_all(ElementKind::Hex20));
        let mut held = vec![false; 3 * mesh.num_nodes()];
        held[..3].fill(true);
        let update = RotationUpdate::new(&mesh, &held, Parallelism::Serial).unwrap();
        // At a state stretched to twice its length along x, a rotation about z and a further stretch along y.
        let u: Vec<[f64; 3]> = mesh.nodes.iter().map(|x| [x[0], 0.0, 0.0]).collect();
        let turn: Vec<[f64; 3]> = mesh.nodes.iter().map(|x| [-0.3 * x[1], 0.6 * x[0], 0.0]).collect();
        let turned = update.extent(&u, &turn);
        assert!((turned.angle - 0.3).abs() < 1e-12 && turned.stretch < 1e-12, "{turned:?}");
        let widen: Vec<[f64; 3]> = mesh.nodes.iter().map(|x| [0.0, 0.2 * x[1], 0.0]).collect();
        let widened = update.extent(&u, &widen);
        assert!((widened.stretch - 0.2).abs() < 1e-12 && widened.angle < 1e-12, "{widened:?}");
    }

    #[test]
    fn small_corrections_are_changed_in_second_order_only() {
        let mesh = Arc::new(Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [3, 2, 2]).mesh_all(ElementKind::Hex27));
        let held: Vec<bool> = mesh.nodes.iter().flat_map(|x| [x[0] == 0.0; 3]).collect();
        let mut update = RotationUpdate::new(&mesh, &held, Parallelism::Serial).unwrap();
        let mut change = |size: f64| -> f64 {
            let delta: Vec<[f64; 3]> =
                mesh.nodes.iter().map(|x| [0.0, size * x[0] * x[0], -size * x[0] * x[1]]).collect();
            let mut u = vec![[0.0; 3]; mesh.num_nodes()];
            update.apply(&mut u, &delta).unwrap();
            u.iter().zip(&delta).flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs())).fold(0.0, f64::max)
        };
        let (coarse, fine) = (change(1e-3), change(1e-4));
        assert!(coarse > 1e-8, "the check would be empty");
        assert!((coarse / fine - 100.0).abs() < 1.0, "{coarse} {fine}");
    }
}
