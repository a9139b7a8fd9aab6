//! Random actuators: a Latin hypercube over everything that a user chooses.
//!
//! Every quantity's range is cut into as many equal parts as there are designs, and every part is used once, in an order of its
//! own (McKay, Beckman & Conover 1979): each single quantity is covered evenly however few designs there are.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Quantities of a design, in the order of the hypercube's columns.
pub const QUANTITIES: usize = 17;

/// A design: numbers from 0 to 1, one per quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    number: usize,
    shares: [f64; QUANTITIES],
}

/// Points of a seed in the unit cube of N quantities.
pub fn latin_hypercube<const N: usize>(count: usize, seed: u64) -> Vec<[f64; N]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut points = vec![[0.0; N]; count];
    for quantity in 0..N {
        let mut parts: Vec<usize> = (0..count).collect();
        parts.shuffle(&mut random);
        for (point, part) in points.iter_mut().zip(parts) {
            point[quantity] = (part as f64 + random.random::<f64>()) / count as f64;
        }
    }
    points
}

/// The designs of a seed, as case files.
pub fn designs(count: usize, seed: u64) -> Vec<Problem> {
    problems(count, seed, |number, &shares| Design::new(number, shares).case())
}

/// A case or model file that was drawn.
pub struct Problem {
    /// Number within its corpus.
    pub number: usize,
    /// The file.
    pub text: String,
    /// Thickness of the actuator's thinnest wall, mm.
    pub thinnest_wall: f64,
}

/// The problems of a seed, each made of its number and its N numbers from 0 to 1.
pub fn problems<const N: usize>(count: usize, seed: u64, make: impl Fn(usize, &[f64; N]) -> Problem) -> Vec<Problem> {
    latin_hypercube::<N>(count, seed).iter().enumerate().map(|(number, shares)| make(number, shares)).collect()
}

/// What a design's numbers stand for, with all lengths times a scale.
pub struct Drawn {
    /// `[actuator]`, `[mesh]` and `[material]`.
    pub body: String,
    /// Length of the actuator, mm.
    pub length: f64,
    /// Its height, mm.
    pub height: f64,
    /// Shear modulus, MPa.
    pub shear_modulus: f64,
    /// Last pressure over the shear modulus.
    pub last_share: f64,
    /// First pressure over the last.
    pub first_share: f64,
    /// Thickness of the thinnest wall, mm.
    pub thinnest_wall: f64,
}

impl Design {
    /// One design with shares of its own.
    pub fn new(number: usize, shares: [f64; QUANTITIES]) -> Self {
        Self { number, shares }
    }

    /// Lengths within 40 % of the paper's actuator times `scale`, 1 to 12 chambers, Young's moduli from 5 kPa to 1 MPa times `stiffening`,
    /// pressures up to 2 to 40 % of the shear modulus (the paper ends at 9 %).
    pub fn draw(&self, scale: f64, stiffening: f64) -> Drawn {
        let mut shares = self.shares.iter().copied();
        let mut next = || shares.next().unwrap_or(0.5);
        let mut about = |length: f64| length * (0.6 + 0.8 * next());
        let (cavity_length, end_wall, gap, flange) = (about(6.0), about(1.0), about(2.0), about(2.0));
        let (cavity_half_width, side_wall, top_wall) = (about(9.0), about(1.0), about(1.0));
        let (base, cavity_height, channel_half_width, channel_height) =
            (about(4.0), about(8.0), about(1.0), about(1.0));
        let lengths = Lengths {
            chambers: 1 + (12.0 * next()).min(11.0) as usize,
            cavity_length,
            end_wall,
            gap,
            flange,
            cavity_half_width,
            side_wall,
            top_wall,
            base,
            cavity_height,
            channel_half_width,
            channel_height: channel_height.min(0.8 * base),
        };
        let youngs_modulus = geometric(next(), 5e-3, 1.0);
        let c10 = stiffening * youngs_modulus / 6.0;
        // The paper's material has 0.11 and -0.0015; the other signs are materials that soften early or stiffen strongly.
        let c20 = c10 * (-0.02 + 0.22 * next());
        let c30 = c10 * (-0.002 + 0.012 * next());
        let last_share = geometric(next(), 0.02, 0.4);
        let first_share = 0.1 + 0.4 * next();
        let body = format!(
            "{}\n[mesh]\nresolution = \"draft\"\n\n[material]\nc10 = {c10:.6}\nc20 = {c20:.6e}\nc30 = {c30:.6e}\n",
            lengths.table(scale),
        );
        let [length, height, thinnest_wall] =
            [lengths.length(), lengths.height(), lengths.thinnest_wall()].map(|length| scale * length);
        Drawn { body, length, height, shear_modulus: 2.0 * c10, last_share, first_share, thinnest_wall }
    }

