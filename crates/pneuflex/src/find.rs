//! Where a result takes a value: at which pressure or time of the path, or at which value of a key.

use pneuflex_mesh::vector::norm;
use pneuflex_model::LoadParameter;
use pneuflex_newton::Checkpoint;
use pneuflex_post::summary::StepSummary;

use crate::analysis::Analysis;
use crate::columns::{Tip, columns};
use crate::error::Error;
use crate::input_error::InputError;
use crate::memory::MemoryLimit;
use crate::observer::{Event, StopToken};
use crate::study::Study;
use crate::words::rounded;

/// The column of the force on the only obstacle, N.
pub const FORCE: &str = "force";

/// Relative width of the interval at which a search ends,
const CLOSE: f64 = 1e-7;

/// and how near the value is where it ends before, relative to how much it changes.
const NEAR: f64 = 1e-9;

/// Where the interval is that narrow and the value is further away than this, relative to how much it changes, it jumps.
const JUMP: f64 = 1e-2;

/// Solutions in a search at the most.
const MOST: usize = 60;

/// Where false position has not come there in so many solutions, halves do.
const BISECTED_FROM: usize = 12;

/// The first place on the path that is looked at, as a share of the first one that is asked for: the value may lie before that.
const FIRST: f64 = 1e-3;

/// Digits of places and values in words.
const DIGITS: i32 = 7;

/// What is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    /// A column of [`crate::columns`], the length of a vector by its name, or [`FORCE`].
    pub column: String,
    /// The value that it is to have.
    pub value: f64,
}

/// What a search has come to.
#[derive(Clone, Debug, PartialEq)]
pub enum Search {
    /// The place.
    Found {
        /// Pressure, kPa, of an actuator; time of a model; or value of the key.
        at: f64,
        /// The value there.
        value: f64,
    },
    /// There is none, and why.
    Never(String),
}

/// A place that was looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    at: f64,
    value: f64,
}

