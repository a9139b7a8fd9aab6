//! How a file says which nodes, faces or elements it means: by the name of a set, or by where they are.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::range_check::{Problems, Quantity};

/// Names of the axes with their directions.
const AXES: [(&str, [f64; 3]); 6] = [
    ("x", [1.0, 0.0, 0.0]),
    ("-x", [-1.0, 0.0, 0.0]),
    ("y", [0.0, 1.0, 0.0]),
    ("-y", [0.0, -1.0, 0.0]),
    ("z", [0.0, 0.0, 1.0]),
    ("-z", [0.0, 0.0, -1.0]),
];

/// Some nodes, faces or elements of a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Choice {
    /// A set of the body.
    Named(String),
    /// Those for which all conditions hold.
    Where(Box<Conditions>),
}

/// Conditions, all of which hold for what is chosen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Conditions {
    /// Between two corners, mm.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub within: Option<[[f64; 3]; 2]>,
    /// In a plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<Plane>,
    /// In a ball.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sphere: Option<Ball>,
    /// By how much nodes may lie outside of the box or the ball, or beside the plane, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Faces that look in a direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<Direction>,
    /// The face nearest to a point, mm, and all that continue it without an edge.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near: Option<[f64; 3]>,
    /// Largest angle to the direction of `normal`, and between neighbours of `near`, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<f64>,
    /// What all of these hold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub and: Option<Vec<Choice>>,
    /// What one of these holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub or: Option<Vec<Choice>>,
    /// What this does not hold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not: Option<Choice>,
}

/// A plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// A point of it, mm.
    pub point: [f64; 3],
    /// Its normal.
    pub normal: Direction,
}

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Its centre, mm.
    pub centre: [f64; 3],
    /// mm.
    pub radius: f64,
}

/// A direction: `"x"`, `"-x"` and so on, or three numbers of any length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(pub [f64; 3]);

impl Direction {
    fn name(&self) -> Option<&'static str> {
        AXES.iter().find(|(_, axis)| *axis == self.0).map(|(name, _)| *name)
    }
}

impl Choice {
    /// The name, if it is one.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Named(name) => Some(name),
            Self::Where(_) => None,
        }
    }

    /// The box, if there is no other condition.
    pub fn only_box(&self) -> Option<[[f64; 3]; 2]> {
        let Self::Where(conditions) = self else { return None };
        let corners = conditions.within?;
        (**conditions == Conditions { within: Some(corners), ..Conditions::default() }).then_some(corners)
    }

    /// The same of a body whose points, directions and lengths are changed.
    #[must_use]
    pub fn moved(
        &self,
        point: &dyn Fn([f64; 3]) -> [f64; 3],
        direction: &dyn Fn([f64; 3]) -> [f64; 3],
        length: f64,
    ) -> Self {
        let Self::Where(conditions) = self else { return self.clone() };
        let all = |choices: &Vec<Self>| choices.iter().map(|choice| choice.moved(point, direction, length)).collect();
        let turned = |Direction(v)| Direction(direction(v));
        Self::Where(Box::new(Conditions {
            within: conditions.within.map(|corners| corners.map(point)),
            plane: conditions.plane.map(|plane| Plane { point: point(plane.point), normal: turned(plane.normal) }),
            sphere: conditions.sphere.map(|ball| Ball { centre: point(ball.centre), radius: length * ball.radius }),
            tolerance: conditions.tolerance.map(|tolerance| length * tolerance),
            normal: conditions.normal.map(turned),
            near: conditions.near.map(point),
            angle: conditions.angle,
            and: conditions.and.as_ref().map(all),
            or: conditions.or.as_ref().map(all),
            not: conditions.not.as_ref().map(|choice| choice.moved(point, direction, length)),
        }))
    }

    /// Finds what is missing or out of range.
    pub(crate) fn check(&self, key: &str, found: &mut Problems) {
        let Self::Where(conditions) = self else { return };
        conditions.check(key, found);
    }
}

impl Conditions {
    /// Choices in it.
    pub(crate) fn choices(&self) -> impl Iterator<Item = &Choice> {
        self.and.iter().flatten().chain(self.or.iter().flatten()).chain(&self.not)
    }

