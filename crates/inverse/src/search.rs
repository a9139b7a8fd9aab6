//! A search in its folder: `history.json` has every design that was solved, `case.toml` the best one.

use std::path::{Path, PathBuf};

use pneuflex::recorder::write_case;
use pneuflex::{Change, Error, InputError, OutputFolder};
use pneuflex_sweep::base::Base;
use pneuflex_sweep::node::Node;

use crate::designs::Designs;
use crate::history::{History, Tried};
use crate::minimise::{Found, Judge, Judged, Space, Step, minimise};

/// Designs that a search tries at the most if nothing is said.
pub const MOST: usize = 60;

/// What is told of a design.
#[derive(Debug)]
pub struct Progress<'a> {
    /// Its number, values, and what it is judged by.
    pub step: &'a Step<'a>,
    /// What was found.
    pub tried: &'a Tried,
    /// Whether it was found by an earlier call.
    pub is_known: bool,
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
        Ok(Self { designs, history, folder, followed: 0, known, judge, listener })
    }

    /// Looks for the best design, with so many solutions at the most; what was found of it comes back, too, and the folder.
    ///
    /// # Errors
    /// [`Error::Interrupted`]; a first design without results; what is no fault of a design.
    pub fn run(mut self, most: usize) -> Result<(Found, Tried, OutputFolder), Error> {
        let bounds: Vec<[f64; 2]> = self.designs.variables().iter().map(|variable| variable.bounds).collect();
        let start = self.designs.start.clone();
        let scale = |(value, [low, high]): (&f64, &[f64; 2])| {
            let width = high - low;
            if *value == 0.0 { width } else { value.abs().min(width) }
        };
        let scales = start.iter().zip(&bounds).map(scale).collect();
        let space = Space { start, bounds, scales, most };
        let Some(found) = minimise(&space, &mut self)? else {
            let why = self.history.designs.first().and_then(|tried| tried.outside.clone()).unwrap_or_default();
            return Err(InputError::new(format!("the design at which the search begins has no results: {why}")).into());
        };
        let why = serde_json::to_value(found.why).ok();
        self.history.ended = why.and_then(|why| why.as_str().map(str::to_owned));
        self.history.write(&self.folder)?;
        let best = self.history.designs.into_iter().find(|tried| tried.values == found.values);
        Ok((found, best.unwrap_or_default(), self.folder))
    }

    /// What was found of a design before, or is found now.
    fn tried(&mut self, values: &[f64]) -> Result<&Tried, Error> {
        let number = self.followed;
        self.followed += 1;
        // Of a search to another goal the first designs may be the same.
        if self.history.designs.get(number).is_none_or(|tried| tried.values != values) {
            let tried = self.designs.solve(values)?;
            self.history.designs.truncate(number);
            self.known = self.known.min(number);
            self.history.designs.push(tried);
        }
        Ok(&self.history.designs[number])
    }
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
        if step.number == 1 && !is_known {
            // Only now: a search that cannot begin leaves what is there.
            self.folder.begin()?;
        }
        if step.is_better && !is_known {
            // By it the folder is known as this program's.
            write_case(&self.folder, &self.designs.analysis(step.values)?)?;
        }
        if !is_known {
            self.history.write(&self.folder)?;
            self.folder.has_begun()?;
        }
        let tried = &self.history.designs[self.followed - 1];
        (self.listener)(&Progress { step, tried, is_known });
        Ok(())
    }
}
