//! Which points touch which faces.

use pneuflex_mesh::{FaceKind, Mesh, quadrature, shape};
use pneuflex_model::{Contact, ContactMethod, ContactPair};
use rayon::prelude::*;

use crate::projection::{EDGE_TOLERANCE, EXTENSION, Projection, face_geometry, project, unit_normal};
use crate::projection::{dot, sub};
use crate::surface::Surface;

/// A point of a slave face that touches a master face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Reference coordinates on the slave face.
    pub slave_xi: [f64; 2],
    /// Reference area that the point stands for, mm².
    pub area: f64,
    /// Reference coordinates of its foot on the master face.
    pub master_xi: [f64; 2],
    /// Signed distance d < 0, mm.
    pub distance: f64,
    /// Number of the slave point among all points of the model, see [`ContactModel::num_points`].
    pub number: usize,
    /// Traction in the tangent's geometric term, MPa. The search sets it to k |d|; a solver may carry another one.
    pub traction: f64,
}

/// The touching points between one slave face and one master face.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactBlock {
    /// Pair of surfaces.
    pub pair: usize,
    /// Slave face, an index into the pair's slave facets.
    pub slave_face: usize,
    /// Master face, an index into the pair's master facets.
    pub master_face: usize,
    /// Nodes of the slave face, then nodes of the master face.
    pub nodes: Vec<u32>,
    /// Touching points, in the order of the rule.
    pub points: Vec<ContactPoint>,
}

/// Surfaces, law and integration rule of the contact between chambers.
#[derive(Clone, Debug)]
pub struct ContactModel {
    /// Where contact is looked for.
    pub method: ContactMethod,
    /// Penalty stiffness k, N/mm³.
    pub stiffness: f64,
    pairs: Vec<SurfacePair>,
    rule: Vec<([f64; 2], f64)>,
}

#[derive(Clone, Debug)]
struct SurfacePair {
    slave: Surface,
    master: Surface,
    /// Reference area of every rule point of every slave face, mm².
    areas: Vec<f64>,
    /// Number of the pair's first point.
    first_point: usize,
    rest_distance: f64,
    /// Points deeper than this behind a face are not found: the distance at rest, at least a face's size, mm.
    reach: f64,
}

impl ContactModel {
    /// Sets up the contact of the given pairs of facets.
    pub fn new(mesh: &Mesh, pairs: &[ContactPair], contact: &Contact) -> Self {
        let kind = mesh.face_kind();
        let rule = match contact.method {
            ContactMethod::None => Vec::new(),
            ContactMethod::SinglePoint => vec![(kind.centre(), kind.reference_area())],
            ContactMethod::MultiPoint => quadrature::contact_face(kind),
        };
        let pairs = if contact.method == ContactMethod::None { &[] } else { pairs };
        let mut first_point = 0;
        let pairs = pairs
            .iter()
            .map(|pair| {
                let slave = Surface::new(mesh, &pair.slave);
                let master = Surface::new(mesh, &pair.master);
                let mut areas = Vec::with_capacity(slave.num_faces() * rule.len());
                for face in 0..slave.num_faces() {
                    let nodes = slave.face_positions(face, &mesh.nodes);
                    for &(xi, weight) in &rule {
                        let geometry = face_geometry(&nodes[..kind.num_nodes()], &shape::evaluate_face(kind, xi));
                        areas.push(weight * unit_normal(&geometry.tangents).1);
                    }
                }
                let (rest_distance, face_size) = rest_distance_and_face_size(&slave, &master, &mesh.nodes);
                let first = first_point;
                first_point += areas.len();
                let reach = rest_distance.max(face_size);
                SurfacePair { slave, master, areas, first_point: first, rest_distance, reach }
            })
            .collect();
        Self { method: contact.method, stiffness: contact.stiffness, pairs, rule }
    }

    /// Number of pairs of surfaces; 0 when contact is switched off.
    pub fn num_pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Number of slave points of all pairs.
    pub fn num_points(&self) -> usize {
        self.pairs.last().map_or(0, |pair| pair.first_point + pair.areas.len())
    }

