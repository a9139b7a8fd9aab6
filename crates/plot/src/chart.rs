//! Charts: lines and points over axes, bars of a tornado.
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

use crate::drawing::{Anchor, Colour, Drawing, Stroke, text_width, wrapped};
use pneuflex_post::check;

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

/// How numbers become lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Proportionally.
    #[default]
    Linear,
    /// By their logarithm; numbers must be greater than 0.
    Logarithmic,
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

const MARGIN: f64 = 14.0;
const TITLE: f64 = 16.0;
const TEXT: f64 = 12.0;
const SMALL: f64 = 11.0;
const INK: Colour = Colour([34, 34, 34]);
const GRID: Colour = Colour([225, 225, 225]);

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

/// An axis: its range as drawn (logarithms on a logarithmic one) and its ticks.
struct Axis {
    low: f64,
    high: f64,
    scale: Scale,
}

impl Axis {
    fn around(values: &[f64], scale: Scale, label: &str) -> Result<Self, PlotError> {
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

    fn ticks(&self) -> Vec<(f64, String)> {
        match self.scale {
            Scale::Linear => ticks(self.low, self.high, 7),
            Scale::Logarithmic => logarithmic_ticks(self.low, self.high),
        }
    }

    fn widest_tick(&self) -> f64 {
        self.ticks().iter().map(|t| text_width(&t.1, SMALL)).fold(0.0, f64::max)
    }

    fn share(&self, value: f64) -> f64 {
        let drawn = if self.scale == Scale::Logarithmic { value.log10() } else { value };
        (drawn - self.low) / (self.high - self.low)
    }

    fn widen(&mut self, share: f64) {
        self.high += share * (self.high - self.low);
    }
}

/// Makes a unit equally long on both axes; returns the height of the axes, no more than `height`.
fn equal(x: &mut Axis, y: &mut Axis, width: f64, height: f64) -> f64 {
    let (wide, high) = (x.high - x.low, y.high - y.low);
    if high * width / wide <= height {
        return high * width / wide;
    }
    let extra = high * width / height - wide;
    (x.low, x.high) = (x.low - 0.5 * extra, x.high + 0.5 * extra);
    height
}

/// The rectangle between the axes.
struct Area<'a> {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: &'a Axis,
    y: &'a Axis,
}

impl Area<'_> {
    fn to(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.left + self.x.share(x) * self.width, self.top + (1.0 - self.y.share(y)) * self.height]
    }

    fn draw_axes(&self, drawing: &mut Drawing) {
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
    fn ticks_are_round_and_inside() {
        let texts = |low, high| -> Vec<String> { ticks(low, high, 6).into_iter().map(|t| t.1).collect() };
        assert_eq!(texts(0.0, 0.12), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10", "0.12"]);
        assert_eq!(texts(-3.0, 47.0), ["0", "10", "20", "30", "40"]);
        assert_eq!(texts(-0.26, 0.1), ["−0.2", "−0.1", "0.0", "0.1"]);
        assert!(ticks(1.0, 1.0, 6).is_empty() && ticks(f64::NAN, 1.0, 6).is_empty());
        let logs: Vec<String> = logarithmic_ticks(-9.2, 2.1).into_iter().map(|t| t.1).collect();
        assert_eq!(logs, ["10⁻⁸", "10⁻⁶", "10⁻⁴", "0.01", "1", "100"]);
    }

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
