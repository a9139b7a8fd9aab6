//! Measured points brought to the frame of the run: scale, rotation and offset by least squares of their distances, as far as asked for.

use pneuflex_report::comparison::Alignment;

use crate::input_error::InputError;

/// What may be fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fit {
    /// A factor of the measured coordinates.
    pub scale: bool,
    /// A rotation about the origin.
    pub rotation: bool,
    /// A translation.
    pub offset: bool,
}

impl Fit {
    /// Whether anything is.
    pub fn is_any(self) -> bool {
        self.scale || self.rotation || self.offset
    }
}

/// Rounds of Gauss–Newton; it ends when nothing moves any more.
const ROUNDS: usize = 100;

/// Below this, relative to the largest one, a pivot of the normal equations says that the points do not tell.
const UNDETERMINED: f64 = 1e-9;

/// A change of the unknowns that is none, relative to the points' extent.
const STILL: f64 = 1e-12;

/// Factor, angle (radians) and offset.
#[derive(Clone, Copy, Debug)]
struct Similarity {
    scale: f64,
    angle: f64,
    offset: [f64; 2],
}

impl Similarity {
    fn of(self, [x, z]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.angle.sin_cos();
        [self.scale * (cos * x - sin * z) + self.offset[0], self.scale * (sin * x + cos * z) + self.offset[1]]
    }
}

/// Where a point is by an alignment.
pub(super) fn aligned(alignment: &Alignment, point: [f64; 2]) -> [f64; 2] {
    let Alignment { scale, rotation_deg, offset_mm } = *alignment;
    Similarity { scale, angle: rotation_deg.to_radians(), offset: offset_mm }.of(point)
}

/// The alignment of points, whose `nearest(number, place)` is a point of their line with a unit vector away from it.
pub(super) fn align(
    points: &[[f64; 2]],
    fit: Fit,
    nearest: impl Fn(usize, [f64; 2]) -> Option<([f64; 2], [f64; 2])>,
) -> Result<Alignment, InputError> {
    let wanted = [fit.scale, fit.rotation, fit.offset, fit.offset];
    let unknowns: Vec<usize> = (0..4).filter(|&i| wanted[i]).collect();
    let extent = points.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs())).max(1e-9);
    let undetermined = || {
        InputError::new("--fit: these points do not tell what is to be fitted")
            .with_help(Some("fit less, or measure points that are further apart".into()))
    };
    if points.len() < unknowns.len() {
        return Err(undetermined());
    }
    let mut now = Similarity { scale: 1.0, angle: 0.0, offset: [0.0; 2] };
    for _ in 0..ROUNDS {
        // Rows of the least squares: how the distance grows with every unknown, all as lengths.
        let mut normal = [[0.0; 5]; 4];
        for (number, &point) in points.iter().enumerate() {
            let place = now.of(point);
            let Some((foot, away)) = nearest(number, place) else { continue };
            let turned = [place[0] - now.offset[0], place[1] - now.offset[1]];
            let along = |v: [f64; 2]| away[0] * v[0] + away[1] * v[1];
            let row = [along(turned) / now.scale / extent, along([-turned[1], turned[0]]) / extent, away[0], away[1]];
            let distance = along([place[0] - foot[0], place[1] - foot[1]]);
            for (i, &a) in unknowns.iter().enumerate() {
                for (j, &b) in unknowns.iter().enumerate() {
                    normal[i][j] += row[a] * row[b];
                }
                normal[i][4] -= row[a] * distance;
            }
        }
        let step = solve(&mut normal, unknowns.len()).ok_or_else(undetermined)?;
        let mut change = [0.0; 4];
        unknowns.iter().zip(step).for_each(|(&unknown, value)| change[unknown] = value);
        now.scale += change[0] / extent;
        now.angle += change[1] / extent;
        (0..2).for_each(|d| now.offset[d] += change[2 + d]);
        if !(now.scale.is_finite() && now.scale > 0.0) {
            return Err(undetermined());
        }
        if change.iter().all(|x| x.abs() <= STILL * extent) {
            break;
        }
    }
    Ok(Alignment { scale: now.scale, rotation_deg: now.angle.to_degrees(), offset_mm: now.offset })
}

/// Gaussian elimination of the first `count` equations with pivots on the diagonal; the matrix is symmetric and not negative.
fn solve(normal: &mut [[f64; 5]; 4], count: usize) -> Option<[f64; 4]> {
    let largest = (0..count).map(|i| normal[i][i]).fold(0.0, f64::max);
    for i in 0..count {
        if normal[i][i] <= UNDETERMINED * largest {
            return None;
        }
        let pivot = normal[i];
        for row in normal.iter_mut().take(count).skip(i + 1) {
            let factor = row[i] / pivot[i];
            (0..5).for_each(|k| row[k] -= factor * pivot[k]);
        }
    }
    let mut found = [0.0; 4];
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|k| normal[i][k] * found[k]).sum();
        found[i] = (normal[i][4] - known) / normal[i][i];
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::line::{chain, nearest};

    #[test]
    fn what_was_done_to_points_is_found_again_and_what_they_cannot_tell_is_refused() {
        let arc: Vec<[f64; 2]> =
            (0..=400).map(|i| 1.2 * f64::from(i) / 400.0).map(|a| [40.0 * a.sin(), 40.0 * a.cos() - 40.0]).collect();
        let line = chain(&[&[[0.0, 12.0], [0.0, 0.0]], &arc[..]].concat());
        let truth = Similarity { scale: 1.02, angle: 0.03, offset: [0.8, -0.5] };
        // What the truth brings onto the line.
        let inverse = |[x, z]: [f64; 2]| {
            let (sin, cos) = truth.angle.sin_cos();
            let [x, z] = [(x - truth.offset[0]) / truth.scale, (z - truth.offset[1]) / truth.scale];
            [cos * x + sin * z, cos * z - sin * x]
        };
        let on_line = [[0.0, 11.0], [0.0, 5.0], [0.0, 2.0], arc[40], arc[130], arc[222], arc[301], arc[390]];
        let points = on_line.map(inverse);
        let all = Fit { scale: true, rotation: true, offset: true };
        let found = align(&points, all, |_, at| nearest(&line, at)).unwrap();
        assert!(
            (found.scale - 1.02).abs() < 1e-6 && (found.rotation_deg.to_radians() - 0.03).abs() < 1e-6,
            "{found:?}"
        );
        assert!((0..2).all(|d| (found.offset_mm[d] - truth.offset[d]).abs() < 1e-5), "{found:?}");
        assert!(points.iter().zip(on_line).all(|(p, q)| {
            let at = aligned(&found, *p);
            (at[0] - q[0]).hypot(at[1] - q[1]) < 1e-4
        }));
        // Points of a straight line say nothing about where along it they are.
        let straight = chain(&[[0.0, 0.0], [50.0, 0.0]]);
        let flat = [[10.0, 0.3], [20.0, 0.3], [30.0, 0.3]];
        let offset = Fit { offset: true, ..Fit::default() };
        assert!(align(&flat, offset, |_, at| nearest(&straight, at)).is_err());
        assert!(align(&flat[..1], all, |_, at| nearest(&line, at)).is_err());
    }
}
