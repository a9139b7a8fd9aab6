//! The command line.

use std::path::PathBuf;

use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use pneuflex::find::{FORCE, Goal};
use pneuflex::gradient::Request;
use pneuflex::{Change, Error, InputError, MemoryLimit};
use pneuflex_inverse::uncertainty::Tolerance;

use crate::completions::CompletionsArguments;
use crate::examples;
use crate::fit::FitArguments;
use crate::man::ManArguments;
use crate::materials::MaterialsArguments;

/// Finite-element simulator of soft pneumatic actuators.
#[derive(Debug, Parser)]
#[command(name = "pneuflex", version, after_help = EXIT_CODES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "\
Exit codes: 0 done (for run: converged), 1 an output could not be written, 2 bad input, 3 not converged, 130 interrupted.

First steps:
  pneuflex new two-chamber                a case file to start from
  pneuflex check two_chamber.toml         what would be solved
  pneuflex run two_chamber.toml           solve it";

/// The program's commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a case and write its results
    #[command(after_help = examples::RUN)]
    Run(RunArguments),
    /// Check a case and print what would be solved, without solving
    #[command(after_help = examples::CHECK)]
    Check(CheckArguments),
    /// Write a commented case or model file to start from
    #[command(after_help = examples::NEW)]
    New(NewArguments),
    /// Mesh a part from CAD or a surface of triangles
    #[command(after_help = examples::MESH)]
    Mesh(MeshArguments),
    /// Solve a case on finer and finer meshes, extrapolate, and report error bars
    #[command(after_help = examples::CONVERGE)]
    Converge(ConvergeArguments),
    /// Solve many designs, each once whatever dies, and write a table
    #[command(after_help = examples::SWEEP)]
    Sweep(SweepArguments),
    /// Write report.html, which shows a result folder in a browser
    #[command(after_help = examples::VIEW)]
    View(ViewArguments),
    /// Draw a state of a result folder as a picture
    #[command(after_help = examples::PICTURE)]
    Picture(PictureArguments),
    /// Compare results with what you have measured: points, angles, forces
    #[command(after_help = examples::COMPARE)]
    Compare(CompareArguments),
    /// Write results in the formats of other programs: surfaces, animations, arrays, meshes for robot simulators, moulds
    #[command(after_help = examples::EXPORT)]
    Export(ExportArguments),
    /// Find the pressure, or the value of a key, at which a result takes a value
    #[command(after_help = examples::FIND)]
    Find(FindArguments),
    /// Compare derivatives of a result with differences of whole runs
    #[command(after_help = examples::CHECK_GRADIENT)]
    CheckGradient(CheckGradientArguments),
    /// Find the design that comes nearest to targets, or is best within limits
    #[command(after_help = examples::DESIGN)]
    Design(SearchArguments),
    /// Find constants and lengths from measurements, with their confidence intervals
    #[command(after_help = examples::IDENTIFY)]
    Identify(SearchArguments),
    /// Say how far results spread by the tolerances of lengths and constants, and which of these count most
    #[command(after_help = examples::UNCERTAINTY)]
    Uncertainty(UncertaintyArguments),
    /// Print the numbers of results, one row per pressure, several runs side by side
    #[command(after_help = examples::TABLE)]
    Table(TableArguments),
    /// Identify an elastic rod from the case's two-chamber cell and compute its shapes
    #[command(after_help = examples::ROD)]
    Rod(RodArguments),
    /// Fit material constants to the curves of tensile tests
    Fit(Box<FitArguments>),
    /// List known silicones, or print one of them for a case file
    Materials(MaterialsArguments),
    /// Print the completions of a shell
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArguments),
    /// Print the manual page, or write one page per command to a folder
    #[command(after_help = examples::MAN)]
    Man(ManArguments),
}

/// A case file with changes to it.
#[derive(Debug, Args)]
pub struct CaseArguments {
    /// Case file (TOML)
    pub case: PathBuf,
    /// Change a key of the case, e.g. --set actuator.gap=1.5 or --set mesh.element=hex8-q1p0; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// Arguments of `pneuflex check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// The case.
    #[command(flatten)]
    pub case: CaseArguments,
    /// Write a page that shows the body with its cavities, supports, loads, contact, regions and choices in colours; it replaces what is there
    #[arg(long, value_name = "FILE.html")]
    pub picture: Option<PathBuf>,
}

