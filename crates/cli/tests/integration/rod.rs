//! The elastica baseline of a coarse actuator: what is printed and written.

use std::fs;
use std::path::Path;

use crate::support::Scratch;
use serde_json::Value;

fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name).to_str().unwrap().to_owned()
}

#[test]
fn the_rod_of_a_coarse_actuator_is_identified() {
    let scratch = Scratch::new("rod");
    let ended = scratch.run(&["rod", &fixture("actuator_coarse.toml"), "--out", "rods"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    for name in ["a1", "a2", "D0", "D1", "Dc", "fit error"] {
        assert!(ended.out.contains(name), "{}", ended.out);
    }
    assert_eq!(fs::read_dir(scratch.path("rods")).unwrap().count(), 1);
    let text = fs::read_to_string(scratch.path("rods/rod.json")).unwrap();
    let rod: Value = serde_json::from_str(&text).unwrap();
    let number = |path: &str| rod.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {text}"));
    assert_eq!((number("/length_mm"), number("/identified_up_to_kpa")), (82.0, 15.0));
    // Pressure bends downwards; a bar of the base alone would have E I = 6 C10 · 20 · 4³ / 12 = 174 N mm².
    assert!(number("/parameters/a1_per_mm_kpa") > 0.0);
    assert!((150.0..1000.0).contains(&number("/parameters/d0_n_mm2")), "{text}");
    for fit in ["intrinsic_curvature_per_mm", "stiffness_n_mm2"] {
        assert!(number(&format!("/fit/{fit}/relative_rms")) < 0.1, "{text}");
    }
    let shapes = rod["shapes"].as_array().unwrap();
    let pressures: Vec<f64> = shapes.iter().map(|s| s["pressure_kpa"].as_f64().unwrap()).collect();
    assert_eq!(pressures, [5.0, 15.0, 25.0, 35.0, 50.0]);
    let line = shapes[0]["centreline"].as_array().unwrap();
    assert_eq!(line[0], serde_json::json!([0.0, 0.0]));
    assert!(line.last().unwrap()[1].as_f64().unwrap() < -1.0, "{text}");
}

#[test]
fn a_tip_load_bends_the_rod_and_files_beside_it_stay() {
    let scratch = Scratch::new("rod-load");
    fs::create_dir_all(scratch.path("rods")).unwrap();
    fs::write(scratch.path("rods/notes.txt"), "mine").unwrap();
    let arguments = ["rod", &fixture("two_chamber_coarse.toml"), "--out", "rods", "--quiet", "--set"];
    let tip = |load: &str| {
        let ended = scratch.run(&[&arguments[..], &["contact.method=none", "--tip-load", load]].concat());
        assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{ended:?}");
        assert!(ended.out.contains("not determined"), "{}", ended.out);
        let text = fs::read_to_string(scratch.path("rods/rod.json")).unwrap();
        let rod: Value = serde_json::from_str(&text).unwrap();
        rod.pointer("/shapes/0/centreline").unwrap().as_array().unwrap().last().unwrap()[1].as_f64().unwrap()
    };
    let (up, free, down) = (tip("-0.02"), tip("0"), tip("0.02"));
    assert!(down < free - 0.05 && up > free + 0.05, "{up} {free} {down}");
    assert_eq!(fs::read_to_string(scratch.path("rods/notes.txt")).unwrap(), "mine");
}

/// Chambers that share a wall are no cells between which only the base bends.
#[test]
fn chambers_without_a_gap_have_no_rod() {
    let scratch = Scratch::new("rod-block");
    let ended = scratch.run(&["rod", &fixture("two_chamber_coarse.toml"), "--set", "actuator.gap=0"]);
    assert!(ended.code == 2 && ended.err.contains("actuator.gap = 0"), "{ended:?}");
    assert!(scratch.listing().is_empty(), "{:?}", scratch.listing());
}

/// A rod is what two chambers are that are repeated all along it.
#[test]
fn chambers_that_differ_have_no_rod() {
    let scratch = Scratch::new("rod-different");
    let differing = ["actuator.top_wall[2]=0.8", "actuator.chamber_length=[8, 9]", "actuator.side_wall=[1, 1.5]"];
    for set in differing {
        let ended = scratch.run(&["rod", &fixture("two_chamber_coarse.toml"), "--set", set]);
        let key = set.split(['=', '[']).next().unwrap();
        assert!(ended.code == 2 && ended.err.contains(&format!("{key} differs from chamber to chamber")), "{ended:?}");
    }
    let apart = ["--set", "actuator.channel.half_width=0", "--set", "load.chamber_factor=[1, 0.5]"];
    let ended = scratch.run(&[&["rod", &fixture("two_chamber_coarse.toml")], &apart[..]].concat());
    assert!(ended.code == 2 && ended.err.contains("load.chamber_factor: a rod has one pressure"), "{ended:?}");
    assert!(scratch.listing().is_empty(), "{:?}", scratch.listing());
}
