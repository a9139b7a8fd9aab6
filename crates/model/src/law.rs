//! Hyperelastic laws: their constants with names and ranges, and the `[material]` table in which they are written.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::fitted_to::FittedTo;
use crate::range_check::{Problems, Quantity};

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
    /// −½ μ J_m ln(1 − (Ī₁ − 3)/J_m) (Gent 1996, *Rubber Chem. Technol.* 69).
    Gent {
        /// Shear modulus at rest μ, MPa.
        shear_modulus: f64,
        /// Value of Ī₁ − 3 at which the material locks; it is never reached.
        jm: f64,
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
pub(crate) const PAPER: [f64; 3] = [0.2712, 0.03053, -0.000_401_3];

impl Law {
    /// Shear modulus at rest, MPa: 2 (C₁₀ + C₀₁) or Σ μᵢ.
    pub fn shear_modulus(&self) -> f64 {
        match self {
            Self::Yeoh { c10, .. } | Self::NeoHooke { c10 } => 2.0 * c10,
            Self::Polynomial { c10, c01, .. } => 2.0 * (c10 + c01),
            Self::Ogden { terms } => terms.iter().map(|term| term.mu).sum(),
            Self::Gent { shear_modulus, .. } => *shear_modulus,
        }
    }

    /// Whether some stretch may be reached beyond which more strain takes less stress: not if every term of the energy is convex.
    pub fn may_give_way(&self) -> bool {
        match self {
            Self::NeoHooke { .. } | Self::Gent { .. } => false,
            Self::Yeoh { c20, c30, .. } => *c20 < 0.0 || *c30 < 0.0,
            // The product of two convex functions need not be convex.
            Self::Polynomial { c10, c01, c20, c11, c02 } => {
                *c11 != 0.0 || [c10, c01, c20, c02].into_iter().any(|c| *c < 0.0)
            }
            Self::Ogden { terms } => terms.iter().any(|term| term.mu < 0.0),
        }
    }

    /// C₁₀, C₂₀, C₃₀ of a law that is a polynomial of the first invariant alone: Yeoh and neo-Hooke.
    pub fn reduced_polynomial(&self) -> Option<[f64; 3]> {
        match *self {
            Self::Yeoh { c10, c20, c30 } => Some([c10, c20, c30]),
            Self::NeoHooke { c10 } => Some([c10, 0.0, 0.0]),
            Self::Polynomial { .. } | Self::Ogden { .. } | Self::Gent { .. } => None,
        }
    }

    /// The shear modulus at rest in the names of the constants, e.g. `2 c10`.
    pub fn shear_modulus_in_words(&self) -> &'static str {
        match self {
            Self::Yeoh { .. } | Self::NeoHooke { .. } => "2 c10",
            Self::Polynomial { .. } => "2 (c10 + c01)",
            Self::Ogden { .. } => "the sum of mu",
            Self::Gent { .. } => "shear_modulus",
        }
    }

    /// Name in case files.
    pub fn name(&self) -> &'static str {
        LawName::of(self).text()
    }

    pub(crate) fn check(&self, key: &impl Fn(&str) -> String, found: &mut Problems) {
        if let Self::Ogden { terms } = self {
            check_ogden(terms, key, found);
            return;
        }
        if let Self::Gent { shear_modulus, jm } = self {
            found.unless_positive(&key("shear_modulus"), *shear_modulus, Quantity::Stress);
            if !(1e-3..=1e6).contains(jm) {
                found.add(&key("jm"), jm, "must be a number from 0.001 to 1e6: the value of I1 - 3 at which it locks");
            }
            return;
        }
        let constants = self.constants();
        for (name, value) in &constants {
            if matches!((self, *name), (Self::Yeoh { .. } | Self::NeoHooke { .. }, "c10")) {
                found.unless_positive(&key(name), *value, Quantity::Stress);
            } else {
                found.unless_finite(&key(name), &[*value], "a finite number", Quantity::Stress);
            }
        }
        if let Self::Polynomial { c10, c01, .. } = self
            && Quantity::Stress.allows(*c10)
            && Quantity::Stress.allows(*c01)
            && !is_modulus(self.shear_modulus())
        {
            let allowed = format!("c10 + c01 must be greater than 0 MPa: half the shear modulus at rest; c01 = {c01}");
            found.add(&key("c10"), c10, &allowed);
        }
    }

    /// The same material with all stresses multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let s = factor;
        match self {
            Self::Yeoh { c10, c20, c30 } => Self::Yeoh { c10: s * c10, c20: s * c20, c30: s * c30 },
            Self::NeoHooke { c10 } => Self::NeoHooke { c10: s * c10 },
            Self::Polynomial { c10, c01, c20, c11, c02 } => {
                Self::Polynomial { c10: s * c10, c01: s * c01, c20: s * c20, c11: s * c11, c02: s * c02 }
            }
            Self::Ogden { terms } => {
                Self::Ogden { terms: terms.iter().map(|term| OgdenTerm { mu: s * term.mu, ..*term }).collect() }
            }
            Self::Gent { shear_modulus, jm } => Self::Gent { shear_modulus: s * shear_modulus, jm: *jm },
        }
    }

    /// Constants that are single numbers by their keys, MPa (J_m without unit); none for Ogden's lists.
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
            Self::Gent { shear_modulus, jm } => vec![("shear_modulus", shear_modulus), ("jm", jm)],
        }
    }
}

