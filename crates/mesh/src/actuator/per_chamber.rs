//! Lengths, and other numbers, that chambers have in common or each for itself.

use serde::{Deserialize, Deserializer, Serialize};

use crate::number_or_list::{NumberOrList, number_or_list};

/// A number for all chambers, or a list with one for each, from the clamp on; of gaps one for each between two chambers.
///
/// In files and messages entries count from 1, as chambers do: `gap[3]` lies between chambers 3 and 4.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PerChamber {
    /// The same for all.
    All(f64),
    /// One for each.
    Each(Vec<f64>),
}

impl PerChamber {
    /// The numbers as they are given: one, or as many as the list has.
    pub fn entries(&self) -> &[f64] {
        match self {
            Self::All(value) => std::slice::from_ref(value),
            Self::Each(list) => list,
        }
    }

    /// That of chamber or gap `i` (from 0); not a number beyond the end of a list.
    pub fn at(&self, i: usize) -> f64 {
        match self {
            Self::All(value) => *value,
            Self::Each(list) => list.get(i).copied().unwrap_or(f64::NAN),
        }
    }

    /// The one number that all of them are; `None` where they differ, or there is none.
    pub fn common(&self) -> Option<f64> {
        let (first, rest) = self.entries().split_first()?;
        rest.iter().all(|other| other == first).then_some(*first)
    }

    /// Whether chambers differ in it.
    pub fn is_varied(&self) -> bool {
        self.entries().windows(2).any(|pair| pair[0] != pair[1])
    }

    /// The smallest of them; infinite if there is none.
    pub fn least(&self) -> f64 {
        self.entries().iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The largest of them; −∞ if there is none.
    pub fn greatest(&self) -> f64 {
        self.entries().iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Sum over `count` chambers or gaps. Of equal entries it is that of the number, to the last bit.
    pub(super) fn total(&self, count: f64) -> f64 {
        match self {
            Self::All(value) => count * value,
            Self::Each(list) => self.common().map_or_else(|| list.iter().sum(), |value| count * value),
        }
    }

    /// Its entries with their keys in a file: `key` itself, or `key[1]`, `key[2]`, …
    pub fn keyed<'a>(&'a self, key: &'a str) -> impl Iterator<Item = (String, f64)> + 'a {
        let name = move |i: usize| match self {
            Self::All(_) => key.to_owned(),
            Self::Each(_) => format!("{key}[{}]", i + 1),
        };
        self.entries().iter().enumerate().map(move |(i, &value)| (name(i), value))
    }
}

impl From<f64> for PerChamber {
    fn from(value: f64) -> Self {
        Self::All(value)
    }
}

impl From<Vec<f64>> for PerChamber {
    fn from(list: Vec<f64>) -> Self {
        Self::Each(list)
    }
}

impl<const N: usize> From<[f64; N]> for PerChamber {
    fn from(list: [f64; N]) -> Self {
        Self::Each(list.into())
    }
}

impl<'de> Deserialize<'de> for PerChamber {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let found = number_or_list(deserializer, "a number for all chambers, or a list with one for each")?;
        Ok(match found {
            NumberOrList::Number(value) => Self::All(value),
            NumberOrList::List(list) => Self::Each(list),
        })
    }
}