    /// Smallest distance at rest between the surfaces of a pair, mm; 0 without pairs.
    pub fn rest_distance(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.rest_distance).reduce(f64::min).unwrap_or(0.0)
    }

    /// The slave and the master surface of a pair.
    pub fn surfaces(&self, pair: usize) -> (&Surface, &Surface) {
        (&self.pairs[pair].slave, &self.pairs[pair].master)
    }

    /// All touching points at the given node positions, grouped by pair of faces, in a fixed order.
    pub fn search(&self, positions: &[[f64; 3]]) -> Vec<ContactBlock> {
        (0..self.pairs.len())
            .into_par_iter()
            .flat_map_iter(|pair| match self.method {
                ContactMethod::None => Vec::new(),
                ContactMethod::SinglePoint => self.search_single(pair, positions),
                ContactMethod::MultiPoint => self.search_multi(pair, positions),
            })
            .collect()
    }

    /// Nodes of the face pairs that touch or may soon touch: those for which the tangent's pattern needs room.
    ///
    /// A slave face belongs with a master face if one of its points, closer than `margin` (mm), has its foot there.
    pub fn near_face_pairs(&self, positions: &[[f64; 3]], margin: f64) -> Vec<Vec<u32>> {
        (0..self.pairs.len())
            .into_par_iter()
            .flat_map_iter(|pair| {
                let blocks = match self.method {
                    ContactMethod::None => Vec::new(),
                    ContactMethod::SinglePoint => self.single_blocks(pair, positions, margin),
                    ContactMethod::MultiPoint => self.multi_blocks(pair, positions, margin),
                };
                blocks.into_iter().map(|block| block.nodes)
            })
            .collect()
    }

    fn search_single(&self, pair: usize, positions: &[[f64; 3]]) -> Vec<ContactBlock> {
        self.single_blocks(pair, positions, 0.0)
    }

    fn search_multi(&self, pair: usize, positions: &[[f64; 3]]) -> Vec<ContactBlock> {
        self.multi_blocks(pair, positions, 0.0)
    }

    fn single_blocks(&self, pair: usize, positions: &[[f64; 3]], margin: f64) -> Vec<ContactBlock> {
        let SurfacePair { slave, master, areas, first_point, .. } = &self.pairs[pair];
        let kind = slave.kind;
        let shape = shape::evaluate_face(kind, kind.centre());
        let mut blocks = Vec::new();
        for face in 0..slave.num_faces().min(master.num_faces()) {
            let s = face_geometry(&slave.face_positions(face, positions)[..kind.num_nodes()], &shape);
            let m = face_geometry(&master.face_positions(face, positions)[..kind.num_nodes()], &shape);
            let distance = dot(sub(s.position, m.position), unit_normal(&m.tangents).0);
            if distance < margin {
                let point = ContactPoint {
                    slave_xi: kind.centre(),
                    area: areas[face],
                    master_xi: kind.centre(),
                    distance,
                    number: first_point + face,
                    traction: -self.stiffness * distance,
                };
                blocks.push(self.block(pair, face, face, vec![point]));
            }
        }
        blocks
    }

    fn multi_blocks(&self, pair: usize, positions: &[[f64; 3]], margin: f64) -> Vec<ContactBlock> {
        let SurfacePair { slave, master, areas, first_point, reach, .. } = &self.pairs[pair];
        let kind = slave.kind;
        let shapes: Vec<_> = self.rule.iter().map(|&(xi, _)| shape::evaluate_face(kind, xi)).collect();
        let boxes: Vec<_> = (0..master.num_faces()).map(|face| grown_box(master, face, positions)).collect();
        let slabs: Vec<_> = (0..master.num_faces()).map(|face| Slab::of(master, face, positions)).collect();
        let mut blocks: Vec<ContactBlock> = Vec::new();
        let mut candidates: Vec<(usize, [[f64; 3]; 2])> = Vec::new();
        let mut order = Vec::new();
        for face in 0..slave.num_faces() {
            candidates.clear();
            let bounds = slave.bounding_box(face, positions);
            candidates.extend(
                boxes
                    .iter()
                    .enumerate()
                    .filter(|(_, other)| boxes_overlap(&bounds, other, *reach))
                    .map(|(m, b)| (m, *b)),
            );
            let nodes = slave.face_positions(face, positions);
            // Far from contact, most faces are told apart without a projection.
            if candidates.iter().all(|(m, _)| slabs[*m].is_clear(kind, &nodes[..kind.num_nodes()], margin)) {
                continue;
            }
            let first_block = blocks.len();
            for (index, (&(slave_xi, _), shape)) in self.rule.iter().zip(&shapes).enumerate() {
                let point = face_geometry(&nodes[..kind.num_nodes()], shape).position;
                let Some((master_face, foot)) = closest(master, &candidates, &mut order, positions, point) else {
                    continue;
                };
                if foot.distance >= margin || foot.distance < -*reach {
                    continue;
                }
                let number = face * self.rule.len() + index;
                let touching = ContactPoint {
                    slave_xi,
                    area: areas[number],
                    master_xi: foot.xi,
                    distance: foot.distance,
                    number: first_point + number,
                    traction: -self.stiffness * foot.distance,
                };
                match blocks[first_block..].iter_mut().find(|block| block.master_face == master_face) {
                    Some(block) => block.points.push(touching),
                    None => blocks.push(self.block(pair, face, master_face, vec![touching])),
                }
            }
        }
        blocks
    }

    fn block(&self, pair: usize, slave_face: usize, master_face: usize, points: Vec<ContactPoint>) -> ContactBlock {
        let SurfacePair { slave, master, .. } = &self.pairs[pair];
        let nodes = slave.face(slave_face).iter().chain(master.face(master_face)).copied().collect();
        ContactBlock { pair, slave_face, master_face, nodes, points }
    }
}

