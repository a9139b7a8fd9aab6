//! Pictures of deformed bodies: hidden surfaces, element edges, colours of a nodal field with their bar, insets.
//!
//! A [`Figure`] shows one or several bodies side by side, all from the same direction, at the same scale and with the
//! same colours, so that they can be compared. Surfaces are hidden by a depth buffer. Where two parts of a body lie in
//! each other in the plane of a section, the picture is red; areas where facing walls have passed through each other are
//! ringed by a dotted oval, as in the paper's Fig. 4.
//!
//! ```
//! use pneuflex_mesh::{Actuator, MeshSize};
//! use pneuflex_model::{Contact, Formulation, Material, Problem};
//! use pneuflex_plot::picture::{Body, Figure, Panel};
//!
//! let size = MeshSize::uniform(2.0);
//! let problem = Problem::from_actuator(
//!     &Actuator::two_chambers(), &size, Formulation::Hex8Sri, Material::default(), Contact::default())?;
//! let displacement = vec![[0.0; 3]; problem.mesh.num_nodes()];
//! let height: Vec<f64> = problem.mesh.nodes.iter().map(|x| x[2]).collect();
//! let body = Body { field: Some(&height), ..Body::plain(&problem, &displacement) };
//! let figure = Figure { label: "height (mm)".into(), ..Figure::new("At rest", vec![Panel::new("half model", body)]) };
//! let drawing = figure.draw()?;
//! assert!(drawing.to_png(1.0)?.len() > 1000 && drawing.to_svg()?.contains("height (mm)"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod colour_map;
mod marks;
mod obstacles;
mod raster;
mod skin;
mod view;

pub use colour_map::viridis;
pub use marks::{Nearest, nearest};
pub use obstacles::{ObstacleSurface, obstacle_surface};
pub use view::View;

use pneuflex_model::{Image, LoadParameter, Problem};

use crate::chart::ticks;
use crate::drawing::{Anchor, Colour, Drawing, Stroke, text_width, wrapped};
use pneuflex_post::check;

use crate::error::PlotError;
use obstacles::Extent;
use pneuflex_mesh::vector::{Vec3, norm, sub};
use pneuflex_post::surface::Bounds;
use raster::{Frame, Paint, render};
use skin::{Face, Skin};
use view::Camera;

/// A deformed body.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// The body at rest.
    pub problem: &'a Problem,
    /// Displacements, mm, three per node.
    pub displacement: &'a [[f64; 3]],
    /// Nodal field that colours it; `None` for one colour.
    pub field: Option<&'a [f64]>,
    /// Whether to show a modelled part together with its mirror images.
    pub is_mirrored: bool,
    /// Where on the load path its obstacles are; `None` to leave them out.
    pub obstacles_at: Option<LoadParameter>,
}

impl<'a> Body<'a> {
    /// A body in one colour, as it is modelled.
    pub fn plain(problem: &'a Problem, displacement: &'a [[f64; 3]]) -> Self {
        Self { problem, displacement, field: None, is_mirrored: false, obstacles_at: None }
    }

    /// The plane y = const through which the inside of a half model is seen, which lies above it.
    fn section(&self) -> Option<f64> {
        let plane = self.problem.symmetry.iter().find(|plane| plane.axis == 1).filter(|_| !self.is_mirrored)?;
        self.problem.mesh.nodes.iter().any(|x| x[1] > plane.at + 1e-6 * plane.at.abs().max(1.0)).then_some(plane.at)
    }

    /// The images of the modelled part that are shown.
    fn images(&self) -> Vec<Image> {
        if self.is_mirrored { self.problem.images() } else { vec![Image::default()] }
    }
}

/// One body of a figure.
#[derive(Clone, Debug)]
pub struct Panel<'a> {
    /// Heading.
    pub title: String,
    /// What is shown.
    pub body: Body<'a>,
    /// Deformed position, mm, around which an enlarged part is shown below.
    pub inset: Option<[f64; 3]>,
}

impl<'a> Panel<'a> {
    /// A body without an enlarged part.
    pub fn new(title: &str, body: Body<'a>) -> Self {
        Self { title: title.into(), body, inset: None }
    }

