//! What `pneuflex fit` prints, and `fit.json`.

use std::fmt::Write;

use pneuflex::calibration::bands::{Band, TOLERANCE};
use pneuflex::calibration::cross_validation::{BLOCKS, Comparison, Validation};
use pneuflex::calibration::fit::{Agreement, LawFit, Residuals};
use pneuflex::calibration::law::{Choice, Mode};
use pneuflex::calibration::stability::{SEARCHED, StableRange};
use pneuflex::model::Material;
use serde::Serialize;

use super::Prepared;

/// Correlations of constants from here on are worth a line.
const HIGH_CORRELATION: f64 = 0.9;

/// What the confidence intervals suppose.
pub const ASSUMPTIONS: &str = "The 95 % confidence intervals are those of weighted linear regression (Student's t). They \
     suppose independent residuals with variances inverse to the weights and a law that is right. Residuals of neighbouring \
     points of a smooth curve are not independent: `widening` is the factor by which the intervals are too narrow if residuals \
     are a first-order autoregressive series. The scatter between specimens, batches and laboratories is not part of them.";

/// `fit.json`.
#[derive(Debug, Serialize)]
pub struct FitFile<'a> {
    /// This program.
    pub program: &'static str,
    /// Its version.
    pub version: &'static str,
    /// Files as they were understood.
    pub files: &'a [FileNote],
    /// Tests and what was left out of them.
    pub tests: Vec<TestNote<'a>>,
    /// What was minimised.
    pub residuals: Residuals,
    /// Largest I₁ − 3 of the points.
    pub largest_i1_minus_3: f64,
    /// What the intervals mean.
    pub assumptions: &'static str,
    /// Laws with constants.
    pub laws: &'a [LawFit],
    /// Laws judged by points that they were not fitted to.
    pub cross_validation: &'a Comparison,
    /// Laws without, and why.
    pub not_fitted: Vec<String>,
    /// Constants for a case file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
}

/// A file as it was understood.
#[derive(Debug, Serialize)]
pub struct FileNote {
    /// Name.
    pub file: String,
    /// Columns, units and tests.
    pub understood: Vec<String>,
}

/// A test as it was fitted.
#[derive(Debug, Serialize)]
pub struct TestNote<'a> {
    name: &'a str,
    mode: Mode,
    weight: f64,
    points: usize,
    stretch: [f64; 2],
    notes: &'a [String],
}

impl<'a> TestNote<'a> {
    /// Of a prepared test.
    pub fn new(test: &'a Prepared) -> Self {
        Self {
            name: &test.test.name,
            mode: test.test.mode,
            weight: test.test.weight,
            points: test.test.points.len(),
            stretch: test.stretch_range(),
            notes: &test.cleaned.notes,
        }
    }
}

/// What was read and left out.
pub fn reading(files: &[FileNote], tests: &[Prepared]) -> String {
    let mut text = String::new();
    for file in files {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", file.file);
        for line in &file.understood {
            let _ = writeln!(text, "  {line}");
        }
        for test in tests.iter().filter(|t| t.file == file.file) {
            for note in &test.cleaned.notes {
                let _ = writeln!(text, "  {}: {note}", test.test.mode.name());
            }
            let [low, high] = test.stretch_range();
            let _ = writeln!(
                text,
                "  {}: {} points are fitted, stretch {low:.4} to {high:.4}, weight {}",
                test.test.mode.name(),
                test.test.points.len(),
                test.test.weight
            );
        }
    }
    text
}

/// Largest relative error of a stress from 10 % strain on, and the stretch where it is.
pub fn largest_error(bands: &[Band]) -> Option<[f64; 2]> {
    let worst = bands.iter().max_by(|a, b| a.largest_error.abs().total_cmp(&b.largest_error.abs()))?;
    Some([worst.largest_error.abs(), worst.largest_at_stretch])
}

