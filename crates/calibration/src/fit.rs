//! Constants of a law from curves: weighted linear least squares, with or without the condition of stability.
//!
//! Every test counts equally, however many points it has: the points of test t share the weight `wₜ`, which is the user's.
//! *Relative* residuals are differences of nominal stress divided by the measured stress; below 10 % strain by that measured at 10 %
//! or more, so that noise near rest does not rule the fit; and the points share the weight so that each part of the logarithm of the strain has the
//! same. *Absolute* ones are the differences themselves: the largest stresses rule, and in a
//! curve that goes to the break those are of no use to an actuator.
//!
//! The confidence intervals are those of linear regression: they suppose that residuals are independent of each other, of one standard
//! deviation (relative to the stress, with relative ones), and that the law is right. The residuals of a smooth curve to which the law does not
//! fit exactly are none of it: neighbours deviate to the same side. [`LawFit::residual_correlation`] tells how much, and
//! [`LawFit::widening`] by how much the intervals are too narrow if residuals are a first-order autoregressive series. None of
//! this covers what another specimen, batch or laboratory would give, which is usually the larger part.

use crate::bands::{Band, bands};
use crate::constrained;
use crate::curve::Point;
use crate::gent;
use crate::law::{Choice, Family, Law, Mode};
use crate::ogden;
use crate::regression::{Reduced, Statistics};
use crate::stability::{StableRange, conditions, margin, stable_range, zero_slope};

/// At smaller strains than this, relative residuals are divided by the stress there, and count the less the smaller the strain is: slack of
/// the grips and offsets of the load cell rule the first points of many curves.
const SMALL: f64 = 0.1;

/// Points are neighbours whose logarithms of the strain differ by less than this.
const NEIGHBOURHOOD: f64 = 0.1;

/// States per test at which stability is demanded and checked.
const STATES: usize = 1000;

/// Least stability that a constrained fit keeps, as a share of the neo-Hookean C₁₀ of the same points.
const STABLE_SHARE: f64 = 1e-3;

/// Points of one test.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// Name for reports.
    pub name: String,
    /// Kind.
    pub mode: Mode,
    /// Points.
    pub points: Vec<Point>,
    /// The user's weight, greater than 0.
    pub weight: f64,
}

impl Test {
    /// Largest stretch of its points; 1 for compression alone.
    pub fn largest_stretch(&self) -> f64 {
        self.points.iter().map(|p| p.stretch).fold(1.0, f64::max)
    }

    /// The same test with no more than so many of its points, at equal distances in their order.
    pub(crate) fn thinned(&self, most: usize) -> Self {
        let stride = self.points.len().div_ceil(most).max(1);
        let points = self.points.iter().copied().step_by(stride).collect();
        Self { points, name: self.name.clone(), ..*self }
    }
}

/// What is minimised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Residuals {
    /// Differences of nominal stress divided by the measured stress.
    #[default]
    Relative,
    /// The differences themselves.
    Absolute,
}

/// How constants are fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// What is minimised.
    pub residuals: Residuals,
    /// I₁ − 3 up to which the law must be stable in every deformation; `None` for a free fit.
    pub stable_up_to: Option<f64>,
}

/// Why there are no constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FitError {
    /// Too few points that differ.
    #[error("its {0} constants are not determined by these points")]
    Undetermined(usize),
    /// Numbers too large.
    #[error("its stress is beyond all bounds at some stretch of these points")]
    NotFinite,
    /// No stable constants were found.
    #[error("no stable constants were found")]
    NoStableConstants,
}

/// A constant and how well it is known.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Constant {
    /// Name.
    pub name: &'static str,
    /// Value, MPa unless it is one of the shape.
    pub value: f64,
    /// Standard error, the same; none if the fit is held by the condition of stability, or has no degree of freedom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
    /// Ends of the 95 % confidence interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confidence_95: Option<[f64; 2]>,
}

