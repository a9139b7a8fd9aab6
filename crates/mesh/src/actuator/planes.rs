//! Planes in which the shape of the body changes, and the intervals between them: what lies in them is meshed line by line.

use super::lengths::{Actuator, Part};
use super::row::{Region, Row};
use crate::grading::{Interval, MeshSize};

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

/// A cut this close to another plane, relative to the thinnest wall, is that plane: elements between them would be slivers. Walls of chambers that
/// differ by so little are refused.
pub(super) const SAME_PLANE: f64 = 0.01;

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

/// Thicknesses that differ, in ascending order.
fn distinct(of_chambers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut found: Vec<f64> = of_chambers.collect();
    found.sort_by(f64::total_cmp);
    found.dedup();
    found
}

impl Row<'_> {
    /// Intervals between the break planes along x, y, z. Walls that are not alike put lines into the mesh of all chambers.
    pub(super) fn intervals(&self, cuts: &Cuts) -> [Vec<Interval>; 3] {
        let mut axes = [self.planes_along(), self.planes_across(), self.planes_up()];
        for (planes, cuts) in axes.iter_mut().zip(&cuts.0) {
            for &at in cuts {
                add_cut(planes, at, SAME_PLANE * self.actuator.thinnest_wall());
            }
        }
        axes.map(|planes| to_intervals(&planes, self.actuator.rounding()))
    }

    fn planes_along(&self) -> Vec<Plane> {
        let (length, rounding) = (self.actuator.length(), self.actuator.rounding());
        // A chamber's outer faces meet the base in an edge, but not where the body itself ends.
        let is_inside = |at: f64| at > rounding && at < length - rounding;
        let outer = |at: f64| if is_inside(at) { Plane::edge(at) } else { Plane::outside(at) };
        let mut planes = vec![Plane::outside(0.0)];
        let mut shares_last = false;
        for chamber in &self.chambers {
            // Chambers without a gap share one wall, in the middle of which nothing ends.
            if !shares_last {
                planes.push(outer(chamber.start));
            }
            planes.push(Plane::edge(chamber.cavity[0]).closing_wall());
            planes.push(Plane::edge(chamber.cavity[1]));
            shares_last = chamber.is_joined_to_next();
            if !shares_last {
                planes.push(outer(chamber.end).closing_wall());
            }
        }
        planes.push(Plane::outside(length));
        planes
    }

    fn planes_across(&self) -> Vec<Plane> {
        let half = 0.5 * self.actuator.width;
        // From the outer face inwards: what of the thinnest wall has its elements, all others have at least.
        let walls = distinct(self.chambers.iter().map(|chamber| chamber.side_wall));
        let channel = self.actuator.has_channel().then_some(self.actuator.channel.half_width);
        let mut planes = Vec::new();
        if self.actuator.part == Part::Whole {
            // The plane that closes a wall is the outer one on this side, the inner one on the other.
            planes.push(Plane::outside(-half));
            for (i, wall) in walls.iter().enumerate() {
                let inner = Plane::edge(wall - half);
                planes.push(if i == 0 { inner.closing_wall() } else { inner });
            }
            planes.extend(channel.map(|half_width| Plane::edge(-half_width)));
        }
        planes.push(Plane::outside(0.0));
        planes.extend(channel.map(Plane::edge));
        planes.extend(walls.iter().rev().map(|wall| Plane::edge(half - wall)));
        planes.push(Plane::outside(half).closing_wall());
        planes
    }

    fn planes_up(&self) -> Vec<Plane> {
        let Actuator { base, height, channel, .. } = self.actuator;
        let mut planes = vec![Plane::outside(0.0), Plane::edge(*base), Plane::edge(self.actuator.floor())];
        if self.actuator.has_channel() {
            planes.extend([Plane::edge(channel.bottom), Plane::edge(channel.top)]);
        }
        let walls = distinct(self.chambers.iter().map(|chamber| chamber.top_wall));
        planes.extend(walls.iter().map(|wall| Plane::edge(height - wall)));
        planes.push(Plane::outside(*height).closing_wall());
        planes.sort_by(|a, b| a.at.total_cmp(&b.at));
        planes
    }
}

impl Actuator {
    /// Estimated number of solid lattice cells for a given size, without building anything; exact up to rounding of the
    /// solid share.
    pub fn estimate_cells(&self, size: &MeshSize, cuts: &Cuts) -> f64 {
        let row = Row::of(self);
        let intervals = row.intervals(cuts);
        let mut solid = 0.0;
        let counts: [Vec<f64>; 3] = std::array::from_fn(|d| intervals[d].iter().map(|i| size.cells(i, d)).collect());
        // Summing over blocks of the geometry is cheap: their number does not depend on the element size.
        for (a, ix) in intervals[0].iter().enumerate() {
            for (b, iy) in intervals[1].iter().enumerate() {
                for (c, iz) in intervals[2].iter().enumerate() {
                    let centre = [ix, iy, iz].map(|i| 0.5 * (i.start + i.end));
                    if row.region(centre) == Region::Solid {
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
        Row::of(self).intervals(cuts).iter().enumerate().map(along).product()
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
