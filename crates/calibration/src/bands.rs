//! How well a law meets a test at small, moderate and large strains: R² does not tell, because the largest stresses rule it.

use crate::curve::Point;
use crate::fit::Test;
use crate::law::Law;

/// Ends of the bands, engineering strain in either direction. Below the first, a law with the right initial modulus is right enough, and
/// measured stresses are mostly noise.
const ENDS: [f64; 7] = [0.1, 0.3, 0.6, 1.0, 2.0, 4.0, f64::INFINITY];

/// Relative error of a stress from here on is worth a warning.
pub const TOLERANCE: f64 = 0.1;

/// A law against the points of a test in a band of strains.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Band {
    /// Smallest and largest strain of the points, without sign.
    pub strain: [f64; 2],
    /// Points.
    pub points: usize,
    /// Mean of (law − measured) / measured.
    pub mean_error: f64,
    /// The one of the largest size.
    pub largest_error: f64,
    /// The stretch at which that is.
    pub largest_at_stretch: f64,
}

impl Band {
    /// Whether an error is worth a warning.
    pub fn misses(&self) -> bool {
        self.largest_error.abs() > TOLERANCE
    }
}

/// The bands of a test that hold points, from small strains to large ones, against a law with its constants (MPa).
pub fn bands(law: Law, constants: &[f64], test: &Test) -> Vec<Band> {
    let error = |p: &Point| (law.stress(constants, test.mode, p.stretch) - p.stress) / p.stress;
    let within = |[low, high]: [f64; 2]| {
        let points = test.points.iter().filter(|p| p.stress != 0.0);
        points.filter(move |p| (low..high).contains(&(p.stretch - 1.0).abs())).map(|p| (p.stretch, error(p)))
    };
    let band = |ends: [f64; 2]| {
        let (largest_at_stretch, largest_error) = within(ends).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let (points, sum) = within(ends).fold((0, 0.0), |(points, sum), (_, error)| (points + 1, sum + error));
        let strains = within(ends).map(|(stretch, _)| (stretch - 1.0).abs());
        let strain = strains.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], s| [low.min(s), high.max(s)]);
        Some(Band { strain, points, mean_error: sum / points as f64, largest_error, largest_at_stretch })
    };
    ENDS.windows(2).filter_map(|ends| band([ends[0], ends[1]])).collect()
}
