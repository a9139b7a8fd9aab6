//! Progress of a run: a bar on a terminal, plain lines elsewhere, nothing when quiet. All on standard error.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use pneuflex::diagnosis::limit_words;
use pneuflex::model::{Clock, LoadParameter, StateKind};
use pneuflex::newton::{Cause, IterationRecord};
use pneuflex::post::summary::{ObstacleSummary, StepSummary};
use pneuflex::{Event, ReachedState};

use crate::terminal::{message, say};

/// Tells somebody how a run is going.
pub struct Progress {
    output: Output,
    clock: Clock,
    /// How many modelled parts make the whole body, of which contact points are counted.
    parts: usize,
    time_left: TimeLeft,
    /// Position on the load path that was reached last, and that the run goes on to.
    last: LoadParameter,
    end: LoadParameter,
}

enum Output {
    Quiet,
    Lines,
    Bar(ProgressBar),
}

/// The bar's length; its position is the share of the last pressure.
const LENGTH: u64 = 1000;

impl Progress {
    /// Progress from `start` to `end`, on the load path, of a body that is made of so many modelled parts.
    pub fn new(quiet: bool, clock: Clock, [start, end]: [LoadParameter; 2], parts: usize) -> Self {
        let output = if quiet {
            Output::Quiet
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::new(LENGTH);
            // What is too long for the line is cut off.
            if let Ok(style) = ProgressStyle::with_template("{spinner} [{bar:10}] {wide_msg}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            Output::Bar(bar)
        } else {
            Output::Lines
        };
        let time_left = TimeLeft::new(start);
        Self { output, clock, parts, time_left, last: start, end }
    }

    /// Prints a line.
    pub fn line(&self, text: &str) {
        match &self.output {
            Output::Quiet => {}
            Output::Lines => say(text),
            Output::Bar(bar) => bar.println(message(text)),
        }
    }

    /// Tells what a run tells.
    pub fn event(&mut self, event: &Event<'_>) {
        match event {
            Event::StepStarted { step, parameter } => self.step_started(*step, *parameter),
            Event::Iteration(record) => self.iteration(record),
            Event::StepRejected { cause, .. } => self.rejected(cause),
            Event::StepAccepted(checkpoint) => {
                self.last = checkpoint.parameter;
                self.time_left.reached(self.last, self.end);
            }
            Event::State(state) => self.state(state),
        }
    }

    /// A load step begins.
    fn step_started(&self, step: usize, parameter: LoadParameter) {
        let aim = self.clock.words(parameter);
        match &self.output {
            Output::Bar(bar) => {
                bar.set_position((LENGTH as f64 * self.last.0 / self.end.0) as u64);
                bar.set_message(format!("step {step} to {aim}"));
            }
            _ => self.line(&format!("step {step} to {aim}")),
        }
    }

    /// An iteration is done; without a new tangent it is one more correction of modified Newton.
    fn iteration(&self, record: &IterationRecord) {
        let points = self.parts * record.contact_points;
        match &self.output {
            Output::Bar(bar) => {
                let (aim, number) = (self.clock.words(record.parameter), record.iteration);
                let left = self.left();
                bar.set_message(format!("to {aim}, iteration {number}, {points} contact points{left}"));
            }
            _ => {
                let number = record.iteration.to_string();
                let number = if record.new_tangent { &number } else { "again" };
                let (correction, residual) = (record.correction, record.residual);
                self.line(&format!(
                    "  iteration {number}: correction {correction:.1e}, residual {residual:.1e} N, {points} contact points"
                ));
            }
        }
    }

    /// A load step failed and is repeated with a smaller one.
    fn rejected(&self, cause: &Cause) {
        self.line(&format!("  step rejected: {cause}"));
    }

    /// A requested pressure is reached.
    fn state(&mut self, ReachedState { summary, equilibrium, .. }: &ReachedState<'_>) {
        self.last = summary.when();
        for line in state_lines(self.clock, summary, self.parts * equilibrium.contact_points, &self.left()) {
            self.line(&line);
        }
    }

    /// The run is over.
    pub fn finish(&self) {
        if let Output::Bar(bar) = &self.output {
            bar.finish_and_clear();
        }
    }

    fn left(&self) -> String {
        self.time_left.seconds().map(|seconds| format!(", about {} left", duration(seconds))).unwrap_or_default()
    }
}

/// What is said of a requested pressure that is reached; `points` are all contact points, those of walls and of obstacles.
fn state_lines(clock: Clock, summary: &StepSummary, points: usize, left: &str) -> Vec<String> {
    let (at, iterations) = (clock.words(summary.when()), summary.iterations);
    let angle = summary.end_face_angle_deg.map(|deg| format!(": end face turned by {deg:.2} deg")).unwrap_or_default();
    let reached = match summary.kind {
        StateKind::Requested => format!("{at} reached"),
        StateKind::GreatestLoad | StateKind::LeastLoad => {
            format!("limit point at {}, found", limit_words(clock, summary))
        }
        StateKind::PastLimit => format!("past the limit point, {} found", limit_words(clock, summary)),
    };
    let mut lines = vec![format!("{reached} in {iterations} iterations{angle}{left}")];
    let force = |(name, found): (&String, &ObstacleSummary)| {
        let size = found.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
        format!(", {size:.4} N on {name}")
    };
    let forces: String = summary.obstacles.iter().map(force).collect();
    let depth = summary.obstacles.values().fold(summary.contact.max_penetration_mm, |a, b| a.max(b.max_penetration_mm));
    if points > 0 || depth > 0.0 || !forces.is_empty() {
        lines.push(format!("  {points} contact points, penetration {depth:.4} mm{forces}"));
    }
    if let Some(warning) = &summary.warning {
        lines.push(format!("  warning: {warning}"));
    }
    lines
}

/// How long a run will take, from how long its load steps took.
struct TimeLeft {
    /// When the steps were accepted, and where: the beginning first.
    steps: Vec<(Instant, LoadParameter)>,
    /// When the run will end by the steps so far, and by those before the last.
    ends: [Option<Instant>; 2],
    has_turned: bool,
}

impl TimeLeft {
    /// Load steps whose pace is the present one.
    const RECENT: usize = 3;

