//! What became of a design: a file for each that is finished.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use pneuflex::Pairs;
use serde::{Deserialize, Serialize};

/// What became of a design.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The design's name.
    pub identity: String,
    /// `converged`, `past-limit`, `not-converged`, `setup`, `bad-input`; `worker-died` or `error` for what is not the design's fault; `open`
    /// for one that is not finished.
    pub status: String,
    /// Kind of reason of a design that did not come to its end.
    #[serde(default)]
    pub reason: Option<String>,
    /// The same in words.
    #[serde(default)]
    pub message: String,
    /// What to try.
    #[serde(default)]
    pub advice: String,
    /// The numbers of every state that was reached.
    #[serde(default)]
    pub states: Vec<Pairs>,
    /// Kinds of warnings.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Seconds that it took.
    #[serde(default)]
    pub seconds: Option<f64>,
    /// Seconds of all cores.
    #[serde(default)]
    pub cpu_seconds: Option<f64>,
    /// Threads of the solver.
    #[serde(default)]
    pub threads: Option<usize>,
    /// Name of the design that it took its guesses from, if it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started_from: Option<String>,
}

impl Row {
    /// A row of that status without anything else.
    pub fn new(identity: &str, status: &str) -> Self {
        Self { identity: identity.to_owned(), status: status.to_owned(), ..Self::default() }
    }

    /// The row of a design in a sweep's folder; `open` if there is none, or a damaged one.
    pub fn read(folder: &Path, identity: &str) -> Self {
        let text = fs::read_to_string(row_file(folder, identity)).ok();
        let row = text.and_then(|text| serde_json::from_str(&text).ok());
        row.unwrap_or_else(|| Self::new(identity, "open"))
    }

    /// Writes the row into a sweep's folder, as a whole or not at all.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn keep(&self, folder: &Path) -> io::Result<()> {
        replace(&row_file(folder, &self.identity), serde_json::to_string(self)?.as_bytes())
    }

    /// Whether the design has ended by itself: the next call does not try it again.
    pub fn is_finished(&self) -> bool {
        !matches!(self.status.as_str(), "open" | "worker-died" | "error")
    }

    /// Whether it did not reach all that was asked for.
    pub fn has_failed(&self) -> bool {
        !matches!(self.status.as_str(), "converged" | "past-limit" | "open")
    }
}

/// The file of a design's row.
pub fn row_file(folder: &Path, identity: &str) -> PathBuf {
    folder.join("rows").join(format!("{identity}.json"))
}

/// Writes a file so that there is the old one or the new one, whenever this process or the machine dies.
///
/// # Errors
/// Whatever the file system says.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    // Jobs on other machines may write the same file.
    let part = path.with_file_name(format!(".{name}.{}-{:016x}.part", std::process::id(), rand::random::<u64>()));
    let write = || {
        let mut file = File::create(&part)?;
        file.write_all(bytes)?;
        file.sync_data()?;
        fs::rename(&part, path)
    };
    write().inspect_err(|_| {
        let _ = fs::remove_file(&part);
    })
}
