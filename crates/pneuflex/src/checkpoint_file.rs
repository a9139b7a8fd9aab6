//! `checkpoint.bin`: the last accepted load step, from which `run --resume` goes on (MessagePack behind a checksum).

use pneuflex_model::{Clock, Continuation, LoadParameter};
use pneuflex_newton::Checkpoint;
use pneuflex_post::summary::StepSummary;
use pneuflex_report::summary::FORMAT;
use serde::{Deserialize, Serialize};
use toml::Value;

use crate::analysis::Analysis;
use crate::error::ResultsError;
use crate::files::{Files, INPUT, included_name};
use crate::folder::OutputFolder;
use crate::input_error::{InputError, InputErrorKind};
use crate::memory::MemoryLimit;
use crate::on_the_way::OnTheWay;
use crate::study::Study;

/// Name of the file.
const FILE: &str = "checkpoint.bin";

/// First bytes of the file; the checksum of all that follows it comes next.
const MAGIC: &[u8; 8] = b"pneuflex";

/// What the output folder held when the checkpoint was written.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Recorded {
    /// Pressures reached on.
    pub steps: Vec<StepSummary>,
    /// Length of `history.jsonl`.
    pub history_bytes: u64,
    /// Seconds spent on derived quantities and files.
    pub output_s: f64,
    /// States on the way to the next requested position.
    pub(crate) on_the_way: OnTheWay,
}

/// Where a run begins that goes on with what a folder holds.
#[derive(Clone, Debug, Default)]
pub enum Start {
    /// At rest: there is nothing to go on with.
    #[default]
    AtRest,
    /// At an accepted load step of an earlier run.
    From(Box<(Recorded, Checkpoint)>),
    /// Nowhere: the earlier run reached everything that is asked for.
    Complete(Vec<StepSummary>),
}

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
fn sealed(bytes: &[u8]) -> Vec<u8> {
    [&MAGIC[..], &checksum(bytes).to_le_bytes(), bytes].concat()
}

/// The bytes behind the checksum, unless one of them or of the checksum is not what was written.
fn unsealed(bytes: &[u8]) -> Option<&[u8]> {
    let (found, bytes) = bytes.strip_prefix(MAGIC)?.split_first_chunk()?;
    (u64::from_le_bytes(*found) == checksum(bytes)).then_some(bytes)
}

/// The hash FNV-1a of 64 bits. Every step is a bijection of the hash, so that no single byte can change unnoticed.
fn checksum(bytes: &[u8]) -> u64 {
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
    let (reached, end) = reached(folder).map_err(again)?;
    let has_checkpoint = folder.path().join(FILE).exists();
    // Of a run that died before its first load step nothing is lost, whatever else has changed since.
    if folder.is_beginning() || (reached.is_empty() && !has_checkpoint) {
        return Ok(Start::AtRest);
    }
    let Some(text) = folder.read("case.toml") else {
        return Err(again("there are results, but case.toml is missing or cannot be read".into()));
    };
    let unreadable = || again("case.toml cannot be read: it is damaged, or another version's".into());
    let old: toml::Table = std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok()).ok_or_else(unreadable)?;
    let new: toml::Table = analysis.resolved().ok().and_then(|text| text.parse().ok()).ok_or_else(unreadable)?;
    let mut changes = changes(&old, &new);
    if let Some(files) = analysis.files()? {
        changes.extend(changed_files(folder, &files));
    }
    let has_all = requested_of(&reached).eq(analysis.requested.iter().copied());
    if changes.is_empty() && (has_all && end == Some(End::Reached) || end == Some(End::PastLimit)) {
        return Ok(Start::Complete(reached));
    }
    let old_requested = requested_by(&old);
    let forbidden: Vec<_> = changes.iter().filter(|(key, _)| !may_change(key)).map(|(_, what)| what.as_str()).collect();
    if !forbidden.is_empty() {
        return Err(again(format!("the case has changed since: {}", forbidden.join("; "))));
    }
    if analysis.problem.clock == Clock::Steps && old_requested.last() != analysis.requested.last() {
        // Nothing but the times has changed: where that changes the problem, loads follow them.
        let before = Study::load(folder.path().join("case.toml")).and_then(|old| old.build_within(MemoryLimit::None));
        if before.map_or(true, |before| before.problem != analysis.problem) {
            let what = "loads without times of their own grow up to the last one of load.times, which has changed, so that what was \
                        reached was reached under other loads; give their values by time, [[time, value], ...], to go on beyond it";
            return Err(again(what.to_owned()));
        }
    }
    let Some(bytes) = folder.read(FILE) else {
        return Err(again(format!("there are results, but {FILE} is missing or cannot be read")));
    };
    let damaged = || again(format!("{FILE} is damaged, or another version's"));
    let loaded: Loaded = unsealed(&bytes).and_then(|bytes| rmp_serde::from_slice(bytes).ok()).ok_or_else(damaged)?;
    if loaded.format != FORMAT {
        return Err(again(format!("{FILE} has the format {} instead of {FORMAT}", loaded.format)));
    }
    if loaded.version != env!("CARGO_PKG_VERSION") {
        return Err(again(format!("the results there are of pneuflex {}", loaded.version)));
    }
    if loaded.path.arc.is_past_limit() && analysis.solver.continuation != Continuation::ArcLength {
        let what =
            "the path there has passed a limit point, which only solver.continuation = \"arc-length\" goes on from";
        return Err(again(what.to_owned()));
    }
    let count = requested_of(&loaded.recorded.steps).count();
    let reached = requested_of(&loaded.recorded.steps);
    let requested = &analysis.requested;
    let at = loaded.path.parameter;
    let goes_on = reached.eq(requested.iter().copied().take(count))
        && requested.get(count).is_none_or(|next| *next >= at)
        // The last time reached may not be among the steps yet.
        && (!old_requested.contains(&at) || requested.contains(&at));
    if !goes_on {
        return Err(again(format!(
            "{} leaves out what was reached; it may only change beyond {}",
            if analysis.problem.clock == Clock::Pressure { "load.pressure_kpa" } else { "load.times" },
            analysis.problem.clock.words(at)
        )));
    }
    Ok(Start::From(Box::new((loaded.recorded, loaded.path))))
}

