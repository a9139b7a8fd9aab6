//! The file that says which designs are solved.

use std::fmt;
use std::path::{Path, PathBuf};

use pneuflex::document::{Document, Written};
use pneuflex::input_error::Origin;
use pneuflex::model::CaseError;
use pneuflex::{Change, Error, InputError};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use toml::{Spanned, Value};

use crate::base::{Base, Design};
use crate::space::{self, Choice, MOST_DESIGNS, MOST_SOBOL, MOST_SOBOL_KEYS, Sample, Space};

/// Tables of which single keys are set; other tables are values.
const TABLES: [&str; 7] = ["actuator", "mesh", "contact", "load", "solver", "output", "model"];

/// What a sweep's file says.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepFile {
    /// Case file, model file or deck, beside this file.
    case: String,
    /// Whether every design's fields and report are kept.
    #[serde(default)]
    fields: bool,
    /// Where the guesses of their load steps come from.
    #[serde(default)]
    start: StartingPoint,
    /// How designs are taken from the space.
    #[serde(default)]
    sample: Sample,
    /// Number of designs of a sample.
    #[serde(default)]
    designs: Option<i64>,
    /// The same seed gives the same sample.
    #[serde(default)]
    seed: Option<i64>,
    /// Keys that all designs have in common.
    #[serde(default)]
    set: Node,
    /// Keys and what they may be.
    #[serde(default)]
    space: Node,
    /// Designs one by one.
    #[serde(default)]
    design: Vec<Node>,
}

/// Where the guesses of a design's load steps come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StartingPoint {
    /// Its own path from rest.
    #[default]
    Rest,
    /// The path of a similar design, where there is one.
    Neighbours,
}

/// A sweep as its file describes it.
#[derive(Clone, Debug)]
pub struct Described {
    /// What all designs are made from.
    pub base: Base,
    /// The designs.
    pub designs: Vec<Design>,
    /// Whether their fields are kept.
    pub fields: bool,
    /// Where the guesses of their load steps come from.
    pub start: StartingPoint,
    file: Written<SweepFile>,
    /// How many designs are those of the space.
    of_space: usize,
}

impl SweepFile {
    /// Reads a sweep's file; `changes` are to what its designs have in common.
    ///
    /// # Errors
    /// A file that cannot be read, or is no TOML; every unknown, missing or misplaced key and every value out of range.
    pub fn load(path: &Path, changes: &[Change]) -> Result<Described, Vec<InputError>> {
        let file = Written::<Self>::load(path, &[])?;
        let sweep = &file.case;
        let mut designs = sweep.of_space();
        let of_space = designs.len();
        designs.extend(sweep.design.iter().map(|design| design.values().into_iter().map(in_toml).collect::<Design>()));
        let mut common: Design = sweep.set.values().into_iter().map(in_toml).collect();
        common.extend(changes.iter().map(|change| (change.key.clone(), change.value.clone())));
        let base = Base { path: path.parent().unwrap_or(Path::new("")).join(&sweep.case), changes: common };
        Ok(Described { base, designs, fields: sweep.fields, start: sweep.start, of_space, file })
    }

    fn of_space(&self) -> Vec<Design> {
        let space = self.choices().unwrap_or_default();
        let (count, seed) = (self.designs.unwrap_or(0) as usize, self.seed.unwrap_or(0) as u64);
        match self.sample {
            _ if space.is_empty() => Vec::new(),
            Sample::Grid => space::grid(&space),
            Sample::LatinHypercube => space::latin_hypercube(&space, count, seed),
            Sample::Sobol => space::sobol(&space, count, seed),
        }
    }

    /// The space, or what is wrong with it.
    fn choices(&self) -> Result<Space, Vec<CaseError>> {
        let (mut space, mut wrong) = (Space::new(), Vec::new());
        for (key, node) in self.space.leaves() {
            match node.choice(space::is_count(&key)) {
                Ok(choice) => space.push((key, choice)),
                Err(allowed) => wrong.push(problem(&format!("space.{key}"), node.in_words(), allowed)),
            }
        }
        if wrong.is_empty() { Ok(space) } else { Err(wrong) }
    }
}

