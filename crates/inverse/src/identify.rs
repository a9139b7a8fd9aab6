//! Constants and lengths from measurements: weighted least squares, and how exactly they are known.

use std::path::Path;

use nalgebra::{DMatrix, DVector};
use pneuflex::calibration::regression::{Reduced, Statistics};
use pneuflex::document::{Document, Written};
use pneuflex::folder::IDENTIFIED;
use pneuflex::gradient::Request;
use pneuflex::model::CaseError;
use pneuflex::{Change, Error, InputError, MemoryLimit, ResultsError, StopToken, json};
use pneuflex_sweep::node::{Node, placed};
use serde::{Deserialize, Serialize};

use crate::designs::{Designs, Setup};
use crate::history::Tried;
use crate::measurements::{self, Measured};
use crate::minimise::{Found, Judged, Why};
use crate::search::{Best, MOST, Progress, Search, base};
use crate::variables::{Variable, variables};

/// Variables nearer to a bound than this share of the way between their bounds are at it.
const AT_BOUND: f64 = 1e-6;

/// Directions in which all measurements together change by less than this share of the most are hardly told apart: their error is so much larger.
const HARDLY: f64 = 1e-2;

/// Shares of a direction from which on a variable has part in it.
const PART: f64 = 0.3;

/// What a file of an identification says.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentifyFile {
    /// Case or model file, beside this file.
    case: String,
    /// Table of what was measured, beside this file.
    data: String,
    /// Columns of it that count; all if nothing is said.
    #[serde(default)]
    columns: Option<Vec<String>>,
    /// Solutions at the most.
    #[serde(default)]
    solutions: Option<i64>,
    /// Keys that all designs have in common.
    #[serde(default)]
    set: Node,
    /// What is looked for.
    variables: Node,
    /// Standard deviations of columns.
    #[serde(default)]
    noise: Node,
}

impl Document for IdentifyFile {
    fn problems(&self) -> Vec<CaseError> {
        let mut found = variables(&self.variables).err().unwrap_or_default();
        found.extend(self.deviations().err().unwrap_or_default());
        found.extend(wrong_solutions(self.solutions));
        found
    }
}

impl IdentifyFile {
    /// Standard deviations by columns.
    fn deviations(&self) -> Result<Vec<(String, f64)>, Vec<CaseError>> {
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for (column, node) in self.noise.leaves() {
            let value = node.value();
            let number = value.as_float().or(value.as_integer().map(|whole| whole as f64));
            match number.filter(|number| *number > 0.0 && number.is_finite()) {
                Some(number) => found.push((column, number)),
                None => wrong.push(CaseError {
                    key: format!("noise.{column}"),
                    value: value.to_string(),
                    allowed: "must be a standard deviation above 0, in the unit of the column".into(),
                }),
            }
        }
        if wrong.is_empty() { Ok(found) } else { Err(wrong) }
    }
}

/// What is wrong with a number of solutions.
pub(crate) fn wrong_solutions(solutions: Option<i64>) -> Option<CaseError> {
    let wrong = solutions.filter(|solutions| !(1..=10_000).contains(solutions))?;
    let allowed = "must be a whole number from 1 to 10000".to_owned();
    Some(CaseError { key: "solutions".into(), value: wrong.to_string(), allowed })
}

/// An identification that is ready to begin.
pub struct Identification {
    file: Written<IdentifyFile>,
    designs: Designs,
    measured: Vec<Measured>,
    /// For every measurement the number of its result.
    of_measured: Vec<usize>,
    /// For every measurement what its errors are large against.
    deviations: Vec<f64>,
    columns: Vec<String>,
}

/// What was identified.
#[derive(Clone, Debug, Serialize)]
pub struct Identified {
    /// Why the search ended.
    pub why: Why,
    /// Designs that were solved.
    pub solutions: usize,
    /// Root mean square of the errors over their standard deviations, where these are given; else over the columns' own.
    pub misfit: f64,
    /// The columns.
    pub columns: Vec<Column>,
    /// What was looked for.
    pub values: Vec<Value>,
    /// Correlations of those that are not at a bound, in their order; empty if they are not known.
    pub correlation: Vec<Vec<f64>>,
    /// Singular values of the Jacobian, every variable in units of its own effect: 1 for all if every one does something else.
    pub singular_values: Vec<f64>,
    /// What the measurements do not tell, in words.
    pub untold: Vec<String>,
}

/// A column of measurements.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Measurements.
    pub count: usize,
    /// Root mean square of what is left, in its unit.
    pub left: f64,
}

/// A value that was identified.
#[derive(Clone, Debug, Serialize)]
pub struct Value {
    /// The variable.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Where the search began.
    pub start: f64,
    /// Whether it is at a bound, where it has no interval.
    pub is_at_bound: bool,
    /// Standard error; left out where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
    /// Half width of the 95 % confidence interval (Student's t).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_width: Option<f64>,
}

