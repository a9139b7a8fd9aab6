//! Random actuators: a Latin hypercube over everything that a user chooses.
//!
//! Every quantity's range is cut into as many equal parts as there are designs, and every part is used once, in an order of its
//! own (McKay, Beckman & Conover 1979): each single quantity is covered evenly however few designs there are.

use std::fmt::Write as _;

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Quantities of a design, in the order of the hypercube's columns.
const QUANTITIES: usize = 17;

/// A design: numbers from 0 to 1, one per quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Number within its corpus.
    pub number: usize,
    shares: [f64; QUANTITIES],
}

/// The designs of a seed.
pub fn latin_hypercube(count: usize, seed: u64) -> Vec<Design> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut designs: Vec<Design> = (0..count).map(|number| Design { number, shares: [0.0; QUANTITIES] }).collect();
    for quantity in 0..QUANTITIES {
        let mut parts: Vec<usize> = (0..count).collect();
        parts.shuffle(&mut random);
        for (design, part) in designs.iter_mut().zip(parts) {
            design.shares[quantity] = (part as f64 + random.random::<f64>()) / count as f64;
        }
    }
    designs
}

impl Design {
    /// The case file of the design: lengths within 40 % of the paper's actuator, 1 to 12 chambers, Young's moduli from 5 kPa to
    /// 1 MPa, four pressures up to 2 to 40 % of the shear modulus (the paper ends at 9 %).
    pub fn case(&self) -> String {
        let mut shares = self.shares.iter().copied();
        let mut next = || shares.next().unwrap_or(0.5);
        let mut about = |length: f64| length * (0.6 + 0.8 * next());
        let (cavity_length, end_wall, gap, flange) = (about(6.0), about(1.0), about(2.0), about(2.0));
        let (cavity_half_width, side_wall, top_wall) = (about(9.0), about(1.0), about(1.0));
        let (base, cavity_height, channel_half_width, channel_height) =
            (about(4.0), about(8.0), about(1.0), about(1.0));
        let chambers = 1 + (12.0 * next()).min(11.0) as usize;
        let youngs_modulus = geometric(next(), 5e-3, 1.0);
        let c10 = youngs_modulus / 6.0;
        // The paper's material has 0.11 and -0.0015; the other signs are materials that soften early or stiffen strongly.
        let c20 = c10 * (-0.02 + 0.22 * next());
        let c30 = c10 * (-0.002 + 0.012 * next());
        let last_kpa = 1e3 * 2.0 * c10 * geometric(next(), 0.02, 0.4);
        let first_share = 0.1 + 0.4 * next();
        let channel_bottom = 0.5 * (base - channel_height.min(0.8 * base));
        let mut text = String::new();
        let pressures: Vec<String> =
            [first_share, 0.6, 0.8, 1.0].map(|share| format!("{:.4}", share * last_kpa)).into();
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "title = \"design {number}\"\n\n[actuator]\nchambers = {chambers}\nchamber_length = {chamber_length:.4}\n\
             cavity_length = {cavity_length:.4}\ngap = {gap:.4}\nflange = {flange:.4}\nwidth = {width:.4}\n\
             height = {height:.4}\nbase = {base:.4}\nside_wall = {side_wall:.4}\ntop_wall = {top_wall:.4}\n\
             channel = {{ half_width = {channel_half_width:.4}, bottom = {channel_bottom:.4}, top = {channel_top:.4} }}\n\n\
             [mesh]\nresolution = \"draft\"\n\n[material]\nc10 = {c10:.6}\nc20 = {c20:.6e}\nc30 = {c30:.6e}\n\n\
             [load]\npressure_kpa = [{pressures}]\n\n[output]\nfields = false\n",
            number = self.number,
            chamber_length = cavity_length + 2.0 * end_wall,
            width = 2.0 * (cavity_half_width + side_wall),
            height = base + cavity_height + top_wall,
            channel_top = base - channel_bottom,
            pressures = pressures.join(", "),
        );
        text
    }
}

/// The point at a share of a range of positive numbers, evenly in the logarithm.
fn geometric(share: f64, low: f64, high: f64) -> f64 {
    low * (high / low).powf(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_range_is_used_once() {
        let designs = latin_hypercube(40, 7);
        for quantity in 0..QUANTITIES {
            let mut parts: Vec<usize> = designs.iter().map(|d| (40.0 * d.shares[quantity]) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..40).collect::<Vec<_>>());
        }
        assert_eq!(designs, latin_hypercube(40, 7));
        assert_ne!(designs, latin_hypercube(40, 8));
    }

    #[test]
    fn every_design_is_a_valid_case() {
        for design in latin_hypercube(200, 1) {
            let case: pneuflex::model::Case = toml::from_str(&design.case()).unwrap();
            case.validate().unwrap();
        }
    }
}
