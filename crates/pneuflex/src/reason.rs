//! Why a run ended early, in the words of somebody who designs actuators, and what helps.

use pneuflex_model::load::Load;
use pneuflex_model::{Control, LoadParameter, Problem};
use pneuflex_newton::{Cause, Failure, UnstableMotions, loose_parts};
use pneuflex_post::stress::{first_largest, recover};
use serde::Serialize;

use crate::advice::Occasion;
use crate::held_in_obstacle;
use crate::holding;
use crate::vocabulary::Vocabulary;

/// A body that somewhere stretches this much more per change of the load than at the beginning is at a limit point.
const LIMIT_POINT: f64 = 10.0;

/// Why a run ended early.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reason {
    /// Short name.
    pub kind: ReasonKind,
    /// Whether the reason lies in the design, and not in how it was computed.
    pub is_physical: bool,
    /// What happened.
    pub message: String,
    /// What to try.
    pub advice: String,
    /// What the advice was given for.
    #[serde(skip)]
    pub occasion: Occasion,
}

/// Kinds of reasons; their names are part of `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReasonKind {
    /// The material is stretched beyond where its constants have stiffness left.
    MaterialLimit,
    /// The equilibrium becomes unstable: buckling, ballooning, snap-through.
    Instability,
    /// The equilibrium becomes unstable by a motion that elements have, and a body has not.
    MeshInstability,
    /// An element turns inside out.
    InvertedElement,
    /// Only contact holds a part of the body, and it does not.
    NotHeld,
    /// Contact does not settle: walls touch and part in turn.
    WallsCross,
    /// An obstacle is in what supports hold.
    HeldInObstacle,
    /// There is not enough memory.
    OutOfMemory,
    /// A tolerance of the residual is below the rounding.
    Rounding,
    /// Newton's method does not converge for a reason that was not found.
    NotConverged,
}

/// Why a path ended, from its failure and the displacements (mm, three per node) of the last equilibrium, with advice in terms of the file
/// that it was written in; `None` for one that was interrupted.
pub fn explain(
    problem: &Problem,
    vocabulary: Vocabulary,
    failure: &Failure,
    displacement: &[[f64; 3]],
) -> Option<Reason> {
    let end = End { problem, vocabulary, failure, displacement };
    match &failure.cause {
        Cause::Interrupted => None,
        Cause::OutOfMemory(error) => Some(end.out_of_memory(error)),
        Cause::Rounding { .. } => Some(end.rounding()),
        // What is wrong with the equations is all there is to say.
        Cause::Setup(_) | Cause::Resume(_) | Cause::Contradiction => Some(end.not_solvable()),
        _ => Some(
            end.material_limit()
                .or_else(|| end.not_held())
                .or_else(|| end.past_limit())
                .or_else(|| end.unstable())
                .or_else(|| end.held_in_obstacle())
                .or_else(|| end.limit_point())
                .or_else(|| end.passed_through())
                .or_else(|| end.chatter())
                .or_else(|| end.inverted())
                .unwrap_or_else(|| end.unclear()),
        ),
    }
}

/// The end of a path, and what is looked at to explain it.
struct End<'a> {
    problem: &'a Problem,
    vocabulary: Vocabulary,
    failure: &'a Failure,
    displacement: &'a [[f64; 3]],
}

