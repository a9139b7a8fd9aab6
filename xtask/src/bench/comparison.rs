//! The same small case here and in CalculiX.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use pneuflex::model::{Case, Problem};
use serde::Serialize;

use super::calculix::{deck, displacements};
use super::process::measure;
use super::runner::Runner;

/// Name of CalculiX's solver.
const PROGRAM: &str = "ccx";

/// Pressures of the comparison, kPa: facing walls stay apart.
pub const PRESSURES: [f64; 2] = [5.0, 15.0];

/// Threads of both programs.
const THREADS: usize = 2;

/// Meshes compared: label, keys, and the CalculiX elements that have its nodes. The second is fine and compressible enough for
/// elements without a pressure of their own.
const MESHES: [(&str, &[&str], &[&str]); 2] = [
    ("draft", &["mesh.resolution=draft", "mesh.element=hex20"], &["C3D20R", "C3D20"]),
    ("1 mm, κ 10 MPa", &["mesh.element=hex20", "material.bulk_modulus=10"], &["C3D20"]),
];

/// One mesh and one CalculiX element.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Mesh and element here.
    pub mesh: &'static str,
    /// Element there.
    pub element: &'static str,
    /// Unknown displacements.
    pub unknowns: usize,
    /// Vertical displacement of the tip at each pressure here, mm.
    pub tip_mm: Vec<f64>,
    /// The same there, as far as it came.
    pub calculix_tip_mm: Vec<f64>,
    /// Time of the process here, s.
    pub seconds: f64,
    /// The same there.
    pub calculix_seconds: f64,
    /// Largest resident set here, bytes.
    pub peak_bytes: u64,
    /// The same there.
    pub calculix_peak_bytes: u64,
}

/// Where `ccx` is on PATH.
pub fn find() -> Option<PathBuf> {
    let paths = std::env::var_os("PATH")?;
    std::env::split_paths(&paths).map(|folder| folder.join(PROGRAM)).find(|file| file.is_file())
}

/// Runs two chambers without contact in both programs; with `is_quick` on the first mesh only.
///
/// # Errors
/// A program that cannot be started, results here that cannot be read, a deck that cannot be written. That CalculiX does not
/// converge is no error.
pub fn compare(ccx: &Path, runner: &Runner, is_quick: bool) -> Result<Vec<Comparison>, String> {
    let mut comparisons = Vec::new();
    let count = if is_quick { 1 } else { MESHES.len() };
    for (number, (mesh, keys, elements)) in (1..).zip(MESHES).take(count) {
        let name = format!("calculix-{number}");
        let mut changes: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
        changes
            .extend(["material.invariant=isochoric", "contact.method=none", "output.fields=false"].map(str::to_owned));
        changes.push(format!("load.pressure_kpa={PRESSURES:?}"));
        eprintln!("{name}");
        let (summary, usage) = runner.solve(&name, "two_chamber.toml", &changes, THREADS)?;
        let tip = summary.probes.get("tip").ok_or("two_chamber.toml has no probe \"tip\"")?.node;
        let vertical = |step: &serde_json::Value| step["probes"]["tip"][2].as_f64();
        let tip_mm: Vec<f64> = summary.steps.iter().filter_map(vertical).collect();
        // The case as it was solved, so that both meshes are the same.
        let folder = runner.folder().join(&name);
        let path = folder.join("case.toml");
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let case: Case = toml::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        let problem = Problem::from_case(&case).map_err(|e| format!("{}: {e}", path.display()))?;
        for &element in elements {
            let deck = deck(&problem, element, &PRESSURES, tip)?;
            let folder = runner.folder().join(format!("{name}-{element}"));
            eprintln!("{name}-{element}");
            let (found, there) = run(ccx, &folder, &deck)?;
            comparisons.push(Comparison {
                mesh,
                element,
                unknowns: summary.mesh.unknowns,
                tip_mm: tip_mm.clone(),
                calculix_tip_mm: found.iter().map(|u| u[2]).collect(),
                seconds: usage.wall_s,
                calculix_seconds: there.wall_s,
                peak_bytes: usage.peak_bytes,
                calculix_peak_bytes: there.peak_bytes,
            });
        }
    }
    Ok(comparisons)
}

fn run(ccx: &Path, folder: &Path, deck: &str) -> Result<(Vec<[f64; 3]>, super::process::Usage), String> {
    let at = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(folder).map_err(|e| at(folder, e))?;
    let input = folder.join("job.inp");
    std::fs::write(&input, deck).map_err(|e| at(&input, e))?;
    let output = folder.join("job.dat");
    match std::fs::remove_file(&output) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(at(&output, error)),
        _ => {}
    }
    let log = folder.join("job.log");
    let file = File::create(&log).map_err(|e| at(&log, e))?;
    let copy = file.try_clone().map_err(|e| at(&log, e))?;
    let mut command = Command::new(ccx);
    command.args(["-i", "job"]).current_dir(folder).env("OMP_NUM_THREADS", THREADS.to_string());
    let usage = measure(command.stdout(file).stderr(copy))?;
    // Where CalculiX stops is seen from what it wrote: its exit code is 0 after some failures.
    let found = std::fs::read_to_string(&output).map_or_else(|_| Vec::new(), |text| displacements(&text));
    Ok((found, usage))
}

/// The comparison in words.
pub fn text(comparisons: &[Comparison]) -> String {
    let mut text = format!(
        "\nTwo chambers without contact, hex20, isochoric invariant, here and in CalculiX on the same mesh, {THREADS} threads, whole \
         processes; CalculiX with its\nown increments and a residual of 1e-6. Elements without a pressure of their own differ on coarse meshes.\n\
         {:>15} {:>8} {:>9} {:>7} {:>11} {:>13} {:>8} {:>8} {:>9} {:>6}\n",
        "mesh", "CalculiX", "unknowns", "kPa", "tip u_z mm", "CalculiX mm", "differ", "s", "CalculiX s", "ratio"
    );
    for c in comparisons {
        for (i, pressure) in PRESSURES.iter().enumerate() {
            let number = |values: &[f64]| values.get(i).map_or_else(|| "-".to_owned(), |u| format!("{u:.4}"));
            let differ = match (c.tip_mm.get(i), c.calculix_tip_mm.get(i)) {
                (Some(here), Some(there)) => format!("{:+.2} %", 100.0 * (there / here - 1.0)),
                (_, None) => "did not converge".to_owned(),
                (None, _) => "-".to_owned(),
            };
            text += &format!(
                "{:>15} {:>8} {:>9} {pressure:>7} {:>11} {:>13} {differ:>8}",
                c.mesh,
                c.element,
                c.unknowns,
                number(&c.tip_mm),
                number(&c.calculix_tip_mm)
            );
            if i + 1 == PRESSURES.len() {
                let ratio = c.calculix_seconds / c.seconds;
                text += &format!(" {:>8.2} {:>9.2} {ratio:>6.1}", c.seconds, c.calculix_seconds);
            }
            text += "\n";
        }
    }
    text
}
