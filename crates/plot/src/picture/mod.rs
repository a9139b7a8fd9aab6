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
mod figure;
mod layout;
mod marks;
mod obstacles;
mod raster;
mod skin;
mod view;

pub use colour_map::viridis;
pub use figure::{Body, Figure, Panel};
pub use marks::{Nearest, nearest};
pub use obstacles::{ObstacleSurface, obstacle_surface};
pub use view::View;

use pneuflex_mesh::vector::Vec3;
use pneuflex_post::check;
use pneuflex_post::surface::Bounds;

use crate::drawing::Drawing;
use crate::error::PlotError;
use layout::{Layout, Scene};
use obstacles::Extent;
use skin::Skin;

impl Figure<'_> {
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

#[cfg(test)]
mod tests {
    use super::layout::MARGIN;
    use super::*;
    use pneuflex_model::Problem;

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
