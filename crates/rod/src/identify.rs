//! The rod's parameters from samples of a three-dimensional model, by linear least squares.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::law::Law;

/// Curvature of the unloaded body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FreeSample {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// Curvature, 1/mm.
    pub curvature: f64,
}

/// Bending stiffness about the unloaded state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StiffnessSample {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// ∂m/∂κ, N·mm².
    pub stiffness: f64,
}

/// Where chambers begin to touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TouchSample {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// Curvature, 1/mm.
    pub curvature: f64,
}

/// A bent body whose chambers touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactSample {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// Curvature, 1/mm.
    pub curvature: f64,
    /// Moment, N·mm.
    pub moment: f64,
}

/// All that is known of the body.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Samples {
    /// Unloaded, at two different pressures or more besides 0.
    pub free: Vec<FreeSample>,
    /// At two different pressures or more.
    pub stiffness: Vec<StiffnessSample>,
    /// At two different pressures or more, or none.
    pub touch: Vec<TouchSample>,
    /// May be empty: the contact stiffness is then 0 and known not to be determined.
    pub contact: Vec<ContactSample>,
}

/// How well samples are met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FitError {
    /// Number of samples.
    pub samples: usize,
    /// Root mean square of the differences, in the samples' unit.
    pub rms: f64,
    /// Largest difference.
    pub largest: f64,
    /// `rms` relative to the root mean square of the samples.
    pub relative_rms: f64,
}

/// The five parameters and how well they fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// The parameters.
    pub law: Law,
    /// Fit of a₁ and a₂, 1/mm.
    pub curvature_fit: FitError,
    /// Fit of D₀ and D₁, N·mm².
    pub stiffness_fit: FitError,
    /// Fit of the curvature at first contact, 1/mm; left out without samples of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub touch_fit: Option<FitError>,
    /// Fit of D_c: moments of the contact samples, N·mm; left out if it was not determined.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_fit: Option<FitError>,
}

/// Samples from which no parameters follow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Too few different pressures.
    #[error("the samples of the {what} do not determine its {parameters} parameters")]
    Undetermined {
        /// What was to be fitted.
        what: &'static str,
        /// Number of its parameters.
        parameters: usize,
    },
    /// A number that is not finite.
    #[error("a sample of the {what} is not finite")]
    NotFinite {
        /// Of what.
        what: &'static str,
    },
}

/// Fits the five parameters.
///
/// # Errors
/// Too few samples, or numbers that are not finite.
pub fn identify(samples: &Samples) -> Result<Identified, IdentifyError> {
    let free: Vec<([f64; 2], f64)> =
        samples.free.iter().map(|s| ([s.pressure_kpa, s.pressure_kpa.powi(2)], s.curvature)).collect();
    let ([a1, a2], curvature_fit) = fit("intrinsic curvature", &free)?;
    let stiffness: Vec<([f64; 2], f64)> =
        samples.stiffness.iter().map(|s| ([1.0, s.pressure_kpa], s.stiffness)).collect();
    let ([d0, d1], stiffness_fit) = fit("bending stiffness", &stiffness)?;
    let mut law = Law { a1, a2, d0, d1, ..Law::default() };
    let (mut touch_fit, mut contact_fit) = (None, None);
    if !samples.touch.is_empty() {
        let touch: Vec<([f64; 2], f64)> = samples.touch.iter().map(|s| ([1.0, s.pressure_kpa], s.curvature)).collect();
        let (line, error) = fit("first contact", &touch)?;
        law.touch = line;
        touch_fit = Some(error);
        let contact: Vec<([f64; 1], f64)> = samples
            .contact
            .iter()
            .map(|s| {
                let beyond = (s.curvature - law.touch_curvature(s.pressure_kpa)).min(0.0);
                ([beyond], s.moment - law.moment(s.pressure_kpa, s.curvature))
            })
            .collect();
        if contact.iter().any(|(row, _)| row[0] < 0.0) {
            let ([stiffness], error) = fit("contact stiffness", &contact)?;
            law.contact = stiffness.max(0.0);
            // The moment is what the law is about, not what contact adds to it.
            let count = samples.contact.len() as f64;
            let size = (samples.contact.iter().map(|s| s.moment * s.moment).sum::<f64>() / count).sqrt();
            contact_fit = Some(FitError { relative_rms: if size > 0.0 { error.rms / size } else { 0.0 }, ..error });
        }
    }
    Ok(Identified { law, curvature_fit, stiffness_fit, touch_fit, contact_fit })
}

