//! A search in its folder: `history.json` has every design that was solved, `case.toml` the best one.

use std::path::{Path, PathBuf};

use pneuflex::recorder::write_case;
use pneuflex::{Change, Error, InputError, OutputFolder};
use pneuflex_sweep::base::Base;
use pneuflex_sweep::node::Node;

use crate::designs::Designs;
use crate::history::{History, Tried};
use crate::minimise::{Found, Judge, Judged, Space, Step, Why, minimise};
use crate::starts::{is_better, points};

/// Designs that a search tries at the most if nothing is said.
pub const MOST: usize = 60;

/// What is told of a design.
#[derive(Debug)]
pub struct Progress<'a> {
    /// The start, from 1, from which the search has come to it, and how many there are.
    pub start: [usize; 2],
    /// Its number among all designs.
    pub number: usize,
    /// Its number from that start on, values, and what it is judged by.
    pub step: &'a Step<'a>,
    /// What was found.
    pub tried: &'a Tried,
    /// Whether it was found by an earlier call.
    pub is_known: bool,
}

/// What a search has come to from a start.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Ended {
    /// Where it began.
    pub values: Vec<f64>,
    /// Why it ended there; left out if there are no results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<Why>,
    /// Designs that were solved.
    pub solutions: usize,
    /// Half the sum of squares of what targets are missed by, over what they may be, and extremes relative to their first values, at its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objective: Option<f64>,
    /// Whether the best design came from it.
    pub is_best: bool,
}

/// The best design of a search.
#[derive(Debug)]
pub struct Best {
    /// What it is judged by, and why the search ended there.
    pub found: Found,
    /// Its results.
    pub tried: Tried,
    /// What came of every start.
    pub starts: Vec<Ended>,
    /// All designs that were tried, in their order.
    pub designs: Vec<Tried>,
    /// The folder.
    pub folder: OutputFolder,
}

/// What all designs of a search are made from: a file with what is set there and changes to that.
pub fn base(path: PathBuf, set: &Node, changes: &[Change]) -> Base {
    let set = set.values().into_iter().map(|(key, value)| (key, value.to_string()));
    let changes = changes.iter().map(|change| (change.key.clone(), change.value.clone()));
    Base { path, changes: set.chain(changes).collect() }
}

/// A search in a folder.
pub struct Search<'a> {
    designs: Designs,
    history: History,
    folder: OutputFolder,
    /// Designs of the history that the search has come to again.
    followed: usize,
    /// Designs that earlier calls have solved.
    known: usize,
    /// The start from which it searches, from 1, and how many there are.
    start: [usize; 2],
    /// The best end of an earlier start.
    best: Option<Judged>,
    judge: &'a dyn Fn(&[f64], &Tried) -> Judged,
    listener: &'a mut dyn FnMut(&Progress<'_>),
}

