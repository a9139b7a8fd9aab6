//! Results that no table has: points of the centreline, volume and mass of the solid, smooth measures of what is largest or smallest.

use pneuflex_model::Problem;
use pneuflex_post::centreline;
use pneuflex_post::peak::{Field, Measure, Peak};
use pneuflex_post::smallest_gap::SmallestGap;

use super::results::{Part, refused};
use crate::input_error::InputError;

/// Exponents that a norm may have.
const EXPONENTS: [f64; 2] = [1.0, 100.0];

/// Shares of the volume that a quantile may be of.
const SHARES: [f64; 2] = [0.5, 0.9999];

/// Where a point of the centreline is at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Along {
    /// So many mm from the clamp.
    Distance(f64),
    /// At this share of the length.
    Share(f64),
}

impl Along {
    /// The point on a body, see [`centreline::point`].
    pub fn weights(self, problem: &Problem) -> Option<Vec<(u32, f64)>> {
        let distance = match self {
            Self::Distance(distance) => distance,
            Self::Share(share) => share * centreline::length(problem),
        };
        centreline::point(problem, distance)
    }
}

/// Results that no table has: `centreline[12.5].x_mm` and `.z_mm`, the position of the point of the bottom centreline that is 12.5 mm from the clamp
/// at rest, or with `centreline[25%]` at that share of its length; `silicone_volume_mm3` and `silicone_mass_g`; those of [`peak`] and
/// [`smallest_gap`]. Their full names and parts, at displacements (mm, one entry per node).
pub(super) fn beside_columns(
    name: &str,
    problem: &Problem,
    displacement: &[[f64; 3]],
) -> Result<Option<(String, Part)>, InputError> {
    if let Some(found) = peak(name)? {
        return Ok(Some(found));
    }
    if let Some(found) = smallest_gap(name, problem, displacement)? {
        return Ok(Some(found));
    }
    match name.trim_end_matches("_mm3").trim_end_matches("_g") {
        "silicone_volume" => return Ok(Some(("silicone_volume_mm3".to_owned(), Part::SolidVolume))),
        "silicone_mass" => {
            let (materials, of_element) = problem.materials();
            if of_element.iter().any(|material| materials[usize::from(*material)].density == 0.0) {
                return Err(refused(name, "the material has no density").of_key("material.density"));
            }
            return Ok(Some(("silicone_mass_g".to_owned(), Part::Mass)));
        }
        _ => {}
    }
    let Some((place, component)) = name.strip_prefix("centreline[").and_then(|rest| rest.split_once(']')) else {
        return Ok(None);
    };
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    let along = match place.trim().strip_suffix('%') {
        Some(percent) => number(percent).map(|percent| Along::Share(0.01 * percent)),
        None => number(place).map(Along::Distance),
    };
    let axis = match component {
        ".x" | ".x_mm" => Some(0),
        ".z" | ".z_mm" => Some(2),
        _ => None,
    };
    let (Some(along), Some(axis)) = (along, axis) else {
        return Err(refused(name, "expected e.g. centreline[12.5].z or centreline[25%].x"));
    };
    if along.weights(problem).is_none() {
        let length = centreline::length(problem);
        let why = if length > 0.0 { format!("the centreline is {length} mm long") } else { "there is none".to_owned() };
        return Err(refused(name, &why));
    }
    Ok(Some((format!("centreline[{}].{}_mm", place.trim(), ["x", "y", "z"][axis]), Part::Centreline(along, axis))))
}

/// `von_mises_norm[12]_mpa`, `von_mises_quantile[99%]_mpa` and the same of `stretch`, with or without the unit.
fn peak(name: &str) -> Result<Option<(String, Part)>, InputError> {
    let Some((kind, rest)) = name.split_once('[') else { return Ok(None) };
    let (field, unit, measure) = match kind {
        "von_mises_norm" | "von_mises_quantile" => (Field::VonMises, "_mpa", kind.trim_start_matches("von_mises_")),
        "stretch_norm" | "stretch_quantile" => (Field::Stretch, "", kind.trim_start_matches("stretch_")),
        _ => return Ok(None),
    };
    let of = rest.strip_suffix(unit).unwrap_or(rest).strip_suffix(']').unwrap_or_default();
    let within = |number: Option<f64>, [low, high]: [f64; 2]| number.filter(|number| (low..=high).contains(number));
    let measure = if measure == "norm" {
        let exponent = within(of.trim().parse().ok(), EXPONENTS).map(Measure::Norm);
        exponent.ok_or_else(|| refused(name, "expected an exponent from 1 to 100, e.g. von_mises_norm[12]"))?
    } else {
        let percent = of.trim().strip_suffix('%').and_then(|percent| percent.trim().parse::<f64>().ok());
        let share = within(percent.map(|percent| 0.01 * percent), SHARES).map(Measure::Quantile);
        share.ok_or_else(|| refused(name, "expected a share from 50% to 99.99%, e.g. von_mises_quantile[99%]"))?
    };
    Ok(Some((format!("{kind}[{}]{unit}", of.trim()), Part::Peak(Peak { field, measure }))))
}

/// `smallest_gap[0.02]_mm`, with or without the unit: smoothed by that many mm.
fn smallest_gap(
    name: &str,
    problem: &Problem,
    displacement: &[[f64; 3]],
) -> Result<Option<(String, Part)>, InputError> {
    let Some(width) =
        name.trim_end_matches("_mm").strip_suffix(']').and_then(|rest| rest.strip_prefix("smallest_gap["))
    else {
        return Ok(None);
    };
    let number = width.trim().parse().ok().filter(|width: &f64| *width > 0.0 && width.is_finite());
    let number = number.ok_or_else(|| refused(name, "expected mm above 0, e.g. smallest_gap[0.02]"))?;
    let gap = SmallestGap::at(problem, displacement, number);
    let gap = gap.ok_or_else(|| refused(name, "no walls that may touch face each other"))?;
    Ok(Some((format!("smallest_gap[{}]_mm", width.trim()), Part::Gap(gap))))
}

/// Mass of the whole body, g.
pub(super) fn mass(problem: &Problem) -> f64 {
    let (materials, of_element) = problem.materials();
    let of_material = |number: usize| {
        let elements = (0..of_element.len()).filter(|e| usize::from(of_element[*e]) == number);
        materials[number].density * problem.mesh.volume_of(elements.map(|e| e as u32))
    };
    // Densities are in g/cm³.
    1e-3 * problem.parts_of_whole() as f64 * (0..materials.len()).map(of_material).sum::<f64>()
}
