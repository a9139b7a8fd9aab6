//! Charts: lines and points over axes.
//!
//! ```
//! use pneuflex_plot::chart::{Chart, Series};
//!
//! let chart = Chart {
//!     x_label: "air pressure (kPa)".into(),
//!     y_label: "angle of the end face (°)".into(),
//!     series: vec![Series::line("multiple-point", vec![[0.0, 0.0], [25.0, 40.0], [50.0, 82.0]])],
//!     ..Chart::new("Bending")
//! };
//! let drawing = chart.draw()?;
//! assert!(drawing.to_svg()?.contains("multiple-point") && drawing.to_png(1.0)?.len() > 1000);
//! # Ok::<(), pneuflex_plot::PlotError>(())
//! ```

use crate::axis::{Area, Axis, INK, MARGIN, SMALL, TEXT, TITLE, equal};
pub use crate::axis::{Scale, ticks};
use crate::drawing::{Anchor, Colour, Drawing, Stroke, text_width, wrapped};
use crate::error::PlotError;

/// Colours that readers with any colour vision can tell apart (M. Okabe and K. Ito), darkest first.
pub const PALETTE: [Colour; 7] = [
    Colour([0, 114, 178]),
    Colour([213, 94, 0]),
    Colour([0, 158, 115]),
    Colour([204, 121, 167]),
    Colour([86, 180, 233]),
    Colour([230, 159, 0]),
    Colour([60, 60, 60]),
];

/// How the points of a series are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// A solid line.
    #[default]
    Solid,
    /// A dashed line.
    Dashed,
    /// A dotted line.
    Dotted,
    /// Rings without a line.
    Markers,
    /// A solid line with a dot at every point.
    SolidWithDots,
    /// A dashed line with a ring at every point.
    DashedWithRings,
}

/// A row of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; series of the same name share one entry, those without a name have none.
    pub name: String,
    /// Points.
    pub points: Vec<[f64; 2]>,
    /// Lines or markers.
    pub style: Style,
    /// Colour; `None` for the palette's next.
    pub colour: Option<Colour>,
    /// Text at the last point; may be empty.
    pub end_label: String,
}

impl Series {
    /// A solid line.
    pub fn line(name: &str, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.into(), points, style: Style::Solid, colour: None, end_label: String::new() }
    }

    /// The same points drawn otherwise.
    pub fn style(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// The same in a colour.
    pub fn colour(self, colour: Colour) -> Self {
        Self { colour: Some(colour), ..self }
    }

    /// The same with a text at its end.
    pub fn end_label(self, text: &str) -> Self {
        Self { end_label: text.into(), ..self }
    }
}

/// Lines and points over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Title.
    pub title: String,
    /// Quantity and unit of the horizontal axis.
    pub x_label: String,
    /// Quantity and unit of the vertical axis.
    pub y_label: String,
    /// What is shown.
    pub series: Vec<Series>,
    /// Sentences below.
    pub caption: String,
    /// Scale of the horizontal axis.
    pub x_scale: Scale,
    /// Scale of the vertical axis.
    pub y_scale: Scale,
    /// Numbers that the axes must show besides those of the series, e.g. a zero.
    pub x_shows: Vec<f64>,
    /// The same for the vertical axis.
    pub y_shows: Vec<f64>,
    /// Whether a unit is equally long on both axes, as for shapes.
    pub has_equal_axes: bool,
    /// Width of the sheet, px.
    pub width: f64,
    /// Height of the axes, px; with equal axes the largest one.
    pub height: f64,
}

