//! Nothing is lost: runs that are killed, interrupted, robbed of their folder or started twice.

use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::{Scratch, ended};
use serde_json::Value;

/// Two coarse chambers in steps of 2.5 kPa at the most.
fn arguments(out: &str) -> Vec<String> {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/two_chamber_coarse.toml");
    let list = ["run", fixture.to_str().unwrap(), "--out", out, "--set", "solver.max_step_kpa=2.5", "--threads", "1"];
    list.map(String::from).into()
}

fn strings(list: &[String]) -> Vec<&str> {
    list.iter().map(String::as_str).collect()
}

fn lines(scratch: &Scratch, out: &str) -> usize {
    fs::read_to_string(scratch.path(out).join("history.jsonl")).map_or(0, |text| text.lines().count())
}

fn summary(scratch: &Scratch, out: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(scratch.path(out).join("summary.json")).unwrap()).unwrap()
}

/// Waits until the history has so many lines, or the program has ended.
#[track_caller]
fn wait_for(scratch: &Scratch, out: &str, count: usize, child: &mut Child) {
    let began = Instant::now();
    while lines(scratch, out) < count && child.try_wait().unwrap().is_none() {
        assert!(began.elapsed() < Duration::from_secs(120), "the program hangs");
        thread::sleep(Duration::from_millis(1));
    }
}

/// Requires the same numbers to 1e-9 of the largest in their neighbourhood; seconds may differ.
#[track_caller]
fn assert_same(path: &str, found: &Value, expected: &Value) {
    match (found, expected) {
        (Value::Object(a), Value::Object(b)) => {
            assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{path}");
            for (key, value) in a.iter().filter(|(key, _)| *key != "timing") {
                assert_same(&format!("{path}.{key}"), value, &b[key]);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                assert_same(&format!("{path}[{i}]"), a, b);
            }
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-3), "{path}: {a} and {b}");
        }
        _ => assert_eq!(found, expected, "{path}"),
    }
}

