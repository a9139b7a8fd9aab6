//! `pneuflex table` and `pneuflex find`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::Scratch;

/// Solved within a second.
const COARSE: [&str; 5] = ["--quiet", "--no-report", "--set", "mesh.size=4.5", "--set"];

fn solve(scratch: &Scratch, case: &str, out: &str, changes: &[&str]) -> i32 {
    let mut arguments = vec!["run", case, "--out", out];
    arguments.extend(COARSE);
    arguments.push("mesh.element=hex8-q1p0");
    changes.iter().for_each(|change| arguments.extend(["--set", change]));
    scratch.run(&arguments).code
}

fn rows(text: &str) -> Vec<Vec<&str>> {
    text.lines().map(|line| line.split_whitespace().collect()).collect()
}

#[test]
fn runs_stand_side_by_side_and_those_that_stopped_say_so() {
    let scratch = Scratch::new("table");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    assert_eq!(solve(&scratch, "case.toml", "near", &["load.pressure_kpa=[5, 10]"]), 0);
    assert_eq!(solve(&scratch, "case.toml", "far", &["load.pressure_kpa=[10, 15]", "actuator.gap=3"]), 0);
    let summary: Value = serde_json::from_str(&fs::read_to_string(scratch.path("near/summary.json")).unwrap()).unwrap();
    let angles: Vec<f64> = (0..2).map(|i| summary["steps"][i]["end_face_angle_deg"].as_f64().unwrap()).collect();

    // One run: a row per pressure, rounded to five digits.
    let one = scratch.run(&["table", "near"]);
    assert_eq!((one.code, one.err.as_str()), (0, ""));
    let found = rows(&one.out);
    assert_eq!(found[0][..4], ["pressure_kpa", "end_face_angle_deg", "chord_angle_deg", "tip.x_mm"]);
    assert_eq!(found.len(), 3);
    for (row, angle) in found[1..].iter().zip(&angles) {
        assert!((row[1].parse::<f64>().unwrap() / angle - 1.0).abs() < 1e-4, "{row:?} {angle}");
    }
    // Nothing moves across the plane of symmetry, and nothing stopped.
    assert!(!one.out.contains("y_mm") && !one.out.contains("state"), "{}", one.out);

    // Two: every pressure of either, all digits, empty where there is none.
    let csv = scratch.run(&["table", "near", "far", "--as", "csv", "--columns", "end_face_angle_deg"]).out;
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines[0], ["pressure_kpa", "near: end_face_angle_deg", "far: end_face_angle_deg"]);
    assert_eq!(lines[1..].iter().map(|line| line[0]).collect::<Vec<_>>(), ["5.0", "10.0", "15.0"]);
    assert_eq!((lines[1][1].parse::<f64>().unwrap(), lines[2][1].parse::<f64>().unwrap()), (angles[0], angles[1]));
    assert_eq!((lines[1][2], lines[3][1]), ("", ""));
    let json = scratch.run(&["table", "near", "--as", "json"]).out;
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json[1]["cavity_volume_mm3"], summary["steps"][1]["cavity_volume_mm3"]);

    // A run that stopped says so in each row.
    let stopped = ["load.pressure_kpa=[5, 2000]", "solver.min_step_kpa=2", "solver.max_iterations=6"];
    assert_eq!(solve(&scratch, "case.toml", "stopped", &stopped), 3);
    let found = scratch.run(&["table", "stopped", "--columns", "state,end_face_angle_deg"]).out;
    let lines: Vec<&str> = found.lines().collect();
    assert!(lines[1].starts_with("         5.0  reached"), "{found}");
    assert!(lines.last().unwrap().trim_end().ends_with("not reached"), "{found}");
    assert!(lines[2..lines.len() - 1].iter().all(|line| line.contains("on the way")), "{found}");
}

/// A deck without cavities, probes and obstacles has the forces of its supports to tell of.
#[test]
fn a_deck_has_its_reactions() {
    let scratch = Scratch::new("table-deck");
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/decks/blocks.inp");
    assert_eq!(scratch.run(&["run", &deck.display().to_string(), "--out", "blocks", "--quiet", "--no-report"]).code, 0);
    let found = scratch.run(&["table", "blocks"]).out;
    assert!(found.lines().next().unwrap().contains("reaction.RAM.z_n"), "{found}");
}

