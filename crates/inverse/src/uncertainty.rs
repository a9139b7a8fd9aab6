//! How uncertain results are by the tolerances of lengths and constants.
//!
//! A number with the tolerance ± t is taken to be anywhere between its ends with the same probability (a uniform distribution, as where nothing but
//! bounds is known: JCGM 100:2008, 4.3.7), independent of all others. Its standard deviation is t/√3, and to first order
//!
//! ```text
//! σ² = Σ (∂J/∂θᵢ)² tᵢ²/3
//! ```

use std::str::FromStr;

use pneuflex::gradient::Request;
use pneuflex::{Analysis, Error, InputError, MemoryLimit, StopToken};
use pneuflex_sweep::base::Base;
use pneuflex_sweep::space::{Choice, Space, latin_hypercube};
use serde::Serialize;

use crate::designs::{Designs, Setup};
use crate::variables::Variable;

/// Seed of the designs by which a linearisation is checked.
const SEED: u64 = 0;

/// A tolerance of a number: `KEY=0.1` in the unit of the key, or `KEY=10%` of its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// The key; several with `+` between them are off together.
    pub key: String,
    half_width: f64,
    is_percentage: bool,
}

impl FromStr for Tolerance {
    type Err = InputError;

    fn from_str(text: &str) -> Result<Self, InputError> {
        let refused = || {
            InputError::new(format!("{text}: expected KEY=TOLERANCE, e.g. actuator.top_wall=0.1 or material.c10=10%"))
        };
        let (key, width) = text.rsplit_once('=').ok_or_else(refused)?;
        let (number, is_percentage) = match width.trim().strip_suffix('%') {
            Some(percent) => (percent, true),
            None => (width, false),
        };
        let half_width: f64 = number.trim().parse().map_err(|_| refused())?;
        if key.trim().is_empty() || !(half_width > 0.0 && half_width.is_finite()) {
            return Err(refused());
        }
        Ok(Self { key: key.trim().to_owned(), half_width, is_percentage })
    }
}

impl Tolerance {
    /// The number as a variable between the ends of its tolerance.
    fn variable(&self, analysis: &Analysis) -> Result<Variable, Error> {
        let value = analysis.number(&self.key)?;
        let half_width = if self.is_percentage { 0.01 * self.half_width * value.abs() } else { self.half_width };
        if half_width == 0.0 {
            let what = format!("{}: it is 0, and no share of that is a tolerance", self.key);
            return Err(InputError::new(what).of_key(&self.key).into());
        }
        let bounds = [value - half_width, value + half_width];
        let keys = self.key.split('+').map(|key| key.trim().to_owned()).collect();
        Ok(Variable { name: self.key.clone(), keys, start: None, bounds })
    }
}

/// The uncertainty of results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Uncertainty {
    /// Numbers with their tolerances.
    pub tolerances: Vec<Tolerated>,
    /// Results in the order in which they were asked for.
    pub results: Vec<Spread>,
    /// Designs within the tolerances that were solved to check the results; left out if none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub designs: Option<usize>,
    /// Those of them that have no results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_results: Option<usize>,
}

/// A number with its tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tolerated {
    /// Its key.
    pub key: String,
    /// Its value.
    pub value: f64,
    /// By so much it may be off either way.
    pub tolerance: f64,
    /// Its standard deviation.
    pub standard_deviation: f64,
}

/// How far a result spreads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The result, with its pressure or time.
    pub of: String,
    /// Its value with all numbers as they are.
    pub value: f64,
    /// To first order.
    pub standard_deviation: f64,
    /// What every number contributes, the largest share first.
    pub contributions: Vec<Contribution>,
    /// Of the designs that were solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampled: Option<Sampled>,
}

/// What a number contributes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contribution {
    /// Its key.
    pub by: String,
    /// Change of the result per unit of the key.
    pub derivative: f64,
    /// The standard deviation of the result if it alone were uncertain.
    pub standard_deviation: f64,
    /// Its share of the variance, 0 to 1.
    pub share: f64,
}