impl Chart {
    /// A chart without series.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.into(),
            x_label: String::new(),
            y_label: String::new(),
            series: Vec::new(),
            caption: String::new(),
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            x_shows: Vec::new(),
            y_shows: Vec::new(),
            has_equal_axes: false,
            width: 720.0,
            height: 400.0,
        }
    }

    /// Draws the chart.
    ///
    /// # Errors
    /// A number that is not finite, or not greater than 0 on a logarithmic axis; no numbers at all.
    pub fn draw(&self) -> Result<Drawing, PlotError> {
        let axis = |d: usize, scale: Scale, shows: &[f64], label: &str| {
            let values: Vec<f64> =
                self.series.iter().flat_map(|s| s.points.iter().map(|p| p[d])).chain(shows.iter().copied()).collect();
            Axis::around(&values, scale, label)
        };
        let mut x = axis(0, self.x_scale, &self.x_shows, &self.x_label)?;
        let mut y = axis(1, self.y_scale, &self.y_shows, &self.y_label)?;

        let colours = self.colours();
        let legend = self.legend(&colours);
        let legend_width = legend.iter().map(|(name, ..)| text_width(name, TEXT) + 54.0).fold(0.0, f64::max);
        let left = MARGIN + if self.y_label.is_empty() { 0.0 } else { TEXT + 12.0 } + y.widest_tick() + 12.0;
        let end_labels = self.series.iter().map(|s| text_width(&s.end_label, SMALL)).fold(0.0, f64::max);
        let right =
            MARGIN + if legend.is_empty() { 6.0 } else { legend_width } + if end_labels > 0.0 { 6.0 } else { 0.0 };
        let width = self.width - left - right;
        if !width.is_finite() || width < 20.0 || !self.height.is_finite() || self.height < 20.0 {
            return Err(PlotError::NotDrawable { what: format!("a chart {} by {} px", self.width, self.height) });
        }
        // Room for texts at the ends of lines.
        x.widen(0.5 * if end_labels > 0.0 { (end_labels + 14.0) / width } else { 0.0 });
        let mut height = self.height;
        if self.has_equal_axes {
            height = equal(&mut x, &mut y, width, self.height);
        }
        let top = MARGIN + if self.title.is_empty() { 0.0 } else { TITLE + 12.0 };
        let caption = wrapped(&self.caption, SMALL, self.width - 2.0 * MARGIN);
        let below = SMALL + 12.0 + if self.x_label.is_empty() { 0.0 } else { TEXT + 10.0 };
        let foot = if caption.is_empty() { 0.0 } else { caption.len() as f64 * (SMALL + 5.0) + 8.0 };
        let mut drawing = Drawing::new(self.width, top + height + below + foot + MARGIN, &self.title);
        drawing.text(&self.title, [MARGIN, MARGIN + TITLE - 3.0], TITLE, Anchor::Start);

        let area = Area { left, top, width, height, x: &x, y: &y };
        area.draw_axes(&mut drawing);
        drawing.text(&self.x_label, [left + 0.5 * width, top + height + SMALL + TEXT + 16.0], TEXT, Anchor::Middle);
        drawing.upright_text(&self.y_label, [MARGIN + TEXT, top + 0.5 * height], TEXT, Anchor::Middle);
        for (series, colour) in self.series.iter().zip(&colours) {
            area.draw_series(&mut drawing, series, *colour);
        }
        let mut taken: Vec<[f64; 4]> = Vec::new();
        for (series, colour) in self.series.iter().zip(&colours) {
            area.draw_end_label(&mut drawing, series, *colour, &mut taken);
        }
        let legend_left = self.width - right + 18.0;
        for (i, (name, style, colour)) in legend.iter().enumerate() {
            let y = top + 10.0 + i as f64 * (TEXT + 8.0);
            stroke_sample(&mut drawing, &[[legend_left, y], [legend_left + 26.0, y]], *style, *colour);
            drawing.text(name, [legend_left + 32.0, y + 4.0], TEXT, Anchor::Start);
        }
        for (i, line) in caption.iter().enumerate() {
            let y = top + height + below + 8.0 + (i + 1) as f64 * (SMALL + 5.0);
            drawing.text(line, [MARGIN, y], SMALL, Anchor::Start);
        }
        Ok(drawing)
    }

    /// The colour of every series; those of one name and without a colour of their own share one.
    fn colours(&self) -> Vec<Colour> {
        let mut names: Vec<&str> = Vec::new();
        let mut colours = Vec::new();
        for series in &self.series {
            let number = names.iter().position(|n| *n == series.name && !n.is_empty()).unwrap_or_else(|| {
                names.push(&series.name);
                names.len() - 1
            });
            colours.push(series.colour.unwrap_or(PALETTE[number % PALETTE.len()]));
        }
        colours
    }

    fn legend(&self, colours: &[Colour]) -> Vec<(&str, Style, Colour)> {
        let mut entries: Vec<(&str, Style, Colour)> = Vec::new();
        for (series, colour) in self.series.iter().zip(colours) {
            match entries.iter_mut().find(|e| e.0 == series.name) {
                // A family in several colours is told apart by its style alone.
                Some(entry) if entry.2 != *colour => entry.2 = INK,
                Some(_) => {}
                None if series.name.is_empty() => {}
                None => entries.push((&series.name, series.style, *colour)),
            }
        }
        entries
    }
}

