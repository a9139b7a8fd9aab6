//! Progress of a run: a bar on a terminal, plain lines elsewhere, nothing when quiet. All on standard error.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use pneuflex::Event;
use pneuflex::model::{Clock, LoadParameter};
use pneuflex::newton::{Cause, IterationRecord};
use pneuflex::post::summary::{ObstacleSummary, StepSummary};

use crate::error::say;

/// Tells somebody how a run is going.
pub struct Progress {
    output: Output,
    began: Instant,
    clock: Clock,
    /// Position on the load path that this run began at, reached last, and goes on to.
    start: LoadParameter,
    last: LoadParameter,
    end: LoadParameter,
    /// Position aimed at by the step under way.
    aim: LoadParameter,
    is_rejected: bool,
}

enum Output {
    Quiet,
    Lines,
    Bar(ProgressBar),
}

/// The bar's length; its position is the share of the last pressure.
const LENGTH: u64 = 1000;

impl Progress {
    /// Progress from `start` to `end`, on the load path.
    pub fn new(quiet: bool, clock: Clock, [start, end]: [LoadParameter; 2]) -> Self {
        let output = if quiet {
            Output::Quiet
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::new(LENGTH);
            if let Ok(style) = ProgressStyle::with_template("{spinner} [{bar:30}] {msg}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            Output::Bar(bar)
        } else {
            Output::Lines
        };
        Self { output, began: Instant::now(), clock, start, last: start, end, aim: start, is_rejected: false }
    }

    /// Prints a line.
    pub fn line(&self, text: &str) {
        match &self.output {
            Output::Quiet => {}
            Output::Lines => say(text),
            Output::Bar(bar) => bar.println(text),
        }
    }

    /// Tells what a run tells.
    pub fn event(&mut self, event: &Event<'_>) {
        match event {
            Event::StepStarted { step, parameter } => self.step_started(*step, *parameter),
            Event::Iteration(record) => self.iteration(record),
            Event::StepRejected { cause, .. } => self.rejected(cause),
            Event::StepAccepted(_) => {}
            Event::State(state) => self.state(state.summary),
        }
    }

    /// A load step begins.
    fn step_started(&mut self, step: usize, parameter: LoadParameter) {
        // A new step after one that was not rejected: that one was accepted.
        if !self.is_rejected {
            self.last = self.aim;
        }
        (self.aim, self.is_rejected) = (parameter, false);
        let aim = self.clock.words(parameter);
        match &self.output {
            Output::Bar(bar) => {
                bar.set_position((LENGTH as f64 * self.last.0 / self.end.0) as u64);
                bar.set_message(format!("step {step} to {aim}"));
            }
            _ => self.line(&format!("step {step} to {aim}")),
        }
    }

    /// An iteration is done; "same factor" is one more correction of modified Newton.
    fn iteration(&self, record: &IterationRecord) {
        let modified = if record.new_tangent { "" } else { ", same factor" };
        let text = format!(
            "iteration {}{modified}: correction {:.2e}, residual {:.2e} N, {} contact points",
            record.iteration, record.correction, record.residual, record.contact_points
        );
        match &self.output {
            Output::Bar(bar) => {
                let left = self.time_left().map(|t| format!(", {t} left")).unwrap_or_default();
                bar.set_message(format!(
                    "step {} to {}, {text}{left}",
                    record.step,
                    self.clock.words(record.parameter)
                ));
            }
            _ => self.line(&format!("  {text}")),
        }
    }

    /// A load step failed and is repeated with a smaller one.
    fn rejected(&mut self, cause: &Cause) {
        self.is_rejected = true;
        self.line(&format!("  step rejected: {cause}"));
    }

    /// A requested pressure is reached.
    fn state(&mut self, summary: &StepSummary) {
        let StepSummary { iterations, contact, .. } = summary;
        self.last = summary.when();
        let left = self.time_left().map(|t| format!(", {t} left")).unwrap_or_default();
        let at = self.clock.words(self.last);
        let angle =
            summary.end_face_angle_deg.map(|deg| format!("end face turned by {deg:.2} deg, ")).unwrap_or_default();
        let force = |(name, found): (&String, &ObstacleSummary)| {
            let size = found.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
            format!(", {size:.4} N on {name}")
        };
        let forces: String = summary.obstacles.iter().map(force).collect();
        self.line(&format!(
            "{at} reached in {iterations} iterations: {angle}{} contact points, penetration {:.4} mm{forces}{left}",
            contact.points_active, contact.max_penetration_mm
        ));
        if let Some(warning) = &summary.warning {
            self.line(&format!("  warning: {warning}"));
        }
    }

    /// The run is over.
    pub fn finish(&self) {
        if let Output::Bar(bar) = &self.output {
            bar.finish_and_clear();
        }
    }

    /// Time left if what is left of the path takes as long as what was gone of it so far.
    fn time_left(&self) -> Option<String> {
        let (gone, left) = (self.last - self.start, self.end - self.last);
        let seconds = self.began.elapsed().as_secs_f64() * left / gone;
        (gone > 0.0 && left > 0.0).then(|| duration(seconds))
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
