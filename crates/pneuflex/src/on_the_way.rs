//! States between the requested positions of a load path, kept until the next requested one is reached: they are what a run that ends
//! early leaves beside its results.

use pneuflex_model::LoadParameter;
use pneuflex_newton::Checkpoint;
use serde::{Deserialize, Serialize};

/// The way from one requested position to the next is divided into so many parts; a state is kept of each, if one in it is solved to the
/// tolerances: where it is only good enough to go on from, forces may be anything.
const PARTS: f64 = 5.0;

/// States on the way to the next requested position, as accepted load steps. Which ones does not depend on where a run was interrupted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OnTheWay {
    states: Vec<Checkpoint>,
    /// Part of the way that the last one is in.
    part: Option<u8>,
}

impl OnTheWay {
    /// Looks at an accepted load step between two requested positions.
    pub fn accept(&mut self, step: &Checkpoint, [from, to]: [LoadParameter; 2]) {
        if step.is_inexact || step.parameter <= from || step.parameter >= to {
            return;
        }
        let part = (PARTS * (step.parameter - from) / (to - from)).floor() as u8;
        if self.part.is_none_or(|last| part > last) {
            self.part = Some(part);
            // Nothing goes on from it.
            self.states.push(Checkpoint { linearisation: None, ..step.clone() });
        }
    }

    /// A requested position is reached.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The states that are kept, before a position.
    pub fn before(&self, end: LoadParameter) -> impl Iterator<Item = &Checkpoint> {
        self.states.iter().filter(move |state| state.parameter < end)
    }
}

/// How the fields of a state on the way are numbered.
pub fn on_the_way_number(number: usize) -> String {
    format!("on_the_way_{number:02}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_newton::checkpoint::Approach;
    use pneuflex_newton::{ArcMemory, Timing};

    fn step(at: f64) -> Checkpoint {
        Checkpoint {
            parameter: LoadParameter(at),
            displacement: Vec::new(),
            multipliers: Vec::new(),
            bordered: Vec::new(),
            contact_points: 0,
            is_inexact: false,
            step: 1,
            iterations: 1,
            timing: Timing::default(),
            approach: Approach { step: 1.0, rejected: None, load_steps: 1, iterations_before: 0 },
            first_rate: None,
            linearisation: None,
            contact_multipliers: Vec::new(),
            augmentation: None,
            mesh_motions: None,
            is_careful: false,
            negative_pivots: 0,
            arc: ArcMemory::default(),
            bifurcations: Vec::new(),
            snaps: Vec::new(),
        }
    }

    #[test]
    fn a_few_states_are_kept_between_requested_ones() {
        let mut kept = OnTheWay::default();
        let way = [10.0, 20.0].map(LoadParameter);
        kept.accept(&Checkpoint { is_inexact: true, ..step(10.5) }, way);
        for at in [10.0, 11.0, 11.5, 14.5, 15.9, 16.1, 19.0, 19.5, 20.0] {
            kept.accept(&step(at), way);
        }
        let found = |end| kept.before(LoadParameter(end)).map(|state| state.parameter.0).collect::<Vec<_>>();
        assert_eq!(found(30.0), [11.0, 14.5, 16.1, 19.0]);
        assert_eq!(found(19.0), [11.0, 14.5, 16.1]);
        kept.clear();
        kept.accept(&step(21.0), [20.0, 40.0].map(LoadParameter));
        assert_eq!(kept.before(LoadParameter(40.0)).count(), 1);
    }
}
