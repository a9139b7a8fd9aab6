//! Points and curves, one chart per test.

use pneuflex::calibration::curve::Point;
use pneuflex::calibration::fit::LawFit;
use pneuflex::calibration::law::{Law, Mode};
use pneuflex::plot::PlotError;
use pneuflex::plot::chart::{Chart, PALETTE, Series, Style};
use pneuflex::plot::drawing::{Colour, Drawing};

use super::Prepared;

/// Points of one kind in a chart; more cannot be told apart.
const MOST_POINTS: usize = 60;

/// Points of a curve on either side of rest.
const SAMPLES: usize = 160;

const UNUSED: Colour = Colour([190, 190, 190]);

/// Draws a chart for every test, under each other; those without points show what the laws predict.
pub fn draw(tests: &[Prepared], fits: &[LawFit], largest_i1_minus_3: f64) -> Result<Drawing, PlotError> {
    let mut charts = Vec::new();
    for mode in Mode::ALL {
        charts.push(chart(tests, fits, mode, largest_i1_minus_3)?.draw()?);
    }
    Ok(Drawing::column(charts, "Laws fitted to material tests"))
}

fn chart(tests: &[Prepared], fits: &[LawFit], mode: Mode, largest_i1_minus_3: f64) -> Result<Chart, PlotError> {
    let of_mode: Vec<&Prepared> = tests.iter().filter(|t| t.test.mode == mode).collect();
    let all = || of_mode.iter().flat_map(|t| t.test.points.iter().chain(&t.cleaned.unused));
    let predicted = mode.stretch_of(largest_i1_minus_3);
    let has_points = !of_mode.is_empty();
    let low = if has_points { all().map(|p| p.stretch).fold(1.0, f64::min) } else { 1.0 };
    let high = if has_points { all().map(|p| p.stretch).fold(1.0, f64::max) } else { predicted };
    // Laws may leave the points by far where they are not fitted; a test that was not made is drawn to scale with the first law.
    let stresses: Vec<f64> = match fits.first() {
        Some(fit) if !has_points => {
            curve(fit, mode, low, high, [f64::NEG_INFINITY, f64::INFINITY]).iter().map(|p| p[1]).collect()
        }
        _ => all().map(|p| p.stress).collect(),
    };
    let (least, most) = stresses.iter().fold((0.0_f64, 0.0_f64), |(a, b), s| (a.min(*s), b.max(*s)));
    let room = 0.15 * (most - least);
    let bounds = [least - room, most + room];

    let mut series = Vec::new();
    for (i, test) in of_mode.iter().enumerate() {
        let unused = Series::line("measured, not fitted", thinned(&test.cleaned.unused));
        if !test.cleaned.unused.is_empty() {
            series.push(unused.style(Style::Markers).colour(UNUSED));
        }
        let name = if of_mode.len() > 1 { test.short_name() } else { "measured".into() };
        let colour = if of_mode.len() > 1 { PALETTE[(i + 2) % PALETTE.len()] } else { PALETTE[6] };
        series.push(Series::line(&name, thinned(&test.test.points)).style(Style::Markers).colour(colour));
    }
    for fit in fits {
        let (style, colour) = match fit.law {
            Law::Yeoh | Law::YeohOfTwoTerms => (Style::Solid, PALETTE[0]),
            Law::NeoHookean => (Style::Dotted, PALETTE[1]),
            Law::MooneyRivlin => (Style::Dashed, PALETTE[3]),
            Law::Ogden(_) => (Style::Solid, PALETTE[2]),
            Law::Gent(_) => (Style::Dashed, PALETTE[4]),
        };
        series.push(Series::line(&fit.law.name(), curve(fit, mode, low, high, bounds)).style(style).colour(colour));
    }
    let name = mode.name();
    let title = format!("{}{}", name[..1].to_uppercase(), &name[1..]);
    let title = if has_points { title } else { format!("{title}: no test, predicted") };
    Ok(Chart {
        x_label: "stretch (1)".into(),
        y_label: "nominal stress (MPa)".into(),
        x_shows: vec![1.0],
        y_shows: vec![0.0],
        series,
        height: 300.0,
        ..Chart::new(&title)
    })
}

/// A law's curve from rest outwards, as far as the stress stays within bounds.
fn curve(fit: &LawFit, mode: Mode, low: f64, high: f64, [least, most]: [f64; 2]) -> Vec<[f64; 2]> {
    let side = |end: f64| -> Vec<[f64; 2]> {
        (0..=SAMPLES)
            .map(|i| 1.0 + (end - 1.0) * i as f64 / SAMPLES as f64)
            .map(|stretch| [stretch, fit.stress(mode, stretch)])
            .take_while(|p| p[1].is_finite() && (least..=most).contains(&p[1]))
            .collect()
    };
    let mut points = if low < 1.0 { side(low) } else { Vec::new() };
    points.reverse();
    points.extend(side(high));
    points
}

fn thinned(points: &[Point]) -> Vec<[f64; 2]> {
    let stride = points.len().div_ceil(MOST_POINTS).max(1);
    points.iter().step_by(stride).map(|p| [p.stretch, p.stress]).collect()
}
