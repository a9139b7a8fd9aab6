//! Obstacles in case files: the force on them is what the clamp carries, and mistakes are named.

use std::fs;
use std::path::Path;

use crate::support::Scratch;
use serde_json::Value;

fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name).to_str().unwrap().to_owned()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Nothing but the clamp and the obstacle acts on the half model along x and z.
#[test]
fn the_clamp_carries_what_the_actuator_presses_on_the_obstacle_with() {
    for (case, obstacle) in [("blocked_force", "table"), ("grip_sphere", "ball")] {
        let scratch = Scratch::new(case);
        let coarse = ["mesh.size=4.5", "mesh.element=hex8-q1p0", "load.pressure_kpa=[20, 50]"];
        let words = ["run", &fixture(&format!("{case}.toml")), "--threads", "1"];
        let mut arguments = words.map(str::to_owned).to_vec();
        arguments.extend(coarse.iter().flat_map(|set| ["--set".to_owned(), (*set).to_owned()]));
        let ended = scratch.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(ended.code, 0, "{ended:?}");
        let text = fs::read_to_string(scratch.path(&format!("out/{case}")).join("summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&text).unwrap();
        let last = &summary["steps"][1];
        let found = &last["obstacles"][obstacle];
        assert!(number(&found["force_n"][2]) < -0.01 && number(&found["max_penetration_mm"]) > 0.0, "{found}");
        for axis in [0, 2] {
            let difference = number(&found["force_n"][axis]) - number(&last["reaction_n"][axis]);
            assert!(difference.abs() < 1e-6, "{found} {}", last["reaction_n"]);
        }
    }
}

/// Along x and z nothing acts on the two fingers but the plate and the ball; the fingers are mirror images of each other.
#[test]
fn the_plate_carries_what_two_fingers_press_on_the_ball_with() {
    let scratch = Scratch::new("gripper");
    let ended = scratch.run(&[
        "run",
        &fixture("models/gripper.toml"),
        "--threads",
        "1",
        "--set",
        "load.times=[0.25]",
        "--no-report",
    ]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let text = fs::read_to_string(scratch.path("out/gripper").join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    let step = &summary["steps"][0];
    let force = &step["obstacles"]["ball"]["force_n"];
    let [left, right] = ["ROOT_LEFT", "ROOT_RIGHT"].map(|name| &step["reactions"][name]);
    // The fingertips reach under the ball.
    assert!(number(&force[2]) > 0.005 && number(&left[0]) > 0.01, "{step}");
    let largest = number(&left[0]);
    for axis in [0, 2] {
        let difference = number(&force[axis]) - number(&left[axis]) - number(&right[axis]);
        assert!(difference.abs() < 1e-6 * largest, "{step}");
    }
    assert!((number(&left[0]) + number(&right[0])).abs() < 1e-6 * largest, "{step}");
    assert!((number(&left[2]) - number(&right[2])).abs() < 1e-6 * largest, "{step}");
}

#[test]
fn a_force_that_nobody_asks_for_is_left_out() {
    let scratch = Scratch::new("silent_obstacle");
    let table =
        "obstacle=[{ name = 'table', shape = 'plane', point = [0, 0, -3], normal = [0, 0, 1], report_force = false }]";
    let sets = ["mesh.size=4.5", "mesh.element=hex8-q1p0", "load.pressure_kpa=[20]", table];
    let mut arguments = vec!["run".to_owned(), fixture("blocked_force.toml")];
    arguments.extend(sets.iter().flat_map(|set| ["--set".to_owned(), (*set).to_owned()]));
    let ended = scratch.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(ended.code, 0, "{ended:?}");
    let text = fs::read_to_string(scratch.path("out/blocked_force/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    let step = &summary["steps"][0];
    // It is there all the same: nothing else presses on the clamp.
    assert!(step["obstacles"]["table"].is_null() && number(&step["reaction_n"][2]) < -0.01, "{step}");
}

#[test]
fn mistakes_in_obstacles_are_named() {
    let scratch = Scratch::new("wrong_obstacles");
    for (obstacle, key, why) in [
        ("{ name = 'a', shape = 'plane', point = [0, 0, 1], normal = [0, 0, 1] }", "obstacle[0].name", "overlaps"),
        ("{ name = 'a', shape = 'plane', normal = [0, 0, 1] }", "obstacle[0].point", "point, normal"),
        ("{ name = 'a', shape = 'sphere', centre = [0, 0, 0], radius = -1 }", "obstacle[0].radius", "greater than 0"),
        (
            "{ name = 'a', shape = 'sphere', centre = [0, 0, -20], radius = 5, faces = 'top' }",
            "obstacle[0].faces",
            "outer, bottom, end_face",
        ),
    ] {
        let set = format!("obstacle=[{obstacle}]");
        let ended = scratch.run(&["check", &fixture("blocked_force.toml"), "--set", &set]);
        assert!(ended.code == 2 && ended.err.contains(key) && ended.err.contains(why), "{obstacle}: {ended:?}");
    }
}