impl<'a> Search<'a> {
    /// Opens the folder; with `resume` the designs that it holds are not solved again. `judge` says how good a design with results is.
    ///
    /// # Errors
    /// A folder that cannot be used, or holds something else.
    pub fn open(
        designs: Designs,
        (path, resume): (&Path, bool),
        judge: &'a dyn Fn(&[f64], &Tried) -> Judged,
        listener: &'a mut dyn FnMut(&Progress<'_>),
    ) -> Result<Self, Error> {
        let variables = designs.variables().iter().map(|variable| variable.name.clone()).collect();
        let results = designs.requests().iter().map(ToString::to_string).collect();
        let mut history = History::new(designs.origin.clone(), variables, results);
        let folder = OutputFolder::prepare(path)?;
        if resume {
            history.resume(&folder)?;
        }
        let known = history.designs.len();
        Ok(Self { designs, history, folder, followed: 0, known, start: [1, 1], best: None, judge, listener })
    }

    /// Looks for the best design, from so many starts and with so many solutions from each at the most. It ends with the first start from which
    /// everything is met that is wanted.
    ///
    /// # Errors
    /// [`Error::Interrupted`]; no start that has results; what is no fault of a design.
    pub fn run(mut self, most: usize, starts: usize) -> Result<Best, Error> {
        let bounds: Vec<[f64; 2]> = self.designs.variables().iter().map(|variable| variable.bounds).collect();
        let (mut best, mut ended): (Option<Found>, Vec<Ended>) = (None, Vec::new());
        self.start = [1, starts];
        for start in points(&self.designs.start, &bounds, starts) {
            let scales = scales(&start, &bounds);
            let space = Space { start: start.clone(), bounds: bounds.clone(), scales, most };
            let (before, end) = (self.followed, minimise(&space, &mut self)?);
            if end.is_none() && starts > 1 {
                self.tell(&Step { number: 1, values: &start, judged: None, is_better: false })?;
            }
            ended.push(Ended {
                values: start,
                why: end.as_ref().map(|found| found.why),
                solutions: self.followed - before,
                objective: end.as_ref().map(|found| found.judged.objective()),
                is_best: false,
            });
            let Some(found) = end else { continue };
            let is_met = found.why == Why::Met;
            if best.as_ref().is_none_or(|best| is_better(&found.judged, &best.judged)) {
                ended.iter_mut().for_each(|start| start.is_best = false);
                ended.iter_mut().last().into_iter().for_each(|start| start.is_best = true);
                self.best = Some(found.judged.clone());
                best = Some(found);
            }
            if is_met || self.start[0] == starts {
                break;
            }
            self.start[0] += 1;
        }
        let Some(found) = best else {
            let why = self.history.designs.first().and_then(|tried| tried.outside.clone()).unwrap_or_default();
            return Err(InputError::new(format!("the design at which the search begins has no results: {why}")).into());
        };
        if starts > 1 {
            // A start may have passed a better design than it ended at.
            write_case(&self.folder, &self.designs.analysis(&found.values)?)?;
        }
        let why = serde_json::to_value(found.why).ok();
        self.history.ended = why.and_then(|why| why.as_str().map(str::to_owned));
        self.history.write(&self.folder)?;
        let designs = self.history.designs;
        let tried = designs.iter().find(|tried| tried.values == found.values).cloned().unwrap_or_default();
        Ok(Best { found, tried, starts: ended, designs, folder: self.folder })
    }

    /// What was found of a design before, or is found now.
    fn tried(&mut self, values: &[f64]) -> Result<&Tried, Error> {
        let number = self.followed;
        self.followed += 1;
        // Of a search to another goal the first designs may be the same.
        if self.history.designs.get(number).is_none_or(|tried| tried.values != values) {
            let tried = Tried { start: self.start[0], ..self.designs.solve(values)? };
            self.history.designs.truncate(number);
            self.known = self.known.min(number);
            self.history.designs.push(tried);
        }
        Ok(&self.history.designs[number])
    }
}

/// What changes of the variables are large against.
fn scales(start: &[f64], bounds: &[[f64; 2]]) -> Vec<f64> {
    let scale = |(value, [low, high]): (&f64, &[f64; 2])| {
        let width = high - low;
        if *value == 0.0 { width } else { value.abs().min(width) }
    };
    start.iter().zip(bounds).map(scale).collect()
}

impl Judge for Search<'_> {
    type Error = Error;

    fn judge(&mut self, values: &[f64]) -> Result<Option<Judged>, Error> {
        let judge = self.judge;
        let tried = self.tried(values)?;
        Ok(tried.outside.is_none().then(|| judge(values, tried)))
    }

    fn tell(&mut self, step: &Step<'_>) -> Result<(), Error> {
        let is_known = self.followed <= self.known;
        let has_results = self.history.designs[..self.followed].iter().any(|tried| tried.outside.is_none());
        let had_results = self.history.designs[..self.followed - 1].iter().any(|tried| tried.outside.is_none());
        if has_results && !had_results && !is_known {
            // Only now: a search that cannot begin leaves what is there.
            self.folder.begin()?;
        }
        let is_best = |judged: &Judged| self.best.as_ref().is_none_or(|best| is_better(judged, best));
        if step.is_better && step.judged.is_some_and(is_best) && !is_known {
            // By it the folder is known as this program's.
            write_case(&self.folder, &self.designs.analysis(step.values)?)?;
        }
        if has_results && !is_known {
            self.history.write(&self.folder)?;
            self.folder.has_begun()?;
        }
        let tried = &self.history.designs[self.followed - 1];
        (self.listener)(&Progress { start: self.start, number: self.followed, step, tried, is_known });
        Ok(())
    }
}
