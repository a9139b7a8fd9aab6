//! `cargo xtask accuracy`: the errors of the headline quantities on the program's meshes, by kind of design, as a table; whether those that
//! the program promises hold wherever it does not warn.
//!
//! * [`kinds`]: the designs.
//! * [`measure`]: solving one on a mesh, and what results differ by.
//! * [`record`]: the table, and `docs/accuracy.json`.

mod kinds;
mod measure;
mod record;

use std::path::Path;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{fs, thread};

use kinds::{KINDS, Kind};
use measure::{Mesh, Solved, solve};
use pneuflex::model::Resolution;
use record::Record;
pub use record::between_marks;

const USAGE: &str = "usage: cargo xtask accuracy [--quick] [--docs] [--only PART OF A NAME]

  --quick   a few kinds, without the meshes that are finer than `fine`
  --docs    bring the guide's table and docs/accuracy.json up to date (full run only)
  --only    the kinds whose names have this part";

struct Arguments {
    quick: bool,
    docs: bool,
    only: String,
}

/// Solves all kinds and prints the table. Exit code 4 if an error is larger than what the program says and it does not warn, 1 if a kind
/// cannot be solved, 2 for arguments that make no sense.
pub fn run(arguments: &[String]) -> ExitCode {
    let arguments = match parse(arguments) {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("accuracy: {message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match measured(&arguments) {
        Ok(record) => {
            println!("{}", record.markdown());
            let broken = record.broken();
            broken.iter().for_each(|line| println!("NOT KEPT: {line}"));
            if arguments.docs
                && let Err(error) = write_docs(&record)
            {
                eprintln!("accuracy: {error}");
                return ExitCode::FAILURE;
            }
            if broken.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(4) }
        }
        Err(message) => {
            eprintln!("accuracy: {message}");
            ExitCode::FAILURE
        }
    }
}

fn parse(arguments: &[String]) -> Result<Arguments, String> {
    let mut parsed = Arguments { quick: false, docs: false, only: String::new() };
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--quick" => parsed.quick = true,
            "--docs" => parsed.docs = true,
            "--only" => parsed.only.clone_from(rest.next().ok_or("--only needs a part of a name")?),
            other => return Err(format!("unknown option {other}")),
        }
    }
    if parsed.docs && (parsed.quick || !parsed.only.is_empty()) {
        return Err("--docs records the full run; leave --quick and --only out".into());
    }
    Ok(parsed)
}

/// The meshes of a kind, from the finest to the coarsest.
fn meshes(kind: &Kind, quick: bool) -> impl Iterator<Item = Mesh> {
    let has_finer = kind.has_finer && !quick;
    Mesh::ALL.into_iter().filter(move |mesh| has_finer || *mesh != Mesh::Finer)
}

fn measured(arguments: &Arguments) -> Result<Record, String> {
    let is_wanted = |kind: &&Kind| (kind.is_quick || !arguments.quick) && kind.name.contains(&*arguments.only);
    let kinds: Vec<&Kind> = KINDS.iter().filter(is_wanted).collect();
    let mut jobs: Vec<(&Kind, Mesh)> =
        kinds.iter().flat_map(|kind| meshes(kind, arguments.quick).map(|mesh| (*kind, mesh))).collect();
    // The long ones first, so that no core is idle at the end.
    jobs.sort_by_key(|(kind, mesh)| {
        let is_long = matches!(kind.base, kinds::Base::EightChambers) && *mesh == Mesh::Of(Resolution::Fine);
        (!is_long, Mesh::ALL.iter().position(|m| m == mesh))
    });
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let began = std::time::Instant::now();
    let workers = thread::available_parallelism().map_or(1, usize::from).min(jobs.len());
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(&(kind, mesh)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let solved = solve(kind, mesh);
                    let words = solved.as_ref().map_or_else(ToString::to_string, |s| format!("{:6.1} s", s.seconds));
                    eprintln!("{:>20} {:9} {words}", kind.name, mesh.name());
                    if let Ok(mut done) = done.lock() {
                        done.push((kind.name, mesh, solved.map_err(|e| e.to_string())));
                    }
                }
            });
        }
    });
    let done = done.into_inner().map_err(|_| "a worker has ended early".to_owned())?;
    let find = |kind: &Kind, mesh: Mesh| -> Result<Option<Solved>, String> {
        match done.iter().find(|(name, of, _)| *name == kind.name && *of == mesh) {
            Some((_, _, Ok(solved))) => Ok(Some(solved.clone())),
            Some((_, _, Err(error))) => Err(format!("{} on {}: {error}", kind.name, mesh.name())),
            None => Ok(None),
        }
    };
    let seconds = began.elapsed().as_secs_f64().round();
    Record::new(arguments.quick, seconds, kinds.iter().map(|kind| (*kind, find)))
}

/// The guide's table, between its marks, and the record with all numbers.
fn write_docs(record: &Record) -> Result<(), String> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let put = |path: &Path, text: &str| fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()));
    put(&docs.join("accuracy.json"), &record.json()?)?;
    let page = docs.join("guide/src/accuracy.md");
    let text = fs::read_to_string(&page).map_err(|e| format!("{}: {e}", page.display()))?;
    put(&page, &between_marks(&text, record::MARKS, &record.markdown())?)
}
