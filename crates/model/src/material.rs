//! The `[material]` table: a hyperelastic law with its constants, the resistance to a change of volume, the density.

use serde::{Deserialize, Serialize};

use crate::fitted_to::FittedTo;
use crate::law::{ConstantError, Invariant, Law, PAPER, Table, Volumetric};
use crate::number::rounded;
use crate::range_check::{CaseError, Problems, Quantity};

/// A hyperelastic material; moduli in MPa.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Table", into = "Table")]
pub struct Material {
    /// Energy of a change of shape.
    pub law: Law,
    /// Bulk modulus κ; the paper calls it the penalty factor.
    pub bulk_modulus: f64,
    /// Energy of a change of volume.
    pub volumetric: Volumetric,
    /// Which first invariant the energy depends on; laws other than Yeoh and neo-Hooke take the isochoric one only.
    pub invariant: Invariant,
    /// Density, g/cm³ (10⁻⁹ t/mm³); 0 is a weightless body.
    pub density: f64,
    /// How far the tests went that the constants were fitted to, if that is known.
    pub fitted_to: Option<FittedTo>,
}

impl Default for Material {
    fn default() -> Self {
        let [c10, c20, c30] = PAPER;
        Self::yeoh(c10, c20, c30)
    }
}

impl From<Law> for Material {
    /// With the paper's ratio of bulk to shear modulus, isochoric and weightless.
    fn from(law: Law) -> Self {
        let bulk_modulus = default_bulk_modulus(law.shear_modulus());
        let (volumetric, invariant) = (Volumetric::Quadratic, Invariant::Isochoric);
        Self { law, bulk_modulus, volumetric, invariant, density: 0.0, fitted_to: None }
    }
}

impl TryFrom<Table> for Material {
    type Error = ConstantError;

    fn try_from(table: Table) -> Result<Self, ConstantError> {
        let default = Self::from(table.law()?);
        Ok(Self {
            bulk_modulus: table.bulk_modulus.unwrap_or(default.bulk_modulus),
            volumetric: table.volumetric,
            invariant: table.invariant.unwrap_or(default.invariant),
            density: table.density,
            fitted_to: table.fitted_to,
            ..default
        })
    }
}

impl From<Material> for Table {
    fn from(material: Material) -> Self {
        let Material { law, bulk_modulus, volumetric, invariant, density, fitted_to } = material;
        let mut table = Self::of_law(&law);
        (table.bulk_modulus, table.invariant) = (Some(bulk_modulus), Some(invariant));
        (table.volumetric, table.density, table.fitted_to) = (volumetric, density, fitted_to);
        table
    }
}

impl Material {
    /// A Yeoh material with the paper's ratio of bulk to shear modulus, isochoric and weightless.
    pub fn yeoh(c10: f64, c20: f64, c30: f64) -> Self {
        Law::Yeoh { c10, c20, c30 }.into()
    }

    /// Shear modulus at rest, MPa.
    pub fn shear_modulus(&self) -> f64 {
        self.law.shear_modulus()
    }

    /// Density in the units of mm, N and MPa, t/mm³.
    pub fn density_in_t_per_mm3(&self) -> f64 {
        self.density / 1e9
    }

    /// Every constant that is out of range; `table` is the name of the material's table, e.g. `material`.
    pub fn problems(&self, table: &str) -> Vec<CaseError> {
        let mut found = Problems::default();
        let key = |name: &str| format!("{table}.{name}");
        self.law.check(&key, &mut found);
        found.unless_positive(&key("bulk_modulus"), self.bulk_modulus, Quantity::Stress);
        if self.invariant == Invariant::Full && self.law.reduced_polynomial().is_none() {
            let allowed = format!("must be \"isochoric\" where {} = \"{}\"", key("law"), self.law.name());
            found.add(&key("invariant"), &"full", &allowed);
        }
        if !(self.density >= 0.0 && Quantity::Density.allows(self.density)) {
            let most = Quantity::Density.range()[1];
            found.add(
                &key("density"),
                &self.density,
                &format!("must be a finite number, 0 or greater, g/cm3, up to {most:e}"),
            );
        }
        // No rubber is stretched further than to some ten times its length.
        if let Some(fitted_to) = self.fitted_to {
            for (mode, stretch) in fitted_to.tests().filter(|(_, stretch)| !(1.0 < *stretch && *stretch <= 100.0)) {
                let allowed = format!("must be a stretch greater than 1, up to 100 ({} test)", mode.name());
                found.add(&key("fitted_to"), &stretch, &allowed);
            }
            if fitted_to.tests().next().is_none() {
                found.add(&key("fitted_to"), &"{}", "must have a stretch of a test: uniaxial, equibiaxial or planar");
            }
        }
        found.0
    }
}

