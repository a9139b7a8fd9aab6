//! Designs from targets: results that are wanted, results that are to be large or small, and limits.

use std::cell::OnceCell;
use std::path::Path;

use nalgebra::{DMatrix, DVector};
use pneuflex::document::Written;
use pneuflex::folder::DESIGNED;
use pneuflex::gradient::Request;
use pneuflex::model::CaseError;
use pneuflex::{Change, Error, InputError, MemoryLimit, ResultsError, StopToken, json};
use pneuflex_sweep::node::Node;
use serde::Serialize;

use crate::curve::{self, Curve};
use crate::design_file::{DesignFile, Extreme, Limit, Points, Target, factor};
use crate::design_page::Page;
use crate::designs::{Designs, Setup};
use crate::history::Tried;
use crate::identify::in_file;
use crate::minimise::{Found, Judged, TOLERANCE, Why};
use crate::search::{Best, Ended, MOST, Progress, Search, base};
use crate::variables::{PATH, Variable, find, variables};

/// Points of a centreline that are compared with a curve if nothing is said.
const POINTS: usize = 20;

/// A limit is active where less than this share of it is left.
const ACTIVE: f64 = 1e-3;

/// Something that has a value and slopes.
#[derive(Clone, Debug, PartialEq)]
enum Quantity {
    /// A result, by its number.
    Result(usize),
    /// A constant, and variables with factors.
    Sum(f64, Vec<(usize, f64)>),
}

impl Quantity {
    fn of(&self, values: &[f64], tried: &Tried) -> (f64, DVector<f64>) {
        match self {
            Self::Result(number) => (tried.results[*number], DVector::from_column_slice(&tried.derivatives[*number])),
            Self::Sum(constant, terms) => {
                let mut slope = DVector::zeros(values.len());
                terms.iter().for_each(|(variable, factor)| slope[*variable] += factor);
                (constant + terms.iter().map(|(variable, factor)| factor * values[*variable]).sum::<f64>(), slope)
            }
        }
    }
}

/// A residual: (quantity − wanted) · factor.
#[derive(Clone, Debug)]
struct Miss {
    quantity: Quantity,
    wanted: f64,
    factor: f64,
}

/// A target: its name, accuracy, weight, and misses, whose root of the sum of squares over the weight is at most 1 where it is met.
#[derive(Clone, Debug)]
struct Wanted {
    name: String,
    value: Option<f64>,
    within: f64,
    weight: f64,
    misses: Vec<Miss>,
    /// The points that a centreline is compared with.
    curve: Option<Vec<[f64; 2]>>,
}

/// A limit: sign · (quantity − end) ≤ 0.
#[derive(Clone, Debug)]
struct Bound {
    name: String,
    quantity: Quantity,
    sign: f64,
    end: f64,
}

/// A design problem that is ready to be solved.
pub struct DesignProblem {
    file: Written<DesignFile>,
    designs: Designs,
    targets: Vec<Wanted>,
    /// Quantities with their signs and weights: what is to be large has a negative one.
    extremes: Vec<(String, Quantity, f64)>,
    limits: Vec<Bound>,
}

/// What a design has come to.
#[derive(Clone, Debug, Serialize)]
pub struct Designed {
    /// Why the search ended.
    pub why: Why,
    /// Designs that were solved, from all starts.
    pub solutions: usize,
    /// What came of every start.
    pub starts: Vec<Ended>,
    /// The variables.
    pub values: Vec<Value>,
    /// What was wanted.
    pub targets: Vec<Reached>,
    /// What was to be large or small, by names.
    pub extremes: Vec<(String, f64)>,
    /// What had to hold.
    pub limits: Vec<Held>,
}

/// A variable.
#[derive(Clone, Debug, Serialize)]
pub struct Value {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Where the first search began.
    pub start: f64,
    /// Whether it is at a bound.
    pub is_at_bound: bool,
}

/// A target.
#[derive(Clone, Debug, Serialize)]
pub struct Reached {
    /// The result.
    pub name: String,
    /// What was wanted; left out for a centreline.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wanted: Option<f64>,
    /// How far it is off: of a centreline the root mean square of the distances, mm.
    pub off: f64,
    /// How far it may be.
    pub within: f64,
}

impl Reached {
    /// Whether it is met.
    pub fn is_met(&self) -> bool {
        self.off.abs() <= self.within
    }
}

/// A limit.
#[derive(Clone, Debug, Serialize)]
pub struct Held {
    /// What must hold.
    pub name: String,
    /// The value.
    pub value: f64,
    /// Whether it holds.
    pub holds: bool,
    /// Whether it keeps the design from being better.
    pub is_active: bool,
}

