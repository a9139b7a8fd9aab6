//! Many designs: each once, whatever dies; the same on a cluster.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::support::{Ended, Scratch, ended};

const SWEEP: &str = r#"case = "cases/finger.toml"

[set]
mesh = { size = 3, element = "hex8-q1p0" }
load.pressure_kpa = [1, 2]

[space]
"actuator.gap" = [1, 1.5, 2]
material = ["dragon-skin-30", "ecoflex-00-30"]

[[design]]
actuator.gap = -1
"#;

/// A folder with a case and a sweep of it.
fn with_sweep(name: &str, text: &str) -> Scratch {
    let scratch = Scratch::new(name);
    fs::create_dir(scratch.path("cases")).unwrap();
    let made = scratch.run(&["new", "two-chamber", "cases/finger.toml"]);
    assert_eq!(made.code, 0, "{made:?}");
    fs::write(scratch.path("gaps.toml"), text).unwrap();
    scratch
}

/// The table without what differs from run to run: every row as its cells by their names.
fn table(scratch: &Scratch, folder: &str) -> Vec<Vec<(String, String)>> {
    let text = fs::read_to_string(scratch.path(folder).join("table.csv")).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let is_same = |(name, _): &(String, String)| !matches!(name.as_str(), "seconds" | "cpu_seconds");
    lines.map(|cells| names.iter().cloned().zip(cells).filter(is_same).collect()).collect()
}

fn cell<'a>(row: &'a [(String, String)], name: &str) -> &'a str {
    &row.iter().find(|(other, _)| other == name).unwrap().1
}

/// Files of finished designs, with when they were written.
fn rows(scratch: &Scratch, folder: &str) -> Vec<(String, std::time::SystemTime)> {
    let entries = fs::read_dir(scratch.path(folder).join("rows")).into_iter().flatten().flatten();
    let files = entries.filter(|entry| !entry.file_name().to_string_lossy().starts_with('.'));
    let row =
        |e: fs::DirEntry| (e.file_name().to_string_lossy().into_owned(), e.metadata().unwrap().modified().unwrap());
    let mut found: Vec<_> = files.map(row).collect();
    found.sort();
    found
}

#[test]
fn every_design_has_its_rows_and_is_solved_once() {
    let scratch = with_sweep("sweep", SWEEP);
    let done = scratch.run(&["sweep", "gaps.toml"]);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.err.contains("7 of 7 designs finished") && done.err.contains("1 failed: bad-input"), "{done:?}");
    let found = table(&scratch, "out/gaps");
    let column = |name: &str| found.iter().map(|row| cell(row, name)).collect::<Vec<_>>().join(" ");
    assert_eq!(column("design"), "0 0 1 1 2 2 3 3 4 4 5 5 6");
    assert_eq!(column("actuator.gap"), "1 1 1 1 1.5 1.5 1.5 1.5 2 2 2 2 -1");
    assert_eq!(cell(&found[2], "material"), "ecoflex-00-30");
    assert_eq!([cell(&found[0], "status"), cell(&found[12], "status")], ["converged", "bad-input"]);
    // The numbers are those of a single run.
    let set = ["mesh.size=3", "mesh.element=hex8-q1p0", "load.pressure_kpa=[1, 2]", "actuator.gap=1.5"];
    let mut arguments = vec!["run", "cases/finger.toml", "--out", "alone", "--threads", "1", "--quiet", "--no-report"];
    arguments.extend(set.iter().flat_map(|change| ["--set", change]));
    fs::write(scratch.path("one.toml"), SWEEP.replace("[1, 1.5, 2]", "[1.5]").replace("material =", "title ="))
        .unwrap();
    assert_eq!(scratch.run(&["sweep", "one.toml", "--workers", "1", "--threads", "1", "--quiet"]).code, 0);
    assert_eq!(scratch.run(&arguments).code, 0);
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(scratch.path("alone/summary.json")).unwrap()).unwrap();
    let angle: f64 = cell(&table(&scratch, "out/one")[1], "end_face_angle_deg").parse().unwrap();
    assert_eq!(summary["steps"][1]["end_face_angle_deg"].as_f64(), Some(angle));

    // Once more, with one design more and one that is there twice.
    let before = rows(&scratch, "out/gaps");
    let more = format!("{SWEEP}\n[[design]]\nactuator.gap = 2.5\n[[design]]\nactuator.gap = 2.5\n");
    fs::write(scratch.path("gaps.toml"), more).unwrap();
    let again = scratch.run(&["sweep", "gaps.toml"]);
    assert!(again.code == 0 && again.err.contains("9 of 9 designs finished"), "{again:?}");
    let after = rows(&scratch, "out/gaps");
    assert_eq!((before.len(), after.len()), (7, 8));
    assert!(before.iter().all(|row| after.contains(row)));
    // Another case needs another folder.
    let other = scratch.run(&["sweep", "gaps.toml", "--set", "actuator.width=19"]);
    assert!(other.code == 2 && other.err.contains("a sweep of another case (actuator differ)"), "{other:?}");
    fs::write(scratch.path("mine.txt"), "mine").unwrap();
    let foreign = scratch.run(&["sweep", "gaps.toml", "--out", "."]);
    assert!(foreign.code == 2 && foreign.err.contains("nothing was touched"), "{foreign:?}");
}

