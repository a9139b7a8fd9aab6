//! What a solver needs, as plain data.

use std::collections::BTreeSet;
use std::sync::Arc;

use pneuflex_mesh::{AddedNode, Facet, Mesh};

use crate::formulation::Formulation;
use crate::load::{Cavity, Control, Curve, LinearEquation, Load, Motion};
use crate::material::Material;
use crate::obstacle::Obstacle;
use crate::options::{Contact, ContactMethod};
use crate::quantity::LoadParameter;
use crate::symmetry::SymmetryPlane;
use crate::units::MPA_PER_KPA;

/// A boundary-value problem: body, materials, supports, loads, facing walls.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The body; shared with everything that is set up from the problem.
    pub mesh: Arc<Mesh>,
    /// How the volumetric energy of its elements is treated.
    pub formulation: Formulation,
    /// Material of all elements that belong to no region.
    pub material: Material,
    /// Elements with materials of their own. No element belongs to two of them.
    pub regions: Vec<Region>,
    /// Held degrees of freedom.
    pub supports: Vec<Support>,
    /// Linear equations between displacements.
    pub equations: Vec<LinearEquation>,
    /// Pairs of nodes whose distance stays what it is at rest, whatever their displacements. With linear equations they make rigid bodies.
    pub distances: Vec<[u32; 2]>,
    /// Surfaces that are glued to each other. A solver is given the equations that they stand for.
    pub ties: Vec<Tie>,
    /// Spaces filled with air.
    pub cavities: Vec<Cavity>,
    /// Other loads.
    pub loads: Vec<Load>,
    /// Contact law of all pairs that have none of their own.
    pub contact: Contact,
    /// Surfaces that may touch.
    pub contact_pairs: Vec<ContactPair>,
    /// Rigid bodies that may be touched.
    pub obstacles: Vec<Obstacle>,
    /// Planes of symmetry at which it is cut; what lies beyond is the mirror image.
    pub symmetry: Vec<SymmetryPlane>,
    /// What the load parameter counts.
    pub clock: Clock,
    /// The mesh as it came, if nodes were added to it, and these.
    pub given: Option<Given>,
}

/// A mesh before nodes were added to it ([`Problem::enriched`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// The mesh, whose nodes are the first.
    pub mesh: Arc<Mesh>,
    /// The added nodes.
    pub added: Vec<AddedNode>,
}

/// What the parameter of a load path counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// The air pressure in kPa.
    #[default]
    Pressure,
    /// Steps of a schedule.
    Steps,
}

impl Clock {
    /// A position on the load path in words, e.g. `35 kPa`.
    pub fn words(self, LoadParameter(time): LoadParameter) -> String {
        let digits = |count: usize| {
            let text = format!("{time:.count$}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        match self {
            Self::Pressure => format!("{} kPa", digits(4)),
            Self::Steps => format!("time {}", digits(6)),
        }
    }
}

/// A cavity whose volume is not defined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the volume of cavity {cavity} is not defined: its walls must be closed, or end in planes of symmetry (x, y or z = const, at most one \
     of them y = const) in which they are held; they are open near ({:.4}, {:.4}, {:.4})", .near[0], .near[1], .near[2]
)]
pub struct OpenCavity {
    /// Name of the cavity.
    pub cavity: String,
    /// A point of the rim, mm.
    pub near: [f64; 3],
}

/// Elements of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Name in reports.
    pub name: String,
    /// Its elements.
    pub elements: Vec<u32>,
    /// Their material.
    pub material: Material,
}

/// Nodes whose displacement along some axes is held, or prescribed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Support {
    /// Name in reports.
    pub name: String,
    /// Held nodes.
    pub nodes: Vec<u32>,
    /// Held axes x, y, z.
    pub axes: [bool; 3],
    /// How they are moved; `None` if they stay in place.
    pub motion: Option<Motion>,
}

/// Two surfaces that are glued to each other, whether or not their faces match.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tie {
    /// Name in reports.
    pub name: String,
    /// Faces whose nodes follow.
    pub slave: Vec<Facet>,
    /// Faces that they follow.
    pub master: Vec<Facet>,
    /// Parts of the slave further than this from the master are not glued, mm; `None` for a tenth of its faces' size.
    pub tolerance: Option<f64>,
}

/// Two surfaces that may touch, or one that may touch itself if both lists are the same. Points of the slave are kept from passing
/// through the master.
///
/// For single-point contact the facets correspond one to one, in the order of the lists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactPair {
    /// Name in reports.
    pub name: String,
    /// Facets that carry the contact points.
    pub slave: Vec<Facet>,
    /// Facets onto which the points are projected.
    pub master: Vec<Facet>,
    /// Where contact is looked for; `None` for the problem's method.
    pub method: Option<ContactMethod>,
    /// Penalty stiffness k, N/mm³; `None` for the problem's.
    pub stiffness: Option<f64>,
    /// Whether each surface is the slave in turn, with half the weight each.
    pub is_two_pass: bool,
    /// Largest depth at requested loads, mm; `None` for the problem's.
    pub penetration_tolerance: Option<f64>,
    /// Position on the load path by which the surfaces have been pressed out of each other where they overlap at rest, evenly from rest on;
    /// `None` if they must not overlap.
    pub interference_until: Option<LoadParameter>,
}

impl ContactPair {
    /// A pair with the problem's law, the slave's points only.
    pub fn new(name: impl Into<String>, slave: Vec<Facet>, master: Vec<Facet>) -> Self {
        Self { name: name.into(), slave, master, ..Self::default() }
    }

    /// Whether the surface is to be kept from passing through itself.
    pub fn is_self(&self) -> bool {
        self.slave == self.master
    }