impl End<'_> {
    fn reason(&self, kind: ReasonKind, occasion: Occasion, message: String) -> Reason {
        use ReasonKind::{HeldInObstacle, Instability, MaterialLimit};
        let is_physical = matches!(kind, MaterialLimit | Instability | HeldInObstacle);
        Reason { kind, is_physical, message, advice: self.vocabulary.advice(occasion, self.problem), occasion }
    }

    fn reached(&self) -> String {
        self.failure.clock.words(self.failure.reached)
    }

    fn is_at_rest(&self) -> bool {
        self.failure.reached <= LoadParameter::default()
    }

    fn is_chatter(&self) -> bool {
        matches!(self.failure.cause, Cause::ContactChatter { .. })
    }

    /// Whether forces or air of a given pressure act, which may grow beyond what the body can bear; a body that only supports and pumps
    /// drive has no greatest load.
    fn is_loaded(&self) -> bool {
        let is_blown = |control: &Control| !matches!(control, Control::Volume(_));
        self.problem.cavities.iter().any(|cavity| is_blown(&cavity.control)) || !self.problem.loads.is_empty()
    }

    /// The equations do not fit in memory.
    fn out_of_memory(&self, why: &dyn std::fmt::Display) -> Reason {
        let message = format!("the memory does not suffice beyond {}: {why}", self.reached());
        self.reason(ReasonKind::OutOfMemory, Occasion::OutOfMemory, message)
    }

    /// The tolerance of the residual cannot be met.
    fn rounding(&self) -> Reason {
        let attempted = self.failure.clock.words(self.failure.attempted);
        let message = format!(
            "the state at {attempted} is found, but not to the tolerance that is asked for: {}",
            self.failure.cause
        );
        self.reason(ReasonKind::Rounding, Occasion::Rounding, message)
    }

    fn not_solvable(&self) -> Reason {
        self.reason(ReasonKind::NotConverged, Occasion::BadEquations, self.failure.cause.to_string())
    }

    /// The material has no stiffness left somewhere.
    fn material_limit(&self) -> Option<Reason> {
        if self.is_chatter() {
            return None;
        }
        let stress = recover(self.problem, self.displacement).ok()?;
        let beyond = stress.beyond_limit(self.problem);
        let worst = first_largest(beyond.iter(), |(_, point, _)| point.invariant_minus_3);
        let (element, at, what, count) = match worst {
            Some((element, point, limit)) => {
                let excess = point.invariant_minus_3;
                let what = format!(
                    "its invariant exceeds 3 by {excess:.2}, and beyond {limit:.2} these constants have no stiffness left"
                );
                (*element, point.position, what, beyond.len())
            }
            None => {
                let unstable = stress.unstable();
                let (element, point) = first_largest(unstable.iter(), |(_, point)| point.von_mises)?;
                let what = "its constants answer more strain with less stress".to_owned();
                (*element, point.position, what, unstable.len())
            }
        };
        let message = format!(
            "at {} the material gives way: in element {element} near {} {what} ({count} integration points)",
            self.reached(),
            place(at)
        );
        Some(self.reason(ReasonKind::MaterialLimit, Occasion::NoStiffnessLeft, message))
    }

    /// A part is held by contact alone, and nothing is solved yet, or it is not held.
    fn not_held(&self) -> Option<Reason> {
        let slips = matches!(self.failure.cause, Cause::HeldBySprings { .. });
        let parts = if self.is_at_rest() || slips { loose_parts(self.problem) } else { Vec::new() };
        let message = || {
            if slips {
                let held = holding::held_by_contact(self.problem, &parts);
                return format!("beyond {} the body slips off: {held}; {}", self.reached(), self.failure.cause);
            }
            format!(
                "no equilibrium is found from rest: {}; it does not hold it from the beginning",
                holding::held_by_contact(self.problem, &parts)
            )
        };
        (!parts.is_empty()).then(|| self.reason(ReasonKind::NotHeld, Occasion::NotHeld, message()))
    }

    /// The path had gone beyond a limit point: every state there is unstable under its loads, which explains nothing.
    fn past_limit(&self) -> Option<Reason> {
        let other = || {
            let message = format!(
                "beyond {}, on the path past its limit point, no further equilibrium is found: {}",
                self.reached(),
                self.failure.cause
            );
            self.reason(ReasonKind::NotConverged, Occasion::Unclear, message)
        };
        let known = || self.passed_through().or_else(|| self.chatter()).or_else(|| self.inverted());
        self.failure.is_past_limit.then(|| known().unwrap_or_else(other))
    }

    /// The tangent is indefinite at the last equilibrium, or at the one that was found after it.
    fn unstable(&self) -> Option<Reason> {
        let stability = &self.failure.stability;
        let of_cause = match &self.failure.cause {
            Cause::IndefiniteTangent { motions, .. } => Some(motions.as_deref()),
            _ => None,
        };
        let motions = match of_cause {
            Some(motions) => motions.or(stability.motions.as_deref()),
            None if stability.negative_pivots > 0 => stability.motions.as_deref(),
            None => return None,
        };
        let place_of = |motions: &UnstableMotions| format!(", most of all near {}", place(motions.place));
        let near = motions.map_or(String::new(), place_of);
        Some(match motions {
            Some(motions) if motions.are_of_the_mesh() => self.mesh_instability(motions),
            // Where the way to it begins is not known: no design is to blame yet.
            _ if self.is_at_rest() => {
                let attempted = self.failure.clock.words(self.failure.attempted);
                let message = format!(
                    "the body is unstable where the first step leads, at {attempted}: it buckles or snaps before{near}"
                );
                Reason { is_physical: false, ..self.reason(ReasonKind::Instability, Occasion::FirstStep, message) }
            }
            _ => {
                let message = format!(
                    "the equilibrium becomes unstable beyond {}: small disturbances make it buckle or snap{near}",
                    self.reached()
                );
                self.reason(ReasonKind::Instability, Occasion::Buckling, message)
            }
        })
    }

    fn mesh_instability(&self, motions: &UnstableMotions) -> Reason {
        let message = format!("the mesh becomes unstable beyond {}: {}", self.reached(), mesh_motions(motions));
        let occasion = if motions.is_volumetric() { Occasion::VolumetricMotion } else { Occasion::ElementMotion };
        self.reason(ReasonKind::MeshInstability, occasion, message)
    }

    /// What is asked for is impossible from where an obstacle comes into what supports hold; how far beyond it a mesh follows says nothing.
    fn held_in_obstacle(&self) -> Option<Reason> {
        let at = self.failure.reached;
        let words =
            held_in_obstacle::words(self.problem, at).filter(|_| held_in_obstacle::is_deep(self.problem, at))?;
        let message = format!("no state is found beyond {}, and no body could have one: {words}", self.reached());
        Some(self.reason(ReasonKind::HeldInObstacle, Occasion::HeldInObstacle, message))
    }

    /// A small change of the load makes a large one of the shape.
    fn limit_point(&self) -> Option<Reason> {
        let softening = self.failure.stability.softening.filter(|softening| *softening > LIMIT_POINT)?;
        if !self.is_loaded() {
            return None;
        }
        if let Some(motions) = self.failure.stability.motions.as_deref().filter(|motions| motions.are_of_the_mesh()) {
            return Some(self.mesh_instability(motions));
        }
        let much = if softening < 1e4 {
            format!("{softening:.0} times as much as")
        } else {
            "beyond all measure against".into()
        };
        let is_blown = self.problem.cavities.iter().any(|cavity| matches!(cavity.control, Control::Pressure(_)))
            || self.problem.loads.iter().any(|load| matches!(load, Load::Pressure { .. }));
        let occasion = if is_blown { Occasion::GreatestPressure } else { Occasion::GreatestForce };
        let pressure = self.greatest_pressure().map_or(String::new(), |kpa| format!(" ({kpa:.4} kPa)"));
        let message = format!(
            "the load has reached its greatest value at {}{pressure}: a little more of it stretches some part {much} at the beginning, \
             and no equilibrium at a greater load is near",
            self.reached()
        );
        Some(self.reason(ReasonKind::Instability, occasion, message))
    }

    /// The greatest pressure of the air where the path ended, kPa, if the load parameter is not one itself.
    fn greatest_pressure(&self) -> Option<f64> {
        if self.vocabulary == Vocabulary::CaseFile {
            return None;
        }
        let of_cavities = self.problem.cavities.iter().filter_map(|cavity| match &cavity.control {
            Control::Pressure(curve) => Some(curve),
            Control::Volume(_) | Control::Gas(_) => None,
        });
        let of_faces = self.problem.loads.iter().filter_map(|load| match load {
            Load::Pressure { curve, .. } => Some(curve),
            _ => None,
        });
        let values =
            of_cavities.chain(of_faces).map(|curve| curve.at(self.failure.reached) / pneuflex_model::MPA_PER_KPA);
        values.max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    fn passed_through(&self) -> Option<Reason> {
        let Cause::PassedThrough { obstacle } = &self.failure.cause else { return None };
        let message = format!(
            "beyond {} the only equilibrium that is found lies on the other side of the obstacle `{obstacle}`; the body may slip off there, \
             which no equilibrium describes",
            self.reached()
        );
        Some(self.reason(ReasonKind::WallsCross, Occasion::PassedThrough, message))
    }

    fn chatter(&self) -> Option<Reason> {
        // Another stiffness leads on in some of these, and in others the body buckles or snaps: which it is nobody knows.
        let limit = match self.failure.cause {
            Cause::ContactChatter { becomes_unstable: true, .. }
                if !(self.is_at_rest() || self.failure.is_past_limit) =>
            {
                "; with some of them the body is stable, with others it is not, and may buckle or snap where they open"
            }
            _ => "",
        };
        let message =
            || format!("the contact does not settle beyond {}: {}{limit}", self.reached(), self.failure.cause);
        self.is_chatter().then(|| self.reason(ReasonKind::WallsCross, Occasion::UnsettledContact, message()))
    }

    fn inverted(&self) -> Option<Reason> {
        let Cause::Inversion { element, .. } = self.failure.cause else { return None };
        let mesh = &self.problem.mesh;
        let near = (element < mesh.num_elements()).then(|| {
            let nodes = mesh.element(element);
            let mean = |k: usize| nodes.iter().map(|&n| mesh.nodes[n as usize][k]).sum::<f64>() / nodes.len() as f64;
            format!(" near {}", place([0, 1, 2].map(mean)))
        });
        let message = format!(
            "an element turns inside out beyond {}: element {element}{}; the mesh does not follow the body there",
            self.reached(),
            near.unwrap_or_default()
        );
        Some(self.reason(ReasonKind::InvertedElement, Occasion::InvertedElement, message))
    }

    fn unclear(&self) -> Reason {
        let message = format!(
            "Newton's method finds no equilibrium beyond {}, and it is not clear why: {}",
            self.reached(),
            self.failure.cause
        );
        self.reason(ReasonKind::NotConverged, Occasion::Unclear, message)
    }
}

