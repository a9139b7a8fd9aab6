//! `pneuflex fit`: material constants from test curves.

mod arguments;
mod plot;
mod report;
pub mod snippet;

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use pneuflex::calibration::bulk::largest_mean_stress;
use pneuflex::calibration::clean::{Cleaned, clean};
use pneuflex::calibration::cross_validation::{Comparison, is_known_elsewhere};
use pneuflex::calibration::curve::{self, Curve, CurveError, MAX_BYTES, Point};
use pneuflex::calibration::fit::{
    FitError, FitOptions, LawFit, Residuals, Test, chosen_law, fit as fit_law, largest_i1_minus_3,
};
use pneuflex::calibration::law::{Choice, Family};
use pneuflex::calibration::range::{Range, better_choice, fitted_to, longest_range};

pub use arguments::FitArguments;
use pneuflex::model::Material;
pub use report::significant;
use report::{FileNote, FitFile, TestNote};

use pneuflex::input_error::{Origin, Place};
use pneuflex::{InputError, OutputFolder, input_file, json};

use crate::error::CliError;
use crate::outcome::Outcome;
use crate::terminal::say;

/// A test that is ready to be fitted.
pub struct Prepared {
    /// File as named on the command line.
    file: String,
    /// Points and weight.
    test: Test,
    /// What was left out.
    cleaned: Cleaned,
}

impl Prepared {
    fn new(curve: &Curve, arguments: &FitArguments) -> Result<Self, InputError> {
        let cleaned = clean(curve, &arguments.cleaning(curve.mode)?);
        if cleaned.used.is_empty() {
            let what = format!("{}: no point of the {} test is left to fit", curve.file, curve.mode.name());
            return Err(InputError::new(what).with_help(Some("give a wider range with --from and --to".into())));
        }
        let stem = Path::new(&curve.file).file_stem().map_or(curve.file.clone(), |s| s.to_string_lossy().into_owned());
        let test = Test {
            name: format!("{stem} {}", curve.mode.name()),
            mode: curve.mode,
            points: cleaned.used.clone(),
            weight: arguments.weight(curve.mode)?,
        };
        Ok(Self { file: curve.file.clone(), test, cleaned })
    }

    /// Smallest and largest stretch that is fitted.
    fn stretch_range(&self) -> [f64; 2] {
        let stretches = self.test.points.iter().map(|p| p.stretch);
        stretches.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)])
    }

    /// Name for a legend.
    fn short_name(&self) -> String {
        self.test.name.chars().take(26).collect()
    }
}

/// Reads the curves, fits all laws and writes the results.
///
/// # Errors
/// Files or options that cannot be used, or results that cannot be written.
pub fn fit(arguments: &FitArguments) -> Result<Outcome, CliError> {
    let chosen = arguments.choice()?;
    let (mut files, mut tests) = (Vec::new(), Vec::<Prepared>::new());
    for path in &arguments.files {
        let text = read(path)?;
        let options = arguments.read_options(path)?;
        let name = path.display().to_string();
        let reading = curve::read(&name, &text, &options).map_err(|e| place(&name, &text, &e))?;
        for curve in &reading.curves {
            tests.push(Prepared::new(curve, arguments)?);
        }
        files.push(FileNote { file: name, understood: reading.understood });
    }
    let better = match arguments.gives_end() {
        true => None,
        false => shorten(&mut tests, chosen, arguments.residuals()),
    };
    let fitted: Vec<Test> = tests.iter().map(|t| t.test.clone()).collect();
    let largest = largest_i1_minus_3(&fitted);
    let (fits, not_fitted) = fit_all(&fitted, chosen, &arguments.fit_options(largest)?);
    let material =
        material(arguments, &fits, &fitted)?.map(|found| Material { fitted_to: fitted_to(&fitted), ..found });
    let comparison = Comparison::new(&fitted, arguments.residuals());
    let snippet = material.as_ref().map(|m| snippet_of(chosen, m, &fits, (&tests, &fitted)));

    let stem = arguments.files[0].file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let default = || PathBuf::from("out").join(format!("{stem}-fit"));
    let folder = OutputFolder::to_add_to(&arguments.out.clone().unwrap_or_else(default))?;
    let content = FitFile {
        program: "pneuflex",
        version: env!("CARGO_PKG_VERSION"),
        files: &files,
        tests: tests.iter().map(TestNote::new).collect(),
        residuals: arguments.fit_options(largest)?.residuals,
        largest_i1_minus_3: largest,
        assumptions: report::ASSUMPTIONS,
        laws: &fits,
        cross_validation: &comparison,
        not_fitted: not_fitted.iter().map(ToString::to_string).collect(),
        material,
    };
    let text = json::pretty(&content).map_err(|e| CliError::Output(format!("fit.json: {e}")))?;
    folder.write("fit.json", &text)?;
    let drawing = plot::draw(&tests, &fits, largest).map_err(|e| CliError::Output(format!("fit.svg: {e}")))?;
    let svg = drawing.to_svg().map_err(|e| CliError::Output(format!("fit.svg: {e}")))?;
    folder.write("fit.svg", &svg)?;
    let png = drawing.to_png(2.0).map_err(|e| CliError::Output(format!("fit.png: {e}")))?;
    folder.write("fit.png", &png)?;
    match &snippet {
        Some(snippet) => folder.write("material.toml", snippet)?,
        // One of an earlier fit would look like this one's.
        None => folder.remove("material.toml")?,
    }
    if !arguments.quiet {
        let mut text = report::reading(&files, &tests);
        for fit in &fits {
            text += &report::law(fit, largest, fit.law.family() == chosen.family);
        }
        for failure in &not_fitted {
            text += &format!("\nnot fitted: {failure}\n");
        }
        text += &report::comparison(&comparison, chosen);
        if !is_known_elsewhere(chosen.family, &fitted) {
            text += &report::one_kind_of_test(chosen);
        }
        if let Some(better) = better {
            text += &format!("\nhint: {better}\n");
        }
        text += "\n95 %: confidence intervals of regression, for independent residuals; scatter between specimens and batches is not part \
                 of them.\n\n";
        print(&text);
    }
    print(snippet.as_deref().unwrap_or_default());
    match snippet {
        Some(_) => {
            if !arguments.quiet {
                say(&format!("results are in {}", folder.path().display()));
            }
            Ok(Outcome::Converged)
        }
        None => {
            let (reason, help) = why_no_constants(chosen, &fits, &not_fitted);
            say(&format!(
                "error: no constants for a case file: {reason}\n  help: {help}\n  what was computed is in {}",
                folder.path().display()
            ));
            Ok(Outcome::NotConverged)
        }
    }
}

