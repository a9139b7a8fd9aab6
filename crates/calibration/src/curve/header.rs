//! What the names of columns mean.

use super::unit::{StrainMeasure, StressMeasure, StressUnit};
use crate::law::Mode;
use crate::test_name;
use crate::words::words_of;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Stretch or strain.
    Strain(StrainMeasure),
    /// Stress; `None` if the name does not say of which kind.
    Stress(Option<StressMeasure>),
    /// The kind of test.
    Test,
    /// A principal stretch besides the first, by its number (2 or 3).
    OtherStretch(usize),
    /// Force, N per unit of the column.
    Force(f64),
    /// Change of length, mm per unit of the column.
    Displacement(f64),
}

/// A column by its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    /// Name as it stands in the file.
    pub name: String,
    /// What it holds; `None` if that is not known.
    pub quantity: Option<Quantity>,
    /// The test it belongs to, in wide tables.
    pub mode: Option<Mode>,
    /// Unit of a stress.
    pub unit: Option<StressUnit>,
    /// Whether a strain is said to be a pure number.
    pub is_pure_number: bool,
}

/// Names of columns, and where the rows below them begin.
#[derive(Clone)]
pub struct Header {
    /// Names of the columns.
    pub headings: Vec<Heading>,
    /// Line of the last of them, from 1.
    pub line: usize,
}

impl Heading {
    /// Understands a name.
    pub fn new(name: &str) -> Self {
        let words = words_of(name);
        let joined = words.concat();
        let has = |parts: &[&str]| parts.iter().any(|p| joined.contains(p));
        let is = |names: &[&str]| words.iter().any(|w| names.contains(&w.as_str()));
        let unit = StressUnit::find(name);
        let mode = test_name::find(name);
        // Columns beside the curve whose names hold the same words.
        let is_other = has(&["rate", "transverse", "lateral", "offset", "energy", "standarddeviation", "strength"]);
        let quantity = if is_other {
            None
        } else if is(&["f22", "f33"]) {
            Some(Quantity::OtherStretch(if is(&["f22"]) { 2 } else { 3 }))
        } else if has(&["stress", "spannung"]) || is(&["σ", "sigma", "p11", "s11", "pk1", "p1"]) {
            let is_nominal =
                has(&["eng", "nominal", "piola", "1stpk", "technisch", "nenn"]) || is(&["p11", "s11", "pk1"]);
            let is_true = has(&["true", "cauchy", "wahre"]);
            Some(Quantity::Stress(match (is_nominal, is_true) {
                (true, false) => Some(StressMeasure::Nominal),
                (false, true) => Some(StressMeasure::True),
                _ => None,
            }))
        } else if has(&["stretch", "lambda", "extensionratio"]) || is(&["λ", "λ1", "f11"]) {
            Some(Quantity::Strain(StrainMeasure::Stretch))
        } else if let Some(newtons) = force_unit(&words).filter(|_| has(&["force", "load", "kraft"]) && !has(&["cell"]))
        {
            Some(Quantity::Force(newtons))
        } else if let Some(millimetres) = length_unit(&words) {
            // By its unit; a strain would be in mm/mm.
            let names =
                ["position", "displacement", "extension", "elongation", "strain", "crosshead", "stroke", "travel"];
            let german = ["weg", "verlängerung", "dehnung"];
            (has(&names) || has(&german)).then_some(Quantity::Displacement(millimetres))
        } else if has(&["strain", "dehnung", "elongation"]) || is(&["ε", "eps", "epsilon"]) {
            let measure = if has(&["true", "log", "hencky", "wahre"]) {
                StrainMeasure::True
            } else if is(&["%", "percent", "pct", "prozent"]) {
                StrainMeasure::Percent
            } else {
                StrainMeasure::Engineering
            };
            Some(Quantity::Strain(measure))
        } else if mode.is_none()
            && words.len() <= 3
            && is(&["test", "mode", "type", "loading", "experiment", "versuch"])
        {
            Some(Quantity::Test)
        } else if mode.is_some() && (unit.is_some() || words.len() <= 2) {
            // A column that is named like a test and nothing else holds its stress.
            Some(Quantity::Stress(None))
        } else {
            None
        };
        let is_pure_number =
            ["(-)", "[-]", "(1)", "[1]", "mm/mm", "m/m", "in/in"].iter().any(|unit| name.contains(unit))
                || name.trim_end().ends_with(" -")
                || name.trim_end().ends_with(" 1");
        Self { name: name.trim().to_owned(), quantity, mode, unit, is_pure_number }
    }