/// Where a result first takes a value on the path of an analysis, as far as the states that it asks for show: the path is followed until one of
/// them is beyond the value, and the place closed in on from the state before. `listener` is told what happens on the way there.
///
/// # Errors
/// A column that the states do not have, and those of [`crate::Run::solve`] but [`Error::NotConverged`].
pub fn along_path(
    analysis: &Analysis,
    tip: &Tip,
    goal: &Goal,
    stop: &StopToken,
    listener: &mut (dyn FnMut(&Event<'_>) + Send),
) -> Result<Search, Error> {
    let clock = analysis.problem.clock;
    let words = |sample: &Sample| {
        format!("{} at {}", rounded(sample.value, DIGITS), clock.words(LoadParameter(rounded(sample.at, DIGITS))))
    };
    let mut path = Followed { analysis: plain(analysis), tip, column: &goal.column, stop };
    let near_rest =
        analysis.requested.first().filter(|first| first.0 > 0.0).map(|first| LoadParameter(FIRST * first.0));
    path.analysis.requested = near_rest.into_iter().chain(analysis.requested.iter().copied()).collect();
    let mut states: Vec<(Sample, Checkpoint)> = Vec::new();
    let ended = path.follow(None, listener, &mut |sample, checkpoint| {
        states.push((sample, checkpoint));
        crosses(states.iter().map(|state| state.0), goal.value).is_some()
    });
    let Some(place) = crosses(states.iter().map(|state| state.0), goal.value) else {
        let why = match ended {
            Ok(End::Turned) => {
                "\n  there the load falls along the path, of which only what comes before is looked at".into()
            }
            Ok(End::Reached) => "\n  what to try: higher pressures or later times, or another design".into(),
            Err(Error::NotConverged(ended)) => format!("\n  the path ended there: {ended}"),
            Err(error) => return Err(error),
        };
        let range = match (states.first(), states.last()) {
            (Some((first, _)), Some((last, _))) => format!("it goes from {} to {}", words(first), words(last)),
            _ => "no state was reached".to_owned(),
        };
        return Ok(Search::Never(format!("{} = {} is never reached: {range}{why}", goal.column, goal.value)));
    };
    let ends = [states[place].0, states[place + 1].0];
    states.truncate(place + 1);
    let closed_in = close_in(ends, goal.value, |at| {
        path.analysis.requested = vec![LoadParameter(at)];
        let before = states.iter().filter(|(sample, _)| sample.at <= at).max_by(|a, b| a.0.at.total_cmp(&b.0.at));
        let mut found = None;
        path.follow(before.map(|(_, from)| from.clone()), &mut |_| (), &mut |sample, checkpoint| {
            found = Some((sample, checkpoint));
            true
        })?;
        let (sample, checkpoint) =
            found.ok_or_else(|| InputError::new(format!("{} was not reached", clock.words(LoadParameter(at)))))?;
        states.push((sample, checkpoint));
        Ok(sample.value)
    })?;
    Ok(closed_in.search(goal, words))
}

/// The value of a key at which a result takes a value at an analysis's last pressure or time, between two values of the key; each is
/// a solution of its own, of which `listener` is told the value of the key and that of the result.
///
/// # Errors
/// A key that cannot be set, a column that the states do not have, and those of [`crate::Run::solve`].
pub fn by_key(
    study: &Study,
    (key, ends): (&str, [f64; 2]),
    goal: &Goal,
    (limit, stop): (MemoryLimit, &StopToken),
    listener: &mut dyn FnMut(f64, f64),
) -> Result<Search, Error> {
    let mut value = |at: f64| -> Result<f64, Error> {
        let mut study = study.clone();
        study.set(key, &at.to_string())?;
        let mut analysis = plain(&study.build_within(limit)?);
        analysis.requested = analysis.requested.last().copied().into_iter().collect();
        let solution = analysis.run().without_fields().stop(stop).solve()?;
        let state = solution.states.iter().rev().find(|state| state.kind.is_requested());
        let state = state.ok_or_else(|| InputError::new(format!("{key} = {at}: nothing was asked for")))?;
        let value = value_of(&goal.column, state, &Tip::of(&study))?;
        listener(at, value);
        Ok(value)
    };
    let samples = [Sample { at: ends[0], value: value(ends[0])? }, Sample { at: ends[1], value: value(ends[1])? }];
    let words =
        |sample: &Sample| format!("{} at {key} = {}", rounded(sample.value, DIGITS), rounded(sample.at, DIGITS));
    if crosses(samples.into_iter(), goal.value).is_none() {
        let [a, b] = samples.each_ref().map(words);
        return Ok(Search::Never(format!("{} = {} does not lie between: it is {a} and {b}", goal.column, goal.value)));
    }
    Ok(close_in(samples, goal.value, value)?.search(goal, words))
}

/// An analysis without what is no part of a search.
fn plain(analysis: &Analysis) -> Analysis {
    let mut plain = analysis.clone();
    plain.output.error_estimate = false;
    plain
}

/// The first of some samples beyond which a value lies before the next one.
fn crosses(samples: impl Iterator<Item = Sample>, value: f64) -> Option<usize> {
    let is_above: Vec<bool> = samples.map(|sample| sample.value > value).collect();
    is_above.windows(2).position(|pair| pair[0] != pair[1])
}

/// How a path that was followed ended, if not early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// At the last place that was asked for, or where nobody wanted more.
    Reached,
    /// Where the load began to fall.
    Turned,
}

/// A path of which a column is looked at.
struct Followed<'a> {
    analysis: Analysis,
    tip: &'a Tip,
    column: &'a str,
    stop: &'a StopToken,
}

