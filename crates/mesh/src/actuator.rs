//! The parametric soft actuator of theory §1: a row of chambers on a continuous base.
//!
//! ```text
//!   z                chamber 1        chamber 2
//!   H ─          ┌──────────────┐  ┌──────────────┐   ── top wall
//!                │ ┌──────────┐ │  │ ┌──────────┐ │
//!                │ │ cavity 1 │ │  │ │ cavity 2 │ │   walls between cavity and gap:
//!                │ │          │ │  │ │          │ │   (chamber_length − cavity_length)/2
//!   base ─ ┌─────┘ └──┐    ┌──┘ └──┘ └──┐    ┌──┘ └─────┐
//!          │ flange   └────┘  channel   └────┘   flange │
//!   0 ──── └────────────────────────────────────────────┘ ── x
//! ```
//!
//! Sets of the generated mesh: node sets `clamp` (x = 0), `symmetry` (y = 0, half models only), `bottom_centreline`
//! (y = z = 0), `end_face` (x = L, z ≤ base); facet sets `cavity` (all faces that feel the air), `cavity_i` (those of
//! chamber i, from 1, where no channel joins the cavities), `gap_i_left` and `gap_i_right` (the wall of chamber i and of
//! chamber i + 1 that face each other, i from 1, unless the gap is 0), `bottom` (z = 0), `end_face` and `clamp`, and `outer`: all faces that look out of the body, those of the gaps included, but not the clamped one.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::element::ElementKind;
use crate::grading::{Interval, MeshSize};
use crate::lattice::{BoundaryFacet, Lattice, Neighbour};
use crate::mesh::{Facet, Mesh};

/// Lengths of the actuator, mm; symbols of the paper in brackets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Actuator {
    /// Number of chambers \[N\].
    pub chambers: usize,
    /// Outer length of one chamber \[t2\].
    pub chamber_length: f64,
    /// Length of one cavity \[t3\].
    pub cavity_length: f64,
    /// Gap between neighbouring chambers \[t1\]; 0 for a solid block with cavities, whose neighbours share a wall.
    pub gap: f64,
    /// Length of the flange at either end; 0 for none.
    pub flange: f64,
    /// Whole width \[W\].
    pub width: f64,
    /// Whole height \[H\].
    pub height: f64,
    /// Thickness of the continuous base \[t\].
    pub base: f64,
    /// Height of the cavities' floor; `None` for the top of the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cavity_floor: Option<f64>,
    /// Thickness of the side walls.
    pub side_wall: f64,
    /// Thickness of the walls above the cavities.
    pub top_wall: f64,
    /// The air channel that connects the cavities.
    pub channel: Channel,
    /// Which part of the body is modelled.
    #[serde(default)]
    pub part: Part,
}

/// Cross-section of the air channel in the base, mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Half of its width; 0 for no channel.
    pub half_width: f64,
    /// Height of its floor.
    pub bottom: f64,
    /// Height of its roof under the gaps and the end walls.
    pub top: f64,
}

/// Which part of the symmetric body is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// y ≥ 0, with `u_y = 0` on the plane y = 0.
    #[default]
    Half,
    /// Both sides of the symmetry plane.
    Whole,
}

/// Coordinates along x, y and z of planes in which faces of elements shall lie beside those that the actuator's shape asks for, mm: where
/// another material begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cuts(pub [Vec<f64>; 3]);

impl Cuts {
    /// Faces of a box along the axes, given by two of its corners.
    pub fn add_box(&mut self, corners: [[f64; 3]; 2]) {
        for corner in corners {
            self.0.iter_mut().zip(corner).for_each(|(along, at)| along.push(at));
        }
    }
}

/// A cut this close to another plane, relative to the thinnest wall, is that plane: elements between them would be slivers.
const SAME_PLANE: f64 = 0.01;

/// A length that makes no body, or none that can be meshed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value} is out of range: {allowed}")]
pub struct GeometryError {
    /// The key, as written in the case file's `[actuator]` table.
    pub key: &'static str,
    /// The offending value.
    pub value: f64,
    /// What would be allowed.
    pub allowed: String,
}

/// The shortest and the longest length of a body and of what is around it, mm: no actuator is smaller or larger.
pub const LENGTHS: [f64; 2] = [1e-6, 1e6];