impl Identification {
    /// Reads a file, with changes to what its designs have in common, and checks everything that can be before anything is solved.
    ///
    /// # Errors
    /// Everything that is wrong with it, with the case and with the measurements.
    pub fn load(path: &Path, changes: &[Change], limit: MemoryLimit, stop: &StopToken) -> Result<Self, Error> {
        let file = Written::<IdentifyFile>::load(path, &[])?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let said = &file.case;
        let data = folder.join(&said.data);
        let measured = measurements::read(&data, said.columns.as_deref())?;
        let mut columns: Vec<String> = Vec::new();
        let mut requests: Vec<Request> = Vec::new();
        let mut of_measured = Vec::new();
        for Measured { column, at, .. } in &measured {
            if !columns.contains(column) {
                columns.push(column.clone());
            }
            let request = Request { column: column.clone(), at: Some(*at) };
            let known = requests.iter().position(|other| *other == request);
            of_measured.push(known.unwrap_or(requests.len()));
            if known.is_none() {
                requests.push(request);
            }
        }
        let given = said.deviations().unwrap_or_default();
        if let Some((column, _)) = given.iter().find(|(column, _)| !columns.contains(column)) {
            let allowed = format!("must be of a column that was measured: {}", columns.join(", "));
            return Err(file
                .out_of_range(&CaseError { key: format!("noise.{column}"), value: column.clone(), allowed })
                .into());
        }
        let deviation = |Measured { column, .. }: &Measured| {
            given
                .iter()
                .find(|(other, _)| other == column)
                .map_or_else(|| size_of(column, &measured), |(_, given)| *given)
        };
        let deviations = measured.iter().map(deviation).collect();
        let variables = variables(&said.variables).unwrap_or_default();
        if variables.len() > measured.len() {
            let what = format!("{} measurements are too few for {} variables", measured.len(), variables.len());
            return Err(InputError::about_file(&data, what).into());
        }
        let base = base(folder.join(&said.case), &said.set, changes);
        let positions = measurements::positions(&measured);
        let setup = Setup { base, variables: variables.clone(), requests, positions, limit };
        let designs = Designs::new(setup, stop).map_err(|error| in_file(&file, &said.set, &variables, error))?;
        Ok(Self { designs, measured, of_measured, deviations, columns, file })
    }

    /// Name of the file without folder and extension.
    pub fn stem(&self) -> String {
        self.file.stem()
    }

