//! Sums of squares and extremes under limits and bounds: steps of Gauss-Newton, and of sequential quadratic programming for what is no square, in
//! a trust region (Fletcher, *Practical Methods of Optimization*, 2nd ed. 1987, ch. 12 and 14).
//!
//! f = ½ Σ rᵢ² + e under cⱼ ≤ 0. A step p minimises ½|r + Jp|² + ∇e·p + ½ p·Bp + ν Σ max(0, cⱼ + ∇cⱼ·p) within the bounds and with |pᵢ| ≤ Δ·scale;
//! B is the damped BFGS approximation of the curvature of e and of the limits, and zero where there are none.

use nalgebra::{DMatrix, DVector};

use crate::quadratic::Programme;

/// Half width of the first trust region, in scales of the variables.
const FIRST_REGION: f64 = 0.3;

/// Steps below this share of a variable's scale are none;
const LEAST_STEP: f64 = 1e-5;

/// and so are those that promise less than this share of what there is,
const LEAST_GAIN: f64 = 1e-6;

/// or of what there was at the beginning.
const LEAST_SHARE: f64 = 1e-12;

/// A trust region narrower than this has become so because steps did not keep what they promised.
const CRAMPED: f64 = 1e-2;

/// Violations of limits up to this, in their scales, are none.
pub const TOLERANCE: f64 = 1e-4;

/// By so much the penalty of limits is raised where it is too low,
const PENALTY: f64 = 4.0;

/// and so often for a step at the most.
const MOST_PENALTIES: usize = 10;

/// Curvature where only limits count.
const NEXT_TO_NOTHING: f64 = 1e-8;

/// What a design is judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// r.
    pub residuals: DVector<f64>,
    /// J, a row for each of them.
    pub jacobian: DMatrix<f64>,
    /// e.
    pub extreme: f64,
    /// ∇e.
    pub extreme_slope: DVector<f64>,
    /// c, each divided by its scale.
    pub limits: DVector<f64>,
    /// ∇c, a row for each of them.
    pub limit_slopes: DMatrix<f64>,
    /// Whether it is good enough.
    pub is_met: bool,
}

impl Judged {
    /// f.
    pub fn objective(&self) -> f64 {
        0.5 * self.residuals.norm_squared() + self.extreme
    }

    /// The largest violation of a limit; 0 if all hold.
    pub fn violation(&self) -> f64 {
        self.limits.iter().fold(0.0, |most, limit| most.max(*limit))
    }

    fn merit(&self, penalty: f64) -> f64 {
        self.objective() + penalty * excess(&self.limits)
    }

    /// With the variables in their scales.
    fn scaled(mut self, scales: &[f64]) -> Self {
        let scales = DVector::from_column_slice(scales);
        for (i, scale) in scales.iter().enumerate() {
            self.jacobian.column_mut(i).scale_mut(*scale);
            self.limit_slopes.column_mut(i).scale_mut(*scale);
        }
        self.extreme_slope.component_mul_assign(&scales);
        self
    }

    /// Slope of e and of the limits with their multipliers.
    fn slope_of_rest(&self, multipliers: &DVector<f64>) -> DVector<f64> {
        &self.extreme_slope + self.limit_slopes.tr_mul(multipliers)
    }
}

fn excess(limits: &DVector<f64>) -> f64 {
    limits.iter().map(|limit| limit.max(0.0)).sum()
}

/// Where a search may go.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// Where it begins.
    pub start: Vec<f64>,
    /// Bounds of every variable.
    pub bounds: Vec<[f64; 2]>,
    /// What changes of every variable are large against.
    pub scales: Vec<f64>,
    /// Designs that are tried at the most.
    pub most: usize,
}

/// A design that was tried.
#[derive(Clone, Debug)]
pub struct Step<'a> {
    /// Its number, from 1.
    pub number: usize,
    /// Values of the variables.
    pub values: &'a [f64],
    /// What it was judged by; `None` for one that has no results.
    pub judged: Option<&'a Judged>,
    /// Whether it is the best one so far.
    pub is_better: bool,
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Why {
    /// The design is good enough.
    Met,
    /// No step within the bounds promises anything that counts.
    Converged,
    /// Steps promise something and do not keep it, however short.
    NoDescent,
    /// As many designs were tried as may be.
    Enough,
}