/// What is wrong with a length that must lie between two others.
fn out_of_range(key: &'static str, value: f64, low: f64, high: f64, strict_low: bool) -> Option<GeometryError> {
    let is_above = if strict_low { value > low } else { value >= low };
    if value.is_finite() && is_above && value < high {
        let [shortest, longest] = LENGTHS;
        if value == 0.0 || (shortest..=longest).contains(&value) {
            return None;
        }
        return Some(GeometryError { key, value, allowed: format!("must be from {shortest:e} to {longest:e} mm") });
    }
    let relation = if strict_low { "greater than" } else { "at least" };
    let mut allowed = format!("must be {relation} {low}");
    if high.is_finite() {
        allowed += &format!(" and less than {high}");
    }
    Some(GeometryError { key, value, allowed: allowed + " mm" })
}

/// A plane in which the shape of the body changes.
#[derive(Clone, Copy, Debug)]
struct Plane {
    at: f64,
    /// Whether the interval that ends here is the thickness of a wall.
    closes_wall: bool,
    /// Whether re-entrant edges lie in it.
    has_edge: bool,
}

impl Plane {
    /// An outer face of the body.
    const fn outside(at: f64) -> Self {
        Self { at, closes_wall: false, has_edge: false }
    }

    /// A plane with re-entrant edges.
    const fn edge(at: f64) -> Self {
        Self { at, closes_wall: false, has_edge: true }
    }

    const fn closing_wall(self) -> Self {
        Self { closes_wall: true, ..self }
    }
}

/// What fills a point of the actuator's bounding box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Region {
    Solid,
    /// Inside of a chamber, or of the channel below it.
    Air(usize),
    Gap(usize),
    Outside,
}

impl Actuator {
    /// The paper's two-chamber piece (theory §1): half model, 1268 mm³.
    pub fn two_chambers() -> Self {
        Self {
            chambers: 2,
            chamber_length: 8.0,
            cavity_length: 6.0,
            gap: 2.0,
            flange: 0.0,
            width: 20.0,
            height: 13.0,
            base: 4.0,
            cavity_floor: None,
            side_wall: 1.0,
            top_wall: 1.0,
            channel: Channel { half_width: 1.0, bottom: 2.0, top: 3.0 },
            part: Part::Half,
        }
    }

    /// The paper's full actuator (theory §1): eight chambers and two flanges, half model, 5460 mm³.
    pub fn full() -> Self {
        Self { chambers: 8, flange: 2.0, ..Self::two_chambers() }
    }

    /// Whole length L, mm.
    pub fn length(&self) -> f64 {
        let n = self.chambers as f64;
        2.0 * self.flange + n * self.chamber_length + (n - 1.0) * self.gap
    }

    /// Planes no further apart are one, mm.
    fn rounding(&self) -> f64 {
        1e-9 * self.length().max(self.width).max(self.height)
    }

    /// Height of the cavities' floor, mm.
    pub fn floor(&self) -> f64 {
        self.cavity_floor.unwrap_or(self.base)
    }

    /// Thickness of the walls that close a cavity along x, mm.
    pub fn end_wall(&self) -> f64 {
        0.5 * (self.chamber_length - self.cavity_length)
    }

    /// Thickness of the thinnest wall around a cavity, mm.
    pub fn thinnest_wall(&self) -> f64 {
        self.end_wall().min(self.side_wall).min(self.top_wall)
    }

    /// Checks that the lengths make a body.
    ///
    /// # Errors
    /// The first key whose value is not finite or lies outside what the other lengths allow; [`Self::problems`] has all.
    pub fn validate(&self) -> Result<(), GeometryError> {
        self.problems().into_iter().next().map_or(Ok(()), Err)
    }

