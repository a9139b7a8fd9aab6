//! Small inputs that were once answered wrongly, with what is right (`fixtures/cases`, `fixtures/stops`).

use std::path::{Path, PathBuf};

use pneuflex::post::summary::StepSummary;
use pneuflex::{Change, Error, Solution, Study};

use crate::Effort;

/// An input, what is changed of it, and what is right.
struct Known {
    /// Below `fixtures`.
    file: &'static str,
    /// Keys and values.
    changes: &'static [(&'static str, &'static str)],
    /// In a second or two.
    is_quick: bool,
    /// What is wrong with an outcome.
    check: fn(Result<Solution, Error>) -> Result<(), String>,
}

/// What came of a known case.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The file and what was changed of it.
    pub name: String,
    /// What is wrong, if something is.
    pub verdict: Result<(), String>,
}

const ALL: [Known; 18] = [
    Known { file: "cases/gravity_y_half.toml", changes: &[], is_quick: true, check: wants_the_whole },
    Known {
        file: "cases/gravity_y_half.toml",
        changes: &[("actuator.part", "whole")],
        is_quick: true,
        check: |outcome| close("tip, mm", last(&outcome)?.probes.get("tip").map(|u| u[1]), -1.258, 1e-3),
    },
    Known { file: "cases/obstacle_off_plane_half.toml", changes: &[], is_quick: true, check: wants_the_whole },
    Known {
        file: "cases/thin_walls.toml",
        changes: &[],
        is_quick: false,
        check: |outcome| close("angle, degrees", last(&outcome)?.end_face_angle_deg, 7.65, 1e-3),
    },
    Known {
        file: "cases/stiff_layer.toml",
        changes: &[],
        is_quick: false,
        check: |outcome| close("angle, degrees", last(&outcome)?.end_face_angle_deg, 54.79, 1e-3),
    },
    Known {
        file: "cases/obstacle_off_plane_half.toml",
        changes: &[("actuator.part", "whole")],
        is_quick: false,
        check: |outcome| {
            let state = last(&outcome)?;
            let mut force = state.obstacles.values().map(|ball| ball.force_n.iter().map(|f| f * f).sum::<f64>().sqrt());
            close("force on the ball, N", force.next(), 0.0391, 3e-3)?;
            close("angle, degrees", state.end_face_angle_deg, 9.79, 1e-3)
        },
    },
    Known {
        file: "cases/layer_box_snaps.toml",
        changes: &[],
        is_quick: true,
        check: |outcome| close("angle, degrees", last(&outcome)?.end_face_angle_deg, 17.89, 0.02),
    },
    Known {
        file: "cases/layer_box_snaps.toml",
        changes: &[("mesh", "{ size = [3.0, 3.0, 1.0] }")],
        is_quick: false,
        check: |outcome| close("angle, degrees", last(&outcome)?.end_face_angle_deg, 17.89, 0.005),
    },
    Known { file: "cases/no_cavity_pressure.toml", changes: &[], is_quick: true, check: stays_at_rest },
    Known {
        file: "accuracy/draft_wrong_sign.toml",
        changes: &[("mesh.resolution", "standard"), ("load.pressure_kpa", "[2.8541, 5.7082]")],
        is_quick: false,
        check: |outcome| close("angle, degrees", last(&outcome)?.end_face_angle_deg, 1.19, 0.01),
    },
    Known {
        file: "cases/ball_on_roof.toml",
        changes: &[],
        is_quick: false,
        check: |outcome| {
            let state = last(&outcome)?;
            close("force on the ball, N", state.obstacles.values().map(|ball| ball.force_n[2]).next(), 0.3331, 2e-3)
        },
    },
    Known {
        file: "cases/weight_on_a_ball.toml",
        changes: &[],
        is_quick: true,
        check: |outcome| close("strain energy, mJ", last(&outcome)?.strain_energy_mj.into(), 0.00838, 1e-3),
    },
    Known {
        file: "cases/two_chamber_neo_hooke_full.toml",
        changes: &[],
        is_quick: true,
        check: |outcome| close("angle, degrees", last(&outcome)?.end_face_angle_deg, 4.58, 0.02),
    },
    Known {
        file: "cases/two_chamber_neo_hooke_full.toml",
        changes: &[("mesh.resolution", "fine")],
        is_quick: false,
        check: |outcome| close("angle, degrees", last(&outcome)?.end_face_angle_deg, 4.58, 0.005),
    },
    // E κ²/24, whatever Poisson's ratio: a field that the elements contain.
    Known {
        file: "cases/tet10_bending.inp",
        changes: &[],
        is_quick: true,
        check: |outcome| close("strain energy, mJ", last(&outcome)?.strain_energy_mj.into(), 1e-6 / 24.0, 1e-5),
    },
    Known {
        file: "stops/obstacle_at_clamp.toml",
        changes: &[],
        is_quick: false,
        check: |outcome| match outcome {
            Err(Error::NotConverged(ended)) if ended.to_string().contains("comes into what supports hold") => Ok(()),
            Err(error) => Err(format!("the plane has come into the clamp, not: {error}")),
            Ok(_) => Err("the plane has come into the clamp, but it is taken".to_owned()),
        },
    },
    // Clear of the clamp.
    Known {
        file: "stops/obstacle_at_clamp.toml",
        changes: &[("obstacle", TILTED)],
        is_quick: false,
        check: |outcome| {
            let state = last(&outcome)?;
            close("angle, degrees", state.end_face_angle_deg, -18.62, 1e-3)
        },
    },
    // The mesh that it was found with takes 43 s; elements of 8 mm end in the same way in an eighth of that.
    Known {
        file: "stops/tet10_inverted_landing.toml",
        changes: &[("mesh", "{ element = \"tet10\", size = 8.0 }"), ("load.pressure_kpa", "[28.0]")],
        is_quick: false,
        check: |outcome| match outcome {
            Err(Error::NotConverged(ended)) if ended.to_string().contains("inside out") => Ok(()),
            Err(error) => Err(format!("an element turns inside out, not: {error}")),
            Ok(_) => Err("an element turns inside out, but it is taken".to_owned()),
        },
    },
];

