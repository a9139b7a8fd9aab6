//! The table of a sweep: one row for every reached state of every design, one for a design without any.

use serde_json::Value;

use crate::plan::Plan;
use crate::row::Row;

/// Columns behind the numbers of the states, whichever design had those first.
const LAST: [&str; 5] = ["reason", "message", "seconds", "cpu_seconds", "threads"];

/// The table as CSV.
///
/// # Errors
/// What the writer says.
pub fn csv(plan: &Plan, rows: &[Row]) -> Result<String, String> {
    let has_neighbours = rows.iter().any(|row| row.started_from.is_some());
    let number_of = |identity: &String| plan.designs.iter().position(|entry| entry.identity == *identity);
    let rows: Vec<Vec<(&str, String)>> = plan
        .designs
        .iter()
        .zip(rows)
        .enumerate()
        .flat_map(|(number, (entry, row))| {
            let inputs = entry.inputs.0.iter().map(|(name, value)| (name.as_str(), text(value)));
            let head =
                [("design", number.to_string())].into_iter().chain(inputs).chain([("status", row.status.clone())]);
            let neighbour = row.started_from.as_ref().and_then(number_of).map_or_else(String::new, |n| n.to_string());
            let head = head.chain(has_neighbours.then_some(("started_from", neighbour)));
            let number = |value: Option<f64>| value.map_or_else(String::new, |value| text(&value.into()));
            let threads = row.threads.map_or_else(String::new, |threads| threads.to_string());
            let tail = [row.reason.clone().unwrap_or_default(), row.message.clone()];
            let tail = tail.into_iter().chain([number(row.seconds), number(row.cpu_seconds), threads]);
            let (head, tail): (Vec<_>, Vec<_>) = (head.collect(), LAST.into_iter().zip(tail).collect());
            let states: Vec<Vec<(&str, String)>> = if row.states.is_empty() {
                vec![Vec::new()]
            } else {
                row.states
                    .iter()
                    .map(|s| s.0.iter().map(|(name, value)| (name.as_str(), text(value))).collect())
                    .collect()
            };
            states.into_iter().map(move |state| [head.clone(), state, tail.clone()].concat())
        })
        .collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !names.contains(name) {
            names.push(name);
        }
    }
    names.retain(|name| !LAST.contains(name));
    names.extend(LAST);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&names).map_err(|error| error.to_string())?;
    for row in &rows {
        let cell = |name: &&str| row.iter().rev().find(|(other, _)| other == name).map_or("", |(_, text)| text);
        writer.write_record(names.iter().map(cell)).map_err(|error| error.to_string())?;
    }
    let bytes = writer.into_inner().map_err(|error| error.to_string())?;
    String::from_utf8(bytes).map_err(|error| error.to_string())
}

/// A value as a cell: a text as it is, nothing for nothing, lists and tables as JSON.
fn text(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
