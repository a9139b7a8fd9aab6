//! Building the program that the tasks start.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Names a program that is built already.
const READY: &str = "PNEUFLEX_PROGRAM";

/// Builds `pneuflex` in release mode and returns the path of the program; cargo's messages go to stderr. Where the environment has
/// `PNEUFLEX_PROGRAM`, it is that program.
///
/// # Errors
/// What went wrong, in words: cargo cannot be started, the build fails, or cargo does not say where the program is.
pub fn build(root: &Path) -> Result<PathBuf, String> {
    if let Some(program) = std::env::var_os(READY).map(PathBuf::from) {
        return program.canonicalize().map_err(|e| format!("{READY}: {}: {e}", program.display()));
    }
    eprintln!("building pneuflex");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["build", "--release", "--locked", "--package", "pneuflex-cli", "--message-format=json"])
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo cannot be started: {e}"))?;
    if !output.status.success() {
        return Err("the program cannot be built".to_owned());
    }
    String::from_utf8_lossy(&output.stdout)
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter_map(|message| Some(PathBuf::from(message.get("executable")?.as_str()?)))
        .next_back()
        .ok_or_else(|| "cargo does not say where the program is".to_owned())
}

/// Cargo's target folder of the repository at `root`.
pub fn target_folder(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}