/// A plane that meets the free end first.
const TILTED: &str = "[{ name = \"thing\", shape = \"plane\", point = [19.1361, 0.0, -0.9507], normal = [-0.4, 0.0, 1.0], \
    displacement = [-2.66, 0.0, 6.65], factor = [[0, 0], [1, 0], [2, 1]] }]";

/// Solves those that are quick, or all.
pub fn run(effort: Effort, observe: &dyn Fn(&Checked)) -> Vec<Checked> {
    let wanted: Vec<&Known> = ALL.iter().filter(|known| known.is_quick || effort == Effort::Full).collect();
    let mut found = Vec::new();
    for known in wanted {
        let changes: Vec<Change> = known.changes.iter().map(|(key, value)| Change::new(*key, *value)).collect();
        let words: String = known.changes.iter().map(|(key, value)| format!(" {key}={value}")).collect();
        let outcome =
            Study::load_with(path(known.file), changes).and_then(|study| study.build()).and_then(|a| a.solve());
        let checked = Checked { name: format!("{}{words}", known.file), verdict: (known.check)(outcome) };
        observe(&checked);
        found.push(checked);
    }
    found
}

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(file)
}

fn last(outcome: &Result<Solution, Error>) -> Result<&StepSummary, String> {
    let solution = outcome.as_ref().map_err(ToString::to_string)?;
    solution.states.last().ok_or_else(|| "no state was reached".to_owned())
}

/// Whether a number is right, to a share of it.
fn close(what: &str, found: Option<f64>, right: f64, share: f64) -> Result<(), String> {
    match found {
        Some(found) if (found / right - 1.0).abs() <= share => Ok(()),
        found => Err(format!("{what}: {found:?}, right is {right} to {:.1} %", 100.0 * share)),
    }
}

fn wants_the_whole(outcome: Result<Solution, Error>) -> Result<(), String> {
    match outcome {
        Err(Error::Input(errors)) if errors.iter().any(|error| error.to_string().contains("part = \"whole\"")) => {
            Ok(())
        }
        Err(error) => Err(format!("refused without the remedy: {error}")),
        Ok(_) => Err("taken, though it breaks the plane of symmetry".to_owned()),
    }
}

fn stays_at_rest(outcome: Result<Solution, Error>) -> Result<(), String> {
    let solution = outcome.map_err(|error| error.to_string())?;
    let most = solution
        .fields
        .iter()
        .flat_map(|field| &field.displacement)
        .flatten()
        .fold(0.0, |most: f64, u| most.max(u.abs()));
    let has_cavities = solution.states.iter().any(|state| !state.cavities.is_empty());
    match (solution.fields.len(), most < 1e-9, has_cavities) {
        (2, true, false) => Ok(()),
        (states, ..) => Err(format!("{states} states, displacements up to {most} mm, cavities: {has_cavities}")),
    }
}
