//! From a table to curves.

use super::decimal::{DecimalSign, Evidence, is_number, number};
use super::header::{Header, Heading, Quantity, is_unit};
use super::reading::{Curve, CurveError, MAX_BYTES, MAX_POINTS, Point, ReadOptions, Reading, shown};
use super::select::{Pair, Selection, select, title};
use super::stress_measure;
use super::table::{LOOK_AHEAD, Row, lines, separator, split};
use super::unit::{StrainMeasure, StressMeasure};
use crate::law::Mode;
use crate::test_name;
use crate::words::words_of;

/// No rubber is stretched to more than this engineering strain.
const LARGEST_STRAIN: f64 = 30.0;

/// Largest engineering strain of a curve from which on it may as well be in per cent that nobody declared.
const AMBIGUOUS_STRAIN: f64 = 2.5;

/// Largest difference of true strain and ln(1 + engineering strain) in a file that gives both.
const STRAIN_TOLERANCE: f64 = 0.02;

/// Largest deviation of det F from 1, and of stretches that a test makes equal, where a file gives all three.
const STRETCH_TOLERANCE: f64 = 0.02;

/// Reads the curves of a file.
///
/// # Errors
/// What cannot be understood, with its line, its column and what was expected.
pub fn read(file: &str, text: &str, options: &ReadOptions) -> Result<Reading, CurveError> {
    if text.len() > MAX_BYTES {
        return Err(CurveError::new(format!("the text has more than {} MiB", MAX_BYTES >> 20)));
    }
    let separator = separator(text)?;
    let header = find_header(text, separator)?;
    let first = lines(text).find(|(n, _)| *n > header.line);
    let first = first.map(|(n, l)| split(n, l, separator)).transpose()?;
    let has_number = |column: usize| first.as_ref().is_some_and(|row| is_number(row.cell(column)));
    let mut selection = select(&header.headings, has_number, header.line, options)?;
    let decimal = decimal_sign(text, separator, &header, options)?;
    stress_measure::find(&mut selection, &header, separator, decimal, text);
    let from_elsewhere = test_of_file(file, text, header.line, options);
    settle_test(&mut selection, &header, from_elsewhere.as_ref(), options)?;
    let reader = Reader { separator, decimal, header: &header, selection: &selection, single: from_elsewhere.as_ref() };
    let mut curves = reader.curves(file, text)?;
    let is_compression =
        curves.iter_mut().filter(|curve| curve.mode == Mode::Uniaxial).try_fold(false, |any, curve| {
            Ok(any | (is_about_compression(file, text, &header) && reader.turn_compression(curve)?))
        })?;
    stress_measure::refuse_unknown(&selection, &header, &curves)?;
    let mut understood = describe(&reader, &curves);
    if is_compression {
        understood.insert(0, "compression with positive signs: strains and stresses are taken as negative".into());
    }
    Ok(Reading { curves, understood })
}

/// Whether the file's name, a line above the table or a name in it speaks of compression, and nothing of tension.
fn is_about_compression(file: &str, text: &str, header: &Header) -> bool {
    let names = header.headings.iter().map(|heading| heading.name.as_str());
    let above = lines(text).take_while(|(n, _)| *n < header.line).take(LOOK_AHEAD).map(|(_, line)| line);
    let all: Vec<String> =
        above.chain(names).chain([file.rsplit(['/', '\\']).next().unwrap_or(file)]).flat_map(words_of).collect();
    let has = |parts: &[&str]| all.iter().any(|word| parts.iter().any(|part| word.starts_with(part)));
    has(&["compress", "druckversuch", "stauch"]) && !has(&["tensi", "tensile", "zugversuch"])
}

