//! `pneuflex table`: the numbers of result folders, one row per pressure or time, several runs side by side.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use pneuflex::columns::{Tip, columns as numbers, columns_of_load_step};
use pneuflex::model::StateKind;
use pneuflex::recorded_states::{Place, RecordedState, RecordedStates};
use pneuflex::{InputError, Pairs, Study, json};
use serde_json::Value;

use crate::args::{TableArguments, TableForm};
use crate::error::CliError;

/// Quantities that a text has where none are asked for.
const USUAL: [&str; 7] =
    ["end_face_angle_deg", "chord_angle_deg", "tip", "probe", "cavity", "obstacle", "von_mises_p99_mpa"];

/// What a text has beside the stress where it would have nothing else.
const OTHERWISE: &str = "reaction";

/// Digits that count in the largest number of a column of a text.
const DIGITS: i32 = 5;

/// A component of a vector below this share of the largest one is rounding.
const ROUNDING: f64 = 1e-9;

/// Prints the table.
///
/// # Errors
/// A folder that is none of this program's, runs that have no row in common, a column that is nowhere.
pub fn table(arguments: &TableArguments) -> Result<(), CliError> {
    let runs = arguments
        .results
        .iter()
        .map(|folder| Run::read(folder, arguments.load_steps))
        .collect::<Result<Vec<_>, _>>()?;
    let mut table = if let [run] = &runs[..] { Table::of(run) } else { Table::side_by_side(&runs)? };
    match (&arguments.columns, arguments.form) {
        (Some(wanted), _) => table.choose(wanted)?,
        (None, TableForm::Text) => table.keep_usual(),
        (None, _) => {}
    }
    let text = match arguments.form {
        TableForm::Text => table.text(),
        TableForm::Csv => table.csv().map_err(CliError::Output)?,
        TableForm::Json => table.json().map_err(CliError::Output)?,
    };
    // Nobody reading on is no error.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(())
}

/// A run, and a row for each of its states.
struct Run {
    name: String,
    folder: String,
    parameter: &'static str,
    has_turned: bool,
    rows: Vec<(f64, Pairs)>,
}

impl Run {
    fn read(folder: &Path, with_load_steps: bool) -> Result<Self, CliError> {
        let recorded = RecordedStates::read(folder)?;
        let tip = Tip::of(&Study::load(folder.join("case.toml"))?);
        let is_plain =
            |state: &RecordedState| state.numbers.is_some() && state.place == Place::OnPath(StateKind::Requested);
        let load_steps = recorded.load_steps.iter().filter(|_| with_load_steps);
        let says_which = load_steps.clone().next().is_some() || !recorded.states.iter().all(is_plain);
        let parameter = if recorded.is_by_time { "time" } else { "pressure_kpa" };
        let rows = recorded.states.iter().map(|state| {
            let mut row = Pairs::default();
            if says_which {
                row.0.push(("state".into(), which(state).into()));
            }
            let found = state.numbers.as_ref().map(|found| numbers(found, &tip)).unwrap_or_default();
            row.0.extend(found.0.into_iter().filter(|(name, _)| name != parameter));
            (state.parameter, row)
        });
        let mut rows: Vec<(f64, Pairs)> = rows.collect();
        for step in load_steps {
            let mut row = Pairs::default();
            row.0.push(("state".into(), "load step".into()));
            row.0.extend(columns_of_load_step(step, &tip).0.into_iter().filter(|(name, _)| name != parameter));
            let at = step.when().0;
            let is_beyond = |row: &(f64, Pairs)| row.0 > at;
            // Among what the path has come to: what it missed comes last.
            let place = rows.iter().position(is_beyond).unwrap_or(rows.len());
            if rows.iter().all(|row| row.0 != at) {
                rows.insert(place, (at, row));
            }
        }
        let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
        let path = folder.display().to_string();
        Ok(Self {
            name: name.unwrap_or_else(|| path.clone()),
            has_turned: recorded.has_turned(),
            rows,
            folder: path,
            parameter,
        })
    }
}