/// Ten designs, most of them near to another one, at a pressure at which chambers touch.
const NEAR: &str = r#"case = "cases/finger.toml"
start = "neighbours"

[set]
mesh = { size = 3, element = "hex8-q1p0" }
load.pressure_kpa = [10, 40]

[space]
actuator.gap = [1.0, 1.03, 0.96, 1.05, 1.3]
actuator.side_wall = [1.0, 1.02]
"#;

/// Two that do not come to the second pressure.
const SOFT: &str = r#"
[[design]]
actuator.gap = 1.0
actuator.side_wall = 1.0
material = "ecoflex-00-30"

[[design]]
actuator.gap = 1.0
actuator.side_wall = 1.02
material = "ecoflex-00-30"
"#;

/// Whether two tables have the same rows but for the way to them: to the last bit where no neighbour is started from, otherwise angles to 1e-8
/// and all other numbers to 1e-6.
fn check_same_states(near: &[Vec<(String, String)>], rest: &[Vec<(String, String)>]) {
    assert_eq!(near.len(), rest.len());
    let is_of_way = |name: &str| matches!(name, "iterations" | "load_steps" | "started_from");
    for (near, rest) in near.iter().zip(rest) {
        if near.iter().all(|(name, other)| name != "started_from" || other.is_empty()) {
            assert!(rest.iter().all(|(name, b)| name == "started_from" || cell(near, name) == b), "{near:?} {rest:?}");
        }
        for (name, b) in rest.iter().filter(|(name, _)| !is_of_way(name)) {
            let a = cell(near, name);
            let tolerance = if name.ends_with("angle_deg") { 1e-8 } else { 1e-6 };
            let is_close = match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) => (a - b).abs() <= tolerance * b.abs().max(1e-3),
                _ => a == b,
            };
            assert!(is_close, "{name}: {a} {b}");
        }
    }
}

fn started_from(scratch: &Scratch, folder: &str) -> Vec<String> {
    let mut found: Vec<_> = table(scratch, folder)
        .iter()
        .map(|row| [cell(row, "design"), cell(row, "started_from")].map(str::to_owned))
        .collect();
    found.dedup();
    found.into_iter().map(|[_, other]| other).collect()
}

#[test]
fn designs_that_start_from_neighbours_have_the_same_table() {
    let scratch = with_sweep("sweep-neighbours", &format!("{NEAR}{SOFT}"));
    let sweep = |out: &str, more: &[&str]| {
        let ended = scratch.run(&[&["sweep", "gaps.toml", "--threads", "1", "--quiet", "--out", out], more].concat());
        assert_eq!(ended.code, 0, "{ended:?}");
        let found = table(&scratch, out);
        // From what has ended early no other one starts. Its message has commas.
        let (ended_early, found): (Vec<_>, Vec<_>) =
            found.into_iter().partition(|row| !cell(row, "material").is_empty());
        assert!(ended_early.len() >= 2 && ended_early.iter().all(|row| cell(row, "status") == "not-converged"));
        found
    };
    let near = sweep("near", &["--workers", "2"]);
    let [mut first, mut last] = [["0"; 8].to_vec(), vec!["", "8", "", ""]];
    first[0] = "";
    first.append(&mut last);
    assert_eq!(started_from(&scratch, "near"), first);
    // What others started from is of no use any more.
    assert!(!scratch.path("near/neighbours").exists());
    // Whichever worker was faster, to the last bit.
    assert!(sweep("one", &["--workers", "1"]) == near);
    fs::write(scratch.path("gaps.toml"), format!("{NEAR}{SOFT}").replace("\"neighbours\"", "\"rest\"")).unwrap();
    let rest = sweep("rest", &[]);
    assert!(rest.iter().filter(|row| cell(row, "contact.gaps_in_contact") == "1").count() > 4);
    check_same_states(&near, &rest);
    let count = |table: &[Vec<(String, String)>]| -> usize {
        table.iter().map(|row| cell(row, "iterations").parse::<usize>().unwrap()).sum()
    };
    println!("{} iterations, from rest {}", count(&near), count(&rest));
    assert!(count(&near) < count(&rest), "{} {}", count(&near), count(&rest));
}