impl Designed {
    /// Whether everything that was wanted is there, and everything holds that must.
    pub fn is_good(&self) -> bool {
        let is_done = matches!(self.why, Why::Met | Why::Converged);
        is_done && self.targets.iter().all(Reached::is_met) && self.limits.iter().all(|limit| limit.holds)
    }

    /// Why the search has ended, in words.
    pub fn why_in_words(&self) -> String {
        let broken: Vec<&str> =
            self.limits.iter().filter(|limit| !limit.holds).map(|limit| limit.name.as_str()).collect();
        let active = self.limits.iter().filter(|limit| limit.is_active).map(|limit| limit.name.clone());
        let at_bounds =
            self.values.iter().filter(|value| value.is_at_bound).map(|value| format!("the bound of {}", value.name));
        let keeps: Vec<String> = active.chain(at_bounds).collect();
        let keeps = if keeps.is_empty() {
            String::new()
        } else {
            format!("; what keeps it from being better: {}", keeps.join(", "))
        };
        match self.why {
            Why::Met => "all targets are met".to_owned(),
            Why::Converged if !broken.is_empty() => {
                format!("not met: no design near this one holds {}{keeps}", broken.join(", "))
            }
            Why::Converged if self.targets.iter().any(|target| !target.is_met()) => {
                format!("not met: no design near this one comes nearer to the targets{keeps}")
            }
            Why::Converged => format!("no design near this one is better{keeps}"),
            Why::NoDescent => {
                format!("not converged: no step makes it better, however short; another start may help{keeps}")
            }
            Why::Enough => {
                format!("not converged after {} solutions: `solutions` allows more, --resume goes on", self.solutions)
            }
        }
    }
}

/// Results that are asked for, each once.
#[derive(Default)]
struct Requests(Vec<Request>);

impl Requests {
    fn quantity(&mut self, column: &str, at: Option<f64>) -> Quantity {
        let request = Request { column: column.to_owned(), at };
        let known = self.0.iter().position(|other| *other == request);
        Quantity::Result(known.unwrap_or_else(|| {
            self.0.push(request);
            self.0.len() - 1
        }))
    }
}

