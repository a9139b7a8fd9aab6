//! How exact a state is: every element is divided into eight, the state continued to the finer mesh, and corrected there by Newton's method
//! without the path that led to it. What that changes is a signed estimate of the error of every quantity (theory §17).

use std::time::Instant;

use pneuflex_model::{LoadParameter, Problem};
use pneuflex_newton::corrected::{Corrections, corrected, element_pressures};
use pneuflex_newton::{ConvergedState, springs_of};
use pneuflex_post::summary::probe_sites;
use serde::{Serialize, Serializer};

use crate::advice::Occasion;
use crate::analysis::Analysis;
use crate::derived;
use crate::diagnosis::{Warning, WarningKind};
use crate::input_error::InputError;
use crate::memory::Estimate;
use crate::quantities::{Quantity, Rest};

/// Corrections on the finer mesh. After one, displacements are estimated, energy and stress are not yet; a third one changes nothing any more,
/// unless contact is still changing (docs/measurements.md).
const CORRECTIONS: Corrections = Corrections { least: 2, most: 6, small: 0.1 };

/// Key that asks for it.
const KEY: &str = "output.error_estimate";

/// Errors of displacements beyond which a run warns, percent.
pub const WORTH_A_WARNING: f64 = 2.0;

/// What an estimate found, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ErrorEstimate {
    /// The errors.
    Found(EstimatedErrors),
    /// There is none.
    None {
        /// Why.
        why_not: String,
    },
}

/// Estimated errors of a state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EstimatedErrors {
    /// Time of the state; left out for actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Its pressure, kPa; that of the first cavity of a model.
    pub pressure_kpa: f64,
    /// Where on the load path it is.
    #[serde(skip)]
    pub at: LoadParameter,
    /// Unknown displacements of the finer mesh.
    pub unknowns: usize,
    /// Seconds spent.
    pub seconds: f64,
    /// The errors, by the keys of their quantities.
    #[serde(serialize_with = "by_key")]
    pub errors: Vec<EstimatedError>,
}

/// Estimated error of a quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EstimatedError {
    /// The quantity in the results.
    #[serde(skip)]
    pub quantity: Quantity,
    /// Its value there.
    pub value: f64,
    /// By how much it is too large; negative if it is too small.
    pub error: f64,
    /// The same over the better value, percent; left out where that is zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub percent: Option<f64>,
}

fn by_key<S: Serializer>(errors: &[EstimatedError], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(errors.iter().map(|error| (&error.quantity.key, error)))
}

impl EstimatedError {
    fn of(quantity: Quantity, better: f64) -> Self {
        let (value, error) = (quantity.value, quantity.value - better);
        let percent = Some(100.0 * error / better.abs()).filter(|percent| percent.is_finite());
        Self { quantity, value, error, percent }
    }
}

impl EstimatedErrors {
    /// Where on the load path in words, the errors in percent.
    pub fn words(&self, problem: &Problem) -> String {
        let of = |error: &EstimatedError| {
            let name = error.quantity.words.rsplit_once(", ").map_or(&*error.quantity.words, |(name, _)| name);
            error.percent.map(|percent| format!("{name} {percent:+.1} %"))
        };
        let errors: Vec<String> = self.errors.iter().filter_map(of).collect();
        format!("estimated errors at {}: {}", problem.clock.words(self.at), errors.join(", "))
    }

