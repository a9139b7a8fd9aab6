//! `cargo xtask validate`: the figures and statements of the paper, computed by the real program, as a report.
//!
//! * [`plan`]: runs and their meshes.
//! * [`runner`], [`solution`]: starting the program and reading what it wrote.
//! * [`statements`], [`places`], [`rods`], [`sensitivity`], [`shapes`]: what is checked, and how.
//! * [`figures`], [`page`], [`record`]: what comes out.

mod figures;
mod page;
mod places;
mod plan;
mod record;
mod rods;
mod runner;
mod sensitivity;
mod shapes;
mod solution;
mod statements;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use figures::Figure;
use plan::{Body, Extent, Method, PRESSURES, Run};
use rayon::prelude::*;
use record::Record;
use runner::{Runner, seconds};
use shapes::MeasuredPoint;
use solution::Solutions;

/// Why the report could not be made.
#[derive(Debug)]
pub struct Failure(String);

/// Result with a [`Failure`].
pub type Outcome<T> = Result<T, Failure>;

impl Failure {
    fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    fn at(path: &Path, what: impl std::fmt::Display) -> Self {
        Self(format!("{}: {what}", path.display()))
    }
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

const USAGE: &str = "usage: cargo xtask validate [--quick] [--measured FILE.csv] [--docs]

  --quick              coarse version for CI
  --measured FILE.csv  measured points of the actuator's bottom, columns x_mm,z_mm,pressure_kpa
  --docs               bring README's figures and docs/validation.json up to date (full run only)";

/// Arguments of the command.
struct Arguments {
    extent: Extent,
    measured: Option<PathBuf>,
    docs: bool,
}

impl Arguments {
    fn read(arguments: &[String]) -> Outcome<Self> {
        let mut read = Self { extent: Extent::Full, measured: None, docs: false };
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            match argument.as_str() {
                "--quick" => read.extent = Extent::Quick,
                "--docs" => read.docs = true,
                "--measured" => {
                    let file = rest.next().ok_or_else(|| Failure::new(format!("--measured needs a file\n{USAGE}")))?;
                    read.measured = Some(file.into());
                }
                other => return Err(Failure::new(format!("unknown argument {other}\n{USAGE}"))),
            }
        }
        if read.docs && read.extent == Extent::Quick {
            return Err(Failure::new("--docs records the full run; leave --quick out"));
        }
        Ok(read)
    }
}

/// Makes the report. Exit code 0 if every statement holds, 4 if one fails, 1 if the report could not be made, 2 for
/// arguments that make no sense.
pub fn run(arguments: &[String]) -> ExitCode {
    let arguments = match Arguments::read(arguments) {
        Ok(arguments) => arguments,
        Err(Failure(text)) => {
            eprintln!("validate: {text}");
            return ExitCode::from(2);
        }
    };
    match report(&arguments) {
        Ok(record) => {
            for statement in &record.statements {
                eprintln!("{:<6} {}", format!("{:?}", statement.verdict).to_lowercase(), statement.id);
            }
            if record.holds() { ExitCode::SUCCESS } else { ExitCode::from(4) }
        }
        Err(Failure(text)) => {
            eprintln!("validate: {text}");
            ExitCode::FAILURE
        }
    }
}

