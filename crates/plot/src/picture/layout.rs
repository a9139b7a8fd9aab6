//! Where the panels of a figure, their insets and the bar of colours go on the sheet, and how they are drawn there.

use pneuflex_mesh::vector::{Vec3, norm, sub};
use pneuflex_post::surface::Bounds;

use super::colour_map::viridis;
use super::figure::{Figure, Panel};
use super::raster::{Frame, Paint, render};
use super::skin::{Face, Skin};
use super::view::Camera;
use crate::axis::ticks;
use crate::drawing::{Anchor, Colour, Drawing, Stroke, text_width, wrapped};
use crate::error::PlotError;

/// What is drawn of one panel.
pub(super) struct Scene {
    pub(super) skin: Skin,
    pub(super) obstacles: Vec<Face>,
    /// Points of every gap to be ringed.
    pub(super) rings: Vec<Vec<Vec3>>,
    /// Least and largest value of the field.
    pub(super) values: Option<[f64; 2]>,
}

/// By how much the body's part of the picture grows for obstacles at the most.
const NEAR: f64 = 0.5;

pub(super) const MARGIN: f64 = 14.0;
const TITLE: f64 = 17.0;
const HEADING: f64 = 13.0;
const SMALL: f64 = 11.0;
const BAR_WIDTH: f64 = 18.0;
const INK: Colour = Colour([34, 34, 34]);
const GREY: Colour = Colour([120, 120, 120]);

/// Where everything goes.
pub(super) struct Layout {
    camera: Camera,
    frame: Frame,
    /// px per mm.
    scale: f64,
    panel: [f64; 2],
    top: f64,
    inset_height: f64,
    range: Option<[f64; 2]>,
    bar_space: f64,
}

impl Layout {
    pub(super) fn new(figure: &Figure<'_>, scenes: &[Scene], range: Option<[f64; 2]>) -> Result<Self, PlotError> {
        let corners = |faces: fn(&Scene) -> &[Face]| {
            let vertices = scenes.iter().flat_map(faces).flat_map(|face| &face.vertices);
            vertices.map(|vertex| vertex.position).collect::<Vec<Vec3>>()
        };
        let own = || [corners(|scene| &scene.skin.faces), corners(|scene| &scene.obstacles)];
        let [body, obstacles] = figure.room.clone().unwrap_or_else(own);
        let bounds = Bounds::around(&body);
        if !bounds.low.iter().chain(&bounds.high).all(|x| x.is_finite()) {
            return Err(PlotError::NotDrawable { what: "a figure without room".into() });
        }
        let camera = Camera::new(&figure.view, bounds.centre(), norm(sub(bounds.high, bounds.low)));
        let seen = |point: &Vec3| {
            let seen = camera.see(*point);
            [seen.x, seen.y]
        };
        let mut frame = body.iter().fold(Frame::EMPTY, |frame, point| frame.with(seen(point)));
        // Obstacles as far as they are near.
        let most = frame.grown(frame.size().map(|s| (1.0 + NEAR) * s));
        for point in obstacles.iter().map(seen) {
            frame = frame.with(std::array::from_fn(|d| point[d].clamp(most.low[d], most.high[d])));
        }
        // Room for lines and rings at the border.
        let room = 0.04 * frame.size()[0].max(frame.size()[1]);
        frame = frame.grown(frame.size().map(|s| s + 2.0 * room));
        let bar_space = if range.is_some() { 100.0 } else { 0.0 };
        let count = scenes.len() as f64;
        let width = (figure.width - 2.0 * MARGIN - bar_space - (count - 1.0) * MARGIN) / count;
        let not_drawable = || PlotError::NotDrawable { what: format!("panels {width} px wide") };
        if !width.is_finite() || width < 20.0 || !figure.max_panel_height.is_finite() || figure.max_panel_height < 20.0
        {
            return Err(not_drawable());
        }
        let [w, h] = frame.size();
        let scale = (width / w).min(figure.max_panel_height / h);
        let frame = frame.grown([width / scale, h]);
        let title = if figure.title.is_empty() { 0.0 } else { TITLE + 10.0 };
        let heading = if figure.panels.iter().all(|p| p.title.is_empty()) { 0.0 } else { HEADING + 8.0 };
        let has_inset = figure.panels.iter().any(|p| p.inset.is_some());
        let inset_height = if has_inset { (0.62 * width).min(0.75 * figure.max_panel_height) } else { 0.0 };
        let panel = [width, frame.size()[1] * scale];
        Ok(Self { camera, frame, scale, panel, top: MARGIN + title + heading, inset_height, range, bar_space })
    }

