//! `cargo xtask corpus`: random designs, or the case files of a folder, through the real program; how many converge or end for a
//! physical reason.

mod contact;
pub mod design;
mod outcome;
mod wide;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use design::Problem;
use outcome::{Outcome, Remains, judge};

use crate::program;

/// Share of the designs that must not fail.
const BAR: f64 = 0.98;

struct Arguments {
    count: usize,
    seed: u64,
    limit: Duration,
    jobs: usize,
    only: Vec<usize>,
    cases: Option<PathBuf>,
    space: Space,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Space {
    /// Actuators like the paper's.
    Designs,
    /// The same with obstacles.
    Contact,
    /// Everything that a case file can say.
    Wide,
}

/// A case to be run.
struct Job {
    name: String,
    text: String,
    /// Thickness of the thinnest wall, mm.
    thinnest_wall: f64,
}

/// A case's run.
struct Record {
    name: String,
    outcome: Outcome,
    seconds: f64,
    iterations: u64,
    /// Load steps that were accepted.
    steps: u64,
}

pub fn run(arguments: &[String]) -> ExitCode {
    match parse(arguments).and_then(|arguments| corpus(&arguments)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(4),
        Err(message) => {
            eprintln!("corpus: {message}");
            ExitCode::from(2)
        }
    }
}

fn parse(arguments: &[String]) -> Result<Arguments, String> {
    let jobs = thread::available_parallelism().map_or(1, usize::from);
    let mut parsed = Arguments {
        count: 200,
        seed: 1,
        limit: Duration::from_secs(300),
        jobs,
        only: Vec::new(),
        cases: None,
        space: Space::Designs,
    };
    let mut rest = arguments.iter();
    while let Some(name) = rest.next() {
        let space = match name.as_str() {
            "--contact" => Some(Space::Contact),
            "--wide" => Some(Space::Wide),
            _ => None,
        };
        if let Some(space) = space {
            parsed.space = space;
            continue;
        }
        let value = rest.next().ok_or_else(|| format!("{name} needs a value"))?;
        let number = || value.parse::<u64>().map_err(|_| format!("{name} {value}: expected a whole number"));
        match name.as_str() {
            "--count" => parsed.count = number()?.clamp(1, 100_000) as usize,
            "--seed" => parsed.seed = number()?,
            "--limit" => parsed.limit = Duration::from_secs(number()?),
            "--jobs" => parsed.jobs = number()?.clamp(1, 1000) as usize,
            "--cases" => parsed.cases = Some(PathBuf::from(value)),
            "--only" => {
                let numbers =
                    value.split(',').map(|n| n.parse().map_err(|_| format!("--only {value}: expected numbers")));
                parsed.only = numbers.collect::<Result<_, _>>()?;
            }
            _ => return Err(format!("unknown option {name}")),
        }
    }
    Ok(parsed)
}

/// Runs the designs; whether enough of them do not fail.
fn corpus(arguments: &Arguments) -> Result<bool, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let program = program::build(&root)?;
    let (jobs, part) = match (&arguments.cases, arguments.space) {
        (Some(cases), _) => (case_files(cases)?, "cases".to_owned()),
        (None, space) => (space.jobs(arguments), format!("{}_{}", space.name(), arguments.seed)),
    };
    if jobs.is_empty() {
        return Err("no design has a number given with --only".to_owned());
    }
    let folder = program::target_folder(&root).join("corpus").join(part);
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    println!("{} cases, in {}", jobs.len(), folder.display());

    let next = AtomicUsize::new(0);
    let records = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..arguments.jobs {
            scope.spawn(|| {
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let record = try_case(&program, &folder, job, arguments.limit);
                    println!("{}", line(&record));
                    if let Ok(mut records) = records.lock() {
                        records.push(record);
                    }
                }
            });
        }
    });
    let mut records = records.into_inner().map_err(|_| "a worker has ended early".to_owned())?;
    records.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(report(&records))
}

impl Space {
    fn name(self) -> &'static str {
        match self {
            Self::Designs => "design",
            Self::Contact => "contact",
            Self::Wide => "wide",
        }
    }

    /// The cases asked for.
    fn jobs(self, arguments: &Arguments) -> Vec<Job> {
        let Arguments { count, seed, .. } = *arguments;
        let all = match self {
            Self::Designs => design::designs(count, seed),
            Self::Contact => contact::problems(count, seed),
            Self::Wide => wide::problems(count, seed),
        };
        let job = |Problem { number, text, thinnest_wall }| Job {
            name: format!("{}_{number:03}", self.name()),
            text,
            thinnest_wall,
        };
        all.into_iter().filter(|problem| arguments.wants(problem.number)).map(job).collect()
    }
}

impl Arguments {
    fn wants(&self, number: usize) -> bool {
        self.only.is_empty() || self.only.contains(&number)
    }
}

