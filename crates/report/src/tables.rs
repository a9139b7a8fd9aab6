//! What the page says of the run: why it ended, warnings, inputs, sizes and times.

use maud::{Markup, html};

use crate::numbers::{difference, fixed, number, thousands};
use crate::report::Report;
use crate::summary::{Summary, Warning};

/// Why the run ended early, and what to be careful about; nothing if there is nothing to say.
pub fn notices(report: &Report<'_>) -> Markup {
    let summary = report.summary;
    let reached = summary.reached().last().map(|(time, _)| report.words(time));
    let on_the_way = !summary.on_the_way.is_empty();
    let warnings = summary.all_warnings();
    html! {
        @if !summary.is_converged() && !summary.is_past_limit() {
            section .notice .failure role="alert" {
                h2 { (status_text(summary)) }
                @if let Some(failure) = &summary.failure { p { (marked(&sentence(failure))) } }
                @if let Some(reason) = &summary.failure_reason { p { "What to try: " (marked(&ended(&reason.advice))) } }
                @match reached {
                    Some(reached) if on_the_way => p {
                        "Everything below shows what was reached. The last shape, at " strong { (reached) }
                        ", lies on the way to the next requested " (report.parameter())
                        ": it is the one that is shown first."
                    },
                    Some(reached) => p { "Everything below shows what was reached, up to " strong { (reached) } "." },
                    None => p { "No equilibrium was found: there is nothing to show but the " (report.noun()) " at rest." },
                }
            }
        }
        @if !warnings.is_empty() {
            section .notice .warnings aria-label="Warnings" {
                h2 { @if warnings.len() == 1 { "One warning" } @else { (warnings.len()) " warnings" } }
                ul { @for warning in &warnings { (warning_item(report, warning)) } }
            }
        }
    }
}

fn warning_item(report: &Report<'_>, warning: &Warning) -> Markup {
    html! {
        li {
            @match warning.time.or(warning.pressure_kpa).map(|time| report.words(time)) {
                // Many messages say themselves from when on they hold.
                Some(words) if !warning.message.contains(&words) => { strong { (words) ": " } (marked(&ended(&warning.message))) },
                _ => (marked(&sentence(&warning.message))),
            }
            @if !warning.advice.is_empty() { span .advice { " " (marked(&sentence(&warning.advice))) } }
        }
    }
}

/// A text in which what stands between backticks is code.
fn marked(text: &str) -> Markup {
    html! {
        @for (number, piece) in text.split('`').enumerate() {
            @if number % 2 == 1 { code { (piece) } } @else { (piece) }
        }
    }
}

/// A text with a full stop at its end.
fn ended(text: &str) -> String {
    let text = text.trim_end();
    if text.is_empty() || text.ends_with(['.', '!', '?']) { text.to_owned() } else { format!("{text}.") }
}

/// A text as a sentence: with a capital, unless it begins with a name of the input or a number, and a full stop.
fn sentence(text: &str) -> String {
    let first = text.split_whitespace().next().unwrap_or_default();
    let is_word = first.trim_end_matches([',', ':', ';']).chars().all(|letter| letter.is_lowercase() || letter == '-');
    match text.chars().next() {
        Some(letter) if is_word => ended(&format!("{}{}", letter.to_uppercase(), &text[letter.len_utf8()..])),
        _ => ended(text),
    }
}

/// How exact the last state is; nothing where that was not asked for.
pub fn exactness(report: &Report<'_>) -> Markup {
    let Some(estimate) = &report.summary.error_estimate else { return html! {} };
    let at = estimate.time.or(estimate.pressure_kpa).map_or_else(String::new, |at| format!(" at {}", report.words(at)));
    html! {
        section .sheet {
            h2 { "How exact it is" (at) }
            @match &estimate.why_not {
                Some(why) => p .note { "Errors were not estimated: " (why) "." },
                None => {
                    div .scroll tabindex="0" role="region" aria-label="Estimated errors" {
                        table .results {
                            thead {
                                tr {
                                    th scope="col" { "quantity" }
                                    th scope="col" { "value" }
                                    th scope="col" { "estimated error" }
                                    th scope="col" { "relative" span .unit { "%" } }
                                }
                            }
                            tbody {
                                @for (key, error) in &estimate.errors {
                                    tr {
                                        th scope="row" { code { (key) } }
                                        td { (number(error.value)) }
                                        td { (difference(error.error)) }
                                        td { (error.percent.map_or_else(|| "–".to_owned(), |percent| fixed(percent, 1))) }
                                    }
                                }
                            }
                        }
                    }
                    p .note {
                        "An error is positive where the value is too large. It is what a mesh of " (thousands(estimate.unknowns))
                        " unknowns, with every element divided into eight, changes of the value; what that mesh lacks itself comes on top."
                    }
                }
            }
        }
    }
}

/// How the run ended, in words.
pub fn status_text(summary: &Summary) -> &str {
    match summary.status.as_str() {
        "converged" => "Converged",
        "past-limit" => "Followed past its limit point",
        "not-converged" => "The run did not converge",
        "running" => "The run had not ended when this page was written",
        "interrupted" => "The run was interrupted",
        other => other,
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
                @for group in report.inputs {
                    table .inputs {
                        caption { (group.heading) }
                        tbody {
                            @for row in &group.rows {
                                tr {
                                    th scope="row" title=(row.meaning) {
                                        code { (row.key) }
                                        @if !row.meaning.is_empty() { span .meaning { (row.meaning) } }
                                    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_marked_and_markup_of_others_is_none() {
        assert_eq!(marked("let `a <b>` be").into_string(), "let <code>a &lt;b&gt;</code> be");
    }

    #[test]
    fn messages_are_sentences_and_names_stay_what_they_are() {
        for (text, expected) in [
            ("two walls touch", "Two walls touch."),
            ("é, so be it!", "É, so be it!"),
            ("max_step_kpa is large", "max_step_kpa is large."),
            ("load.pressure_kpa: too much", "load.pressure_kpa: too much."),
            ("2 elements are flat", "2 elements are flat."),
            ("", ""),
        ] {
            assert_eq!(sentence(text), expected);
        }
    }
}