impl CaseArguments {
    /// The changes.
    ///
    /// # Errors
    /// One that is none.
    pub fn changes(&self) -> Result<Vec<Change>, InputError> {
        changes(&self.set)
    }
}

/// The changes of `--set`.
///
/// # Errors
/// One that is none.
pub fn changes(set: &[String]) -> Result<Vec<Change>, InputError> {
    let change = |text: &String| {
        let parts = text.split_once('=').filter(|(key, value)| !key.trim().is_empty() && !value.trim().is_empty());
        let expected = || InputError::new(format!("--set {text}: expected KEY=VALUE, e.g. --set actuator.gap=1.5"));
        parts.map(|(key, value)| Change::new(key, value)).ok_or_else(expected)
    };
    set.iter().map(change).collect()
}

/// With how many threads, and with how many words.
#[derive(Debug, Args)]
pub struct ThreadArguments {
    /// Number of threads, at the most four times the cores [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Leave out everything about progress
    #[arg(long)]
    pub quiet: bool,
}

impl ThreadArguments {
    /// Sets the number of threads, if one is given, for the whole program.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub fn use_threads(&self) -> Result<(), Error> {
        self.threads.map_or(Ok(()), |threads| pneuflex::use_threads(threads.into()))
    }
}

/// How cases are solved.
#[derive(Debug, Args)]
pub struct SolveArguments {
    /// Threads and words.
    #[command(flatten)]
    pub with: ThreadArguments,
    /// Solve even if the estimated memory exceeds what is available
    #[arg(long)]
    pub force: bool,
}

impl SolveArguments {
    /// How much memory may be needed.
    pub fn memory_limit(&self) -> MemoryLimit {
        if self.force { MemoryLimit::None } else { MemoryLimit::Available }
    }
}

/// Arguments of `pneuflex run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// The case.
    #[command(flatten)]
    pub case: CaseArguments,
    /// Output folder [default: out/NAME for the case file NAME.toml]. Results of an earlier run in it are replaced; a folder
    /// that holds anything else is left alone
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with a run of this case that was interrupted or killed, from its last load step; the results are those of a run
    /// that never stopped. Starts from the beginning where there is nothing to go on with
    #[arg(long)]
    pub resume: bool,
    /// Estimate the errors of the last state, as output.error_estimate = true does: by a mesh with every element divided into
    /// eight, which may take longer than the run
    #[arg(long)]
    pub estimate: bool,
    /// Derivatives of a result, e.g. end_face_angle or tip.z, by every length, constant and load of the case, at the last pressure or the one
    /// behind @; may be repeated. They go to gradients.json
    #[arg(long, value_name = "RESULT[@AT]")]
    pub gradient: Vec<Request>,
    /// In addition the derivatives of these results by the position of every node at rest, as fields in shape_gradients.vtu
    #[arg(long, requires = "gradient")]
    pub shape: bool,
    /// Leave out report.html
    #[arg(long)]
    pub no_report: bool,
    /// How it is solved.
    #[command(flatten)]
    pub solve: SolveArguments,
}

/// Arguments of `pneuflex check-gradient`.
#[derive(Debug, Args)]
pub struct CheckGradientArguments {
    /// The case.
    #[command(flatten)]
    pub case: CaseArguments,
    /// The result, as for `pneuflex run --gradient`
    #[arg(long, value_name = "RESULT[@AT]")]
    pub of: Request,
    /// Keys by which it is differentiated, e.g. actuator.gap; may be repeated [default: all]
    #[arg(long, value_name = "KEY")]
    pub by: Vec<String>,
    /// How it is solved.
    #[command(flatten)]
    pub solve: SolveArguments,
}

/// The name of a file for a drawing.
fn picture_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_known = path.extension().is_some_and(|extension| extension == "svg" || extension == "png");
    is_known.then_some(path).ok_or_else(|| "expected a name that ends in .svg or .png".to_owned())
}

