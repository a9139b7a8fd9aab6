//! A run beside what somebody has measured: how far points are from the deformed body, and numbers from the run's, and a picture of both.

mod alignment;
mod line;
mod measured;

use std::fs;
use std::path::Path;

use pneuflex_export::surface::Surface;
use pneuflex_model::{Clock, LoadParameter};
use pneuflex_plot::chart::{Chart, PALETTE, Series, Style};
use pneuflex_plot::drawing::Drawing;
use pneuflex_report::comparison::{Comparison, Difference};

pub use alignment::Fit;
use line::{Piece, chain, nearest, outline};
use measured::{Measured, Sample};

use crate::columns::{Tip, columns};
use crate::error::Error;
use crate::input_error::InputError;
use crate::pairs::Pairs;
use crate::picture::FieldsOfRun;
use crate::recorded_states::{RecordedState, RecordedStates};
use crate::study::Study;
use crate::words::rounded;

/// A state is that of a measurement if it is no further from it than this, relative to it.
const SAME: f64 = 1e-6;

/// Digits of numbers in the picture.
const DIGITS: i32 = 4;

/// Height of a picture of points in shares of its width, at the least.
const FLATTEST: f64 = 0.3;

/// Columns of the points' distances.
const POINTS: &str = "points";

/// What measured points are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// The bottom line of an actuator.
    Bottom,
    /// The outline of the whole body as it is seen along y.
    Outline,
}

impl Line {
    fn words(self) -> &'static str {
        match self {
            Self::Bottom => "bottom line",
            Self::Outline => "outline",
        }
    }
}

/// How a run is compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choices {
    /// What points are compared with; `None` for the bottom line where the body has one, else the outline.
    pub line: Option<Line>,
    /// What is fitted before points are compared.
    pub fit: Fit,
}

/// Compares a result folder with a table of measurements: points `x_mm`, `z_mm`, and columns as of `pneuflex table`, by `pressure_kpa` or
/// `time`. Returns the differences and a picture of both.
///
/// # Errors
/// [`Error::Input`]: a folder that is none of this program's, results without fields for points, a table that is none or has columns that the run
/// does not have, measurements outside of the run, what cannot be fitted.
pub fn compare(folder: &Path, table: &Path, choices: Choices) -> Result<(Comparison, Drawing), Error> {
    let text = fs::read_to_string(table).map_err(|e| InputError::about_file(table, format!("cannot be read: {e}")))?;
    let states = Computed::read(folder)?;
    let measured = Measured::read(table, &text, states.parameter())?;
    let beyond = |sample: f64| states.place(sample).is_none();
    let all = measured.points.iter().map(|sample| sample.at);
    let mut all = all.chain(measured.numbers.iter().flat_map(|(_, samples)| samples.iter().map(|sample| sample.at)));
    if let Some(at) = all.find(|at| beyond(*at)) {
        return Err(InputError::about_file(table, states.nothing_at(at)).with_help(Some(states.help())).into());
    }
    let mut comparison = Comparison {
        measured: table.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        is_by_time: states.clock == Clock::Steps,
        line: None,
        alignment: None,
        kinds: Vec::new(),
        interpolated_at: Vec::new(),
        picture: String::new(),
    };
    let mut charts = Vec::new();
    if measured.points.is_empty() {
        if choices.fit.is_any() || choices.line.is_some() {
            let what = "--fit and --line are for points (columns x_mm and z_mm), of which there are none";
            return Err(InputError::about_file(table, what).into());
        }
    } else {
        charts.push(points(folder, &states, &measured.points, choices, &mut comparison)?);
    }
    for (name, samples) in &measured.numbers {
        charts.push(numbers(table, &states, name, samples, &mut comparison)?);
    }
    comparison.interpolated_at.sort_by(f64::total_cmp);
    comparison.interpolated_at.dedup();
    let drawn = charts.iter().map(Chart::draw).collect::<Result<Vec<_>, _>>();
    let drawn = drawn.map_err(|e| InputError::about_file(table, e))?;
    let (width, height) = (drawn.iter().map(|d| d.width).fold(0.0, f64::max), drawn.iter().map(|d| d.height).sum());
    let mut sheet = Drawing::new(width, height, "Measured and computed");
    let mut top = 0.0;
    for drawing in drawn {
        let height = drawing.height;
        sheet.place(drawing, [0.0, top]);
        top += height;
    }
    comparison.picture = sheet.to_svg().map_err(|e| InputError::about_file(table, e))?;
    Ok((comparison, sheet))
}

/// The states of a run in the order of their pressures or times.
struct Computed {
    clock: Clock,
    states: Vec<RecordedState>,
    rows: Vec<Pairs>,
}

impl Computed {
    fn read(folder: &Path) -> Result<Self, Error> {
        let recorded = RecordedStates::read(folder)?;
        if recorded.has_turned() {
            let why = "its load turns back, so that several states share a pressure or time: measurements cannot be told apart";
            return Err(InputError::about_file(folder, why).into());
        }
        let tip = Tip::of(&Study::load(folder.join("case.toml"))?);
        let clock = if recorded.is_by_time { Clock::Steps } else { Clock::Pressure };
        let states: Vec<RecordedState> = recorded.states.into_iter().filter(|state| state.numbers.is_some()).collect();
        let rows = states.iter().filter_map(|state| Some(columns(state.numbers.as_ref()?, &tip))).collect();
        Ok(Self { clock, states, rows })
    }

