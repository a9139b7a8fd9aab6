//! Which points touch which faces and obstacles.

use pneuflex_mesh::shape;
use pneuflex_model::ContactMethod;
use rayon::prelude::*;

use crate::average_gap::{close_gaps, coupled_nodes};
use crate::averaging::Averaging;
use crate::contact_block::{ContactBlock, ContactPoint, Partner};
use crate::model::{ContactModel, Rigid};
use crate::narrow_phase::{Facing, kept_at, single_blocks};
use crate::obstacle::distance;
use crate::projection::{dot, face_geometry, sub};
use crate::surface_pair::SurfacePair;
use crate::touching::Touching;

/// Points nearer than this share of the nodes' spacing count as touching: bodies that rest on each other without any pressure hold each other in the tangent.
/// The traction that this invents, k times as much, is far below every tolerance.
pub const TOUCHING: f64 = 1e-9;

/// Faces nearer than this share of the surfaces' reach are cut along each other's edges.
const CUT_NEARER: f64 = 0.25;

/// Slave faces that one task looks at.
const CHUNK: usize = 32;

impl ContactModel {
    /// All touching points at the given node positions, grouped by faces, in a fixed order.
    pub fn search(&self, positions: &[[f64; 3]]) -> Touching {
        self.search_keeping(positions, &[])
    }

    /// The same with those points that are kept in contact up to a distance of their own, mm; `kept` holds one per point of the model, or is
    /// empty for none. See [`Self::kept_distances`].
    pub fn search_keeping(&self, positions: &[[f64; 3]], kept: &[f64]) -> Touching {
        let margin = |pair: &SurfacePair| pair.averaging.as_ref().map_or(self.touching, Averaging::farthest);
        let mut blocks = self.face_blocks(positions, kept, margin);
        blocks.par_extend(self.obstacles.par_iter().enumerate().flat_map_iter(|(number, rigid)| {
            (0..rigid.surface.num_faces())
                .filter_map(move |face| self.obstacle_block(number, rigid, face, (positions, kept)))
        }));
        let averages = close_gaps(self, &mut blocks, positions, kept);
        Touching { blocks, averages }
    }

    /// Integration points of averaged gaps: slave faces are cut along the edges of the master's faces as they lie at these positions. The
    /// points stay where they are on their faces until this is called again, so that forces are derivatives of an energy.
    pub fn cut(&mut self, positions: &[[f64; 3]]) {
        let Self { surface_pairs, mesh, .. } = self;
        for surface_pair in surface_pairs.iter_mut().filter(|pair| pair.averaging.is_some()) {
            let margin = CUT_NEARER * surface_pair.reach;
            let Some(facing) = Facing::new(surface_pair, &mesh.nodes, (positions, &[]), margin) else { continue };
            let faces = 0..surface_pair.slave.num_faces();
            surface_pair.samples = faces.into_par_iter().map(|face| facing.cut(face)).collect();
        }
    }

    /// Nodes of the pairs of faces that touch or may soon touch, and of the averages over them: those for which the tangent's pattern needs
    /// room.
    ///
    /// A slave face belongs with a master face if one of its points, close enough to it, has its foot there.
    pub fn near_face_pairs(&self, positions: &[[f64; 3]]) -> Vec<Vec<u32>> {
        let margin = |pair: &SurfacePair| pair.averaging.as_ref().map_or(0.0, Averaging::farthest).max(pair.near);
        let blocks = self.face_blocks(positions, &[], margin);
        let mut groups = coupled_nodes(self, &blocks);
        groups.extend(blocks.into_iter().map(|block| block.nodes));
        groups
    }

    /// Points nearer to their foot than a margin that depends on the surface pair.
    fn face_blocks(
        &self,
        positions: &[[f64; 3]],
        kept: &[f64],
        margin: impl Fn(&SurfacePair) -> f64 + Sync,
    ) -> Vec<ContactBlock> {
        let facing: Vec<Option<Facing<'_>>> = (self.surface_pairs.par_iter())
            .map(|surface_pair| match surface_pair.method {
                ContactMethod::MultiPoint | ContactMethod::Mortar => {
                    Facing::new(surface_pair, &self.mesh.nodes, (positions, kept), margin(surface_pair))
                }
                _ => None,
            })
            .collect();
        let tasks: Vec<(usize, usize)> = (self.surface_pairs.iter().enumerate())
            .flat_map(|(number, surface_pair)| {
                (0..surface_pair.slave.num_faces()).step_by(CHUNK).map(move |face| (number, face))
            })
            .collect();
        let blocks = tasks.into_par_iter().flat_map_iter(|(number, first)| {
            let surface_pair = &self.surface_pairs[number];
            let faces = first..surface_pair.slave.num_faces().min(first + CHUNK);
            match (surface_pair.method, &facing[number]) {
                (ContactMethod::SinglePoint, _) => {
                    single_blocks(self, number, faces, (positions, kept), margin(surface_pair))
                }
                (_, Some(facing)) => facing.blocks(self, number, faces),
                (_, None) => Vec::new(),
            }
        });
        blocks.collect()
    }

    fn obstacle_block(
        &self,
        number: usize,
        rigid: &Rigid,
        face: usize,
        (positions, kept): (&[[f64; 3]], &[f64]),
    ) -> Option<ContactBlock> {
        let Rigid { obstacle, surface, offset, points, first_point, .. } = rigid;
        let kind = surface.kind(face);
        let n = kind.num_nodes();
        let nodes = &surface.face_positions(face, positions)[..n];
        let own = points.of_face(face);
        let (first, rule) = (own.start, points.rule(kind));
        let room = |number: usize, shift: f64| shift + kept_at(kept, number);
        let most_room =
            own.map(|i| first_point + i).map(|i| room(i, self.shift(i, obstacle.stiffness))).fold(0.0, f64::max);
        // The distance changes by no more than the way one moves.
        let centre: [f64; 3] = std::array::from_fn(|d| nodes.iter().map(|x| x[d]).sum::<f64>() / n as f64);
        let radius = nodes.iter().map(|&x| dot(sub(x, centre), sub(x, centre)).sqrt()).fold(0.0, f64::max);
        let nearest = distance(&obstacle.shape, *offset, centre).value - (1.0 + kind.bulge) * radius;
        if nearest > self.touching + most_room {
            return None;
        }
        let touching = rule.iter().enumerate().filter_map(|(index, &(slave_xi, _))| {
            let position = face_geometry(nodes, &shape::evaluate_face(kind, slave_xi)).position;
            let distance = distance(&obstacle.shape, *offset, position).value;
            let number = first_point + first + index;
            let (shift, area) = (self.shift(number, obstacle.stiffness), points.areas[first + index]);
            (distance < self.touching + room(number, shift)).then(|| {
                let point = ContactPoint { slave_xi, area, distance, shift, number, ..ContactPoint::default() };
                point.with_penalty(obstacle.stiffness)
            })
        });
        let touching: Vec<_> = touching.collect();
        let partner = Partner::Obstacle(number);
        (!touching.is_empty()).then(|| ContactBlock {
            partner,
            slave_face: face,
            nodes: surface.face(face).to_vec(),
            points: touching,
        })
    }
}
