//! Axes of charts: their ranges, ticks, and the area that they span on a sheet.

use pneuflex_post::check;

use crate::drawing::{Anchor, Colour, Drawing, Stroke, text_width};
use crate::error::PlotError;

pub(crate) const MARGIN: f64 = 14.0;
pub(crate) const TITLE: f64 = 16.0;
pub(crate) const TEXT: f64 = 12.0;
pub(crate) const SMALL: f64 = 11.0;
pub(crate) const INK: Colour = Colour([34, 34, 34]);
pub(crate) const GRID: Colour = Colour([225, 225, 225]);

/// How numbers become lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Proportionally.
    #[default]
    Linear,
    /// By their logarithm; numbers must be greater than 0.
    Logarithmic,
}

/// An axis: its range as drawn (logarithms on a logarithmic one) and its ticks.
pub(crate) struct Axis {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) scale: Scale,
}

impl Axis {
    pub(crate) fn around(values: &[f64], scale: Scale, label: &str) -> Result<Self, PlotError> {
        let what = if label.is_empty() { "chart" } else { label };
        check(what, values, values.len())?;
        if scale == Scale::Logarithmic && values.iter().any(|v| *v <= 0.0) {
            return Err(PlotError::NotDrawable {
                what: format!("{what}: a number of 0 or less on a logarithmic axis"),
            });
        }
        let drawn = values.iter().map(|v| if scale == Scale::Logarithmic { v.log10() } else { *v });
        let (low, high) = drawn.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if low > high {
            return Err(PlotError::NotDrawable { what: format!("{what}: a chart without numbers") });
        }
        let room = if high > low { 0.05 * (high - low) } else { 0.5 * low.abs().max(1e-3) };
        let touch = |end: f64| scale == Scale::Linear && end == 0.0;
        // An axis that begins at zero begins there.
        let low = if touch(low) { low } else { low - room };
        let high = if touch(high) { high } else { high + room };
        Ok(Self { low, high, scale })
    }

    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        match self.scale {
            Scale::Linear => ticks(self.low, self.high, 7),
            Scale::Logarithmic => logarithmic_ticks(self.low, self.high),
        }
    }

    pub(crate) fn widest_tick(&self) -> f64 {
        self.ticks().iter().map(|t| text_width(&t.1, SMALL)).fold(0.0, f64::max)
    }

    pub(crate) fn share(&self, value: f64) -> f64 {
        let drawn = if self.scale == Scale::Logarithmic { value.log10() } else { value };
        (drawn - self.low) / (self.high - self.low)
    }

    pub(crate) fn widen(&mut self, share: f64) {
        self.high += share * (self.high - self.low);
    }
}

/// Makes a unit equally long on both axes; returns the height of the axes, no more than `height`.
pub(crate) fn equal(x: &mut Axis, y: &mut Axis, width: f64, height: f64) -> f64 {
    let (wide, high) = (x.high - x.low, y.high - y.low);
    if high * width / wide <= height {
        return high * width / wide;
    }
    let extra = high * width / height - wide;
    (x.low, x.high) = (x.low - 0.5 * extra, x.high + 0.5 * extra);
    height
}

/// The rectangle between the axes.
pub(crate) struct Area<'a> {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) x: &'a Axis,
    pub(crate) y: &'a Axis,
}

impl Area<'_> {
    pub(crate) fn to(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.left + self.x.share(x) * self.width, self.top + (1.0 - self.y.share(y)) * self.height]
    }

    pub(crate) fn draw_axes(&self, drawing: &mut Drawing) {
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        let thin = Stroke::solid(GRID, 1.0);
        let mut free_from = f64::NEG_INFINITY;
        for (value, text) in self.x.ticks() {
            let x = self.left + self.x.share(value) * self.width;
            drawing.line(&[[x, self.top], [x, bottom]], thin.clone());
            drawing.line(&[[x, bottom], [x, bottom + 4.0]], Stroke::solid(INK, 1.0));
            let half = 0.5 * text_width(&text, SMALL);
            if x - half > free_from {
                drawing.text(&text, [x, bottom + SMALL + 6.0], SMALL, Anchor::Middle);
                free_from = x + half + 4.0;
            }
        }
        for (value, text) in self.y.ticks() {
            let y = self.top + (1.0 - self.y.share(value)) * self.height;
            drawing.line(&[[self.left, y], [right, y]], thin.clone());
            drawing.line(&[[self.left - 4.0, y], [self.left, y]], Stroke::solid(INK, 1.0));
            drawing.text(&text, [self.left - 7.0, y + 4.0], SMALL, Anchor::End);
        }
        let frame = Some(Stroke::solid(INK, 1.0));
        drawing.rectangle([self.left, self.top], [self.width, self.height], frame, None);
    }
}

/// Round values from `low` to `high`, about `count`, with their texts.
pub fn ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let raw = (high - low) / count.max(1) as f64;
    if !raw.is_finite() || raw <= 0.0 {
        return Vec::new();
    }
    let power = 10_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= 0.999 * raw).unwrap_or(raw);
    let decimals = (0..12).find(|d| {
        let scaled = step * 10_f64.powi(*d);
        (scaled - scaled.round()).abs() < 1e-6 * scaled
    });
    let decimals = decimals.unwrap_or(12) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last)
        .map(|i| {
            let value = i as f64 * step;
            (value, format!("{value:.decimals$}").replace('-', "−"))
        })
        .collect()
}

/// Powers of ten between two logarithms, and their doubles and fivefolds if there are few.
fn logarithmic_ticks(low: f64, high: f64) -> Vec<(f64, String)> {
    let multiples: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let stride = (((high - low) / 8.0).ceil() as i32).max(1);
    let mut found = Vec::new();
    for power in (low.floor() as i32)..=(high.ceil() as i32) {
        if power % stride != 0 {
            continue;
        }
        for multiple in multiples {
            let value = multiple * 10_f64.powi(power);
            if (low - 1e-9..=high + 1e-9).contains(&value.log10()) {
                found.push((value, power_text(*multiple, power)));
            }
        }
    }
    found
}

fn power_text(multiple: f64, power: i32) -> String {
    if (-3..=4).contains(&power) {
        let decimals = (-power).max(0) as usize;
        return format!("{:.decimals$}", multiple * 10_f64.powi(power));
    }
    let raised: String = power
        .to_string()
        .chars()
        .filter_map(|c| match c {
            '-' => Some('⁻'),
            _ => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(c.to_digit(10)? as usize),
        })
        .collect();
    if multiple == 1.0 { format!("10{raised}") } else { format!("{multiple}·10{raised}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let texts = |low, high| -> Vec<String> { ticks(low, high, 6).into_iter().map(|t| t.1).collect() };
        assert_eq!(texts(0.0, 0.12), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10", "0.12"]);
        assert_eq!(texts(-3.0, 47.0), ["0", "10", "20", "30", "40"]);
        assert_eq!(texts(-0.26, 0.1), ["−0.2", "−0.1", "0.0", "0.1"]);
        assert!(ticks(1.0, 1.0, 6).is_empty() && ticks(f64::NAN, 1.0, 6).is_empty());
        let logs: Vec<String> = logarithmic_ticks(-9.2, 2.1).into_iter().map(|t| t.1).collect();
        assert_eq!(logs, ["10⁻⁸", "10⁻⁶", "10⁻⁴", "0.01", "1", "100"]);
    }
}
