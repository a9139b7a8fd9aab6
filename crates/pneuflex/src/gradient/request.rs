//! Which derivatives are asked for.

use std::fmt;
use std::str::FromStr;

use crate::input_error::InputError;

/// What is asked for: `COLUMN` or `COLUMN@PRESSURE`, e.g. `end_face_angle@35`.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// A column of [`crate::columns`], with or without its unit, a vector, whose length is meant, `force`, a point of the centreline such as
    /// `centreline[12.5].z` or `centreline[25%].x`, `silicone_volume` or `silicone_mass`, or a smooth measure: `von_mises_norm[12]`,
    /// `von_mises_quantile[99%]`, the same of `stretch`, `smallest_gap[0.02]`.
    pub column: String,
    /// Pressure in kPa, or time of a model, at which; `None` for the last one that is asked for.
    pub at: Option<f64>,
}

impl FromStr for Request {
    type Err = InputError;

    fn from_str(text: &str) -> Result<Self, InputError> {
        let Some((column, at)) = text.rsplit_once('@') else {
            return Ok(Self { column: text.trim().to_owned(), at: None });
        };
        let at: Option<f64> = at.trim().parse().ok().filter(|at: &f64| at.is_finite());
        match at {
            Some(at) => Ok(Self { column: column.trim().to_owned(), at: Some(at) }),
            None => Err(InputError::new(format!("{text}: expected RESULT or RESULT@PRESSURE, e.g. end_face_angle@35"))),
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at {
            Some(at) => write!(f, "{}@{at}", self.column),
            None => f.write_str(&self.column),
        }
    }
}
