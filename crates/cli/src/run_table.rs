//! What a run has found, as a small table for a terminal: a row for each of its states.

use pneuflex::model::Clock;
use pneuflex::post::summary::StepSummary;

/// Rows that are shown; of more, the first and the last ones.
const ROWS: usize = 12;

/// Obstacles whose forces are shown: more columns make a line too long.
const OBSTACLES: usize = 2;

/// Letters of an obstacle's name.
const NAME: usize = 12;

/// What a column is called, and what it has for a state.
type Column = (String, Box<dyn Fn(&StepSummary) -> Option<String>>);

/// The lines of the table; none without states.
pub fn lines(clock: Clock, states: &[StepSummary]) -> Vec<String> {
    if states.is_empty() {
        return Vec::new();
    }
    let mut columns: Vec<Column> = match clock {
        Clock::Pressure => vec![("kPa".into(), Box::new(|state| Some(short(state.pressure_kpa))))],
        Clock::Steps => vec![("time".into(), Box::new(|state| state.time.map(short)))],
    };
    let has_air = |state: &StepSummary| state.pressure_kpa != 0.0;
    if clock == Clock::Steps && states.iter().any(has_air) {
        columns.push(("kPa".into(), Box::new(|state| Some(short(state.pressure_kpa)))));
    }
    let angle = |deg: f64| format!("{deg:.2}");
    columns.push(("end face, deg".into(), Box::new(move |state| state.end_face_angle_deg.map(angle))));
    columns.push(("chord, deg".into(), Box::new(move |state| state.chord_angle_deg().map(angle))));
    // A body without angles is told by where its first probe went.
    if let Some(probe) = states[0].probes.keys().next().filter(|_| states[0].end_face_angle_deg.is_none()).cloned() {
        let name = format!("{}, mm", cut(&probe));
        columns.push((name, Box::new(move |state| state.probes.get(&probe).map(|u| format!("{:.3}", length(*u))))));
    }
    for obstacle in states[0].obstacles.keys().take(OBSTACLES) {
        let (name, obstacle) = (format!("{}, N", cut(obstacle)), obstacle.clone());
        let force = move |state: &StepSummary| Some(format!("{:.4}", length(state.obstacles.get(&obstacle)?.force_n)));
        columns.push((name, Box::new(force)));
    }
    let area = |state: &StepSummary| {
        state.contact.area_mm2 + state.obstacles.values().map(|found| found.area_mm2).sum::<f64>()
    };
    if states.iter().any(|state| area(state) > 0.0) {
        columns.push(("contact, mm2".into(), Box::new(move |state| Some(format!("{:.1}", area(state))))));
    }
    columns.push(("99 % stress, MPa".into(), Box::new(|state| Some(format!("{:.4}", state.von_mises_p99_mpa)))));
    columns.retain(|(_, cell)| states.iter().any(|state| cell(state).is_some()));

    let widths: Vec<usize> = columns
        .iter()
        .map(|(name, cell)| {
            let cells = states.iter().filter_map(cell).map(|cell| cell.len()).max().unwrap_or(0);
            cells.max(name.chars().count())
        })
        .collect();
    let row = |cells: Vec<String>| {
        let cells: Vec<String> = cells.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        format!("  {}", cells.join("  "))
    };
    let mut lines = vec![row(columns.iter().map(|(name, _)| name.clone()).collect())];
    let left_out = states.len().saturating_sub(ROWS);
    for (number, state) in states.iter().enumerate() {
        if left_out > 0 && number == ROWS / 2 {
            lines.push(format!("  ... {left_out} more"));
        }
        if left_out == 0 || number < ROWS / 2 || number >= ROWS / 2 + left_out {
            lines.push(row(columns.iter().map(|(_, cell)| cell(state).unwrap_or_else(|| "-".into())).collect()));
        }
    }
    lines
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn short(number: f64) -> String {
    pneuflex::words::rounded(number, 4).to_string()
}

fn cut(name: &str) -> String {
    name.chars().take(NAME).collect()
}