fn find_header(text: &str, separator: u8) -> Result<Header, CurveError> {
    let rows: Vec<Row> = lines(text).take(LOOK_AHEAD).map(|(n, l)| split(n, l, separator)).collect::<Result<_, _>>()?;
    let first_data = rows.iter().position(|row| row.count_numbers() >= 2);
    let mut candidates = (0..rows.len()).filter_map(|i| header_at(&rows, i));
    let mut first = None;
    let is_curve = |h: &Header| h.headings.iter().any(Heading::is_strain) && h.headings.iter().any(Heading::is_stress);
    let found = candidates.find(|h| {
        if first.is_none() {
            first = Some(h.clone());
        }
        is_curve(h)
    });
    if let Some(header) = found.or(first) {
        return Ok(header);
    }
    // A table without names: its columns can still be told by their numbers.
    let row = first_data.map(|i| &rows[i]);
    let row = row.ok_or_else(|| CurveError::new("no line with two numbers was found near the beginning"))?;
    Ok(Header { headings: row.cells.iter().map(|_| Heading::new("")).collect(), line: row.line - 1 })
}

/// The header in row `i`, if names stand there and numbers below, perhaps with a row of units in between.
fn header_at(rows: &[Row], i: usize) -> Option<Header> {
    let row = &rows[i];
    if row.count_numbers() > 0 || row.cells.iter().filter(|c| !c.is_empty()).count() < 2 {
        return None;
    }
    let units = rows.get(i + 1).filter(|r| r.count_numbers() == 0 && r.cells.iter().all(|c| is_unit(c)));
    rows.get(if units.is_some() { i + 2 } else { i + 1 }).filter(|r| r.count_numbers() >= 2)?;
    let unit_of = |column: usize| units.map_or("", |r| r.cell(column));
    let headings = row.cells.iter().enumerate().map(|(c, name)| Heading::new(&format!("{name} {}", unit_of(c))));
    Some(Header { headings: headings.collect(), line: units.map_or(row.line, |r| r.line) })
}

/// The decimal sign: a comma only where commas separate no cells and cannot group thousands.
fn decimal_sign(text: &str, separator: u8, header: &Header, options: &ReadOptions) -> Result<DecimalSign, CurveError> {
    if let Some(sign) = options.decimal {
        return Ok(sign);
    }
    if separator == b',' {
        return Ok(DecimalSign::Point);
    }
    let mut evidence = Evidence::default();
    for (n, l) in lines(text).skip_while(|(n, _)| *n <= header.line).take(LOOK_AHEAD) {
        split(n, l, separator)?.cells.iter().for_each(|c| evidence.add(c, n));
    }
    let help = "say which with --decimal comma or --decimal point";
    match (evidence.comma, evidence.point) {
        (None, _) => Ok(DecimalSign::Point),
        (Some(comma), Some(point)) => {
            let message = format!("decimal commas here and decimal points in line {point}");
            Err(CurveError::at(comma, message).help(help))
        }
        (Some(_), None) if evidence.comma_is_decimal => Ok(DecimalSign::Comma),
        (Some(line), None) => {
            Err(CurveError::at(line, "commas may be decimal or separate thousands in this file").help(help))
        }
    }
}

/// The test of a file that names none in its table, and how it is known.
fn test_of_file(file: &str, text: &str, header_line: usize, options: &ReadOptions) -> Option<(Mode, String)> {
    if let Some(mode) = options.test {
        return Some((mode, "as given".into()));
    }
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    // An abbreviation counts if nothing else stands there: `ut.csv` is clear, `sample_ET_3.csv` may be anything.
    let stem = stem.rsplit_once('.').map_or(stem, |(name, _)| name);
    let abbreviated = || test_name::find(stem).filter(|_| words_of(stem).len() == 1);
    if let Some(mode) = test_name::find_spelled_out(stem).or_else(abbreviated) {
        return Some((mode, "by the file's name".into()));
    }
    let above = lines(text).take_while(|(n, _)| *n < header_line);
    for (n, line) in above.take(LOOK_AHEAD) {
        let words = words_of(line);
        let has = |pair: [&str; 2]| words.windows(2).any(|w| w[0] == pair[0] && w[1] == pair[1]);
        if [["astm", "d412"], ["iso", "37"], ["din", "53504"]].into_iter().any(has) {
            return Some((Mode::Uniaxial, format!("by the standard in line {n}")));
        }
        let names_a_test = words.iter().any(|w| ["test", "mode", "loading", "versuch"].contains(&w.as_str()));
        let abbreviated = || test_name::find(line).filter(|_| names_a_test);
        if let Some(mode) = test_name::find_spelled_out(line).or_else(abbreviated) {
            return Some((mode, format!("by line {n}")));
        }
    }
    None
}

