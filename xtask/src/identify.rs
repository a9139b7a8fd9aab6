//! `cargo xtask identify`: lengths and constants from the shapes that they give, and how often 95 % intervals cover them where there is noise.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use pneuflex::gradient::Request;
use pneuflex::{Change, Error, MemoryLimit, StopToken, Study};
use pneuflex_inverse::identify::{Identification, Identified};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::program::target_folder;

/// Lengths and a constant, with how far off the search begins.
const LOST: [(&str, f64); 7] = [
    ("actuator.chamber_length", 1.2),
    ("actuator.cavity_length", 0.8),
    ("actuator.gap", 0.8),
    ("actuator.base", 1.2),
    ("actuator.side_wall", 1.2),
    ("actuator.top_wall", 0.8),
    ("material.c10", 1.2),
];

/// Largest errors of what is found again: degrees, a share of every value; solutions at the most.
const BOUNDS: (f64, f64, usize) = (0.1, 0.01, 15);

/// Shares of 95 % intervals that cover the truth.
const COVERED: [f64; 2] = [0.9, 0.99];

/// Standard deviation of the noise, as a share of the root mean square of a column.
const NOISE: f64 = 0.01;

/// What has to be found again.
struct Truth {
    study: Study,
    case: PathBuf,
    set: Vec<(&'static str, &'static str)>,
    pressures: Vec<f64>,
    columns: Vec<String>,
    /// Values, a row for each pressure.
    rows: Vec<Vec<f64>>,
}

impl Truth {
    fn of(
        case: &Path,
        set: &[(&'static str, &'static str)],
        pressures: &[f64],
        columns: Vec<String>,
    ) -> Result<Self, Error> {
        let mut changes: Vec<Change> = set.iter().map(|(key, value)| Change::new(*key, *value)).collect();
        changes.push(Change::new("load.pressure_kpa", format!("{pressures:?}")));
        let study = Study::load_with(case, changes)?;
        let analysis = study.build()?;
        let solution = analysis.solve()?;
        let request = |at: f64| columns.iter().map(move |column| Request { column: column.clone(), at: Some(at) });
        let requests: Vec<Request> = pressures.iter().flat_map(|at| request(*at)).collect();
        let values: Vec<f64> =
            analysis.gradients(&solution.fields, &requests, Some(&[]))?.iter().map(|found| found.value).collect();
        let rows = values.chunks(columns.len()).map(<[f64]>::to_vec).collect();
        let case = case.canonicalize().unwrap_or_else(|_| case.to_owned());
        Ok(Self { study, case, set: set.to_vec(), pressures: pressures.to_vec(), columns, rows })
    }

    fn number(&self, key: &str) -> Result<f64, Error> {
        self.study.build()?.number(key)
    }

    /// Identifies variables with bounds and starts from the rows with an error added to each of them, in a folder.
    fn identify(
        &self,
        folder: &Path,
        variables: &[(String, f64, [f64; 2])],
        mut error: impl FnMut(usize) -> f64,
    ) -> Result<Identified, Error> {
        let mut data = format!("pressure_kpa,{}\n", self.columns.join(","));
        for (at, row) in self.pressures.iter().zip(&self.rows) {
            let cells: Vec<String> =
                row.iter().enumerate().map(|(column, value)| (value + error(column)).to_string()).collect();
            // Writing to a string cannot fail.
            let _ = writeln!(data, "{at},{}", cells.join(","));
        }
        let mut text = format!("case = {:?}\ndata = \"data.csv\"\n[set]\n", self.case.display().to_string());
        for (key, value) in &self.set {
            let value = if value.parse::<toml::Value>().is_ok() { (*value).to_owned() } else { format!("{value:?}") };
            let _ = writeln!(text, "{key:?} = {value}");
        }
        text += "[variables]\n";
        for (key, start, [from, to]) in variables {
            let _ = writeln!(text, "{key:?} = {{ start = {start:?}, from = {from:?}, to = {to:?} }}");
        }
        let write = || fs::create_dir_all(folder).and_then(|()| fs::write(folder.join("data.csv"), data));
        let written = write().and_then(|()| fs::write(folder.join("identify.toml"), text));
        written.map_err(|error| pneuflex::InputError::about_file(folder, error))?;
        let file = folder.join("identify.toml");
        let identification = Identification::load(&file, &[], MemoryLimit::Available, &StopToken::new())?;
        identification.run((&folder.join("out"), false), &mut |_| ())
    }

    /// Root mean square of a column.
    fn size(&self, column: usize) -> f64 {
        let squares: f64 = self.rows.iter().map(|row| row[column] * row[column]).sum();
        (squares / self.rows.len() as f64).sqrt()
    }
}

