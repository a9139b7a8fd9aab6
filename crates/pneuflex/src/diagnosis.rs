//! What to be careful about in results, in the words of somebody who designs actuators.

use pneuflex_model::{Case, Clock, ContactMethod, Resolution};
use pneuflex_post::summary::StepSummary;
use serde::Serialize;

/// Walls that pass through each other further than this share of the thinnest wall are worth a warning.
const PENETRATION_SHARE: f64 = 0.1;

/// Something to be careful about in results that were reached.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// Short name.
    pub kind: WarningKind,
    /// First requested pressure at which it holds, kPa; left out if it holds for the whole run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_kpa: Option<f64>,
    /// The same as a time, for models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// What is to be known.
    pub message: String,
    /// What to do about it.
    pub advice: String,
}

/// Kinds of warnings; their names are part of `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WarningKind {
    /// The material is stretched beyond where its constants have stiffness left.
    MaterialLimit,
    /// Walls of neighbouring chambers pass through each other.
    Penetration,
    /// The body has curled so far that parts may overlap between which no contact is modelled.
    Overlap,
    /// The mesh is too coarse to rely on the numbers.
    CoarseMesh,
    /// Elements are unstable where a finer mesh is not.
    MeshInstability,
}

/// What to be careful about in results; `case` is that of an actuator.
pub fn warnings(clock: Clock, case: Option<&Case>, steps: &[StepSummary]) -> Vec<Warning> {
    let mut found = Vec::new();
    let mut add = |kind, at: Option<&StepSummary>, message: String, advice: &str| {
        let time = at.and_then(|step| step.time);
        let pressure_kpa = at.filter(|step| step.time.is_none()).map(|step| step.pressure_kpa);
        found.push(Warning { kind, pressure_kpa, time, message, advice: advice.into() });
    };
    let when = |step: &StepSummary| clock.words(step.when());
    if let (Some(first), Some(worst)) = first_and_last(steps, |step| step.warning.is_some()) {
        let message = worst.warning.clone().unwrap_or_default();
        let advice = "what lies beyond is no measured behaviour; use constants that were fitted to larger stretches";
        add(WarningKind::MaterialLimit, Some(first), format!("at {} {message}", when(worst)), advice);
    }
    if let (Some(first), _) = first_and_last(steps, |step| step.mesh_instability.is_some()) {
        let message = format!("at {} {}", when(first), first.mesh_instability.clone().unwrap_or_default());
        let advice = "use quadratic elements or a finer mesh before relying on what lies beyond";
        add(WarningKind::MeshInstability, Some(first), message, advice);
    }
    let Some(case) = case else { return found };
    let thinnest = case.actuator.thinnest_wall();
    let is_deep = |step: &StepSummary| step.contact.max_penetration_mm > PENETRATION_SHARE * thinnest;
    if let (Some(first), Some(last)) = first_and_last(steps, is_deep) {
        let message = format!(
            "walls of neighbouring chambers pass through each other by {:.3} mm at {} kPa; the thinnest wall has {thinnest:.3} mm",
            last.contact.max_penetration_mm, last.pressure_kpa
        );
        let advice = match case.contact.method {
            ContactMethod::None => "contact is switched off: set contact.method to multi-point".into(),
            ContactMethod::SinglePoint => {
                "single-point contact lets walls through: set contact.method to multi-point".into()
            }
            ContactMethod::MultiPoint => format!("raise contact.stiffness, which is {}", case.contact.stiffness),
        };
        add(WarningKind::Penetration, Some(first), message, &advice);
    }
    if let (Some(first), _) =
        first_and_last(steps, |step| step.end_face_angle_deg.is_some_and(|angle| angle.abs() > 360.0))
    {
        let message = "the body has curled through more than a full turn; contact is modelled between neighbouring chambers only, other \
                       parts may overlap";
        add(WarningKind::Overlap, Some(first), message.into(), "look at the shape before relying on it");
    }
    if let Some((message, advice)) = coarse_mesh(case) {
        add(WarningKind::CoarseMesh, None, message, advice);
    }
    found
}

fn coarse_mesh(case: &Case) -> Option<(String, &'static str)> {
    let advice = "use mesh.resolution = \"standard\" or \"fine\" before relying on numbers; `pneuflex converge` gives error bars";
    let mesh = &case.mesh;
    if mesh.resolution == Some(Resolution::Draft) && mesh.size.is_none() && mesh.edge_size.is_none() {
        let message = "the draft mesh is for trying things out: expect errors of about 1 % in displacements, and larger ones in stresses";
        return Some((message.into(), advice));
    }
    let is_linear = !mesh.formulation().element.is_quadratic();
    let size = mesh.mesh_size(&case.actuator);
    let across = case.actuator.thinnest_wall() / size.size.into_iter().fold(0.0, f64::max).min(size.edge);
    (is_linear && across.max(size.wall_elements as f64) < 1.5).then(|| {
        let message = "one linear element across the thinnest wall bends too stiffly: displacements come out several per cent too small";
        (message.into(), advice)
    })
}

fn first_and_last(
    steps: &[StepSummary],
    holds: impl Fn(&StepSummary) -> bool,
) -> (Option<&StepSummary>, Option<&StepSummary>) {
    let mut those = steps.iter().filter(|step| holds(step));
    let first = those.next();
    (first, those.last().or(first))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(change: &str) -> Case {
        toml::from_str(&crate::template::two_chambers().replace("resolution = \"standard\"", change)).unwrap()
    }

    #[test]
    fn meshes_are_warned_about() {
        let kinds = |change: &str| -> Vec<_> {
            let case = case(change);
            warnings(Clock::Pressure, Some(&case), &[]).into_iter().map(|w| w.kind).collect()
        };
        assert_eq!(kinds("resolution = \"draft\""), [WarningKind::CoarseMesh]);
        assert_eq!(kinds("resolution = \"standard\""), []);
        assert_eq!(kinds("size = 2.0\nelement = \"hex8-q1p0\""), [WarningKind::CoarseMesh]);
        assert_eq!(kinds("size = 0.5\nelement = \"hex8-q1p0\""), []);
    }
}
