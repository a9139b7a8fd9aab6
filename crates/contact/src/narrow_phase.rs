//! The points of some slave faces against the faces of their master: which foot counts.

use std::ops::Range;

use pneuflex_mesh::face::FaceShape;
use pneuflex_mesh::{FaceKind, PerFaceKind, shape};

use crate::broad_phase::{Bounds, FaceTree, join, overlap};
use crate::contact_block::{ContactBlock, ContactPoint, Partner};
use crate::model::ContactModel;
use crate::projection::{EDGE_TOLERANCE, EXTENSION, Projection, dot, face_geometry, project, sub, unit_normal};
use crate::segments::{Sample, samples};
use crate::self_contact::{
    BLOCKING_EXTENSION, NormalCone, SlavePoint, are_neighbours, blocks, counts, covers, is_across,
};
use crate::surface::Surface;
use crate::surface_pair::SurfacePair;

/// Centres of slave faces against the centres of the master faces of the same number.
pub fn single_blocks(
    model: &ContactModel,
    number: usize,
    faces: Range<usize>,
    (positions, kept): (&[[f64; 3]], &[f64]),
    margin: f64,
) -> Vec<ContactBlock> {
    let surface_pair = model.surface_pair(number);
    let (slave, master) = (&surface_pair.slave, &surface_pair.master);
    let mut blocks = Vec::new();
    for face in faces.start..faces.end.min(master.num_faces()) {
        let [on_slave, on_master] = [slave, master].map(|surface| surface.kind(face).centre());
        let (s, m) = (slave.geometry(face, on_slave, positions), master.geometry(face, on_master, positions));
        let distance = dot(sub(s.position, m.position), unit_normal(&m.tangents).0);
        let shift = model.shift(surface_pair.first_point + face, surface_pair.stiffness);
        if distance < margin + shift + kept_at(kept, surface_pair.first_point + face) {
            let point = ContactPoint {
                slave_xi: on_slave,
                area: surface_pair.points.areas[face],
                master_xi: on_master,
                distance,
                shift,
                number: surface_pair.first_point + face,
                ..ContactPoint::default()
            };
            blocks.push(block(surface_pair, number, face, face, vec![point.with_penalty(surface_pair.stiffness)]));
        }
    }
    blocks
}

/// Distance up to which a point is kept in contact, mm.
pub fn kept_at(kept: &[f64], number: usize) -> f64 {
    kept.get(number).copied().unwrap_or(0.0)
}

fn block(
    surface_pair: &SurfacePair,
    number: usize,
    slave_face: usize,
    face: usize,
    points: Vec<ContactPoint>,
) -> ContactBlock {
    let nodes = surface_pair.slave.face(slave_face).iter().chain(surface_pair.master.face(face)).copied().collect();
    ContactBlock { partner: Partner::Face { surface_pair: number, face }, slave_face, nodes, points }
}

/// A surface pair at some positions: what is computed once for all of its slave faces.
pub struct Facing<'a> {
    surface_pair: &'a SurfacePair,
    rest: &'a [[f64; 3]],
    positions: &'a [[f64; 3]],
    kept: &'a [f64],
    margin: f64,
    /// Of the master's faces, with room for their continuation.
    boxes: Vec<Bounds>,
    tree: FaceTree,
    slabs: Vec<Slab>,
    /// Of both surfaces' faces, within one body.
    cones: Option<[Vec<NormalCone>; 2]>,
}

impl<'a> Facing<'a> {
    /// `None` if the surfaces are out of each other's reach.
    pub fn new(
        surface_pair: &'a SurfacePair,
        rest: &'a [[f64; 3]],
        (positions, kept): (&'a [[f64; 3]], &'a [f64]),
        margin: f64,
    ) -> Option<Self> {
        let (slave, master) = (&surface_pair.slave, &surface_pair.master);
        let room = if surface_pair.is_self_contact { BLOCKING_EXTENSION } else { EXTENSION };
        let boxes: Vec<Bounds> = (0..master.num_faces()).map(|face| grown_box(master, face, positions, room)).collect();
        let slaves: Vec<Bounds> = (0..slave.num_faces()).map(|face| slave.bounding_box(face, positions)).collect();
        if !overlap(&join(&slaves), &join(&boxes), surface_pair.reach) {
            return None;
        }
        let cones = |surface: &Surface| {
            (0..surface.num_faces()).map(|face| NormalCone::of(surface, face, positions)).collect::<Vec<_>>()
        };
        Some(Self {
            surface_pair,
            rest,
            positions,
            kept,
            margin,
            tree: FaceTree::new(&boxes),
            boxes,
            slabs: (0..master.num_faces()).map(|face| Slab::of(master, face, positions)).collect(),
            cones: surface_pair.is_self_contact.then(|| [cones(slave), cones(master)]),
        })
    }

