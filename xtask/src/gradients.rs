//! `cargo xtask gradients`: exact derivatives of results against differences of whole runs, case by case.

use std::process::ExitCode;

use pneuflex::gradient::{Checked, Request, check};
use pneuflex::words::rounded;
use pneuflex::{Change, Error, StopToken, Study};

/// How far the two may be apart, relative to the larger one. Where a point comes into contact between two runs, differences are worse than that.
const CLOSE: f64 = 1e-6;

/// What is told: file, changes, result, and keys by which it is differentiated; none for all.
type Task = (&'static str, &'static [(&'static str, &'static str)], &'static str, &'static [&'static str]);

/// Three chambers of the actuator, at a pressure at which both gaps are closed.
const FINGER: &[(&str, &str)] =
    &[("actuator.chambers", "3"), ("probe", "[]"), ("mesh.resolution", "draft"), ("load.pressure_kpa", "[20, 40]")];

const TASKS: [Task; 4] = [
    ("fixtures/two_chamber_coarse.toml", &[], "end_face_angle@35", &[]),
    (
        "fixtures/actuator.toml",
        FINGER,
        "end_face_angle",
        &["actuator.side_wall", "actuator.top_wall", "actuator.gap", "material.c10", "contact.stiffness"],
    ),
    (
        "fixtures/actuator.toml",
        FINGER,
        "tip.z",
        &["actuator.gap[1]", "actuator.cavity_length[2]", "material.c30", "load.pressure_kpa"],
    ),
    (
        "fixtures/blocked_force.toml",
        &[("mesh.resolution", "draft")],
        "force",
        &["actuator.base", "material.c10", "obstacle[0].point.z"],
    ),
];

/// Prints the table; fails if a derivative and its difference are too far apart.
pub fn run() -> ExitCode {
    let mut misses = 0;
    for task in TASKS {
        let (file, _, of, _) = task;
        println!("{file}: {of}");
        let told = |checked: &Checked| {
            let [exact, differences] = [checked.exact.derivative, checked.by_differences].map(|x| rounded(x, 9));
            let relative = checked.relative_difference();
            misses += usize::from(relative.is_nan() || relative > CLOSE);
            println!("  {:<28} {exact:>18} {differences:>18} {relative:>9.1e}", checked.exact.by);
        };
        if let Err(error) = compare(task, told) {
            println!("  {error}");
            misses += 1;
        }
    }
    println!("{misses} of them are apart by more than {CLOSE:e}");
    if misses == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn compare((file, changes, of, keys): Task, mut told: impl FnMut(&Checked)) -> Result<(), Error> {
    let changes = changes.iter().map(|(key, value)| Change::new(*key, *value)).collect();
    let analysis = Study::load_with(file, changes)?.build()?;
    let request: Request = of.parse().map_err(Error::from)?;
    let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    let keys = Some(&keys[..]).filter(|keys| !keys.is_empty());
    check(&analysis, &request, keys, &StopToken::new(), &mut told).map(drop)
}
