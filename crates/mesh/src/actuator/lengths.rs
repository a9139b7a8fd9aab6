//! What describes an actuator, and what follows from it at once.

use serde::{Deserialize, Serialize};

use super::per_chamber::PerChamber;

/// Lengths of the actuator, mm; symbols of the paper in brackets.
///
/// Chambers may differ in their own length, that of their cavity, the walls around it and the gap behind it. Width and height of the body are
/// the same all along it: a thicker side or top wall makes the cavity narrower or lower.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Actuator {
    /// Number of chambers \[N\].
    pub chambers: usize,
    /// Outer length of one chamber \[t2\].
    pub chamber_length: PerChamber,
    /// Length of one cavity \[t3\].
    pub cavity_length: PerChamber,
    /// Gap between neighbouring chambers \[t1\]; 0 for a solid block with cavities, whose neighbours share a wall.
    pub gap: PerChamber,
    /// Length of the flange at either end; 0 for none.
    pub flange: f64,
    /// Whole width \[W\].
    pub width: f64,
    /// Whole height \[H\].
    pub height: f64,
    /// Thickness of the continuous base \[t\].
    pub base: f64,
    /// Height of the cavities' floor; `None` for the top of the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cavity_floor: Option<f64>,
    /// Thickness of the side walls.
    pub side_wall: PerChamber,
    /// Thickness of the walls above the cavities.
    pub top_wall: PerChamber,
    /// The air channel that connects the cavities.
    pub channel: Channel,
    /// Which part of the body is modelled.
    #[serde(default)]
    pub part: Part,
}

/// Keys of the `[actuator]` table that may be given for every chamber.
pub const LENGTHS_PER_CHAMBER: [&str; 5] = ["chamber_length", "cavity_length", "gap", "side_wall", "top_wall"];

/// Cross-section of the air channel in the base, mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Half of its width; 0 for no channel.
    pub half_width: f64,
    /// Height of its floor.
    pub bottom: f64,
    /// Height of its roof under the gaps and the end walls.
    pub top: f64,
}

/// Which part of the symmetric body is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// y ≥ 0, with `u_y = 0` on the plane y = 0.
    #[default]
    Half,
    /// Both sides of the symmetry plane.
    Whole,
}

impl Actuator {
    /// The paper's two-chamber piece (theory §1): half model, 1268 mm³.
    pub fn two_chambers() -> Self {
        Self {
            chambers: 2,
            chamber_length: 8.0.into(),
            cavity_length: 6.0.into(),
            gap: 2.0.into(),
            flange: 0.0,
            width: 20.0,
            height: 13.0,
            base: 4.0,
            cavity_floor: None,
            side_wall: 1.0.into(),
            top_wall: 1.0.into(),
            channel: Channel { half_width: 1.0, bottom: 2.0, top: 3.0 },
            part: Part::Half,
        }
    }

    /// The paper's full actuator (theory §1): eight chambers and two flanges, half model, 5460 mm³.
    pub fn full() -> Self {
        Self { chambers: 8, flange: 2.0, ..Self::two_chambers() }
    }

    /// The lengths that may be given for every chamber, by their keys in the `[actuator]` table.
    pub fn per_chamber(&self) -> [(&'static str, &PerChamber); 5] {
        [
            ("chamber_length", &self.chamber_length),
            ("cavity_length", &self.cavity_length),
            ("gap", &self.gap),
            ("side_wall", &self.side_wall),
            ("top_wall", &self.top_wall),
        ]
    }

    /// Key of the first length in which chambers, or gaps, differ; `None` if all are alike.
    pub fn first_varied(&self) -> Option<&'static str> {
        self.per_chamber().into_iter().find(|(_, value)| value.is_varied()).map(|(key, _)| key)
    }

    /// Whole length L, mm.
    pub fn length(&self) -> f64 {
        let n = self.chambers as f64;
        2.0 * self.flange + self.chamber_length.total(n) + self.gap.total(n - 1.0)
    }

    /// Planes no further apart are one, mm.
    pub(super) fn rounding(&self) -> f64 {
        1e-9 * self.length().max(self.width).max(self.height)
    }

    /// Height of the cavities' floor, mm.
    pub fn floor(&self) -> f64 {
        self.cavity_floor.unwrap_or(self.base)
    }

    /// Thickness of the thinner walls that close a cavity along x, mm: of the chamber that has the thinnest.
    pub fn end_wall(&self) -> f64 {
        let [outer, inner] = [&self.chamber_length, &self.cavity_length];
        let count = outer.entries().len().max(inner.entries().len());
        (0..count).map(|i| 0.5 * (outer.at(i) - inner.at(i))).fold(f64::INFINITY, f64::min)
    }

    /// Thickness of the thinnest wall around a cavity, mm.
    pub fn thinnest_wall(&self) -> f64 {
        self.end_wall().min(self.side_wall.least()).min(self.top_wall.least())
    }

    /// Whether the cavities are one, joined by the channel.
    pub fn has_channel(&self) -> bool {
        self.channel.half_width > 0.0
    }

    /// Number of gaps, whose walls may touch.
    pub fn gaps(&self) -> usize {
        let between = self.chambers.saturating_sub(1);
        match &self.gap {
            PerChamber::All(gap) => {
                if *gap > 0.0 {
                    between
                } else {
                    0
                }
            }
            PerChamber::Each(list) => list.iter().filter(|gap| **gap > 0.0).count(),
        }
    }
}
