//! `cargo xtask fuzz`: damaged inputs of every reader.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use pneuflex_verification::mutation::{Options, run as damage};
use pneuflex_verification::relations::Files;

use crate::{program, record};

/// Larger files take too long to be read thousands of times.
const MOST_BYTES: usize = 60_000;

pub fn run(arguments: &[String]) -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut seeds = fixtures(&root.join("fixtures"));
    seeds.extend(meshes(&root.join("crates/deck/tests/data")));
    seeds.extend(surfaces());
    let mut options = Options { inputs: 10_000, seed: 1, seeds };
    let is_recorded = arguments.iter().any(|argument| argument == "--docs");
    let arguments: Vec<String> = arguments.iter().filter(|argument| *argument != "--docs").cloned().collect();
    for pair in arguments.chunks(2) {
        let number = pair.get(1).and_then(|text| text.parse::<u64>().ok());
        match (pair[0].as_str(), number) {
            ("--draws", Some(number)) => options.inputs = number.min(100_000_000) as usize,
            ("--seed", Some(number)) => options.seed = number,
            _ => {
                eprintln!("fuzz: {} is no option with a whole number", pair[0]);
                return ExitCode::from(2);
            }
        }
    }
    let folder = program::target_folder(&root).join("fuzz");
    let found = std::sync::atomic::AtomicUsize::new(0);
    let tallies = damage(&options, &|fault| {
        found.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        println!("WRONG input {}: {}", fault.input, fault.why);
        let folder = folder.join(fault.input.to_string());
        let written = fs::create_dir_all(&folder)
            .and_then(|()| fault.files.iter().try_for_each(|(name, bytes)| fs::write(folder.join(name), bytes)));
        if let Err(error) = written {
            eprintln!("{}: {error}", folder.display());
        }
    });
    println!("{:20} {:>9} {:>9} {:>9}  longest", "damaged file", "inputs", "read", "refused");
    for tally in &tallies {
        let reader = &tally.reader;
        println!("{reader:20} {:9} {:9} {:9}  {:.2} s", tally.tried, tally.read, tally.refused, tally.longest);
    }
    let found = found.into_inner();
    if is_recorded {
        let mut text = format!(
            "{} damaged inputs (seed {}) of every reader in one process, overflow checks on: {found} that panicked or took too long.\n\n\
             | damaged file | inputs | read | refused | longest |\n|---|---|---|---|---|\n",
            options.inputs, options.seed
        );
        for tally in &tallies {
            text += &format!(
                "| {} | {} | {} | {} | {:.2} s |\n",
                tally.reader, tally.tried, tally.read, tally.refused, tally.longest
            );
        }
        if let Err(error) = record::write("Damaged inputs", &text) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    }
    match found {
        0 => ExitCode::SUCCESS,
        wrong => {
            println!("{wrong} inputs that a reader cannot bear are in {}", folder.display());
            ExitCode::FAILURE
        }
    }
}

/// Cases, models with their bodies, decks and curves of the repository.
fn fixtures(folder: &Path) -> Vec<Files> {
    let mut found = Vec::new();
    for folder in [folder.to_owned(), folder.join("models"), folder.join("decks"), folder.join("curves")] {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        found.extend(paths.iter().filter_map(|path| files_of(path)));
    }
    found
}

/// Meshes of other programs, each within a model that holds one end and speaks of what is found.
fn meshes(folder: &Path) -> Vec<Files> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let files = |path: &PathBuf| {
        let name = path.file_name()?.to_string_lossy().into_owned();
        let is_mesh = [".vtk", ".vtu", ".msh"].iter().any(|end| name.ends_with(end));
        let bytes = fs::read(path).ok().filter(|bytes| is_mesh && bytes.len() < MOST_BYTES)?;
        let text = format!(
            "[model]\nfile = \"{name}\"\n[[support]]\nnodes = {{ plane = {{ point = [0, 0, 0], normal = \"x\" }}, normal = \"-x\" }}\naxes = \
             \"xyz\"\n[[pressure]]\nfaces = {{ and = [\"outer\", {{ near = [2, 0.5, 0.5] }}] }}\npressure_kpa = 1\n[load]\ntimes = [1]\n"
        );
        Some(vec![("mesh.toml".to_owned(), text.into_bytes()), (name, bytes)])
    };
    paths.iter().filter_map(files).collect()
}

/// A box with a hollow, as text and as bytes.
fn surfaces() -> Vec<Files> {
    let cuboid = |low: f64, high: f64, first: u32| {
        let points = (0..8).map(move |i| [0, 1, 2].map(|d| if i >> d & 1 == 0 { low } else { high }));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        (points, triangles.map(move |corners| corners.map(|point: u32| point + first)))
    };
    let (outer, inner) = (cuboid(0.0, 3.0, 0), cuboid(1.0, 2.0, 8));
    let (points, triangles) = (outer.0.chain(inner.0).collect(), outer.1.chain(inner.1).collect());
    let surface = pneuflex::deck::surface::Surface { points, triangles };
    let mut text = String::new();
    surface.points.iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
    surface.triangles.iter().for_each(|corners| {
        let [a, b, c] = corners.map(|point| point + 1);
        text += &format!("f {a} {b} {c}\n");
    });
    vec![vec![("box.stl".to_owned(), surface.to_stl())], vec![("box.obj".to_owned(), text.into_bytes())]]
}

/// A file, and the body beside it that a model names.
fn files_of(path: &Path) -> Option<Files> {
    let name = |path: &Path| Some(path.file_name()?.to_string_lossy().into_owned());
    let is_input = path.extension().is_some_and(|end| ["toml", "inp", "feb", "csv"].iter().any(|known| end == *known));
    let bytes = fs::read(path).ok().filter(|bytes| is_input && bytes.len() < MOST_BYTES)?;
    let table = String::from_utf8_lossy(&bytes).parse::<toml::Table>().ok();
    let body = table.as_ref().and_then(|table| table.get("model")?.get("file")?.as_str().map(PathBuf::from));
    let mut files = vec![(name(path)?, bytes)];
    if let Some(body) = body {
        let bytes = fs::read(path.with_file_name(&body)).ok().filter(|bytes| bytes.len() < MOST_BYTES)?;
        files.push((name(&body)?, bytes));
    }
    Some(files)
}
