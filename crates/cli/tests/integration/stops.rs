//! Runs that cannot come to their end, and what is said of them: the true reason, and a remedy that this kind of file has.

use std::path::Path;

use serde_json::Value;

use crate::support::Scratch;

fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/stops").join(name).to_str().unwrap().to_owned()
}

/// What nothing holds is found before anything is solved, and the free motions are named.
#[test]
fn free_rigid_motions_are_named_before_solving() {
    let scratch = Scratch::new("free");
    let all = "nothing holds the body: it is free to slide along x, y and z, and to turn about x, y and z";
    for (name, message, help) in [
        ("nothing_holds.inp", all, "*BOUNDARY"),
        ("one_tet.toml", all, "[[support]]"),
        ("slides.inp", "the body is not held: it is free to slide along x and y, and to turn about z", "*BOUNDARY"),
    ] {
        for command in ["check", "run"] {
            let ended = scratch.run(&[command, &fixture(name)]);
            assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{command} {name}: {ended:?}");
            assert!(ended.err.contains(message) && ended.err.contains(help), "{command} {name}: {}", ended.err);
        }
    }
    assert_eq!(scratch.listing(), [""; 0]);
}

/// A body that only contact may hold is called that, and solved.
#[test]
fn a_body_held_by_contact_only_is_called_that() {
    let scratch = Scratch::new("contact-only");
    let deck = std::fs::read_to_string(fixture("slides.inp")).unwrap();
    let deck = deck.replace("*STEP", "*SURFACE, NAME=SIDES\nBAR, S3\nBAR, S4\nBAR, S5\nBAR, S6\n*STEP");
    std::fs::write(scratch.path("bar.inp"), deck).unwrap();
    let walls: Vec<String> = [("x", [0, 0, 0], "[1, 0, 0]"), ("y", [0, 0, 0], "[0, 1, 0]")]
        .iter()
        .map(|(name, point, normal)| {
            format!(
                "[[obstacle]]\nname = \"{name}\"\nshape = \"plane\"\npoint = {point:?}\nnormal = {normal}\nfaces = \"SIDES\"\n"
            )
        })
        .collect();
    std::fs::write(scratch.path("bar.toml"), format!("[model]\nfile = \"bar.inp\"\n{}", walls.concat())).unwrap();
    let checked = scratch.run(&["check", "bar.toml"]);
    assert_eq!(checked.code, 0, "{checked:?}");
    let words =
        "warning: only contact holds the body: without it, it is free to slide along x and y, and to turn about z";
    assert!(checked.err.contains(words), "{}", checked.err);
}

/// The reason that `summary.json` has.
#[track_caller]
fn stopped(scratch: &Scratch, arguments: &[&str]) -> Value {
    let ended = scratch.run(&[&["run", "--quiet", "--no-report", "--out", "result"], arguments].concat());
    assert_eq!(ended.code, 3, "{ended:?}");
    let summary: Value = serde_json::from_slice(&std::fs::read(scratch.path("result/summary.json")).unwrap()).unwrap();
    let reason = summary["failure_reason"].clone();
    assert!(ended.err.contains(reason["advice"].as_str().unwrap()), "{}", ended.err);
    reason
}

/// The greatest pressure of a balloon in closed form is 12.09 kPa; pumped full by its volume it goes on.
#[test]
fn a_balloon_ends_at_its_greatest_pressure_and_a_volume_passes_it() {
    let scratch = Scratch::new("balloon");
    let reason = stopped(&scratch, &[&fixture("balloon_pressure.toml")]);
    assert_eq!((&reason["kind"], &reason["is_physical"]), (&"instability".into(), &true.into()), "{reason}");
    let message = reason["message"].as_str().unwrap();
    let (_, kpa) = message.split_once(" (").unwrap();
    let kpa: f64 = kpa.split_once(" kPa").unwrap().0.parse().unwrap();
    assert!((kpa / 12.09 - 1.0).abs() < 2e-3, "{message}");
    assert!(reason["advice"].as_str().unwrap().contains("volume_mm3"), "{reason}");
    // As advised: an eighth of the ball, blown up to twice its volume and more.
    let text = std::fs::read_to_string(fixture("balloon_pressure.toml")).unwrap();
    let text = text.replace("balloon.inp", &fixture("balloon.inp")).replace("pressure_kpa=20", "volume_mm3=1500");
    std::fs::write(scratch.path("pumped.toml"), text).unwrap();
    let ended = scratch.run(&["run", "--quiet", "--no-report", "--out", "pumped", "pumped.toml"]);
    assert_eq!(ended.code, 0, "{ended:?}");
}

