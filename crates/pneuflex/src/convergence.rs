//! The same case on finer and finer meshes, and what that says about the exact answer.

use std::time::Instant;

use pneuflex_model::{Case, Problem};
use pneuflex_newton::{ConvergedState, Event, follow_path};
use pneuflex_post::convergence::{Extrapolated, extrapolate};
use pneuflex_post::{PostError, measures, stress};
use serde::Serialize;

use crate::document::CaseFile;
use crate::error::Error;

/// `converge.json`. Its keys are a contract: later versions add to them.
#[derive(Clone, Debug, Serialize)]
pub struct Convergence {
    /// This program.
    pub program: &'static str,
    /// Its version.
    pub version: &'static str,
    /// Title of the case.
    pub title: String,
    /// Name of the element formulation.
    pub element: &'static str,
    /// One per mesh, the coarsest first.
    pub levels: Vec<Level>,
    /// One per pressure that was reached on every mesh.
    pub results: Vec<AtPressure>,
    /// Why it ended before the finest mesh, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// One mesh.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// Number of parts into which every element of the case's mesh is divided along every direction.
    pub divisions: usize,
    /// Number of elements.
    pub elements: usize,
    /// Number of unknown displacements.
    pub unknowns: usize,
    /// Edge of a cube with the mean volume of an element, mm.
    pub element_size_mm: f64,
    /// Seconds spent.
    pub seconds: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// One per pressure that was reached.
    pub steps: Vec<Measured>,
}

/// What is compared.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Measured {
    /// Pressure, kPa.
    pub pressure_kpa: f64,
    /// Angle of the end face, degrees.
    pub end_face_angle_deg: f64,
    /// Length of the displacement of the bottom centreline's last node, mm.
    pub tip_displacement_mm: f64,
    /// von Mises stress not exceeded in 99 % of the volume, MPa.
    pub von_mises_p99_mpa: f64,
}

/// Extrapolations at one pressure.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AtPressure {
    /// Pressure, kPa.
    pub pressure_kpa: f64,
    /// Angle of the end face, degrees.
    pub end_face_angle_deg: Extrapolated,
    /// Length of the displacement of the bottom centreline's last node, mm.
    pub tip_displacement_mm: Extrapolated,
    /// von Mises stress not exceeded in 99 % of the volume, MPa.
    pub von_mises_p99_mpa: Extrapolated,
}

/// What a listener is told of a mesh.
#[derive(Clone, Copy, Debug)]
pub enum LevelEvent<'a> {
    /// It is about to be solved.
    Started {
        /// Number of parts into which every element of the case's mesh is divided along every direction.
        divisions: usize,
        /// Number of unknown displacements.
        unknowns: usize,
    },
    /// It was solved as far as it could be.
    Finished(&'a Level),
}