#[test]
fn jobs_start_from_neighbours_of_their_own_and_do_without_damaged_ones() {
    let text = NEAR.replace(", 1.02]", "]");
    let scratch = with_sweep("sweep-neighbours-jobs", &text);
    let job = |more: &[&str]| {
        let ended =
            scratch.run(&[&["sweep", "gaps.toml", "--threads", "1", "--quiet", "--out", "jobs"], more].concat());
        assert_eq!(ended.code, 0, "{ended:?}");
    };
    job(&["--only", "0-1"]);
    job(&["--only", "2-3"]);
    job(&["--only", "4"]);
    assert!(scratch.path("jobs/neighbours").exists());
    job(&["--join"]);
    let before = table(&scratch, "jobs");
    assert_eq!(started_from(&scratch, "jobs"), ["", "0", "", "2", ""]);
    assert!(!scratch.path("jobs/neighbours").exists());
    // Again, with jobs that are killed between their two designs; what they left is damaged meanwhile, or lost.
    fs::rename(scratch.path("jobs"), scratch.path("first")).unwrap();
    job(&["--only", "0-1"]);
    job(&["--only", "2-3"]);
    let plan: Value = serde_json::from_str(&fs::read_to_string(scratch.path("jobs/sweep.json")).unwrap()).unwrap();
    let name = |number: usize| plan["designs"][number]["identity"].as_str().unwrap().to_owned();
    for number in [1, 3] {
        fs::remove_file(scratch.path("jobs/rows").join(format!("{}.json", name(number)))).unwrap();
    }
    let file = scratch.path("jobs/neighbours").join(format!("{}.bin", name(0)));
    let mut bytes = fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&file, bytes).unwrap();
    fs::remove_file(scratch.path("jobs/neighbours").join(format!("{}.bin", name(2)))).unwrap();
    job(&["--only", "0-1"]);
    job(&["--only", "2-4"]);
    job(&["--join"]);
    let text = fs::read_to_string(scratch.path("jobs/table.csv")).unwrap();
    assert!(!text.contains("started_from"), "{text}");
    check_same_states(&before, &table(&scratch, "jobs"));
}

