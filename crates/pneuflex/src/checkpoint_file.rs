//! `checkpoint.bin`: the last accepted load step, from which `run --resume` goes on (MessagePack behind a checksum).

use pneuflex_newton::Checkpoint;
use pneuflex_post::summary::StepSummary;
use pneuflex_report::summary::FORMAT;
use serde::{Deserialize, Serialize};

use crate::analysis::Analysis;
use crate::error::ResultsError;
use crate::files::{Files, INPUT, included_name};
use crate::folder::OutputFolder;
use crate::input_error::{InputError, InputErrorKind};
use crate::memory::MemoryLimit;
use crate::solution::Status;
use crate::start::{Earlier, Recorded, Start};
use crate::study::Study;

/// Name of the file.
const FILE: &str = "checkpoint.bin";

/// First bytes of the file; the checksum of all that follows it comes next.
const MAGIC: &[u8; 8] = b"pneuflex";

#[derive(Serialize)]
struct Stored<'a> {
    version: &'a str,
    format: u32,
    recorded: &'a Recorded,
    path: &'a Checkpoint,
}

#[derive(Deserialize)]
struct Loaded {
    version: String,
    /// That of `summary.json`, whose numbers it holds.
    #[serde(default)]
    format: u32,
    recorded: Recorded,
    path: Checkpoint,
}

/// Writes the checkpoint of a run.
///
/// # Errors
/// The file cannot be written.
pub fn store(folder: &OutputFolder, recorded: &Recorded, path: &Checkpoint) -> Result<(), ResultsError> {
    let stored = Stored { version: env!("CARGO_PKG_VERSION"), format: FORMAT, recorded, path };
    let bytes = rmp_serde::to_vec_named(&stored).map_err(|e| ResultsError::not_representable(FILE, e))?;
    folder.write(FILE, sealed(&bytes))
}

/// Bytes behind their checksum.
pub(crate) fn sealed(bytes: &[u8]) -> Vec<u8> {
    [&MAGIC[..], &checksum(bytes).to_le_bytes(), bytes].concat()
}

/// The bytes behind the checksum, unless one of them or of the checksum is not what was written.
pub(crate) fn unsealed(bytes: &[u8]) -> Option<&[u8]> {
    let (found, bytes) = bytes.strip_prefix(MAGIC)?.split_first_chunk()?;
    (u64::from_le_bytes(*found) == checksum(bytes)).then_some(bytes)
}

/// The hash FNV-1a of 64 bits. Every step is a bijection of the hash, so that no single byte can change unnoticed.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

impl OutputFolder {
    /// Where a run of an analysis is to go on that records in this folder.
    ///
    /// # Errors
    /// Results of another case, of another version of the program, or a damaged checkpoint.
    pub fn start(&self, analysis: &Analysis) -> Result<Start, InputError> {
        load(self, analysis)
    }
}

fn load(folder: &OutputFolder, analysis: &Analysis) -> Result<Start, InputError> {
    let again = |what: String| {
        InputError::about_file(folder.path(), what)
            .of_kind(InputErrorKind::OtherResults)
            .with_help(Some("start over; that replaces what is there".into()))
    };
    let (reached, status) = reached(folder).map_err(again)?;
    let has_checkpoint = folder.path().join(FILE).exists();
    // Of a run that died before its first load step nothing is lost, whatever else has changed since.
    if folder.is_beginning() || (reached.is_empty() && !has_checkpoint) {
        return Ok(Start::AtRest);
    }
    let Some(text) = folder.read("case.toml") else {
        return Err(again("there are results, but case.toml is missing or cannot be read".into()));
    };
    let unreadable = || again("case.toml cannot be read: it is damaged, or another version's".into());
    let case = std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok()).ok_or_else(unreadable)?;
    let files = analysis.files()?;
    let earlier = Earlier {
        case,
        reached,
        status,
        changed_files: files.and_then(|files| changed_files(folder, &files)),
        has_problem_of: &|analysis| {
            let before =
                Study::load(folder.path().join("case.toml")).and_then(|old| old.build_within(MemoryLimit::None));
            before.is_ok_and(|before| before.problem == analysis.problem)
        },
        step: &|| read(folder).map(Some),
    };
    earlier.start(analysis).map_err(again)
}

/// The checkpoint of a folder.
fn read(folder: &OutputFolder) -> Result<(Recorded, Checkpoint), String> {
    let bytes =
        folder.read(FILE).ok_or_else(|| format!("there are results, but {FILE} is missing or cannot be read"))?;
    let damaged = || format!("{FILE} is damaged, or another version's");
    let loaded: Loaded = unsealed(&bytes).and_then(|bytes| rmp_serde::from_slice(bytes).ok()).ok_or_else(damaged)?;
    if loaded.format != FORMAT {
        return Err(format!("{FILE} has the format {} instead of {FORMAT}", loaded.format));
    }
    if loaded.version != env!("CARGO_PKG_VERSION") {
        return Err(format!("the results there are of pneuflex {}", loaded.version));
    }
    Ok((loaded.recorded, loaded.path))
}

/// Files of the body that are not the copies of an earlier run.
fn changed_files(folder: &OutputFolder, files: &Files) -> Option<(String, String)> {
    let same = |name: &str, bytes: &[u8]| folder.read(&format!("{INPUT}/{name}")).is_some_and(|old| old == bytes);
    let is_same = (files.bytes.is_empty() || same(&files.name, &files.bytes))
        && files.included.iter().enumerate().all(|(i, (_, bytes))| same(&included_name(i), bytes));
    (!is_same).then(|| ("model.file".to_owned(), format!("{} or what it includes is another one", files.name)))
}

/// What `summary.json` says of the times that were reached, and how the run stands, or why its numbers mean something else.
fn reached(folder: &OutputFolder) -> Result<(Vec<StepSummary>, Status), String> {
    let mut summary: serde_json::Value =
        serde_json::from_slice(&folder.read("summary.json").unwrap_or_default()).unwrap_or_default();
    let status = summary["status"].as_str().and_then(Status::find).unwrap_or_default();
    let steps = summary.get_mut("steps").and_then(serde_json::Value::as_array_mut);
    let Some(steps) = steps else { return Ok((Vec::new(), status)) };
    let steps = std::mem::take(steps);
    let format = summary["format"].as_u64().unwrap_or(1);
    if format != u64::from(FORMAT) && !steps.is_empty() {
        return Err(format!("its summary.json has the format {format} instead of {FORMAT}"));
    }
    let converged = steps.into_iter().filter(|step| step["converged"] == true);
    Ok((converged.filter_map(|step| serde_json::from_value(step).ok()).collect(), status))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_byte_is_noticed_wherever_it_is() {
        let sealed = sealed(b"displacements and more");
        assert_eq!(unsealed(&sealed), Some(&b"displacements and more"[..]));
        for at in 0..sealed.len() {
            for damage in [1, 0x80, 0xff] {
                let mut damaged = sealed.clone();
                damaged[at] ^= damage;
                assert_eq!(unsealed(&damaged), None, "byte {at}");
            }
            assert_eq!(unsealed(&sealed[..at]), None, "{at} bytes");
        }
        assert_eq!(unsealed(&[&sealed[..], b"x"].concat()), None);
    }
}
