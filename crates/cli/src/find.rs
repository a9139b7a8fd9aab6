//! `pneuflex find`: the pressure, or another key, at which a result takes a value.

use std::io::Write;

use pneuflex::model::{Clock, LoadParameter};
use pneuflex::newton::Checkpoint;
use pneuflex::post::summary::StepSummary;
use pneuflex::{Analysis, Error, Event, InputError, MemoryLimit, StopToken, Study};
use pneuflex_sweep::numbers::{Tip, numbers};

use crate::args::FindArguments;
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::progress::Progress;
use crate::terminal::say;

/// Relative width of the interval at which the search ends,
const CLOSE: f64 = 1e-7;

/// and how near the value is where it ends before, relative to how much it changes.
const NEAR: f64 = 1e-9;

/// The name of the force on the only obstacle.
pub const FORCE: &str = "force";

/// Solutions in a search at the most.
const MOST: usize = 40;

/// Where false position has not come there in so many solutions, halves do.
const BISECTED_FROM: usize = 12;

/// The first pressure or time of a path where none of those that are asked for lies before the value, as a share of the first of them.
const FIRST: f64 = 1e-3;

/// Finds it and prints it.
///
/// # Errors
/// Bad input, found before anything is solved; a value that is never reached.
pub fn find(arguments: &FindArguments) -> Result<Outcome, CliError> {
    arguments.threads.use_threads()?;
    let goal = arguments.goal()?;
    let study = Study::load_with(&arguments.case.case, arguments.case.changes()?)?;
    let stop = interrupt::listen();
    let found = match (&arguments.by, &arguments.between) {
        (Some(key), Some(ends)) => {
            let search = Fresh { study, arguments, column: &goal.0, key, stop: stop.clone() };
            search.search(goal.1, *ends).map(|(found, at)| (format!("{key} = {found}"), at))
        }
        _ => {
            let analysis = study.build_within(MemoryLimit::Available)?;
            let search = Continued { analysis: &analysis, tip: Tip::of(&study), column: &goal.0, stop: stop.clone() };
            let words = |found: f64| match analysis.problem.clock {
                Clock::Pressure => format!("{found} kPa"),
                Clock::Steps => format!("time {found}"),
            };
            search.search(goal.1, arguments).map(|(found, at)| (words(found), at))
        }
    };
    match found {
        Ok((found, at)) => {
            // Nobody reading on is no error.
            let _ = writeln!(std::io::stdout(), "{found}\n{} = {}", goal.0, rounded(at));
            Ok(Outcome::Converged)
        }
        Err(_) if stop.is_stopped() => {
            say("interrupted");
            Ok(Outcome::Interrupted)
        }
        Err(error) => Err(error),
    }
}

/// Seven digits, without zeros behind them.
fn rounded(x: f64) -> f64 {
    format!("{x:.6e}").parse().unwrap_or(x)
}

/// The value of a column in a state.
fn value_of(column: &str, state: &StepSummary, tip: &Tip) -> Result<f64, CliError> {
    let found = numbers(state, tip);
    if let Some(value) = found.get(column).and_then(serde_json::Value::as_f64) {
        return Ok(value);
    }
    // The length of a vector is asked for by its name.
    let of_vector =
        found.0.iter().filter(|(name, _)| name.rsplit_once('.').is_some_and(|(vector, _)| vector == column));
    let parts: Vec<f64> = of_vector.filter_map(|(_, part)| part.as_f64()).collect();
    if parts.len() == 3 {
        return Ok(parts.iter().map(|x| x * x).sum::<f64>().sqrt());
    }
    if column == FORCE {
        let forces: Vec<_> = state.obstacles.values().map(|obstacle| obstacle.force_n).collect();
        if let [force] = forces[..] {
            return Ok(force.iter().map(|x| x * x).sum::<f64>().sqrt());
        }
        let names: Vec<&str> = state.obstacles.keys().map(String::as_str).collect();
        let message = match &names[..] {
            [] => "--force: there is no obstacle whose force is reported".to_owned(),
            [first, ..] => format!(
                "--force: there are the obstacles {}; say which one, e.g. --column obstacle.{first}=0.5",
                names.join(", ")
            ),
        };
        return Err(InputError::new(message).into());
    }
    let known: Vec<&str> = found.0.iter().map(|(name, _)| name.as_str()).collect();
    let help = Some(format!("there are {}, and the lengths of vectors by their names", known.join(", ")));
    Err(InputError::new(format!("{column}: this body has no such result")).with_help(help).into())
}

/// A point of a search: where, and what was found there less what is wanted.
#[derive(Clone, Copy, Debug)]
struct Sample {
    at: f64,
    miss: f64,
}

