//! The output folder: who owns it, and files that are never half written.

use std::fmt::Display;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use crate::disk::Disk;
use crate::error::ResultsError;
use crate::files::{INCLUDED, INPUT};
use crate::input_error::{InputError, InputErrorKind};
use crate::recorder::FIELDS;

/// Name of the report in a result folder.
pub const REPORT: &str = "report.html";

/// First words of a resolved case file, by which an output folder is recognised.
pub const CASE_MARK: &str = "# pneuflex";

/// The files of a run besides its fields, but `case.toml`, which stays until it is replaced: by it the folder is known as ours, even after
/// a kill in between.
const RESULTS: [&str; 12] = [
    "summary.json",
    "history.jsonl",
    "checkpoint.bin",
    GRADIENTS,
    SHAPE_GRADIENTS,
    COMPARISON,
    COMPARISON_PICTURE,
    ROUNDS,
    IDENTIFIED,
    DESIGNED,
    PICTURE,
    REPORT,
];

/// File of the designs that a search has solved.
pub const ROUNDS: &str = "history.json";

/// File of what a design was found to be.
pub const DESIGNED: &str = "designed.json";

/// File of what was identified from measurements.
pub const IDENTIFIED: &str = "identified.json";

/// File of the derivatives of results.
pub const GRADIENTS: &str = "gradients.json";

/// File of the derivatives of results by the positions of nodes.
pub const SHAPE_GRADIENTS: &str = "shape_gradients.vtu";

/// File of differences from measurements, and its picture.
pub const COMPARISON: &str = "comparison.json";
/// See [`COMPARISON`].
pub const COMPARISON_PICTURE: &str = "comparison.svg";

/// File of a picture of a state, unless another one is named.
pub const PICTURE: &str = "picture.png";

/// File by which it is found out whether a folder can be written to.
const TRIAL: &str = ".pneuflex-trial";

/// File that is there while the results of an earlier run give way to those of a new one: what the folder holds then is neither's.
const BEGINNING: &str = ".pneuflex-beginning";

/// File by which runs keep out of each other's way where a folder cannot be locked. The system forgets the lock when its owner
/// ends, however it ends.
const LOCK: &str = ".pneuflex.lock";

/// What the names of files end in that are being written.
const PART: &str = ".part";

/// A folder that is ready to be written to, and by nobody else until the last copy of this value is dropped.
#[derive(Clone, Debug)]
pub struct OutputFolder {
    path: PathBuf,
    disk: Disk,
    identity: Option<[u64; 2]>,
    _lock: Arc<File>,
}

impl OutputFolder {
    /// Makes sure that the folder exists, can be written to and holds nothing but results of this program; those of an earlier
    /// run stay until [`Self::begin`].
    ///
    /// # Errors
    /// A path that is no folder, cannot be created or written to, or holds something else.
    pub fn prepare(path: &Path) -> Result<Self, InputError> {
        Self::prepare_on(path, Disk::default())
    }

    pub(crate) fn prepare_on(path: &Path, disk: Disk) -> Result<Self, InputError> {
        let problem = |what: &str, error: io::Error| refused(path, format!("{what}: {error}"));
        if path.is_dir() {
            let mut entries = fs::read_dir(path).map_err(|e| problem("cannot be read", e))?.flatten();
            if entries.any(|entry| !is_leftover(&entry.file_name().to_string_lossy())) && !is_ours(path) {
                return Err(InputError::about_file(path, "the folder holds files that are no results of pneuflex")
                    .of_kind(InputErrorKind::ForeignFolder)
                    .with_help(Some("choose another folder; nothing was touched".into())));
            }
        }
        Self::open(path, disk)
    }

    /// Makes sure that the folder exists and can be written to; nothing in it is removed.
    ///
    /// # Errors
    /// A path that is no folder, cannot be created or written to, or is being written to by another run.
    pub fn to_add_to(path: &Path) -> Result<Self, InputError> {
        Self::open(path, Disk::default())
    }

    fn open(path: &Path, disk: Disk) -> Result<Self, InputError> {
        let problem = |what: &str, error: io::Error| refused(path, format!("{what}: {error}"));
        if path.exists() && !path.is_dir() {
            return Err(refused(path, "the output folder's name is taken by a file"));
        }
        disk.create_folders(path).map_err(|e| problem("the output folder cannot be created", e))?;
        let trial = path.join(TRIAL);
        let not_writable = |e| problem("the output folder is not writable", e);
        disk.create(&trial).map_err(not_writable)?;
        disk.remove(&trial).map_err(not_writable)?;
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
        Ok(Self { path: path.to_owned(), disk, identity: identity(path), _lock: Arc::new(lock) })
    }