impl DesignProblem {
    /// Reads a file, with changes to what its designs have in common, and checks everything that can be before anything is solved.
    ///
    /// # Errors
    /// Everything that is wrong with it and with the case.
    pub fn load(path: &Path, changes: &[Change], limit: MemoryLimit, stop: &StopToken) -> Result<Self, Error> {
        let file = Written::<DesignFile>::load(path, &[])?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let said = &file.case;
        let variables = variables(&said.variables).unwrap_or_default();
        let mut requests = Requests::default();
        let mut positions: Vec<f64> = said.places().into_iter().flatten().collect();
        positions.sort_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.total_cmp(b)));
        positions.dedup();
        let path_key = |variable: &Variable| variable.keys.iter().any(|key| PATH.contains(&key.as_str()));
        if let Some(variable) = variables.iter().find(|variable| path_key(variable) && !positions.is_empty()) {
            let allowed = "is where all results are: at must not be said of them".to_owned();
            let key = format!("variables.{}", variable.name);
            return Err(file.out_of_range(&CaseError { key, value: "at".into(), allowed }).into());
        }
        let mut quantity = |name: &str, at: Option<f64>| match find(&variables, name) {
            Some(variable) => Quantity::Sum(0.0, vec![(variable, 1.0)]),
            None => requests.quantity(name, at),
        };
        let targets = said.target.iter().map(|target| target.wanted(folder, &mut quantity));
        let targets = targets.collect::<Result<Vec<_>, InputError>>()?;
        let extreme = |extreme: &Extreme, quantity: &mut dyn FnMut(&str, Option<f64>) -> Quantity| {
            let (name, sign) = match (&extreme.largest, &extreme.least) {
                (Some(name), _) => (name.clone(), -1.0),
                (None, name) => (name.clone().unwrap_or_default(), 1.0),
            };
            (named(&name, extreme.at), quantity(&name, extreme.at), sign * extreme.weight)
        };
        let extremes = said.extreme.iter().map(|each| extreme(each, &mut quantity)).collect();
        // Sums get their constants once the case is built.
        let of_results: Vec<Option<Quantity>> =
            said.limit.iter().map(|limit| Some(quantity(limit.result.as_ref()?, limit.at))).collect();
        let base = base(folder.join(&said.case), &said.set, changes);
        let setup = Setup { base, variables: variables.clone(), requests: requests.0, positions, limit };
        let designs = Designs::new(setup, stop).map_err(|error| in_file(&file, &said.set, &variables, error))?;
        let mut limits = Vec::new();
        for (number, (limit, of_result)) in said.limit.iter().zip(of_results).enumerate() {
            let (name, quantity) = match of_result {
                Some(quantity) => (named(limit.result.as_deref().unwrap_or_default(), limit.at), quantity),
                None => limit.sum(&designs, &format!("limit[{number}].sum"), &file)?,
            };
            for (end, sign, word) in [(limit.at_least, -1.0, "at least"), (limit.at_most, 1.0, "at most")] {
                let bound =
                    |end: f64| Bound { name: format!("{name} {word} {end}"), quantity: quantity.clone(), sign, end };
                limits.extend(end.map(bound));
            }
        }
        Ok(Self { designs, targets, extremes, limits, file })
    }

    /// Name of the file without folder and extension.
    pub fn stem(&self) -> String {
        self.file.stem()
    }

    /// Looks for the design, in a folder; with `resume` what it holds of this search is not solved again.
    ///
    /// # Errors
    /// [`Error::Interrupted`]; a folder that cannot be used; a first design without results; what is no fault of a design.
    pub fn run(self, folder: (&Path, bool), listener: &mut dyn FnMut(&Progress<'_>)) -> Result<Designed, Error> {
        let Self { file, designs, targets, extremes, limits } = self;
        let (variables, start) = (designs.variables().to_vec(), designs.start.clone());
        let count = variables.len();
        // What changes of an extreme are large against is its first value.
        let sizes: OnceCell<Vec<f64>> = OnceCell::new();
        let judge = |values: &[f64], tried: &Tried| {
            let misses: Vec<&Miss> = targets.iter().flat_map(|target| &target.misses).collect();
            let found: Vec<(f64, DVector<f64>)> = misses
                .iter()
                .map(|miss| {
                    let (value, slope) = miss.quantity.of(values, tried);
                    (miss.factor * (value - miss.wanted), slope * miss.factor)
                })
                .collect();
            let sizes = sizes.get_or_init(|| {
                let size = |quantity: &Quantity| quantity.of(values, tried).0.abs();
                extremes
                    .iter()
                    .map(|(_, quantity, _)| if size(quantity) > 0.0 { size(quantity) } else { 1.0 })
                    .collect()
            });
            let (mut extreme, mut extreme_slope) = (0.0, DVector::zeros(count));
            for ((_, quantity, weight), size) in extremes.iter().zip(sizes) {
                let (value, slope) = quantity.of(values, tried);
                extreme += weight / size * value;
                extreme_slope += slope * (weight / size);
            }
            let of_limits: Vec<(f64, DVector<f64>)> = limits.iter().map(|limit| limit.of(values, tried)).collect();
            let reached = targets.iter().all(|target| target.reached(values, tried).is_met());
            let holds = of_limits.iter().all(|(limit, _)| *limit <= TOLERANCE);
            Judged {
                residuals: DVector::from_iterator(found.len(), found.iter().map(|(miss, _)| *miss)),
                jacobian: DMatrix::from_fn(found.len(), count, |i, j| found[i].1[j]),
                extreme,
                extreme_slope,
                limits: DVector::from_iterator(of_limits.len(), of_limits.iter().map(|(limit, _)| *limit)),
                limit_slopes: DMatrix::from_fn(of_limits.len(), count, |i, j| of_limits[i].1[j]),
                is_met: extremes.is_empty() && reached && holds,
            }
        };
        let most = file.case.solutions.map_or(MOST, |solutions| solutions as usize);
        let starts = file.case.starts.map_or(1, |starts| starts as usize);
        let best = Search::open(designs, folder, &judge, listener)?.run(most, starts)?;
        let Best { found, tried: last, starts, designs, folder } = best;
        let is_at_bound = |number: usize| {
            let [low, high] = variables[number].bounds;
            (found.values[number] - low).min(high - found.values[number]) <= 1e-6 * (high - low)
        };
        let value = |number: usize| Value {
            name: variables[number].name.clone(),
            value: found.values[number],
            start: start[number],
            is_at_bound: is_at_bound(number),
        };
        let extreme =
            |(name, quantity, _): &(String, Quantity, f64)| (name.clone(), quantity.of(&found.values, &last).0);
        let designed = Designed {
            why: found.why,
            solutions: starts.iter().map(|start| start.solutions).sum(),
            starts,
            values: (0..count).map(value).collect(),
            targets: targets.iter().map(|target| target.reached(&found.values, &last)).collect(),
            extremes: extremes.iter().map(extreme).collect(),
            limits: limits.iter().enumerate().map(|(number, limit)| limit.held(number, &found, &last)).collect(),
        };
        let text = json::pretty(&designed).map_err(|why| ResultsError::not_representable(DESIGNED, why))?;
        folder.write(DESIGNED, text)?;
        let rounds: Vec<&Tried> = designs.iter().filter(|tried| tried.outside.is_none()).collect();
        let of_round = |round: &&Tried| {
            let reached = targets.iter().map(|target| target.reached(&round.values, round)).collect();
            (judge(&round.values, round).objective(), reached)
        };
        let reached: Vec<(f64, Vec<Reached>)> = rounds.iter().map(of_round).collect();
        let wanted: Vec<Vec<[f64; 2]>> = targets.iter().filter_map(|target| target.curve.clone()).collect();
        let names = [&*file.stem(), &*file.case.case];
        Page { names, variables: &variables, rounds: &rounds, reached: &reached, wanted: &wanted }
            .write(&designed, &folder)?;
        Ok(designed)
    }
}

