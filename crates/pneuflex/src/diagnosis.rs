//! What to be careful about in results, in the words of somebody who designs actuators.

use std::fmt;

use pneuflex_mesh::Actuator;
use pneuflex_model::{Clock, ContactMethod, ContactPair, MeshOptions, Problem, Resolution, StateKind};
use pneuflex_post::summary::{SnapSummary, StepSummary};
use serde::Serialize;

use crate::accuracy::{Expected, Fineness, Outside, Parameter, expected};
use crate::advice::Occasion;
use crate::held_in_obstacle;
use crate::vocabulary::Vocabulary;
use crate::words::plural;

/// Walls that pass through each other further than this share of the thinnest wall are worth a warning.
const PENETRATION_SHARE: f64 = 0.01;

/// An end face that turns by less than this, degrees, and a tip that moves by less than this share of the actuator's length: nobody builds
/// an actuator for that.
const LEAST_ANGLE: f64 = 0.5;
const LEAST_TIP: f64 = 0.01;

/// Share of elements with two opposite faces on the surface of a body from which on it is made of walls of one element.
const SINGLE_LAYERS: f64 = 0.25;

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
    /// What the advice was given for.
    #[serde(skip)]
    pub occasion: Occasion,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "warning: {}\n  what to do: {}", self.message, self.advice)
    }
}

/// Kinds of warnings; their names are part of `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WarningKind {
    /// The material is stretched beyond where its constants have stiffness left.
    MaterialLimit,
    /// The material is stretched further than the tests that its constants were fitted to.
    BeyondFit,
    /// Walls of neighbouring chambers pass through each other.
    Penetration,
    /// The body has curled so far that parts may overlap between which no contact is modelled.
    Overlap,
    /// The mesh is too coarse to rely on the numbers.
    CoarseMesh,
    /// The actuator is unlike those on which the errors of its mesh were measured.
    Accuracy,
    /// Elements are unstable where a finer mesh is not.
    MeshInstability,
    /// Elements are badly shaped.
    ElementShape,
    /// Something stands for two: itself and its mirror image.
    Symmetry,
    /// A probe is beside the body.
    Probe,
    /// A number looks as if it were in another unit.
    Units,
    /// The load parameter has a greatest value, beyond which the path was followed.
    LimitPoint,
    /// The body buckles, and the path was led along the softest motion.
    Bifurcation,
    /// The body snaps to another equilibrium under the same loads.
    Snap,
    /// A load step leads much further than predicted: the body may have snapped.
    Jump,
}

/// What results are about.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// What was solved.
    pub problem: &'a Problem,
    /// Lengths and mesh, if it is an actuator.
    pub actuator: Option<(&'a Actuator, &'a MeshOptions)>,
    /// What it was written in.
    pub vocabulary: Vocabulary,
}