    /// Identifies, in a folder; with `resume` what it holds of this search is not solved again.
    ///
    /// # Errors
    /// [`Error::Interrupted`]; a folder that cannot be used; a first design without results; what is no fault of a design.
    pub fn run(self, folder: (&Path, bool), listener: &mut dyn FnMut(&Progress<'_>)) -> Result<Identified, Error> {
        let Self { file, designs, measured, of_measured, deviations, columns } = self;
        let (variables, start) = (designs.variables().to_vec(), designs.start.clone());
        let count = variables.len();
        let judge = |_: &[f64], tried: &Tried| {
            let of = |row: usize| tried.results[of_measured[row]];
            let residual = |row: usize| (of(row) - measured[row].value) / deviations[row];
            let slope = |row: usize, by: usize| tried.derivatives[of_measured[row]][by] / deviations[row];
            Judged {
                residuals: DVector::from_fn(measured.len(), |row, _| residual(row)),
                jacobian: DMatrix::from_fn(measured.len(), count, slope),
                extreme: 0.0,
                extreme_slope: DVector::zeros(count),
                limits: DVector::zeros(0),
                limit_slopes: DMatrix::zeros(0, count),
                is_met: false,
            }
        };
        let most = file.case.solutions.map_or(MOST, |solutions| solutions as usize);
        let Best { found, folder, .. } = Search::open(designs, folder, &judge, listener)?.run(most, 1)?;
        let columns = columns.into_iter().map(|name| {
            let rows: Vec<usize> = (0..measured.len()).filter(|row| measured[*row].column == name).collect();
            let squares = rows.iter().map(|row| (found.judged.residuals[*row] * deviations[*row]).powi(2));
            let left = (squares.sum::<f64>() / rows.len() as f64).sqrt();
            Column { name, count: rows.len(), left }
        });
        let identified = identified(&found, &variables, &start, columns.collect());
        let text = json::pretty(&identified).map_err(|why| ResultsError::not_representable(IDENTIFIED, why))?;
        folder.write(IDENTIFIED, text)?;
        Ok(identified)
    }
}

/// Root mean square of a column; errors without a standard deviation are taken to be the same share of it in all columns.
fn size_of(column: &str, measured: &[Measured]) -> f64 {
    let own: Vec<f64> = measured.iter().filter(|other| other.column == column).map(|other| other.value).collect();
    let size = (own.iter().map(|value| value * value).sum::<f64>() / own.len() as f64).sqrt();
    if size > 0.0 { size } else { 1.0 }
}

/// Errors of what a file sets, at their places in it.
pub(crate) fn in_file<T: Document>(file: &Written<T>, set: &Node, variables: &[Variable], error: Error) -> Error {
    let set = set.values();
    let key_of = |key: &str| {
        if key.starts_with("variables.") {
            return Some(key.to_owned());
        }
        let variable = variables.iter().find(|variable| variable.keys.iter().any(|own| own == key));
        let of_variable = variable.map(|variable| format!("variables.{}", variable.name));
        of_variable.or_else(|| set.iter().any(|(other, _)| other == key).then(|| format!("set.{key}")))
    };
    placed(file, &key_of, error)
}

/// What a search has come to, and how exactly it is known.
fn identified(found: &Found, variables: &[Variable], start: &[f64], columns: Vec<Column>) -> Identified {
    let is_at_bound = |number: usize| {
        let [low, high] = variables[number].bounds;
        let value = found.values[number];
        (value - low).min(high - value) <= AT_BOUND * (high - low)
    };
    let free: Vec<usize> = (0..variables.len()).filter(|number| !is_at_bound(*number)).collect();
    let names: Vec<&str> = variables.iter().map(|variable| variable.name.as_str()).collect();
    // Also of those at a bound: to there a search comes that cannot tell them from others.
    let (singular_values, untold) = directions(&found.judged.jacobian, &names);
    let statistics = statistics(&found.judged.jacobian.select_columns(&free), &found.judged.residuals);
    let value = |number: usize| {
        let place = free.iter().position(|free| *free == number);
        let of = |errors: fn(&Statistics) -> &Vec<f64>| Some(errors(statistics.as_ref()?)[place?]);
        Value {
            name: variables[number].name.clone(),
            value: found.values[number],
            start: start[number],
            is_at_bound: place.is_none(),
            standard_error: of(|statistics| &statistics.standard_errors),
            half_width: of(|statistics| &statistics.half_widths),
        }
    };
    let residuals = &found.judged.residuals;
    Identified {
        why: found.why,
        solutions: found.tried,
        misfit: (residuals.norm_squared() / residuals.len() as f64).sqrt(),
        columns,
        values: (0..variables.len()).map(value).collect(),
        correlation: statistics.map(|statistics| statistics.correlation).unwrap_or_default(),
        singular_values,
        untold,
    }
}

/// Standard errors and correlations, by the linearisation at the best values; `None` where the measurements do not tell them.
fn statistics(jacobian: &DMatrix<f64>, residuals: &DVector<f64>) -> Option<Statistics> {
    let rows: Vec<Vec<f64>> = jacobian.row_iter().map(|row| row.iter().copied().collect()).collect();
    let right: Vec<f64> = residuals.iter().map(|residual| -residual).collect();
    let ones = vec![1.0; right.len()];
    Reduced::new(&rows, &right, &ones, &ones)?.statistics()
}

/// Singular values of a Jacobian whose columns are divided by their lengths, and what the measurements hardly tell, or do not.
fn directions(jacobian: &DMatrix<f64>, names: &[&str]) -> (Vec<f64>, Vec<String>) {
    let lengths: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
    let (told, silent): (Vec<usize>, Vec<usize>) = (0..names.len()).partition(|column| lengths[*column] > 0.0);
    let silent = silent.into_iter().map(|column| format!("nothing that was measured depends on {}", names[column]));
    let mut untold: Vec<String> = silent.collect();
    if told.is_empty() {
        return (Vec::new(), untold);
    }
    let scaled = DMatrix::from_fn(jacobian.nrows(), told.len(), |i, j| jacobian[(i, told[j])] / lengths[told[j]]);
    let svd = scaled.svd(false, true);
    let most = svd.singular_values.max();
    for (value, direction) in svd.singular_values.iter().zip(svd.v_t.iter().flat_map(|v| v.row_iter())) {
        if *value >= HARDLY * most {
            continue;
        }
        let largest = direction.amax();
        let parts = (0..told.len()).filter(|part| direction[*part].abs() >= PART * largest);
        let parts: Vec<&str> = parts.map(|part| names[told[part]]).collect();
        untold.push(format!(
            "the measurements hardly tell {} apart: together they can change {:.0} times as much as each alone before anything shows",
            parts.join(" and "),
            (most / value).min(1e9)
        ));
    }
    (svd.singular_values.iter().copied().collect(), untold)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_the_same_is_named_and_what_does_nothing_too() {
        // The second column is the first one, but for a little; the last is empty.
        let jacobian = DMatrix::from_row_slice(
            4,
            4,
            &[1.0, 2.0, 0.3, 0.0, 2.0, 4.001, -0.4, 0.0, 3.0, 6.0, 0.1, 0.0, 4.0, 8.0, 0.2, 0.0],
        );
        let (values, untold) = directions(&jacobian, &["a", "b", "c", "d"]);
        assert_eq!(values.len(), 3);
        assert_eq!(untold.len(), 2, "{untold:?}");
        assert_eq!(untold[0], "nothing that was measured depends on d");
        assert!(untold[1].contains("tell a and b apart"), "{untold:?}");
        let (_, untold) = directions(&jacobian.select_columns(&[0, 2]), &["a", "c"]);
        assert!(untold.is_empty());
    }
}
