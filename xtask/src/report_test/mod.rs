//! `cargo xtask report-test`: the report of a run in a real browser, with a real mouse.
//!
//! The program solves two chambers, from a deck two blocks, an actuator that bends onto a ball, a chamber with a stiff layer, and a quarter of
//! a cylinder; Chromium opens the reports from disk, at the size of a desk and of
//! a phone, light and dark. Values read by clicks are compared with `summary.json`. Pictures of every stage are left in
//! `target/report-test`. Drawing in software takes its time: every control is used where it is light, and the other bodies are seen on a desk
//! by light and on a phone by dark; with `--all`, everything is done on all four screens.

mod bodies;
pub mod browser;
mod checks;
mod controls;
pub mod visit;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Arc;

use pneuflex::mesh::Mesh;
use pneuflex::model::{Case, Problem};
use serde_json::Value;

use crate::program;
use browser::Browser;

/// Draws in software, which is there on every machine.
pub const SOFTWARE: [&str; 3] = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];

/// A result folder that is looked at.
pub struct Results {
    folder: PathBuf,
    summary: Value,
    /// The mesh of an actuator.
    mesh: Option<Arc<Mesh>>,
}

/// Runs the test on two chambers, or on the result folder that is named.
pub fn run(arguments: &[String]) -> ExitCode {
    let (options, folders): (Vec<_>, Vec<_>) = arguments.iter().partition(|argument| argument.starts_with("--"));
    let outcome = match (&options[..], &folders[..]) {
        ([], []) => test(None, false),
        ([], [folder]) => test(Some(Path::new(folder)), false),
        ([option], []) if *option == "--all" => test(None, true),
        ([option], [folder]) if *option == "--all" => test(Some(Path::new(folder)), true),
        _ => Err("takes --all and at most one result folder".to_owned()),
    };
    match outcome {
        Ok(pictures) => {
            println!("report-test: passed; pictures are in {}", pictures.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("report-test: {error}");
            ExitCode::FAILURE
        }
    }
}

fn test(folder: Option<&Path>, on_all_screens: bool) -> Result<PathBuf, String> {
    let chromium = browser::installed().ok_or(
        "no Chromium is installed (Debian: apt-get install chromium), or set CHROMIUM to the path of its program",
    )?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = program::target_folder(&root).join("report-test");
    let _ = fs::remove_dir_all(&target);
    fs::create_dir_all(&target).map_err(|e| format!("{}: {e}", target.display()))?;
    let target = target.canonicalize().map_err(|e| e.to_string())?;
    let program = program::build(&root)?;
    let results = Results::of(match folder {
        Some(folder) => view(&program, folder)?,
        None => solve(&program, &root.join("fixtures/two_chamber_coarse.toml"), &target.join("two_chamber"))?,
    })?;

    let mut browser = Browser::start(&chromium, &target.join("profile"), &SOFTWARE)?;
    for screen in &visit::SCREENS {
        let uses_every_control = on_all_screens || screen.scheme == "light";
        checks::look(&mut browser, screen, &results, &target, uses_every_control)
            .map_err(|e| format!("{}: {e}", screen.name))?;
        println!("report-test: {} passed", screen.name);
    }
    // Every size and every scheme.
    let screens = || visit::SCREENS.iter().step_by(if on_all_screens { 1 } else { 3 });
    if folder.is_none() {
        let blocks = solve(&program, &root.join("fixtures/decks/blocks.inp"), &target.join("blocks"))?;
        let blocks = Results::of_body(blocks)?;
        for screen in screens() {
            let looked = bodies::look_at_blocks(&mut browser, screen, &blocks, &target);
            looked.map_err(|e| format!("blocks, {}: {e}", screen.name))?;
        }
        println!("report-test: two blocks passed");
        let ball = solve(&program, &root.join("fixtures/grip_sphere.toml"), &target.join("ball"))?;
        let ball = Results::of(ball)?;
        for screen in screens() {
            let looked = bodies::look_at_the_ball(&mut browser, screen, &ball, &target);
            looked.map_err(|e| format!("ball, {}: {e}", screen.name))?;
        }
        println!("report-test: an actuator on a ball passed");
        let layer = solve(&program, &root.join("fixtures/models/strain_limited.toml"), &target.join("layer"))?;
        let layer = Results::of_body(layer)?;
        for screen in screens() {
            let looked = bodies::look_at_materials(&mut browser, screen, &layer, &target);
            looked.map_err(|e| format!("layer, {}: {e}", screen.name))?;
        }
        println!("report-test: a body of two materials passed");
        let quarter = Results::of_body(solve(&program, &quarter(&root, &target)?, &target.join("quarter"))?)?;
        for screen in screens() {
            let looked = bodies::look_at_a_quarter(&mut browser, screen, &quarter, &target);
            looked.map_err(|e| format!("quarter, {}: {e}", screen.name))?;
        }
        println!("report-test: a quarter passed");
    }
    drop(browser);
    let mut browser = Browser::start(&chromium, &target.join("profile-flat"), &["--disable-gpu", "--disable-3d-apis"])?;
    bodies::without_graphics(&mut browser, &results).map_err(|e| format!("without WebGL: {e}"))?;
    println!("report-test: without WebGL passed");
    drop(browser);
    for profile in ["profile", "profile-flat"] {
        // Chromium's helpers may still be busy there; then the folder stays until the next test.
        let _ = fs::remove_dir_all(target.join(profile));
    }
    Ok(target)
}

fn solve(program: &Path, case: &Path, folder: &Path) -> Result<PathBuf, String> {
    let status = Command::new(program).arg("run").arg(case).arg("--out").arg(folder).arg("--quiet").status();
    match status {
        Ok(status) if status.success() => Ok(folder.to_owned()),
        Ok(status) => Err(format!("pneuflex run {} ended with {status}", case.display())),
        Err(error) => Err(format!("{} cannot be started: {error}", program.display())),
    }
}

/// The model of the crushed cylinder of `fixtures/cases`, a quarter, with its planes of symmetry declared.
fn quarter(root: &Path, target: &Path) -> Result<PathBuf, String> {
    let cases = root.join("fixtures/cases");
    let mut text = read(&cases, "crushed_cylinder.toml")?;
    for axis in ["x", "y"] {
        text = text.replace(&format!("axes = \"{axis}\"\n"), &format!("axes = \"{axis}\"\nsymmetry = true\n"));
    }
    let deck = fs::canonicalize(cases.join("crushed_cylinder.inp")).map_err(|e| e.to_string())?;
    text = text.replace("crushed_cylinder.inp", &deck.display().to_string());
    let file = target.join("quarter.toml");
    fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
    Ok(file)
}

fn view(program: &Path, folder: &Path) -> Result<PathBuf, String> {
    let status = Command::new(program).arg("view").arg(folder).status();
    match status {
        Ok(status) if status.success() => folder.canonicalize().map_err(|e| e.to_string()),
        Ok(status) => Err(format!("pneuflex view {} ended with {status}", folder.display())),
        Err(error) => Err(format!("{} cannot be started: {error}", program.display())),
    }
}

impl Results {
    fn of(folder: PathBuf) -> Result<Self, String> {
        let summary = read_summary(&folder)?;
        let case: Case = toml::from_str(&read(&folder, "case.toml")?).map_err(|e| format!("case.toml: {e}"))?;
        let problem = Problem::from_case(&case).map_err(|e| format!("case.toml: {e}"))?;
        Ok(Self { folder, summary, mesh: Some(problem.mesh) })
    }

    /// Those of a body that is no actuator's.
    ///
    /// # Errors
    /// A summary that cannot be read.
    pub fn of_body(folder: PathBuf) -> Result<Self, String> {
        Ok(Self { mesh: None, summary: read_summary(&folder)?, folder })
    }

    fn mesh(&self) -> Result<&Mesh, String> {
        self.mesh.as_deref().ok_or_else(|| "the results are no actuator's".to_owned())
    }
}

fn read(folder: &Path, name: &str) -> Result<String, String> {
    fs::read_to_string(folder.join(name)).map_err(|e| format!("{name}: {e}"))
}

fn read_summary(folder: &Path) -> Result<Value, String> {
    serde_json::from_str(&read(folder, "summary.json")?).map_err(|e| format!("summary.json: {e}"))
}
