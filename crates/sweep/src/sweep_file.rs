//! The file that says which designs are solved.

use std::path::{Path, PathBuf};

use pneuflex::document::{Document, Written};
use pneuflex::model::CaseError;
use pneuflex::{Change, Error, InputError};
use serde::Deserialize;
use toml::Value;

use crate::base::{Base, Design};
use crate::node::{Node, placed};
use crate::space::{self, Choice, MOST_DESIGNS, MOST_SOBOL, MOST_SOBOL_KEYS, Sample, Space};

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
        let table = match number {
            Some(number) if number >= self.of_space => format!("design[{}]", number - self.of_space),
            _ => "space".to_owned(),
        };
        let set = self.file.case.set.values();
        let key_of = |key: &str| {
            if number.is_some_and(|number| self.designs[number].iter().any(|(other, _)| other == key)) {
                return Some(format!("{table}.{key}"));
            }
            set.iter().any(|(other, _)| other == key).then(|| format!("set.{key}"))
        };
        placed(&self.file, &key_of, error)
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