/// The half-space in front of a master face.
struct Slab {
    /// Unit normal at the face's centre.
    normal: [f64; 3],
    /// No point of the face, continued a little, lies further than this along the normal, mm.
    front: f64,
}

impl Slab {
    fn of(surface: &Surface, face: usize, positions: &[[f64; 3]]) -> Self {
        let kind = surface.kind;
        let nodes = &surface.face_positions(face, positions)[..kind.num_nodes()];
        let normal = unit_normal(&face_geometry(nodes, &shape::evaluate_face(kind, kind.centre())).tangents).0;
        let [low, high] = extent(nodes, normal);
        Self { normal, front: high + (bulge(kind) + 2.0 * EXTENSION) * (high - low) }
    }

    /// Whether a slave face lies wholly in front, further away than `margin`: then no distance to this face is below it.
    fn is_clear(&self, kind: FaceKind, slave: &[[f64; 3]], margin: f64) -> bool {
        let [low, high] = extent(slave, self.normal);
        low - bulge(kind) * (high - low) > self.front + margin
    }
}

/// Least and largest coordinate of points along a direction.
fn extent(points: &[[f64; 3]], direction: [f64; 3]) -> [f64; 2] {
    points
        .iter()
        .map(|&x| dot(x, direction))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)])
}

/// By how much of their nodes' extent faces may exceed it: half of what their shape functions' absolute values exceed 1 by.
fn bulge(kind: FaceKind) -> f64 {
    match kind {
        FaceKind::Quad4 => 0.0,
        // Σ|N| ≤ 25/16 for nine nodes, 2 for eight, 5/3 for the triangle.
        FaceKind::Quad8 | FaceKind::Quad9 | FaceKind::Tri6 => 0.5,
    }
}

/// The foot that counts: the nearest one inside a face; failing that, the nearest one on a slightly continued face.
///
/// `candidates` are faces with bounding boxes that hold their continuation too. No foot is nearer than its box, so
/// faces are tried in the order of their boxes' distance until none can beat the best foot.
fn closest(
    master: &Surface,
    candidates: &[(usize, [[f64; 3]; 2])],
    order: &mut Vec<(f64, usize)>,
    positions: &[[f64; 3]],
    point: [f64; 3],
) -> Option<(usize, Projection)> {
    let n = master.kind.num_nodes();
    order.clear();
    order.extend(candidates.iter().map(|(face, bounds)| (distance_to_box(point, bounds), *face)));
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let is_outside = |p: &Projection| p.excess > EDGE_TOLERANCE;
    // Ties go to the face that comes first in the surface.
    let rank = |face: usize, p: &Projection| (is_outside(p), p.distance.abs(), face);
    let mut best: Option<(usize, Projection)> = None;
    for &(distance, face) in order.iter() {
        if best.as_ref().is_some_and(|(_, foot)| !is_outside(foot) && foot.distance.abs() < distance) {
            break;
        }
        let Some(foot) = project(master.kind, &master.face_positions(face, positions)[..n], point) else { continue };
        if foot.excess <= EXTENSION && best.as_ref().is_none_or(|(b, p)| rank(face, &foot) < rank(*b, p)) {
            best = Some((face, foot));
        }
    }
    best
}

fn distance_to_box(point: [f64; 3], bounds: &[[f64; 3]; 2]) -> f64 {
    let outside: [f64; 3] = std::array::from_fn(|d| (bounds[0][d] - point[d]).max(point[d] - bounds[1][d]).max(0.0));
    dot(outside, outside).sqrt()
}

/// Bounding box of a face with room for its continuation beyond its edges and for the bulge of a quadratic face.
fn grown_box(surface: &Surface, face: usize, positions: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let [low, high] = surface.bounding_box(face, positions);
    let size = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    let share = if surface.kind == FaceKind::Quad4 { EXTENSION } else { 2.5 * EXTENSION };
    [low.map(|x| x - share * size), high.map(|x| x + share * size)]
}

fn boxes_overlap(a: &[[f64; 3]; 2], b: &[[f64; 3]; 2], margin: f64) -> bool {
    (0..3).all(|d| a[0][d] <= b[1][d] + margin && b[0][d] <= a[1][d] + margin)
}

/// Distance of the two surfaces at rest, from the slave's first corner, and the size of the master's first face, mm.
fn rest_distance_and_face_size(slave: &Surface, master: &Surface, nodes: &[[f64; 3]]) -> (f64, f64) {
    if slave.num_faces() == 0 || master.num_faces() == 0 {
        return (0.0, 0.0);
    }
    let origin = nodes[slave.face(0)[0] as usize];
    let nearest = (0..master.num_faces())
        .flat_map(|face| master.face(face))
        .map(|&node| {
            let gap = sub(origin, nodes[node as usize]);
            dot(gap, gap).sqrt()
        })
        .fold(f64::INFINITY, f64::min);
    let bounds = master.bounding_box(0, nodes);
    let size = (0..3).map(|d| bounds[1][d] - bounds[0][d]).fold(0.0, f64::max);
    (nearest, size)
}
