//! `pneuflex export`: results in the formats of other programs, of every kind of run.

use std::fs;

use serde_json::Value;

use crate::support::Scratch;

const CASE: &str = "[actuator]\nchambers = 2\nchamber_length = 8.0\ncavity_length = 6.0\ngap = 2.0\nflange = 2.0\nwidth = 20.0\nheight = 13.0\n\
                    base = 4.0\nside_wall = 1.0\ntop_wall = 1.0\nchannel = { half_width = 1.0, bottom = 2.0, top = 3.0 }\n[mesh]\nsize = 4.5\n\
                    element = \"hex8-q1p0\"\n[load]\npressure_kpa = [2, 4]\n[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\n\
                    centre = [20, 0, -6]\nradius = 4\n";

/// A quarter of a bar that is pulled; its planes of symmetry are declared.
const BAR: &str = "*NODE, NSET=ALL\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n*NSET, NSET=END\n1,4,5,8\n\
                   *NSET, NSET=FRONT\n1,2,5,6\n*NSET, NSET=BOTTOM\n1,2,3,4\n*ELEMENT, TYPE=C3D8, ELSET=BODY\n1,1,2,3,4,5,6,7,8\n\
                   *MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.1,0.02\n*SOLID SECTION, ELSET=BODY, MATERIAL=M\n\
                   *STEP, NLGEOM\n*STATIC\n*BOUNDARY\nEND,1\n*END STEP\n";
const MODEL: &str = "[model]\nfile = \"bar.inp\"\n[load]\ntimes = [1, 2]\n[[support]]\nnodes = \"FRONT\"\naxes = \"y\"\nsymmetry = true\n\
                     [[support]]\nnodes = \"BOTTOM\"\naxes = \"z\"\nsymmetry = true\n\
                     [[force]]\nnodes = { near = [1, 1, 1] }\ntotal = [0.002, 0, 0]\n";

/// The JSON of a glTF file.
fn gltf(file: &[u8]) -> Value {
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&file[20..20 + length]).unwrap()
}

#[test]
fn a_case_with_an_obstacle_leaves_in_every_format() {
    let scratch = Scratch::new("export");
    fs::write(scratch.path("case.toml"), CASE).unwrap();
    let ended = scratch.run(&["run", "case.toml", "--out", "out/bent", "--no-report"]);
    assert_eq!(ended.code, 0);
    // It ends with a table of what it has found, narrow enough for any terminal.
    let mut lines = ended.err.lines().skip_while(|line| !line.starts_with("  kPa  end face, deg  chord, deg  ball, N"));
    assert!(lines.next().is_some(), "{ended:?}");
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(scratch.path("out/bent/summary.json")).unwrap()).unwrap();
    for (line, step) in lines.zip(summary["steps"].as_array().unwrap()) {
        let found: Vec<f64> = line.split_whitespace().map(|cell| cell.parse().unwrap()).collect();
        let expected = ["pressure_kpa", "end_face_angle_deg"].map(|key| step[key].as_f64().unwrap());
        assert!(
            line.chars().count() <= 80 && (0..2).all(|i| (found[i] - expected[i]).abs() < 0.006),
            "{line} {expected:?}"
        );
    }
    let export = |more: &[&str]| scratch.run(&[&["export", "out/bent", "--to"], more].concat());
    for (format, begins) in [
        ("stl", &b"binary STL"[..]),
        ("obj", b"# by pneuflex"),
        ("glb", b"glTF"),
        ("csv", b"pressure_kpa,node"),
        ("npz", b"PK\x03\x04"),
        ("vtk", b"# vtk DataFile"),
        ("msh", b"$MeshFormat"),
    ] {
        let ended = export(&[format]);
        assert_eq!((ended.code, ended.err.trim()), (0, &*format!("wrote bent.{format}")), "{ended:?}");
        assert!(fs::read(scratch.path(&format!("bent.{format}"))).unwrap().starts_with(begins), "{format}");
    }
    let film = ["--pictures", "3", "--width", "300"];
    assert_eq!(export(&[&["gif", "--out", "a.gif", "--view", "side"], &film[..]].concat()).code, 0);
    assert!(fs::read(scratch.path("a.gif")).unwrap().starts_with(b"GIF89a"));
    assert_eq!(export(&[&["png"], &film[..]].concat()).err.trim(), "wrote 3 files into bent-pictures");
    // All alike in size, so that they can follow each other.
    let sizes: Vec<Vec<u8>> = (1..4)
        .map(|i| fs::read(scratch.path(&format!("bent-pictures/picture_00{i}.png"))).unwrap()[16..24].to_vec())
        .collect();
    assert!(sizes[0] == sizes[1] && sizes[1] == sizes[2]);
    assert_eq!(export(&["mould", "--wall", "3"]).code, 0);
    assert_eq!(fs::read_dir(scratch.path("bent-mould")).unwrap().count(), 3);

    let moving = gltf(&fs::read(scratch.path("bent.glb")).unwrap());
    assert_eq!(moving["meshes"][0]["extras"]["targetNames"], serde_json::json!(["at 2 kPa", "at 4 kPa"]));
    assert_eq!(moving["meshes"][1]["name"], "ball");
    assert_eq!(export(&["glb", "--at", "2", "--colour", "none", "--out", "still.glb"]).code, 0);
    let still = gltf(&fs::read(scratch.path("still.glb")).unwrap());
    assert!(
        still.get("animations").is_none() && still["meshes"][0]["primitives"][0]["attributes"].get("COLOR_0").is_none()
    );
    assert_eq!(export(&["csv", "--at", "2", "--out", "two.csv"]).code, 0);
    let lines = |name: &str| fs::read_to_string(scratch.path(name)).unwrap().lines().count();
    assert_eq!(2 * (lines("two.csv") - 1), lines("bent.csv") - 1);

    for (more, words) in [
        (&["stl", "--at", "3"][..], "there are no results at 3 kPa"),
        (&["stl", "--colour", "displacement"], "--colour means nothing to --to stl"),
        (&["npz", "--at", "2"], "--at means nothing to --to npz"),
        (&["gif", "--wall", "2"], "--wall means nothing to --to gif"),
        (&["glb", "--range", "2,1"], "--range 2,1: expected two finite numbers"),
        (&["mould", "--wall", "0", "--out", "other"], "a mould with walls of 0 mm"),
        (&["mould"], "this folder holds something already"),
        (&["stl", "--out", "nowhere/a.stl"], "cannot be written"),
    ] {
        let ended = export(more);
        assert!(ended.code != 0 && ended.err.contains(words), "{more:?} {ended:?}");
    }
}

