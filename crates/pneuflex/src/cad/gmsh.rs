//! Gmsh as a process: the Python package of that name, which runs a script of this program.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::input_error::{InputError, InputErrorKind};

/// What Gmsh is told to do.
pub(super) const SCRIPT: &str = include_str!("gmsh.py");

/// It is ended after so long.
const LONGEST: Duration = Duration::from_secs(900);

/// Code with which the script ends where there is no package.
const MISSING: i32 = 4;

/// How to get it.
const GET: &str = "pip install gmsh";

/// A mesh may have so many bytes.
const MOST_BYTES: u64 = 2_000_000_000;

/// A part in a folder of its own, which goes with this.
pub(super) struct Gmsh<'a> {
    /// What the part is called in messages.
    path: &'a Path,
    folder: PathBuf,
    /// Name of the part in the folder.
    part: String,
}

/// What is to be done.
pub(super) struct Task {
    pub what: &'static str,
    pub size: f64,
    pub shape: &'static str,
}

/// What Gmsh said.
pub(super) struct Said(Vec<(String, String)>);

impl Said {
    /// Values that follow a word.
    pub fn said<'s>(&'s self, word: &'s str) -> impl Iterator<Item = &'s str> {
        self.0.iter().filter(move |(known, _)| known == word).map(|(_, value)| value.as_str())
    }
}

impl<'a> Gmsh<'a> {
    /// Puts a part into a folder of its own under a name that says what it is.
    pub fn new(path: &'a Path, part: &str, bytes: &[u8]) -> Result<Self, InputError> {
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("pneuflex-mesh-{}-{number}", std::process::id()));
        let gmsh = Self { path, folder, part: part.to_owned() };
        // Not one that somebody else has put there.
        fs::create_dir(&gmsh.folder)
            .and_then(|()| fs::write(gmsh.folder.join(part), bytes))
            .map_err(|error| InputError::new(format!("{}: cannot be written: {error}", gmsh.folder.display())))?;
        Ok(gmsh)
    }

    /// Does something with the part.
    pub fn run(&self, task: &Task) -> Result<Said, InputError> {
        let size = task.size.to_string();
        let arguments =
            [task.what, &self.part, if task.what == "surface" { "surface" } else { "mesh.msh" }, &size, task.shape];
        let mut missing = None;
        for python in interpreters() {
            let (code, said) = self.process(&python, &arguments)?;
            match code {
                Some(0) => return Ok(said),
                Some(MISSING) => missing = said.said("missing").next().map(str::to_owned).or(missing),
                code => return Err(self.failed(code, &said)),
            }
        }
        let why =
            missing.filter(|why| !why.contains("No module named")).map_or_else(String::new, |why| format!(" ({why})"));
        let what = format!("a part is meshed by Gmsh, whose Python package is not there{why}: {GET}");
        Err(InputError::about_file(self.path, what).with_help(Some(format!(
            "or mesh it elsewhere into a .msh, and name that: `{GET}` brings Gmsh for Python, which is found if python3 finds it"
        ))).of_kind(InputErrorKind::MissingProgram))
    }

    fn failed(&self, code: Option<i32>, said: &Said) -> InputError {
        if said.said("none").next().is_some() {
            let help = "export the body as a solid, not as a surface or a sketch".to_owned();
            return InputError::about_file(self.path, "there is no solid in it").with_help(Some(help));
        }
        let why = said.said("error").next().map(str::to_owned).or_else(|| self.last_words());
        let why = why.or_else(|| code.map(|code| format!("it ended with the code {code}"))).unwrap_or_default();
        InputError::about_file(self.path, format!("Gmsh cannot mesh it: {why}")).with_help(Some(
            "another size of elements (--size, model.size) may do; or mend the part where it was drawn".into(),
        ))
    }

    /// The last line of what it complained of.
    fn last_words(&self) -> Option<String> {
        let text = fs::read_to_string(self.folder.join("errors")).ok()?;
        text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(|line| line.chars().take(200).collect())
    }

    /// Runs the script by an interpreter, in the part's folder: nothing beside the part is imported. `None` for a process that something ended.
    fn process(&self, python: &Path, arguments: &[&str]) -> Result<(Option<i32>, Said), InputError> {
        let file = |name: &str| File::create(self.folder.join(name)).map(Stdio::from);
        let wrong = |error: io::Error| InputError::new(format!("{}: {error}", python.display()));
        let mut command = Command::new(python);
        command.arg("-c").arg(SCRIPT).args(arguments).current_dir(&self.folder).stdin(Stdio::null());
        command.stdout(file("words").map_err(wrong)?).stderr(file("errors").map_err(wrong)?);
        let mut child = match command.spawn() {
            Ok(child) => child,
            // There is none of that name.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok((Some(MISSING), Said(Vec::new()))),
            Err(error) => return Err(wrong(error)),
        };
        let end = Instant::now() + LONGEST;
        let status = loop {
            match child.try_wait().map_err(wrong)? {
                Some(status) => break status,
                None if Instant::now() < end => thread::sleep(Duration::from_millis(20)),
                None => {
                    let _ = child.kill();
                    let _ = child.wait();
                    let why = format!("Gmsh has not meshed it in {} minutes and was ended", LONGEST.as_secs() / 60);
                    let help = "choose larger elements with --size, or model.size in a model file".to_owned();
                    return Err(InputError::about_file(self.path, why).with_help(Some(help)));
                }
            }
        };
        let text = fs::read_to_string(self.folder.join("words")).unwrap_or_default();
        let line = |line: &str| line.split_once(' ').map(|(word, value)| (word.to_owned(), value.trim().to_owned()));
        Ok((status.code(), Said(text.lines().filter_map(line).collect())))
    }

    /// The triangles around every solid.
    pub fn surfaces(&self) -> Vec<Vec<u8>> {
        (1..).map_while(|number| fs::read(self.folder.join(format!("surface_{number}.stl"))).ok()).collect()
    }

    /// The mesh.
    pub fn mesh(&self) -> Result<Vec<u8>, InputError> {
        let cannot = |error: io::Error| InputError::about_file(self.path, format!("Gmsh wrote no mesh: {error}"));
        let mut bytes = Vec::new();
        File::open(self.folder.join("mesh.msh"))
            .map_err(cannot)?
            .take(MOST_BYTES)
            .read_to_end(&mut bytes)
            .map_err(cannot)?;
        Ok(bytes)
    }
}

