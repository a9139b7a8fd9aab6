//! Which points touch which faces and obstacles.

use pneuflex_mesh::{Mesh, shape};
use pneuflex_model::{Contact, ContactMethod, ContactPair, Obstacle, Problem};
use rayon::prelude::*;

use crate::narrow_phase::{Facing, single_blocks};
use crate::obstacle::{Distance, distance};
use crate::pass::{Pass, point_areas};
use crate::projection::{dot, face_geometry, sub};
use crate::surface::Surface;

/// Points nearer than this count as touching, mm: bodies that rest on each other without any pressure hold each other in the tangent.
/// The traction that this invents, k times as much, is far below every tolerance.
const TOUCHING: f64 = 1e-9;

/// Slave faces that one task looks at.
const CHUNK: usize = 32;

/// A point of a slave face that touches a master face or an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Reference coordinates on the slave face.
    pub slave_xi: [f64; 2],
    /// Reference area that the point stands for, mm².
    pub area: f64,
    /// Reference coordinates of its foot on the master face; not used with an obstacle.
    pub master_xi: [f64; 2],
    /// Signed distance d, mm; negative is penetration.
    pub distance: f64,
    /// λ/k, mm: the distance up to which the point's multiplier keeps it in contact; 0 for a plain penalty.
    pub shift: f64,
    /// Number of the slave point among all points of the model, see [`ContactModel::num_points`].
    pub number: usize,
    /// Traction in the tangent's geometric term, MPa. The search sets it to ⟨λ − k d⟩; a solver may carry another one.
    pub traction: f64,
}

/// What a slave face touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partner {
    /// A face of the pass's master surface.
    Face {
        /// Number of the pass, see [`ContactModel::pass`].
        pass: usize,
        /// An index into the master's facets.
        face: usize,
    },
    /// The obstacle of this number.
    Obstacle(usize),
}

/// The touching points between a slave face and one master face or obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactBlock {
    /// What is touched.
    pub partner: Partner,
    /// Slave face, an index into the pass's slave facets or the obstacle's facets.
    pub slave_face: usize,
    /// Nodes of the slave face, then nodes of the master face.
    pub nodes: Vec<u32>,
    /// Touching points, in the order of the rule.
    pub points: Vec<ContactPoint>,
}

/// Surfaces, obstacles, laws and multipliers of a problem's contact.
#[derive(Clone, Debug)]
pub struct ContactModel {
    passes: Vec<Pass>,
    obstacles: Vec<Rigid>,
    /// Traction λ of every point that is there without any penetration, MPa; empty for a plain penalty.
    multipliers: Vec<f64>,
    rest: Vec<[f64; 3]>,
}

/// An obstacle and the faces that carry its points.
#[derive(Clone, Debug)]
pub(crate) struct Rigid {
    obstacle: Obstacle,
    pub(crate) surface: Surface,
    /// Where it is now, from where it was at rest, mm.
    offset: [f64; 3],
    rule: Vec<([f64; 2], f64)>,
    areas: Vec<f64>,
    first_point: usize,
}

impl ContactModel {
    /// Sets up the contact of a problem.
    pub fn of(problem: &Problem) -> Self {
        Self::new(&problem.mesh, &problem.contact_pairs, &problem.contact)
            .with_obstacles(&problem.mesh, &problem.obstacles)
    }

    /// Sets up the contact of the given pairs of facets; `contact` is the law of those that have none of their own.
    pub fn new(mesh: &Mesh, pairs: &[ContactPair], contact: &Contact) -> Self {
        let mut passes: Vec<Pass> = Vec::new();
        let mut points = 0;
        for (number, pair) in pairs.iter().enumerate() {
            let of_pair = Pass::all_of(mesh, number, pair, contact, points);
            points += of_pair.iter().map(Pass::num_points).sum::<usize>();
            passes.extend(of_pair);
        }
        Self { passes, obstacles: Vec::new(), multipliers: Vec::new(), rest: mesh.nodes.clone() }
    }

    /// The same with obstacles, at the places where they begin.
    pub fn with_obstacles(mut self, mesh: &Mesh, obstacles: &[Obstacle]) -> Self {
        for obstacle in obstacles {
            let surface = Surface::new(mesh, &obstacle.facets);
            let rule = surface.kind.contact_rule();
            let areas = point_areas(&surface, &rule, &mesh.nodes, 1.0);
            let (first_point, offset) = (self.num_points(), obstacle.offset(0.0));
            self.obstacles.push(Rigid { obstacle: obstacle.clone(), surface, offset, rule, areas, first_point });
        }
        self
    }

    /// Moves the obstacles to where they are at a time.
    pub fn set_time(&mut self, time: f64) {
        for rigid in &mut self.obstacles {
            rigid.offset = rigid.obstacle.offset(time);
        }
    }

    /// Gives every point the traction λ (MPa) that it carries without any penetration: ⟨λ − k d⟩ instead of ⟨−k d⟩.
    ///
    /// # Panics
    /// If there are neither none nor as many as points.
    pub fn set_multipliers(&mut self, multipliers: Vec<f64>) {
        assert!(multipliers.is_empty() || multipliers.len() == self.num_points(), "one multiplier per contact point");
        self.multipliers = multipliers;
    }

    /// See [`Self::set_multipliers`].
    pub fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    /// Positions of the mesh's nodes at rest, mm.
    pub fn rest(&self) -> &[[f64; 3]] {
        &self.rest
    }

    /// Surfaces whose points are projected onto others.
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// The pass of the given number.
    pub fn pass(&self, pass: usize) -> &Pass {
        &self.passes[pass]
    }