/// Solves a case on its own mesh and on that mesh with every element divided by 2, 3 and so on up to `finest` along every direction.
///
/// # Errors
/// [`Error::Input`] for lengths that make no body. A mesh on which the path ends early ends the sequence, too: see
/// [`Convergence::failure`].
pub fn converge(
    file: &CaseFile,
    finest: usize,
    listener: &mut dyn FnMut(LevelEvent<'_>),
) -> Result<Convergence, Error> {
    let case = &file.case;
    let base = case.mesh.mesh_size(&case.actuator);
    let (mut levels, mut failure) = (Vec::new(), None);
    for divisions in 1..=finest {
        let problem = Problem::from_case_on(case, &base.divided(divisions)).map_err(|e| file.out_of_range(&e))?;
        listener(LevelEvent::Started { divisions, unknowns: problem.num_unknowns() });
        let (level, ended) = solve(case, &problem, divisions);
        listener(LevelEvent::Finished(&level));
        levels.push(level);
        if let Err(cause) = ended {
            failure = Some(format!("elements divided by {divisions}: {cause}"));
            break;
        }
    }
    Ok(Convergence {
        program: "pneuflex",
        version: env!("CARGO_PKG_VERSION"),
        title: case.title.clone(),
        element: case.mesh.formulation().name(),
        results: compare(&levels),
        levels,
        failure,
    })
}

/// Follows the case's pressures on one mesh; what was reached is kept when it fails.
fn solve(case: &Case, problem: &Problem, divisions: usize) -> (Level, Result<(), String>) {
    let began = Instant::now();
    let mut steps = Vec::new();
    let mut measured = Ok(());
    let result = follow_path(problem, &case.load.pressure_kpa, &case.solver, &mut |event| {
        // States past a limit point are at other pressures on every mesh.
        if let (Event::Converged(state), Ok(())) = (event, &measured)
            && state.kind.is_requested()
        {
            match measure(problem, state) {
                Ok(step) => steps.push(step),
                Err(error) => measured = Err(error.to_string()),
            }
        }
    });
    let missed = case.load.pressure_kpa.get(steps.len());
    let limit = missed.map_or(Ok(()), |kpa| Err(format!("the path past its limit point does not come to {kpa} kPa")));
    let (iterations, ended) = match result {
        Ok(report) => (report.iterations, measured.and(limit)),
        Err(ended) => (ended.1.iterations, Err(ended.0.to_string())),
    };
    let elements = problem.mesh.num_elements();
    let level = Level {
        divisions,
        elements,
        unknowns: problem.num_unknowns(),
        element_size_mm: (problem.mesh.volume() / elements as f64).cbrt(),
        seconds: began.elapsed().as_secs_f64(),
        iterations,
        steps,
    };
    (level, ended)
}

fn measure(problem: &Problem, state: &ConvergedState) -> Result<Measured, PostError> {
    let u = &state.displacement;
    let tip = problem.mesh.node_set("bottom_centreline").last().map_or([0.0; 3], |&node| u[node as usize]);
    Ok(Measured {
        pressure_kpa: state.parameter.0,
        end_face_angle_deg: measures::end_face_angle_deg(problem, u)?,
        tip_displacement_mm: tip.iter().map(|x| x * x).sum::<f64>().sqrt(),
        von_mises_p99_mpa: stress::recover(problem, u)?.von_mises_quantile(0.99),
    })
}

/// Extrapolates at the pressures that every mesh reached.
fn compare(levels: &[Level]) -> Vec<AtPressure> {
    let h: Vec<f64> = levels.iter().map(|level| level.element_size_mm).collect();
    let reached = levels.iter().map(|level| level.steps.len()).min().unwrap_or(0);
    (0..reached)
        .filter_map(|step| {
            let of = |value: fn(&Measured) -> f64| {
                extrapolate(&h, &levels.iter().map(|level| value(&level.steps[step])).collect::<Vec<_>>())
            };
            Some(AtPressure {
                pressure_kpa: levels[0].steps[step].pressure_kpa,
                end_face_angle_deg: of(|m| m.end_face_angle_deg)?,
                tip_displacement_mm: of(|m| m.tip_displacement_mm)?,
                von_mises_p99_mpa: of(|m| m.von_mises_p99_mpa)?,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mesh's own limit point is compared with nothing.
    #[test]
    fn states_past_a_limit_point_are_left_out_and_what_is_not_reached_is_said() {
        let mesh = "size = 4.5\nelement = \"hex8-q1p0\"";
        let mut case: Case =
            toml::from_str(&crate::template::two_chambers().replace("resolution = \"standard\"", mesh)).unwrap();
        case.material.law = pneuflex_model::Law::NeoHooke { c10: 0.05 };
        case.load.pressure_kpa = [5.0, 60.0].map(Into::into).to_vec();
        case.solver.continuation = pneuflex_model::Continuation::ArcLength;
        case.solver.states_past_limit = 2;
        let (level, ended) = solve(&case, &Problem::from_case(&case).unwrap(), 1);
        assert_eq!(level.steps.iter().map(|step| step.pressure_kpa).collect::<Vec<_>>(), [5.0]);
        assert!(ended.unwrap_err().contains("does not come to 60 kPa"));
    }
}
