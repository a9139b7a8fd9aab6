//! Results of a folder in the formats of other programs.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use pneuflex_export::gltf::{Moment, Scene, Thing};
use pneuflex_export::linear_mesh::LinearMesh;
use pneuflex_export::mould::Mould;
use pneuflex_export::paint::Paint;
use pneuflex_export::surface::Surface;
use pneuflex_export::{ExportError, gif, gltf, nodes, npz, obj, stl};
use pneuflex_mesh::vector::Vec3;
use pneuflex_model::{LoadParameter, Problem};
use pneuflex_plot::picture::obstacle_surface;
use pneuflex_report::state::State;

use crate::error::{Error, ResultsError};
use crate::ffmpeg::Ffmpeg;
use crate::film::{Film, range_of_all, seconds};
use crate::input_error::InputError;
use crate::picture::{FieldsOfRun, Look, field};
use crate::report_page::{RecordedRun, read_summary};
use crate::study::Study;

/// What is written.
#[derive(Clone, Debug, PartialEq)]
pub enum Format {
    /// The surface at a pressure, kPa, or a time; `None` for the last state.
    Stl(Option<f64>),
    /// The same with groups and, for a field, colours. View and width of the look are not used.
    Obj(Look),
    /// The body in motion; a look with a state stands still. View and width are not used.
    Glb(Look),
    /// Fields at the nodes of a state, or of all.
    Csv(Option<f64>),
    /// Everything as arrays.
    Npz,
    /// The mesh at rest for SOFA.
    Vtk,
    /// The mesh at rest for MuJoCo.
    Msh,
    /// A film: a folder of pictures, or one file.
    Film {
        /// How the pictures look.
        look: Look,
        /// How many there are.
        pictures: usize,
        /// What they are written as.
        reel: Reel,
    },
    /// The mould of an actuator, with walls of a thickness, mm.
    Mould(f64),
}

/// What a film is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reel {
    /// A folder of PNG files.
    Png,
    /// An animated GIF.
    Gif,
    /// A video, made by the program `ffmpeg`.
    Mp4,
}

