//! The solid: deviatoric energy at Gauss points, volumetric energy by pressure modes per element.
//!
//! # Kernel
//!
//! With ∇N the reference gradients, `f_a = F ∇N_a` and `c_a = cof F ∇N_a`, a material in the invariants (I₁, J) has
//!
//! ```text
//! r_a  = w (2 W₁ f_a + W_J c_a)
//! K_ab = w [2 W₁ (∇N_a·∇N_b) 1 + 4 W₁₁ f_a f_bᵀ + 2 W₁J (f_a c_bᵀ + c_a f_bᵀ) + W_JJ c_a c_bᵀ
//!           + W_J/J (c_a c_bᵀ − c_b c_aᵀ)]
//! ```
//!
//! The last term is the second derivative of J; it equals −W_J \[F (∇N_a × ∇N_b)\]ₓ, where \[v\]ₓ x = v × x.
//!
//! Other laws are asked for P and A = ∂P/∂F: r_a = w P ∇N_a, K_ab = w ∇N_a·A·∇N_b.
//!
//! # Mixed linearisation
//!
//! The residual is that of the energy: its pressure is κ M⁻¹ θ (for other volumetric energies than ½ κ (J − 1)², see
//! [`crate::law::ElementMaterial::respond_to_dilatation`]). The tangent's geometric term may carry another one, an
//! independent pressure p of each element that Newton's method updates by p ← κ M⁻¹ (θ + B δu) (Magisano, Leonetti &
//! Garcea 2017, *Comput. Methods Appl. Mech. Engrg.* 313; design §3.1). At a solution the two agree, so the tangent is
//! consistent there; on the way to it, the carried one lets steps be about a hundred times longer.

use std::sync::Arc;

use nalgebra::Matrix4;
use pneuflex_material::{Kinematics, Tangent, add_dyad, add_scaled as add_tangent, second_derivative_of_jacobian};
use pneuflex_mesh::{
    Mesh,
    mesh::{cofactor, determinant},
};
use pneuflex_model::{Formulation, Material, Volumetric};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::contribution::{Contribution, Mixed, Position, Prediction};
use crate::formulation::{IntegrationPoint, ReferenceElement};
use crate::kernel::{
    LANES, NodeVectors, PairBlocks, PointTangent, add_moduli, add_outer, add_point, add_scaled, add_skew, geometry,
    gradient_of, inner, store, to_lanes, transform, zero,
};
use crate::law::{ElementMaterial, VolumetricResponse};
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// All elements of a body.
#[derive(Clone, Debug)]
pub struct Solid {
    reference: ReferenceElement,
    materials: Vec<ElementMaterial>,
    /// Number of every element's material.
    material_of: Vec<u16>,
    mesh: Arc<Mesh>,
    /// M⁻¹ of every element; only the leading `num_modes` rows and columns count.
    inverse_mass: Vec<[[f64; 4]; 4]>,
    /// Pressure carried by the linearisation, `num_modes` per element; empty: that of the residual.
    carried: Vec<f64>,
    /// What the next tangent's carried pressures follow from, if they are not those of the tangent before.
    prediction: Option<Arc<Prediction>>,
    processor: Arch,
}

/// θ and its derivative B for one element.
struct Dilatation<const C: usize> {
    theta: [f64; 4],
    gradient: [NodeVectors<C>; 4],
}

/// An element has no volume or is turned inside out at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("element {element} of the undeformed mesh has no positive volume")]
pub struct DegenerateElement {
    /// Element number.
    pub element: usize,
}

impl Solid {
    /// The body of a mesh, of one material.
    ///
    /// # Errors
    /// [`DegenerateElement`] if the undeformed mesh has an element with a non-positive Jacobian.
    pub fn new(
        mesh: impl Into<Arc<Mesh>>,
        formulation: Formulation,
        material: &Material,
    ) -> Result<Self, DegenerateElement> {
        let mesh = mesh.into();
        let material_of = vec![0; mesh.num_elements()];
        Self::of_materials(mesh, formulation, &[material], material_of)
    }