/// Prints both tables; fails where a value is not found again, or intervals cover too seldom or too often.
pub fn run(arguments: &[String]) -> ExitCode {
    let (mut draws, mut only) = (100, None);
    let mut options = arguments.chunks(2);
    let is_understood = options.all(|option| match option {
        [name, number] if name == "--draws" => number.parse().map(|number| draws = number).is_ok(),
        [name, table] if name == "--only" => {
            only = ["recovery", "coverage"].into_iter().find(|known| known == table);
            only.is_some()
        }
        _ => false,
    });
    if !is_understood {
        eprintln!("identify: expected [--draws N] [--only recovery|coverage]");
        return ExitCode::from(2);
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = target_folder(&root).join("identify");
    let tables = || -> Result<bool, Error> {
        let is_recovered = only == Some("coverage") || recovery(&root, &folder)?;
        let is_covered = only == Some("recovery") || coverage(&root, &folder, draws)?;
        Ok(is_recovered && is_covered)
    };
    match tables() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(4),
        Err(error) => {
            eprintln!("identify: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Three chambers of the actuator: six lengths and c10 from points of the centreline at five pressures.
fn recovery(root: &Path, folder: &Path) -> Result<bool, Error> {
    let set = [("actuator.chambers", "3"), ("probe", "[]"), ("mesh.resolution", "draft")];
    let points = (1..=10).flat_map(|share| ["x", "z"].map(|axis| format!("centreline[{}%].{axis}_mm", 10 * share)));
    let pressures = [10.0, 20.0, 30.0, 40.0, 50.0];
    let truth = Truth::of(&root.join("fixtures/actuator.toml"), &set, &pressures, points.collect())?;
    let mut variables = Vec::new();
    for (key, off) in LOST {
        let value = truth.number(key)?;
        variables.push((key.to_owned(), off * value, [0.5 * value, 2.0 * value]));
    }
    let began = std::time::Instant::now();
    let found = truth.identify(&folder.join("recovery"), &variables, |_| 0.0)?;
    println!("six lengths and c10 from ten points of the centreline at five pressures ({:?}):", found.why);
    let mut worst = 0.0_f64;
    for (found, (key, off)) in found.values.iter().zip(LOST) {
        let exact = truth.number(key)?;
        let error = (found.value - exact).abs() / exact;
        worst = worst.max(error);
        println!("  {key:<26} {exact:>8} from {:>8.4}: {:>12.8}, off by {error:.1e}", off * exact, found.value);
    }
    let mut again = truth.study.clone();
    again.set_all(found.values.iter().map(|value| Change::new(value.name.clone(), format!("{:?}", value.value))))?;
    let angles = |study: &Study| -> Result<Vec<f64>, Error> {
        Ok(study.solve()?.states.iter().filter_map(|state| state.end_face_angle_deg).collect())
    };
    let angle = angles(&again)?.iter().zip(angles(&truth.study)?).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    println!(
        "  {} solutions in {:.0} s; angles off by at most {angle:.1e} degrees",
        found.solutions,
        began.elapsed().as_secs_f64()
    );
    let (degrees, share, most) = BOUNDS;
    Ok(angle <= degrees && worst <= share && found.solutions <= most)
}

/// Two chambers: a constant and two lengths from angle and tip at five pressures with noise; on a coarse mesh, as what is asked is no question of meshes.
fn coverage(root: &Path, folder: &Path, draws: usize) -> Result<bool, Error> {
    let keys = ["material.c10", "actuator.top_wall", "actuator.gap"];
    let columns = ["end_face_angle_deg", "tip.x_mm", "tip.z_mm"].map(str::to_owned).to_vec();
    let set = [("mesh.size", "3"), ("mesh.element", "hex8-q1p0")];
    let truth = Truth::of(&root.join("fixtures/two_chamber.toml"), &set, &[5.0, 15.0, 25.0, 35.0, 50.0], columns)?;
    let exact = keys.iter().map(|key| truth.number(key)).collect::<Result<Vec<_>, _>>()?;
    let variables: Vec<_> = keys
        .iter()
        .zip(&exact)
        .map(|(key, value)| ((*key).to_owned(), 1.05 * value, [0.2 * value, 5.0 * value]))
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    // Normal, by Box and Muller.
    let mut normal = || {
        let [a, b]: [f64; 2] = [random.random(), random.random()];
        (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    };
    let (mut covered, mut solutions) = (vec![0_usize; keys.len()], 0);
    for draw in 0..draws {
        let found =
            truth.identify(&folder.join("coverage"), &variables, |column| NOISE * truth.size(column) * normal())?;
        solutions += found.solutions;
        for (number, value) in found.values.iter().enumerate() {
            let is_covered = value.half_width.is_some_and(|width| (value.value - exact[number]).abs() <= width);
            covered[number] += usize::from(is_covered);
            if draw == 0 {
                println!("{:<20} {} ± {:.2?} ({:?})", value.name, value.value, value.half_width, found.why);
            }
        }
    }
    let shares: Vec<f64> = covered.iter().map(|count| *count as f64 / draws.max(1) as f64).collect();
    println!(
        "with {NOISE} noise, {draws} draws, {solutions} solutions: 95 % intervals of {keys:?} cover the truth in shares of {shares:?}"
    );
    Ok(draws == 0 || shares.iter().all(|share| (COVERED[0]..=COVERED[1]).contains(share)))
}
