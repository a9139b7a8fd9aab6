//! The `[material]` table: a hyperelastic law with its constants, the resistance to a change of volume, the density.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::case::{CaseError, Problems};
use crate::written::rounded;
use table::{LawName, Table};

mod table;

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
}

/// Energy of a change of shape per reference volume. Bars mark the isochoric part J^(−1/3) F of the deformation gradient.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// Σ Cᵢ₀ (Ī₁ − 3)ⁱ, i = 1…3 (Yeoh 1993, *Rubber Chem. Technol.* 66).
    Yeoh {
        /// Coefficient of (Ī₁ − 3), MPa.
        c10: f64,
        /// Coefficient of (Ī₁ − 3)², MPa.
        c20: f64,
        /// Coefficient of (Ī₁ − 3)³, MPa.
        c30: f64,
    },
    /// C₁₀ (Ī₁ − 3).
    NeoHooke {
        /// Coefficient of (Ī₁ − 3), MPa.
        c10: f64,
    },
    /// Σ Cᵢⱼ (Ī₁ − 3)ⁱ (Ī₂ − 3)ʲ, i + j = 1, 2 (Rivlin & Saunders 1951); Mooney–Rivlin has C₁₀ and C₀₁ alone.
    Polynomial {
        /// Coefficient of (Ī₁ − 3), MPa.
        c10: f64,
        /// Coefficient of (Ī₂ − 3), MPa.
        c01: f64,
        /// Coefficient of (Ī₁ − 3)², MPa.
        c20: f64,
        /// Coefficient of (Ī₁ − 3) (Ī₂ − 3), MPa.
        c11: f64,
        /// Coefficient of (Ī₂ − 3)², MPa.
        c02: f64,
    },
    /// Σ 2 μᵢ/αᵢ² (λ̄₁^αᵢ + λ̄₂^αᵢ + λ̄₃^αᵢ − 3), 1 to 3 terms (Ogden 1972). The constants are Abaqus's: Ogden's own μᵢ are
    /// 2/αᵢ times these.
    Ogden {
        /// The terms.
        terms: Vec<OgdenTerm>,
    },
}

/// One term of Ogden's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OgdenTerm {
    /// Its share μ of the shear modulus at rest, MPa.
    pub mu: f64,
    /// Its exponent α.
    pub alpha: f64,
}

/// Energy U of a change of volume per reference volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Volumetric {
    /// κ/2 (J − 1)².
    #[default]
    Quadratic,
    /// κ/2 (ln J)².
    Logarithmic,
}

/// First invariant in the energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Invariant {
    /// I₁ of the whole deformation (the paper's).
    Full,
    /// Ī₁ = J^(−2/3) I₁, stress-free at rest, as in other programs.
    Isochoric,
}

/// The paper's constants.
const PAPER: [f64; 3] = [0.2712, 0.03053, -0.000_401_3];

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
        Self { law, bulk_modulus, volumetric, invariant, density: 0.0 }
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
        found.unless_positive(&key("bulk_modulus"), self.bulk_modulus, " MPa");
        if self.invariant == Invariant::Full && self.law.reduced_polynomial().is_none() {
            let allowed = format!("must be \"isochoric\" where {} = \"{}\"", key("law"), self.law.name());
            found.add(&key("invariant"), &"full", &allowed);
        }
        if !(self.density.is_finite() && self.density >= 0.0) {
            found.add(&key("density"), &self.density, "must be a finite number, 0 or greater, g/cm3");
        }
        found.0
    }
}

impl Law {
    /// Shear modulus at rest, MPa: 2 (C₁₀ + C₀₁) or Σ μᵢ.
    pub fn shear_modulus(&self) -> f64 {
        match self {
            Self::Yeoh { c10, .. } | Self::NeoHooke { c10 } => 2.0 * c10,
            Self::Polynomial { c10, c01, .. } => 2.0 * (c10 + c01),
            Self::Ogden { terms } => terms.iter().map(|term| term.mu).sum(),
        }
    }