    /// Every key whose value is not finite or lies outside what the other lengths allow. A length that is wrong itself allows
    /// the others anything.
    pub fn problems(&self) -> Vec<GeometryError> {
        const NO_LIMIT: f64 = f64::INFINITY;
        let mut found = Vec::new();
        if !(1..=10_000).contains(&self.chambers) {
            let allowed = "must be from 1 to 10000".into();
            found.push(GeometryError { key: "chambers", value: self.chambers as f64, allowed });
        }
        // The value, if it is positive and below a limit.
        let mut length = |key, value, limit| {
            let error = out_of_range(key, value, 0.0, limit, true);
            let is_right = error.is_none();
            found.extend(error);
            if is_right { value } else { f64::NAN }
        };
        // What is unknown limits nothing.
        let limit = |value: f64| if value.is_nan() { NO_LIMIT } else { value };
        let chamber_length = length("chamber_length", self.chamber_length, NO_LIMIT);
        length("cavity_length", self.cavity_length, limit(chamber_length));
        let width = length("width", self.width, NO_LIMIT);
        let height = length("height", self.height, NO_LIMIT);
        let base = length("base", self.base, limit(height));
        let side_wall = length("side_wall", self.side_wall, limit(0.5 * width));
        let top_wall = length("top_wall", self.top_wall, limit(height - base));
        if let Some(floor) = self.cavity_floor {
            length("cavity_floor", floor, limit(height - top_wall));
        }
        if self.has_channel() {
            let bottom = length("channel.bottom", self.channel.bottom, limit(base));
            let lowest = if bottom.is_nan() { 0.0 } else { bottom };
            found.extend(out_of_range("channel.top", self.channel.top, lowest, limit(base), true));
        }
        found.extend(out_of_range("gap", self.gap, 0.0, NO_LIMIT, false));
        found.extend(out_of_range("flange", self.flange, 0.0, NO_LIMIT, false));
        let half_inside = limit(0.5 * width - side_wall);
        found.extend(out_of_range("channel.half_width", self.channel.half_width, 0.0, half_inside, false));
        // Planes that are nearer to each other are one, and so would be the chambers.
        if found.is_empty() && self.gap > 0.0 && self.gap <= self.rounding() {
            let allowed = format!("must be 0 or greater than {:.1e} mm, a billionth of the body", self.rounding());
            found.push(GeometryError { key: "gap", value: self.gap, allowed });
        }
        found
    }

    /// Whether the cavities are one, joined by the channel.
    pub fn has_channel(&self) -> bool {
        self.channel.half_width > 0.0
    }

    /// Number of gaps, whose walls may touch.
    pub fn gaps(&self) -> usize {
        if self.gap > 0.0 { self.chambers.saturating_sub(1) } else { 0 }
    }

    /// Start of chamber `i` (from 0) along x.
    fn chamber_start(&self, i: usize) -> f64 {
        self.flange + i as f64 * (self.chamber_length + self.gap)
    }

    /// Intervals between the break planes along x, y, z.
    fn intervals(&self, cuts: &Cuts) -> [Vec<Interval>; 3] {
        let wall = self.end_wall();
        let mut x = vec![Plane::outside(0.0)];
        for i in 0..self.chambers {
            let (start, end) = (self.chamber_start(i), self.chamber_start(i) + self.chamber_length);
            // A chamber's outer faces meet the base in an edge, but not where the body itself ends.
            let outer = |at: f64| if at > 0.0 && at < self.length() { Plane::edge(at) } else { Plane::outside(at) };
            // Chambers without a gap share one wall, in the middle of which nothing ends.
            let shares_wall = |neighbour: bool| neighbour && self.gap == 0.0;
            if !shares_wall(i > 0) {
                x.push(outer(start));
            }
            x.push(Plane::edge(start + wall).closing_wall());
            x.push(Plane::edge(start + wall + self.cavity_length));
            if !shares_wall(i + 1 < self.chambers) {
                x.push(outer(end).closing_wall());
            }
        }
        x.push(Plane::outside(self.length()));

        let half = 0.5 * self.width;
        let mut y = vec![Plane::edge(half - self.side_wall), Plane::outside(half).closing_wall()];
        if self.has_channel() {
            y.insert(0, Plane::edge(self.channel.half_width));
        }
        if self.part == Part::Whole {
            // The plane that closes a wall is the outer one on this side, the inner one on the other.
            let mirrored = [Plane::outside(-half), Plane::edge(self.side_wall - half).closing_wall()];
            let channel = self.has_channel().then_some(Plane::edge(-self.channel.half_width));
            y.splice(0..0, mirrored.into_iter().chain(channel).chain([Plane::outside(0.0)]));
        } else {
            y.insert(0, Plane::outside(0.0));
        }

        let mut z = vec![Plane::outside(0.0), Plane::edge(self.base), Plane::edge(self.floor())];
        if self.has_channel() {
            z.extend([Plane::edge(self.channel.bottom), Plane::edge(self.channel.top)]);
        }
        z.extend([Plane::edge(self.height - self.top_wall), Plane::outside(self.height).closing_wall()]);
        z.sort_by(|a, b| a.at.total_cmp(&b.at));
        let mut axes = [x, y, z];
        for (planes, cuts) in axes.iter_mut().zip(&cuts.0) {
            for &at in cuts {
                add_cut(planes, at, SAME_PLANE * self.thinnest_wall());
            }
        }
        axes.map(|planes| to_intervals(&planes, self.rounding()))
    }

