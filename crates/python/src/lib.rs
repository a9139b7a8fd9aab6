//! `pneuflex._native`: what the Python package `pneuflex` needs of the library, as little as possible.
//!
//! The package itself is Python (`python/pneuflex`): there are its classes, words, types and documentation. Here are
//!
//! | file | what is there |
//! |---|---|
//! | `study` | case files, model files, decks and meshes, and what is built from them |
//! | `run` | solving, with the interpreter free and Ctrl-C heard |
//! | `state` | reached states with their fields, field files |
//! | `sweep` | names of designs, numbers of states, tables: those of the program's sweeps |
//! | `array` | numbers that numpy sees without a copy |
//! | `calibration` | fits and known materials |
//! | `error` | errors as exceptions; no panic crosses |
//!
//! What has a structure of its own (summaries, warnings, reasons, fits) crosses as JSON, whose numbers are read back to the last bit.

mod array;
mod calibration;
mod error;
mod leave;
mod run;
mod state;
mod study;
mod sweep;

use pyo3::prelude::*;

/// The module.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::array::Array;
    #[pymodule_export]
    use crate::calibration::{fit, materials, read_curves, test_kind};
    #[pymodule_export]
    use crate::leave::{compare, export};
    #[pymodule_export]
    use crate::run::{Outcome, Start, solve};
    #[pymodule_export]
    use crate::state::{FieldFile, State, read_field_file, report_page};
    #[pymodule_export]
    use crate::study::{Analysis, Study, available_memory, template};
    #[pymodule_export]
    use crate::sweep::{
        content_of, forget_neighbours, identity_of, identity_of_bad_input, is_count, neighbours_of, numbers, table_of,
    };
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
