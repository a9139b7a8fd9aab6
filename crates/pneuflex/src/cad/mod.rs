//! Parts from CAD, and surfaces of triangles, as meshes: measured here, filled by Gmsh, which is a process of its own.
//!
//! * `gmsh`: finding it and letting it run.
//!
//! A part is data: Gmsh is told what to do by a script of this program, in a folder of its own, and imports shapes or triangles only.

mod gmsh;

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use pneuflex_deck::msh;
use pneuflex_deck::surface::{self, Wall};

use crate::input_error::{InputError, InputErrorKind};
use crate::words::{measured, place, plural, thousands};
use gmsh::{Gmsh, Task};

/// Ends of the names of files with solids.
const SOLIDS: [&str; 5] = ["step", "stp", "iges", "igs", "brep"];

/// Ends of the names of surfaces of triangles.
const TRIANGLES: [&str; 2] = ["stl", "obj"];

/// Elements where nothing is said, relative to the thinnest wall, and to the part's diagonal at the most.
const PER_WALL: f64 = 1.5;
const PER_DIAGONAL: f64 = 0.1;

/// More tetrahedra than this, without those that curvature asks for, are not made where no size is asked for: a machine of 16 GiB solves them.
const MOST_ELEMENTS: f64 = 20_000.0;

/// Volume of a regular tetrahedron relative to the cube of its edge.
const TETRAHEDRON: f64 = 0.117_851_130_197_757_92;

/// A mesh has the volume of the triangles around its part but for this share.
const SAME_VOLUME: f64 = 0.1;

/// Folder, beside those of results by default, in which meshes of parts are kept.
const KEPT: &str = "out/meshes";

/// A part as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshedPart {
    /// The mesh, a `.msh` of Gmsh.
    pub bytes: Vec<u8>,
    /// Names of the solids.
    pub solids: Vec<String>,
    /// The thinnest wall, mm.
    pub wall: Option<Wall>,
    /// Volume inside of the surface, as its triangles have it, mm³.
    pub volume: f64,
    /// Largest edge of an element that was asked for, mm.
    pub size: f64,
    /// What to know.
    pub notes: Vec<String>,
}

/// Whether a path is that of a part that is meshed before it is solved.
pub fn is_part(path: &Path) -> bool {
    ends_in(path, &SOLIDS) || ends_in(path, &TRIANGLES)
}

fn ends_in(path: &Path, ends: &[&str]) -> bool {
    path.extension().is_some_and(|found| ends.iter().any(|end| found.eq_ignore_ascii_case(end)))
}

/// Meshes a part; `size` is the largest edge of an element in the part's unit of length, from its walls if it is left out.
///
/// # Errors
/// A surface with holes or triangles that pass through each other, with their places; a file in which no solid is; that there is no Gmsh, or
/// what it could not do.
pub fn mesh_part(path: &Path, bytes: &[u8], size: Option<f64>) -> Result<MeshedPart, Vec<InputError>> {
    if ends_in(path, &TRIANGLES) { mesh_triangles(path, bytes, size) } else { mesh_solids(path, bytes, size) }
}

/// The mesh of a part that is kept from an earlier time, or made and kept; with what to know of it.
///
/// # Errors
/// As for [`mesh_part`].
pub fn kept_mesh(path: &Path, bytes: &[u8], size: Option<f64>) -> Result<(Vec<u8>, Vec<String>), Vec<InputError>> {
    let kept = kept_path(path, bytes, size);
    if let Ok(mesh) = fs::read(&kept) {
        return Ok((mesh, vec![format!("{}: meshed at an earlier time, as {}", path.display(), kept.display())]));
    }
    let part = mesh_part(path, bytes, size)?;
    let mut notes = part.said(path);
    // A mesh that cannot be kept is made again the next time.
    let beside = kept.with_extension(format!("{}.part", std::process::id()));
    let is_kept = fs::create_dir_all(kept.parent().unwrap_or(Path::new("")))
        .and_then(|()| fs::write(&beside, &part.bytes))
        .and_then(|()| fs::rename(&beside, &kept));
    if is_kept.is_ok() {
        notes.push(format!("{}: the mesh is kept as {}", path.display(), kept.display()));
    }
    Ok((part.bytes, notes))
}

/// Where the mesh of a part with this size is kept, by what is in the file.
fn kept_path(path: &Path, bytes: &[u8], size: Option<f64>) -> PathBuf {
    let hash = |salt: u8| {
        let mut hasher = DefaultHasher::new();
        (salt, bytes, size.map(f64::to_bits), env!("CARGO_PKG_VERSION"), gmsh::SCRIPT).hash(&mut hasher);
        hasher.finish()
    };
    let stem = path.file_stem().map_or_else(|| "part".into(), |stem| stem.to_string_lossy().into_owned());
    Path::new(KEPT).join(format!("{stem}-{:016x}{:016x}.msh", hash(0), hash(1)))
}