/// The kind of test of a table whose columns name a single one. `Tensile strain` stands over planar and equibiaxial tests, too: what the caller
/// says comes first, and where the file says something else, the caller has to.
fn settle_test(
    selection: &mut Selection,
    header: &Header,
    from_elsewhere: Option<&(Mode, String)>,
    options: &ReadOptions,
) -> Result<(), CurveError> {
    let Some((said, how)) = from_elsewhere else { return Ok(()) };
    let Some(Some(of_columns)) = selection.pairs.first().map(|pair| pair.mode) else { return Ok(()) };
    let are_several = selection.pairs.iter().any(|pair| pair.mode != Some(of_columns));
    if are_several || of_columns == *said {
        return Ok(());
    }
    if options.test.is_none() {
        let message =
            format!("the test is {} by the names of the columns, and {} {how}", of_columns.name(), said.name());
        return Err(CurveError::at(header.line, message).help("add --test uniaxial, equibiaxial or planar"));
    }
    selection.pairs.iter_mut().for_each(|pair| pair.mode = None);
    Ok(())
}

struct Reader<'a> {
    separator: u8,
    decimal: DecimalSign,
    header: &'a Header,
    selection: &'a Selection,
    single: Option<&'a (Mode, String)>,
}

impl Reader<'_> {
    fn curves(&self, file: &str, text: &str) -> Result<Vec<Curve>, CurveError> {
        let mut largest: Option<(f64, Row)> = None;
        let mut curves = Mode::ALL.map(|mode| Curve { file: file.to_owned(), mode, points: Vec::new() });
        let mut count = 0;
        for (line, text) in lines(text).skip_while(|(n, _)| *n <= self.header.line) {
            let row = split(line, text, self.separator)?;
            self.refuse_decimal_commas(&row)?;
            for pair in &self.selection.pairs {
                let Some(point) = self.point(&row, pair)? else { continue };
                let mode = self.mode(&row, pair)?;
                self.check_stretches(&row, mode, point.stretch)?;
                count += 1;
                if count > MAX_POINTS {
                    return Err(CurveError::at(line, format!("more than {MAX_POINTS} points")).help("thin the curve"));
                }
                curves[mode as usize].points.push(point);
                let strain = number(row.cell(pair.strain), self.decimal).unwrap_or(0.0);
                if pair.may_be_percent && largest.as_ref().is_none_or(|(most, _)| strain > *most) {
                    largest = Some((strain, row.clone()));
                }
            }
        }
        if let Some((strain, row)) = largest {
            self.refuse_undeclared_percent(strain, &row)?;
        }
        let curves: Vec<Curve> = curves.into_iter().filter(|c| !c.points.is_empty()).collect();
        if curves.is_empty() {
            return Err(CurveError::at(self.header.line, "no numbers below the header"));
        }
        Ok(curves)
    }

    /// Turns the signs of a test of compression whose machine writes strains and stresses as positive numbers; whether it does.
    fn turn_compression(&self, curve: &mut Curve) -> Result<bool, CurveError> {
        if curve.points.iter().any(|p| p.stretch < 1.0 || p.stress < 0.0) {
            return Ok(false);
        }
        let plain = |pair: &Pair| {
            matches!(pair.strain_measure, StrainMeasure::Engineering | StrainMeasure::Percent)
                && pair.stress_measure != Some(StressMeasure::True)
        };
        if !self.selection.pairs.iter().all(plain) || curve.points.iter().any(|p| p.stretch >= 2.0) {
            let message = "a test of compression with positive signs: stretches must be less than 1, stresses negative";
            return Err(CurveError::new(message).help("change the signs in the file"));
        }
        for point in &mut curve.points {
            *point = Point { stretch: 2.0 - point.stretch, stress: -point.stress, ..*point };
        }
        Ok(true)
    }

    /// Strains up to 25 without a unit are 25 % to most people, and 2500 % to some machines. A true strain beside it decides.
    fn refuse_undeclared_percent(&self, strain: f64, row: &Row) -> Result<(), CurveError> {
        let headings = &self.header.headings;
        let is_true = |h: &Heading| h.quantity == Some(Quantity::Strain(StrainMeasure::True));
        let truth = headings.iter().position(is_true).and_then(|column| number(row.cell(column), self.decimal));
        if strain <= AMBIGUOUS_STRAIN || truth.is_some_and(|t| (t - strain.ln_1p()).abs() < STRAIN_TOLERANCE) {
            return Ok(());
        }
        let column = self.selection.pairs.iter().find(|pair| pair.may_be_percent).map_or(0, |pair| pair.strain);
        let message = format!(
            "column {}: strains up to {strain} may be {strain} % (a stretch of {:.4}) or {:.0} % (a stretch of {:.4})",
            title(headings, column),
            1.0 + 0.01 * strain,
            100.0 * strain,
            1.0 + strain,
        );
        Err(CurveError::at(row.line, message).help("add --strain percent, or --strain engineering if 1 is 100 %"))
    }

    /// A row of `1,5,2,3` under two names would give wrong numbers without a word.
    fn refuse_decimal_commas(&self, row: &Row) -> Result<(), CurveError> {
        let columns = self.header.headings.len();
        if row.cells.len() <= columns || row.cells[columns..].iter().all(|c| c.is_empty()) {
            return Ok(());
        }
        let message = format!("{} cells under a header of {columns}", row.cells.len());
        Err(CurveError::at(row.line, message).help("numbers with decimal commas need semicolons or tabs between them"))
    }

    fn point(&self, row: &Row, pair: &Pair) -> Result<Option<Point>, CurveError> {
        let [strain, stress] = [pair.strain, pair.stress].map(|c| row.cell(c));
        if strain.is_empty() && stress.is_empty() {
            return Ok(None);
        }
        // In wide tables with one column of strain, not every test has a stress at every strain.
        if stress.is_empty() && self.selection.pairs.iter().filter(|p| p.strain == pair.strain).count() > 1 {
            return Ok(None);
        }
        let value = |column: usize| {
            let cell = row.cell(column);
            number(cell, self.decimal).ok_or_else(|| {
                let sign = match self.decimal {
                    DecimalSign::Point => "",
                    DecimalSign::Comma => " with a decimal comma",
                };
                let title = title(&self.header.headings, column);
                let what = if cell.is_empty() { "is empty".into() } else { format!("`{}`", shown(cell)) };
                CurveError::at(row.line, format!("column {title}: {what}; expected a finite number{sign}"))
            })
        };
        let strain = pair.strain_factor * value(pair.strain)?;
        let stretch = pair.strain_measure.stretch(strain);
        let title = title(&self.header.headings, pair.strain);
        if !(stretch > 0.0 && stretch.is_finite()) {
            let message = format!(
                "column {title}: {strain} as {} is a stretch of {stretch}; it must be greater than 0",
                pair.strain_measure.name()
            );
            return Err(CurveError::at(row.line, message).help("say what it is with --strain"));
        }
        if !pair.may_be_percent && pair.strain_measure == StrainMeasure::Engineering && strain > LARGEST_STRAIN {
            let message = format!("column {title}: an engineering strain of {strain} is more than {LARGEST_STRAIN}");
            return Err(CurveError::at(row.line, message).help("add --strain percent if it is in per cent"));
        }
        let stress = pair.nominal(value(pair.stress)?, stretch);
        if !stress.is_finite() {
            return Err(CurveError::at(row.line, format!("column {title}: the nominal stress is beyond all bounds")));
        }
        Ok(Some(Point { stretch, stress, line: row.line }))
    }

    fn mode(&self, row: &Row, pair: &Pair) -> Result<Mode, CurveError> {
        if let Some(mode) = pair.mode {
            return Ok(mode);
        }
        let help = "add --test uniaxial, equibiaxial or planar";
        if let Some(column) = self.selection.test {
            let cell = row.cell(column);
            if let Some(mode) = test_name::find(cell) {
                return Ok(mode);
            }
            // A number there counts specimens.
            if self.single.is_none() || !is_number(cell) {
                let title = title(&self.header.headings, column);
                let message = format!(
                    "column {title}: `{}` is no known test; expected uniaxial (ut), equibiaxial (et) or planar (ps)",
                    shown(cell)
                );
                return Err(CurveError::at(row.line, message).help(help));
            }
        }
        let known = self.single.map(|(mode, _)| *mode);
        known
            .ok_or_else(|| CurveError::new("which test this is stands neither in its table nor in its name").help(help))
    }

    /// Where a file gives the other principal stretches, they must be those of the test.
    fn check_stretches(&self, row: &Row, mode: Mode, stretch: f64) -> Result<(), CurveError> {
        let expected = mode.stretches(stretch);
        for (number_of, column) in self.selection.other_stretches.iter().enumerate() {
            let Some(column) = *column else { continue };
            let Some(found) = number(row.cell(column), self.decimal) else { continue };
            let expected = expected[number_of + 1];
            if (found / expected - 1.0).abs() > STRETCH_TOLERANCE {
                let title = title(&self.header.headings, column);
                let message = format!(
                    "column {title}: {found} where a {} test of stretch {stretch} has {expected:.4}",
                    mode.name()
                );
                return Err(CurveError::at(row.line, message).help("is this another test, or F not what it seems?"));
            }
        }
        Ok(())
    }
}

