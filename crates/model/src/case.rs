//! The case file of an actuator, with defaults and range checks.

use pneuflex_mesh::{Actuator, PerChamber};
use serde::{Deserialize, Serialize};

use crate::choice::Choice;
use crate::material::Material;
use crate::number::rounded;
use crate::obstacle_table::{self, ObstacleTable};
use crate::options::{self, Contact, ContactMethod, Continuation, Load, MeshOptions, Output, Probe, Solver};
use crate::range_check::{CaseError, Problems, Quantity};

/// A whole case file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Written")]
pub struct Case {
    /// Title, repeated in the output.
    pub title: String,
    /// Geometry; every length is required.
    pub actuator: Actuator,
    /// Mesh size and element.
    pub mesh: MeshOptions,
    /// Material law and constants.
    pub material: Material,
    /// Contact between neighbouring chambers.
    pub contact: Contact,
    /// Rigid bodies in the way.
    #[serde(rename = "obstacle", skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<ObstacleTable>,
    /// Pressures to land on.
    pub load: Load,
    /// Points whose displacement is reported.
    #[serde(rename = "probe", skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// Solver settings.
    pub solver: Solver,
    /// What is written.
    pub output: Output,
}

/// Sets of an actuator's faces that may touch an obstacle; the first one if nothing is said.
const FACES: [&str; 3] = ["outer", "bottom", "end_face"];

impl Case {
    /// The same with every default of the mesh written out.
    pub fn resolved(&self) -> Self {
        Self { mesh: self.mesh.resolved(&self.actuator), ..self.clone() }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// The first key that is out of range; [`Self::problems`] has all.
    pub fn validate(&self) -> Result<(), CaseError> {
        self.problems().into_iter().next().map_or(Ok(()), Err)
    }

    /// Every key whose value is out of range, table by table.
    pub fn problems(&self) -> Vec<CaseError> {
        let mut found = Problems(self.actuator.problems().into_iter().map(CaseError::from).collect());
        self.mesh.check(&mut found);
        self.output.check(&mut found);
        found.0.extend(self.material.problems("material"));
        found.unless_positive("contact.stiffness", self.contact.stiffness, Quantity::Stiffness);
        if let Some(tolerance) = self.contact.penetration_tolerance {
            found.unless_positive("contact.penetration_tolerance", tolerance, Quantity::Tolerance);
        }
        let is_single = self.contact.method == ContactMethod::SinglePoint;
        for (key, is_asked) in
            [("contact.two_pass", self.contact.two_pass), ("contact.self_contact", self.contact.self_contact)]
        {
            if is_asked && is_single {
                found.add(key, &true, "is not for contact.method = \"single-point\"");
            }
        }
        obstacle_table::check(&self.obstacles, &mut found);
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            let key = format!("obstacle[{i}].faces");
            match &obstacle.faces {
                Some(Choice::Named(faces)) if !FACES.contains(&faces.as_str()) => {
                    found.add(&key, faces, &format!("must be one of {}", FACES.join(", ")));
                }
                faces => faces.iter().for_each(|faces| faces.check(&key, &mut found)),
            }
            let moves = [("displacement", obstacle.displacement.is_some()), ("factor", obstacle.factor.is_some())];
            for (key, _) in moves.into_iter().filter(|(_, is_given)| *is_given) {
                let allowed = "is for model files: obstacles of an actuator stay where they are";
                found.add(&format!("obstacle[{i}].{key}"), &"something", allowed);
            }
        }
        self.check_load_and_probes(&mut found);
        self.solver.check(&mut found);
        found.0
    }

    fn check_load_and_probes(&self, found: &mut Problems) {
        let pressures = &self.load.pressure_kpa;
        let increasing = pressures.windows(2).all(|w| w[0] < w[1]);
        let [least, most] = Quantity::Pressure.range();
        if pressures.is_empty() || !pressures.iter().all(|p| (least..=most).contains(p)) || !increasing {
            let allowed = "must be a non-empty, strictly increasing list of finite pressures greater than 0 kPa";
            found.add("load.pressure_kpa", pressures, &format!("{allowed}, from {least:e} to {most:e}"));
        }
        self.check_chamber_factor(found);
        options::check_probes(&self.probes, found);
    }