    /// The body of a mesh; `material_of` is the number of every element's material in `materials`.
    ///
    /// # Errors
    /// [`DegenerateElement`] if the undeformed mesh has an element with a non-positive Jacobian.
    pub fn of_materials(
        mesh: impl Into<Arc<Mesh>>,
        formulation: Formulation,
        materials: &[&Material],
        material_of: Vec<u16>,
    ) -> Result<Self, DegenerateElement> {
        let mut solid = Self {
            reference: ReferenceElement::new(formulation),
            materials: materials.iter().map(|material| ElementMaterial::new(material, formulation)).collect(),
            material_of,
            mesh: mesh.into(),
            inverse_mass: Vec::new(),
            carried: Vec::new(),
            prediction: None,
            processor: Arch::new(),
        };
        for element in 0..solid.mesh.num_elements() {
            let mut mass = Matrix4::<f64>::zeros();
            for point in &solid.reference.volumetric {
                let volume = solid.point_volume(element, point);
                if volume <= 0.0 || !volume.is_finite() {
                    return Err(DegenerateElement { element });
                }
                for i in 0..4 {
                    for j in 0..4 {
                        mass[(i, j)] += volume * point.modes[i] * point.modes[j];
                    }
                }
            }
            // Modes that the formulation does not have are decoupled.
            for i in solid.reference.num_modes..4 {
                mass.row_mut(i).fill(0.0);
                mass.column_mut(i).fill(0.0);
                mass[(i, i)] = 1.0;
            }
            let inverse = mass.try_inverse().ok_or(DegenerateElement { element })?;
            solid.inverse_mass.push(std::array::from_fn(|i| std::array::from_fn(|j| inverse[(i, j)])));
        }
        Ok(solid)
    }

    /// Number of pressure modes per element.
    pub fn num_modes(&self) -> usize {
        self.reference.num_modes
    }

    /// Coefficients of the pressure modes of every element, MPa, `num_modes` per element: p(θ), or with a correction
    /// p(θ) + ∂p/∂θ B δu; κ M⁻¹ θ and κ M⁻¹ (θ + B δu) for the quadratic volumetric energy. The pressure at a point is Σ ψᵢ pᵢ; tension is positive. On tetrahedra κ is less κ_f here, see
    /// [`crate::formulation`].
    pub fn element_pressures(&self, displacement: &[[f64; 3]], correction: Option<&[[f64; 3]]>) -> Vec<f64> {
        pneuflex_mesh::with_num_nodes!(self.reference.kind, N => {
            self.pressures_of::<N, { N.div_ceil(LANES) }>(displacement, correction)
        })
    }