/// Relative errors at small, moderate and large strains, with a warning where that of the `chosen` law is too large.
fn errors(fit: &LawFit, width: usize, chosen: bool) -> String {
    let mut text = String::new();
    for (row, bands) in fit.tests.iter().zip(&fit.bands) {
        let band = |b: &Band| {
            let [low, high] = b.strain.map(|strain| 100.0 * strain);
            format!("{low:.0} to {high:.0} %: {:+.0} %", 100.0 * b.largest_error)
        };
        let all: Vec<String> = bands.iter().map(band).collect();
        if !all.is_empty() {
            let _ = writeln!(text, "  {:width$}  largest error of the stress by strain: {}", row.test, all.join(", "));
        }
    }
    let missed: Vec<String> = fit
        .tests
        .iter()
        .zip(&fit.bands)
        .flat_map(|(row, bands)| bands.iter().map(move |band| (row, band)))
        .filter(|(_, band)| band.misses())
        .map(|(row, band)| {
            let kind = if band.largest_error > 0.0 { "stiff" } else { "soft" };
            format!(
                "{:.0} % too {kind} at stretch {:.2} ({})",
                100.0 * band.largest_error.abs(),
                band.largest_at_stretch,
                row.test
            )
        })
        .collect();
    if chosen && !missed.is_empty() {
        let _ = writeln!(
            text,
            "  WARNING: more than {:.0} % off: {}; fit the range that your actuator uses (--to), or compare the other laws",
            100.0 * TOLERANCE,
            missed.join(", ")
        );
    }
    text
}