/// Writes results of a folder to a file, or into a folder of their own; returns the files.
///
/// # Errors
/// [`Error::Input`]: a folder that is none of this program's, files that are missing or damaged, results without fields, a pressure or time that
/// is not among them, a mould of another body than an actuator, a folder that holds something already, no `ffmpeg`. [`Error::Results`]: a
/// file that cannot be written.
pub fn export(folder: &Path, format: &Format, out: &Path) -> Result<Vec<PathBuf>, Error> {
    let cannot = |e: ExportError| InputError::about_file(folder, e);
    let one = |bytes: Vec<u8>| write(out.to_owned(), bytes).map(|file| vec![file]);
    match format {
        Format::Stl(at) => {
            let (run, surface) = surface_of(folder)?;
            let positions = surface.positions(Some(&run.states[run.place_of(*at)?].displacement));
            one(stl::write(&positions, &surface.triangles).map_err(cannot)?)
        }
        Format::Obj(look) => {
            let (run, surface) = surface_of(folder)?;
            let place = run.place_of(look.at)?;
            let state = &run.states[place];
            let (values, label) = field(state, look.colours);
            let values = values.map(|values| surface.values(&values));
            let range = look.range.or_else(|| run.stress_range(look.colours, place..place + 1));
            let most = values.iter().flatten().copied().fold(0.0, f64::max);
            let paint = Paint { label: label.into(), range: range.unwrap_or([0.0, most]) };
            let positions = surface.positions(Some(&state.displacement));
            one(obj::write(&surface, &positions, values.as_deref().map(|values| (&paint, values))).into_bytes())
        }
        Format::Glb(look) => one(animated(folder, look)?),
        Format::Csv(at) => {
            let run = FieldsOfRun::read(folder)?;
            let states: Vec<&State> = match at {
                Some(_) => vec![&run.states[run.place_of(*at)?]],
                None => run.states.iter().collect(),
            };
            one(nodes::csv(&run.analysis.problem, &states).into_bytes())
        }
        Format::Npz => {
            let run = FieldsOfRun::read(folder)?;
            one(npz::write(&run.analysis.problem, &run.states.iter().collect::<Vec<_>>()).map_err(cannot)?)
        }
        Format::Vtk | Format::Msh => {
            let problem = RecordedRun::read(folder)?.analysis.problem;
            let is_vtk = *format == Format::Vtk;
            let mesh = LinearMesh::new(&problem, is_vtk).map_err(cannot)?;
            one(if is_vtk { mesh.vtk() } else { mesh.msh() }.into_bytes())
        }
        Format::Film { look, pictures, reel: Reel::Png } => {
            let film = Film::of(folder, look)?;
            let into = new_folder(out)?;
            let width = pictures.to_string().len().max(3);
            let named = film.pictures(*pictures).enumerate().map(|(number, drawing)| {
                let bytes = drawing?.to_png(1.0).map_err(|e| InputError::about_file(folder, e))?;
                write(into.join(format!("picture_{:0width$}.png", number + 1)), bytes)
            });
            named.collect()
        }
        Format::Film { look, pictures, reel: Reel::Gif } => {
            let film = Film::of(folder, look)?;
            let all = film
                .pictures(*pictures)
                .map(|drawing| picture(folder, &drawing?))
                .collect::<Result<Vec<_>, Error>>()?;
            // The last one stays a while before it begins again.
            let delay = (100.0 * film.length() / all.len().max(1) as f64).round().clamp(2.0, 6000.0) as u16;
            let mut delays = vec![delay; all.len()];
            delays.last_mut().into_iter().for_each(|last| *last = (*last).max(100));
            one(gif::write(&all, &delays).map_err(cannot)?)
        }
        Format::Film { look, pictures, reel: Reel::Mp4 } => {
            Ffmpeg::is_there()?;
            let film = Film::of(folder, look)?;
            let rate = *pictures as f64 / film.length();
            let mut video: Option<Ffmpeg> = None;
            for drawing in film.pictures(*pictures) {
                let gif::Picture { width, height, rgb } = picture(folder, &drawing?)?;
                let running = match video.take() {
                    Some(running) => running,
                    None => Ffmpeg::begin([width, height], rate, out)?,
                };
                video = Some(running.add(&rgb)?);
            }
            video.map_or(Ok(()), Ffmpeg::end)?;
            Ok(vec![out.to_owned()])
        }
        Format::Mould(wall) => {
            read_summary(folder)?;
            let study = Study::load(folder.join("case.toml"))?;
            let of_case = study.case().map(|case| &case.actuator);
            let actuator =
                of_case.or_else(|| study.model().and_then(|model| model.actuator.as_ref())).ok_or_else(|| {
                    let what =
                        "a mould is for a body that is described by its lengths ([actuator]); this one is a mesh";
                    InputError::about_file(folder, what)
                })?;
            let Mould { halves: [left, right], core } = Mould::new(actuator, *wall).map_err(cannot)?;
            let into = new_folder(out)?;
            let pieces = [("half-left.stl", left), ("half-right.stl", right), ("core.stl", core)];
            let written = pieces.into_iter().map(|(name, piece)| {
                write(into.join(name), stl::write(&piece.corners, &piece.triangles).map_err(cannot)?)
            });
            written.collect()
        }
    }
}

fn surface_of(folder: &Path) -> Result<(FieldsOfRun, Surface), Error> {
    let run = FieldsOfRun::read(folder)?;
    let surface = Surface::new(&run.analysis.problem);
    Ok((run, surface))
}

fn picture(folder: &Path, drawing: &pneuflex_plot::drawing::Drawing) -> Result<gif::Picture, Error> {
    let (width, height, rgb) = drawing.pixels().map_err(|e| InputError::about_file(folder, e))?;
    Ok(gif::Picture { width, height, rgb })
}