/// Least squares of `row · parameters = value`, columns scaled to the same size.
fn fit<const N: usize>(what: &'static str, samples: &[([f64; N], f64)]) -> Result<([f64; N], FitError), IdentifyError> {
    if !samples.iter().all(|(row, value)| row.iter().chain([value]).all(|x| x.is_finite())) {
        return Err(IdentifyError::NotFinite { what });
    }
    let undetermined = IdentifyError::Undetermined { what, parameters: N };
    let scale: [f64; N] = std::array::from_fn(|j| samples.iter().map(|(row, _)| row[j].abs()).fold(0.0, f64::max));
    if samples.len() < N || scale.contains(&0.0) {
        return Err(undetermined);
    }
    let matrix = DMatrix::from_fn(samples.len(), N, |i, j| samples[i].0[j] / scale[j]);
    let values = DVector::from_fn(samples.len(), |i, _| samples[i].1);
    let svd = matrix.clone().svd(true, true);
    if svd.singular_values.min() < 1e-9 * svd.singular_values.max() {
        return Err(undetermined);
    }
    let Ok(solution) = svd.solve(&values, 0.0) else { return Err(undetermined) };
    let difference = &matrix * &solution - &values;
    let count = samples.len() as f64;
    let rms = difference.norm() / count.sqrt();
    let size = values.norm() / count.sqrt();
    let error = FitError {
        samples: samples.len(),
        rms,
        largest: difference.amax(),
        relative_rms: if size > 0.0 { rms / size } else { 0.0 },
    };
    Ok((std::array::from_fn(|j| solution[j] / scale[j]), error))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Law = Law { a1: 2e-3, a2: -1e-5, d0: 900.0, d1: -4.0, contact: 5000.0, touch: [-0.02, 1.5e-3] };

    fn samples(noise: f64) -> Samples {
        let wave = |p: f64| 1.0 + noise * (3.7 * p).sin();
        let pressures = [1.0, 3.0, 6.0, 9.0, 12.0, 15.0];
        let at =
            |p: f64, curvature: f64| ContactSample { pressure_kpa: p, curvature, moment: LAW.moment(p, curvature) };
        Samples {
            free: pressures
                .map(|p| FreeSample { pressure_kpa: p, curvature: wave(p) * LAW.intrinsic_curvature(p) })
                .into(),
            stiffness: pressures.map(|p| StiffnessSample { pressure_kpa: p, stiffness: LAW.stiffness(p) }).into(),
            touch: [5.0, 15.0].map(|p| TouchSample { pressure_kpa: p, curvature: LAW.touch_curvature(p) }).into(),
            contact: vec![at(5.0, -0.03), at(15.0, -0.02), at(15.0, 0.01)],
        }
    }

    #[test]
    fn samples_of_a_law_give_the_law_back() {
        let found = identify(&samples(0.0)).unwrap();
        let pairs = [
            (found.law.a1, LAW.a1),
            (found.law.a2, LAW.a2),
            (found.law.d0, LAW.d0),
            (found.law.d1, LAW.d1),
            (found.law.contact, LAW.contact),
            (found.law.touch[0], LAW.touch[0]),
            (found.law.touch[1], LAW.touch[1]),
        ];
        for (a, b) in pairs {
            assert!((a - b).abs() < 1e-9 * b.abs(), "{a} instead of {b}");
        }
        assert!(found.curvature_fit.relative_rms < 1e-12);
    }

    #[test]
    fn noise_shows_in_the_fit_error() {
        let found = identify(&samples(0.01)).unwrap();
        assert!((1e-3..1e-2).contains(&found.curvature_fit.relative_rms), "{found:?}");
        assert!(found.curvature_fit.largest >= found.curvature_fit.rms);
    }

    #[test]
    fn without_contact_the_fifth_parameter_stays_unknown() {
        let found = identify(&Samples { contact: vec![], ..samples(0.0) }).unwrap();
        assert_eq!((found.law.contact, found.contact_fit), (0.0, None));
    }

    #[test]
    fn too_few_samples_are_an_error() {
        let mut few = samples(0.0);
        few.free.truncate(1);
        assert!(matches!(identify(&few), Err(IdentifyError::Undetermined { parameters: 2, .. })));
        let mut same = samples(0.0);
        same.stiffness = vec![same.stiffness[0]; 5];
        assert!(matches!(identify(&same), Err(IdentifyError::Undetermined { .. })));
        let mut bad = samples(0.0);
        bad.touch[0].curvature = f64::NAN;
        assert_eq!(identify(&bad), Err(IdentifyError::NotFinite { what: "first contact" }));
    }
}
