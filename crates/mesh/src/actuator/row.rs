//! The chambers one after the other, and what fills a point among them.

use super::lengths::Actuator;

/// A chamber in the row, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chamber {
    /// Where it begins along x.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
    /// Where its cavity begins and ends.
    pub cavity: [f64; 2],
    /// Thickness of its side walls.
    pub side_wall: f64,
    /// Thickness of the wall above its cavity.
    pub top_wall: f64,
    /// Gap to the next one, 0 for a wall that both share; `None` for the last.
    pub gap: Option<f64>,
}

impl Chamber {
    /// Whether it shares a wall with the next one.
    pub fn is_joined_to_next(&self) -> bool {
        self.gap == Some(0.0)
    }
}

/// What fills a point of the actuator's bounding box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Region {
    Solid,
    /// Inside of a chamber, or of the channel below it.
    Air(usize),
    Gap(usize),
    Outside,
}

/// An actuator with its chambers in their places.
pub(super) struct Row<'a> {
    pub actuator: &'a Actuator,
    pub chambers: Vec<Chamber>,
}

impl Actuator {
    /// The chambers from the clamp on. The lengths must make a body, see [`Self::validate`].
    pub fn row(&self) -> Vec<Chamber> {
        let pitch = self.chamber_length.common().zip(self.gap.common()).map(|(length, gap)| length + gap);
        let mut sum = self.flange;
        let chamber = |i: usize| {
            // Of equal chambers without a sum's rounding, which would grow along the row.
            let start = pitch.map_or(sum, |pitch| self.flange + i as f64 * pitch);
            let (length, cavity) = (self.chamber_length.at(i), self.cavity_length.at(i));
            let gap = (i + 1 < self.chambers).then(|| self.gap.at(i));
            sum += length + gap.unwrap_or_default();
            let wall = 0.5 * (length - cavity);
            Chamber {
                start,
                end: start + length,
                cavity: [start + wall, start + wall + cavity],
                side_wall: self.side_wall.at(i),
                top_wall: self.top_wall.at(i),
                gap,
            }
        };
        (0..self.chambers).map(chamber).collect()
    }
}

impl<'a> Row<'a> {
    pub fn of(actuator: &'a Actuator) -> Self {
        Self { actuator, chambers: actuator.row() }
    }

    /// What fills a point that lies in no plane in which something ends.
    pub fn region(&self, [x, y, z]: [f64; 3]) -> Region {
        let actuator = self.actuator;
        let begun = self.chambers.partition_point(|chamber| chamber.start <= x);
        let Some((index, chamber)) = begun.checked_sub(1).map(|index| (index, &self.chambers[index])) else {
            return if z < actuator.base { Region::Solid } else { Region::Outside };
        };
        // Where there is no gap, rounding must not leave anything between two chambers.
        let in_chamber = x < chamber.end || chamber.is_joined_to_next();
        let along_cavity = x > chamber.cavity[0] && x < chamber.cavity[1];
        let inner_width = y.abs() < 0.5 * actuator.width - chamber.side_wall;
        if along_cavity && inner_width && z > actuator.floor() && z < actuator.height - chamber.top_wall {
            return Region::Air(index);
        }
        let channel = &actuator.channel;
        let last = self.chambers.last().map_or(x, |last| last.cavity[1]);
        if y.abs() < channel.half_width && x > self.chambers[0].cavity[0] && x < last && z > channel.bottom {
            let roof = if along_cavity { actuator.floor().max(channel.top) } else { channel.top };
            if z < roof {
                return Region::Air(index);
            }
        }
        if z < actuator.base || in_chamber {
            Region::Solid
        } else if chamber.gap.is_some() {
            Region::Gap(index)
        } else {
            Region::Outside
        }
    }
}