/// The case files of a folder.
fn case_files(folder: &Path) -> Result<Vec<Job>, String> {
    let words = |e: std::io::Error| format!("{}: {e}", folder.display());
    let mut jobs = Vec::new();
    for entry in fs::read_dir(folder).map_err(words)? {
        let path = entry.map_err(words)?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let text = fs::read_to_string(&path).map_err(words)?;
            let case: pneuflex::model::Case = toml::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
            jobs.push(Job { name, text, thinnest_wall: case.actuator.thinnest_wall() });
        }
    }
    jobs.sort_by(|a, b| a.name.cmp(&b.name));
    if jobs.is_empty() { Err(format!("{}: no case files", folder.display())) } else { Ok(jobs) }
}

fn line(record: &Record) -> String {
    let Record { name, outcome, seconds, iterations, .. } = record;
    let outcome = match outcome {
        Outcome::Converged => "converged".to_owned(),
        Outcome::Physical(kind) => format!("ended: {kind}"),
        Outcome::Failed(what) => format!("FAILED: {what}"),
    };
    format!("{name:>12}  {seconds:6.1} s  {iterations:4} iterations  {outcome}")
}

/// Prints the counts; whether the bar is met.
fn report(records: &[Record]) -> bool {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for record in records {
        let name = match &record.outcome {
            Outcome::Converged => "converged".into(),
            Outcome::Physical(kind) => format!("ended: {kind}"),
            Outcome::Failed(what) => format!("FAILED: {}", what.split(':').next().unwrap_or(what)),
        };
        *counts.entry(name).or_default() += 1;
    }
    println!();
    for (name, count) in &counts {
        println!("{count:5}  {name}");
    }
    let failed: Vec<String> = records
        .iter()
        .filter(|record| matches!(record.outcome, Outcome::Failed(_)))
        .map(|record| record.name.trim_start_matches(|c: char| !c.is_ascii_digit()).to_owned())
        .collect();
    if !failed.is_empty() {
        println!("failed: {}", failed.join(","));
    }
    let rate = 1.0 - failed.len() as f64 / records.len().max(1) as f64;
    let quantiles = |values: Vec<f64>| {
        let mut sorted = values;
        sorted.sort_by(f64::total_cmp);
        [0.5, 1.0].map(|share: f64| {
            sorted.get((share * (sorted.len() as f64 - 1.0)).max(0.0) as usize).copied().unwrap_or(0.0)
        })
    };
    let seconds = quantiles(records.iter().map(|record| record.seconds).collect());
    let converged = records.iter().filter(|record| record.outcome == Outcome::Converged && record.steps > 0);
    let per_step = quantiles(converged.map(|record| record.iterations as f64 / record.steps as f64).collect());
    println!(
        "{:.1} % converge or end for a physical reason (bar: {:.0} %); seconds: median {:.1}, most {:.1}; iterations per accepted step \
         of the converged: median {:.1}, most {:.1}",
        100.0 * rate,
        100.0 * BAR,
        seconds[0],
        seconds[1],
        per_step[0],
        per_step[1],
    );
    rate >= BAR
}

fn try_case(program: &Path, folder: &Path, job: &Job, limit: Duration) -> Record {
    let began = Instant::now();
    let remains = run_case(program, &folder.join(&job.name), job, limit);
    let summary: serde_json::Value = remains
        .as_ref()
        .ok()
        .and_then(|remains| serde_json::from_str(remains.summary.as_deref()?).ok())
        .unwrap_or_default();
    Record {
        name: job.name.clone(),
        outcome: remains.map_or_else(Outcome::Failed, |remains| judge(&remains)),
        seconds: began.elapsed().as_secs_f64(),
        iterations: summary["iterations_total"].as_u64().unwrap_or(0),
        steps: summary["steps"].as_array().map_or(0, |all| all.iter().filter_map(|s| s["load_steps"].as_u64()).sum()),
    }
}

/// Writes a case and lets the program solve it with one thread.
fn run_case(program: &Path, stem: &Path, job: &Job, limit: Duration) -> Result<Remains, String> {
    let words = |what: &str, e: std::io::Error| format!("{}: {what}: {e}", stem.display());
    let (file, out): (PathBuf, PathBuf) = (stem.with_extension("toml"), stem.to_owned());
    fs::write(&file, &job.text).map_err(|e| words("case", e))?;
    let messages = stem.with_extension("log");
    let log = File::create(&messages).map_err(|e| words("log", e))?;
    // An older summary must not be taken for this run's.
    let _ = fs::remove_file(out.join("summary.json"));
    let mut child = Command::new(program)
        .args(["run", "--threads", "1", "--no-report", "--out"])
        .args([&out, &file])
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()
        .map_err(|e| words("the program cannot be started", e))?;
    let began = Instant::now();
    let status = loop {
        match child.try_wait().map_err(|e| words("waiting", e))? {
            Some(status) => break Some(status),
            None if began.elapsed() > limit => {
                child.kill().map_err(|e| words("killing", e))?;
                child.wait().map_err(|e| words("waiting", e))?;
                break None;
            }
            None => thread::sleep(Duration::from_millis(20)),
        }
    };
    Ok(Remains {
        code: status.and_then(|status| status.code()),
        is_late: status.is_none(),
        messages: fs::read_to_string(&messages).unwrap_or_default(),
        summary: fs::read_to_string(out.join("summary.json")).ok(),
        thinnest_wall: job.thinnest_wall,
    })
}