    /// Removes the results of an earlier run, and marks the folder as one whose run is only beginning until [`Self::has_begun`] is called:
    /// a run that dies in between has left nothing to go on with, and nothing to keep.
    ///
    /// # Errors
    /// A file that cannot be written or removed.
    pub fn begin(&self) -> Result<(), InputError> {
        self.remove_results()
            .map_err(|e| refused(&self.path, format!("results of an earlier run cannot be removed: {e}")))
    }

    /// Everything is there that a run begins with.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn has_begun(&self) -> Result<(), ResultsError> {
        self.disk.remove(&self.path.join(BEGINNING)).map_err(|e| self.cannot_write(BEGINNING, e))
    }

    /// Whether a run has died while it was beginning.
    pub fn is_beginning(&self) -> bool {
        self.path.join(BEGINNING).exists()
    }

    fn remove_results(&self) -> io::Result<()> {
        self.disk.create(&self.path.join(BEGINNING))?;
        self.remove_parts()?;
        for file in RESULTS {
            self.disk.remove(&self.path.join(file))?;
        }
        for name in self.names_in("fields") {
            let is_field = FIELDS.into_iter().chain(["mode"]).any(|field| name.starts_with(&format!("{field}_")));
            if (is_field && name.ends_with(".vtu")) || name == "series.pvd" {
                self.disk.remove(&self.path.join("fields").join(name))?;
            }
        }
        let input = self.path.join(INPUT);
        // The list by which they are known goes last.
        if input.join(INCLUDED).is_file() {
            let files = self.names_in(INPUT).into_iter().filter(|name| name != INCLUDED && input.join(name).is_file());
            for name in files.chain([INCLUDED.to_owned()]) {
                self.disk.remove(&input.join(name))?;
            }
        }
        self.disk.remove_empty_folder(&input)
    }

    /// Removes files that a run was writing when it died.
    ///
    /// # Errors
    /// One that cannot be removed.
    pub fn remove_partial_files(&self) -> Result<(), ResultsError> {
        self.remove_parts().map_err(|e| self.cannot_write("", e))
    }

    fn remove_parts(&self) -> io::Result<()> {
        for folder in ["", "fields", INPUT] {
            for name in self.names_in(folder).into_iter().filter(|name| name.ends_with(PART)) {
                self.disk.remove(&self.path.join(folder).join(name))?;
            }
        }
        Ok(())
    }

    /// Names of what is in a folder of this one, in the order of the alphabet; none if it is not there.
    fn names_in(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path.join(folder)).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
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
        self.check_identity()?;
        let target = self.path.join(name);
        let temporary = self.path.join(format!("{name}{PART}"));
        let write = || -> io::Result<()> {
            if let Some(parent) = target.parent().filter(|parent| *parent != self.path && !parent.is_dir()) {
                // Not the folder itself: if that has gone away, somebody has moved it.
                self.disk.create_folder(parent)?;
            }
            let mut file = self.disk.create(&temporary)?;
            self.disk.write(&mut file, contents.as_ref())?;
            file.sync_data()?;
            self.disk.rename(&temporary, &target)
        };
        write().map_err(|error| {
            let _ = self.disk.remove(&temporary);
            self.cannot_write(name, error)
        })
    }

    /// The contents of a file of the folder, if it can be read.
    pub fn read(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.path.join(name)).ok()
    }

    /// Removes a file of the folder if it is there.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove(&self, name: &str) -> Result<(), ResultsError> {
        self.check_identity()?;
        self.disk.remove(&self.path.join(name)).map_err(|e| self.cannot_write(name, e))
    }

    /// Opens a file of the folder for [`Self::add`] after its first `keep` bytes.
    ///
    /// # Errors
    /// Whatever the file system says, with the file's name.
    pub fn append(&self, name: &str, keep: u64) -> Result<File, ResultsError> {
        self.check_identity()?;
        self.disk.append(&self.path.join(name), keep).map_err(|e| self.cannot_write(name, e))
    }

    /// Adds a line to a file that was opened by [`Self::append`] under this name.
    ///
    /// # Errors
    /// Whatever the file system says, with the file's name.
    pub fn add(&self, name: &str, file: &mut File, line: &str) -> Result<(), ResultsError> {
        self.check_identity()?;
        self.disk.write(file, line.as_bytes()).map_err(|e| self.cannot_write(name, e))
    }

    /// Somebody may move the folder away during a run and put another in its place, which is none of ours.
    fn check_identity(&self) -> Result<(), ResultsError> {
        match identity(&self.path) {
            Some(now) if self.identity.is_some_and(|then| then != now) => {
                Err(ResultsError::FolderReplaced { folder: self.path.clone() })
            }
            _ => Ok(()),
        }
    }

    /// The error of a file that cannot be written.
    pub fn cannot_write(&self, name: &str, error: io::Error) -> ResultsError {
        // Another folder may have come while the file was written.
        if let Err(replaced) = self.check_identity() {
            return replaced;
        }
        let file = self.path.join(name);
        match error.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => ResultsError::DiskFull { file },
            io::ErrorKind::NotFound if !self.path.is_dir() => ResultsError::FolderGone { folder: self.path.clone() },
            _ => ResultsError::NotWritable { file, source: error },
        }
    }
}

