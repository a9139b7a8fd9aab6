//! Nothing is lost: runs die before every single operation on the disk, and are gone on with.

#![allow(clippy::unwrap_used)]

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use crate::analysis::Analysis;
use crate::disk::{Disk, Life};
use crate::folder::{OutputFolder, REPORT};
use crate::report_page::write_report;
use crate::start::Start;
use crate::study::Study;

const CASE: &str = "title = \"tiny\"\n[actuator]\nchambers = 2\nchamber_length = 8.0\ncavity_length = 6.0\ngap = 2.0\nflange = 0.0\n\
                    width = 20.0\nheight = 13.0\nbase = 4.0\nside_wall = 1.0\ntop_wall = 1.0\n\
                    channel = { half_width = 1.0, bottom = 2.0, top = 3.0 }\npart = \"half\"\n\
                    [mesh]\nelement = \"hex8-q1p0\"\nsize = 6.0\n[material]\nlaw = \"neo-hooke\"\nc10 = 0.2\n\
                    [load]\npressure_kpa = [0.2, 0.4]\n[solver]\nfirst_step_kpa = 0.2\nmax_step_kpa = 0.2\n";

const DECK: &str = "*HEADING\nA brick\n*INCLUDE, INPUT=nodes.inc\n*ELEMENT, TYPE=C3D8, ELSET=BAR\n1, 1, 2, 3, 4, 5, 6, 7, 8\n\
                    *NSET, NSET=FOOT\n1, 2, 3, 4\n*NSET, NSET=TOP\n5, 6, 7, 8\n*MATERIAL, NAME=SILICONE\n\
                    *HYPERELASTIC, NEO HOOKE\n0.1, 0.1\n*SOLID SECTION, ELSET=BAR, MATERIAL=SILICONE\n*BOUNDARY\nFOOT, 1, 3\n\
                    *STEP, NLGEOM\n*STATIC, DIRECT\n0.5, 1.\n*BOUNDARY\nTOP, 3, 3, 0.1\n*END STEP\n";

const NODES: &str =
    "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 2\n6, 1, 0, 2\n7, 1, 1, 2\n8, 0, 1, 2\n";

/// Half of the way is accepted beside the two times.
const MODEL: &str = "[model]\nfile = \"brick.inp\"\n[load]\ntimes = [0.4, 1.0]\n[solver]\nmax_step = 0.4\n\
                     [[probe]]\nname = \"top\"\nat = [1.0, 1.0, 2.0]\n";

fn analysis(name: &str) -> Analysis {
    let files = [("case.toml", CASE), ("model.toml", MODEL), ("brick.inp", DECK), ("nodes.inc", NODES)];
    let files = files.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
    Study::from_files(name, files).unwrap().build().unwrap()
}

fn scratch(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("pneuflex-deaths-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    path
}

/// What `pneuflex run` does, on a disk that fails for good after some operations.
fn run(analysis: &Analysis, path: &Path, life: Option<Arc<Life>>, resumes: bool) -> Result<(), Box<dyn Error>> {
    let folder = OutputFolder::prepare_on(path, Disk { life })?;
    let start = if resumes { folder.start(analysis)? } else { Start::AtRest };
    if !matches!(start, Start::Complete(_)) {
        analysis.run().record_in(folder.clone(), start).solve()?;
    } else if path.join(REPORT).exists() {
        return Ok(());
    }
    write_report(&folder)?;
    Ok(())
}

/// Paths of all files below a folder, and of folders without any.
fn listing(path: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut open = vec![path.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap().path();
            found.push(entry.strip_prefix(path).unwrap().display().to_string());
            if entry.is_dir() {
                open.push(entry);
            }
        }
    }
    found.sort();
    found
}

/// Requires the same numbers to 1e-9; seconds may differ.
#[track_caller]
fn assert_same(path: &str, found: &Value, expected: &Value) {
    match (found, expected) {
        (Value::Object(a), Value::Object(b)) => {
            assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{path}");
            for (key, value) in a.iter().filter(|(key, _)| *key != "timing") {
                assert_same(&format!("{path}.{key}"), value, &b[key]);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| assert_same(&format!("{path}[{i}]"), a, b));
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-3), "{path}: {a} and {b}");
        }
        _ => assert_eq!(found, expected, "{path}"),
    }
}

/// What a finished run leaves.
#[derive(Debug)]
struct Left {
    files: Vec<String>,
    summary: Value,
    texts: Vec<String>,
    lines: usize,
}

impl Left {
    fn in_folder(path: &Path) -> Self {
        let text = |name: &str| fs::read_to_string(path.join(name)).unwrap();
        Self {
            files: listing(path),
            summary: serde_json::from_str(&text("summary.json")).unwrap(),
            texts: ["case.toml", "fields/series.pvd"].map(text).into(),
            lines: text("history.jsonl").lines().count(),
        }
    }

