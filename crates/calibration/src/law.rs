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
//! with Wᵢ = ∂W/∂Iᵢ. All laws here are linear in their constants, Ogden's with its exponents given.

use crate::words::words_of;

/// A homogeneous test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Tension or compression along one axis.
    Uniaxial,
    /// Equal tension along two axes.
    Equibiaxial,
    /// Tension with the width held, also called pure shear.
    Planar,
}

impl Mode {
    /// All tests; their number is their place here.
    pub const ALL: [Self; 3] = [Self::Uniaxial, Self::Equibiaxial, Self::Planar];

    /// Name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Uniaxial => "uniaxial",
            Self::Equibiaxial => "equibiaxial",
            Self::Planar => "planar",
        }
    }

    /// The test that a text names, by its usual names and abbreviations.
    pub fn find(text: &str) -> Option<Self> {
        let words = words_of(text);
        let joined = words.concat();
        let has = |parts: &[&str]| parts.iter().any(|p| joined.contains(p));
        let is = |names: &[&str]| words.iter().any(|w| names.contains(&w.as_str()));
        let found = [
            has(&["uniaxial", "einachsig"])
                || is(&["ut", "ua", "uni", "tension", "tensile", "compression", "zugversuch", "druckversuch"]),
            has(&["biaxial", "zweiachsig"]) || is(&["et", "eb", "bt", "ebt", "equi"]),
            has(&["planar", "pureshear"]) || is(&["ps"]),
        ];
        // "Planar tension" and "equibiaxial tension" are no uniaxial tests.
        match found {
            [_, true, true] => None,
            [_, true, _] => Some(Self::Equibiaxial),
            [_, _, true] => Some(Self::Planar),
            [true, ..] => Some(Self::Uniaxial),
            _ => None,
        }
    }

    /// The test that a sentence or a name is about, by clear words alone: abbreviations stand in for too much else.
    pub fn find_spelled_out(text: &str) -> Option<Self> {
        let long: Vec<String> = words_of(text).into_iter().filter(|word| word.len() > 3).collect();
        // "Pure shear" and "equi-biaxial" are two words.
        Self::find(&long.join(" "))
    }

    /// The principal stretches at a stretch λ > 0 along the load.
    pub fn stretches(self, stretch: f64) -> [f64; 3] {
        match self {
            Self::Uniaxial => [stretch, stretch.powf(-0.5), stretch.powf(-0.5)],
            Self::Equibiaxial => [stretch, stretch, stretch.powi(-2)],
            Self::Planar => [stretch, 1.0, stretch.recip()],
        }
    }

    /// I₁ − 3, without loss of digits near rest.
    pub fn i1_minus_3(self, stretch: f64) -> f64 {
        let e = stretch - 1.0;
        match self {
            Self::Uniaxial => e * e * (stretch + 2.0) / stretch,
            Self::Equibiaxial => {
                let square = stretch * stretch;
                (e * (stretch + 1.0) / square).powi(2) * (2.0 * square + 1.0)
            }
            Self::Planar => (e * (stretch + 1.0) / stretch).powi(2),
        }
    }

    /// What 2 W₁ and 2 W₂ are multiplied by in the nominal stress.
    pub fn stress_factors(self, stretch: f64) -> [f64; 2] {
        let e = stretch - 1.0;
        match self {
            Self::Uniaxial => {
                let factor = e * (stretch * (stretch + 1.0) + 1.0) / (stretch * stretch);
                [factor, factor / stretch]
            }
            Self::Equibiaxial => {
                let sum = 1.0 + stretch * (1.0 + stretch * (1.0 + stretch * (1.0 + stretch * (1.0 + stretch))));
                let factor = e * sum / stretch.powi(5);
                [factor, factor * stretch * stretch]
            }
            Self::Planar => {
                let factor = e * (stretch + 1.0) * (stretch * stretch + 1.0) / stretch.powi(3);
                [factor, factor]
            }
        }
    }

    /// Nominal stress of 2/α² (λ₁^α + λ₂^α + λ₃^α − 3): its derivative by the stretch, over the axes that are loaded.
    pub fn power_stress(self, stretch: f64, alpha: f64) -> f64 {
        // λ^a − λ^b = 2 λ^((a + b)/2) sinh((a − b)/2 ln λ) keeps its digits near rest.
        let difference = |a: f64, b: f64| 2.0 * stretch.powf(0.5 * (a + b)) * (0.5 * (a - b) * stretch.ln()).sinh();
        let across = match self {
            Self::Uniaxial => -0.5 * alpha,
            Self::Equibiaxial => -2.0 * alpha,
            Self::Planar => -alpha,
        };
        2.0 / alpha * difference(alpha - 1.0, across - 1.0)
    }

    /// The largest stretch with this I₁ − 3 ≥ 0.
    pub fn stretch_of(self, i1_minus_3: f64) -> f64 {
        // I₁ − 3 grows with λ > 1, and is at least (λ − 1)² there in every test.
        let (mut low, mut high) = (1.0, 1.0 + i1_minus_3.max(0.0).sqrt());
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.i1_minus_3(middle) < i1_minus_3 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

/// Most terms of Ogden's law.
pub const MOST_TERMS: usize = 3;

/// Exponents α of Ogden's law, to a thousandth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exponents {
    thousandths: [i32; MOST_TERMS],
    terms: usize,
}