/// Arguments of `pneuflex uncertainty`.
#[derive(Debug, Args)]
pub struct UncertaintyArguments {
    /// The case.
    #[command(flatten)]
    pub case: CaseArguments,
    /// A result, as for `pneuflex run --gradient`, at every pressure or the one behind @; may be repeated
    #[arg(long, value_name = "RESULT[@AT]", required = true)]
    pub of: Vec<Request>,
    /// How far a key may be off either way, in its unit or in percent of its value: actuator.top_wall=0.1, material.c10=10%; may be repeated
    #[arg(long, value_name = "KEY=TOLERANCE", required = true)]
    pub tolerance: Vec<Tolerance>,
    /// Solve so many designs within the tolerances, too (a Latin hypercube), to compare with
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub check: u16,
    /// Write all numbers into a file
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Draw for every result what each tolerance contributes, as SVG or PNG by the file's name
    #[arg(long, value_name = "FILE", value_parser = picture_file)]
    pub chart: Option<PathBuf>,
    /// How it is solved.
    #[command(flatten)]
    pub solve: SolveArguments,
}

/// Arguments of `pneuflex identify` and `pneuflex design`.
#[derive(Debug, Args)]
pub struct SearchArguments {
    /// File that says what is looked for (TOML)
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Change a key of all designs; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Folder for history.json, case.toml and what was found [default: out/NAME for the file NAME.toml]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with the search that the folder holds: designs that were solved are not solved again
    #[arg(long)]
    pub resume: bool,
    /// How designs are solved.
    #[command(flatten)]
    pub solve: SolveArguments,
}

/// Arguments of `pneuflex sweep`.
#[derive(Debug, Args)]
pub struct SweepArguments {
    /// File that says which designs are solved (TOML)
    #[arg(value_name = "SWEEP.toml")]
    pub file: PathBuf,
    /// Change a key of all designs; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Folder of the sweep [default: out/NAME for the file NAME.toml]. What is finished in it is kept and not solved again
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of processes, one design each [default: one per core, as far as there is memory]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub workers: Option<u16>,
    /// Number of threads of each process [default: what the processes leave of the cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Solve these designs only, numbers from 0, and write no table: for jobs of a cluster, many of which may run at once
    #[arg(long, value_name = "FIRST[-LAST]", value_parser = numbers)]
    pub only: Option<[usize; 2]>,
    /// Write the table of what is finished, and solve nothing
    #[arg(long, conflicts_with = "only")]
    pub join: bool,
    /// Print a script that solves the designs as jobs of a cluster, and solve nothing
    #[arg(long, value_name = "SCHEDULER", conflicts_with_all = ["only", "join"])]
    pub emit: Option<Scheduler>,
    /// Leave out everything about progress
    #[arg(long)]
    pub quiet: bool,
    /// Be a process that solves what it is told on standard input
    #[arg(long, hide = true)]
    pub worker: bool,
}

/// Schedulers of clusters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Scheduler {
    /// SLURM.
    Slurm,
    /// HyperQueue.
    Hq,
}

/// Two numbers with a comma between them.
fn ends(text: &str) -> Result<[f64; 2], String> {
    let wanted = || "must be two numbers as in 0.8,2".to_owned();
    let (a, b) = text.split_once(',').ok_or_else(wanted)?;
    let number = |text: &str| text.trim().parse().map_err(|_| wanted());
    Ok([number(a)?, number(b)?])
}

/// A number, or the first and the last of several.
fn numbers(text: &str) -> Result<[usize; 2], String> {
    let number = |text: &str| text.trim().parse().map_err(|_| "must be a number, or two as in 10-19".to_owned());
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let found: [usize; 2] = [number(first)?, number(last)?];
    if found[0] <= found[1] { Ok(found) } else { Err("the first is greater than the last".into()) }
}

/// Arguments of `pneuflex view`.
#[derive(Debug, Args)]
pub struct ViewArguments {
    /// Folder that `pneuflex run` wrote
    #[arg(value_name = "RESULT_DIR")]
    pub results: PathBuf,
}