/// Bulk modulus of a material of which only the shear constants are known, MPa: the paper's 1000 to its shear modulus of
/// 2 C₁₀, 1844 times as much (Poisson's ratio 0.4997).
fn default_bulk_modulus(shear_modulus: f64) -> f64 {
    let half = 0.5 * shear_modulus;
    // What is out of range itself is complained about by itself.
    let [least, most] = Quantity::Stress.range();
    if (least..=most).contains(&half) { rounded(1000.0 * half / PAPER[0]).min(most) } else { 1000.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::OgdenTerm;

    #[test]
    fn the_papers_material_gives_the_papers_numbers_and_others_scale() {
        assert_eq!(Material::default().bulk_modulus, 1000.0);
        assert_eq!(Material::yeoh(0.02712, 0.0, 0.0).bulk_modulus, 100.0);
        assert_eq!(Material::yeoh(f64::NAN, 0.0, 0.0).bulk_modulus, 1000.0);
        let mooney_rivlin = Law::Polynomial { c10: 0.2, c01: 0.0712, c20: 0.0, c11: 0.0, c02: 0.0 };
        assert_eq!(
            (Material::from(mooney_rivlin.clone()).bulk_modulus, mooney_rivlin.shear_modulus()),
            (1000.0, 0.5424)
        );
        let terms = vec![OgdenTerm { mu: 0.6, alpha: 1.3 }, OgdenTerm { mu: -0.1, alpha: -2.0 }];
        assert_eq!(Law::Ogden { terms }.shear_modulus(), 0.5);
        assert_eq!(Material { density: 1.08, ..Material::default() }.density_in_t_per_mm3(), 1.08e-9);
    }

    fn complaints(law: Law) -> Vec<String> {
        let material = Material { bulk_modulus: 1.0, ..Material::from(law) };
        material.problems("m").into_iter().map(|p| p.key).collect()
    }

    #[test]
    fn constants_out_of_range_are_named() {
        let polynomial = |c10, c01, c02| complaints(Law::Polynomial { c10, c01, c20: 0.0, c11: 0.0, c02 });
        assert_eq!(polynomial(0.3, -0.1, -5.0), [""; 0]);
        assert_eq!(polynomial(0.1, -0.1, 0.0), ["m.c10"]);
        assert_eq!(polynomial(0.1, f64::NAN, f64::INFINITY), ["m.c01", "m.c02"]);
        let ogden = |terms: &[(f64, f64)]| {
            complaints(Law::Ogden { terms: terms.iter().map(|&(mu, alpha)| OgdenTerm { mu, alpha }).collect() })
        };
        assert_eq!(ogden(&[(0.6, 1.3), (-0.1, 5.0), (0.01, -2.0)]), [""; 0]);
        assert_eq!(ogden(&[]), ["m.mu"]);
        assert_eq!(ogden(&[(0.1, 2.0); 4]), ["m.mu"]);
        assert_eq!(ogden(&[(0.1, 2.0), (-0.1, 3.0)]), ["m.mu"]);
        assert_eq!(ogden(&[(0.1, 2.0), (f64::NAN, 3.0)]), ["m.mu"]);
        assert_eq!(ogden(&[(0.1, 0.0)]), ["m.alpha"]);
        assert_eq!(ogden(&[(0.1, f64::NAN)]), ["m.alpha"]);
        let full = Material {
            invariant: Invariant::Full,
            ..Law::Polynomial { c10: 0.1, c01: 0.1, c20: 0.0, c11: 0.0, c02: 0.0 }.into()
        };
        assert_eq!(full.problems("material")[0].key, "material.invariant");
        assert!(full.problems("material")[0].allowed.contains("mooney-rivlin"));
        let heavy = Material { density: -1.0, ..Material::default() };
        assert_eq!(heavy.problems("material")[0].key, "material.density");
    }
}
