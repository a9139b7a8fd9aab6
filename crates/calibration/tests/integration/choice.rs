//! The law that points are of is recommended, and none that they say nothing of.

use pneuflex_calibration::cross_validation::Comparison;
use pneuflex_calibration::curve::Point;
use pneuflex_calibration::fit::{Residuals, Test};
use pneuflex_calibration::law::{Exponents, Law, Mode};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Points of a law with 1 % of noise, to a stretch of 4 (equibiaxial 2.5).
fn points_of(law: Law, moduli: &[f64], modes: &[Mode]) -> Vec<Test> {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut test = |&mode: &Mode| {
        let end = if mode == Mode::Equibiaxial { 2.5 } else { 4.0 };
        let point = |i: u32| {
            let stretch = 1.0 + (end - 1.0) * f64::from(i) / 60.0;
            let noise = 1.0 + 0.02 * (random.random::<f64>() - 0.5);
            Point { stretch, stress: noise * law.stress(moduli, mode, stretch), line: 1 }
        };
        Test { name: mode.name().into(), mode, points: (1..=60).map(point).collect(), weight: 1.0 }
    };
    modes.iter().map(&mut test).collect()
}

fn recommended(law: Law, moduli: &[f64], modes: &[Mode]) -> String {
    let comparison = Comparison::new(&points_of(law, moduli, modes), Residuals::Relative);
    comparison.best().unwrap().law.clone()
}

#[test]
fn the_law_of_the_points_is_recommended() {
    let uniaxial = [Mode::Uniaxial];
    assert_eq!(recommended(Law::NeoHookean, &[0.1], &uniaxial), "neo-Hookean");
    assert_eq!(recommended(Law::Yeoh, &[0.05, 0.004, -8e-5], &uniaxial), "Yeoh");
    assert_eq!(recommended(Law::Gent(30.0), &[0.1], &uniaxial), "Gent");
    assert_eq!(recommended(Law::MooneyRivlin, &[0.08, 0.02], &Mode::ALL), "Mooney-Rivlin");
}

#[test]
fn exponents_are_recommended_from_two_kinds_of_test_only() {
    let law = Law::Ogden(Exponents::new(&[3.2]));
    assert_eq!(recommended(law, &[0.1], &[Mode::Uniaxial, Mode::Equibiaxial]), "Ogden of 1 term");
    let from_one = Comparison::new(&points_of(law, &[0.1], &[Mode::Uniaxial]), Residuals::Relative);
    let ogden = from_one.laws.iter().find(|found| found.law == "Ogden of 1 term").unwrap();
    let best = from_one.best().unwrap();
    assert!(ogden.error < best.error && !ogden.is_known_elsewhere, "{from_one:?}");
    assert!(best.law.starts_with("Yeoh"), "{}", best.law);
}