    /// Number of slave points of all passes and obstacles.
    pub fn num_points(&self) -> usize {
        match (self.obstacles.last(), self.passes.last()) {
            (Some(rigid), _) => rigid.first_point + rigid.areas.len(),
            (None, Some(pass)) => pass.first_point + pass.areas.len(),
            (None, None) => 0,
        }
    }

    /// Penalty stiffness between the faces of a block, N/mm³.
    pub fn stiffness(&self, partner: Partner) -> f64 {
        match partner {
            Partner::Face { pass, .. } => self.passes[pass].stiffness,
            Partner::Obstacle(number) => self.obstacles[number].obstacle.stiffness,
        }
    }

    /// The surface that carries the points of a block.
    pub fn slave(&self, partner: Partner) -> &Surface {
        match partner {
            Partner::Face { pass, .. } => &self.passes[pass].slave,
            Partner::Obstacle(number) => &self.obstacles[number].surface,
        }
    }

    /// Signed distance of a position from an obstacle where it is now.
    pub fn distance_to_obstacle(&self, number: usize, position: [f64; 3]) -> Distance {
        let Rigid { obstacle, offset, .. } = &self.obstacles[number];
        distance(&obstacle.shape, *offset, position)
    }

    /// The point that an obstacle's moment refers to, where it is now.
    pub fn reference_point(&self, number: usize) -> [f64; 3] {
        let Rigid { obstacle, offset, .. } = &self.obstacles[number];
        let point = obstacle.shape.reference_point();
        std::array::from_fn(|d| point[d] + offset[d])
    }

    /// All touching points at the given node positions, grouped by faces, in a fixed order.
    pub fn search(&self, positions: &[[f64; 3]]) -> Vec<ContactBlock> {
        let mut blocks = self.face_blocks(positions, |_| TOUCHING);
        blocks.par_extend(self.obstacles.par_iter().enumerate().flat_map_iter(|(number, rigid)| {
            (0..rigid.surface.num_faces()).filter_map(move |face| self.obstacle_block(number, rigid, face, positions))
        }));
        blocks
    }

    /// Nodes of the pairs of faces that touch or may soon touch: those for which the tangent's pattern needs room.
    ///
    /// A slave face belongs with a master face if one of its points, close enough to it, has its foot there.
    pub fn near_face_pairs(&self, positions: &[[f64; 3]]) -> Vec<Vec<u32>> {
        self.face_blocks(positions, |pass| pass.near).into_iter().map(|block| block.nodes).collect()
    }

    /// Points nearer to their foot than a margin that depends on the pass.
    fn face_blocks(&self, positions: &[[f64; 3]], margin: impl Fn(&Pass) -> f64 + Sync) -> Vec<ContactBlock> {
        let facing: Vec<Option<Facing<'_>>> = (self.passes.par_iter())
            .map(|pass| match pass.method {
                ContactMethod::MultiPoint => Facing::new(pass, &self.rest, positions, margin(pass)),
                _ => None,
            })
            .collect();
        let tasks: Vec<(usize, usize)> = (self.passes.iter().enumerate())
            .flat_map(|(number, pass)| (0..pass.slave.num_faces()).step_by(CHUNK).map(move |face| (number, face)))
            .collect();
        let blocks = tasks.into_par_iter().flat_map_iter(|(number, first)| {
            let pass = &self.passes[number];
            let faces = first..pass.slave.num_faces().min(first + CHUNK);
            match (pass.method, &facing[number]) {
                (ContactMethod::SinglePoint, _) => single_blocks(self, number, faces, positions, margin(pass)),
                (_, Some(facing)) => facing.blocks(self, number, faces),
                (_, None) => Vec::new(),
            }
        });
        blocks.collect()
    }

    /// λ/k of a point, mm.
    pub(crate) fn shift(&self, number: usize, stiffness: f64) -> f64 {
        self.multipliers.get(number).map_or(0.0, |lambda| lambda / stiffness)
    }

    fn obstacle_block(
        &self,
        number: usize,
        rigid: &Rigid,
        face: usize,
        positions: &[[f64; 3]],
    ) -> Option<ContactBlock> {
        let Rigid { obstacle, surface, offset, rule, areas, first_point } = rigid;
        let kind = surface.kind;
        let n = kind.num_nodes();
        let nodes = &surface.face_positions(face, positions)[..n];
        let first = face * rule.len();
        let most_shift =
            (first..first + rule.len()).map(|i| self.shift(first_point + i, obstacle.stiffness)).fold(0.0, f64::max);
        // The distance changes by no more than the way one moves.
        let centre: [f64; 3] = std::array::from_fn(|d| nodes.iter().map(|x| x[d]).sum::<f64>() / n as f64);
        let radius = nodes.iter().map(|&x| dot(sub(x, centre), sub(x, centre)).sqrt()).fold(0.0, f64::max);
        let nearest = distance(&obstacle.shape, *offset, centre).value - (1.0 + kind.bulge) * radius;
        if nearest > TOUCHING + most_shift {
            return None;
        }
        let touching = rule.iter().enumerate().filter_map(|(index, &(slave_xi, _))| {
            let position = face_geometry(nodes, &shape::evaluate_face(kind, slave_xi)).position;
            let distance = distance(&obstacle.shape, *offset, position).value;
            let shift = self.shift(first_point + first + index, obstacle.stiffness);
            (distance < TOUCHING + shift).then(|| ContactPoint {
                slave_xi,
                area: areas[first + index],
                master_xi: [0.0; 2],
                distance,
                shift,
                number: first_point + first + index,
                traction: -obstacle.stiffness * (distance - shift),
            })
        });
        let points: Vec<_> = touching.collect();
        let partner = Partner::Obstacle(number);
        (!points.is_empty()).then(|| ContactBlock {
            partner,
            slave_face: face,
            nodes: surface.face(face).to_vec(),
            points,
        })
    }
}