/// Why a state is among the results, in words.
fn which(state: &RecordedState) -> &'static str {
    match state.place {
        _ if state.numbers.is_none() => "not reached",
        Place::OnTheWay => "on the way",
        Place::OnPath(StateKind::Requested) => "reached",
        Place::OnPath(StateKind::GreatestLoad) => "greatest load",
        Place::OnPath(StateKind::LeastLoad) => "least load",
        Place::OnPath(StateKind::PastLimit) => "past the limit",
    }
}

/// A column: what stands above it, which quantity it is of, and its values.
struct Column {
    heading: String,
    quantity: String,
    values: Vec<Value>,
}

impl Column {
    fn largest(&self) -> f64 {
        self.values.iter().filter_map(Value::as_f64).fold(0.0, |a, b| a.max(b.abs()))
    }

    /// What its numbers are the components of.
    fn vector(&self) -> &str {
        self.heading.rsplit_once('.').map_or(&self.heading, |(vector, _)| vector)
    }

    /// Its cells in a text: numbers with the same number of decimals.
    fn cells(&self) -> Vec<String> {
        let largest = self.largest();
        let needed = if largest > 0.0 { DIGITS - 1 - largest.log10().floor() as i32 } else { 0 };
        let decimals = needed.clamp(0, 12) as usize;
        let cell = |value: &Value| match value {
            Value::Null => String::new(),
            Value::String(text) => text.clone(),
            // Zero has no sign.
            Value::Number(number) if number.is_f64() => {
                format!("{:.decimals$}", number.as_f64().filter(|x| x.abs() > ROUNDING * largest).unwrap_or(0.0))
            }
            other => other.to_string(),
        };
        self.values.iter().map(cell).collect()
    }
}

struct Table {
    parameter: Column,
    columns: Vec<Column>,
}

impl Table {
    /// A row for every state of a run.
    fn of(run: &Run) -> Self {
        let parameters = run.rows.iter().map(|(parameter, _)| (*parameter).into()).collect();
        Self::new(
            run.parameter,
            parameters,
            columns(&run.rows.iter().map(|(_, row)| Some(row)).collect::<Vec<_>>(), ""),
        )
    }

    /// A row for every pressure that one of the runs has.
    fn side_by_side(runs: &[Run]) -> Result<Self, CliError> {
        let [first, rest @ ..] = runs else { return Err(InputError::new("table: no result folder is named").into()) };
        if let Some(other) = rest.iter().find(|run| run.parameter != first.parameter) {
            let [one, two] = [first, other].map(|run| format!("{} has rows by {}", run.folder, run.parameter));
            return Err(InputError::new(format!("{one}, {two}: they cannot stand side by side")).into());
        }
        if let Some(run) = runs.iter().find(|run| run.has_turned) {
            let why = "its load turns back, so that several rows share a pressure or time";
            let help = Some("make a table of it alone".to_owned());
            return Err(InputError::about_file(Path::new(&run.folder), why).with_help(help).into());
        }
        let mut parameters: Vec<f64> = runs.iter().flat_map(|run| run.rows.iter().map(|row| row.0)).collect();
        parameters.sort_by(f64::total_cmp);
        parameters.dedup();
        let mut names: BTreeMap<&str, usize> = BTreeMap::new();
        runs.iter().for_each(|run| *names.entry(&run.name).or_default() += 1);
        let columns = runs.iter().flat_map(|run| {
            let name = if names[run.name.as_str()] == 1 { &run.name } else { &run.folder };
            let row = |parameter: &f64| run.rows.iter().find(|row| row.0 == *parameter).map(|row| &row.1);
            columns(&parameters.iter().map(row).collect::<Vec<_>>(), name)
        });
        let columns = columns.collect();
        Ok(Self::new(first.parameter, parameters.into_iter().map(Value::from).collect(), columns))
    }

    fn new(parameter: &str, values: Vec<Value>, columns: Vec<Column>) -> Self {
        let parameter = Column { heading: parameter.into(), quantity: parameter.into(), values };
        Self { parameter, columns }
    }

    /// Keeps what is asked for, in that order. A name stands for everything that begins with it and a full stop, too.
    fn choose(&mut self, wanted: &[String]) -> Result<(), CliError> {
        let is = |column: &Column, name: &str| {
            column.quantity == name || column.quantity.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'))
        };
        for name in wanted {
            if !self.columns.iter().any(|column| is(column, name)) {
                let mut known: Vec<&str> = self.columns.iter().map(|column| column.quantity.as_str()).collect();
                known.sort_unstable();
                known.dedup();
                let help = Some(format!("there are {}", known.join(", ")));
                return Err(InputError::new(format!("--columns {name}: no such column")).with_help(help).into());
            }
        }
        let place = |column: &Column| wanted.iter().position(|name| is(column, name));
        self.columns.retain(|column| place(column).is_some());
        self.columns.sort_by_key(|column| place(column));
        Ok(())
    }

