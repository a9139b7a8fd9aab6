//! Every kind of bad input: one clear message, exit code 2, and nothing written.

use std::fs;
use std::path::Path;

use crate::support::{Scratch, ended};

/// Writes a case file made from the two-chamber template and checks it with `run`: the message holds every word of
/// `expected`, the exit code is 2 and the case file is the only thing in the folder.
#[track_caller]
fn refused(name: &str, edit: impl Fn(String) -> String, set: &[&str], expected: &[&str]) {
    let scratch = Scratch::new(name);
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    let text = edit(fs::read_to_string(scratch.path("case.toml")).unwrap());
    fs::write(scratch.path("case.toml"), &text).unwrap();
    for command in ["run", "check"] {
        let mut arguments = vec![command, "case.toml"];
        set.iter().for_each(|s| arguments.extend(["--set", s]));
        let ended = scratch.run(&arguments);
        assert_eq!(ended.code, 2, "{command}: {ended:?}");
        assert!(ended.out.is_empty(), "{ended:?}");
        assert_eq!(ended.err.matches("error:").count(), 1, "one message: {}", ended.err);
        for word in expected {
            assert!(ended.err.contains(word), "{command}: `{word}` is not in: {}", ended.err);
        }
        assert_eq!(scratch.listing(), ["case.toml"], "{command}");
        assert_eq!(fs::read_to_string(scratch.path("case.toml")).unwrap(), text);
    }
}

/// Line of the template (from 1) that begins with `start`, as it stands in messages.
fn line_of(start: &str) -> String {
    let scratch = Scratch::new(&format!("line-{}", start.len()));
    scratch.run(&["new", "two-chamber", "case.toml"]);
    let text = fs::read_to_string(scratch.path("case.toml")).unwrap();
    let line = text.lines().position(|l| l.starts_with(start)).unwrap();
    format!("case.toml:{}:", line + 1)
}

/// The template's choice of a mesh.
const RESOLUTION: &str = "resolution = \"standard\"";

fn replace(from: &'static str, to: &'static str) -> impl Fn(String) -> String {
    move |text| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    }
}

#[test]
fn unknown_key_with_a_suggestion() {
    let place = line_of("gap = ");
    refused(
        "unknown",
        replace("gap = 2.0", "gpa = 2.0"),
        &[],
        &[&place, "unknown key `actuator.gpa`", "did you mean `gap`?"],
    );
    let place = line_of("[load]");
    refused("table", replace("[load]", "[loads]"), &[], &[&place, "unknown key `loads`", "did you mean `load`?"]);
}

