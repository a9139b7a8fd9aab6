//! The page of a search for a design.

use pneuflex::report::curves::{Curve, Plot};
use pneuflex::report::rounds::{Rounds, Table, render};
use pneuflex::words::rounded;
use pneuflex::{Error, OutputFolder, ResultsError, folder::REPORT};

use crate::design::{Designed, Reached};
use crate::history::Tried;
use crate::minimise::Why;
use crate::variables::Variable;

/// Digits of what is said.
const DIGITS: i32 = 5;

/// What the page is made of besides what the search has come to.
pub(crate) struct Page<'a> {
    /// Name of the design's file, and of the case that is varied.
    pub(crate) names: [&'a str; 2],
    pub(crate) variables: &'a [Variable],
    /// The designs with results.
    pub(crate) rounds: &'a [&'a Tried],
    /// What each of them came to: the objective, and every target.
    pub(crate) reached: &'a [(f64, Vec<Reached>)],
    /// Curves that are wanted.
    pub(crate) wanted: &'a [Vec<[f64; 2]>],
}

impl Page<'_> {
    /// Writes the page into the folder of the search.
    ///
    /// # Errors
    /// A file that cannot be written; a number that is not finite.
    pub(crate) fn write(&self, designed: &Designed, folder: &OutputFolder) -> Result<(), Error> {
        let [title, case] = self.names;
        let lines: Vec<Vec<[f64; 2]>> = self.rounds.iter().map(|round| round.line.clone()).collect();
        let about = format!("{case} · {} solutions", designed.solutions);
        let misses = self.misses();
        let objective =
            Plot::single("Objective", "", self.reached.iter().map(|(objective, _)| Some(*objective)).collect());
        let plots = [vec![objective.clone()], misses.clone(), self.over_rounds()].concat();
        let page = Rounds {
            title,
            about: &about,
            why: &designed.why_in_words(),
            is_good: designed.is_good(),
            lines: &lines,
            wanted: self.wanted,
            count: self.rounds.len(),
            key_numbers: misses
                .first()
                .filter(|plot| plot.curves.len() == 1)
                .cloned()
                .into_iter()
                .chain([objective])
                .collect(),
            plots,
            tables: &tables(designed, self.variables),
        };
        let text = render(&page).map_err(|why| ResultsError::not_representable(REPORT, why.to_string()))?;
        Ok(folder.write(REPORT, text)?)
    }

    /// What every target is missed by.
    fn misses(&self) -> Vec<Plot> {
        let Some((_, first)) = self.reached.first() else { return Vec::new() };
        let plot = |(number, target): (usize, &Reached)| {
            let values = self.reached.iter().map(|(_, targets)| Some(targets[number].off.abs())).collect();
            Plot::single(&format!("{} off", target.name), "", values)
        };
        first.iter().enumerate().map(plot).collect()
    }

    /// The variables.
    fn over_rounds(&self) -> Vec<Plot> {
        let curve = |(number, variable): (usize, &Variable)| Curve {
            name: variable.name.trim_start_matches("actuator.").to_owned(),
            values: self.rounds.iter().map(|round| Some(round.values[number])).collect(),
        };
        let plots = Plot::grouped("Variables", "", self.variables.iter().enumerate().map(curve).collect());
        plots.into_iter().map(|plot| Plot { from_zero: false, ..plot }).collect()
    }
}

fn tables(designed: &Designed, variables: &[Variable]) -> Vec<Table> {
    let text = |x: f64| rounded(x, DIGITS).to_string();
    let of_variables = designed.values.iter().zip(variables).map(|(value, variable)| {
        let bounds = format!("{} to {}", text(variable.bounds[0]), text(variable.bounds[1]));
        let mark = if value.is_at_bound { "at its bound" } else { "" };
        vec![value.name.clone(), text(value.value), text(value.start), bounds, mark.to_owned()]
    });
    let of_targets = designed.targets.iter().map(|target| {
        let wanted = target.wanted.map_or_else(|| "a curve".to_owned(), text);
        let state = if target.is_met() { "met" } else { "missed" };
        vec![target.name.clone(), wanted, text(target.off), text(target.within), state.to_owned()]
    });
    let of_extremes = designed.extremes.iter().map(|(name, value)| vec![name.clone(), text(*value)]);
    let of_limits = designed.limits.iter().map(|limit| {
        let state = match (limit.holds, limit.is_active) {
            (false, _) => "exceeded",
            (true, true) => "active",
            (true, false) => "held",
        };
        vec![limit.name.clone(), text(limit.value), state.to_owned()]
    });
    let of_starts = designed.starts.iter().enumerate().filter(|_| designed.starts.len() > 1).map(|(number, start)| {
        let why = match start.why {
            None => "no results",
            Some(Why::Met) => "all targets met",
            Some(Why::Converged) => "nothing better near by",
            Some(Why::NoDescent) => "no step makes it better",
            Some(Why::Enough) => "as many solutions as may be",
        };
        let best = if start.is_best { "the best" } else { "" };
        let objective = start.objective.map_or_else(String::new, text);
        vec![(number + 1).to_string(), objective, start.solutions.to_string(), why.to_owned(), best.to_owned()]
    });
    vec![
        Table { heading: "Targets", columns: vec!["", "wanted", "off by", "within", ""], rows: of_targets.collect() },
        Table { heading: "Extremes", columns: vec!["", "value"], rows: of_extremes.collect() },
        Table { heading: "Variables", columns: vec!["", "value", "start", "bounds", ""], rows: of_variables.collect() },
        Table { heading: "Limits", columns: vec!["", "value", ""], rows: of_limits.collect() },
        Table {
            heading: "Starts",
            columns: vec!["start", "objective", "solutions", "it ended", ""],
            rows: of_starts.collect(),
        },
    ]
}
