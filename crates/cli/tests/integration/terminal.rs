//! What a terminal shows: no line beyond its last column, one line for an iteration.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use nix::pty::{OpenptyResult, Winsize, openpty};

use crate::support::Scratch;

/// Columns of the terminal.
const COLUMNS: u16 = 80;

/// What the program prints on a terminal, both streams; control sequences are left out, and what overwrites a line is a line.
fn shown(scratch: &Scratch, arguments: &[&str], wanted_columns: Option<&str>) -> Vec<String> {
    let size = Winsize { ws_row: 40, ws_col: COLUMNS, ws_xpixel: 0, ws_ypixel: 0 };
    let OpenptyResult { master, slave } = openpty(&size, None).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneuflex"));
    command.args(arguments).current_dir(scratch.path(".")).env_remove("COLUMNS").env("TERM", "xterm");
    wanted_columns.map(|columns| command.env("COLUMNS", columns));
    let mut child = command.stdout(Stdio::from(slave.try_clone().unwrap())).stderr(Stdio::from(slave)).spawn().unwrap();
    // What holds the terminal open here has to go, or reading never ends.
    drop(command);
    let (mut terminal, mut bytes, mut part) = (File::from(master), Vec::new(), [0; 4096]);
    // Linux ends a terminal that nobody holds open with an error.
    while let Ok(count @ 1..) = terminal.read(&mut part) {
        bytes.extend_from_slice(&part[..count]);
    }
    child.wait().unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let mut plain = String::new();
    let mut rest = text.chars();
    while let Some(c) = rest.next() {
        if c == '\u{1b}' {
            // A control sequence ends with a letter.
            let _ = rest.find(char::is_ascii_alphabetic);
        } else {
            plain.push(c);
        }
    }
    plain.split(['\n', '\r']).map(str::to_owned).filter(|line| !line.is_empty()).collect()
}

/// Files of the fixtures in a folder of their own, where their names are short.
fn scratch_with(name: &str, files: &[&str]) -> Scratch {
    let scratch = Scratch::new(name);
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    for file in files {
        let to = Path::new(file).file_name().unwrap().to_str().unwrap();
        fs::copy(fixtures.join(file), scratch.path(to)).unwrap();
    }
    scratch
}

/// Words of lines that the edge of a terminal cuts. What the bar's lines are filled up with is no line break.
fn cut_words(lines: &[String], columns: usize) -> Vec<String> {
    let mut cut = Vec::new();
    for line in lines {
        let columns_of_line: Vec<char> = line.chars().collect();
        let edges = (columns..columns_of_line.len()).step_by(columns);
        for edge in edges.filter(|&edge| columns_of_line[edge - 1] != ' ' && columns_of_line[edge] != ' ') {
            cut.push(columns_of_line[edge.saturating_sub(20)..].iter().take(40).collect());
        }
    }
    cut
}

#[test]
fn no_line_is_cut_by_the_edge_of_the_terminal() {
    let files = ["stops/nothing_holds.inp", "stops/q1p0_pulled_bar.inp", "two_chamber_coarse.toml"];
    let scratch = scratch_with("terminal", &files);
    let commands: [&[&str]; 5] = [
        &["check", "nothing_holds.inp"],
        &["check", "two_chamber_coarse.toml", "--set", "mesh.resolution=draft"],
        &["check", "two_chamber_coarse.toml", "--set", "mesh.edge_sice=1"],
        &["run", "q1p0_pulled_bar.inp", "--no-report", "--out", "result"],
        &["run", "--help"],
    ];
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    for arguments in commands {
        let lines = shown(&scratch, arguments, None);
        assert!(lines.len() > 1, "{arguments:?}: {lines:#?}");
        assert_eq!(cut_words(&lines, COLUMNS.into()), [""; 0], "{arguments:?}: {lines:#?}");
    }
    // The same in a pipe, where it may be as long as it is.
    let piped = scratch.run(&["check", "nothing_holds.inp"]);
    assert!(piped.err.lines().any(|line| line.len() > COLUMNS.into()), "{}", piped.err);
    let narrow = shown(&scratch, &["check", "two_chamber_coarse.toml"], Some("60"));
    assert!(narrow.iter().all(|line| line.chars().count() <= 60), "{narrow:#?}");
    let wide = scratch.run(&["check", "two_chamber_coarse.toml"]);
    assert_eq!(words(&narrow.join("\n")), words(&format!("{}{}", wide.err, wide.out)));
}

#[test]
fn an_iteration_is_one_line() {
    let scratch = scratch_with("iterations", &["stops/q1p0_pulled_bar.inp"]);
    let arguments = ["run", "q1p0_pulled_bar.inp", "--no-report", "--out", "result"];
    let ended = scratch.run(&arguments);
    let iterations: Vec<&str> = ended.err.lines().filter(|line| line.starts_with("  iteration ")).collect();
    assert!(iterations.len() > 3, "{}", ended.err);
    let is_whole = |line: &&str| line.len() <= COLUMNS.into() && line.ends_with(" contact points");
    assert!(iterations.iter().all(is_whole), "{}", ended.err);
}