    pub(super) fn draw(&self, figure: &Figure<'_>, scenes: &[Scene]) -> Result<Drawing, PlotError> {
        let caption = wrapped(&figure.caption, SMALL, figure.width - 2.0 * MARGIN);
        let inset_space = if self.inset_height > 0.0 { self.inset_height + 2.0 * MARGIN } else { 0.0 };
        let body = self.top + self.panel[1] + inset_space + MARGIN;
        let height = body + caption.len() as f64 * (SMALL + 5.0) + if caption.is_empty() { 0.0 } else { 6.0 };
        let mut drawing = Drawing::new(figure.width, height, &figure.title);
        drawing.text(&figure.title, [MARGIN, MARGIN + TITLE - 3.0], TITLE, Anchor::Start);
        for (i, (panel, scene)) in figure.panels.iter().zip(scenes).enumerate() {
            let left = MARGIN + i as f64 * (self.panel[0] + MARGIN);
            self.draw_panel(&mut drawing, figure, panel, scene, left)?;
        }
        self.draw_axes(&mut drawing, figure);
        if let Some(range) = self.range {
            let largest = scenes.iter().filter_map(|s| s.values).fold(f64::NEG_INFINITY, |m, v| m.max(v[1]));
            let least = scenes.iter().filter_map(|s| s.values).fold(f64::INFINITY, |m, v| m.min(v[0]));
            let left = figure.width - MARGIN - self.bar_space + 12.0;
            colour_bar(&mut drawing, [left, self.top], self.panel[1], range, [least, largest], &figure.label);
        }
        for (i, line) in caption.iter().enumerate() {
            drawing.text(line, [MARGIN, body + (i + 1) as f64 * (SMALL + 5.0) - 5.0], SMALL, Anchor::Start);
        }
        Ok(drawing)
    }

    fn draw_panel(
        &self,
        drawing: &mut Drawing,
        figure: &Figure<'_>,
        panel: &Panel<'_>,
        scene: &Scene,
        left: f64,
    ) -> Result<(), PlotError> {
        let corner = [left, self.top];
        drawing.text(&panel.title, [left, self.top - 8.0], HEADING, Anchor::Start);
        let Some(inset) = panel.inset else {
            return self.draw_frame(drawing, figure, scene, &self.frame, self.scale, corner, self.panel);
        };
        let seen = self.camera.see(inset);
        let size = [self.panel[0], self.inset_height];
        let scale = size[0] / figure.inset_width.max(1e-6);
        let point = [seen.x, seen.y];
        let frame = Frame { low: point, high: point }.grown(size.map(|s| s / scale));
        let at = [left, self.top + self.panel[1] + MARGIN];
        // What is enlarged, and lines that lead there.
        let to = |p: [f64; 2]| to_drawing(&self.frame, self.scale, corner, p);
        let (a, b) = (to([frame.low[0], frame.high[1]]), to([frame.high[0], frame.low[1]]));
        let thin = Stroke::solid(GREY, 0.8);
        // The body hides them: lines across it would look like its edges.
        drawing.line(&[[a[0], b[1]], at], thin.clone());
        drawing.line(&[[b[0], b[1]], [at[0] + size[0], at[1]]], thin);
        self.draw_frame(drawing, figure, scene, &self.frame, self.scale, corner, self.panel)?;
        self.draw_frame(drawing, figure, scene, &frame, scale, at, size)?;
        drawing.rectangle(at, size, Some(Stroke::solid(GREY, 1.0)), None);
        drawing.rectangle(a, [b[0] - a[0], b[1] - a[1]], Some(Stroke::solid(INK, 1.2)), None);
        let text = format!("{:.1} × enlarged, {:.0} mm wide", scale / self.scale, figure.inset_width);
        let [w, h] = [text_width(&text, SMALL) + 10.0, SMALL + 8.0];
        drawing.rectangle([at[0], at[1] + size[1] - h], [w, h], None, Some(Colour::WHITE));
        drawing.text(&text, [at[0] + 5.0, at[1] + size[1] - 6.0], SMALL, Anchor::Start);
        Ok(())
    }