    fn parameter(&self) -> &'static str {
        match self.clock {
            Clock::Pressure => "pressure_kpa",
            Clock::Steps => "time",
        }
    }

    fn words(&self, at: f64) -> String {
        self.clock.words(LoadParameter(rounded(at, DIGITS)))
    }

    fn nothing_at(&self, at: f64) -> String {
        format!("something is measured at {}, where the run has no results", self.words(at))
    }

    fn help(&self) -> String {
        match &self.states[..] {
            [] => "no state was reached".into(),
            [only] => format!("it has one state, at {}", self.words(only.parameter)),
            [first, .., last] => {
                format!(
                    "they go from {} to {}: leave such rows out, or run the case further",
                    self.words(first.parameter),
                    self.words(last.parameter)
                )
            }
        }
    }

    /// The states before and after a place, and how far it is from one to the other; a state's own place is both.
    fn place(&self, at: f64) -> Option<([usize; 2], f64)> {
        let is_same = |state: &RecordedState| (state.parameter - at).abs() <= SAME * at.abs().max(SAME);
        if let Some(own) = self.states.iter().position(is_same) {
            return Some(([own, own], 0.0));
        }
        let after = self.states.iter().position(|state| state.parameter > at).filter(|after| *after > 0)?;
        let [a, b] = [after - 1, after].map(|i| self.states[i].parameter);
        Some(([after - 1, after], (at - a) / (b - a)))
    }

    /// Something that is computed at a place from what the states have.
    fn at<T>(&self, at: f64, of: impl Fn(usize) -> T, mix: impl Fn(T, T, f64) -> T) -> Option<T> {
        let ([before, after], share) = self.place(at)?;
        Some(if before == after { of(before) } else { mix(of(before), of(after), share) })
    }

    fn is_between(&self, at: f64) -> bool {
        self.place(at).is_some_and(|([before, after], _)| before != after)
    }
}

