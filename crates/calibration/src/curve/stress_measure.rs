//! Whether a stress is nominal or true, where its column does not say so: a good fit of the one is a good fit of the other.

use super::decimal::{DecimalSign, number};
use super::header::{Header, Heading, Quantity};
use super::reading::{Curve, CurveError};
use super::select::{Pair, Selection, title};
use super::table::{LOOK_AHEAD, lines, split};
use super::unit::StressMeasure;
use crate::words::words_of;

/// Largest ratio of true and nominal stress up to which nominal stress is supposed without asking: what specimens scatter by.
const LARGEST_SUPPOSED_RATIO: f64 = 1.1;

/// Largest deviation from its mean of a ratio that is taken for constant.
const RATIO_TOLERANCE: f64 = 0.02;

/// Finds out what stresses of unknown kind are: by a force beside them, or by the lines above the table.
pub fn find(selection: &mut Selection, header: &Header, separator: u8, decimal: DecimalSign, text: &str) {
    for pair in selection.pairs.iter_mut().filter(|pair| pair.stress_measure.is_none()) {
        let found = by_force(pair, header, separator, decimal, text).or_else(|| by_lines_above(header, text));
        if let Some((measure, how)) = found {
            (pair.stress_measure, pair.stress_evidence) = (Some(measure), Some(how));
        }
    }
}

/// A force divided by nominal stress is the undeformed area; by true stress, an area that shrinks with the stretch.
fn by_force(
    pair: &Pair,
    header: &Header,
    separator: u8,
    decimal: DecimalSign,
    text: &str,
) -> Option<(StressMeasure, String)> {
    let is_force = |heading: &Heading| matches!(heading.quantity, Some(Quantity::Force(_)));
    let force = header.headings.iter().position(is_force)?;
    let mut rows: Vec<[f64; 3]> = Vec::new();
    for (n, line) in lines(text).skip_while(|(n, _)| *n <= header.line) {
        let row = split(n, line, separator).ok()?;
        let [force, stress, strain] = [force, pair.stress, pair.strain].map(|c| number(row.cell(c), decimal));
        if let (Some(force), Some(stress), Some(strain)) = (force, stress, strain) {
            rows.push([force, stress, pair.strain_measure.stretch(pair.strain_factor * strain)]);
        }
    }
    let largest = rows.iter().fold(0.0, |most: f64, row| most.max(row[1].abs()));
    // Small numbers are rounded too much to be divided.
    rows.retain(|[force, stress, stretch]| stress.abs() > 0.1 * largest && *force != 0.0 && *stretch > 0.0);
    let is_constant = |ratio: &dyn Fn(&[f64; 3]) -> f64| {
        let (low, high) =
            rows.iter().map(ratio).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), r| (a.min(r), b.max(r)));
        low > 0.0 && high <= low * (1.0 + 2.0 * RATIO_TOLERANCE)
    };
    let is_nominal = is_constant(&|[force, stress, _]| stress / force);
    let is_true = is_constant(&|[force, stress, stretch]| stress / (force * stretch));
    let how = format!("by column {}", title(&header.headings, force));
    match (is_nominal, is_true) {
        (true, false) => Some((StressMeasure::Nominal, how)),
        (false, true) => Some((StressMeasure::True, how)),
        _ => None,
    }
}

fn by_lines_above(header: &Header, text: &str) -> Option<(StressMeasure, String)> {
    lines(text).take_while(|(n, _)| *n < header.line).take(LOOK_AHEAD).find_map(|(n, line)| {
        let words = words_of(line);
        let has = |parts: &[&str]| words.iter().any(|word| parts.contains(&word.as_str()));
        let is_about_stress = words.iter().any(|word| word.contains("stress") || word.contains("spannung"));
        let is_nominal = has(&["nominal", "engineering", "piola", "pk1", "technische", "nennspannung"]);
        let measure = match (is_nominal, has(&["true", "cauchy", "wahre"])) {
            (true, false) => StressMeasure::Nominal,
            (false, true) => StressMeasure::True,
            _ => return None,
        };
        is_about_stress.then(|| (measure, format!("by line {n}")))
    })
}

/// Refuses a stress of unknown kind where the two readings differ by more than specimens do.
///
/// # Errors
/// Both readings, and how to choose.
pub fn refuse_unknown(selection: &Selection, header: &Header, curves: &[Curve]) -> Result<(), CurveError> {
    let Some(pair) = selection.pairs.iter().find(|pair| pair.stress_measure.is_none()) else { return Ok(()) };
    let stretches = curves.iter().flat_map(|curve| &curve.points).map(|point| point.stretch);
    let furthest = stretches.fold(1.0_f64, |far, s| if s.ln().abs() > far.ln().abs() { s } else { far });
    if furthest.ln().abs() <= LARGEST_SUPPOSED_RATIO.ln() {
        return Ok(());
    }
    let message = format!(
        "column {} may be nominal stress (force per undeformed area) or true stress (force per deformed area): nothing says which, \
         and at a stretch of {furthest:.4} true stress is {furthest:.2} times the nominal one",
        title(&header.headings, pair.stress),
    );
    Err(CurveError::at(header.line, message)
        .help("add --stress nominal (what testing machines write, as a rule) or --stress true"))
}
