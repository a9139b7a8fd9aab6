//! Parts from CAD and surfaces of triangles: what is refused without Gmsh and with it, from a surface to a model that can be solved; chambers
//! and places in model files.

use std::fmt::Write as _;
use std::fs;
use std::process::Command;

use crate::support::{Scratch, ended};

/// Triangles of boxes as a text.
fn surface(boxes: &[[[f64; 3]; 2]]) -> String {
    let mut text = String::new();
    for [low, high] in boxes {
        for i in 0..8 {
            let [x, y, z] = [0, 1, 2].map(|d| if i >> d & 1 == 0 { low[d] } else { high[d] });
            let _ = writeln!(text, "v {x} {y} {z}");
        }
    }
    for number in 0..boxes.len() {
        for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            let [a, b, c, d] = quad.map(|point| point + 1 + 8 * number);
            let _ = writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}");
        }
    }
    text
}

const BODY: [[[f64; 3]; 2]; 2] = [[[0.0; 3], [12.0, 5.0, 5.0]], [[2.0, 1.5, 1.5], [9.0, 3.5, 3.5]]];

#[test]
fn what_is_wrong_with_a_surface_is_said_with_its_place_before_anything_is_meshed() {
    let scratch = Scratch::new("surface");
    let whole = surface(&BODY);
    let open: Vec<&str> = whole.lines().filter(|line| *line != "f 6 8 7" && *line != "f 5 6 8").collect();
    fs::write(scratch.path("open.obj"), open.join("\n")).unwrap();
    fs::write(scratch.path("crossing.obj"), surface(&[BODY[0], [[6.0, 1.0, 1.0], [15.0, 4.0, 4.0]]])).unwrap();
    for (file, said) in [
        ("open.obj", "the surface has a hole of"),
        ("crossing.obj", "its triangles pass through each other, e.g. at (12, "),
        ("none.step", "cannot be read"),
        ("part.dwg", "is no part that can be meshed"),
    ] {
        let ended = scratch.run(&["mesh", file]);
        assert!(ended.code == 2 && ended.err.contains(said), "{file}: {ended:?}");
    }
    let mesh = |out: &str| {
        // No interpreter is on such a path.
        let mut command = Command::new(env!("CARGO_BIN_EXE_pneuflex"));
        command
            .args(["mesh", "whole.obj", "--out", out])
            .current_dir(scratch.path("."))
            .env("PATH", scratch.path("empty"));
        ended(command.output().unwrap())
    };
    fs::write(scratch.path("whole.obj"), whole).unwrap();
    let ended = mesh("a.msh");
    assert!(ended.code == 2 && ended.err.contains("pip install gmsh"), "{ended:?}");
    assert_eq!(scratch.listing(), ["crossing.obj", "open.obj", "whole.obj"]);
}

/// From triangles to a solved state, in three commands.
#[test]
fn a_surface_with_a_hollow_becomes_a_model_that_runs() {
    if !pneuflex::cad::has_gmsh() {
        eprintln!("passed over: Gmsh is not there (pip install gmsh)");
        return;
    }
    let scratch = Scratch::new("parts");
    fs::write(scratch.path("part.obj"), surface(&BODY)).unwrap();
    let meshed = scratch.run(&["mesh", "part.obj", "--size", "4", "--out", "part.msh"]);
    assert_eq!(meshed.code, 0, "{meshed:?}");
    assert!(meshed.err.contains("1 solid, 272 mm3; the thinnest wall is 1.5 mm"), "{}", meshed.err);
    assert!(meshed.out.contains("272.000000 mm3") && meshed.out.contains("28 mm3, closed"), "{}", meshed.out);
    // On the way, by a model file: the same body.
    let new = scratch.run(&["new", "model", "part.msh"]);
    assert_eq!(new.code, 0, "{new:?}");
    let checked = scratch.run(&["check", "part.toml", "--set", "model.file=part.obj", "--set", "model.size=4"]);
    assert_eq!(checked.code, 0, "{checked:?}");
    assert!(checked.out.contains("272.000000 mm3") && checked.out.contains("cavity    chamber 1: "), "{}", checked.out);
    assert!(checked.out.contains("25 mm2, x 0 to 0, y 0 to 5, z 0 to 5"), "{}", checked.out);
    let run = scratch.run(&[
        "run",
        "part.toml",
        "--quiet",
        "--no-report",
        "--set",
        "mesh.element=tet10",
        "--set",
        "load.times=[1]",
    ]);
    assert_eq!(run.code, 0, "{run:?}");
}