    /// The case file of the design, with four pressures.
    fn case(&self) -> Problem {
        let Drawn { body, shear_modulus, last_share, first_share, thinnest_wall, .. } = self.draw(1.0, 1.0);
        let last_kpa = 1e3 * shear_modulus * last_share;
        let pressures: Vec<String> =
            [first_share, 0.6, 0.8, 1.0].map(|share| format!("{:.4}", share * last_kpa)).into();
        let text = format!(
            "title = \"design {}\"\n\n{body}\n[load]\npressure_kpa = [{}]\n\n[output]\nfields = false\n",
            self.number,
            pressures.join(", "),
        );
        Problem { number: self.number, text, thinnest_wall }
    }
}

/// Lengths of an actuator, mm, as they are drawn.
pub struct Lengths {
    /// Number of chambers.
    pub chambers: usize,
    /// Of a cavity.
    pub cavity_length: f64,
    /// Thickness of the walls between cavity and gap.
    pub end_wall: f64,
    /// Slit between chambers.
    pub gap: f64,
    /// Base beyond the first and the last chamber.
    pub flange: f64,
    /// Of a cavity.
    pub cavity_half_width: f64,
    /// Thickness.
    pub side_wall: f64,
    /// Thickness.
    pub top_wall: f64,
    /// Thickness.
    pub base: f64,
    /// Of a cavity.
    pub cavity_height: f64,
    /// Of the air channel.
    pub channel_half_width: f64,
    /// In the middle of the base.
    pub channel_height: f64,
}

impl Lengths {
    /// `[actuator]`, everything times a scale.
    pub fn table(&self, scale: f64) -> String {
        // Five significant digits of every length.
        let digits = (4.0 - scale.log10().round()).max(0.0) as usize;
        let mm = |length: f64| format!("{:.digits$}", scale * length);
        let bottom = 0.5 * (self.base - self.channel_height);
        format!(
            "[actuator]\nchambers = {}\nchamber_length = {}\ncavity_length = {}\ngap = {}\nflange = {}\nwidth = {}\nheight = {}\n\
             base = {}\nside_wall = {}\ntop_wall = {}\nchannel = {{ half_width = {}, bottom = {}, top = {} }}\n",
            self.chambers,
            mm(self.chamber_length()),
            mm(self.cavity_length),
            mm(self.gap),
            mm(self.flange),
            mm(2.0 * (self.cavity_half_width + self.side_wall)),
            mm(self.height()),
            mm(self.base),
            mm(self.side_wall),
            mm(self.top_wall),
            mm(self.channel_half_width),
            mm(bottom),
            mm(self.base - bottom),
        )
    }

    fn chamber_length(&self) -> f64 {
        self.cavity_length + 2.0 * self.end_wall
    }

    /// Of the actuator.
    pub fn length(&self) -> f64 {
        2.0 * self.flange + self.chambers as f64 * (self.chamber_length() + self.gap) - self.gap
    }

    /// Of the actuator.
    pub fn height(&self) -> f64 {
        self.base + self.cavity_height + self.top_wall
    }

    /// Thickness of the thinnest wall.
    pub fn thinnest_wall(&self) -> f64 {
        [self.end_wall, self.side_wall, self.top_wall].into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// The point at a share of a range of positive numbers, evenly in the logarithm.
pub fn geometric(share: f64, low: f64, high: f64) -> f64 {
    low * (high / low).powf(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_range_is_used_once() {
        let designs = latin_hypercube::<QUANTITIES>(40, 7);
        for quantity in 0..QUANTITIES {
            let mut parts: Vec<usize> = designs.iter().map(|shares| (40.0 * shares[quantity]) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..40).collect::<Vec<_>>());
        }
        assert_eq!(designs, latin_hypercube(40, 7));
        assert_ne!(designs, latin_hypercube(40, 8));
    }

    #[test]
    fn every_design_is_a_valid_case() {
        for design in designs(200, 1) {
            let case: pneuflex::model::Case = toml::from_str(&design.text).unwrap();
            case.validate().unwrap();
        }
    }
}
