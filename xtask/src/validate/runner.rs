//! Starting the real program, and saying how far along it is.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::plan::{Body, Mesh, Run};
use super::solution::Solution;
use super::{Failure, Outcome};

/// Exit code of the program for a path that could not be followed.
const NOT_CONVERGED: i32 = 3;

/// Starts the program and reads its results; several at a time may ask it to.
pub struct Runner {
    program: PathBuf,
    root: PathBuf,
    folder: PathBuf,
    began: Instant,
    /// Expected seconds of all that is to be done.
    expected_s: f64,
    /// Expected seconds of what is done.
    done_s: Mutex<f64>,
}

impl Runner {
    /// Builds the program in release mode; `folder` takes the results, `expected_s` is a rough time for all runs.
    ///
    /// # Errors
    /// A build that fails.
    pub fn new(root: &Path, folder: &Path, expected_s: f64) -> Outcome<Self> {
        let program = crate::program::build(root).map_err(Failure::new)?;
        let (root, folder) = (root.to_owned(), folder.to_owned());
        let (expected_s, done_s) = (expected_s.max(1.0), Mutex::new(0.0));
        Ok(Self { program, root, folder, began: Instant::now(), expected_s, done_s })
    }

    /// Solves a case; `None` if the program could not follow the path to its end.
    ///
    /// # Errors
    /// Any other failure of the program, or results that cannot be read.
    pub fn try_solve(&self, run: &Run) -> Outcome<Option<Solution>> {
        let folder = self.folder.join(&run.name);
        let mut command = self.command("run", run.body, &folder);
        for change in run.settings() {
            command.args(["--set", &change]);
        }
        let code = self.timed(&mut command, &run.name, run.expected_s(), &[0, NOT_CONVERGED])?;
        if code == 0 { Solution::read(run.clone(), &folder).map(Some) } else { Ok(None) }
    }

    /// The same where a path that ends early is an error.
    ///
    /// # Errors
    /// As [`Runner::try_solve`].
    pub fn solve(&self, run: &Run) -> Outcome<Solution> {
        self.try_solve(run)?.ok_or_else(|| Failure::new(format!("{}: the program did not converge", run.name)))
    }

    /// Identifies the rod on a mesh; returns the text of `rod.json`.
    ///
    /// # Errors
    /// As [`Runner::solve`].
    pub fn rod(&self, body: Body, mesh: Mesh, expected_s: f64) -> Outcome<String> {
        let name = format!("rod-{}-{}", mesh.element, mesh.size);
        let folder = self.folder.join(&name);
        let mut command = self.command("rod", body, &folder);
        let (element, size) = (format!("mesh.element={}", mesh.element), format!("mesh.size={:?}", mesh.size));
        command.args(["--set", &element, "--set", &size]).stdout(std::process::Stdio::null());
        self.timed(&mut command, &name, expected_s, &[0])?;
        let path = folder.join("rod.json");
        std::fs::read_to_string(&path).map_err(|e| Failure::at(&path, e))
    }

    /// Time since the first run.
    pub fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    fn command(&self, what: &str, body: Body, folder: &Path) -> Command {
        let mut command = Command::new(&self.program);
        command.arg(what).arg(Path::new("fixtures").join(body.fixture())).arg("--out").arg(folder).arg("--quiet");
        command.current_dir(&self.root);
        command
    }

    /// Runs the program to its end and says how far along all of them are.
    fn timed(&self, command: &mut Command, name: &str, expected_s: f64, allowed: &[i32]) -> Outcome<i32> {
        eprintln!("{name} …");
        let began = Instant::now();
        let code = finished(command, name, allowed)?;
        let took = seconds(began.elapsed());
        let mut done = self.done_s.lock().unwrap_or_else(PoisonError::into_inner);
        *done += expected_s;
        // The expectation holds for one machine; what is done says how fast this one is.
        let pace = self.elapsed().as_secs_f64() / *done;
        let left = seconds(Duration::from_secs_f64(((self.expected_s - *done) * pace).max(0.0)));
        eprintln!("[{:3.0} %, about {left} left] {name}: {took}", 100.0 * (*done / self.expected_s).min(0.99));
        Ok(code)
    }
}

fn finished(command: &mut Command, name: &str, allowed: &[i32]) -> Outcome<i32> {
    let status = command.status().map_err(|e| Failure::new(format!("{name}: cannot be started: {e}")))?;
    let code = status.code().unwrap_or(-1);
    if allowed.contains(&code) {
        return Ok(code);
    }
    Err(Failure::new(format!("{name}: the program ended with exit code {code}")))
}

/// A duration in words.
pub fn seconds(duration: Duration) -> String {
    let s = duration.as_secs_f64().round() as u64;
    if s < 90 { format!("{s} s") } else { format!("{} min {:02} s", s / 60, s % 60) }
}