    /// The points of some slave faces that are near enough to their feet, grouped by master face.
    pub fn blocks(&self, model: &ContactModel, number: usize, faces: Range<usize>) -> Vec<ContactBlock> {
        let SurfacePair { slave, points, reach, stiffness, first_point, averaging, .. } = self.surface_pair;
        let shapes = PerFaceKind::new(|kind| {
            points.rule(kind).iter().map(|&(xi, _)| shape::evaluate_face(kind, xi)).collect::<Vec<_>>()
        });
        let mut samples: Vec<(Sample, FaceShape)> = Vec::new();
        let mut blocks: Vec<ContactBlock> = Vec::new();
        let (mut near, mut candidates, mut order) = (Vec::new(), Vec::new(), Vec::new());
        for face in faces {
            let kind = slave.kind(face);
            let bounds = slave.bounding_box(face, self.positions);
            self.tree.overlapping(&self.boxes, &bounds, *reach, &mut near);
            candidates.clear();
            let nodes = slave.face_positions(face, self.positions);
            let nodes = &nodes[..kind.num_nodes()];
            let counted = |m: usize| self.is_candidate(face, m) && !self.is_across(face, nodes, m);
            candidates.extend(near.iter().copied().filter(|&m| counted(m)));
            let own = points.of_face(face);
            let first = first_point + own.start;
            let room = |i: usize| {
                if averaging.is_some() { 0.0 } else { model.shift(i, *stiffness) + kept_at(self.kept, i) }
            };
            let most_room = (first..first + own.len()).map(room).fold(0.0, f64::max);
            // Far from contact, most faces are told apart without a projection.
            if candidates.iter().all(|&m| self.slabs[m].is_clear(kind, nodes, self.margin + most_room)) {
                continue;
            }
            let first_block = blocks.len();
            samples.clear();
            if averaging.is_some() {
                let own = self.surface_pair.samples[face].iter();
                samples.extend(own.map(|&sample| (sample, shape::evaluate_face(kind, sample.xi))));
            } else {
                let of_rule = points.rule(kind).iter().zip(&points.areas[own]);
                let of_rule = of_rule.map(|(&(xi, _), &area)| Sample { xi, area });
                samples.extend(of_rule.zip(shapes[kind].iter().copied()));
            }
            for (index, (sample, shape)) in samples.iter().enumerate() {
                let geometry = face_geometry(nodes, shape);
                let slave_point = self.cones.as_ref().map(|_| {
                    let at_rest = face_geometry(&slave.face_positions(face, self.rest)[..kind.num_nodes()], shape);
                    let [normal, normal_at_rest] = [&geometry, &at_rest].map(|g| unit_normal(&g.tangents).0);
                    SlavePoint { at_rest: at_rest.position, normal_at_rest, normal }
                });
                let found =
                    self.closest(face, [&candidates, &near], &mut order, geometry.position, slave_point.as_ref());
                let Some((master_face, foot)) = found else { continue };
                if foot.distance >= self.margin + room(first + index) || foot.distance < -*reach {
                    continue;
                }
                if slave_point.is_some_and(|slave| self.is_far_side(face, &near, geometry.position, &slave, &foot)) {
                    continue;
                }
                let touching = ContactPoint {
                    slave_xi: sample.xi,
                    area: sample.area,
                    master_xi: foot.xi,
                    distance: foot.distance,
                    ..ContactPoint::default()
                };
                let touching = if averaging.is_some() {
                    touching
                } else {
                    let (number, shift) = (first + index, model.shift(first + index, *stiffness));
                    ContactPoint { shift, number, ..touching }.with_penalty(*stiffness)
                };
                let partner = Partner::Face { surface_pair: number, face: master_face };
                match blocks[first_block..].iter_mut().find(|block| block.partner == partner) {
                    Some(block) => block.points.push(touching),
                    None => blocks.push(block(self.surface_pair, number, face, master_face, vec![touching])),
                }
            }
        }
        blocks
    }

