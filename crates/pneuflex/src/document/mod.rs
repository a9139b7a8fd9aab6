//! Reading a case or model file and changes to it, with errors that name file, line, key and allowed range.
//!
//! Everything wrong with a case is said at once: what cannot be read is mended for the time being (a misspelt key gets its nearest
//! name, a wrong value its default) and reading goes on (`repair`).
//!
//! Changes are TOML themselves. Each is parsed behind as many blanks as the texts before it have bytes, so that every
//! span of the merged document is a place in exactly one of the texts.

pub(crate) mod place;
mod repair;
mod sources;
mod suggest;

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pneuflex_model::model_file::Model;
use pneuflex_model::{Case, CaseError};
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::input_error::{InputError, InputErrorKind, Origin};
use crate::store::Store;
use repair::{Repair, Repairs};
use sources::{Key, Sources, Text, collect, place_of, value_of};

/// Problems of a file that are said at the most.
const MOST_PROBLEMS: usize = 30;

/// Keys of `[mesh]` that a resolution stands for.
const SIZES: [&str; 3] = ["size", "edge_size", "wall_elements"];

/// What a file in TOML describes.
pub trait Document: DeserializeOwned {
    /// Every key whose value is out of range.
    fn problems(&self) -> Vec<CaseError>;
}

impl Document for Case {
    fn problems(&self) -> Vec<CaseError> {
        Self::problems(self)
    }
}

impl Document for Model {
    fn problems(&self) -> Vec<CaseError> {
        Self::problems(self)
    }
}

/// The case file of an actuator.
pub type CaseFile = Written<Case>;

/// Another value for a key of a case or model file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// The key, e.g. `actuator.gap`; `actuator.gap[3]` for one entry, from 1, of a list of numbers, or of what may be given for every chamber;
    /// `obstacle[0].centre.z` or `obstacle.ball.radius` for a number in one of several tables, from 0 or by its name.
    pub key: String,
    /// The value in TOML; what is no TOML is taken as a text without quotes.
    pub value: String,
}

impl Change {
    /// Sets `key` to `value`.
    pub fn new(key: impl Into<String>, value: impl Into<String>) -> Self {
        Self { key: key.into(), value: value.into() }
    }

    /// Whether an earlier change has no meaning any more beside this one: one of the same key, of a key in a table that is given as a whole,
    /// or of a size of the mesh where this one asks for a resolution.
    pub fn replaces(&self, earlier: &Self) -> bool {
        let (key, old) = (self.key.trim(), earlier.key.trim());
        let is_within = old.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
        is_within || key == "mesh.resolution" && SIZES.iter().any(|size| old == format!("mesh.{size}"))
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.value)
    }
}

/// A case or a model together with where its values come from.
#[derive(Clone, Debug)]
pub struct Written<T> {
    /// The case, every value within its range.
    pub case: T,
    path: PathBuf,
    sources: Sources,
    keys: Vec<Key>,
}

impl<T: Document> Written<T> {
    /// Reads and checks a case file with changes to it.
    ///
    /// # Errors
    /// A file that cannot be read, is not UTF-8 or not TOML; every unknown, missing or misplaced key and every value out of range.
    pub fn load(path: &Path, changes: &[Change]) -> Result<Self, Vec<InputError>> {
        Self::from_text(path, Store::Disk.text(path)?, changes)
    }

    /// The same from a text; `path` is its name in messages.
    ///
    /// # Errors
    /// As there.
    pub fn from_text(path: &Path, text: impl Into<Arc<str>>, changes: &[Change]) -> Result<Self, Vec<InputError>> {
        let name = path.display().to_string();
        let file = Text { name, origin: Origin::File, start: 0, text: text.into(), key: String::new() };
        let mut sources = Sources { texts: vec![file] };
        for change in changes {
            sources.push_change(&change.key, &change.value, change.to_string())?;
        }
        let padded: Vec<String> =
            sources.texts[1..].iter().map(|t| format!("{}{}", " ".repeat(t.start), t.parsed())).collect();
        let syntax = |error: &toml::de::Error| {
            let place = error.span().map(|span| sources.place(span));
            InputError::new(format!("not valid TOML: {}", plain_types(&one_line(error.message())))).at(place)
        };
        let mut document = DeTable::parse(&sources.texts[0].text).map_err(|e| syntax(&e))?;
        let changes = padded.iter().map(|text| Ok(DeTable::parse(text).map_err(|e| syntax(&e))?.into_inner()));
        let changes: Vec<DeTable<'_>> = changes.collect::<Result<_, InputError>>()?;
        if changes.iter().any(|change| of_mesh(change).is_some_and(|mesh| mesh.contains_key("resolution"))) {
            make_way_for_resolution(document.get_mut());
        }
        let given = value_of(&document);
        let (of_entries, of_keys): (Vec<_>, Vec<_>) =
            changes.into_iter().zip(&sources.texts[1..]).partition(|(_, text)| text.is_in_list(given.as_ref()));
        for (change, text) in of_keys {
            set(document.get_mut(), change, place::names(&text.key));
        }
        // Behind the others, whatever their order: an entry is one of the list, and of as many chambers, as they leave.
        for (change, text) in of_entries {
            text.set_entry(&mut document, change)?;
        }
        let mut keys = Vec::new();
        collect(document.get_ref(), "", &mut keys);
        let (case, errors) = deserialize(&mut document, &sources, &keys);
        match case {
            Some(case) if errors.is_empty() => Ok(Self { case, path: path.to_owned(), sources, keys }),
            _ => Err(errors),
        }
    }

