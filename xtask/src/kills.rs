//! `cargo xtask kills`: runs of the real program that are killed at random moments, twice, and gone on with, must end as undisturbed ones.
//!
//! The tests of `pneuflex::deaths` let a run die before every single operation on the disk; here the system kills whole processes, at any
//! moment, while they solve random problems in every kind of file.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use pneuflex_verification::relations::{Dice, Draw, Form, Scale};
use serde_json::Value;

use crate::{program, record};

/// Problems to choose from.
const PROBLEMS: usize = 60;

/// Longer runs are left out: they would be most of the time.
const LONGEST: Duration = Duration::from_millis(1500);

/// Numbers of a run that was gone on with are those of the undisturbed one to this, relative to themselves or 10⁻³.
const SAME: f64 = 1e-9;

/// A problem in its folder, with what an undisturbed run of it leaves.
struct Problem {
    file: PathBuf,
    kind: String,
    duration: Duration,
    left: Left,
}

/// What a finished run leaves.
struct Left {
    exit: Option<i32>,
    files: Vec<String>,
    summary: Value,
    history: usize,
}

pub fn run(arguments: &[String]) -> ExitCode {
    match all(arguments) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(lost) => {
            println!("{lost} runs ended otherwise than undisturbed ones");
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("kills: {message}");
            ExitCode::from(2)
        }
    }
}