    /// The largest error of a displacement or an angle, percent.
    fn worst_displacement(&self) -> Option<&EstimatedError> {
        let of_displacement = self.errors.iter().filter(|error| error.quantity.is_displacement);
        let size = |error: &EstimatedError| error.percent.map_or(0.0, f64::abs);
        of_displacement.max_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

impl ErrorEstimate {
    /// The errors of a state of an analysis.
    pub fn of(analysis: &Analysis, state: &ConvergedState) -> Self {
        match errors(analysis, state) {
            Ok(found) => Self::Found(found),
            Err(why_not) => Self::None { why_not },
        }
    }

    /// The errors, if they were found.
    pub fn found(&self) -> Option<&EstimatedErrors> {
        match self {
            Self::Found(found) => Some(found),
            Self::None { .. } => None,
        }
    }
}

fn errors(analysis: &Analysis, state: &ConvergedState) -> Result<EstimatedErrors, String> {
    let began = Instant::now();
    if analysis.requested.last() != Some(&state.parameter) || !state.kind.is_requested() {
        return Err("the run has not ended at the last state that was asked for".into());
    }
    if state.contact_multipliers.iter().any(|multiplier| *multiplier != 0.0) {
        return Err(
            "contact carries multipliers (penetration_tolerance), which a finer mesh has at other points".into()
        );
    }
    let (finer, division) = analysis.divided().map_err(|errors| errors[0].to_string())?;
    let problem = finer.problem.with_contact_of(&analysis.problem);
    let own = element_pressures(&analysis.problem, &state.displacement).map_err(|e| e.to_string())?;
    let modes = analysis.problem.formulation.num_modes;
    let continued = own.chunks(modes).enumerate().flat_map(|(element, own)| {
        let mut coefficients = [0.0; 4];
        coefficients[..modes].copy_from_slice(own);
        division.linear(element, coefficients).into_iter().flat_map(move |of_part| of_part.into_iter().take(modes))
    });
    let pressures: Vec<f64> = continued.collect();
    let guess = ConvergedState {
        displacement: division.continued(&state.displacement),
        contact_multipliers: Vec::new(),
        ..state.clone()
    };
    let found =
        corrected(&problem, &guess, &pressures, CORRECTIONS).map_err(|why| format!("on the finer mesh: {why}"))?;
    let found = found.ok_or("on the finer mesh corrections do not settle, as where contact keeps changing")?;
    let better = Some(found).filter(|better| better.negative_pivots == 0);
    let better = better.ok_or("on the finer mesh the state is not stable")?;
    let summary = |problem: &Problem, probes: &_, state: &ConvergedState| {
        derived::describe(problem, &probe_sites(&problem.mesh, probes), state).map(|described| described.summary)
    };
    let before = summary(&analysis.problem, &analysis.probes, state).map_err(|e| e.to_string())?;
    let after = summary(&problem, &finer.probes, &better).map_err(|e| e.to_string())?;
    // Volumes at rest are the same, as the shapes of the elements are.
    let rest = Rest::of(&analysis.problem).map_err(|e| e.to_string())?;
    let pairs = rest.quantities(&before).into_iter().zip(rest.quantities(&after));
    Ok(EstimatedErrors {
        time: before.time,
        pressure_kpa: before.pressure_kpa,
        at: state.parameter,
        unknowns: problem.num_unknowns(),
        seconds: began.elapsed().as_secs_f64(),
        errors: pairs.map(|(quantity, better)| EstimatedError::of(quantity, better.value)).collect(),
    })
}

impl Analysis {
    /// Refuses what `output.error_estimate` cannot be honoured for.
    pub(crate) fn check_error_estimate(&self) -> Result<(), InputError> {
        if !self.output.error_estimate {
            return Ok(());
        }
        let why = match self.says_nothing_of_finer_meshes() {
            Some(why) => why.to_string(),
            None if !springs_of(&self.problem).is_empty() => "only contact holds a part of the body".to_owned(),
            None => return Ok(()),
        };
        let help = "leave it out, and compare two meshes".to_owned();
        Err(InputError::new(format!("{KEY} = true is not possible: {why}")).of_key(KEY).with_help(Some(help)))
    }

    /// Size of the finer mesh, and the memory that the estimate needs; `None` where none is asked for.
    pub fn size_of_error_estimate(&self) -> Option<Estimate> {
        self.output.error_estimate.then(|| match self.description.case() {
            Some(case) => Estimate::of_size(case, &case.mesh.mesh_size(&case.actuator).divided(2)),
            None => Estimate::of_divided(&self.problem.mesh, 1),
        })
    }

    /// What to be careful about beside an estimate of the errors, which takes the place of what is said of meshes like this one.
    pub(crate) fn with_estimate(&self, mut warnings: Vec<Warning>, estimate: Option<&ErrorEstimate>) -> Vec<Warning> {
        let Some(found) = estimate.and_then(ErrorEstimate::found) else { return warnings };
        let is_general = |occasion| matches!(occasion, Occasion::CoarseMesh | Occasion::Unmeasured);
        warnings.retain(|warning| !is_general(warning.occasion));
        let worst = found.worst_displacement().filter(|worst| worst.percent.is_none_or(|p| p.abs() > WORTH_A_WARNING));
        if worst.is_some() {
            warnings.push(Warning {
                kind: WarningKind::Accuracy,
                pressure_kpa: found.time.is_none().then_some(found.pressure_kpa),
                time: found.time,
                message: found.words(&self.problem),
                advice: self.vocabulary().advice(Occasion::Unmeasured, &self.problem),
                occasion: Occasion::Unmeasured,
            });
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Study;
    use crate::template;

    /// One chamber, so coarse that its errors are large; the right values are those of the mesh with every element divided.
    #[test]
    fn errors_are_those_against_the_divided_mesh_solved_from_rest() {
        let mut study = Study::from_text("one.toml", &template::two_chambers()).unwrap();
        let changes = [
            ("actuator.chambers", "1"),
            ("actuator.flange", "2.0"),
            ("mesh.size", "4.5"),
            ("mesh.element", "hex8-q1p0"),
            ("load.pressure_kpa", "[20]"),
            ("output.error_estimate", "true"),
        ];
        study.set_all(changes.map(|(key, value)| crate::Change::new(key, value))).unwrap();
        let analysis = study.build().unwrap();
        let solution = analysis.solve().unwrap();
        let found = solution.error_estimate.as_ref().and_then(ErrorEstimate::found).expect("there is an estimate");
        let finer = analysis.divided().unwrap().0;
        let right = finer.run().without_fields().solve().unwrap();
        let right = Rest::of(&finer.problem).unwrap().quantities(&right.states[0]);
        assert!(found.errors.len() >= 5 && found.errors.len() == right.len());
        for (error, right) in found.errors.iter().zip(&right) {
            let truth = error.value - right.value;
            assert_eq!(error.quantity.key, right.key);
            // Two corrections are nearly all: what is left is small against the error itself.
            assert!((error.error - truth).abs() < 0.05 * truth.abs(), "{}: {} for {truth}", right.key, error.error);
        }
        assert!(found.worst_displacement().unwrap().percent.unwrap().abs() > WORTH_A_WARNING, "{found:?}");
        // It takes the place of the table's sentences.
        let of_accuracy: Vec<_> = solution.warnings.iter().filter(|w| w.kind == WarningKind::Accuracy).collect();
        assert_eq!(of_accuracy.len(), 1, "{:?}", solution.warnings);
        assert!(of_accuracy[0].message.starts_with("estimated errors at 20 kPa: end face angle "));
    }

    #[test]
    fn what_an_estimate_is_not_possible_for_is_refused() {
        let deck = crate::convergence::PULLED_CUBE;
        let model = "[model]\nfile = \"c.inp\"\n[output]\nerror_estimate = true\n";
        let files =
            [("c.toml", model), ("c.inp", deck)].map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
        let study = Study::from_files("c.toml", files).unwrap();
        let error = study.build().unwrap_err().to_string();
        assert!(error.contains("output.error_estimate = true is not possible: forces act on nodes"), "{error}");
    }
}
