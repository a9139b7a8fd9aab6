//! A curve in the plane in which actuators bend, by its points.

use std::path::Path;

use pneuflex::InputError;
use pneuflex::number_table::NumberTable;

/// Points along x and z, mm, and how far along the curve they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    points: Vec<[f64; 2]>,
    lengths: Vec<f64>,
}

impl Curve {
    /// That of points in their order from the clamp, joined by straight lines.
    ///
    /// # Errors
    /// Points that are no curve, in words.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Self, String> {
        if points.as_flattened().iter().any(|x| !x.is_finite()) {
            return Err("a centreline has points whose coordinates are numbers".into());
        }
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            let last = lengths.last().copied().unwrap_or_default();
            lengths.push(last + (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        }
        if lengths.last().is_none_or(|length| *length <= 0.0) {
            return Err("a centreline has two points or more, not all at one place".into());
        }
        Ok(Self { points, lengths })
    }

    /// The point at a share of its length.
    pub fn at(&self, share: f64) -> [f64; 2] {
        let last = self.lengths.len() - 1;
        let along = share.clamp(0.0, 1.0) * self.lengths[last];
        let next = self.lengths.partition_point(|length| *length < along).clamp(1, last);
        let (from, to) = (self.lengths[next - 1], self.lengths[next]);
        let part = if to > from { (along - from) / (to - from) } else { 1.0 };
        std::array::from_fn(|d| (1.0 - part) * self.points[next - 1][d] + part * self.points[next][d])
    }
}

/// Reads a curve from a table with the columns `x_mm` and `z_mm`.
///
/// # Errors
/// A file that cannot be read, or is no such table.
pub fn read(path: &Path) -> Result<Curve, InputError> {
    let refused = |what: String| InputError::about_file(path, what);
    let table = NumberTable::read(path)?;
    let column = |name: &str| table.column(name).ok_or_else(|| refused(format!("no column is called {name}")));
    let columns = [column("x_mm")?, column("z_mm")?];
    let point = |row| Ok([table.given(row, columns[0])?, table.given(row, columns[1])?]);
    let points = (0..table.num_rows()).map(point).collect::<Result<_, InputError>>()?;
    Curve::new(points).map_err(refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_at_shares_of_the_length() {
        let curve = Curve::new(vec![[0.0, 0.0], [3.0, 0.0], [3.0, 0.0], [3.0, -1.0]]).unwrap();
        assert_eq!(
            [0.0, 0.5, 0.75, 1.0].map(|share| curve.at(share)),
            [[0.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, -1.0]]
        );
        assert!(Curve::new(vec![[0.0, 0.0]]).is_err() && Curve::new(vec![[1.0, 1.0]; 3]).is_err());
        assert!(Curve::new(vec![[0.0, 0.0], [f64::NAN, 1.0]]).is_err());
    }
}
