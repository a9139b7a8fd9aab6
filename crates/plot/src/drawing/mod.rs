//! Flat drawings: lines, areas, texts and images, written as SVG or as PNG.
//!
//! Both come from the same list of shapes, and texts are measured with the font that the PNG is drawn with, so that the
//! two look alike: SVG names that font and leaves the glyphs to the viewer. Lengths are CSS pixels (1/96 inch), y points
//! down.

mod font;
mod png_file;
mod raster;
mod svg;

pub use font::text_width;
pub use png_file::encode as encode_png;

use crate::error::PlotError;

/// A colour, sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub [u8; 3]);

impl Colour {
    /// Black.
    pub const BLACK: Self = Self([0, 0, 0]);
    /// White.
    pub const WHITE: Self = Self([255, 255, 255]);

    /// The colour at `share` (0 … 1) of the way to another.
    pub fn towards(self, other: Self, share: f64) -> Self {
        Self(std::array::from_fn(|i| {
            let (a, b) = (f64::from(self.0[i]), f64::from(other.0[i]));
            (a + share.clamp(0.0, 1.0) * (b - a)).round() as u8
        }))
    }
}

/// How a line is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub colour: Colour,
    /// Width, px.
    pub width: f64,
    /// Lengths of dashes and gaps in turn, px; empty for a solid line.
    pub dashes: Vec<f64>,
}

impl Stroke {
    /// A solid line.
    pub fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dashes: Vec::new() }
    }

    /// A line of round dots.
    pub fn dotted(colour: Colour, width: f64) -> Self {
        Self { colour, width, dashes: vec![0.01, 2.0 * width] }
    }

    /// A line of dashes.
    pub fn dashed(colour: Colour, width: f64) -> Self {
        Self { colour, width, dashes: vec![4.0 * width, 3.0 * width] }
    }
}

/// Where a text lies relative to its position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// It starts there.
    #[default]
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// One shape.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    Path { points: Vec<[f64; 2]>, is_closed: bool, stroke: Option<Stroke>, fill: Option<Colour> },
    Ellipse { centre: [f64; 2], radii: [f64; 2], turn_deg: f64, stroke: Option<Stroke>, fill: Option<Colour> },
    Text { text: String, at: [f64; 2], size: f64, anchor: Anchor, is_upright: bool, colour: Colour },
    Image { at: [f64; 2], size: [f64; 2], image: Image },
}

/// An image of red, green, blue and opacity, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Four bytes per pixel, sRGB, opacity not multiplied in.
    pub rgba: Vec<u8>,
}

/// A list of shapes on a white sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width of the sheet, px.
    pub width: f64,
    /// Height of the sheet, px.
    pub height: f64,
    /// What it shows, for readers who do not see it.
    pub title: String,
    pub(crate) shapes: Vec<Shape>,
}

impl Drawing {
    /// An empty sheet.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        Self { width, height, title: title.into(), shapes: Vec::new() }
    }

    /// A line through some points.
    pub fn line(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        self.path(points, false, Some(stroke), None);
    }

    /// An area or its outline.
    pub fn polygon(&mut self, points: &[[f64; 2]], stroke: Option<Stroke>, fill: Option<Colour>) {
        self.path(points, true, stroke, fill);
    }

    /// A rectangle from its upper left corner.
    pub fn rectangle(&mut self, at: [f64; 2], size: [f64; 2], stroke: Option<Stroke>, fill: Option<Colour>) {
        let ([x, y], [w, h]) = (at, size);
        self.polygon(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h]], stroke, fill);
    }

    /// An ellipse whose first radius is turned clockwise from the x axis.
    pub fn ellipse(
        &mut self,
        centre: [f64; 2],
        radii: [f64; 2],
        turn_deg: f64,
        stroke: Option<Stroke>,
        fill: Option<Colour>,
    ) {
        if centre.iter().chain(&radii).all(|v| v.is_finite()) {
            self.shapes.push(Shape::Ellipse { centre, radii, turn_deg, stroke, fill });
        }
    }

    /// A text of the given size (px) with its baseline at `at`.
    pub fn text(&mut self, text: &str, at: [f64; 2], size: f64, anchor: Anchor) {
        let colour = Colour([34, 34, 34]);
        self.shapes.push(Shape::Text { text: text.into(), at, size, anchor, is_upright: false, colour });
    }

    /// A text in a colour.
    pub fn coloured_text(&mut self, text: &str, at: [f64; 2], size: f64, anchor: Anchor, colour: Colour) {
        self.shapes.push(Shape::Text { text: text.into(), at, size, anchor, is_upright: false, colour });
    }

    /// A text that reads from bottom to top.
    pub fn upright_text(&mut self, text: &str, at: [f64; 2], size: f64, anchor: Anchor) {
        let colour = Colour([34, 34, 34]);
        self.shapes.push(Shape::Text { text: text.into(), at, size, anchor, is_upright: true, colour });
    }

    /// An image from its upper left corner.
    pub fn image(&mut self, at: [f64; 2], size: [f64; 2], image: Image) {
        self.shapes.push(Shape::Image { at, size, image });
    }

    /// Drawings under each other.
    pub fn column(drawings: Vec<Self>, title: &str) -> Self {
        let width = drawings.iter().map(|drawing| drawing.width).fold(0.0, f64::max);
        let mut sheet = Self::new(width, drawings.iter().map(|drawing| drawing.height).sum(), title);
        let mut top = 0.0;
        for drawing in drawings {
            let height = drawing.height;
            sheet.place(drawing, [0.0, top]);
            top += height;
        }
        sheet
    }

    /// Adds another drawing with its upper left corner at `at`.
    pub fn place(&mut self, other: Self, at: [f64; 2]) {
        let moved = |p: [f64; 2]| [p[0] + at[0], p[1] + at[1]];
        self.shapes.extend(other.shapes.into_iter().map(|mut shape| {
            match &mut shape {
                Shape::Path { points, .. } => points.iter_mut().for_each(|p| *p = moved(*p)),
                Shape::Ellipse { centre, .. } => *centre = moved(*centre),
                Shape::Text { at, .. } | Shape::Image { at, .. } => *at = moved(*at),
            }
            shape
        }));
    }

    /// The text of an SVG file; images are part of it.
    ///
    /// # Errors
    /// An image whose bytes do not fit its size.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        svg::write(self)
    }

    /// The bytes of a PNG file with `scale` pixels per CSS pixel (1 … 8).
    ///
    /// # Errors
    /// A sheet without area or too large, or an image whose bytes do not fit its size.
    pub fn to_png(&self, scale: f64) -> Result<Vec<u8>, PlotError> {
        raster::write(self, scale)
    }

    /// Its pixels, as many as CSS pixels: width, height, and red, green and blue of each, row by row from the top.
    ///
    /// # Errors
    /// As for [`Self::to_png`].
    pub fn pixels(&self) -> Result<(usize, usize, Vec<u8>), PlotError> {
        raster::pixels(self, 1.0)
    }

    fn path(&mut self, points: &[[f64; 2]], is_closed: bool, stroke: Option<Stroke>, fill: Option<Colour>) {
        // A point that is nowhere would spoil the file.
        if points.len() > 1 && points.as_flattened().iter().all(|v| v.is_finite()) {
            self.shapes.push(Shape::Path { points: points.to_vec(), is_closed, stroke, fill });
        }
    }
}

