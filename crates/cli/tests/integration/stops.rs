//! Runs that cannot come to their end, and what is said of them: the true reason, and a remedy that this kind of file has.

use std::path::Path;

use crate::support::Scratch;

fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/stops").join(name).to_str().unwrap().to_owned()
}

/// What nothing holds is found before anything is solved, and the free motions are named.
#[test]
fn free_rigid_motions_are_named_before_solving() {
    let scratch = Scratch::new("free");
    let all = "nothing holds the body: it is free to slide along x, y and z, and to turn about x, y and z";
    for (name, message, help) in [
        ("nothing_holds.inp", all, "*BOUNDARY"),
        ("one_tet.toml", all, "[[support]]"),
        ("slides.inp", "the body is not held: it is free to slide along x and y, and to turn about z", "*BOUNDARY"),
    ] {
        for command in ["check", "run"] {
            let ended = scratch.run(&[command, &fixture(name)]);
            assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{command} {name}: {ended:?}");
            assert!(ended.err.contains(message) && ended.err.contains(help), "{command} {name}: {}", ended.err);
        }
    }
    assert_eq!(scratch.listing(), [""; 0]);
}

/// A body that only contact may hold is called that, and solved.
#[test]
fn a_body_held_by_contact_only_is_called_that() {
    let scratch = Scratch::new("contact-only");
    let deck = std::fs::read_to_string(fixture("slides.inp")).unwrap();
    let deck = deck.replace("*STEP", "*SURFACE, NAME=SIDES\nBAR, S3\nBAR, S4\nBAR, S5\nBAR, S6\n*STEP");
    std::fs::write(scratch.path("bar.inp"), deck).unwrap();
    let walls: Vec<String> = [("x", [0, 0, 0], "[1, 0, 0]"), ("y", [0, 0, 0], "[0, 1, 0]")]
        .iter()
        .map(|(name, point, normal)| {
            format!(
                "[[obstacle]]\nname = \"{name}\"\nshape = \"plane\"\npoint = {point:?}\nnormal = {normal}\nfaces = \"SIDES\"\n"
            )
        })
        .collect();
    std::fs::write(scratch.path("bar.toml"), format!("[model]\nfile = \"bar.inp\"\n{}", walls.concat())).unwrap();
    let checked = scratch.run(&["check", "bar.toml"]);
    assert_eq!(checked.code, 0, "{checked:?}");
    let words =
        "warning: only contact holds the body: without it, it is free to slide along x and y, and to turn about z";
    assert!(checked.err.contains(words), "{}", checked.err);
}
