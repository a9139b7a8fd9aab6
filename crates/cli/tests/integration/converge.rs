//! `pneuflex converge`.

use std::fs;
use std::path::Path;

use crate::support::Scratch;
use serde_json::Value;

fn fixture() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/two_chamber_coarse.toml");
    path.to_str().unwrap().to_owned()
}

#[test]
fn three_meshes_give_values_with_error_bars() {
    let scratch = Scratch::new("converge");
    let ended = scratch.run(&[
        "converge",
        &fixture(),
        "--set",
        "load.pressure_kpa=[5, 10]",
        "--set",
        "contact.method=none",
        "--quiet",
    ]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert!(ended.err.is_empty(), "{}", ended.err);
    for words in
        ["divided by", "5 kPa", "10 kPa", "end face angle", "tip displacement", "p99 von Mises", "extrapolated"]
    {
        assert!(ended.out.contains(words), "`{words}` is not in: {}", ended.out);
    }
    let folder = scratch.path("out/two_chamber_coarse-converge");
    assert!(fs::read_to_string(folder.join("convergence.svg")).unwrap().contains("element size"));
    let file: Value = serde_json::from_str(&fs::read_to_string(folder.join("converge.json")).unwrap()).unwrap();
    let levels = file["levels"].as_array().unwrap();
    let sizes: Vec<f64> = levels.iter().map(|level| level["element_size_mm"].as_f64().unwrap()).collect();
    assert!(sizes.len() == 3 && sizes.windows(2).all(|w| w[1] < w[0]), "{sizes:?}");
    let results = file["results"].as_array().unwrap();
    assert_eq!(results.len(), 2);
    for result in results {
        for key in ["end_face_angle_deg", "tip_displacement_mm", "von_mises_p99_mpa"] {
            let found = |name: &str| result[key][name].as_f64().unwrap();
            assert!(found("error_bar") > 0.0 && found("finest") > 0.0 && found("extrapolated") > 0.0);
        }
        // The value of the finest mesh is what that mesh gave.
        let step = levels[2]["steps"].as_array().unwrap().iter().find(|s| s["pressure_kpa"] == result["pressure_kpa"]);
        assert_eq!(step.unwrap()["tip_displacement_mm"], result["tip_displacement_mm"]["finest"]);
    }
}

/// Obstacles are in the way on every mesh: the tip would sink by more than 0.3 mm.
#[test]
fn obstacles_are_on_every_mesh() {
    let scratch = Scratch::new("converge-obstacle");
    let table = "obstacle=[{name = \"table\", shape = \"plane\", point = [0.0, 0.0, -0.1], normal = [0.0, 0.0, 1.0]}]";
    let ended = scratch.run(&[
        "converge",
        &fixture(),
        "--levels",
        "2",
        "--set",
        "load.pressure_kpa=[10]",
        "--set",
        "contact.method=none",
        "--set",
        table,
        "--quiet",
    ]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let file = fs::read_to_string(scratch.path("out/two_chamber_coarse-converge/converge.json")).unwrap();
    let file: Value = serde_json::from_str(&file).unwrap();
    for level in file["levels"].as_array().unwrap() {
        let sunk = level["steps"][0]["tip_displacement_mm"].as_f64().unwrap();
        assert!((0.05..0.25).contains(&sunk), "{sunk}");
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let scratch = Scratch::new("converge-bad");
    for levels in ["1", "7"] {
        let ended = scratch.run(&["converge", &fixture(), "--levels", levels]);
        assert_eq!(ended.code, 2, "{ended:?}");
        assert!(ended.err.contains("--levels"), "{}", ended.err);
    }
    assert!(scratch.listing().is_empty());
}

#[test]
fn a_mesh_that_will_not_fit_in_memory_is_refused_before_anything_is_solved() {
    let scratch = Scratch::new("converge-memory");
    let ended = scratch.run(&["converge", &fixture(), "--levels", "6", "--set", "mesh.size=0.3"]);
    assert_eq!(ended.code, 2, "{ended:?}");
    assert!(ended.err.contains("will not fit in memory"), "{}", ended.err);
    assert!(scratch.listing().is_empty());
}
