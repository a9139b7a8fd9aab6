//! `pneuflex identify` and `pneuflex design`: from results to inputs.

use std::fs;

use serde_json::Value;

use crate::support::Scratch;

const COARSE: &str = "\"mesh.size\" = 9\n\"mesh.element\" = \"hex8-q1p0\"\n";

fn json(scratch: &Scratch, file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(scratch.path(file)).unwrap()).unwrap()
}

/// A case and a table of what a piece of another stiffness and another wall does.
fn measured(name: &str) -> Scratch {
    let scratch = Scratch::new(name);
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    let set = [
        "mesh.size=9",
        "mesh.element=hex8-q1p0",
        "load.pressure_kpa=[4, 8]",
        "material.c10=0.3",
        "actuator.top_wall=1.1",
    ];
    let set: Vec<&str> = set.iter().flat_map(|change| ["--set", change]).collect();
    assert_eq!(
        scratch.run(&[&["run", "case.toml", "--out", "piece", "--quiet", "--no-report"], &set[..]].concat()).code,
        0
    );
    let table = scratch.run(&["table", "piece", "--as", "csv", "--columns", "end_face_angle_deg,tip"]);
    fs::write(scratch.path("piece.csv"), format!("# by a camera\n{}", table.out)).unwrap();
    let variables = "\"material.c10\" = { from = 0.1, to = 1 }\nactuator.top_wall = { from = 0.5, to = 2 }\n";
    let text = format!("case = \"case.toml\"\ndata = \"piece.csv\"\n[set]\n{COARSE}[variables]\n{variables}");
    fs::write(scratch.path("piece.toml"), text).unwrap();
    scratch
}