    /// Integration points of a slave face, cut along the edges of the master's faces that are not clear of it.
    pub fn cut(&self, face: usize) -> Vec<Sample> {
        let SurfacePair { slave, master, share, reach, .. } = self.surface_pair;
        let kind = slave.kind(face);
        let nodes = &slave.face_positions(face, self.positions)[..kind.num_nodes()];
        let mut near = Vec::new();
        self.tree.overlapping(&self.boxes, &slave.bounding_box(face, self.positions), *reach, &mut near);
        let opposite: Vec<(usize, [[f64; 3]; 9])> = (near.into_iter())
            .filter(|&m| self.is_candidate(face, m) && !self.slabs[m].is_clear(kind, nodes, self.margin))
            .map(|m| (master.kind(m).num_corners(), master.face_positions(m, self.positions)))
            .collect();
        let corners: Vec<&[[f64; 3]]> = opposite.iter().map(|(corners, nodes)| &nodes[..*corners]).collect();
        let at_rest = slave.face_positions(face, self.rest);
        samples(kind, [nodes, &at_rest[..kind.num_nodes()]], &corners, *share)
    }

    fn is_candidate(&self, slave_face: usize, master_face: usize) -> bool {
        let Some([slaves, masters]) = &self.cones else { return true };
        !slaves[slave_face].never_opposes(&masters[master_face])
            && self.surface_pair.slave.face(slave_face) != self.surface_pair.master.face(master_face)
    }

    /// Whether a master face lies on the other side of a wall from a slave face with all of its points.
    fn is_across(&self, slave_face: usize, slave: &[[f64; 3]], master_face: usize) -> bool {
        let (Some([_, masters]), Some([slaves_at_rest, masters_at_rest])) = (&self.cones, &self.surface_pair.at_rest)
        else {
            return false;
        };
        let depth = self.slabs[master_face].depth(self.surface_pair.slave.kind(slave_face), slave);
        masters[master_face].is_narrow() && is_across(&slaves_at_rest[slave_face], &masters_at_rest[master_face], depth)
    }

    fn are_neighbours(&self, slave_face: usize, master_face: usize) -> bool {
        are_neighbours(self.surface_pair.slave.face(slave_face), self.surface_pair.master.face(master_face))
    }

    /// Rule 4 of [`crate::self_contact`], for a foot that the point lies behind.
    fn is_far_side(
        &self,
        slave_face: usize,
        near: &[usize],
        point: [f64; 3],
        slave: &SlavePoint,
        foot: &Projection,
    ) -> bool {
        foot.distance < 0.0
            && near.iter().any(|&m| {
                !self.are_neighbours(slave_face, m)
                    && distance_to_box(point, &self.boxes[m]) < -foot.distance
                    && self.project(m, point).is_some_and(|other| blocks(slave.normal, &other, -foot.distance))
            })
    }

    /// Rule 5 of [`crate::self_contact`], for a foot beyond the edges of a face.
    fn is_covered(&self, face: usize, near: &[usize], point: [f64; 3]) -> bool {
        let SurfacePair { master, reach, .. } = self.surface_pair;
        near.iter().any(|&m| {
            m != face
                && are_neighbours(master.face(face), master.face(m))
                && distance_to_box(point, &self.boxes[m]) <= *reach
                && self.project(m, point).is_some_and(|other| covers(&other, *reach))
        })
    }

    fn project(&self, face: usize, point: [f64; 3]) -> Option<Projection> {
        let master = &self.surface_pair.master;
        let kind = master.kind(face);
        project(kind, &master.face_positions(face, self.positions)[..kind.num_nodes()], point)
    }