    /// Turns a range error into one that shows where the value stands.
    pub fn out_of_range(&self, error: &CaseError) -> InputError {
        out_of_range(error, &self.sources, &self.keys)
    }

    /// Name of the case file without folder and extension.
    pub fn stem(&self) -> String {
        self.path.file_stem().map_or_else(|| "case".into(), |s| s.to_string_lossy().into_owned())
    }

    /// Path of the case file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Reads the case, and says everything that is wrong with it.
fn deserialize<T: Document>(
    document: &mut Spanned<DeTable<'_>>,
    sources: &Sources,
    keys: &[Key],
) -> (Option<T>, Vec<InputError>) {
    let mut errors = Vec::new();
    let mut repairs = Repairs::default();
    while errors.len() < MOST_PROBLEMS {
        let error = match T::deserialize(toml::Deserializer::from(document.clone())) {
            Ok(case) => {
                let problems = case.problems();
                let said = problems.iter().filter(|problem| !repairs.touch(&problem.key));
                let said = said.take(MOST_PROBLEMS - errors.len());
                errors.extend(said.map(|problem| out_of_range(problem, sources, keys)));
                errors.sort_by_key(InputError::position);
                return (Some(case), errors);
            }
            Err(error) => error,
        };
        let (said, repair) = describe(&error, sources, keys);
        let is_news = !repairs.touch(repair.path());
        if is_news {
            errors.push(said);
        }
        if !repairs.apply(repair, document.get_mut()) {
            break;
        }
    }
    errors.sort_by_key(InputError::position);
    (None, errors)
}

fn out_of_range(error: &CaseError, sources: &Sources, keys: &[Key]) -> InputError {
    InputError::new(error.to_string()).of_key(&error.key).at(Some(place_of(&error.key, sources, keys)))
}

/// Whether a text describes a model rather than an actuator with nothing but air in it: a table `model`, or times instead of
/// pressures. A text that cannot be read does neither.
pub fn is_model(text: &str) -> bool {
    let Ok(document) = DeTable::parse(text) else { return false };
    let load = document.get_ref().get("load").and_then(|load| load.get_ref().as_table());
    document.get_ref().contains_key("model") || load.is_some_and(|load| load.contains_key("times"))
}

fn of_mesh<'a, 'b>(document: &'b DeTable<'a>) -> Option<&'b DeTable<'a>> {
    document.get("mesh").and_then(|mesh| mesh.get_ref().as_table())
}

/// A resolution that is set replaces the sizes of the file: beside it, those keys would win. The element stays if the file has chosen it for
/// a resolution of its own; else it is part of the mesh that is replaced. What other changes set stays, whatever their order.
fn make_way_for_resolution(document: &mut DeTable<'_>) {
    let has_resolution = of_mesh(document).is_some_and(|mesh| mesh.contains_key("resolution"));
    if let Some(DeValue::Table(mesh)) = document.get_mut("mesh").map(Spanned::get_mut) {
        for key in SIZES {
            mesh.remove(key);
        }
        if !has_resolution {
            mesh.remove("element");
        }
    }
}

/// Sets a key of so many names. Its value is the new one and nothing of the old, also where it is a table.
fn set<'a>(into: &mut DeTable<'a>, change: DeTable<'a>, names: usize) {
    for (key, value) in change {
        let existing = into.get_mut(key.get_ref().as_ref()).map(Spanned::get_mut);
        match (existing, value) {
            (Some(DeValue::Table(old)), value) if names > 1 && value.get_ref().is_table() => {
                if let DeValue::Table(new) = value.into_inner() {
                    set(old, new, names - 1);
                }
            }
            (_, value) => {
                // Removed first, because an insertion keeps the old key with its old place.
                into.remove(key.get_ref().as_ref());
                into.insert(key, value);
            }
        }
    }
}

