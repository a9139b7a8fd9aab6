//! What is read of `summary.json`. Keys that are not needed are passed over, so that later versions can be read.

use std::collections::BTreeMap;

use pneuflex_model::StateKind;
use pneuflex_post::measures;
use serde::Deserialize;

use crate::comparison::Comparison;

/// Number of the form that numbers of the whole body have.
pub const FORMAT: u32 = 2;

fn first_format() -> u32 {
    1
}

/// A run's summary.
#[derive(Clone, Debug, Deserialize)]
pub struct Summary {
    /// Number of its form; those of another form than this one's mean something else.
    #[serde(default = "first_format")]
    pub format: u32,
    /// Title of the case.
    #[serde(default)]
    pub title: String,
    /// Version of the program that wrote it.
    #[serde(default)]
    pub version: String,
    /// `converged`, `past-limit`, `not-converged`, `running`, or a word of a later version.
    pub status: String,
    /// Why the run ended early.
    #[serde(default)]
    pub failure: Option<String>,
    /// What to try against it.
    #[serde(default)]
    pub failure_reason: Option<Reason>,
    /// Size of the mesh.
    pub mesh: MeshSize,
    /// Where the probes sit, by their names.
    #[serde(default)]
    pub probes: BTreeMap<String, ProbeSite>,
    /// Requested pressures or times in increasing order; of a path that was followed by its arc length with the states past its limit points,
    /// in the path's order.
    pub steps: Vec<Step>,
    /// States of a run that ended early, beyond the last requested one that was reached; the last converged one comes last.
    #[serde(default)]
    pub on_the_way: Vec<Step>,
    /// Load steps between requested pressures or times.
    #[serde(default)]
    pub load_steps: Vec<LoadStep>,
    /// Newton iterations.
    #[serde(default)]
    pub iterations_total: usize,
    /// Where the time went.
    #[serde(default)]
    pub timing: Timing,
    /// What to be careful about.
    #[serde(default)]
    pub warnings: Option<Vec<Warning>>,
    /// Estimated errors of the last state, if they were asked for.
    #[serde(default)]
    pub error_estimate: Option<ErrorEstimate>,
    /// Derivatives of results, if they were asked for: they come from a file of their own.
    #[serde(default)]
    pub gradients: Vec<Gradient>,
    /// How the run compares with measurements, if that was asked for: it comes from a file of its own.
    #[serde(default)]
    pub comparison: Option<Comparison>,
}

/// Derivatives of a result of a state, as `gradients.json` has them.
#[derive(Clone, Debug, Deserialize)]
pub struct Gradient {
    /// The result's column.
    pub of: String,
    /// Time; left out for actuators.
    #[serde(default)]
    pub time: Option<f64>,
    /// Pressure, kPa.
    pub pressure_kpa: f64,
    /// The result there.
    pub value: f64,
    /// The greatest effect of a change by a percent first.
    pub derivatives: Vec<Derivative>,
    /// Numbers by which there is no derivative.
    #[serde(default)]
    pub without: Vec<NoDerivative>,
}

/// The derivative by a number.
#[derive(Clone, Debug, Deserialize)]
pub struct Derivative {
    /// Key of the number.
    pub by: String,
    /// Its value.
    pub value: f64,
    /// Its unit; empty for none.
    pub unit: String,
    /// Change of the result per unit.
    pub derivative: f64,
    /// Change of the result when the number grows by a percent.
    pub per_percent: f64,
}

/// A number by which there is no derivative.
#[derive(Clone, Debug, Deserialize)]
pub struct NoDerivative {
    /// Its key.
    pub by: String,
    /// Why.
    pub why: String,
}

/// Estimated errors of a state, or why there are none.
#[derive(Clone, Debug, Deserialize)]
pub struct ErrorEstimate {
    /// Time; left out for actuators.
    #[serde(default)]
    pub time: Option<f64>,
    /// Pressure, kPa.
    #[serde(default)]
    pub pressure_kpa: Option<f64>,
    /// Unknowns of the finer mesh.
    #[serde(default)]
    pub unknowns: usize,
    /// By the keys of their quantities.
    #[serde(default)]
    pub errors: BTreeMap<String, EstimatedError>,
    /// Why there are none.
    #[serde(default)]
    pub why_not: Option<String>,
}

/// Estimated error of a quantity.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct EstimatedError {
    /// The quantity in the results.
    pub value: f64,
    /// By how much it is too large.
    pub error: f64,
    /// The same in percent of the better value.
    #[serde(default)]
    pub percent: Option<f64>,
}