fn describe(reader: &Reader, curves: &[Curve]) -> Vec<String> {
    let headings = &reader.header.headings;
    let separator = match reader.separator {
        b';' => "semicolons",
        b'\t' => "tabs",
        b' ' => "blanks",
        _ => "commas",
    };
    let is = |column: usize| match headings.get(column).and_then(|h| h.quantity) {
        Some(Quantity::Force(_) | Quantity::Displacement(_)) => "gives",
        _ => "is",
    };
    let sign = if reader.decimal == DecimalSign::Comma { ", decimal commas" } else { "" };
    let mut lines = Vec::new();
    let has_modes = reader.selection.pairs.iter().all(|p| p.mode.is_some()) || reader.selection.test.is_some();
    let how = match reader.single {
        Some((_, how)) if !has_modes => format!(" ({how})"),
        _ => String::new(),
    };
    for curve in curves {
        let stretches = curve.points.iter().map(|p| p.stretch);
        let (low, high) = stretches.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s), b.max(s)));
        let count = curve.points.len();
        lines.push(format!("{}{how}: {count} points, stretch {low:.4} to {high:.4}", curve.mode.name()));
    }
    for pair in &reader.selection.pairs {
        let (measure, how) = match (pair.stress_measure, &pair.stress_evidence) {
            (None, _) => (StressMeasure::Nominal, " (supposed; --stress true otherwise)".into()),
            (Some(measure), Some(evidence)) => (measure, format!(" ({evidence})")),
            (Some(measure), None) => (measure, String::new()),
        };
        lines.push(format!(
            "cells between {separator}{sign}; column {} {} {}, column {} {} {}{how} in {}",
            title(headings, pair.strain),
            is(pair.strain),
            pair.strain_measure.name(),
            title(headings, pair.stress),
            is(pair.stress),
            measure.name(),
            pair.unit,
        ));
    }
    let used = |i: usize| {
        reader.selection.test == Some(i)
            || reader.selection.other_stretches.contains(&Some(i))
            || reader.selection.pairs.iter().any(|p| p.strain == i || p.stress == i)
    };
    let unused: Vec<String> = (0..headings.len())
        .filter(|&i| !used(i) && (headings[i].is_strain() || headings[i].is_stress()))
        .map(|i| title(headings, i))
        .collect();
    if !unused.is_empty() {
        lines.push(format!("not used: column {}", unused.join(", column ")));
    }
    lines
}
