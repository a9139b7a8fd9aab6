//! A bulk modulus to go with what was fitted: tests of the shape say nothing about the volume.

use crate::fit::Test;
use crate::law::Mode;

/// Bulk modulus over initial shear modulus, at the least: Poisson's ratio 0.4995. Silicones are stiffer in volume by far, but soft actuators
/// do not notice, and the solver needs no more.
pub const BULK_RATIO: f64 = 1000.0;

/// Change of volume at the largest stress of the tests. The stress of a law that stiffens goes up to the sixth power of the stretch, of
/// which a third of this is missing: a hundredth of the stress.
const VOLUME_CHANGE: f64 = 0.005;

/// The bulk modulus (MPa) for an initial shear modulus (MPa) and the largest mean stress up to which the constants are to be used (MPa).
pub fn bulk_modulus(shear_modulus: f64, mean_stress: f64) -> f64 {
    (BULK_RATIO * shear_modulus).max(mean_stress / VOLUME_CHANGE)
}

/// Mean of the principal true stresses of a test, MPa, at most: σ/3 in a uniaxial test, up to 2σ/3 where another axis is held or pulled.
pub fn mean_stress(mode: Mode, stretch: f64, nominal: f64) -> f64 {
    let axes = if mode == Mode::Uniaxial { 1.0 } else { 2.0 };
    axes * (stretch * nominal).abs() / 3.0
}

/// The largest mean stress of tests, MPa.
pub fn largest_mean_stress(tests: &[Test]) -> f64 {
    let all = tests.iter().flat_map(|test| test.points.iter().map(|p| mean_stress(test.mode, p.stretch, p.stress)));
    all.fold(0.0, f64::max)
}