/// What tells a folder from another one of the same name; `None` where the system does not say. The folder's lock keeps it from being given
/// to another one after it is deleted.
#[cfg(unix)]
fn identity(path: &Path) -> Option<[u64; 2]> {
    use std::os::unix::fs::MetadataExt;
    fs::metadata(path).ok().map(|found| [found.dev(), found.ino()])
}

#[cfg(not(unix))]
fn identity(_: &Path) -> Option<[u64; 2]> {
    None
}

fn refused(path: &Path, why: impl Display) -> InputError {
    InputError::about_file(path, why)
        .of_kind(InputErrorKind::UnusableFolder)
        .with_help(Some("choose another folder".into()))
}

/// Whether a file may be left of a run that was killed before it had written anything.
fn is_leftover(name: &str) -> bool {
    [LOCK, TRIAL, BEGINNING].contains(&name) || name.ends_with(PART)
}

/// Whether a folder holds results of this program.
fn is_ours(path: &Path) -> bool {
    let summary = fs::read_to_string(path.join("summary.json")).unwrap_or_default();
    let case = fs::read_to_string(path.join("case.toml")).unwrap_or_default();
    let written_by_us = serde_json::from_str::<Value>(&summary).is_ok_and(|s| s["program"] == "pneuflex");
    written_by_us || case.starts_with(CASE_MARK) || path.join(BEGINNING).exists()
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
        fs::write(path.join("fields/step_02.vtu.part"), "half").unwrap();
        folder.begin().unwrap();
        assert!(folder.is_beginning() && !path.join("fields/step_02.vtu.part").exists());
        folder.has_begun().unwrap();
        assert!(!folder.is_beginning());
        assert!(!path.join("summary.json").exists() && !path.join("fields/step_01.vtu").exists());
        assert!(path.join("fields/notes.txt").exists());

        folder.write("fields/step_01.vtu", "new").unwrap();
        assert_eq!(fs::read_to_string(path.join("fields/step_01.vtu")).unwrap(), "new");
        assert_eq!(fs::read_dir(path.join("fields")).unwrap().count(), 2);

        fs::write(path.join("lines"), "one\ntwo\n").unwrap();
        let mut lines = folder.append("lines", 4).unwrap();
        folder.add("lines", &mut lines, "three\n").unwrap();
        assert_eq!(fs::read_to_string(path.join("lines")).unwrap(), "one\nthree\n");

        let elsewhere = scratch("elsewhere");
        fs::rename(&path, &elsewhere).unwrap();
        if cfg!(unix) {
            fs::create_dir(&path).unwrap();
            for replaced in [
                folder.write("summary.json", "new"),
                folder.remove("case.toml"),
                folder.add("lines", &mut lines, "four\n"),
                folder.append("lines", 0).map(drop),
            ] {
                let replaced = replaced.unwrap_err().to_string();
                assert!(replaced.contains("another folder has taken the place"), "{replaced}");
            }
            assert_eq!(fs::read_dir(&path).unwrap().count(), 0);
            assert_eq!(fs::read_to_string(elsewhere.join("lines")).unwrap(), "one\nthree\n");
            fs::remove_dir(&path).unwrap();
        }
        fs::remove_dir_all(&elsewhere).unwrap();
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
