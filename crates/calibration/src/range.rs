//! How much of a curve a law can follow: fits up to the break are ruled by stresses that no actuator sees.

use pneuflex_model::FittedTo;

use crate::bands::{TOLERANCE, bands};
use crate::cross_validation::is_known_elsewhere;
use crate::fit::{FitError, Residuals, Test, chosen_law, free_constants};
use crate::law::{Choice, Family, Law};

/// Ranges are tried down to this engineering strain, which most actuators reach.
const LEAST_STRAIN: f64 = 1.0;

/// Constants of any law.
const MOST_CONSTANTS: usize = 3;

/// By how much the strain at a range's end falls from one trial to the next.
const RATIO: f64 = 0.9;

/// Points of a test that a range is judged by.
const MOST_POINTS: usize = 3000;

/// A law that follows a curve to this many times the strain is worth a word.
const WORTH_ANOTHER_LAW: f64 = 1.2;

/// Where no range is within the tolerance, one whose error is this many times the least is as good.
const AS_GOOD: f64 = 1.1;

/// The end of a range, and what it is good for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Largest stretch that is fitted; infinite for all points.
    pub to: f64,
    /// Largest relative error of a stress from 10 % strain on, of the law fitted to the range.
    pub error: f64,
    /// The same if all points are fitted, and the stretch where it is.
    pub of_all: [f64; 2],
}

impl Range {
    /// Why points are left out, for a note; `None` if none are.
    pub fn words(&self, choice: Choice) -> Option<String> {
        let [error, at] = self.of_all;
        self.to.is_finite().then(|| {
            format!(
                "points above stretch {:.3} are not fitted: with them {} would be off by {:.0} % at stretch {at:.2}",
                self.to,
                choice.name(),
                100.0 * error
            )
        })
    }
}

/// The longest range that a law can follow within [`TOLERANCE`] at every strain from 10 % on; if there is none, the longest of those where it
/// comes closest.
///
/// # Errors
/// As [`crate::fit::fit`], for all points.
pub fn longest_range(choice: impl Into<Choice>, tests: &[Test], residuals: Residuals) -> Result<Range, FitError> {
    let choice = choice.into();
    let tests: &[Test] = &tests.iter().map(|test| test.thinned(MOST_POINTS)).collect::<Vec<_>>();
    let error = |tests: &[Test]| {
        let law = chosen_law(choice, tests, residuals)?;
        Ok::<_, FitError>(worst(law, &free_constants(law, tests, residuals)?, tests))
    };
    let of_all = error(tests)?;
    let largest = tests.iter().map(Test::largest_stretch).fold(1.0, f64::max);
    let mut tried = vec![(f64::INFINITY, of_all[0])];
    let mut strain = RATIO * (largest - 1.0);
    while of_all[0] > TOLERANCE && strain >= LEAST_STRAIN {
        let inside = up_to(tests, 1.0 + strain);
        // A test of which nothing is left has no say any more, and must not lose it.
        if inside.iter().any(|test| test.points.len() <= MOST_CONSTANTS) {
            break;
        }
        if let Ok([error, _]) = error(&inside) {
            tried.push((1.0 + strain, error));
        }
        strain *= RATIO;
    }
    let least = tried.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
    let bound = (AS_GOOD * least).max(TOLERANCE);
    let &(to, error) = tried.iter().find(|t| t.1 <= bound).unwrap_or(&tried[0]);
    Ok(Range { to, error, of_all })
}

/// The law that follows the tests furthest, or closely where `own`, the range of the `chosen` one, is not: if there is one that is worth a
/// word, with its range. Laws that one kind of test does not determine in other deformations are not named.
pub fn better_choice(chosen: Choice, own: &Range, tests: &[Test], residuals: Residuals) -> Option<(Choice, Range)> {
    let largest = tests.iter().map(Test::largest_stretch).fold(1.0, f64::max);
    let strain = |range: &Range| range.to.min(largest) - 1.0;
    let (choice, other): (Choice, Range) = Family::ALL
        .into_iter()
        .filter(|family| *family != chosen.family && is_known_elsewhere(*family, tests))
        .filter_map(|family| Some((family.into(), longest_range(family, tests, residuals).ok()?)))
        .filter(|(_, other)| other.error <= own.error.max(TOLERANCE))
        .max_by(|a, b| strain(&a.1).total_cmp(&strain(&b.1)))?;
    let is_closer = own.error > TOLERANCE && other.error <= TOLERANCE;
    (is_closer || strain(&other) > WORTH_ANOTHER_LAW * strain(own)).then_some((choice, other))
}

/// The tests without the points above a stretch.
pub fn up_to(tests: &[Test], to: f64) -> Vec<Test> {
    let cut = |test: &Test| Test {
        points: test.points.iter().copied().filter(|p| p.stretch <= to).collect(),
        ..test.clone()
    };
    tests.iter().map(cut).collect()
}

/// Largest relative error, and the stretch where it is.
fn worst(law: Law, constants: &[f64], tests: &[Test]) -> [f64; 2] {
    let all = tests.iter().flat_map(|test| bands(law, constants, test));
    all.fold([0.0, 1.0], |worst, band| {
        let error = band.largest_error.abs();
        if error > worst[0] { [error, band.largest_at_stretch] } else { worst }
    })
}

/// How far the tests go, to three digits and no more than there is; `None` if there is no strain.
pub fn fitted_to(tests: &[Test]) -> Option<FittedTo> {
    FittedTo::of(tests.iter().flat_map(|test| test.points.iter().map(|p| (test.mode, p.stretch)))).rounded()
}
