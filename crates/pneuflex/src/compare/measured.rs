//! Measurements as a table: a row for every pressure or time at which something was measured.

use std::path::Path;

use crate::input_error::InputError;
use crate::number_table::NumberTable;

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
        let table = NumberTable::of(path, text)?;
        let place = |name: &str| table.column(name);
        let help = format!(
            "its first line has the names of the columns, e.g. {parameter},x_mm,z_mm or {parameter},end_face_angle_deg"
        );
        let at = place(parameter).ok_or_else(|| {
            wrong(format!("there is no column {parameter}, by which this run's states are known"))
                .with_help(Some(help.clone()))
        })?;
        let point = match POINT.map(place) {
            [Some(x), Some(z)] => Some([x, z]),
            [None, None] => None,
            _ => return Err(wrong("a point has both x_mm and z_mm".into())),
        };
        let is_number = |column: &usize| *column != at && point.is_none_or(|point| !point.contains(column));
        let names = table.names();
        let columns: Vec<usize> = (0..names.len()).filter(is_number).collect();
        let mut found = Self {
            numbers: columns.iter().map(|&column| (names[column].clone(), Vec::new())).collect(),
            ..Self::default()
        };
        for row in 0..table.num_rows() {
            let at = table.given(row, at)?;
            if let Some([x, z]) = point {
                match [table.number(row, x)?, table.number(row, z)?] {
                    [Some(x), Some(z)] => found.points.push(Sample { at, value: [x, z] }),
                    [None, None] => {}
                    _ => return Err(table.refused(row, ": a point has both x_mm and z_mm")),
                }
            }
            for (&column, (_, samples)) in columns.iter().zip(&mut found.numbers) {
                samples.extend(table.number(row, column)?.map(|value| Sample { at, value }));
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
            ("pressure_kpa,angle\n1,two\n", "line 2, angle: \"two\" is no number"),
            ("pressure_kpa,angle\n,2\n", "line 2, pressure_kpa: it is empty"),
            ("pressure_kpa,angle,angle\n1,2,3\n", "two columns are called \"angle\""),
            ("pressure_kpa,angle\n1,\n", "there are no measurements in it"),
            ("pressure_kpa,angle\n1\n", "found record with 1 fields"),
        ] {
            let refused = read(text).unwrap_err();
            assert!(refused.contains(words), "{text:?}: {refused}");
        }
    }
}
