//! Incompressible hyperelastic laws in the three tests that are homogeneous.
//!
//! With the principal stretches λ₁, λ₂, λ₃ = 1/(λ₁λ₂) and a free face normal to the third axis, the nominal stress along the
//! load is (e.g. Ogden 1984, §7.2)
//!
//! ```text
//! uniaxial     λ, λ^(−½), λ^(−½)   P = 2 (λ − λ⁻²) (W₁ + W₂ / λ)
//! equibiaxial  λ, λ, λ⁻²           P = 2 (λ − λ⁻⁵) (W₁ + λ² W₂)
//! planar       λ, 1, λ⁻¹           P = 2 (λ − λ⁻³) (W₁ + W₂)
//! ```
//!
//! with Wᵢ = ∂W/∂Iᵢ. All laws here are linear in their moduli, with parameters of their shape given: Ogden's exponents, Gent's J_m.

pub use pneuflex_model::Mode;

/// What 2 W₁ and 2 W₂ are multiplied by in the nominal stress.
pub fn stress_factors(mode: Mode, stretch: f64) -> [f64; 2] {
    let e = stretch - 1.0;
    match mode {
        Mode::Uniaxial => {
            let factor = e * (stretch * (stretch + 1.0) + 1.0) / (stretch * stretch);
            [factor, factor / stretch]
        }
        Mode::Equibiaxial => {
            let sum = 1.0 + stretch * (1.0 + stretch * (1.0 + stretch * (1.0 + stretch * (1.0 + stretch))));
            let factor = e * sum / stretch.powi(5);
            [factor, factor * stretch * stretch]
        }
        Mode::Planar => {
            let factor = e * (stretch + 1.0) * (stretch * stretch + 1.0) / stretch.powi(3);
            [factor, factor]
        }
    }
}

/// Nominal stress of 2/α² (λ₁^α + λ₂^α + λ₃^α − 3): its derivative by the stretch, over the axes that are loaded.
pub fn power_stress(mode: Mode, stretch: f64, alpha: f64) -> f64 {
    // λ^a − λ^b = 2 λ^((a + b)/2) sinh((a − b)/2 ln λ) keeps its digits near rest.
    let difference = |a: f64, b: f64| 2.0 * stretch.powf(0.5 * (a + b)) * (0.5 * (a - b) * stretch.ln()).sinh();
    let across = match mode {
        Mode::Uniaxial => -0.5 * alpha,
        Mode::Equibiaxial => -2.0 * alpha,
        Mode::Planar => -alpha,
    };
    2.0 / alpha * difference(alpha - 1.0, across - 1.0)
}

/// Most terms of Ogden's law.
pub const MOST_TERMS: usize = 3;

/// Exponents α of Ogden's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponents {
    exponents: [f64; MOST_TERMS],
    terms: usize,
}

impl Exponents {
    /// Of up to [`MOST_TERMS`] terms, none of them 0; further ones are left out.
    pub fn new(exponents: &[f64]) -> Self {
        let terms = exponents.len().min(MOST_TERMS);
        let mut all = [0.0; MOST_TERMS];
        all[..terms].copy_from_slice(&exponents[..terms]);
        Self { exponents: all, terms }
    }

    /// The same in thousandths.
    pub fn of_thousandths(thousandths: &[i32]) -> Self {
        Self::new(&thousandths.iter().map(|a| 1e-3 * f64::from(*a)).collect::<Vec<_>>())
    }

    /// The exponents.
    pub fn values(self) -> Vec<f64> {
        self.exponents[..self.terms].to_vec()
    }
}

/// A kind of law, as users choose it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// See [`Law::Yeoh`].
    Yeoh,
    /// See [`Law::NeoHookean`].
    NeoHookean,
    /// See [`Law::MooneyRivlin`].
    MooneyRivlin,
    /// See [`Law::Ogden`]; its exponents are fitted.
    Ogden,
    /// See [`Law::Gent`]; its J_m is fitted.
    Gent,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Yeoh, Self::NeoHookean, Self::MooneyRivlin, Self::Ogden, Self::Gent];

    /// Name in texts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Yeoh => "Yeoh",
            Self::NeoHookean => "neo-Hookean",
            Self::MooneyRivlin => "Mooney-Rivlin",
            Self::Ogden => "Ogden",
            Self::Gent => "Gent",
        }
    }

    /// Name in case files and options.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Yeoh => "yeoh",
            Self::NeoHookean => "neo-hooke",
            Self::MooneyRivlin => "mooney-rivlin",
            Self::Ogden => "ogden",
            Self::Gent => "gent",
        }
    }
}