#[test]
fn slips_name_the_file_the_key_and_what_is_allowed() {
    let scratch = with_sweep("sweep-slips", SWEEP);
    for (from, to, words) in [
        (
            "\"actuator.gap\"",
            "\"actuator.gpa\"",
            &["gaps.toml:8:1: unknown key `actuator.gpa`", "did you mean `gap`"][..],
        ),
        (
            "[1, 1.5, 2]",
            "[]",
            &["gaps.toml:8:1: space.actuator.gap = [] is out of range: must have at least one value"],
        ),
        ("[1, 1.5, 2]", "{ from = 2, to = 1 }", &["must be from a number to one that is not smaller"]),
        ("[1, 1.5, 2]", "{ from = 1, to = 2 }", &["sample = \"latin-hypercube\""]),
        ("[1, 1.5, 2]", "1.5", &["space.actuator.gap = 1.5 is out of range: must be a list of values"]),
        ("load.pressure_kpa = [1, 2]", "load.pressure = [1, 2]", &["gaps.toml:5:6: unknown key `load.pressure`"]),
        ("dragon-skin-30", "dragon-skin-31", &["gaps.toml:9:1: no material \"dragon-skin-31\"", "pneuflex materials"]),
        ("[set]", "sampel = 1\n[set]", &["unknown key `sampel`", "did you mean `sample`"]),
        ("[set]", "sample = \"sobol\"\n[set]", &["designs", "a sample needs the number of its designs"]),
        ("[set]", "sample = \"sobol\"\ndesigns = 70000\n[set]", &["designs = 70000 is out of range", "1 to 65536"]),
        ("[set]", "designs = 5\n[set]", &["designs = 5 is out of range: must be left out of a grid"]),
        ("finger.toml", "thumb.toml", &["thumb.toml", "cannot be read"]),
    ] {
        assert!(SWEEP.contains(from), "{from}");
        fs::write(scratch.path("gaps.toml"), SWEEP.replace(from, to)).unwrap();
        let end = scratch.run(&["sweep", "gaps.toml"]);
        assert_eq!(end.code, 2, "{to}: {end:?}");
        for word in words {
            assert!(end.err.contains(word), "{to}: {}", end.err);
        }
        assert!(!scratch.path("out").exists(), "{to}");
    }
    fs::write(scratch.path("gaps.toml"), SWEEP).unwrap();
    let end = scratch.run(&["sweep", "gaps.toml", "--only", "7"]);
    assert!(end.code == 2 && end.err.contains("there is no design 7") && !scratch.path("out").exists(), "{end:?}");
}

#[test]
fn a_template_need_not_be_complete() {
    let scratch = with_sweep("sweep-template", SWEEP);
    let case = fs::read_to_string(scratch.path("cases/finger.toml")).unwrap();
    let without = case.lines().filter(|line| !line.starts_with("gap = ")).collect::<Vec<_>>().join("\n");
    assert_ne!(without.lines().count(), case.lines().count());
    fs::write(scratch.path("cases/finger.toml"), without).unwrap();
    assert_eq!(scratch.run(&["check", "cases/finger.toml"]).code, 2);
    let end = scratch.run(&["sweep", "gaps.toml", "--only", "0-2", "--quiet"]);
    assert_eq!((end.code, rows(&scratch, "out/gaps").len()), (0, 3), "{end:?}");
}

#[test]
fn what_changes_meanwhile_is_no_result() {
    let scratch = with_sweep("sweep-model", "case = \"cases/brick.toml\"\n[space]\n\"load.times\" = [[0.5], [1.0]]\n");
    let deck = |height: f64| {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let nodes = [0.0, height].into_iter().flat_map(|z| corners.map(|[x, y]| format!("{x}, {y}, {z}")));
        let nodes: String = nodes.enumerate().map(|(i, at)| format!("{}, {at}\n", i + 1)).collect();
        format!(
            "*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=BAR\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=FOOT\n1, 2, 3, 4\n\
             *NSET, NSET=TOP\n5, 6, 7, 8\n\
             *MATERIAL, NAME=SILICONE\n*HYPERELASTIC, NEO HOOKE\n0.1, 0.1\n*SOLID SECTION, ELSET=BAR, MATERIAL=SILICONE\n\
             *BOUNDARY\nFOOT, 1, 3\n*STEP, NLGEOM\n*STATIC\n1., 1.\n*BOUNDARY\nTOP, 3, 3, 0.1\n*END STEP\n"
        )
    };
    fs::write(scratch.path("cases/brick.inp"), deck(2.0)).unwrap();
    fs::write(scratch.path("cases/brick.toml"), "[model]\nfile = \"brick.inp\"\n[load]\ntimes = [1.0]\n").unwrap();
    let end = scratch.run(&["sweep", "gaps.toml", "--quiet"]);
    assert_eq!(end.code, 0, "{end:?}");
    let energies: Vec<f64> =
        table(&scratch, "out/gaps").iter().map(|row| cell(row, "strain_energy_mj").parse().unwrap()).collect();
    assert!((3.8..4.0).contains(&(energies[1] / energies[0])), "{energies:?}");
    fs::write(scratch.path("cases/brick.inp"), deck(4.0)).unwrap();
    let other = scratch.run(&["sweep", "gaps.toml", "--quiet"]);
    assert!(other.code == 2 && other.err.contains("its mesh, its deck or what that includes differs"), "{other:?}");
}