/// A result with its place on the load path.
fn named(column: &str, at: Option<f64>) -> String {
    Request { column: column.to_owned(), at }.to_string()
}

impl Target {
    fn wanted(
        &self,
        folder: &Path,
        quantity: &mut dyn FnMut(&str, Option<f64>) -> Quantity,
    ) -> Result<Wanted, InputError> {
        let Self { within, weight, at, .. } = *self;
        let wanted = |name: &str, value: Option<f64>, misses: Vec<Miss>| Wanted {
            name: named(name, at),
            value,
            within,
            weight,
            misses,
            curve: None,
        };
        if let (Some(result), Some(value)) = (&self.result, self.value) {
            let miss = Miss { quantity: quantity(result, at), wanted: value, factor: weight / within };
            return Ok(wanted(result, Some(value), vec![miss]));
        }
        let curve = match &self.centreline {
            Some(Points::File(name)) => curve::read(&folder.join(name))?,
            Some(Points::List(points)) => Curve::new(points.clone()).map_err(InputError::new)?,
            None => return Err(InputError::new("a target has neither a result nor a centreline")),
        };
        let count = self.points.unwrap_or(POINTS);
        let mut misses = Vec::new();
        for point in 1..=count {
            let share = point as f64 / count as f64;
            for (axis, wanted) in ["x", "z"].into_iter().zip(curve.at(share)) {
                let quantity = quantity(&format!("centreline[{}%].{axis}", 100.0 * share), at);
                misses.push(Miss { quantity, wanted, factor: weight / within / (count as f64).sqrt() });
            }
        }
        let points = (0..=count).map(|point| curve.at(point as f64 / count as f64)).collect();
        Ok(Wanted { curve: Some(points), ..wanted("centreline", None, misses) })
    }
}

impl Wanted {
    fn reached(&self, values: &[f64], tried: &Tried) -> Reached {
        let miss = |miss: &Miss| miss.factor / self.weight * (miss.quantity.of(values, tried).0 - miss.wanted);
        let misses: Vec<f64> = self.misses.iter().map(miss).collect();
        let size = misses.iter().map(|miss| miss * miss).sum::<f64>().sqrt();
        let off = self.within * if let [one] = misses[..] { one } else { size };
        Reached { name: self.name.clone(), wanted: self.value, off, within: self.within }
    }
}

impl Limit {
    /// Its sum, with a name: variables have factors, other keys are constants.
    fn sum(&self, designs: &Designs, place: &str, file: &Written<DesignFile>) -> Result<(String, Quantity), Error> {
        let analysis = designs.analysis(&designs.start)?;
        let (mut constant, mut terms, mut names) = (0.0, Vec::new(), Vec::new());
        for (key, node) in self.sum.iter().flat_map(Node::leaves) {
            let factor = factor(node).unwrap_or_default();
            names.push(format!("{factor} {key}"));
            match find(designs.variables(), &key) {
                Some(variable) => terms.push((variable, factor)),
                None => {
                    let number = analysis.number(&key).map_err(|error| {
                        let allowed = format!("must have keys that are numbers: {error}");
                        let key = format!("{place}.{key}");
                        Error::from(file.out_of_range(&CaseError { key: key.clone(), value: key, allowed }))
                    })?;
                    constant += factor * number;
                }
            }
        }
        Ok((names.join(" + "), Quantity::Sum(constant, terms)))
    }
}

impl Bound {
    /// Its value and slopes by the variables, over its own size.
    fn of(&self, values: &[f64], tried: &Tried) -> (f64, DVector<f64>) {
        let (value, slope) = self.quantity.of(values, tried);
        let factor = self.sign / if self.end == 0.0 { 1.0 } else { self.end.abs() };
        (factor * (value - self.end), slope * factor)
    }

    fn held(&self, number: usize, found: &Found, last: &Tried) -> Held {
        let left = found.judged.limits[number];
        Held {
            name: self.name.clone(),
            value: self.quantity.of(&found.values, last).0,
            holds: left <= TOLERANCE,
            is_active: left >= -ACTIVE && found.multipliers[number] > 0.0,
        }
    }
}
