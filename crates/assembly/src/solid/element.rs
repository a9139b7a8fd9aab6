//! The kernel of one element: energy, residual and tangent.

use pneuflex_material::{Kinematics, Tangent, add_dyad, add_scaled as add_tangent, second_derivative_of_jacobian};
use pulp::{Arch, Simd, WithSimd};

use super::Solid;
use crate::formulation::IntegrationPoint;
use crate::kernel::{
    LANES, NodeVectors, PairBlocks, PointTangent, add_moduli, add_outer, add_point, add_scaled, add_skew, geometry,
    gradient_of, store, transform, zero,
};
use crate::law::{ElementMaterial, VolumetricResponse};
use crate::local::{LocalBlock, LocalError, Request};

impl Solid {
    #[inline(always)]
    fn evaluate_nodes<const N: usize, const C: usize, const FMA: bool>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let [x, u] = [&self.mesh.nodes[..], displacement].map(|field| self.gather::<N, C>(element, field));
        let (modes, reference) = (self.num_modes, self.reference(element));

        let dilatation = self.dilatation::<C, FMA>(element, &x, &u, request >= Request::Residual);
        let VolumetricResponse { energy, pressure, modulus } =
            self.volumetric_response::<C, FMA>(element, &x, &dilatation.theta)?;
        out.energy += energy;
        let material = self.material(element);
        let mut residual: NodeVectors<C> = zero();
        for i in 0..modes {
            add_scaled::<C, FMA>(&mut residual, pressure[i], &dilatation.gradient[i]);
        }
        let carried = self.carried_pressure(element, &pressure);
        let carried_at = |point: &IntegrationPoint| (0..modes).map(|i| point.modes[i] * carried[i]).sum::<f64>();
        // Large: cleared only where it is asked for.
        let mut tangent: Option<PairBlocks<N, C>> =
            (request == Request::Tangent).then_some([[[[0.0; LANES]; 9]; C]; N]);

        for (index, point) in reference.deviatoric.iter().enumerate() {
            let (g, det) = geometry::<C, FMA>(&point.lanes, &x);
            let volume = point.weight * det;
            let h = gradient_of::<C, FMA>(&u, &g);
            let kinematics =
                Kinematics::new(&h).map_err(|e| LocalError { block: element, point: index, jacobian: e.0 })?;
            let shared = if reference.shares_points { volume * carried_at(point) } else { 0.0 };
            let overflow = LocalError { block: element, point: index, jacobian: kinematics.jacobian };
            let Some(mut d) = material.law.by_invariants(&kinematics) else {
                let state = GeneralPoint { kinematics: &kinematics, g: &g, volume, shared };
                let residual = (request >= Request::Residual).then_some(&mut residual);
                let energy = state.add::<N, FMA>(material, residual, tangent.as_mut());
                out.energy += energy.ok_or(overflow)?;
                continue;
            };
            if !d.energy.is_finite() {
                return Err(overflow);
            }
            let excess = kinematics.jacobian_minus_1;
            d.energy += 0.5 * material.fluctuation_modulus * excess * excess;
            d.wj += material.fluctuation_modulus * excess;
            d.wjj += material.fluctuation_modulus;
            out.energy += volume * d.energy;
            if request == Request::Energy {
                continue;
            }
            let f = transform::<C, FMA>(&kinematics.gradient, &g);
            let c = transform::<C, FMA>(&kinematics.cofactor, &g);
            add_scaled::<C, FMA>(&mut residual, 2.0 * volume * d.w1, &f);
            add_scaled::<C, FMA>(&mut residual, volume * d.wj, &c);
            if let Some(tangent) = &mut tangent {
                let factors = PointTangent {
                    identity: 2.0 * volume * d.w1,
                    outer: [4.0 * volume * d.w11, 2.0 * volume * d.w1j, volume * d.wjj],
                    skew: volume * d.wj + shared,
                };
                add_point::<N, C, FMA>(tangent, [&g, &f, &c], &kinematics.gradient, &factors);
            }
        }
        for (a, r) in out.residual.iter_mut().enumerate() {
            for k in 0..3 {
                r[k] += residual[k][a / LANES][a % LANES];
            }
        }
        if let Some(tangent) = &mut tangent {
            // Bᵀ ∂p/∂θ B.
            for i in 0..modes {
                let mut weighted = zero();
                for j in 0..modes {
                    add_scaled::<C, FMA>(&mut weighted, modulus[i][j], &dilatation.gradient[j]);
                }
                add_outer::<N, C, FMA>(tangent, &dilatation.gradient[i], &weighted);
            }
            // The second derivative of θ under the carried pressure, where it was not added above.
            if !reference.shares_points {
                for point in &reference.volumetric {
                    let (g, volume) = self.geometry_at::<C, FMA>(element, &x, point);
                    let mut f = gradient_of::<C, FMA>(&u, &g);
                    for i in 0..3 {
                        f[i][i] += 1.0;
                    }
                    add_skew::<N, C, FMA>(tangent, &g, &f, volume * carried_at(point));
                }
            }
            store(tangent, &mut out.tangent);
        }
        Ok(())
    }

    fn carried_pressure(&self, element: usize, pressure: &[f64; 4]) -> [f64; 4] {
        let modes = self.num_modes;
        if self.carried.is_empty() {
            return *pressure;
        }
        std::array::from_fn(|i| if i < modes { self.carried[element * modes + i] } else { 0.0 })
    }

    /// The kernel compiled for the instructions that this processor has.
    pub(super) fn dispatch<const N: usize, const C: usize>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        match self.processor {
            Arch::Scalar => self.evaluate_nodes::<N, C, false>(element, displacement, request, out),
            processor => processor.dispatch(EvaluateNodes::<N, C> { solid: self, element, displacement, request, out }),
        }
    }
}

