//! Values by keys in a file, in their order: of what is set in a case file, and of what its keys may be.

use std::fmt;

use pneuflex::document::{Document, Written};
use pneuflex::input_error::Origin;
use pneuflex::model::CaseError;
use pneuflex::{Error, InputError};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use toml::{Spanned, Value};

use crate::space::Choice;

/// Tables of which single keys are set; other tables are values.
const TABLES: [&str; 7] = ["actuator", "mesh", "contact", "load", "solver", "output", "model"];

/// A value of TOML whose tables keep their order, in which grids are gone through.
#[derive(Clone, Debug)]
pub enum Node {
    /// Neither a list nor a table.
    Value(Value),
    /// A list.
    List(Vec<Self>),
    /// A table.
    Table(Vec<(String, Self)>),
}

impl Default for Node {
    fn default() -> Self {
        Self::Table(Vec::new())
    }
}

impl Node {
    /// As a value.
    pub fn value(&self) -> Value {
        match self {
            Self::Value(value) => value.clone(),
            Self::List(entries) => entries.iter().map(Self::value).collect::<Vec<_>>().into(),
            Self::Table(pairs) => Value::Table(pairs.iter().map(|(key, node)| (key.clone(), node.value())).collect()),
        }
    }

    /// Keys of a design with their values.
    pub fn values(&self) -> Vec<(String, Value)> {
        let Self::Table(pairs) = self else { return Vec::new() };
        let of = |(key, node): &(String, Self)| match node {
            Self::Table(inner) if TABLES.contains(&key.as_str()) => {
                inner.iter().map(|(name, node)| (format!("{key}.{name}"), node.value())).collect()
            }
            node => vec![(key.clone(), node.value())],
        };
        pairs.iter().flat_map(of).collect()
    }

    /// Keys of a space with what they may be: what is no table, and ranges.
    pub fn leaves(&self) -> Vec<(String, &Self)> {
        let Self::Table(pairs) = self else { return Vec::new() };
        let mut found = Vec::new();
        for (key, node) in pairs {
            match node {
                Self::Table(inner) if !inner.iter().any(|(name, _)| name == "from" || name == "to") => {
                    found.extend(node.leaves().into_iter().map(|(name, node)| (format!("{key}.{name}"), node)));
                }
                _ => found.push((key.clone(), node)),
            }
        }
        found
    }

    /// What a key may be.
    ///
    /// # Errors
    /// What it must be, in words.
    pub(crate) fn choice(&self, is_count: bool) -> Result<Choice, String> {
        let expected = || "must be a list of values or { from = …, to = … }".to_owned();
        match self {
            Self::List(values) if values.is_empty() => Err("must have at least one value".into()),
            Self::List(values) => Ok(Choice::Values(values.iter().map(Self::value).collect())),
            Self::Table(pairs) => {
                let end = |name: &str| pairs.iter().find(|(key, _)| key == name).map(|(_, node)| node.value());
                let (Some(from), Some(to), 2) = (end("from"), end("to"), pairs.len()) else { return Err(expected()) };
                match (&from, &to) {
                    (Value::Integer(from), Value::Integer(to)) if is_count && from <= to => {
                        Ok(Choice::WholeBetween(*from, *to))
                    }
                    _ if is_count => Err("must be from a whole number to one that is not smaller".into()),
                    _ => {
                        let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
                        let ends = number(&from)
                            .zip(number(&to))
                            .filter(|(from, to)| from.is_finite() && to.is_finite() && from <= to);
                        let (from, to) = ends.ok_or("must be from a number to one that is not smaller")?;
                        Ok(Choice::Between(from, to))
                    }
                }
            }
            Self::Value(_) => Err(expected()),
        }
    }

    pub(crate) fn in_words(&self) -> String {
        self.value().to_string()
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Node;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value of a key")
            }

            fn visit_bool<E>(self, truth: bool) -> Result<Node, E> {
                Ok(Node::Value(truth.into()))
            }

            fn visit_i64<E>(self, number: i64) -> Result<Node, E> {
                Ok(Node::Value(number.into()))
            }

            fn visit_f64<E>(self, number: f64) -> Result<Node, E> {
                Ok(Node::Value(number.into()))
            }

            fn visit_str<E>(self, text: &str) -> Result<Node, E> {
                Ok(Node::Value(text.into()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Node, A::Error> {
                let mut found = Vec::new();
                while let Some(entry) = entries.next_element()? {
                    found.push(entry);
                }
                Ok(Node::List(found))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Node, A::Error> {
                let mut found: Vec<(Spanned<String>, Node)> = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    found.push(pair);
                }
                found.sort_by_key(|(key, _)| key.span().start);
                Ok(Node::Table(found.into_iter().map(|(key, node)| (key.into_inner(), node)).collect()))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

/// Errors of values that a file sets, at their places in it; `key_of` is the key in the file by which a key is set, if it is. What is set on the
/// command line has a place of its own.
pub fn placed<T: Document>(file: &Written<T>, key_of: &dyn Fn(&str) -> Option<String>, error: Error) -> Error {
    let Error::Input(errors) = error else { return error };
    let placed = |error: InputError| {
        let of_change = error.place().filter(|place| place.origin() == Origin::Change);
        let key = of_change.map(|place| place.name().split('=').next().unwrap_or_default().trim().to_owned());
        // What is found out behind the text, by the mesh or its derivatives, has a key and no place.
        let key = key.or_else(|| error.key().filter(|_| error.place().is_none()).map(str::to_owned));
        let Some((key, own)) = key.and_then(|key| Some((key_of(&key)?, key))) else { return error };
        let at = file.out_of_range(&CaseError { key, value: String::new(), allowed: String::new() });
        InputError::new(error.to_string())
            .of_kind(error.kind())
            .of_key(error.key().unwrap_or(&own))
            .at(at.place().cloned())
            .with_help(error.help().map(str::to_owned))
    };
    Error::Input(errors.into_iter().map(placed).collect())
}