/// Bodies of meshes, parts of which are modelled, runs that stopped and results without fields: whole, or refused by name.
#[test]
fn models_and_runs_that_stopped_are_honoured_or_refused() {
    let scratch = Scratch::new("export-kinds");
    fs::write(scratch.path("bar.inp"), BAR).unwrap();
    fs::write(scratch.path("model.toml"), MODEL).unwrap();
    let ended = scratch.run(&["run", "model.toml", "--out", "pulled", "--quiet", "--no-report"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert_eq!(scratch.run(&["export", "pulled", "--to", "glb"]).code, 0);
    let found = gltf(&fs::read(scratch.path("pulled.glb")).unwrap());
    let targets = &found["meshes"][0]["extras"]["targetNames"];
    assert_eq!(*targets, serde_json::json!(["at time 1", "at time 2"]));
    // Four images of a quarter.
    let base = &found["accessors"][0];
    let size = |axis: usize| base["max"][axis].as_f64().unwrap() - base["min"][axis].as_f64().unwrap();
    assert_eq!([0, 1, 2].map(size), [1.0, 2.0, 2.0]);
    assert_eq!(scratch.run(&["export", "pulled", "--to", "msh"]).code, 0);
    let mesh = fs::read_to_string(scratch.path("pulled.msh")).unwrap();
    assert!(mesh.contains("$Nodes\n18\n") && mesh.contains("$Elements\n24\n"), "{mesh}");
    let csv = scratch.run(&["export", "pulled", "--to", "csv"]);
    assert!(csv.code == 0 && fs::read_to_string(scratch.path("pulled.csv")).unwrap().starts_with("time,node,"));
    let mould = scratch.run(&["export", "pulled", "--to", "mould"]);
    assert!(mould.code == 2 && mould.err.contains("this one is a mesh"), "{mould:?}");
    let video = scratch.run(&["export", "pulled", "--to", "png", "--pictures", "2", "--width", "300"]);
    assert_eq!(video.code, 0, "{video:?}");

    let changes = ["--set", "output.fields=false", "--set", "load.times=[1]"];
    assert_eq!(scratch.run(&[&["run", "model.toml", "--out", "bare", "--quiet"], &changes[..]].concat()).code, 0);
    let bare = scratch.run(&["export", "bare", "--to", "glb"]);
    assert!(bare.code == 2 && bare.err.contains("its results have no fields"), "{bare:?}");

    // It is crushed on the way; what was reached is shown.
    let crushed = ["--set", "force=[{ nodes = { near = [1, 1, 1] }, total = [-1, 0, 0] }]"];
    let ended =
        scratch.run(&[&["run", "model.toml", "--out", "crushed", "--quiet", "--no-report"], &crushed[..]].concat());
    assert_eq!(ended.code, 3, "{ended:?}");
    let summary = fs::read_to_string(scratch.path("crushed/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let on_the_way = summary["on_the_way"].as_array().unwrap().len();
    let reached = summary["steps"].as_array().unwrap().iter().filter(|step| step["converged"] == true).count();
    assert!(on_the_way > 0);
    assert_eq!(scratch.run(&["export", "crushed", "--to", "glb"]).code, 0);
    let found = gltf(&fs::read(scratch.path("crushed.glb")).unwrap());
    assert_eq!(found["meshes"][0]["extras"]["targetNames"].as_array().unwrap().len(), reached + on_the_way);
}
