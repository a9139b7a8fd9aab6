//! Rules of this repository that a compiler does not check.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Which workspace crates a crate may use (ARCHITECTURE.md, "Arrows"). Test-only arrows are free.
const ARROWS: [(&str, &[&str]); 24] = [
    ("mesh", &[]),
    ("model", &["mesh"]),
    ("material", &["mesh", "model"]),
    ("laws", &["material", "model"]),
    ("contact", &["mesh", "model"]),
    ("factor", &[]),
    ("assembly", &["mesh", "model", "material", "laws", "contact", "factor"]),
    ("newton", &["mesh", "model", "contact", "assembly", "factor"]),
    ("post", &["mesh", "model", "material", "laws", "contact", "assembly"]),
    ("plot", &["mesh", "model", "post"]),
    ("reference", &["mesh", "model"]),
    ("rod", &["mesh", "model", "newton", "post"]),
    ("report", &["mesh", "model", "post"]),
    ("export", &["mesh", "model", "plot", "report"]),
    ("calibration", &["model", "laws"]),
    ("deck", &["mesh", "model"]),
    ("pneuflex", &["calibration", "deck", "export", "mesh", "model", "newton", "plot", "post", "report", "rod"]),
    ("sweep", &["pneuflex"]),
    ("inverse", &["pneuflex", "sweep"]),
    ("cli", &["pneuflex", "sweep", "inverse"]),
    ("python", &["pneuflex", "sweep"]),
    ("benches", &["pneuflex"]),
    ("verification", &["mesh", "model", "laws", "contact", "assembly", "factor", "newton", "post", "pneuflex"]),
    ("xtask", &["pneuflex", "inverse", "verification"]),
];

/// What the crates of single laws may use. Only `laws` may use them.
const LAW_ARROWS: &[&str] = &["material", "model"];
const LAW_PREFIX: &str = "material-";

/// Libraries that a crate must not use, because of what it is for.
const ABSENCES: [(&str, &[&str]); 2] =
    [("reference", &["faer", "rayon"]), ("model", &["nalgebra", "faer", "rayon", "serde_json"])];

pub fn run() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut complaints = Vec::new();
    for (name, allowed) in ARROWS {
        let folder = if matches!(name, "benches" | "xtask") { root.join(name) } else { root.join("crates").join(name) };
        if folder.exists() {
            check_arrows(name, &folder, allowed, &mut complaints);
            check_docs(&folder, &mut complaints);
        }
    }
    check_other_crates(&root, &mut complaints);
    if complaints.is_empty() {
        println!("tidy: nothing to complain about");
        return ExitCode::SUCCESS;
    }
    for complaint in &complaints {
        eprintln!("tidy: {complaint}");
    }
    ExitCode::FAILURE
}

fn check_arrows(name: &str, folder: &Path, allowed: &[&str], complaints: &mut Vec<String>) {
    let manifest = folder.join("Cargo.toml");
    let Some(table) = fs::read_to_string(&manifest).ok().and_then(|text| text.parse::<toml::Table>().ok()) else {
        complaints.push(format!("{} cannot be read", manifest.display()));
        return;
    };
    let Some(dependencies) = table.get("dependencies").and_then(toml::Value::as_table) else { return };
    for dependency in dependencies.keys() {
        let face = Some("pneuflex").filter(|name| dependency == name);
        if let Some(crate_name) = dependency.strip_prefix("pneuflex-").or(face)
            && !allowed.contains(&crate_name)
            && !(name == "laws" && crate_name.starts_with(LAW_PREFIX))
        {
            complaints.push(format!("{name} must not depend on {crate_name} (see ARCHITECTURE.md)"));
        }
        if ABSENCES.iter().any(|(who, what)| *who == name && what.contains(&dependency.as_str())) {
            complaints.push(format!("{name} must not use {dependency}"));
        }
    }
}

/// Every source file begins by saying what it is.
fn check_docs(folder: &Path, complaints: &mut Vec<String>) {
    for file in rust_files(&folder.join("src")) {
        let text = fs::read_to_string(&file).unwrap_or_default();
        if !text.starts_with("//!") {
            complaints.push(format!("{} does not begin with a doc comment", file.display()));
        }
    }
}

/// Crates that are not in the list of arrows: laws, and what was forgotten.
fn check_other_crates(root: &Path, complaints: &mut Vec<String>) {
    let listed: BTreeSet<&str> = ARROWS.iter().map(|(name, _)| *name).collect();
    let Ok(entries) = fs::read_dir(root.join("crates")) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !entry.path().join("Cargo.toml").exists() || listed.contains(name.as_str()) {
            continue;
        }
        if name.starts_with(LAW_PREFIX) {
            check_arrows(&name, &entry.path(), LAW_ARROWS, complaints);
            check_docs(&entry.path(), complaints);
        } else {
            complaints.push(format!("crate {name} is not in the list of arrows (xtask/src/tidy.rs)"));
        }
    }
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let Ok(entries) = fs::read_dir(folder) else { return files };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}
