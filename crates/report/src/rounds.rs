//! The page of a search for a design: the shape of every round beside the curve that is wanted, what was aimed at and the variables over the rounds,
//! why it ended, and what it ended with.

use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use crate::controls::slider;
use crate::curves::Plot;
use crate::error::ReportError;
use crate::page::{MOON, document};
use crate::payload::{ClockData, for_script};
use crate::series::Series;

/// Points of the line of a round: all rounds have as many, whatever their meshes.
pub const POINTS: usize = 61;

/// What the page of a search is made of.
#[derive(Clone, Debug)]
pub struct Rounds<'a> {
    /// What it is a search for.
    pub title: &'a str,
    /// The file that is varied, and how many rounds there are.
    pub about: &'a str,
    /// Why it ended.
    pub why: &'a str,
    /// Whether it came to what was wanted.
    pub is_good: bool,
    /// By rounds with results the bottom centreline, \[x, z\] in mm from the clamp to the tip; empty for a body without one.
    pub lines: &'a [Vec<[f64; 2]>],
    /// Curves that lines are to follow.
    pub wanted: &'a [Vec<[f64; 2]>],
    /// Number of rounds with results.
    pub count: usize,
    /// What is said beside the slider, by rounds.
    pub key_numbers: Vec<Plot>,
    /// What is plotted over the rounds.
    pub plots: Vec<Plot>,
    /// Tables below.
    pub tables: &'a [Table],
}

/// A table of texts.
#[derive(Clone, Debug)]
pub struct Table {
    /// What it holds.
    pub heading: &'static str,
    /// Heads of its columns.
    pub columns: Vec<&'static str>,
    /// Its rows, the first cell of each a name.
    pub rows: Vec<Vec<String>>,
}

#[derive(Serialize)]
struct Data<'a> {
    title: &'a str,
    clock: ClockData<'a>,
    series: Series,
    wanted: &'a [Vec<[f64; 2]>],
}

/// The page as the text of an HTML file.
///
/// # Errors
/// Numbers that are not finite.
pub fn render(rounds: &Rounds<'_>) -> Result<String, ReportError> {
    let lines: Vec<Vec<[f64; 2]>> = rounds.lines.iter().map(|line| evenly(line)).collect();
    let centrelines = (lines.len() == rounds.count && lines.iter().all(|line| line.len() == POINTS)).then_some(lines);
    let times: Vec<f64> = (0..rounds.count).map(|round| round as f64).collect();
    let series = Series {
        places: times.clone(),
        times,
        parameters: None,
        on_the_way: 0,
        centrelines,
        key_numbers: rounds.key_numbers.clone(),
        plots: rounds.plots.clone(),
        more: Vec::new(),
    };
    if !series.is_finite() || !rounds.wanted.iter().flatten().flatten().all(|x| x.is_finite()) {
        return Err(ReportError::NotFinite("history.json".into()));
    }
    let clock = ClockData { name: "round", unit: "", rest: Some("at the start"), decimals: Some(1), parameters: None };
    let data = Data { title: rounds.title, clock, series, wanted: rounds.wanted };
    let data = serde_json::to_string(&data).map_err(|e| ReportError::Json(e.to_string()))?;
    Ok(document(&format!("{} – pneuflex", rounds.title), &body(rounds), &for_script(&data), "main"))
}

fn body(rounds: &Rounds<'_>) -> Markup {
    html! {
        header .masthead {
            div .titles { h1 { (rounds.title) } p { (rounds.about) } }
            p .status .bad[!rounds.is_good] { @if rounds.is_good { "found" } @else { "not met" } }
            button #theme .icon type="button" aria-label="Light or dark" title="Light or dark" { (PreEscaped(MOON)) }
        }
        section .notice .failure[!rounds.is_good] { p { "Why it ended: " (rounds.why) "." } }
        noscript { p .notice { "The plots need JavaScript. The tables below do not." } }
        main {
            section .rounds aria-label="Rounds" { (slider("Round")) }
            section #plots .plots .more-plots aria-label="Plots over the rounds" {}
            section #more-plots .plots .more-plots aria-label="Plots over the rounds, continued" hidden {}
            @for table in rounds.tables.iter().filter(|table| !table.rows.is_empty()) { (section(table)) }
        }
    }
}

fn section(table: &Table) -> Markup {
    html! {
        section .sheet {
            h2 { (table.heading) }
            div .scroll tabindex="0" role="region" aria-label=(table.heading) {
                table .results {
                    thead { tr { @for column in &table.columns { th scope="col" { (column) } } } }
                    tbody {
                        @for row in &table.rows {
                            tr {
                                @for (i, cell) in row.iter().enumerate() {
                                    @if i == 0 { th scope="row" { (cell) } } @else { td { (cell) } }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// As many points at equal distances along a line; none of a line without a length.
fn evenly(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut along = vec![0.0];
    for pair in line.windows(2) {
        along.push(along[along.len() - 1] + (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
    }
    let length = along[along.len() - 1];
    if line.len() < 2 || length <= 0.0 || !length.is_finite() {
        return Vec::new();
    }
    let at = |i: usize| {
        let wanted = length * i as f64 / (POINTS - 1) as f64;
        let end = along.partition_point(|distance| *distance < wanted).clamp(1, line.len() - 1);
        let share = (wanted - along[end - 1]) / (along[end] - along[end - 1]);
        [0, 1].map(|d| line[end - 1][d] + share * (line[end][d] - line[end - 1][d]))
    };
    (0..POINTS).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::Curve;

    fn page(values: Vec<f64>, why: &str) -> Result<String, ReportError> {
        let line = |z: f64| vec![[0.0, 0.0], [3.0, 0.0], [3.0, z]];
        let curves = vec![Curve { name: String::new(), values: values.into_iter().map(Some).collect() }];
        let plot = Plot { name: "Objective".into(), unit: "", from_zero: true, over: None, curves };
        render(&Rounds {
            title: "<b>hook",
            about: "case.toml",
            why,
            is_good: false,
            lines: &[line(-1.0), line(-4.0)],
            wanted: &[line(-3.0)],
            count: 2,
            key_numbers: vec![plot.clone()],
            plots: vec![plot],
            tables: &[Table {
                heading: "Variables",
                columns: vec!["", "value"],
                rows: vec![vec!["actuator.base".into(), "4".into()]],
            }],
        })
    }

    #[test]
    fn the_page_has_the_rounds_the_wanted_curve_and_why_it_ended() {
        let html = page(vec![2.0, 1.0], "no step <makes> it better").unwrap();
        assert!(html.contains("Why it ended: no step &lt;makes&gt; it better.") && !html.contains("<b>hook"));
        assert!(html.contains("<th scope=\"row\">actuator.base</th><td>4</td>"));
        let data = html.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!((&data["clock"]["name"], &data["clock"]["rest"]), (&"round".into(), &"at the start".into()));
        assert_eq!(data["series"]["times"], serde_json::json!([0.0, 1.0]));
        // 7 mm in 60 pieces; the corner is 3 mm along.
        let line = &data["series"]["centrelines"][1];
        assert_eq!(line.as_array().unwrap().len(), POINTS);
        assert_eq!((&line[60], &line[30][0]), (&serde_json::json!([3.0, -4.0]), &3.0.into()));
        assert_eq!(data["wanted"][0][2], serde_json::json!([3.0, -3.0]));
        assert!(page(vec![f64::NAN, 1.0], "").is_err());
    }
}