/// Misspelt, missing, misplaced, of the wrong type and out of range: everything is said, in the order of the file, underlined.
#[test]
fn all_problems_are_said_at_once() {
    let scratch = Scratch::new("all");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    let mut text = fs::read_to_string(scratch.path("case.toml")).unwrap();
    for (from, to) in [
        ("gap = 2.0", "gpa = 2.0"),
        ("width = 20.0", ""),
        ("side_wall = 1.0", "side_wall = \"thin\""),
        ("top_wall = 1.0", "top_wall = -1.0"),
        ("c10 = 0.2712", "c10 = 0.0\ncolour = \"red\""),
        ("[5, 15, 25, 35, 50]", "[5, 4]"),
    ] {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    fs::write(scratch.path("case.toml"), &text).unwrap();
    let ended = scratch.run(&["run", "case.toml"]);
    assert_eq!(ended.code, 2, "{ended:?}");
    let errors: Vec<&str> = ended.err.lines().filter(|line| line.starts_with("error:")).collect();
    let expected = [
        "`actuator.width` is missing",
        "unknown key `actuator.gpa`",
        "actuator.side_wall: wrong type",
        "actuator.top_wall = -1",
        "material.c10 = 0.0",
        "unknown key `material.colour`",
        "load.pressure_kpa",
    ];
    assert_eq!(errors.len(), expected.len(), "{}", ended.err);
    for (error, words) in errors.iter().zip(expected) {
        assert!(error.contains(words), "`{words}` is not in: {error}");
    }
    let underlined = ended.err.lines().skip_while(|line| !line.contains("| top_wall = -1.0")).nth(1).unwrap();
    assert_eq!(underlined.split_once("| ").unwrap().1, "^^^^^^^^^^^^^^^", "{}", ended.err);
    assert!(ended.err.contains("did you mean `gap`?"), "{}", ended.err);
    assert_eq!(scratch.listing(), ["case.toml"]);
}

#[test]
fn constants_of_another_law_missing_ones_and_lists_that_do_not_match() {
    let law = |table: &'static str| {
        move |text: String| {
            let yeoh = "law = \"yeoh\"\nc10 = 0.2712\nc20 = 0.03053\nc30 = -0.0004013\n";
            assert!(text.contains(yeoh), "{text}");
            text.replacen(yeoh, table, 1)
        }
    };
    let line = |offset: usize| {
        let start: usize = line_of("law = ").trim_end_matches(':').rsplit(':').next().unwrap().parse().unwrap();
        format!("case.toml:{}:", start + offset)
    };
    let misplaced = "key `material.c30` is out of place: a constant of yeoh; the constants of neo-hooke are c10";
    refused("misplaced", law("law = \"neo-hooke\"\nc10 = 0.1\nc30 = 0.1\n"), &[], &[&line(2), misplaced]);
    refused("missing-constant", law("law = \"neo-hooke\"\n"), &[], &["[material]", "key `material.c10` is missing"]);
    let words = [&line(2), "material.alpha = [2.0, NaN] is out of range", "as many numbers as mu has"];
    refused("lists", law("law = \"ogden\"\nmu = [0.1, 0.2]\nalpha = [2.0]\n"), &[], &words);
    let words = [&line(1), "material.mu = [0.1, -0.2] is out of range", "shear modulus at rest, greater than 0 MPa"];
    refused("soft", law("law = \"ogden\"\nmu = [0.1, -0.2]\nalpha = [2.0, 3.0]\n"), &[], &words);
    let words =
        ["material.invariant = \"full\" is out of range: must be \"isochoric\" where material.law = \"mooney-rivlin\""];
    refused("full", law("law = \"mooney-rivlin\"\nc10 = 0.1\nc01 = 0.1\n"), &["material.invariant=full"], &words);
    let words = ["material.density = -1.0 is out of range", "0 or greater, g/cm3"];
    refused("density", law("law = \"yeoh\"\ndensity = -1\n"), &[], &words);
}

#[test]
fn negative_thickness() {
    let place = line_of("side_wall");
    refused(
        "negative",
        replace("side_wall = 1.0", "side_wall = -1.0"),
        &[],
        &[&place, "actuator.side_wall = -1", "must be greater than 0 and less than 10 mm"],
    );
}

#[test]
fn walls_that_overlap() {
    let place = line_of("cavity_length");
    refused(
        "overlap",
        replace("cavity_length = 6.0", "cavity_length = 8.5"),
        &[],
        &[&place, "actuator.cavity_length = 8.5", "less than 8 mm"],
    );
    let place = line_of("channel");
    refused(
        "channel",
        replace("top = 3.0", "top = 4.0"),
        &[],
        &[&place, "actuator.channel.top = 4", "greater than 2 and less than 4 mm"],
    );
}

#[test]
fn pressures_that_do_not_increase_or_are_not_finite() {
    let place = line_of("pressure_kpa");
    for (name, list) in
        [("same", "[5, 15, 15]"), ("down", "[15, 5]"), ("nan", "[5, nan]"), ("inf", "[inf]"), ("none", "[]")]
    {
        let edit = |text: String| text.replacen("[5, 15, 25, 35, 50]", list, 1);
        refused(name, edit, &[], &[&place, "load.pressure_kpa", "strictly increasing list of finite pressures"]);
    }
}