/// Puts a reader's error into words about keys, with what lets the reader go on.
fn describe(error: &toml::de::Error, sources: &Sources, keys: &[Key]) -> (InputError, Repair) {
    let message = one_line(error.message());
    let span = error.span().unwrap_or(0..0);
    // The innermost key whose name or value is at the error's place.
    let holds = |range: &Range<usize>| range.start <= span.start && span.start < range.end.max(range.start + 1);
    let key = keys
        .iter()
        .filter(|k| holds(&k.key) || holds(&k.value))
        .min_by_key(|k| if holds(&k.key) { k.key.len() } else { k.value.len() });
    let path = key.map_or("", |k| k.path.as_str());
    let place = Some(sources.place(span.clone()));
    let did_you_mean = |name: &str| format!("did you mean `{name}`?");

    if let Some((_, rest)) = message.split_once("unknown field `") {
        let (name, expected) = rest.split_once('`').unwrap_or((rest, ""));
        let allowed = quoted(expected);
        let known =
            if allowed.is_empty() { String::new() } else { format!("; known keys here: {}", allowed.join(", ")) };
        let meant = suggest::closest(name, allowed.iter().copied());
        let path = if path.is_empty() { name } else { path };
        let repair = match meant {
            Some(meant) => Repair::Rename { path: path.into(), to: meant.into() },
            None => Repair::Remove(path.into()),
        };
        let error =
            InputError::new(format!("unknown key `{path}`{known}")).of_kind(InputErrorKind::Unknown).of_key(path);
        return (error.at(place).with_help(meant.map(did_you_mean)), repair);
    }
    if let Some((_, rest)) = message.split_once("unknown variant `") {
        let (name, expected) = rest.split_once('`').unwrap_or((rest, ""));
        let allowed = quoted(expected);
        let help = suggest::closest(name, allowed.iter().copied()).map(did_you_mean);
        let message = format!("{path} = {name:?} is not allowed: must be one of {}", allowed.join(", "));
        return (InputError::new(message).of_key(path).at(place).with_help(help), Repair::Remove(path.into()));
    }
    if let Some((_, rest)) = message.split_once("missing field `") {
        let name = rest.split('`').next().unwrap_or(rest);
        let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        let help = Some("`pneuflex new two-chamber` writes a complete case file to compare with; the guide has all keys of model files".to_owned());
        let error = InputError::new(format!("key `{path}` is missing")).of_key(&path).at(place).with_help(help);
        return (error, Repair::StandIn(path));
    }
    if let Some((_, rest)) = message.split_once("misplaced field `") {
        let (name, why) = rest.split_once("`: ").unwrap_or((rest, ""));
        let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        let place = Some(place_of(&path, sources, keys));
        let error = InputError::new(format!("key `{path}` is out of place: {why}")).of_key(&path).at(place);
        return (error, Repair::Remove(path));
    }
    let text = plain_types(&message);
    let error = match path {
        "" => InputError::new(text),
        path => InputError::new(format!("{path}: {text}")).of_key(path),
    };
    (error.at(place), Repair::Remove(path.into()))
}

/// The words between backquotes.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

fn one_line(message: &str) -> String {
    message.lines().collect::<Vec<_>>().join("; ")
}

/// Says what a type is to somebody who writes TOML.
fn plain_types(message: &str) -> String {
    let words = [
        ("invalid type: ", "wrong type: "),
        ("floating point ", "number "),
        ("expected f64", "expected a number"),
        ("expected usize", "expected a whole number, 0 or more"),
        ("expected a sequence", "expected a list"),
        ("a boolean", "true or false"),
        (", expected nothing", ""),
        ("map", "a table"),
        ("sequence", "a list"),
    ];
    let text = words.iter().fold(message.to_owned(), |text, (from, to)| text.replace(from, to));
    // Names of structs mean nothing outside this program.
    match text.split_once("expected struct ") {
        Some((before, _)) => format!("{before}expected a table"),
        None => text,
    }
}

#[cfg(test)]
mod fuzz;
