//! Fits of material constants to test curves, and known silicones.

use std::path::{Path, PathBuf};

use pneuflex::calibration::bulk::{bulk_modulus, largest_mean_stress};
use pneuflex::calibration::clean::{Cleaning, Cycles, clean};
use pneuflex::calibration::curve::{
    self, ColumnChoice, Curve, DecimalSign, MAX_BYTES, Point, ReadOptions, StrainMeasure, StressMeasure, StressUnit,
};
use pneuflex::calibration::fit::{FitOptions, Residuals, Test, chosen_law, fit as fit_law, largest_i1_minus_3};
use pneuflex::calibration::law::{Choice, Family, Mode};
use pneuflex::calibration::library::{ENTRIES, Entry, identifier};
use pneuflex::calibration::range::{fitted_to, longest_range, up_to};
use pneuflex::calibration::test_name;
use pneuflex::model::Material;
use pneuflex::{Error, InputError, input_file};
use pyo3::prelude::*;
use serde_json::json;

use crate::error::{apart, wrong};

/// Kind of test, stretches, nominal stresses in MPa.
type Points = (String, Vec<f64>, Vec<f64>);

/// Name, kind of test, stretches, nominal stresses in MPa, weight.
type Weighted = (String, String, Vec<f64>, Vec<f64>, f64);

/// Reads a file of test curves; also returns how it was understood.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "what may be said about a file")]
pub fn read_curves(
    py: Python<'_>,
    path: PathBuf,
    test: Option<&str>,
    columns: Option<&str>,
    unit: Option<&str>,
    strain: Option<&str>,
    stress: Option<&str>,
    decimal: Option<&str>,
    specimen: Option<[f64; 2]>,
) -> PyResult<(Vec<Points>, Vec<String>)> {
    let options = ReadOptions {
        test: test.map(|text| mode(py, text)).transpose()?,
        columns: match columns {
            None => ColumnChoice::default(),
            Some(text) => ColumnChoice::parse(text).map_err(|error| wrong(py, format!("columns: {error}")))?,
        },
        unit: one_of(py, "unit", unit, StressUnit::find, "MPa, kPa, Pa, GPa, N/mm2, N/cm2, kgf/cm2 or psi")?,
        strain: one_of(py, "strain", strain, strain_measure, "stretch, engineering, percent or true")?,
        stress: one_of(py, "stress", stress, stress_measure, "nominal or true")?,
        decimal: one_of(py, "decimal", decimal, decimal_sign, "point or comma")?,
        specimen,
    };
    apart(py, || {
        let bytes = input_file(&path, MAX_BYTES as u64)?;
        let name = path.display().to_string();
        let text = curve::decode(&bytes).map_err(|error| about(&path, &error))?;
        let reading = curve::read(&name, &text, &options).map_err(|error| about(&path, &error))?;
        let numbers = |points: &[Point], of: fn(&Point) -> f64| points.iter().map(of).collect();
        let of_curve = |curve: &Curve| {
            let points = &curve.points;
            (curve.mode.name().to_owned(), numbers(points, |p| p.stretch), numbers(points, |p| p.stress))
        };
        Ok((reading.curves.iter().map(of_curve).collect(), reading.understood))
    })
}

