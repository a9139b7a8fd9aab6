//! How often 95 % intervals of fits cover the constants that a curve was made of, by simulation.

use pneuflex::calibration::curve::Point;
use pneuflex::calibration::fit::{FitError, FitOptions, Residuals, Test, chosen_law, fit};
use pneuflex::calibration::law::{Choice, Exponents, Family, Law, Mode};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A choice of a law, that law and its moduli, MPa.
type Truth = (Choice, Law, Vec<f64>);

/// Laws, each with a curve to a stretch of 5.8.
fn truths() -> [Truth; 4] {
    [
        (Family::Yeoh.into(), Law::Yeoh, vec![0.05, 0.004, -4e-5]),
        (Choice { family: Family::Ogden, terms: Some(1) }, Law::Ogden(Exponents::of_thousandths(&[2500])), vec![0.1]),
        (
            Choice { family: Family::Ogden, terms: Some(2) },
            Law::Ogden(Exponents::of_thousandths(&[1500, 6000])),
            vec![0.1, 0.002],
        ),
        (Family::Gent.into(), Law::Gent(60.0), vec![0.1]),
    ]
}

/// Tests that a law is fitted to: in uniaxial tension alone Ogden's exponents 6 and −12 are nearly the same.
fn modes(choice: Choice) -> &'static [Mode] {
    match choice.terms {
        Some(2) => &[Mode::Uniaxial, Mode::Planar],
        _ => &[Mode::Uniaxial],
    }
}

/// Shares of so many draws in which the interval of each constant, the shape's behind the moduli, has the truth in it.
fn covered((choice, truth, moduli): &Truth, residuals: Residuals, draws: usize) -> Result<Vec<f64>, FitError> {
    let of_mode = |mode: Mode, stretch: f64| truth.stress(moduli, mode, stretch);
    // The largest stresses rule absolute residuals; what relative ones suppose is a share of the stress.
    let noise = match residuals {
        Residuals::Absolute => 0.004 * of_mode(Mode::Uniaxial, 5.8),
        Residuals::Relative => 0.02,
    };
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let exact: Vec<f64> = moduli.iter().copied().chain(truth.shape().into_iter().map(|(_, value)| value)).collect();
    let mut covered = vec![0; exact.len()];
    for _ in 0..draws {
        let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let mut tests = Vec::new();
        for &mode in modes(*choice) {
            let stress = |stretch: f64| of_mode(mode, stretch);
            // Most points are at large strains, as in the files of machines.
            let points = (1..=60).map(|i| {
                let stretch = 1.0 + 0.08 * f64::from(i);
                // At smaller strains than a tenth relative noise is that of a larger stress.
                let scale = match residuals {
                    Residuals::Absolute => 1.0,
                    Residuals::Relative if i == 1 => 1.25 * stress(1.16),
                    Residuals::Relative => stress(stretch),
                };
                Point { stretch, stress: stress(stretch) + noise * scale * normal(), line: 1 }
            });
            tests.push(Test { name: "simulated".into(), mode, points: points.collect(), weight: 1.0 });
        }
        let law = chosen_law(*choice, &tests, residuals)?;
        let found = fit(law, &tests, &FitOptions { residuals, stable_up_to: None })?;
        // Terms in the order of their exponents.
        let mut all: Vec<_> = found.constants.iter().chain(&found.shape).collect();
        if found.shape.len() == 2 && found.shape[0].value > found.shape[1].value {
            all.swap(0, 1);
            all.swap(2, 3);
        }
        for ((constant, exact), covered) in all.into_iter().zip(&exact).zip(&mut covered) {
            *covered += usize::from(constant.confidence_95.is_some_and(|[low, high]| (low..=high).contains(exact)));
        }
    }
    Ok(covered.into_iter().map(|number| f64::from(number as u32) / draws as f64).collect())
}

/// What was counted of a law.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// Name of the law.
    pub law: String,
    /// What the fits minimised, and the noise was of.
    pub residuals: Residuals,
    /// Share of the draws in which the interval of each constant has the true one in it.
    pub shares: Vec<f64>,
}

/// Counts for the first `laws` of Yeoh's law, Ogden's of one and of two terms and Gent's, for both kinds of noise.
///
/// # Errors
/// Points that determine no law.
pub fn coverage(laws: usize, draws: usize) -> Result<Vec<Coverage>, FitError> {
    let mut found = Vec::new();
    for truth in truths().iter().take(laws) {
        for residuals in [Residuals::Absolute, Residuals::Relative] {
            found.push(Coverage { law: truth.0.name(), residuals, shares: covered(truth, residuals, draws)? });
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(laws: usize, draws: usize, [least, most]: [f64; 2]) {
        for coverage in coverage(laws, draws).unwrap() {
            assert!(coverage.shares.iter().all(|share| (least..=most).contains(share)), "{coverage:?}");
        }
    }

    /// With 60 draws a share of 95 % comes out above 85 % all but always; Yeoh's law, by a linear regression, takes more in no time.
    /// `cargo xtask coverage` takes 400.
    #[test]
    fn intervals_cover_the_truth() {
        check(4, 60, [0.85, 1.0]);
        check(1, 120, [0.9, 0.99]);
    }
}
