//! `cargo xtask estimates`: what `output.error_estimate` says of random designs, against the errors that a finer mesh shows; as a table, and in
//! `docs/estimates.json`.
//!
//! * [`record`]: how often an estimate is right, the table, the file.

mod record;

use std::path::Path;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{fs, thread};

use pneuflex::error_estimate::ErrorEstimate;
use pneuflex::quantities::{Quantity, Rest};
use pneuflex::{Change, Solution, Study};

use crate::accuracy::between_marks;
use crate::corpus::design;
use record::{Compared, OfDesign, OfMesh, Record};

const USAGE: &str = "usage: cargo xtask estimates [--count N] [--seed S] [--jobs N] [--docs]

  --count   random designs (12)
  --seed    other designs (7)
  --jobs    designs that are solved at once (the machine's cores)
  --docs    bring the guide's table and docs/estimates.json up to date";

/// Meshes whose errors are estimated, and the one that shows what they are.
const MESHES: [&str; 2] = ["draft", "standard"];
const RIGHT: &str = "fine";

/// Marks of the guide's table.
const MARKS: [&str; 2] = ["<!-- made by cargo xtask estimates --docs -->\n", "<!-- end of estimates -->\n"];

/// Designs have up to so many chambers: what happens at one happens at all.
const CHAMBERS: usize = 3;

struct Arguments {
    count: usize,
    seed: u64,
    jobs: usize,
    docs: bool,
}

/// Solves the designs and prints the table. Exit code 1 if nothing could be solved, 2 for arguments that make no sense.
pub fn run(arguments: &[String]) -> ExitCode {
    let arguments = match parse(arguments) {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("estimates: {message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    let record = Record::new(arguments.seed, measured(&arguments));
    println!("{}", record.markdown());
    let written = if arguments.docs { write_docs(&record) } else { Ok(()) };
    match written {
        Ok(()) if !record.is_empty() => ExitCode::SUCCESS,
        Ok(()) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("estimates: {message}");
            ExitCode::FAILURE
        }
    }
}

fn parse(arguments: &[String]) -> Result<Arguments, String> {
    let jobs = thread::available_parallelism().map_or(1, usize::from);
    let mut parsed = Arguments { count: 12, seed: 7, jobs, docs: false };
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut number = || rest.next().and_then(|n| n.parse::<u64>().ok()).ok_or(format!("{argument} needs a number"));
        match argument.as_str() {
            "--count" => parsed.count = number()?.clamp(1, 1000) as usize,
            "--seed" => parsed.seed = number()?,
            "--jobs" => parsed.jobs = number()?.clamp(1, 1000) as usize,
            "--docs" => parsed.docs = true,
            other => return Err(format!("unknown option {other}")),
        }
    }
    Ok(parsed)
}

/// The designs, those that could not be solved left out with a word.
fn measured(arguments: &Arguments) -> Vec<OfDesign> {
    let designs = design::designs(arguments.count, arguments.seed);
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..arguments.jobs {
            scope.spawn(|| {
                while let Some(problem) = designs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    match of_design(problem.number, &problem.text) {
                        Ok(found) => {
                            eprintln!("design {}: solved", problem.number);
                            if let Ok(mut done) = done.lock() {
                                done.push(found);
                            }
                        }
                        Err(why) => eprintln!("design {}: {why}", problem.number),
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|design: &OfDesign| design.design);
    done
}

fn of_design(number: usize, text: &str) -> Result<OfDesign, String> {
    let mut study = Study::from_text(&format!("design_{number}.toml"), text).map_err(|e| e.to_string())?;
    let chambers = 1 + number % CHAMBERS;
    study.set("actuator.chambers", &chambers.to_string()).map_err(|e| e.to_string())?;
    let (right, _) = solved(&study, RIGHT, false)?;
    let mut meshes = Vec::new();
    for mesh in MESHES {
        let (found, solution) = solved(&study, mesh, true)?;
        let touching = solution.states.last().is_some_and(|state| state.contact.points_active > 0);
        let run_seconds = solution.timing.total_s;
        let estimate = match &solution.error_estimate {
            Some(ErrorEstimate::Found(estimate)) => estimate,
            Some(ErrorEstimate::None { why_not }) => return Err(format!("{mesh}: {why_not}")),
            None => return Err(format!("{mesh}: no estimate")),
        };
        let percent = |value: f64, right: f64| 100.0 * (value - right) / right.abs();
        let compared = found.iter().zip(&right).zip(&estimate.errors).filter_map(|((found, right), estimated)| {
            let (error, estimated) = (percent(found.value, right.value), estimated.percent?);
            Some(Compared { key: found.key.clone(), error, estimated })
        });
        meshes.push(OfMesh {
            mesh,
            run_seconds,
            estimate_seconds: estimate.seconds,
            unknowns: estimate.unknowns,
            touching,
            quantities: compared.filter(|one| !one.key.starts_with("probe_")).collect(),
        });
    }
    Ok(OfDesign { design: number, chambers, meshes })
}

/// The last state of a design on a mesh, and all that was found, on one thread.
fn solved(study: &Study, mesh: &str, with_estimate: bool) -> Result<(Vec<Quantity>, Solution), String> {
    let mut study = study.clone();
    let changes = [("mesh.resolution", mesh.to_owned()), ("output.error_estimate", with_estimate.to_string())];
    study.set_all(changes.map(|(key, value)| Change::new(key, value))).map_err(|e| e.to_string())?;
    let analysis = study.build().map_err(|e| format!("{mesh}: {e}"))?;
    let solution = analysis.run().threads(1).without_fields().solve().map_err(|e| format!("{mesh}: {e}"))?;
    let rest = Rest::of(&analysis.problem).map_err(|e| e.to_string())?;
    let last = solution.states.last().ok_or("nothing was asked for")?;
    Ok((rest.quantities(last), solution))
}

fn write_docs(record: &Record) -> Result<(), String> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let put = |path: &Path, text: &str| fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()));
    put(&docs.join("estimates.json"), &record.json()?)?;
    let page = docs.join("guide/src/accuracy.md");
    let text = fs::read_to_string(&page).map_err(|e| format!("{}: {e}", page.display()))?;
    put(&page, &between_marks(&text, MARKS, &record.markdown())?)
}
