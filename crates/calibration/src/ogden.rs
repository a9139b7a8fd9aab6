//! The exponents of Ogden's law. With them given the law is linear in its moduli; they themselves are searched for from many starts, because
//! the sum of squares has many minima.

use crate::fit::{FitError, Residuals, Test, share_left};
use crate::law::{Exponents, Law, MOST_TERMS};

/// Exponents to start from, in thousandths.
const STARTS: [i32; 20] = [
    -12_000, -8_000, -5_000, -3_500, -2_000, -1_000, -500, 500, 1_000, 1_500, 2_000, 2_500, 3_000, 4_000, 5_000, 7_000,
    9_000, 12_000, 16_000, 20_000,
];

/// Largest exponent that is looked at, in thousandths.
const LARGEST: i32 = 30_000;

/// Starts that are followed to their minimum.
const FOLLOWED: usize = 4;

/// First step of the search, in thousandths.
const FIRST_STEP: i32 = 512;

/// First step of the search among all points, near what was found among some, in thousandths.
const LAST_STEP: i32 = 16;

/// Points of a test that the search looks at.
const MOST_POINTS: usize = 150;

/// A further term must leave less than this share of what was left.
const WORTH_A_TERM: f64 = 0.7;

/// A law that leaves less than this of the squares of the stresses, 0.1 % of the stress, needs no further term.
const ENOUGH: f64 = 1e-6;

/// Ogden's law with the exponents that fit best, of as few terms as follow the points nearly as well as more, or of a given number. Moduli
/// of all terms are positive: the law is then stable in every deformation.
///
/// # Errors
/// Points that do not determine its terms, or not even one.
pub fn find(tests: &[Test], residuals: Residuals, terms: Option<usize>) -> Result<Law, FitError> {
    let thinned: Vec<Test> = tests.iter().map(|test| test.thinned(MOST_POINTS)).collect();
    let squares = |exponents: &[i32]| share_left(Law::Ogden(Exponents::new(exponents)), &thinned, residuals);
    let mut best: Option<(f64, Vec<i32>)> = None;
    let mut before: Vec<Vec<i32>> = vec![Vec::new()];
    for number in 1..=terms.unwrap_or(MOST_TERMS) {
        let mut starts: Vec<(f64, Vec<i32>)> = Vec::new();
        for known in &before {
            for start in STARTS {
                let all = [&known[..], &[start]].concat();
                starts.extend(squares(&all).map(|sum| (sum, all)));
            }
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.truncate(FOLLOWED);
        let follow = |start| descend(start, FIRST_STEP, &squares);
        let mut found: Vec<(f64, Vec<i32>)> = starts.into_iter().map(follow).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(first) = found.first().cloned() else {
            // A term that is asked for is not left out.
            if terms.is_some() {
                return Err(FitError::Undetermined(2 * number));
            }
            break;
        };
        if terms.is_none() && best.as_ref().is_some_and(|(sum, _)| first.0 > WORTH_A_TERM * sum) {
            break;
        }
        let is_enough = terms.is_none() && first.0 < ENOUGH;
        best = Some(first);
        if is_enough {
            break;
        }
        before = found.into_iter().map(|(_, exponents)| exponents).collect();
    }
    let (_, exponents) = best.ok_or(FitError::Undetermined(1))?;
    let all = |exponents: &[i32]| share_left(Law::Ogden(Exponents::new(exponents)), tests, residuals);
    let is_thinned = tests.iter().any(|test| test.points.len() > MOST_POINTS);
    let exponents = match all(&exponents).filter(|_| is_thinned) {
        Some(sum) => descend((sum, exponents), LAST_STEP, &all).1,
        None => exponents,
    };
    Ok(Law::Ogden(Exponents::new(&exponents)))
}

/// The pattern search of Hooke and Jeeves (1961): one exponent after the other, with smaller and smaller steps.
fn descend(start: (f64, Vec<i32>), first_step: i32, squares: &impl Fn(&[i32]) -> Option<f64>) -> (f64, Vec<i32>) {
    let (mut least, mut place) = start;
    let mut step = first_step;
    while step > 0 {
        let mut is_better = false;
        for k in 0..place.len() {
            for change in [step, -step] {
                let mut other = place.clone();
                other[k] += change;
                let is_allowed = other[k] != 0 && other[k].abs() <= LARGEST;
                let sum = if is_allowed { squares(&other) } else { None };
                if let Some(sum) = sum.filter(|sum| *sum < least) {
                    (least, place, is_better) = (sum, other, true);
                }
            }
        }
        if !is_better {
            step /= 2;
        }
    }
    (least, place)
}