/// How many runs lost something.
fn all(arguments: &[String]) -> Result<usize, String> {
    let (mut draws, mut seed) = (100, 1);
    let is_recorded = arguments.iter().any(|argument| argument == "--docs");
    let arguments: Vec<&String> = arguments.iter().filter(|argument| *argument != "--docs").collect();
    for pair in arguments.chunks(2) {
        match (pair[0].as_str(), pair.get(1).and_then(|text| text.parse::<u64>().ok())) {
            ("--draws", Some(number)) => draws = number.min(1_000_000) as usize,
            ("--seed", Some(number)) => seed = number,
            _ => return Err(format!("{} is no option with a whole number", pair[0])),
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let program = program::build(&root)?;
    let folder = program::target_folder(&root).join("kills");
    let problems = problems(&program, &folder, seed)?;
    if problems.is_empty() {
        return Err("no problem can be solved".to_owned());
    }
    let (mut lost, mut killed) = (0, [0; 2]);
    for number in 0..draws {
        let mut dice = Dice::of(seed.wrapping_add(1), number);
        let problem = &problems[(dice.between(0.0, problems.len() as f64) as usize).min(problems.len() - 1)];
        let out = folder.join(format!("out-{number}"));
        for (at, count) in killed.iter_mut().enumerate() {
            // Beyond the end of a run now and then; the second one has less to do.
            let moment = problem.duration.mul_f64(dice.between(0.0, 1.1));
            *count += usize::from(start_and_kill(&program, problem, &out, at > 0, moment)?);
        }
        let after = finish(&program, problem, &out).and_then(|left| left.compare(&problem.left));
        match after {
            Ok(()) => fs::remove_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?,
            Err(why) => {
                lost += 1;
                println!("LOST {} {}: {why}", out.display(), problem.file.display());
            }
        }
    }
    let kinds = |kind: &str| problems.iter().filter(|problem| problem.kind == kind).count();
    let stopped = problems.iter().filter(|problem| problem.left.exit != Some(0)).count();
    let text = format!(
        "{draws} runs of {} problems ({} case files, {} models of actuators, {} of decks, {} of meshes; {stopped} stop on the way): {} killed, \
         of these {} once more while they went on; {lost} lost anything",
        problems.len(),
        kinds("case"),
        kinds("actuator"),
        kinds("deck"),
        kinds("mesh"),
        killed[0],
        killed[1],
    );
    println!("{text}");
    if is_recorded {
        record::write(
            "Killed runs",
            &format!("{text}. Numbers are compared to {SAME:e}, with the exit code and the list of files.\n"),
        )?;
    }
    Ok(lost)
}

/// Random problems that are neither refused nor too long, each in a kind of file.
fn problems(program: &Path, folder: &Path, seed: u64) -> Result<Vec<Problem>, String> {
    let mut found = Vec::new();
    for number in 0..PROBLEMS {
        let draw = Draw::new(&mut Dice::of(seed, number), Scale::Tiny);
        let (form, kind) = match (&draw, number % 2) {
            (Draw::Case(_), _) => (Form::Text, "case"),
            (Draw::Model(_, None), _) => (Form::Text, "actuator"),
            (Draw::Model(_, Some(_)), 0) => (Form::Deck, "deck"),
            (Draw::Model(_, Some(_)), _) => (Form::Gmsh, "mesh"),
        };
        let Some(files) = draw.files(form) else { continue };
        let place = folder.join(format!("problem-{number}"));
        let wrong = |error: std::io::Error| format!("{}: {error}", place.display());
        fs::create_dir_all(&place).map_err(wrong)?;
        for (name, bytes) in &files {
            fs::write(place.join(name), bytes).map_err(wrong)?;
        }
        let mut problem = Problem {
            file: place.join(&files[0].0),
            kind: kind.to_owned(),
            duration: Duration::ZERO,
            left: Left { exit: None, files: Vec::new(), summary: Value::Null, history: 0 },
        };
        let out = folder.join("undisturbed");
        let _ = fs::remove_dir_all(&out);
        let begin = Instant::now();
        let Ok(left) = finish(program, &problem, &out) else { continue };
        problem.duration = begin.elapsed();
        if problem.duration < LONGEST {
            problem.left = left;
            found.push(problem);
        }
    }
    Ok(found)
}

fn command(program: &Path, problem: &Problem, out: &Path, resumes: bool) -> Command {
    let mut command = Command::new(program);
    command.arg("run").arg(&problem.file).arg("--out").arg(out).args(["--threads", "1", "--quiet"]);
    if resumes {
        command.arg("--resume");
    }
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Kills a run at a moment; returns whether it was still alive then.
fn start_and_kill(
    program: &Path,
    problem: &Problem,
    out: &Path,
    resumes: bool,
    moment: Duration,
) -> Result<bool, String> {
    let mut child =
        command(program, problem, out, resumes).stderr(Stdio::null()).spawn().map_err(|error| error.to_string())?;
    thread::sleep(moment);
    let is_alive = child.try_wait().map_err(|error| error.to_string())?.is_none();
    // One that has just ended cannot be killed any more.
    let _ = child.kill();
    child.wait().map_err(|error| error.to_string())?;
    Ok(is_alive)
}

/// Goes on with a run to its end.
fn finish(program: &Path, problem: &Problem, out: &Path) -> Result<Left, String> {
    let output = command(program, problem, out, true).output().map_err(|error| error.to_string())?;
    if ![Some(0), Some(3)].contains(&output.status.code()) {
        return Err(format!("{}: {}", output.status, String::from_utf8_lossy(&output.stderr)));
    }
    let text = |name: &str| fs::read_to_string(out.join(name)).map_err(|error| format!("{name}: {error}"));
    Ok(Left {
        exit: output.status.code(),
        files: listing(out),
        summary: serde_json::from_str(&text("summary.json")?).map_err(|error| error.to_string())?,
        history: text("history.jsonl")?.lines().count(),
    })
}

/// Paths of everything below a folder.
fn listing(folder: &Path) -> Vec<String> {
    let (mut found, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).into_iter().flatten().flatten() {
            let path = entry.path();
            found.push(path.strip_prefix(folder).unwrap_or(&path).display().to_string());
            if path.is_dir() {
                open.push(path);
            }
        }
    }
    found.sort();
    found
}

impl Left {
    fn compare(&self, expected: &Self) -> Result<(), String> {
        if (self.exit, self.history) != (expected.exit, expected.history) {
            return Err(format!(
                "exit code {:?} and {} lines of history, undisturbed {:?} and {}",
                self.exit, self.history, expected.exit, expected.history
            ));
        }
        if self.files != expected.files {
            return Err(format!("files {:?}, undisturbed {:?}", self.files, expected.files));
        }
        same("summary", &self.summary, &expected.summary)
    }
}

/// Whether two results are the same but for seconds.
fn same(path: &str, found: &Value, expected: &Value) -> Result<(), String> {
    match (found, expected) {
        (Value::Object(one), Value::Object(other)) => {
            if !one.keys().eq(other.keys()) {
                return Err(format!("{path}: other keys"));
            }
            let others = other.values();
            one.iter()
                .zip(others)
                .filter(|((key, _), _)| *key != "timing")
                .try_for_each(|((key, one), other)| same(&format!("{path}.{key}"), one, other))
        }
        (Value::Array(one), Value::Array(other)) if one.len() == other.len() => one
            .iter()
            .zip(other)
            .enumerate()
            .try_for_each(|(i, (one, other))| same(&format!("{path}[{i}]"), one, other)),
        (Value::Number(one), Value::Number(other)) => {
            let (a, b) = (one.as_f64().unwrap_or(f64::NAN), other.as_f64().unwrap_or(f64::NAN));
            let is_same = (a - b).abs() <= SAME * b.abs().max(1e-3);
            if is_same { Ok(()) } else { Err(format!("{path}: {a}, undisturbed {b}")) }
        }
        _ if found == expected => Ok(()),
        _ => Err(format!("{path}: {found}, undisturbed {expected}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn other_numbers_files_and_ends_are_told_apart() {
        let left = |summary: Value, exit| Left { exit: Some(exit), files: vec!["a".into()], summary, history: 3 };
        let right = left(json!({ "steps": [{ "tip": 1.0 }], "timing": { "s": 1.0 } }), 0);
        let with = |summary| left(summary, 0).compare(&right);
        assert_eq!(with(json!({ "steps": [{ "tip": 1.0 + 1e-11 }], "timing": { "s": 9.0 } })), Ok(()));
        assert!(with(json!({ "steps": [{ "tip": 1.0 + 1e-8 }], "timing": { "s": 1.0 } })).is_err());
        assert!(with(json!({ "steps": [], "timing": { "s": 1.0 } })).is_err());
        assert!(with(json!({ "steps": [{ "tip": 1.0 }] })).is_err());
        assert!(left(right.summary.clone(), 3).compare(&right).is_err());
        assert!(Left { files: Vec::new(), ..left(right.summary.clone(), 0) }.compare(&right).is_err());
        assert!(Left { history: 4, ..left(right.summary.clone(), 0) }.compare(&right).is_err());
    }
}
