//! The exponents of Ogden's law. With them given the law is linear in its moduli; they themselves are searched for from many starts, because
//! the sum of squares has many minima.

use crate::fit::{FitError, Residuals, Test, share_left, step_of_shape};
use crate::law::{Exponents, Law, MOST_TERMS};

/// Exponents to start from, in thousandths.
const STARTS: [i32; 20] = [
    -12_000, -8_000, -5_000, -3_500, -2_000, -1_000, -500, 500, 1_000, 1_500, 2_000, 2_500, 3_000, 4_000, 5_000, 7_000,
    9_000, 12_000, 16_000, 20_000,
];

/// Largest exponent that is looked at, in thousandths.
const LARGEST: i32 = 30_000;

/// Starts that are followed to their minimum.
const FOLLOWED: usize = 5;

/// First and last step of the search, in thousandths.
const FIRST_STEP: i32 = 512;
const LAST_STEP: i32 = 32;

/// Smallest size of an exponent: with smaller ones the energy loses its digits.
const LEAST: f64 = 0.01;

/// Steps of Gauss and Newton, and how often one of them is halved.
const MOST_STEPS: usize = 60;
const MOST_HALVINGS: i32 = 12;

/// Points of a test that starts are compared at.
const ROUGH_POINTS: usize = 40;

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
    let mut best: Option<(f64, Exponents)> = None;
    for number in terms.unwrap_or(1)..=terms.unwrap_or(MOST_TERMS) {
        let follow = |start| followed(start, &thinned, residuals);
        let found = starts(number, &thinned, residuals).into_iter().map(follow).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((sum, exponents)) = found else { break };
        if best.is_some_and(|(before, _)| sum > WORTH_A_TERM * before) {
            break;
        }
        best = Some((sum, exponents));
        if sum < ENOUGH {
            break;
        }
    }
    let (_, exponents) = best.ok_or(FitError::Undetermined(2 * terms.unwrap_or(1)))?;
    Ok(Law::Ogden(refined(exponents, tests, residuals).map_or(exponents, |(_, exponents)| exponents)))
}

/// The best of all combinations of so many exponents among [`STARTS`], no two of them neighbours: minima that are worth
/// being followed.
fn starts(number: usize, tests: &[Test], residuals: Residuals) -> Vec<Vec<i32>> {
    let mut combinations: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..number {
        let longer = |known: &Vec<usize>| {
            let known = known.clone();
            (known.last().map_or(0, |last| last + 1)..STARTS.len()).map(move |next| [&known[..], &[next]].concat())
        };
        combinations = combinations.iter().flat_map(longer).collect();
    }
    let exponents = |places: &[usize]| -> Vec<i32> { places.iter().map(|&place| STARTS[place]).collect() };
    let rough: Vec<Test> = tests.iter().map(|test| test.thinned(ROUGH_POINTS)).collect();
    let left = |places: Vec<usize>| Some((left(&exponents(&places), &rough, residuals)?, places));
    let mut all: Vec<(f64, Vec<usize>)> = combinations.into_iter().filter_map(left).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<(f64, Vec<usize>)> = Vec::new();
    for (sum, places) in all {
        let is_neighbour = |other: &(f64, Vec<usize>)| other.1.iter().zip(&places).all(|(a, b)| a.abs_diff(*b) <= 1);
        if !kept.iter().any(is_neighbour) {
            kept.push((sum, places));
        }
        if kept.len() == FOLLOWED {
            break;
        }
    }
    kept.iter().map(|(_, places)| exponents(places)).collect()
}

/// The minimum that a start leads to.
fn followed(start: Vec<i32>, tests: &[Test], residuals: Residuals) -> (f64, Exponents) {
    let squares = |exponents: &[i32]| left(exponents, tests, residuals);
    let Some(sum) = squares(&start) else { return (f64::INFINITY, Exponents::of_thousandths(&start)) };
    let (sum, place) = descend((sum, start), &squares);
    let place = Exponents::of_thousandths(&place);
    refined(place, tests, residuals).unwrap_or((sum, place))
}

/// Share of the squares that the best moduli leave with exponents in thousandths.
fn left(exponents: &[i32], tests: &[Test], residuals: Residuals) -> Option<f64> {
    share_left(Law::Ogden(Exponents::of_thousandths(exponents)), tests, residuals)
}

/// The exponents at the bottom of the valley that they are in, by the method of Gauss and Newton among all points: along a valley that is not
/// along an axis the pattern search stops early. `None` if the points do not determine them.
fn refined(exponents: Exponents, tests: &[Test], residuals: Residuals) -> Option<(f64, Exponents)> {
    let left = |exponents: Exponents| share_left(Law::Ogden(exponents), tests, residuals);
    let mut here = exponents;
    let mut least = left(here)?;
    for _ in 0..MOST_STEPS {
        let step = step_of_shape(Law::Ogden(here), tests, residuals)?;
        let moved = |by: f64| {
            let values: Vec<f64> = here.values().iter().zip(&step).map(|(alpha, change)| alpha + by * change).collect();
            let is_allowed = values.iter().all(|alpha| (LEAST..=1e-3 * f64::from(LARGEST)).contains(&alpha.abs()));
            let other = Exponents::new(&values);
            let sum = if is_allowed { left(other) } else { None };
            sum.filter(|sum| *sum < least).map(|sum| (sum, other))
        };
        let Some((sum, other)) = (0..MOST_HALVINGS).find_map(|k| moved(0.5_f64.powi(k))) else { break };
        let is_there = sum > (1.0 - 1e-10) * least;
        (least, here) = (sum, other);
        if is_there {
            break;
        }
    }
    Some((least, here))
}

/// The pattern search of Hooke and Jeeves (1961): one exponent after the other, with smaller and smaller steps.
fn descend(start: (f64, Vec<i32>), squares: &impl Fn(&[i32]) -> Option<f64>) -> (f64, Vec<i32>) {
    let (mut least, mut place) = start;
    let mut step = FIRST_STEP;
    while step >= LAST_STEP {
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
