//! What a file of a design says.

use pneuflex::document::Document;
use pneuflex::model::CaseError;
use pneuflex_sweep::node::Node;
use pneuflex_sweep::space::MOST_SOBOL_KEYS;
use serde::Deserialize;

use crate::identify::wrong_solutions;
use crate::starts::MOST_STARTS;
use crate::variables::{find, variables};

/// What a file of a design says.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DesignFile {
    /// Case or model file, beside this file.
    pub(crate) case: String,
    /// Solutions at the most, from each start.
    #[serde(default)]
    pub(crate) solutions: Option<i64>,
    /// How often the search begins, each time somewhere else.
    #[serde(default)]
    pub(crate) starts: Option<i64>,
    /// Keys that all designs have in common.
    #[serde(default)]
    pub(crate) set: Node,
    /// What may be changed.
    pub(crate) variables: Node,
    /// What is wanted.
    #[serde(default)]
    pub(crate) target: Vec<Target>,
    /// What is to be large or small.
    #[serde(default)]
    pub(crate) extreme: Vec<Extreme>,
    /// What must hold.
    #[serde(default)]
    pub(crate) limit: Vec<Limit>,
}

/// A result, or the centreline, that is wanted.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Target {
    pub(crate) result: Option<String>,
    pub(crate) value: Option<f64>,
    pub(crate) centreline: Option<Points>,
    pub(crate) points: Option<usize>,
    pub(crate) at: Option<f64>,
    pub(crate) within: f64,
    #[serde(default = "one")]
    pub(crate) weight: f64,
}

/// Points of a curve, x and z in mm from the clamp on, or the file that has them.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum Points {
    File(String),
    List(Vec<[f64; 2]>),
}

/// A result that is to be large or small.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Extreme {
    pub(crate) largest: Option<String>,
    pub(crate) least: Option<String>,
    pub(crate) at: Option<f64>,
    #[serde(default = "one")]
    pub(crate) weight: f64,
}

/// What must hold of a result, or of a sum of keys with factors.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limit {
    pub(crate) result: Option<String>,
    #[serde(default)]
    pub(crate) sum: Option<Node>,
    pub(crate) at: Option<f64>,
    pub(crate) at_least: Option<f64>,
    pub(crate) at_most: Option<f64>,
}

fn one() -> f64 {
    1.0
}

impl Document for DesignFile {
    fn problems(&self) -> Vec<CaseError> {
        let mut found = variables(&self.variables).err().unwrap_or_default();
        found.extend(wrong_solutions(self.solutions));
        if let Some(starts) = self.starts.filter(|starts| !(1..=MOST_STARTS).contains(starts)) {
            let allowed = format!("must be a whole number from 1 to {MOST_STARTS}");
            found.push(CaseError { key: "starts".into(), value: starts.to_string(), allowed });
        }
        let count = variables(&self.variables).map_or(0, |variables| variables.len());
        if self.starts.is_some_and(|starts| starts > 1) && count > MOST_SOBOL_KEYS {
            let allowed = format!("must be 1 for more than {MOST_SOBOL_KEYS} variables");
            found.push(CaseError { key: "starts".into(), value: format!("{:?}", self.starts), allowed });
        }
        let mut refuse = |key: String, value: String, allowed: &str| {
            found.push(CaseError { key, value, allowed: allowed.to_owned() });
        };
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        for (i, target) in self.target.iter().enumerate() {
            let key = |name: &str| format!("target[{i}].{name}");
            for (name, value) in [("within", target.within), ("weight", target.weight)] {
                if !is_positive(value) {
                    refuse(key(name), value.to_string(), "must be above 0");
                }
            }
            let says = [target.result.is_some(), target.value.is_some(), target.centreline.is_some()];
            if !matches!(says, [true, true, false] | [false, false, true]) {
                let allowed = "must have either result and value, or centreline";
                refuse(format!("target[{i}]"), "the target".into(), allowed);
            }
            if target.value.is_some_and(|value| !value.is_finite()) {
                refuse(key("value"), format!("{:?}", target.value), "must be a number");
            }
            if target.points.is_some_and(|points| !(1..=200).contains(&points)) || target.points.is_some() && says[0] {
                refuse(key("points"), format!("{:?}", target.points), "must be from 1 to 200, of a centreline");
            }
        }
        for (i, extreme) in self.extreme.iter().enumerate() {
            if extreme.largest.is_some() == extreme.least.is_some() {
                refuse(format!("extreme[{i}]"), "the extreme".into(), "must have either largest or least");
            }
            if !is_positive(extreme.weight) {
                refuse(format!("extreme[{i}].weight"), extreme.weight.to_string(), "must be above 0");
            }
        }
        for (i, limit) in self.limit.iter().enumerate() {
            if limit.result.is_some() == limit.sum.is_some() {
                refuse(format!("limit[{i}]"), "the limit".into(), "must have either result or sum");
            }
            let ends: Vec<f64> = limit.at_least.into_iter().chain(limit.at_most).collect();
            if ends.is_empty() || ends.iter().any(|end| !end.is_finite()) {
                refuse(format!("limit[{i}]"), "the limit".into(), "must have at_least or at_most, or both, as numbers");
            }
            let factors = limit.sum.iter().flat_map(Node::leaves);
            if limit.sum.is_some()
                && (factors.clone().count() == 0 || factors.clone().any(|(_, f)| factor(f).is_none()))
            {
                refuse(format!("limit[{i}].sum"), "the sum".into(), "must have keys with factors, which are numbers");
            }
        }
        if self.target.is_empty() && self.extreme.is_empty() {
            let allowed = "must say what is wanted, as [[target]] or [[extreme]]";
            refuse("target".into(), "nothing".into(), allowed);
        }
        let places = self.places();
        if places.iter().any(Option::is_some) && places.iter().any(Option::is_none) {
            refuse("target".into(), "at".into(), "must be said of every result or of none");
        }
        found
    }
}

pub(crate) fn factor(node: &Node) -> Option<f64> {
    let value = node.value();
    let number = value.as_float().or(value.as_integer().map(|whole| whole as f64));
    number.filter(|number| number.is_finite())
}

impl DesignFile {
    /// Where on the load path its results are wanted; not those of sums, of variables, and of the body at rest.
    pub(crate) fn places(&self) -> Vec<Option<f64>> {
        let variables = variables(&self.variables).unwrap_or_default();
        let is_result = |name: &&String| find(&variables, name).is_none() && !name.starts_with("silicone_");
        let targets = self.target.iter().map(|target| target.at);
        let named = |extreme: &Extreme| extreme.largest.clone().or(extreme.least.clone());
        let extremes =
            self.extreme.iter().filter(|extreme| named(extreme).iter().any(|name| is_result(&name))).map(|e| e.at);
        let limits = self.limit.iter().filter(|limit| limit.result.iter().any(|name| is_result(&name))).map(|l| l.at);
        targets.chain(extremes).chain(limits).collect()
    }
}