    #[expect(clippy::too_many_arguments, reason = "a part of a scene, where it goes, and how")]
    fn draw_frame(
        &self,
        drawing: &mut Drawing,
        figure: &Figure<'_>,
        scene: &Scene,
        frame: &Frame,
        scale: f64,
        corner: [f64; 2],
        size: [f64; 2],
    ) -> Result<(), PlotError> {
        let sharpness = figure.sharpness.clamp(0.5, 4.0);
        let pixels = size.map(|s| (s * sharpness).round().max(1.0) as usize);
        let paint = Paint {
            range: scene.values.and(self.range),
            edge_width: sharpness * (scale * scene.skin.face_size() / 70.0).clamp(0.35, 1.0),
        };
        let image = render((&scene.skin, &scene.obstacles), &self.camera, frame, scale * sharpness, pixels, &paint);
        drawing.image(corner, size, image);
        for ring in &scene.rings {
            let points: Vec<[f64; 2]> = ring
                .iter()
                .map(|&p| {
                    let seen = self.camera.see(p);
                    to_drawing(frame, scale, corner, [seen.x, seen.y])
                })
                .collect();
            let (centre, radii, turn_deg) = oval(&points);
            let is_inside = (0..2).all(|d| centre[d] > corner[d] && centre[d] < corner[d] + size[d]);
            let is_small = radii.iter().all(|r| 2.0 * r < 1.2 * size[0].max(size[1]));
            if is_inside && is_small {
                drawing.ellipse(centre, radii, turn_deg, Some(Stroke::solid(Colour::WHITE, 3.6)), None);
                drawing.ellipse(centre, radii, turn_deg, Some(Stroke::dotted(Colour::BLACK, 2.4)), None);
            }
        }
        Ok(())
    }

    /// A tripod of the axes and a length, in the lower left corner of the first panel.
    fn draw_axes(&self, drawing: &mut Drawing, figure: &Figure<'_>) {
        let [x, y] = [MARGIN + 34.0, self.top + self.panel[1] - 30.0];
        for (name, direction) in [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])] {
            let [dx, dy] = self.camera.direction(direction);
            if dx.hypot(dy) < 0.15 {
                continue;
            }
            let tip = [x + 24.0 * dx, y - 24.0 * dy];
            drawing.line(&[[x, y], tip], Stroke::solid(INK, 1.4));
            let label = [x + 32.0 * dx, y - 32.0 * dy + 4.0];
            drawing.text(name, label, SMALL, Anchor::Middle);
        }
        if figure.view.distance.is_none() {
            // Parallel rays: one length is true for the whole picture.
            let wanted = 90.0 / self.scale;
            let power = 10_f64.powf(wanted.log10().floor());
            let length = [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|l| *l <= wanted).unwrap_or(power);
            let right = MARGIN + self.panel[0] - 6.0;
            let (y, left) = (self.top + self.panel[1] - 8.0, right - length * self.scale);
            let text = format!("{length} mm");
            // On white, because the lines to an inset may pass here.
            let wide = text_width(&text, SMALL).max(right - left) + 6.0;
            let corner = [0.5 * (left + right - wide), y - SMALL - 6.0];
            drawing.rectangle(corner, [wide, SMALL + 9.0], None, Some(Colour::WHITE));
            drawing.line(&[[left, y - 4.0], [left, y], [right, y], [right, y - 4.0]], Stroke::solid(INK, 1.2));
            drawing.text(&text, [0.5 * (left + right), y - 5.0], SMALL, Anchor::Middle);
        }
    }
}