#[test]
fn what_cannot_be_a_table_is_refused() {
    let scratch = Scratch::new("table-refused");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    assert_eq!(solve(&scratch, "case.toml", "one", &["load.pressure_kpa=[5]"]), 0);
    let bar = "*NODE, NSET=ALL\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
               *NSET, NSET=END\n1,4,5,8\n*ELEMENT, TYPE=C3D8, ELSET=BODY\n1,1,2,3,4,5,6,7,8\n\
               *MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.1,0.02\n*SOLID SECTION, ELSET=BODY, MATERIAL=M\n\
               *STEP, NLGEOM\n*STATIC\n*BOUNDARY\nEND,1,3\n*CLOAD\n7,1,0.001\n*END STEP\n";
    fs::write(scratch.path("bar.inp"), bar).unwrap();
    assert_eq!(scratch.run(&["run", "bar.inp", "--out", "bar", "--quiet", "--no-report"]).code, 0);
    let alone = scratch.run(&["table", "bar"]);
    assert!(alone.code == 0 && alone.out.trim_start().starts_with("time"), "{alone:?}");
    for (arguments, words) in [
        (&["table", "."][..], "holds no summary.json"),
        (&["table", "nowhere"], "is no folder"),
        (
            &["table", "one", "bar"],
            "one has rows by pressure_kpa, bar has rows by time: they cannot stand side by side",
        ),
        (&["table", "one", "--columns", "angle"], "--columns angle: no such column"),
    ] {
        let ended = scratch.run(arguments);
        assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{arguments:?}");
        assert!(ended.err.contains(words), "{arguments:?}: {}", ended.err);
    }
    assert!(scratch.run(&["table", "one", "--columns", "angle"]).err.contains(", chord_angle_deg, "));
}

/// What is found is where a run comes to it, whether the path or a key is searched.
#[test]
fn a_pressure_and_a_length_are_found_for_an_angle() {
    let scratch = Scratch::new("find");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    let find = |more: &[&str]| {
        let sets =
            ["--set", "mesh.size=4.5", "--set", "mesh.element=hex8-q1p0", "--set", "load.pressure_kpa=[4, 12, 20]"];
        scratch.run(&[&["find", "case.toml", "--quiet"], &sets[..], more].concat())
    };
    let angle_at = |pressure: &str, change: &str| -> f64 {
        assert_eq!(solve(&scratch, "case.toml", "run", &[&format!("load.pressure_kpa=[{pressure}]"), change]), 0);
        let text = fs::read_to_string(scratch.path("run/summary.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()["steps"][0]["end_face_angle_deg"].as_f64().unwrap()
    };
    // Before the first pressure that is asked for, and beyond it.
    for wanted in ["0.5", "3"] {
        let found = find(&["--angle", wanted]);
        assert_eq!(found.code, 0, "{found:?}");
        let pressure = found.out.lines().next().unwrap().strip_suffix(" kPa").unwrap();
        let angle = angle_at(pressure, "actuator.gap=2");
        assert!((angle / wanted.parse::<f64>().unwrap() - 1.0).abs() < 1e-5, "{pressure} kPa: {angle}");
    }
    let wanted = angle_at("20", "actuator.top_wall=1.1");
    let goal = format!("end_face_angle_deg={wanted}");
    let found = find(&["--column", &goal, "--by", "actuator.top_wall", "--between", "0.8,1.4"]);
    assert_eq!(found.code, 0, "{found:?}");
    let wall = found.out.lines().next().unwrap().strip_prefix("actuator.top_wall = ").unwrap();
    assert!((wall.parse::<f64>().unwrap() - 1.1).abs() < 1e-4, "{wall}");

    let never = find(&["--angle", "-80"]);
    assert_eq!((never.code, never.out.as_str()), (3, ""));
    assert!(never.err.contains("end_face_angle_deg = -80 is never reached: it goes from "), "{}", never.err);
    for (arguments, words) in [
        (&["--force", "1"][..], "force: there is no obstacle whose force is reported"),
        (&["--column", "angle=3"], "angle: this body has no such result"),
        (&["--column", "angle"], "--column angle: expected NAME=VALUE"),
        (&["--angle", "inf"], "no finite number"),
    ] {
        let ended = find(arguments);
        assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{arguments:?} {ended:?}");
        assert!(ended.err.contains(words), "{arguments:?}: {}", ended.err);
    }
}
