//! The homogeneous tests of materials, and how far constants were measured in each.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A homogeneous test of an incompressible specimen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
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

    /// The test whose deformation is most like that of principal stretches λ₁ ≥ λ₂ ≥ λ₃ (in any order): by the place of ln λ₂ between the
    /// other two, 1 (equibiaxial) to −1 (uniaxial). Compression along one axis is tension along two others.
    pub fn nearest(stretches: [f64; 3]) -> Self {
        let mut logarithms = stretches.map(f64::ln);
        logarithms.sort_by(f64::total_cmp);
        let [least, middle, most] = logarithms;
        let place = 2.0 * middle - least - most;
        let half = 0.5 * (most - least);
        match place {
            place if place > half => Self::Equibiaxial,
            place if place < -half => Self::Uniaxial,
            _ => Self::Planar,
        }
    }

    /// The principal stretches at a stretch λ > 0 along the load; the last face is free.
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

/// Largest stretches of the tests that constants were fitted to. In a file it is a number, that of a uniaxial test, or a table of tests.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FittedTo {
    /// By the number of the test in [`Mode::ALL`].
    stretches: [Option<f64>; 3],
}

impl FittedTo {
    /// Of tests and their stretches, the largest of each counts. Compression along one axis is tension along the two others.
    pub fn of(points: impl IntoIterator<Item = (Mode, f64)>) -> Self {
        let mut found = Self::default();
        for (mode, stretch) in points {
            let (mode, stretch) = match mode {
                _ if stretch >= 1.0 => (mode, stretch),
                Mode::Uniaxial => (Mode::Equibiaxial, stretch.powf(-0.5)),
                Mode::Equibiaxial => (Mode::Uniaxial, stretch.powi(-2)),
                Mode::Planar => (Mode::Planar, stretch.recip()),
            };
            let largest = &mut found.stretches[mode as usize];
            *largest = Some(largest.map_or(stretch, |before| before.max(stretch)));
        }
        found
    }

    /// A uniaxial test up to a stretch.
    pub fn uniaxial(stretch: f64) -> Self {
        Self { stretches: [Some(stretch), None, None] }
    }

    /// The tests with their stretches.
    pub fn tests(&self) -> impl Iterator<Item = (Mode, f64)> + '_ {
        Mode::ALL.into_iter().zip(&self.stretches).filter_map(|(mode, stretch)| Some((mode, (*stretch)?)))
    }

    /// I₁ − 3 up to which constants are known in deformations like a test: to its end, or for want of it to the largest value of the others.
    pub fn invariant_minus_3(&self, mode: Mode) -> f64 {
        let own = self.stretches[mode as usize].map(|stretch| mode.i1_minus_3(stretch));
        own.unwrap_or_else(|| self.tests().map(|(mode, stretch)| mode.i1_minus_3(stretch)).fold(0.0, f64::max))
    }

    /// The same with stretches rounded down to thousandths; tests that do not reach the first are left out, `None` without any.
    pub fn rounded(&self) -> Option<Self> {
        let thousandths = |stretch: f64| Some((1e3 * stretch).floor() / 1e3).filter(|rounded| *rounded > 1.0);
        let rounded = Self { stretches: self.stretches.map(|stretch| stretch.and_then(thousandths)) };
        rounded.tests().next().is_some().then_some(rounded)
    }
}

/// As in `uniaxial 3.4, planar 2.1`.
impl fmt::Display for FittedTo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tests: Vec<String> = self.tests().map(|(mode, stretch)| format!("{} {stretch}", mode.name())).collect();
        f.write_str(&tests.join(", "))
    }
}

/// The table as it is written.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "FittedTo", deny_unknown_fields)]
struct Table {
    #[serde(skip_serializing_if = "Option::is_none")]
    uniaxial: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    equibiaxial: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    planar: Option<f64>,
}

impl Serialize for FittedTo {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.stretches {
            [Some(uniaxial), None, None] => serializer.serialize_f64(uniaxial),
            [uniaxial, equibiaxial, planar] => Table { uniaxial, equibiaxial, planar }.serialize(serializer),
        }
    }
}

/// Written out because the derived reader of an untagged enum cannot say what it expects.
impl<'de> Deserialize<'de> for FittedTo {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FittedToVisitor;
        impl<'de> Visitor<'de> for FittedToVisitor {
            type Value = FittedTo;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a stretch, or a table of stretches { uniaxial, equibiaxial, planar }")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<FittedTo, E> {
                Ok(FittedTo::uniaxial(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<FittedTo, E> {
                Ok(FittedTo::uniaxial(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<FittedTo, E> {
                Ok(FittedTo::uniaxial(value as f64))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<FittedTo, A::Error> {
                let Table { uniaxial, equibiaxial, planar } = Table::deserialize(MapAccessDeserializer::new(map))?;
                Ok(FittedTo { stretches: [uniaxial, equibiaxial, planar] })
            }
        }
        deserializer.deserialize_any(FittedToVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deformations_are_like_the_test_that_they_are_nearest_to() {
        for mode in Mode::ALL {
            for stretch in [1.01, 1.7, 5.0] {
                let [a, b, c] = mode.stretches(stretch);
                assert_eq!(Mode::nearest([b, c, a]), mode, "{stretch}");
                // Compressed, the first two are each other.
                let opposite = match mode {
                    Mode::Uniaxial => Mode::Equibiaxial,
                    Mode::Equibiaxial => Mode::Uniaxial,
                    Mode::Planar => Mode::Planar,
                };
                assert_eq!(Mode::nearest(mode.stretches(1.0 / stretch)), opposite, "{stretch}");
            }
            assert!((mode.stretch_of(mode.i1_minus_3(3.7)) - 3.7).abs() < 1e-12);
            assert_eq!(mode.stretch_of(0.0), 1.0);
        }
    }

    #[test]
    fn a_mode_that_was_not_tested_is_known_as_far_as_the_others_lead() {
        let known = FittedTo::of([(Mode::Uniaxial, 2.0), (Mode::Uniaxial, 3.0), (Mode::Planar, 1.5)]);
        assert_eq!(known.invariant_minus_3(Mode::Planar), Mode::Planar.i1_minus_3(1.5));
        assert_eq!(known.invariant_minus_3(Mode::Equibiaxial), Mode::Uniaxial.i1_minus_3(3.0));
        // Half the length is 1.414 of the width.
        let pressed = FittedTo::of([(Mode::Uniaxial, 0.5), (Mode::Uniaxial, 1.2)]).rounded();
        assert_eq!(pressed.map(|f| f.to_string()).as_deref(), Some("uniaxial 1.2, equibiaxial 1.414"));
        assert_eq!(FittedTo::of([(Mode::Uniaxial, 1.0002)]).rounded(), None);
    }
}