/// What to be careful about in results.
pub fn warnings(subject: Subject<'_>, steps: &[StepSummary]) -> Vec<Warning> {
    let mut found = Vec::new();
    let mut add = |kind, at: Option<&StepSummary>, message: String, occasion: Occasion| {
        let time = at.and_then(|step| step.time);
        let pressure_kpa = at.filter(|step| step.time.is_none()).map(|step| step.pressure_kpa);
        let advice = subject.vocabulary.advice(occasion, subject.problem);
        found.push(Warning { kind, pressure_kpa, time, message, advice, occasion });
    };
    let when = |step: &StepSummary| subject.problem.clock.words(step.when());
    // A warning is headed by where it begins; its numbers are those of where it is worst.
    let since = |first: &StepSummary, worst: &StepSummary| {
        let begins = if first.when() == worst.when() { String::new() } else { format!("from {} on; ", when(first)) };
        format!("{begins}at {} ", when(worst))
    };
    if let (Some(first), Some(worst)) = first_and_last(steps, |step| step.warning.is_some()) {
        let message = worst.warning.clone().unwrap_or_default();
        let message = format!("{}{message}; what lies beyond is no measured behaviour", since(first, worst));
        add(WarningKind::MaterialLimit, Some(first), message, Occasion::BeyondConstants);
    }
    if let (Some(first), Some(worst)) = first_and_last(steps, |step| step.beyond_fit.is_some()) {
        let message = format!("{}{}", since(first, worst), worst.beyond_fit.as_deref().unwrap_or_default());
        add(WarningKind::BeyondFit, Some(first), message, Occasion::BeyondConstants);
    }
    if let (Some(first), _) = first_and_last(steps, |step| step.mesh_instability.is_some()) {
        let message = format!(
            "at {} {}; what lies beyond is not to be relied on",
            when(first),
            first.mesh_instability.clone().unwrap_or_default()
        );
        add(WarningKind::MeshInstability, Some(first), message, Occasion::UnstableElements);
    }
    if let (Some(first), _) = first_and_last(steps, |step| step.kind == StateKind::GreatestLoad) {
        add(WarningKind::LimitPoint, Some(first), past_limit(subject, first, steps), Occasion::PastLimit);
    }
    if let (Some(first), _) = first_and_last(steps, |step| !step.bifurcations.is_empty()) {
        add(WarningKind::Bifurcation, Some(first), buckled(subject, steps), Occasion::Buckled);
    }
    for (in_load_step, kind, occasion) in
        [(false, WarningKind::Snap, Occasion::Snapped), (true, WarningKind::Jump, Occasion::Jumped)]
    {
        let is_one = |snap: &&SnapSummary| snap.in_load_step == in_load_step;
        if let (Some(first), _) = first_and_last(steps, |step| step.snaps.iter().any(|snap| is_one(&snap))) {
            let words: fn(Subject<'_>, &[&SnapSummary]) -> String = if in_load_step { jumped } else { snapped };
            let all: Vec<&SnapSummary> = steps.iter().flat_map(|step| &step.snaps).filter(is_one).collect();
            add(kind, Some(first), words(subject, &all), occasion);
        }
    }
    if let (Some(first), Some(worst)) = first_and_last(steps, |step| step.unmet_tolerance.is_some()) {
        let message = format!(
            "{}walls press into each other by more than contact.penetration_tolerance: {}",
            since(first, worst),
            worst.unmet_tolerance.as_deref().unwrap_or_default()
        );
        add(WarningKind::Penetration, Some(first), message, Occasion::UnmetTolerance);
    }
    if let Some((thickness, of)) = touched_thickness(subject) {
        let is_deep = |step: &StepSummary| deepest(step) > PENETRATION_SHARE * thickness;
        let worst = steps.iter().max_by(|a, b| deepest(a).total_cmp(&deepest(b)));
        if let (Some(first), Some(worst)) = (steps.iter().find(|step| is_deep(step)), worst) {
            let message = format!(
                "{}what touches passes through each other by {:.3} mm, {:.1} % of {of}, {thickness:.3} mm",
                since(first, worst),
                deepest(worst),
                100.0 * deepest(worst) / thickness
            );
            let held = held_in_obstacle::depth(subject.problem, worst.when());
            let occasion = match subject.problem.contact.method {
                // No stiffness takes that out.
                _ if held > deepest(worst) => Occasion::HeldInObstacle,
                _ if deepest(worst) > worst.contact.max_penetration_mm => Occasion::DeepObstacle,
                _ if has_averaged_gaps(subject.problem) => Occasion::DeepAverages,
                ContactMethod::MultiPoint | ContactMethod::Mortar => Occasion::DeepContact,
                ContactMethod::None | ContactMethod::SinglePoint => Occasion::NoContact,
            };
            add(WarningKind::Penetration, Some(first), message, occasion);
        }
    }
    let is_watched = subject.problem.contact_pairs.iter().any(ContactPair::is_self);
    if let (Some(first), _) =
        first_and_last(steps, |step| step.end_face_angle_deg.is_some_and(|angle| angle.abs() > 360.0))
        && !is_watched
    {
        let message = "the body has curled through more than a full turn; other parts than those between which contact is modelled may \
                       overlap: look at the shape before relying on it";
        add(WarningKind::Overlap, Some(first), message.into(), Occasion::Overlap);
    }
    let expected = subject.actuator.map(|(actuator, mesh)| expected(subject.problem, actuator, mesh, steps));
    if let Some((message, occasion)) = coarse_mesh(subject, expected.as_ref()) {
        add(WarningKind::CoarseMesh, None, message, occasion);
    }
    if let Some(expected) = &expected
        && let Some(message) = unmeasured(subject, expected)
    {
        let first = expected.since().and_then(|since| steps.iter().find(|step| step.when() == since));
        add(WarningKind::Accuracy, first, message, Occasion::Unmeasured);
    }
    if let Some((actuator, _)) = subject.actuator
        && subject.problem.obstacles.is_empty()
        && let Some(last) = steps.last().filter(|last| hardly_moves(actuator, last))
    {
        let message = format!(
            "the actuator hardly bends: at {} its end face turns by {:.3} degrees",
            when(last),
            last.end_face_angle_deg.unwrap_or_default()
        );
        add(WarningKind::Units, Some(last), message, Occasion::HardlyMoves);
    }
    found
}

/// What is said of a path that was followed past a limit point.
fn past_limit(subject: Subject<'_>, limit: &StepSummary, steps: &[StepSummary]) -> String {
    let clock = subject.problem.clock;
    let others: String = (steps.iter().filter(|step| step.kind.is_limit_point() && step.when() != limit.when()))
        .map(|step| format!(", then a {} one at {}", extreme(step), limit_words(clock, step)))
        .collect();
    let beyond = steps.iter().filter(|step| step.kind == StateKind::PastLimit).count();
    format!(
        "limit point at {}: the loads have a {} value there{others}; {} beyond are on the path past it, where the body would snap if the \
         loads kept their values",
        limit_words(clock, limit),
        extreme(limit),
        plural(beyond, "state"),
    )
}

/// What is said of a body that buckled and was followed.
fn buckled(subject: Subject<'_>, steps: &[StepSummary]) -> String {
    let places: Vec<String> = (steps.iter().flat_map(|step| &step.bifurcations))
        .map(|left| {
            let [x, y, z] = left.near_mm;
            let at = subject.problem.clock.words(left.at);
            format!("beyond {at}, most near ({x:.1}, {y:.1}, {z:.1}) mm (pushed by {:.3} mm)", left.pushed_mm)
        })
        .collect();
    format!(
        "the body buckles {}; the results beyond are those of one of the shapes that it may take, its motions are in fields/mode_*.vtu",
        places.join(", then ")
    )
}

/// What is said of a body that snapped.
fn snapped(subject: Subject<'_>, snaps: &[&SnapSummary]) -> String {
    let jumps: Vec<String> = (snaps.iter())
        .map(|snap| {
            let [x, y, z] = snap.near_mm;
            let at = subject.problem.clock.words(snap.at);
            let energy = snap.released_mj.map_or(String::new(), |released| format!(", giving up {released:.2e} mJ"));
            format!("at {at}, by {:.3} mm near ({x:.1}, {y:.1}, {z:.1}) mm{energy}", snap.moved_mm)
        })
        .collect();
    format!(
        "the body snaps {}; between there is no state at which it stays, and with little damping a real body may swing on to another one",
        jumps.join(", then ")
    )
}

/// What is said of load steps that may be snaps.
fn jumped(subject: Subject<'_>, snaps: &[&SnapSummary]) -> String {
    let jumps: Vec<String> = (snaps.iter())
        .map(|snap| {
            let [x, y, z] = snap.near_mm;
            let [at, to] = [snap.at, snap.to].map(|at| subject.problem.clock.words(at));
            format!("from {at} to {to}, by {:.3} mm near ({x:.1}, {y:.1}, {z:.1}) mm", snap.moved_mm)
        })
        .collect();
    format!(
        "the body jumps {}, in a step that is more than twice as long as the stiffness at its beginning and at its end predict; it may snap there, \
         and what lies beyond may be another one of several equilibria",
        jumps.join(", then ")
    )
}

fn extreme(step: &StepSummary) -> &'static str {
    if step.kind == StateKind::LeastLoad { "least" } else { "greatest" }
}

