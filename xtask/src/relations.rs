//! `cargo xtask relations`: random problems, each written in two ways that must have one solution.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};

use pneuflex_verification::relations::{Fault, Files, Options, Report, Scale, Tally, run as compare};

use crate::{program, record};

/// What is tried, and whether the outcome becomes a part of `docs/relations.md`.
struct Request {
    options: Options,
    is_recorded: bool,
}

pub fn run(arguments: &[String]) -> ExitCode {
    let Request { options, is_recorded } = match parse(arguments) {
        Ok(request) => request,
        Err(message) => {
            eprintln!("relations: {message}");
            return ExitCode::from(2);
        }
    };
    let folder = program::target_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).join("relations");
    let number = AtomicUsize::new(0);
    let report = compare(&options, &|fault| {
        let name = format!("{:03}", number.fetch_add(1, Ordering::Relaxed));
        println!("BROKEN {name} {} (draw {}): {}", fault.relation, fault.draw, fault.why);
        if let Err(error) = write(&folder.join(name), options.seed, fault) {
            eprintln!("{}: {error}", folder.display());
        }
    });
    if is_recorded && let Err(error) = write_docs(&report, &options) {
        eprintln!("{error}");
        return ExitCode::FAILURE;
    }
    let Report { relations: tallies, ends, .. } = report;
    println!("{}", table(&tallies, options.draws.len()));
    for (why, count) in kinds(&ends) {
        println!("{count:5} drawn problems: {why}");
    }
    let broken: usize = tallies.iter().map(|(_, tally)| tally.broken).sum();
    if broken == 0 {
        return ExitCode::SUCCESS;
    }
    println!("{broken} do not hold; the problems are in {}", folder.display());
    ExitCode::FAILURE
}

/// Ends without the numbers of their problem, and how many have them.
fn kinds(ends: &BTreeMap<String, usize>) -> BTreeMap<String, usize> {
    let mut found = BTreeMap::new();
    for (why, count) in ends {
        let why = why.rsplit(" is out of range: ").next().unwrap_or_default();
        let why: String = why.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).take(60).collect();
        *found.entry(why).or_default() += count;
    }
    found
}

fn parse(arguments: &[String]) -> Result<Request, String> {
    let mut options = Options { draws: Vec::new(), seed: 1, scale: Scale::Small, only: String::new() };
    let (mut count, mut first, mut is_recorded) = (100, 0, false);
    let mut rest = arguments.iter();
    while let Some(name) = rest.next() {
        if name == "--quick" {
            (count, options.scale) = (14, Scale::Tiny);
            continue;
        }
        if name == "--docs" {
            is_recorded = true;
            continue;
        }
        let value = rest.next().ok_or_else(|| format!("{name} needs a value"))?;
        let number = || value.parse::<u64>().map_err(|_| format!("{name} {value}: expected a whole number"));
        match name.as_str() {
            "--draws" => count = number()?.clamp(1, 1_000_000) as usize,
            "--from" => first = number()? as usize,
            "--seed" => options.seed = number()?,
            "--only" => options.only.clone_from(value),
            _ => return Err(format!("unknown option {name}")),
        }
    }
    options.draws = (first..first + count).collect();
    Ok(Request { options, is_recorded })
}

/// The outcome as tables in `docs/relations.md`.
fn write_docs(report: &Report, options: &Options) -> Result<(), String> {
    let count = options.draws.len();
    let mut text = format!(
        "{count} random problems (seed {}), each rewritten in every way that says something of it. *Held*: the two agree to what theory allows; \
         the last column is the largest difference, relative to the largest number of its kind. *Refused*: both are, with what is wrong. \
         *Stopped*: on the way, and they agree so far.\n\n| relation | tried | held | refused | stopped | broken | largest difference |\n\
         |---|---|---|---|---|---|---|\n",
        options.seed
    );
    for (name, Tally { tried, held, refused, stopped, broken, worst }) in &report.relations {
        text += &format!("| {name} | {tried} | {held} | {refused} | {stopped} | {broken} | {worst:.1e} |\n");
    }
    let ended: usize = report.ends.values().sum();
    text += &format!("\n{ended} of the problems are refused or stop on the way; {} reach their end.\n", count - ended);
    record::write("Relations", &text)?;
    let mut text = String::from(
        "In how many of the problems a key of a case or model file was, and a word.\n\n| key | problems |\n|---|---|\n",
    );
    for (key, problems) in &report.said {
        text += &format!("| {} | {problems} |\n", key.replace('|', "/"));
    }
    record::write("What was drawn", &text)
}

/// How often every relation held.
fn table(tallies: &[(&str, Tally)], draws: usize) -> String {
    let mut lines = vec![format!(
        "{draws} draws\n{:30} {:>6} {:>6} {:>8} {:>8} {:>7}  worst",
        "relation", "tried", "held", "refused", "stopped", "broken"
    )];
    for (name, Tally { tried, held, refused, stopped, broken, worst }) in tallies {
        lines.push(format!("{name:30} {tried:6} {held:6} {refused:8} {stopped:8} {broken:7}  {worst:.1e}"));
    }
    lines.join("\n")
}

/// Writes the two problems of a fault, each with what is right in its first line.
fn write(folder: &Path, seed: u64, fault: &Fault) -> std::io::Result<()> {
    let Fault { relation, draw, why, files: [first, second] } = fault;
    let right = format!("# Right: both have one solution ({relation}; seed {seed}, draw {draw}). Found: {why}\n");
    for (name, files) in [("first", first), ("second", second)] {
        let folder = folder.join(name);
        fs::create_dir_all(&folder)?;
        write_files(&folder, files, &right)?;
    }
    Ok(())
}

fn write_files(folder: &Path, files: &Files, right: &str) -> std::io::Result<()> {
    for (name, bytes) in files {
        let head = if name.ends_with(".toml") { right.replace(['\n', '\r'], " ") + "\n" } else { String::new() };
        fs::write(folder.join(name), [head.as_bytes(), bytes].concat())?;
    }
    Ok(())
}
