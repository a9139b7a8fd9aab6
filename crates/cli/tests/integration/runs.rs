//! Whole runs on coarse meshes: what is written, exit codes, and failed runs.

use std::fs;
use std::path::Path;

use crate::support::{Ended, Scratch};
use serde_json::Value;

fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name).to_str().unwrap().to_owned()
}

fn summary(scratch: &Scratch, folder: &str) -> Value {
    let text = fs::read_to_string(scratch.path(folder).join("summary.json")).unwrap();
    assert!(!text.contains("null") && !text.contains("NaN"), "{text}");
    serde_json::from_str(&text).unwrap()
}

fn history(scratch: &Scratch, folder: &str) -> Vec<Value> {
    let text = fs::read_to_string(scratch.path(folder).join("history.jsonl")).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[track_caller]
fn has_keys(value: &Value, keys: &[&str]) {
    for key in keys {
        assert!(value.get(key).is_some(), "no `{key}` in {value}");
    }
}

/// The keys that the case's summary promises, by name.
#[test]
fn a_coarse_run_writes_everything_it_promises() {
    let scratch = Scratch::new("run");
    let ended = scratch.run(&["run", &fixture("two_chamber_coarse.toml"), "--threads", "1"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    // Plain lines when piped.
    assert!(ended.err.contains("50 kPa reached in") && !ended.err.contains('\u{1b}'), "{}", ended.err);
    assert!(ended.out.is_empty());

    let folder = "out/two_chamber_coarse";
    let summary = summary(&scratch, folder);
    has_keys(&summary, &["mesh", "steps", "timing", "iterations_total", "version", "title", "probes"]);
    has_keys(&summary["mesh"], &["nodes", "elements", "unknowns", "element"]);
    has_keys(&summary["timing"], &["assembly_s", "factor_s", "solve_s", "contact_s", "total_s"]);
    assert_eq!((&summary["status"], &summary["mesh"]["element"]), (&"converged".into(), &"hex8-sri".into()));
    assert!(summary.get("failure").is_none());
    let steps = summary["steps"].as_array().unwrap();
    let pressures: Vec<f64> = steps.iter().map(|s| s["pressure_kpa"].as_f64().unwrap()).collect();
    assert_eq!(pressures, [5.0, 15.0, 25.0, 35.0, 50.0]);
    for step in steps {
        has_keys(
            step,
            &[
                "converged",
                "iterations",
                "probes",
                "end_face_angle_deg",
                "centreline",
                "max_von_mises_mpa",
                "von_mises_p99_mpa",
                "contact",
                "cavity_volume_mm3",
                "reaction_n",
                "strain_energy_mj",
            ],
        );
        let contact = ["points_active", "area_mm2", "max_penetration_mm", "gaps_in_contact", "min_gap_mm"];
        has_keys(&step["contact"], &contact);
        assert_eq!(step["converged"], true);
        assert_eq!(step["probes"]["tip"].as_array().unwrap().len(), 3);
        // A closed cavity has no resultant.
        for axis in [0, 2] {
            assert!(step["reaction_n"][axis].as_f64().unwrap().abs() < 1e-6, "{}", step["reaction_n"]);
        }
    }
    // Bending goes on downwards, as an angle and at the tip.
    let grows = |f: &dyn Fn(&Value) -> f64| steps.windows(2).all(|w| f(&w[0]) < f(&w[1])) && f(&steps[0]) > 0.0;
    assert!(grows(&|s| s["end_face_angle_deg"].as_f64().unwrap()));
    assert!(grows(&|s| -s["probes"]["tip"][2].as_f64().unwrap()));
    assert!(grows(&|s| s["cavity_volume_mm3"].as_f64().unwrap() - 892.0));

    let history = history(&scratch, folder);
    // Tangents factorised for a first guess have no correction to report.
    let total = summary["iterations_total"].as_u64().unwrap();
    let written = history.iter().filter(|line| line["new_tangent"] == true).count() as u64;
    assert!(written > 5 && written <= total, "{written} of {total}");
    assert_eq!(steps.iter().map(|s| s["iterations"].as_u64().unwrap()).sum::<u64>(), total);
    has_keys(&history[0], &["step", "iteration", "pressure_kpa", "correction", "residual", "contact_points"]);
    let fields: Vec<String> = fs::read_dir(scratch.path(folder).join("fields"))
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(fields.len(), 11, "{fields:?}");
    let series = fs::read_to_string(scratch.path(folder).join("fields/series.pvd")).unwrap();
    assert!((1..=5).all(|i| series.contains(&format!("step_{i:02}.vtu"))));
}

#[test]
fn the_resolved_case_gives_the_same_result_again_and_replaces_it() {
    let scratch = Scratch::new("resolved");
    let set = ["--set", "load.pressure_kpa=[5, 12]", "--set", "mesh.element=hex8-q1p0", "--quiet", "--threads", "1"];
    let mut arguments = vec!["run"];
    let case = fixture("two_chamber_coarse.toml");
    arguments.extend([case.as_str(), "--out", "a"]);
    arguments.extend(set);
    let Ended { code, out, err } = scratch.run(&arguments);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "", ""));
    let first = summary(&scratch, "a");
    assert_eq!(first["mesh"]["element"], "hex8-q1p0");
    assert_eq!(scratch.run(&["run", "a/case.toml", "--out", "a", "--quiet", "--threads", "1"]).code, 0);
    let second = summary(&scratch, "a");
    assert_eq!(first["steps"], second["steps"]);
}

#[test]
fn fields_can_be_left_out() {
    let scratch = Scratch::new("fields");
    let case = fixture("two_chamber_coarse.toml");
    let set = ["--set", "output.fields=false", "--set", "load.pressure_kpa=[3]", "--set", "actuator.chambers=1"];
    let mut arguments = vec!["run", case.as_str(), "--out", "o", "--quiet"];
    arguments.extend(set);
    assert_eq!(scratch.run(&arguments).code, 0);
    assert!(!scratch.path("o/fields").exists());
    // No gaps, so no least gap.
    assert!(summary(&scratch, "o")["steps"][0]["contact"].get("min_gap_mm").is_none());
}

#[test]
fn a_failed_run_keeps_what_it_has_and_says_why() {
    let scratch = Scratch::new("failed");
    let case = fixture("two_chamber_coarse.toml");
    // Far beyond what the body can bear, and too few steps to try.
    let arguments =
        ["run", &case, "--out", "o", "--set", "load.pressure_kpa=[5, 100000]", "--set", "solver.min_step_kpa=10"];
    let ended = scratch.run(&arguments);
    assert_eq!(ended.code, 3, "{ended:?}");
    assert!(ended.err.contains("error: not converged"), "{}", ended.err);
    let summary = summary(&scratch, "o");
    assert_eq!(summary["status"], "not-converged");
    assert!(summary["failure"].as_str().unwrap().contains("kPa"));
    let steps = summary["steps"].as_array().unwrap();
    assert_eq!((steps.len(), &steps[0]["converged"], &steps[1]["converged"]), (2, &true.into(), &false.into()));
    assert_eq!(steps[1]["pressure_kpa"], 100_000.0);
    assert!(scratch.path("o/fields/step_01.vtu").exists());
    assert!(history(&scratch, "o").len() > 4);
}
