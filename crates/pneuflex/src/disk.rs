//! What a run does to a disk, operation by operation: every change that it makes to a folder is one of these.
//!
//! They are gathered here so that tests can let a run die before any of them, see `deaths.rs`.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

/// A disk.
#[derive(Clone, Debug, Default)]
pub struct Disk {
    #[cfg(test)]
    pub(crate) life: Option<std::sync::Arc<Life>>,
}

impl Disk {
    /// Makes a folder, with those that it lies in.
    pub fn create_folders(&self, path: &Path) -> io::Result<()> {
        if path.is_dir() { Ok(()) } else { self.survive().and_then(|()| fs::create_dir_all(path)) }
    }

    /// Makes a folder in one that is there.
    pub fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.survive()?;
        fs::create_dir(path)
    }

    /// Makes an empty file, in the place of what is there.
    pub fn create(&self, path: &Path) -> io::Result<File> {
        self.survive()?;
        File::create(path)
    }

    /// Writes to a file.
    pub fn write(&self, file: &mut File, bytes: &[u8]) -> io::Result<()> {
        let life = self.survive();
        // Death does not wait for the end of a write.
        #[cfg(test)]
        if life.is_err() && self.life.as_ref().is_some_and(|life| life.ends_now()) {
            file.write_all(&bytes[..bytes.len() / 2])?;
        }
        life?;
        file.write_all(bytes)
    }

    /// Gives a file another name, in the place of what has that name.
    pub fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.survive()?;
        fs::rename(from, to)
    }

    /// Removes a file; one that is not there is no error.
    pub fn remove(&self, path: &Path) -> io::Result<()> {
        // What is not there needs no operation.
        if fs::symlink_metadata(path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound) {
            return Ok(());
        }
        self.survive()?;
        fs::remove_file(path)
    }

    /// Removes a folder if it is empty.
    pub fn remove_empty_folder(&self, path: &Path) -> io::Result<()> {
        let is_empty = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none());
        if is_empty { self.survive().and_then(|()| fs::remove_dir(path)) } else { Ok(()) }
    }

    /// Opens a file for writing behind its first `keep` bytes; what follows them is cut off.
    pub fn append(&self, path: &Path, keep: u64) -> io::Result<File> {
        self.survive()?;
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(path)?;
        let kept = file.metadata()?.len().min(keep);
        self.survive()?;
        file.set_len(kept)?;
        drop(file);
        OpenOptions::new().append(true).open(path)
    }

    #[cfg(not(test))]
    #[allow(clippy::unused_self, clippy::unnecessary_wraps)]
    fn survive(&self) -> io::Result<()> {
        Ok(())
    }

    #[cfg(test)]
    fn survive(&self) -> io::Result<()> {
        self.life.as_ref().map_or(Ok(()), |life| life.survive())
    }
}

/// How many operations are left before everything fails, and how many were done.
#[cfg(test)]
#[derive(Debug)]
pub(crate) struct Life {
    length: usize,
    done: std::sync::atomic::AtomicUsize,
}

#[cfg(test)]
impl Life {
    pub(crate) fn of_length(length: usize) -> std::sync::Arc<Self> {
        std::sync::Arc::new(Self { length, done: Default::default() })
    }

    /// Operations attempted so far.
    pub(crate) fn attempted(&self) -> usize {
        self.done.load(std::sync::atomic::Ordering::Relaxed)
    }

    pub(crate) fn is_over(&self) -> bool {
        self.attempted() > self.length
    }

    fn ends_now(&self) -> bool {
        self.attempted() == self.length + 1
    }

    fn survive(&self) -> io::Result<()> {
        let before = self.done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if before < self.length { Ok(()) } else { Err(io::Error::other("killed")) }
    }
}
