//! Measurements as a table: a row for every pressure or time at which something was measured.

use std::path::Path;

use crate::input_error::InputError;

/// Columns with places of points.
const POINT: [&str; 2] = ["x_mm", "z_mm"];

/// A measured number, or a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample<T> {
    /// Pressure, kPa, or time.
    pub at: f64,
    pub value: T,
}

/// What a file has.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Measured {
    /// Places x, z, mm.
    pub points: Vec<Sample<[f64; 2]>>,
    /// Numbers by the column that they are compared with.
    pub numbers: Vec<(String, Vec<Sample<f64>>)>,
}

impl Measured {
    /// Reads the text of a file, whose rows stand at values of a parameter, `pressure_kpa` or `time`.
    pub fn read(path: &Path, text: &str, parameter: &str) -> Result<Self, InputError> {
        let wrong = |what: String| InputError::about_file(path, what);
        let header = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
        let delimiter = if header.contains(';') && !header.contains(',') { b';' } else { b',' };
        let mut reader = csv::ReaderBuilder::new();
        reader.delimiter(delimiter).comment(Some(b'#')).trim(csv::Trim::All).flexible(false);
        let mut reader = reader.from_reader(text.trim_start_matches('\u{feff}').as_bytes());
        let names: Vec<String> =
            reader.headers().map_err(|e| wrong(e.to_string()))?.iter().map(str::to_owned).collect();
        let place = |name: &str| names.iter().position(|other| other == name);
        let help = format!(
            "its first line has the names of the columns, e.g. {parameter},x_mm,z_mm or {parameter},end_face_angle_deg"
        );
        let at = place(parameter).ok_or_else(|| {
            wrong(format!("there is no column {parameter}, by which this run's states are known"))
                .with_help(Some(help.clone()))
        })?;
        if let Some(name) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)).map(|(_, name)| name)
        {
            return Err(wrong(format!("there are two columns {name}")));
        }
        let point = match POINT.map(place) {
            [Some(x), Some(z)] => Some([x, z]),
            [None, None] => None,
            _ => return Err(wrong("a point has both x_mm and z_mm".into())),
        };
        let is_number = |column: &usize| *column != at && point.is_none_or(|point| !point.contains(column));
        let columns: Vec<usize> = (0..names.len()).filter(is_number).collect();
        let mut found = Self {
            numbers: columns.iter().map(|&column| (names[column].clone(), Vec::new())).collect(),
            ..Self::default()
        };
        for record in reader.records() {
            let record = record.map_err(|e| wrong(e.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |column: usize| -> Result<Option<f64>, InputError> {
                let cell = &record[column];
                let not_one = || wrong(format!("line {line}: {} = {cell:?} is no finite number", names[column]));
                let number = (!cell.is_empty()).then(|| cell.parse::<f64>().map_err(|_| not_one())).transpose()?;
                number.map_or(Ok(None), |number| if number.is_finite() { Ok(Some(number)) } else { Err(not_one()) })
            };
            let at = number(at)?.ok_or_else(|| wrong(format!("line {line}: {parameter} is empty")))?;
            if let Some(point) = point {
                match [number(point[0])?, number(point[1])?] {
                    [Some(x), Some(z)] => found.points.push(Sample { at, value: [x, z] }),
                    [None, None] => {}
                    _ => return Err(wrong(format!("line {line}: a point has both x_mm and z_mm"))),
                }
            }
            for (&column, (_, samples)) in columns.iter().zip(&mut found.numbers) {
                samples.extend(number(column)?.map(|value| Sample { at, value }));
            }
        }
        found.numbers.retain(|(_, samples)| !samples.is_empty());
        if found.points.is_empty() && found.numbers.is_empty() {
            return Err(wrong("there are no measurements in it".into()).with_help(Some(help)));
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Measured, String> {
        Measured::read(Path::new("m.csv"), text, "pressure_kpa").map_err(|e| e.to_string())
    }

    #[test]
    fn points_and_numbers_stand_in_one_table_and_cells_may_be_empty() {
        let found =
            read("# camera\npressure_kpa, x_mm, z_mm, chord_angle_deg\n5, 10, -1, 2.5\n5, 20, -3,\n15,,, 7\n").unwrap();
        let sample = |at, value| Sample { at, value };
        assert_eq!(found.points, [Sample { at: 5.0, value: [10.0, -1.0] }, Sample { at: 5.0, value: [20.0, -3.0] }]);
        assert_eq!(found.numbers, [("chord_angle_deg".to_owned(), vec![sample(5.0, 2.5), sample(15.0, 7.0)])]);
        assert_eq!(read("pressure_kpa;x_mm;z_mm\n5;1;2\n").unwrap().points.len(), 1);
    }

    #[test]
    fn what_is_no_table_of_measurements_is_refused() {
        for (text, words) in [
            ("time,x_mm,z_mm\n1,2,3\n", "there is no column pressure_kpa"),
            ("pressure_kpa,x_mm\n1,2\n", "both x_mm and z_mm"),
            ("pressure_kpa,x_mm,z_mm\n1,2,\n", "line 2: a point has both"),
            ("pressure_kpa,angle\n1,two\n", "line 2: angle = \"two\" is no finite number"),
            ("pressure_kpa,angle\n,2\n", "line 2: pressure_kpa is empty"),
            ("pressure_kpa,angle,angle\n1,2,3\n", "two columns angle"),
            ("pressure_kpa,angle\n1,\n", "there are no measurements in it"),
            ("pressure_kpa,angle\n1\n", "found record with 1 fields"),
        ] {
            let refused = read(text).unwrap_err();
            assert!(refused.contains(words), "{text:?}: {refused}");
        }
    }
}
