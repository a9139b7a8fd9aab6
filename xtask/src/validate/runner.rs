//! Starting the real program, and saying how far along it is.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use super::plan::{Body, Mesh, Run};
use super::solution::Solution;
use super::{Failure, Outcome};

/// Exit code of the program for a path that could not be followed.
const NOT_CONVERGED: i32 = 3;

/// Starts the program and reads its results.
pub struct Runner {
    program: PathBuf,
    root: PathBuf,
    folder: PathBuf,
    began: Instant,
    /// Expected seconds of all that is to be done, and of what is done.
    expected: [f64; 2],
}

impl Runner {
    /// Builds the program in release mode; `folder` takes the results, `expected_s` is a rough time for all runs.
    ///
    /// # Errors
    /// A build that fails.
    pub fn new(root: &Path, folder: &Path, expected_s: f64) -> Outcome<Self> {
        let program = crate::program::build(root).map_err(Failure::new)?;
        let (root, folder) = (root.to_owned(), folder.to_owned());
        Ok(Self { program, root, folder, began: Instant::now(), expected: [expected_s.max(1.0), 0.0] })
    }

    /// Solves a case; `None` if the program could not follow the path to its end.
    ///
    /// # Errors
    /// Any other failure of the program, or results that cannot be read.
    pub fn try_solve(&mut self, run: &Run) -> Outcome<Option<Solution>> {
        let folder = self.folder.join(&run.name);
        let mut command = self.command("run", run.body, &folder);
        for change in run.settings() {
            command.args(["--set", &change]);
        }
        self.say(&run.name);
        let began = Instant::now();
        let code = finished(&mut command, &run.name, &[0, NOT_CONVERGED])?;
        self.expected[1] += run.expected_s();
        eprintln!("    {}", seconds(began.elapsed()));
        if code == 0 { Solution::read(run.clone(), &folder).map(Some) } else { Ok(None) }
    }

    /// The same where a path that ends early is an error.
    ///
    /// # Errors
    /// As [`Runner::try_solve`].
    pub fn solve(&mut self, run: &Run) -> Outcome<Solution> {
        self.try_solve(run)?.ok_or_else(|| Failure::new(format!("{}: the program did not converge", run.name)))
    }

    /// Identifies the rod on a mesh; returns the text of `rod.json`.
    ///
    /// # Errors
    /// As [`Runner::solve`].
    pub fn rod(&mut self, body: Body, mesh: Mesh, expected_s: f64) -> Outcome<String> {
        let name = format!("rod-{}-{}", mesh.element, mesh.size);
        let folder = self.folder.join(&name);
        let mut command = self.command("rod", body, &folder);
        let (element, size) = (format!("mesh.element={}", mesh.element), format!("mesh.size={:?}", mesh.size));
        command.args(["--set", &element, "--set", &size]).stdout(std::process::Stdio::null());
        self.say(&name);
        let began = Instant::now();
        finished(&mut command, &name, &[0])?;
        self.expected[1] += expected_s;
        eprintln!("    {}", seconds(began.elapsed()));
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

    fn say(&self, name: &str) {
        let [all, done] = self.expected;
        let elapsed = self.began.elapsed().as_secs_f64();
        // The expectation holds for one machine; what is done says how fast this one is.
        let pace = if done > 0.0 { elapsed / done } else { 1.0 };
        let left = Duration::from_secs_f64(((all - done) * pace).max(0.0));
        eprintln!("[{:3.0} %, about {} left] {name}", 100.0 * (done / all).min(0.99), seconds(left));
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
