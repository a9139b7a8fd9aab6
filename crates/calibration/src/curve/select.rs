//! Which columns of a table are the curve's.

use super::header::{Heading, Quantity};
use super::reading::{ColumnChoice, CurveError, ReadOptions};
use super::unit::{StrainMeasure, StressMeasure};
use crate::law::Mode;

impl ColumnChoice {
    /// From a text such as `stretch=1,stress=4` or `true-strain=Log Strain,true-stress=3,test=1`.
    ///
    /// # Errors
    /// Text of another form; what is expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let expected = "expected e.g. strain=2,stress=5 with a column's number (from 1) or name; keys: stretch, strain, \
                        percent-strain, true-strain, stress, nominal-stress, true-stress, test";
        let mut choice = Self::default();
        for part in text.split(',') {
            let (key, column) = part.split_once('=').ok_or_else(|| format!("`{part}`: {expected}"))?;
            let column = column.trim().to_owned();
            if column.is_empty() {
                return Err(format!("`{part}`: {expected}"));
            }
            match key.trim().to_lowercase().as_str() {
                "stretch" => choice.strain = Some((column, Some(StrainMeasure::Stretch))),
                "strain" => choice.strain = Some((column, None)),
                "percent-strain" => choice.strain = Some((column, Some(StrainMeasure::Percent))),
                "true-strain" => choice.strain = Some((column, Some(StrainMeasure::True))),
                "stress" => choice.stress = Some((column, None)),
                "nominal-stress" => choice.stress = Some((column, Some(StressMeasure::Nominal))),
                "true-stress" => choice.stress = Some((column, Some(StressMeasure::True))),
                "test" => choice.test = Some(column),
                _ => return Err(format!("`{}`: {expected}", key.trim())),
            }
        }
        Ok(choice)
    }
}

/// Two columns that make a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Column of stretch or strain, from 0.
    pub strain: usize,
    /// What it holds, times [`Self::strain_factor`].
    pub strain_measure: StrainMeasure,
    /// 1, or 1 over the specimen's length for a change of length.
    pub strain_factor: f64,
    /// Whether nothing but its name says that a strain is no percentage.
    pub may_be_percent: bool,
    /// Column of the stress, from 0.
    pub stress: usize,
    /// What it holds; `None` if nothing says so.
    pub stress_measure: Option<StressMeasure>,
    /// What says so, if neither its name nor the caller does.
    pub stress_evidence: Option<String>,
    /// MPa per unit; of a force, with the specimen's area.
    pub to_megapascals: f64,
    /// Name of the unit.
    pub unit: &'static str,
    /// The test, in wide tables.
    pub mode: Option<Mode>,
}

impl Pair {
    /// The nominal stress of a value of the column, MPa; what is of unknown kind is supposed to be nominal.
    pub fn nominal(&self, value: f64, stretch: f64) -> f64 {
        self.stress_measure.unwrap_or(StressMeasure::Nominal).nominal(value * self.to_megapascals, stretch)
    }
}

/// The columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// Column with the kind of test.
    pub test: Option<usize>,
    /// Pairs of columns.
    pub pairs: Vec<Pair>,
    /// Columns of the second and third principal stretch, to check the kind of test.
    pub other_stretches: [Option<usize>; 2],
}