/// What unstable motions of the mesh are, in words.
pub(crate) fn mesh_motions(motions: &UnstableMotions) -> String {
    let why = if motions.is_volumetric() {
        "changes of volume that the pressures of the elements do not see"
    } else {
        "which elements with straight edges have and a finer mesh has not"
    };
    format!(
        "{} near {} would release energy: {why}",
        match motions.count {
            1 => "a motion of elements".to_owned(),
            count => format!("{count} motions of elements"),
        },
        place(motions.place)
    )
}

fn place([x, y, z]: [f64; 3]) -> String {
    format!("({x:.1}, {y:.1}, {z:.1}) mm")
}

#[cfg(test)]
mod tests {
    use pneuflex_model::{Case, Clock};
    use pneuflex_newton::Stability;

    use super::*;

    fn problem() -> Problem {
        let mesh = "size = 2.0\nelement = \"hex8-q1p0\"";
        let case: Case =
            toml::from_str(&crate::template::two_chambers().replace("resolution = \"standard\"", mesh)).unwrap();
        Problem::from_case(&case).unwrap()
    }

    fn failure(cause: Cause, softening: Option<f64>) -> Failure {
        let stability = Stability { softening, ..Stability::default() };
        Failure {
            reached: LoadParameter(7.0),
            attempted: LoadParameter(8.0),
            cause,
            stability,
            clock: Clock::Pressure,
            is_past_limit: false,
        }
    }

