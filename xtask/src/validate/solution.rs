//! What a run left on disk, read back: its case, its mesh, its summary, its fields.

use std::fs;
use std::path::{Path, PathBuf};

use pneuflex::model::{Case, Problem};
use pneuflex::post::stress::{self, StressField};
use pneuflex::post::vtu::Grid;
use serde::Deserialize;

use super::plan::{Method, Run};
use super::{Failure, Outcome};

/// One reached pressure in `summary.json`; keys not needed here are passed over.
#[derive(Clone, Debug, Deserialize)]
pub struct Step {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// Angle of the end face, degrees.
    pub end_face_angle_deg: f64,
    /// Deformed bottom centreline, x and z, mm.
    pub centreline: Vec<[f64; 2]>,
    /// von Mises stress not exceeded in 99 % of the volume, MPa.
    pub von_mises_p99_mpa: f64,
    /// Contact.
    pub contact: Contact,
    /// Volume of the modelled air, mm³.
    pub cavity_volume_mm3: f64,
    /// Sum of the clamp's reactions, N.
    pub reaction_n: [f64; 3],
    /// Strain energy, mJ.
    pub strain_energy_mj: f64,
}

/// Contact at one reached pressure.
#[derive(Clone, Debug, Deserialize)]
pub struct Contact {
    /// Contact points that carry traction.
    pub points_active: usize,
    /// Energy of the penalty, mJ.
    pub penalty_energy_mj: f64,
    /// Depth by dense sampling, mm.
    pub max_penetration_mm: f64,
    /// Area behind the opposite wall by dense sampling, mm².
    pub penetrating_area_mm2: f64,
    /// Gaps whose walls touch.
    pub gaps_in_contact: usize,
    /// Least distance of facing walls, mm.
    pub min_gap_mm: f64,
}

#[derive(Deserialize)]
struct Summary {
    version: String,
    status: String,
    steps: Vec<Step>,
}

/// A line of `history.jsonl`.
#[derive(Clone, Debug, Deserialize)]
pub struct Iteration {
    /// Whether a tangent was factorised for it.
    pub new_tangent: bool,
}

/// A run read back.
#[derive(Clone, Debug)]
pub struct Solution {
    /// What was asked for.
    pub run: Run,
    /// The mesh with its sets and the material, rebuilt from the case file in the output folder.
    pub problem: Problem,
    /// Version of the program that solved it.
    pub version: String,
    /// Reached pressures.
    pub steps: Vec<Step>,
    /// Tangents factorised.
    pub tangents: usize,
    folder: PathBuf,
}

impl Solution {
    /// Reads an output folder.
    ///
    /// # Errors
    /// A file that is missing, not as the program writes it, or of a run that did not converge.
    pub fn read(run: Run, folder: &Path) -> Outcome<Self> {
        let text = |name: &str| {
            let path = folder.join(name);
            fs::read_to_string(&path).map_err(|e| Failure::at(&path, e))
        };
        let at = |name: &str| folder.join(name);
        let summary: Summary =
            serde_json::from_str(&text("summary.json")?).map_err(|e| Failure::at(&at("summary.json"), e))?;
        if summary.status != "converged" {
            return Err(Failure::at(&at("summary.json"), format!("the run is {}", summary.status)));
        }
        let case: Case = toml::from_str(&text("case.toml")?).map_err(|e| Failure::at(&at("case.toml"), e))?;
        let problem = Problem::from_case(&case).map_err(|e| Failure::at(&at("case.toml"), e))?;
        let mut tangents = 0;
        for line in text("history.jsonl")?.lines() {
            let iteration: Iteration = serde_json::from_str(line).map_err(|e| Failure::at(&at("history.jsonl"), e))?;
            tangents += usize::from(iteration.new_tangent);
        }
        let folder = folder.to_owned();
        Ok(Self { run, problem, version: summary.version, steps: summary.steps, tangents, folder })
    }

    /// The step at a pressure.
    ///
    /// # Errors
    /// A pressure that was not reached on.
    pub fn step(&self, pressure_kpa: f64) -> Outcome<&Step> {
        let found = self.steps.iter().find(|s| s.pressure_kpa == pressure_kpa);
        found.ok_or_else(|| Failure::at(&self.folder, format!("nothing was reached at {pressure_kpa} kPa")))
    }

    /// Displacements at a pressure, mm, one entry per node, from the field file.
    ///
    /// # Errors
    /// A file that is missing, broken or of another mesh.
    pub fn displacement(&self, pressure_kpa: f64) -> Outcome<Vec<[f64; 3]>> {
        let number = self.steps.iter().take_while(|s| s.pressure_kpa != pressure_kpa).count() + 1;
        let path = self.folder.join(format!("fields/step_{number:02}.vtu"));
        let text = fs::read_to_string(&path).map_err(|e| Failure::at(&path, e))?;
        let grid = Grid::from_vtu(&text).map_err(|e| Failure::at(&path, e))?;
        if grid.time != pressure_kpa || grid.points != self.problem.mesh.nodes {
            return Err(Failure::at(&path, "does not belong to the case beside it"));
        }
        let values = grid.point_values("displacement").filter(|u| u.len() == self.problem.num_dofs());
        values.map(|u| u.as_chunks().0.to_vec()).ok_or_else(|| Failure::at(&path, "holds no displacement"))
    }

    /// Stresses at a pressure, recovered from the displacements.
    ///
    /// # Errors
    /// As [`Solution::displacement`].
    pub fn stress(&self, pressure_kpa: f64) -> Outcome<StressField> {
        Ok(stress::recover(&self.problem, &self.displacement(pressure_kpa)?)?)
    }

    /// Longest side of the faces of the walls that face each other, mm, at rest.
    pub fn face_size(&self) -> f64 {
        let mesh = &self.problem.mesh;
        let facets = self.problem.contact_pairs.iter().flat_map(|pair| &pair.slave);
        let side = |facet| {
            let corners: Vec<[f64; 3]> =
                mesh.facet_nodes(facet).iter().take(4).map(|&n| mesh.nodes[n as usize]).collect();
            let length = |a: [f64; 3], b: [f64; 3]| (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt();
            (0..4).map(|i| length(corners[i], corners[(i + 1) % 4])).fold(0.0, f64::max)
        };
        facets.map(|&facet| side(facet)).fold(0.0, f64::max)
    }
}

/// All runs of a report.
#[derive(Debug, Default)]
pub struct Solutions(pub Vec<Solution>);

impl Solutions {
    /// A run by its name.
    ///
    /// # Errors
    /// A run that is not part of this report.
    pub fn get(&self, run: &Run) -> Outcome<&Solution> {
        let found = self.0.iter().find(|s| s.run.name == run.name);
        found.ok_or_else(|| Failure::new(format!("the run {} is not part of this report", run.name)))
    }

    /// The standard run of a body.
    ///
    /// # Errors
    /// As [`Solutions::get`].
    pub fn standard(&self, body: super::plan::Body, mesh: super::plan::Mesh, method: Method) -> Outcome<&Solution> {
        self.get(&Run::standard(body, mesh, method))
    }
}
