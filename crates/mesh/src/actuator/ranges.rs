//! Whether lengths make a body.

use super::lengths::Actuator;
use super::per_chamber::PerChamber;
use super::planes::SAME_PLANE;

/// A length that makes no body, or none that can be meshed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value} is out of range: {allowed}")]
pub struct GeometryError {
    /// The key, as written in the case file's `[actuator]` table; an entry of a list by its number from 1.
    pub key: String,
    /// The offending value.
    pub value: String,
    /// What would be allowed.
    pub allowed: String,
}

/// The shortest and the longest length of a body and of what is around it, mm: no actuator is smaller or larger.
pub const LENGTHS: [f64; 2] = [1e-6, 1e6];

const NO_LIMIT: f64 = f64::INFINITY;

/// What is unknown limits nothing.
fn limit(value: f64) -> f64 {
    if value.is_nan() { NO_LIMIT } else { value }
}

/// What is wrong with a length that must lie between two others.
fn out_of_range(key: &str, value: f64, low: f64, high: f64, strict_low: bool) -> Option<GeometryError> {
    let error = |allowed| Some(GeometryError { key: key.into(), value: value.to_string(), allowed });
    let is_above = if strict_low { value > low } else { value >= low };
    if value.is_finite() && is_above && value < high {
        let [shortest, longest] = LENGTHS;
        if value == 0.0 || (shortest..=longest).contains(&value) {
            return None;
        }
        return error(format!("must be from {shortest:e} to {longest:e} mm"));
    }
    let relation = if strict_low { "greater than" } else { "at least" };
    let mut allowed = format!("must be {relation} {low}");
    if high.is_finite() {
        allowed += &format!(" and less than {high}");
    }
    error(allowed + " mm")
}

/// What is found out of range.
struct Found(Vec<GeometryError>);

impl Found {
    /// The value, if it is positive and below a limit; else not a number.
    fn length(&mut self, key: &str, value: f64, limit: f64) -> f64 {
        let error = out_of_range(key, value, 0.0, limit, true);
        let is_right = error.is_none();
        self.0.extend(error);
        if is_right { value } else { f64::NAN }
    }

    /// The same for every entry, with the limit of entry `i` (from 0).
    fn lengths(&mut self, key: &str, value: &PerChamber, limit: impl Fn(usize) -> f64) -> PerChamber {
        let right = value.keyed(key).enumerate().map(|(i, (key, entry))| self.length(&key, entry, limit(i))).collect();
        match value {
            PerChamber::All(_) => PerChamber::Each(right).at(0).into(),
            PerChamber::Each(_) => PerChamber::Each(right),
        }
    }

    /// Complains about a list that has not one entry for each chamber, or gap.
    fn unless_one_each(&mut self, key: &str, value: &PerChamber, chambers: usize) {
        let PerChamber::Each(list) = value else { return };
        let gaps = chambers.saturating_sub(1);
        let (count, of) = match key {
            "gap" => (gaps, format!("one for each of the gaps between {chambers} chambers")),
            _ => (chambers, format!("one for each of {chambers} chambers")),
        };
        if list.len() != count {
            let entries = if count == 1 { "entry" } else { "entries" };
            let allowed =
                format!("must be a number, or a list with {count} {entries}, {of}: this one has {}", list.len());
            self.0.push(GeometryError { key: key.into(), value: format!("{list:?}"), allowed });
        }
    }
}

impl Actuator {
    /// Checks that the lengths make a body.
    ///
    /// # Errors
    /// The first key whose value is not finite or lies outside what the other lengths allow; [`Self::problems`] has all.
    pub fn validate(&self) -> Result<(), GeometryError> {
        self.problems().into_iter().next().map_or(Ok(()), Err)
    }

    /// Every key whose value is not finite or lies outside what the other lengths allow. A length that is wrong itself allows
    /// the others anything.
    pub fn problems(&self) -> Vec<GeometryError> {
        let mut found = Found(Vec::new());
        if (1..=10_000).contains(&self.chambers) {
            self.per_chamber().into_iter().for_each(|(key, value)| found.unless_one_each(key, value, self.chambers));
        } else {
            let allowed = "must be from 1 to 10000".into();
            found.0.push(GeometryError { key: "chambers".into(), value: self.chambers.to_string(), allowed });
        }
        let chamber_length = found.lengths("chamber_length", &self.chamber_length, |_| NO_LIMIT);
        found.lengths("cavity_length", &self.cavity_length, |i| match self.cavity_length {
            PerChamber::All(_) => chamber_length.least(),
            PerChamber::Each(_) => limit(chamber_length.at(i)),
        });
        let width = found.length("width", self.width, NO_LIMIT);
        let height = found.length("height", self.height, NO_LIMIT);
        let base = found.length("base", self.base, limit(height));
        let side_wall = found.lengths("side_wall", &self.side_wall, |_| limit(0.5 * width)).greatest();
        let top_wall = found.lengths("top_wall", &self.top_wall, |_| limit(height - base)).greatest();
        if let Some(floor) = self.cavity_floor {
            found.length("cavity_floor", floor, limit(height - top_wall));
        }
        if self.has_channel() {
            let bottom = found.length("channel.bottom", self.channel.bottom, limit(base));
            let lowest = if bottom.is_nan() { 0.0 } else { bottom };
            found.0.extend(out_of_range("channel.top", self.channel.top, lowest, limit(base), true));
        }
        let gaps = self.gap.keyed("gap");
        found.0.extend(gaps.filter_map(|(key, gap)| out_of_range(&key, gap, 0.0, NO_LIMIT, false)));
        found.0.extend(out_of_range("flange", self.flange, 0.0, NO_LIMIT, false));
        let half_inside = limit(0.5 * width - side_wall);
        found.0.extend(out_of_range("channel.half_width", self.channel.half_width, 0.0, half_inside, false));
        if found.0.is_empty() {
            found.0.extend(self.too_close());
        }
        found.0
    }

    /// Planes that are as good as one, or so close that elements between them would be slivers, of lengths that are right by themselves.
    fn too_close(&self) -> Vec<GeometryError> {
        let mut found = Vec::new();
        let rounding = self.rounding();
        for (key, gap) in self.gap.keyed("gap").filter(|(_, gap)| *gap > 0.0 && *gap <= rounding) {
            let allowed = format!("must be 0 or greater than {rounding:.1e} mm, a billionth of the body");
            found.push(GeometryError { key, value: gap.to_string(), allowed });
        }
        let sliver = SAME_PLANE * self.thinnest_wall();
        for (key, value) in [("side_wall", &self.side_wall), ("top_wall", &self.top_wall)] {
            let mut walls: Vec<(String, f64)> = value.keyed(key).collect();
            walls.sort_by(|a, b| a.1.total_cmp(&b.1));
            for pair in walls.windows(2) {
                let [(thinner, a), (thicker, b)] = pair else { continue };
                if b - a > rounding && b - a < sliver {
                    let allowed = format!(
                        "must be equal to {thinner} = {a}, or differ from it by {sliver:.2e} mm or more, a hundredth of the thinnest wall: the \
                         elements between them would be slivers"
                    );
                    found.push(GeometryError { key: thicker.clone(), value: b.to_string(), allowed });
                }
            }
        }
        found
    }
}