/// Arguments of `pneuflex picture`.
#[derive(Debug, Args)]
pub struct PictureArguments {
    /// Folder that `pneuflex run` wrote
    #[arg(value_name = "RESULT_DIR")]
    pub results: PathBuf,
    /// Pressure in kPa, or time of a model, which must be among the results [default: the last one]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// What the colours mean
    #[arg(long, value_name = "FIELD", value_enum, default_value_t = PictureColours::VonMises)]
    pub colour: PictureColours,
    /// From where
    #[arg(long, value_name = "VIEW", value_enum, default_value_t = PictureView::Iso)]
    pub view: PictureView,
    /// Values at the ends of the colours, e.g. 0,0.2 [default: the least and the largest one; of stresses 0 and what 99 % of the volume stays
    /// below]
    #[arg(long, value_name = "LOW,HIGH", value_parser = ends, allow_hyphen_values = true)]
    pub range: Option<[f64; 2]>,
    /// Width in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 1100, value_parser = clap::value_parser!(u32).range(300..=4000))]
    pub width: u32,
    /// The picture: a file that ends with .png or .svg [default: picture.png in the result folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// What the colours of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PictureColours {
    /// von Mises stress, MPa.
    VonMises,
    /// How far points have moved, mm.
    Displacement,
    /// Pressure of opposite walls and obstacles, MPa.
    Contact,
    /// Nothing.
    None,
}

/// From where a picture is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PictureView {
    /// From outside, the whole body.
    Iso,
    /// Into a half that is cut open at its plane of symmetry.
    Section,
    /// Straight at that plane: lengths along x and z are true.
    Side,
}

/// Arguments of `pneuflex compare`.
#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Folder that `pneuflex run` wrote
    #[arg(value_name = "RESULT_DIR")]
    pub results: PathBuf,
    /// Measurements: a CSV file with the columns pressure_kpa (of a model time), x_mm and z_mm of points, and any columns of `pneuflex table`
    #[arg(value_name = "MEASURED.csv")]
    pub measured: PathBuf,
    /// What points are compared with [default: bottom of an actuator, else outline]
    #[arg(long, value_name = "LINE", value_enum)]
    pub line: Option<CompareLine>,
    /// What is fitted before points are compared, e.g. scale,offset
    #[arg(long, value_name = "WHAT", value_enum, value_delimiter = ',')]
    pub fit: Vec<CompareFit>,
    /// The picture as a file of its own, too, which ends with .png or .svg
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// What measured points are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CompareLine {
    /// The bottom line of an actuator.
    Bottom,
    /// The outline of the body as it is seen along y.
    Outline,
}

/// What is fitted before points are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CompareFit {
    /// A factor of the measured coordinates.
    Scale,
    /// A rotation about the origin.
    Rotation,
    /// A translation.
    Offset,
}

/// Arguments of `pneuflex export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Folder that `pneuflex run` wrote
    #[arg(value_name = "RESULT_DIR")]
    pub results: PathBuf,
    /// What is written
    #[arg(long, value_name = "FORMAT", value_enum)]
    pub to: ExportFormat,
    /// The file, or of png and mould the folder [default: the name of the result folder with the ending of the format, here]
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// stl, obj, glb, csv: the state at this pressure in kPa, or time of a model [default: stl and obj the last one, glb and csv all]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// obj, glb, png, gif, mp4: what the colours mean [default: von-mises]
    #[arg(long, value_name = "FIELD", value_enum)]
    pub colour: Option<PictureColours>,
    /// With --colour: values at the ends of the colours, e.g. 0,0.2 [default: 0 and the largest one of all states; of stresses what 99 % of the
    /// volume stays below]
    #[arg(long, value_name = "LOW,HIGH", value_parser = ends, allow_hyphen_values = true)]
    pub range: Option<[f64; 2]>,
    /// png, gif, mp4: from where [default: iso]
    #[arg(long, value_name = "VIEW", value_enum)]
    pub view: Option<PictureView>,
    /// png, gif, mp4: width in pixels [default: 700]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(300..=4000))]
    pub width: Option<u32>,
    /// png, gif, mp4: number of pictures [default: 40]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub pictures: Option<u32>,
    /// mould: thickness of its walls in mm [default: 5]
    #[arg(long, value_name = "MM")]
    pub wall: Option<f64>,
}

/// A format that results are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// Surface as triangles, for printing.
    Stl,
    /// Surface with groups and colours.
    Obj,
    /// The body in motion: glTF 2.0 with colours and an animation.
    Glb,
    /// Fields at the nodes as a table.
    Csv,
    /// Fields at the nodes as arrays of numpy.
    Npz,
    /// Mesh at rest for SOFA: legacy VTK.
    Vtk,
    /// Mesh at rest for MuJoCo's flex: tetrahedra in Gmsh's format.
    Msh,
    /// A folder of pictures.
    Png,
    /// An animated picture.
    Gif,
    /// A video, by the program ffmpeg.
    Mp4,
    /// What an actuator is cast in: two halves and a core as STL.
    Mould,
}

