//! The table of results at every requested pressure or time.

use maud::{Markup, html};
use pneuflex_model::{Clock, StateKind, SymmetryPlane};

use crate::numbers::{fixed, number};
use crate::report::Report;
use crate::summary::{Found, Step};

/// Digits that count in the largest number of a column, at the least.
const DIGITS: i32 = 3;

/// Numbers that need more decimals are zero but for rounding.
const MOST_DECIMALS: i32 = 9;

/// A column: its heading, and a text for every reached step.
struct Column {
    heading: String,
    unit: &'static str,
    cells: Vec<String>,
}

impl Column {
    /// Numbers with at least so many decimals; lists of them with commas between.
    fn new<const N: usize>(
        heading: &str,
        unit: &'static str,
        decimals: usize,
        values: impl Iterator<Item = Option<[f64; N]>>,
    ) -> Self {
        let values: Vec<Option<[f64; N]>> = values.collect();
        let largest = values.iter().flatten().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        let needed = if largest > 0.0 { DIGITS - largest.log10().ceil() as i32 } else { 0 };
        let decimals = if needed > MOST_DECIMALS { decimals } else { decimals.max(needed.max(0) as usize) };
        let text = |value: Option<[f64; N]>| match value.filter(|numbers| numbers.iter().all(|x| x.is_finite())) {
            Some(numbers) => numbers.map(|x| fixed(x, decimals)).join(", "),
            None => "–".to_owned(),
        };
        Self { heading: heading.into(), unit, cells: values.into_iter().map(text).collect() }
    }
}

/// Results at every requested pressure or time.
pub fn results(report: &Report<'_>) -> Markup {
    let columns = columns(report);
    let mut reached = 0..;
    // Those on the way before the one that was missed, which they lead to.
    let (requested, on_the_way) = (&report.summary.steps, &report.summary.on_the_way);
    let (found, missed): (Vec<&Step>, Vec<&Step>) = requested.iter().partition(|step| step.reached.is_some());
    let marked = |is_on_the_way: bool| move |step| (step, is_on_the_way);
    let steps = found.into_iter().map(marked(false)).chain(on_the_way.iter().map(marked(true)));
    let rows: Vec<_> = (steps.chain(missed.into_iter().map(marked(false))))
        .map(|(step, is_on_the_way)| (step, is_on_the_way, step.reached.as_ref().and_then(|_| reached.next())))
        .collect();
    html! {
        section .sheet {
            h2 { "Results at the computed " (report.parameter()) "s" }
            div .scroll tabindex="0" role="region" aria-label="Results" {
                table .results {
                    thead {
                        tr {
                            th scope="col" { (report.parameter()) span .unit { (if report.unit().is_empty() { "–" } else { report.unit() }) } }
                            @for column in &columns { th scope="col" { (column.heading) span .unit { (column.unit) } } }
                            th scope="col" { "iterations" span .unit { "–" } }
                        }
                    }
                    tbody {
                        @for (step, is_on_the_way, row) in &rows {
                            tr .missed[row.is_none()] {
                                th scope="row" {
                                    (number(step.when()))
                                    @if *is_on_the_way { " " span .unit { "on the way" } }
                                    @match step.kind {
                                        StateKind::Requested => {},
                                        StateKind::GreatestLoad => { " " span .unit { "limit point, greatest" } },
                                        StateKind::LeastLoad => { " " span .unit { "limit point, least" } },
                                        StateKind::PastLimit => { " " span .unit { "past the limit" } },
                                    }
                                }
                                @match row {
                                    Some(row) => @for column in &columns { td { (column.cells[*row]) } },
                                    None => td colspan=(columns.len()) { "not reached" },
                                }
                                td { (step.iterations) }
                            }
                        }
                    }
                }
            }
            @if !report.problem.symmetry.is_empty() {
                p .note {
                    "Areas, volumes, forces and energies are those of the whole " (report.noun()) ", of which one "
                    (report.problem.modelled_part()) " was modelled (symmetric to " (planes(report)) ")."
                }
            }
            @if report.problem.obstacles.iter().any(|thing| report.problem.symmetry.iter().any(|plane| !plane.is_symmetry_of(thing))) {
                p .note { "An obstacle beside the plane of symmetry stands for two: the force is that on one of them." }
            }
            @if report.summary.has_turned() {
                p .note {
                    "From the first limit point on, states stand in the order in which the path comes to them: the " (report.parameter())
                    " falls there while the " (report.noun()) " goes on to deform. Where it falls, the body does not stay by itself at that "
                    (report.parameter()) "."
                }
            }
            @if !on_the_way.is_empty() {
                p .note {
                    "States on the way were not asked for: they lie between the last " (report.parameter()) " that was reached and where the \
                     run ended. They are solved to the tolerances, the last one as far as was possible."
                }
            }
            p .note {
                "99 % of the volume carries no more than the von Mises stress, 99 %. The largest value sits at a sharp inner \
                 edge as a rule and grows as the mesh is refined."
            }
        }
    }
}

