//! Curves of quantities along the load path: through the states that were reached and the load steps between them.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::report::Report;
use crate::summary::{Found, Reached};

/// Curves in one plot at the most.
pub(crate) const CURVES: usize = 4;

/// Values at the places of [`Rows`]; `None` at load steps for which a quantity was not derived.
pub type Values = Vec<Option<f64>>;

/// A plot with up to four curves of one unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plot {
    /// What it shows.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Whether the axis begins at zero.
    pub from_zero: bool,
    /// What stands along the other axis; the parameter if it is left out and does not turn back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over: Option<Axis>,
    /// Its curves.
    pub curves: Vec<Curve>,
}

/// A quantity along an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// What it is.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its values.
    pub values: Values,
}

/// A curve of a plot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Name of what it belongs to; empty where the plot's says it all.
    pub name: String,
    /// Its values.
    pub values: Values,
}

impl Plot {
    /// One curve.
    pub fn single(name: &str, unit: &'static str, values: Values) -> Self {
        let curves = vec![Curve { name: String::new(), values }];
        Self { name: name.into(), unit, from_zero: true, over: None, curves }
    }

    /// Plots with a few of the curves each.
    pub fn grouped(name: &str, unit: &'static str, curves: Vec<Curve>) -> Vec<Self> {
        let plot = |curves: &[Curve]| Self { curves: curves.to_vec(), ..Self::single(name, unit, Vec::new()) };
        curves.chunks(CURVES).map(plot).collect()
    }

    /// All its numbers.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let over = self.over.iter().map(|axis| &axis.values);
        self.curves.iter().map(|curve| &curve.values).chain(over).flatten().flatten().copied()
    }
}

/// A place on the load path.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Where it is along the slider.
    pub place: f64,
    /// The load parameter there.
    pub parameter: f64,
    /// What was found there.
    pub kind: RowKind<'a>,
}

/// What a place is.
#[derive(Clone, Copy, Debug)]
pub enum RowKind<'a> {
    /// The body at rest.
    Rest,
    /// A state that was reached.
    State(&'a Reached),
    /// A load step between two states.
    LoadStep(&'a Found),
}

/// The path: rest, and what was reached.
#[derive(Clone, Debug)]
pub struct Rows<'a>(pub Vec<Row<'a>>);

impl<'a> Rows<'a> {
    /// Those of a report whose states, after rest, stand at `times` along the slider. Load steps stand where their parameter is: none is
    /// told of where that turned back.
    pub fn of(report: &'a Report<'_>, times: &[f64]) -> Self {
        let summary = report.summary;
        let rest = Row { place: 0.0, parameter: 0.0, kind: RowKind::Rest };
        let state = |(&place, (parameter, reached)): (&f64, (f64, &'a Reached))| Row {
            place,
            parameter,
            kind: RowKind::State(reached),
        };
        let states = times.iter().skip(1).zip(summary.reached()).map(state);
        let mut rows: Vec<Row<'a>> = std::iter::once(rest).chain(states).collect();
        let last = rows[rows.len() - 1].place;
        let is_new = |at: f64| 0.0 < at && at < last && !times.contains(&at);
        let steps = summary.load_steps.iter().filter(|step| is_new(step.when()));
        rows.extend(steps.map(|step| Row {
            place: step.when(),
            parameter: step.when(),
            kind: RowKind::LoadStep(&step.found),
        }));
        rows.sort_by(|a, b| a.place.total_cmp(&b.place));
        Self(rows)
    }

    /// Zero at rest, and a value at every state, if all of them have one.
    pub fn column(&self, of: impl Fn(&Found) -> Option<f64>) -> Option<Values> {
        self.column_from(Some(0.0), of)
    }

    /// The same with another value at rest.
    pub fn column_from(&self, rest: Option<f64>, of: impl Fn(&Found) -> Option<f64>) -> Option<Values> {
        self.vectors(rest, of)
    }

    /// The same of anything.
    pub fn vectors<T>(&self, rest: Option<T>, of: impl Fn(&Found) -> Option<T>) -> Option<Vec<Option<T>>> {
        let mut rest = Some(rest?);
        let value = |row: &Row<'_>| match row.kind {
            RowKind::Rest => rest.take().map(Some),
            RowKind::State(reached) => of(&reached.found).map(Some),
            RowKind::LoadStep(found) => Some(of(found)),
        };
        self.0.iter().map(value).collect()
    }

    /// Zero at rest, and what only states have.
    pub fn column_of_states(&self, of: impl Fn(&Reached) -> f64) -> Values {
        let value = |row: &Row<'_>| match row.kind {
            RowKind::Rest => Some(0.0),
            RowKind::State(reached) => Some(of(reached)),
            RowKind::LoadStep(_) => None,
        };
        self.0.iter().map(value).collect()
    }

    /// What stands in `values` for rest and each state.
    pub fn spread(&self, values: impl IntoIterator<Item = f64>) -> Values {
        let mut values = values.into_iter();
        let value = |row: &Row<'_>| match row.kind {
            RowKind::LoadStep(_) => None,
            RowKind::Rest | RowKind::State(_) => values.next(),
        };
        self.0.iter().map(value).collect()
    }

    /// The first state.
    pub fn first_state(&self) -> Option<&'a Found> {
        self.0.iter().find_map(|row| match row.kind {
            RowKind::State(reached) => Some(&reached.found),
            RowKind::Rest | RowKind::LoadStep(_) => None,
        })
    }

    /// A curve for everything that has a name and a value at every state.
    pub fn named<T>(
        &self,
        of: impl Fn(&Found) -> &BTreeMap<String, T>,
        value: impl Fn(&T) -> Option<f64>,
    ) -> Vec<Curve> {
        let Some(first) = self.first_state() else { return Vec::new() };
        let curve = |name: &String| {
            let values = self.column(|found| of(found).get(name).and_then(&value))?;
            Some(Curve { name: name.clone(), values })
        };
        of(first).keys().filter_map(curve).collect()
    }

    /// The load parameter at every place.
    pub fn parameters(&self) -> Values {
        self.0.iter().map(|row| Some(row.parameter)).collect()
    }
}