/// Size of the mesh.
#[derive(Clone, Debug, Deserialize)]
pub struct MeshSize {
    /// Nodes.
    pub nodes: usize,
    /// Elements.
    pub elements: usize,
    /// Unknown displacements.
    pub unknowns: usize,
    /// Name of the element formulation.
    pub element: String,
}

/// A probe's node.
#[derive(Clone, Debug, Deserialize)]
pub struct ProbeSite {
    /// Node number.
    pub node: usize,
}

/// A requested pressure of an actuator, or a requested time of a model.
#[derive(Clone, Debug, Deserialize)]
pub struct Step {
    /// Time; left out for actuators.
    #[serde(default)]
    pub time: Option<f64>,
    /// Air pressure, kPa; that of the first cavity of a model. Left out at a time that was missed and for which none is given.
    #[serde(default)]
    pub pressure_kpa: Option<f64>,
    /// Whether it was reached.
    pub converged: bool,
    /// Newton iterations spent since the previous step.
    #[serde(default)]
    pub iterations: usize,
    /// Why it is there.
    #[serde(default)]
    pub kind: StateKind,
    /// What was found, if it was reached.
    #[serde(flatten)]
    pub reached: Option<Reached>,
}

/// A load step between requested pressures or times.
#[derive(Clone, Debug, Deserialize)]
pub struct LoadStep {
    /// Time; left out for actuators.
    #[serde(default)]
    pub time: Option<f64>,
    /// Air pressure, kPa; that of the first cavity of a model.
    pub pressure_kpa: f64,
    /// What was found.
    #[serde(flatten)]
    pub found: Found,
}

/// What was found at a reached step.
#[derive(Clone, Debug, Deserialize)]
pub struct Reached {
    /// What load steps between requested ones have, too.
    #[serde(flatten)]
    pub found: Found,
    /// Largest von Mises stress, MPa.
    pub max_von_mises_mpa: f64,
    /// von Mises stress not exceeded in 99 % of the volume, MPa.
    pub von_mises_p99_mpa: f64,
    /// What to be careful about, as older versions wrote it.
    #[serde(default)]
    pub warning: Option<String>,
}

/// What was found at a load step.
#[derive(Clone, Debug, Deserialize)]
pub struct Found {
    /// Displacement of every probe, mm.
    #[serde(default)]
    pub probes: BTreeMap<String, [f64; 3]>,
    /// Angle of the end face, degrees, positive downwards; left out for a body without one.
    #[serde(default)]
    pub end_face_angle_deg: Option<f64>,
    /// Deformed bottom centreline, \[x, z\] in mm from the clamp to the tip; empty for a body without one.
    #[serde(default)]
    pub centreline: Vec<[f64; 2]>,
    /// Contact.
    pub contact: Contact,
    /// Volume of the air, mm³.
    pub cavity_volume_mm3: f64,
    /// Cavities of a model, by name.
    #[serde(default)]
    pub cavities: BTreeMap<String, Cavity>,
    /// Sums of the reactions of a model's supports, N, by name.
    #[serde(default)]
    pub reactions: BTreeMap<String, [f64; 3]>,
    /// Forces across the planes of symmetry, N, by their words.
    #[serde(default)]
    pub symmetry_reactions: BTreeMap<String, [f64; 3]>,
    /// Rigid obstacles, by name.
    #[serde(default)]
    pub obstacles: BTreeMap<String, Obstacle>,
}

/// A cavity at a reached step.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Cavity {
    /// Pressure above the atmosphere's, kPa.
    #[serde(default)]
    pub pressure_kpa: Option<f64>,
    /// Volume, mm³; left out for an open one.
    #[serde(default)]
    pub volume_mm3: Option<f64>,
}

/// An obstacle at a reached step.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Obstacle {
    /// Force on it, N.
    #[serde(default)]
    pub force_n: Option<[f64; 3]>,
    /// Reference area that touches it, mm².
    #[serde(default)]
    pub area_mm2: Option<f64>,
}

/// Contact at a reached step.
#[derive(Clone, Debug, Deserialize)]
pub struct Contact {
    /// Reference area in contact, mm².
    pub area_mm2: f64,
    /// Largest depth by which walls pass through each other, mm; of requested steps only.
    #[serde(default)]
    pub max_penetration_mm: Option<f64>,
    /// Gaps whose walls touch; of requested steps only.
    #[serde(default)]
    pub gaps_in_contact: Option<usize>,
}

/// Where the time went, s.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Timing {
    /// Assembly of residual and tangent.
    #[serde(default)]
    pub assembly_s: f64,
    /// Factorisations.
    #[serde(default)]
    pub factor_s: f64,
    /// Solutions.
    #[serde(default)]
    pub solve_s: f64,
    /// Contact search.
    #[serde(default)]
    pub contact_s: f64,
    /// The whole run.
    #[serde(default)]
    pub total_s: f64,
}

