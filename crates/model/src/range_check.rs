//! Values out of range, with the keys that they are written under.

use std::fmt;

use pneuflex_mesh::{GeometryError, LENGTHS};

/// A value out of range; names the key as written in the case file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value} {}: {allowed}", self.verdict())]
pub struct CaseError {
    /// Dotted key, e.g. `mesh.size`; tables of a list by their number from 0, e.g. `probe[1].at`; what
    /// there is of every chamber by the chamber's number, from 1, e.g. `actuator.top_wall[3]`.
    pub key: String,
    /// The offending value as text.
    pub value: String,
    /// What would be allowed, in words that begin with "must"; or why the value cannot be taken, and what to do.
    pub allowed: String,
}

impl CaseError {
    /// What is wrong: a range is only spoken of where there is one.
    fn verdict(&self) -> &'static str {
        if self.allowed.starts_with("must ") { "is out of range" } else { "cannot be used" }
    }
}

impl From<GeometryError> for CaseError {
    fn from(error: GeometryError) -> Self {
        Self { key: format!("actuator.{}", error.key), value: error.value, allowed: error.allowed }
    }
}

/// Values found out of range.
#[derive(Default)]
pub(crate) struct Problems(pub(crate) Vec<CaseError>);

impl Problems {
    pub(crate) fn add(&mut self, key: &str, value: &dyn fmt::Debug, allowed: &str) {
        self.0.push(CaseError { key: key.into(), value: format!("{value:?}"), allowed: allowed.into() });
    }

    /// A number that must be greater than 0.
    pub(crate) fn unless_positive(&mut self, key: &str, value: f64, quantity: Quantity) {
        let ([least, most], unit) = (quantity.range(), quantity.unit());
        if !(least..=most).contains(&value) {
            let allowed = format!("must be a finite number greater than 0{unit}: from {least:e} to {most:e}");
            self.add(key, &value, &allowed);
        }
    }

    /// Numbers that may have either sign, or be 0; `what` says what they must be, e.g. "finite numbers".
    pub(crate) fn unless_finite(&mut self, key: &str, values: &[f64], what: &str, quantity: Quantity) {
        if !values.iter().all(|&value| quantity.allows(value)) {
            let (unit, most) = (quantity.unit(), quantity.range()[1]);
            let text = match values {
                [value] => format!("{value:?}"),
                values => format!("{values:?}"),
            };
            let allowed = format!("must be {what} of no more than {most:e}{unit}, 0 or not smaller than {TINY:e}");
            self.0.push(CaseError { key: key.into(), value: text, allowed });
        }
    }
}

/// What numbers of either sign may not be smaller than without being 0. Differences that rounding leaves are larger.
const TINY: f64 = 1e-30;

/// Kinds of quantities, each with one range wherever it occurs: what nobody means, and what computing with would overflow or vanish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// Lengths, coordinates, displacements, mm.
    Length,
    /// Moduli, constants of materials, tractions, MPa.
    Stress,
    /// Pressures of air, kPa.
    Pressure,
    /// Penalties of contact, N/mm³.
    Stiffness,
    /// Forces, N.
    Force,
    /// Accelerations, mm/s².
    Acceleration,
    /// Densities, g/cm³.
    Density,
    /// Volumes, mm³.
    Volume,
    /// Times, and steps in time.
    Time,
    /// Factors and other numbers without a unit.
    Factor,
    /// What is small enough.
    Tolerance,
}

impl Quantity {
    /// Least and largest size.
    pub(crate) const fn range(self) -> [f64; 2] {
        match self {
            Self::Length => LENGTHS,
            Self::Stress | Self::Pressure | Self::Force | Self::Acceleration | Self::Density => [1e-12, 1e12],
            Self::Time | Self::Factor => [1e-12, 1e12],
            // They follow from stresses and lengths, and lengths.
            Self::Stiffness | Self::Volume => [1e-18, 1e18],
            Self::Tolerance => [1e-18, 1e6],
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Length => " mm",
            Self::Stress => " MPa",
            Self::Pressure => " kPa",
            Self::Stiffness => " N/mm3",
            Self::Force => " N",
            Self::Acceleration => " mm/s2",
            Self::Density => " g/cm3",
            Self::Volume => " mm3",
            Self::Time | Self::Factor | Self::Tolerance => "",
        }
    }

    /// Whether a number of either sign is one of this kind.
    pub(crate) fn allows(self, value: f64) -> bool {
        value == 0.0 || (TINY..=self.range()[1]).contains(&value.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_means_numbers_at_the_end_of_what_can_be_written() {
        use Quantity::{
            Acceleration, Density, Factor, Force, Length, Pressure, Stiffness, Stress, Time, Tolerance, Volume,
        };
        let all = [Length, Stress, Pressure, Stiffness, Force, Acceleration, Density, Volume, Time, Factor, Tolerance];
        for quantity in all {
            for bad in [5e-324, -5e-324, 1e300, -1e308, f64::NAN, f64::INFINITY] {
                let mut found = Problems::default();
                found.unless_positive("key", bad, quantity);
                found.unless_finite("key", &[1.0, bad], "finite numbers", quantity);
                assert_eq!(found.0.len(), 2, "{quantity:?} {bad}");
            }
            let mut found = Problems::default();
            quantity.range().into_iter().for_each(|good| found.unless_positive("key", good, quantity));
            found.unless_finite("key", &[0.0, -0.0, 6e-17, -1.0, quantity.range()[1]], "finite numbers", quantity);
            assert_eq!(found.0, []);
            found.unless_positive("key", 0.0, quantity);
            assert_eq!(found.0.len(), 1);
        }
    }
}
