//! `cargo xtask decks FOLDER`: how many input decks of others run, and which keywords stop the rest.
//!
//! Meant for the test suite of CalculiX (Debian's `calculix-ccx-test`, unpacked), which has a deck for every feature of that program.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use crate::program;

/// Keywords that stop fewer decks than this are not listed.
const FEW: usize = 3;

/// How a deck ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    Converged,
    NotConverged,
    Refused,
    TooLong,
    Died,
}

pub fn run(arguments: &[String]) -> ExitCode {
    match all(arguments) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(died) => {
            eprintln!("decks: {died} runs died");
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("decks: {message}");
            ExitCode::from(2)
        }
    }
}

/// How many runs died.
fn all(arguments: &[String]) -> Result<usize, String> {
    let (folder, limit) = match arguments {
        [folder] => (folder, 20.0),
        [folder, option, limit] if option == "--limit" => (folder, limit.parse().map_err(|_| "--limit takes seconds")?),
        _ => return Err("takes a folder of decks, and --limit SECONDS".to_owned()),
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let program = program::build(&root)?;
    let out = program::target_folder(&root).join("decks");
    let entries = fs::read_dir(folder).map_err(|e| format!("{folder}: {e}"))?.flatten().map(|entry| entry.path());
    let mut decks: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "inp")).collect();
    decks.sort();
    let mut ends: BTreeMap<End, Vec<String>> = BTreeMap::new();
    // Of every keyword the decks that it stops, and those that nothing else stops.
    let mut stopped: BTreeMap<String, [usize; 2]> = BTreeMap::new();
    for deck in &decks {
        let (end, said) = solve(&program, deck, &out, Duration::from_secs_f64(limit))?;
        let name = deck.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        println!("{name}: {end:?}");
        if end == End::Refused {
            let keywords = keywords(&said);
            for keyword in &keywords {
                let counts = stopped.entry(keyword.clone()).or_default();
                counts[0] += 1;
                counts[1] += usize::from(keywords.len() == 1);
            }
        }
        ends.entry(end).or_default().push(name);
    }
    println!("\n{} decks", decks.len());
    for (end, names) in &ends {
        println!("{end:?}: {}", names.len());
    }
    println!("\n| keyword | decks that it stops | of these by itself |\n|---|---|---|");
    let mut rows: Vec<_> = stopped.into_iter().filter(|(_, counts)| counts[0] >= FEW).collect();
    rows.sort_by_key(|(_, counts)| std::cmp::Reverse(*counts));
    rows.iter().for_each(|(keyword, [all, alone])| println!("| {keyword} | {all} | {alone} |"));
    Ok(ends.get(&End::Died).map_or(0, Vec::len))
}

/// Runs the program on a deck; its end and what it said.
fn solve(program: &Path, deck: &Path, out: &Path, limit: Duration) -> Result<(End, String), String> {
    let said = out.join("said.txt");
    fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
    let file = fs::File::create(&said).map_err(|e| format!("{}: {e}", said.display()))?;
    let mut child = Command::new(program)
        .arg("run")
        .arg(deck)
        .args(["--quiet", "--no-report", "--threads", "1", "--out"])
        .arg(out.join("run"))
        .stdout(Stdio::null())
        .stderr(file)
        .spawn()
        .map_err(|e| format!("the program cannot be started: {e}"))?;
    let end = match ended(&mut child, limit)? {
        None => End::TooLong,
        Some(Some(0)) => End::Converged,
        Some(Some(2)) => End::Refused,
        Some(Some(3)) => End::NotConverged,
        Some(_) => End::Died,
    };
    Ok((end, fs::read_to_string(&said).unwrap_or_default()))
}

/// Exit code of a process; `None` if it was stopped because it took too long.
fn ended(child: &mut Child, limit: Duration) -> Result<Option<Option<i32>>, String> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            return Ok(Some(status.code()));
        }
        if start.elapsed() > limit {
            child.kill().and_then(|()| child.wait()).map_err(|e| e.to_string())?;
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// The keywords that errors name first, or what else they begin with: `file:line: *KEYWORD …`.
fn keywords(said: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for line in said.lines() {
        let Some((_, text)) = line.strip_prefix("error: ").and_then(|rest| rest.split_once(": ")) else { continue };
        let keyword = match text.split_once('*').map(|(before, rest)| (before.trim(), rest)) {
            Some(("", rest)) => {
                let end = rest.find([':', ',']).into_iter().chain(rest.find(" is ")).min().unwrap_or(rest.len());
                format!("*{}", rest[..end].trim().to_uppercase())
            }
            _ => match text.split_once("elements of type ") {
                Some((_, rest)) => format!("elements {}", rest.split('"').nth(1).unwrap_or_default().to_uppercase()),
                None => text.split_whitespace().take(5).collect::<Vec<_>>().join(" "),
            },
        };
        if !found.contains(&keyword) {
            found.push(keyword);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_sorted_by_what_they_are_about() {
        let said = "note\nerror: a.inp:3: *Shell Section is not supported: why\nerror: a.inp:4: *DLOAD: BX is not supported\n\
                    error: a.inp:5: elements of type \"S8R\" cannot be solved: only\nerror: a.inp:9: *DLOAD, X is\n";
        assert_eq!(keywords(said), ["*SHELL SECTION", "*DLOAD", "elements S8R"]);
    }
}
