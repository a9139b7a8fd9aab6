//! Model files to start from, for a mesh, a deck or a part from CAD.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use pneuflex_deck::Extent;
use pneuflex_mesh::vector::{angle_between, bounds};
use pneuflex_mesh::{Facet, Hollow, Mesh};
use pneuflex_model::model_file::Source;

use crate::body_file::{is_deck, read_body};
use crate::error::Error;
use crate::input_error::InputError;
use crate::store::Store;
use crate::words::{measured, place, plain};

/// Bodies of soft robots are as long as this, mm; others may be in another unit.
const USUAL: [f64; 2] = [4.0, 2000.0];

/// A flat face looks along an axis to so many degrees.
const STRAIGHT: f64 = 2.0;

/// What is flat within this share of the body's length from its end is at the end.
const AT_END: f64 = 0.2;

/// A model file with what to know of the body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StartModel {
    /// The text.
    pub text: String,
    /// What to know.
    pub notes: Vec<String>,
}

/// A commented model file that runs around a body: the cavities that were found, the largest flat end as the clamp, a material to replace.
/// `named` is what the model file calls the body's file, `path` where it lies.
///
/// # Errors
/// A body that cannot be read or meshed.
pub fn start_model(path: &Path, named: &str) -> Result<StartModel, Error> {
    let read = read_body(&Store::Disk, path, &Source::of_file(named), None, Extent::Body)?;
    let mesh = &*read.problem.mesh;
    let (hollows, _) = mesh.hollows(&[]).map_err(|_| InputError::about_file(path, "has no surface"))?;
    let [low, high] = bounds(mesh.nodes.iter().copied()).unwrap_or_default();
    let long = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    let mut notes = read.notes.clone();
    let scale = likely_scale(long).filter(|_| !is_deck(path));
    if let Some((factor, unit)) = scale {
        notes.push(format!(
            "{}: the body is {} long, which is little or much for mm: it is taken as {unit} (model.scale = {factor}); change that if it is wrong",
            path.display(),
            measured(long)
        ));
    }
    let factor = scale.map_or(1.0, |(factor, _)| factor);
    let mesh = &mesh.clone().map_nodes(|x| x.map(|t| factor * t));
    let text = Start {
        mesh,
        named,
        factor,
        hollows: &hollows,
        has_deck: is_deck(path),
        has_schedule: read.schedule.is_some(),
    };
    Ok(StartModel { text: text.text(), notes })
}

/// A scale for a body that is too long or too short to be in mm, and its unit.
fn likely_scale(long: f64) -> Option<(f64, &'static str)> {
    if (USUAL[0]..=USUAL[1]).contains(&long) {
        return None;
    }
    let units = [(1000.0, "metres"), (25.4, "inches"), (0.001, "micrometres")];
    units.into_iter().find(|(factor, _)| (10.0..=1000.0).contains(&(factor * long)))
}

struct Start<'a> {
    mesh: &'a Mesh,
    named: &'a str,
    factor: f64,
    /// In the mesh's own unit.
    hollows: &'a [Hollow],
    has_deck: bool,
    has_schedule: bool,
}

