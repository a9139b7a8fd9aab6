//! Finite-element simulation of soft pneumatic actuators: large rotations, hyperelastic silicones, air pressure that follows the walls,
//! contact between chambers, with themselves and with rigid obstacles.
//!
//! A [`Study`] is a case file, a model file or an input deck whose keys can be changed; [`Study::build`] meshes it and makes an
//! [`Analysis`] of it, a boundary-value problem that is ready to be solved. A [`Body`] becomes an analysis without any file. A [`Run`]
//! follows the quasi-static equilibrium path of an analysis from rest through the requested pressures or times and ends with a
//! [`Solution`] or an [`Error`] that says what was reached and why it ended there.
//!
//! Units are mm, N, MPa and mJ; pressures in files and summaries are in kPa, angles in degrees.
//!
//! # Solve a case and read the angle
//!
//! ```
//! let mut study = pneuflex::Study::from_text("finger.toml", &pneuflex::template::two_chambers())?;
//! study.set("mesh.resolution", "draft")?.set("actuator.gap", "1.5")?.set("load.pressure_kpa", "[1, 3]")?;
//! study.set("mesh.size", "3")?.set("mesh.element", "hex8-q1p0")?; // coarse, to be quick
//! let solution = study.solve()?;
//!
//! let last = solution.states.last().ok_or("no pressure was asked for")?;
//! let angle = last.end_face_angle_deg.ok_or("the body has no end face")?;
//! println!("turned by {angle:.2} degrees at {} kPa", last.pressure_kpa);
//! assert!(angle > 1.0 && angle < 10.0, "{angle}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Build a body from nodes and cells and pressurise it
//!
//! ```
//! use pneuflex::model::{Formulation, Law, Material};
//!
//! // A plate of 4 x 1 hexahedra, 8 mm x 2 mm x 1 mm.
//! let at = |i: usize, j: usize, k: usize| (2 * (2 * i + j) + k) as u32;
//! let nodes = (0..20).map(|n| [2.0 * (n / 4) as f64, 2.0 * (n / 2 % 2) as f64, (n % 2) as f64]).collect();
//! let cells: Vec<[u32; 8]> = (0..4)
//!     .map(|i| {
//!         let face = |k| [at(i, 0, k), at(i + 1, 0, k), at(i + 1, 1, k), at(i, 1, k)];
//!         let ([a, b, c, d], [e, f, g, h]) = (face(0), face(1));
//!         [a, b, c, d, e, f, g, h]
//!     })
//!     .collect();
//!
//! let mut plate = pneuflex::Body::new(Formulation::Hex8Q1p0, nodes, &cells)?;
//! plate
//!     .material(Material::from(Law::NeoHooke { c10: 0.1 }))
//!     .name_nodes("clamp", |[x, _, _]| x == 0.0)
//!     .name_faces("bottom", |[_, _, z]| z == 0.0)
//!     .hold("clamp", "xyz")
//!     .pressure("bottom", 0.5) // kPa
//!     .probe("tip", [8.0, 0.0, 0.0])
//!     .times([1.0]);
//! let solution = plate.analysis()?.solve()?;
//!
//! let [_, _, up] = solution.states[0].probes["tip"];
//! assert!(up > 0.1, "{up}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Follow every state with an observer
//!
//! ```
//! use pneuflex::{Error, Event, StopToken, Study};
//!
//! let mut study = Study::from_text("finger.toml", &pneuflex::template::two_chambers())?;
//! study.set("mesh.size", "3")?.set("mesh.element", "hex8-q1p0")?.set("load.pressure_kpa", "[1, 2, 50]")?;
//! let analysis = study.build()?;
//!
//! let enough = StopToken::new();
//! let mut curve = Vec::new();
//! let ended = analysis
//!     .run()
//!     .stop(&enough)
//!     .observer(|event| {
//!         if let Event::State(state) = event {
//!             curve.push((state.summary.pressure_kpa, state.summary.cavity_volume_mm3));
//!             if curve.len() == 2 {
//!                 enough.stop(); // nobody needs the rest
//!             }
//!         }
//!     })
//!     .solve();
//!
//! assert!(matches!(ended, Err(Error::Interrupted(_))));
//! assert!(curve.len() == 2 && curve[1].1 > curve[0].1, "{curve:?}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A run is recorded into a folder by [`Run::record`] and gone on with by [`Run::resume`]; [`Run::observe_with`] takes observers of one's
//! own.
//!
//! # Map of the crates
//!
//! | crate | what it is responsible for |
//! |---|---|
//! | [`mesh`] | element families, shape functions, quadrature, the parametric actuator and its named sets |
//! | [`model`] | the tables of case and model files, and the boundary-value problem, as plain data |
//! | [`deck`] | input decks of Abaqus, CalculiX and FEBio, meshes |
//! | [`newton`] | Newton's method with mixed linearisation, load stepping, checkpoints |
//! | [`post`] | stresses, angles, volumes, penetration, VTK files |
//! | [`report`] | the page that shows a result folder in a browser |
//! | [`rod`] | the elastica baseline, identified from a two-chamber cell |
//! | [`calibration`] | material constants from test curves, published silicones |
//! | `pneuflex-cli` | the command line: arguments, progress, messages, exit codes |
//!
//! Below [`newton`] are `assembly` (element, pressure and contact terms), `contact`, `factor` (the sparse direct solver), `material` and a
//! crate per material law. In this crate:
//!
//! | module | what is there |
//! |---|---|
//! | [`study`], [`body`], [`analysis`] | what is to be solved: from files, from memory, built |
//! | [`run`], [`start`], [`neighbour`], [`observer`] | following the path, from rest or from an earlier run, by itself or with guesses from a similar design |
//! | [`error`], [`input_error`], [`reason`], [`diagnosis`], [`advice`], [`vocabulary`] | what went wrong, where, why, and what to try in terms of the file |
//! | [`accuracy`] | how exact the results on a mesh are |
//! | [`overview`], [`memory`] | what would be solved, and what that needs |
//! | [`cad`], [`start_model`] | parts as meshes; model files to start from |
//! | [`columns`], [`find`] | the numbers of a state as a row; where on the path, or at which value of a key, one of them takes a value |
//! | [`compare`], [`number_table`] | results beside measurements; tables of numbers that people write |
//! | [`export`] | results in the formats of other programs |
//! | [`gradient`] | exact derivatives of results by the numbers of a file, and what tests them |
//! | [`folder`], [`recorder`], [`recorded_states`], [`checkpoint_file`], [`report_page`], [`picture`] | result folders |
//! | [`setup_page`] | a picture of what would be solved |
//! | [`convergence`], [`error_estimate`], [`quantities`] | sequences of meshes, what a finer mesh would change, and in which numbers |
//! | [`document`] | case and model files as texts with places |