    #[test]
    fn reasons_follow_from_the_state() {
        let problem = problem();
        let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let diverged = || Cause::Diverged { correction: 1.0 };
        let reason = |failure: &Failure, u: &[[f64; 3]]| explain(&problem, Vocabulary::CaseFile, failure, u);
        let kind = |failure: Failure| reason(&failure, &rest).map(|reason| (reason.kind, reason.is_physical));
        assert_eq!(kind(failure(Cause::Interrupted, Some(1.0))), None);
        assert_eq!(kind(failure(diverged(), Some(1.5))), Some((ReasonKind::NotConverged, false)));
        // Nothing is known of its stability.
        assert_eq!(kind(failure(diverged(), None)), Some((ReasonKind::NotConverged, false)));
        assert_eq!(kind(failure(diverged(), Some(30.0))), Some((ReasonKind::Instability, true)));
        let chatter = |becomes_unstable| Cause::ContactChatter { least: 1, most: 9, becomes_unstable };
        assert_eq!(kind(failure(chatter(false), Some(1.0))), Some((ReasonKind::WallsCross, false)));
        let says_so =
            |cause: Cause| reason(&failure(cause, Some(1.0)), &rest).unwrap().message.contains("may buckle or snap");
        assert_eq!([false, true].map(|unstable| says_so(chatter(unstable))), [false, true]);
        let passed = Cause::PassedThrough { obstacle: "ball".into() };
        assert_eq!(kind(failure(passed, Some(1.0))), Some((ReasonKind::WallsCross, false)));
        let inverted = Cause::Inversion { element: 3, point: 0, jacobian: -0.1 };
        assert_eq!(kind(failure(inverted, Some(1.0))), Some((ReasonKind::InvertedElement, false)));
        // Plane stretch to 8 is beyond the paper's limit of 54.83.
        let stretched: Vec<[f64; 3]> = problem.mesh.nodes.iter().map(|x| [7.0 * x[0], 0.0, -0.875 * x[2]]).collect();
        let reason = reason(&failure(diverged(), Some(1.0)), &stretched).unwrap();
        assert_eq!((reason.kind, reason.is_physical), (ReasonKind::MaterialLimit, true));
        assert!(reason.message.contains("in element") && reason.message.contains("54.83"), "{}", reason.message);
    }

