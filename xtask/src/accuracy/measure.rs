//! Solving a kind on its meshes, and what its results differ by.

use pneuflex::mesh::Actuator;
use pneuflex::model::{MeshOptions, Resolution, Size};
use pneuflex::post::measures;
use pneuflex::post::summary::StepSummary;
use pneuflex::{Error, ResultsError, Study};
use serde::Serialize;

use super::kinds::Kind;

/// A mesh that kinds are solved on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mesh {
    /// One of the program's.
    Of(Resolution),
    /// `fine` with half of its element sizes.
    Finer,
}

impl Mesh {
    /// From the finest to the coarsest.
    pub const ALL: [Self; 4] =
        [Self::Finer, Self::Of(Resolution::Fine), Self::Of(Resolution::Standard), Self::Of(Resolution::Draft)];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Of(Resolution::Draft) => "draft",
            Self::Of(Resolution::Standard) => "standard",
            Self::Of(Resolution::Fine) => "fine",
            Self::Finer => "finer",
        }
    }

    fn options(self, actuator: &Actuator) -> MeshOptions {
        match self {
            Self::Of(resolution) => MeshOptions { resolution: Some(resolution), ..MeshOptions::default() },
            Self::Finer => {
                let fine = Resolution::Fine.mesh_size(actuator);
                MeshOptions {
                    size: Some(Size::PerAxis(fine.size.map(|size| 0.5 * size))),
                    edge_size: Some(0.5 * fine.edge),
                    ..MeshOptions::default()
                }
            }
        }
    }
}

/// The headline quantities of a state.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Measured {
    /// Pressure, kPa.
    pub pressure_kpa: f64,
    /// Gaps whose walls touch.
    pub gaps_in_contact: usize,
    /// Angle of the end face, degrees.
    pub end_face_angle_deg: f64,
    /// Angle of the line from the clamp to the tip, degrees, positive downwards.
    pub chord_angle_deg: f64,
    /// Length of the displacement of the tip, the end of the bottom centreline, mm.
    pub tip_mm: f64,
    /// Growth of the cavities, mm³.
    pub volume_change_mm3: f64,
    /// von Mises stress not exceeded in 99 % of the volume, MPa.
    pub von_mises_p99_mpa: f64,
    /// Area in contact, mm².
    pub contact_area_mm2: f64,
}

impl Measured {
    fn of(state: &StepSummary, length: f64, volume_at_rest: f64) -> Self {
        let [x, z] = state.centreline.last().copied().unwrap_or_default();
        Self {
            pressure_kpa: state.pressure_kpa,
            gaps_in_contact: state.contact.gaps_in_contact,
            end_face_angle_deg: state.end_face_angle_deg.unwrap_or_default(),
            chord_angle_deg: (-z).atan2(x).to_degrees(),
            tip_mm: (x - length).hypot(z),
            volume_change_mm3: state.cavity_volume_mm3 - volume_at_rest,
            von_mises_p99_mpa: state.von_mises_p99_mpa,
            contact_area_mm2: state.contact.area_mm2,
        }
    }

    /// Relative errors against a better solution, in percent.
    pub fn errors(&self, right: &Self) -> Errors {
        let percent = |value: f64, right: f64| 100.0 * (value - right) / right.abs();
        Errors {
            end_face_angle: percent(self.end_face_angle_deg, right.end_face_angle_deg),
            chord_angle: percent(self.chord_angle_deg, right.chord_angle_deg),
            tip: percent(self.tip_mm, right.tip_mm),
            volume_change: percent(self.volume_change_mm3, right.volume_change_mm3),
            von_mises_p99: percent(self.von_mises_p99_mpa, right.von_mises_p99_mpa),
            contact_area: (right.contact_area_mm2 > 0.0)
                .then(|| percent(self.contact_area_mm2, right.contact_area_mm2)),
        }
    }
}

/// Errors of the headline quantities, percent.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Errors {
    /// Of the end face's angle.
    pub end_face_angle: f64,
    /// Of the angle of the line from the clamp to the tip.
    pub chord_angle: f64,
    /// Of the length of the tip's displacement.
    pub tip: f64,
    /// Of the growth of the cavities.
    pub volume_change: f64,
    /// Of the stress that 99 % of the volume stays below.
    pub von_mises_p99: f64,
    /// Of the area in contact; left out where nothing touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_area: Option<f64>,
}

/// A kind solved on a mesh.
#[derive(Clone, Debug, Serialize)]
pub struct Solved {
    /// Unknown displacements.
    pub unknowns: usize,
    /// Seconds on one thread.
    pub seconds: f64,
    /// One per pressure.
    pub states: Vec<Measured>,
    /// The parameters that it finds outside the table.
    pub outside: Vec<&'static str>,
}

/// Solves a kind on a mesh with one thread.
///
/// # Errors
/// A case that cannot be built, or a path that cannot be followed.
pub fn solve(kind: &Kind, mesh: Mesh) -> Result<Solved, Error> {
    let study = kind.study()?;
    let Some(case) = study.case() else {
        return Err(ResultsError::not_representable(kind.name, "no case file").into());
    };
    let mut case = case.clone();
    case.mesh = mesh.options(&case.actuator);
    let analysis = Study::actuator(&case)?.build()?;
    let began = std::time::Instant::now();
    let solution = analysis.run().threads(1).without_fields().solve()?;
    let rest = vec![[0.0; 3]; analysis.problem.mesh.num_nodes()];
    let at_rest =
        measures::cavity_volume(&analysis.problem, &rest).map_err(|e| ResultsError::not_representable(kind.name, e))?;
    let length = case.actuator.length();
    let outside = analysis.expected(&solution.states).map(|expected| expected.outside).unwrap_or_default();
    Ok(Solved {
        unknowns: analysis.problem.num_unknowns(),
        seconds: (10.0 * began.elapsed().as_secs_f64()).round() / 10.0,
        states: solution.states.iter().map(|state| Measured::of(state, length, at_rest)).collect(),
        outside: outside.into_iter().map(|outside| outside.parameter.name()).collect(),
    })
}
