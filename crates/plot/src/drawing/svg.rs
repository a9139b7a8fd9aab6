//! Drawings as SVG.

use super::{Anchor, Colour, Drawing, Shape, Stroke, encode_png, short};
use crate::error::PlotError;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pneuflex_post::vtu::escape;

const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

pub(super) fn write(drawing: &Drawing) -> Result<String, PlotError> {
    let (w, h) = (short(drawing.width), short(drawing.height));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
         font-family=\"{FAMILY}\">\n<title>{}</title>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
        escape(&drawing.title)
    );
    for shape in &drawing.shapes {
        push(&mut text, shape)?;
    }
    Ok(text + "</svg>\n")
}

fn push(text: &mut String, shape: &Shape) -> Result<(), PlotError> {
    match shape {
        Shape::Path { points, is_closed, stroke, fill } => {
            let name = if *is_closed { "polygon" } else { "polyline" };
            let points: Vec<String> = points.iter().map(|[x, y]| format!("{},{}", short(*x), short(*y))).collect();
            *text += &format!("<{name} points=\"{}\"{}/>\n", points.join(" "), style(stroke.as_ref(), *fill));
        }
        Shape::Ellipse { centre: [x, y], radii: [a, b], turn_deg, stroke, fill } => {
            let (x, y) = (short(*x), short(*y));
            let turn = if *turn_deg == 0.0 {
                String::new()
            } else {
                format!(" transform=\"rotate({} {x} {y})\"", short(*turn_deg))
            };
            let style = style(stroke.as_ref(), *fill);
            *text +=
                &format!("<ellipse cx=\"{x}\" cy=\"{y}\" rx=\"{}\" ry=\"{}\"{turn}{style}/>\n", short(*a), short(*b));
        }
        Shape::Text { text: words, at: [x, y], size, anchor, is_upright, colour } => {
            let (x, y) = (short(*x), short(*y));
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let turn = if *is_upright { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
            *text += &format!(
                "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"{anchor}{turn} fill=\"{}\">{}</text>\n",
                short(*size),
                hex(*colour),
                escape(words)
            );
        }
        Shape::Image { at: [x, y], size: [w, h], image } => {
            let png = encode_png(image.width, image.height, &image.rgba)?;
            *text += &format!(
                "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
                 href=\"data:image/png;base64,",
                short(*x),
                short(*y),
                short(*w),
                short(*h)
            );
            STANDARD.encode_string(&png, text);
            *text += "\"/>\n";
        }
    }
    Ok(())
}

fn style(stroke: Option<&Stroke>, fill: Option<Colour>) -> String {
    let mut text = match fill {
        Some(colour) => format!(" fill=\"{}\"", hex(colour)),
        None => " fill=\"none\"".into(),
    };
    if let Some(stroke) = stroke {
        text += &format!(" stroke=\"{}\" stroke-width=\"{}\"", hex(stroke.colour), short(stroke.width));
        text += " stroke-linecap=\"round\" stroke-linejoin=\"round\"";
        if !stroke.dashes.is_empty() {
            let dashes: Vec<String> = stroke.dashes.iter().map(|d| short(*d)).collect();
            text += &format!(" stroke-dasharray=\"{}\"", dashes.join(" "));
        }
    }
    text
}

fn hex(Colour([r, g, b]): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
