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
//! Garcea 2017, *Comput. Methods Appl. Mech. Engrg.* 313; theory §11). At a solution the two agree, so the tangent is
//! consistent there; on the way to it, the carried one lets steps be about a hundred times longer.

mod admissibility;
mod configurational;
mod dilatation;
mod element;

use std::sync::Arc;

use nalgebra::Matrix4;
use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::{Mesh, PerKind};
use pneuflex_model::{Formulation, Material};
use pulp::Arch;

use crate::contribution::{Contribution, Frozen, Mixed, Position, Prediction};
use crate::formulation::{IntegrationPoint, ReferenceElement};
use crate::kernel::LANES;
use crate::law::ElementMaterial;
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// How far displacements are moved along multipliers for a difference, as a share of the nodes' spacing.
const STEP_ALONG_MULTIPLIERS: f64 = 1e-3;

/// All elements of a body.
#[derive(Clone, Debug)]
pub struct Solid {
    references: PerKind<ReferenceElement>,
    materials: PerKind<Vec<ElementMaterial>>,
    /// Pressure modes of every element.
    num_modes: usize,
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

    /// The body of a mesh; `material_of` is the number of every element's material in `materials`. Elements of other families than the
    /// formulation's have that of [`Formulation::beside`].
    ///
    /// # Errors
    /// [`DegenerateElement`] if the undeformed mesh has an element with a non-positive Jacobian.
    pub fn of_materials(
        mesh: impl Into<Arc<Mesh>>,
        formulation: Formulation,
        materials: &[&Material],
        material_of: Vec<u16>,
    ) -> Result<Self, DegenerateElement> {
        let mesh = mesh.into();
        let in_family =
            |formulation| materials.iter().map(|material| ElementMaterial::new(material, formulation)).collect();
        let mut solid = Self {
            references: mesh.per_kind(|kind| ReferenceElement::new(formulation.beside(kind))),
            materials: mesh.per_kind(|kind| in_family(formulation.beside(kind))),
            num_modes: formulation.num_modes,
            material_of,
            mesh,
            inverse_mass: Vec::new(),
            carried: Vec::new(),
            prediction: None,
            processor: Arch::new(),
        };
        for element in 0..solid.mesh.num_elements() {
            let mut mass = Matrix4::<f64>::zeros();
            for point in &solid.reference(element).volumetric {
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
            for i in solid.num_modes..4 {
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
        self.num_modes
    }

    fn material(&self, element: usize) -> &ElementMaterial {
        &self.materials[self.mesh.kind_of(element)][usize::from(self.material_of[element])]
    }

    /// The tables of an element.
    #[inline]
    fn reference(&self, element: usize) -> &ReferenceElement {
        &self.references[self.mesh.kind_of(element)]
    }

    /// Reference volume that an integration point stands for, mm³.
    fn point_volume(&self, element: usize, point: &IntegrationPoint) -> f64 {
        let volume_at = |p: &IntegrationPoint| p.weight * determinant(&self.mesh.jacobian(element, &p.gradients));
        let reference = self.reference(element);
        if reference.is_centre_only { reference.deviatoric.iter().map(volume_at).sum() } else { volume_at(point) }
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

    fn element_tensions(&self, displacement: &[[f64; 3]]) -> Vec<f64> {
        self.element_pressures(displacement, None).into_iter().step_by(self.num_modes).collect()
    }

    fn check_equilibrium(&self, displacement: &[[f64; 3]]) -> Result<(), LocalError> {
        self.check_orientation(displacement)
    }

    /// The derivative of Λ·∂E/∂u by the positions at rest is that of ∂E/∂X along Λ: a difference of configurational forces, extrapolated.
    fn add_shape_slope(&self, frozen: &Frozen<'_>, slope: &mut [[f64; 3]]) -> Result<bool, LocalError> {
        let &Frozen { displacement, multipliers, energy } = frozen;
        let mut add = |factor: f64, forces: Vec<[f64; 3]>| {
            let pairs = slope.as_flattened_mut().iter_mut().zip(forces.as_flattened());
            pairs.for_each(|(sum, force)| *sum += factor * force);
        };
        if energy != 0.0 {
            add(energy, self.configurational_forces(displacement)?);
        }
        let largest = multipliers.as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if largest > 0.0 {
            let step = STEP_ALONG_MULTIPLIERS * self.mesh.mean_node_spacing() / largest;
            for (steps, factor) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                let pairs = displacement.iter().zip(multipliers);
                let moved: Vec<[f64; 3]> =
                    pairs.map(|(u, m)| std::array::from_fn(|k| u[k] + steps * step * m[k])).collect();
                add(-factor / (12.0 * step), self.configurational_forces(&moved)?);
            }
        }
        Ok(true)
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

    fn num_stored(&self) -> usize {
        self.num_modes * self.mesh.num_elements()
    }

    fn stored(&self) -> &[f64] {
        &self.carried
    }

    fn restore(&mut self, stored: &[f64]) {
        self.prediction = None;
        self.carried = stored.to_vec();
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
        pneuflex_mesh::with_num_nodes!(self.mesh.kind_of(block), N => {
            self.dispatch::<N, { N.div_ceil(LANES) }>(block, displacement, request, out)
        })
    }
}