    /// What is held cannot keep out of an obstacle, however the iterations end.
    #[test]
    fn an_obstacle_in_what_supports_hold_is_a_reason_once_it_is_deep() {
        let problem = crate::held_in_obstacle::tests::bar([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let kind = |reached: f64, cause: Cause| {
            let failure = Failure { reached: LoadParameter(reached), clock: Clock::Steps, ..failure(cause, None) };
            let reason = explain(&problem, Vocabulary::MeshModel, &failure, &rest).unwrap();
            (reason.kind, reason.is_physical)
        };
        let chatter = || Cause::ContactChatter { least: 1, most: 9, becomes_unstable: false };
        assert_eq!(kind(1.3, chatter()), (ReasonKind::WallsCross, false));
        assert_eq!(kind(1.9, chatter()), (ReasonKind::HeldInObstacle, true));
        assert_eq!(kind(1.9, Cause::Diverged { correction: 1.0 }), (ReasonKind::HeldInObstacle, true));
    }

    /// A body buckles, or its mesh is unstable.
    #[test]
    fn an_instability_is_one_of_the_body_or_of_the_mesh() {
        let problem = problem();
        let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let of_body = UnstableMotions {
            count: 1,
            element: 5,
            place: [1.0, 2.0, 3.0],
            num_elements: 40,
            volumetric_share: 0.01,
            varying_share: 0.3,
            tension: -0.1,
            is_linear: true,
        };
        let reason = |motions: Option<UnstableMotions>, reached: f64| {
            let cause = Cause::IndefiniteTangent { negative_pivots: 1, motions: motions.map(Box::new) };
            let failure = Failure { reached: LoadParameter(reached), ..failure(cause, None) };
            explain(&problem, Vocabulary::CaseFile, &failure, &rest).unwrap()
        };
        let buckles = reason(Some(of_body), 7.0);
        assert_eq!((buckles.kind, buckles.is_physical), (ReasonKind::Instability, true));
        assert!(
            buckles.message.contains("(1.0, 2.0, 3.0)") && !buckles.message.contains("times"),
            "{}",
            buckles.message
        );
        assert_eq!(reason(None, 7.0).kind, ReasonKind::Instability);
        for motions in [
            UnstableMotions { num_elements: 2, ..of_body },
            UnstableMotions { volumetric_share: 0.5, ..of_body },
            UnstableMotions { tension: 0.1, ..of_body },
        ] {
            let reason = reason(Some(motions), 7.0);
            assert_eq!((reason.kind, reason.is_physical), (ReasonKind::MeshInstability, false), "{motions:?}");
        }
        let volumetric = reason(Some(UnstableMotions { volumetric_share: 0.5, ..of_body }), 7.0);
        assert!(!volumetric.advice.contains("isochoric"), "it is: {}", volumetric.advice);
        // A first step beyond the load at which it buckles says nothing of the body at rest.
        let first_step = reason(Some(of_body), 0.0);
        assert_eq!((first_step.kind, first_step.is_physical), (ReasonKind::Instability, false));
        assert!(
            first_step.message.contains("at 8 kPa") && first_step.advice.contains("max_step_kpa"),
            "{first_step:?}"
        );
    }
}
