//! Drawings as PNG.

use tiny_skia::{
    FillRule, FilterQuality, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PixmapPaint, Rect, StrokeDash,
    Transform,
};

use super::{Anchor, Colour, Drawing, Image, Shape, Stroke, encode_png, font, text_width};
use pneuflex_post::PostError;

use crate::error::PlotError;

/// Pixels of a side beyond which a sheet is taken for a mistake.
const LARGEST: f64 = 30_000.0;

pub(super) fn write(drawing: &Drawing, scale: f64) -> Result<Vec<u8>, PlotError> {
    let (width, height, rgb) = pixels(drawing, scale)?;
    encode_png(width, height, &rgb)
}

/// Width, height, and red, green and blue of every pixel.
pub(super) fn pixels(drawing: &Drawing, scale: f64) -> Result<(usize, usize, Vec<u8>), PlotError> {
    let [width, height] = [drawing.width, drawing.height].map(|x| (x * scale).ceil());
    let not_drawable = || PlotError::NotDrawable { what: format!("a sheet of {width} by {height} pixels") };
    if !(1.0..=LARGEST).contains(&width) || !(1.0..=LARGEST).contains(&height) {
        return Err(not_drawable());
    }
    let mut sheet = Pixmap::new(width as u32, height as u32).ok_or_else(not_drawable)?;
    sheet.fill(tiny_skia::Color::WHITE);
    for shape in &drawing.shapes {
        draw(&mut sheet, shape, Transform::from_scale(scale as f32, scale as f32))?;
    }
    // The sheet is opaque: nothing is multiplied in.
    let rgb = sheet.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    Ok((width as usize, height as usize, rgb))
}

fn draw(sheet: &mut Pixmap, shape: &Shape, scale: Transform) -> Result<(), PlotError> {
    match shape {
        Shape::Path { points, is_closed, stroke, fill } => {
            let mut path = PathBuilder::new();
            for (i, [x, y]) in points.iter().enumerate() {
                let (x, y) = (*x as f32, *y as f32);
                if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
            }
            if *is_closed {
                path.close();
            }
            if let Some(path) = path.finish() {
                fill_and_stroke(sheet, &path, stroke.as_ref(), *fill, scale);
            }
        }
        Shape::Ellipse { centre, radii, turn_deg, stroke, fill } => {
            let [a, b] = radii.map(|r| r.abs() as f32);
            let path = Rect::from_ltrb(-a, -b, a, b).and_then(PathBuilder::from_oval);
            if let Some(path) = path {
                let place = Transform::from_rotate(*turn_deg as f32)
                    .post_translate(centre[0] as f32, centre[1] as f32)
                    .post_concat(scale);
                fill_and_stroke(sheet, &path, stroke.as_ref(), *fill, place);
            }
        }
        Shape::Text { text, at, size, anchor, is_upright, colour } => {
            let shift = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -0.5 * text_width(text, *size),
                Anchor::End => -text_width(text, *size),
            };
            let mut path = PathBuilder::new();
            font::outline(text, *size, &mut path);
            if let Some(path) = path.finish() {
                let turn = if *is_upright { -90.0 } else { 0.0 };
                let place = Transform::from_translate(shift as f32, 0.0)
                    .post_concat(Transform::from_rotate(turn))
                    .post_translate(at[0] as f32, at[1] as f32)
                    .post_concat(scale);
                fill_and_stroke(sheet, &path, None, Some(*colour), place);
            }
        }
        Shape::Image { at, size, image } => {
            let pixels = pixmap(image)?;
            let (sx, sy) = (size[0] / image.width as f64, size[1] / image.height as f64);
            let place = Transform::from_scale(sx as f32, sy as f32)
                .post_translate(at[0] as f32, at[1] as f32)
                .post_concat(scale);
            let paint = PixmapPaint { quality: FilterQuality::Bilinear, ..PixmapPaint::default() };
            sheet.draw_pixmap(0, 0, pixels.as_ref(), &paint, place, None);
        }
    }
    Ok(())
}

fn fill_and_stroke(sheet: &mut Pixmap, path: &Path, stroke: Option<&Stroke>, fill: Option<Colour>, place: Transform) {
    if let Some(colour) = fill {
        sheet.fill_path(path, &paint(colour), FillRule::Winding, place, None);
    }
    if let Some(stroke) = stroke {
        let dash = match stroke.dashes.len() {
            0 => None,
            n => {
                // The rasteriser wants an even number of lengths.
                let twice = if n % 2 == 0 { 1 } else { 2 };
                StrokeDash::new(stroke.dashes.repeat(twice).iter().map(|d| *d as f32).collect(), 0.0)
            }
        };
        let style = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            dash,
            ..tiny_skia::Stroke::default()
        };
        sheet.stroke_path(path, &paint(stroke.colour), &style, place, None);
    }
}

fn paint(Colour([r, g, b]): Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

fn pixmap(image: &Image) -> Result<Pixmap, PlotError> {
    let expected = 4 * image.width * image.height;
    let wrong = || PostError::WrongLength { what: "image".into(), expected, found: image.rgba.len() }.into();
    if image.rgba.len() != expected {
        return Err(wrong());
    }
    let mut pixels = Pixmap::new(image.width as u32, image.height as u32).ok_or_else(wrong)?;
    for (to, from) in pixels.data_mut().chunks_exact_mut(4).zip(image.rgba.chunks_exact(4)) {
        let alpha = u16::from(from[3]);
        for k in 0..3 {
            to[k] = ((u16::from(from[k]) * alpha + 127) / 255) as u8;
        }
        to[3] = from[3];
    }
    Ok(pixels)
}