/// What a search has come to.
#[derive(Clone, Debug)]
pub struct Found {
    /// Values of the variables.
    pub values: Vec<f64>,
    /// What they are judged by; slopes are by the variables themselves.
    pub judged: Judged,
    /// Multipliers of the limits: how much f would fall if one were looser, by its scale.
    pub multipliers: DVector<f64>,
    /// Why it ended.
    pub why: Why,
    /// Designs that were tried.
    pub tried: usize,
}

/// Who solves designs, and is told what became of them.
pub trait Judge {
    /// What ends a search.
    type Error;

    /// Solves a design; `None` for one that has no results, from which the search steps back.
    ///
    /// # Errors
    /// What ends the search.
    fn judge(&mut self, values: &[f64]) -> Result<Option<Judged>, Self::Error>;

    /// Is told of a design, right after it was solved.
    ///
    /// # Errors
    /// What ends the search.
    fn tell(&mut self, step: &Step<'_>) -> Result<(), Self::Error>;
}

/// Looks for the best design; `None` if the first one has no results.
///
/// # Errors
/// Those of the judge.
pub fn minimise<J: Judge>(space: &Space, judge: &mut J) -> Result<Option<Found>, J::Error> {
    let n = space.start.len();
    let Some(first) = judge.judge(&space.start)? else { return Ok(None) };
    judge.tell(&Step { number: 1, values: &space.start, judged: Some(&first), is_better: true })?;
    let (mut values, mut judged, mut number) = (space.start.clone(), first.clone(), 1);
    let mut present = first.scaled(&space.scales);
    let at_first = present.objective().abs();
    let mut curvature = DMatrix::zeros(n, n);
    let (mut region, mut penalty) = (FIRST_REGION, 1.0_f64);
    let mut multipliers = DVector::zeros(present.limits.len());
    let why = loop {
        if present.is_met {
            break Why::Met;
        }
        let full = present.jacobian.tr_mul(&present.jacobian) + &curvature;
        let slope = present.jacobian.tr_mul(&present.residuals) + &present.extreme_slope;
        let ends: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                let [low, high] = space.bounds[i].map(|end| (end - values[i]) / space.scales[i]);
                [low.max(-region).min(0.0), high.min(region).max(0.0)]
            })
            .collect();
        let programme = |curvature: &DMatrix<f64>, slope: &DVector<f64>, penalty: f64| {
            let (limits, limit_slopes) = (&present.limits, &present.limit_slopes);
            Programme { curvature, slope, limits, limit_slopes, penalty, ends: &ends }.solve()
        };
        let left = |p: &DVector<f64>| excess(&(&present.limits + &present.limit_slopes * p));
        let Some((mut p, mut of_limits)) = programme(&full, &slope, penalty) else { break Why::NoDescent };
        if left(&p) > TOLERANCE {
            // How well a step can hold the limits if nothing else counts; the penalty is to come at least half of the way (Byrd, Nocedal and Waltz 2008).
            let nothing = (DMatrix::identity(n, n) * NEXT_TO_NOTHING, DVector::zeros(n));
            let best = programme(&nothing.0, &nothing.1, 1.0).map_or(f64::INFINITY, |(p, _)| left(&p));
            let enough = if best <= TOLERANCE { TOLERANCE } else { 0.5 * (excess(&present.limits) + best) };
            for _ in 0..MOST_PENALTIES {
                if left(&p) <= enough || best.is_infinite() {
                    break;
                }
                let Some(again) = programme(&full, &slope, PENALTY * penalty) else { break };
                (penalty, p, of_limits) = (PENALTY * penalty, again.0, again.1);
            }
        }
        multipliers = of_limits;
        let model = 0.5 * p.dot(&(&full * &p)) + slope.dot(&p);
        let gain = penalty * (excess(&present.limits) - left(&p)) - model;
        let merit = present.merit(penalty);
        let reach = p.amax();
        if reach < LEAST_STEP || gain <= LEAST_GAIN * merit.abs() || gain <= LEAST_SHARE * at_first {
            // A step that is kept this short promises little in any case.
            let is_cramped = region < CRAMPED && reach > 0.99 * region;
            break if is_cramped || region < LEAST_STEP { Why::NoDescent } else { Why::Converged };
        }
        if number == space.most {
            break Why::Enough;
        }
        number += 1;
        let moved = |i: usize| (values[i] + space.scales[i] * p[i]).clamp(space.bounds[i][0], space.bounds[i][1]);
        let next: Vec<f64> = (0..n).map(moved).collect();
        let Some(found) = judge.judge(&next)? else {
            judge.tell(&Step { number, values: &next, judged: None, is_better: false })?;
            region = 0.25 * reach;
            continue;
        };
        let scaled = found.clone().scaled(&space.scales);
        let share = (merit - scaled.merit(penalty)) / gain;
        let is_better = share > 1e-4;
        judge.tell(&Step { number, values: &next, judged: Some(&found), is_better })?;
        let change = scaled.slope_of_rest(&multipliers) - present.slope_of_rest(&multipliers);
        update(&mut curvature, &p, change);
        region = match share {
            share if !is_better || share.is_nan() => 0.25 * reach,
            share if share < 0.25 => 0.5 * reach,
            share if share > 0.75 => region.max(2.0 * reach),
            _ => region,
        };
        if is_better {
            (values, judged, present) = (next, found, scaled);
        }
    };
    Ok(Some(Found { values, judged, multipliers, why, tried: number }))
}

