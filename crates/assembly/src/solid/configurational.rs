//! Configurational forces: the derivative of the energy by the positions of the nodes at rest, the displacements staying what they are
//! (Eshelby 1951; theory §18).
//!
//! With a motion V of the positions at rest, H = ∂u/∂X changes by −H ∇V and a volume by tr ∇V of itself, so that
//! δ∫ W dV = ∫ (W 1 − HᵀP):∇V dV. Of an element's change of volume, θ and M change, and with p = ∂E/∂θ and c = M⁻¹θ
//!
//! ```text
//! δE = p·δθ − p·δM c + ∫ U(J̄) tr ∇V dV,   δθ = ∫ ψ [(J − 1) tr ∇V − cof F:(H ∇V)] dV,   δM = ∫ ψψᵀ tr ∇V dV
//! ```

use pneuflex_material::{Kinematics, volumetric};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::Solid;
use super::dilatation::volume_change;
use crate::kernel::{LANES, NodeVectors, add_scaled, geometry, gradient_of, transform, zero};
use crate::local::LocalError;

type Matrix = [[f64; 3]; 3];

impl Solid {
    /// ∂E/∂X at a displacement (mm), N, one entry per node.
    ///
    /// # Errors
    /// [`LocalError`] of the first element that is turned inside out.
    pub fn configurational_forces(&self, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, LocalError> {
        let of_element = |element: usize| {
            pneuflex_mesh::with_num_nodes!(self.mesh.kind_of(element), N => {
                self.dispatch_configurational::<N, { N.div_ceil(LANES) }>(element, displacement)
            })
        };
        let found = (0..self.mesh.num_elements()).into_par_iter().with_min_len(8).map(of_element);
        let mut forces = vec![[0.0; 3]; displacement.len()];
        for (element, of_element) in found.collect::<Vec<Result<Vec<[f64; 3]>, LocalError>>>().into_iter().enumerate() {
            for (&node, force) in self.mesh.element(element).iter().zip(of_element?) {
                (0..3).for_each(|k| forces[node as usize][k] += force[k]);
            }
        }
        Ok(forces)
    }

    fn dispatch_configurational<const N: usize, const C: usize>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
    ) -> Result<Vec<[f64; 3]>, LocalError> {
        match self.processor {
            Arch::Scalar => self.configurational_of_element::<N, C, false>(element, displacement),
            processor => processor.dispatch(OfElement::<N, C> { solid: self, element, displacement }),
        }
    }

    #[inline(always)]
    fn configurational_of_element<const N: usize, const C: usize, const FMA: bool>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
    ) -> Result<Vec<[f64; 3]>, LocalError> {
        let [x, u] = [&self.mesh.nodes[..], displacement].map(|field| self.gather::<N, C>(element, field));
        let (material, modes, reference) = (self.material(element), self.num_modes, self.reference(element));
        let theta = self.dilatation::<C, FMA>(element, &x, &u, false).theta;
        let pressure = self.volumetric_response::<C, FMA>(element, &x, &theta)?.pressure;
        let inverse = &self.inverse_mass[element];
        let strain: [f64; 4] = std::array::from_fn(|i| (0..modes).map(|j| inverse[i][j] * theta[j]).sum());
        let at = |values: &[f64; 4], psi: &[f64; 4]| (0..modes).map(|i| values[i] * psi[i]).sum::<f64>();
        let mut force: NodeVectors<C> = zero();
        // Of a point that stands for the volume of the whole element, per that volume.
        let mut of_volume = 0.0;
        for point in &reference.volumetric {
            let (g, volume) = self.geometry_at::<C, FMA>(element, &x, point);
            let h = gradient_of::<C, FMA>(&u, &g);
            let (excess, cofactor) = volume_change(&h);
            let (p, smoothed) = (at(&pressure, &point.modes), at(&strain, &point.modes));
            let energy = material.bulk_modulus * volumetric::evaluate(material.volumetric, smoothed)[0];
            let by_volume = p * (excess - smoothed) + energy;
            let along = minus_transposed_product(&h, &cofactor);
            add_scaled::<C, FMA>(&mut force, volume * p, &transform::<C, FMA>(&along, &g));
            if reference.is_centre_only {
                of_volume += by_volume;
            } else {
                add_scaled::<C, FMA>(&mut force, volume * by_volume, &g);
            }
        }
        let fluctuation = material.fluctuation_modulus;
        for (index, point) in reference.deviatoric.iter().enumerate() {
            let (g, det) = geometry::<C, FMA>(&point.lanes, &x);
            let volume = point.weight * det;
            let h = gradient_of::<C, FMA>(&u, &g);
            let kinematics =
                Kinematics::new(&h).map_err(|e| LocalError { block: element, point: index, jacobian: e.0 })?;
            let excess = kinematics.jacobian_minus_1;
            let (energy, mut stress) = material.law.energy_and_stress(&kinematics);
            for i in 0..3 {
                for j in 0..3 {
                    stress[i][j] += fluctuation * excess * kinematics.cofactor[i][j];
                }
            }
            let mut eshelby = minus_transposed_product(&h, &stress);
            for (i, row) in eshelby.iter_mut().enumerate() {
                row[i] += energy + 0.5 * fluctuation * excess * excess + of_volume;
            }
            add_scaled::<C, FMA>(&mut force, volume, &transform::<C, FMA>(&eshelby, &g));
        }
        Ok((0..N).map(|a| std::array::from_fn(|k| force[k][a / LANES][a % LANES])).collect())
    }
}

/// −Aᵀ B.
#[inline(always)]
fn minus_transposed_product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| -(0..3).map(|k| a[k][i] * b[k][j]).sum::<f64>()))
}

/// A call of [`Solid::configurational_of_element`] with vector instructions.
struct OfElement<'a, const N: usize, const C: usize> {
    solid: &'a Solid,
    element: usize,
    displacement: &'a [[f64; 3]],
}

impl<const N: usize, const C: usize> WithSimd for OfElement<'_, N, C> {
    type Output = Result<Vec<[f64; 3]>, LocalError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.solid.configurational_of_element::<N, C, true>(self.element, self.displacement)
    }
}
