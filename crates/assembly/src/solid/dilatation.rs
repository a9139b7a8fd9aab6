//! The change of volume θ of an element by its pressure modes, and the pressures that follow from it.

use pneuflex_mesh::mesh::cofactor;
use pneuflex_model::Volumetric;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::Solid;
use crate::formulation::IntegrationPoint;
use crate::kernel::{LANES, NodeVectors, add_scaled, geometry, gradient_of, inner, to_lanes, transform, zero};
use crate::law::VolumetricResponse;
use crate::local::LocalError;

/// θ and its derivative B for one element.
pub(super) struct Dilatation<const C: usize> {
    pub theta: [f64; 4],
    pub gradient: [NodeVectors<C>; 4],
}

impl Solid {
    /// Coefficients of the pressure modes of every element, MPa, `num_modes` per element: p(θ), or with a correction
    /// p(θ) + ∂p/∂θ B δu; κ M⁻¹ θ and κ M⁻¹ (θ + B δu) for the quadratic volumetric energy. The pressure at a point is Σ ψᵢ pᵢ; tension is positive. κ is less κ_f here, see
    /// [`crate::formulation`].
    pub fn element_pressures(&self, displacement: &[[f64; 3]], correction: Option<&[[f64; 3]]>) -> Vec<f64> {
        let mut pressures = vec![0.0; self.num_modes * self.inverse_mass.len()];
        pressures.par_chunks_mut(self.num_modes).with_min_len(64).enumerate().for_each(|(element, out)| {
            pneuflex_mesh::with_num_nodes!(self.mesh.kind_of(element), N => {
                self.dispatch_pressures::<N, { N.div_ceil(LANES) }>(element, displacement, correction, out);
            });
        });
        pressures
    }

    fn dispatch_pressures<const N: usize, const C: usize>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
        correction: Option<&[[f64; 3]]>,
        out: &mut [f64],
    ) {
        match self.processor {
            Arch::Scalar => self.pressures_of_element::<N, C, false>(element, displacement, correction, out),
            processor => {
                processor.dispatch(PressuresOfElement::<N, C> { solid: self, element, displacement, correction, out });
            }
        }
    }

    #[inline(always)]
    fn pressures_of_element<const N: usize, const C: usize, const FMA: bool>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
        correction: Option<&[[f64; 3]]>,
        out: &mut [f64],
    ) {
        let [x, u] = [&self.mesh.nodes[..], displacement].map(|field| self.gather::<N, C>(element, field));
        let dilatation = self.dilatation::<C, FMA>(element, &x, &u, correction.is_some());
        let (material, modes) = (self.material(element), self.num_modes);
        let mut theta = dilatation.theta;
        if let Some(correction) = correction {
            let delta = self.gather::<N, C>(element, correction);
            for (theta, gradient) in theta.iter_mut().zip(&dilatation.gradient).take(modes) {
                *theta += inner(gradient, &delta);
            }
        }
        let pressure = if material.volumetric == Volumetric::Quadratic {
            material.quadratic_pressure(&theta, &self.inverse_mass[element], modes)
        } else {
            // Where U is not defined the element cannot be evaluated either.
            let here = self.volumetric_response::<C, FMA>(element, &x, &dilatation.theta);
            here.map_or([f64::NAN; 4], |here| {
                let by_correction =
                    |i: usize| (0..modes).map(|j| here.modulus[i][j] * (theta[j] - dilatation.theta[j])).sum::<f64>();
                std::array::from_fn(|i| if i < modes { here.pressure[i] + by_correction(i) } else { 0.0 })
            })
        };
        out.copy_from_slice(&pressure[..modes]);
    }

    #[inline(always)]
    pub(super) fn volumetric_response<const C: usize, const FMA: bool>(
        &self,
        element: usize,
        x: &NodeVectors<C>,
        theta: &[f64; 4],
    ) -> Result<VolumetricResponse, LocalError> {
        let (inverse, modes) = (&self.inverse_mass[element], self.num_modes);
        let points = || {
            let volume = |point| self.geometry_at::<C, FMA>(element, x, point).1;
            self.reference(element).volumetric.iter().map(move |point| (point.modes, volume(point)))
        };
        self.material(element)
            .respond_to_dilatation(theta, inverse, modes, points)
            .map_err(|(point, jacobian)| LocalError { block: element, point, jacobian })
    }

    #[inline(always)]
    pub(super) fn gather<const N: usize, const C: usize>(&self, element: usize, field: &[[f64; 3]]) -> NodeVectors<C> {
        let nodes = self.mesh.element(element);
        to_lanes::<N, C>(&std::array::from_fn(|a| field[nodes[a] as usize]))
    }

    #[inline(always)]
    pub(super) fn dilatation<const C: usize, const FMA: bool>(
        &self,
        element: usize,
        x: &NodeVectors<C>,
        u: &NodeVectors<C>,
        with_gradient: bool,
    ) -> Dilatation<C> {
        let modes = self.num_modes;
        let mut out = Dilatation { theta: [0.0; 4], gradient: [zero(); 4] };
        for point in &self.reference(element).volumetric {
            let (g, volume) = self.geometry_at::<C, FMA>(element, x, point);
            let h = gradient_of::<C, FMA>(u, &g);
            let (jacobian_minus_1, cof) = volume_change(&h);
            for i in 0..modes {
                out.theta[i] += volume * point.modes[i] * jacobian_minus_1;
            }
            if with_gradient {
                let c = transform::<C, FMA>(&cof, &g);
                for i in 0..modes {
                    add_scaled::<C, FMA>(&mut out.gradient[i], volume * point.modes[i], &c);
                }
            }
        }
        out
    }

    /// Gradients ∂N/∂X at a point of the volumetric energy, and the volume it stands for, mm³.
    #[inline(always)]
    pub(super) fn geometry_at<const C: usize, const FMA: bool>(
        &self,
        element: usize,
        x: &NodeVectors<C>,
        point: &IntegrationPoint,
    ) -> (NodeVectors<C>, f64) {
        let (g, det) = geometry::<C, FMA>(&point.lanes, x);
        (g, if self.reference(element).is_centre_only { self.point_volume(element, point) } else { point.weight * det })
    }
}

/// A call of [`Solid::pressures_of_element`] with vector instructions.
struct PressuresOfElement<'a, const N: usize, const C: usize> {
    solid: &'a Solid,
    element: usize,
    displacement: &'a [[f64; 3]],
    correction: Option<&'a [[f64; 3]]>,
    out: &'a mut [f64],
}

impl<const N: usize, const C: usize> WithSimd for PressuresOfElement<'_, N, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.solid.pressures_of_element::<N, C, true>(self.element, self.displacement, self.correction, self.out);
    }
}

/// J − 1 and cof F for the displacement gradient H, also for states that are turned inside out.
#[inline]
pub(super) fn volume_change(h: &[[f64; 3]; 3]) -> (f64, [[f64; 3]; 3]) {
    let cof_h = cofactor(h);
    let trace = h[0][0] + h[1][1] + h[2][2];
    let second = cof_h[0][0] + cof_h[1][1] + cof_h[2][2];
    let det = h[0][0] * cof_h[0][0] + h[0][1] * cof_h[0][1] + h[0][2] * cof_h[0][2];
    let mut f = *h;
    for i in 0..3 {
        f[i][i] += 1.0;
    }
    (trace + second + det, cofactor(&f))
}