/// By its arc length the balloon passes its greatest pressure, also in two runs, and the page shows a curve that turns back.
#[test]
fn a_balloon_is_followed_past_its_greatest_pressure() {
    let scratch = Scratch::new("past");
    let run = |out: &str, states: usize, more: &[&str]| {
        let states = format!("solver.states_past_limit={states}");
        let arguments = ["run", "--out", out, &fixture("balloon_pressure.toml"), "--set", &states];
        let by_arc = ["--set", "solver.continuation=arc-length"];
        let ended = scratch.run(&[&arguments[..], &by_arc, more].concat());
        assert_eq!(ended.code, 0, "{ended:?}");
        let summary: Value =
            serde_json::from_slice(&std::fs::read(scratch.path(out).join("summary.json")).unwrap()).unwrap();
        (ended.err, summary)
    };
    let (said, whole) = run("whole", 4, &[]);
    assert!(said.contains("limit point at 12.07") && said.contains("followed past the limit point"), "{said}");
    assert_eq!(whole["status"], "past-limit");
    let steps = whole["steps"].as_array().unwrap();
    let kinds: Vec<&str> = steps.iter().map(|step| step["kind"].as_str().unwrap_or("-")).collect();
    assert_eq!(kinds, ["-", "-", "-", "greatest-load", "past-limit", "past-limit", "past-limit", "-", "-"]);
    assert!(steps[8]["converged"] == false && steps[8]["time"] == 1.0, "{}", steps[8]);
    assert!(whole["warnings"][0]["kind"] == "limit-point", "{}", whole["warnings"]);
    let page = std::fs::read_to_string(scratch.path("whole/report.html")).unwrap();
    assert!(page.contains("\"parameters\":[0.0,0.25,") && page.contains("limit point, greatest"));

    run("parts", 2, &[]);
    let (said, parts) = run("parts", 4, &["--resume"]);
    assert!(said.contains("going on from"), "{said}");
    for (part, whole) in parts["steps"].as_array().unwrap().iter().zip(steps) {
        let at = |step: &Value| step["time"].as_f64().unwrap();
        assert!((at(part) - at(whole)).abs() < 1e-10 && part["kind"] == whole["kind"], "{part} {whole}");
    }
    assert_eq!(parts["steps"].as_array().unwrap().len(), steps.len());
    let refused = scratch.run(&["run", "--out", "parts", &fixture("balloon_pressure.toml"), "--resume"]);
    assert!(refused.code == 2 && refused.err.contains("has passed a limit point"), "{refused:?}");
}

/// The bar of `q1p0_pulled_bar.inp` of n × n × n bricks.
fn pulled_bar(n: usize) -> String {
    let node = |i: usize, j: usize, k: usize| 1 + i + (n + 1) * (j + (n + 1) * k);
    let layer =
        |k: usize| -> String { (0..=n).flat_map(|j| (0..=n).map(move |i| format!("{}\n", node(i, j, k)))).collect() };
    let mut deck = "*NODE\n".to_owned();
    let (mut bricks, mut number) = (String::new(), 0);
    for (k, j, i) in (0..=n).flat_map(|k| (0..=n).flat_map(move |j| (0..=n).map(move |i| (k, j, i)))) {
        let [x, y, z] = [i, j, 2 * k].map(|index| index as f64 / n as f64);
        deck += &format!("{}, {x}, {y}, {z}\n", node(i, j, k));
        if i.max(j).max(k) < n {
            number += 1;
            let ring =
                |k| [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| node(i, j, k).to_string()).join(", ");
            bricks += &format!("{number}, {}, {}\n", ring(k), ring(k + 1));
        }
    }
    let body = std::fs::read_to_string(fixture("q1p0_pulled_bar.inp")).unwrap();
    let rest = &body[body.find("*MATERIAL").unwrap()..];
    format!(
        "{deck}*ELEMENT, TYPE=C3D8, ELSET=BAR\n{bricks}*NSET, NSET=FOOT\n{}*NSET, NSET=TOP\n{}{rest}",
        layer(0),
        layer(n)
    )
}

/// Linear bricks twist as they are pulled, which no body does: the run goes on, with a warning.
#[test]
fn an_instability_of_the_mesh_is_a_warning_where_supports_drive_the_body() {
    let scratch = Scratch::new("pulled");
    std::fs::write(scratch.path("bar.inp"), pulled_bar(3)).unwrap();
    let ended = scratch.run(&["run", "--quiet", "--no-report", "--out", "bricks", "bar.inp"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let deck = fixture("q1p0_pulled_bar.inp");
    let ended = scratch.run(&["run", "--quiet", "--no-report", "--out", "result", &deck]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let summary: Value = serde_json::from_slice(&std::fs::read(scratch.path("result/summary.json")).unwrap()).unwrap();
    let warning = &summary["warnings"][0];
    assert_eq!((&warning["kind"], &warning["time"]), (&"mesh-instability".into(), &1.0.into()), "{warning}");
    // The motion alone drives it: residuals are relative to what the supports bear.
    let history = std::fs::read_to_string(scratch.path("result/history.jsonl")).unwrap();
    let record: Value = serde_json::from_str(history.lines().last().unwrap()).unwrap();
    assert!(record["relative_residual"].as_f64().unwrap() < 1e-6, "{record}");
}
