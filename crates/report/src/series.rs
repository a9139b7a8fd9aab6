//! What is plotted against pressure.

use pneuflex_mesh::actuator::Part;
use pneuflex_post::measures;
use serde::Serialize;

use crate::{Report, ReportError};

/// Numbers at one pressure, for the whole body even if a half of it was modelled.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Air pressure, kPa.
    pub pressure: f64,
    /// Angle of the end face, degrees, positive downwards.
    pub angle: f64,
    /// Bottom centreline, \[x, z\] in mm from the clamp to the tip; empty for a mesh without one.
    pub centreline: Vec<[f64; 2]>,
    /// Volume of the air, cm³.
    pub volume: f64,
    /// Area in contact, mm².
    pub contact_area: f64,
    /// von Mises stress not exceeded in 99 % of the volume, MPa.
    pub stress: f64,
}

/// The body at rest, followed by every landed pressure.
///
/// # Errors
/// A volume at rest that cannot be found, or a number that is not finite.
pub fn of(report: &Report<'_>) -> Result<Vec<Point>, ReportError> {
    let halves = halves(report);
    let rest = vec![0.0; report.problem.num_dofs()];
    let volume = |mm3: f64| halves * mm3 / 1000.0;
    let mut points = vec![Point {
        pressure: 0.0,
        angle: 0.0,
        centreline: measures::centreline(report.problem, &rest)?,
        volume: volume(measures::cavity_volume(report.problem, &rest)?),
        contact_area: 0.0,
        stress: 0.0,
    }];
    points.extend(report.summary.landed().map(|(pressure, landed)| Point {
        pressure,
        angle: landed.end_face_angle_deg,
        centreline: landed.centreline.clone(),
        volume: volume(landed.cavity_volume_mm3),
        contact_area: halves * landed.contact.area_mm2,
        stress: landed.von_mises_p99_mpa,
    }));
    let is_finite = |p: &Point| {
        let numbers = [p.pressure, p.angle, p.volume, p.contact_area, p.stress];
        numbers.iter().chain(p.centreline.as_flattened()).all(|x| x.is_finite())
    };
    if points.iter().all(is_finite) { Ok(points) } else { Err(ReportError::NotFinite("summary.json".into())) }
}

/// How many of the modelled part make the whole body.
pub fn halves(report: &Report<'_>) -> f64 {
    match report.case.actuator.part {
        Part::Half => 2.0,
        Part::Whole => 1.0,
    }
}
