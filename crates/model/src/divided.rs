//! A problem on its mesh with every element divided into eight.

use std::collections::BTreeSet;
use std::sync::Arc;

use pneuflex_mesh::{AddedNode, Division, Facet, Place, Torn};

use crate::load::{Cavity, Load};
use crate::obstacle::Obstacle;
use crate::problem::{ContactPair, Given, Problem, Region, Tie};

/// Why a problem cannot be put on a finer mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Undividable {
    /// Its elements do not hold together.
    #[error("{0}")]
    Torn(#[from] Torn),
    /// Equations tie nodes to each other; what holds for the nodes between them is not known.
    #[error("linear equations tie nodes of this mesh, and say nothing of those that a finer one has between them")]
    Equations,
    /// Forces act on nodes; how they are spread over the nodes between them is not known.
    #[error("forces act on nodes of this mesh, and say nothing of those that a finer one has between them")]
    Forces,
    /// So many elements have all of their nodes held, by several supports together: whether what lies between these is held, too, is not known.
    #[error(
        "several supports together hold all nodes of {0} elements, and say nothing of those that a finer mesh has between them"
    )]
    Held(usize),
}

impl Problem {
    /// The same problem with every element divided, and how. Nodes keep their numbers, and those that are added are held, and moved, where all nodes
    /// around them are. What depends on the size of elements, as the stiffness of contact may, stays as it is.
    ///
    /// # Errors
    /// What says nothing of nodes that are added.
    pub fn divided(&self) -> Result<(Self, Division), Undividable> {
        if !(self.equations.is_empty() && self.distances.is_empty()) {
            return Err(Undividable::Equations);
        }
        let held = self.held_between_supports();
        if held > 0 {
            return Err(Undividable::Held(held));
        }
        let division = self.mesh.divided()?;
        let facets = |facets: &[Facet]| division.facets(facets);
        let added =
            division.added().map(|(node, around)| AddedNode { node, place: Place::Element, around: around.to_vec() });
        let given = Some(Given { mesh: Arc::clone(&self.mesh), added: added.collect() });
        let loads = self.loads.iter().map(|load| {
            Ok(match load.clone() {
                Load::Force { .. } => return Err(Undividable::Forces),
                Load::Traction { facets: faces, traction, curve } => {
                    Load::Traction { facets: facets(&faces), traction, curve }
                }
                Load::Pressure { facets: faces, curve } => Load::Pressure { facets: facets(&faces), curve },
                Load::Gravity { elements, acceleration, curve } => {
                    let elements = elements.map(|elements| division.elements(&elements));
                    Load::Gravity { elements, acceleration, curve }
                }
            })
        });
        let mut problem = Self {
            mesh: Arc::new(division.mesh.clone()),
            regions: (self.regions.iter())
                .map(|region| Region { elements: division.elements(&region.elements), ..region.clone() })
                .collect(),
            cavities: (self.cavities.iter())
                .map(|cavity| Cavity { facets: facets(&cavity.facets), ..cavity.clone() })
                .collect(),
            loads: loads.collect::<Result<_, _>>()?,
            ties: (self.ties.iter())
                .map(|tie| Tie { slave: facets(&tie.slave), master: facets(&tie.master), ..tie.clone() })
                .collect(),
            contact_pairs: (self.contact_pairs.iter())
                .map(|pair| ContactPair { slave: facets(&pair.slave), master: facets(&pair.master), ..pair.clone() })
                .collect(),
            obstacles: (self.obstacles.iter())
                .map(|obstacle| Obstacle { facets: facets(&obstacle.facets), ..obstacle.clone() })
                .collect(),
            ..self.clone()
        };
        // Those of the undivided mesh first: nodes may have been added to it.
        let mut whole = self.clone();
        whole.hold_added();
        problem.supports = whole.supports;
        problem.given = given;
        problem.hold_added();
        Ok((problem, division))
    }