#[test]
fn fields_and_reports_are_kept_when_asked_for() {
    let scratch = with_sweep("sweep-fields", &format!("fields = true\n{SWEEP}"));
    assert_eq!(scratch.run(&["sweep", "gaps.toml", "--only", "5", "--quiet"]).code, 0);
    let [(row, _)] = &rows(&scratch, "out/gaps")[..] else { panic!("not one row") };
    let folder = scratch.path("out/gaps/designs").join(row.trim_end_matches(".json"));
    assert!(folder.join("report.html").is_file() && folder.join("fields/step_02.vtu").is_file());
}

/// The script's command, called by hand for every index as a scheduler calls it.
const SBATCH: &str = r#"#!/usr/bin/env bash
set -eu
for word in "$@"; do
    case "$word" in
        --array=*) array="${word#--array=}" ;;
        --wrap=*) wrap="${word#--wrap=}" ;;
        --dependency=*) echo "$word" >> dependencies ;;
    esac
done
if [ -n "${array:-}" ]; then
    for index in $(seq "${array%-*}" "${array#*-}"); do SLURM_ARRAY_TASK_ID=$index bash -c "$wrap"; done
    echo 17
else
    bash -c "$wrap"
fi
"#;

const HQ: &str = r#"#!/usr/bin/env bash
set -eu
for word in "$@"; do
    shift
    case "$word" in
        --array=*) array="${word#--array=}" ;;
        --) break ;;
    esac
done
for index in $(seq "${array%-*}" "${array#*-}"); do HQ_TASK_ID=$index "$@"; done
"#;

#[cfg(unix)]
#[test]
fn scripts_of_clusters_end_with_the_same_table() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = with_sweep("sweep scripts", SWEEP);
    assert_eq!(scratch.run(&["sweep", "gaps.toml", "--threads", "1", "--quiet"]).code, 0);
    let expected = table(&scratch, "out/gaps");
    fs::create_dir(scratch.path("bin")).unwrap();
    for (name, text) in [("sbatch", SBATCH), ("hq", HQ)] {
        fs::write(scratch.path("bin").join(name), text).unwrap();
        fs::set_permissions(scratch.path("bin").join(name), fs::Permissions::from_mode(0o755)).unwrap();
    }
    let path = format!("{}:{}", scratch.path("bin").display(), std::env::var("PATH").unwrap());
    for scheduler in ["slurm", "hq"] {
        let out = format!("it's {scheduler}");
        let script = scratch.run(&["sweep", "gaps.toml", "--out", &out, "--emit", scheduler]);
        assert!(script.code == 0 && !scratch.path(&out).exists(), "{script:?}");
        fs::write(scratch.path("job.sh"), &script.out).unwrap();
        let bash = |arguments: &[&str]| -> Ended {
            let mut command = Command::new("bash");
            command.args(arguments).arg("job.sh").current_dir(scratch.path(".")).env("PATH", &path);
            ended(command.output().unwrap())
        };
        assert_eq!(bash(&["-n"]).code, 0, "{}", script.out);
        let done = bash(&[]);
        assert_eq!(done.code, 0, "{done:?}");
        assert_eq!(table(&scratch, &out), expected, "{scheduler}");
    }
    let dependencies = fs::read_to_string(scratch.path("dependencies")).unwrap();
    assert_eq!(dependencies, "--dependency=afterany:17\n");
}