/// A deviatoric point whose law is no function of I₁ and J alone.
struct GeneralPoint<'a, const C: usize> {
    kinematics: &'a Kinematics,
    g: &'a NodeVectors<C>,
    volume: f64,
    /// Volume times the carried pressure, where its geometric term is added here.
    shared: f64,
}

impl<const C: usize> GeneralPoint<'_, C> {
    /// Adds residual and tangent, and returns the energy; `None` where it is no finite number.
    #[inline(always)]
    fn add<const N: usize, const FMA: bool>(
        &self,
        material: &ElementMaterial,
        residual: Option<&mut NodeVectors<C>>,
        tangent: Option<&mut PairBlocks<N, C>>,
    ) -> Option<f64> {
        let &Self { kinematics, g, volume, shared } = self;
        let (excess, modulus) = (kinematics.jacobian_minus_1, material.fluctuation_modulus);
        let (energy, mut stress) = match tangent {
            Some(tangent) => {
                let response = material.law.respond(kinematics);
                let mut moduli: Tangent = response.tangent.map(|row| row.map(|entry| volume * entry));
                add_dyad(&mut moduli, volume * modulus, &kinematics.cofactor, &kinematics.cofactor);
                let of_jacobian = second_derivative_of_jacobian(&kinematics.gradient);
                add_tangent(&mut moduli, volume * modulus * excess + shared, &of_jacobian);
                add_moduli::<N, C, FMA>(tangent, g, &moduli);
                (response.energy, response.stress)
            }
            None => material.law.energy_and_stress(kinematics),
        };
        for i in 0..3 {
            for j in 0..3 {
                stress[i][j] += modulus * excess * kinematics.cofactor[i][j];
            }
        }
        if let Some(residual) = residual {
            add_scaled::<C, FMA>(residual, volume, &transform::<C, FMA>(&stress, g));
        }
        let energy = volume * (energy + 0.5 * modulus * excess * excess);
        (energy.is_finite() && stress.as_flattened().iter().all(|p| p.is_finite())).then_some(energy)
    }
}

/// A call of [`Solid::evaluate_nodes`] with vector instructions.
struct EvaluateNodes<'a, const N: usize, const C: usize> {
    solid: &'a Solid,
    element: usize,
    displacement: &'a [[f64; 3]],
    request: Request,
    out: &'a mut LocalBlock,
}

impl<const N: usize, const C: usize> WithSimd for EvaluateNodes<'_, N, C> {
    type Output = Result<(), LocalError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.solid.evaluate_nodes::<N, C, true>(self.element, self.displacement, self.request, self.out)
    }
}