#[test]
fn a_run_killed_again_and_again_ends_with_the_results_of_one_that_never_stopped() {
    let scratch = Scratch::new("killed");
    let whole = scratch.run(&strings(&arguments("whole")));
    assert_eq!(whole.code, 0, "{whole:?}");
    let all = lines(&scratch, "whole");
    assert!(all > 40, "{all}");

    let mut killed = arguments("killed");
    killed.push("--resume".into());
    let mut kills = 0;
    for part in 1..8 {
        let mut child = scratch.start(&strings(&killed));
        wait_for(&scratch, "killed", part * all / 8, &mut child);
        kills += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(kills >= 3, "killed {kills} times");
    let last = scratch.run(&strings(&killed));
    assert_eq!(last.code, 0, "{last:?}");
    assert!(last.err.contains("going on from"), "{}", last.err);
    assert_same("summary", &summary(&scratch, "killed"), &summary(&scratch, "whole"));
    for file in ["case.toml", "fields/series.pvd"] {
        let text = |out: &str| fs::read_to_string(scratch.path(out).join(file)).unwrap();
        assert_eq!(text("killed"), text("whole"), "{file}");
    }
    assert_eq!(lines(&scratch, "killed"), all);

    // Killed after its results, before its report.
    fs::remove_file(scratch.path("killed/report.html")).unwrap();
    let again = scratch.run(&strings(&killed));
    assert!(again.code == 0 && again.err.contains("nothing is left to do"), "{again:?}");
    assert!(scratch.path("killed/report.html").exists());
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_at_the_next_iteration_and_keeps_what_is_there() {
    let scratch = Scratch::new("ctrl-c");
    let mut child = scratch.start(&strings(&arguments("out")));
    wait_for(&scratch, "out", 25, &mut child);
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let end = ended(child.wait_with_output().unwrap());
    assert_eq!(end.code, 130, "{end:?}");
    assert!(end.err.contains("interrupted at") && end.err.contains("--resume"), "{}", end.err);
    let summary = summary(&scratch, "out");
    assert_eq!(summary["status"], "interrupted");
    let steps = summary["steps"].as_array().unwrap();
    assert!(!steps.is_empty() && steps.iter().all(|step| step["converged"] == true), "{summary}");
}

/// A terminal that is closed stops a run, but not one that was started by `nohup`.
#[cfg(target_os = "linux")]
#[test]
fn the_end_of_the_terminal_is_ignored_where_the_program_was_started_so() {
    // What is ignored by the tests already, nobody can take notice of again.
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap().trim().to_owned();
    let is_ignored = u64::from_str_radix(&ignored, 16).unwrap() & 1 == 1;
    for (name, trap, code) in [("nohup", "trap '' HUP;", 0), ("terminal", "", if is_ignored { 0 } else { 130 })] {
        let scratch = Scratch::new(name);
        let mut command = Command::new("sh");
        command.args(["-c", &format!("{trap} exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_pneuflex")]);
        let piped = || std::process::Stdio::piped();
        command.args(arguments("out")).current_dir(scratch.path(".")).stdout(piped()).stderr(piped());
        let mut child = command.spawn().unwrap();
        wait_for(&scratch, "out", 10, &mut child);
        assert!(Command::new("kill").args(["-HUP", &child.id().to_string()]).status().unwrap().success());
        let end = ended(child.wait_with_output().unwrap());
        assert_eq!(end.code, code, "{name}: {end:?}");
    }
}

#[test]
fn two_runs_do_not_share_a_folder() {
    let scratch = Scratch::new("lock");
    let mut first = scratch.start(&strings(&arguments("out")));
    wait_for(&scratch, "out", 3, &mut first);
    let second = scratch.run(&strings(&arguments("out")));
    assert_eq!(second.code, 2, "{second:?}");
    assert!(second.err.contains("another run is writing to this folder"), "{}", second.err);
    let first = ended(first.wait_with_output().unwrap());
    assert_eq!(first.code, 0, "{first:?}");
}

#[test]
fn a_folder_that_goes_away_is_one_clear_error() {
    let scratch = Scratch::new("vanished");
    let mut child = scratch.start(&strings(&arguments("out")));
    wait_for(&scratch, "out", 10, &mut child);
    fs::rename(scratch.path("out"), scratch.path("elsewhere")).unwrap();
    let end = ended(child.wait_with_output().unwrap());
    assert_eq!(end.code, 1, "{end:?}");
    let errors: Vec<_> = end.err.lines().filter(|line| line.starts_with("error")).collect();
    assert!(errors.len() == 1 && errors[0].contains("gone away"), "{}", end.err);
    assert!(!scratch.path("out").exists());
}

#[cfg(unix)]
#[test]
fn a_folder_that_another_one_takes_the_place_of_is_noticed() {
    let scratch = Scratch::new("replaced");
    let mut child = scratch.start(&strings(&arguments("out")));
    wait_for(&scratch, "out", 10, &mut child);
    fs::rename(scratch.path("out"), scratch.path("elsewhere")).unwrap();
    fs::create_dir(scratch.path("out")).unwrap();
    let end = ended(child.wait_with_output().unwrap());
    // In the moment between both the folder has gone away.
    assert!(end.code == 1 && (end.err.contains("taken the place") || end.err.contains("gone away")), "{end:?}");
    assert_eq!(fs::read_dir(scratch.path("out")).unwrap().count(), 0);
}

#[test]
fn what_a_run_was_begun_with_may_not_change_but_it_may_go_further() {
    let scratch = Scratch::new("changed");
    let with = |changes: &[&str]| {
        let mut list = arguments("out");
        for change in changes {
            list.extend(["--set".into(), (*change).into()]);
        }
        list
    };
    assert_eq!(scratch.run(&strings(&with(&["load.pressure_kpa=[5, 10]"]))).code, 0);
    let resume = |changes: &[&str]| {
        let mut list = with(changes);
        list.push("--resume".into());
        scratch.run(&strings(&list))
    };
    let other = resume(&["load.pressure_kpa=[5, 10]", "material.c10=0.2"]);
    assert!(other.code == 2 && other.err.contains("material.c10 was 0.2712 and is 0.2"), "{other:?}");
    let less = resume(&["load.pressure_kpa=[7, 10]"]);
    assert!(less.code == 2 && less.err.contains("load.pressure_kpa"), "{less:?}");
    let other_fields = resume(&["load.pressure_kpa=[5, 10, 15]", "output.fields=false"]);
    assert!(other_fields.code == 2 && other_fields.err.contains("output.fields"), "{other_fields:?}");
    // 10 kPa is reached, though only its landing tells.
    let past = resume(&["load.pressure_kpa=[5, 12]"]);
    assert!(past.code == 2 && past.err.contains("load.pressure_kpa"), "{past:?}");
    let further = resume(&["load.pressure_kpa=[5, 10, 15]"]);
    assert_eq!(further.code, 0, "{further:?}");
    let steps = summary(&scratch, "out")["steps"].as_array().unwrap().len();
    assert_eq!(steps, 3);

    fs::write(scratch.path("out/checkpoint.bin"), "no checkpoint").unwrap();
    let damaged = resume(&["load.pressure_kpa=[5, 10, 15, 20]"]);
    assert!(damaged.code == 2 && damaged.err.contains("checkpoint.bin is damaged"), "{damaged:?}");
    // Results are never thrown away for want of a checkpoint.
    fs::remove_file(scratch.path("out/checkpoint.bin")).unwrap();
    let missing = resume(&["load.pressure_kpa=[5, 10, 15, 20]"]);
    assert!(missing.code == 2 && missing.err.contains("checkpoint.bin is missing"), "{missing:?}");
    assert_eq!(summary(&scratch, "out")["steps"].as_array().unwrap().len(), 3);
}
