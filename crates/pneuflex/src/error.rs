//! What can go wrong, by kind.

use std::io;
use std::path::PathBuf;

use pneuflex_newton::{Cause, Failure};
use pneuflex_post::PostError;

use crate::input_error::InputError;
use crate::reason::Reason;
use crate::solution::Solution;

/// What can go wrong between a file and its results.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// What was given cannot be used: everything that is wrong with it.
    #[error("{}", joined(.0))]
    Input(Vec<InputError>),
    /// The equations cannot be set up: a cell without volume, a part that is not held, a cavity that is open.
    #[error("{0}")]
    Setup(Box<Unfinished>),
    /// The equilibrium path ended before the last requested time.
    #[error("{0}")]
    NotConverged(Box<Unfinished>),
    /// Somebody asked to stop, see [`crate::StopToken`].
    #[error("{0}")]
    Interrupted(Box<Unfinished>),
    /// A result could not be derived or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The threads that were asked for cannot be started.
    #[error("{threads} threads cannot be started: {source}")]
    Threads {
        /// How many.
        threads: usize,
        /// Why not.
        source: rayon::ThreadPoolBuildError,
    },
}

/// A path that ended before its last requested time, with what it had reached.
#[derive(Clone, Debug)]
pub struct Unfinished {
    /// Where it ended, and the cause.
    pub failure: Failure,
    /// Why in the words of somebody who designs actuators, and what to try; `None` if it was interrupted.
    pub reason: Option<Reason>,
    /// What was reached before.
    pub reached: Solution,
}

impl Error {
    /// Whether a run with a neighbour's guesses ([`crate::Run::start_from`]) ended where the two designs differ.
    pub fn has_left_neighbour(&self) -> bool {
        matches!(self, Self::NotConverged(ended) if ended.has_left_neighbour())
    }
}

impl Unfinished {
    /// As [`Error::has_left_neighbour`].
    pub fn has_left_neighbour(&self) -> bool {
        self.reached.has_started_from && self.failure.cause == Cause::OtherBranch
    }

    /// As an error of its kind.
    pub(crate) fn into_error(self) -> Error {
        match self.failure.cause {
            Cause::Interrupted => Error::Interrupted(Box::new(self)),
            Cause::Setup(_) => Error::Setup(Box::new(self)),
            _ => Error::NotConverged(Box::new(self)),
        }
    }
}

/// How the end of a path is said, with the reason where one was found.
pub(crate) fn end_in_words(failure: &Failure, reason: Option<&Reason>) -> String {
    match reason {
        Some(reason) => format!("not converged: {}", reason.message),
        None => failure.to_string(),
    }
}

impl std::fmt::Display for Unfinished {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&end_in_words(&self.failure, self.reason.as_ref()))
    }
}

/// A result that could not be derived or written.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// Nothing can be derived from a state.
    #[error("results at {at}: {source}")]
    Derived {
        /// Pressure or time in words.
        at: String,
        /// Why.
        source: PostError,
    },
    /// The disk is full.
    #[error("{}: cannot be written: the disk is full", .file.display())]
    DiskFull {
        /// The file.
        file: PathBuf,
    },
    /// The output folder was removed or moved.
    #[error("{}: the output folder has gone away during the run", .folder.display())]
    FolderGone {
        /// The folder.
        folder: PathBuf,
    },
    /// Another folder has the output folder's name.
    #[error(
        "{}: another folder has taken the place of the output folder during the run; what was recorded is where that was moved to",
        .folder.display()
    )]
    FolderReplaced {
        /// The folder.
        folder: PathBuf,
    },
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", .file.display())]
    NotWritable {
        /// The file.
        file: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// What is to be written has no such form, e.g. a number that is not finite.
    #[error("{file}: {why}")]
    NotRepresentable {
        /// Name of the file.
        file: String,
        /// Why not.
        why: String,
    },
}

impl ResultsError {
    /// Something that the form of a file does not allow.
    pub fn not_representable(file: &str, why: impl ToString) -> Self {
        Self::NotRepresentable { file: file.into(), why: why.to_string() }
    }
}

impl From<InputError> for Error {
    fn from(error: InputError) -> Self {
        Self::Input(vec![error])
    }
}

impl From<Vec<InputError>> for Error {
    fn from(errors: Vec<InputError>) -> Self {
        Self::Input(errors)
    }
}

fn joined(errors: &[InputError]) -> String {
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}