    /// Whether the surfaces have nodes in common: then they are one that may touch itself.
    pub fn is_of_one_surface(&self, mesh: &Mesh) -> bool {
        let nodes = |facets: &[Facet]| facets.iter().flat_map(|&f| mesh.facet_nodes(f)).collect::<BTreeSet<u32>>();
        !nodes(&self.slave).is_disjoint(&nodes(&self.master))
    }
}

impl Problem {
    /// A free body without loads and contact.
    pub fn body(mesh: impl Into<Arc<Mesh>>, formulation: Formulation, material: Material) -> Self {
        Self {
            mesh: mesh.into(),
            formulation,
            material,
            regions: Vec::new(),
            supports: Vec::new(),
            equations: Vec::new(),
            distances: Vec::new(),
            ties: Vec::new(),
            cavities: Vec::new(),
            loads: Vec::new(),
            contact: Contact { method: ContactMethod::None, ..Contact::default() },
            contact_pairs: Vec::new(),
            obstacles: Vec::new(),
            symmetry: Vec::new(),
            clock: Clock::Pressure,
            given: None,
        }
    }

    /// Adds a cavity whose pressure in kPa is the time.
    pub fn inflate(&mut self, name: &str, facets: Vec<Facet>) {
        let control = Control::Pressure(Curve::Proportional(MPA_PER_KPA));
        self.cavities.push(Cavity { name: name.into(), facets, control });
    }

    /// Whether there is one air, whose pressure in kPa is the load parameter.
    pub fn has_one_air(&self) -> bool {
        let is_parameter = |cavity: &Cavity| cavity.control == Control::Pressure(Curve::Proportional(MPA_PER_KPA));
        matches!(&self.cavities[..], [cavity] if is_parameter(cavity))
    }

    /// Numbers of the contact pairs: those of gaps `gap_1`, `gap_2`, … are the gaps' own, also where chambers without a gap between them have
    /// none; the others count on.
    pub fn numbers_of_pairs(&self) -> Vec<usize> {
        let mut last = 0;
        let number = |pair: &ContactPair| {
            let of_gap = pair.name.strip_prefix("gap_").and_then(|number| number.parse().ok());
            last = of_gap.filter(|number| *number > last).unwrap_or(last + 1);
            last
        };
        self.contact_pairs.iter().map(number).collect()
    }

    /// Materials, that of the elements without region first, and for every element the index of its own.
    pub fn materials(&self) -> (Vec<&Material>, Vec<u16>) {
        let mut of_element = vec![0; self.mesh.num_elements()];
        for (number, region) in self.regions.iter().enumerate() {
            for &element in &region.elements {
                of_element[element as usize] = number as u16 + 1;
            }
        }
        let materials = std::iter::once(&self.material).chain(self.regions.iter().map(|region| &region.material));
        (materials.collect(), of_element)
    }

    /// Displacements that the supports prescribe at a position on the load path, mm; 0 at free degrees of freedom.
    pub fn held_displacement(&self, parameter: LoadParameter) -> Vec<[f64; 3]> {
        let mut displacement = vec![[0.0; 3]; self.mesh.num_nodes()];
        for support in &self.supports {
            let Some(motion) = &support.motion else { continue };
            let factor = motion.curve.at(parameter);
            for &node in &support.nodes {
                for axis in (0..3).filter(|&axis| support.axes[axis]) {
                    displacement[node as usize][axis] = factor * motion.displacement[axis];
                }
            }
        }
        displacement
    }

    /// Coordinate y of the plane of symmetry y = const that cuts a cavity, mm; 0 if there is none. What the cavity lacks to be closed must
    /// lie in planes normal to an axis in which the nodes of its rim are held along that axis.
    ///
    /// # Errors
    /// [`OpenCavity`] if it is not closed in this sense, or cut by two planes y = const.
    pub fn cavity_plane(&self, cavity: &Cavity) -> Result<f64, OpenCavity> {
        let held = self.held_dofs();
        let mut plane_y: Option<f64> = None;
        for edge in self.mesh.rim(&cavity.facets) {
            let (a, b) = (edge[0], edge[1]);
            let open = || OpenCavity { cavity: cavity.name.clone(), near: self.mesh.nodes[a as usize] };
            let [xa, xb] = [a, b].map(|node| self.mesh.nodes[node as usize]);
            let lies_in = |axis: usize| {
                let is_flat = (xa[axis] - xb[axis]).abs() < 1e-9 * (1.0 + xa[axis].abs());
                is_flat && [a, b].iter().all(|&node| held[3 * node as usize + axis])
            };
            if lies_in(0) || lies_in(2) {
                continue;
            }
            let is_same = |y: f64| (y - xa[1]).abs() < 1e-9 * (1.0 + y.abs());
            if !lies_in(1) || plane_y.is_some_and(|y| !is_same(y)) {
                return Err(open());
            }
            plane_y = Some(xa[1]);
        }
        Ok(plane_y.unwrap_or(0.0))
    }

    /// Walls of all cavities, one cavity after the other.
    pub fn cavity_facets(&self) -> Vec<Facet> {
        self.cavities.iter().flat_map(|cavity| cavity.facets.iter().copied()).collect()
    }

    /// Number of degrees of freedom, three per node, held ones included.
    pub fn num_dofs(&self) -> usize {
        3 * self.mesh.num_nodes()
    }

    /// For every degree of freedom (3 · node + axis) whether it is held.
    pub fn held_dofs(&self) -> Vec<bool> {
        let mut held = vec![false; self.num_dofs()];
        for support in &self.supports {
            for &node in &support.nodes {
                for axis in 0..3 {
                    held[3 * node as usize + axis] |= support.axes[axis];
                }
            }
        }
        held
    }

    /// Number of unknown displacements.
    pub fn num_unknowns(&self) -> usize {
        self.held_dofs().iter().filter(|held| !**held).count()
    }
}