    #[track_caller]
    fn assert_same(&self, expected: &Self, what: &str) {
        assert_eq!(self.files, expected.files, "{what}");
        assert_same(what, &self.summary, &expected.summary);
        assert_eq!((&self.texts, self.lines), (&expected.texts, expected.lines), "{what}");
    }
}

/// Dies before every operation, once more while it is gone on with, and must then end as if nothing had been.
fn dies_everywhere(name: &str) {
    let analysis = analysis(name);
    let path = scratch(name);
    let life = Life::of_length(usize::MAX);
    run(&analysis, &path, Some(life.clone()), false).unwrap();
    let undisturbed = Left::in_folder(&path);
    assert_eq!((undisturbed.summary["status"].as_str(), undisturbed.lines > 3), (Some("converged"), true));
    let operations = life.attempted();
    assert!(operations > 40, "{operations}");
    for first in 0..operations {
        fs::remove_dir_all(&path).unwrap_or_default();
        let life = Life::of_length(first);
        assert!(run(&analysis, &path, Some(life.clone()), false).is_err() && life.is_over(), "{name}: {first}");
        // Another number each time, up to the end of what is left to do.
        let second = (7 * first + 5) % (operations - first + 12);
        let life = Life::of_length(second);
        let again = run(&analysis, &path, Some(life.clone()), true);
        assert_eq!(again.is_err(), life.is_over(), "{name}: {first}, {second}: {again:?}");
        let what = format!("{name}, died before {first}, then {second}");
        run(&analysis, &path, None, true).unwrap_or_else(|error| panic!("{what}: {error}"));
        Left::in_folder(&path).assert_same(&undisturbed, &what);
    }
    fs::remove_dir_all(&path).unwrap();
}

#[test]
fn a_case_that_dies_anywhere_is_gone_on_with() {
    dies_everywhere("case.toml");
}

#[test]
fn a_model_that_dies_anywhere_is_gone_on_with() {
    dies_everywhere("model.toml");
}

#[test]
fn a_deck_that_dies_anywhere_is_gone_on_with() {
    dies_everywhere("brick.inp");
}

/// A run that takes the place of another one's results: either those are all there, or the new run can be gone on with.
#[test]
fn a_run_that_dies_while_it_replaces_another_loses_neither() {
    let (old, new) = (analysis("brick.inp"), analysis("model.toml"));
    let path = scratch("replaced");
    run(&new, &path, None, false).unwrap();
    let undisturbed = Left::in_folder(&path);
    fs::remove_dir_all(&path).unwrap();
    run(&old, &path, None, false).unwrap();
    let before = Left::in_folder(&path);
    let (mut refused, mut replaced) = (0, 0);
    for length in 0..40 {
        fs::remove_dir_all(&path).unwrap();
        run(&old, &path, None, false).unwrap();
        assert!(run(&new, &path, Some(Life::of_length(length)), false).is_err());
        match run(&new, &path, None, true) {
            Ok(()) => {
                Left::in_folder(&path).assert_same(&undisturbed, &format!("replaced, died before {length}"));
                replaced += 1;
            }
            Err(error) => {
                assert!(error.to_string().contains("the case has changed"), "{length}: {error}");
                Left::in_folder(&path).assert_same(&before, &format!("kept, died before {length}"));
                refused += 1;
            }
        }
    }
    assert!(refused >= 2 && replaced >= 20, "{refused} refused, {replaced} replaced");
    fs::remove_dir_all(&path).unwrap();
}

/// A run that is refused leaves what is there as it is: another case, a checkpoint with a damaged byte, equations that cannot be set up.
#[test]
fn a_start_that_is_refused_removes_nothing() {
    let (mut analysis, other) = (analysis("brick.inp"), analysis("case.toml"));
    let path = scratch("refused");
    run(&analysis, &path, None, false).unwrap();
    let before = Left::in_folder(&path);
    assert!(run(&other, &path, None, true).is_err());
    Left::in_folder(&path).assert_same(&before, "another case");

    analysis.requested.push(pneuflex_model::LoadParameter(1.5));
    let file = path.join("checkpoint.bin");
    let bytes = fs::read(&file).unwrap();
    let places = (0..bytes.len()).step_by(bytes.len() / 40 + 1).chain([bytes.len() - 1]);
    for at in places {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        fs::write(&file, damaged).unwrap();
        let error = run(&analysis, &path, None, true).unwrap_err().to_string();
        assert!(error.contains("checkpoint.bin is damaged"), "byte {at}: {error}");
    }
    fs::write(&file, bytes).unwrap();
    Left::in_folder(&path).assert_same(&before, "damaged");

    // An element without volume.
    let mut flat = analysis.clone();
    let mut mesh = (*flat.problem.mesh).clone();
    mesh.nodes.iter_mut().for_each(|node| node[2] = 0.0);
    flat.problem.mesh = Arc::new(mesh);
    let error = flat.run().record(&path).solve().unwrap_err();
    assert!(matches!(error, crate::Error::Setup(_)), "{error}");
    Left::in_folder(&path).assert_same(&before, "flat");
    fs::remove_dir_all(&path).unwrap();
}
