//! Materials in elements: the law of the change of shape beside the energy of the element's change of volume.

use std::sync::Arc;

use pneuflex_laws::law_of;
use pneuflex_material::{Hyperelastic, volumetric};
use pneuflex_model::{Formulation, Material, Volumetric};

/// A material in elements of one formulation.
#[derive(Clone, Debug)]
pub struct ElementMaterial {
    /// Its law, without the volumetric energy.
    pub law: Arc<dyn Hyperelastic>,
    /// Form of the volumetric energy.
    pub volumetric: Volumetric,
    /// Part of the bulk modulus that resists the element's smoothed change of volume, in the material's volumetric form, MPa.
    pub bulk_modulus: f64,
    /// Part that resists fluctuations, always in the quadratic form: ½ κ_f (J − 1)², MPa.
    pub fluctuation_modulus: f64,
}

/// Volumetric energy of an element as a function of θ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumetricResponse {
    /// E, N·mm.
    pub energy: f64,
    /// p = ∂E/∂θ, MPa.
    pub pressure: [f64; 4],
    /// ∂p/∂θ, MPa/mm³.
    pub modulus: [[f64; 4]; 4],
}

impl ElementMaterial {
    /// A material in a formulation.
    pub fn new(material: &Material, formulation: Formulation) -> Self {
        let fluctuation_modulus = formulation.fluctuation_modulus(material);
        Self {
            law: law_of(material),
            volumetric: material.volumetric,
            bulk_modulus: material.bulk_modulus - fluctuation_modulus,
            fluctuation_modulus,
        }
    }

    /// Volumetric energy ∫ U(J̄) dV with J̄ = 1 + Σ ψᵢ (M⁻¹θ)ᵢ, its pressure p = M⁻¹ ∫ U′ ψ dV and their modulus
    /// M⁻¹ [∫ U″ ψψᵀ dV] M⁻¹; in the quadratic form ½ κ θᵀM⁻¹θ, κ M⁻¹ θ and κ M⁻¹.
    ///
    /// `inverse_mass` is M⁻¹, of which the leading `modes` rows and columns count; `points` are values ψ and volumes
    /// of the volumetric points, and are only asked for where the form is not quadratic.
    ///
    /// # Errors
    /// J̄ at the first point (with its number) where it is not positive, though U is not defined there.
    pub fn respond_to_dilatation<I: Iterator<Item = ([f64; 4], f64)>>(
        &self,
        theta: &[f64; 4],
        inverse_mass: &[[f64; 4]; 4],
        modes: usize,
        points: impl FnOnce() -> I,
    ) -> Result<VolumetricResponse, (usize, f64)> {
        let kappa = self.bulk_modulus;
        if self.volumetric == Volumetric::Quadratic {
            let pressure = self.quadratic_pressure(theta, inverse_mass, modes);
            let energy = 0.5 * (0..modes).map(|i| pressure[i] * theta[i]).sum::<f64>();
            return Ok(VolumetricResponse {
                energy,
                pressure,
                modulus: inverse_mass.map(|row| row.map(|entry| kappa * entry)),
            });
        }
        let product = |v: &[f64; 4]| -> [f64; 4] {
            std::array::from_fn(|i| if i < modes { (0..modes).map(|j| inverse_mass[i][j] * v[j]).sum() } else { 0.0 })
        };
        let strain = product(theta);
        let (mut energy, mut slope, mut curvature) = (0.0, [0.0; 4], [[0.0; 4]; 4]);
        for (index, (psi, volume)) in points().enumerate() {
            let excess = (0..modes).map(|i| psi[i] * strain[i]).sum::<f64>();
            let [u, du, ddu] = volumetric::evaluate(self.volumetric, excess);
            // Written so that a NaN is refused too.
            if !(excess > -1.0 && u.is_finite()) {
                return Err((index, 1.0 + excess));
            }
            energy += kappa * volume * u;
            for i in 0..modes {
                slope[i] += kappa * volume * du * psi[i];
                for j in 0..modes {
                    curvature[i][j] += kappa * volume * ddu * psi[i] * psi[j];
                }
            }
        }
        // M⁻¹ is symmetric: the rows of M⁻¹ [·] are products with the columns of [·], which is symmetric, too.
        let half = curvature.map(|row| product(&row));
        let modulus = std::array::from_fn(|i| product(&std::array::from_fn(|j| half[j][i])));
        Ok(VolumetricResponse { energy, pressure: product(&slope), modulus })
    }

    /// κ M⁻¹ θ.
    pub fn quadratic_pressure(&self, theta: &[f64; 4], inverse_mass: &[[f64; 4]; 4], modes: usize) -> [f64; 4] {
        std::array::from_fn(|i| {
            if i < modes {
                self.bulk_modulus * (0..modes).map(|j| inverse_mass[i][j] * theta[j]).sum::<f64>()
            } else {
                0.0
            }
        })
    }
}
