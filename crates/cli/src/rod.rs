//! `pneuflex rod`: the elastica baseline of a case's actuator, identified from its two-chamber cell.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::PathBuf;

use pneuflex::model::Case;
use pneuflex::rod::cell;
use pneuflex::rod::elastica::Load;
use pneuflex::rod::identify::FitError;
use pneuflex::rod::{Identified, Law, Rod, Samples, identify};
use pneuflex::{CaseFile, Estimate, InputError, MemoryLimit, OutputFolder, json};
use serde::Serialize;

use crate::args::RodArguments;
use crate::error::CliError;
use crate::outcome::Outcome;
use crate::terminal::say;

/// Intervals of the rod: far more than its shape needs.
const INTERVALS: usize = 164;

/// `rod.json`. Its keys are a contract: later versions add to them.
#[derive(Debug, Serialize)]
struct RodFile<'a> {
    program: &'static str,
    version: &'static str,
    title: &'a str,
    /// What the rod is, and what it is not.
    model: &'static str,
    length_mm: f64,
    /// Pressures of the identification, kPa.
    identified_up_to_kpa: f64,
    parameters: Parameters,
    fit: Fit,
    /// Largest change in length of the cell's bottom, as a share: the rod is inextensible.
    cell_stretch: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<String>,
    samples: Samples,
    tip_load_n: f64,
    shapes: Vec<ShapeAt>,
}

const MODEL: &str = "planar inextensible elastica, m = D(p) (k - k0(p)) + Dc min(k - kc(p), 0), k0 = a1 p + a2 p^2, \
                     D = D0 + D1 p; a baseline in the spirit of de Payrebrune & O'Reilly, not their model";

/// The five parameters and the curvature at first contact, pressures in kPa.
#[derive(Debug, Serialize)]
struct Parameters {
    a1_per_mm_kpa: f64,
    a2_per_mm_kpa2: f64,
    d0_n_mm2: f64,
    d1_n_mm2_per_kpa: f64,
    contact_n_mm2: f64,
    /// Whether the samples determined the contact stiffness; it is 0 otherwise.
    contact_is_determined: bool,
    touch_per_mm: f64,
    touch_per_mm_kpa: f64,
}

#[derive(Debug, Serialize)]
struct Fit {
    intrinsic_curvature_per_mm: FitError,
    stiffness_n_mm2: FitError,
    #[serde(skip_serializing_if = "Option::is_none")]
    touch_per_mm: Option<FitError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_moment_n_mm: Option<FitError>,
}

/// The rod at one pressure, with all five parameters and with the fifth left out.
#[derive(Debug, Serialize)]
struct ShapeAt {
    pressure_kpa: f64,
    #[serde(flatten)]
    shape: Line,
    without_contact: Line,
}

#[derive(Debug, Serialize)]
struct Line {
    curvature_at_clamp_per_mm: f64,
    tip_angle_deg: f64,
    /// x and z, mm, from the clamp to the tip.
    centreline: Vec<[f64; 2]>,
}

/// Identifies the rod, prints its parameters and writes `rod.json`.
///
/// # Errors
/// Bad input, found before anything is solved or written; a result that cannot be written.
pub fn rod(arguments: &RodArguments) -> Result<Outcome, CliError> {
    let file = CaseFile::load(&arguments.case.case, &arguments.case.changes()?)?;
    if !arguments.tip_load.is_finite() {
        return Err(InputError::new("--tip-load must be a finite number of newtons").into());
    }
    let case = &file.case;
    let actuator = cell::cell_of(case).map_err(|error| {
        let key = error.key().unwrap_or_default();
        InputError::about_file(&arguments.case.case, error).of_key(&key)
    })?;
    let cell_case = Case { actuator, ..case.clone() };
    Estimate::of(&cell_case).within(MemoryLimit::Available)?;
    let default = || PathBuf::from("out").join(format!("{}-rod", file.stem()));
    let folder = OutputFolder::to_add_to(&arguments.out.clone().unwrap_or_else(default))?;

    let mut progress = |line: &str| {
        if !arguments.quiet {
            say(line);
        }
    };
    let found = cell::sample(case, &mut progress).map_err(|e| e.to_string()).and_then(|cell| {
        let identified = identify(&cell.samples).map_err(|e| e.to_string())?;
        Ok((cell, identified))
    });
    let (cell, identified) = match found {
        Ok(found) => found,
        Err(cause) => {
            say(&format!("error: the rod could not be identified: {cause}"));
            return Ok(Outcome::NotConverged);
        }
    };
    let length_mm = case.actuator.length();
    let shapes: Result<Vec<ShapeAt>, String> = case
        .load
        .pressure_kpa
        .iter()
        .map(|&pressure_kpa| {
            let line = |law| line(length_mm, law, pressure_kpa, arguments.tip_load);
            let law = identified.law;
            Ok(ShapeAt { pressure_kpa, shape: line(law)?, without_contact: line(law.without_contact())? })
        })
        .collect();
    let shapes = match shapes {
        Ok(shapes) => shapes,
        Err(cause) => {
            say(&format!("error: {cause}"));
            return Ok(Outcome::NotConverged);
        }
    };
    let text = report(&identified, &cell, &shapes);
    let law = identified.law;
    let content = RodFile {
        program: "pneuflex",
        version: env!("CARGO_PKG_VERSION"),
        title: &case.title,
        model: MODEL,
        length_mm,
        identified_up_to_kpa: cell::HIGHEST_KPA,
        parameters: Parameters {
            a1_per_mm_kpa: law.a1,
            a2_per_mm_kpa2: law.a2,
            d0_n_mm2: law.d0,
            d1_n_mm2_per_kpa: law.d1,
            contact_n_mm2: law.contact,
            contact_is_determined: identified.contact_fit.is_some(),
            touch_per_mm: law.touch[0],
            touch_per_mm_kpa: law.touch[1],
        },
        fit: Fit {
            intrinsic_curvature_per_mm: identified.curvature_fit,
            stiffness_n_mm2: identified.stiffness_fit,
            touch_per_mm: identified.touch_fit,
            contact_moment_n_mm: identified.contact_fit,
        },
        cell_stretch: cell.stretch,
        note: cell.note,
        samples: cell.samples,
        tip_load_n: arguments.tip_load,
        shapes,
    };
    let json = json::pretty(&content).map_err(|e| CliError::Output(format!("rod.json: {e}")))?;
    folder.write("rod.json", json)?;
    progress(&format!("results are in {}", folder.path().display()));
    let mut out = io::stdout().lock();
    // Nobody listening is no reason to fail: the file is written.
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    Ok(Outcome::Converged)
}