/// A result over designs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sampled {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub standard_deviation: f64,
}

/// A file whose numbers have tolerances, ready to be solved.
#[derive(Debug)]
pub struct Tolerances {
    designs: Designs,
}

impl Tolerances {
    /// Checks everything that can be before anything is solved. A result without a pressure is meant at every pressure of the file.
    ///
    /// # Errors
    /// What is wrong with the file; results and keys without derivatives; a key that is there twice; a percentage of 0.
    pub fn new(
        base: Base,
        tolerances: &[Tolerance],
        requests: &[Request],
        limit: MemoryLimit,
        stop: &StopToken,
    ) -> Result<Self, Error> {
        let analysis = base.study(&Vec::new())?.build_within(limit)?;
        let mut variables: Vec<Variable> = Vec::new();
        for tolerance in tolerances {
            let variable = tolerance.variable(&analysis)?;
            if variables.iter().any(|other| other.name == variable.name) {
                let what = format!("{}: it has two tolerances", variable.name);
                return Err(InputError::new(what).of_key(&variable.name).into());
            }
            variables.push(variable);
        }
        let everywhere = |request: &Request| -> Vec<Request> {
            match request.at {
                Some(_) => vec![request.clone()],
                None => {
                    let at = analysis.requested.iter().map(|at| Some(at.0));
                    at.map(|at| Request { column: request.column.clone(), at }).collect()
                }
            }
        };
        let requests = requests.iter().flat_map(everywhere).collect();
        let designs = Designs::new(Setup { base, variables, requests, positions: Vec::new(), limit }, stop)?;
        Ok(Self { designs })
    }

    /// Solves the file, and as many designs of a Latin hypercube within the tolerances. `listener` is told how many of them are solved.
    ///
    /// # Errors
    /// [`Error::Interrupted`]; a file that has no results.
    pub fn solve(mut self, designs: usize, listener: &mut dyn FnMut(usize)) -> Result<Uncertainty, Error> {
        let present = self.designs.start.clone();
        let found = self.designs.solve(&present)?;
        if let Some(why) = found.outside {
            return Err(InputError::new(format!("the file as it is has no results: {why}")).into());
        }
        let half_widths: Vec<f64> =
            self.designs.variables().iter().map(|variable| 0.5 * (variable.bounds[1] - variable.bounds[0])).collect();
        let deviations: Vec<f64> = half_widths.iter().map(|half_width| half_width / 3.0_f64.sqrt()).collect();
        let mut samples: Vec<Vec<f64>> = Vec::new();
        for (number, values) in self.sample(designs).into_iter().enumerate() {
            let tried = self.designs.solve(&values)?;
            samples.extend(tried.outside.is_none().then_some(tried.results));
            listener(number + 1);
        }
        let variables = self.designs.variables();
        let spread = |number: usize| {
            let parts: Vec<f64> = found.derivatives[number]
                .iter()
                .zip(&deviations)
                .map(|(slope, deviation)| (slope * deviation).abs())
                .collect();
            let variance: f64 = parts.iter().map(|part| part * part).sum();
            let share = |part: f64| if variance > 0.0 { part * part / variance } else { 0.0 };
            let slopes = &found.derivatives[number];
            let part = |(variable, (part, slope)): (&Variable, (&f64, &f64))| Contribution {
                by: variable.name.clone(),
                derivative: *slope,
                standard_deviation: *part,
                share: share(*part),
            };
            let mut contributions: Vec<Contribution> =
                variables.iter().zip(parts.iter().zip(slopes)).map(part).collect();
            contributions.sort_by(|a, b| b.share.total_cmp(&a.share));
            let values: Vec<f64> = samples.iter().map(|results| results[number]).collect();
            Spread {
                of: self.designs.requests()[number].to_string(),
                value: found.results[number],
                standard_deviation: variance.sqrt(),
                contributions,
                sampled: sampled(&values),
            }
        };
        let tolerated = |number: usize| Tolerated {
            key: variables[number].name.clone(),
            value: present[number],
            tolerance: half_widths[number],
            standard_deviation: deviations[number],
        };
        Ok(Uncertainty {
            tolerances: (0..variables.len()).map(tolerated).collect(),
            results: (0..found.results.len()).map(spread).collect(),
            designs: (designs > 0).then_some(designs),
            without_results: (designs > 0).then(|| designs - samples.len()),
        })
    }