/// Whether a shear modulus at rest is one of a material, MPa.
fn is_modulus(shear_modulus: f64) -> bool {
    let [least, most] = Quantity::Stress.range();
    (least..=2.0 * most).contains(&shear_modulus)
}

fn check_ogden(terms: &[OgdenTerm], key: &impl Fn(&str) -> String, found: &mut Problems) {
    let (mu, alpha): (Vec<f64>, Vec<f64>) = terms.iter().map(|term| (term.mu, term.alpha)).unzip();
    if terms.is_empty() || terms.len() > 3 {
        found.add(&key("mu"), &mu, "must be a list of 1 to 3 numbers, MPa");
    }
    let shear_modulus: f64 = mu.iter().sum();
    let are_stresses = mu.iter().all(|&mu| Quantity::Stress.allows(mu));
    if !(mu.is_empty() || (are_stresses && is_modulus(shear_modulus))) {
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

/// Names of laws in case files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Law", rename_all = "kebab-case")]
enum LawName {
    #[default]
    Yeoh,
    NeoHooke,
    MooneyRivlin,
    Polynomial,
    Ogden,
    Gent,
}

impl LawName {
    const ALL: [Self; 6] = [Self::Yeoh, Self::NeoHooke, Self::MooneyRivlin, Self::Polynomial, Self::Ogden, Self::Gent];

    fn of(law: &Law) -> Self {
        match *law {
            Law::Yeoh { .. } => Self::Yeoh,
            Law::NeoHooke { .. } => Self::NeoHooke,
            Law::Polynomial { c20, c11, c02, .. } if [c20, c11, c02] == [0.0; 3] => Self::MooneyRivlin,
            Law::Polynomial { .. } => Self::Polynomial,
            Law::Ogden { .. } => Self::Ogden,
            Law::Gent { .. } => Self::Gent,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Yeoh => "yeoh",
            Self::NeoHooke => "neo-hooke",
            Self::MooneyRivlin => "mooney-rivlin",
            Self::Polynomial => "polynomial",
            Self::Ogden => "ogden",
            Self::Gent => "gent",
        }
    }

    /// Keys of its constants.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Yeoh => &["c10", "c20", "c30"],
            Self::NeoHooke => &["c10"],
            Self::MooneyRivlin => &["c10", "c01"],
            Self::Polynomial => &["c10", "c01", "c20", "c11", "c02"],
            Self::Ogden => &["mu", "alpha"],
            Self::Gent => &["shear_modulus", "jm"],
        }
    }
}

/// The `[material]` table as it is written: flat, with the constants of one law.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(rename = "Material", deny_unknown_fields, default)]
pub(crate) struct Table {
    law: LawName,
    #[serde(skip_serializing_if = "Option::is_none")]
    c10: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    c20: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    c30: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    c01: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    c11: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    c02: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mu: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shear_modulus: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    jm: Option<f64>,
    pub(crate) bulk_modulus: Option<f64>,
    pub(crate) invariant: Option<Invariant>,
    pub(crate) volumetric: Volumetric,
    pub(crate) density: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fitted_to: Option<FittedTo>,
}