impl Start<'_> {
    fn text(&self) -> String {
        let [low, high] = bounds(self.mesh.nodes.iter().copied()).unwrap_or_default();
        let [length, width, height] = [0, 1, 2].map(|d| measured(high[d] - low[d]));
        let mut text = format!(
            "# A model file around {}, for pneuflex: {length} mm x {width} mm x {height} mm.\n#   pneuflex check THIS.toml    what would be \
             solved\n#   pneuflex run THIS.toml      solve it\n# Lengths in mm, moduli in MPa, pressures \
             in kPa.\n\ntitle = {:?}\n\n[model]\nfile = {:?}\n",
            self.named,
            Path::new(self.named).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            self.named
        );
        // Writing to a string cannot fail.
        let _ = match self.factor {
            1.0 if self.has_deck => Ok(()),
            1.0 => writeln!(
                text,
                "# scale = 1               # mm per unit of length of the file: 25.4 for inches, 1000 for metres"
            ),
            factor => {
                writeln!(text, "scale = {factor}                # mm per unit of length of the file: is that right?")
            }
        };
        if crate::cad::is_part(Path::new(self.named)) {
            text +=
                "# size = 3.0              # largest edge of an element; follows the thinnest wall if it is left out\n";
        }
        text += "# inlet = [0, 0, 0]       # a point in the mouth of a chamber that was not found: cavity_1 and so on are behind such points\n";
        text += "\n[material]                # replace it: `pneuflex materials` lists silicones, `pneuflex fit` fits your own tests\n\
                 law = \"neo-hooke\"\nc10 = 0.1                 # half the shear modulus\n# density = 1.1           # g/cm3, for [gravity]\n";
        text += &self.support();
        text += &self.cavities();
        text += "\n# A surface that may touch itself or another one; { near = [x, y, z] } is the smooth part of the surface at a point.\n\
                 # [[contact]]\n# slave = \"outer\"\n# master = \"outer\"\n";
        text += "\n# [gravity]\n# acceleration = [0, 0, -9810]\n";
        if !self.has_schedule {
            text += "\n[load]\ntimes = [0.25, 0.5, 0.75, 1.0]      # when results are written; loads grow evenly up to the last one\n";
        }
        text += &self.probe(low, high);
        text
    }

    /// The largest flat end as the clamp; else a slice at one end.
    fn support(&self) -> String {
        let axis = self.mesh.longest_axis();
        let name = ["x", "y", "z"][axis];
        let head = "\n[[support]]               # the clamp: ";
        match self.flat_end(axis) {
            Some((side, at, area)) => {
                let sign = if side > 0.0 { "" } else { "-" };
                let mut point = [0.0; 3];
                point[axis] = at;
                let [x, y, z] = point.map(plain);
                format!(
                    "{head}the largest flat end, {} mm2\nnodes = {{ plane = {{ point = [{x}, {y}, {z}], normal = \"{sign}{name}\" }}, normal = \
                     \"{sign}{name}\", tolerance = {} }}\naxes = \"xyz\"\n",
                    measured(area),
                    plain(1e-5 * self.mesh.extent())
                )
            }
            None => {
                let [low, mut high] = bounds(self.mesh.nodes.iter().copied()).unwrap_or_default();
                high[axis] = low[axis] + 0.05 * (high[axis] - low[axis]);
                let corner = |x: [f64; 3], by: f64| {
                    let [x, y, z] = x.map(|t| plain((1e6 * (t + by)).round() / 1e6));
                    format!("[{x}, {y}, {z}]")
                };
                let slack = 1e-3 * self.mesh.extent();
                format!(
                    "{head}no end is flat, so all of the body's end; say what is held\nnodes = {{ box = [{}, {}] }}\naxes = \"xyz\"\n",
                    corner(low, -slack),
                    corner(high, slack)
                )
            }
        }
    }

    /// Which way the largest flat end along an axis looks, where it is, its area.
    fn flat_end(&self, axis: usize) -> Option<(f64, f64, f64)> {
        let inner: BTreeSet<Facet> = self.hollows.iter().flat_map(|hollow| hollow.facets.iter().copied()).collect();
        let [low, high] = bounds(self.mesh.nodes.iter().copied())?;
        let length = high[axis] - low[axis];
        let mut found: Vec<(f64, f64, f64)> = Vec::new();
        for side in [-1.0, 1.0] {
            let direction = std::array::from_fn(|d| if d == axis { side } else { 0.0 });
            let end = if side < 0.0 { low[axis] } else { high[axis] };
            let outside = self.mesh.boundary_facets().into_iter().filter(|facet| !inner.contains(facet));
            let places = outside.map(|facet| (facet, self.mesh.face_place(facet)));
            let is_flat = |(facet, place): &(Facet, pneuflex_mesh::FacePlace)| {
                let nodes = self.mesh.facet_nodes(*facet);
                let off = nodes.iter().map(|&n| (self.mesh.nodes[n as usize][axis] - place.centre[axis]).abs());
                angle_between(place.normal, direction) < STRAIGHT
                    && off.fold(0.0, f64::max) < 1e-5 * length
                    && (place.centre[axis] - end).abs() < AT_END * length
            };
            let mut flat: Vec<(f64, f64)> =
                places.filter(is_flat).map(|(_, place)| (place.centre[axis], place.area)).collect();
            flat.sort_by(|a, b| a.0.total_cmp(&b.0));
            for plane in flat.chunk_by(|a, b| (a.0 - b.0).abs() < 1e-5 * length) {
                found.push((side, plane[0].0, plane.iter().map(|(_, area)| area).sum()));
            }
        }
        // The first of equal ones.
        found.into_iter().reduce(|best, next| if next.2 > best.2 * (1.0 + 1e-6) { next } else { best })
    }

    fn cavities(&self) -> String {
        if self.hollows.is_empty() {
            return "\n# No cavity was found: none is closed, and none opens through a narrow inlet alone. Say where one opens with model.inlet, or \
                    its walls:\n# [[cavity]]\n# name = \"air\"\n# faces = \"cavity_1\"\n# pressure_kpa = 4\n"
                .into();
        }
        let mut text = String::new();
        for (number, hollow) in (1..).zip(self.hollows) {
            let cubic = self.factor.powi(3);
            let mouth = hollow.mouth.map_or_else(
                || ", closed".to_owned(),
                |mouth| format!(", which opens near {}", place(mouth.centre.map(|t| self.factor * t))),
            );
            let _ = write!(
                text,
                "\n[[cavity]]                # {} mm3{mouth}\nname = \"chamber {number}\"\nfaces = \"cavity_{number}\"\npressure_kpa = 4          # \
                 reached at the last time\n",
                measured(cubic * hollow.volume)
            );
        }
        text
    }

    /// A point to follow at the end that is not clamped.
    fn probe(&self, low: [f64; 3], high: [f64; 3]) -> String {
        let axis = self.mesh.longest_axis();
        let is_high = self.flat_end(axis).is_none_or(|(side, ..)| side < 0.0);
        let mut at: [f64; 3] = std::array::from_fn(|d| 0.5 * (low[d] + high[d]));
        at[axis] = if is_high { high[axis] } else { low[axis] };
        let [x, y, z] = self
            .mesh
            .nearest_node(at)
            .map_or(at, |(node, _)| self.mesh.nodes[node])
            .map(|t| plain((1e6 * t).round() / 1e6));
        format!("\n[[probe]]                 # a point to follow\nname = \"tip\"\nat = [{x}, {y}, {z}]\n")
    }
}
