//! Functions of time as model files have them.

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, Visitor};
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

/// Written out because the derived reader of an untagged enum cannot say what it expects.
impl<'de> Deserialize<'de> for Series {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SeriesVisitor;
        impl<'de> Visitor<'de> for SeriesVisitor {
            type Value = Series;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, reached at the end, or points [[time, value], ...]")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Series, E> {
                Ok(Series::End(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Series, E> {
                Ok(Series::End(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Series, E> {
                Ok(Series::End(value as f64))
            }

            fn visit_seq<A: de::SeqAccess<'de>>(self, sequence: A) -> Result<Series, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(sequence)).map(Series::Points)
            }
        }
        deserializer.deserialize_any(SeriesVisitor)
    }
}