/// How well a law meets points.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Agreement {
    /// Test, or `all, weighted`.
    pub test: String,
    /// Points.
    pub points: usize,
    /// Root of the mean squared difference of nominal stress, MPa.
    pub rms_mpa: f64,
    /// The same divided by the root mean square of the measured stress.
    pub relative_rms: f64,
    /// 1 − Σ(difference)² / Σ(stress − mean)²; none if all stresses are equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r_squared: Option<f64>,
    /// Largest difference, MPa.
    pub largest_mpa: f64,
    /// Where it is.
    pub largest_at_stretch: f64,
}

/// A law with its constants.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct LawFit {
    /// The law.
    pub law: Law,
    /// Exponents of Ogden's law.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub exponents: Vec<f64>,
    /// Moduli.
    pub constants: Vec<Constant>,
    /// Fitted parameters without unit: exponents of Ogden's law, J_m of Gent's.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shape: Vec<Constant>,
    /// Initial shear modulus, MPa.
    pub shear_modulus_mpa: f64,
    /// Correlations of the estimates of the constants, and of the shape's behind them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation: Option<Vec<Vec<f64>>>,
    /// Agreement per test.
    pub tests: Vec<Agreement>,
    /// Relative errors per test and band of strains.
    pub bands: Vec<Vec<Band>>,
    /// Agreement with all points, weighted as in the fit.
    pub total: Agreement,
    /// Correlation of each residual with the next one of its test; 0 for independent ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_correlation: Option<f64>,
    /// Factor by which the confidence intervals are too narrow, √((1 + r) / (1 − r)) with that correlation r if it is positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub widening: Option<f64>,
    /// Stable stretches per test; empty if the law is not even stable at rest.
    pub stable: Vec<StableRange>,
    /// Whether the law is stable in every test up to the largest I₁ − 3 of the points.
    pub is_stable_in_range: bool,
    /// I₁ − 3 at which the slope of the energy vanishes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zero_slope_i1_minus_3: Option<f64>,
    /// The I₁ − 3 up to which stability was demanded, if that changed the constants.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_stable_up_to_i1_minus_3: Option<f64>,
}

impl LawFit {
    /// Values of the constants, MPa.
    pub fn values(&self) -> Vec<f64> {
        self.constants.iter().map(|c| c.value).collect()
    }

    /// Nominal stress, MPa.
    pub fn stress(&self, mode: Mode, stretch: f64) -> f64 {
        self.law.stress(&self.values(), mode, stretch)
    }
}

/// The largest I₁ − 3 of the points.
pub fn largest_i1_minus_3(tests: &[Test]) -> f64 {
    tests.iter().flat_map(|t| t.points.iter().map(|p| t.mode.i1_minus_3(p.stretch))).fold(0.0, f64::max)
}

/// Fits a law.
///
/// # Errors
/// Points that do not determine the constants.
pub fn fit(law: Law, tests: &[Test], options: &FitOptions) -> Result<LawFit, FitError> {
    let weights = weights(tests, options.residuals);
    let reduced = reduce(law, tests, &weights)?;
    let undetermined = FitError::Undetermined(law.constants().len());
    let free = reduced.solve().ok_or(undetermined)?;
    let stable = match options.stable_up_to {
        Some(limit) if !is_stable_up_to(law, &free, limit) => Some(held_stable(law, tests, &weights, &reduced, limit)?),
        _ => None,
    };
    // A solution on the edge of a condition has no symmetric interval.
    let statistics = match stable {
        Some(_) => None,
        None => linearised(law, &free, tests, &weights).and_then(|all| all.statistics()),
    };
    let held = options.stable_up_to.filter(|_| stable.is_some());
    let values = stable.unwrap_or(free);
    let fitted = describe(law, &values, statistics, tests, &weights.values, held);
    let numbers = fitted.tests.iter().chain([&fitted.total]).flat_map(|a| [a.rms_mpa, a.relative_rms, a.largest_mpa]);
    if values.iter().copied().chain(numbers).all(f64::is_finite) { Ok(fitted) } else { Err(FitError::NotFinite) }
}

