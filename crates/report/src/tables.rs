//! The tables of the page: results, warnings, inputs, the run.

use maud::{Markup, html};
use pneuflex_mesh::actuator::Part;

use crate::Report;
use crate::inputs::groups;
use crate::series::halves;
use crate::summary::{Landed, Step, Summary, Warning};

/// Why the run ended early, and what to be careful about; nothing if there is nothing to say.
pub fn notices(summary: &Summary) -> Markup {
    let reached = summary.landed().last().map(|(pressure, _)| pressure);
    let warnings = summary.all_warnings();
    html! {
        @if !summary.is_converged() {
            section .notice .failure role="alert" {
                h2 { (status_text(summary)) }
                @if let Some(failure) = &summary.failure { p { (failure) } }
                @if let Some(reason) = &summary.failure_reason { p { "What to try: " (reason.advice) "." } }
                @match reached {
                    Some(pressure) => p { "Everything below shows what was reached, up to " strong { (number(pressure)) " kPa" } "." },
                    None => p { "No pressure was reached: there is nothing to show but the actuator at rest." },
                }
            }
        }
        @if !warnings.is_empty() {
            section .notice .warnings aria-label="Warnings" {
                h2 { @if warnings.len() == 1 { "One warning" } @else { (warnings.len()) " warnings" } }
                ul { @for warning in &warnings { (warning_item(warning)) } }
            }
        }
    }
}

fn warning_item(warning: &Warning) -> Markup {
    html! {
        li {
            @if let Some(pressure) = warning.pressure_kpa { strong { (number(pressure)) " kPa: " } }
            (warning.message)
            @if !warning.advice.is_empty() { span .advice { " " (warning.advice) } }
        }
    }
}

/// How the run ended, in words.
pub fn status_text(summary: &Summary) -> &str {
    match summary.status.as_str() {
        "converged" => "Converged",
        "not-converged" => "The run did not converge",
        "running" => "The run had not ended when this page was written",
        "interrupted" => "The run was interrupted",
        other => other,
    }
}

/// Results at every requested pressure.
pub fn results(report: &Report<'_>) -> Markup {
    let steps = &report.summary.steps;
    let halves = halves(report);
    let probes: Vec<&String> = report.summary.probes.keys().collect();
    html! {
        section .sheet {
            h2 { "Results at the computed pressures" }
            div .scroll tabindex="0" role="region" aria-label="Results" {
                table .results {
                    thead {
                        tr {
                            th scope="col" { "pressure" span .unit { "kPa" } }
                            th scope="col" { "bending angle" span .unit { "°" } }
                            @for name in &probes {
                                th scope="col" { (name) ": displacement x, y, z" span .unit { "mm" } }
                            }
                            th scope="col" { "von Mises, 99 %" span .unit { "MPa" } }
                            th scope="col" { "von Mises, largest" span .unit { "MPa" } }
                            th scope="col" { "contact area" span .unit { "mm²" } }
                            th scope="col" { "gaps in contact" span .unit { "–" } }
                            th scope="col" { "penetration" span .unit { "mm" } }
                            th scope="col" { "air volume" span .unit { "cm³" } }
                            th scope="col" { "iterations" span .unit { "–" } }
                        }
                    }
                    tbody {
                        @for step in steps {
                            @match &step.landed {
                                Some(landed) => (landed_row(step, landed, &probes, halves)),
                                None => tr .missed {
                                    th scope="row" { (number(step.pressure_kpa)) }
                                    td colspan=(probes.len() + 7) { "not reached" }
                                    td { (step.iterations) }
                                }
                            }
                        }
                    }
                }
            }
            @if report.case.actuator.part == Part::Half {
                p .note { "Areas and volumes are those of the whole actuator; summary.json holds those of the modelled half." }
            }
            p .note {
                "99 % of the volume carries no more than the von Mises stress, 99 %. The largest value sits at a sharp inner \
                 edge as a rule and grows as the mesh is refined."
            }
        }
    }
}

fn landed_row(step: &Step, landed: &Landed, probes: &[&String], halves: f64) -> Markup {
    html! {
        tr {
            th scope="row" { (number(step.pressure_kpa)) }
            td { (fixed(landed.end_face_angle_deg, 2)) }
            @for name in probes {
                td { @if let Some(u) = landed.probes.get(*name) { (u.map(|x| fixed(x, 3)).join(", ")) } @else { "–" } }
            }
            td { (fixed(landed.von_mises_p99_mpa, 4)) }
            td { (fixed(landed.max_von_mises_mpa, 4)) }
            td { (fixed(halves * landed.contact.area_mm2, 1)) }
            td { (landed.contact.gaps_in_contact) }
            td { (fixed(landed.contact.max_penetration_mm, 4)) }
            td { (fixed(halves * landed.cavity_volume_mm3 / 1000.0, 3)) }
            td { (step.iterations) }
        }
    }
}

/// The case, the mesh and the run.
pub fn inputs(report: &Report<'_>) -> Markup {
    let summary = report.summary;
    let timing = &summary.timing;
    let seconds = |s: f64| (format!("{s:.2}"), "s");
    let count = |n: usize| (thousands(n), "");
    let run = [
        ("status", (status_text(summary).to_lowercase(), "")),
        ("program", (format!("pneuflex {}", summary.version), "")),
        ("nodes", count(summary.mesh.nodes)),
        ("elements", (format!("{} {}", thousands(summary.mesh.elements), summary.mesh.element), "")),
        ("unknowns", count(summary.mesh.unknowns)),
        ("Newton iterations", count(summary.iterations_total)),
        ("time", seconds(timing.total_s)),
        ("of that: assembly", seconds(timing.assembly_s)),
        ("of that: factorisation", seconds(timing.factor_s)),
        ("of that: solution", seconds(timing.solve_s)),
        ("of that: contact search", seconds(timing.contact_s)),
    ];
    html! {
        section .sheet {
            h2 { "What was computed" }
            div .groups {
                @for group in groups(report.case) {
                    table .inputs {
                        caption { (group.heading) }
                        tbody {
                            @for row in &group.rows {
                                tr {
                                    th scope="row" title=(row.meaning) { code { (row.key) } span .meaning { (row.meaning) } }
                                    td { (row.value) @if !row.unit.is_empty() { " " span .unit { (row.unit) } } }
                                }
                            }
                        }
                    }
                }
                table .inputs {
                    caption { "Run" }
                    tbody {
                        @for (name, (value, unit)) in &run {
                            tr { th scope="row" { (name) } td { (value) @if !unit.is_empty() { " " span .unit { (unit) } } } }
                        }
                    }
                }
            }
        }
    }
}

/// A whole number with commas between thousands.
pub fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number as short as it can be.
pub fn number(x: f64) -> String {
    minus(x.to_string())
}

fn fixed(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    // No "−0.000".
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') { text.replace('-', "") } else { minus(text) }
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(
            (thousands(7), thousands(41_901), thousands(1_234_567)),
            ("7".into(), "41,901".into(), "1,234,567".into())
        );
        assert_eq!((fixed(-0.0001, 3), fixed(-1.5, 2), number(-5.0)), ("0.000".into(), "−1.50".into(), "−5".into()));
    }
}