    fn region(&self, [x, y, z]: [f64; 3]) -> Region {
        let pitch = self.chamber_length + self.gap;
        let index = ((x - self.flange) / pitch).floor();
        let in_row = index >= 0.0 && index < self.chambers as f64;
        let offset = x - self.flange - index * pitch;
        // Without gaps rounding must not leave anything between the chambers.
        let in_chamber = in_row && (self.gap == 0.0 || offset < self.chamber_length);
        let wall = self.end_wall();
        let along_cavity = in_chamber && offset > wall && offset < wall + self.cavity_length;
        let inner_width = y.abs() < 0.5 * self.width - self.side_wall;
        let channel_width = y.abs() < self.channel.half_width;
        let first = self.flange + wall;
        let last = self.length() - first;

        if along_cavity && inner_width && z > self.floor() && z < self.height - self.top_wall {
            return Region::Air(index as usize);
        }
        if channel_width && x > first && x < last && z > self.channel.bottom {
            let roof = if along_cavity { self.floor().max(self.channel.top) } else { self.channel.top };
            if z < roof {
                return Region::Air(index as usize);
            }
        }
        if z < self.base || in_chamber {
            Region::Solid
        } else if in_row && index + 1.0 < self.chambers as f64 {
            Region::Gap(index as usize)
        } else {
            Region::Outside
        }
    }

    /// Estimated number of solid lattice cells for a given size, without building anything; exact up to rounding of the
    /// solid share.
    pub fn estimate_cells(&self, size: &MeshSize, cuts: &Cuts) -> f64 {
        let intervals = self.intervals(cuts);
        let mut solid = 0.0;
        let counts: [Vec<f64>; 3] = std::array::from_fn(|d| intervals[d].iter().map(|i| size.cells(i, d)).collect());
        // Summing over blocks of the geometry is cheap: their number does not depend on the element size.
        for (a, ix) in intervals[0].iter().enumerate() {
            for (b, iy) in intervals[1].iter().enumerate() {
                for (c, iz) in intervals[2].iter().enumerate() {
                    let centre = [ix, iy, iz].map(|i| 0.5 * (i.start + i.end));
                    if self.region(centre) == Region::Solid {
                        solid += counts[0][a] * counts[1][b] * counts[2][c];
                    }
                }
            }
        }
        solid
    }

    /// Number of lattice cells of the body's bounding box, of which meshing keeps account.
    pub fn estimate_grid(&self, size: &MeshSize, cuts: &Cuts) -> f64 {
        let along = |(d, intervals): (usize, &Vec<Interval>)| intervals.iter().map(|i| size.cells(i, d)).sum::<f64>();
        self.intervals(cuts).iter().enumerate().map(along).product()
    }
}

/// Adds a plane without edges between others, which are in ascending order, unless it lies beyond them or close to one.
fn add_cut(planes: &mut Vec<Plane>, at: f64, close: f64) {
    let after = planes.partition_point(|plane| plane.at < at);
    let (below, above) = planes.split_at(after);
    if let (Some(below), Some(above)) = (below.last(), above.first())
        && at - below.at > close
        && above.at - at > close
    {
        planes.insert(after, Plane::outside(at));
    }
}

/// Turns break planes into non-empty intervals.
fn to_intervals(planes: &[Plane], tolerance: f64) -> Vec<Interval> {
    let mut intervals: Vec<Interval> = Vec::new();
    let mut start = planes[0];
    for &plane in &planes[1..] {
        if plane.at - start.at > tolerance {
            let edges = [start.has_edge, plane.has_edge];
            intervals.push(Interval { start: start.at, end: plane.at, is_wall: plane.closes_wall, edges });
            start = plane;
        } else {
            start.has_edge |= plane.has_edge;
        }
    }
    intervals
}

/// Builds the mesh of the actuator with all its named sets (see the module's text).
///
/// # Errors
/// A length out of range, see [`Actuator::validate`].
///
/// # Panics
/// If a size is not positive: callers check their options first.
pub fn build_actuator(actuator: &Actuator, size: &MeshSize, kind: ElementKind) -> Result<Mesh, GeometryError> {
    build_actuator_with(actuator, size, kind, &Cuts::default())
}

