//! Gent's J_m. With it given the law is linear in its modulus.

use crate::fit::{FitError, Residuals, Test, largest_i1_minus_3, share_left};
use crate::law::Law;

/// J_m over the largest I₁ − 3 of the points, less 1, is looked for between these.
const SEARCHED: [f64; 2] = [1e-4, 1e3];

/// Values that are tried before the best is made exact.
const TRIED: usize = 80;

/// Gent's law with the J_m that fits best. Points that do not stiffen have it at the end of what is searched, where the law is neo-Hooke's to a
/// thousandth.
///
/// # Errors
/// Points that determine no modulus.
pub fn find(tests: &[Test], residuals: Residuals) -> Result<Law, FitError> {
    let largest = largest_i1_minus_3(tests);
    let law = |place: f64| Law::Gent(largest * (1.0 + place.exp()));
    let squares = |place: f64| share_left(law(place), tests, residuals).unwrap_or(f64::INFINITY);
    let [low, high] = SEARCHED.map(f64::ln);
    let step = (high - low) / TRIED as f64;
    let places = (0..=TRIED).map(|i| low + step * i as f64).map(|place| (squares(place), place));
    let (least, best) = places.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, high));
    if !least.is_finite() {
        return Err(FitError::Undetermined(2));
    }
    // Golden section: a third of an interval goes with every value.
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = ((best - step).max(low), (best + step).min(high));
    while b - a > 1e-9 {
        let [left, right] = [b - share * (b - a), a + share * (b - a)];
        if squares(left) < squares(right) { b = right } else { a = left }
    }
    Ok(law(0.5 * (a + b)))
}