/// The kind of test that a text names.
#[pyfunction]
pub fn test_kind(py: Python<'_>, text: &str) -> PyResult<&'static str> {
    mode(py, text).map(Mode::name)
}

/// Fits a law to curves (name, test, stretches, nominal stresses in MPa, weight) in a range, or as far as it can follow them; the fit as
/// JSON, with what was left out of the curves.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "what may be said about a fit")]
pub fn fit(
    py: Python<'_>,
    curves: Vec<Weighted>,
    law: &str,
    terms: Option<usize>,
    range: (f64, Option<f64>),
    cycles: &str,
    keeps_break: bool,
    keeps_offset: bool,
    is_relative: bool,
    stable: Option<f64>,
    is_stable: bool,
) -> PyResult<String> {
    let wanted = one_of(py, "law", Some(law), family_of, "yeoh, neo-hooke, mooney-rivlin, ogden or gent")?;
    let wanted = Choice { family: wanted.unwrap_or(Family::Yeoh), terms };
    if !wanted.is_possible() {
        return Err(wrong(py, "terms: yeoh has 2 or 3, ogden 1 to 3, the others have none"));
    }
    let cycles = match cycles {
        "last" => Cycles::Last,
        "first" => Cycles::First,
        "all" => Cycles::All,
        _ => return Err(wrong(py, format!("cycles = \"{cycles}\" must be last, first or all"))),
    };
    let (mut tests, mut notes) = (Vec::new(), Vec::new());
    for (name, kind, stretches, stresses, weight) in curves {
        let points = stretches.iter().zip(&stresses).enumerate();
        let point = |(i, (&stretch, &stress)): (usize, (&f64, &f64))| Point { stretch, stress, line: i + 1 };
        let curve = Curve { file: name.clone(), mode: mode(py, &kind)?, points: points.map(point).collect() };
        let to = range.1.unwrap_or(f64::INFINITY);
        let how = Cleaning { cycles, keeps_break, keeps_offset, from: range.0, to };
        let cleaned = clean(&curve, &how);
        if cleaned.used.is_empty() {
            return Err(wrong(py, format!("{name}: no point of the {} test is left to fit", curve.mode.name())));
        }
        notes.extend(cleaned.notes);
        tests.push(Test { name, mode: curve.mode, points: cleaned.used, weight });
    }
    let residuals = if is_relative { Residuals::Relative } else { Residuals::Absolute };
    // What cannot be fitted is said later.
    if range.1.is_none()
        && let Ok(range) = longest_range(wanted, &tests, residuals)
        && let Some(why) = range.words(wanted)
    {
        notes.push(why);
        tests = up_to(&tests, range.to);
    }
    let largest = largest_i1_minus_3(&tests);
    let options = FitOptions { residuals, stable_up_to: is_stable.then(|| stable.unwrap_or(largest)) };
    apart(py, || {
        // The exponents of Ogden's law and the J_m of Gent's are looked for before the moduli.
        let found = chosen_law(wanted, &tests, residuals).and_then(|law| fit_law(law, &tests, &options));
        let found = found.map_err(|error| InputError::new(format!("{} cannot be fitted: {error}", wanted.name())))?;
        let material = Material::from(found.law.with_constants(&found.values()));
        let bulk_modulus = bulk_modulus(material.shear_modulus(), largest_mean_stress(&tests));
        let material = Material { fitted_to: fitted_to(&tests), bulk_modulus, ..material };
        let problems = material.problems("material");
        if let Some(problem) = problems.first() {
            return Err(InputError::new(format!("the fitted constants cannot be used: {problem}")).into());
        }
        let text = serde_json::to_string(&json!({ "fit": found, "material": material, "notes": notes }));
        Ok(text.map_err(|error| InputError::new(error.to_string()))?)
    })
}

/// Known silicones as JSON.
#[pyfunction]
pub fn materials(py: Python<'_>) -> PyResult<String> {
    let all = ENTRIES.iter().enumerate().map(|(number, entry)| {
        let Entry { name, constants, range, source, .. } = entry;
        json!({ "identifier": identifier(number), "name": name, "constants": constants, "range": range, "source": source,
                "material": entry.material() })
    });
    let all: Vec<_> = all.collect();
    serde_json::to_string(&all).map_err(|error| wrong(py, error.to_string()))
}

fn about(path: &Path, error: &curve::CurveError) -> Error {
    let line = error.line.map_or(String::new(), |line| format!("line {line}: "));
    InputError::about_file(path, format!("{line}{error}")).with_help(error.help.clone()).into()
}

fn one_of<T>(
    py: Python<'_>,
    key: &str,
    text: Option<&str>,
    find: impl Fn(&str) -> Option<T>,
    words: &str,
) -> PyResult<Option<T>> {
    let found = text.map(|text| find(text).ok_or_else(|| wrong(py, format!("{key} = \"{text}\" must be {words}"))));
    found.transpose()
}

fn mode(py: Python<'_>, text: &str) -> PyResult<Mode> {
    test_name::find(text).ok_or_else(|| {
        wrong(py, format!("\"{text}\" is no kind of test: it must be uniaxial, equibiaxial or planar (pure shear)"))
    })
}

fn strain_measure(text: &str) -> Option<StrainMeasure> {
    match text {
        "stretch" => Some(StrainMeasure::Stretch),
        "engineering" | "nominal" => Some(StrainMeasure::Engineering),
        "percent" | "%" => Some(StrainMeasure::Percent),
        "true" | "log" => Some(StrainMeasure::True),
        _ => None,
    }
}

fn stress_measure(text: &str) -> Option<StressMeasure> {
    match text {
        "nominal" | "engineering" => Some(StressMeasure::Nominal),
        "true" | "cauchy" => Some(StressMeasure::True),
        _ => None,
    }
}

fn decimal_sign(text: &str) -> Option<DecimalSign> {
    match text {
        "point" | "." => Some(DecimalSign::Point),
        "comma" | "," => Some(DecimalSign::Comma),
        _ => None,
    }
}

fn family_of(text: &str) -> Option<Family> {
    Family::ALL.into_iter().find(|family| [family.key(), &family.name().to_lowercase()].contains(&text))
}