/// Arguments of `pneuflex find`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("goal").required(true).multiple(false)))]
pub struct FindArguments {
    /// The case.
    #[command(flatten)]
    pub case: CaseArguments,
    /// Bending angle of the end face, degrees
    #[arg(long, value_name = "DEG", group = "goal", allow_negative_numbers = true)]
    pub angle: Option<f64>,
    /// Angle of the chord from the clamp to the tip, degrees
    #[arg(long, value_name = "DEG", group = "goal", allow_negative_numbers = true)]
    pub chord_angle: Option<f64>,
    /// Displacement of the tip along x, mm
    #[arg(long, value_name = "MM", group = "goal", allow_negative_numbers = true)]
    pub tip_x: Option<f64>,
    /// Displacement of the tip along y, mm
    #[arg(long, value_name = "MM", group = "goal", allow_negative_numbers = true)]
    pub tip_y: Option<f64>,
    /// Displacement of the tip along z, mm
    #[arg(long, value_name = "MM", group = "goal", allow_negative_numbers = true)]
    pub tip_z: Option<f64>,
    /// Volume of all cavities, mm3
    #[arg(long, value_name = "MM3", group = "goal")]
    pub volume: Option<f64>,
    /// Force on the obstacle, N
    #[arg(long, value_name = "N", group = "goal")]
    pub force: Option<f64>,
    /// Any column of `pneuflex table`, e.g. --column cavity_1.volume_mm3=900 or, for the length of a vector, --column probe.tip=12
    #[arg(long, value_name = "NAME=VALUE", group = "goal")]
    pub column: Option<String>,
    /// A key whose value is looked for, at the last pressure or time of the case, in place of the pressure
    #[arg(long, value_name = "KEY", requires = "between")]
    pub by: Option<String>,
    /// Values of the key between which it is looked for
    #[arg(long, value_name = "A,B", requires = "by", value_parser = ends, allow_hyphen_values = true)]
    pub between: Option<[f64; 2]>,
    /// Threads and words.
    #[command(flatten)]
    pub threads: ThreadArguments,
}

impl FindArguments {
    /// Column of the table and the value that is wanted in it.
    ///
    /// # Errors
    /// A `--column` that has none, a value that is no finite number.
    pub fn goal(&self) -> Result<Goal, InputError> {
        let named = [
            ("end_face_angle_deg", self.angle),
            ("chord_angle_deg", self.chord_angle),
            ("tip.x_mm", self.tip_x),
            ("tip.y_mm", self.tip_y),
            ("tip.z_mm", self.tip_z),
            ("cavity_volume_mm3", self.volume),
            (FORCE, self.force),
        ];
        let goal = match (named.into_iter().find_map(|(name, value)| Some((name.to_owned(), value?))), &self.column) {
            (Some(goal), _) => Some(goal),
            (None, Some(text)) => text
                .rsplit_once('=')
                .and_then(|(name, value)| Some((name.trim().to_owned(), value.trim().parse().ok()?))),
            (None, None) => None,
        };
        let column = self.column.as_deref().unwrap_or_default();
        let ends = self.between.iter().flatten();
        match goal {
            Some((name, value)) if value.is_finite() && ends.clone().all(|end| end.is_finite()) => {
                Ok(Goal { column: name, value })
            }
            Some(_) => Err(InputError::new("find: a value or an end is no finite number")),
            None => Err(InputError::new(format!(
                "--column {column}: expected NAME=VALUE, e.g. --column end_face_angle_deg=90"
            ))),
        }
    }
}