/// Damped BFGS (Powell 1978). What does not change has no curvature.
fn update(curvature: &mut DMatrix<f64>, step: &DVector<f64>, change: DVector<f64>) {
    let square = step.norm_squared();
    if square == 0.0 || change.amax() <= f64::EPSILON * change.len() as f64 {
        return;
    }
    if curvature.iter().all(|entry| *entry == 0.0) {
        let size = step.dot(&change).abs().max(1e-3 * change.norm() * square.sqrt()) / square;
        *curvature = DMatrix::identity(step.len(), step.len()) * size;
    }
    let along = &*curvature * step;
    let (known, seen) = (step.dot(&along), step.dot(&change));
    let share = if seen >= 0.2 * known { 1.0 } else { 0.8 * known / (known - seen) };
    let change = change * share + &along * (1.0 - share);
    let seen = step.dot(&change);
    if known > 0.0 && seen > 0.0 {
        *curvature += &change * change.transpose() / seen - &along * along.transpose() / known;
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    fn none(n: usize) -> (DVector<f64>, DMatrix<f64>) {
        (DVector::zeros(0), DMatrix::zeros(0, n))
    }

    struct Known<F>(F);

    impl<F: FnMut(&[f64]) -> Option<Judged>> Judge for Known<F> {
        type Error = Infallible;

        fn judge(&mut self, values: &[f64]) -> Result<Option<Judged>, Infallible> {
            Ok(self.0(values))
        }

        fn tell(&mut self, _: &Step<'_>) -> Result<(), Infallible> {
            Ok(())
        }
    }

    fn search(space: &Space, judge: impl FnMut(&[f64]) -> Option<Judged>) -> Found {
        minimise(space, &mut Known(judge)).unwrap().unwrap()
    }

    /// Rosenbrock's valley as residuals 10 (y − x²) and 1 − x.
    fn rosenbrock(x: &[f64]) -> Judged {
        let (limits, limit_slopes) = none(2);
        Judged {
            residuals: DVector::from_vec(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]),
            jacobian: DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0]),
            extreme: 0.0,
            extreme_slope: DVector::zeros(2),
            limits,
            limit_slopes,
            is_met: false,
        }
    }

    #[test]
    fn squares_have_their_least_value_within_the_bounds_and_where_there_are_results() {
        let space = Space { start: vec![-1.2, 1.0], bounds: vec![[-2.0, 2.0]; 2], scales: vec![1.0, 1.0], most: 60 };
        let found = search(&space, |x| Some(rosenbrock(x)));
        assert!((found.values[0] - 1.0).abs() < 1e-4 && (found.values[1] - 1.0).abs() < 1e-4, "{found:?}");
        assert_eq!(found.why, Why::Converged);
        // With x ≤ 0.8 at (0.8, 0.64).
        let bounded = Space { bounds: vec![[-2.0, 0.8], [-2.0, 2.0]], ..space.clone() };
        let found = search(&bounded, |x| Some(rosenbrock(x)));
        assert!((found.values[0] - 0.8).abs() < 1e-6 && (found.values[1] - 0.64).abs() < 1e-4, "{found:?}");
        // Beyond x = 0.9 nothing can be solved: it comes near.
        let found = search(&space, |x| (x[0] <= 0.9).then(|| rosenbrock(x)));
        assert!((found.values[0] - 0.9).abs() < 1e-2, "{found:?}");
        let enough = search(&Space { most: 3, ..space }, |x| Some(rosenbrock(x)));
        assert_eq!((enough.why, enough.tried), (Why::Enough, 3));
    }

    /// Beside the first design everything is worse than its slope says, as where the number of elements changes.
    #[test]
    fn a_search_that_is_stuck_has_not_converged() {
        let space = Space { start: vec![0.5], bounds: vec![[0.0, 2.0]], scales: vec![1.0], most: 60 };
        let (limits, limit_slopes) = none(1);
        let found = search(&space, |x| {
            let jump = if x[0] == 0.5 { 0.0 } else { 0.4 };
            Some(Judged {
                residuals: DVector::from_vec(vec![1.0 - x[0] + jump, 10.0]),
                jacobian: DMatrix::from_row_slice(2, 1, &[-1.0, 0.0]),
                extreme: 0.0,
                extreme_slope: DVector::zeros(1),
                limits: limits.clone(),
                limit_slopes: limit_slopes.clone(),
                is_met: false,
            })
        });
        assert_eq!((found.why, found.values[0]), (Why::NoDescent, 0.5), "{found:?}");
    }

    /// The problem of Hock and Schittkowski no. 71: min x₀x₃(x₀ + x₁ + x₂) + x₂ under x₀x₁x₂x₃ ≥ 25, Σx² ≤ 40, 1 ≤ x ≤ 5. They ask for
    /// Σx² = 40, which the best point has in any case: with more, x₃ could be less. f = 17.0140173.
    #[test]
    fn an_extreme_under_limits_is_that_of_hock_and_schittkowski() {
        let judge = |x: &[f64]| {
            let sum = x[0] + x[1] + x[2];
            let slope = vec![x[3] * (sum + x[0]), x[0] * x[3], x[0] * x[3] + 1.0, x[0] * sum];
            let product: f64 = x.iter().product();
            let squares: f64 = x.iter().map(|x| x * x).sum();
            let of_product = x.iter().map(|x| -product / x / 25.0);
            let of_squares = x.iter().map(|x| 2.0 * x / 40.0);
            Some(Judged {
                residuals: DVector::zeros(0),
                jacobian: DMatrix::zeros(0, 4),
                extreme: x[0] * x[3] * sum + x[2],
                extreme_slope: DVector::from_vec(slope),
                limits: DVector::from_vec(vec![1.0 - product / 25.0, squares / 40.0 - 1.0]),
                limit_slopes: DMatrix::from_row_iterator(2, 4, of_product.chain(of_squares)),
                is_met: false,
            })
        };
        let space =
            Space { start: vec![1.0, 5.0, 5.0, 1.0], bounds: vec![[1.0, 5.0]; 4], scales: vec![1.0; 4], most: 60 };
        let found = search(&space, judge);
        assert!((found.judged.objective() - 17.014_017_3).abs() < 1e-3, "{found:?}");
        assert!(found.judged.violation() < TOLERANCE && found.why == Why::Converged, "{found:?}");
        assert!(found.tried < 30, "{}", found.tried);
    }
}
