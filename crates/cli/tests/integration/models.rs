//! Models and decks through the program.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("models").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn pneuflex(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pneuflex")).current_dir(folder).args(arguments).output().unwrap()
}

#[track_caller]
fn run(folder: &Path, arguments: &[&str]) -> Value {
    let output = pneuflex(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    summary(folder)
}

#[track_caller]
fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("result/summary.json")).unwrap()).unwrap()
}

/// A cube of one element, 1 mm, in a file of its own that the deck includes.
const NODES: &str = "*NODE, NSET=ALL
1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=LEFT\n1, 4, 5, 8
*NSET, NSET=RIGHT\n2, 3, 6, 7
*NSET, NSET=FRONT\n1, 2, 5, 6
*NSET, NSET=FLOOR\n1, 2, 3, 4
*SURFACE, NAME=END\nCUBE, S4
";

const DECK: &str = "*HEADING
a cube
*INCLUDE, INPUT=nodes.inc
*MATERIAL, NAME=M
*HYPERELASTIC, NEO HOOKE
0.25, 0.0002
*SOLID SECTION, ELSET=CUBE, MATERIAL=M
*BOUNDARY
LEFT, 1
FRONT, 2
FLOOR, 3
*STEP, NLGEOM
*STATIC
0.5, 1
*BOUNDARY
RIGHT, 1, 1, 0.5
*END STEP
";

/// Nominal stress of the neo-Hookean cube stretched to 1.5, MPa.
const NOMINAL: f64 = 2.0 * 0.25 * (1.5 - 1.0 / 2.25);

fn with_deck(name: &str) -> PathBuf {
    let folder = scratch(name);
    fs::write(folder.join("nodes.inc"), NODES).unwrap();
    fs::write(folder.join("cube.inp"), DECK).unwrap();
    folder
}

#[test]
fn a_deck_runs_as_it_is_and_goes_on_from_its_copy() {
    let folder = with_deck("deck");
    let first = run(&folder, &["run", "cube.inp", "--out", "result"]);
    assert_eq!((first["status"].as_str(), first["title"].as_str()), (Some("converged"), Some("a cube")));
    let pull = first["steps"][0]["reactions"]["RIGHT"][0].as_f64().or_else(|| {
        let reactions = first["steps"][0]["reactions"].as_object().unwrap();
        reactions.values().filter_map(|r| r[0].as_f64()).find(|x| *x > 0.0)
    });
    assert!((pull.unwrap() / NOMINAL - 1.0).abs() < 1e-3, "{pull:?} for {NOMINAL}");
    // The copies in the result folder are a model themselves.
    let again = run(&folder, &["run", "result/case.toml", "--out", "again", "--quiet"]);
    assert_eq!(again["steps"], first["steps"]);
    let complete = pneuflex(&folder, &["run", "cube.inp", "--out", "result", "--resume"]);
    assert!(complete.status.success() && String::from_utf8_lossy(&complete.stderr).contains("nothing is left to do"));
    fs::write(folder.join("nodes.inc"), NODES.replace("3, 1, 1, 0", "3, 1, 1.1, 0")).unwrap();
    let changed = pneuflex(&folder, &["run", "cube.inp", "--out", "result", "--resume"]);
    let said = String::from_utf8_lossy(&changed.stderr).into_owned();
    assert!(changed.status.code() == Some(2) && said.contains("cube.inp or what it includes"), "{said}");
}

#[test]
fn a_model_file_adds_to_its_body() {
    let folder = with_deck("model");
    let deck = DECK.split("*BOUNDARY").next().unwrap().to_owned() + "*STEP, NLGEOM\n*STATIC\n0.5, 1\n*END STEP\n";
    fs::write(folder.join("cube.inp"), deck).unwrap();
    let model = "[model]\nfile = \"cube.inp\"\n[material]\nlaw = \"neo-hooke\"\nc10 = 0.5\nbulk_modulus = 2000.0\n
[[support]]\nnodes = \"left\"\naxes = \"x\"\n[[support]]\nnodes = \"FRONT\"\naxes = \"y\"\n[[support]]\nnodes = \"FLOOR\"\naxes = \"z\"\n
[[traction]]\nfaces = \"END\"\ntraction_mpa = [TRACTION, 0.0, 0.0]\nfactor = [[0, 0], [2, 1]]\n
[[probe]]\nname = \"end\"\nat = [1.0, 0.0, 0.0]\n[load]\ntimes = [1.0, 2.0]\n";
    // Twice as stiff as the deck's material.
    fs::write(folder.join("cube.toml"), model.replace("TRACTION", &(2.0 * NOMINAL).to_string())).unwrap();
    let found = run(&folder, &["run", "cube.toml", "--out", "result", "--quiet"]);
    let steps = found["steps"].as_array().unwrap();
    assert_eq!(steps.iter().map(|step| step["time"].as_f64().unwrap()).collect::<Vec<_>>(), [1.0, 2.0]);
    let end = steps[1]["probes"]["end"][0].as_f64().unwrap();
    assert!((end - 0.5).abs() < 1e-3, "{end}");
    let text = String::from_utf8(pneuflex(&folder, &["check", "cube.toml"]).stdout).unwrap();
    for part in ["neo-hooke", "support   left: 4 nodes held in x", "traction", "times     1, 2"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// The cube is stretched evenly, on every mesh: nothing changes from one to the next.
#[test]
fn a_deck_is_solved_on_finer_meshes() {
    let folder = with_deck("finer");
    let output = pneuflex(&folder, &["converge", "cube.inp", "--levels", "2", "--quiet"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && said.is_empty(), "{said}");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("time 1") && table.contains("strain energy, mJ"), "{table}");
    let file = fs::read(folder.join("out/cube-converge/converge.json")).unwrap();
    let file: Value = serde_json::from_slice(&file).unwrap();
    let [one, eight] = [0, 1].map(|level| file["levels"][level].clone());
    assert_eq!([&one, &eight].map(|level| level["elements"].as_u64()), [Some(1), Some(8)]);
    let step = one["steps"][0].as_object().unwrap();
    let forces = step.iter().filter(|(key, _)| key.starts_with("reaction_") && key.ends_with("_n"));
    assert!(forces.filter_map(|(_, n)| n.as_f64()).any(|n| (n / NOMINAL - 1.0).abs() < 1e-3), "{step:?}");
    for (key, before) in step {
        let [before, after] = [before, &eight["steps"][0][key]].map(|value| value.as_f64().unwrap());
        assert!((before - after).abs() < 1e-9, "{key}: {before} {after}");
    }
}

#[test]
fn what_is_wrong_with_a_model_is_said_at_once() {
    let folder = with_deck("wrong");
    let model = "[model]\nfile = \"cube.inp\"\n[[support]]\nnodes = \"LEFTT\"\naxes = \"x\"\n[[traction]]\nfaces = \"ENDE\"\ntraction_mpa = [1, 0, 0]\n";
    fs::write(folder.join("cube.toml"), model).unwrap();
    let output = pneuflex(&folder, &["run", "cube.toml", "--out", "result"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    for part in ["support[0].nodes", "LEFTT", "traction[0].faces", "END"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!folder.join("result").exists());
    fs::write(folder.join("cube.inp"), DECK.replace("M\n*HYPER", "M\n*VISCO\n*HYPER")).unwrap();
    let output = pneuflex(&folder, &["check", "cube.inp"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && said.contains("cube.inp:5") && said.contains("VISCO"), "{said}");
}
