//! What a tangent is assembled from: a state, and the stresses that its geometric term carries (mixed linearisation, theory §11).

use std::sync::Arc;

use pneuflex_assembly::{Contribution, Prediction};
use pneuflex_model::LoadParameter;
use serde::{Deserialize, Serialize};

use crate::state::State;

/// A tangent by what it is made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Linearisation {
    /// Position on the load path.
    #[serde(rename = "time")]
    pub parameter: LoadParameter,
    /// Unknowns beside the displacements.
    #[serde(rename = "border")]
    pub bordered: Vec<f64>,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Source of the carried pressures.
    pub carried: Carried,
    /// Carried traction of every contact point, MPa, and what else contributions keep ([`pneuflex_assembly::Mixed::stored`]).
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

impl Linearisation {
    /// Its state.
    pub fn state(&self) -> State {
        State::new(self.parameter, self.displacement.clone(), self.bordered.clone())
    }
}

/// The stresses that the next tangent carries.
pub struct MixedLinearisation {
    prediction: Arc<Prediction>,
}

impl MixedLinearisation {
    /// Nothing is carried yet: the stresses at rest, which are zero.
    pub fn at_rest(num_nodes: usize) -> Self {
        let displacement = vec![[0.0; 3]; num_nodes];
        Self { prediction: Arc::new(Prediction { displacement, correction: None, ..Prediction::default() }) }
    }

    /// Lets the contributions take the stresses that the linear system, assembled at `displacement`, makes of theirs under a correction; or
    /// without one those of that displacement itself. `motion` are the positions that obstacles move between meanwhile.
    pub fn predict(
        &mut self,
        contributions: &mut [Box<dyn Contribution>],
        displacement: &[[f64; 3]],
        correction: Option<&[[f64; 3]]>,
        motion: Option<[LoadParameter; 2]>,
    ) {
        let (displacement, correction) = (displacement.to_vec(), correction.map(<[_]>::to_vec));
        self.take(contributions, Prediction { displacement, correction, motion });
    }

    fn take(&mut self, contributions: &mut [Box<dyn Contribution>], prediction: Prediction) {
        self.prediction = Arc::new(prediction);
        for mixed in contributions.iter_mut().filter_map(|contribution| contribution.mixed()) {
            mixed.predict(&self.prediction);
        }
    }

    /// A tangent is assembled at a state: what it is made from.
    pub fn linearise(&self, contributions: &mut [Box<dyn Contribution>], state: &State) -> Linearisation {
        let mut tractions = Vec::new();
        for mixed in contributions.iter_mut().filter_map(|contribution| contribution.mixed()) {
            mixed.linearise();
            tractions.extend_from_slice(mixed.stored());
        }
        let State { parameter, displacement, bordered } = state.clone();
        let Prediction { displacement: at, correction, .. } = (*self.prediction).clone();
        let carried = Carried { displacement: at, correction };
        Linearisation { parameter, bordered, displacement, carried, tractions }
    }

    /// Puts the stresses of an earlier linearisation back. Its lists must have this problem's lengths.
    pub fn restore(&mut self, contributions: &mut [Box<dyn Contribution>], linearisation: &Linearisation) {
        let Carried { displacement, correction } = linearisation.carried.clone();
        // Contact cannot predict at a position that it has not taken; it gets what was stored.
        self.prediction = Arc::new(Prediction { displacement, correction, ..Prediction::default() });
        let mut stored = &linearisation.tractions[..];
        for mixed in contributions.iter_mut().filter_map(|contribution| contribution.mixed()) {
            let (own, rest) = stored.split_at(mixed.stored().len());
            if own.is_empty() {
                mixed.predict(&self.prediction);
            } else {
                mixed.restore(own);
            }
            stored = rest;
        }
    }
}