/// Where a limit point is: the pressure, for a model beside the time.
pub fn limit_words(clock: Clock, step: &StepSummary) -> String {
    match clock {
        Clock::Steps if step.pressure_kpa != 0.0 => {
            format!("{:.4} kPa ({})", step.pressure_kpa, clock.words(step.when()))
        }
        Clock::Pressure | Clock::Steps => clock.words(step.when()),
    }
}

/// Whether gaps between surfaces are averaged anywhere: what is left of their depth within a face does not follow the stiffness then.
fn has_averaged_gaps(problem: &Problem) -> bool {
    let mut methods = problem.contact_pairs.iter().map(|pair| pair.method.unwrap_or(problem.contact.method));
    methods.any(|method| method == ContactMethod::Mortar)
}

/// Largest depth of what touches at a state, mm.
fn deepest(step: &StepSummary) -> f64 {
    let obstacles = step.obstacles.values().map(|obstacle| obstacle.max_penetration_mm);
    obstacles.fold(step.contact.max_penetration_mm, f64::max)
}

/// What depths of penetration are compared with, mm, and what it is: the thinnest wall of an actuator, of other bodies the least thickness
/// of an element behind a face that may touch something.
fn touched_thickness(subject: Subject<'_>) -> Option<(f64, &'static str)> {
    if let Some((actuator, _)) = subject.actuator {
        return Some((actuator.thinnest_wall(), "the thinnest wall"));
    }
    let Problem { mesh, contact_pairs, obstacles, .. } = subject.problem;
    let pairs = contact_pairs.iter().flat_map(|pair| [&pair.slave, &pair.master]);
    let facets = pairs.chain(obstacles.iter().map(|obstacle| &obstacle.facets)).flatten();
    let thickness = facets.map(|&facet| mesh.thickness_behind(facet)).fold(f64::INFINITY, f64::min);
    (thickness.is_finite() && thickness > 0.0).then_some((thickness, "the thinnest element there"))
}

