//! One surface's points against another surface: what of it does not change.

use pneuflex_mesh::{FaceKind, Facet, Mesh};
use pneuflex_model::{Contact, ContactMethod, ContactPair, LoadParameter};

use crate::averaging::Averaging;
use crate::projection::{EXTENSION, dot, sub};
use crate::segments::{Sample, samples};
use crate::self_contact::{FaceAtRest, share_nodes};
use crate::surface::{FacePoints, Surface};

/// Room is made in the tangent for faces that are nearer than this share of their distance at rest, and at least this share of a
/// face's size where they (nearly) touch at rest.
const NEAR_SHARE: f64 = 0.15;
const NEAR_FACE_SHARE: f64 = 0.03;

/// The points of a slave surface against a master surface. A pair has one of them, or two if each surface is the slave in turn.
#[derive(Clone, Debug)]
pub struct SurfacePair {
    /// Number of the pair among the problem's.
    pub pair: usize,
    /// Whether the slave of this surface pair is the pair's master.
    pub is_reversed: bool,
    /// Where contact is looked for.
    pub method: ContactMethod,
    /// Penalty stiffness k, N/mm³.
    pub stiffness: f64,
    /// Surface that carries the points.
    pub slave: Surface,
    /// Surface onto which they are projected.
    pub master: Surface,
    /// Number of the first point.
    pub(crate) first_point: usize,
    /// The points of the slave's faces; the areas are half of what they are where both surfaces are slaves. None where gaps are averaged.
    pub(crate) points: FacePoints,
    /// Share of the area at rest that points stand for: half where both surfaces are slaves.
    pub(crate) share: f64,
    /// The corners around which gaps are averaged, if they are.
    pub(crate) averaging: Option<Averaging>,
    /// Integration points of every slave face where gaps are averaged, see [`crate::ContactModel::cut`].
    pub(crate) samples: Vec<Vec<Sample>>,
    /// How deep points may be at requested loads, mm; `None` for any depth.
    pub(crate) tolerance: Option<f64>,
    /// Where an overlap at rest is gone; `None` if there must be none.
    pub(crate) interference_until: Option<LoadParameter>,
    /// The surfaces belong together, see [`crate::self_contact`].
    pub(crate) is_self_contact: bool,
    /// Of self-contact: the faces of slave and master at rest.
    pub(crate) at_rest: Option<[Vec<FaceAtRest>; 2]>,
    /// Smallest distance at rest from the slave's first corner, mm; 0 of a surface from itself.
    pub rest_distance: f64,
    /// Points deeper than this behind a face are not found, mm; see [`SurfacePair::all_of`].
    pub reach: f64,
    /// How near faces must be for the tangent's pattern to have room for them, mm.
    pub(crate) near: f64,
}