#[test]
fn mesh_size_zero() {
    let place = line_of("resolution");
    refused("zero", replace(RESOLUTION, "size = 0"), &[], &[&place, "mesh.size = 0.0", "greater than 0 mm"]);
    refused("part", replace(RESOLUTION, "size = [1, 1]"), &[], &[&place, "mesh.size", "three numbers [sx, sy, sz]"]);
}

#[test]
fn a_mesh_that_will_not_fit_in_memory() {
    let words = ["will not fit in memory", "elements", "unknowns", "GiB", "mesh.size", "--force"];
    refused("huge", replace(RESOLUTION, "size = 0.02"), &[], &words);
    let of_lengths = "greater than 0 mm: from 1e-6 to 1e6";
    refused("wide", replace("width = 20.0", "width = 1e200"), &[], &["actuator.width = 1", "from 1e-6 to 1e6 mm"]);
    refused("absurd", replace(RESOLUTION, "size = 1e-300"), &[], &["mesh.size = 1e-300", of_lengths]);
}

#[test]
fn broken_utf8() {
    let scratch = Scratch::new("utf8");
    fs::write(scratch.path("case.toml"), b"title = \"x\"\n[actuator]\nchambers = \xff2\n").unwrap();
    for command in ["run", "check"] {
        let ended = scratch.run(&[command, "case.toml"]);
        assert_eq!(ended.code, 2);
        assert!(ended.err.contains("case.toml:3:12: not valid UTF-8"), "{}", ended.err);
    }
    assert_eq!(scratch.listing(), ["case.toml"]);
}

#[test]
fn broken_toml_and_wrong_types() {
    let place = line_of("gap = ");
    refused("toml", replace("gap = 2.0", "gap = = 2.0"), &[], &[&place, "not valid TOML"]);
    refused("twice", replace("gap = 2.0", "gap = 2.0\ngap = 3.0"), &[], &["not valid TOML", "duplicate key"]);
    refused("type", replace("gap = 2.0", "gap = \"wide\""), &[], &[&place, "actuator.gap", "expected a number"]);
    let place = line_of("chambers");
    refused("count", replace("chambers = 2", "chambers = -2"), &[], &[&place, "actuator.chambers", "whole number"]);
    let place = line_of("resolution");
    refused(
        "resolution",
        replace("\"standard\"", "\"standart\""),
        &[],
        &[&place, "mesh.resolution = \"standart\"", "draft", "did you mean `standard`?"],
    );
    refused(
        "element",
        replace(RESOLUTION, "element = \"hex8-sir\""),
        &[],
        &[&place, "mesh.element = \"hex8-sir\"", "hex8-q1p0", "did you mean `hex8-sri`?"],
    );
}

#[test]
fn missing_keys() {
    refused("missing", replace("gap = 2.0", "# gap = 2.0"), &[], &["case.toml:", "key `actuator.gap` is missing"]);
}

#[test]
fn probes_are_named_by_their_number() {
    let add = |text: String| text + "\n[[probe]]\nname = \"tip\"\nat = [0, 0, 0]\n";
    refused("probe", add, &[], &["case.toml:", "probe[1].name = \"tip\"", "different for every probe"]);
}

