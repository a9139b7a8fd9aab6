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
    /// The problem that was solved; numbers are those of the whole body, also where a part of it was modelled.
    pub problem: &'a Problem,
    /// What the run says of itself.
    pub summary: &'a Summary,
    /// The fields at every reached step, in the order of the summary's; `None` if the run wrote none.
    pub states: Option<&'a [State]>,
}

impl Report<'_> {
    /// By axis, whether the body is cut at a plane of symmetry normal to it.
    pub(crate) fn mirrored(&self) -> [bool; 3] {
        std::array::from_fn(|axis| self.problem.symmetry.iter().any(|plane| plane.axis == axis))
    }

    /// Nodes in every plane of symmetry.
    pub(crate) fn symmetry_nodes(&self) -> Vec<&[u32]> {
        self.problem.symmetry.iter().map(|plane| &self.problem.supports[plane.support].nodes[..]).collect()
    }

    /// Whether there are walls that may touch each other.
    pub(crate) fn has_walls(&self) -> bool {
        self.problem.clock == Clock::Pressure || !self.problem.contact_pairs.is_empty()
    }

    /// Whether there is contact to be shown.
    pub(crate) fn may_touch(&self) -> bool {
        self.has_walls() || !self.problem.obstacles.is_empty()
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
