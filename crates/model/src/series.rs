//! Functions of time as model files have them.

use pneuflex_mesh::{NumberOrList, number_or_list};
use serde::{Deserialize, Deserializer, Serialize};

/// A value at the end, reached along a straight line from zero, or points \[time, value\].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Series {
    /// Value at the last time.
    End(f64),
    /// Points in the order of time.
    Points(Vec<[f64; 2]>),
}

impl From<f64> for Series {
    fn from(value: f64) -> Self {
        Self::End(value)
    }
}

impl From<Vec<[f64; 2]>> for Series {
    fn from(points: Vec<[f64; 2]>) -> Self {
        Self::Points(points)
    }
}

impl<'de> Deserialize<'de> for Series {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let found = number_or_list(deserializer, "a number, reached at the end, or points [[time, value], ...]")?;
        Ok(match found {
            NumberOrList::Number(value) => Self::End(value),
            NumberOrList::List(points) => Self::Points(points),
        })
    }
}