impl Area<'_> {
    fn draw_series(&self, drawing: &mut Drawing, series: &Series, colour: Colour) {
        let points: Vec<[f64; 2]> = series.points.iter().map(|p| self.to(*p)).collect();
        stroke_line(drawing, &points, series.style, colour);
        for p in points {
            marker(drawing, p, series.style, colour);
        }
    }

    /// Writes a series' text beside its last point, moved up or down from those already there.
    fn draw_end_label(&self, drawing: &mut Drawing, series: &Series, colour: Colour, taken: &mut Vec<[f64; 4]>) {
        let Some(last) = series.points.last().filter(|_| !series.end_label.is_empty()) else { return };
        let [x, y] = self.to(*last);
        let width = text_width(&series.end_label, SMALL);
        let x = (x + 7.0).min(self.left + self.width - width - 3.0);
        let place = |shift: f64| [x, y - 7.0 + shift, x + width, y + 7.0 + shift];
        let is_free = |b: &[f64; 4], taken: &[[f64; 4]]| {
            taken.iter().all(|t| b[2] < t[0] || b[0] > t[2] || b[3] <= t[1] || b[1] >= t[3])
        };
        let shifts = (0..12).flat_map(|i| [f64::from(i) * 7.0, -f64::from(i) * 7.0]);
        let found = shifts.map(place).find(|b| is_free(b, taken)).unwrap_or(place(0.0));
        drawing.coloured_text(&series.end_label, [found[0], found[3] - 3.0], SMALL, Anchor::Start, colour);
        taken.push(found);
    }
}

fn stroke_line(drawing: &mut Drawing, points: &[[f64; 2]], style: Style, colour: Colour) {
    let stroke = match style {
        Style::Markers => return,
        Style::Solid | Style::SolidWithDots => Stroke::solid(colour, 1.8),
        Style::Dashed | Style::DashedWithRings => Stroke::dashed(colour, 1.8),
        Style::Dotted => Stroke::dotted(colour, 1.8),
    };
    drawing.line(points, stroke);
}

fn marker(drawing: &mut Drawing, at: [f64; 2], style: Style, colour: Colour) {
    match style {
        Style::SolidWithDots => drawing.ellipse(at, [3.0; 2], 0.0, None, Some(colour)),
        Style::Markers | Style::DashedWithRings => {
            drawing.ellipse(at, [3.4; 2], 0.0, Some(Stroke::solid(colour, 1.4)), Some(Colour::WHITE));
        }
        _ => {}
    }
}

fn stroke_sample(drawing: &mut Drawing, line: &[[f64; 2]; 2], style: Style, colour: Colour) {
    stroke_line(drawing, line, style, colour);
    marker(drawing, [0.5 * (line[0][0] + line[1][0]), line[0][1]], style, colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_axes_have_equal_units() {
        for (w, h) in [(10.0, 3.0), (3.0, 10.0)] {
            let mut x = Axis { low: 0.0, high: w, scale: Scale::Linear };
            let mut y = Axis { low: -h, high: 0.0, scale: Scale::Linear };
            let height = equal(&mut x, &mut y, 500.0, 400.0);
            let (px, py) = (500.0 / (x.high - x.low), height / (y.high - y.low));
            assert!((px - py).abs() < 1e-9 && height <= 400.0);
            assert!(x.low <= 0.0 && x.high >= w && (y.low, y.high) == (-h, 0.0));
        }
    }

    #[test]
    fn a_family_shares_one_entry_of_the_legend() {
        let line = |name: &str, end: f64| Series::line(name, vec![[0.0, 0.0], [1.0, end]]);
        let chart = Chart {
            series: vec![line("a", 1.0), line("a", 2.0), line("b", 3.0).style(Style::Dashed), line("", 4.0)],
            ..Chart::new("family")
        };
        let colours = chart.colours();
        assert_eq!(colours[0], colours[1]);
        assert_ne!(colours[0], colours[2]);
        assert_eq!(chart.legend(&colours).len(), 2);
        assert!(chart.draw().unwrap().to_svg().unwrap().contains("stroke-dasharray"));
    }

    #[test]
    fn numbers_that_cannot_be_drawn_are_refused() {
        assert!(Chart::new("empty").draw().is_err());
        let chart =
            |p: [f64; 2], y_scale| Chart { series: vec![Series::line("", vec![p])], y_scale, ..Chart::new("bad") };
        assert!(chart([0.0, f64::NAN], Scale::Linear).draw().is_err());
        assert!(chart([1.0, 0.0], Scale::Logarithmic).draw().is_err());
        assert!(chart([1.0, 2.0], Scale::Logarithmic).draw().is_ok());
    }
}
