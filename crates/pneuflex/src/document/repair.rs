//! Makeshift repairs of a case that cannot be read, so that the reader finds the next problem, too. Nothing is ever solved with them.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What lets the reader go on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Repair {
    /// A key gets the name that was probably meant.
    Rename {
        /// Path of the key.
        path: String,
        /// Its new name.
        to: String,
    },
    /// A key is left out, so that its default takes its place.
    Remove(String),
    /// A missing key gets some value.
    StandIn(String),
}

impl Repair {
    /// Path of the key it is about.
    pub fn path(&self) -> &str {
        match self {
            Self::Rename { path, .. } | Self::Remove(path) | Self::StandIn(path) => path,
        }
    }
}

/// Repairs made so far.
#[derive(Debug, Default)]
pub struct Repairs {
    touched: Vec<String>,
}

impl Repairs {
    /// Whether a problem of a key follows from a repair: the key itself, or one below it, was removed or made up.
    pub fn touch(&self, key: &str) -> bool {
        self.touched.iter().any(|path| {
            key.strip_prefix(path.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        })
    }

    /// Makes a repair; whether the reader can go on.
    pub fn apply(&mut self, repair: Repair, document: &mut DeTable<'_>) -> bool {
        let path = match &repair {
            // An entry of a list goes with the whole list.
            Repair::Remove(path) if path.ends_with(']') => path.rfind('[').map_or("", |end| &path[..end]),
            other => other.path(),
        }
        .to_owned();
        let Some((table, name)) = parent_of(document, &path) else { return false };
        let is_done = match &repair {
            Repair::Rename { to, .. } => match table.remove(name.as_str()) {
                Some(value) if !table.contains_key(to.as_str()) => {
                    table.insert(Spanned::new(0..0, to.clone().into()), value);
                    true
                }
                removed => removed.is_some(),
            },
            Repair::Remove(_) => table.remove(name.as_str()).is_some(),
            Repair::StandIn(_) => match stand_in(&path, &name) {
                Some(value) => table.insert(Spanned::new(0..0, name.into()), value).is_none(),
                None => false,
            },
        };
        if !matches!(repair, Repair::Rename { .. }) {
            self.touched.push(path);
        }
        is_done
    }
}

/// The table that holds a key, and the key's own name.
fn parent_of<'d, 'i>(document: &'d mut DeTable<'i>, path: &str) -> Option<(&'d mut DeTable<'i>, String)> {
    let (tables, name) = path.rsplit_once('.').unwrap_or(("", path));
    let mut table = document;
    for part in tables.split('.').filter(|part| !part.is_empty()) {
        let mut pieces = part.split('[');
        let mut value = table.get_mut(pieces.next()?)?.get_mut();
        for index in pieces {
            let index: usize = index.strip_suffix(']')?.parse().ok()?;
            let DeValue::Array(entries) = value else { return None };
            value = entries.get_mut(index)?.get_mut();
        }
        let DeValue::Table(inner) = value else { return None };
        table = inner;
    }
    (!name.is_empty() && !name.contains('[')).then(|| (table, name.to_owned()))
}

/// Some value for a key that must be there. Lengths are unknown, which the range checks understand.
fn stand_in(path: &str, name: &str) -> Option<Spanned<DeValue<'static>>> {
    let text = match name {
        "load" => "x = { pressure_kpa = [1.0] }",
        "pressure_kpa" if path.starts_with("pressure[") => "x = 1.0",
        "pressure_kpa" => "x = [1.0]",
        "chambers" => "x = 1",
        "channel" => "x = { half_width = nan, bottom = nan, top = nan }",
        "name" => "x = \"some\"",
        "nodes" | "axes" | "faces" | "slave" | "master" => "x = \"some\"",
        "at" | "total" | "traction_mpa" | "acceleration" => "x = [0.0, 0.0, 0.0]",
        "c10" | "c01" => "x = 1.0",
        "mu" | "alpha" => "x = [1.0]",
        _ if path.starts_with("actuator.") => "x = nan",
        _ => return None,
    };
    DeTable::parse(text).ok()?.into_inner().remove("x")
}