fn to_drawing(frame: &Frame, scale: f64, corner: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [corner[0] + (x - frame.low[0]) * scale, corner[1] + (frame.high[1] - y) * scale]
}

/// An ellipse around points along their own axes: centre, radii, turn in degrees.
fn oval(points: &[[f64; 2]]) -> ([f64; 2], [f64; 2], f64) {
    let n = points.len() as f64;
    let mean: [f64; 2] = std::array::from_fn(|d| points.iter().map(|p| p[d]).sum::<f64>() / n);
    let moment = |a: usize, b: usize| points.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum::<f64>();
    let angle = 0.5 * (2.0 * moment(0, 1)).atan2(moment(0, 0) - moment(1, 1));
    let (sine, cosine) = angle.sin_cos();
    let along = |p: &[f64; 2]| [cosine * p[0] + sine * p[1], -sine * p[0] + cosine * p[1]];
    let frame = points.iter().fold(Frame::EMPTY, |f, p| f.with(along(p)));
    let [u, v] = frame.centre();
    // An ellipse through the corners of the points' box would be √2 larger; they seldom fill their corners.
    let radii = frame.size().map(|s| 0.62 * s + 12.0);
    ([cosine * u - sine * v, sine * u + cosine * v], radii, angle.to_degrees())
}

/// A bar with ticks; an arrow where the values go on beyond the range.
fn colour_bar(drawing: &mut Drawing, at: [f64; 2], height: f64, range: [f64; 2], values: [f64; 2], label: &str) {
    const STEPS: usize = 128;
    let arrow = 14.0;
    let [low, high] = range;
    let tolerance = 1e-9 * (high - low);
    let (goes_above, goes_below) = (values[1] > high + tolerance, values[0] < low - tolerance);
    let (top, bottom) = (at[1] + arrow + 4.0, at[1] + height - arrow - 4.0);
    let step = (bottom - top) / STEPS as f64;
    for i in 0..STEPS {
        let colour = viridis((i as f64 + 0.5) / STEPS as f64);
        let y = bottom - (i + 1) as f64 * step;
        // A little taller than a step, so that no white shows between them.
        let h = if i == 0 { step } else { step + 0.6 };
        drawing.rectangle([at[0], y], [BAR_WIDTH, h], None, Some(colour));
    }
    let thin = Stroke::solid(INK, 0.8);
    drawing.rectangle([at[0], top], [BAR_WIDTH, bottom - top], Some(thin.clone()), None);
    let middle = at[0] + 0.5 * BAR_WIDTH;
    if goes_above {
        let tip = [[at[0], top], [middle, top - arrow], [at[0] + BAR_WIDTH, top]];
        drawing.polygon(&tip, Some(thin.clone()), Some(viridis(1.0)));
        drawing.text(&format!("max {}", significant(values[1])), [at[0], top - arrow - 4.0], SMALL, Anchor::Start);
    }
    if goes_below {
        let tip = [[at[0], bottom], [middle, bottom + arrow], [at[0] + BAR_WIDTH, bottom]];
        drawing.polygon(&tip, Some(thin.clone()), Some(viridis(0.0)));
    }
    let right = at[0] + BAR_WIDTH;
    let mut widest: f64 = 0.0;
    for (value, text) in ticks(low, high, 6) {
        let y = bottom - (value - low) / (high - low) * (bottom - top);
        drawing.line(&[[right, y], [right + 4.0, y]], thin.clone());
        drawing.text(&text, [right + 7.0, y + 4.0], SMALL, Anchor::Start);
        widest = widest.max(text_width(&text, SMALL));
    }
    drawing.upright_text(label, [right + 7.0 + widest + 16.0, 0.5 * (top + bottom)], HEADING, Anchor::Middle);
}

fn significant(value: f64) -> String {
    let digits = (2 - value.abs().max(1e-300).log10().floor() as i32).clamp(0, 12) as usize;
    format!("{value:.digits$}")
}
