//! `new` and `check`.

use std::fs;

use crate::support::Scratch;

#[test]
fn new_case_files_pass_the_check() {
    let scratch = Scratch::new("new");
    let ended = scratch.run(&["new", "two-chamber"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert!(ended.out.contains("wrote two_chamber.toml") && ended.out.contains("pneuflex run two_chamber.toml"));
    assert_eq!(scratch.run(&["new", "actuator", "a.toml"]).code, 0);
    assert_eq!(scratch.listing(), ["a.toml", "two_chamber.toml"]);

    let two = scratch.run(&["check", "two_chamber.toml"]);
    assert_eq!(two.code, 0, "{two:?}");
    for words in ["1268.000000 mm3", "elements hex27", "clamp: ", "gap_1_left: ", "5, 15, 25, 35, 50 kPa"] {
        assert!(two.out.contains(words), "`{words}` is not in: {}", two.out);
    }
    let full = scratch.run(&["check", "a.toml"]);
    for words in ["8 chambers", "5460.000000 mm3", "7 gaps with ", "memory"] {
        assert!(full.out.contains(words), "`{words}` is not in: {}", full.out);
    }
    // Checking writes nothing.
    assert_eq!(scratch.listing(), ["a.toml", "two_chamber.toml"]);
}

#[test]
fn new_does_not_replace_a_file() {
    let scratch = Scratch::new("keep");
    fs::write(scratch.path("actuator.toml"), "mine").unwrap();
    let ended = scratch.run(&["new", "actuator"]);
    assert_eq!(ended.code, 2);
    assert!(ended.err.contains("actuator.toml: exists already"), "{}", ended.err);
    assert_eq!(fs::read_to_string(scratch.path("actuator.toml")).unwrap(), "mine");
}

#[test]
fn changes_reach_the_mesh() {
    let scratch = Scratch::new("set");
    scratch.run(&["new", "two-chamber", "case.toml"]);
    let ended = scratch.run(&[
        "check",
        "case.toml",
        "--set",
        "actuator.cavity_floor=2",
        "--set",
        "mesh.size=[2, 2, 1]",
        "--set",
        "mesh.element=hex8-q1p0",
        "--set",
        "contact.method=none",
        "--set",
        "probe=[{name=\"middle\", at=[9, 0.2, 0]}]",
    ]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let volume = 1268.0 - 2.0 * (6.0 * 9.0 * 2.0 - 12.0);
    for words in [&format!("{volume:.6} mm3"), "elements hex8-q1p0", "none, 1 gap with 0", "middle: node", "mm away"] {
        assert!(ended.out.contains(words), "`{words}` is not in: {}", ended.out);
    }
}

#[test]
fn a_resolution_on_the_command_line_replaces_the_mesh_of_the_file() {
    let scratch = Scratch::new("resolution");
    let fixture = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/two_chamber.toml");
    let case = fixture.to_str().unwrap();
    let unknowns = |set: &[&str]| {
        let mut arguments = vec!["check", case];
        set.iter().for_each(|s| arguments.extend(["--set", s]));
        let ended = scratch.run(&arguments);
        assert_eq!(ended.code, 0, "{ended:?}");
        let element = ended.out.split(" elements ").nth(1).unwrap().split(',').next().unwrap().to_owned();
        let count = ended.out.split(" unknowns").next().unwrap().rsplit(' ').next().unwrap().replace(',', "");
        (element, count.parse::<usize>().unwrap())
    };
    let [draft, standard, fine] = ["draft", "standard", "fine"].map(|r| unknowns(&[&format!("mesh.resolution={r}")]));
    assert_eq!([&draft.0, &standard.0, &fine.0], ["hex27"; 3]);
    assert!(draft.1 < standard.1 && standard.1 < fine.1, "{draft:?} {standard:?} {fine:?}");
    let both = unknowns(&["mesh.resolution=draft", "mesh.element=hex20"]);
    assert_eq!(both.0, "hex20");
}

#[test]
fn fixtures_pass_the_check() {
    let scratch = Scratch::new("fixtures");
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let ended = scratch.run(&["check", path.to_str().unwrap()]);
            assert_eq!(ended.code, 0, "{}: {}", path.display(), ended.err);
            let text = fs::read_to_string(&path).unwrap();
            for heading in ["# title:", "# goal:", "# source:", "# tolerance:"] {
                assert!(text.contains(heading), "{} has no `{heading}`", path.display());
            }
            count += 1;
        }
    }
    assert!(count >= 4);
}