impl Followed<'_> {
    /// Follows the path from a checkpoint, or from rest, and tells `reached` of the states that are asked for, until that wants no more.
    fn follow(
        &self,
        from: Option<Checkpoint>,
        listener: &mut (dyn FnMut(&Event<'_>) + Send),
        reached: &mut (dyn FnMut(Sample, Checkpoint) -> bool + Send),
    ) -> Result<End, Error> {
        let enough = StopToken::new();
        let mut last = from.clone();
        let mut early: Option<Result<End, InputError>> = None;
        let mut run = self.analysis.run().without_fields().stop(&enough);
        if let Some(checkpoint) = from {
            run = run.resume_from(checkpoint);
        }
        let ended = run
            .observer(|event| {
                listener(event);
                match event {
                    Event::StepAccepted(checkpoint) => last = Some((*checkpoint).clone()),
                    Event::State(state) if early.is_none() => {
                        let value = value_of(self.column, state.summary, self.tip);
                        early = match (value, &last) {
                            _ if !state.summary.kind.is_requested() => Some(Ok(End::Turned)),
                            (Err(error), _) => Some(Err(error)),
                            (Ok(value), Some(checkpoint)) => {
                                let sample = Sample { at: state.summary.when().0, value };
                                reached(sample, checkpoint.clone()).then_some(Ok(End::Reached))
                            }
                            (Ok(_), None) => None,
                        };
                    }
                    _ => {}
                }
                if early.is_some() || self.stop.is_stopped() {
                    enough.stop();
                }
            })
            .solve();
        match early {
            Some(early) => Ok(early?),
            None => ended.map(|_| End::Reached),
        }
    }
}

/// The value of a column in a state.
pub(crate) fn value_of(column: &str, state: &StepSummary, tip: &Tip) -> Result<f64, InputError> {
    let found = columns(state, tip);
    if let Some(value) = found.get(column).and_then(serde_json::Value::as_f64) {
        return Ok(value);
    }
    // The length of a vector is asked for by its name.
    let of_vector =
        found.0.iter().filter(|(name, _)| name.rsplit_once('.').is_some_and(|(vector, _)| vector == column));
    let parts: Vec<f64> = of_vector.filter_map(|(_, part)| part.as_f64()).collect();
    if let [x, y, z] = parts[..] {
        return Ok(norm([x, y, z]));
    }
    if column == FORCE {
        let mut obstacles = state.obstacles.iter();
        return match (obstacles.next(), obstacles.next()) {
            (Some((_, obstacle)), None) => Ok(norm(obstacle.force_n)),
            (None, _) => Err(InputError::new(format!("{FORCE}: there is no obstacle whose force is reported"))),
            (Some((first, _)), Some(_)) => {
                let names: Vec<&str> = state.obstacles.keys().map(String::as_str).collect();
                let help = format!("say which one by its column, obstacle.{first}");
                let what = format!("there are the obstacles {}: which force is meant is not clear", names.join(", "));
                Err(InputError::new(what).with_help(Some(help)))
            }
        };
    }
    let known: Vec<&str> = found.0.iter().map(|(name, _)| name.as_str()).collect();
    let help = Some(format!("there are {}, and the lengths of vectors by their names", known.join(", ")));
    Err(InputError::new(format!("{column}: this body has no such result")).with_help(help))
}

/// Where a search has ended.
struct ClosedIn {
    ends: [Sample; 2],
    /// How much the value changes between the first ends.
    scale: f64,
}

impl ClosedIn {
    fn search(self, goal: &Goal, words: impl Fn(&Sample) -> String) -> Search {
        let miss = |sample: &Sample| (sample.value - goal.value).abs();
        let [low, high] = &self.ends;
        let best = if miss(low) < miss(high) { low } else { high };
        if miss(best) > JUMP * self.scale {
            let [a, b] = self.ends.each_ref().map(words);
            return Search::Never(format!("{} = {} is passed by in a jump, from {a} to {b}", goal.column, goal.value));
        }
        Search::Found { at: rounded(best.at, DIGITS), value: rounded(best.value, DIGITS) }
    }
}

/// Closes in on a value between two samples on either side of it: false position, by the Illinois rule, and halves where that is slow.
fn close_in(
    mut ends: [Sample; 2],
    wanted: f64,
    mut value: impl FnMut(f64) -> Result<f64, Error>,
) -> Result<ClosedIn, Error> {
    let miss = |sample: Sample| sample.value - wanted;
    let scale = miss(ends[0]).abs().max(miss(ends[1]).abs());
    let mut weights = [1.0, 1.0];
    for count in 0..MOST {
        let [low, high] = ends;
        let width = high.at - low.at;
        let is_near = miss(low).abs().min(miss(high).abs()) <= NEAR * scale;
        if is_near || width.abs() <= CLOSE * low.at.abs().max(high.at.abs()) {
            break;
        }
        let [a, b] = [weights[0] * miss(low), weights[1] * miss(high)];
        let share = if count % 4 == 3 || count > BISECTED_FROM { 0.5 } else { (a / (a - b)).clamp(0.01, 0.99) };
        let at = low.at + share * width;
        let sample = Sample { at, value: value(at)? };
        let side = usize::from((miss(sample) > 0.0) == (miss(high) > 0.0));
        ends[side] = sample;
        weights[side] = 1.0;
        weights[1 - side] *= 0.5;
    }
    Ok(ClosedIn { ends, scale })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;

    #[test]
    fn places_are_found_from_either_side_and_where_the_slope_vanishes_and_jumps_are_told() {
        let goal = |value: f64| Goal { column: "y".into(), value };
        let words = |sample: &Sample| format!("{} at {}", rounded(sample.value, 6), rounded(sample.at, 6));
        for (f, value, exact) in [
            ((|x: f64| x * x) as fn(f64) -> f64, 2.0, Some(2.0_f64.sqrt())),
            (|x: f64| -x.powi(9), -1.0, Some(1.0)),
            (|x: f64| (x - 1.3).cbrt(), 0.0, Some(1.3)),
            (|x: f64| if x < 1.7 { x } else { 5.0 + x }, 3.0, None),
        ] {
            let mut solutions = 0;
            let found = close_in([0.5, 2.5].map(|at| Sample { at, value: f(at) }), value, |at| {
                solutions += 1;
                Ok(f(at))
            });
            match (found.unwrap().search(&goal(value), words), exact) {
                (Search::Found { at, .. }, Some(exact)) => assert!((at - exact).abs() < 2e-6, "{at} {exact}"),
                (Search::Never(why), None) => {
                    assert_eq!(why, "y = 3 is passed by in a jump, from 1.7 at 1.7 to 6.7 at 1.7")
                }
                (found, exact) => panic!("{found:?} for {exact:?}"),
            }
            assert!(solutions < MOST, "{solutions}");
        }
    }

    /// Beyond its greatest pressure a balloon's wall grows under ever less: what lies there is on no path that the pressure drives.
    #[test]
    fn only_what_comes_before_the_load_falls_is_found() {
        let mut study = Study::from_text("a.toml", &template::two_chambers()).unwrap();
        for (key, value) in [
            ("mesh.size", "4.5"),
            ("mesh.element", "hex8-q1p0"),
            ("material", "{ law = \"neo-hooke\", c10 = 0.05 }"),
            ("contact.method", "none"),
            ("load.pressure_kpa", "[5, 60]"),
            ("solver.continuation", "arc-length"),
        ] {
            study.set(key, value).unwrap();
        }
        let (analysis, tip) = (study.build().unwrap(), Tip::of(&study));
        let find = |value: f64| {
            let goal = Goal { column: "cavity_volume_mm3".into(), value };
            along_path(&analysis, &tip, &goal, &StopToken::new(), &mut |_| ()).unwrap()
        };
        let solution = analysis.solve().unwrap();
        let limit =
            solution.states.iter().position(|state| !state.kind.is_requested()).expect("there is a limit point");
        let volume = |state: usize| solution.states[state].cavity_volume_mm3;
        let between = 0.5 * (volume(limit - 1) + volume(limit));
        let Search::Never(why) = find(between) else { panic!("{between} was found") };
        assert!(why.contains("there the load falls along the path"), "{why}");
        let first = 0.5 * volume(0) + 0.5 * find_rest(&analysis);
        let Search::Found { at, value } = find(first) else { panic!("{first} was not found") };
        assert!(at > 0.0 && at < 5.0 && (value / first - 1.0).abs() < 1e-6, "{at} {value}");
    }

    /// Volume of the air at rest.
    fn find_rest(analysis: &Analysis) -> f64 {
        let rest = vec![[0.0; 3]; analysis.problem.mesh.num_nodes()];
        pneuflex_post::measures::cavity_volume(&analysis.problem, &rest).unwrap()
    }

    #[test]
    fn what_cannot_be_looked_for_is_refused() {
        let mut study = Study::from_text("a.toml", &template::two_chambers()).unwrap();
        study.set("mesh.size", "4.5").unwrap().set("mesh.element", "hex8-q1p0").unwrap();
        study.set("load.pressure_kpa", "[1]").unwrap();
        let (analysis, tip) = (study.build().unwrap(), Tip::of(&study));
        for (column, words) in [(FORCE, "no obstacle"), ("angle", "no such result")] {
            let goal = Goal { column: column.into(), value: 1.0 };
            let error = along_path(&analysis, &tip, &goal, &StopToken::new(), &mut |_| ()).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
        let stopped = StopToken::new();
        stopped.stop();
        let goal = Goal { column: "end_face_angle_deg".into(), value: 1.0 };
        assert!(matches!(along_path(&analysis, &tip, &goal, &stopped, &mut |_| ()), Err(Error::Interrupted(_))));
    }
}