fn columns(report: &Report<'_>) -> Vec<Column> {
    let summary = report.summary;
    let is_model = report.problem.clock == Clock::Steps;
    let whole = || summary.reached().map(|(_, reached)| reached);
    let reached = || whole().map(|step| &step.found);
    let one = |heading: &str, unit, decimals, of: &dyn Fn(&Found) -> Option<f64>| {
        Column::new(heading, unit, decimals, reached().map(|step| of(step).map(|x| [x])))
    };
    let mut columns = Vec::new();
    if !is_model || reached().any(|step| step.end_face_angle_deg.is_some()) {
        columns.push(one("end-face angle", "°", 2, &|step| step.end_face_angle_deg));
        columns.push(one("chord angle", "°", 2, &Found::chord_angle_deg));
    }
    for name in names(reached().map(|step| step.cavities.keys())) {
        let cavity = |step: &Found| step.cavities.get(name).copied();
        columns.push(one(&format!("{name}: pressure"), "kPa", 2, &|step| cavity(step)?.pressure_kpa));
        if reached().any(|step| cavity(step).is_some_and(|cavity| cavity.volume_mm3.is_some())) {
            let volume = |step: &Found| cavity(step)?.volume_mm3;
            columns.push(one(&format!("{name}: volume"), "mm³", 1, &volume));
        }
    }
    for name in summary.probes.keys() {
        let of = reached().map(|step| step.probes.get(name).copied());
        columns.push(Column::new(&format!("{name}: displacement x, y, z"), "mm", 3, of));
    }
    for name in names(reached().map(|step| step.reactions.keys())) {
        let of = reached().map(|step| step.reactions.get(name).copied());
        columns.push(Column::new(&format!("{name}: reaction x, y, z"), "N", 3, of));
    }
    if is_model {
        for name in names(reached().map(|step| step.symmetry_reactions.keys())) {
            let of = reached().map(|step| step.symmetry_reactions.get(name).copied());
            columns.push(Column::new(&format!("across {name}: force x, y, z"), "N", 3, of));
        }
    }
    for name in names(reached().map(|step| step.obstacles.keys())) {
        let of = reached().map(|step| step.obstacles.get(name)?.force_n);
        columns.push(Column::new(&format!("{name}: force on it x, y, z"), "N", 3, of));
        let area = |step: &Found| step.obstacles.get(name)?.area_mm2;
        columns.push(one(&format!("{name}: contact area"), "mm²", 1, &area));
    }
    let p99 = whole().map(|step| Some([step.von_mises_p99_mpa]));
    columns.push(Column::new("von Mises, 99 %", "MPa", 4, p99));
    let largest = whole().map(|step| Some([step.max_von_mises_mpa]));
    columns.push(Column::new("von Mises, largest", "MPa", 4, largest));
    if report.has_walls() {
        columns.push(one("contact area", "mm²", 1, &|step| Some(step.contact.area_mm2)));
        let gaps = if is_model { "pairs in contact" } else { "gaps in contact" };
        let count = |gaps: Option<usize>| gaps.map_or_else(|| "–".to_owned(), |gaps| gaps.to_string());
        let cells = reached().map(|step| count(step.contact.gaps_in_contact)).collect();
        columns.push(Column { heading: gaps.into(), unit: "–", cells });
        columns.push(one("penetration", "mm", 4, &|step| step.contact.max_penetration_mm));
    }
    if !is_model {
        columns.push(one("air volume", "cm³", 3, &|step| Some(step.cavity_volume_mm3 / 1000.0)));
    }
    columns
}

/// The planes of symmetry in words.
fn planes(report: &Report<'_>) -> String {
    report.problem.symmetry.iter().map(SymmetryPlane::words).collect::<Vec<_>>().join(", ")
}

/// All names, each once.
fn names<'a>(keys: impl Iterator<Item = impl Iterator<Item = &'a String>>) -> Vec<&'a String> {
    let mut names: Vec<&String> = keys.flatten().collect();
    names.sort_unstable();
    names.dedup();
    names
}