    fn new(start: LoadParameter) -> Self {
        Self { steps: vec![(Instant::now(), start)], ends: [None; 2], has_turned: false }
    }

    /// A load step is accepted.
    fn reached(&mut self, at: LoadParameter, end: LoadParameter) {
        self.reached_when(Instant::now(), at, end);
    }

    fn reached_when(&mut self, now: Instant, at: LoadParameter, end: LoadParameter) {
        // Where the load parameter turns back, nobody knows.
        if self.steps.last().is_some_and(|(_, last)| at < *last) {
            self.has_turned = true;
        }
        self.steps.push((now, at));
        // Steps become dearer as walls touch: what is left goes at the slower one of the whole path's pace and the present one.
        let count = self.steps.len();
        let pace = |first: usize| {
            let (begin, from) = self.steps[first];
            (now - begin).as_secs_f64() / (at - from)
        };
        let pace = pace(0).max(pace(count.saturating_sub(1 + Self::RECENT)));
        let left = pace * (end - at).max(0.0);
        let next = Duration::try_from_secs_f64(left).ok().and_then(|left| now.checked_add(left));
        self.ends = [next, self.ends[0]];
    }

    /// Seconds left; `None` while the estimates of the last two steps contradict each other, or once the run takes longer than expected.
    fn seconds(&self) -> Option<f64> {
        self.seconds_at(Instant::now())
    }

    fn seconds_at(&self, now: Instant) -> Option<f64> {
        let [Some(end), Some(before)] = self.ends.map(|end| end.filter(|_| !self.has_turned)) else { return None };
        let left = end.checked_duration_since(now)?.as_secs_f64();
        let differ = if end > before { end - before } else { before - end };
        (left > 0.0 && differ.as_secs_f64() <= 0.5 * left).then_some(left)
    }
}

/// A time span in words.
pub fn duration(seconds: f64) -> String {
    if seconds < 10.0 {
        format!("{seconds:.1} s")
    } else if seconds < 100.0 {
        format!("{seconds:.0} s")
    } else if seconds < 6000.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_said_when_it_is_known_and_never_grows_within_a_step() {
        let mut left = TimeLeft::new(LoadParameter(0.0));
        let begin = left.steps[0].0;
        let after = |seconds: f64| begin + Duration::from_secs_f64(seconds);
        let end = LoadParameter(10.0);
        left.reached_when(after(1.0), LoadParameter(1.0), end);
        assert_eq!(left.seconds_at(after(1.0)), None);
        left.reached_when(after(2.1), LoadParameter(2.0), end);
        let [soon, late] = [2.1, 4.0].map(|now| left.seconds_at(after(now)).unwrap());
        assert!((soon - 8.4).abs() < 1e-6 && (soon - late - 1.9).abs() < 1e-6, "{soon} {late}");
        // Walls touch: the next step takes far longer, so that nothing is known until its pace is confirmed.
        assert_eq!(left.seconds_at(after(12.0)), None);
        left.reached_when(after(22.0), LoadParameter(3.0), end);
        assert_eq!(left.seconds_at(after(22.0)), None);
        left.reached_when(after(30.0), LoadParameter(4.0), end);
        assert!(left.seconds_at(after(30.0)).unwrap() > 40.0);
        left.reached_when(after(80.0), end, end);
        assert_eq!(left.seconds_at(after(80.0)), None);
    }
}
