//! All designs of a sweep, with their names.

use std::collections::BTreeMap;

use pneuflex::{Error, InputError, InputErrorKind, MemoryLimit, Pairs, Study};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::base::{Base, Design};
use crate::identity;

/// What `sweep.json` says.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Which program has written it.
    pub program: String,
    /// Of which version, by which results may differ.
    pub version: String,
    /// A digest of what all designs have in common.
    pub origin: String,
    /// The values of its keys, as far as it can be read by itself.
    pub values: Value,
    /// The designs.
    pub designs: Vec<Entry>,
}

/// A design of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Its name.
    pub identity: String,
    /// Its values by keys.
    pub inputs: Pairs,
}

/// A plan with what solving it needs.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The plan.
    pub plan: Plan,
    /// The largest estimate of memory of a design, bytes; `None` where no design can be built.
    pub memory: Option<f64>,
}

/// Designs that all are bad input, or a key that no design can have: the number of a design and what is wrong with it.
pub type Slip = (usize, Vec<InputError>);

impl Plan {
    /// Gives every design its name, and looks how much memory they need.
    ///
    /// # Errors
    /// A key that is unknown in a design, or the first design if all of them are bad input: its number and what is wrong. Other errors as they
    /// are, without a number.
    pub fn of(base: &Base, designs: &[Design], fields: bool) -> Result<Planned, (Option<usize>, Error)> {
        let mut contents = Contents::default();
        let (values, origin) = origin(base, &mut contents).map_err(|error| (None, error))?;
        let (mut entries, mut memory, mut first, mut has_good) = (Vec::new(), None, None, false);
        let mut largest = |bytes: f64| memory = Some(memory.map_or(bytes, |other: f64| other.max(bytes)));
        for (number, design) in designs.iter().enumerate() {
            let identity = match base.study(design) {
                Ok(study) => {
                    has_good = true;
                    let (content, is_new) = contents.of(&study);
                    match study.estimate() {
                        Some(estimate) => largest(estimate.bytes),
                        // Meshes hardly change with the design, but for those that are other files.
                        None if is_new => {
                            if let Ok(analysis) = study.build_within(MemoryLimit::None) {
                                largest(analysis.estimate().bytes);
                            }
                        }
                        None => {}
                    }
                    identity::of_study(&study, &content, fields).map_err(|error| (None, error))?
                }
                Err(error) => {
                    // A key that is unknown is so in all designs.
                    if is_slip(&error) {
                        return Err((Some(number), error));
                    }
                    first.get_or_insert((Some(number), error));
                    identity::of_bad_input(&origin, design, fields)
                }
            };
            entries.push(Entry { identity, inputs: inputs(design) });
        }
        if let (Some(first), false) = (first, has_good) {
            return Err(first);
        }
        let (program, version) = ("pneuflex".to_owned(), identity::VERSION.to_owned());
        Ok(Planned { plan: Self { program, version, origin, values, designs: entries }, memory })
    }
}

/// Whether a name is misspelt.
fn is_slip(error: &Error) -> bool {
    matches!(error, Error::Input(errors) if errors.iter().any(|error| error.kind() == InputErrorKind::Unknown))
}

/// What all designs have in common: values of keys, and a digest.
fn origin(base: &Base, contents: &mut Contents) -> Result<(Value, String), Error> {
    match base.study(&Design::new()) {
        Ok(study) => {
            let content = contents.of(&study).0;
            let values = identity::values(&study).and_then(|text| serde_json::from_str(&text));
            let values = values.map_err(|error| pneuflex::ResultsError::not_representable("sweep.json", error))?;
            Ok((values, identity::of_study(&study, &content, false)?))
        }
        // A template that is no body by itself is its text.
        Err(error) => {
            let text = std::fs::read_to_string(&base.path).map_err(|_| error)?;
            let changes = base.changes.iter().flat_map(|(key, value)| [key.as_str(), value]);
            let origin = identity::digest(["template", &text].into_iter().chain(changes));
            Ok((Value::Object(serde_json::Map::new()), origin))
        }
    }
}

/// Digests of what is read, by the file that is read.
#[derive(Default)]
struct Contents(BTreeMap<String, String>);

impl Contents {
    /// The digest of what a study reads, and whether nothing else has read that.
    fn of(&mut self, study: &Study) -> (String, bool) {
        let Some(source) = study.model().map(|model| serde_json::to_string(&model.model)) else {
            return (identity::content(study), true);
        };
        let source = source.unwrap_or_default();
        if let Some(known) = self.0.get(&source) {
            return (known.clone(), false);
        }
        let content = identity::content(study);
        self.0.insert(source, content.clone());
        (content, true)
    }
}

/// Values of a design as JSON has them.
fn inputs(design: &Design) -> Pairs {
    let value = |text: &str| {
        let table = toml::from_str::<toml::Table>(&format!("value = {text}"));
        table.map_or_else(|_| Value::from(text), |table| json(&table["value"]))
    };
    Pairs(design.iter().map(|(key, text)| (key.clone(), value(text))).collect())
}

fn json(value: &toml::Value) -> Value {
    match value {
        toml::Value::String(text) => text.as_str().into(),
        toml::Value::Integer(number) => (*number).into(),
        // What is not finite has no other form.
        toml::Value::Float(number) => {
            serde_json::Number::from_f64(*number).map_or_else(|| number.to_string().into(), Value::Number)
        }
        toml::Value::Boolean(truth) => (*truth).into(),
        toml::Value::Datetime(time) => time.to_string().into(),
        toml::Value::Array(entries) => entries.iter().map(json).collect(),
        toml::Value::Table(table) => table.iter().map(|(name, value)| (name.clone(), json(value))).collect(),
    }
}
