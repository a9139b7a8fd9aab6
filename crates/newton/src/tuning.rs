//! The constants that were found by measuring.

use crate::rotation_update::Extent;

/// Constants of globalisation, of the guess of a load step and of its step control. Each was tuned on the paper's actuator and on random
/// designs (`docs/measurements.md`).
#[derive(Clone, Debug, PartialEq)]
pub struct Tuning {
    /// A correction this many times as large as the body is no use.
    pub runaway: f64,
    /// A correction with more stretching or rotation comes from a tangent that is nearly singular, and leads nowhere.
    pub hopeless: Extent,
    /// Corrections smaller than this are not hopeless; like all lengths here in mean spacings of the nodes.
    pub harmless: f64,
    /// From this iteration on, a correction that is not smaller than [`Self::not_smaller`] times the one [`Self::circle`] tangents before is
    /// halved: contact points that open and close in turn let Newton's method run in circles.
    pub circling_from: usize,
    /// See [`Self::circling_from`].
    pub circle: usize,
    /// See [`Self::circling_from`].
    pub not_smaller: f64,
    /// Once a correction moves no node further than this, the factor at hand is tried for the next ones.
    pub modified_below: f64,
    /// Corrections in a row with the same factor, at the most.
    pub most_modified: usize,
    /// A correction with an old factor that is not smaller than this share of the one before is thrown away.
    pub modified_contraction: f64,
    /// Guesses are shortened to this stretching and rotation at any point: Newton's method hardly returns from further away.
    pub guess: Extent,
    /// Guesses are shortened where they would drive walls deeper than this into each other.
    pub guess_penetration: f64,
    /// Walls that are deep in each other may get this many times as deep: a guess that allows no more than there is would creep.
    pub guess_deepening: f64,
    /// By how much a guess is shortened at a time.
    pub shortening: f64,
    /// By how much at the most.
    pub shortest: f64,
    /// A step on the way is good enough (inexact Newton) when no node moves further than this,
    pub inexact_displacement: f64,
    /// and nothing is stretched further than this: in thin elements the displacement alone would leave stresses from which there is no going on.
    pub inexact_stretch: f64,
    /// Materials whose bulk modulus is a larger multiple of the shear modulus than this allow the less stretching, the less they allow of a
    /// change of volume.
    pub inexact_modulus_ratio: f64,
    /// After the present equilibrium was solved again to the tolerances, the next step is at least this share of the rejected one.
    pub step_after_polishing: f64,
    /// After an accepted step, the next one is at most this share of the size that was rejected before,
    pub step_after_rejection: f64,
    /// which counts as this many times as large after every accepted step.
    pub forgetting: f64,
    /// A step with no more iterations than this is followed by one twice as large.
    pub easy_iterations: usize,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            runaway: 1e3,
            hopeless: Extent { stretch: 0.7, angle: 1.5 },
            harmless: 0.12,
            circling_from: 8,
            circle: 3,
            not_smaller: 0.7,
            modified_below: 0.06,
            most_modified: 8,
            modified_contraction: 0.5,
            guess: Extent { stretch: 0.2, angle: 0.7 },
            guess_penetration: 0.24,
            guess_deepening: 1.5,
            shortening: 0.7,
            shortest: 0.03,
            inexact_displacement: 0.12,
            inexact_stretch: 0.05,
            inexact_modulus_ratio: 2e4,
            step_after_polishing: 0.25,
            step_after_rejection: 0.7,
            forgetting: 1.25,
            easy_iterations: 8,
        }
    }
}