/// Chooses the columns; `line` is the header's, and `has_number` says of a column whether the first row has a number there.
///
/// # Errors
/// Columns that are missing or cannot be told apart, a unit that nothing names.
pub fn select(
    headings: &[Heading],
    has_number: impl Fn(usize) -> bool,
    line: usize,
    options: &ReadOptions,
) -> Result<Selection, CurveError> {
    if let Some(specimen) = options.specimen {
        return force_and_displacement(headings, has_number, specimen, line, options);
    }
    let named = |column: &str| find(headings, column, line);
    let choice = &options.columns;
    let test = match &choice.test {
        Some(column) => Some(named(column)?),
        None => headings.iter().position(|h| h.quantity == Some(Quantity::Test)),
    };
    let strains = |mode: Option<Mode>| -> Vec<usize> {
        let fits = |h: &Heading| h.is_strain() && h.mode == mode && wanted_strain(h, options);
        (0..headings.len()).filter(|&i| fits(&headings[i])).collect()
    };
    let chosen_strain = choice.strain.as_ref().map(|(column, _)| named(column)).transpose()?;
    let pair = |stress: usize, mode: Option<Mode>| -> Result<Pair, CurveError> {
        let strain = match chosen_strain {
            Some(column) => column,
            None => {
                let own = strains(mode);
                let named = || Mode::ALL.map(|mode| strains(Some(mode)));
                let common = match mode {
                    _ if !own.is_empty() => own,
                    Some(_) => strains(None),
                    // `Tensile strain` beside `Nominal stress`: the one test that the strains name is that of the stress.
                    None if named().iter().filter(|of| !of.is_empty()).count() == 1 => named().concat(),
                    None => own,
                };
                // In tables of pairs without names of tests, the strain stands to the left of its stress.
                best_strain(headings, &common, line).map_err(|e| match common[..] {
                    [] => e.help(help_without(headings, &has_number)),
                    _ => e,
                })?
            }
        };
        // A column with the kind of test says more than `Tensile strain`, which machines write over any test.
        let mode = if test.is_some() { mode } else { mode.or(headings[strain].mode) };
        make_pair(headings, strain, stress, mode, line, options)
    };
    let pairs = if let Some((column, _)) = &choice.stress {
        vec![pair(named(column)?, None)?]
    } else {
        let stresses: Vec<usize> =
            (0..headings.len()).filter(|&i| headings[i].is_stress() && wanted_stress(&headings[i], options)).collect();
        let mut pairs = Vec::new();
        for mode in Mode::ALL.map(Some).into_iter().chain([None]) {
            let of_mode: Vec<usize> = stresses.iter().copied().filter(|&i| headings[i].mode == mode).collect();
            // Columns that name no test are another form of what the others hold.
            if !of_mode.is_empty() && (mode.is_some() || pairs.is_empty()) {
                pairs.push(pair(best_stress(headings, &of_mode, line)?, mode)?);
            }
        }
        pairs
    };
    if pairs.is_empty() {
        return Err(CurveError::at(line, format!("no column of stress among {}", list(headings, None)))
            .help(help_without(headings, &has_number)));
    }
    // A column that is named and not filled holds nothing.
    if let Some(pair) = pairs.iter().find(|pair| !has_number(pair.stress) && has_number(pair.strain)) {
        let message = format!("column {} holds no number in the first row", title(headings, pair.stress));
        return Err(CurveError::at(line, message).help(help_without(headings, &has_number)));
    }
    let other = |number| headings.iter().position(|h| h.quantity == Some(Quantity::OtherStretch(number)));
    Ok(Selection { test, pairs, other_stretches: [other(2), other(3)] })
}

/// What to do about a table without strain or stress.
fn help_without(headings: &[Heading], has_number: &impl Fn(usize) -> bool) -> String {
    let filled = |is: fn(&Quantity) -> bool| {
        (0..headings.len()).find(|&i| headings[i].quantity.as_ref().is_some_and(is) && has_number(i))
    };
    let force = filled(|q| matches!(q, Quantity::Force(_)));
    let displacement = filled(|q| matches!(q, Quantity::Displacement(_)));
    match (force, displacement) {
        (Some(force), Some(displacement)) => format!(
            "add --area MM2 and --length MM of the undeformed specimen, and the curve follows from columns {} and {}",
            title(headings, force),
            title(headings, displacement)
        ),
        _ => "name the columns, e.g. --columns strain=1,stress=2".into(),
    }
}

