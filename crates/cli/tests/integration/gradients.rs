//! `pneuflex run --gradient` and `pneuflex check-gradient`.

use std::fs;

use serde_json::Value;

use crate::support::{Ended, Scratch};

const COARSE: [&str; 6] =
    ["--set", "mesh.size=9", "--set", "mesh.element=hex8-q1p0", "--set", "load.pressure_kpa=[4, 8]"];

fn run(scratch: &Scratch, command: &str, more: &[&str]) -> Ended {
    scratch.run(&[&[command, "case.toml"], &COARSE[..], more].concat())
}

/// They are in a file and in the report, the greatest effect first, and differences of runs say the same.
#[test]
fn gradients_are_written_shown_and_checked() {
    let scratch = Scratch::new("gradients");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    let ended = run(&scratch, "run", &["--gradient", "end_face_angle", "--gradient", "tip.z@4", "--out", "run"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert!(
        ended.err.contains("end_face_angle_deg = ") && ended.err.contains(" at 8 kPa changes most by ("),
        "{ended:?}"
    );
    let text = fs::read_to_string(scratch.path("run/gradients.json")).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found[1]["of"], "tip.z_mm");
    assert_eq!(found[1]["pressure_kpa"], 4.0);
    let derivatives = found[0]["derivatives"].as_array().unwrap();
    let of = |key: &str| derivatives.iter().find(|derivative| derivative["by"] == key).unwrap();
    assert_eq!((&of("actuator.top_wall")["unit"], &of("actuator.top_wall")["value"]), (&"mm".into(), &1.0.into()));
    assert!(of("load.pressure_kpa")["derivative"].as_f64().unwrap() > 0.0);
    let report = fs::read_to_string(scratch.path("run/report.html")).unwrap();
    assert!(report.contains("What changes <code>end_face_angle_deg</code> most"));

    let checked = run(&scratch, "check-gradient", &["--of", "end_face_angle", "--by", "actuator.top_wall"]);
    assert_eq!(checked.code, 0, "{checked:?}");
    let row: Vec<&str> = checked.out.lines().nth(1).unwrap().split_whitespace().collect();
    let number = |place: usize| row[place].parse::<f64>().unwrap();
    assert_eq!(row[0], "actuator.top_wall");
    assert!((number(1) / of("actuator.top_wall")["derivative"].as_f64().unwrap() - 1.0).abs() < 1e-5, "{row:?}");
    assert!((number(1) / number(2) - 1.0).abs() < 1e-5 && number(3) < 1e-5, "{row:?}");

    // What an earlier run has reached has no displacements any more.
    let again = run(&scratch, "run", &["--gradient", "tip.z", "--out", "run", "--resume"]);
    assert!(again.code == 2 && again.err.contains("tip.z: the displacements there are not known"), "{again:?}");
    // A run without leaves none.
    assert_eq!(run(&scratch, "run", &["--out", "run", "--quiet", "--no-report"]).code, 0);
    assert!(!scratch.path("run/gradients.json").exists());
}

#[test]
fn what_has_no_gradient_is_refused_before_anything_is_solved() {
    let scratch = Scratch::new("no-gradients");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    for (more, words) in [
        (&["--gradient", "von_mises_p99"][..], "no derivative of von_mises_p99_mpa: it is the value of one point"),
        (&["--gradient", "tip.z@5"], "tip.z@5: no state is asked for at 5 kPa"),
        (&["--gradient", "tip.z@x"], "expected RESULT or RESULT@PRESSURE"),
        (&["--gradient", "tip.z", "--set", "contact.method=mortar"], "contact.method: gaps that are averaged"),
    ] {
        let ended = run(&scratch, "run", more);
        assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{more:?} {ended:?}");
        assert!(ended.err.contains(words), "{more:?}: {}", ended.err);
    }
    let ended = run(&scratch, "check-gradient", &["--of", "tip.z", "--by", "mesh.size"]);
    assert!(ended.code == 2 && ended.err.contains("no derivative by mesh.size: the elements stay"), "{ended:?}");
    assert_eq!(scratch.listing(), ["case.toml"]);
}