#[test]
fn constants_and_lengths_are_found_again_and_a_search_goes_on() {
    let scratch = measured("identify");
    let ended = scratch.run(&["identify", "piece.toml"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let found = json(&scratch, "out/piece/identified.json");
    let value = |number: usize| found["values"][number]["value"].as_f64().unwrap();
    assert!((value(0) - 0.3).abs() < 1e-5 && (value(1) - 1.1).abs() < 1e-5, "{found}");
    assert!(found["values"][0]["half_width"].as_f64().unwrap() < 1e-4, "{found}");
    assert!(ended.out.contains("material.c10") && ended.err.contains("solution 1: misfit"), "{ended:?}");
    // The case that is written is the one that was found.
    let case: toml::Table = fs::read_to_string(scratch.path("out/piece/case.toml")).unwrap().parse().unwrap();
    assert_eq!(case["material"]["c10"].as_float(), Some(value(0)));

    // Of what was solved nothing is solved again; the rest is what a search in one go finds.
    let mut history = json(&scratch, "out/piece/history.json");
    let all = history["designs"].as_array().unwrap().len();
    assert!(all >= 3 && all == found["solutions"], "{all}");
    history["designs"].as_array_mut().unwrap().truncate(2);
    fs::write(scratch.path("out/piece/history.json"), history.to_string()).unwrap();
    let again = scratch.run(&["identify", "piece.toml", "--resume"]);
    assert_eq!(again.code, 0, "{again:?}");
    assert_eq!(again.err.matches("(known)").count(), 2, "{again:?}");
    let resumed = json(&scratch, "out/piece/identified.json");
    assert!((resumed["values"][0]["value"].as_f64().unwrap() - value(0)).abs() < 1e-8);
    // Of another case nothing is.
    let other = scratch.run(&["identify", "piece.toml", "--resume", "--set", "actuator.width=19"]);
    assert!(other.code == 2 && other.err.contains("designs of another case"), "{other:?}");
}

#[test]
fn what_cannot_be_told_apart_is_said() {
    let scratch = measured("identify-apart");
    let text = fs::read_to_string(scratch.path("piece.toml")).unwrap();
    // Without contact the angle is a function of the pressure over the stiffness, and that of no contact of its stiffness.
    let set = "\"contact.method\" = \"none\"\n\"actuator.channel.half_width\" = 0\n\"load.chamber_factor\" = [1.0, 1.0]\n\
               material = { law = \"neo-hooke\", c10 = 0.3, bulk_modulus = 1000 }\n[variables]\n\
               air = { keys = [\"load.chamber_factor[1]\", \"load.chamber_factor[2]\"], from = 0.05, to = 20 }\n";
    let text = text.replace("[variables]\n", set).replace("actuator.top_wall = { from = 0.5, to = 2 }\n", "");
    fs::write(scratch.path("apart.toml"), text).unwrap();
    let ended = scratch.run(&["identify", "apart.toml", "--quiet"]);
    assert!(ended.out.contains("hardly tell air and material.c10 apart"), "{ended:?}");
}

#[test]
fn bad_input_is_refused_before_anything_is_solved() {
    let scratch = measured("identify-bad");
    let text = fs::read_to_string(scratch.path("piece.toml")).unwrap();
    let data = fs::read_to_string(scratch.path("piece.csv")).unwrap();
    fs::write(scratch.path("bar.inp"), "*NODE\n").unwrap();
    for (from, to, words) in [
        ("from = 0.1", "from = 2", "bad.toml:7:1: variables.material.c10"),
        ("to = 1 }", "to = 1, start = 3 }", "must start between its bounds"),
        ("material.c10", "material.c11", "c11"),
        ("actuator.top_wall", "mesh.size", "the elements stay what they are"),
        ("\"mesh.size\" = 9", "\"mesh.sise\" = 9", "bad.toml:4:1: unknown key `mesh.sise`"),
        ("from = 0.5", "from = 1.5", "the value in the case must be between the bounds"),
        ("piece.csv", "no.csv", "no.csv: cannot be read"),
        ("data =", "noise.angle = 1\ndata =", "noise.angle"),
        ("data =", "columns = [\"tip.y\"]\ndata =", "no column is called \"tip.y\""),
        ("data =", "solutions = 0\ndata =", "must be a whole number"),
        ("case.toml", "bar.inp", "a deck has no keys"),
    ] {
        fs::write(scratch.path("bad.toml"), text.replacen(from, to, 1)).unwrap();
        let ended = scratch.run(&["identify", "bad.toml"]);
        assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{to}: {ended:?}");
        assert!(ended.err.contains(words), "{to}: {}", ended.err);
    }
    for (from, to, words) in [
        ("tip.x_mm", "tip.w_mm", "no derivative of tip.w_mm: this body has no such result"),
        ("pressure_kpa", "pressure", "no column is called pressure_kpa or time"),
        ("\n4", "\nx", "line 3, pressure_kpa: \"x.0\" is no number"),
        ("\n4", "\n0", "at 0 the body is at rest"),
    ] {
        fs::write(scratch.path("piece.csv"), data.replacen(from, to, 1)).unwrap();
        let ended = scratch.run(&["identify", "piece.toml"]);
        assert_eq!(ended.code, 2, "{to}: {ended:?}");
        assert!(ended.err.contains(words), "{to}: {}", ended.err);
    }
    assert!(!scratch.path("out").exists());
}

/// A case of two lengths, and what is wanted of it.
fn wanted(name: &str, goals: &str) -> Scratch {
    let scratch = Scratch::new(name);
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    let variables = "\"actuator.base\" = { from = 3.2, to = 6 }\nwalls = { keys = [\"actuator.side_wall\", \"actuator.top_wall\"], from = 0.8, to = 2 }\n";
    let text = format!("case = \"case.toml\"\n[set]\n{COARSE}[variables]\n{variables}{goals}");
    fs::write(scratch.path("goal.toml"), text).unwrap();
    scratch
}

/// What another piece does is wanted of this one, and it becomes that piece.
#[test]
fn targets_are_met_and_the_case_that_is_written_has_them() {
    let scratch = wanted("design", "");
    let solve = |case: &str, more: &[&str]| {
        let run = scratch.run(&[&["run", case, "--out", "made", "--no-report", "--quiet"], more].concat());
        assert_eq!(run.code, 0, "{run:?}");
        let made = json(&scratch, "made/summary.json");
        [&made["steps"][1]["end_face_angle_deg"], &made["steps"][0]["cavity_volume_mm3"]].map(|x| x.as_f64().unwrap())
    };
    let set = [
        "mesh.size=9",
        "mesh.element=hex8-q1p0",
        "load.pressure_kpa=[4, 8]",
        "actuator.base=4.4",
        "actuator.side_wall=1.1",
        "actuator.top_wall=1.1",
    ];
    let [angle, volume] = solve("case.toml", &set.iter().flat_map(|change| ["--set", change]).collect::<Vec<_>>());
    let goals = format!(
        "[[target]]\nresult = \"end_face_angle\"\nat = 8\nvalue = {angle}\nwithin = 0.001\n\
         [[target]]\nresult = \"cavity_volume\"\nat = 4\nvalue = {volume}\nwithin = 0.1\n"
    );
    let text = fs::read_to_string(scratch.path("goal.toml")).unwrap();
    fs::write(scratch.path("goal.toml"), format!("{text}{goals}")).unwrap();
    let ended = scratch.run(&["design", "goal.toml"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert!(ended.err.contains("all targets are met"), "{ended:?}");
    let found = json(&scratch, "out/goal/designed.json");
    assert!((found["values"][0]["value"].as_f64().unwrap() - 4.4).abs() < 0.05, "{found}");
    let made = solve("out/goal/case.toml", &[]);
    assert!((made[0] - angle).abs() <= 1e-3 && (made[1] - volume).abs() <= 0.1, "{made:?}");
}

/// The least pressure that bends by an angle, with walls of a thickness together.
#[test]
fn an_extreme_ends_at_its_limits() {
    let goals = "[[extreme]]\nleast = \"load.pressure_kpa\"\n[[limit]]\nresult = \"end_face_angle\"\nat_least = 2.0\n\
                 [[limit]]\nsum = { \"actuator.base\" = 1, walls = 2 }\nat_least = 5.5\n";
    let scratch = wanted("design-extreme", goals);
    let text = fs::read_to_string(scratch.path("goal.toml")).unwrap();
    let text = text.replace(
        "[variables]\n",
        "\"load.pressure_kpa\" = [6]\n[variables]\n\"load.pressure_kpa\" = { from = 2, to = 20 }\n",
    );
    fs::write(scratch.path("goal.toml"), text).unwrap();
    let ended = scratch.run(&["design", "goal.toml"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert!(ended.err.contains("what keeps it from being better: end_face_angle at least 2, "), "{ended:?}");
    let found = json(&scratch, "out/goal/designed.json");
    let value = |name: &str| {
        let values = found["values"].as_array().unwrap();
        values.iter().find(|value| value["name"] == name).unwrap()["value"].as_f64().unwrap()
    };
    assert!((found["limits"][0]["value"].as_f64().unwrap() - 2.0).abs() < 1e-3, "{found}");
    assert!((value("actuator.base") + 2.0 * value("walls") - 5.5).abs() < 1e-3, "{found}");
    assert_eq!(found["limits"][1]["is_active"], true);
}

/// Two starts of which neither gets there, by a variable of a table that is called by its name; gone on with, nothing is solved again.
#[test]
fn a_search_begins_as_often_as_is_asked_for_and_keeps_the_best_end() {
    let plane = "[[obstacle]]\nname = \"table\"\nshape = \"plane\"\npoint = [0, 0, -0.1]\nnormal = [0, 0, 1]\n";
    let goal = "[[target]]\nresult = \"force\"\nat = 4\nvalue = 9\nwithin = 1\n";
    let scratch = wanted("design-starts", goal);
    let case = fs::read_to_string(scratch.path("case.toml")).unwrap();
    fs::write(scratch.path("case.toml"), format!("{case}\n{plane}")).unwrap();
    let text = fs::read_to_string(scratch.path("goal.toml")).unwrap();
    let (head, tail) = text.split_once("\"actuator.base\"").unwrap();
    let (_, tail) = tail.split_once('\n').unwrap();
    let place = "\"obstacle.table.point.z\" = { from = -0.12, to = -0.04 }\n";
    fs::write(scratch.path("goal.toml"), format!("starts = 2\nsolutions = 2\n{head}{place}{tail}")).unwrap();
    let ended = scratch.run(&["design", "goal.toml"]);
    assert_eq!(ended.code, 3, "{ended:?}");
    // Between them a table that the piece does not reach: without a force that has none has no derivative, either.
    for words in [
        "start 1 of 2, solution 1: ",
        "start 2 of 2, solution 3: none, beginning elsewhere",
        "start 2 of 2, solution 5: ",
    ] {
        assert!(ended.err.contains(words), "{words}: {ended:?}");
    }
    assert!(
        ended.out.contains("start 2: no results\nstart 3: objective ") && ended.out.matches(", the best").count() == 1,
        "{ended:?}"
    );
    let found = json(&scratch, "out/goal/designed.json");
    let starts = found["starts"].as_array().unwrap();
    let best = starts.iter().find(|start| start["is_best"] == true).unwrap()["objective"].as_f64().unwrap();
    let objectives: Vec<f64> = starts.iter().filter_map(|start| start["objective"].as_f64()).collect();
    assert!(objectives.len() == 2 && objectives.iter().all(|objective| best <= *objective), "{found}");
    let written = fs::read_to_string(scratch.path("out/goal/case.toml")).unwrap();
    assert!(written.contains(&format!("{}", found["values"][0]["value"])), "{written}");
    let page = fs::read_to_string(scratch.path("out/goal/report.html")).unwrap();
    assert!(page.contains("Why it ended: not converged after 5 solutions") && page.contains("obstacle.table.point.z"));
    let again = scratch.run(&["design", "goal.toml", "--resume"]);
    assert_eq!(again.err.matches("(known)").count(), 5, "{again:?}");
    assert_eq!(json(&scratch, "out/goal/designed.json"), found);
    let text = fs::read_to_string(scratch.path("goal.toml")).unwrap();
    for (from, to, words) in [
        ("starts = 2", "starts = 0", "starts = 0 is out of range: must be a whole number from 1 to 100"),
        ("obstacle.table.", "obstacle.tabel.", "obstacle has no entry with the name \"tabel\": there are table"),
        ("obstacle.table.point.z", "obstacle[1].radius", "obstacle has entries from 0 to 0"),
    ] {
        fs::write(scratch.path("bad.toml"), text.replacen(from, to, 1)).unwrap();
        let ended = scratch.run(&["design", "bad.toml", "--out", "bad"]);
        assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{to}: {ended:?}");
        assert!(ended.err.contains(words), "{to}: {}", ended.err);
    }
}

#[test]
fn what_cannot_be_reached_is_said_and_bad_files_are_refused() {
    let goal = "[[target]]\nresult = \"end_face_angle\"\nat = 4\nvalue = 60\nwithin = 1\n";
    let scratch = wanted("design-bad", goal);
    let ended = scratch.run(&["design", "goal.toml", "--quiet"]);
    assert_eq!(ended.code, 3, "{ended:?}");
    assert!(
        ended.err.contains("comes nearer to the targets; what keeps it from being better: the bound of"),
        "{ended:?}"
    );
    assert!(ended.out.contains("for 60, within 1: missed"), "{ended:?}");
    let text = fs::read_to_string(scratch.path("goal.toml")).unwrap();
    for (from, to, words) in [
        ("within = 1", "within = 0", "target[0].within"),
        ("value = 60\n", "", "must have either result and value, or centreline"),
        ("[[target]]", "[[limit]]\nat_least = 1\n[[target]]", "must have either result or sum"),
        ("[[target]]", "[[extreme]]\nleast = \"tip.z\"\n[[target]]", "must be said of every result or of none"),
        (
            "[[target]]",
            "[[limit]]\nsum = { \"mesh.size\" = 1 }\nat_least = 1\n[[target]]",
            "the elements stay what they are",
        ),
        ("end_face_angle", "von_mises_p99", "jumps"),
        (
            "result = \"end_face_angle\"\nat = 4\nvalue = 60",
            "at = 4\ncentreline = \"none.csv\"",
            "none.csv: cannot be read",
        ),
        ("result = \"end_face_angle\"\nat = 4\nvalue = 60", "at = 4\ncentreline = [[0, 0]]", "two points or more"),
        ("case.toml", "goal.toml", "goal.toml"),
    ] {
        fs::write(scratch.path("bad.toml"), text.replacen(from, to, 1)).unwrap();
        let ended = scratch.run(&["design", "bad.toml", "--out", "bad"]);
        assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{to}: {ended:?}");
        assert!(ended.err.contains(words), "{to}: {}", ended.err);
    }
    assert!(!scratch.path("bad").exists());
}