impl Document for SweepFile {
    fn problems(&self) -> Vec<CaseError> {
        let mut found = Vec::new();
        let space = self.choices().unwrap_or_else(|wrong| {
            found.extend(wrong);
            Space::new()
        });
        let is_grid = self.sample == Sample::Grid;
        let most = if self.sample == Sample::Sobol { MOST_SOBOL } else { MOST_DESIGNS };
        match self.designs {
            Some(count) if is_grid => {
                let allowed = "must be left out of a grid, which has every combination of values".to_owned();
                found.push(problem("designs", count.to_string(), allowed));
            }
            None if !is_grid => {
                let allowed = "a sample needs the number of its designs".to_owned();
                found.push(problem("designs", "nothing".into(), allowed));
            }
            Some(count) if count < 1 || count as usize > most => {
                let allowed = format!("must be a whole number from 1 to {most}");
                found.push(problem("designs", count.to_string(), allowed));
            }
            _ => {}
        }
        match self.seed {
            Some(seed) if is_grid => {
                found.push(problem("seed", seed.to_string(), "must be left out of a grid".into()));
            }
            Some(seed) if seed < 0 => found.push(problem("seed", seed.to_string(), "must be 0 or more".into())),
            _ => {}
        }
        if is_grid {
            for (key, choice) in &space {
                if !matches!(choice, Choice::Values(_)) {
                    let allowed =
                        "must be a list of values, or sample = \"latin-hypercube\" or \"sobol\" be said".into();
                    found.push(problem(&format!("space.{key}"), "a range".into(), allowed));
                }
            }
            if space::combinations(&space).is_some_and(|count| count > MOST_DESIGNS) {
                let allowed = format!("must have at the most {MOST_DESIGNS} combinations of values");
                found.push(problem("space", "the grid".into(), allowed));
            }
        }
        if self.sample == Sample::Sobol && space.len() > MOST_SOBOL_KEYS {
            let allowed = format!("must have at the most {MOST_SOBOL_KEYS} keys");
            found.push(problem("space", format!("a sequence of {} keys", space.len()), allowed));
        }
        if found.is_empty() && space.is_empty() && (self.design.is_empty() || !is_grid) {
            let allowed = "must have keys with values, or designs be listed as [[design]]".into();
            found.push(problem("space", "nothing".into(), allowed));
        }
        for (i, design) in self.design.iter().enumerate().filter(|(_, design)| design.values().is_empty()) {
            let allowed = "must have values by keys".into();
            found.push(problem(&format!("design[{i}]"), design.in_words(), allowed));
        }
        found
    }
}

impl Described {
    /// What is wrong with a design, at the place in the file where its values stand.
    pub fn place(&self, number: Option<usize>, error: Error) -> Error {
        let Error::Input(errors) = error else { return error };
        let table = match number {
            Some(number) if number >= self.of_space => format!("design[{}]", number - self.of_space),
            Some(_) => "space".to_owned(),
            None => "case".to_owned(),
        };
        let placed = |error: InputError| {
            let is_set = error.place().is_some_and(|place| place.origin() == Origin::Change);
            let key = error.place().map(|place| place.name().split('=').next().unwrap_or_default().trim().to_owned());
            let Some(key) = key.filter(|_| is_set) else { return error };
            // What is set on the command line has a place of its own.
            let has = |table: &Node| table.values().iter().any(|(other, _)| *other == key);
            let is_of_design = number.is_some_and(|number| self.designs[number].iter().any(|(k, _)| *k == key));
            let table = if is_of_design { &table } else { "set" };
            if table == "set" && !has(&self.file.case.set) {
                return error;
            }
            let at = self.file.out_of_range(&problem(&format!("{table}.{key}"), String::new(), String::new()));
            InputError::new(error.to_string())
                .of_kind(error.kind())
                .of_key(error.key().unwrap_or(&key))
                .at(at.place().cloned())
                .with_help(error.help().map(str::to_owned))
        };
        Error::Input(errors.into_iter().map(placed).collect())
    }

