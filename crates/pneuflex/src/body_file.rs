//! Reading the file that holds a body: a deck, a mesh of Gmsh or VTK, or a mesh as it was recorded.

use std::path::Path;

use pneuflex_deck::{Extent, msh, vtk, vtu};
use pneuflex_model::model_file::Source;
use pneuflex_model::{Formulation, Problem};

use crate::cad::{is_part, kept_mesh};
use crate::files::{Files, INCLUDED, included_name};
use crate::foreign::{not_a_body, pointer};
use crate::input_error::InputError;
use crate::recorded_mesh::RecordedMesh;
use crate::store::Store;

/// A body that was read.
pub struct ReadBody {
    /// Title of the deck.
    pub title: String,
    /// The body, with what a deck says of loads and supports.
    pub problem: Problem,
    /// Times and first increment of a deck.
    pub schedule: Option<(Vec<f64>, f64)>,
    /// What was understood in another way than it may be meant.
    pub notes: Vec<String>,
    /// The files.
    pub files: Files,
}

/// Whether a path is that of a deck.
pub fn is_deck(path: &Path) -> bool {
    has_extension(path, "inp") || has_extension(path, "feb")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Reads the body of a model file; `element` is the formulation that it asks for, `extent` what a deck must hold.
///
/// # Errors
/// A file that cannot be read, or everything that is wrong with it.
pub fn read_body(
    store: &Store,
    path: &Path,
    source: &Source,
    element: Option<Formulation>,
    extent: Extent,
) -> Result<ReadBody, Vec<InputError>> {
    let bytes = store.bytes(path).map_err(|why| InputError::about_file(path, why))?;
    if let Some(error) = pointer(path, &bytes) {
        return Err(error.into());
    }
    let part = is_part(path).then(|| mesh_of_part(store, path, source, &bytes)).transpose()?;
    if part.is_none() && source.size.is_some() {
        let what = "model.size = is for parts that are meshed on the way (.step, .iges, .brep, .stl, .obj): this file has its elements";
        return Err(InputError::new(what).of_key("model.size").into());
    }
    let (path, bytes, of_part) = match part {
        Some((mesh, notes)) => (&*path.with_extension("msh"), mesh, notes),
        None => (path, bytes, Vec::new()),
    };
    let shown = path.display().to_string();
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut files = Files { name, bytes: bytes.clone(), included: Vec::new() };
    let wrong = |errors: Vec<pneuflex_deck::DeckError>| errors.into_iter().map(InputError::from).collect::<Vec<_>>();
    if is_deck(path) {
        if source.scale != 1.0 {
            let what = "model.scale = must be 1 for a deck: decks are in mm, N, MPa";
            return Err(InputError::new(what).of_key("model.scale").into());
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let copies = copies(store, folder);
        let mut outside = Vec::new();
        let mut include = |name: &str| {
            let copy = copies.iter().position(|known| known == name).map(included_name);
            let file = folder.join(copy.unwrap_or_else(|| name.to_owned()));
            if !store.is_within(folder, &file) {
                outside
                    .push(format!("{shown}: {} is included, which lies outside of the deck's folder", file.display()));
            }
            let bytes = store.bytes(&file)?;
            if let Some(error) = pointer(&file, &bytes) {
                return Err(error.help().map_or_else(|| error.to_string(), |help| format!("{error}; {help}")));
            }
            if files.included.iter().all(|(known, _)| known != name) {
                files.included.push((name.to_owned(), bytes.clone()));
            }
            Ok(bytes)
        };
        let deck = pneuflex_deck::read_extent(&shown, bytes, &mut include, extent).map_err(wrong)?;
        outside.extend(deck.notes.iter().map(ToString::to_string));
        let (problem, note) = solved_by(deck.problem, element)?;
        outside.push(note);
        return Ok(ReadBody {
            title: deck.title,
            problem,
            schedule: Some((deck.schedule.times, deck.schedule.first_increment)).filter(|(times, _)| !times.is_empty()),
            notes: outside,
            files,
        });
    }
    let reader = [("msh", msh::read as MeshReader), ("vtk", vtk::read), ("vtu", vtu::read)]
        .into_iter()
        .find(|(end, _)| has_extension(path, end));
    let (mesh, formulation, mut notes): (_, _, Vec<String>) = if let Some((_, read)) = reader {
        let read = read(&shown, &bytes).map_err(wrong)?;
        let unknown = || InputError::about_file(path, format!("{} cannot be solved", read.mesh.words()));
        let formulation = Formulation::of_mesh(&read.mesh).ok_or_else(unknown)?;
        (read.mesh, formulation, read.notes.iter().map(ToString::to_string).collect())
    } else if has_extension(path, "json") {
        let (mesh, formulation) = RecordedMesh::read(&bytes).map_err(|why| InputError::about_file(path, why))?;
        (mesh, formulation, Vec::new())
    } else {
        return Err(not_a_body(path, &bytes).into());
    };
    let mesh = mesh.map_nodes(|x| x.map(|t| source.scale * t));
    let is_recorded = has_extension(path, "json");
    // Elements of several families have no formulation that could be chosen.
    let recorded = mesh.kinds.only().and(is_recorded.then_some(formulation));
    let problem = Problem::body(mesh, formulation, Default::default());
    let (problem, note) = solved_by(problem, element.or(recorded))?;
    notes.extend((problem.given.is_some() && !is_recorded).then_some(note));
    notes.splice(0..0, of_part);
    Ok(ReadBody { title: String::new(), problem, schedule: None, notes, files })
}

/// The mesh of a part, and what to know of it. A part that has been read before comes with its mesh in its place.
fn mesh_of_part(
    store: &Store,
    path: &Path,
    source: &Source,
    bytes: &[u8],
) -> Result<(Vec<u8>, Vec<String>), Vec<InputError>> {
    if bytes.starts_with(b"$MeshFormat") {
        return Ok((bytes.to_vec(), Vec::new()));
    }
    match store {
        Store::Disk => kept_mesh(path, bytes, source.size.map(|size| size / source.scale)),
        // Files that were sent from somewhere start no other program.
        Store::Memory(_) => {
            let what = "is a part without a mesh, and parts are meshed where they lie on a disk";
            Err(InputError::about_file(path, what)
                .with_help(Some(format!("`pneuflex mesh {}` first", path.display())))
                .into())
        }
    }
}

/// Reads a mesh that is called by a name.
type MeshReader = fn(&str, &[u8]) -> Result<msh::MeshFile, Vec<pneuflex_deck::DeckError>>;

/// A body with the formulation that is asked for, and what it is solved with.
fn solved_by(body: Problem, element: Option<Formulation>) -> Result<(Problem, String), InputError> {
    let words = body.mesh.words();
    // Without a formulation as they are, there is nothing to choose.
    let as_it_is = body.mesh.kinds.only().and_then(Formulation::of_kind);
    let problem = body.solved_by(element).map_err(|e| InputError::new(e.to_string()).of_key(&e.key))?;
    let solved: Vec<String> = problem.formulations().map(|f| format!("{} ({})", f.name, f.words)).collect();
    let solved = solved.join(" and ");
    let note = match (&problem.given, as_it_is) {
        (Some(_), Some(as_it_is)) => format!(
            "{words} are solved with {solved}: nodes are added in faces and inside of elements; `mesh.element = \"{as_it_is}\"` in a model \
             file does without them"
        ),
        (Some(_), None) => format!("{words} are solved with {solved}: nodes are added in faces and inside of elements"),
        (None, _) => format!("{words} are solved with {solved}"),
    };
    Ok((problem, note))
}

/// Names of included files of which copies lie in a folder.
fn copies(store: &Store, folder: &Path) -> Vec<String> {
    store.bytes(&folder.join(INCLUDED)).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
}