    /// The foot that counts: the nearest one inside a face; failing that, the nearest one on a slightly continued face.
    ///
    /// No foot is nearer than its face's box, so faces are tried in the order of their boxes' distance until none can beat the
    /// best foot.
    fn closest(
        &self,
        slave_face: usize,
        [candidates, near]: [&[usize]; 2],
        order: &mut Vec<(f64, usize)>,
        point: [f64; 3],
        slave: Option<&SlavePoint>,
    ) -> Option<(usize, Projection)> {
        order.clear();
        order.extend(candidates.iter().map(|&face| (distance_to_box(point, &self.boxes[face]), face)));
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let is_outside = |p: &Projection| p.excess > EDGE_TOLERANCE;
        // Ties go to the face that comes first in the surface.
        let rank = |face: usize, p: &Projection| (is_outside(p), p.distance.abs(), face);
        let mut best: Option<(usize, Projection)> = None;
        for &(distance, face) in order.iter() {
            if best.as_ref().is_some_and(|(_, foot)| !is_outside(foot) && foot.distance.abs() < distance) {
                break;
            }
            let Some(foot) = self.project(face, point) else { continue };
            if foot.excess <= EXTENSION
                && best.as_ref().is_none_or(|(b, p)| rank(face, &foot) < rank(*b, p))
                && slave.is_none_or(|slave| {
                    counts(slave, &foot, self.at_rest(face, &foot), self.are_neighbours(slave_face, face))
                        && !(is_outside(&foot) && self.is_covered(face, near, point))
                })
            {
                best = Some((face, foot));
            }
        }
        best
    }

    /// Position of a foot at rest.
    fn at_rest(&self, face: usize, foot: &Projection) -> [f64; 3] {
        self.surface_pair.master.geometry(face, foot.xi, self.rest).position
    }
}

/// The half-spaces in front of and behind a master face.
struct Slab {
    /// Unit normal at the face's centre.
    normal: [f64; 3],
    /// No point of the face, continued a little, lies further than this along the normal, mm.
    front: f64,
    /// Nor less far than this, mm.
    back: f64,
}

impl Slab {
    fn of(surface: &Surface, face: usize, positions: &[[f64; 3]]) -> Self {
        let kind = surface.kind(face);
        let nodes = &surface.face_positions(face, positions)[..kind.num_nodes()];
        let normal = unit_normal(&face_geometry(nodes, &shape::evaluate_face(kind, kind.centre())).tangents).0;
        let [low, high] = extent(nodes, normal);
        let room = (kind.bulge + 2.0 * EXTENSION) * (high - low);
        Self { normal, front: high + room, back: low - room }
    }

    /// Whether a slave face lies wholly in front, further away than `margin`: then no distance to this face is below it.
    fn is_clear(&self, kind: FaceKind, slave: &[[f64; 3]], margin: f64) -> bool {
        let [low, high] = extent(slave, self.normal);
        low - kind.bulge * (high - low) > self.front + margin
    }

    /// How far behind the whole of a slave face lies at least, mm; negative if a part of it does not.
    fn depth(&self, kind: FaceKind, slave: &[[f64; 3]]) -> f64 {
        let [low, high] = extent(slave, self.normal);
        self.back - (high + kind.bulge * (high - low))
    }
}

/// Least and largest coordinate of points along a direction.
fn extent(points: &[[f64; 3]], direction: [f64; 3]) -> [f64; 2] {
    points
        .iter()
        .map(|&x| dot(x, direction))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)])
}

fn distance_to_box(point: [f64; 3], bounds: &Bounds) -> f64 {
    let outside: [f64; 3] = std::array::from_fn(|d| (bounds[0][d] - point[d]).max(point[d] - bounds[1][d]).max(0.0));
    dot(outside, outside).sqrt()
}

/// Bounding box of a face with room for its continuation beyond its edges and for the bulge of a quadratic face.
fn grown_box(surface: &Surface, face: usize, positions: &[[f64; 3]], room: f64) -> Bounds {
    let [low, high] = surface.bounding_box(face, positions);
    let size = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    let share = if surface.kind(face).is_linear() { room } else { 2.5 * room };
    [low.map(|x| x - share * size), high.map(|x| x + share * size)]
}