/// Constants of a law, how well they fit, and where they are stable; with warnings if it is the `chosen` one.
pub fn law(fit: &LawFit, largest_i1_minus_3: f64, chosen: bool) -> String {
    let mut text = format!("\n{}\n", fit.law.name());
    let units = fit.constants.iter().map(|constant| (constant, " MPa")).chain(fit.shape.iter().map(|c| (c, "")));
    for (constant, unit) in units {
        let interval = constant
            .confidence_95
            .map_or(String::new(), |[low, high]| format!("   95 %: {} to {}", significant(low), significant(high)));
        let _ = writeln!(text, "  {} = {}{unit}{interval}", constant.name, significant(constant.value));
    }
    let _ = writeln!(text, "  initial shear modulus {} MPa", significant(fit.shear_modulus_mpa));
    let width = fit.tests.iter().map(|t| t.test.chars().count()).max().unwrap_or(0).max(fit.total.test.len());
    let shows_total = fit.tests.len() > 1;
    for row in fit.tests.iter().chain(shows_total.then_some(&fit.total)) {
        let _ = writeln!(text, "  {}", agreement(row, width));
    }
    text += &errors(fit, width, chosen);
    if let Some(limit) = fit.held_stable_up_to_i1_minus_3 {
        let _ = writeln!(
            text,
            "  held stable up to I1-3 = {limit:.3}; on the edge of what is stable there are no symmetric intervals"
        );
    }
    let _ = writeln!(text, "  {}", stability(fit, largest_i1_minus_3));
    for line in correlations(fit) {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// What is to be said of a law whose other deformations the tests do not determine.
pub fn one_kind_of_test(chosen: Choice) -> String {
    format!(
        "\nWARNING: {} fitted to one kind of test says nothing reliable of other deformations (its stress there may be off by any factor); \
         give tests of a second kind, or take a law of the first invariant (--law yeoh)\n",
        chosen.name()
    )
}

/// Laws judged by points that they were not fitted to, the one to take, and why.
pub fn comparison(comparison: &Comparison, chosen: Choice) -> String {
    let mut text = format!(
        "\nCross-validation: relative error of the stress in blocks of strain that were left out of the fit ({BLOCKS} in a test, by the \
         logarithm of the strain)\n"
    );
    let width = comparison.laws.iter().map(|law| law.law.chars().count()).max().unwrap_or(0);
    let percent = |error: f64| format!("{:.1} %", 100.0 * error);
    for law in &comparison.laws {
        let beyond = match law.beyond {
            Some(error) if error < 10.0 => percent(error),
            Some(_) => "over 1000 %".to_owned(),
            None => "no stress".to_owned(),
        };
        let unable = match (law.is_stable, law.is_known_elsewhere) {
            (false, _) => "; not stable over the range",
            (true, false) => "; not known in other deformations",
            (true, true) => "",
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  {:width$}  {} constant{} {:>7} +- {:>6}, largest {:>7} at stretch {:.2}; beyond the end {beyond}{unable}",
            law.law,
            law.constants,
            if law.constants == 1 { " " } else { "s" },
            percent(law.error),
            percent(law.standard_error),
            percent(law.largest_error),
            law.largest_at_stretch,
        );
    }
    match comparison.best() {
        Some(best) => text += &recommendation(comparison, best, chosen),
        None => text += "  no recommendation: too few points, or none of these laws is stable\n",
    }
    text
}

fn recommendation(comparison: &Comparison, best: &Validation, chosen: Choice) -> String {
    let in_short =
        |law: &Validation| format!("{}: {:.1} % with {} constants", law.law, 100.0 * law.error, law.constants);
    let closest = comparison.laws.iter().filter(|law| law.is_able()).min_by(|a, b| a.error.total_cmp(&b.error));
    let why = match closest {
        Some(closest) if closest.law != best.law => {
            format!("within a standard error of the closest, {}, and simpler", in_short(closest))
        }
        _ => "the closest".to_owned(),
    };
    let is_chosen = best.choice.family == chosen.family && best.choice.name() == chosen.name();
    let how = if is_chosen { String::new() } else { format!(" ({})", best.options) };
    format!("  recommended for this range: {}, {why}{how}\n", in_short(best))
}

fn agreement(row: &Agreement, width: usize) -> String {
    let r_squared = row.r_squared.map_or("    -    ".into(), |r| format!("{r:9.6}"));
    format!(
        "{:width$}  {:>5} points  R2 {r_squared}  RMS {} MPa ({:.2} %)  largest {} MPa at stretch {:.3}",
        row.test,
        row.points,
        significant(row.rms_mpa),
        100.0 * row.relative_rms,
        significant(row.largest_mpa),
        row.largest_at_stretch,
    )
}

fn stability(fit: &LawFit, largest_i1_minus_3: f64) -> String {
    let range = |range: &StableRange| {
        let low = range.low.map_or(format!("below {}", SEARCHED[0]), |l| format!("{l:.3}"));
        let high = range.high.map_or(format!("beyond {}", SEARCHED[1]), |h| format!("{h:.3}"));
        format!("{} {low} to {high}", range.mode.name())
    };
    if fit.stable.is_empty() {
        return "NOT STABLE even at rest".into();
    }
    let ranges: Vec<String> = fit.stable.iter().map(range).collect();
    let slope = match fit.zero_slope_i1_minus_3 {
        Some(limit) => {
            format!("; the slope of the energy vanishes at I1-3 = {limit:.3}, where the solver's material gives way")
        }
        None => String::new(),
    };
    let warning = if fit.is_stable_in_range {
        String::new()
    } else {
        format!(
            "\n  UNSTABLE within the range of the points (I1-3 up to {largest_i1_minus_3:.3}, in some test); --stable holds \
             the fit stable there"
        )
    };
    format!("stable (Drucker) at stretches: {}{slope}{warning}", ranges.join(", "))
}

fn correlations(fit: &LawFit) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(correlation) = &fit.correlation {
        let mut high = Vec::new();
        let names: Vec<&str> = fit.constants.iter().chain(&fit.shape).map(|constant| constant.name).collect();
        for i in 0..names.len() {
            for j in 0..i {
                if correlation[i][j].abs() > HIGH_CORRELATION {
                    high.push(format!("{} and {} {:.3}", names[j], names[i], correlation[i][j]));
                }
            }
        }
        if !high.is_empty() {
            let pairs = high.join(", ");
            lines.push(format!("correlated estimates: {pairs}; take the constants as a set, not one by one"));
        }
    }
    if let (Some(r), Some(widening), true) = (fit.residual_correlation, fit.widening, fit.correlation.is_some())
        && widening > 1.2
    {
        lines.push(format!(
            "neighbouring residuals are correlated ({r:.2}; 0 if independent): the intervals are too narrow, by a factor of \
             about {widening:.1}"
        ));
    }
    lines
}

/// Four significant digits without an exponent where that is short.
pub fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-5..1e5).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}
