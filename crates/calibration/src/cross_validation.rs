//! Which law to take: each is judged by points that it was not fitted to.
//!
//! The points of every test from 10 % strain on are divided into [`BLOCKS`] blocks of neighbours, of equal width in the logarithm of the strain.
//! One block after the other is left out, the law is fitted to all other points, exponents and J_m included, and its stress in the block is
//! compared with the measured one. Blocks are contiguous because neighbouring points of a smooth curve know of each other: a law that
//! goes through every second point says nothing new about the others (e.g. Roberts et al. 2017, *Ecography* 40, 913).
//!
//! Blocks say nothing of deformations that no test has. From one kind of test alone only laws of the first invariant are recommended: the
//! exponents of Ogden's law and the C₀₁ of Mooney-Rivlin are then those of that test, and its others may be off by any factor
//! ([`is_known_elsewhere`]).
//!
//! The last block of a test is beyond what the law was then fitted to. It is judged apart, as [`Validation::beyond`]: within their range laws
//! interpolate, and a run that leaves it warns.

use pneuflex_model::FittedTo;
use serde::Serialize;

use crate::curve::Point;
use crate::fit::{FitError, Residuals, Test, chosen_law, free_constants, is_stable_up_to, largest_i1_minus_3};
use crate::law::{Choice, Family, Law};

/// Blocks of a test.
pub const BLOCKS: usize = 8;

/// Smaller strains are not judged, as in [`crate::bands`].
const SMALL: f64 = 0.1;

/// Points of a test that are looked at.
const MOST_POINTS: usize = 150;

/// Errors that differ by less than this are equal to an actuator.
const NO_DIFFERENCE: f64 = 0.005;

/// A law, judged by points that it was not fitted to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Validation {
    /// Name of the law.
    pub law: String,
    /// Options that choose it.
    pub options: String,
    /// Constants that are fitted.
    pub constants: usize,
    /// Root of the mean squared relative error of the stress in blocks that were left out, every block counting alike, but for the last of a
    /// test.
    pub error: f64,
    /// Standard error of that, from how it differs between the blocks.
    pub standard_error: f64,
    /// The largest of these errors.
    pub largest_error: f64,
    /// The stretch at which that is.
    pub largest_at_stretch: f64,
    /// The largest of the same of the last blocks; `None` where the law has no stress there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond: Option<f64>,
    /// Whether the law fitted to all points is stable over their range.
    pub is_stable: bool,
    /// See [`is_known_elsewhere`].
    pub is_known_elsewhere: bool,
    /// The law.
    #[serde(skip)]
    pub choice: Choice,
}

/// Laws on the same points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Those with few constants first.
    pub laws: Vec<Validation>,
    /// The one to take, by its place among them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recommended: Option<usize>,
}

impl Validation {
    /// Whether the law may be recommended if it is close enough.
    pub fn is_able(&self) -> bool {
        self.is_stable && self.is_known_elsewhere && self.error.is_finite()
    }
}

/// Whether what a law says of deformations unlike those of the tests follows from the tests: for laws of the first invariant, and where
/// there are two kinds of test, of which compression along one axis is one.
pub fn is_known_elsewhere(family: Family, tests: &[Test]) -> bool {
    let is_of_first_invariant = matches!(family, Family::Yeoh | Family::NeoHookean | Family::Gent);
    let points = tests.iter().flat_map(|test| test.points.iter().map(|p| (test.mode, p.stretch)));
    let large = points.filter(|(_, stretch)| (stretch - 1.0).abs() >= SMALL);
    is_of_first_invariant || FittedTo::of(large).tests().count() > 1
}

impl Comparison {
    /// Judges all laws that the points determine with a block left out.
    pub fn new(tests: &[Test], residuals: Residuals) -> Self {
        let tests: Vec<Test> = tests.iter().map(|test| test.thinned(MOST_POINTS)).collect();
        let laws: Vec<Validation> =
            Choice::ALL.into_iter().filter_map(|choice| cross_validate(choice, &tests, residuals).ok()).collect();
        let recommended = recommended(&laws);
        Self { laws, recommended }
    }

    /// The law to take.
    pub fn best(&self) -> Option<&Validation> {
        self.recommended.map(|place| &self.laws[place])
    }
}

