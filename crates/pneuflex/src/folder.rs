//! The output folder: who owns it, and files that are never half written.

use std::fmt::Display;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use crate::error::ResultsError;
use crate::files::{INCLUDED, INPUT};
use crate::input_error::{InputError, InputErrorKind};

/// Name of the report in a result folder.
pub const REPORT: &str = "report.html";

/// First words of a resolved case file, by which an output folder is recognised.
pub const CASE_MARK: &str = "# pneuflex";

/// The files of a run besides its fields, but `case.toml`, which stays until it is replaced: by it the folder is known as ours, even after
/// a kill in between.
const RESULTS: [&str; 4] = ["summary.json", "history.jsonl", "checkpoint.bin", REPORT];

/// File by which it is found out whether a folder can be written to.
const TRIAL: &str = ".pneuflex-trial";

/// File by which runs keep out of each other's way where a folder cannot be locked. The system forgets the lock when its owner
/// ends, however it ends.
const LOCK: &str = ".pneuflex.lock";

/// A folder that is ready to be written to, and by nobody else until the last copy of this value is dropped.
#[derive(Clone, Debug)]
pub struct OutputFolder {
    path: PathBuf,
    _lock: Arc<File>,
}

impl OutputFolder {
    /// Makes sure that the folder exists, can be written to and holds nothing but results of this program; those of an earlier
    /// run stay until [`Self::clear`].
    ///
    /// # Errors
    /// A path that is no folder, cannot be created or written to, or holds something else.
    pub fn prepare(path: &Path) -> Result<Self, InputError> {
        let problem = |what: &str, error: io::Error| refused(path, format!("{what}: {error}"));
        if path.is_dir() {
            let mut entries = fs::read_dir(path).map_err(|e| problem("cannot be read", e))?.flatten();
            if entries.any(|entry| !is_leftover(&entry.file_name().to_string_lossy())) && !is_ours(path) {
                return Err(InputError::about_file(path, "the folder holds files that are no results of pneuflex")
                    .of_kind(InputErrorKind::ForeignFolder)
                    .with_help(Some("choose another folder; nothing was touched".into())));
            }
        }
        Self::to_add_to(path)
    }

    /// Makes sure that the folder exists and can be written to; nothing in it is removed.
    ///
    /// # Errors
    /// A path that is no folder, cannot be created or written to, or is being written to by another run.
    pub fn to_add_to(path: &Path) -> Result<Self, InputError> {
        let problem = |what: &str, error: io::Error| refused(path, format!("{what}: {error}"));
        if path.exists() && !path.is_dir() {
            return Err(refused(path, "the output folder's name is taken by a file"));
        }
        fs::create_dir_all(path).map_err(|e| problem("the output folder cannot be created", e))?;
        let trial = path.join(TRIAL);
        let not_writable = |e| problem("the output folder is not writable", e);
        fs::write(&trial, "trial").map_err(not_writable)?;
        fs::remove_file(&trial).map_err(not_writable)?;
        // The folder itself is locked where it can be opened like a file (not on Windows).
        let lock = File::open(path).or_else(|_| File::create(path.join(LOCK))).map_err(not_writable)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(InputError::about_file(path, "another run is writing to this folder")
                    .of_kind(InputErrorKind::BusyFolder)
                    .with_help(Some("wait until it has ended, or choose another folder".into())));
            }
            // A file system without locks: nothing can be promised, but nothing is wrong either.
            Err(TryLockError::Error(_)) => {}
        }
        Ok(Self { path: path.to_owned(), _lock: Arc::new(lock) })
    }

    /// Removes the results of an earlier run.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn clear(&self) -> Result<(), InputError> {
        self.remove_results()
            .map_err(|e| refused(&self.path, format!("results of an earlier run cannot be removed: {e}")))
    }

    fn remove_results(&self) -> io::Result<()> {
        let [fields, input] = ["fields", INPUT].map(|folder| self.path.join(folder));
        if input.join(INCLUDED).is_file() {
            fs::remove_dir_all(&input)?;
        }
        let mut old: Vec<PathBuf> = RESULTS.map(|f| self.path.join(f)).into();
        old.push(fields.join("series.pvd"));
        if fields.is_dir() {
            for entry in fs::read_dir(&fields)? {
                let entry = entry?;
                let name = entry.file_name().to_string_lossy().into_owned();
                if (name.starts_with("step_") || name.starts_with("contact_")) && name.ends_with(".vtu") {
                    old.push(entry.path());
                }
            }
        }
        for file in old {
            match fs::remove_file(&file) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file of the folder; a reader sees the old contents or the new ones, never a part.
    ///
    /// # Errors
    /// Whatever the file system says, with the file's name.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), ResultsError> {
        let target = self.path.join(name);
        let temporary = target.with_extension("part");
        let write = || -> io::Result<()> {
            if let Some(parent) = target.parent().filter(|parent| *parent != self.path && !parent.is_dir()) {
                // Not the folder itself: if that has gone away, somebody has moved it.
                fs::create_dir(parent)?;
            }
            let mut file = File::create(&temporary)?;
            file.write_all(contents.as_ref())?;
            file.sync_data()?;
            fs::rename(&temporary, &target)
        };
        write().map_err(|error| {
            let _ = fs::remove_file(&temporary);
            self.cannot_write(name, error)
        })
    }

    /// The contents of a file of the folder, if it can be read.
    pub fn read(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.path.join(name)).ok()
    }

    /// Removes a file of the folder if it is there.
    pub fn remove(&self, name: &str) {
        let _ = fs::remove_file(self.path.join(name));
    }

    /// Opens a file of the folder for writing line by line after its first `keep` bytes.
    ///
    /// # Errors
    /// Whatever the file system says, with the file's name.
    pub fn append(&self, name: &str, keep: u64) -> Result<File, ResultsError> {
        let open = || -> io::Result<File> {
            let file = OpenOptions::new().create(true).truncate(false).write(true).open(self.path.join(name))?;
            let kept = file.metadata()?.len().min(keep);
            file.set_len(kept)?;
            drop(file);
            OpenOptions::new().append(true).open(self.path.join(name))
        };
        open().map_err(|e| self.cannot_write(name, e))
    }

    /// The error of a file that cannot be written.
    pub fn cannot_write(&self, name: &str, error: io::Error) -> ResultsError {
        let file = self.path.join(name);
        match error.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => ResultsError::DiskFull { file },
            io::ErrorKind::NotFound if !self.path.is_dir() => ResultsError::FolderGone { folder: self.path.clone() },
            _ => ResultsError::NotWritable { file, source: error },
        }
    }
}

