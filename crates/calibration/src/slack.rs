//! Strains that a specimen takes without stress: before it is taut, or after a first loading that has left it longer.

use crate::curve::Point;

/// A strain without stress below this is in the reading of the strain.
const LEAST: f64 = 0.01;

/// The part of a loading, by its largest stress, whose line leads back to no stress.
const PART: [f64; 2] = [0.005, 0.05];

/// Share of the stress which that line would have from rest on, below which a point has none.
const NO_STRESS: f64 = 0.02;

/// The strain of a loading in tension up to which it has no stress, by the line through its first stresses (the toe compensation of
/// ASTM D638, annex A1), if points were measured there; rubber is stiffest at rest and has no such part of its own.
pub fn strain_without_stress(loading: &[Point]) -> Option<f64> {
    let largest = loading.iter().map(|p| p.stress).fold(0.0, f64::max);
    let is_first = |p: &Point| p.stress > PART[0] * largest;
    let mut line: Vec<&Point> =
        loading.iter().filter(|p| is_first(p)).take_while(|p| p.stress < PART[1] * largest).collect();
    if line.len() < 2 {
        line = loading.iter().filter(|p| is_first(p)).take(2).collect();
    }
    let count = line.len() as f64;
    let mean = |of: &dyn Fn(&Point) -> f64| line.iter().map(|p| of(p)).sum::<f64>() / count;
    let (strain, stress) = (mean(&|p| p.stretch - 1.0), mean(&|p| p.stress));
    let covariance = mean(&|p| (p.stretch - 1.0 - strain) * (p.stress - stress));
    let variance = mean(&|p| (p.stretch - 1.0 - strain).powi(2));
    let slope = covariance / variance;
    let slack = strain - stress / slope;
    let has_none = |strain: f64, stress: f64| strain >= 0.5 * slack && stress.abs() < NO_STRESS * slope * strain;
    // The line is a chord, and ends a little too early. Behind its beginning stresses fall for other reasons: specimens break.
    let before = loading.iter().take_while(|p| !is_first(p)).map(|p| (p.stretch - 1.0, p.stress));
    let furthest =
        before.filter(|(strain, stress)| has_none(*strain, *stress)).map(|(strain, _)| strain).fold(0.0, f64::max);
    (slope > 0.0 && slack > LEAST && furthest > 0.0).then_some(slack.max(furthest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loading(slack: f64, stress: impl Fn(f64) -> f64) -> Vec<Point> {
        let taut = |strain: f64| (strain - slack).max(0.0);
        let strains = (1..=100).map(|i| 0.02 * f64::from(i));
        strains.map(|strain| Point { stretch: 1.0 + strain, stress: stress(taut(strain)), line: 1 }).collect()
    }

    #[test]
    fn slack_is_found_and_softness_is_none() {
        let rubber = |e: f64| (1.0 + e) - (1.0 + e).powi(-2);
        for slack in [0.03, 0.1, 0.3] {
            let found = strain_without_stress(&loading(slack, rubber)).unwrap();
            assert!((found - slack).abs() < 0.01, "{found} {slack}");
        }
        assert_eq!(strain_without_stress(&loading(0.0, rubber)), None);
        // Ten times as stiff at its end as at rest.
        assert_eq!(strain_without_stress(&loading(0.0, |e| rubber(e) * (1.0 + 0.4 * e.powi(4)))), None);
        assert_eq!(strain_without_stress(&loading(0.0, |_| 0.0)), None);
        assert_eq!(strain_without_stress(&[]), None);
        // What is left after the break has no stress either.
        let mut broken = loading(0.1, rubber);
        broken.iter_mut().skip(60).for_each(|p| p.stress = 0.0);
        assert!((strain_without_stress(&broken).unwrap() - 0.1).abs() < 0.01);
    }
}
