//! Names of designs: a digest of everything that a design's results are a function of.

use std::path::Path;

use pneuflex::{Error, Study};
use sha2::{Digest, Sha256};

use crate::base::Design;

/// Version of the program, by which results may differ.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Hexadecimal digits of an identity.
const DIGITS: usize = 24;

/// What kind of file a study is: `case`, `model` or `deck`.
pub fn kind(study: &Study) -> &'static str {
    match (study.case(), study.model()) {
        (Some(_), _) => "case",
        (None, Some(_)) => "model",
        (None, None) => "deck",
    }
}

/// Every key with its value as JSON; of a deck, nothing.
///
/// # Errors
/// A value that JSON does not have.
pub fn values(study: &Study) -> Result<String, serde_json::Error> {
    match (study.case(), study.model()) {
        (Some(case), _) => serde_json::to_string(&case.resolved()),
        (None, Some(model)) => serde_json::to_string(model),
        (None, None) => Ok("{}".to_owned()),
    }
}

/// A digest of what is read beside the values of keys: the mesh or the deck, and what that includes. Where it was read from makes no
/// difference. Files that cannot be read are what is said of them.
pub fn content(study: &Study) -> String {
    let files = match (study.case(), study.files()) {
        (Some(_), _) => return String::new(),
        (None, Ok(files)) => files,
        (None, Err(error)) => return digest(["unreadable", &error.to_string()]),
    };
    let folder = study.path().parent().unwrap_or(Path::new(""));
    let mut state = Sha256::new();
    for (path, bytes) in &files {
        // What a model file says are its values.
        if path == study.path() && study.model().is_some() {
            continue;
        }
        let name = path.strip_prefix(folder).unwrap_or(path).to_string_lossy();
        add(&mut state, name.as_bytes());
        add(&mut state, bytes);
    }
    in_digits(state)
}

/// The name of a design: of its values, the content that it reads, and whether its fields are kept.
///
/// # Errors
/// Values that JSON does not have.
pub fn of_study(study: &Study, content: &str, fields: bool) -> Result<String, Error> {
    let values = values(study).map_err(|error| pneuflex::ResultsError::not_representable("sweep.json", error))?;
    Ok(digest([VERSION, kind(study), &values, content, if fields { "with fields" } else { "" }]))
}

/// The name of a design whose values make no body, in a sweep of that origin.
pub fn of_bad_input(origin: &str, design: &Design, fields: bool) -> String {
    let mut pairs: Vec<String> = design.iter().map(|(key, value)| format!("{}={}", key.trim(), plain(value))).collect();
    pairs.sort();
    let fields = if fields { "with fields" } else { "" };
    digest(["bad input", origin, fields].into_iter().chain(pairs.iter().map(String::as_str)))
}

/// A value in the form that all of its spellings share.
fn plain(value: &str) -> String {
    let read = toml::from_str::<toml::Table>(&format!("value = {value}"));
    read.map_or_else(|_| value.trim().to_owned(), |table| table["value"].to_string())
}

/// A digest of texts.
pub fn digest<'a>(parts: impl IntoIterator<Item = &'a str>) -> String {
    let mut state = Sha256::new();
    for part in parts {
        add(&mut state, part.as_bytes());
    }
    in_digits(state)
}

/// Adds a part; its length goes first, so that no two lists of parts are one.
fn add(state: &mut Sha256, part: &[u8]) {
    state.update((part.len() as u64).to_le_bytes());
    state.update(part);
}

fn in_digits(state: Sha256) -> String {
    let mut digits: String = state.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    digits.truncate(DIGITS);
    digits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_design_is_what_it_is_a_function_of() {
        let study = |changes: &[(&str, &str)]| {
            let mut study = Study::from_text("case.toml", &pneuflex::template::two_chambers()).unwrap();
            study.set_all(changes.iter().map(|(key, value)| pneuflex::Change::new(*key, *value))).unwrap();
            study
        };
        let name = |changes: &[(&str, &str)], fields| of_study(&study(changes), "", fields).unwrap();
        let one = name(&[("actuator.gap", "1"), ("actuator.width", "19")], false);
        assert_eq!(one, name(&[("actuator.width", "19.0"), ("actuator.gap", "1.0")], false));
        assert_ne!(one, name(&[("actuator.width", "19"), ("actuator.gap", "1")], true));
        assert_ne!(one, name(&[("actuator.width", "19"), ("actuator.gap", "1.1")], false));
        let bad = |value: &str| of_bad_input("x", &vec![("material".into(), value.into())], false);
        assert_eq!(bad("{law=\"yeoh\",  c10 = 1}"), bad("{ law = 'yeoh', c10 = 1 }"));
        assert_ne!(bad("1"), bad("2"));
    }
}