    fn check_chamber_factor(&self, found: &mut Problems) {
        const KEY: &str = "load.chamber_factor";
        let Some(factor) = &self.load.chamber_factor else { return };
        let chambers = self.actuator.chambers;
        let text = match factor {
            PerChamber::All(value) => format!("{value:?}"),
            PerChamber::Each(list) => format!("{list:?}"),
        };
        let mut complain = |key: &str, value: String, allowed: String| {
            found.0.push(CaseError { key: key.into(), value, allowed });
        };
        if self.actuator.has_channel() {
            let allowed = "the channel joins the cavities, and their air has one pressure: set actuator.channel.half_width = 0 for chambers with air \
                           of their own, or leave it out";
            return complain(KEY, text, allowed.into());
        }
        if let PerChamber::Each(list) = factor
            && list.len() != chambers
        {
            let entries = if chambers == 1 { "entry" } else { "entries" };
            let allowed = format!(
                "must be a number, or a list with {chambers} {entries}, one for each of {chambers} chambers: this one has {}",
                list.len()
            );
            return complain(KEY, text, allowed);
        }
        let mut is_finite = true;
        for (key, value) in factor.keyed(KEY).filter(|(_, value)| !Quantity::Factor.allows(*value)) {
            is_finite = false;
            let [least, most] = Quantity::Factor.range();
            let allowed = format!(
                "must be a factor of the pressure: a finite number, 0 or from {least:e} to {most:e}, negative for a vacuum"
            );
            complain(&key, format!("{value:?}"), allowed);
        }
        if is_finite && factor.entries().iter().all(|value| *value == 0.0) {
            complain(KEY, text, "must not be 0 for all chambers: nothing would be inflated".into());
        }
    }
}

/// The case file as it is written: keys whose defaults follow from other keys are left open.
#[derive(Deserialize)]
#[serde(rename = "Case", deny_unknown_fields)]
struct Written {
    #[serde(default)]
    title: String,
    actuator: Actuator,
    #[serde(default)]
    mesh: MeshOptions,
    #[serde(default)]
    material: Material,
    #[serde(default)]
    contact: WrittenContact,
    #[serde(default, rename = "obstacle")]
    obstacles: Vec<ObstacleTable>,
    load: Load,
    #[serde(default, rename = "probe")]
    probes: Vec<Probe>,
    #[serde(default)]
    solver: WrittenSolver,
    #[serde(default)]
    output: Output,
}

#[derive(Deserialize)]
#[serde(rename = "Contact", deny_unknown_fields, default)]
struct WrittenContact {
    method: ContactMethod,
    stiffness: Option<f64>,
    two_pass: bool,
    self_contact: bool,
    penetration_tolerance: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename = "Solver", deny_unknown_fields, default)]
struct WrittenSolver {
    tolerance: f64,
    residual_tolerance: f64,
    max_iterations: usize,
    first_step_kpa: f64,
    max_step_kpa: f64,
    min_step_kpa: Option<f64>,
    continuation: Continuation,
    states_past_limit: usize,
    imperfection: Option<f64>,
}

impl Default for WrittenSolver {
    fn default() -> Self {
        let default = Solver::default();
        Self {
            tolerance: default.tolerance,
            residual_tolerance: default.residual_tolerance,
            max_iterations: default.max_iterations,
            first_step_kpa: default.first_step,
            max_step_kpa: default.max_step,
            min_step_kpa: None,
            continuation: default.continuation,
            states_past_limit: default.states_past_limit,
            imperfection: None,
        }
    }
}

impl Default for WrittenContact {
    fn default() -> Self {
        let Contact { method, two_pass, self_contact, penetration_tolerance, .. } = Contact::default();
        Self { method, stiffness: None, two_pass, self_contact, penetration_tolerance }
    }
}

impl From<Written> for Case {
    fn from(written: Written) -> Self {
        let Written { title, actuator, mesh, material, contact, mut obstacles, load, probes, solver, output } = written;
        let stiffness = contact.stiffness.unwrap_or_else(|| Contact::of_actuator(&material, &actuator).stiffness);
        let min_step = solver.min_step_kpa.unwrap_or_else(|| default_min_step(&load, solver.max_step_kpa));
        let solver = Solver {
            tolerance: solver.tolerance,
            residual_tolerance: solver.residual_tolerance,
            max_iterations: solver.max_iterations,
            first_step: solver.first_step_kpa,
            max_step: solver.max_step_kpa,
            min_step,
            continuation: solver.continuation,
            states_past_limit: solver.states_past_limit,
            imperfection: solver.imperfection,
        };
        for obstacle in &mut obstacles {
            obstacle.stiffness.get_or_insert(stiffness);
            obstacle.faces.get_or_insert_with(|| "outer".into());
        }
        let WrittenContact { method, two_pass, self_contact, penetration_tolerance, .. } = contact;
        Self {
            title,
            mesh,
            material,
            contact: Contact { method, stiffness, two_pass, self_contact, penetration_tolerance },
            actuator,
            obstacles,
            load,
            probes,
            solver,
            output,
        }
    }
}

/// Smallest load step, kPa: small beside the pressures of soft materials, too.
fn default_min_step(load: &Load, max_step_kpa: f64) -> f64 {
    let last = load.pressure_kpa.iter().copied().fold(0.0, f64::max);
    let default = Solver::default().min_step;
    let small = if last > 0.0 && last.is_finite() {
        rounded(last / 5000.0).max(Quantity::Pressure.range()[0]).min(default)
    } else {
        default
    };
    if max_step_kpa > 0.0 { small.min(max_step_kpa) } else { small }
}