/// Arguments of `pneuflex table`.
#[derive(Debug, Args)]
pub struct TableArguments {
    /// Folders that `pneuflex run` wrote
    #[arg(value_name = "RESULT_DIR", required = true)]
    pub results: Vec<PathBuf>,
    /// What is printed
    #[arg(long = "as", value_name = "FORM", value_enum, default_value_t = TableForm::Text)]
    pub form: TableForm,
    /// Columns, e.g. end_face_angle_deg,tip: a name stands for everything that begins with it and a full stop, too [default: all; of a text
    /// angles, tip and probes, cavities, forces on obstacles and the 99 % stress; reactions where there is but the stress]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Option<Vec<String>>,
    /// A row for every load step between the pressures or times, too, that was solved to the tolerances; such rows have no stresses
    #[arg(long)]
    pub load_steps: bool,
}

/// Forms of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TableForm {
    /// Aligned columns.
    Text,
    /// Comma-separated values, all digits.
    Csv,
    /// A list of rows, all digits.
    Json,
}

/// Arguments of `pneuflex converge`.
#[derive(Debug, Args)]
pub struct ConvergeArguments {
    /// The case; its mesh is the coarsest
    #[command(flatten)]
    pub case: CaseArguments,
    /// Number of meshes: the body's own, every element divided by 2 along every direction, by 3 and so on; in model files and decks
    /// by 2, 4 and so on. Three are needed to see an order of convergence; start them from a coarse mesh, e.g. with
    /// --set mesh.resolution=draft
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(2..=6))]
    pub levels: u8,
    /// Folder for converge.json and convergence.svg [default: out/NAME-converge for the case file NAME.toml]; what else it holds
    /// is left alone
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How it is solved.
    #[command(flatten)]
    pub solve: SolveArguments,
}

/// Arguments of `pneuflex rod`.
#[derive(Debug, Args)]
pub struct RodArguments {
    /// The case.
    #[command(flatten)]
    pub case: CaseArguments,
    /// Folder for rod.json [default: out/NAME-rod for the case file NAME.toml]; what else it holds is left alone
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Force on the rod's tip, downwards, that keeps its direction
    #[arg(long, value_name = "NEWTON", default_value_t = 0.0, allow_negative_numbers = true)]
    pub tip_load: f64,
    /// Print nothing but the parameters and errors
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `pneuflex new`.
#[derive(Debug, Args)]
pub struct NewArguments {
    /// Which case, or a model around a body of your own
    pub kind: CaseKind,
    /// File to write [default: two_chamber.toml or actuator.toml]; an existing file is not replaced. Of a model: the part, mesh or deck
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// File to write of a model [default: PART.toml]
    #[arg(value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
}

/// Arguments of `pneuflex mesh`.
#[derive(Debug, Args)]
pub struct MeshArguments {
    /// The part: .step, .stp, .iges, .igs, .brep, or a closed surface, .stl, .obj
    pub part: PathBuf,
    /// Largest edge of an element [default: one and a half of the thinnest wall]
    #[arg(long, value_name = "MM")]
    pub size: Option<f64>,
    /// The mesh [default: PART.msh in this folder; an existing file is not replaced]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Cases to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CaseKind {
    /// The two-chamber piece of the paper.
    TwoChamber,
    /// The full actuator of the paper: eight chambers and two flanges.
    Actuator,
    /// A model around a part from CAD, a mesh or a deck.
    Model,
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use super::Arguments;

    /// The command of an example: what stands before a remark, a pipe or a redirection.
    fn words(line: &str) -> Vec<String> {
        let command = line.trim().split("  ").next().unwrap_or("");
        let command = command.split(['|', '>']).next().unwrap_or("");
        let mut words = vec![String::new()];
        let mut is_quoted = false;
        for c in command.trim().chars() {
            match c {
                '\'' => is_quoted = !is_quoted,
                ' ' if !is_quoted => words.push(String::new()),
                other => words.last_mut().unwrap().push(other),
            }
        }
        words
    }

    #[test]
    fn every_command_has_examples_and_the_program_understands_them() {
        Arguments::command().debug_assert();
        for command in Arguments::command().get_subcommands_mut() {
            let help = command.render_long_help().to_string();
            let examples: Vec<&str> = help.lines().filter(|line| line.starts_with("  pneuflex ")).collect();
            assert!(help.contains("Examples:") && !examples.is_empty(), "{help}");
            for example in examples {
                let words = words(example);
                assert_eq!(words[1], command.get_name(), "{example}");
                if let Err(error) = Arguments::try_parse_from(&words) {
                    panic!("{example}: {error}");
                }
            }
        }
    }
}
