//! What is needed to go on from an accepted load step as if nothing had happened.
//!
//! A path remembers more than its equilibrium: the next step is predicted with the factor of a tangent that was assembled one or more
//! corrections before. That factor is not stored but made again, from the displacement and the carried stresses it came from.

use serde::{Deserialize, Serialize};

use crate::history::{Augmentation, Timing};

/// An accepted load step and the path's memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Time reached.
    pub time: f64,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Multipliers λ of the supports, N, three per node.
    pub multipliers: Vec<f64>,
    /// Unknowns beside the displacements, see [`crate::System::border_len`].
    pub border: Vec<f64>,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Whether the equilibrium is solved well enough to go on from only, not to the tolerances asked for.
    pub is_loose: bool,
    /// Load steps attempted.
    pub step: usize,
    /// Newton iterations so far.
    pub iterations: usize,
    /// Seconds spent so far.
    pub timing: Timing,
    /// How far the path is on its way to the next requested time.
    pub approach: Approach,
    /// Largest stretching per time at the beginning of the path.
    pub first_rate: Option<f64>,
    /// Tangent whose factor predicts the next step.
    pub linearisation: Option<Linearisation>,
    /// Multipliers of the contact points, MPa; empty for a plain penalty.
    #[serde(default)]
    pub contact_multipliers: Vec<f64>,
    /// How the contact's multipliers came about, if the state is a requested one.
    #[serde(default)]
    pub augmentation: Option<Augmentation>,
}

/// The way to a requested time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// Size of the next load step.
    pub step: f64,
    /// Load steps accepted since the previous requested time.
    pub load_steps: usize,
    /// Iterations up to the previous requested time.
    pub iterations_before: usize,
}

/// A tangent by what it is made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Linearisation {
    /// Time.
    pub time: f64,
    /// Unknowns beside the displacements.
    pub border: Vec<f64>,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Source of the carried pressures.
    pub carried: Carried,
    /// Carried traction of every contact point, MPa.
    pub tractions: Vec<f64>,
}

/// What carried pressures follow from: a displacement, and the correction the linear system found there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Carried {
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Correction, mm; `None` if the pressures are those of the displacement itself.
    pub correction: Option<Vec<[f64; 3]>>,
}

/// A checkpoint that belongs to another problem, or is damaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the checkpoint does not fit the problem: {0}")]
pub struct Misfit(&'static str);

impl Checkpoint {
    /// Checks that every list has the length that a problem asks for and every number is finite.
    ///
    /// # Errors
    /// What does not fit.
    pub fn check(&self, num_nodes: usize, num_contact_points: usize, border_len: usize) -> Result<(), Misfit> {
        let field = |values: &[[f64; 3]]| values.len() == num_nodes && is_finite(values.as_flattened());
        let fits = field(&self.displacement) && self.multipliers.len() == 3 * num_nodes && is_finite(&self.multipliers);
        let lambda = &self.contact_multipliers;
        let fits = fits && (lambda.is_empty() || lambda.len() == num_contact_points) && is_finite(lambda);
        let beside = |border: &[f64]| border.len() == border_len && is_finite(border);
        let times = [self.time, self.approach.step];
        if !fits || !beside(&self.border) || !is_finite(&times) || self.time <= 0.0 || self.approach.step <= 0.0 {
            return Err(Misfit("its state"));
        }
        let Some(linearisation) = &self.linearisation else { return Ok(()) };
        let Linearisation { time, border, displacement, carried, tractions } = linearisation;
        let fits = field(displacement)
            && beside(border)
            && field(&carried.displacement)
            && carried.correction.as_ref().is_none_or(|correction| field(correction))
            && tractions.len() == num_contact_points
            && is_finite(tractions)
            && time.is_finite();
        if fits { Ok(()) } else { Err(Misfit("its tangent")) }
    }
}

fn is_finite(values: &[f64]) -> bool {
    values.iter().all(|x| x.is_finite())
}
