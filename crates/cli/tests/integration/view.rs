//! The report: written by `run`, written again by `view`, and what is said about folders that cannot be shown.

use std::fs;
use std::path::Path;

use crate::support::{Ended, Scratch};

const COARSE: &str = "two_chamber_coarse.toml";

fn solved(name: &str, more: &[&str]) -> (Scratch, Ended) {
    let scratch = Scratch::new(name);
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(COARSE);
    let arguments = [&["run", fixture.to_str().unwrap(), "--threads", "1", "--quiet", "--out", "out"], more].concat();
    let ended = scratch.run(&arguments);
    (scratch, ended)
}

fn report(scratch: &Scratch) -> String {
    fs::read_to_string(scratch.path("out/report.html")).unwrap()
}

#[test]
fn run_leaves_a_report_that_view_writes_again_identically() {
    let hostile = "title='</script><b>x'";
    let (scratch, ended) = solved("view", &["--set", hostile, "--set", "load.pressure_kpa=[5, 15]"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let page = report(&scratch);
    assert!(page.len() < 10_000_000, "{} bytes", page.len());
    assert!(page.contains("id=\"canvas\"") && !page.contains("<b>x") && !page.contains("NaN"));
    fs::remove_file(scratch.path("out/report.html")).unwrap();
    let ended = scratch.run(&["view", "out"]);
    assert_eq!((ended.code, ended.err.as_str()), (0, "wrote out/report.html\n"));
    assert_eq!(report(&scratch), page);
}

/// Two blocks of one element each, the upper one pressed onto the lower.
const DECK: &str = "*HEADING
</script><b>blocks
*NODE, NSET=ALL
1, 0, 0, 0\n2, 2, 0, 0\n3, 2, 2, 0\n4, 0, 2, 0\n5, 0, 0, 1\n6, 2, 0, 1\n7, 2, 2, 1\n8, 0, 2, 1
11, 0, 0, 1\n12, 1, 0, 1\n13, 1, 1, 1\n14, 0, 1, 1\n15, 0, 0, 2\n16, 1, 0, 2\n17, 1, 1, 2\n18, 0, 1, 2
*ELEMENT, TYPE=C3D8, ELSET=LOWER\n1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=UPPER\n2, 11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=FLOOR\n1, 2, 3, 4
*NSET, NSET=RAM\n15, 16, 17, 18
*SURFACE, NAME=ABOVE\nUPPER, S1
*SURFACE, NAME=BELOW\nLOWER, S2
*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.25, 0.02
*SOLID SECTION, ELSET=LOWER, MATERIAL=M\n*SOLID SECTION, ELSET=UPPER, MATERIAL=M
*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n10.
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nABOVE, BELOW
*BOUNDARY\nFLOOR, 1, 3\nRAM, 1, 2
*STEP, NLGEOM\n*STATIC\n0.5, 1\n*BOUNDARY\nRAM, 3, 3, -0.2\n*END STEP
";

#[test]
fn a_deck_leaves_a_report_that_view_writes_again_from_the_folder_alone() {
    let scratch = Scratch::new("view-deck");
    fs::write(scratch.path("blocks.inp"), DECK).unwrap();
    let ended = scratch.run(&["run", "blocks.inp", "--out", "out", "--threads", "1", "--quiet"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let page = report(&scratch);
    assert!(page.contains("id=\"canvas\"") && !page.contains("<b>blocks") && !page.contains("NaN"));
    for part in
        ["blocks.inp · 2 elements", "computed to time 1", "RAM: reaction x, y, z", "input/blocks.inp", "neo-hooke"]
    {
        assert!(page.contains(part), "{part}");
    }
    fs::remove_file(scratch.path("out/report.html")).unwrap();
    fs::remove_file(scratch.path("blocks.inp")).unwrap();
    let ended = scratch.run(&["view", "out"]);
    assert_eq!((ended.code, ended.err.as_str()), (0, "wrote out/report.html\n"));
    assert_eq!(report(&scratch), page);

    let copy = scratch.path("out/input/blocks.inp");
    fs::write(&copy, DECK.replace("3, 2, 2, 0\n", "3, 2, 2.5, 0\n")).unwrap();
    let ended = scratch.run(&["view", "out"]);
    assert!(ended.code == 2 && ended.err.contains("does not fit the mesh"), "{ended:?}");
    fs::remove_file(&copy).unwrap();
    let ended = scratch.run(&["view", "out"]);
    assert!(ended.code == 2 && ended.err.contains("blocks.inp: cannot be read"), "{ended:?}");
}

#[test]
fn without_fields_there_are_tables_and_plots_and_on_request_there_is_no_report() {
    let quick = ["--set", "output.fields=false", "--set", "load.pressure_kpa=[5]"];
    let (scratch, ended) = solved("view-no-fields", &quick);
    assert_eq!(ended.code, 0, "{ended:?}");
    let page = report(&scratch);
    assert!(
        page.contains("the run wrote no fields") && !page.contains("id=\"canvas\"") && page.contains("id=\"plots\"")
    );
    let (scratch, ended) = solved("view-no-report", &[&quick[..], &["--no-report"]].concat());
    assert_eq!((ended.code, scratch.path("out/report.html").exists()), (0, false), "{ended:?}");
}

#[test]
fn a_run_that_did_not_converge_has_a_report_that_says_so() {
    // Far beyond what the body can bear, and too few steps to try.
    let hopeless = ["--set", "load.pressure_kpa=[5, 100000]", "--set", "solver.min_step_kpa=10"];
    let (scratch, ended) = solved("view-failed", &hopeless);
    assert_eq!(ended.code, 3, "{ended:?}");
    let page = report(&scratch);
    let failure = page.find("The run did not converge").unwrap();
    assert!(failure < page.find("<main>").unwrap());
}

#[test]
fn folders_that_cannot_be_shown_are_bad_input() {
    let (scratch, _) = solved("view-bad", &["--set", "load.pressure_kpa=[5]", "--no-report"]);
    let refused = |what: &str| {
        let ended = scratch.run(&["view", "out"]);
        assert_eq!(ended.code, 2, "{ended:?}");
        assert!(ended.err.contains(what), "{} instead of {what}", ended.err);
        assert!(!scratch.path("out/report.html").exists());
    };
    let changed = |file: &str, change: &dyn Fn(&str) -> String, what: &str| {
        let path = scratch.path("out").join(file);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, change(&text)).unwrap();
        refused(what);
        fs::write(&path, text).unwrap();
    };
    changed("fields/step_01.vtu", &|t| t[..t.len() / 2].to_owned(), "fields/step_01.vtu: damaged: not an XML file");
    changed("summary.json", &|t| t[..t.len() / 2].to_owned(), "summary.json: damaged");
    changed("summary.json", &|t| t.replace("max_von_mises_mpa", "x"), "results are missing at 5 kPa");
    changed("case.toml", &|t| t.replace("gap = ", "gop = "), "unknown key `actuator.gop`");
    changed("case.toml", &|t| t.replace("gap = 2.0", "gap = 2.5"), "does not fit the mesh of case.toml");
    changed("case.toml", &|t| t.replace("size = [4.0, 4.0, 4.0]", "size = 0.001"), "that of summary.json has");
    for file in ["fields/contact_01.vtu", "case.toml"] {
        let (path, kept) = (scratch.path("out").join(file), scratch.path("kept"));
        fs::rename(&path, &kept).unwrap();
        refused(&format!("{file}: cannot be read"));
        fs::rename(&kept, &path).unwrap();
    }
    let ended = scratch.run(&["view", "nowhere"]);
    assert!(ended.code == 2 && ended.err.contains("nowhere: not a result folder"), "{ended:?}");
    fs::create_dir(scratch.path("empty")).unwrap();
    let ended = scratch.run(&["view", "empty"]);
    assert!(ended.code == 2 && ended.err.contains("holds no summary.json"), "{ended:?}");
}

/// Pictures of states of a run: as PNG and SVG, with the obstacle beside the body, and what cannot be drawn is refused.
#[test]
fn states_of_a_run_are_drawn_with_their_obstacles() {
    let scratch = Scratch::new("picture");
    let case = "[actuator]\nchambers = 2\nchamber_length = 8.0\ncavity_length = 6.0\ngap = 2.0\nflange = 2.0\nwidth = 20.0\nheight = 13.0\n\
                base = 4.0\nside_wall = 1.0\ntop_wall = 1.0\nchannel = { half_width = 1.0, bottom = 2.0, top = 3.0 }\n[mesh]\nsize = 4.5\n\
                element = \"hex8-q1p0\"\n[load]\npressure_kpa = [2, 4]\n[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\n\
                centre = [20, 0, -6]\nradius = 4\n";
    fs::write(scratch.path("case.toml"), case).unwrap();
    // Before it is solved, the obstacle itself is there, beside the faces that may touch it.
    assert_eq!(scratch.run(&["check", "case.toml", "--picture", "check.html"]).code, 0);
    let page = fs::read_to_string(scratch.path("check.html")).unwrap();
    let (listed, data) = page.split_once("report-data\" type=\"application/json\">").unwrap();
    let kinds: Vec<&str> = listed.split("<strong>").skip(1).filter_map(|rest| rest.split("</strong>").next()).collect();
    assert_eq!(kinds.iter().filter(|kind| **kind == "obstacle").count(), 2, "{kinds:?}");
    let data: serde_json::Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    let last = data["parts"].as_array().unwrap().last().unwrap();
    assert!(last["triangles"].as_str().unwrap().len() > 10_000 && last["points"] == "", "the ball");
    assert_eq!(scratch.run(&["run", "case.toml", "--out", "run", "--quiet", "--no-report"]).code, 0);
    let drawn = scratch.run(&["picture", "run"]);
    assert_eq!(drawn.code, 0, "{drawn:?}");
    assert_eq!(&fs::read(scratch.path("run/picture.png")).unwrap()[1..4], b"PNG");
    let svg = |more: &[&str]| {
        let ended = scratch.run(&[&["picture", "run", "--out", "a.svg"], more].concat());
        assert_eq!(ended.code, 0, "{more:?} {ended:?}");
        fs::read_to_string(scratch.path("a.svg")).unwrap()
    };
    for (more, words) in [
        (&["--at", "2"][..], &["at 2 kPa", "von Mises stress (MPa)", "99 %"][..]),
        (&["--view", "side", "--colour", "displacement"], &["at 4 kPa", "displacement (mm)"]),
        (&["--view", "section", "--colour", "contact", "--range", "0,0.5"], &["contact pressure (MPa)", "0.5"]),
    ] {
        let text = svg(more);
        assert!(words.iter().all(|word| text.contains(word)), "{more:?}");
    }
    assert!(!svg(&["--colour", "none"]).contains("MPa"));
    for (more, words) in [
        (&["--at", "3"][..], "there are no results at 3 kPa"),
        (&["--out", "a.jpg"], "ends with .png or .svg"),
        (&["--range", "2,1"], "--range 2,1: expected two finite numbers"),
        (&["--width", "20"], "300..=4000"),
    ] {
        let ended = scratch.run(&[&["picture", "run"], more].concat());
        assert!(ended.code == 2 && ended.err.contains(words), "{more:?} {ended:?}");
    }
    assert_eq!(scratch.run(&["run", "case.toml", "--out", "bare", "--quiet", "--set", "output.fields=false"]).code, 0);
    let ended = scratch.run(&["picture", "bare"]);
    assert!(ended.code == 2 && ended.err.contains("its results have no fields"), "{ended:?}");
}
