//! What a picture shows, as data.

use pneuflex_mesh::vector::Vec3;
use pneuflex_model::{Image, LoadParameter, Problem};

use super::marks::nearest;
use super::view::View;
use crate::error::PlotError;

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
    pub(super) fn section(&self) -> Option<f64> {
        let plane = self.problem.symmetry.iter().find(|plane| plane.axis == 1).filter(|_| !self.is_mirrored)?;
        self.problem.mesh.nodes.iter().any(|x| x[1] > plane.at + 1e-6 * plane.at.abs().max(1.0)).then_some(plane.at)
    }

    /// The images of the modelled part that are shown.
    pub(super) fn images(&self) -> Vec<Image> {
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
}
