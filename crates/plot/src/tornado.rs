//! A chart of how much a quantity depends on several inputs.

use crate::axis::{Area, Axis, GRID, INK, MARGIN, SMALL, Scale, TEXT, TITLE};
use crate::chart::PALETTE;
use crate::drawing::{Anchor, Colour, Drawing, Stroke, text_width, wrapped};
use crate::error::PlotError;

/// One bar of a tornado: a quantity's value with an input lowered and raised.
#[derive(Clone, Debug, PartialEq)]
pub struct TornadoBar {
    /// The input and how far it is changed, e.g. "base 4 ± 0.4 mm".
    pub name: String,
    /// Value with the input lowered; `None` if there is none, e.g. because the run failed.
    pub lowered: Option<f64>,
    /// Value with the input raised.
    pub raised: Option<f64>,
}

/// How much a quantity depends on several inputs: bars about its present value, the longest on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Tornado {
    /// Title.
    pub title: String,
    /// Quantity and unit.
    pub label: String,
    /// Value with all inputs as they are.
    pub centre: f64,
    /// Inputs in any order.
    pub bars: Vec<TornadoBar>,
    /// Sentences below.
    pub caption: String,
    /// Width of the sheet, px.
    pub width: f64,
}

impl Tornado {
    /// Draws the chart.
    ///
    /// # Errors
    /// A number that is not finite; a sheet too narrow for its texts.
    pub fn draw(&self) -> Result<Drawing, PlotError> {
        const ROW: f64 = 26.0;
        let ends = |bar: &TornadoBar| [bar.lowered, bar.raised];
        let values: Vec<f64> = self.bars.iter().flat_map(ends).flatten().chain(std::iter::once(self.centre)).collect();
        let mut axis = Axis::around(&values, Scale::Linear, &self.label)?;
        let spread =
            |bar: &TornadoBar| ends(bar).into_iter().flatten().map(|v| (v - self.centre).abs()).fold(0.0, f64::max);
        let mut bars: Vec<&TornadoBar> = self.bars.iter().collect();
        bars.sort_by(|a, b| spread(b).total_cmp(&spread(a)));

        let names = bars.iter().map(|b| text_width(&b.name, TEXT)).fold(0.0, f64::max);
        let left = MARGIN + names + 12.0;
        let width = self.width - left - MARGIN - 8.0;
        if !width.is_finite() || width < 60.0 {
            return Err(PlotError::NotDrawable { what: format!("a chart {} px wide", self.width) });
        }
        // Enough to tell the ends of bars apart.
        let decimals = (2.5 - (axis.high - axis.low).log10()).clamp(1.0, 9.0) as usize;
        // Room for the numbers at the ends of the bars.
        let room = 44.0 / width * (axis.high - axis.low);
        (axis.low, axis.high) = (axis.low - room, axis.high + room);
        let none = Axis { low: 0.0, high: 1.0, scale: Scale::Linear };
        let top = MARGIN + if self.title.is_empty() { 0.0 } else { TITLE + 12.0 } + TEXT + 12.0;
        let height = ROW * bars.len() as f64 + 8.0;
        let caption = wrapped(&self.caption, SMALL, self.width - 2.0 * MARGIN);
        let below = SMALL + TEXT + 24.0;
        let foot = caption.len() as f64 * (SMALL + 5.0) + 8.0;
        let mut drawing = Drawing::new(self.width, top + height + below + foot + MARGIN, &self.title);
        drawing.text(&self.title, [MARGIN, MARGIN + TITLE - 3.0], TITLE, Anchor::Start);
        let area = Area { left, top, width, height, x: &axis, y: &none };
        let bottom = top + height;
        for (value, text) in axis.ticks() {
            let x = area.to([value, 0.0])[0];
            drawing.line(&[[x, top], [x, bottom]], Stroke::solid(GRID, 1.0));
            drawing.text(&text, [x, bottom + SMALL + 6.0], SMALL, Anchor::Middle);
        }
        let middle = area.to([self.centre, 0.0])[0];
        let (low_colour, high_colour) = (PALETTE[0], PALETTE[1]);
        for (i, bar) in bars.iter().enumerate() {
            let y = top + 4.0 + i as f64 * ROW;
            drawing.text(&bar.name, [left - 8.0, y + 0.5 * ROW + 4.0], TEXT, Anchor::End);
            let mut halves = [(bar.lowered, low_colour), (bar.raised, high_colour)];
            // Both may lie on one side: the shorter one is drawn over the longer one.
            let length = |half: &(Option<f64>, Colour)| half.0.map_or(0.0, |v| (v - self.centre).abs());
            halves.sort_by(|a, b| length(b).total_cmp(&length(a)));
            for (value, colour) in halves {
                let Some(value) = value else { continue };
                let x = area.to([value, 0.0])[0];
                drawing.rectangle([x.min(middle), y + 4.0], [(x - middle).abs(), ROW - 8.0], None, Some(colour));
            }
            // Beside the outer end on either side; both on one side stand behind each other.
            for side in [-1.0, 1.0] {
                let there: Vec<f64> =
                    ends(bar).into_iter().flatten().filter(|v| side * (v - self.centre) >= 0.0).collect();
                let Some(&outer) = there.iter().max_by(|a, b| (side * **a).total_cmp(&(side * **b))) else { continue };
                let texts: Vec<String> = there.iter().map(|v| format!("{v:.decimals$}")).collect();
                let text = texts.join(" / ");
                let anchor = if side < 0.0 { Anchor::End } else { Anchor::Start };
                let x = area.to([outer, 0.0])[0] + 5.0 * side;
                drawing.text(&text, [x, y + 0.5 * ROW + 4.0], SMALL, anchor);
            }
            if bar.lowered.is_none() && bar.raised.is_none() {
                drawing.text("not solved", [middle + 5.0, y + 0.5 * ROW + 4.0], SMALL, Anchor::Start);
            }
        }
        drawing.line(&[[middle, top], [middle, bottom]], Stroke::solid(INK, 1.4));
        drawing.rectangle([left, top], [width, height], Some(Stroke::solid(INK, 1.0)), None);
        drawing.text(&self.label, [left + 0.5 * width, bottom + SMALL + TEXT + 16.0], TEXT, Anchor::Middle);
        let mut x = left;
        for (text, colour) in [("lowered", low_colour), ("raised", high_colour)] {
            drawing.rectangle([x, top - TEXT - 8.0], [TEXT, TEXT], None, Some(colour));
            drawing.text(text, [x + TEXT + 6.0, top - 10.0], TEXT, Anchor::Start);
            x += text_width(text, TEXT) + 48.0;
        }
        let text = format!("as it is: {:.decimals$}", self.centre);
        drawing.text(&text, [x, top - 10.0], TEXT, Anchor::Start);
        for (i, line) in caption.iter().enumerate() {
            let y = bottom + below + (i + 1) as f64 * (SMALL + 5.0);
            drawing.text(line, [MARGIN, y], SMALL, Anchor::Start);
        }
        Ok(drawing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_bar_of_a_tornado_is_on_top() {
        let bar = |name: &str, a, b| TornadoBar { name: name.into(), lowered: a, raised: b };
        let tornado = Tornado {
            title: "t".into(),
            label: "angle (°)".into(),
            centre: 82.0,
            bars: vec![
                bar("short", Some(80.0), Some(83.0)),
                bar("long", Some(60.0), Some(99.0)),
                bar("none", None, None),
            ],
            caption: String::new(),
            width: 600.0,
        };
        let svg = tornado.draw().unwrap().to_svg().unwrap();
        assert!(svg.find(">long<") < svg.find(">short<"));
        assert!(svg.contains(">99.0<") && svg.contains("not solved"));
        let bars = vec![bar("fine", Some(0.0213), Some(0.0287))];
        let svg = Tornado { centre: 0.025, bars, ..tornado }.draw().unwrap().to_svg().unwrap();
        assert!(svg.contains(">0.0213<") && svg.contains(">0.0287<"), "{svg}");
    }
}
