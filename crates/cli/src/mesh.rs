//! `pneuflex mesh`: a part from CAD, or a surface of triangles, as a mesh.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};

use pneuflex::cad::{is_part, mesh_part};
use pneuflex::{InputError, input_file};

use crate::args::MeshArguments;
use crate::error::CliError;
use crate::terminal::{print_rows, say};

/// Bytes that a part may have.
const MOST_BYTES: u64 = 2_000_000_000;

/// Meshes a part, writes the mesh and says what it is.
///
/// # Errors
/// A part that cannot be read or meshed, a file that exists already or cannot be written.
pub fn mesh(arguments: &MeshArguments) -> Result<(), CliError> {
    let part = &arguments.part;
    if !is_part(part) {
        let help = "parts end in .step, .stp, .iges, .igs, .brep, .stl or .obj".to_owned();
        return Err(InputError::about_file(part, "is no part that can be meshed").with_help(Some(help)).into());
    }
    let bytes = input_file(part, MOST_BYTES)?;
    let default =
        || part.file_name().map_or_else(|| "part.msh".into(), |name| std::path::Path::new(name).with_extension("msh"));
    let path = arguments.out.clone().unwrap_or_else(default);
    let is_new = arguments.out.is_none();
    // Before minutes of work.
    if is_new && path.exists() {
        let help = "give another name with --out, which replaces what is there".to_owned();
        return Err(InputError::about_file(&path, "exists already and is not replaced").with_help(Some(help)).into());
    }
    let meshed = mesh_part(part, &bytes, arguments.size)?;
    let rows = meshed.rows()?;
    for line in meshed.said(part) {
        say(&line);
    }
    let written = OpenOptions::new().write(true).create(true).truncate(true).create_new(is_new).open(&path);
    written.and_then(|mut file| file.write_all(&meshed.bytes)).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => CliError::Output(format!("{}: exists already and is not replaced", path.display())),
        _ => CliError::Output(format!("{}: cannot be written: {error}", path.display())),
    })?;
    let name = path.display();
    print_rows(&format!("{rows}wrote {name}\nnext: pneuflex new model {name}\n"));
    Ok(())
}
