//! Distances between shapes in the plane of bending, and measured points.

use std::path::Path;

use serde::Deserialize;

use super::record::MeasuredDistance;
use super::{Failure, Outcome};

/// A point measured on the bottom of a real actuator.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredPoint {
    /// Along the actuator at rest, from the clamp, mm.
    pub x_mm: f64,
    /// Upwards, mm.
    pub z_mm: f64,
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
}

/// Reads points from a CSV file with the columns `x_mm,z_mm,pressure_kpa` in any order.
///
/// # Errors
/// A file that cannot be read, a missing or unknown column, a number that is none or not finite (with its line), a
/// pressure that is not computed, no points at all.
pub fn read_measured(path: &Path, pressures: &[f64]) -> Outcome<Vec<MeasuredPoint>> {
    let text = std::fs::read_to_string(path).map_err(|e| Failure::at(path, e))?;
    parse_measured(&text, pressures).map_err(|what| Failure::at(path, what))
}

fn parse_measured(text: &str, pressures: &[f64]) -> Result<Vec<MeasuredPoint>, String> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    const COLUMNS: [&str; 3] = ["x_mm", "z_mm", "pressure_kpa"];
    let headers = reader.headers().map_err(|e| e.to_string())?.clone();
    let complete = COLUMNS.iter().all(|column| headers.iter().filter(|h| h == column).count() == 1);
    if !complete || headers.len() != COLUMNS.len() {
        let found: Vec<&str> = headers.iter().collect();
        return Err(format!(
            "the first line must name the columns x_mm,z_mm,pressure_kpa; it is `{}`",
            found.join(",")
        ));
    }
    let mut points = Vec::new();
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(|e| e.to_string())? {
        let line = record.position().map_or(0, csv::Position::line);
        let point: MeasuredPoint = record.deserialize(Some(&headers)).map_err(|e| match e.kind() {
            csv::ErrorKind::Deserialize { err, .. } => {
                let column = err.field().and_then(|i| headers.get(i as usize)).unwrap_or("?");
                format!("line {line}, column {column}: {}", err.kind())
            }
            _ => e.to_string(),
        })?;
        if ![point.x_mm, point.z_mm, point.pressure_kpa].iter().all(|v| v.is_finite()) {
            return Err(format!("line {line}: a number is not finite"));
        }
        if !pressures.contains(&point.pressure_kpa) {
            let known: Vec<String> = pressures.iter().map(f64::to_string).collect();
            return Err(format!(
                "line {line}: nothing is computed at {} kPa, only at {} kPa",
                point.pressure_kpa,
                known.join(", ")
            ));
        }
        points.push(point);
    }
    if points.is_empty() { Err("holds no points".into()) } else { Ok(points) }
}

/// RMS distance of the points at every pressure from two families of shapes, each a list of pressures and lines.
pub fn rms_distances(
    points: &[MeasuredPoint],
    multiple: &[(f64, Vec<[f64; 2]>)],
    single: &[(f64, Vec<[f64; 2]>)],
) -> Vec<MeasuredDistance> {
    let line = |family: &[(f64, Vec<[f64; 2]>)], p: f64| family.iter().find(|f| f.0 == p).map(|f| f.1.clone());
    let mut found = Vec::new();
    for &(pressure_kpa, _) in multiple {
        let here: Vec<[f64; 2]> =
            points.iter().filter(|p| p.pressure_kpa == pressure_kpa).map(|p| [p.x_mm, p.z_mm]).collect();
        let (Some(a), Some(b)) = (line(multiple, pressure_kpa), line(single, pressure_kpa)) else { continue };
        if here.is_empty() {
            continue;
        }
        let rms = |line: &[[f64; 2]]| {
            let sum: f64 = here.iter().map(|p| distance_to_line(*p, line).powi(2)).sum();
            (sum / here.len() as f64).sqrt()
        };
        let (multiple_point_mm, single_point_mm) = (rms(&a), rms(&b));
        found.push(MeasuredDistance { pressure_kpa, points: here.len(), multiple_point_mm, single_point_mm });
    }
    found
}

/// Distance of a point from a line through some points.
pub fn distance_to_line(p: [f64; 2], line: &[[f64; 2]]) -> f64 {
    let to_segment = |a: [f64; 2], b: [f64; 2]| {
        let d = [b[0] - a[0], b[1] - a[1]];
        let squared = d[0] * d[0] + d[1] * d[1];
        let share = if squared > 0.0 { ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / squared } else { 0.0 };
        let share = share.clamp(0.0, 1.0);
        distance(p, [a[0] + share * d[0], a[1] + share * d[1]])
    };
    line.windows(2).map(|w| to_segment(w[0], w[1])).fold(f64::INFINITY, f64::min)
}

/// Distance of two points.
pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Distance between the ends of two lines; infinite if one is empty.
pub fn tip_distance(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    match (a.last(), b.last()) {
        (Some(a), Some(b)) => distance(*a, *b),
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRESSURES: [f64; 2] = [5.0, 35.0];

    #[test]
    fn points_are_read_in_any_order_of_columns() {
        let text = "# by hand\npressure_kpa, x_mm, z_mm\n5, 10, -1.5\n35,20,-3\n";
        let points = parse_measured(text, &PRESSURES).unwrap();
        assert_eq!(points[0], MeasuredPoint { x_mm: 10.0, z_mm: -1.5, pressure_kpa: 5.0 });
        assert_eq!(points.len(), 2);
    }

    #[test]
    fn bad_files_say_what_and_where() {
        for (text, reason) in [
            ("x,z,p\n1,2,5\n", "must name the columns x_mm,z_mm,pressure_kpa; it is `x,z,p`"),
            ("x_mm,z_mm,pressure_kpa,note\n1,2,5,a\n", "must name the columns"),
            ("x_mm,z_mm,pressure_kpa\n", "holds no points"),
            ("x_mm,z_mm,pressure_kpa\n1,2,5\n1,abc,5\n", "line 3, column z_mm: "),
            ("x_mm,z_mm,pressure_kpa\n1,2\n", "found record with 2 fields"),
            ("x_mm,z_mm,pressure_kpa\n1,NaN,5\n", "line 2: a number is not finite"),
            ("x_mm,z_mm,pressure_kpa\n1,2,7\n", "line 2: nothing is computed at 7 kPa, only at 5, 35 kPa"),
        ] {
            let message = parse_measured(text, &PRESSURES).unwrap_err();
            assert!(message.contains(reason), "{message}");
        }
    }

    #[test]
    fn the_rms_distance_is_that_of_the_pressure_s_own_line() {
        let (low, high) = (vec![[0.0, 0.0], [10.0, 0.0]], vec![[0.0, 0.0], [0.0, 10.0]]);
        let point = |x_mm, z_mm, pressure_kpa| MeasuredPoint { x_mm, z_mm, pressure_kpa };
        let points = [point(5.0, 3.0, 5.0), point(5.0, -4.0, 5.0), point(2.0, 5.0, 35.0), point(0.0, 13.0, 35.0)];
        let multiple = [(5.0, low), (35.0, high.clone())];
        let found = rms_distances(&points, &multiple, &[(5.0, high.clone()), (35.0, high)]);
        assert_eq!(found.len(), 2);
        assert!((found[0].multiple_point_mm - 12.5_f64.sqrt()).abs() < 1e-12);
        assert!((found[1].multiple_point_mm - 6.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(found[1].multiple_point_mm, found[1].single_point_mm);
    }
}
