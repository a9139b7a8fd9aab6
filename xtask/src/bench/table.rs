//! The whole-case table as text.

use serde::Serialize;

use super::fit::exponent;
use super::plan::Series;
use super::runner::Row;

/// Above the table.
pub const HEAD: &str = "\
Whole cases, each run a process of its own. Only ratios within this one run count: seconds depend on the machine and on
what else it does. solver: from the set-up of the equations to the last equilibrium; process: from start to end; factor:
share of the factorisations in the solver's time; t/f: the inverse; peak: largest resident set; 2/1: solver's time with
one thread over that with two.
";

/// The numbers of chambers that exponents are fitted to.
const FITTED: std::ops::RangeInclusive<usize> = 4..=64;

/// Growth over the number of chambers N, as exponents b of Nᵇ.
#[derive(Clone, Debug, Serialize)]
pub struct Growth {
    /// Resolution.
    pub resolution: String,
    /// Numbers of chambers fitted to.
    pub chambers: Vec<usize>,
    /// Of the unknowns.
    pub unknowns: f64,
    /// Of the solver's time.
    pub solver: f64,
    /// Of the solver's time per iteration: long bodies may need more iterations.
    pub per_iteration: f64,
    /// Of the factorisations' time.
    pub factor: f64,
    /// Of the peak memory.
    pub peak: f64,
}

/// All rows under their headings.
pub fn rows(rows: &[Row]) -> String {
    let mut text = String::from(HEAD);
    for (series, title) in [
        (Series::Paper, "The paper's fixtures as they are, 5 pressures to 50 kPa"),
        (Series::Resolution, "Eight chambers by resolution, isochoric invariant, 5 pressures to 50 kPa"),
        (
            Series::Chambers,
            "By number of chambers, isochoric invariant, one load step to 5 kPa (at 50 kPa, 64 chambers would curl \
             through themselves)",
        ),
    ] {
        let part: Vec<&Row> = rows.iter().filter(|row| row.series == series).collect();
        if part.is_empty() {
            continue;
        }
        text += &format!(
            "\n{title}\n{:>16} {:>8} {:>10} {:>9} {:>9} {:>7} {:>10} {:>9} {:>9} {:>7} {:>5} {:>9} {:>5}\n",
            "case",
            "chambers",
            "resolution",
            "element",
            "unknowns",
            "threads",
            "iterations",
            "solver s",
            "process s",
            "factor",
            "t/f",
            "peak MiB",
            "2/1"
        );
        for row in part {
            text += &line(row, rows);
        }
    }
    text
}

fn line(row: &Row, all: &[Row]) -> String {
    let speed_up = speed_up(row, all).map_or_else(String::new, |ratio| format!("{ratio:.2}"));
    let remark = if row.converged { "" } else { "  did not converge" };
    format!(
        "{:>16} {:>8} {:>10} {:>9} {:>9} {:>7} {:>10} {:>9.2} {:>9.2} {:>5.0} % {:>5.2} {:>9.0} {speed_up:>5}{remark}\n",
        row.fixture.trim_end_matches(".toml"),
        row.chambers,
        row.resolution,
        row.element,
        row.unknowns,
        row.threads,
        row.iterations,
        row.solver_s,
        row.process_s,
        100.0 * row.factor_s / row.solver_s,
        row.solver_s / row.factor_s,
        row.peak_bytes as f64 / f64::from(1 << 20),
    )
}

/// Time with one thread over time with this row's two; `None` for other rows.
fn speed_up(row: &Row, all: &[Row]) -> Option<f64> {
    let is_serial_twin = |other: &&Row| {
        (other.series, other.fixture, other.chambers, &other.resolution, other.threads)
            == (row.series, row.fixture, row.chambers, &row.resolution, 1)
    };
    let twin = all.iter().filter(|_| row.threads == 2).find(is_serial_twin)?;
    (row.converged && twin.converged).then(|| twin.solver_s / row.solver_s)
}

/// Exponents for every resolution that has at least two numbers of chambers from 4 to 64.
pub fn growth(rows: &[Row]) -> Vec<Growth> {
    let scaled = |row: &&Row| row.series == Series::Chambers && row.converged && FITTED.contains(&row.chambers);
    let scaled: Vec<&Row> = rows.iter().filter(scaled).collect();
    let fit = |part: &[&Row]| {
        let of =
            |y: fn(&Row) -> f64| exponent(&part.iter().map(|row| (row.chambers as f64, y(row))).collect::<Vec<_>>());
        Some(Growth {
            resolution: part.first()?.resolution.clone(),
            chambers: part.iter().map(|row| row.chambers).collect(),
            unknowns: of(|row| row.unknowns as f64)?,
            solver: of(|row| row.solver_s)?,
            per_iteration: of(|row| row.solver_s / row.iterations as f64)?,
            factor: of(|row| row.factor_s)?,
            peak: of(|row| row.peak_bytes as f64)?,
        })
    };
    scaled.chunk_by(|a, b| a.resolution == b.resolution).filter_map(fit).collect()
}

/// The exponents in words.
pub fn growth_text(growth: &[Growth]) -> String {
    let mut text = String::new();
    for g in growth {
        let chambers: Vec<String> = g.chambers.iter().map(ToString::to_string).collect();
        text += &format!(
            "{}: over the number of chambers ({}), unknowns grow with exponent {:.2}, solver's time {:.2} \
             ({:.2} per iteration), factorisations {:.2}, peak memory {:.2}\n",
            g.resolution,
            chambers.join(", "),
            g.unknowns,
            g.solver,
            g.per_iteration,
            g.factor,
            g.peak
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(series: Series, chambers: usize, threads: usize, solver_s: f64) -> Row {
        Row {
            series,
            fixture: "actuator.toml",
            chambers,
            resolution: "draft".into(),
            element: "hex27".into(),
            unknowns: 1000 * chambers,
            threads,
            converged: true,
            iterations: 4,
            solver_s,
            process_s: solver_s + 0.1,
            factor_s: 0.5 * solver_s,
            peak_bytes: (chambers as u64) << 24,
        }
    }

    #[test]
    fn two_threads_are_compared_with_one_of_the_same_case() {
        let all =
            [row(Series::Resolution, 8, 1, 3.0), row(Series::Resolution, 8, 2, 2.0), row(Series::Chambers, 8, 2, 1.0)];
        assert_eq!(speed_up(&all[1], &all), Some(1.5));
        assert_eq!((speed_up(&all[0], &all), speed_up(&all[2], &all)), (None, None));
        let text = rows(&all);
        assert!(
            text.contains("ratios within this one run") && text.contains(" 1.50") && text.contains("50 %"),
            "{text}"
        );
    }

    #[test]
    fn growth_is_fitted_from_four_to_sixty_four_chambers() {
        let time = |n: usize| if n == 2 { 100.0 } else { 0.1 * (n as f64).powf(1.1) };
        let mut all: Vec<Row> = [2, 4, 16, 64].map(|n| row(Series::Chambers, n, 2, time(n))).to_vec();
        all.push(row(Series::Resolution, 8, 2, 9.0));
        let growth = growth(&all);
        assert_eq!(growth[0].chambers, [4, 16, 64]);
        assert!((growth[0].solver - 1.1).abs() < 1e-9 && (growth[0].peak - 1.0).abs() < 1e-9);
    }
}