    fn pressures_of<const N: usize, const C: usize>(
        &self,
        displacement: &[[f64; 3]],
        correction: Option<&[[f64; 3]]>,
    ) -> Vec<f64> {
        let modes = self.reference.num_modes;
        let mut pressures = vec![0.0; modes * self.inverse_mass.len()];
        pressures.par_chunks_mut(modes).with_min_len(64).enumerate().for_each(|(element, out)| match self.processor {
            Arch::Scalar => self.pressures_of_element::<N, C, false>(element, displacement, correction, out),
            processor => {
                processor.dispatch(PressuresOfElement::<N, C> { solid: self, element, displacement, correction, out })
            }
        });
        pressures
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
        let (material, modes) = (self.material(element), self.reference.num_modes);
        let mut theta = dilatation.theta;
        if let Some(correction) = correction {
            let delta = self.gather::<N, C>(element, correction);
            for (theta, gradient) in theta.iter_mut().zip(&dilatation.gradient).take(self.reference.num_modes) {
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

    fn material(&self, element: usize) -> &ElementMaterial {
        &self.materials[usize::from(self.material_of[element])]
    }

    #[inline(always)]
    fn volumetric_response<const C: usize, const FMA: bool>(
        &self,
        element: usize,
        x: &NodeVectors<C>,
        theta: &[f64; 4],
    ) -> Result<VolumetricResponse, LocalError> {
        let (inverse, modes) = (&self.inverse_mass[element], self.reference.num_modes);
        let points = || {
            let volume = |point| self.geometry_at::<C, FMA>(element, x, point).1;
            self.reference.volumetric.iter().map(move |point| (point.modes, volume(point)))
        };
        self.material(element)
            .respond_to_dilatation(theta, inverse, modes, points)
            .map_err(|(point, jacobian)| LocalError { block: element, point, jacobian })
    }

    #[inline(always)]
    fn gather<const N: usize, const C: usize>(&self, element: usize, field: &[[f64; 3]]) -> NodeVectors<C> {
        let nodes = self.mesh.element(element);
        to_lanes::<N, C>(&std::array::from_fn(|a| field[nodes[a] as usize]))
    }

    /// Reference volume that an integration point stands for, mm³.
    fn point_volume(&self, element: usize, point: &IntegrationPoint) -> f64 {
        let volume_at = |p: &IntegrationPoint| p.weight * determinant(&self.mesh.jacobian(element, &p.gradients));
        if self.reference.is_centre_only {
            self.reference.deviatoric.iter().map(volume_at).sum()
        } else {
            volume_at(point)
        }
    }

    #[inline(always)]
    fn dilatation<const C: usize, const FMA: bool>(
        &self,
        element: usize,
        x: &NodeVectors<C>,
        u: &NodeVectors<C>,
        with_gradient: bool,
    ) -> Dilatation<C> {
        let modes = self.reference.num_modes;
        let mut out = Dilatation { theta: [0.0; 4], gradient: [zero(); 4] };
        for point in &self.reference.volumetric {
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
    fn geometry_at<const C: usize, const FMA: bool>(
        &self,
        element: usize,
        x: &NodeVectors<C>,
        point: &IntegrationPoint,
    ) -> (NodeVectors<C>, f64) {
        let (g, det) = geometry::<C, FMA>(&point.lanes, x);
        (g, if self.reference.is_centre_only { self.point_volume(element, point) } else { point.weight * det })
    }

    #[inline(always)]
    fn evaluate_nodes<const N: usize, const C: usize, const FMA: bool>(
        &self,
        element: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let [x, u] = [&self.mesh.nodes[..], displacement].map(|field| self.gather::<N, C>(element, field));
        let modes = self.reference.num_modes;

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

        for (index, point) in self.reference.deviatoric.iter().enumerate() {
            let (g, det) = geometry::<C, FMA>(&point.lanes, &x);
            let volume = point.weight * det;
            let h = gradient_of::<C, FMA>(&u, &g);
            let kinematics =
                Kinematics::new(&h).map_err(|e| LocalError { block: element, point: index, jacobian: e.0 })?;
            let shared = if self.reference.shares_points { volume * carried_at(point) } else { 0.0 };
            let Some(mut d) = material.law.by_invariants(&kinematics) else {
                let state = GeneralPoint { kinematics: &kinematics, g: &g, volume, shared };
                let residual = (request >= Request::Residual).then_some(&mut residual);
                let energy = state.add::<N, FMA>(material, residual, tangent.as_mut());
                let overflow = LocalError { block: element, point: index, jacobian: kinematics.jacobian };
                out.energy += energy.ok_or(overflow)?;
                continue;
            };
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
            if !self.reference.shares_points {
                for point in &self.reference.volumetric {
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
        let modes = self.reference.num_modes;
        if self.carried.is_empty() {
            return *pressure;
        }
        std::array::from_fn(|i| if i < modes { self.carried[element * modes + i] } else { 0.0 })
    }

    /// The kernel compiled for the instructions that this processor has.
    fn dispatch<const N: usize, const C: usize>(
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

impl Contribution for Solid {
    fn name(&self) -> &'static str {
        "solid"
    }

    fn set_position(&mut self, _position: Position<'_>) {}

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        Some(self)
    }

    fn mixed(&mut self) -> Option<&mut dyn Mixed> {
        Some(self)
    }
}

/// The pressures are only computed when a tangent follows.
impl Mixed for Solid {
    fn predict(&mut self, prediction: &Arc<Prediction>) {
        self.prediction = Some(Arc::clone(prediction));
    }

    fn linearise(&mut self) {
        if let Some(prediction) = self.prediction.take() {
            self.carried = self.element_pressures(&prediction.displacement, prediction.correction.as_deref());
        }
    }
}

impl LocalContribution for Solid {
    fn num_blocks(&self) -> usize {
        self.inverse_mass.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        self.mesh.element(block)
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        pneuflex_mesh::with_num_nodes!(self.reference.kind, N => {
            self.dispatch::<N, { N.div_ceil(LANES) }>(block, displacement, request, out)
        })
    }
}

/// J − 1 and cof F for the displacement gradient H, also for states that are turned inside out.
#[inline]
fn volume_change(h: &[[f64; 3]; 3]) -> (f64, [[f64; 3]; 3]) {
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