/// Leaves out what the chosen law cannot follow together with the strains that actuators see. A law that follows the curves further, or more
/// closely, is named in a sentence.
fn shorten(tests: &mut [Prepared], chosen: Choice, residuals: Residuals) -> Option<String> {
    let all: Vec<Test> = tests.iter().map(|t| t.test.clone()).collect();
    // What cannot be fitted is said later.
    let own = longest_range(chosen, &all, residuals).ok()?;
    if let Some(why) = own.words(chosen) {
        for Prepared { test, cleaned, .. } in tests {
            let (inside, outside): (Vec<Point>, Vec<Point>) = test.points.iter().partition(|p| p.stretch <= own.to);
            if !outside.is_empty() {
                cleaned.notes.push(format!("{} {why}; --to all fits them, too", outside.len()));
            }
            test.points = inside;
            cleaned.unused.extend(outside);
        }
    }
    let (better, other) = better_choice(chosen, &own, &all, residuals)?;
    let largest = all.iter().map(Test::largest_stretch).fold(1.0, f64::max);
    let reach = |range: &Range| format!("to {:.2} within {:.0} %", range.to.min(largest), (100.0 * range.error).ceil());
    let [ours, theirs] = [reach(&own), reach(&other)];
    Some(format!(
        "{} follows these points {theirs} ({}), {} {ours}; largest stretches and errors from 10 % strain on",
        better.name(),
        better.options(),
        chosen.name()
    ))
}

/// The text of a file, of which no more is read than may be.
fn read(path: &Path) -> Result<String, CliError> {
    let bytes = input_file(path, MAX_BYTES as u64)?;
    let text = curve::decode(&bytes).map_err(|e| InputError::about_file(path, &e).with_help(e.help.clone()))?;
    Ok(text.into_owned())
}

/// An error with the line it is about.
fn place(name: &str, text: &str, error: &CurveError) -> CliError {
    let Some(line) = error.line else {
        return InputError::new(format!("{name}: {error}")).with_help(error.help.clone()).into();
    };
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let length = text[start..].lines().next().map_or(0, str::len);
    let place = Place::new(name, Origin::File, text.into(), start..start + length);
    InputError::new(error.to_string()).at(Some(place)).with_help(error.help.clone()).into()
}

/// A law that has no constants, and why.
struct NotFitted {
    choice: Choice,
    why: FitError,
}

impl fmt::Display for NotFitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.choice.name(), self.why)
    }
}