impl Drop for Gmsh<'_> {
    fn drop(&mut self) {
        // A folder of the system's that stays is no fault of anybody's input.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Interpreters that may have the package: `python3` and `python`, and the one that a `gmsh` of the package on the PATH names.
fn interpreters() -> Vec<PathBuf> {
    let mut found = vec![PathBuf::from("python3"), PathBuf::from("python")];
    let folders = std::env::var_os("PATH").unwrap_or_default();
    for folder in std::env::split_paths(&folders).filter(|folder| folder.is_absolute()) {
        let Ok(file) = File::open(folder.join("gmsh")) else { continue };
        let mut head = Vec::new();
        if file.take(300).read_to_end(&mut head).is_err() {
            continue;
        }
        let text = String::from_utf8_lossy(&head);
        let first = text.lines().next().unwrap_or_default();
        if let Some(interpreter) = first.strip_prefix("#!").map(str::trim).filter(|name| name.contains("python")) {
            found.extend(Some(PathBuf::from(interpreter)).filter(|path| path.is_absolute() && path.is_file()));
        }
        // The first one is the one that would run.
        break;
    }
    found
}

/// Whether an interpreter has the package.
pub(super) fn is_there() -> bool {
    interpreters().iter().any(|python| {
        let mut command = Command::new(python);
        command.arg("-c").arg("import gmsh").current_dir(std::env::temp_dir());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    })
}
