//! Constants of hyperelastic laws from the curves of material tests.
//!
//! * [`curve`]: the text of a test file → curves of nominal stress over stretch.
//! * [`test_name`]: the kinds of test that texts name.
//! * [`clean`]: rows at rest, slack, duplicates, cycles, what comes after the break, the range to fit.
//! * [`law`]: Yeoh, Mooney-Rivlin, neo-Hookean, Ogden and Gent stress in uniaxial, equibiaxial and planar tension, incompressible.
//! * [`fit`]: weighted linear least squares with its statistics, with or without the condition of stability.
//! * [`bands`], [`range`]: how well a law meets a curve at every strain, and how much of a curve it can follow.
//! * [`cross_validation`]: which law predicts points that it was not fitted to.
//! * [`bulk`]: a bulk modulus that suits the range.
//! * [`stability`]: the stretches up to which a law is stable in Drucker's sense.
//! * [`library`]: constants of known silicones, each with its source.
//!
//! Units: stretches and strains without unit, stresses and constants in MPa. This crate knows neither files nor terminals.

pub mod bands;
pub mod bulk;
pub mod clean;
mod constrained;
pub mod cross_validation;
pub mod curve;
pub mod fit;
mod gent;
pub mod law;
pub mod library;
mod ogden;
pub mod range;
pub mod regression;
mod slack;
pub mod stability;
pub mod test_name;
mod words;
