//! The font of texts: a subset of DejaVu Sans, which is part of the program.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

static FONT: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("../../assets/DejaVuSans-subset.ttf"), 0).ok());

/// Width of a text of the given size, px.
pub fn text_width(text: &str, size: f64) -> f64 {
    glyphs(text, size).1
}

/// Whether the font can show a character.
#[cfg(test)]
pub(super) fn has_glyph(c: char) -> bool {
    FONT.as_ref().is_some_and(|face| face.glyph_index(c).is_some())
}

/// Glyphs with the place where each starts, and the width of the whole.
fn glyphs(text: &str, size: f64) -> (Vec<(GlyphId, f64)>, f64) {
    let Some(face) = FONT.as_ref() else { return (Vec::new(), 0.0) };
    let scale = size / f64::from(face.units_per_em());
    let mut x = 0.0;
    let glyphs = text
        .chars()
        .map(|c| {
            let glyph = face.glyph_index(c).unwrap_or_default();
            let start = x;
            x += scale * f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
            (glyph, start)
        })
        .collect();
    (glyphs, x)
}

/// Draws the outlines of a text that starts at the origin, y downwards, px.
pub(super) fn outline(text: &str, size: f64, path: &mut tiny_skia::PathBuilder) {
    let Some(face) = FONT.as_ref() else { return };
    let scale = size / f64::from(face.units_per_em());
    for (glyph, start) in glyphs(text, size).0 {
        face.outline_glyph(glyph, &mut Pen { path, scale: scale as f32, start: start as f32 });
    }
}

struct Pen<'a> {
    path: &'a mut tiny_skia::PathBuilder,
    scale: f32,
    start: f32,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.start + self.scale * x, -self.scale * y)
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
