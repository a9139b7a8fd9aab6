//! Units and measures of strain and stress.

use crate::words::words_of;

/// Unit of a stress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StressUnit {
    /// MPa = N/mm².
    Megapascal,
    /// kPa.
    Kilopascal,
    /// Pa.
    Pascal,
    /// GPa.
    Gigapascal,
    /// Pound-force per square inch.
    Psi,
    /// Kilogram-force per square centimetre.
    KilogramForcePerSquareCentimetre,
    /// Newton per square centimetre.
    NewtonPerSquareCentimetre,
}

impl StressUnit {
    /// MPa per unit.
    pub const fn megapascals(self) -> f64 {
        match self {
            Self::Megapascal => 1.0,
            Self::Kilopascal => 1e-3,
            Self::Pascal => 1e-6,
            Self::Gigapascal => 1e3,
            // 0.45359237 kg · 9.80665 m/s² / (25.4 mm)².
            Self::Psi => 0.453_592_37 * 9.806_65 / (25.4 * 25.4),
            Self::KilogramForcePerSquareCentimetre => 0.098_066_5,
            Self::NewtonPerSquareCentimetre => 0.01,
        }
    }

    /// Name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Megapascal => "MPa",
            Self::Kilopascal => "kPa",
            Self::Pascal => "Pa",
            Self::Gigapascal => "GPa",
            Self::Psi => "psi",
            Self::KilogramForcePerSquareCentimetre => "kgf/cm2",
            Self::NewtonPerSquareCentimetre => "N/cm2",
        }
    }

    /// The unit among the words of a text such as `Stress (N/mm²)` or `stress_kPa`.
    pub fn find(text: &str) -> Option<Self> {
        let words = words_of(text);
        let is = |i: usize, what: &str| words.get(i).is_some_and(|w| w == what);
        let per = |i: usize, length: &str| {
            is(i, &format!("{length}2")) || is(i, length) && is(i + 1, "2") || is(i, "sq") && is(i + 1, length)
        };
        (0..words.len()).find_map(|i| match words[i].as_str() {
            "mpa" | "megapascal" | "nmm2" => Some(Self::Megapascal),
            "kpa" | "kilopascal" => Some(Self::Kilopascal),
            "pa" | "pascal" => Some(Self::Pascal),
            "gpa" => Some(Self::Gigapascal),
            "psi" => Some(Self::Psi),
            "n" if per(i + 1, "mm") => Some(Self::Megapascal),
            "mn" if per(i + 1, "m") => Some(Self::Megapascal),
            "kn" if per(i + 1, "m") => Some(Self::Kilopascal),
            "n" if per(i + 1, "m") => Some(Self::Pascal),
            "n" if per(i + 1, "cm") => Some(Self::NewtonPerSquareCentimetre),
            "kgf" | "kp" if per(i + 1, "cm") => Some(Self::KilogramForcePerSquareCentimetre),
            _ => None,
        })
    }
}

/// What a strain column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrainMeasure {
    /// Stretch λ = l / L.
    Stretch,
    /// Engineering strain λ − 1.
    Engineering,
    /// Engineering strain in per cent.
    Percent,
    /// True (logarithmic) strain ln λ.
    True,
}

impl StrainMeasure {
    /// Name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stretch => "stretch",
            Self::Engineering => "engineering strain",
            Self::Percent => "engineering strain in %",
            Self::True => "true strain",
        }
    }

    /// The stretch; not finite or not greater than 0 if the value is out of range.
    pub fn stretch(self, value: f64) -> f64 {
        match self {
            Self::Stretch => value,
            Self::Engineering => 1.0 + value,
            Self::Percent => 1.0 + 0.01 * value,
            Self::True => value.exp(),
        }
    }
}

/// What a stress column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StressMeasure {
    /// Nominal (engineering, first Piola-Kirchhoff) stress: force per undeformed area.
    Nominal,
    /// True (Cauchy) stress: force per deformed area.
    True,
}

impl StressMeasure {
    /// Name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal stress",
            Self::True => "true stress",
        }
    }

    /// The nominal stress at a stretch. The loaded area is 1/λ of the undeformed one in all three tests, as volume is kept.
    pub fn nominal(self, value: f64, stretch: f64) -> f64 {
        match self {
            Self::Nominal => value,
            Self::True => value / stretch,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_in_headers() {
        for (text, unit) in [
            ("Engineering Stress (MPa)", Some(StressUnit::Megapascal)),
            ("stress_kgf_cm2", Some(StressUnit::KilogramForcePerSquareCentimetre)),
            ("Spannung in N/mm²", Some(StressUnit::Megapascal)),
            ("stress [N/mm^2]", Some(StressUnit::Megapascal)),
            ("stress N·mm⁻²", Some(StressUnit::Megapascal)),
            ("P11 [kPa]", Some(StressUnit::Kilopascal)),
            ("stress (psi)", Some(StressUnit::Psi)),
            ("stress / Pa", Some(StressUnit::Pascal)),
            ("stress (N/m2)", Some(StressUnit::Pascal)),
            ("pull (N)", None),
            ("compare", None),
        ] {
            assert_eq!(StressUnit::find(text), unit, "{text}");
        }
        assert!((StressUnit::Psi.megapascals() - 0.006_894_757_293_168).abs() < 1e-15);
    }
}
