//! The contact of a problem: surfaces, obstacles, laws and multipliers.

use std::sync::Arc;

use pneuflex_mesh::{Mesh, shape};
use pneuflex_model::load::Motion;
use pneuflex_model::{Contact, ContactPair, LoadParameter, Material, Obstacle, Problem};

use crate::averaging::Averaging;
use crate::contact_block::Partner;
use crate::obstacle::{Distance, distance};
use crate::overlap::Overlap;
use crate::projection::{dot, face_geometry, sub};
use crate::search::TOUCHING;
use crate::surface::{FacePoints, Surface};
use crate::surface_pair::SurfacePair;

/// A point is deep inside of an obstacle beyond this share of the obstacle's greatest depth.
const DEEP_INSIDE: f64 = 0.5;

/// Where a way is looked at, as shares of it.
const ON_THE_WAY: [f64; 7] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];

/// Penalties up to this multiple of the body's own stiffness decide alone which points touch: they do it in fewer iterations.
const SOFT: f64 = 8.0;

/// Points are kept in contact up to this share of the nodes' spacing at the most: further away the foot may be another one.
const MOST_KEPT: f64 = 0.1;

/// Surfaces, obstacles, laws and multipliers of a problem's contact.
#[derive(Clone, Debug)]
pub struct ContactModel {
    pub(crate) surface_pairs: Vec<SurfacePair>,
    pub(crate) obstacles: Vec<Rigid>,
    /// Traction λ of every point that is there without any penetration, MPa; empty for a plain penalty.
    multipliers: Vec<f64>,
    /// Points nearer than this touch, mm.
    pub(crate) touching: f64,
    /// Stiffness of the body against a pressure on a spot of it, N/mm³: the softest material's shear modulus over the mean spacing of the nodes.
    body_stiffness: f64,
    /// For every degree of freedom (3 · node + axis) whether a support holds it; empty for none.
    pub(crate) held: Vec<bool>,
    pub(crate) overlaps: Vec<Overlap>,
    /// The position on the load path.
    pub(crate) parameter: LoadParameter,
    pub(crate) mesh: Arc<Mesh>,
}

/// An obstacle and the faces that carry its points.
#[derive(Clone, Debug)]
pub(crate) struct Rigid {
    pub(crate) obstacle: Obstacle,
    pub(crate) surface: Surface,
    /// Where it is now, from where it was at rest, mm.
    pub(crate) offset: [f64; 3],
    pub(crate) points: FacePoints,
    pub(crate) first_point: usize,
    /// How deep points may be at requested loads, mm; `None` for any depth.
    pub(crate) tolerance: Option<f64>,
}

impl ContactModel {
    /// Sets up the contact of a problem.
    pub fn of(problem: &Problem) -> Self {
        let moduli = problem.materials().0.into_iter().map(Material::shear_modulus);
        let body_stiffness = moduli.fold(f64::INFINITY, f64::min) / problem.mesh.mean_node_spacing();
        let model = Self::new(Arc::clone(&problem.mesh), &problem.contact_pairs, &problem.contact);
        let model = Self { body_stiffness, held: problem.held_dofs(), ..model };
        model.with_obstacles(&problem.obstacles, &problem.contact).with_overlaps()
    }

    /// Sets up the contact of the given pairs of facets; `contact` is the law of those that have none of their own.
    pub fn new(mesh: impl Into<Arc<Mesh>>, pairs: &[ContactPair], contact: &Contact) -> Self {
        let mesh = mesh.into();
        let mut surface_pairs: Vec<SurfacePair> = Vec::new();
        let mut points = 0;
        for (number, pair) in pairs.iter().enumerate() {
            let of_pair = SurfacePair::all_of(&mesh, number, pair, contact, points);
            points += of_pair.iter().map(SurfacePair::num_points).sum::<usize>();
            surface_pairs.extend(of_pair);
        }
        let touching = TOUCHING * mesh.mean_node_spacing();
        Self {
            surface_pairs,
            obstacles: Vec::new(),
            multipliers: Vec::new(),
            touching,
            body_stiffness: f64::INFINITY,
            held: Vec::new(),
            overlaps: Vec::new(),
            parameter: LoadParameter::default(),
            mesh,
        }
    }