    /// Keeps the usual quantities, those of runs that stopped with the words for it, and of vectors the components that are there.
    fn keep_usual(&mut self) {
        let mut largest: BTreeMap<String, f64> = BTreeMap::new();
        for column in &self.columns {
            let of_vector = largest.entry(column.vector().to_owned()).or_default();
            *of_vector = of_vector.max(column.largest());
        }
        let has_tip = self.columns.iter().any(|column| column.quantity.starts_with("tip."));
        let first = |column: &Column| column.quantity.split('.').next().unwrap_or_default().to_owned();
        let is_telling = |column: &Column| USUAL[..USUAL.len() - 1].contains(&first(column).as_str());
        let otherwise = if self.columns.iter().any(is_telling) { "" } else { OTHERWISE };
        self.columns.retain(|column| {
            let quantity = column.quantity.split('.').next().unwrap_or_default();
            let is_there = column.largest() > ROUNDING * largest[column.vector()];
            // The probe of that name is the tip, as a rule, and stands there as such.
            let is_twice =
                column.quantity.strip_prefix("probe.").is_some_and(|probe| probe.starts_with("tip.")) && has_tip;
            column.quantity == "state"
                || ((USUAL.contains(&quantity) || quantity == otherwise) && is_there && !is_twice)
        });
        let place = |column: &Column| {
            let quantity = column.quantity.split('.').next().unwrap_or_default();
            (quantity != "state").then(|| USUAL.iter().position(|usual| *usual == quantity))
        };
        self.columns.sort_by_key(|column| place(column));
    }

    fn all(&self) -> impl Iterator<Item = &Column> {
        std::iter::once(&self.parameter).chain(&self.columns)
    }

    fn text(&self) -> String {
        let columns: Vec<(Vec<String>, bool)> = self
            .all()
            .map(|column| {
                let is_text = column.values.iter().any(Value::is_string);
                ([vec![column.heading.clone()], column.cells()].concat(), is_text)
            })
            .collect();
        let width = |cells: &[String]| cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        let mut text = String::new();
        for row in 0..=self.parameter.values.len() {
            let cells = columns.iter().map(|(cells, is_text)| {
                let (cell, width) = (&cells[row], width(cells));
                if *is_text { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            text += cells.collect::<Vec<_>>().join("  ").trim_end();
            text.push('\n');
        }
        text
    }

    fn csv(&self) -> Result<String, String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.all().map(|column| &column.heading)).map_err(|e| e.to_string())?;
        for row in 0..self.parameter.values.len() {
            let cell = |column: &Column| match &column.values[row] {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            writer.write_record(self.all().map(cell)).map_err(|e| e.to_string())?;
        }
        String::from_utf8(writer.into_inner().map_err(|e| e.to_string())?).map_err(|e| e.to_string())
    }

    fn json(&self) -> Result<String, String> {
        let row = |row: usize| {
            let there = self.all().filter(|column| !column.values[row].is_null());
            Pairs(there.map(|column| (column.heading.clone(), column.values[row].clone())).collect())
        };
        json::pretty(&(0..self.parameter.values.len()).map(row).collect::<Vec<_>>())
    }
}

/// The columns of some rows, in the order in which they come up; of a run with a name, which stands before theirs.
fn columns(rows: &[Option<&Pairs>], run: &str) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    for quantity in rows.iter().flatten().flat_map(|row| row.0.iter().map(|(name, _)| name)) {
        if columns.iter().any(|column| column.quantity == *quantity) {
            continue;
        }
        let values = rows.iter().map(|row| row.and_then(|row| row.get(quantity)).cloned().unwrap_or_default());
        let heading = if run.is_empty() { quantity.clone() } else { format!("{run}: {quantity}") };
        columns.push(Column { heading, quantity: quantity.clone(), values: values.collect() });
    }
    columns
}