/// The constants alone, MPa, without a condition of stability.
///
/// # Errors
/// As [`fit`].
pub fn free_constants(law: Law, tests: &[Test], residuals: Residuals) -> Result<Vec<f64>, FitError> {
    let reduced = reduce(law, tests, &weights(tests, residuals))?;
    reduced.solve().ok_or(FitError::Undetermined(law.constants().len()))
}

/// The law that was chosen, with the exponents or the J_m that fit best.
///
/// # Errors
/// Points that do not determine these.
pub fn chosen_law(choice: impl Into<Choice>, tests: &[Test], residuals: Residuals) -> Result<Law, FitError> {
    let choice = choice.into();
    match choice.family {
        Family::Yeoh if choice.terms == Some(2) => Ok(Law::YeohOfTwoTerms),
        Family::Yeoh => Ok(Law::Yeoh),
        Family::NeoHookean => Ok(Law::NeoHookean),
        Family::MooneyRivlin => Ok(Law::MooneyRivlin),
        Family::Ogden => ogden::find(tests, residuals, choice.terms),
        Family::Gent => gent::find(tests, residuals),
    }
}

/// By how much the parameters of the shape are to change, by the linearised problem; `None` if they are not determined.
pub(crate) fn step_of_shape(law: Law, tests: &[Test], residuals: Residuals) -> Option<Vec<f64>> {
    let weights = weights(tests, residuals);
    let constants = reduce(law, tests, &weights).ok()?.solve()?;
    let mut step = linearised(law, &constants, tests, &weights)?.solve()?;
    Some(step.split_off(constants.len()))
}

/// The problem linearised about a solution, with the parameters of the shape behind the moduli: what is known of all of them together;
/// `None` if they are not determined.
fn linearised(law: Law, constants: &[f64], tests: &[Test], weights: &Weights) -> Option<Reduced> {
    let points = || tests.iter().flat_map(|t| t.points.iter().map(move |p| (t.mode, p)));
    let rows: Vec<Vec<f64>> = points()
        .map(|(mode, p)| [law.stress_basis(mode, p.stretch), law.stress_by_shape(constants, mode, p.stretch)].concat())
        .collect();
    let residuals: Vec<f64> = points().map(|(mode, p)| p.stress - law.stress(constants, mode, p.stretch)).collect();
    Reduced::new(&rows, &residuals, &weights.values, &weights.over_inverse_variance)
}

/// Share of the weighted sum of squares of the stresses that the best constants leave; `None` if there are none or one of them is not
/// positive.
pub(crate) fn share_left(law: Law, tests: &[Test], residuals: Residuals) -> Option<f64> {
    let reduced = reduce(law, tests, &weights(tests, residuals)).ok()?;
    let share = reduced.rest / (reduced.rest + reduced.right.norm_squared());
    reduced.solve()?.iter().all(|value| *value > 0.0).then_some(share)
}

/// Weights of points.
struct Weights {
    /// As they count, of mean 1.
    values: Vec<f64>,
    /// The same over weights that are inverse to the variances of the points, of mean 1.
    over_inverse_variance: Vec<f64>,
}

fn weights(tests: &[Test], residuals: Residuals) -> Weights {
    let (mut values, mut over) = (Vec::new(), Vec::new());
    for test in tests {
        let share = test.weight / test.points.len() as f64;
        let (scales, measure) = match residuals {
            Residuals::Absolute => (vec![1.0; test.points.len()], vec![1.0; test.points.len()]),
            Residuals::Relative => (scales(&test.points), measure(&test.points)),
        };
        values.extend(scales.iter().zip(&measure).map(|(scale, measure)| share * measure / (scale * scale)));
        over.extend(measure);
    }
    let of_mean_one = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.iter().map(|w| w / mean).collect()
    };
    Weights { values: of_mean_one(values), over_inverse_variance: of_mean_one(over) }
}

