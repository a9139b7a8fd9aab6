//! The contact of a problem: surfaces, obstacles, laws and multipliers.

use std::sync::Arc;

use pneuflex_mesh::Mesh;
use pneuflex_model::{Contact, ContactPair, LoadParameter, Obstacle, Problem};

use crate::contact_block::Partner;
use crate::obstacle::{Distance, distance};
use crate::surface::Surface;
use crate::surface_pair::{SurfacePair, point_areas};

/// Surfaces, obstacles, laws and multipliers of a problem's contact.
#[derive(Clone, Debug)]
pub struct ContactModel {
    pub(crate) surface_pairs: Vec<SurfacePair>,
    pub(crate) obstacles: Vec<Rigid>,
    /// Traction λ of every point that is there without any penetration, MPa; empty for a plain penalty.
    multipliers: Vec<f64>,
    pub(crate) mesh: Arc<Mesh>,
}

/// An obstacle and the faces that carry its points.
#[derive(Clone, Debug)]
pub(crate) struct Rigid {
    pub(crate) obstacle: Obstacle,
    pub(crate) surface: Surface,
    /// Where it is now, from where it was at rest, mm.
    pub(crate) offset: [f64; 3],
    pub(crate) rule: Vec<([f64; 2], f64)>,
    pub(crate) areas: Vec<f64>,
    pub(crate) first_point: usize,
}

impl ContactModel {
    /// Sets up the contact of a problem.
    pub fn of(problem: &Problem) -> Self {
        Self::new(Arc::clone(&problem.mesh), &problem.contact_pairs, &problem.contact)
            .with_obstacles(&problem.obstacles)
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
        Self { surface_pairs, obstacles: Vec::new(), multipliers: Vec::new(), mesh }
    }

    /// The same with obstacles, at the places where they begin.
    pub fn with_obstacles(mut self, obstacles: &[Obstacle]) -> Self {
        for obstacle in obstacles {
            let surface = Surface::new(&self.mesh, &obstacle.facets);
            let rule = surface.kind.contact_rule();
            let areas = point_areas(&surface, &rule, &self.mesh.nodes, 1.0);
            let (first_point, offset) = (self.num_points(), obstacle.offset(LoadParameter::default()));
            self.obstacles.push(Rigid { obstacle: obstacle.clone(), surface, offset, rule, areas, first_point });
        }
        self
    }

    /// Moves the obstacles to where they are at a position on the load path.
    pub fn set_parameter(&mut self, parameter: LoadParameter) {
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

    /// Number of slave points of all surface pairs and obstacles.
    pub fn num_points(&self) -> usize {
        match (self.obstacles.last(), self.surface_pairs.last()) {
            (Some(rigid), _) => rigid.first_point + rigid.areas.len(),
            (None, Some(surface_pair)) => surface_pair.first_point + surface_pair.areas.len(),
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

    /// λ/k of a point, mm.
    pub(crate) fn shift(&self, number: usize, stiffness: f64) -> f64 {
        self.multipliers.get(number).map_or(0.0, |lambda| lambda / stiffness)
    }
}