    /// Whether this is stretch or strain.
    pub fn is_strain(&self) -> bool {
        matches!(self.quantity, Some(Quantity::Strain(_)))
    }

    /// Whether this is a stress.
    pub fn is_stress(&self) -> bool {
        matches!(self.quantity, Some(Quantity::Stress(_)))
    }
}

/// N per unit of force among words.
fn force_unit(words: &[String]) -> Option<f64> {
    words.iter().find_map(|word| match word.as_str() {
        "n" | "newton" => Some(1.0),
        "kn" => Some(1e3),
        "mn" => Some(1e-3),
        "kgf" | "kp" => Some(9.806_65),
        "lbf" => Some(4.448_221_615_260_5),
        _ => None,
    })
}

/// mm per unit of length among words, of which there is one.
fn length_unit(words: &[String]) -> Option<f64> {
    let mut found = words.iter().filter_map(|word| match word.as_str() {
        "mm" => Some(1.0),
        "cm" => Some(10.0),
        "m" => Some(1e3),
        "inch" => Some(25.4),
        _ => None,
    });
    found.next().filter(|_| found.next().is_none())
}

/// Whether a cell of the line under the header is the unit of its column.
pub fn is_unit(cell: &str) -> bool {
    let bare = cell.trim().trim_matches(['(', ')', '[', ']']);
    StressUnit::find(bare).is_some()
        || ["", "-", "1", "%", "s", "sec", "min", "mm", "mm/mm", "m/m", "n", "kn", "°c"]
            .contains(&&*bare.to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;
    use Quantity::{Strain, Stress};

    #[test]
    fn names_of_real_files_are_understood() {
        let of = |name: &str| Heading::new(name).quantity;
        assert_eq!(of("True Strain"), Some(Strain(StrainMeasure::True)));
        assert_eq!(of("Engineering Strain"), Some(Strain(StrainMeasure::Engineering)));
        assert_eq!(of("Dehnung [%]"), Some(Strain(StrainMeasure::Percent)));
        assert_eq!(of("F11"), Some(Strain(StrainMeasure::Stretch)));
        assert_eq!(of("True Stress (MPa)"), Some(Stress(Some(StressMeasure::True))));
        assert_eq!(of("Engineering Stress (MPa)"), Some(Stress(Some(StressMeasure::Nominal))));
        assert_eq!(of("stress_kgf_cm2"), Some(Stress(None)));
        assert_eq!(of("Standardspannung"), Some(Stress(None)));
        assert_eq!(of("mode"), Some(Quantity::Test));
        assert_eq!(of("F22"), Some(Quantity::OtherStretch(2)));
        assert_eq!(of("Load (N)"), Some(Quantity::Force(1.0)));
        assert_eq!(of("Standardkraft [kN]"), Some(Quantity::Force(1e3)));
        assert_eq!(of("Position (mm)"), Some(Quantity::Displacement(1.0)));
        assert_eq!(of("Strain (mm)"), Some(Quantity::Displacement(1.0)));
        assert_eq!(of("Strain (mm/mm)"), Some(Strain(StrainMeasure::Engineering)));
        assert!(Heading::new("Strain (mm/mm)").is_pure_number && !Heading::new("Strain").is_pure_number);
        for other in ["Time (s)", "Load Cell (kN)", "Thickness (mm)", "Strain rate (1/s)", "URL", "S22", ""] {
            assert_eq!(of(other), None, "{other}");
        }
        let wide = Heading::new("pure shear stress (kPa)");
        assert_eq!(
            (wide.quantity, wide.mode, wide.unit),
            (Some(Stress(None)), Some(Mode::Planar), Some(StressUnit::Kilopascal))
        );
        assert_eq!(of("equibiaxial"), Some(Stress(None)));
    }
}