    /// The same with an enlarged part around the place where the walls of gap `gap` (from 0; `None`: of all gaps) are
    /// nearest; on the symmetry plane for a half model. A body without gaps has none.
    ///
    /// # Errors
    /// Displacements of the wrong length or with a number that is not finite.
    pub fn with_contact_inset(mut self, gap: Option<usize>) -> Result<Self, PlotError> {
        let places = nearest(self.body.problem, self.body.displacement)?;
        let wanted = places.iter().filter(|n| gap.is_none_or(|g| g == n.gap));
        let deepest = wanted.min_by(|a, b| a.distance_mm.total_cmp(&b.distance_mm));
        self.inset = deepest.map(|n| {
            let [x, y, z] = n.position;
            [x, self.body.section().unwrap_or(y), z]
        });
        Ok(self)
    }
}

/// Bodies side by side with one colour bar.
#[derive(Clone, Debug)]
pub struct Figure<'a> {
    /// Title.
    pub title: String,
    /// Sentences below the picture: pressure, mesh, what to look at.
    pub caption: String,
    /// What is shown, from left to right.
    pub panels: Vec<Panel<'a>>,
    /// From where.
    pub view: View,
    /// Range of the colours; `None` for the least and largest nodal value of all panels.
    ///
    /// A range that ends below the largest value gets a bar with an arrow: stresses at re-entrant edges have no limit
    /// under refinement, and a bar that reaches for them shows nothing else.
    pub range: Option<[f64; 2]>,
    /// What the colours mean, with the unit.
    pub label: String,
    /// Width of the whole, px.
    pub width: f64,
    /// Largest height of a panel, px.
    pub max_panel_height: f64,
    /// Width of what an inset shows, mm.
    pub inset_width: f64,
    /// Walls deeper than this in each other are ringed, mm; `None` for no rings. Penalty contact always leaves a few
    /// hundredths of a millimetre.
    pub ring_deeper_than: Option<f64>,
    /// Pixels of the image per px of the drawing.
    pub sharpness: f64,
    /// Points that the picture has room for, mm, in place of what it shows: of the body, and as far as they are near of obstacles. Pictures
    /// of a film have the same.
    pub room: Option<[Vec<Vec3>; 2]>,
}

impl<'a> Figure<'a> {
    /// A figure of some panels.
    pub fn new(title: &str, panels: Vec<Panel<'a>>) -> Self {
        Self {
            title: title.into(),
            caption: String::new(),
            panels,
            view: View::SECTION,
            range: None,
            label: String::new(),
            width: 1100.0,
            max_panel_height: 620.0,
            inset_width: 6.0,
            ring_deeper_than: Some(0.1),
            sharpness: 2.0,
            room: None,
        }
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// Lists of the wrong length or with a number that is not finite; a figure without panels or with a width of
    /// nothing.
    pub fn draw(&self) -> Result<Drawing, PlotError> {
        let scenes = self.scenes()?;
        let range = self.common_range(&scenes);
        Layout::new(self, &scenes, range)?.draw(self, &scenes)
    }

    fn scenes(&self) -> Result<Vec<Scene>, PlotError> {
        let mut scenes = Vec::new();
        let mut bounds = Bounds::EMPTY;
        for panel in &self.panels {
            let Body { problem, displacement, field, is_mirrored, obstacles_at } = panel.body;
            check("displacement", displacement.as_flattened(), problem.num_dofs())?;
            if let Some(field) = field {
                check("field", field, problem.mesh.num_nodes())?;
            }
            if let Some(inset) = panel.inset {
                check("inset", &inset, 3)?;
            }
            let images = panel.body.images();
            let skin = Skin::new(problem, displacement, field, &images);
            bounds = bounds.join(&skin.bounds);
            let mut rings: Vec<Vec<Vec3>> = match self.ring_deeper_than {
                Some(depth) => marks::deeper_than(problem, displacement, depth)?,
                None => Vec::new(),
            };
            if let Some(plane) = panel.body.section() {
                // What is seen of it is its cut by the symmetry plane.
                rings.iter_mut().flatten().for_each(|point| point[1] = plane);
            } else {
                for ring in &mut rings {
                    *ring = images.iter().flat_map(|image| ring.iter().map(|&point| image.point(point))).collect();
                }
            }
            rings.retain(|ring| !ring.is_empty());
            let values =
                field.map(|f| f.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]));
            let extent = match (is_mirrored, panel.body.section()) {
                (true, _) => Extent::Whole,
                (false, Some(plane)) => Extent::Section(plane),
                (false, None) => Extent::Part,
            };
            let obstacles =
                obstacles_at.map(|at| obstacles::faces(problem, at, &skin.bounds, extent)).unwrap_or_default();
            scenes.push(Scene { skin, obstacles, rings, values });
        }
        if !bounds.low.iter().chain(&bounds.high).all(|x| x.is_finite()) {
            return Err(PlotError::NotDrawable { what: "a figure without bodies".into() });
        }
        Ok(scenes)
    }

    fn common_range(&self, scenes: &[Scene]) -> Option<[f64; 2]> {
        let values = scenes.iter().filter_map(|s| s.values).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])?;
        let [low, high] = self.range.unwrap_or(values);
        Some(if high > low { [low, high] } else { [low, low + 1.0] })
    }
}