impl Exponents {
    /// Of up to [`MOST_TERMS`] terms, none of them 0, in thousandths; further ones are left out.
    pub fn new(thousandths: &[i32]) -> Self {
        let terms = thousandths.len().min(MOST_TERMS);
        let mut all = [0; MOST_TERMS];
        all[..terms].copy_from_slice(&thousandths[..terms]);
        Self { thousandths: all, terms }
    }

    /// The exponents.
    pub fn values(self) -> Vec<f64> {
        self.thousandths[..self.terms].iter().map(|a| 1e-3 * f64::from(*a)).collect()
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
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Yeoh, Self::NeoHookean, Self::MooneyRivlin, Self::Ogden];

    /// Name in texts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Yeoh => "Yeoh",
            Self::NeoHookean => "neo-Hookean",
            Self::MooneyRivlin => "Mooney-Rivlin",
            Self::Ogden => "Ogden",
        }
    }

    /// Name in case files and options.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Yeoh => "yeoh",
            Self::NeoHookean => "neo-hooke",
            Self::MooneyRivlin => "mooney-rivlin",
            Self::Ogden => "ogden",
        }
    }
}

/// A law that is linear in its constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// W = Σ Cᵢ₀ (I₁ − 3)ⁱ, i = 1…3 (Yeoh 1993).
    Yeoh,
    /// W = C₁₀ (I₁ − 3).
    NeoHookean,
    /// W = C₁₀ (I₁ − 3) + C₀₁ (I₂ − 3).
    MooneyRivlin,
    /// W = Σ 2 μᵢ/αᵢ² (λ₁^αᵢ + λ₂^αᵢ + λ₃^αᵢ − 3) (Ogden 1972), with these exponents.
    Ogden(Exponents),
}

impl serde::Serialize for Law {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match self {
            Self::Yeoh => "yeoh",
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
            Self::Yeoh => Family::Yeoh,
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

    /// Name in texts.
    pub const fn name(self) -> &'static str {
        self.family().name()
    }

    /// Names of the constants; all are in MPa.
    pub fn constants(self) -> &'static [&'static str] {
        const MODULI: [&str; MOST_TERMS] = ["mu1", "mu2", "mu3"];
        match self {
            Self::Ogden(exponents) => &MODULI[..exponents.terms],
            Self::Yeoh => &["C10", "C20", "C30"],
            Self::NeoHookean => &["C10"],
            Self::MooneyRivlin => &["C10", "C01"],
        }
    }

    /// Nominal stress per unit of each constant.
    pub fn stress_basis(self, mode: Mode, stretch: f64) -> Vec<f64> {
        let [by_w1, by_w2] = mode.stress_factors(stretch).map(|f| 2.0 * f);
        match self {
            Self::Yeoh => {
                let x = mode.i1_minus_3(stretch);
                vec![by_w1, by_w1 * 2.0 * x, by_w1 * 3.0 * x * x]
            }
            Self::NeoHookean => vec![by_w1],
            Self::MooneyRivlin => vec![by_w1, by_w2],
            Self::Ogden(exponents) => exponents.values().into_iter().map(|a| mode.power_stress(stretch, a)).collect(),
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
            Self::Yeoh => pneuflex_model::Law::Yeoh { c10: get(0), c20: get(1), c30: get(2) },
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

    /// Initial shear modulus μ = 2 (C₁₀ + C₀₁), or the sum of Ogden's moduli, MPa.
    pub fn shear_modulus(self, constants: &[f64]) -> f64 {
        match self {
            Self::MooneyRivlin => 2.0 * constants.iter().sum::<f64>(),
            Self::Ogden(_) => constants.iter().sum(),
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
                let [a, b] = mode.stress_factors(stretch);
                assert!((a - (squares[0] - squares[2]) / stretch).abs() < 1e-12 * a.abs());
                assert!((b + (1.0 / squares[0] - 1.0 / squares[2]) / stretch).abs() < 1e-12 * b.abs(), "{mode:?}");
            }
            let i1 = mode.i1_minus_3(3.7);
            assert!((mode.stretch_of(i1) - 3.7).abs() < 1e-12);
            assert_eq!(mode.stretch_of(0.0), 1.0);
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
                    let found = mode.power_stress(stretch, alpha);
                    assert!((found - expected).abs() < 1e-7 * found.abs().max(1.0), "{mode:?} {alpha} {stretch}");
                }
            }
            // α = 2 is neo-Hookean, μ = 2 C₁₀.
            let neo = Law::NeoHookean.stress(&[0.5], mode, 1.7);
            assert!((Law::Ogden(Exponents::new(&[2000])).stress(&[1.0], mode, 1.7) - neo).abs() < 1e-14);
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
            assert!((mode.stress_factors(1.0 + strain)[0] / (factor * e) - 1.0).abs() < 1e-8);
            assert!((mode.i1_minus_3(1.0 + strain) / (invariant * e * e) - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn tests_have_many_names() {
        for (text, mode) in [
            ("UT", Some(Mode::Uniaxial)),
            ("uniaxial_stress", Some(Mode::Uniaxial)),
            ("ET", Some(Mode::Equibiaxial)),
            ("Equi-biaxial", Some(Mode::Equibiaxial)),
            ("pure shear", Some(Mode::Planar)),
            ("planar tension", Some(Mode::Planar)),
            ("simple shear", None),
            ("stress", None),
        ] {
            assert_eq!(Mode::find(text), mode, "{text}");
        }
    }
}
