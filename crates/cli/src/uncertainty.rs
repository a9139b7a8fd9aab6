//! `pneuflex uncertainty`: how far results spread by the tolerances of lengths and constants.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use pneuflex::plot::PlotError;
use pneuflex::plot::drawing::Drawing;
use pneuflex::plot::tornado::{Tornado, TornadoBar};
use pneuflex::{Error, json};
use pneuflex_inverse::search::base;
use pneuflex_inverse::uncertainty::{Contribution, Sampled, Spread, Tolerances, Tolerated, Uncertainty};
use pneuflex_sweep::node::Node;

use crate::args::UncertaintyArguments;
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::search::number;
use crate::terminal::say;

/// Contributors that are named in the table.
const MOST_NAMED: usize = 3;

/// Width of a chart, px.
const WIDTH: f64 = 640.0;

/// Prints a row for every result at every pressure.
///
/// # Errors
/// Bad input, found before anything is solved; a case that has no results; a file that cannot be written.
pub fn uncertainty(arguments: &UncertaintyArguments) -> Result<Outcome, CliError> {
    let UncertaintyArguments { case, of, tolerance, check, json: out, chart, solve } = arguments;
    solve.with.use_threads()?;
    let base = base(case.case.clone(), &Node::default(), &case.changes()?);
    let stop = interrupt::listen();
    let ready = Tolerances::new(base, tolerance, of, solve.memory_limit(), &stop)?;
    let told = &mut |solved: usize| {
        if !solve.with.quiet {
            say(&format!("design {solved} of {check}"));
        }
    };
    let found = match ready.solve(usize::from(*check), told) {
        Ok(found) => found,
        Err(Error::Interrupted(_)) => {
            say("interrupted");
            return Ok(Outcome::Interrupted);
        }
        Err(error) => return Err(error.into()),
    };
    if let Some(out) = out {
        let text = json::pretty(&found).map_err(CliError::Output)?;
        fs::write(out, text).map_err(|e| CliError::Output(format!("{}: cannot be written: {e}", out.display())))?;
    }
    if let Some(path) = chart {
        let cannot = |why: String| CliError::Output(format!("{}: {why}", path.display()));
        let bytes = drawing(&found, path).map_err(|why| cannot(why.to_string()))?;
        fs::write(path, bytes).map_err(|why| cannot(format!("cannot be written: {why}")))?;
    }
    // Nobody reading on is no error.
    let _ = std::io::stdout().write_all(text(&found).as_bytes());
    Ok(Outcome::Converged)
}

/// A chart for every result, in the form that the file's name asks for: by how much each number alone spreads it.
fn drawing(found: &Uncertainty, path: &Path) -> Result<Vec<u8>, PlotError> {
    let tolerance = |key: &str| found.tolerances.iter().find(|tolerated| tolerated.key == key);
    let chart = |spread: &Spread| {
        let bar = |part: &Contribution| {
            let Tolerated { key, value, standard_deviation, .. } = tolerance(&part.by)?;
            let change = part.derivative * standard_deviation;
            Some(TornadoBar {
                name: format!("{key} {} ± {}", number(*value), number(*standard_deviation)),
                lowered: Some(spread.value - change),
                raised: Some(spread.value + change),
            })
        };
        let caption = format!(
            "Each number lowered and raised by its standard deviation (the tolerance over √3), to first order; by all together {}.",
            number(spread.standard_deviation)
        );
        let bars = spread.contributions.iter().filter_map(bar).collect();
        let (title, label) = ("By tolerances".to_owned(), spread.of.clone());
        Tornado { title, label, centre: spread.value, bars, caption, width: WIDTH }.draw()
    };
    let charts = found.results.iter().map(chart).collect::<Result<_, _>>()?;
    let sheet = Drawing::column(charts, "What tolerances do");
    let is_png = path.extension().is_some_and(|extension| extension == "png");
    if is_png { sheet.to_png(2.0) } else { sheet.to_svg().map(String::into_bytes) }
}

fn text(found: &Uncertainty) -> String {
    let of_designs = found.designs.map(|count| format!(" {:>18}", format!("of {count} designs"))).unwrap_or_default();
    let mut text = format!("{:<28} {:>12} {:>12}{of_designs}  by\n", "", "value", "std. dev.");
    for Spread { of, value, standard_deviation, contributions, sampled } in &found.results {
        let named = contributions.iter().filter(|part| part.share > 0.0).take(MOST_NAMED);
        let named: Vec<String> =
            named.map(|Contribution { by, share, .. }| format!("{by} {:.0} %", 100.0 * share)).collect();
        let sampled = match sampled {
            Some(Sampled { standard_deviation, .. }) => format!(" {:>18}", number(*standard_deviation)),
            None => " ".repeat(of_designs.chars().count()),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{of:<28} {:>12} {:>12}{sampled}  {}",
            number(*value),
            number(*standard_deviation),
            named.join(", ")
        );
    }
    if let Some(count) = found.without_results.filter(|count| *count > 0) {
        let _ = writeln!(text, "{count} designs have no results, and do not count");
    }
    text
}