pub mod accuracy;
pub mod advice;
pub mod analysis;
pub mod body;
mod body_file;
pub mod cad;
mod caution;
pub mod checkpoint_file;
pub mod columns;
pub mod compare;
pub mod convergence;
#[cfg(test)]
mod deaths;
mod derived;
pub mod diagnosis;
mod disk;
pub mod document;
pub mod error;
pub mod error_estimate;
pub mod export;
pub mod export_request;
mod ffmpeg;
mod files;
mod film;
pub mod find;
pub mod folder;
mod foreign;
pub mod gradient;
mod held_in_obstacle;
mod holding;
pub mod input_error;
pub mod json;
mod late_recording;
pub mod memory;
pub mod neighbour;
pub mod number_table;
pub mod observer;
mod on_the_way;
pub mod overview;
mod pairs;
pub mod picture;
pub mod quantities;
pub mod reason;
mod recorded_mesh;
pub mod recorded_states;
pub mod recorder;
mod refusals;
pub mod report_page;
pub mod run;
pub mod setup_page;
pub mod solution;
pub mod start;
pub mod start_model;
mod store;
pub mod study;
pub mod template;
pub mod vocabulary;
pub mod words;

pub use pneuflex_calibration as calibration;
pub use pneuflex_deck as deck;
pub use pneuflex_mesh as mesh;
pub use pneuflex_model as model;
pub use pneuflex_newton as newton;
pub use pneuflex_plot as plot;
pub use pneuflex_post as post;
pub use pneuflex_report as report;
pub use pneuflex_rod as rod;

pub use analysis::Analysis;
pub use body::Body;
pub use document::{CaseFile, Change};
pub use error::{Error, ResultsError, Unfinished};
pub use folder::OutputFolder;
pub use input_error::{InputError, InputErrorKind};
pub use memory::{Estimate, MemoryLimit};
pub use neighbour::Neighbour;
pub use observer::{End, Event, Observer, ReachedState, StopToken};
pub use overview::Overview;
pub use pairs::Pairs;
pub use run::Run;
pub use solution::{Solution, Status};
pub use start::Start;
pub use store::input_file;
pub use study::Study;

/// Sets the number of threads for the whole program, once, before anything is read or solved. [`Run::threads`] sets it for a single run.
///
/// # Errors
/// [`Error::Input`] for more than four times as many as there are cores; [`Error::Threads`] if they cannot be started, or were set before.
pub fn use_threads(threads: usize) -> Result<(), Error> {
    check_threads(threads)?;
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    built.map_err(|source| Error::Threads { threads, source })
}

/// Does some work on threads of its own, which end with it; on all of the machine's if nothing is said. Programs that are forked, and those
/// that do several things at once, have a use for this in place of [`use_threads`].
///
/// # Errors
/// As there, and those of the work.
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> Result<T, Error> + Send) -> Result<T, Error> {
    // 0 is the number of cores, or what `RAYON_NUM_THREADS` says.
    let number = threads.unwrap_or(0);
    check_threads(number)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number).build();
    pool.map_err(|source| Error::Threads { threads: number, source })?.install(work)
}

/// Threads beyond the cores only wait for each other: a number far beyond them is a slip.
fn check_threads(threads: usize) -> Result<(), InputError> {
    const PER_CORE: usize = 4;
    let Ok(cores) = std::thread::available_parallelism() else { return Ok(()) };
    let most = PER_CORE * cores.get();
    if threads <= most {
        return Ok(());
    }
    let help = format!("leave it out to use all {cores} cores");
    Err(InputError::new(format!("{threads} threads are too many: at the most {most}, four times the {cores} cores"))
        .of_kind(InputErrorKind::TooManyThreads)
        .with_help(Some(help)))
}