/// What the residuals of a test are divided by, MPa.
fn scales(points: &[Point]) -> Vec<f64> {
    let strain = |p: &Point| (p.stretch - 1.0).abs();
    let stresses =
        |is_small: bool| points.iter().filter(move |p| (strain(p) < SMALL) == is_small).map(|p| p.stress.abs());
    // With small strains alone, all count alike.
    let least = stresses(false).min_by(f64::total_cmp).unwrap_or_else(|| stresses(true).fold(0.0, f64::max));
    let has_large = stresses(false).next().is_some();
    let scale = |p: &Point| {
        let doubt = if has_large && strain(p) < SMALL { SMALL / strain(p).max(1e-3 * SMALL) } else { 1.0 };
        (doubt * p.stress.abs().max(least)).max(f64::MIN_POSITIVE.sqrt())
    };
    points.iter().map(scale).collect()
}

/// How much each point of a test stands for, of mean 1: every part of the logarithm of the strain counts alike, however many points are in
/// it. Machines write points at equal times, most of which are at the largest strains.
fn measure(points: &[Point]) -> Vec<f64> {
    let place = |p: &Point| {
        let strain = (p.stretch - 1.0).abs() / SMALL;
        (p.stretch - 1.0).signum() * if strain < 1.0 { strain } else { 1.0 + strain.ln() }
    };
    let mut sorted: Vec<f64> = points.iter().map(place).collect();
    sorted.sort_by(f64::total_cmp);
    let neighbours = |place: f64| {
        let below = |limit: f64| sorted.partition_point(|other| *other < limit);
        below(place + NEIGHBOURHOOD) - below(place - NEIGHBOURHOOD)
    };
    let measure: Vec<f64> = points.iter().map(|p| 1.0 / neighbours(place(p)).max(1) as f64).collect();
    let mean = measure.iter().sum::<f64>() / points.len().max(1) as f64;
    measure.iter().map(|m| m / mean).collect()
}

fn reduce(law: Law, tests: &[Test], weights: &Weights) -> Result<Reduced, FitError> {
    let points = || tests.iter().flat_map(|t| t.points.iter().map(move |p| (t.mode, p)));
    let rows: Vec<Vec<f64>> = points().map(|(mode, p)| law.stress_basis(mode, p.stretch)).collect();
    if !rows.iter().flatten().all(|x| x.is_finite()) {
        return Err(FitError::NotFinite);
    }
    let right: Vec<f64> = points().map(|(_, p)| p.stress).collect();
    Reduced::new(&rows, &right, &weights.values, &weights.over_inverse_variance)
        .ok_or(FitError::Undetermined(law.constants().len()))
}

/// States in which stability is looked at: all tests in tension up to an I₁ − 3. They are enough: compression and shear the
/// other way are among them, and at one I₁ the conditions are linear in 1/I₂, which is extreme in uniaxial and equibiaxial
/// tension.
fn states(limit: f64) -> impl Iterator<Item = [f64; 3]> {
    let state = move |mode: Mode, i: usize| mode.stretches(mode.stretch_of(limit * i as f64 / STATES as f64));
    Mode::ALL.into_iter().flat_map(move |mode| (0..=STATES).map(move |i| state(mode, i)))
}

/// Whether a law is stable in every deformation up to an I₁ − 3.
pub(crate) fn is_stable_up_to(law: Law, constants: &[f64], limit: f64) -> bool {
    states(limit).all(|state| margin(law, constants, state) > 0.0)
}

fn held_stable(
    law: Law,
    tests: &[Test],
    weights: &Weights,
    reduced: &Reduced,
    limit: f64,
) -> Result<Vec<f64>, FitError> {
    let neo_hookean = reduce(Law::NeoHookean, tests, weights)?.solve().ok_or(FitError::NoStableConstants)?;
    let forms: Vec<Vec<f64>> = states(limit).flat_map(|state| conditions(law, state)).collect();
    let found = constrained::solve(reduced, &forms, STABLE_SHARE * neo_hookean[0].abs());
    found.filter(|c| is_stable_up_to(law, c, limit)).ok_or(FitError::NoStableConstants)
}