/// The root between two samples of opposite signs: false position, by the Illinois rule, and bisection where that is slow.
fn root(mut ends: [Sample; 2], mut miss: impl FnMut(f64) -> Result<f64, CliError>) -> Result<Sample, CliError> {
    let scale = ends[0].miss.abs().max(ends[1].miss.abs());
    let mut weights = [1.0, 1.0];
    for count in 0..MOST {
        let [low, high] = ends;
        let width = high.at - low.at;
        let best = if low.miss.abs() < high.miss.abs() { low } else { high };
        if best.miss.abs() <= NEAR * scale || width.abs() <= CLOSE * low.at.abs().max(high.at.abs()) {
            return Ok(best);
        }
        let [a, b] = [weights[0] * low.miss, weights[1] * high.miss];
        let share = if count % 4 == 3 || count > BISECTED_FROM { 0.5 } else { (a / (a - b)).clamp(0.01, 0.99) };
        let at = low.at + share * width;
        let sample = Sample { at, miss: miss(at)? };
        let side = usize::from((sample.miss > 0.0) == (high.miss > 0.0));
        ends[side] = sample;
        weights[side] = 1.0;
        weights[1 - side] *= 0.5;
    }
    let [low, high] = ends;
    Ok(if low.miss.abs() < high.miss.abs() { low } else { high })
}

/// Along the path of one analysis: every state is gone on to from the nearest one before it.
struct Continued<'a> {
    analysis: &'a Analysis,
    tip: Tip,
    column: &'a str,
    stop: StopToken,
}

impl Continued<'_> {
    fn search(&self, wanted: f64, arguments: &FindArguments) -> Result<(f64, f64), CliError> {
        let requested = &self.analysis.requested;
        let end = requested.last().copied().unwrap_or_default();
        let clock = self.analysis.problem.clock;
        let parts = self.analysis.problem.parts_of_whole();
        let mut progress = Progress::new(arguments.threads.quiet, clock, [LoadParameter::default(), end], parts);
        let mut states: Vec<(Sample, Checkpoint)> = Vec::new();
        // A first state near rest: what is wanted may lie before the first one that is asked for.
        let near_rest = requested.first().filter(|first| first.0 > 0.0).map(|first| LoadParameter(FIRST * first.0));
        let all = near_rest.into_iter().chain(requested.iter().copied()).collect();
        let ended = self.follow(all, None, &mut progress, &mut |sample, checkpoint| {
            let miss = sample.miss - wanted;
            let crosses = states.last().is_some_and(|(before, _)| (before.miss > 0.0) != (miss > 0.0));
            states.push((Sample { miss, ..sample }, checkpoint));
            crosses
        });
        progress.finish();
        let crossed = states.windows(2).position(|pair| (pair[0].0.miss > 0.0) != (pair[1].0.miss > 0.0));
        let Some(place) = crossed else {
            if let Err(error @ (Error::Input(_) | Error::Setup(_) | Error::Results(_) | Error::Threads { .. })) = ended
            {
                return Err(error.into());
            }
            return Err(self.never(wanted, &states, ended.err()));
        };
        let ends = [states[place].0, states[place + 1].0];
        let mut known: Vec<(Sample, Checkpoint)> = states.drain(..=place).collect();
        let sample = root(ends, |at| {
            let before = known.iter().filter(|(sample, _)| sample.at <= at).max_by(|a, b| a.0.at.total_cmp(&b.0.at));
            let from = before.map(|(_, checkpoint)| checkpoint.clone());
            let mut found = None;
            let mut silent = Progress::new(true, clock, [LoadParameter::default(), end], parts);
            self.follow(vec![LoadParameter(at)], from, &mut silent, &mut |sample, checkpoint| {
                found = Some((Sample { miss: sample.miss - wanted, ..sample }, checkpoint));
                true
            })?;
            let (sample, checkpoint) = found.ok_or_else(|| CliError::NotConverged(format!("{at} was not reached")))?;
            known.push((sample, checkpoint));
            Ok(sample.miss)
        })?;
        Ok((rounded(sample.at), sample.miss + wanted))
    }

    /// Follows the path to some places, and tells of each what the result is there; ends early where that says so.
    fn follow(
        &self,
        requested: Vec<LoadParameter>,
        from: Option<Checkpoint>,
        progress: &mut Progress,
        reached: &mut (dyn FnMut(Sample, Checkpoint) -> bool + Send),
    ) -> Result<(), Error> {
        let mut analysis = self.analysis.clone();
        analysis.requested = requested;
        let enough = StopToken::new();
        let mut last: Option<Checkpoint> = from.clone();
        let mut missing: Option<CliError> = None;
        let mut run = analysis.run().without_fields().stop(&enough);
        if let Some(checkpoint) = from {
            run = run.resume_from(checkpoint);
        }
        let (mut is_done, stop) = (false, &self.stop);
        let ended = run
            .observer(|event| {
                progress.event(event);
                if stop.is_stopped() {
                    enough.stop();
                }
                match event {
                    Event::StepAccepted(checkpoint) => last = Some((*checkpoint).clone()),
                    Event::State(state) => match (value_of(self.column, state.summary, &self.tip), last.clone()) {
                        (Ok(value), Some(checkpoint)) => {
                            let at = state.summary.time.unwrap_or(state.summary.pressure_kpa);
                            if reached(Sample { at, miss: value }, checkpoint) {
                                is_done = true;
                                enough.stop();
                            }
                        }
                        (Err(error), _) => {
                            missing = Some(error);
                            enough.stop();
                        }
                        (Ok(_), None) => {}
                    },
                    _ => {}
                }
            })
            .solve();
        match (ended, missing) {
            (_, Some(CliError::Input(errors))) => Err(Error::Input(errors)),
            (Err(Error::Interrupted(_)), _) if is_done => Ok(()),
            (ended, _) => ended.map(|_| ()),
        }
    }

    /// Why there is no such place.
    fn never(&self, wanted: f64, states: &[(Sample, Checkpoint)], error: Option<Error>) -> CliError {
        let words = |place: f64| self.analysis.problem.clock.words(LoadParameter(place));
        let column = self.column;
        let range = match states {
            [] => "no state was reached".to_owned(),
            [(first, _), ..] => {
                let (last, _) = &states[states.len() - 1];
                let [a, b] =
                    [first, last].map(|sample| format!("{} at {}", rounded(sample.miss + wanted), words(sample.at)));
                format!("it goes from {a} to {b}")
            }
        };
        let why = match error.map(CliError::from) {
            Some(error) => format!("\n  the path ended there: {}", error.message()),
            None => "\n  what to try: ask for higher pressures or later times, or for another design".to_owned(),
        };
        CliError::NotConverged(format!("{column} = {wanted} is never reached: {range}{why}"))
    }
}

