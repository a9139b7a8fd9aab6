//! The numbers of a case or model file that results can be differentiated by.

use toml::Value;

use crate::document::place::Step;

/// A number of a case or model file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variable {
    /// Its key, e.g. `actuator.gap`, `actuator.gap[3]`, `material.c10` or `obstacle[0].centre.z`.
    pub key: String,
    /// Its value.
    pub value: f64,
    /// Its unit; empty for none.
    pub unit: &'static str,
    /// How far it is changed for a difference.
    pub kind: Kind,
    /// Where it stands in the document; several places of numbers that are changed together.
    pub places: Vec<Vec<Step>>,
}

impl Variable {
    /// This one and another, which has the same value, as one that changes both.
    ///
    /// # Errors
    /// Why the two cannot be one, in words.
    pub fn linked_to(mut self, other: Self) -> Result<Self, String> {
        if self.unit != other.unit || [self.kind, other.kind].contains(&Kind::Path) {
            return Err(format!("{} and {} are not of one kind", self.key, other.key));
        }
        if (self.value - other.value).abs() > SAME * self.value.abs() {
            return Err(format!("{} is {} and {} is {}", self.key, self.value, other.key, other.value));
        }
        if other.kind != self.kind {
            self.kind = Kind::Share;
        }
        self.key = format!("{}{LINK}{}", self.key, other.key);
        self.places.extend(other.places);
        Ok(self)
    }
}

/// How far a number is changed for a difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// By a share of the smallest length of the body.
    Length,
    /// By a share of itself: results may depend on it in any way.
    Share,
    /// By a larger share of itself, as the equations are linear in it.
    Linear,
    /// The position on the load path.
    Path,
}

/// What is between the keys of numbers that are changed together.
pub(super) const LINK: char = '+';

/// Numbers are one up to this share.
const SAME: f64 = 1e-12;

/// A table of numbers that are all of one kind, and their unit.
const TABLES: [(&str, &[&str], Kind, &str); 17] = [
    (
        "actuator",
        &[
            "chamber_length",
            "cavity_length",
            "gap",
            "flange",
            "width",
            "height",
            "base",
            "cavity_floor",
            "side_wall",
            "top_wall",
            "half_width",
            "bottom",
            "top",
        ],
        Kind::Length,
        "mm",
    ),
    (
        "material",
        &["c10", "c01", "c20", "c11", "c02", "c30", "mu", "shear_modulus", "bulk_modulus"],
        Kind::Linear,
        "MPa",
    ),
    ("material", &["alpha", "jm"], Kind::Share, ""),
    ("material", &["density"], Kind::Linear, "g/cm3"),
    ("contact", &["stiffness"], Kind::Linear, "N/mm3"),
    ("obstacle", &["point", "centre", "radius", "size", "edge_radius", "displacement"], Kind::Length, "mm"),
    ("obstacle", &["normal", "axis"], Kind::Share, ""),
    ("obstacle", &["stiffness"], Kind::Linear, "N/mm3"),
    ("support", &["displacement"], Kind::Length, "mm"),
    ("load", &["chamber_factor"], Kind::Linear, ""),
    ("cavity", &["pressure_kpa", "atmosphere_kpa"], Kind::Linear, "kPa"),
    ("cavity", &["volume_mm3"], Kind::Linear, "mm3"),
    ("cavity", &["gas", "exponent"], Kind::Share, ""),
    ("force", &["total"], Kind::Linear, "N"),
    ("traction", &["traction_mpa"], Kind::Linear, "MPa"),
    ("pressure", &["pressure_kpa"], Kind::Linear, "kPa"),
    ("gravity", &["acceleration"], Kind::Linear, "mm/s2"),
];

/// Names of lists whose entries are along x, y and z.
const VECTORS: [&str; 9] =
    ["point", "centre", "size", "displacement", "normal", "axis", "total", "traction_mpa", "acceleration"];

/// Adds the numbers of a document that are variables.
pub(super) fn collect(value: &Value, place: &mut Vec<Step>, found: &mut Vec<Variable>) {
    match value {
        Value::Float(value) => found.extend(variable(place, *value)),
        Value::Table(table) => {
            for (key, value) in table {
                place.push(Step::Key(key.clone()));
                collect(value, place, found);
                place.pop();
            }
        }
        Value::Array(list) => {
            for (item, value) in list.iter().enumerate() {
                place.push(Step::Item(item));
                collect(value, place, found);
                place.pop();
            }
        }
        _ => {}
    }
}

/// The number at a place, if it is a variable.
fn variable(place: &[Step], value: f64) -> Option<Variable> {
    let is_key = |step: &&Step| matches!(step, Step::Key(_));
    let names: Vec<&str> =
        place.iter().filter_map(|step| if let Step::Key(key) = step { Some(&**key) } else { None }).collect();
    let name = place.iter().rposition(|step| is_key(&step))?;
    // Of a region it is the material that counts; points of a curve have two numbers each, of which one is a time.
    let table = *names.iter().rev().nth(1).filter(|table| **table != "channel").or(names.first())?;
    let items = place.len() - 1 - name;
    let last = *names.last()?;
    let (_, _, kind, unit) = TABLES.iter().find(|(of, names, ..)| *of == table && names.contains(&last))?;
    // A material without a density has no weight, and nothing depends on it.
    if last == "density" && value == 0.0 {
        return None;
    }
    if items > 1 || (items == 1 && ["pressure_kpa", "volume_mm3", "gas"].contains(&last)) {
        return None;
    }
    let mut key = String::new();
    for (i, step) in place.iter().enumerate() {
        match step {
            Step::Key(name) if key.is_empty() => key.push_str(name),
            Step::Key(name) => key += &format!(".{name}"),
            Step::Item(item) if i < name => key += &format!("[{item}]"),
            Step::Item(item) if VECTORS.contains(&last) => key += &format!(".{}", ["x", "y", "z"].get(*item)?),
            Step::Item(item) => key += &format!("[{}]", item + 1),
        }
    }
    Some(Variable { key, value, unit, kind: *kind, places: vec![place.to_vec()] })
}