#[test]
fn changes_on_the_command_line() {
    let same = |text: String| text;
    refused("set-range", same, &["actuator.gap=-1"], &["--set actuator.gap=-1: actuator.gap = -1", "at least 0"]);
    refused(
        "set-key",
        same,
        &["mesh.sise=2"],
        &["--set mesh.sise=2", "unknown key `mesh.sise`", "did you mean `size`?"],
    );
    refused(
        "set-entry",
        same,
        &["actuator.gap[2]=1"],
        &["--set actuator.gap[2]=1: actuator.gap[2] cannot be set", "entries from 1 to 1"],
    );
    refused(
        "set-entry-range",
        same,
        &["actuator.top_wall[2]=-1"],
        &["--set actuator.top_wall[2]=-1: actuator.top_wall[2] = -1"],
    );
    refused("set-form", same, &["actuator.gap"], &["--set actuator.gap: expected KEY=VALUE"]);
    refused("set-word", same, &["mesh.element=hex9"], &["--set mesh.element=hex9", "hex8-q1p0"]);
    refused("set-odd", same, &["a b=1"], &["--set a b=1", "`a b` is not a key"]);
    // The second change is the one out of range, and the first is in force: 8 mm chambers would allow 7 mm cavities.
    let changes = ["actuator.chamber_length=5", "actuator.cavity_length=7"];
    refused("set-two", same, &changes, &["--set actuator.cavity_length=7:", "less than 5 mm"]);
    // A value of the file that a change has made impossible is shown in the file.
    let place = line_of("cavity_length");
    refused(
        "set-other",
        same,
        &["actuator.chamber_length=5"],
        &[&place, "actuator.cavity_length = 6", "less than 5 mm"],
    );
}

#[test]
fn files_that_are_not_there() {
    let scratch = Scratch::new("absent");
    let ended = scratch.run(&["run", "nothing.toml"]);
    assert_eq!(ended.code, 2);
    assert!(ended.err.contains("nothing.toml: cannot be read"), "{}", ended.err);
    assert!(scratch.listing().is_empty());
    assert_eq!(scratch.run(&["walk"]).code, 2);
    assert_eq!(scratch.run(&["run", "case.toml", "--threads", "0"]).code, 2);
    let many = scratch.run(&["run", "case.toml", "--threads", "60000"]);
    assert!(many.code == 2 && many.err.contains("four times the"), "{many:?}");
}

#[test]
fn output_folder_not_writable() {
    let scratch = Scratch::new("output");
    scratch.run(&["new", "two-chamber", "case.toml"]);
    fs::write(scratch.path("taken"), "a file").unwrap();
    for (out, words) in [("taken", "taken by a file"), ("taken/below", "cannot be created")] {
        let ended = scratch.run(&["run", "case.toml", "--out", out]);
        assert_eq!(ended.code, 2, "{ended:?}");
        assert!(ended.err.contains(out) && ended.err.contains(words), "{}", ended.err);
    }
    // A folder with something else in it.
    fs::create_dir(scratch.path("mine")).unwrap();
    fs::write(scratch.path("mine/summary.json"), "{\"grades\": [1, 2]}").unwrap();
    let ended = scratch.run(&["run", "case.toml", "--out", "mine"]);
    assert_eq!(ended.code, 2);
    assert!(ended.err.contains("no results of pneuflex"), "{}", ended.err);
    assert_eq!(fs::read_to_string(scratch.path("mine/summary.json")).unwrap(), "{\"grades\": [1, 2]}");
    assert_eq!(scratch.listing(), ["case.toml", "mine", "taken"]);
}

