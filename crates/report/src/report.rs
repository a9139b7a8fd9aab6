//! What a report is made of.

use pneuflex_model::{Clock, Problem};

use crate::inputs::Group;
use crate::numbers::number;
use crate::state::State;
use crate::summary::Summary;

/// What a report is made of.
#[derive(Clone, Debug)]
pub struct Report<'a> {
    /// Title; may be empty.
    pub title: &'a str,
    /// What was solved in a few words: the number of chambers, or the name of a file.
    pub about: &'a str,
    /// The case or the model as it was solved, see [`crate::inputs::groups`].
    pub inputs: &'a [Group],
    /// Whether the problem is one half (y ≥ 0) of a body that is symmetric to y = 0.
    pub mirrored: bool,
    /// The problem that was solved.
    pub problem: &'a Problem,
    /// What the run says of itself.
    pub summary: &'a Summary,
    /// The fields at every reached step, in the order of the summary's; `None` if the run wrote none.
    pub states: Option<&'a [State]>,
}

impl Report<'_> {
    /// How many of the modelled part make the whole body.
    pub fn halves(&self) -> f64 {
        if self.mirrored { 2.0 } else { 1.0 }
    }

    /// Whether there are walls that may touch each other.
    pub(crate) fn has_walls(&self) -> bool {
        self.problem.clock == Clock::Pressure || !self.problem.contact_pairs.is_empty()
    }

    /// Whether there is contact to be shown.
    pub(crate) fn may_touch(&self) -> bool {
        self.has_walls() || !self.problem.obstacles.is_empty()
    }

    /// Whether a support holds the whole body, and not just the modelled half at its plane of symmetry.
    pub(crate) fn holds_whole(&self, support: &str) -> bool {
        !(self.mirrored && support == "symmetry")
    }

    /// What the body is called.
    pub(crate) fn noun(&self) -> &'static str {
        match self.problem.clock {
            Clock::Pressure => "actuator",
            Clock::Steps => "body",
        }
    }

    /// What results depend on.
    pub(crate) fn parameter(&self) -> &'static str {
        match self.problem.clock {
            Clock::Pressure => "pressure",
            Clock::Steps => "time",
        }
    }

    /// Unit of the parameter; empty for none.
    pub(crate) fn unit(&self) -> &'static str {
        match self.problem.clock {
            Clock::Pressure => "kPa",
            Clock::Steps => "",
        }
    }

    /// A value of the parameter as words, e.g. `35 kPa`.
    pub(crate) fn words(&self, time: f64) -> String {
        match self.problem.clock {
            Clock::Pressure => format!("{} kPa", number(time)),
            Clock::Steps => format!("time {}", number(time)),
        }
    }
}