/// Whether air in an actuator does next to nothing.
fn hardly_moves(actuator: &Actuator, step: &StepSummary) -> bool {
    let length = actuator.length();
    let tip = step.centreline.last().map_or(f64::INFINITY, |[x, z]| (x - length).hypot(*z));
    let angle = step.end_face_angle_deg.map_or(f64::INFINITY, f64::abs);
    step.pressure_kpa > 0.0 && angle < LEAST_ANGLE && tip < LEAST_TIP * length
}

fn coarse_mesh(subject: Subject<'_>, expected: Option<&Expected>) -> Option<(String, Occasion)> {
    let too_stiff = "one linear element across the thinnest wall bends too stiffly: displacements come out several per cent too small";
    let is_linear = !subject.problem.formulation.element.is_quadratic();
    let (Some((actuator, mesh)), Some(expected)) = (subject.actuator, expected) else {
        let message = || (too_stiff.replace("the thinnest wall", "a wall"), Occasion::LinearElements);
        return (is_linear && subject.problem.mesh.share_of_single_layers() > SINGLE_LAYERS).then(message);
    };
    if is_linear {
        let size = mesh.mesh_size(actuator);
        let across = actuator.thinnest_wall() / size.size.into_iter().fold(0.0, f64::max).min(size.edge);
        let message = || (too_stiff.into(), Occasion::LinearElements);
        return (across.max(size.wall_elements as f64) < 1.5).then(message);
    }
    let which = match expected.fineness {
        Some(Fineness::Standard | Fineness::Fine) => return None,
        Some(Fineness::Draft) if mesh.resolution == Some(Resolution::Draft) => "the draft mesh",
        Some(Fineness::Draft) => "a mesh as coarse as draft",
        None => "a mesh coarser than draft",
    };
    let errors = match expected.bounds() {
        Some(bounds) => format!("on designs like this one its errors are up to {bounds}"),
        None => "its errors may be large".to_owned(),
    };
    Some((format!("{which} is for trying things out: {errors}"), Occasion::CoarseMesh))
}

/// In what an actuator is unlike those on which errors were measured.
fn unmeasured(subject: Subject<'_>, expected: &Expected) -> Option<String> {
    let words = |outside: &Outside| match outside.when {
        Some(when) => format!("at {} {}", subject.problem.clock.words(when), outside.what),
        None => outside.what.clone(),
    };
    let is_linear = !subject.problem.formulation.element.is_quadratic();
    // Linear elements are known to be less exact, and have a word of their own where they are too few.
    let is_news =
        |outside: &&Outside| !(is_linear && matches!(outside.parameter, Parameter::Element | Parameter::Mesh));
    let what: Vec<String> = expected.outside.iter().filter(is_news).map(words).collect();
    let message = format!(
        "errors may be larger than those that were measured for this mesh, because the design is unlike the measured ones: {}; compare two \
         meshes before relying on numbers",
        what.join("; ")
    );
    (!what.is_empty()).then_some(message)
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
    use pneuflex_model::Case;

    fn case(change: &str) -> Case {
        toml::from_str(&crate::template::two_chambers().replace("resolution = \"standard\"", change)).unwrap()
    }

    #[test]
    fn meshes_are_warned_about() {
        let kinds = |change: &str| -> Vec<_> {
            let case = case(change);
            let problem = Problem::from_case(&case).unwrap();
            let actuator = Some((&case.actuator, &case.mesh));
            let subject = Subject { problem: &problem, actuator, vocabulary: Vocabulary::CaseFile };
            warnings(subject, &[]).into_iter().map(|w| w.kind).collect()
        };
        assert_eq!(kinds("resolution = \"draft\""), [WarningKind::CoarseMesh]);
        assert_eq!(kinds("resolution = \"standard\""), []);
        assert_eq!(kinds("resolution = \"standard\"\nelement = \"hex20\""), [WarningKind::Accuracy]);
        assert_eq!(kinds("size = 5.0"), [WarningKind::CoarseMesh, WarningKind::Accuracy]);
        assert_eq!(kinds("size = 2.0\nelement = \"hex8-q1p0\""), [WarningKind::CoarseMesh]);
        assert_eq!(kinds("size = 0.5\nelement = \"hex8-q1p0\""), []);
    }
}