    fn check(&self, key: &str, found: &mut Problems) {
        let Self { within, plane, sphere, tolerance, normal, near, angle, and, or, not } = self;
        if *self == (Self { tolerance: *tolerance, angle: *angle, ..Self::default() }) {
            let allowed = "must have one of box, plane, sphere, normal, near, and, or, not";
            return found.add(key, &Shown(self), allowed);
        }
        let three = "three finite numbers";
        let corners = within.unwrap_or_default();
        found.unless_finite(&format!("{key}.box"), corners.as_flattened(), "finite numbers", Quantity::Length);
        let centre = sphere.map(|ball| ball.centre);
        for (name, at) in [("plane.point", plane.map(|plane| plane.point)), ("sphere.centre", centre), ("near", *near)]
        {
            found.unless_finite(&format!("{key}.{name}"), &at.unwrap_or_default(), three, Quantity::Length);
        }
        for (name, direction) in [("plane.normal", plane.map(|plane| plane.normal)), ("normal", *normal)] {
            let has_length = |Direction(v): &Direction| v.iter().map(|x| x * x).sum::<f64>().is_normal();
            if let Some(Direction(v)) = direction.filter(|direction| !has_length(direction)) {
                found.add(&format!("{key}.{name}"), &v, "must be three finite numbers that are not all 0");
            }
        }
        if let Some(ball) = sphere {
            found.unless_positive(&format!("{key}.sphere.radius"), ball.radius, Quantity::Length);
        }
        if let Some(tolerance) = tolerance {
            found.unless_positive(&format!("{key}.tolerance"), *tolerance, Quantity::Tolerance);
            if within.is_none() && plane.is_none() && sphere.is_none() {
                found.add(&format!("{key}.tolerance"), tolerance, "must stand beside box, plane or sphere");
            }
        }
        if let Some(angle) = angle {
            if !(*angle > 0.0 && *angle < 180.0) {
                found.add(&format!("{key}.angle"), angle, "must be greater than 0 and less than 180 degrees");
            }
            if normal.is_none() && near.is_none() {
                found.add(&format!("{key}.angle"), angle, "must stand beside normal or near");
            }
        }
        for (name, choices) in [("and", and), ("or", or)] {
            for (number, choice) in choices.iter().flatten().enumerate() {
                choice.check(&format!("{key}.{name}[{number}]"), found);
            }
            if choices.as_ref().is_some_and(Vec::is_empty) {
                found.add(&format!("{key}.{name}"), choices, "must not be empty");
            }
        }
        if let Some(choice) = not {
            choice.check(&format!("{key}.not"), found);
        }
    }
}

/// Conditions as a file has them, for a message.
struct Shown<'a>(&'a Conditions);

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self.0, f)
    }
}

impl From<&str> for Choice {
    fn from(name: &str) -> Self {
        Self::Named(name.to_owned())
    }
}

impl From<String> for Choice {
    fn from(name: String) -> Self {
        Self::Named(name)
    }
}

impl From<Conditions> for Choice {
    fn from(conditions: Conditions) -> Self {
        Self::Where(Box::new(conditions))
    }
}

/// As a file has it, a name without quotes.
impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Named(name) => f.write_str(name),
            Self::Where(conditions) => conditions.fmt(f),
        }
    }
}

impl fmt::Display for Conditions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let point = |[x, y, z]: [f64; 3]| format!("[{x}, {y}, {z}]");
        let several = |choices: &Vec<Choice>| {
            let quoted: Vec<String> = choices.iter().map(quoted).collect();
            format!("[{}]", quoted.join(", "))
        };
        let ball = |ball: Ball| format!("{{ centre = {}, radius = {} }}", point(ball.centre), ball.radius);
        let plane = |plane: Plane| format!("{{ point = {}, normal = {} }}", point(plane.point), plane.normal);
        let said = [
            ("box", self.within.map(|[low, high]| format!("[{}, {}]", point(low), point(high)))),
            ("plane", self.plane.map(plane)),
            ("sphere", self.sphere.map(ball)),
            ("tolerance", self.tolerance.map(|tolerance| tolerance.to_string())),
            ("normal", self.normal.map(|normal| normal.to_string())),
            ("near", self.near.map(point)),
            ("angle", self.angle.map(|angle| angle.to_string())),
            ("and", self.and.as_ref().map(several)),
            ("or", self.or.as_ref().map(several)),
            ("not", self.not.as_ref().map(quoted)),
        ];
        let said: Vec<String> =
            said.into_iter().filter_map(|(key, value)| Some(format!("{key} = {}", value?))).collect();
        if said.is_empty() { f.write_str("{}") } else { write!(f, "{{ {} }}", said.join(", ")) }
    }
}

fn quoted(choice: &Choice) -> String {
    match choice {
        Choice::Named(name) => format!("{name:?}"),
        Choice::Where(_) => choice.to_string(),
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.name(), self.0) {
            (Some(name), _) => write!(f, "{name:?}"),
            (None, [x, y, z]) => write!(f, "[{x}, {y}, {z}]"),
        }
    }
}

impl Serialize for Direction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.name() {
            Some(name) => serializer.serialize_str(name),
            None => self.0.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;

        impl<'de> Visitor<'de> for Read {
            type Value = Direction;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"x\", \"-x\", \"y\", \"-y\", \"z\", \"-z\" or three numbers")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<Direction, E> {
                let known = AXES.iter().find(|(axis, _)| *axis == name);
                known.map(|(_, v)| Direction(*v)).ok_or_else(|| E::invalid_value(de::Unexpected::Str(name), &self))
            }

            fn visit_seq<A: de::SeqAccess<'de>>(self, sequence: A) -> Result<Direction, A::Error> {
                Deserialize::deserialize(SeqAccessDeserializer::new(sequence)).map(Direction)
            }
        }

        deserializer.deserialize_any(Read)
    }
}

/// Written out because the derived reader of an untagged enum cannot say what it expects.
impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;

        impl<'de> Visitor<'de> for Read {
            type Value = Choice;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a set, or a table with box, plane, sphere, normal, near, and, or, not")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<Choice, E> {
                Ok(name.into())
            }

            fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<Choice, A::Error> {
                Conditions::deserialize(MapAccessDeserializer::new(map)).map(Choice::from)
            }
        }

        deserializer.deserialize_any(Read)
    }
}
