//! The output folder: who owns it, and files that are never half written.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::InputError;

/// First words of a resolved case file, by which an output folder is recognised.
pub const CASE_MARK: &str = "# pneuflex";

/// A folder that is ready to be written to.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Makes sure that the folder exists, can be written to and holds nothing but results of this program, and removes
    /// those of an earlier run.
    ///
    /// # Errors
    /// A path that is no folder, cannot be created or written to, or holds something else.
    pub fn prepare(path: &Path) -> Result<Self, InputError> {
        let problem = |what: &str, error: io::Error| refused(path, format!("{what}: {error}"));
        if path.is_dir() {
            let is_empty = fs::read_dir(path).map_err(|e| problem("cannot be read", e))?.next().is_none();
            if !is_empty && !is_ours(path) {
                return Err(InputError::file(path, "the folder holds files that are no results of pneuflex")
                    .help(Some("choose another folder with --out; nothing was touched".into())));
            }
        }
        let folder = Self::to_add_to(path)?;
        folder.clear().map_err(|e| problem("results of an earlier run cannot be removed", e))?;
        Ok(folder)
    }

    /// Makes sure that the folder exists and can be written to; nothing in it is removed.
    ///
    /// # Errors
    /// A path that is no folder, cannot be created or written to.
    pub fn to_add_to(path: &Path) -> Result<Self, InputError> {
        let problem = |what: &str, error: io::Error| refused(path, format!("{what}: {error}"));
        if path.exists() && !path.is_dir() {
            return Err(refused(path, "the output folder's name is taken by a file"));
        }
        fs::create_dir_all(path).map_err(|e| problem("the output folder cannot be created", e))?;
        let trial = path.join(".pneuflex-trial");
        let not_writable = |e| problem("the output folder is not writable", e);
        fs::write(&trial, "trial").map_err(not_writable)?;
        fs::remove_file(&trial).map_err(not_writable)?;
        Ok(Self { path: path.to_owned() })
    }

    fn clear(&self) -> io::Result<()> {
        let fields = self.path.join("fields");
        let mut old: Vec<PathBuf> = ["summary.json", "history.jsonl", "case.toml"].map(|f| self.path.join(f)).into();
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

    /// Writes a file of the folder; a reader sees the old text or the new one, never a part.
    ///
    /// # Errors
    /// Whatever the file system says, with the file's name.
    pub fn write(&self, name: &str, text: &str) -> Result<(), String> {
        let target = self.path.join(name);
        let write = || -> io::Result<()> {
            if let Some(parent) = target.parent() {
                fs::create_dir_all(parent)?;
            }
            let temporary = target.with_extension("part");
            let mut file = File::create(&temporary)?;
            file.write_all(text.as_bytes())?;
            file.sync_data()?;
            fs::rename(&temporary, &target)
        };
        write().map_err(|e| format!("{}: cannot be written: {e}", target.display()))
    }

    /// Opens a file of the folder for writing line by line.
    ///
    /// # Errors
    /// Whatever the file system says, with the file's name.
    pub fn create(&self, name: &str) -> Result<File, String> {
        let target = self.path.join(name);
        File::create(&target).map_err(|e| format!("{}: cannot be written: {e}", target.display()))
    }
}

fn refused(path: &Path, why: impl Display) -> InputError {
    InputError::file(path, why).help(Some("choose another folder with --out".into()))
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
        assert!(!path.join("summary.json").exists() && !path.join("fields/step_01.vtu").exists());
        assert!(path.join("fields/notes.txt").exists());

        folder.write("fields/step_01.vtu", "new").unwrap();
        assert_eq!(fs::read_to_string(path.join("fields/step_01.vtu")).unwrap(), "new");
        assert_eq!(fs::read_dir(path.join("fields")).unwrap().count(), 2);
        fs::remove_dir_all(&path).unwrap();
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
