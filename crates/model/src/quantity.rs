//! Quantities that must not be mistaken for each other.

use std::fmt;
use std::ops::{Add, Sub};

use serde::{Deserialize, Serialize};

use crate::units::MPA_PER_KPA;

/// A position on a load path: what all loads, prescribed motions and obstacles are functions of (the load factor of continuation
/// methods). It has no unit of its own; what it counts is said by the problem's [`Clock`](crate::Clock): the air pressure in kPa of an
/// actuator, or the steps of a schedule. It is no time in seconds: nothing depends on how fast it passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct LoadParameter(pub f64);

impl LoadParameter {
    /// The one further along a rising path.
    pub fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
}

impl From<f64> for LoadParameter {
    fn from(value: f64) -> Self {
        Self(value)
    }
}

/// The number.
impl fmt::Display for LoadParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The increment from one position to another.
impl Sub for LoadParameter {
    type Output = f64;

    fn sub(self, start: Self) -> f64 {
        self.0 - start.0
    }
}

/// The position an increment further.
impl Add<f64> for LoadParameter {
    type Output = Self;

    fn add(self, increment: f64) -> Self {
        Self(self.0 + increment)
    }
}

/// A pressure above the atmosphere's.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Pressure {
    mpa: f64,
}

impl Pressure {
    /// From a number of MPa (N/mm²), the unit of stresses and of everything below the files.
    pub fn from_mpa(mpa: f64) -> Self {
        Self { mpa }
    }

    /// From a number of kPa, the unit of files and reports.
    pub fn from_kpa(kpa: f64) -> Self {
        Self { mpa: MPA_PER_KPA * kpa }
    }

    /// In MPa.
    pub fn mpa(self) -> f64 {
        self.mpa
    }

    /// In kPa.
    pub fn kpa(self) -> f64 {
        self.mpa / MPA_PER_KPA
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressures_keep_their_size_whatever_the_unit() {
        let pressure = Pressure::from_kpa(35.0);
        assert_eq!(pressure.mpa(), 0.035);
        assert!((pressure.kpa() - 35.0).abs() < 1e-13);
        assert_eq!(Pressure::from_mpa(0.035), pressure);
    }
}