/// Force and change of length of a specimen of a known area and length.
fn force_and_displacement(
    headings: &[Heading],
    has_number: impl Fn(usize) -> bool,
    [area, length]: [f64; 2],
    line: usize,
    options: &ReadOptions,
) -> Result<Selection, CurveError> {
    let choice = &options.columns;
    let has_measure =
        choice.strain.as_ref().is_some_and(|c| c.1.is_some()) || choice.stress.as_ref().is_some_and(|c| c.1.is_some());
    if options.unit.is_some() || options.strain.is_some() || options.stress.is_some() || has_measure {
        let message = "force and change of length have units of their own, and are no strain and no stress of any kind";
        return Err(CurveError::at(line, message).help(
            "leave out --unit, --strain and --stress; --columns strain=2,stress=5 names change of length and force",
        ));
    }
    let the_one = |what: &str, chosen: Option<&str>, is: fn(&Quantity) -> bool| {
        let is_it = |i: usize| headings[i].quantity.as_ref().is_some_and(is);
        if let Some(column) = chosen {
            let found = find(headings, column, line)?;
            let message = format!("column {} is no {what} with a unit in its name", title(headings, found));
            let help = "write the unit into the column's name, as in `Load (N)` and `Position (mm)`";
            return if is_it(found) { Ok(found) } else { Err(CurveError::at(line, message).help(help)) };
        }
        let found: Vec<usize> = (0..headings.len()).filter(|&i| is_it(i) && has_number(i)).collect();
        best(headings, &found, what, line, |_| 0)
    };
    let strain = choice.strain.as_ref().map(|(column, _)| column.as_str());
    let stress = choice.stress.as_ref().map(|(column, _)| column.as_str());
    let force = the_one("force", stress, |q| matches!(q, Quantity::Force(_)))?;
    let displacement = the_one("change of length", strain, |q| matches!(q, Quantity::Displacement(_)))?;
    let factor = |column: usize| match headings[column].quantity {
        Some(Quantity::Force(factor) | Quantity::Displacement(factor)) => factor,
        _ => 1.0,
    };
    let pair = Pair {
        strain: displacement,
        strain_measure: StrainMeasure::Engineering,
        strain_factor: factor(displacement) / length,
        may_be_percent: false,
        stress: force,
        stress_measure: Some(StressMeasure::Nominal),
        stress_evidence: None,
        to_megapascals: factor(force) / area,
        unit: "MPa, by the specimen's area and length",
        mode: None,
    };
    let test = match &choice.test {
        Some(column) => Some(find(headings, column, line)?),
        None => headings.iter().position(|h| h.quantity == Some(Quantity::Test)),
    };
    Ok(Selection { test, pairs: vec![pair], other_stretches: [None, None] })
}

fn wanted_strain(heading: &Heading, options: &ReadOptions) -> bool {
    let Some(Quantity::Strain(measure)) = heading.quantity else { return false };
    // A column that is only called strain may hold engineering strain, per cent or true strain.
    options.strain.is_none_or(|wanted| wanted == measure || measure == StrainMeasure::Engineering)
}

fn wanted_stress(heading: &Heading, options: &ReadOptions) -> bool {
    let Some(Quantity::Stress(measure)) = heading.quantity else { return false };
    options.stress.is_none_or(|wanted| measure.is_none_or(|m| m == wanted))
}

fn best_strain(headings: &[Heading], among: &[usize], line: usize) -> Result<usize, CurveError> {
    let rank = |i: usize| match headings[i].quantity {
        Some(Quantity::Strain(StrainMeasure::Stretch)) => 0,
        Some(Quantity::Strain(StrainMeasure::True)) => 2,
        _ => 1,
    };
    best(headings, among, "stretch or strain", line, rank)
}

fn best_stress(headings: &[Heading], among: &[usize], line: usize) -> Result<usize, CurveError> {
    let rank = |i: usize| {
        let kind = match headings[i].quantity {
            Some(Quantity::Stress(Some(StressMeasure::Nominal))) => 0,
            Some(Quantity::Stress(None)) => 1,
            _ => 2,
        };
        let unit = match headings[i].unit {
            Some(super::unit::StressUnit::Megapascal) => 0,
            Some(_) => 1,
            None => 2,
        };
        3 * kind + unit
    };
    best(headings, among, "stress", line, rank)
}