fn refused(path: &Path, why: impl Display) -> InputError {
    InputError::about_file(path, why)
        .of_kind(InputErrorKind::UnusableFolder)
        .with_help(Some("choose another folder".into()))
}

/// Whether a file may be left of a run that was killed before it had written anything.
fn is_leftover(name: &str) -> bool {
    name == LOCK || name == TRIAL || name.ends_with(".part")
}

/// Whether a folder holds results of this program.
fn is_ours(path: &Path) -> bool {
    let summary = fs::read_to_string(path.join("summary.json")).unwrap_or_default();
    let case = fs::read_to_string(path.join("case.toml")).unwrap_or_default();
    let written_by_us = serde_json::from_str::<Value>(&summary).is_ok_and(|s| s["program"] == "pneuflex");
    written_by_us || case.starts_with(CASE_MARK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scratch(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("pneuflex-folder-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        path
    }

    #[test]
    fn foreign_folders_are_left_alone_and_own_ones_are_replaced() {
        let path = scratch("own");
        fs::create_dir_all(path.join("fields")).unwrap();
        fs::write(path.join("case.toml"), "title = \"mine\"").unwrap();
        assert!(OutputFolder::prepare(&path).unwrap_err().to_string().contains("no results of pneuflex"));
        assert!(path.join("case.toml").exists());

        fs::write(path.join("summary.json"), "{\"program\": \"pneuflex\"}").unwrap();
        fs::write(path.join("fields/step_01.vtu"), "old").unwrap();
        fs::write(path.join("fields/notes.txt"), "kept").unwrap();
        let folder = OutputFolder::prepare(&path).unwrap();
        assert!(path.join("summary.json").exists());
        let second = OutputFolder::prepare(&path).unwrap_err().to_string();
        assert!(second.contains("another run is writing"), "{second}");
        folder.clear().unwrap();
        assert!(!path.join("summary.json").exists() && !path.join("fields/step_01.vtu").exists());
        assert!(path.join("fields/notes.txt").exists());

        folder.write("fields/step_01.vtu", "new").unwrap();
        assert_eq!(fs::read_to_string(path.join("fields/step_01.vtu")).unwrap(), "new");
        assert_eq!(fs::read_dir(path.join("fields")).unwrap().count(), 2);

        fs::write(path.join("lines"), "one\ntwo\n").unwrap();
        folder.append("lines", 4).unwrap().write_all(b"three\n").unwrap();
        assert_eq!(fs::read_to_string(path.join("lines")).unwrap(), "one\nthree\n");

        fs::remove_dir_all(&path).unwrap();
        let gone = folder.write("summary.json", "new").unwrap_err().to_string();
        assert!(gone.contains("has gone away") && !path.exists(), "{gone}");
        assert!(folder.write("fields/step_01.vtu", "new").unwrap_err().to_string().contains("has gone away"));
    }

    #[test]
    fn a_file_in_the_way_is_an_error() {
        let path = scratch("file");
        fs::write(&path, "x").unwrap();
        assert!(OutputFolder::prepare(&path).unwrap_err().to_string().contains("taken by a file"));
        assert!(OutputFolder::prepare(&path.join("below")).unwrap_err().to_string().contains("cannot be created"));
        fs::remove_file(&path).unwrap();
    }
}
