//! A run beside what somebody has measured: a table of the differences, and a picture.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};
use serde::{Deserialize, Serialize};

use crate::numbers::number;
use crate::report::Report;

/// How measurements differ from a run, as `comparison.json` has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the file with the measurements.
    pub measured: String,
    /// Whether measurements stand at times, and not at pressures.
    pub is_by_time: bool,
    /// What points are compared with: `bottom line` or `outline`; left out without points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<String>,
    /// What was fitted before points were compared; left out if nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alignment: Option<Alignment>,
    /// Differences, kind by kind.
    pub kinds: Vec<Difference>,
    /// Pressures or times between those of the run, where it was interpolated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub interpolated_at: Vec<f64>,
    /// The picture, an SVG file of its own.
    #[serde(skip)]
    pub picture: String,
}

/// Measured points were multiplied by a scale, turned about the origin from x towards z, and moved, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alignment {
    /// Factor.
    pub scale: f64,
    /// Angle, degrees.
    pub rotation_deg: f64,
    /// Along x and z, mm.
    pub offset_mm: [f64; 2],
}

/// How far measurements of a kind are from the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// `points`, or a column of `pneuflex table`.
    pub of: String,
    /// Unit; may be empty.
    pub unit: String,
    /// Number of measurements.
    pub count: usize,
    /// Root of the mean square.
    pub rms: f64,
    /// Largest one.
    pub largest: f64,
    /// Pressure, kPa, or time of the largest one.
    pub largest_at: f64,
    /// Mean of measured less computed; left out for points, whose distances have no sign.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean: Option<f64>,
}

impl Alignment {
    /// In words.
    pub fn words(&self) -> String {
        let Self { scale, rotation_deg, offset_mm: [x, z] } = self;
        format!(
            "Measured points were fitted to the run first: times {scale:.4}, turned by {rotation_deg:.3} degrees about the origin, moved by \
             ({x:.4}, {z:.4}) mm."
        )
    }
}

/// The section of the page; nothing without a comparison.
pub(crate) fn section(report: &Report<'_>) -> Markup {
    let Some(found) = &report.summary.comparison else { return html! {} };
    let places: Vec<String> = found.interpolated_at.iter().map(|at| report.words(*at)).collect();
    html! {
        section .sheet {
            h2 { "Compared with " code { (found.measured) } }
            div .scroll tabindex="0" role="region" aria-label="Differences from measurements" {
                table .results {
                    thead {
                        tr {
                            th scope="col" { "measured" }
                            th scope="col" { "number" }
                            th scope="col" { "RMS of the difference" }
                            th scope="col" { "largest" }
                            th scope="col" { "mean (measured less computed)" }
                        }
                    }
                    tbody {
                        @for kind in &found.kinds {
                            tr {
                                th scope="row" { @if kind.of == "points" { "points" } @else { code { (kind.of) } } }
                                td { (kind.count) }
                                td { (number(kind.rms)) " " span .unit { (kind.unit) } }
                                td { (number(kind.largest)) " " span .unit { (kind.unit) ", at " (report.words(kind.largest_at)) } }
                                td { @if let Some(mean) = kind.mean { (number(mean)) " " span .unit { (kind.unit) } } @else { "–" } }
                            }
                        }
                    }
                }
            }
            @if let Some(line) = &found.line {
                p .note { "Points are compared with the nearest point of the " (line) " at their " (report.parameter()) "." }
            }
            @if let Some(alignment) = &found.alignment { p .note { (alignment.words()) } }
            @if !places.is_empty() { p .note { "The run is interpolated at " (places.join(", ")) "." } }
            @if !found.picture.is_empty() {
                img .comparison alt="Measurements beside the run" src={ "data:image/svg+xml;base64," (STANDARD.encode(&found.picture)) };
            }
        }
    }
}