#[cfg(unix)]
#[test]
fn output_folder_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new("permission");
    scratch.run(&["new", "two-chamber", "case.toml"]);
    let locked = scratch.path("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    // The superuser may write everywhere: nothing to be seen then.
    if fs::write(locked.join("trial"), "").is_ok() {
        return;
    }
    let ended = scratch.run(&["run", "case.toml", "--out", "locked"]);
    assert_eq!(ended.code, 2);
    assert!(ended.err.contains("locked: the output folder is not writable"), "{}", ended.err);
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn huge_and_hostile_files_are_refused_within_bounded_memory() {
    let scratch = Scratch::new("hostile");
    let files = [
        ("large", "# \n".repeat(400_000), "larger than 1 MB"),
        ("nested", format!("a = {}", "[".repeat(900_000)), "not valid TOML"),
        ("dotted", format!("{}a = 1", "a.".repeat(450_000)), "not valid TOML: recursion limit"),
        ("long", format!("{} = 1", "x".repeat(900_000)), "unknown key `xxx"),
        ("probes", "[[probe]]\nname = \"a\"\nat = [nan, 0, 0]\n".repeat(24_000), "is missing"),
    ];
    for (name, text, words) in &files {
        fs::write(scratch.path(name), text).unwrap();
        let limited = ["-c", "ulimit -v 1000000; exec \"$0\" check \"$1\"", env!("CARGO_BIN_EXE_pneuflex"), name];
        let run = std::process::Command::new("sh").args(limited).current_dir(scratch.path(".")).output();
        // Where there is no such shell, at least the program is run.
        let ended = run.map_or_else(|_| scratch.run(&["check", name]), ended);
        assert_eq!(ended.code, 2, "{name}: {ended:.2000?}");
        assert!(
            ended.err.contains(words) && ended.err.len() < 50_000,
            "{name}: {} bytes {:.2000}",
            ended.err.len(),
            ended.err
        );
    }
    // Nothing forces a mesh whose nodes cannot be numbered.
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    for size in ["1e-5", "1e-6"] {
        let forced = scratch.run(&["run", "case.toml", "--force", "--set", &format!("mesh.size={size}")]);
        assert!(forced.code == 2 && forced.err.contains("will not fit in memory"), "{size}: {forced:?}");
    }
    if cfg!(unix) {
        let endless = scratch.run(&["check", "/dev/zero"]);
        assert!(endless.code == 2 && endless.err.contains("a device or a pipe"), "{endless:?}");
    }
}

/// Numbers at the end of what can be written are out of range, whatever kind of file has them, and whatever they are of.
#[test]
fn numbers_that_nobody_means() {
    for (key, value) in [
        ("actuator.gap", "5e-324"),
        ("actuator.flange", "1e300"),
        ("mesh.edge_size", "1e308"),
        ("material.c10", "5e-324"),
        ("material.c20", "1e300"),
        ("material.bulk_modulus", "1e308"),
        ("material.density", "5e-324"),
        ("contact.stiffness", "1e300"),
        ("load.pressure_kpa", "[5e-324]"),
        ("solver.tolerance", "5e-324"),
    ] {
        refused(&format!("size-{key}"), |text| text, &[&format!("{key}={value}")], &[key, "is out of range"]);
    }
    let scratch = Scratch::new("size-model");
    let model = "[actuator]\nchambers = 2\nchamber_length = 8.0\ncavity_length = 6.0\ngap = 2.0\nflange = 0.0\nwidth = 20.0\n\
                 height = 13.0\nbase = 4.0\nside_wall = 1.0\ntop_wall = 1.0\n\
                 channel = { half_width = 1.0, bottom = 2.0, top = 3.0 }\n[load]\ntimes = [5e-324]\n\
                 [[force]]\nnodes = \"end_face\"\ntotal = [1e300, 0, 0]\n[gravity]\nacceleration = [0, 0, 1e308]\n\
                 [[cavity]]\nname = \"air\"\nfaces = \"cavity\"\npressure_kpa = [[0, 0], [1, 1e300]]\n\
                 [[obstacle]]\nname = \"table\"\nshape = \"plane\"\npoint = [0, 0, -1e300]\nnormal = [0, 0, 1]\n";
    fs::write(scratch.path("model.toml"), model).unwrap();
    let ended = scratch.run(&["check", "model.toml"]);
    assert_eq!(ended.code, 2, "{ended:?}");
    for key in ["load.times", "force[0].total", "gravity.acceleration", "cavity[0].pressure_kpa", "obstacle[0].point"] {
        assert!(ended.err.contains(&format!("{key} = ")), "{key}: {}", ended.err);
    }
    fs::write(scratch.path("deck.inp"), "*NODE\n1, 1e300, 0, 0\n2, 5e-324, 0, 0\n").unwrap();
    let ended = scratch.run(&["check", "deck.inp"]);
    assert!(ended.code == 2 && ended.err.contains("too large") && ended.err.contains("too small"), "{ended:?}");
}

/// Files in the place of others: the message says what they are, and leads on.
#[test]
fn another_kind_of_file_than_expected() {
    let scratch = Scratch::new("foreign");
    for (name, text, words) in [
        ("one_tet.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "a mesh needs a model file"),
        ("part.stl", "solid part\nfacet normal 0 0 1\n", "without a mesh inside"),
        ("curve.csv", "stretch;stress\n1;0\n", "pneuflex fit"),
        ("deck.txt", "*HEADING\n*NODE\n", "end in .inp"),
        ("case.toml", "version https://git-lfs.github.com/spec/v1\noid sha256:12\nsize 9\n", "git lfs pull"),
        ("deck.inp", "version https://git-lfs.github.com/spec/v1\noid sha256:12\nsize 9\n", "git lfs pull"),
        ("a.toml", "[model]\nfile = \"part.stl\"\n[load]\ntimes = [1]\n", "the file has no triangle"),
    ] {
        fs::write(scratch.path(name), text).unwrap();
        let ended = scratch.run(&["check", name]);
        assert!(ended.code == 2 && ended.err.contains(words), "{name}: {ended:?}");
        assert_eq!(ended.err.matches("error:").count(), 1, "{name}: {}", ended.err);
    }
    let fit = scratch.run(&["fit", "case.toml"]);
    assert!(fit.code == 2 && fit.err.contains("git lfs pull"), "{fit:?}");
    let folder = scratch.run(&["check", "."]);
    assert!(folder.code == 2 && folder.err.contains("it is a folder"), "{folder:?}");
}

/// Includes without end are one error at once; what is included from elsewhere is named.
#[test]
fn included_files_end_and_are_where_they_are_expected() {
    let scratch = Scratch::new("included");
    fs::write(scratch.path("self2.inp"), "*HEADING\n".to_owned() + &"*INCLUDE, INPUT=self2.inp\n".repeat(3)).unwrap();
    fs::write(scratch.path("bomb.inp"), "*HEADING\n*INCLUDE, INPUT=b0.inc\n").unwrap();
    for level in 0..15 {
        let next = format!("*INCLUDE, INPUT=b{}.inc\n", level + 1).repeat(4);
        fs::write(scratch.path(&format!("b{level}.inc")), if level < 14 { &next } else { "*NODE\n" }).unwrap();
    }
    for name in ["self2.inp", "bomb.inp"] {
        let ended = scratch.run(&["check", name]);
        assert_eq!((ended.code, ended.err.matches("error:").count()), (2, 1), "{name}: {ended:?}");
    }
    let deck =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/decks/blocks.inp")).unwrap();
    let (nodes, rest) = deck.split_once("*ELEMENT").unwrap();
    fs::create_dir(scratch.path("deck")).unwrap();
    fs::write(scratch.path("nodes.inc"), nodes).unwrap();
    fs::write(scratch.path("deck/a.inp"), format!("*INCLUDE, INPUT=../nodes.inc\n*ELEMENT{rest}")).unwrap();
    let ended = scratch.run(&["check", "deck/a.inp"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert!(ended.err.contains("nodes.inc is included, which lies outside of the deck's folder"), "{}", ended.err);
}

/// A case from another program, through a pipe or a file.
#[cfg(unix)]
#[test]
fn standard_input_is_an_input() {
    let scratch = Scratch::new("stdin");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    for command in ["cat case.toml | \"$0\" check /dev/stdin", "\"$0\" check /dev/stdin < case.toml"] {
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", command, env!("CARGO_BIN_EXE_pneuflex")]).current_dir(scratch.path("."));
        let ended = ended(shell.output().unwrap());
        assert!(ended.code == 0 && ended.out.contains("chambers"), "{command}: {ended:?}");
    }
}
