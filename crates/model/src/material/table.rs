//! The `[material]` table as it is written: flat, with the constants of one law.

use serde::{Deserialize, Serialize};

use super::{Invariant, Law, Material, OgdenTerm, PAPER, Volumetric};

/// Names of laws in case files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Law", rename_all = "kebab-case")]
pub enum LawName {
    #[default]
    Yeoh,
    NeoHooke,
    MooneyRivlin,
    Polynomial,
    Ogden,
}

impl LawName {
    const ALL: [Self; 5] = [Self::Yeoh, Self::NeoHooke, Self::MooneyRivlin, Self::Polynomial, Self::Ogden];

    pub fn of(law: &Law) -> Self {
        match *law {
            Law::Yeoh { .. } => Self::Yeoh,
            Law::NeoHooke { .. } => Self::NeoHooke,
            Law::Polynomial { c20, c11, c02, .. } if [c20, c11, c02] == [0.0; 3] => Self::MooneyRivlin,
            Law::Polynomial { .. } => Self::Polynomial,
            Law::Ogden { .. } => Self::Ogden,
        }
    }

    pub fn text(self) -> &'static str {
        match self {
            Self::Yeoh => "yeoh",
            Self::NeoHooke => "neo-hooke",
            Self::MooneyRivlin => "mooney-rivlin",
            Self::Polynomial => "polynomial",
            Self::Ogden => "ogden",
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
        }
    }
}

/// The table as it is written.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(rename = "Material", deny_unknown_fields, default)]
pub struct Table {
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
    bulk_modulus: Option<f64>,
    invariant: Option<Invariant>,
    volumetric: Volumetric,
    density: f64,
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

impl TryFrom<Table> for Material {
    type Error = ConstantError;

    fn try_from(table: Table) -> Result<Self, ConstantError> {
        table.check_keys()?;
        let needed = |key, value: Option<f64>| value.ok_or(ConstantError::Missing(key));
        let number = |value: Option<f64>| value.unwrap_or(0.0);
        let law = match table.law {
            LawName::Yeoh => Law::Yeoh {
                c10: table.c10.unwrap_or(PAPER[0]),
                c20: table.c20.unwrap_or(PAPER[1]),
                c30: table.c30.unwrap_or(PAPER[2]),
            },
            LawName::NeoHooke => Law::NeoHooke { c10: needed("c10", table.c10)? },
            LawName::MooneyRivlin | LawName::Polynomial => Law::Polynomial {
                c10: needed("c10", table.c10)?,
                c01: needed("c01", table.c01)?,
                c20: number(table.c20),
                c11: number(table.c11),
                c02: number(table.c02),
            },
            LawName::Ogden => {
                let mu = table.mu.ok_or(ConstantError::Missing("mu"))?;
                let alpha = table.alpha.ok_or(ConstantError::Missing("alpha"))?;
                // What one of the lists lacks is no number, which the range check complains about.
                let at = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(f64::NAN);
                let term = |i| OgdenTerm { mu: at(&mu, i), alpha: at(&alpha, i) };
                Law::Ogden { terms: (0..mu.len().max(alpha.len())).map(term).collect() }
            }
        };
        let default = Self::from(law);
        Ok(Self {
            bulk_modulus: table.bulk_modulus.unwrap_or(default.bulk_modulus),
            volumetric: table.volumetric,
            invariant: table.invariant.unwrap_or(default.invariant),
            density: table.density,
            ..default
        })
    }
}

impl Table {
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

impl From<Material> for Table {
    fn from(material: Material) -> Self {
        let Material { law, bulk_modulus, volumetric, invariant, density } = material;
        let constants = law.constants();
        let constant = |key: &str| constants.iter().find(|(name, _)| *name == key).map(|(_, value)| *value);
        let (mu, alpha) = match &law {
            Law::Ogden { terms } => {
                let (mu, alpha) = terms.iter().map(|term| (term.mu, term.alpha)).unzip();
                (Some(mu), Some(alpha))
            }
            _ => (None, None),
        };
        Self {
            law: LawName::of(&law),
            c10: constant("c10"),
            c20: constant("c20"),
            c30: constant("c30"),
            c01: constant("c01"),
            c11: constant("c11"),
            c02: constant("c02"),
            mu,
            alpha,
            bulk_modulus: Some(bulk_modulus),
            invariant: Some(invariant),
            volumetric,
            density,
        }
    }
}