impl SurfacePair {
    /// The surface pairs of pair number `number`; none where contact is switched off.
    ///
    /// Reach: at least a face's size, so that surfaces that touch at rest are followed as deep as the mesh can tell; the distance
    /// at rest where that is larger, which is as far as a wall gets in a first guess without any contact; never more than half the
    /// master's extent, so that bodies far apart are not looked for behind each other.
    pub fn all_of(mesh: &Mesh, number: usize, pair: &ContactPair, contact: &Contact, first_point: usize) -> Vec<Self> {
        let method = match pair.method.unwrap_or(contact.method) {
            ContactMethod::Mortar if pair.is_of_one_surface(mesh) => ContactMethod::MultiPoint,
            method => method,
        };
        let stiffness = pair.stiffness.unwrap_or(contact.stiffness);
        // Of two faces of one surface each is the other's slave.
        let is_shared = pair.is_two_pass || pair.is_self();
        let new = |slave: &[Facet], master: &[Facet], is_reversed: bool, first_point: usize| {
            let rule = |kind: FaceKind| match method {
                ContactMethod::SinglePoint => vec![(kind.centre(), kind.reference_area())],
                ContactMethod::Mortar => Vec::new(),
                _ => kind.contact_rule(),
            };
            let (slave, master) = (Surface::new(mesh, slave), Surface::new(mesh, master));
            let share = if is_shared { 0.5 } else { 1.0 };
            let points = FacePoints::of(&slave, rule, &mesh.nodes, share);
            let averaging = (method == ContactMethod::Mortar).then(|| Averaging::of(&slave, &mesh.nodes, share));
            let samples = averaging.as_ref().map_or_else(Vec::new, |_| uncut(&slave, &mesh.nodes, share));
            let is_self_contact = method != ContactMethod::SinglePoint && share_nodes(&slave, &master);
            let faces_at_rest = |surface: &Surface, room: f64| {
                (0..surface.num_faces()).map(|face| FaceAtRest::of(surface, face, &mesh.nodes, room)).collect()
            };
            let at_rest = is_self_contact.then(|| [faces_at_rest(&slave, 0.0), faces_at_rest(&master, EXTENSION)]);
            let rest_distance = if is_self_contact { 0.0 } else { rest_distance(&slave, &master, &mesh.nodes) };
            let (face_size, extent) = sizes(&master, &mesh.nodes);
            let reach = rest_distance.min(0.5 * extent).max(face_size);
            let near = (NEAR_SHARE * rest_distance).max(NEAR_FACE_SHARE * face_size).min(reach);
            Self {
                pair: number,
                is_reversed,
                method,
                stiffness,
                slave,
                master,
                first_point,
                points,
                share,
                averaging,
                samples,
                tolerance: pair.penetration_tolerance.or(contact.penetration_tolerance),
                interference_until: pair.interference_until,
                is_self_contact,
                at_rest,
                rest_distance,
                reach,
                near,
            }
        };
        if method == ContactMethod::None {
            return Vec::new();
        }
        let forward = new(&pair.slave, &pair.master, false, first_point);
        if !pair.is_two_pass || pair.is_self() {
            return vec![forward];
        }
        let next = first_point + forward.num_points();
        vec![forward, new(&pair.master, &pair.slave, true, next)]
    }

    /// Number of slave points, or of corners around which gaps are averaged.
    pub fn num_points(&self) -> usize {
        self.averaging.as_ref().map_or(self.points.areas.len(), Averaging::len)
    }
}

/// Integration points of every face before anything is near it.
fn uncut(surface: &Surface, nodes: &[[f64; 3]], share: f64) -> Vec<Vec<Sample>> {
    let of_face = |face| {
        let kind = surface.kind(face);
        let positions = surface.face_positions(face, nodes);
        let positions = &positions[..kind.num_nodes()];
        samples(kind, [positions; 2], &[], share)
    };
    (0..surface.num_faces()).map(of_face).collect()
}

/// Distance of the two surfaces at rest, from the slave's first corner, mm.
fn rest_distance(slave: &Surface, master: &Surface, nodes: &[[f64; 3]]) -> f64 {
    if slave.num_faces() == 0 || master.num_faces() == 0 {
        return 0.0;
    }
    let origin = nodes[slave.face(0)[0] as usize];
    (0..master.num_faces())
        .flat_map(|face| master.face(face))
        .map(|&node| {
            let gap = sub(origin, nodes[node as usize]);
            dot(gap, gap).sqrt()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Mean size of the faces, and extent of the surface, mm: the longest edge of their bounding boxes.
fn sizes(surface: &Surface, nodes: &[[f64; 3]]) -> (f64, f64) {
    if surface.num_faces() == 0 {
        return (0.0, 0.0);
    }
    let longest = |b: &[[f64; 3]; 2]| (0..3).map(|d| b[1][d] - b[0][d]).fold(0.0, f64::max);
    let boxes: Vec<_> = (0..surface.num_faces()).map(|face| surface.bounding_box(face, nodes)).collect();
    let mean = boxes.iter().map(longest).sum::<f64>() / boxes.len() as f64;
    (mean, longest(&crate::broad_phase::join(&boxes)))
}
