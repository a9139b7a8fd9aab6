//! A rod in the place of the actuator: an elastica whose intrinsic curvature depends on the air pressure (theory §8).
//!
//! The rod is planar and inextensible, clamped at s = 0 and loaded at s = L:
//!
//! ```text
//! n′ + f = 0,   m′ + n_y cos θ − n_x sin θ = 0,   x′ = cos θ,   y′ = sin θ,   m = D(p) (θ′ − κ₀(p))
//! ```
//!
//! It is a baseline in the spirit of de Payrebrune & O'Reilly (refs. \[14, 15\] of Xu & Liu 2020), **not theirs**: neither
//! their five-parameter relation nor its values are available to us. Our five parameters are a₁ and a₂ of
//! κ₀ = a₁p + a₂p², D₀ and D₁ of D = D₀ + D₁p, and the stiffness that contact between chambers adds.
//!
//! * [`law`]: moment and curvature.
//! * [`elastica`]: the boundary-value problem.
//! * [`cell`]: samples of a three-dimensional model, two chambers of the actuator.
//! * [`mod@identify`]: the parameters from such samples.
//!
//! Law, rod and identification know nothing of that model. Units: mm, N, kPa for
//! pressures; curvatures 1/mm, bending stiffnesses N·mm².

pub mod cell;
pub mod elastica;
pub mod identify;
pub mod law;

pub use elastica::{Load, Rod, RodError, Shape};
pub use identify::{Identified, IdentifyError, Samples, identify};
pub use law::Law;
