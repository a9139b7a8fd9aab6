//! What all designs are made from: a file with changes. It is only a template, which need not be complete or within its ranges by itself.

use std::path::PathBuf;

use pneuflex::calibration::library::{ENTRIES, find};
use pneuflex::input_error::{InputError, InputErrorKind, Origin, Place};
use pneuflex::{Change, Error, Study};
use serde::{Deserialize, Serialize};

/// Values by keys in TOML.
pub type Design = Vec<(String, String)>;

/// A case file, a model file or a deck, with changes that all designs have in common.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Base {
    /// The file.
    pub path: PathBuf,
    /// Changes to its keys.
    pub changes: Design,
}

impl Base {
    /// A design as something to be solved. What the design sets takes the place of what the base sets, as in [`Study::set_all`].
    ///
    /// # Errors
    /// Everything that is wrong with its keys and values.
    pub fn study(&self, design: &Design) -> Result<Study, Error> {
        let new = design.iter().map(change).collect::<Result<Vec<_>, _>>()?;
        let mut changes = self.changes.iter().map(change).collect::<Result<Vec<_>, _>>()?;
        changes.retain(|earlier| !new.iter().any(|change| change.replaces(earlier)));
        changes.extend(new);
        Study::load_with(&self.path, changes)
    }
}

/// A value of a key as a change; a material may be the name of a known one.
fn change((key, value): &(String, String)) -> Result<Change, InputError> {
    let change = Change::new(key, value);
    let name = match value.parse::<toml::Value>() {
        Ok(toml::Value::String(name)) if key.trim() == "material" => name,
        _ => return Ok(change),
    };
    let Some(entry) = find(&name).map(|index| &ENTRIES[index]) else {
        let text = change.to_string();
        let place = Place::new(&text, Origin::Change, text.as_str().into(), 0..key.len());
        let error = InputError::new(format!("no material \"{name}\" is known")).of_key("material").at(Some(place));
        let error = error.of_kind(InputErrorKind::Unknown);
        return Err(error.with_help(Some("`pneuflex materials` lists all".into())));
    };
    let material = toml::Value::try_from(entry.material());
    Ok(Change::new(key, material.map_err(|error| InputError::new(error.to_string()))?.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_have_names() {
        let named = |name: &str| change(&("material".to_owned(), format!("\"{name}\"")));
        let found = named("dragon-skin-30").unwrap();
        assert!(found.value.contains("law = \"yeoh\"") && found.value.contains("fitted_to"), "{found}");
        assert!(named("dragon-skin-31").unwrap_err().to_string().contains("no material \"dragon-skin-31\""));
        let other = ("title".to_owned(), "\"dragon-skin-30\"".to_owned());
        assert_eq!(change(&other).unwrap().value, other.1);
    }
}