/// A constant of another law, or one that is missing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConstantError {
    /// A constant of one law beside the name of another.
    #[error("misplaced field `{key}`: a constant of {owners}; the constants of {law} are {}", keys.join(", "))]
    Misplaced {
        /// Its key.
        key: &'static str,
        /// Laws that have it.
        owners: String,
        /// The law that is named.
        law: &'static str,
        /// Constants of that law.
        keys: &'static [&'static str],
    },
    /// A constant without a default.
    #[error("missing field `{0}`")]
    Missing(&'static str),
}

impl Table {
    /// The law that the table names, with its constants.
    pub(crate) fn law(&self) -> Result<Law, ConstantError> {
        self.check_keys()?;
        let needed = |key, value: Option<f64>| value.ok_or(ConstantError::Missing(key));
        let number = |value: Option<f64>| value.unwrap_or(0.0);
        Ok(match self.law {
            LawName::Yeoh => Law::Yeoh {
                c10: self.c10.unwrap_or(PAPER[0]),
                c20: self.c20.unwrap_or(PAPER[1]),
                c30: self.c30.unwrap_or(PAPER[2]),
            },
            LawName::NeoHooke => Law::NeoHooke { c10: needed("c10", self.c10)? },
            LawName::MooneyRivlin | LawName::Polynomial => Law::Polynomial {
                c10: needed("c10", self.c10)?,
                c01: needed("c01", self.c01)?,
                c20: number(self.c20),
                c11: number(self.c11),
                c02: number(self.c02),
            },
            LawName::Gent => {
                Law::Gent { shear_modulus: needed("shear_modulus", self.shear_modulus)?, jm: needed("jm", self.jm)? }
            }
            LawName::Ogden => {
                let [mu, alpha] = [("mu", &self.mu), ("alpha", &self.alpha)]
                    .map(|(key, list)| list.as_deref().ok_or(ConstantError::Missing(key)));
                let (mu, alpha) = (mu?, alpha?);
                // What one of the lists lacks is no number, which the range check complains about.
                let at = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(f64::NAN);
                let term = |i| OgdenTerm { mu: at(mu, i), alpha: at(alpha, i) };
                Law::Ogden { terms: (0..mu.len().max(alpha.len())).map(term).collect() }
            }
        })
    }

    /// The constants of a law, and nothing else.
    pub(crate) fn of_law(law: &Law) -> Self {
        let constants = law.constants();
        let constant = |key: &str| constants.iter().find(|(name, _)| *name == key).map(|(_, value)| *value);
        let lists = match law {
            Law::Ogden { terms } => Some(terms.iter().map(|term| (term.mu, term.alpha)).unzip()),
            _ => None,
        };
        let (mu, alpha) = lists.unzip();
        Self {
            law: LawName::of(law),
            c10: constant("c10"),
            c20: constant("c20"),
            c30: constant("c30"),
            c01: constant("c01"),
            c11: constant("c11"),
            c02: constant("c02"),
            mu,
            alpha,
            shear_modulus: constant("shear_modulus"),
            jm: constant("jm"),
            ..Self::default()
        }
    }

    fn check_keys(&self) -> Result<(), ConstantError> {
        let written = [
            ("c10", self.c10.is_some()),
            ("c20", self.c20.is_some()),
            ("c30", self.c30.is_some()),
            ("c01", self.c01.is_some()),
            ("c11", self.c11.is_some()),
            ("c02", self.c02.is_some()),
            ("mu", self.mu.is_some()),
            ("alpha", self.alpha.is_some()),
            ("shear_modulus", self.shear_modulus.is_some()),
            ("jm", self.jm.is_some()),
        ];
        let keys = self.law.keys();
        let Some((key, _)) = written.into_iter().find(|(key, is_written)| *is_written && !keys.contains(key)) else {
            return Ok(());
        };
        let owners: Vec<&str> =
            LawName::ALL.into_iter().filter(|law| law.keys().contains(&key)).map(LawName::text).collect();
        Err(ConstantError::Misplaced { key, owners: owners.join(", "), law: self.law.text(), keys })
    }
}
