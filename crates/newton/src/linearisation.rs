//! What a tangent is assembled from: a state, and the stresses that its geometric term carries (mixed linearisation, theory §11).

use std::sync::Arc;

use pneuflex_assembly::{Contribution, Mixed, Prediction};
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
    /// Carried pressures of the elements and tractions of the contact points, MPa, and what else contributions keep
    /// ([`pneuflex_assembly::Mixed::stored`]).
    pub stored: Vec<f64>,
}

impl Linearisation {
    /// The tangent that is assembled next, at a state.
    pub fn next(contributions: &mut [Box<dyn Contribution>], state: &State) -> Self {
        let mut stored = Vec::new();
        for mixed in mixed(contributions) {
            mixed.linearise();
            stored.extend_from_slice(mixed.stored());
        }
        let State { parameter, displacement, bordered } = state.clone();
        Self { parameter, bordered, displacement, stored }
    }

    /// Its state.
    pub fn state(&self) -> State {
        State::new(self.parameter, self.displacement.clone(), self.bordered.clone())
    }

    /// Whether it is one of a problem with so many nodes, unknowns beside the displacements, and values that contributions keep.
    pub fn fits(&self, num_nodes: usize, num_bordered: usize, num_stored: usize) -> bool {
        let Self { parameter, bordered, displacement, stored } = self;
        let is_finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
        [displacement.len(), bordered.len(), stored.len()] == [num_nodes, num_bordered, num_stored]
            && parameter.0.is_finite()
            && [displacement.as_flattened(), bordered, stored].into_iter().all(is_finite)
    }

    /// Lets the next tangent carry its stresses. It must fit.
    pub fn restore(&self, contributions: &mut [Box<dyn Contribution>]) {
        let mut stored = &self.stored[..];
        for mixed in mixed(contributions) {
            let (own, rest) = stored.split_at(mixed.num_stored());
            mixed.restore(own);
            stored = rest;
        }
    }
}

/// Lets the contributions take the stresses that the linear system predicts for the next tangent.
pub fn predict(contributions: &mut [Box<dyn Contribution>], prediction: Prediction) {
    let prediction = Arc::new(prediction);
    mixed(contributions).for_each(|mixed| mixed.predict(&prediction));
}

/// Number of values that the contributions keep of a tangent.
pub fn num_stored(contributions: &mut [Box<dyn Contribution>]) -> usize {
    mixed(contributions).map(|mixed| mixed.num_stored()).sum()
}

fn mixed(contributions: &mut [Box<dyn Contribution>]) -> impl Iterator<Item = &mut dyn Mixed> {
    contributions.iter_mut().filter_map(|contribution| contribution.mixed())
}
