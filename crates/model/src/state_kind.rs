//! Why a state is among the results.

use serde::{Deserialize, Serialize};

/// Why a state is among the results. Paths that are followed by their arc length have others beside the requested ones; their names are part
/// of `summary.json`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StateKind {
    /// It was asked for.
    #[default]
    Requested,
    /// The load parameter has a greatest value there: a limit point, from which on it falls.
    GreatestLoad,
    /// The load parameter has a least value there: a limit point, from which on it rises again.
    LeastLoad,
    /// It lies beyond the first limit point.
    PastLimit,
}

impl StateKind {
    /// Whether it was asked for.
    pub fn is_requested(&self) -> bool {
        *self == Self::Requested
    }

    /// Whether the load parameter has a greatest or a least value there.
    pub fn is_limit_point(self) -> bool {
        matches!(self, Self::GreatestLoad | Self::LeastLoad)
    }
}
