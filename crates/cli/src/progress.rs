//! Progress of a run: a bar on a terminal, plain lines elsewhere, nothing when quiet. All on standard error.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use pneuflex_newton::{Cause, IterationRecord};
use pneuflex_post::summary::StepSummary;

use crate::error::say;

/// Tells somebody how a run is going.
pub struct Progress {
    output: Output,
    began: Instant,
    last_kpa: f64,
    final_kpa: f64,
    /// Pressure aimed at by the step under way.
    aim_kpa: f64,
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
    /// Progress towards `final_kpa`.
    pub fn new(quiet: bool, final_kpa: f64) -> Self {
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
        Self { output, began: Instant::now(), last_kpa: 0.0, final_kpa, aim_kpa: 0.0, is_rejected: false }
    }

    /// Prints a line.
    pub fn line(&self, text: &str) {
        match &self.output {
            Output::Quiet => {}
            Output::Lines => say(text),
            Output::Bar(bar) => bar.println(text),
        }
    }

    /// A load step begins.
    pub fn step_started(&mut self, step: usize, pressure_kpa: f64) {
        // A new step after one that was not rejected: that one was accepted.
        if !self.is_rejected {
            self.last_kpa = self.aim_kpa;
        }
        (self.aim_kpa, self.is_rejected) = (pressure_kpa, false);
        match &self.output {
            Output::Bar(bar) => {
                bar.set_position((LENGTH as f64 * self.last_kpa / self.final_kpa) as u64);
                bar.set_message(format!("step {step} to {pressure_kpa:.4} kPa"));
            }
            _ => self.line(&format!("step {step} to {pressure_kpa:.4} kPa")),
        }
    }

    /// An iteration is done; "again" is one more correction with the factor of the same iteration.
    pub fn iteration(&self, record: &IterationRecord) {
        let again = if record.new_tangent { "" } else { " again" };
        let text = format!(
            "iteration {}{again}: correction {:.2e}, residual {:.2e} N, {} contact points",
            record.iteration, record.correction, record.residual, record.contact_points
        );
        match &self.output {
            Output::Bar(bar) => {
                let left = self.time_left().map(|t| format!(", {t} left")).unwrap_or_default();
                bar.set_message(format!("step {} to {:.3} kPa, {text}{left}", record.step, record.time));
            }
            _ => self.line(&format!("  {text}")),
        }
    }

    /// A load step failed and is repeated with a smaller one.
    pub fn rejected(&mut self, cause: &Cause) {
        self.is_rejected = true;
        self.line(&format!("  step rejected: {cause}"));
    }

    /// A requested pressure is reached.
    pub fn landed(&mut self, summary: &StepSummary) {
        let StepSummary { pressure_kpa, iterations, contact, .. } = summary;
        self.last_kpa = *pressure_kpa;
        let left = self.time_left().map(|t| format!(", {t} left")).unwrap_or_default();
        self.line(&format!(
            "{pressure_kpa} kPa reached in {iterations} iterations: end face turned by {:.2} deg, {} contact points, \
             penetration {:.4} mm{left}",
            summary.end_face_angle_deg, contact.points_active, contact.max_penetration_mm
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

    /// Time left if every kPa takes as long as those so far.
    fn time_left(&self) -> Option<String> {
        let kpa = self.last_kpa;
        let left = self.began.elapsed().as_secs_f64() * (self.final_kpa - kpa) / kpa;
        (kpa > 0.0 && kpa < self.final_kpa).then(|| duration(left))
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