impl MeshedPart {
    /// What was measured and made, in words; `path` is the part's.
    pub fn said(&self, path: &Path) -> Vec<String> {
        let wall = self.wall.map_or_else(
            || "no wall was found".to_owned(),
            |wall| format!("the thinnest wall is {} mm, near {}", measured(wall.thickness), place(wall.at)),
        );
        let what = plural(self.solids.len(), "solid");
        let first = format!(
            "{}: {what}, {} mm3; {wall}; tetrahedra of at most {} mm",
            path.display(),
            measured(self.volume),
            measured(self.size)
        );
        std::iter::once(first).chain(self.notes.iter().map(|note| format!("{}: {note}", path.display()))).collect()
    }
}

impl MeshedPart {
    /// What the mesh holds, row by row: elements, the worst of them, regions, hollow spaces.
    ///
    /// # Errors
    /// A mesh that cannot be read.
    pub fn rows(&self) -> Result<String, Vec<InputError>> {
        let read = msh::read("mesh.msh", &self.bytes);
        let mesh = read.map_err(|errors| errors.into_iter().map(InputError::from).collect::<Vec<_>>())?.mesh;
        let mut text = format!(
            "body      {} nodes, {} elements, {:.6} mm3\n",
            thousands(mesh.num_nodes() as u64),
            thousands(mesh.num_elements() as u64),
            mesh.volume()
        );
        let worst = mesh.scaled_jacobians().fold(f64::INFINITY, f64::min);
        text += &format!("quality   the worst element has the scaled Jacobian {worst:.3} of 1\n");
        for (name, elements) in &mesh.element_sets {
            text += &format!("elements  {name}: {}\n", thousands(elements.len() as u64));
        }
        for (number, hollow) in (1..).zip(mesh.hollows(&[]).map_or_else(|_| Vec::new(), |(found, _)| found)) {
            let mouth =
                hollow.mouth.map_or_else(|| "closed".to_owned(), |mouth| format!("open near {}", place(mouth.centre)));
            let faces = plural(hollow.facets.len(), "face");
            text += &format!("hollow    cavity_{number}: {faces}, {} mm3, {mouth}\n", measured(hollow.volume));
        }
        Ok(text)
    }
}

/// The size of elements: what is asked for, or what follows from the walls, with a note where that would be too many.
fn size_of(
    asked: Option<f64>,
    wall: Option<Wall>,
    diagonal: f64,
    volume: f64,
    notes: &mut Vec<String>,
) -> Result<f64, InputError> {
    if let Some(size) = asked {
        let [least, most] = [1e-3, 1.0].map(|share| share * diagonal);
        if (least..=most).contains(&size) {
            return Ok(size);
        }
        let allowed = format!("must be from {} to {} for this part", measured(least), measured(most));
        return Err(InputError::new(format!("the size of elements, {size} mm, is out of range: {allowed}")));
    }
    let wanted = wall.map_or(f64::INFINITY, |wall| PER_WALL * wall.thickness).min(PER_DIAGONAL * diagonal);
    let least = (volume / (TETRAHEDRON * MOST_ELEMENTS)).cbrt();
    if wanted < least {
        let count = thousands((volume / (TETRAHEDRON * wanted.powi(3))).min(1e15) as u64);
        notes.push(format!(
            "elements of {} mm, as the thinnest wall asks for, would be {count}: they are larger, and walls are of one element; say a size to \
             have others",
            measured(wanted)
        ));
    }
    Ok(wanted.max(least))
}

/// A mesh that Gmsh has made of a part, if it fills that: triangles know the part's volume but for what is round.
fn filled(path: &Path, bytes: Vec<u8>, volume: f64) -> Result<Vec<u8>, Vec<InputError>> {
    let read = msh::read("mesh.msh", &bytes);
    let mesh = read.map_err(|errors| errors.into_iter().map(InputError::from).collect::<Vec<_>>())?.mesh;
    if (mesh.volume() - volume).abs() <= SAME_VOLUME * volume {
        return Ok(bytes);
    }
    let [found, expected] = [mesh.volume(), volume].map(measured);
    let why = format!(
        "Gmsh's mesh of it has {found} mm3, and its surface encloses {expected} mm3: it is not filled as it should be"
    );
    Err(InputError::about_file(path, why)
        .with_help(Some(
            "another size of elements (--size, model.size) may do; or mend the part where it was drawn".into(),
        ))
        .into())
}