/// Why a run ended early; the words are those of [`Summary::failure`].
#[derive(Clone, Debug, Deserialize)]
pub struct Reason {
    /// What to try.
    #[serde(default)]
    pub advice: String,
}

/// Something to be careful about.
#[derive(Clone, Debug, Deserialize)]
pub struct Warning {
    /// Pressure from which it holds, kPa.
    #[serde(default)]
    pub pressure_kpa: Option<f64>,
    /// The same as a time, for models.
    #[serde(default)]
    pub time: Option<f64>,
    /// What was found.
    pub message: String,
    /// What to do about it.
    #[serde(default)]
    pub advice: String,
}

impl LoadStep {
    /// The time of the load path: the air pressure in kPa of an actuator.
    pub fn when(&self) -> f64 {
        self.time.unwrap_or(self.pressure_kpa)
    }
}

impl Found {
    /// Angle of the chord from the clamp to the tip, degrees, positive downwards; none for a body without a centreline.
    pub fn chord_angle_deg(&self) -> Option<f64> {
        measures::angle_of_chord_deg(&self.centreline)
    }
}

impl Step {
    /// The time of the load path: the air pressure in kPa of an actuator. NaN where the file gives neither.
    pub fn when(&self) -> f64 {
        self.time.or(self.pressure_kpa).unwrap_or(f64::NAN)
    }
}

impl Summary {
    /// Whether every requested pressure or time was reached.
    pub fn is_converged(&self) -> bool {
        self.status == "converged"
    }

    /// The pressures (kPa) or times that were reached with what was found there, those on the way at the end.
    pub fn reached(&self) -> impl Iterator<Item = (f64, &Reached)> {
        self.steps.iter().chain(&self.on_the_way).filter_map(|step| Some((step.when(), step.reached.as_ref()?)))
    }

    /// Whether the path was followed to its end, past limit points.
    pub fn is_past_limit(&self) -> bool {
        self.status == "past-limit"
    }

    /// Whether the load parameter turned back along the path.
    pub fn has_turned(&self) -> bool {
        self.steps.iter().any(|step| step.kind != StateKind::Requested)
    }

    /// The warnings; those that older versions attached to steps if there is no list of them.
    pub fn all_warnings(&self) -> Vec<Warning> {
        let of_step = |(pressure, reached): (f64, &Reached)| {
            let message = reached.warning.clone()?;
            Some(Warning { pressure_kpa: Some(pressure), time: None, message, advice: String::new() })
        };
        self.warnings.clone().unwrap_or_else(|| self.reached().filter_map(of_step).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn a_pressure_that_was_missed_has_nothing_to_show() {
        let mut value = testing::summary_json(&[5.0]);
        let missed = serde_json::json!({"pressure_kpa": 9.0, "converged": false, "iterations": 4});
        value["steps"].as_array_mut().unwrap().push(missed);
        let summary: Summary = serde_json::from_value(value).unwrap();
        assert_eq!((summary.steps.len(), summary.reached().count()), (2, 1));
        assert_eq!(summary.steps[1].iterations, 4);
        assert_eq!((summary.format, summary.steps[0].when()), (1, 5.0));
    }

    #[test]
    fn states_on_the_way_come_after_the_requested_ones() {
        let mut value = testing::summary_json(&[5.0, 7.5]);
        let on_the_way = value["steps"].as_array_mut().unwrap().pop().unwrap();
        value["on_the_way"] = serde_json::json!([on_the_way]);
        value["steps"].as_array_mut().unwrap().push(serde_json::json!({"time": 9.0, "converged": false}));
        let summary: Summary = serde_json::from_value(value).unwrap();
        assert_eq!(summary.reached().map(|(when, _)| when).collect::<Vec<_>>(), [5.0, 7.5]);
        assert_eq!((summary.steps[1].when(), summary.steps[1].pressure_kpa), (9.0, None));
    }

    #[test]
    fn the_older_warnings_are_shown_only_without_the_newer() {
        let mut value = testing::summary_json(&[5.0]);
        value["steps"][0]["warning"] = "old".into();
        let read = |value: &serde_json::Value| -> Vec<String> {
            let summary: Summary = serde_json::from_value(value.clone()).unwrap();
            summary.all_warnings().into_iter().map(|w| w.message).collect()
        };
        assert_eq!(read(&value), ["old"]);
        value["warnings"] =
            serde_json::json!([{"kind": "unstable", "pressure_kpa": null, "message": "new", "advice": "a"}]);
        assert_eq!(read(&value), ["new"]);
    }
}
