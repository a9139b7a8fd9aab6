//! `cargo xtask pictures`: pictures by a browser, to be looked at, in `target/pictures`.
//!
//! * The reports of six runs (two chambers, an actuator, a gripper, a blocked force, an imported finger, a run that stopped), from top to
//!   bottom, on a desk and on a phone, light and dark.
//! * The mould of the guide, which `--docs` puts there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

use crate::program;
use crate::report_test::browser::{self, Browser};
use crate::report_test::visit::{SCREENS, Visit};
use crate::report_test::{Results, SOFTWARE};

/// The reports that are looked at, and what they are of. The last one stops.
const REPORTS: [(&str, &str); 6] = [
    ("two_chambers", "fixtures/two_chamber_coarse.toml"),
    ("actuator", "fixtures/actuator_coarse.toml"),
    ("gripper", "fixtures/models/gripper.toml"),
    ("blocked_force", "fixtures/blocked_force.toml"),
    ("finger", "fixtures/models/finger.toml"),
    ("stopped", "fixtures/stops/balloon_pressure.toml"),
];

/// Bytes of a binary STL file before its triangles, of one of them, and where its corners are in them.
const STL_HEAD: usize = 84;
const STL_TRIANGLE: usize = 50;
const STL_CORNERS: std::ops::Range<usize> = 12..48;

/// Makes the pictures.
pub fn run(arguments: &[String]) -> ExitCode {
    let with_docs = match arguments {
        [] => false,
        [argument] if argument == "--docs" => true,
        _ => {
            eprintln!("pictures: expected nothing or --docs");
            return ExitCode::from(2);
        }
    };
    match pictures(with_docs) {
        Ok(folder) => {
            println!("pictures: they are in {}", folder.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("pictures: {error}");
            ExitCode::FAILURE
        }
    }
}

fn pictures(with_docs: bool) -> Result<PathBuf, String> {
    let chromium =
        browser::installed().ok_or("no Chromium is installed, or set CHROMIUM to the path of its program")?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = program::target_folder(&root).join("pictures");
    let _ = fs::remove_dir_all(&target);
    fs::create_dir_all(&target).map_err(|e| format!("{}: {e}", target.display()))?;
    let target = target.canonicalize().map_err(|e| e.to_string())?;
    let program = program::build(&root)?;
    let mut browser = Browser::start(&chromium, &target.join("profile"), &SOFTWARE)?;
    for (name, file) in REPORTS {
        let folder = target.join(name);
        pneuflex(&program, &["run".as_ref(), root.join(file).as_os_str(), "--out".as_ref(), folder.as_os_str()])?;
        let results = Results::of_body(folder)?;
        for screen in &SCREENS {
            let mut visit = Visit { browser: &mut browser, screen, results: &results, pictures: &target };
            visit.open()?;
            visit.slices(name)?;
        }
        println!("pictures: {name}");
    }
    let picture = mould(&program, &target, &mut browser)?;
    let place = if with_docs { root.join("docs/guide/src") } else { target.clone() }.join("mould.png");
    fs::write(&place, picture).map_err(|e| format!("{}: {e}", place.display()))?;
    drop(browser);
    let _ = fs::remove_dir_all(target.join("profile"));
    Ok(target)
}

/// Runs the program. That a run stops is no error: its report is what is looked at.
fn pneuflex(program: &Path, arguments: &[&std::ffi::OsStr]) -> Result<(), String> {
    let status = Command::new(program).args(arguments).arg("--quiet").status();
    status.map(drop).map_err(|e| format!("{} cannot be started: {e}", program.display()))
}

/// The mould of the actuator among the reports.
fn mould(program: &Path, target: &Path, browser: &mut Browser) -> Result<Vec<u8>, String> {
    let folder = target.join("mould");
    let results = target.join("actuator");
    let status = Command::new(program)
        .args([
            "export".as_ref(),
            results.as_os_str(),
            "--to".as_ref(),
            "mould".as_ref(),
            "--wall".as_ref(),
            "4".as_ref(),
        ])
        .arg("--out")
        .arg(&folder)
        .status();
    match status {
        Ok(status) if status.success() => {}
        Ok(status) => return Err(format!("pneuflex export ended with {status}")),
        Err(error) => return Err(format!("{} cannot be started: {error}", program.display())),
    }
    let corners = |name: &str| -> Result<String, String> {
        let path = folder.join(format!("{name}.stl"));
        let bytes = fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let triangles = bytes.get(STL_HEAD..).unwrap_or_default().chunks_exact(STL_TRIANGLE);
        Ok(STANDARD.encode(triangles.flat_map(|triangle| &triangle[STL_CORNERS]).copied().collect::<Vec<u8>>()))
    };
    let three = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/report/assets/vendor/three.module.min.js");
    let three = fs::read(&three).map_err(|e| format!("{}: {e}", three.display()))?;
    let page = include_str!("mould.html")
        .replace("base64,THREE", &format!("base64,{}", STANDARD.encode(three)))
        .replace("\"LEFT\"", &format!("{:?}", corners("half-left")?))
        .replace("\"RIGHT\"", &format!("{:?}", corners("half-right")?))
        .replace("\"CORE\"", &format!("{:?}", corners("core")?));
    let file = target.join("mould.html");
    fs::write(&file, page).map_err(|e| format!("{}: {e}", file.display()))?;
    browser.call("Page.navigate", &json!({"url": format!("file://{}", file.display())}))?;
    browser.wait_for("window.size")?;
    let [width, height] = browser.numbers("size")?[..] else { return Err("the mould has no size".into()) };
    browser.picture([width, height])
}