/// The rule of one standard error (Breiman et al. 1984, *Classification and Regression Trees*, §3.4.3): of the laws that
/// may be taken at all, and are no worse than the best of them by more than its standard error, the one with the fewest constants; of two
/// with as many, the better one.
fn recommended(laws: &[Validation]) -> Option<usize> {
    let able = || laws.iter().enumerate().filter(|(_, law)| law.is_able());
    let (_, best) = able().min_by(|a, b| a.1.error.total_cmp(&b.1.error))?;
    let bound = best.error + best.standard_error.max(NO_DIFFERENCE);
    let good = able().filter(|(_, law)| law.error <= bound);
    let place = good.min_by(|(_, a), (_, b)| a.constants.cmp(&b.constants).then(a.error.total_cmp(&b.error)))?.0;
    Some(place)
}

/// Fits a law with one block after the other left out.
///
/// # Errors
/// Points that do not determine it with a block left out, or fewer than three blocks with points.
pub fn cross_validate(choice: Choice, tests: &[Test], residuals: Residuals) -> Result<Validation, FitError> {
    let whole = chosen_law(choice, tests, residuals)?;
    let constants = free_constants(whole, tests, residuals)?;
    let (mut inner, mut beyond) = (Vec::<(f64, f64)>::new(), Some(0.0_f64));
    let mut largest = [0.0, 1.0];
    for (number, test) in tests.iter().enumerate() {
        let blocks = blocks(test);
        let last = blocks.len().saturating_sub(1);
        for (k, block) in blocks.iter().enumerate() {
            let kept: Vec<Point> = test.points.iter().copied().filter(|p| !block.contains(p)).collect();
            let mut others = tests.to_vec();
            others[number].points = kept;
            let law = chosen_law(choice, &others, residuals)?;
            let fitted = free_constants(law, &others, residuals)?;
            let error = |p: &Point| (law.stress(&fitted, test.mode, p.stretch) - p.stress) / p.stress;
            let errors: Vec<[f64; 2]> = block.iter().map(|p| [error(p).abs(), p.stretch]).collect();
            let square = errors.iter().map(|e| e[0] * e[0]).sum::<f64>() / errors.len() as f64;
            let worst = errors.into_iter().fold([0.0, 1.0], |a, b| if b[0] > a[0] { b } else { a });
            if k == last {
                beyond = beyond.map(|before| before.max(worst[0])).filter(|error| error.is_finite());
                continue;
            }
            inner.push((test.weight, square));
            if worst[0] > largest[0] {
                largest = worst;
            }
        }
    }
    // Two blocks have no scatter to speak of.
    if inner.len() < 3 {
        return Err(FitError::Undetermined(constants.len()));
    }
    let sum: f64 = inner.iter().map(|(weight, _)| weight).sum();
    let mean = inner.iter().map(|(weight, square)| weight * square).sum::<f64>() / sum;
    let spread = inner.iter().map(|(weight, square)| weight * (square - mean).powi(2)).sum::<f64>() / sum;
    let error = mean.sqrt();
    // That of the mean square, carried over to its root.
    let standard_error = if error > 0.0 { (spread / (inner.len() - 1) as f64).sqrt() / (2.0 * error) } else { 0.0 };
    Ok(Validation {
        law: choice.name(),
        options: choice.options(),
        constants: constants.len() + whole.shape().len(),
        error,
        standard_error,
        largest_error: largest[0],
        largest_at_stretch: largest[1],
        beyond,
        is_stable: is_material(whole, &constants) && is_stable_up_to(whole, &constants, largest_i1_minus_3(tests)),
        is_known_elsewhere: is_known_elsewhere(choice.family, tests),
        choice,
    })
}

/// Whether a case file could have the law.
fn is_material(law: Law, constants: &[f64]) -> bool {
    let material = pneuflex_model::Material::from(law.with_constants(constants));
    material.problems("material").is_empty()
}

/// The points of a test from 10 % strain on, in blocks of equal width in the logarithm of the strain, in compression and in tension; those
/// without points are left out. The strains of the last block are the largest.
fn blocks(test: &Test) -> Vec<Vec<Point>> {
    let place = |p: &Point| ((p.stretch - 1.0).abs() / SMALL).ln();
    let judged = || test.points.iter().filter(|p| (p.stretch - 1.0).abs() >= SMALL && p.stress != 0.0);
    let largest = judged().map(place).fold(0.0, f64::max);
    let block = |k: usize| -> Vec<Point> {
        let number = |p: &&Point| ((place(p) / largest * BLOCKS as f64) as usize).min(BLOCKS - 1) == k;
        judged().filter(number).copied().collect()
    };
    (0..BLOCKS).map(block).filter(|block| !block.is_empty()).collect()
}