    /// Number of elements all of whose nodes are held along all axes, though no support holds them all by itself.
    fn held_between_supports(&self) -> usize {
        let held = self.held_dofs();
        let is_held = |node: &u32| held[3 * *node as usize..3 * *node as usize + 3] == [true; 3];
        let whole: Vec<u32> = (0..self.mesh.num_elements() as u32)
            .filter(|&element| self.mesh.element(element as usize).iter().all(is_held))
            .collect();
        if whole.is_empty() {
            return 0;
        }
        let members = self.supports.iter().filter(|support| support.axes == [true; 3]);
        let members: Vec<BTreeSet<u32>> = members.map(|support| support.nodes.iter().copied().collect()).collect();
        let is_of_one = |element: u32| {
            let nodes = self.mesh.element(element as usize);
            members.iter().any(|support| nodes.iter().all(|node| support.contains(node)))
        };
        whole.into_iter().filter(|&element| !is_of_one(element)).count()
    }
}

impl Problem {
    /// The same with the contact of the problem that it was divided from: its law, stiffnesses and tolerances, which may follow the size of
    /// elements.
    pub fn with_contact_of(self, undivided: &Self) -> Self {
        let pairs = self.contact_pairs.into_iter().zip(&undivided.contact_pairs).map(|(pair, before)| ContactPair {
            stiffness: before.stiffness,
            penetration_tolerance: before.penetration_tolerance,
            ..pair
        });
        let obstacles = self.obstacles.into_iter().zip(&undivided.obstacles).map(|(obstacle, before)| Obstacle {
            stiffness: before.stiffness,
            penetration_tolerance: before.penetration_tolerance,
            ..obstacle
        });
        let (contact_pairs, obstacles) = (pairs.collect(), obstacles.collect());
        Self { contact: undivided.contact.clone(), contact_pairs, obstacles, ..self }
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::testing::angle;
    use pneuflex_mesh::{ElementKind, Mesh};

    use super::*;
    use crate::formulation::Formulation;
    use crate::law::Law;
    use crate::load::{Curve, LinearEquation, Motion};
    use crate::problem::Support;
    use crate::quantity::LoadParameter;

    fn body(mesh: Mesh) -> Problem {
        let formulation = Formulation::of_mesh(&mesh).unwrap();
        Problem::body(mesh, formulation, Law::NeoHooke { c10: 0.1 }.into())
    }

    /// Two supports that hold a floor together, no node twice, and one that is moved by 2y, node by node.
    #[test]
    fn added_nodes_are_held_and_moved_as_those_around_them() {
        let hexahedra = pneuflex_mesh::lattice::Lattice::uniform([0.0; 3], [1.0; 3], [2; 3]);
        for mesh in [angle(1), hexahedra.mesh_all(ElementKind::Hex8), hexahedra.mesh_all(ElementKind::Hex20)] {
            let words = mesh.words();
            let mut problem = body(mesh).enriched();
            let low = 0.5 * problem.mesh.nodes.iter().fold(0.0_f64, |most, x| most.max(x[0]));
            let support =
                |nodes: Vec<u32>| Support { name: "floor".into(), nodes, axes: [false, true, true], motion: None };
            let floor = problem.mesh.select_nodes(|x| x[2] == 0.0);
            let (near, far) = floor.into_iter().partition(|&node| problem.mesh.nodes[node as usize][0] < low);
            problem.supports = vec![support(near), support(far)];
            for node in problem.mesh.select_nodes(|x| x[2] == 0.0) {
                let y = problem.mesh.nodes[node as usize][1];
                let motion = Some(Motion { displacement: [2.0 * y, 0.0, 0.0], curve: Curve::Proportional(1.0) });
                problem.supports.push(Support {
                    name: "m".into(),
                    nodes: vec![node],
                    axes: [true, false, false],
                    motion,
                });
            }
            let twice = problem.divided().unwrap().0.divided().unwrap().0;
            let (held, moved) = (twice.held_dofs(), twice.held_displacement(LoadParameter(0.5)));
            for (node, x) in twice.mesh.nodes.iter().enumerate() {
                assert_eq!(held[3 * node..3 * node + 3], [x[2] == 0.0; 3], "{words} {x:?}");
                let expected = if x[2] == 0.0 { x[1] } else { 0.0 };
                assert!((moved[node][0] - expected).abs() < 1e-14, "{words} {x:?}");
            }
        }
    }

    #[test]
    fn everything_that_names_faces_and_elements_follows() {
        let mesh = angle(1);
        let (wall, roof) = (mesh.select_facets(|x| x[0] == 0.0), mesh.select_facets(|x| x[2] == 3.0));
        let mut problem = body(mesh);
        problem.inflate("air", wall.clone());
        let curve = Curve::Proportional(1.0);
        problem.loads.push(Load::Traction { facets: roof.clone(), traction: [1.0; 3], curve: curve.clone() });
        problem.loads.push(Load::Pressure { facets: wall.clone(), curve: curve.clone() });
        problem.loads.push(Load::Gravity { elements: Some(vec![1]), acceleration: [1.0; 3], curve });
        problem.contact_pairs.push(ContactPair::new("pair", wall.clone(), roof.clone()));
        problem.regions.push(Region { name: "r".into(), elements: vec![0, 2], material: problem.material.clone() });
        let (fine, _) = problem.divided().unwrap();
        let at = |mesh: &Mesh, axis: usize, value: f64| mesh.select_facets(|x| x[axis] == value);
        let sorted = |facets: &[Facet]| {
            let mut facets = facets.to_vec();
            facets.sort_unstable();
            facets
        };
        let (wall, roof) = (at(&fine.mesh, 0, 0.0), at(&fine.mesh, 2, 3.0));
        assert_eq!(sorted(&fine.cavities[0].facets), wall);
        assert_eq!(sorted(&fine.contact_pairs[0].slave), wall);
        assert_eq!(sorted(&fine.contact_pairs[0].master), roof);
        assert!(matches!(&fine.loads[0], Load::Traction { facets, .. } if sorted(facets) == roof));
        assert!(matches!(&fine.loads[1], Load::Pressure { facets, .. } if sorted(facets) == wall));
        assert!(
            matches!(&fine.loads[2], Load::Gravity { elements: Some(elements), .. } if elements[..] == [8, 9, 10, 11, 12, 13, 14, 15])
        );
        let volume = |problem: &Problem| problem.mesh.volume_of(problem.regions[0].elements.iter().copied());
        assert!((volume(&fine) - volume(&problem)).abs() < 1e-13);
    }

    /// One layer between two plates, where nothing tells that what lies between them is free; two layers; a layer that one support holds.
    #[test]
    fn what_lies_between_two_supports_is_not_taken_as_held() {
        let held = |layers: usize, supports: &[[f64; 2]]| {
            let block = pneuflex_mesh::lattice::Lattice::uniform([0.0; 3], [2.0, 2.0, 1.0], [2, 2, layers]);
            let mut problem = body(block.mesh_all(ElementKind::Hex8));
            for &[from, to] in supports {
                let nodes = problem.mesh.select_nodes(|x| from <= x[2] && x[2] <= to);
                problem.supports.push(Support { name: "plate".into(), nodes, axes: [true; 3], motion: None });
            }
            problem.divided().map(|(fine, _)| fine.held_dofs().iter().filter(|held| !**held).count())
        };
        let plates = [[0.0, 0.0], [1.0, 1.0]];
        assert_eq!(held(1, &plates), Err(Undividable::Held(4)));
        assert_eq!(held(2, &plates), Ok(3 * 3 * 25));
        assert_eq!(held(1, &[[0.0, 1.0]]), Ok(0));
    }

    #[test]
    fn what_says_nothing_of_added_nodes_is_refused() {
        let mut problem = body(angle(1));
        problem.equations.push(LinearEquation { terms: vec![(0, 0, 1.0), (1, 0, -1.0)], value: Curve::ZERO });
        assert_eq!(problem.divided().unwrap_err(), Undividable::Equations);
        problem.equations.clear();
        let nodes = vec![(0, 1.0)];
        problem.loads.push(Load::Force { nodes, force: [1.0, 0.0, 0.0], curve: Curve::Proportional(1.0) });
        assert_eq!(problem.divided().unwrap_err(), Undividable::Forces);
    }
}