    /// Name of the file without folder and extension.
    pub fn stem(&self) -> String {
        self.file.stem()
    }

    /// The file.
    pub fn path(&self) -> PathBuf {
        self.file.path().to_owned()
    }
}

fn problem(key: &str, value: String, allowed: String) -> CaseError {
    CaseError { key: key.to_owned(), value, allowed }
}

fn in_toml((key, value): (String, Value)) -> (String, String) {
    (key, value.to_string())
}

/// A value of TOML whose tables keep their order, in which grids are gone through.
#[derive(Clone, Debug)]
enum Node {
    Value(Value),
    List(Vec<Self>),
    Table(Vec<(String, Self)>),
}

impl Default for Node {
    fn default() -> Self {
        Self::Table(Vec::new())
    }
}

impl Node {
    /// As a value.
    fn value(&self) -> Value {
        match self {
            Self::Value(value) => value.clone(),
            Self::List(entries) => entries.iter().map(Self::value).collect::<Vec<_>>().into(),
            Self::Table(pairs) => Value::Table(pairs.iter().map(|(key, node)| (key.clone(), node.value())).collect()),
        }
    }

    /// Keys of a design with their values.
    fn values(&self) -> Vec<(String, Value)> {
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
    fn leaves(&self) -> Vec<(String, &Self)> {
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
    fn choice(&self, is_count: bool) -> Result<Choice, String> {
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

    fn in_words(&self) -> String {
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::sample::{Index, select};

    use super::*;

    const TEXT: &str = "case = \"case.toml\"\nfields = true\nsample = \"sobol\"\ndesigns = 8\nseed = 3\n\n[set]\n\"mesh.size\" = 3\n\
        load.pressure_kpa = [1, 2]\n\n[space]\n\"actuator.gap\" = { from = 1.0, to = 2 }\n\
        actuator.chambers = { from = 2, to = 4 }\nmaterial = [\"dragon-skin-30\", { law = \"gent\" }]\n\n[[design]]\n\"actuator.gap\" = 3\n";

    /// What stands in the place of a piece of the text.
    const ODD: [&str; 19] = [
        "",
        "0",
        "-1",
        "3.7",
        "1e308",
        "1e999",
        "nan",
        "inf",
        "9223372036854775807",
        "-9223372036854775808",
        "true",
        "[]",
        "{}",
        "\"\"",
        "{ from = 1, to = 9223372036854775807 }",
        "\n[space]\n",
        "\n[[design]]\n",
        "=",
        "é",
    ];

    proptest! {
        /// No text makes the reader of sweeps panic, hang, or fail without a word.
        #[test]
        fn damaged_texts_are_refused_or_are_designs(
            changes in proptest::collection::vec((any::<Index>(), 0..12_usize, select(&ODD[..])), 1..5)
        ) {
            let mut text = TEXT.to_owned();
            for (at, length, odd) in changes {
                let from = (0..=at.index(text.len() + 1)).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
                let to = (from + length..text.len()).find(|at| text.is_char_boundary(*at)).unwrap_or(text.len());
                text.replace_range(from.min(to)..to, odd);
            }
            match Written::<SweepFile>::from_text(Path::new("sweep.toml"), text.clone(), &[]) {
                Ok(file) => {
                    let designs = file.case.of_space();
                    prop_assert!(designs.len() <= MOST_DESIGNS && designs.len() + file.case.design.len() > 0, "{text}");
                }
                Err(errors) => prop_assert!(errors.iter().all(|error| !error.to_string().is_empty()) && !errors.is_empty()),
            }
        }
    }

    /// Between 1 and 2 mm there are other gaps than these two, and between 2 and 4 chambers only 3.
    #[test]
    fn ranges_have_whole_numbers_of_what_is_counted() {
        let file = Written::<SweepFile>::from_text(Path::new("sweep.toml"), TEXT.replace("1.0", "1"), &[]).unwrap();
        let space = file.case.choices().unwrap();
        assert_eq!(space[0].1, Choice::Between(1.0, 2.0));
        assert_eq!(space[1].1, Choice::WholeBetween(2, 4));
    }
}
