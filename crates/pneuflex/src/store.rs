//! Where files are read from: a disk, or memory.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::input_error::{InputError, Origin, Place};

/// Bytes that a case or model file may have.
const MOST_BYTES_OF_TEXT: u64 = 1_000_000;

/// Bytes that a deck or a mesh may have.
const MOST_BYTES: u64 = 2_000_000_000;

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
    /// A file that cannot be read, is too large or not UTF-8.
    pub fn text(&self, path: &Path) -> Result<String, InputError> {
        let cannot = |e: std::io::Error| InputError::about_file(path, format!("cannot be read: {e}"));
        let bytes = self.read(path, MOST_BYTES_OF_TEXT).map_err(cannot)?;
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
        let bytes = self.read(path, MOST_BYTES).map_err(|e| format!("cannot be read: {e}"))?;
        if bytes.len() as u64 > MOST_BYTES { Err("is larger than 2 GB".into()) } else { Ok(bytes) }
    }

    /// At the most one byte more than `most`.
    fn read(&self, path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
        match self {
            Self::Disk => {
                let mut bytes = Vec::new();
                File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
                Ok(bytes)
            }
            Self::Memory(files) => {
                let missing = || std::io::Error::new(std::io::ErrorKind::NotFound, "it is not among the given files");
                files.get(path).cloned().ok_or_else(missing)
            }
        }
    }
}