/// By solving the last pressure or time of a case anew for every value of a key.
struct Fresh<'a> {
    study: Study,
    arguments: &'a FindArguments,
    column: &'a str,
    key: &'a str,
    stop: StopToken,
}

impl Fresh<'_> {
    fn search(&self, wanted: f64, ends: [f64; 2]) -> Result<(f64, f64), CliError> {
        let samples = [self.sample(ends[0], wanted)?, self.sample(ends[1], wanted)?];
        if (samples[0].miss > 0.0) == (samples[1].miss > 0.0) {
            let [a, b] = samples.map(|s| format!("{} at {} = {}", rounded(s.miss + wanted), self.key, s.at));
            let message = format!("{} = {wanted} does not lie between: it is {a} and {b}", self.column);
            return Err(CliError::NotConverged(message));
        }
        let found = root(samples, |at| Ok(self.sample(at, wanted)?.miss))?;
        Ok((rounded(found.at), found.miss + wanted))
    }

    fn sample(&self, at: f64, wanted: f64) -> Result<Sample, CliError> {
        let mut study = self.study.clone();
        study.set(self.key, &at.to_string())?;
        let mut analysis = study.build_within(MemoryLimit::Available)?;
        analysis.requested = analysis.requested.last().copied().into_iter().collect();
        let solution = analysis.run().without_fields().stop(&self.stop).solve()?;
        let state = solution.states.last();
        let state = state.ok_or_else(|| CliError::NotConverged(format!("{} = {at}: nothing was reached", self.key)))?;
        let value = value_of(self.column, state, &Tip::of(&study))?;
        if !self.arguments.threads.quiet {
            say(&format!("{} = {at}: {} = {}", self.key, self.column, rounded(value)));
        }
        Ok(Sample { at, miss: value - wanted })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found_from_either_side_and_where_the_slope_vanishes() {
        for (f, exact) in [
            ((|x: f64| x * x - 2.0) as fn(f64) -> f64, 2.0_f64.sqrt()),
            (|x: f64| 1.0 - x.powi(9), 1.0),
            (|x: f64| (x - 1.3).cbrt(), 1.3),
            (|x: f64| if x < 1.7 { -1.0 } else { 1e-3 * x }, 1.7),
        ] {
            let mut solutions = 0;
            let ends = [0.5, 2.5].map(|at| Sample { at, miss: f(at) });
            let found = root(ends, |at| {
                solutions += 1;
                Ok(f(at))
            })
            .unwrap();
            assert!((found.at - exact).abs() < 2e-6 || found.miss.abs() < 1e-6, "{found:?} {exact}");
            assert!(solutions <= MOST, "{solutions}");
        }
    }
}
