//! The texts that a document is made of, its file and changes to it, and where its keys stand in them.

use std::ops::Range;
use std::sync::Arc;

use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Value};

use super::place::{self, Step};
use crate::input_error::{InputError, Origin, Place};

/// The texts a document is made of, as if they stood one after the other.
#[derive(Clone, Debug)]
pub struct Sources {
    pub texts: Vec<Text>,
}

/// One of them.
#[derive(Clone, Debug)]
pub struct Text {
    /// What it is called in messages.
    pub name: String,
    pub origin: Origin,
    /// Where it begins in the document.
    pub start: usize,
    pub text: Arc<str>,
    /// The key that a change sets; empty for the file.
    pub key: String,
}

/// Where a key and its value stand.
#[derive(Clone, Debug)]
pub struct Key {
    pub path: String,
    pub key: Range<usize>,
    pub value: Range<usize>,
}

impl Sources {
    /// Adds a change of a key to a value; its name is how somebody has written it.
    pub fn push_change(&mut self, key: &str, value: &str, name: String) -> Result<(), InputError> {
        let plain = format!("{key}={value}");
        // A value that is no TOML is a bare string, as in `mesh.element=hex8-q1p0`.
        let quoted = format!("{key}={}", Value::from(value.trim()));
        let is_toml = |text: &String| DeTable::parse(&blanked(text, key)).is_ok();
        let text = [plain, quoted].into_iter().find(is_toml);
        let start = self.texts.last().map_or(0, |t| t.start + t.text.len() + 1);
        let Some(text) = text.filter(|_| !key.trim().is_empty() && !value.trim().is_empty()) else {
            let place = Place::new(&name, Origin::Change, Arc::from(name.clone()), 0..key.len());
            return Err(InputError::new(format!("`{}` is not a key", key.trim())).of_key(key).at(Some(place)));
        };
        self.texts.push(Text { name, origin: Origin::Change, start, text: text.into(), key: key.to_owned() });
        Ok(())
    }

    /// Where a span of the document is.
    pub fn place(&self, span: Range<usize>) -> Place {
        let index = self.texts.iter().rposition(|t| t.start <= span.start).unwrap_or(0);
        let Text { name, origin, start, text, .. } = &self.texts[index];
        Place::new(name, *origin, text.clone(), span.start - start..span.end.max(span.start) - start)
    }
}

/// A text that begins with a key, with blanks in the place of numbers of entries, which are no TOML.
fn blanked(text: &str, key: &str) -> String {
    let mut blanked = text.to_owned();
    place::brackets(key).into_iter().for_each(|range| blanked.replace_range(range.clone(), &" ".repeat(range.len())));
    blanked
}

/// A document as values without places; `None` where it holds what no value can be.
pub fn value_of(document: &Spanned<DeTable<'_>>) -> Option<Value> {
    Value::deserialize(toml::Deserializer::from(document.clone())).ok()
}

impl Text {
    /// What of it is TOML.
    pub fn parsed(&self) -> String {
        blanked(&self.text, &self.key)
    }

    /// Whether a change sets an entry of a list, or something in one.
    pub fn is_in_list(&self, document: Option<&Value>) -> bool {
        let goes_through_list = |document| {
            let place = place::resolve(document, &self.key);
            place.is_err() || place.is_ok_and(|place| place.iter().any(|step| matches!(step, Step::Item(_))))
        };
        !place::brackets(&self.key).is_empty() || document.is_some_and(goes_through_list)
    }

    /// Sets the entry that it is about to the value in `change`.
    pub fn set_entry<'a>(&self, document: &mut Spanned<DeTable<'a>>, change: DeTable<'a>) -> Result<(), InputError> {
        // What cannot be read is complained about by the reader.
        let (Some(given), Some(value)) = (value_of(document), innermost(change, place::names(&self.key))) else {
            return Ok(());
        };
        let found = place::resolve(&given, &self.key).map_err(|why| {
            let key = self.key.trim();
            let place = Place::new(&self.name, self.origin, self.text.clone(), 0..self.key.len());
            InputError::new(format!("{key} cannot be set: {why}")).of_key(key).at(Some(place))
        })?;
        let list = found.split_last().map_or(&found[..], |(_, list)| list);
        place::set(document.get_mut(), &found, place::entries(&given, list), value);
        Ok(())
    }
}

/// The value behind so many names.
fn innermost<'a>(table: DeTable<'a>, names: usize) -> Option<Spanned<DeValue<'a>>> {
    let (_, value) = table.into_iter().next()?;
    if names <= 1 {
        return Some(value);
    }
    if let DeValue::Table(inner) = value.into_inner() { innermost(inner, names - 1) } else { None }
}

/// Where a key stands; if it is not written out, where the nearest table around it does. Of a list it is the entry that was changed.
pub fn place_of(key: &str, sources: &Sources, keys: &[Key]) -> Place {
    let mut wanted = key;
    let is_changed = |k: &&Key| sources.texts.get(1).is_some_and(|change| k.value.start >= change.start);
    loop {
        let is_entry = |k: &&Key| k.path.strip_prefix(wanted).is_some_and(|rest| rest.starts_with('['));
        let whole = keys.iter().find(|k| k.path == wanted);
        let entry = keys.iter().filter(is_entry).find(is_changed);
        if let Some(found) = entry.filter(|_| whole.is_some_and(|whole| !is_changed(&whole))).or(whole) {
            return sources.place(found.key.start..found.value.end.max(found.key.end));
        }
        match wanted.rfind(['.', '[']) {
            Some(end) => wanted = &wanted[..end],
            None => return sources.place(0..0),
        }
    }
}

/// Adds every key below a table, with its path.
pub fn collect(table: &DeTable<'_>, prefix: &str, keys: &mut Vec<Key>) {
    for (key, value) in table {
        let path = if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
        collect_value(value, &path, keys);
        keys.push(Key { path, key: key.span(), value: value.span() });
    }
}

fn collect_value(value: &Spanned<DeValue<'_>>, path: &str, keys: &mut Vec<Key>) {
    match value.get_ref() {
        DeValue::Table(table) => collect(table, path, keys),
        DeValue::Array(entries) => {
            let is_nested =
                |entry: &Spanned<DeValue<'_>>| matches!(entry.get_ref(), DeValue::Table(_) | DeValue::Array(_));
            let first = place::first_number(entries, is_nested);
            for (i, entry) in entries.iter().enumerate() {
                let path = format!("{path}[{}]", first + i);
                collect_value(entry, &path, keys);
                keys.push(Key { path, key: entry.span(), value: entry.span() });
            }
        }
        _ => {}
    }
}
