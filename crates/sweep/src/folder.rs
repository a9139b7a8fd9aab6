//! The folder of a sweep.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use pneuflex::{InputError, InputErrorKind, ResultsError};

use crate::identity::VERSION;
use crate::neighbours;
use crate::plan::Plan;
use crate::row::{Row, replace, row_file};
use crate::table;

/// Names of tables; one that is not written is of before.
const TABLES: [&str; 2] = ["table.csv", "table.parquet"];

/// The folder of a sweep, open for writing.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    plan: Plan,
    _lock: File,
}

impl Folder {
    /// Opens a folder, which is made if need be, and keeps other sweeps out until this value is dropped.
    ///
    /// # Errors
    /// A folder that cannot be written to, that holds something else, or that another sweep is writing to.
    pub fn hold(path: &Path, plan: Plan) -> Result<Self, InputError> {
        let folder = Self::open(path, plan, File::try_lock)?;
        // What was being written when somebody died. Others may be writing where the folder is shared.
        for entry in fs::read_dir(path.join("rows")).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().ends_with(".part") {
                let _ = fs::remove_file(entry.path());
            }
        }
        Ok(folder)
    }

    /// Opens a folder beside others who solve designs of the same sweep, each their own.
    ///
    /// # Errors
    /// As for [`Self::hold`].
    pub fn share(path: &Path, plan: Plan) -> Result<Self, InputError> {
        Self::open(path, plan, File::try_lock_shared)
    }

    fn open(path: &Path, plan: Plan, lock: fn(&File) -> Result<(), TryLockError>) -> Result<Self, InputError> {
        let unusable = |error: io::Error| {
            let what = format!("cannot be written to: {error}");
            InputError::about_file(path, what).of_kind(InputErrorKind::UnusableFolder)
        };
        fs::create_dir_all(path).map_err(unusable)?;
        let held = File::options().create(true).append(true).open(path.join(".lock")).map_err(unusable)?;
        match lock(&held) {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(InputError::about_file(path, "another sweep is writing to this folder")
                    .of_kind(InputErrorKind::BusyFolder));
            }
            // A file system without locks: nothing can be promised, but nothing is wrong either.
            Err(TryLockError::Error(_)) => {}
        }
        check(path, &plan)?;
        fs::create_dir_all(path.join("rows")).map_err(unusable)?;
        let text = serde_json::to_string_pretty(&plan).map_err(|error| unusable(error.into()))?;
        let file = path.join("sweep.json");
        if fs::read_to_string(&file).ok().as_deref() != Some(&text) {
            replace(&file, text.as_bytes()).map_err(unusable)?;
        }
        Ok(Self { path: path.to_owned(), plan, _lock: held })
    }

    /// Numbers of the designs that are not finished, those that are there twice once.
    pub fn left(&self) -> Vec<usize> {
        let mut seen = BTreeSet::new();
        let designs = self.plan.designs.iter().enumerate();
        let left = designs.filter(|(_, entry)| !Row::read(&self.path, &entry.identity).is_finished());
        left.filter(|(_, entry)| seen.insert(&entry.identity)).map(|(number, _)| number).collect()
    }

    /// Forgets what became of a design, which is to be tried again.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn forget(&self, number: usize) -> Result<(), ResultsError> {
        let file = row_file(&self.path, &self.plan.designs[number].identity);
        match fs::remove_file(&file) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => Err(ResultsError::NotWritable { file, source }),
            _ => Ok(()),
        }
    }

    /// What became of every design.
    pub fn rows(&self) -> Vec<Row> {
        self.plan.designs.iter().map(|entry| Row::read(&self.path, &entry.identity)).collect()
    }

    /// Writes the table of all designs; returns its path.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_table(&self) -> Result<PathBuf, ResultsError> {
        let file = self.path.join(TABLES[0]);
        let text =
            table::csv(&self.plan, &self.rows()).map_err(|why| ResultsError::not_representable(TABLES[0], why))?;
        let not_writable = |source| ResultsError::NotWritable { file: file.clone(), source };
        replace(&file, text.as_bytes()).map_err(not_writable)?;
        // One of before would be taken for this one.
        let _ = fs::remove_file(self.path.join(TABLES[1]));
        if self.left().is_empty() {
            neighbours::forget(&self.path);
        }
        Ok(file)
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The designs.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}

/// The plan of a folder.
///
/// # Errors
/// A folder that holds no sweep, or a damaged one.
pub fn plan_of(path: &Path) -> Result<Plan, InputError> {
    let file = path.join("sweep.json");
    let text = fs::read_to_string(&file).map_err(|_| InputError::about_file(path, "holds no sweep"))?;
    serde_json::from_str(&text).map_err(|error| InputError::about_file(&file, format!("damaged: {error}")))
}

/// Refuses a folder that holds something else than an earlier state of the sweep.
fn check(path: &Path, plan: &Plan) -> Result<(), InputError> {
    let other = |what: String| Err(InputError::about_file(path, what).of_kind(InputErrorKind::OtherSweep));
    if !path.join("sweep.json").is_file() {
        let entries = fs::read_dir(path).into_iter().flatten().flatten();
        let is_mine = |name: &str| name == ".lock" || name.starts_with(".sweep.json.");
        if entries.into_iter().any(|entry| !is_mine(&entry.file_name().to_string_lossy())) {
            return Err(InputError::about_file(path, "the folder holds files that are no sweep")
                .of_kind(InputErrorKind::ForeignFolder));
        }
        return Ok(());
    }
    let old = plan_of(path)?;
    if old.version != VERSION {
        return other(format!("the folder holds a sweep of pneuflex {}", old.version));
    }
    if old.origin == plan.origin {
        return Ok(());
    }
    let keys = plan.values.as_object().into_iter().flat_map(|values| values.keys());
    let changed: Vec<&str> =
        keys.filter(|key| plan.values.get(key) != old.values.get(key)).map(String::as_str).collect();
    let words = match &changed[..] {
        [] => "its mesh, its deck or what that includes differs".to_owned(),
        changed => format!("{} differ", changed.join(", ")),
    };
    other(format!("the folder holds a sweep of another case ({words})"))
}