/// The rod's shape in the actuator's plane, z upwards.
fn line(length: f64, law: Law, pressure_kpa: f64, tip_load: f64) -> Result<Line, String> {
    let rod = Rod { length, law, intervals: INTERVALS };
    // The rod's second axis points downwards, to the side it bends to.
    let load = Load { tip_force: [0.0, tip_load], ..Load::pressure(pressure_kpa) };
    let shape = rod.shape(&load).map_err(|e| format!("the rod at {pressure_kpa} kPa: {e}"))?;
    let moment = shape.moments.first().copied().unwrap_or(0.0);
    Ok(Line {
        curvature_at_clamp_per_mm: law.curvature(pressure_kpa, moment).0,
        tip_angle_deg: shape.tip_angle().to_degrees(),
        centreline: shape.points.iter().map(|&[x, y]| [x, if y == 0.0 { 0.0 } else { -y }]).collect(),
    })
}

fn report(identified: &Identified, cell: &cell::Cell, shapes: &[ShapeAt]) -> String {
    let law = identified.law;
    let mut text = String::from("elastica baseline, identified from the two-chamber cell on 0-15 kPa (p in kPa)\n");
    let mut row = |name: &str, value: f64, unit: &str, error: Option<&FitError>| {
        let error = error.map_or("not determined by the samples".into(), |e| {
            format!("fit error {:.2} % of {} samples", 100.0 * e.relative_rms, e.samples)
        });
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {name:<3} {value:>12.5e} {unit:<14} {error}");
    };
    row("a1", law.a1, "1/(mm kPa)", Some(&identified.curvature_fit));
    row("a2", law.a2, "1/(mm kPa2)", Some(&identified.curvature_fit));
    row("D0", law.d0, "N mm2", Some(&identified.stiffness_fit));
    row("D1", law.d1, "N mm2/kPa", Some(&identified.stiffness_fit));
    row("Dc", law.contact, "N mm2", identified.contact_fit.as_ref());
    if let Some(error) = &identified.touch_fit {
        let _ = writeln!(
            text,
            "  chambers touch below the curvature {:.3e} + {:.3e} p per mm (fit error {:.2} %)",
            law.touch[0],
            law.touch[1],
            100.0 * error.relative_rms
        );
    }
    if let Some(note) = &cell.note {
        let _ = writeln!(text, "  note: {note}");
    }
    let _ =
        writeln!(text, "  bottom of the cell longer by up to {:.2} %; the rod is inextensible", 100.0 * cell.stretch);
    let _ = writeln!(text, "{:>8} {:>10} {:>10} {:>10}   without contact", "p (kPa)", "tip x", "tip z", "angle");
    for at in shapes {
        let tip = |l: &Line| l.centreline.last().copied().unwrap_or_default();
        let ([x, z], [x0, z0]) = (tip(&at.shape), tip(&at.without_contact));
        let (angle, angle0) = (at.shape.tip_angle_deg, at.without_contact.tip_angle_deg);
        let p = at.pressure_kpa;
        let _ = writeln!(text, "{p:>8} {x:>10.3} {z:>10.3} {angle:>10.2}   {x0:.3} {z0:.3} {angle0:.2}");
    }
    text
}