fn describe(
    law: Law,
    values: &[f64],
    statistics: Option<Statistics>,
    tests: &[Test],
    weights: &[f64],
    held: Option<f64>,
) -> LawFit {
    let shape = law.shape();
    let constant = |i: usize| {
        let half = statistics.as_ref().map(|s| s.half_widths[i]);
        let (name, value) = match i.checked_sub(values.len()) {
            None => (law.constants()[i], values[i]),
            Some(k) => shape[k],
        };
        Constant {
            name,
            value,
            standard_error: statistics.as_ref().map(|s| s.standard_errors[i]),
            confidence_95: half.map(|h| [value - h, value + h]),
        }
    };
    let residual = |mode: Mode, p: &Point| law.stress(values, mode, p.stretch) - p.stress;
    let mut all = Vec::new();
    let mut per_test = Vec::new();
    let mut rest = weights;
    for test in tests {
        let (own, others) = rest.split_at(test.points.len());
        rest = others;
        let rows: Vec<[f64; 4]> =
            test.points.iter().zip(own).map(|(p, w)| [p.stretch, p.stress, residual(test.mode, p), *w]).collect();
        per_test.push(agreement(&test.name, rows.iter().map(|r| [r[0], r[1], r[2], 1.0])));
        all.push(rows);
    }
    let total = agreement("all, weighted", all.iter().flatten().copied());
    let residual_correlation = correlation_of_neighbours(&mut all);
    let widening = residual_correlation.map(|r| ((1.0 + r.clamp(0.0, 0.999)) / (1.0 - r.clamp(0.0, 0.999))).sqrt());
    LawFit {
        law,
        exponents: law.exponents(),
        constants: (0..values.len()).map(constant).collect(),
        shape: (values.len()..values.len() + shape.len()).map(constant).collect(),
        shear_modulus_mpa: law.shear_modulus(values),
        correlation: statistics.map(|s| s.correlation),
        tests: per_test,
        bands: tests.iter().map(|test| bands(law, values, test)).collect(),
        total,
        residual_correlation,
        widening,
        stable: Mode::ALL.into_iter().filter_map(|mode| stable_range(law, values, mode)).collect(),
        is_stable_in_range: is_stable_up_to(law, values, largest_i1_minus_3(tests)),
        zero_slope_i1_minus_3: zero_slope(law, values),
        held_stable_up_to_i1_minus_3: held,
    }
}

/// Of rows of stretch, stress, residual and weight.
fn agreement(test: &str, rows: impl Iterator<Item = [f64; 4]> + Clone) -> Agreement {
    let sum = |f: &dyn Fn([f64; 4]) -> f64| rows.clone().map(|r| r[3] * f(r)).sum::<f64>();
    let weight = sum(&|_| 1.0);
    let mean = sum(&|r| r[1]) / weight;
    let squares = sum(&|r| r[2] * r[2]);
    let spread = sum(&|r| (r[1] - mean).powi(2));
    let size = sum(&|r| r[1] * r[1]);
    let largest = rows.clone().max_by(|a, b| a[2].abs().total_cmp(&b[2].abs())).unwrap_or_default();
    Agreement {
        test: test.into(),
        points: rows.count(),
        rms_mpa: (squares / weight).sqrt(),
        relative_rms: if size > 0.0 { (squares / size).sqrt() } else { 0.0 },
        r_squared: (spread > 0.0).then(|| 1.0 - squares / spread),
        largest_mpa: largest[2].abs(),
        largest_at_stretch: largest[0],
    }
}

/// Correlation of neighbouring residuals within tests, in the order of the stretch; `None` with fewer than five neighbours.
fn correlation_of_neighbours(tests: &mut [Vec<[f64; 4]>]) -> Option<f64> {
    let (mut products, mut squares, mut pairs) = (0.0, 0.0, 0);
    for rows in tests {
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let weighted: Vec<f64> = rows.iter().map(|r| r[3].sqrt() * r[2]).collect();
        products += weighted.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
        squares += weighted.iter().map(|r| r * r).sum::<f64>();
        pairs += rows.len().saturating_sub(1);
    }
    (pairs >= 5 && squares > 0.0).then(|| products / squares)
}