/// Whether a run may go on with another value of a key: how the rest of the path is followed.
fn may_change(key: &str) -> bool {
    key == "load.pressure_kpa" || key == "load.times" || key.starts_with("solver.")
}

/// The positions on the load path that a case asks for, as far as it names them.
fn requested_by(case: &toml::Table) -> Vec<LoadParameter> {
    let load = case.get("load").and_then(Value::as_table);
    let list = load.and_then(|load| load.get("pressure_kpa").or_else(|| load.get("times"))).and_then(Value::as_array);
    list.into_iter().flatten().filter_map(Value::as_float).map(LoadParameter).collect()
}

/// Files of the body that are not the copies of an earlier run.
fn changed_files(folder: &OutputFolder, files: &Files) -> Option<(String, String)> {
    let same = |name: &str, bytes: &[u8]| folder.read(&format!("{INPUT}/{name}")).is_some_and(|old| old == bytes);
    let is_same = (files.bytes.is_empty() || same(&files.name, &files.bytes))
        && files.included.iter().enumerate().all(|(i, (_, bytes))| same(&included_name(i), bytes));
    (!is_same).then(|| ("model.file".to_owned(), format!("{} or what it includes is another one", files.name)))
}

/// How a run came to its end.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    /// At the last requested position.
    Reached,
    /// On the path past a limit point.
    PastLimit,
}

/// Where the states are that were asked for.
fn requested_of(steps: &[StepSummary]) -> impl Iterator<Item = LoadParameter> {
    steps.iter().filter(|step| step.kind.is_requested()).map(StepSummary::when)
}

/// What `summary.json` says of the times that were reached, and whether the run came to its end, or why its numbers mean something else.
fn reached(folder: &OutputFolder) -> Result<(Vec<StepSummary>, Option<End>), String> {
    let mut summary: serde_json::Value =
        serde_json::from_slice(&folder.read("summary.json").unwrap_or_default()).unwrap_or_default();
    let end = match summary["status"].as_str() {
        Some("converged") => Some(End::Reached),
        Some("past-limit") => Some(End::PastLimit),
        _ => None,
    };
    let steps = summary.get_mut("steps").and_then(serde_json::Value::as_array_mut);
    let Some(steps) = steps else { return Ok((Vec::new(), None)) };
    let steps = std::mem::take(steps);
    let format = summary["format"].as_u64().unwrap_or(1);
    if format != u64::from(FORMAT) && !steps.is_empty() {
        return Err(format!("its summary.json has the format {format} instead of {FORMAT}"));
    }
    let converged = steps.into_iter().filter(|step| step["converged"] == true);
    Ok((converged.filter_map(|step| serde_json::from_value(step).ok()).collect(), end))
}

/// Keys of which two cases have different values, each with what it was and is.
fn changes(old: &toml::Table, new: &toml::Table) -> Vec<(String, String)> {
    let mut found = Vec::new();
    compare(Some(&Value::Table(old.clone())), Some(&Value::Table(new.clone())), "", &mut found);
    found
}

fn compare(old: Option<&Value>, new: Option<&Value>, key: &str, found: &mut Vec<(String, String)>) {
    let keys = [old, new].into_iter().flatten().filter_map(Value::as_table).flat_map(toml::Table::keys);
    if let (Some(Value::Table(_)) | None, Some(Value::Table(_)) | None) = (old, new) {
        let keys: std::collections::BTreeSet<_> = keys.collect();
        for name in keys {
            let below = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            compare(old.and_then(|o| o.get(name)), new.and_then(|n| n.get(name)), &below, found);
        }
    } else if old != new {
        let text = |value: Option<&Value>| value.map_or("nothing".into(), Value::to_string);
        found.push((key.into(), format!("{key} was {} and is {}", text(old), text(new))));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_model::Case;

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

    #[test]
    fn changes_of_a_case_are_named() {
        let text = crate::template::two_chambers();
        let old: Case = toml::from_str(&text).unwrap();
        let table = |case: &Case| toml::Table::try_from(case).unwrap();
        assert_eq!(changes(&table(&old), &table(&old)), []);
        let mut new = old.clone();
        new.material.law = pneuflex_model::Law::Yeoh { c10: 1.0, c20: 0.03053, c30: -0.000_401_3 };
        new.title = "other".into();
        let found = changes(&table(&old), &table(&new));
        let keys: Vec<_> = found.iter().map(|(key, _)| key.as_str()).collect();
        assert_eq!(keys, ["material.c10", "title"]);
        assert!(found[0].1.ends_with("and is 1.0"), "{}", found[0].1);
        assert!(!may_change("output.fields") && !may_change("material.c10") && may_change("solver.min_step_kpa"));
    }
}