fn best(
    headings: &[Heading],
    among: &[usize],
    what: &str,
    line: usize,
    rank: impl Fn(usize) -> usize,
) -> Result<usize, CurveError> {
    let help = "name the columns, e.g. --columns strain=1,stress=2";
    let Some(lowest) = among.iter().map(|&i| rank(i)).min() else {
        return Err(CurveError::at(line, format!("no column of {what} among {}", list(headings, None))).help(help));
    };
    let equal: Vec<usize> = among.iter().copied().filter(|&i| rank(i) == lowest).collect();
    match equal[..] {
        [one] => Ok(one),
        _ => {
            let message = format!("several columns may hold the {what}: {}", list(headings, Some(&equal)));
            Err(CurveError::at(line, message).help(help))
        }
    }
}

fn make_pair(
    headings: &[Heading],
    strain: usize,
    stress: usize,
    mode: Option<Mode>,
    line: usize,
    options: &ReadOptions,
) -> Result<Pair, CurveError> {
    let by_choice = options.columns.strain.as_ref().and_then(|c| c.1);
    let by_strain_choice = by_choice.is_some();
    let by_name = |h: &Heading| match h.quantity {
        Some(Quantity::Strain(measure)) => Some(measure),
        _ => None,
    };
    let strain_measure = by_choice.or(options.strain).or_else(|| by_name(&headings[strain]));
    let Some(strain_measure) = strain_measure else {
        let message = format!("column {} holds stretch or strain of an unknown kind", title(headings, strain));
        return Err(CurveError::at(line, message).help("add --strain stretch, engineering, percent or true"));
    };
    let by_choice = options.columns.stress.as_ref().and_then(|c| c.1);
    let by_name = |h: &Heading| match h.quantity {
        Some(Quantity::Stress(measure)) => measure,
        _ => None,
    };
    let known = by_choice.or(options.stress).or_else(|| by_name(&headings[stress]));
    let unit = match (headings[stress].unit, options.unit) {
        (Some(own), Some(other)) if own != other => {
            let message =
                format!("column {} is in {} by its name, not in {}", title(headings, stress), own.name(), other.name());
            return Err(CurveError::at(line, message).help("leave --unit out, or give it for other files only"));
        }
        (own, other) => own.or(other).ok_or_else(|| {
            CurveError::at(line, format!("the unit of column {} is not known", title(headings, stress)))
                .help("add --unit MPa, kPa, Pa, N/mm2 or psi, or write it into the column's name, as in `stress (MPa)`")
        })?,
    };
    let is_said = by_strain_choice || options.strain.is_some() || headings[strain].is_pure_number;
    Ok(Pair {
        strain,
        strain_measure,
        strain_factor: 1.0,
        may_be_percent: strain_measure == StrainMeasure::Engineering && !is_said,
        stress,
        stress_measure: known,
        stress_evidence: None,
        to_megapascals: unit.megapascals(),
        unit: unit.name(),
        mode,
    })
}

fn find(headings: &[Heading], column: &str, line: usize) -> Result<usize, CurveError> {
    if let Ok(number) = column.parse::<usize>() {
        if (1..=headings.len()).contains(&number) {
            return Ok(number - 1);
        }
        return Err(CurveError::at(line, format!("there is no column {number}: the table has {}", headings.len())));
    }
    let is_it = |h: &Heading| h.name.to_lowercase() == column.to_lowercase();
    headings
        .iter()
        .position(is_it)
        .ok_or_else(|| CurveError::at(line, format!("there is no column '{column}' among {}", list(headings, None))))
}

/// Number and name of a column, for messages.
pub fn title(headings: &[Heading], column: usize) -> String {
    match headings.get(column).map(|h| h.name.as_str()) {
        None | Some("") => format!("{}", column + 1),
        Some(name) => format!("{} '{}'", column + 1, super::reading::shown(name)),
    }
}

fn list(headings: &[Heading], some: Option<&[usize]>) -> String {
    let all: Vec<usize> = (0..headings.len()).collect();
    let numbers = some.unwrap_or(&all);
    let mut titles: Vec<String> = numbers.iter().take(12).map(|&i| title(headings, i)).collect();
    if numbers.len() > 12 {
        titles.push("…".into());
    }
    format!("columns {}", titles.join(", "))
}