/// Reason and advice where a law has no constants that a case file could use.
fn why_no_constants(chosen: Choice, fits: &[LawFit], not_fitted: &[NotFitted]) -> (String, &'static str) {
    let family = chosen.family;
    if let Some(failure) = not_fitted.iter().find(|f| f.choice == chosen) {
        let help = match failure.why {
            FitError::Undetermined(_) if family != Family::NeoHookean => {
                "give more points at different stretches, or choose the law with one constant, --law neo-hooke"
            }
            FitError::Undetermined(_) => "give points at stretches other than 1",
            FitError::NotFinite => "give a narrower range with --from and --to",
            FitError::NoStableConstants => "fit another range with --from and --to, or leave out --stable",
        };
        return (failure.to_string(), help);
    }
    let value = |i: usize| {
        fits.iter().find(|f| f.law.family() == family).and_then(|f| f.constants.get(i)).map_or(f64::NAN, |c| c.value)
    };
    let (key, modulus) = match family {
        Family::MooneyRivlin => ("c10 + c01", value(0) + value(1)),
        Family::Yeoh | Family::NeoHookean => ("c10", value(0)),
        Family::Ogden | Family::Gent => ("mu", value(0)),
    };
    let reason = format!("{}: its {key} = {} MPa is not greater than 0", family.name(), significant(modulus));
    (reason, "fit another range with --from and --to, or add --stable")
}

/// A law of every family, of the chosen number of terms in that of the chosen one; and why others are missing.
fn fit_all(tests: &[Test], chosen: Choice, options: &FitOptions) -> (Vec<LawFit>, Vec<NotFitted>) {
    let (mut fits, mut failures) = (Vec::new(), Vec::new());
    for family in Family::ALL {
        let choice = if family == chosen.family { chosen } else { family.into() };
        let law = chosen_law(choice, tests, options.residuals);
        match law.and_then(|law| fit_law(law, tests, options)) {
            Ok(fit) => fits.push(fit),
            Err(why) => failures.push(NotFitted { choice, why }),
        }
    }
    (fits, failures)
}

/// The chosen law as a case file has it; `None` if the solver would refuse it.
fn material(arguments: &FitArguments, fits: &[LawFit], tests: &[Test]) -> Result<Option<Material>, InputError> {
    let family = arguments.choice()?.family;
    let of_fit = |fit: &LawFit| {
        let constants: Vec<f64> = fit.constants.iter().map(|constant| constant.value).collect();
        Material::from(fit.law.with_constants(&constants))
    };
    let found =
        fits.iter().find(|f| f.law.family() == family).map(of_fit).filter(|m| m.problems("material").is_empty());
    // The options are checked whether or not there is something to use them for.
    let shear_modulus = found.as_ref().map_or(1.0, Material::shear_modulus);
    let bulk_modulus = arguments.bulk_modulus(shear_modulus, largest_mean_stress(tests))?;
    Ok(found.map(|material| Material { bulk_modulus, ..material }))
}

fn snippet_of(chosen: Choice, material: &Material, fits: &[LawFit], (tests, fitted): (&[Prepared], &[Test])) -> String {
    let mut comments = Vec::new();
    for fit in fits.iter().filter(|f| f.law.family() == chosen.family) {
        comments.push(format!("{} fitted by pneuflex {} to", fit.law.name(), env!("CARGO_PKG_VERSION")));
        for (test, bands) in tests.iter().zip(&fit.bands) {
            let [low, high] = test.stretch_range();
            let error = report::largest_error(bands).map_or(String::new(), |[error, at]| {
                format!(", within {:.0} % from 10 % strain on (worst at {at:.2})", (100.0 * error).ceil())
            });
            comments.push(format!(
                "  {}: {} points, stretch {low:.3} to {high:.3}{error}",
                test.test.name,
                test.test.points.len()
            ));
        }
        if !fit.is_stable_in_range {
            comments.push("  NOT STABLE over this range; see pneuflex fit --stable".into());
        }
        if !is_known_elsewhere(chosen.family, fitted) {
            comments.push("  fitted to one kind of test: NOT RELIABLE in other deformations".into());
        }
        let limits: Vec<String> =
            (fit.stable.iter()).filter_map(|range| Some(format!("{} {:.3}", range.mode.name(), range.high?))).collect();
        if !limits.is_empty() {
            comments.push(format!("  stable up to stretches of: {}", limits.join(", ")));
        }
    }
    let ratio = material.bulk_modulus / material.shear_modulus();
    let words = material.law.shear_modulus_in_words();
    let bulk = format!("{ratio:.0} times the initial shear modulus ({words}); no result of these tests");
    snippet::material(&comments, material, &bulk)
}

fn print(text: &str) {
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(text.as_bytes());
}