/// Breaks a text into lines no wider than `width` px.
pub fn wrapped(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if !line.is_empty() && text_width(&longer, size) > width {
                lines.push(std::mem::replace(&mut line, word.to_owned()));
            } else {
                line = longer;
            }
        }
        lines.push(line);
    }
    lines
}

/// A length with few decimals: a hundredth of a pixel is not seen.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" || text.is_empty() { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet() -> Drawing {
        let mut drawing = Drawing::new(120.0, 60.0, "test & trial");
        drawing.rectangle([10.0, 10.0], [20.0, 10.0], None, Some(Colour([200, 0, 0])));
        drawing.line(&[[0.0, 50.0], [120.0, 50.0]], Stroke::solid(Colour([0, 0, 200]), 2.0));
        drawing.text("σ < 1 MPa", [60.0, 30.0], 12.0, Anchor::Middle);
        let image = Image { width: 1, height: 1, rgba: vec![0, 200, 0, 255] };
        drawing.image([100.0, 0.0], [20.0, 20.0], image);
        drawing
    }

    fn pixels(bytes: &[u8]) -> (u32, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        (info.width, data)
    }

    #[test]
    fn png_and_svg_show_the_same_shapes() {
        let drawing = sheet();
        let (width, data) = pixels(&drawing.to_png(2.0).unwrap());
        assert_eq!((width, data.len()), (240, 240 * 120 * 3));
        let at = |x: usize, y: usize| -> [u8; 3] { std::array::from_fn(|k| data[3 * (240 * y + x) + k]) };
        assert_eq!(at(40, 30), [200, 0, 0]);
        assert_eq!(at(100, 100), [0, 0, 200]);
        assert_eq!(at(220, 20), [0, 200, 0]);
        assert_eq!(at(2, 2), [255, 255, 255]);
        // Some ink where the text stands.
        assert!((60..180).any(|x| at(x, 54)[0] < 100));
        let svg = drawing.to_svg().unwrap();
        assert!(svg.contains("test &amp; trial") && svg.contains("σ &lt; 1 MPa"), "{svg}");
        assert!(svg.contains("data:image/png;base64,iVBOR"));
    }

    #[test]
    fn the_font_has_every_glyph_of_captions() {
        for text in ["von Mises stress (MPa)", "θ′ − κ₀ · 10⁻³ mm²", "±≤≥≈×°µ…–—→αβκσ₁₂₃", "ÄÖÜäöüß"]
        {
            for c in text.chars() {
                assert!(font::has_glyph(c), "{c}");
            }
        }
        let (one, two) = (text_width("x", 10.0), text_width("xx", 20.0));
        assert!((two - 4.0 * one).abs() < 1e-9 && one > 3.0);
    }

    #[test]
    fn long_texts_are_broken_between_words() {
        let lines = wrapped("one two three four\nfive", 10.0, text_width("one two three", 10.0));
        assert_eq!(lines, ["one two three", "four", "five"]);
    }

    #[test]
    fn an_impossible_sheet_is_refused() {
        assert!(Drawing::new(0.0, 10.0, "").to_png(1.0).is_err());
        assert!(Drawing::new(1e6, 1e6, "").to_png(1.0).is_err());
        let mut drawing = Drawing::new(10.0, 10.0, "");
        drawing.image([0.0; 2], [1.0; 2], Image { width: 2, height: 2, rgba: vec![0; 3] });
        assert!(drawing.to_png(1.0).is_err() && drawing.to_svg().is_err());
    }
}