/// The bytes of a glTF file.
fn animated(folder: &Path, look: &Look) -> Result<Vec<u8>, Error> {
    let (run, surface) = surface_of(folder)?;
    let problem = &run.analysis.problem;
    let chosen = look.at.map(|at| run.place_of(Some(at))).transpose()?;
    let range = match chosen {
        Some(place) => look.range.or_else(|| run.stress_range(look.colours, place..place + 1)),
        None => None,
    };
    let (has_field, label) = {
        let (values, label) = field(&run.states[0], look.colours);
        (values.is_some(), label)
    };
    let range = range.or_else(|| range_of_all(&run, look)).unwrap_or([0.0, 1.0]);
    let paint = has_field.then(|| Paint { label: label.into(), range });
    let moment = |state: &State, seconds: f64| Moment {
        name: format!("at {}", run.when(state.time)),
        seconds,
        displacement: Some(state.displacement.clone()),
        values: field(state, look.colours).0.unwrap_or_default(),
    };
    let (moments, times): (Vec<Moment>, Vec<f64>) = match chosen {
        Some(place) => (vec![moment(&run.states[place], 0.0)], vec![run.states[place].time]),
        None => {
            let values = vec![0.0; problem.mesh.num_nodes()];
            let rest = Moment { name: "at rest".into(), seconds: 0.0, displacement: None, values };
            let seconds = seconds(&run.states);
            let later = run.states.iter().zip(&seconds[1..]).map(|(state, seconds)| moment(state, *seconds));
            let times = run.states.iter().map(|state| state.time);
            (std::iter::once(rest).chain(later).collect(), std::iter::once(0.0).chain(times).collect())
        }
    };
    let around: Vec<Vec3> =
        moments.iter().flat_map(|moment| surface.positions(moment.displacement.as_deref())).collect();
    let things = things(problem, &times, &around);
    let title = &run.analysis.title;
    let scene = Scene { title, surface: &surface, moments: &moments, paint: paint.as_ref(), things: &things };
    Ok(gltf::write(&scene).map_err(|e| InputError::about_file(folder, e))?)
}

/// The obstacles at some positions on the load path beside a body that fills what lies around points, and their mirror images.
fn things(problem: &Problem, times: &[f64], around: &[Vec3]) -> Vec<Thing> {
    let first = LoadParameter(times.first().copied().unwrap_or_default());
    let mut things = Vec::new();
    for obstacle in &problem.obstacles {
        let surface = obstacle_surface(obstacle, first, around);
        let is_another =
            |image: &pneuflex_model::Image| image.planes().iter().all(|plane| !plane.is_symmetry_of(obstacle));
        for image in problem.images().into_iter().filter(is_another).filter(|_| !surface.triangles.is_empty()) {
            let start = obstacle.offset(first);
            let offset = |time: &f64| {
                let now = obstacle.offset(LoadParameter(*time));
                image.vector(std::array::from_fn(|d| now[d] - start[d]))
            };
            let turned = |&[a, b, c]: &[u32; 3]| if image.is_turned() { [a, c, b] } else { [a, b, c] };
            things.push(Thing {
                name: obstacle.name.clone(),
                corners: surface.corners.iter().map(|[at, normal]| [image.point(*at), image.vector(*normal)]).collect(),
                triangles: surface.triangles.iter().map(turned).collect(),
                offsets: times.iter().map(offset).collect(),
            });
        }
    }
    things
}

/// A folder with nothing in it: what is there of an earlier export would be taken for a part of this one.
fn new_folder(path: &Path) -> Result<&Path, Error> {
    let not_writable = |source: io::Error| ResultsError::NotWritable { file: path.to_owned(), source };
    fs::create_dir_all(path).map_err(not_writable)?;
    if fs::read_dir(path).map_err(not_writable)?.next().is_some() {
        let help = Some("remove it, or name another one with --out".to_owned());
        return Err(InputError::about_file(path, "this folder holds something already").with_help(help).into());
    }
    Ok(path)
}

fn write(file: PathBuf, bytes: Vec<u8>) -> Result<PathBuf, Error> {
    match fs::write(&file, bytes) {
        Ok(()) => Ok(file),
        Err(source) => Err(ResultsError::NotWritable { file, source }.into()),
    }
}
