//! Values that files give as a number or as a list.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer};

/// What a file gives.
#[derive(Clone, Debug, PartialEq)]
pub enum NumberOrList<L> {
    /// A number, whole or not.
    Number(f64),
    /// A list.
    List(L),
}

/// Reads a number or a list; `expected` says what both are, for the message where it is neither. Written out because the derived reader of an
/// untagged enum cannot say what it expects.
///
/// # Errors
/// Neither, or a list of something else.
pub fn number_or_list<'de, L: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
    expected: &'static str,
) -> Result<NumberOrList<L>, D::Error> {
    deserializer.deserialize_any(Either { expected, list: PhantomData })
}

struct Either<L> {
    expected: &'static str,
    list: PhantomData<L>,
}

impl<'de, L: Deserialize<'de>> Visitor<'de> for Either<L> {
    type Value = NumberOrList<L>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(NumberOrList::Number(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        Ok(NumberOrList::Number(value as f64))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Self::Value, E> {
        Ok(NumberOrList::Number(value as f64))
    }

    fn visit_seq<A: de::SeqAccess<'de>>(self, sequence: A) -> Result<Self::Value, A::Error> {
        L::deserialize(SeqAccessDeserializer::new(sequence)).map(NumberOrList::List)
    }
}
