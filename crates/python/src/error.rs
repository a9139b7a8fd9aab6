//! Errors as Python's exceptions.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pneuflex::input_error::InputErrorKind;
use pneuflex::{Error, InputError};
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// Does something that takes long, or may go wrong, while other Python threads go on.
///
/// # Errors
/// What went wrong; a panic is a `RuntimeError`.
pub fn apart<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T, Error> + Send) -> PyResult<T> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(work))) {
        Ok(done) => done.map_err(|error| raised(py, error)),
        Err(panic) => Err(of_panic(&*panic)),
    }
}

/// A panic as an exception.
pub fn of_panic(panic: &(dyn Any + Send)) -> PyErr {
    let said = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    PyRuntimeError::new_err(format!("a defect of pneuflex, please report it: {}", said.unwrap_or("unknown")))
}

/// The exception of an error.
pub fn raised(py: Python<'_>, error: Error) -> PyErr {
    match error {
        Error::Input(errors) => bad_input(py, &errors),
        Error::Results(error) => PyOSError::new_err(error.to_string()),
        Error::Threads { .. } => PyValueError::new_err(error.to_string()),
        // Those who solve make more of these than their words.
        Error::Setup(_) | Error::NotConverged(_) | Error::Interrupted(_) => PyRuntimeError::new_err(error.to_string()),
    }
}

/// `pneuflex.InputError`, a `ValueError`, with everything that is wrong.
pub fn bad_input(py: Python<'_>, errors: &[InputError]) -> PyErr {
    let problems: Vec<_> = errors
        .iter()
        .map(|error| {
            let file = error.file().map(|path| path.display().to_string());
            let of_machine = error.kind().is_of_machine();
            (
                error.in_full(help(error).as_deref()),
                error.to_string(),
                error.key(),
                help(error),
                file,
                error.line(),
                of_machine,
            )
        })
        .collect();
    let class = py.import("pneuflex._errors").and_then(|module| module.getattr("InputError"));
    match class.and_then(|class| class.call_method1("_of", (problems,))) {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// A single problem that has no place.
pub fn wrong(py: Python<'_>, message: impl Into<String>) -> PyErr {
    bad_input(py, &[InputError::new(message)])
}

/// What to do about bad input, in terms of the package.
fn help(error: &InputError) -> Option<String> {
    let help = match error.kind() {
        InputErrorKind::Other
        | InputErrorKind::Unknown
        | InputErrorKind::TooManyThreads
        | InputErrorKind::MissingProgram => {
            return error.help().map(str::to_owned);
        }
        InputErrorKind::TooLarge => {
            "choose a coarser mesh.resolution or a larger mesh.size, or force=True to try all the same"
        }
        InputErrorKind::UnusableFolder => "choose another folder",
        InputErrorKind::ForeignFolder => "choose another folder; nothing was touched",
        InputErrorKind::BusyFolder => "wait until it has ended, or choose another folder",
        InputErrorKind::OtherSweep => "choose another folder",
        InputErrorKind::OtherResults => "solve the case again; that replaces what is there",
    };
    Some(help.to_owned())
}