/// A law as users choose it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Its kind.
    pub family: Family,
    /// Its terms, for Yeoh 2 or 3, for Ogden 1 to 3; `None` for Yeoh's three, and for as many of Ogden's as are worth it.
    pub terms: Option<usize>,
}

impl From<Family> for Choice {
    fn from(family: Family) -> Self {
        Self { family, terms: None }
    }
}

impl Choice {
    /// All laws of a given number of constants, those with few first.
    pub const ALL: [Self; 8] = [
        Self { family: Family::NeoHookean, terms: None },
        Self { family: Family::Yeoh, terms: Some(2) },
        Self { family: Family::MooneyRivlin, terms: None },
        Self { family: Family::Gent, terms: None },
        Self { family: Family::Ogden, terms: Some(1) },
        Self { family: Family::Yeoh, terms: Some(3) },
        Self { family: Family::Ogden, terms: Some(2) },
        Self { family: Family::Ogden, terms: Some(3) },
    ];

    /// Whether its family has laws of so many terms.
    pub fn is_possible(self) -> bool {
        match (self.family, self.terms) {
            (_, None) => true,
            (Family::Yeoh, Some(terms)) => (2..=3).contains(&terms),
            (Family::Ogden, Some(terms)) => (1..=MOST_TERMS).contains(&terms),
            _ => false,
        }
    }

    /// Name in texts.
    pub fn name(self) -> String {
        match (self.family, self.terms) {
            (Family::Yeoh, Some(3)) | (_, None) => self.family.name().to_owned(),
            (family, Some(terms)) => format!("{} of {terms} term{}", family.name(), if terms == 1 { "" } else { "s" }),
        }
    }

    /// Options that choose it.
    pub fn options(self) -> String {
        let terms = self.terms.filter(|terms| (self.family, *terms) != (Family::Yeoh, 3));
        format!("--law {}{}", self.family.key(), terms.map_or(String::new(), |terms| format!(" --terms {terms}")))
    }
}

/// A law that is linear in its moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// W = Σ Cᵢ₀ (I₁ − 3)ⁱ, i = 1…3 (Yeoh 1993).
    Yeoh,
    /// The same with i = 1, 2.
    YeohOfTwoTerms,
    /// W = C₁₀ (I₁ − 3).
    NeoHookean,
    /// W = C₁₀ (I₁ − 3) + C₀₁ (I₂ − 3).
    MooneyRivlin,
    /// W = Σ 2 μᵢ/αᵢ² (λ₁^αᵢ + λ₂^αᵢ + λ₃^αᵢ − 3) (Ogden 1972), with these exponents.
    Ogden(Exponents),
    /// W = −½ μ J_m ln(1 − (I₁ − 3)/J_m) (Gent 1996), with this J_m.
    Gent(f64),
}

impl serde::Serialize for Law {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match self {
            Self::Yeoh => "yeoh",
            Self::YeohOfTwoTerms => "yeoh-2",
            Self::Gent(_) => "gent",
            Self::NeoHookean => "neo-hookean",
            Self::MooneyRivlin => "mooney-rivlin",
            Self::Ogden(_) => "ogden",
        })
    }
}

impl Law {
    /// Its kind.
    pub const fn family(self) -> Family {
        match self {
            Self::Yeoh | Self::YeohOfTwoTerms => Family::Yeoh,
            Self::Gent(_) => Family::Gent,
            Self::NeoHookean => Family::NeoHookean,
            Self::MooneyRivlin => Family::MooneyRivlin,
            Self::Ogden(_) => Family::Ogden,
        }
    }