/// Compares points, and draws them.
fn points(
    folder: &Path,
    states: &Computed,
    samples: &[Sample<[f64; 2]>],
    choices: Choices,
    comparison: &mut Comparison,
) -> Result<Chart, Error> {
    let bottom = |state: usize| states.states[state].numbers.as_ref().map_or(&[][..], |numbers| &numbers.centreline);
    let has_bottom = (0..states.states.len()).all(|state| !bottom(state).is_empty());
    let line = choices.line.unwrap_or(if has_bottom { Line::Bottom } else { Line::Outline });
    let mut places: Vec<f64> = samples.iter().map(|sample| sample.at).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let mix = |a: f64, b: f64, share: f64| a + share * (b - a);
    let lines: Vec<(f64, Vec<Piece>)> = match line {
        Line::Bottom if !has_bottom => {
            return Err(
                InputError::new("--line bottom: this body has no bottom line (node set bottom_centreline)").into()
            );
        }
        Line::Bottom => {
            let of = |at: &f64| {
                let between = |a: Vec<[f64; 2]>, b: Vec<[f64; 2]>, share| {
                    a.iter().zip(&b).map(|(a, b)| [0, 1].map(|d| mix(a[d], b[d], share))).collect()
                };
                let points = states.at(*at, |state| bottom(state).to_vec(), between).unwrap_or_default();
                (*at, chain(&points))
            };
            places.iter().map(of).collect()
        }
        Line::Outline => {
            let run = FieldsOfRun::read(folder)?;
            let surface = Surface::new(&run.analysis.problem);
            let of = |at: &f64| {
                let between = |a: Vec<[f64; 3]>, b: Vec<[f64; 3]>, share| {
                    a.iter().zip(&b).map(|(a, b)| std::array::from_fn(|d| mix(a[d], b[d], share))).collect()
                };
                let u = states.at(*at, |state| run.states[state].displacement.clone(), between).unwrap_or_default();
                (*at, outline(&surface, &surface.positions(Some(&u))))
            };
            places.iter().map(of).collect()
        }
    };
    let of = |at: f64| lines.iter().find(|(place, _)| *place == at).map_or(&[][..], |(_, line)| line);
    let raw: Vec<[f64; 2]> = samples.iter().map(|sample| sample.value).collect();
    let alignment = if choices.fit.is_any() {
        Some(alignment::align(&raw, choices.fit, |number, at| nearest(of(samples[number].at), at))?)
    } else {
        None
    };
    let points: Vec<[f64; 2]> =
        raw.iter().map(|point| alignment.map_or(*point, |a| alignment::aligned(&a, *point))).collect();
    let distances = points.iter().zip(samples).filter_map(|(point, sample)| {
        let (foot, _) = nearest(of(sample.at), *point)?;
        Some((sample.at, (point[0] - foot[0]).hypot(point[1] - foot[1])))
    });
    let distances: Vec<(f64, f64)> = distances.collect();
    comparison.kinds.push(difference(POINTS, "mm", &distances, false));
    comparison.interpolated_at.extend(places.iter().filter(|at| states.is_between(**at)));
    comparison.line = Some(line.words().to_owned());
    comparison.alignment = alignment;
    let mut series = Vec::new();
    for (number, (at, pieces)) in lines.iter().enumerate() {
        let colour = PALETTE[number % PALETTE.len()];
        // Pieces of a chain are one curve; those of an outline stand for themselves.
        let curves: Vec<Vec<[f64; 2]>> = match line {
            Line::Bottom => {
                vec![pieces.iter().map(|piece| piece[0]).chain(pieces.last().map(|piece| piece[1])).collect()]
            }
            Line::Outline => pieces.iter().map(|piece| piece.to_vec()).collect(),
        };
        let name = states.words(*at);
        series.extend(
            curves
                .into_iter()
                .enumerate()
                .map(|(i, curve)| Series::line(if i == 0 { &name } else { "" }, curve).colour(colour)),
        );
        let here = points.iter().zip(samples).filter(|(_, sample)| sample.at == *at).map(|(point, _)| *point).collect();
        series.push(Series::line("measured", here).style(Style::Markers).colour(colour));
    }
    // A body that hardly bends still has room for the marks of the axis.
    let ends = |d: usize| {
        let all = series.iter().flat_map(|series: &Series| series.points.iter().map(move |point| point[d]));
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let ([left, right], [low, high]) = (ends(0), ends(1));
    let missing = (0.5 * (FLATTEST * (right - left) - (high - low))).max(0.0);
    Ok(Chart {
        x_label: "x (mm)".into(),
        y_label: "z (mm)".into(),
        y_shows: vec![low - missing, high + missing],
        series,
        has_equal_axes: true,
        height: 520.0,
        ..Chart::new(&format!("Measured points and the {}", line.words()))
    })
}

/// Compares numbers of a column, and draws them.
fn numbers(
    table: &Path,
    states: &Computed,
    name: &str,
    samples: &[Sample<f64>],
    comparison: &mut Comparison,
) -> Result<Chart, Error> {
    let known = |row: &Pairs| row.get(name).and_then(serde_json::Value::as_f64);
    let values: Option<Vec<f64>> = states.rows.iter().map(known).collect();
    let values = values.ok_or_else(|| {
        let mut there: Vec<&str> =
            states.rows.iter().flat_map(|row| row.0.iter().map(|(name, _)| name.as_str())).collect();
        there.sort_unstable();
        there.dedup();
        let help = format!("there are x_mm and z_mm of points, and the columns {}", there.join(", "));
        InputError::about_file(table, format!("the run has no column {name}")).with_help(Some(help))
    })?;
    let difference_of = |sample: &Sample<f64>| {
        let computed = states.at(sample.at, |state| values[state], |a, b, share| a + share * (b - a))?;
        Some((sample.at, sample.value - computed))
    };
    let differences: Vec<(f64, f64)> = samples.iter().filter_map(difference_of).collect();
    comparison.kinds.push(difference(name, unit(name), &differences, true));
    comparison.interpolated_at.extend(samples.iter().map(|sample| sample.at).filter(|at| states.is_between(*at)));
    let computed = states.states.iter().zip(&values).map(|(state, value)| [state.parameter, *value]).collect();
    let measured = samples.iter().map(|sample| [sample.at, sample.value]).collect();
    let x_label = if states.clock == Clock::Pressure { "air pressure (kPa)" } else { "time" };
    Ok(Chart {
        x_label: x_label.into(),
        y_label: name.into(),
        series: vec![
            Series::line("computed", computed).style(Style::SolidWithDots),
            Series::line("measured", measured).style(Style::Markers).colour(PALETTE[1]),
        ],
        height: 260.0,
        ..Chart::new(&format!("Measured and computed {name}"))
    })
}

fn difference(of: &str, unit: &str, differences: &[(f64, f64)], has_sign: bool) -> Difference {
    let count = differences.len();
    let mean = |of: fn(f64) -> f64| differences.iter().map(|(_, d)| of(*d)).sum::<f64>() / count.max(1) as f64;
    let largest = differences.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or_default();
    Difference {
        of: of.to_owned(),
        unit: unit.to_owned(),
        count,
        rms: mean(|d| d * d).sqrt(),
        largest: largest.1.abs(),
        largest_at: largest.0,
        mean: has_sign.then(|| mean(|d| d)),
    }
}

/// Unit in the name of a column; empty for none.
fn unit(column: &str) -> &'static str {
    let units = [
        ("_deg", "°"),
        ("_mm", "mm"),
        ("_mm2", "mm²"),
        ("_mm3", "mm³"),
        ("_kpa", "kPa"),
        ("_mpa", "MPa"),
        ("_n", "N"),
        ("_mj", "mJ"),
    ];
    units.into_iter().find(|(ending, _)| column.ends_with(ending)).map_or("", |(_, unit)| unit)
}