/// A chamber with a bore to the outside, as a mesh without groups: it is found, inflated and named in what is said.
#[test]
fn a_mesh_without_groups_runs_with_what_is_found_in_it() {
    let scratch = Scratch::new("hollow");
    let solid = |cell: [usize; 3]| !(0..3).all(|d| (1..[5, 3, 3][d] - 1).contains(&cell[d])) && cell != [0, 1, 1];
    let mut text = String::from(
        "# vtk DataFile Version 3.0\na hollow block\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 96 double\n",
    );
    for node in 0..96 {
        let _ = writeln!(text, "{} {} {}", node / 16, node / 4 % 4, node % 4);
    }
    let cells: Vec<[usize; 3]> = (0..45).map(|i| [i / 9, i / 3 % 3, i % 3]).filter(|cell| solid(*cell)).collect();
    let _ = writeln!(text, "CELLS {} {}", cells.len(), 9 * cells.len());
    for [i, j, k] in &cells {
        let node = |a: usize, b: usize, c: usize| 16 * (i + a) + 4 * (j + b) + k + c;
        let floor = |c: usize| format!("{} {} {} {}", node(0, 0, c), node(1, 0, c), node(1, 1, c), node(0, 1, c));
        let _ = writeln!(text, "8 {} {}", floor(0), floor(1));
    }
    let _ = writeln!(text, "CELL_TYPES {}\n{}", cells.len(), "12 ".repeat(cells.len()));
    fs::write(scratch.path("block.vtk"), text).unwrap();
    let model = "[model]\nfile = \"block.vtk\"\ninlet = [0, 1.5, 1.5]\n[[support]]\nnodes = { normal = \"x\", plane = { point = [5, 0, 0], normal = \"x\" } \
                 }\naxes = \"xyz\"\n[[cavity]]\nname = \"air\"\nfaces = \"cavity_1\"\npressure_kpa = 1\n[load]\ntimes = [1]\n";
    fs::write(scratch.path("block.toml"), model).unwrap();
    let checked = scratch.run(&["check", "block.toml"]);
    assert_eq!(checked.code, 0, "{checked:?}");
    assert!(
        checked.out.contains("hollow    cavity_1: 17 faces, 17 mm2, 4 mm3, open near (0, 1.5, 1.5) by 1 mm2"),
        "{}",
        checked.out
    );
    assert!(checked.out.contains("16 nodes, 9 faces, 9 mm2, x 5 to 5, y 0 to 3, z 0 to 3"), "{}", checked.out);
    let run = scratch.run(&["run", "block.toml", "--quiet", "--no-report"]);
    assert_eq!(run.code, 0, "{run:?}");
    // What is open has no volume to be pumped.
    let pumped =
        scratch.run(&["check", "block.toml", "--set", "cavity=[{name=\"air\",faces=\"cavity_1\",volume_mm3=1}]"]);
    assert!(pumped.code == 2 && pumped.err.contains("its walls must be closed"), "{pumped:?}");
    // What touches a plane is all but the hollow and, where the body is cut at a plane of symmetry, that.
    for (symmetry, faces) in [("false", "77 faces, 77 mm2"), ("true", "68 faces, 68 mm2")] {
        let cut = format!(
            "support=[{{nodes={{plane={{point=[5,0,0],normal=\"x\"}}}},axes=\"x\",symmetry={symmetry}}},{{nodes={{normal=\"-x\"}},axes=\"yz\"}}]"
        );
        let plane = "obstacle=[{name=\"floor\",shape=\"plane\",point=[0,0,-1],normal=[0,0,1],faces={and=[\"outer\",{box=[[-1,-1,-1],[9,9,9]]}]}}]";
        let checked = scratch.run(&["check", "block.toml", "--set", &cut, "--set", plane]);
        assert!(checked.code == 0 && checked.out.contains(faces), "{symmetry}: {checked:?}");
    }
}