    /// Its exponents; none of other laws than Ogden's.
    pub fn exponents(self) -> Vec<f64> {
        match self {
            Self::Ogden(exponents) => exponents.values(),
            _ => Vec::new(),
        }
    }

    /// Parameters that it is not linear in, none of them in MPa, with their names.
    pub fn shape(self) -> Vec<(&'static str, f64)> {
        const EXPONENTS: [&str; MOST_TERMS] = ["alpha1", "alpha2", "alpha3"];
        match self {
            Self::Ogden(exponents) => EXPONENTS.into_iter().zip(exponents.values()).collect(),
            Self::Gent(jm) => vec![("Jm", jm)],
            _ => Vec::new(),
        }
    }

    /// Name in texts.
    pub fn name(self) -> String {
        let terms = match self {
            Self::YeohOfTwoTerms => Some(2),
            Self::Ogden(exponents) => Some(exponents.terms),
            _ => None,
        };
        Choice { family: self.family(), terms }.name()
    }

    /// Names of the moduli; all are in MPa.
    pub fn constants(self) -> &'static [&'static str] {
        const MODULI: [&str; MOST_TERMS] = ["mu1", "mu2", "mu3"];
        match self {
            Self::Ogden(exponents) => &MODULI[..exponents.terms],
            Self::Yeoh => &["C10", "C20", "C30"],
            Self::YeohOfTwoTerms => &["C10", "C20"],
            Self::Gent(_) => &["mu"],
            Self::NeoHookean => &["C10"],
            Self::MooneyRivlin => &["C10", "C01"],
        }
    }

    /// Nominal stress per unit of each modulus; infinite where the law has no such state.
    pub fn stress_basis(self, mode: Mode, stretch: f64) -> Vec<f64> {
        let [by_w1, by_w2] = stress_factors(mode, stretch).map(|f| 2.0 * f);
        match self {
            Self::Yeoh => {
                let x = mode.i1_minus_3(stretch);
                vec![by_w1, by_w1 * 2.0 * x, by_w1 * 3.0 * x * x]
            }
            Self::YeohOfTwoTerms => vec![by_w1, by_w1 * 2.0 * mode.i1_minus_3(stretch)],
            Self::Gent(jm) => {
                let left = 1.0 - mode.i1_minus_3(stretch) / jm;
                vec![if left > 0.0 { 0.5 * by_w1 / left } else { f64::INFINITY }]
            }
            Self::NeoHookean => vec![by_w1],
            Self::MooneyRivlin => vec![by_w1, by_w2],
            Self::Ogden(exponents) => exponents.values().into_iter().map(|a| power_stress(mode, stretch, a)).collect(),
        }
    }

    /// Derivatives of the nominal stress by the parameters of [`Law::shape`], MPa.
    pub fn stress_by_shape(self, constants: &[f64], mode: Mode, stretch: f64) -> Vec<f64> {
        match self {
            Self::Ogden(exponents) => {
                let slope = |(alpha, mu): (f64, &f64)| {
                    let h = 1e-4 * alpha.abs();
                    mu * (power_stress(mode, stretch, alpha + h) - power_stress(mode, stretch, alpha - h)) / (2.0 * h)
                };
                exponents.values().into_iter().zip(constants).map(slope).collect()
            }
            // P = μ f/(1 − x/J_m), f the factor of W₁.
            Self::Gent(jm) => {
                let x = mode.i1_minus_3(stretch);
                vec![-self.stress(constants, mode, stretch) * x / (jm * (jm - x))]
            }
            _ => Vec::new(),
        }
    }

    /// Nominal stress, MPa.
    pub fn stress(self, constants: &[f64], mode: Mode, stretch: f64) -> f64 {
        self.stress_basis(mode, stretch).iter().zip(constants).map(|(b, c)| b * c).sum()
    }

    /// The solver's law with these constants; those that are missing are 0.
    pub fn with_constants(self, constants: &[f64]) -> pneuflex_model::Law {
        let get = |i: usize| constants.get(i).copied().unwrap_or(0.0);
        match self {
            Self::Gent(jm) => pneuflex_model::Law::Gent { shear_modulus: get(0), jm },
            Self::Yeoh | Self::YeohOfTwoTerms => pneuflex_model::Law::Yeoh { c10: get(0), c20: get(1), c30: get(2) },
            Self::NeoHookean => pneuflex_model::Law::NeoHooke { c10: get(0) },
            Self::MooneyRivlin => {
                pneuflex_model::Law::Polynomial { c10: get(0), c01: get(1), c20: 0.0, c11: 0.0, c02: 0.0 }
            }
            Self::Ogden(exponents) => pneuflex_model::Law::Ogden {
                terms: exponents
                    .values()
                    .into_iter()
                    .enumerate()
                    .map(|(i, alpha)| pneuflex_model::OgdenTerm { mu: get(i), alpha })
                    .collect(),
            },
        }
    }

    /// Initial shear modulus μ = 2 (C₁₀ + C₀₁), or the sum of the moduli of Ogden and Gent, MPa.
    pub fn shear_modulus(self, constants: &[f64]) -> f64 {
        match self {
            Self::MooneyRivlin => 2.0 * constants.iter().sum::<f64>(),
            Self::Ogden(_) | Self::Gent(_) => constants.iter().sum(),
            _ => 2.0 * constants[0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_and_invariants_are_those_of_the_stretches() {
        for mode in Mode::ALL {
            for stretch in [0.4, 0.9, 1.3, 2.0, 5.0] {
                let squares = mode.stretches(stretch).map(|l| l * l);
                let i1: f64 = squares.iter().sum();
                assert!((mode.i1_minus_3(stretch) - (i1 - 3.0)).abs() < 1e-12 * i1);
                // P₁ = σ₁/λ₁ with σ₁ = 2 (λ₁² − λ₃²) W₁ − 2 (λ₁⁻² − λ₃⁻²) W₂.
                let [a, b] = stress_factors(mode, stretch);
                assert!((a - (squares[0] - squares[2]) / stretch).abs() < 1e-12 * a.abs());
                assert!((b + (1.0 / squares[0] - 1.0 / squares[2]) / stretch).abs() < 1e-12 * b.abs(), "{mode:?}");
            }
        }
    }

    #[test]
    fn ogdens_stress_is_the_derivative_of_its_energy() {
        for mode in Mode::ALL {
            let axes = if mode == Mode::Equibiaxial { 2.0 } else { 1.0 };
            for alpha in [-3.0, 0.7, 2.0, 9.5] {
                let energy = |l: f64| {
                    2.0 / (alpha * alpha) * (mode.stretches(l).map(|x| x.powf(alpha)).iter().sum::<f64>() - 3.0)
                };
                for stretch in [0.6, 1.0, 1.4, 3.0] {
                    let h = 1e-5;
                    let expected = (energy(stretch + h) - energy(stretch - h)) / (2.0 * h * axes);
                    let found = power_stress(mode, stretch, alpha);
                    assert!((found - expected).abs() < 1e-7 * found.abs().max(1.0), "{mode:?} {alpha} {stretch}");
                }
            }
            // α = 2 is neo-Hookean, μ = 2 C₁₀.
            let neo = Law::NeoHookean.stress(&[0.5], mode, 1.7);
            assert!((Law::Ogden(Exponents::of_thousandths(&[2000])).stress(&[1.0], mode, 1.7) - neo).abs() < 1e-14);
        }
    }

    #[test]
    fn small_strains_keep_their_digits() {
        let strain = 1e-9;
        for (mode, factor, invariant) in
            [(Mode::Uniaxial, 3.0, 3.0), (Mode::Equibiaxial, 6.0, 12.0), (Mode::Planar, 4.0, 4.0)]
        {
            // 1 + 1e-9 is not 1e-9 away from 1 exactly.
            let e = (1.0 + strain) - 1.0;
            assert!((stress_factors(mode, 1.0 + strain)[0] / (factor * e) - 1.0).abs() < 1e-8);
            assert!((mode.i1_minus_3(1.0 + strain) / (invariant * e * e) - 1.0).abs() < 1e-8);
        }
    }
}
