//! Supports and obstacles that move along the load path.

use pneuflex_model::{LoadParameter, Problem};

use crate::state::{State, difference};

/// Displacements of supports below this share of the body's extent are rounding.
const ROUNDED: f64 = 1e-15;

/// The displacements that the supports prescribe.
pub struct PrescribedMotion {
    /// `None` if no support ever moves.
    moving: Option<Problem>,
    /// Whether an obstacle ever moves, or is pressed out of the body.
    pub moves_obstacles: bool,
    /// Where overlaps at rest that are meant are gone; 0 without any.
    pub overlaps_until: LoadParameter,
}

impl PrescribedMotion {
    /// That of a problem's supports.
    pub fn of(problem: &Problem) -> Self {
        let of_obstacles = problem.obstacles.iter().filter_map(|obstacle| obstacle.interference_until);
        let of_pairs = problem.contact_pairs.iter().filter_map(|pair| pair.interference_until);
        let overlaps_until = of_obstacles.chain(of_pairs).fold(LoadParameter::default(), LoadParameter::max);
        let has_motion = problem.obstacles.iter().any(|obstacle| obstacle.motion.is_some());
        Self {
            moving: problem.supports.iter().any(|support| support.motion.is_some()).then(|| problem.clone()),
            moves_obstacles: has_motion || overlaps_until > LoadParameter::default(),
            overlaps_until,
        }
    }

    /// Whether anything moves the body that is no load.
    pub fn is_driving(&self) -> bool {
        self.moving.is_some() || self.moves_obstacles
    }

    /// Displacements at held degrees of freedom, mm, one entry per node; `None` if there are none to prescribe.
    pub fn target(&self, parameter: LoadParameter) -> Option<Vec<[f64; 3]>> {
        self.moving.as_ref().map(|problem| problem.held_displacement(parameter))
    }

    /// What is left of them at a state, mm, one entry per node.
    pub fn change(&self, state: &State) -> Option<Vec<[f64; 3]>> {
        self.target(state.parameter).map(|target| difference(&target, &state.displacement))
    }
}

/// Whether a change of the supports' displacements is more than rounding, for a body of an extent in mm.
pub(crate) fn is_felt(change: &[[f64; 3]], held: &[bool], size: f64) -> bool {
    change.as_flattened().iter().zip(held).any(|(x, held)| *held && x.abs() > ROUNDED * size)
}
