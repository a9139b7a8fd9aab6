//! `pneuflex materials`: constants of known silicones.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use pneuflex::calibration::law::{Law, Mode};
use pneuflex::calibration::library::{ENTRIES, Entry, find, identifier};
use pneuflex::plot::PlotError;
use pneuflex::plot::chart::{Chart, Series, Style};
use pneuflex::{InputError, OutputFolder};

use crate::error::CliError;
use crate::fit::{significant, snippet};

const WARNING: &str = "Published sets for one product differ by a factor of two (batch, curing, strain rate, first or later \
                       loading, range of the fit). Test your own batch and use `pneuflex fit` if it matters.";

/// Largest stretch of a comparison.
const LARGEST_STRETCH: f64 = 4.0;

/// Points of a curve.
const SAMPLES: usize = 120;

const EXAMPLES: &str = "\
Examples:
  pneuflex materials                      the list
  pneuflex materials dragon-skin-30       the [material] table of a case file
  pneuflex materials dragon-skin-30:2     another set for the same product
  pneuflex materials dragon-skin-30 --compare   a picture of all its sets

A set is a Yeoh law. Its `range` is that of the test it was fitted to; it says nothing beyond.";

/// Arguments of `pneuflex materials`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct MaterialsArguments {
    /// A name of the list; without one the list is printed
    name: Option<String>,
    /// Draw the stress of all sets of the product over the stretch
    #[arg(long, requires = "name")]
    compare: bool,
    /// Folder for the picture [default: out/NAME-materials]; what else it holds is left alone
    #[arg(long, value_name = "DIR", requires = "compare")]
    out: Option<PathBuf>,
}

/// Prints the list or one set.
///
/// # Errors
/// A name that is not in the list, or a picture that cannot be written.
pub fn materials(arguments: &MaterialsArguments) -> Result<(), CliError> {
    let text = match &arguments.name {
        None => list(),
        Some(name) => {
            let index = find(name).ok_or_else(|| unknown(name))?;
            if arguments.compare { compare(index, arguments.out.as_deref())? } else { table(index) }
        }
    };
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(text.as_bytes());
    Ok(())
}

/// Draws all sets of a product; what they say at small and at large strains.
fn compare(index: usize, out: Option<&Path>) -> Result<String, CliError> {
    let name = ENTRIES[index].name;
    let sets: Vec<usize> = (0..ENTRIES.len()).filter(|&i| ENTRIES[i].name == name).collect();
    let stress = |set: usize, stretch: f64| Law::Yeoh.stress(&ENTRIES[set].constants, Mode::Uniaxial, stretch);
    let curve = |set: usize| {
        // Beyond its points a fit says nothing; those of a source that names no range are drawn all the way.
        let end = ENTRIES[set].fit.map_or(LARGEST_STRETCH, |fit| fit.to.min(LARGEST_STRETCH));
        let stretch = |i: usize| 1.0 + (end - 1.0) * i as f64 / SAMPLES as f64;
        (0..=SAMPLES).map(stretch).map(|stretch| [stretch, stress(set, stretch)]).collect()
    };
    let styles = [Style::Solid, Style::Dashed, Style::Dotted];
    let series = sets.iter().enumerate().map(|(i, &set)| {
        let kind = match ENTRIES[set].fit {
            Some(fit) => format!("our fit to {:.1}", fit.to),
            None => "published".to_owned(),
        };
        Series::line(&format!("{} ({kind})", identifier(set)), curve(set)).style(styles[i % styles.len()])
    });
    let chart = Chart {
        x_label: "stretch (1)".into(),
        y_label: "nominal stress, uniaxial (MPa)".into(),
        series: series.collect(),
        ..Chart::new(name)
    };
    let words = |e: PlotError| CliError::Output(format!("compare: {e}"));
    let drawing = chart.draw().map_err(words)?;
    let default = || PathBuf::from("out").join(format!("{}-materials", identifier(sets[0])));
    let folder = OutputFolder::to_add_to(&out.map_or_else(default, Path::to_path_buf))?;
    folder.write("compare.svg", &drawing.to_svg().map_err(words)?)?;
    folder.write("compare.png", &drawing.to_png(2.0).map_err(words)?)?;
    let width = sets.iter().map(|&set| identifier(set).len()).max().unwrap_or(0);
    let mut text = format!("{:width$}  nominal stress, MPa, at 30 %   100 %   200 %  range and source\n", "");
    for &set in &sets {
        let is_fitted = |stretch: f64| ENTRIES[set].fit.is_none_or(|fit| stretch <= fit.to);
        let [low, middle, high] = [1.3, 2.0, 3.0]
            .map(|stretch| if is_fitted(stretch) { significant(stress(set, stretch)) } else { "-".to_owned() });
        let (range, source) = (ENTRIES[set].range, in_short(&ENTRIES[set]));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:width$}  {low:>30} {middle:>7} {high:>7}  {range}; {source}", identifier(set));
    }
    let _ = writeln!(text, "\n{WARNING}\nthe picture is in {}", folder.path().display());
    Ok(text)
}

fn unknown(name: &str) -> InputError {
    let bare = |t: &str| t.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect::<String>();
    let is_like = |i: &usize| bare(&identifier(*i)).contains(&bare(name)) && !bare(name).is_empty();
    let like: Vec<String> = (0..ENTRIES.len()).filter(is_like).map(identifier).collect();
    let help = match like.is_empty() {
        true => "`pneuflex materials` lists all".into(),
        false => format!("did you mean {}?", like.join(", ")),
    };
    InputError::new(format!("no material `{name}` is known")).with_help(Some(help))
}

fn list() -> String {
    let width = (0..ENTRIES.len()).map(|i| identifier(i).len()).max().unwrap_or(0);
    let mut text = format!("{:width$}  {:>10} {:>11} {:>11}  range and source\n", "Yeoh, MPa", "C10", "C20", "C30");
    for (i, entry) in ENTRIES.iter().enumerate() {
        let [c10, c20, c30] = entry.constants.map(significant);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:width$}  {c10:>10} {c20:>11} {c30:>11}  {}; {}",
            identifier(i),
            entry.range,
            in_short(entry)
        );
    }
    format!("{text}\n{WARNING}\n")
}

fn in_short(entry: &Entry) -> &'static str {
    let end = entry.source.find([',', ';', '(', ':']).unwrap_or(entry.source.len());
    entry.source[..end].trim_end()
}

fn table(index: usize) -> String {
    let entry = &ENTRIES[index];
    let mut comments = vec![format!("{} ({})", entry.name, identifier(index)), format!("range: {}", entry.range)];
    comments.push(format!("source: {}", entry.source));
    if let Some(fit) = entry.fit {
        comments
            .push(format!("  by: pneuflex fit fixtures/curves/{} {}", fit.curve, fit.arguments).trim_end().to_owned());
    }
    let others: Vec<String> =
        (0..ENTRIES.len()).filter(|&i| i != index && ENTRIES[i].name == entry.name).map(identifier).collect();
    if !others.is_empty() {
        comments.push(format!("other sets: {}", others.join(", ")));
    }
    comments.push(WARNING.into());
    let material = entry.material();
    let comment = match entry.bulk_modulus_of_source {
        Some(_) => "as in the source".to_owned(),
        None => {
            format!("{:.0} times the initial shear modulus (2 c10)", material.bulk_modulus / material.shear_modulus())
        }
    };
    snippet::material(&comments, &material, &comment)
}