/// The same with faces of elements in further planes.
///
/// # Errors
/// As there.
///
/// # Panics
/// As there.
pub fn build_actuator_with(
    actuator: &Actuator,
    size: &MeshSize,
    kind: ElementKind,
    cuts: &Cuts,
) -> Result<Mesh, GeometryError> {
    actuator.validate()?;
    let intervals = actuator.intervals(cuts);
    let lines: [Vec<f64>; 3] = std::array::from_fn(|d| {
        let mut line = vec![intervals[d][0].start];
        for interval in &intervals[d] {
            line.extend(size.divide(interval, d));
        }
        line
    });
    let lattice = Lattice { lines };
    let mut built = lattice.mesh(kind, |cell| actuator.region(lattice.centre(cell)) == Region::Solid);

    let mut facet_sets: BTreeMap<String, Vec<Facet>> = BTreeMap::new();
    let last = lattice.num_cells()[0] - 1;
    for BoundaryFacet { facet, cell, side, neighbour } in built.boundary() {
        let is_outer = match (neighbour, side) {
            (Neighbour::Void(void), _) => !matches!(actuator.region(lattice.centre(void)), Region::Air(_)),
            (Neighbour::Outside, 0) => false,
            // The plane of symmetry.
            (Neighbour::Outside, 2) => actuator.part == Part::Whole,
            (Neighbour::Outside, _) => true,
        };
        if is_outer {
            facet_sets.entry("outer".into()).or_default().push(facet);
        }
        let name = match (neighbour, side) {
            (Neighbour::Void(void), side) => match actuator.region(lattice.centre(void)) {
                Region::Air(chamber) => {
                    if !actuator.has_channel() {
                        facet_sets.entry(format!("cavity_{}", chamber + 1)).or_default().push(facet);
                    }
                    "cavity".into()
                }
                // The wall at the gap's low end looks along +x and belongs to the left chamber.
                Region::Gap(i) if side == 1 => format!("gap_{}_left", i + 1),
                Region::Gap(i) if side == 0 => format!("gap_{}_right", i + 1),
                _ => continue,
            },
            (Neighbour::Outside, 0) => "clamp".into(),
            (Neighbour::Outside, 1) if cell[0] == last && lattice.centre(cell)[2] < actuator.base => "end_face".into(),
            (Neighbour::Outside, 4) => "bottom".into(),
            _ => continue,
        };
        facet_sets.entry(name).or_default().push(facet);
    }
    facet_sets.values_mut().for_each(|facets| facets.sort_unstable());

    let mesh = &mut built.mesh;
    let length = actuator.length();
    let tolerance = 1e-9 * length;
    let near = |a: f64, b: f64| (a - b).abs() <= tolerance;
    let mut node_sets = BTreeMap::from([
        ("clamp".to_owned(), mesh.select_nodes(|x| near(x[0], 0.0))),
        ("bottom_centreline".to_owned(), mesh.select_nodes(|x| near(x[1], 0.0) && near(x[2], 0.0))),
        ("end_face".to_owned(), mesh.select_nodes(|x| near(x[0], length) && x[2] <= actuator.base + tolerance)),
    ]);
    if actuator.part == Part::Half {
        node_sets.insert("symmetry".to_owned(), mesh.select_nodes(|x| near(x[1], 0.0)));
    }
    mesh.node_sets = node_sets;
    mesh.facet_sets = facet_sets;
    Ok(built.mesh)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape;

    fn size(h: f64) -> MeshSize {
        MeshSize::uniform(h)
    }

    #[test]
    fn the_grid_is_the_whole_box() {
        let half = Actuator::two_chambers();
        assert_eq!(half.estimate_grid(&size(1.0), &Cuts::default()), 18.0 * 10.0 * 13.0);
        let whole = Actuator { part: Part::Whole, ..half };
        assert_eq!(whole.estimate_grid(&size(0.5), &Cuts::default()), 36.0 * 40.0 * 26.0);
    }

    /// Volume enclosed by a facet set and the planes that cut it: ∮ x n_x dS over the facets.
    fn signed_volume(mesh: &Mesh, set: &str) -> f64 {
        let mut volume = 0.0;
        for &facet in mesh.facet_set(set) {
            let nodes = mesh.facet_nodes(facet);
            for (xi, w) in (mesh.face_kind(facet).rule)() {
                let shape = shape::evaluate_face(mesh.face_kind(facet), xi);
                let mut point = [0.0; 3];
                let mut tangent = [[0.0; 3]; 2];
                for (i, &n) in nodes.iter().enumerate() {
                    for d in 0..3 {
                        point[d] += shape.values[i] * mesh.nodes[n as usize][d];
                        for a in 0..2 {
                            tangent[a][d] += shape.gradients[i][a] * mesh.nodes[n as usize][d];
                        }
                    }
                }
                volume += w * point[0] * (tangent[0][1] * tangent[1][2] - tangent[0][2] * tangent[1][1]);
            }
        }
        volume
    }

    #[test]
    fn default_half_models_have_the_volumes_of_the_theory() {
        for kind in ElementKind::ALL {
            for h in [1.0, 2.0, 4.5] {
                let two = build_actuator(&Actuator::two_chambers(), &size(h), kind).unwrap();
                assert!((two.volume() - 1268.0).abs() < 1e-8, "{kind:?} at {h}: {}", two.volume());
                let full = build_actuator(&Actuator::full(), &size(h), kind).unwrap();
                assert!((full.volume() - 5460.0).abs() < 1e-8, "{kind:?} at {h}: {}", full.volume());
            }
        }
    }

    #[test]
    fn whole_model_is_twice_the_half() {
        let whole = Actuator { part: Part::Whole, ..Actuator::two_chambers() };
        let mesh = build_actuator(&whole, &size(1.0), ElementKind::Hex8).unwrap();
        assert!((mesh.volume() - 2536.0).abs() < 1e-9);
        assert!(mesh.node_set("symmetry").is_empty());
        let half = build_actuator(&Actuator::two_chambers(), &size(1.0), ElementKind::Hex8).unwrap();
        assert_eq!(mesh.num_elements(), 2 * half.num_elements());
    }

    #[test]
    fn cavity_facets_enclose_the_air() {
        // Facet normals point out of the solid, into the air: the sum has the opposite sign of the air volume.
        let mesh = build_actuator(&Actuator::two_chambers(), &size(1.0), ElementKind::Hex20).unwrap();
        let air = 2.0 * 6.0 * 9.0 * 8.0 + 16.0 + 12.0;
        assert!((signed_volume(&mesh, "cavity") + air).abs() < 1e-9);
    }

    /// Single-point contact pairs the facets in the order of the sets: through the gap, they must coincide.
    #[test]
    fn walls_of_a_gap_correspond_facet_by_facet() {
        for kind in ElementKind::ALL {
            let mesh = build_actuator(&Actuator::two_chambers(), &size(3.0), kind).unwrap();
            let [left, right] = ["gap_1_left", "gap_1_right"].map(|set| mesh.facet_set(set));
            assert_eq!(left.len(), right.len());
            for (&a, &b) in left.iter().zip(right) {
                let across = |facet: Facet| -> Vec<[u64; 2]> {
                    let nodes = mesh.facet_nodes(facet);
                    let mut seen: Vec<_> =
                        nodes.iter().map(|&n| mesh.nodes[n as usize]).map(|x| [x[1], x[2]].map(f64::to_bits)).collect();
                    seen.sort_unstable();
                    seen
                };
                assert_eq!(across(a), across(b), "{kind:?}");
            }
        }
    }

    #[test]
    fn walls_of_every_gap_face_each_other() {
        let mesh = build_actuator(&Actuator::full(), &size(1.0), ElementKind::Hex8).unwrap();
        let actuator = Actuator::full();
        for i in 1..actuator.chambers {
            for (side, x) in [("left", 0.0), ("right", actuator.gap)] {
                let facets = mesh.facet_set(&format!("gap_{i}_{side}"));
                assert_eq!(facets.len(), 10 * 9);
                let plane = actuator.chamber_start(i - 1) + actuator.chamber_length + x;
                for &facet in facets {
                    for n in mesh.facet_nodes(facet) {
                        assert!((mesh.nodes[n as usize][0] - plane).abs() < 1e-12);
                    }
                }
            }
        }
        assert!(mesh.facet_set("gap_8_left").is_empty());
    }

    /// Together with the clamp and the plane of symmetry the outer faces enclose the body with its air.
    #[test]
    fn outer_facets_enclose_body_and_air() {
        for kind in ElementKind::ALL {
            for actuator in [Actuator::two_chambers(), Actuator { part: Part::Whole, ..Actuator::full() }] {
                let mesh = build_actuator(&actuator, &size(4.5), kind).unwrap();
                // On the clamp x is 0, and the normal of the plane of symmetry has no x: neither adds to the volume.
                let enclosed = signed_volume(&mesh, "outer");
                let air = -signed_volume(&mesh, "cavity");
                assert!((enclosed - air - mesh.volume()).abs() < 1e-8, "{kind:?}: {enclosed} {air}");
            }
        }
    }

    /// Without a channel every chamber has air of its own.
    #[test]
    fn cavities_that_nothing_joins_are_surfaces_of_their_own() {
        let joined = build_actuator(&Actuator::full(), &size(2.0), ElementKind::Hex8).unwrap();
        assert!(joined.facet_sets.keys().all(|name| !name.starts_with("cavity_")));
        for part in [Part::Half, Part::Whole] {
            let mut actuator = Actuator { chambers: 3, part, ..Actuator::full() };
            actuator.channel.half_width = 0.0;
            let sides = if part == Part::Half { 1.0 } else { 2.0 };
            for kind in ElementKind::ALL {
                let mesh = build_actuator(&actuator, &size(2.0), kind).unwrap();
                let mut all: Vec<Facet> = Vec::new();
                for i in 1..=3 {
                    let name = format!("cavity_{i}");
                    assert!((signed_volume(&mesh, &name) + sides * 6.0 * 9.0 * 8.0).abs() < 1e-9, "{kind:?} {name}");
                    all.extend(mesh.facet_set(&name));
                }
                all.sort_unstable();
                assert_eq!(all, mesh.facet_set("cavity"), "{kind:?}");
                assert!(mesh.facet_set("cavity_4").is_empty());
            }
        }
    }

    /// A solid block with cavities: its volume in closed form, and no walls that could touch.
    #[test]
    fn chambers_without_gaps_are_a_block_with_cavities() {
        for kind in ElementKind::ALL {
            for half_width in [0.0, 1.0] {
                for h in [0.7, 2.0, 4.5] {
                    for edge in [0.9, f64::INFINITY] {
                        let mut block = Actuator { chambers: 3, gap: 0.0, flange: 0.3, ..Actuator::two_chambers() };
                        block.channel.half_width = half_width;
                        let size = MeshSize { edge, ..MeshSize::uniform(h) };
                        // Coarse meshes only of what has many nodes.
                        if h < 1.0 && kind != ElementKind::Hex8 {
                            continue;
                        }
                        let mesh = build_actuator(&block, &size, kind).unwrap();
                        // A block of 24 mm and flanges in the base, less three cavities and the channel between the outer end walls: 22 mm of
                        // 1 mm², and 1 mm² more below each cavity's floor.
                        let air = 3.0 * 6.0 * 9.0 * 8.0 + if half_width > 0.0 { 22.0 + 3.0 * 6.0 } else { 0.0 };
                        let solid = 24.0 * 10.0 * 13.0 + 2.0 * 0.3 * 10.0 * 4.0 - air;
                        assert!((mesh.volume() - solid).abs() < 1e-8, "{kind:?} {h} {edge}: {} {solid}", mesh.volume());
                        assert!((signed_volume(&mesh, "cavity") + air).abs() < 1e-8, "{kind:?} {h}");
                        assert!(mesh.facet_sets.keys().all(|name| !name.starts_with("gap_")));
                        let enclosed = signed_volume(&mesh, "outer");
                        assert!((enclosed - air - solid).abs() < 1e-8, "{kind:?}: {enclosed}");
                        if kind == ElementKind::Hex8 {
                            assert_eq!(mesh.num_elements() as f64, block.estimate_cells(&size, &Cuts::default()));
                        }
                    }
                }
            }
        }
        assert_eq!((Actuator { gap: 0.0, ..Actuator::full() }.gaps(), Actuator::full().gaps()), (0, 7));
        // A gap that no mesh has is refused, not closed without a word.
        let gap_of = |chamber_length, gap| Actuator { chamber_length, gap, ..Actuator::two_chambers() }.validate();
        assert!(gap_of(8.0, 1e-6).is_ok() && gap_of(800.0, 0.0).is_ok());
        assert_eq!(gap_of(800.0, 1e-6).unwrap_err().key, "gap");
    }

    /// The wall that two chambers share is one wall: as many elements as were asked for, and none that only half of it gets.
    #[test]
    fn a_shared_wall_is_one_wall() {
        let block = Actuator { gap: 0.0, ..Actuator::two_chambers() };
        let mesh = build_actuator(&block, &MeshSize { wall_elements: 3, ..size(6.0) }, ElementKind::Hex8).unwrap();
        let mut lines: Vec<f64> = mesh.nodes.iter().map(|x| x[0]).filter(|x| (6.9..9.1).contains(x)).collect();
        lines.sort_by(f64::total_cmp);
        lines.dedup();
        assert_eq!(lines.len(), 4, "{lines:?}");
    }

    #[test]
    fn deeper_cavity_floor_takes_its_volume_from_the_base() {
        let deep = Actuator { cavity_floor: Some(2.0), ..Actuator::two_chambers() };
        let mesh = build_actuator(&deep, &size(1.0), ElementKind::Hex8).unwrap();
        // 2 mm × 6 mm × 9 mm more air per chamber, less the part of the channel that was already there.
        assert!((mesh.volume() - (1268.0 - 2.0 * (6.0 * 9.0 * 2.0 - 12.0))).abs() < 1e-9);
    }

    #[test]
    fn named_node_sets_lie_where_they_should() {
        let mesh = build_actuator(&Actuator::full(), &size(1.0), ElementKind::Hex8).unwrap();
        assert_eq!(mesh.node_set("clamp").len(), 11 * 5);
        assert_eq!(mesh.node_set("bottom_centreline").len(), 83);
        assert_eq!(mesh.node_set("end_face").len(), 11 * 5);
        assert_eq!(mesh.facet_set("bottom").len(), 82 * 10);
        assert!(mesh.node_set("symmetry").iter().all(|&n| mesh.nodes[n as usize][1] == 0.0));
        let estimate = Actuator::full().estimate_cells(&size(1.0), &Cuts::default());
        assert_eq!(estimate as usize, mesh.num_elements());
    }

    #[test]
    fn wall_elements_refine_walls_only() {
        let fine = MeshSize { wall_elements: 2, ..MeshSize::uniform(2.0) };
        let mesh = build_actuator(&Actuator::two_chambers(), &fine, ElementKind::Hex8).unwrap();
        assert!((mesh.volume() - 1268.0).abs() < 1e-9);
        assert!(mesh.select_nodes(|x| (x[0] - 0.5).abs() < 1e-12).len() > 10);
        assert!(mesh.select_nodes(|x| (x[0] - 1.5).abs() < 1e-12).is_empty());
    }

    #[test]
    fn faces_of_elements_lie_in_cuts_and_nothing_else_changes() {
        let actuator = Actuator::two_chambers();
        let graded = MeshSize { edge: 2.8, ..MeshSize::uniform(6.0) };
        let plain = build_actuator(&actuator, &graded, ElementKind::Hex8).unwrap();
        let cut = |corners| {
            let mut cuts = Cuts::default();
            cuts.add_box(corners);
            let estimate = actuator.estimate_cells(&graded, &cuts);
            let mesh = build_actuator_with(&actuator, &graded, ElementKind::Hex8, &cuts).unwrap();
            assert!((mesh.volume() - plain.volume()).abs() < 1e-9);
            assert_eq!(mesh.num_elements() as f64, estimate);
            mesh
        };
        let layer = cut([[-1.0, -10.0, 0.0], [18.0, 10.0, 0.7]]);
        let at = |mesh: &Mesh, z: f64| mesh.select_nodes(|x| (x[2] - z).abs() < 1e-12).len();
        assert!(at(&plain, 0.7) == 0 && at(&layer, 0.7) == at(&layer, 0.0));
        assert_eq!(layer.facet_set("gap_1_left").len(), layer.facet_set("gap_1_right").len());
        // Planes of the body itself, and what is as good as one.
        assert_eq!(cut([[0.0, 0.0, 0.0], [8.0, 9.0, 4.0]]), plain);
        assert_eq!(cut([[0.0, 0.0, 2.005], [8.0, 9.0, 3.995]]), plain);
    }

    #[test]
    fn impossible_lengths_are_named() {
        type Change = fn(&mut Actuator);
        let cases: [(&str, Change); 9] = [
            ("chambers", |a| a.chambers = 0),
            ("cavity_length", |a| a.cavity_length = 8.0),
            ("gap", |a| a.gap = -1.0),
            ("base", |a| a.base = f64::NAN),
            ("side_wall", |a| a.side_wall = 10.0),
            ("top_wall", |a| a.top_wall = 9.5),
            ("cavity_floor", |a| a.cavity_floor = Some(12.5)),
            ("channel.half_width", |a| a.channel.half_width = 9.5),
            ("channel.top", |a| a.channel.top = 1.0),
        ];
        for (key, change) in cases {
            let mut actuator = Actuator::two_chambers();
            change(&mut actuator);
            assert_eq!(actuator.validate().unwrap_err().key, key);
        }
    }
}