/// A CAD file with solids.
fn mesh_solids(path: &Path, bytes: &[u8], size: Option<f64>) -> Result<MeshedPart, Vec<InputError>> {
    let end = path.extension().map_or_else(String::new, |end| end.to_string_lossy().to_ascii_lowercase());
    let gmsh = Gmsh::new(path, &format!("part.{end}"), bytes)?;
    let surfaces = gmsh.run(&Task { what: "surface", size: 0.0, shape: "curved" })?;
    let mut notes: Vec<String> = surfaces
        .said("overlap")
        .map(|name| format!("the solid {name} overlaps another one, which keeps what both have"))
        .collect();
    let (mut wall, mut volume, mut diagonal, mut are_closed) = (None::<Wall>, 0.0, 0.0_f64, true);
    for triangles in gmsh.surfaces() {
        let Ok(read) = surface::read("part.stl", &triangles) else { continue };
        diagonal = diagonal.max(read.diagonal());
        match read.bounded() {
            Ok(bounded) => {
                volume += bounded.volume;
                let own = bounded.surface.thinnest_wall();
                wall = [wall, own].into_iter().flatten().min_by(|a, b| a.thickness.total_cmp(&b.thickness));
            }
            Err(_) => {
                are_closed = false;
                notes.push("the surface of a solid is not closed as triangles: its walls are not measured".into())
            }
        }
    }
    let size = size_of(size, wall, diagonal, volume, &mut notes)?;
    let said = gmsh.run(&Task { what: "volume", size, shape: "curved" })?;
    let solids = said.said("solid").map(str::to_owned).collect();
    // Of solids that overlap both surfaces count.
    let is_known = are_closed && surfaces.said("overlap").next().is_none();
    let bytes = if is_known { filled(path, gmsh.mesh()?, volume)? } else { gmsh.mesh()? };
    Ok(MeshedPart { bytes, solids, wall, volume, size, notes })
}

/// A surface of triangles.
fn mesh_triangles(path: &Path, bytes: &[u8], size: Option<f64>) -> Result<MeshedPart, Vec<InputError>> {
    let read = surface::read(&path.display().to_string(), bytes).map_err(InputError::from)?;
    let about = |why: String| InputError::about_file(path, why);
    let mend = "mend it where it was drawn, and export it as one closed surface, or use its STEP file";
    let bounded = read.bounded().map_err(|faults| {
        let errors = faults.into_iter().map(|fault| about(fault).with_help(Some(mend.into())));
        errors.collect::<Vec<_>>()
    })?;
    let crossings: Vec<[f64; 3]> = bounded.surface.crossings(3);
    if !crossings.is_empty() {
        let places: Vec<String> = crossings.iter().map(|&x| place(x)).collect();
        let why = format!("its triangles pass through each other, e.g. at {}", places.join(", "));
        return Err(about(why).with_help(Some(mend.into())).into());
    }
    let mut notes = Vec::new();
    let wall = bounded.surface.thinnest_wall();
    let size = size_of(size, wall, bounded.surface.diagonal(), bounded.volume, &mut notes)?;
    let gmsh = Gmsh::new(path, "part.stl", &bounded.surface.to_stl())?;
    // Anew between its edges, by smaller elements where those of two sides meet; what cannot be parametrised keeps its triangles.
    let tries = [(size, "straight"), (0.6 * size, "straight"), (size, "as-it-is")];
    let mut failed: Option<InputError> = None;
    let mut done = None;
    for (number, (size, shape)) in tries.into_iter().enumerate() {
        match gmsh.run(&Task { what: "fill", size, shape }) {
            Ok(ran) => {
                done = Some((ran, size, shape));
                break;
            }
            // The first reason is the plain one, unless there is no Gmsh at all.
            Err(error) if number == 0 && error.kind() == InputErrorKind::MissingProgram => return Err(error.into()),
            Err(error) => failed = failed.or(Some(error)),
        }
    }
    let Some((ran, made, shape)) = done else {
        return Err(failed.unwrap_or_else(|| about("cannot be meshed".into())).into());
    };
    if shape == "as-it-is" {
        notes.push("its triangles could not be made anew and are kept as they are, whatever their size".into());
    } else if made < size {
        let text =
            format!("elements of {} mm would cross each other: they are of {} mm", measured(size), measured(made));
        notes.push(text);
    }
    let size = made;
    let solids = ran.said("solid").map(str::to_owned).collect();
    let bytes = filled(path, gmsh.mesh()?, bounded.volume)?;
    Ok(MeshedPart { bytes, solids, wall, volume: bounded.volume, size, notes })
}

/// Whether Gmsh is there: tests that need it are passed over where it is not.
pub fn has_gmsh() -> bool {
    gmsh::is_there()
}