    /// The same with obstacles, at the places where they begin; `contact` says how deep points may be where obstacles do not.
    pub fn with_obstacles(mut self, obstacles: &[Obstacle], contact: &Contact) -> Self {
        for obstacle in obstacles {
            let surface = Surface::new(&self.mesh, &obstacle.facets);
            let points = FacePoints::of(&surface, |kind| kind.contact_rule(), &self.mesh.nodes, 1.0);
            let (first_point, offset) = (self.num_points(), obstacle.offset(LoadParameter::default()));
            let tolerance = obstacle.penetration_tolerance.or(contact.penetration_tolerance);
            let obstacle = obstacle.clone();
            self.obstacles.push(Rigid { obstacle, surface, offset, points, first_point, tolerance });
        }
        self
    }

    /// Distances up to which points stay in contact while Newton's method has not converged, mm, from the traction t (MPa) that the linear
    /// system predicts for each: a point stays where t + c (−d − t/k) > 0.
    ///
    /// This is the primal-dual active set of a penalty k. With c = k a point leaves as soon as its distance is positive; after a correction
    /// that distance is t/k less than what the linear system leaves out, and under a stiff penalty only that decides: points leave and come
    /// back in turn. With c of the order of the body's own stiffness the decision does not depend on k (Hintermüller, Ito & Kunisch 2002,
    /// *SIAM J. Optim.* 13; Wriggers 2006, *Computational Contact Mechanics*, §10.4).
    pub fn kept_distances(&self, tractions: &[f64]) -> Vec<f64> {
        let most = MOST_KEPT * self.mesh.mean_node_spacing();
        let mut kept = vec![0.0; tractions.len()];
        let mut keep = |first: usize, count: usize, stiffness: f64| {
            let is_stiff = stiffness > SOFT * self.body_stiffness;
            let flexibility = if is_stiff { 1.0 / self.body_stiffness - 1.0 / stiffness } else { 0.0 };
            for number in first..first + count {
                kept[number] = (tractions[number] * flexibility).min(most);
            }
        };
        for pair in &self.surface_pairs {
            keep(pair.first_point, pair.num_points(), pair.stiffness);
        }
        for rigid in &self.obstacles {
            keep(rigid.first_point, rigid.points.areas.len(), rigid.obstacle.stiffness);
        }
        kept
    }

    /// Where an obstacle has moved between two positions on the load path, mm.
    pub(crate) fn moved(&self, number: usize, from: LoadParameter, to: LoadParameter) -> [f64; 3] {
        let obstacle = &self.obstacles[number].obstacle;
        let (before, after) = (obstacle.offset(from), obstacle.offset(to));
        std::array::from_fn(|d| after[d] - before[d])
    }

    /// The first obstacle that a point passes through on the straight way between two positions of the nodes, seen from the obstacle, which moves
    /// meanwhile: on the way the point is deep inside, at both ends it is not.
    pub fn passed_through(
        &self,
        [from, to]: [LoadParameter; 2],
        [before, after]: [&[[f64; 3]]; 2],
    ) -> Option<&Obstacle> {
        let passes = |rigid: &&Rigid| {
            let Rigid { obstacle, surface, points, .. } = rigid;
            let deep = DEEP_INSIDE * obstacle.shape.greatest_depth();
            let ends = [(before, obstacle.offset(from)), (after, obstacle.offset(to))];
            deep.is_finite()
                && (0..surface.num_faces()).any(|face| {
                    let kind = surface.kind(face);
                    let nodes = ends.map(|(positions, _)| surface.face_positions(face, positions));
                    points.rule(kind).iter().any(|&(xi, _)| {
                        let shape = shape::evaluate_face(kind, xi);
                        let seen = |end: usize| -> [f64; 3] {
                            let x = face_geometry(&nodes[end][..kind.num_nodes()], &shape).position;
                            std::array::from_fn(|d| x[d] - ends[end].1[d])
                        };
                        let [start, end] = [seen(0), seen(1)];
                        let way = sub(end, start);
                        let depth = |share: f64| {
                            let x = std::array::from_fn(|d| start[d] + share * way[d]);
                            -distance(&obstacle.shape, [0.0; 3], x).value
                        };
                        // Whoever goes less far cannot have been in there and out again.
                        dot(way, way).sqrt() > deep && {
                            let at_ends = depth(0.0).max(depth(1.0)).max(0.0);
                            ON_THE_WAY.iter().any(|&share| depth(share) > deep.max(2.0 * at_ends))
                        }
                    })
                })
        };
        self.obstacles.iter().find(passes).map(|rigid| &rigid.obstacle)
    }