fn report(arguments: &Arguments) -> Outcome<Record> {
    let extent = arguments.extent;
    let measured = match &arguments.measured {
        Some(path) => shapes::read_measured(path, &PRESSURES)?,
        None => Vec::new(),
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let target = crate::program::target_folder(&root);
    let folder = target.join("validation");
    let runs = runs(extent);
    let expected: f64 = runs.iter().map(Run::expected_s).sum();
    let expected = expected + rods::expected_s(extent) + sensitivity::expected_s(extent);
    let runner = Runner::new(&root, &folder.join("runs"), expected)?;
    let solutions = Solutions(runs.par_iter().map(|run| runner.solve(run)).collect::<Outcome<_>>()?);
    let rods = rods::identify(extent, &runner, &solutions)?;
    let sensitivities = sensitivity::study(extent, &runner)?;
    eprintln!("all runs done in {}; drawing", seconds(runner.elapsed()));

    let (stress, highest_stresses) = statements::stress_places(extent, &solutions)?;
    let record = Record {
        program: "pneuflex",
        version: solutions.0.first().map(|s| s.version.clone()).unwrap_or_default(),
        date: time::OffsetDateTime::now_utc().date().to_string(),
        extent: extent.name(),
        resolution: Record::resolution(extent),
        seconds: runner.elapsed().as_secs_f64().round(),
        statements: vec![
            statements::no_touch(extent, &solutions)?,
            statements::penetration(extent, &solutions)?,
            statements::face_sizes(extent, &solutions)?,
            statements::all_gaps(extent, &solutions)?,
            stress,
            statements::variants_part(extent, &solutions)?,
            statements::larger_mesh(extent, &solutions)?,
            rods::statement(&rods),
            statements::half_whole(extent, &solutions)?,
            statements::energy(extent, &solutions)?,
            statements::reactions(&solutions)?,
            sensitivity::statement(&sensitivities),
        ],
        highest_stresses,
        rods: rods.iter().map(|rod| rod.record.clone()).collect(),
        measured: distances(extent, &solutions, &measured)?,
        missing: missing(&measured),
        sensitivities,
    };

    let mut figures = figures::pictures(extent, &solutions)?;
    figures.push(figures::depth_chart(extent, &solutions)?);
    figures.extend(figures::shapes(extent, &solutions, &measured)?);
    figures.extend(figures::rods(&rods, &solutions)?);
    figures.extend(figures::tornado(&record.sensitivities)?);
    // Nobody looks at those of CI.
    let scale = if extent == Extent::Quick { 0.5 } else { 1.5 };
    write(&folder, &figures, scale, &record, &page::write(&record, &figures, &rods, &solutions)?)?;
    if arguments.docs {
        write_docs(&root.join("docs"), &figures, &record)?;
    }
    eprintln!("{}", folder.join("index.html").display());
    Ok(record)
}

/// All standard and extra runs, each once.
fn runs(extent: Extent) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for body in [Body::TwoChambers, Body::Actuator] {
        let sizes = if body == Body::TwoChambers { extent.face_sizes() } else { Vec::new() };
        for mesh in extent.meshes(body).into_iter().chain(sizes) {
            runs.extend(Method::BOTH.map(|method| Run::standard(body, mesh, method)));
        }
    }
    runs.extend(extent.rod_meshes().into_iter().map(|mesh| Run::standard(Body::Actuator, mesh, Method::Multiple)));
    runs.extend(statements::extra_runs(extent));
    let mut once: Vec<Run> = Vec::new();
    for run in runs {
        if !once.iter().any(|r| r.name == run.name) {
            once.push(run);
        }
    }
    once
}

fn distances(
    extent: Extent,
    solutions: &Solutions,
    measured: &[MeasuredPoint],
) -> Outcome<Vec<record::MeasuredDistance>> {
    let [single, multiple] = statements::both(solutions, Body::Actuator, extent.meshes(Body::Actuator)[0])?;
    let lines = |s: &solution::Solution| -> Vec<(f64, Vec<[f64; 2]>)> {
        s.steps.iter().map(|step| (step.pressure_kpa, step.centreline.clone())).collect()
    };
    Ok(shapes::rms_distances(measured, &lines(multiple), &lines(single)))
}

fn missing(measured: &[MeasuredPoint]) -> Vec<String> {
    let mut missing = vec![
        "Fig. 14 shows photographs of the experiment; there is nothing to compute.".to_owned(),
        "The relation and the values of the paper's rod-based model (its refs. 14, 15) are not available; the rod here is a \
         baseline in their spirit."
            .to_owned(),
    ];
    if measured.is_empty() {
        missing.push(
            "No measured points of Figs. 15 and 16 survived, so that no computed shape is compared with the experiment. \
             Points of your own are laid over with --measured FILE.csv."
                .to_owned(),
        );
    }
    missing
}

fn write(folder: &Path, figures: &[Figure], scale: f64, record: &Record, page: &str) -> Outcome<()> {
    fs::create_dir_all(folder).map_err(|e| Failure::at(folder, e))?;
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|e| Failure::at(&path, e))
    };
    for figure in figures {
        put(&format!("{}.svg", figure.name), figure.drawing.to_svg()?.as_bytes())?;
        put(&format!("{}.png", figure.name), &figure.drawing.to_png(scale)?)?;
    }
    put("validation.json", json(record)?.as_bytes())?;
    put("index.html", page.as_bytes())
}

/// README's figures, which the guide has, too, and the committed record.
fn write_docs(folder: &Path, figures: &[Figure], record: &Record) -> Outcome<()> {
    let pictures = folder.join("guide/src");
    fs::create_dir_all(&pictures).map_err(|e| Failure::at(&pictures, e))?;
    for (name, file) in
        [("figure-06-07", "two_chamber.png"), ("figure-10-11", "actuator.png"), ("figure-15", "shapes.png")]
    {
        let figure = figures.iter().find(|f| f.name == name);
        let figure = figure.ok_or_else(|| Failure::new(format!("the figure {name} was not drawn")))?;
        let path = pictures.join(file);
        fs::write(&path, figure.drawing.to_png(1.0)?).map_err(|e| Failure::at(&path, e))?;
    }
    let path = folder.join("validation.json");
    fs::write(&path, json(record)?).map_err(|e| Failure::at(&path, e))
}

/// Readable JSON; a number that is not finite is an error, not a silent `null`.
fn json(record: &Record) -> Outcome<String> {
    let broken = record.statements.iter().flat_map(|s| &s.numbers).find(|n| !n.value.is_finite());
    if let Some(number) = broken {
        return Err(Failure::new(format!("`{}` on {} is not a finite number", number.name, number.mesh)));
    }
    Ok(serde_json::to_string_pretty(record)? + "\n")
}