/// What is drawn of one panel.
struct Scene {
    skin: Skin,
    obstacles: Vec<Face>,
    /// Points of every gap to be ringed.
    rings: Vec<Vec<Vec3>>,
    /// Least and largest value of the field.
    values: Option<[f64; 2]>,
}

/// By how much the body's part of the picture grows for obstacles at the most.
const NEAR: f64 = 0.5;

const MARGIN: f64 = 14.0;
const TITLE: f64 = 17.0;
const HEADING: f64 = 13.0;
const SMALL: f64 = 11.0;
const BAR_WIDTH: f64 = 18.0;
const INK: Colour = Colour([34, 34, 34]);
const GREY: Colour = Colour([120, 120, 120]);

/// Where everything goes.
struct Layout {
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
    fn new(figure: &Figure<'_>, scenes: &[Scene], range: Option<[f64; 2]>) -> Result<Self, PlotError> {
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

    fn draw(&self, figure: &Figure<'_>, scenes: &[Scene]) -> Result<Drawing, PlotError> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Shape;
    use crate::testing::{displacement_of, two_chambers};

    fn images(drawing: &Drawing) -> Vec<&crate::drawing::Image> {
        let image = |s: &'_ Shape| matches!(s, Shape::Image { .. });
        drawing
            .shapes
            .iter()
            .filter(|s| image(s))
            .filter_map(|s| if let Shape::Image { image, .. } = s { Some(image) } else { None })
            .collect()
    }

    /// Share of pixels for which a colour passes a test.
    fn share(image: &crate::drawing::Image, test: impl Fn([u8; 3]) -> bool) -> f64 {
        let seen = image.rgba.chunks_exact(4).filter(|p| p[3] == 255 && test([p[0], p[1], p[2]]));
        seen.count() as f64 / (image.width * image.height) as f64
    }

    fn is_red([r, g, b]: [u8; 3]) -> bool {
        r > 150 && g < 80 && b < 80
    }

    fn figure(problem: &Problem, u: &[[f64; 3]], view: View) -> Drawing {
        let panel = Panel::new("", Body::plain(problem, u));
        Figure { view, width: 300.0, sharpness: 1.0, ..Figure::new("", vec![panel]) }.draw().unwrap()
    }

    #[test]
    fn the_section_of_a_half_model_shows_the_cavities_and_the_outside_does_not() {
        let problem = two_chambers(2.0);
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        // Colour by height: inside the cavities one sees their far side walls at every height; from outside, too. What
        // differs is the area of the section's own colour: mark the symmetry plane.
        let on_plane: Vec<f64> = problem.mesh.nodes.iter().map(|x| if x[1] == 0.0 { 1.0 } else { 0.0 }).collect();
        let body = Body { field: Some(&on_plane), ..Body::plain(&problem, &zero) };
        let seen = |azimuth_deg: f64| {
            let view = View { azimuth_deg, ..View::SIDE };
            let panels = vec![Panel::new("", body)];
            let drawing = Figure { view, width: 500.0, sharpness: 1.0, ..Figure::new("", panels) }.draw().unwrap();
            let image = images(&drawing)[0].clone();
            let all = share(&image, |_| true);
            share(&image, |[r, _, b]| r > 120 && b < 80) / all
        };
        // Section area 18 × 4 + 2 × (8 × 9 − 6 × 8) less the channel, of the silhouette 18 × 13 − 2 × 9.
        let (section, silhouette) = (18.0 * 4.0 + 48.0 - 28.0, 18.0 * 13.0 - 18.0);
        assert!((seen(-90.0) - section / silhouette).abs() < 0.06, "{}", seen(-90.0));
        assert_eq!(seen(90.0), 0.0);
    }

    #[test]
    fn walls_in_each_other_are_red_and_ringed() {
        let problem = two_chambers(2.0);
        let pushed =
            displacement_of(&problem, |x| [if x[0] > 6.5 && x[0] < 8.5 && x[2] > 7.0 { 2.6 } else { 0.0 }, 0.0, 0.0]);
        let drawing = figure(&problem, &pushed, View::SIDE);
        assert!(share(images(&drawing)[0], is_red) > 0.005);
        let ovals = |d: &Drawing| d.shapes.iter().filter(|s| matches!(s, Shape::Ellipse { .. })).count();
        assert_eq!(ovals(&drawing), 2);
        // At rest nothing is in anything else, from no side and in no projection.
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        for view in [View::SIDE, View::SECTION, View::OUTSIDE, View { distance: Some(2.0), ..View::SECTION }] {
            let drawing = figure(&problem, &zero, view);
            assert_eq!((share(images(&drawing)[0], is_red), ovals(&drawing)), (0.0, 0));
        }
    }

    #[test]
    fn the_silhouette_has_the_area_of_the_body() {
        let problem = two_chambers(1.0);
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let drawing = figure(&problem, &zero, View::SIDE);
        let image = images(&drawing)[0];
        let covered = image.rgba.chunks_exact(4).map(|p| f64::from(p[3]) / 255.0).sum::<f64>();
        // Width 300 less margins over 1.08 × 18 mm.
        let scale = (300.0 - 2.0 * MARGIN) / (1.08 * 18.0);
        let area = covered / (scale * scale);
        assert!((area - 216.0).abs() < 0.5, "{area}");
    }

    #[test]
    fn panels_share_scale_and_colours_and_have_insets() {
        let problem = two_chambers(2.0);
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let bent = displacement_of(&problem, |x| [0.0, 0.0, -0.02 * x[0] * x[0]]);
        let (low, high) = (vec![0.0; problem.mesh.num_nodes()], vec![2.0; problem.mesh.num_nodes()]);
        let body = |u, field| Body { field: Some(field), ..Body::plain(&problem, u) };
        let panels = vec![
            Panel::new("rest", body(&zero, &low)).with_contact_inset(None).unwrap(),
            Panel::new("bent", body(&bent, &high)).with_contact_inset(Some(0)).unwrap(),
        ];
        let figure = Figure { width: 600.0, sharpness: 1.0, caption: "caption".into(), ..Figure::new("two", panels) };
        let drawing = figure.draw().unwrap();
        let found = images(&drawing);
        assert_eq!(found.len(), 4);
        assert_eq!((found[0].width, found[0].height), (found[2].width, found[2].height));
        let is_dark = |[r, g, b]: [u8; 3]| r < 80 && g < 20 && b < 90;
        let is_bright = |[r, g, b]: [u8; 3]| r > 150 && g > 130 && b < 60;
        assert!(share(found[0], is_dark) > 0.05 && share(found[0], is_bright) == 0.0);
        assert!(share(found[2], is_bright) > 0.05);
        let clipped = Figure { range: Some([0.0, 1.0]), ..figure }.draw().unwrap().to_svg().unwrap();
        assert!(clipped.contains("max 2.00"));
    }

    #[test]
    fn states_that_do_not_fit_are_refused() {
        let problem = two_chambers(4.5);
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let draw = |body| Figure::new("", vec![Panel::new("", body)]).draw();
        assert!(draw(Body::plain(&problem, &zero[1..])).is_err());
        assert!(draw(Body { field: Some(&[1.0]), ..Body::plain(&problem, &zero) }).is_err());
        assert!(Figure::new("", vec![]).draw().is_err());
        assert!(
            Figure { width: 10.0, ..Figure::new("", vec![Panel::new("", Body::plain(&problem, &zero))]) }
                .draw()
                .is_err()
        );
    }
}
