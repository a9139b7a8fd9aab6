//! What rigid motions are, in words.

use std::fmt;

use nalgebra::{DMatrix, Matrix3xX, Vector3};

/// Directions further than this from an axis are not called by its name.
const ALONG: f64 = 1e-6;

/// Turning less than this over the size of a part is none.
const NO_TURN: f64 = 1e-6;

/// Independent rigid motions of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidMotions {
    /// Orthonormal directions in which it slides without turning.
    pub translations: Vec<[f64; 3]>,
    /// Motions in which it turns.
    pub rotations: Vec<Rotation>,
    /// Radius of the part, mm.
    pub size: f64,
}

/// A motion in which a part turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// A point of the axis, mm.
    pub through: [f64; 3],
    /// Distance that it moves along the axis as it turns, mm per radian: 0 for a turn in place.
    pub pitch: f64,
}

impl RigidMotions {
    /// Those whose translations t and rotations r ω about a centre (mm) are the columns of a basis; r is the part's radius, mm.
    pub(super) fn of(basis: &DMatrix<f64>, centre: [f64; 3], radius: f64) -> Self {
        // Combinations that do not turn are the right singular vectors of the lower rows without a singular value.
        let missing = basis.ncols().saturating_sub(3);
        let turning = basis.rows(3, 3).into_owned().insert_rows(3, missing, 0.0).svd(false, true);
        let vectors = turning.v_t.unwrap_or_else(|| DMatrix::zeros(0, basis.ncols())).transpose();
        let (mut translations, mut rotations) = (Vec::new(), Vec::new());
        for k in 0..vectors.ncols() {
            let motion = basis * vectors.column(k);
            let [t, omega] = [0, 3].map(|first| Vector3::from_fn(|i, _| motion[first + i]));
            if turning.singular_values[k] <= NO_TURN {
                translations.push(t.normalize());
            } else {
                rotations.push((t, omega / radius));
            }
        }
        let across = |t: Vector3<f64>| translations.iter().fold(t, |t, slide| t - *slide * slide.dot(&t));
        let rotations = rotations.iter().map(|(t, omega)| {
            let (t, square) = (across(*t), omega.norm_squared());
            let from_centre = omega.cross(&t) / square;
            let through = std::array::from_fn(|k| centre[k] + from_centre[k]);
            Rotation { axis: omega.normalize().into(), through, pitch: t.dot(omega) / square }
        });
        let rotations = rotations.collect();
        Self { translations: translations.into_iter().map(Into::into).collect(), rotations, size: radius }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.translations.len() + self.rotations.len()
    }
}

impl fmt::Display for RigidMotions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let slides = &self.translations;
        let axes: Vec<[f64; 3]> = self.rotations.iter().map(|rotation| rotation.axis).collect();
        if !slides.is_empty() {
            write!(f, "to slide along {}", directions(slides))?;
        }
        if axes.is_empty() {
            return Ok(());
        }
        if !slides.is_empty() {
            f.write_str(", and ")?;
        }
        write!(f, "to turn about {}", directions(&axes))?;
        if let ([Rotation { through, pitch, .. }], 0 | 1) = (&self.rotations[..], slides.len()) {
            write!(f, " through {}", triple(*through))?;
            if pitch.abs() > ALONG * self.size {
                f.write_str(", and to slide along it by as much as it turns")?;
            }
        }
        Ok(())
    }
}

/// The space that some directions span, in words.
fn directions(list: &[[f64; 3]]) -> String {
    let columns: Vec<Vector3<f64>> = list.iter().map(|direction| Vector3::from(*direction)).collect();
    let span = Matrix3xX::from_columns(&columns).qr().q();
    let named: Vec<&str> = ["x", "y", "z"]
        .into_iter()
        .enumerate()
        .filter(|(axis, _)| 1.0 - span.row(*axis).norm() < ALONG)
        .map(|(_, name)| name)
        .collect();
    match (&named[..], &columns[..]) {
        ([x, y, z], _) => format!("{x}, {y} and {z}"),
        ([a, b], [_, _]) => format!("{a} and {b}"),
        ([a], [_]) => (*a).to_owned(),
        (_, [a, b]) => format!("every direction normal to {}", triple(a.cross(b).normalize().into())),
        (_, columns) => {
            let each: Vec<String> = columns.iter().map(|&direction| triple(direction.into())).collect();
            each.join(" and ")
        }
    }
}

/// Three numbers, without the digits that rounding leaves behind.
fn triple(values: [f64; 3]) -> String {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let each = values.map(|value| {
        // Adding zero makes −0 a zero.
        let shown = if value.abs() < 1e-9 * largest { 0.0 } else { value } + 0.0;
        let text = format!("{shown:.4}");
        let short = text.trim_end_matches('0').trim_end_matches('.');
        if short == "-0" { "0".to_owned() } else { short.to_owned() }
    });
    format!("({})", each.join(", "))
}