    /// C₁₀, C₂₀, C₃₀ of a law that is a polynomial of the first invariant alone: Yeoh and neo-Hooke.
    pub fn reduced_polynomial(&self) -> Option<[f64; 3]> {
        match *self {
            Self::Yeoh { c10, c20, c30 } => Some([c10, c20, c30]),
            Self::NeoHooke { c10 } => Some([c10, 0.0, 0.0]),
            Self::Polynomial { .. } | Self::Ogden { .. } => None,
        }
    }

    /// Name in case files.
    pub fn name(&self) -> &'static str {
        LawName::of(self).text()
    }

    fn check(&self, key: &impl Fn(&str) -> String, found: &mut Problems) {
        if let Self::Ogden { terms } = self {
            check_ogden(terms, key, found);
            return;
        }
        let constants = self.constants();
        for (name, value) in &constants {
            if matches!((self, *name), (Self::Yeoh { .. } | Self::NeoHooke { .. }, "c10")) {
                found.unless_positive(&key(name), *value, " MPa");
            } else if !value.is_finite() {
                found.add(&key(name), value, "must be a finite number, MPa");
            }
        }
        if let Self::Polynomial { c10, c01, .. } = self
            && c10.is_finite()
            && c01.is_finite()
            && !(c10 + c01 > 0.0 && self.shear_modulus().is_finite())
        {
            let allowed = format!("c10 + c01 must be greater than 0 MPa: half the shear modulus at rest; c01 = {c01}");
            found.add(&key("c10"), c10, &allowed);
        }
    }

    /// Constants that are single numbers, MPa, by their keys; none for Ogden's lists.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Yeoh { c10, c20, c30 } => vec![("c10", c10), ("c20", c20), ("c30", c30)],
            Self::NeoHooke { c10 } => vec![("c10", c10)],
            Self::Polynomial { c10, c01, .. } if LawName::of(self) == LawName::MooneyRivlin => {
                vec![("c10", c10), ("c01", c01)]
            }
            Self::Polynomial { c10, c01, c20, c11, c02 } => {
                vec![("c10", c10), ("c01", c01), ("c20", c20), ("c11", c11), ("c02", c02)]
            }
            Self::Ogden { .. } => Vec::new(),
        }
    }
}

fn check_ogden(terms: &[OgdenTerm], key: &impl Fn(&str) -> String, found: &mut Problems) {
    let (mu, alpha): (Vec<f64>, Vec<f64>) = terms.iter().map(|term| (term.mu, term.alpha)).unzip();
    if terms.is_empty() || terms.len() > 3 {
        found.add(&key("mu"), &mu, "must be a list of 1 to 3 numbers, MPa");
    }
    let shear_modulus: f64 = mu.iter().sum();
    let is_stiff = shear_modulus.is_finite() && shear_modulus > 0.0;
    if !(mu.is_empty() || is_stiff) {
        let allowed =
            "must be as many finite numbers as alpha has, and their sum, the shear modulus at rest, greater than 0 MPa";
        found.add(&key("mu"), &mu, allowed);
    }
    // Smaller exponents lose the digits of the energy, larger ones overflow at stretches of silicones.
    if !alpha.iter().all(|a| (0.01..=100.0).contains(&a.abs())) {
        let allowed = "must be as many numbers as mu has, each from 0.01 to 100 or from -100 to -0.01";
        found.add(&key("alpha"), &alpha, allowed);
    }
}

/// The constants, as in `c10 0.2712, c20 0.03053`.
impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Self::Ogden { terms } = self {
            let (mu, alpha): (Vec<f64>, Vec<f64>) = terms.iter().map(|term| (term.mu, term.alpha)).unzip();
            return write!(f, "mu {mu:?}, alpha {alpha:?}");
        }
        let constants: Vec<String> = self.constants().iter().map(|(name, value)| format!("{name} {value}")).collect();
        f.write_str(&constants.join(", "))
    }
}

/// Bulk modulus of a material of which only the shear constants are known, MPa: the paper's 1000 to its shear modulus of
/// 2 C₁₀, 1844 times as much (Poisson's ratio 0.4997).
fn default_bulk_modulus(shear_modulus: f64) -> f64 {
    let half = 0.5 * shear_modulus;
    // What is out of range itself is complained about by itself.
    if half > 0.0 && half.is_finite() { rounded(1000.0 * half / PAPER[0]) } else { 1000.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

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