    /// The obstacles that move: number, and motion.
    pub fn motions(&self) -> impl Iterator<Item = (usize, &Motion)> {
        self.obstacles.iter().enumerate().filter_map(|(number, rigid)| Some((number, rigid.obstacle.motion.as_ref()?)))
    }

    /// Moves the obstacles to where they are at a position on the load path, and leaves of overlaps what is left there.
    pub fn set_parameter(&mut self, parameter: LoadParameter) {
        self.parameter = parameter;
        for rigid in &mut self.obstacles {
            rigid.offset = rigid.obstacle.offset(parameter);
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
        &self.mesh.nodes
    }

    /// Surfaces whose points are projected onto others.
    pub fn surface_pairs(&self) -> &[SurfacePair] {
        &self.surface_pairs
    }

    /// The surface pair of the given number.
    pub fn surface_pair(&self, surface_pair: usize) -> &SurfacePair {
        &self.surface_pairs[surface_pair]
    }

    /// Number of slave points of all surface pairs and obstacles; where gaps are averaged, corners are the points.
    pub fn num_points(&self) -> usize {
        match (self.obstacles.last(), self.surface_pairs.last()) {
            (Some(rigid), _) => rigid.first_point + rigid.points.areas.len(),
            (None, Some(surface_pair)) => surface_pair.first_point + surface_pair.num_points(),
            (None, None) => 0,
        }
    }

    /// Penalty stiffness between the faces of a block, N/mm³.
    pub fn stiffness(&self, partner: Partner) -> f64 {
        match partner {
            Partner::Face { surface_pair, .. } => self.surface_pairs[surface_pair].stiffness,
            Partner::Obstacle(number) => self.obstacles[number].obstacle.stiffness,
        }
    }

    /// The corners around which the gaps of a block are averaged, if they are, and the number of the first one among the model's points.
    pub fn averaging(&self, partner: Partner) -> Option<(&Averaging, usize)> {
        match partner {
            Partner::Face { surface_pair, .. } => {
                let SurfacePair { averaging, first_point, .. } = &self.surface_pairs[surface_pair];
                averaging.as_ref().map(|averaging| (averaging, *first_point))
            }
            Partner::Obstacle(_) => None,
        }
    }

    /// Whether gaps between surfaces are averaged anywhere, see [`Self::cut`].
    pub fn is_cut(&self) -> bool {
        self.surface_pairs.iter().any(|pair| pair.averaging.is_some())
    }

    /// How deep every point may be at requested loads, mm; infinite where any depth will do.
    pub fn tolerances(&self) -> Vec<f64> {
        let of_pairs = self.surface_pairs.iter().map(|pair| (pair.num_points(), pair.tolerance));
        let of_obstacles = self.obstacles.iter().map(|rigid| (rigid.points.areas.len(), rigid.tolerance));
        let each = of_pairs.chain(of_obstacles);
        each.flat_map(|(count, tolerance)| std::iter::repeat_n(tolerance.unwrap_or(f64::INFINITY), count)).collect()
    }

    /// The surface that carries the points of a block.
    pub fn slave(&self, partner: Partner) -> &Surface {
        match partner {
            Partner::Face { surface_pair, .. } => &self.surface_pairs[surface_pair].slave,
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

    /// λ/k of a point less what it may still overlap, mm: the distance up to which it is in contact.
    pub(crate) fn shift(&self, number: usize, stiffness: f64) -> f64 {
        let of_multiplier = self.multipliers.get(number).map_or(0.0, |lambda| lambda / stiffness);
        of_multiplier - self.allowed(number, self.parameter)
    }
}
