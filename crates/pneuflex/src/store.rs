//! Where files are read from: a disk, or memory.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use crate::foreign::{not_a_case, pointer};
use crate::input_error::{InputError, Origin, Place};

/// Bytes that a case or model file may have.
const MOST_BYTES_OF_TEXT: u64 = 1_000_000;

/// Bytes that a deck or a mesh may have.
const MOST_BYTES: u64 = 2_000_000_000;

/// What is said of a larger one.
const TOO_LARGE: &str = "is larger than 2 GB";

/// A source of files.
#[derive(Clone, Debug)]
pub enum Store {
    /// The file system.
    Disk,
    /// Files in memory by their paths.
    Memory(Arc<BTreeMap<PathBuf, Vec<u8>>>),
}

impl Store {
    /// The text of a case or model file.
    ///
    /// # Errors
    /// A file that cannot be read, is another kind of file, too large or not UTF-8.
    pub fn text(&self, path: &Path) -> Result<String, InputError> {
        let cannot = |e: io::Error| InputError::about_file(path, format!("cannot be read: {e}"));
        let bytes = self.read(path, MOST_BYTES_OF_TEXT).map_err(cannot)?;
        if let Some(error) = not_a_case(path, &bytes) {
            return Err(error);
        }
        if bytes.len() as u64 > MOST_BYTES_OF_TEXT {
            let help = "a case file is a short text; is this another kind of file?".to_owned();
            let what = "is larger than 1 MB, which no case file may be";
            return Err(InputError::about_file(path, what).with_help(Some(help)));
        }
        String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            // Up to the first bad byte both texts agree.
            let place = Place::new(&path.display().to_string(), Origin::File, text.into(), valid..valid + 1);
            let what = format!("not valid UTF-8 (byte {valid} of the file); save the file as UTF-8");
            InputError::new(what).at(Some(place))
        })
    }

    /// The bytes of a deck or a mesh.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn bytes(&self, path: &Path) -> Result<Vec<u8>, String> {
        let is_large = |length: u64| length > MOST_BYTES;
        // Before anything of it is read.
        let known = if let Self::Disk = self { fs::metadata(path).ok() } else { None };
        if known.is_some_and(|found| found.is_file() && is_large(found.len())) {
            return Err(TOO_LARGE.into());
        }
        let bytes = self.read(path, MOST_BYTES).map_err(|e| format!("cannot be read: {e}"))?;
        if is_large(bytes.len() as u64) { Err(TOO_LARGE.into()) } else { Ok(bytes) }
    }

    /// Where a file is that another one names: from that one's folder, or from the present one if that one came from standard input.
    pub fn beside(&self, path: &Path, file: &str) -> PathBuf {
        if is_standard_input(path) { PathBuf::from(file) } else { path.parent().unwrap_or(Path::new("")).join(file) }
    }

    /// Whether a path leads to somewhere within a folder, by the file system if the file is there, else by the names alone.
    pub fn is_within(&self, folder: &Path, path: &Path) -> bool {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let real = |path: &Path| match self {
            Self::Disk => fs::canonicalize(path).ok(),
            Self::Memory(_) => None,
        };
        match (real(folder), real(path)) {
            (Some(folder), Some(path)) => path.starts_with(folder),
            _ => {
                let (folder, path) = (plain(folder), plain(path));
                let leaves = |path: &Path| path.is_absolute() || path.starts_with("..");
                path.starts_with(&folder) && (leaves(&folder) || !leaves(&path))
            }
        }
    }

    /// At the most one byte more than `most`.
    fn read(&self, path: &Path, most: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        match self {
            Self::Disk if is_standard_input(path) => {
                io::stdin().lock().take(most + 1).read_to_end(&mut bytes)?;
            }
            Self::Disk => {
                refuse_endless(path)?;
                File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
            }
            Self::Memory(files) => {
                let missing = || io::Error::new(io::ErrorKind::NotFound, "it is not among the given files");
                bytes.clone_from(files.get(path).ok_or_else(missing)?);
            }
        }
        Ok(bytes)
    }
}

/// The bytes of a file of input, at the most one more than `most`.
///
/// # Errors
/// A file that cannot be read, a folder, a device or a pipe, or what Git LFS leaves in the place of a file.
pub fn input_file(path: &Path, most: u64) -> Result<Vec<u8>, InputError> {
    let cannot = |e: io::Error| InputError::about_file(path, format!("cannot be read: {e}"));
    let bytes = Store::Disk.read(path, most).map_err(cannot)?;
    pointer(path, &bytes).map_or(Ok(bytes), Err)
}

/// What is read from is not a file of the disk, but what was given to the program.
fn is_standard_input(path: &Path) -> bool {
    cfg!(unix) && ["/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"].iter().any(|known| path == Path::new(known))
}

/// Refuses what may never end, or never begin: devices, and pipes that nobody may ever write to. A shell's `<(…)` is a pipe that somebody
/// writes to.
fn refuse_endless(path: &Path) -> io::Result<()> {
    let kind = fs::metadata(path)?.file_type();
    let refuse = |kind, what: &str| Err(io::Error::new(kind, what));
    if kind.is_dir() {
        return refuse(io::ErrorKind::IsADirectory, "it is a folder");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let is_of_shell = path.starts_with("/dev/fd") || path.starts_with("/proc/self/fd");
        if kind.is_fifo() && is_of_shell {
            return Ok(());
        }
    }
    if kind.is_file() { Ok(()) } else { refuse(io::ErrorKind::InvalidInput, "it is a device or a pipe, not a file") }
}

/// A path without `.`, and without `..` as far as that is possible.
fn plain(path: &Path) -> PathBuf {
    let mut found = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(found.components().next_back(), Some(Component::Normal(_))) => {
                found.pop();
            }
            part => found.push(part),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_out_of_a_folder_are_known() {
        let store = Store::Memory(Arc::default());
        let is_within = |path: &str| store.is_within(Path::new("a/b"), &Path::new("a/b").join(path));
        assert_eq!(["c", "./c/../d", "../b/c", "c/../../b/d"].map(is_within), [true; 4]);
        assert_eq!(["../c", "/etc/passwd", "../../x", "c/../../../b/d", "../bb/c"].map(is_within), [false; 5]);
        assert!(store.is_within(Path::new(""), Path::new("c")) && !store.is_within(Path::new(""), Path::new("../c")));
    }

    #[cfg(unix)]
    #[test]
    fn devices_folders_and_pipes_are_refused_at_once() {
        let folder = std::env::temp_dir().join(format!("pneuflex-store-{}", std::process::id()));
        let pipe = folder.join("pipe");
        fs::create_dir_all(&folder).unwrap();
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        let mut paths = vec![PathBuf::from("/dev/zero"), PathBuf::from("/dev/null"), folder.clone()];
        paths.extend(made.is_ok_and(|status| status.success()).then_some(pipe));
        for path in paths {
            let words = if path == folder { "it is a folder" } else { "it is a device or a pipe" };
            let [text, bytes] =
                [Store::Disk.text(&path).unwrap_err().to_string(), Store::Disk.bytes(&path).unwrap_err()];
            assert!(text.contains(words) && bytes.contains(words), "{text} {bytes}");
        }
        // A large file with nothing in it.
        let large = folder.join("large.msh");
        File::create(&large).unwrap().set_len(MOST_BYTES + 1).unwrap();
        assert_eq!(Store::Disk.bytes(&large).unwrap_err(), TOO_LARGE);
        fs::remove_dir_all(&folder).unwrap();
    }
}
