//! Runs of the program, each one process.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};

use super::plan::{Run, Series};
use super::process::{Usage, measure};

/// Exit code of the program for a path that could not be followed.
const NOT_CONVERGED: i32 = 3;

/// What was measured in one run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Why it is in the table.
    pub series: Series,
    /// Case file.
    pub fixture: &'static str,
    /// Number of chambers.
    pub chambers: usize,
    /// Resolution, or the mesh in words.
    pub resolution: String,
    /// Element formulation.
    pub element: String,
    /// Unknown displacements.
    pub unknowns: usize,
    /// Number of threads.
    pub threads: usize,
    /// Whether every pressure was reached.
    pub converged: bool,
    /// Tangent factorisations.
    pub iterations: usize,
    /// Time of the path from the set-up of its equations to its end, s.
    pub solver_s: f64,
    /// Time of the process, s.
    pub process_s: f64,
    /// Time of the factorisations, s.
    pub factor_s: f64,
    /// Largest resident set of the process, bytes.
    pub peak_bytes: u64,
}

/// The part of `summary.json` that is read.
#[derive(Debug, Deserialize)]
pub struct Summary {
    /// Mesh.
    pub mesh: MeshSummary,
    /// Probes by name.
    pub probes: std::collections::BTreeMap<String, Site>,
    /// One entry per requested pressure, as far as it came.
    pub steps: Vec<serde_json::Value>,
    /// Tangent factorisations.
    pub iterations_total: usize,
    /// Times.
    pub timing: Timing,
}

/// Size of the mesh.
#[derive(Debug, Deserialize)]
pub struct MeshSummary {
    /// Element formulation.
    pub element: String,
    /// Unknown displacements.
    pub unknowns: usize,
}

/// Where a probe sits.
#[derive(Debug, Deserialize)]
pub struct Site {
    /// Its node.
    pub node: usize,
}

/// Times of a path, s.
#[derive(Debug, Deserialize)]
pub struct Timing {
    /// Factorisations.
    pub factor_s: f64,
    /// Everything.
    pub total_s: f64,
}

/// Starts the program.
pub struct Runner {
    program: PathBuf,
    root: PathBuf,
    folder: PathBuf,
}

impl Runner {
    /// Runs `program` on the fixtures of the repository at `root`; results go to folders in `folder`.
    pub fn new(program: PathBuf, root: &Path, folder: &Path) -> Self {
        Self { program, root: root.to_owned(), folder: folder.to_owned() }
    }

    /// Folder for all results.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Measures one run.
    ///
    /// # Errors
    /// A program that fails for any other reason than a path that cannot be followed, or that leaves no summary.
    pub fn measure(&self, run: &Run) -> Result<Row, String> {
        let (summary, usage) = self.solve(&run.name(), run.fixture, &run.changes, run.threads)?;
        Ok(Row {
            series: run.series,
            fixture: run.fixture,
            chambers: run.chambers,
            resolution: run.resolution.clone(),
            element: summary.mesh.element,
            unknowns: summary.mesh.unknowns,
            threads: run.threads,
            converged: usage.code == Some(0),
            iterations: summary.iterations_total,
            solver_s: summary.timing.total_s,
            process_s: usage.wall_s,
            factor_s: summary.timing.factor_s,
            peak_bytes: usage.peak_bytes,
        })
    }

    /// Solves a fixture with changes into the folder `name`.
    ///
    /// # Errors
    /// As [`Runner::measure`].
    pub fn solve(
        &self,
        name: &str,
        fixture: &str,
        changes: &[String],
        threads: usize,
    ) -> Result<(Summary, Usage), String> {
        let folder = self.folder.join(name);
        let mut command = Command::new(&self.program);
        command.current_dir(&self.root).arg("run").arg(Path::new("fixtures").join(fixture)).arg("--quiet");
        command.arg("--out").arg(&folder).arg("--threads").arg(threads.to_string());
        for change in changes {
            command.args(["--set", change]);
        }
        let usage = measure(&mut command)?;
        match usage.code {
            Some(0 | NOT_CONVERGED) => {}
            Some(code) => return Err(format!("{name}: the program ended with exit code {code}")),
            None => return Err(format!("{name}: the program was ended by a signal")),
        }
        let path = folder.join("summary.json");
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let summary = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok((summary, usage))
    }
}