/// Processes that a process has started.
#[cfg(target_os = "linux")]
fn children(pid: u32) -> Vec<u32> {
    let tasks = fs::read_dir(format!("/proc/{pid}/task")).into_iter().flatten().flatten();
    let text = |task: fs::DirEntry| fs::read_to_string(task.path().join("children")).unwrap_or_default();
    let words: String = tasks.map(text).collect();
    words.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

#[cfg(target_os = "linux")]
fn kill(pid: u32, signal: nix::sys::signal::Signal) {
    nix::sys::signal::kill(nix::unistd::Pid::from_raw(pid as i32), signal).unwrap();
}

#[cfg(target_os = "linux")]
#[track_caller]
fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let began = std::time::Instant::now();
    while !is_so() {
        assert!(began.elapsed() < std::time::Duration::from_secs(120), "never: {what}");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

/// The same while a program runs, whose words are shown if it ends before.
#[cfg(target_os = "linux")]
#[track_caller]
fn wait_while_running(driver: &mut std::process::Child, what: &str, mut is_so: impl FnMut(u32) -> bool) {
    wait_until(what, || {
        if is_so(driver.id()) {
            return true;
        }
        if driver.try_wait().unwrap().is_some() {
            let words = |pipe: Option<&mut dyn std::io::Read>| {
                pipe.map(|pipe| std::io::read_to_string(pipe).unwrap_or_default()).unwrap_or_default()
            };
            let out = words(driver.stdout.as_mut().map(|pipe| pipe as _));
            panic!("ended before {what}: {out}{}", words(driver.stderr.as_mut().map(|pipe| pipe as _)));
        }
        false
    });
}

#[cfg(target_os = "linux")]
const LONG: &str = r#"case = "cases/finger.toml"
sample = "latin-hypercube"
designs = 12
[set]
mesh = { size = 2.5, element = "hex8-q1p0" }
load.pressure_kpa = [1, 2, 3]
[space]
actuator.gap = { from = 1, to = 2.0 }
"#;

#[cfg(target_os = "linux")]
#[test]
fn killed_workers_and_drivers_lose_and_repeat_nothing() {
    use nix::sys::signal::Signal;
    let scratch = with_sweep("sweep-killed", LONG);
    let arguments = ["sweep", "gaps.toml", "--workers", "2", "--threads", "1"];
    let mut driver = scratch.start(&arguments);
    let count = || rows(&scratch, "out/gaps").len();
    wait_while_running(&mut driver, "a design is finished", |_| count() > 0);
    // Two workers die, one after the other, then the driver.
    for _ in 0..2 {
        let before = count();
        wait_while_running(&mut driver, "there are workers", |driver| children(driver).len() == 2);
        kill(children(driver.id())[0], Signal::SIGKILL);
        wait_while_running(&mut driver, "it goes on", |_| count() > before);
    }
    let orphans = children(driver.id());
    driver.kill().unwrap();
    driver.wait().unwrap();
    let is_alive = |pid: &u32| fs::read_to_string(format!("/proc/{pid}/stat")).is_ok_and(|stat| !stat.contains(") Z "));
    wait_until("no worker outlives its driver", || !orphans.iter().any(is_alive));
    let before = rows(&scratch, "out/gaps");
    assert!((3..12).contains(&before.len()) && orphans.len() == 2, "{before:?} {orphans:?}");
    let end = scratch.run(&arguments);
    assert_eq!(end.code, 0, "{end:?}");
    let after = rows(&scratch, "out/gaps");
    assert!(after.len() == 12 && before.iter().all(|row| after.contains(row)));
    let found = table(&scratch, "out/gaps");
    let designs: Vec<usize> = found.iter().map(|row| cell(row, "design").parse().unwrap()).collect();
    assert_eq!(designs, (0..36).map(|i| i / 3).collect::<Vec<_>>());
    assert!(found.iter().all(|row| cell(row, "status") == "converged"));
    // What was being written when somebody died is gone.
    assert_eq!(fs::read_dir(scratch.path("out/gaps/rows")).unwrap().count(), 12);
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_a_sweep_and_keeps_what_is_finished() {
    use nix::sys::signal::Signal;
    let scratch = with_sweep("sweep-ctrl-c", LONG);
    let mut driver = scratch.start(&["sweep", "gaps.toml", "--workers", "2", "--threads", "1"]);
    wait_while_running(&mut driver, "there are workers", |driver| children(driver).len() == 2);
    wait_while_running(&mut driver, "a design is finished", |_| !rows(&scratch, "out/gaps").is_empty());
    let workers = children(driver.id());
    // Nobody else solves in this folder meanwhile.
    let other = scratch.run(&["sweep", "gaps.toml"]);
    assert!(other.code == 2 && other.err.contains("another sweep is writing to this folder"), "{other:?}");
    kill(driver.id(), Signal::SIGINT);
    let end = ended(driver.wait_with_output().unwrap());
    assert_eq!(end.code, 130, "{end:?}");
    assert!(end.err.contains("designs are left: the same command tries them again"), "{end:?}");
    assert_eq!(workers.len(), 2);
    assert!(!workers.iter().any(|pid| Path::new(&format!("/proc/{pid}")).exists()));
    let open = table(&scratch, "out/gaps").iter().filter(|row| cell(row, "status") == "open").count();
    assert!((1..12).contains(&open), "{open}");
}