    /// Designs of a Latin hypercube within the tolerances.
    fn sample(&self, count: usize) -> Vec<Vec<f64>> {
        let between =
            |variable: &Variable| (variable.name.clone(), Choice::Between(variable.bounds[0], variable.bounds[1]));
        let space: Space = self.designs.variables().iter().map(between).collect();
        let values =
            |design: Vec<(String, String)>| design.iter().filter_map(|(_, value)| value.parse().ok()).collect();
        latin_hypercube(&space, count, SEED).into_iter().map(values).collect()
    }
}

/// Mean and standard deviation of two values or more.
fn sampled(values: &[f64]) -> Option<Sampled> {
    if values.len() < 2 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    Some(Sampled { mean, standard_deviation: (squares / (values.len() - 1) as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_in_the_unit_of_the_key_or_percent() {
        let read = |text: &str| text.parse::<Tolerance>();
        let wall = read("actuator.gap[2] = 0.1").unwrap();
        assert_eq!((&*wall.key, wall.half_width, wall.is_percentage), ("actuator.gap[2]", 0.1, false));
        assert!(read("material.c10=10%").unwrap().is_percentage);
        for text in ["material.c10", "material.c10=", "=1", "a=0", "a=-1%", "a=wide", "a=inf"] {
            assert!(read(text).unwrap_err().to_string().contains("expected KEY=TOLERANCE"), "{text}");
        }
    }

    /// Volume of the solid, which no solution is needed for: it is linear in the wall above the cavities, and the hypercube says the same.
    #[test]
    fn the_spread_of_a_volume_is_that_of_its_slope() {
        let folder = std::env::temp_dir().join(format!("pneuflex-uncertainty-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("two.toml");
        std::fs::write(&path, pneuflex::template::two_chambers()).unwrap();
        let changes = [("mesh.size", "9"), ("mesh.element", "\"hex8-q1p0\""), ("load.pressure_kpa", "[1.0]")];
        let changes = changes.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec();
        let of = |tolerances: &[&str], designs: usize| {
            let tolerances: Vec<Tolerance> = tolerances.iter().map(|text| text.parse().unwrap()).collect();
            let base = Base { path: path.clone(), changes: changes.clone() };
            let requests = ["silicone_volume".parse().unwrap()];
            Tolerances::new(base, &tolerances, &requests, MemoryLimit::Available, &StopToken::new())
                .and_then(|ready| ready.solve(designs, &mut |_| {}))
        };
        let found = of(&["actuator.top_wall=0.1", "material.c10=10%"], 8).unwrap();
        let [spread] = &found.results[..] else { panic!("{found:?}") };
        assert_eq!((&*spread.of, found.designs, found.without_results), ("silicone_volume@1", Some(8), Some(0)));
        assert_eq!((&*spread.contributions[0].by, spread.contributions[1].share), ("actuator.top_wall", 0.0));
        assert!(spread.standard_deviation > 1.0, "{spread:?}");
        let sampled = spread.sampled.unwrap();
        // Eight values, one in each eighth: n/(n − 1) of nearly the variance of the whole.
        assert!((sampled.standard_deviation / spread.standard_deviation - 1.0).abs() < 0.15, "{spread:?}");
        assert!((sampled.mean - spread.value).abs() < 0.2 * spread.standard_deviation, "{spread:?}");
        for (tolerance, words) in [
            (vec!["actuator.top_wall=0.1", "actuator.top_wall=1%"], "two tolerances"),
            (vec!["mesh.size=1"], "the elements stay what they are"),
        ] {
            let error = of(&tolerance, 0).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
