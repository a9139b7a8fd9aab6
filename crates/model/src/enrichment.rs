//! Bodies that come with elements whose pressures are not stable are given nodes in their faces and inside (theory §10).
//!
//! What a file says of single nodes it says of the functions that its own elements have. So an added node is held, and moved, where all nodes
//! around it are; and where equations or forces act on all nodes of a face of the surface, its added node follows them.

use std::sync::Arc;

use pneuflex_mesh::{AddedNode, Place};

use crate::formulation::Formulation;
use crate::load::{Curve, LinearEquation, Load, Motion};
use crate::problem::{Given, Problem, Support};
use crate::range_check::CaseError;

impl Problem {
    /// The body that a file has, with the formulation that is asked for or, by default, one that is stable: nodes are added for it where
    /// the elements lack them.
    ///
    /// # Errors
    /// A formulation that such elements cannot have; any for elements of several families, which have those that fit together.
    pub fn solved_by(self, wanted: Option<Formulation>) -> Result<Self, CaseError> {
        let Some(kind) = self.mesh.kinds.only() else {
            let Some(formulation) = wanted else { return Ok(self.enriched()) };
            let allowed = format!(
                "must be left out for {}: only hex27, tet15 and wedge21 fit together, and the body has those of its elements",
                self.mesh.words()
            );
            return Err(CaseError { key: "mesh.element".into(), value: format!("{:?}", formulation.name), allowed });
        };
        let is_possible = |f: &Formulation| f.element == kind || Some(f.element) == kind.enriched();
        let Some(formulation) = wanted.or_else(|| Formulation::of_kind(kind.enriched().unwrap_or(kind))) else {
            return Ok(self);
        };
        if !is_possible(&formulation) {
            let names: Vec<&str> = Formulation::ALL.iter().filter(|f| is_possible(f)).map(|f| f.name).collect();
            let allowed = format!("must be {} for {}", names.join(" or "), kind.words());
            return Err(CaseError { key: "mesh.element".into(), value: format!("{:?}", formulation.name), allowed });
        }
        Ok(if formulation.element == kind { Self { formulation, ..self } } else { self.enriched() })
    }

    /// The formulations of its elements, one for each family that it has elements of.
    pub fn formulations(&self) -> impl Iterator<Item = Formulation> + use<> {
        let formulation = self.formulation;
        self.mesh.families().into_iter().map(move |kind| formulation.beside(kind))
    }

    /// Their names, as in `hex27 + wedge21`.
    pub fn element_names(&self) -> String {
        self.formulations().map(|formulation| formulation.name).collect::<Vec<_>>().join(" + ")
    }

    /// The same body with nodes in the faces and inside of its elements, where there is a family with them, and the formulation of that family.
    pub fn enriched(self) -> Self {
        if self.mesh.families().iter().all(|kind| kind.enriched().is_none()) {
            return self;
        }
        let given = Arc::clone(&self.mesh);
        let (mesh, added) = (*given).clone().enriched();
        let Some(formulation) = Formulation::of_mesh(&mesh) else { return self };
        Self { mesh: mesh.into(), formulation, given: Some(Given { mesh: given, added }), ..self }
    }

    /// Added nodes are held along the axes along which all nodes around them are, whichever supports these are of, and move as these and the
    /// shape functions say; unless a support has the added node itself, as those of faces do.
    pub(crate) fn hold_added(&mut self) {
        let Some(enriched) = self.given.take() else { return };
        let given = self.supports.clone();
        let mut holding: Vec<Vec<usize>> = vec![Vec::new(); self.mesh.num_nodes()];
        for (number, support) in given.iter().enumerate() {
            support.nodes.iter().for_each(|&node| holding[node as usize].push(number));
        }
        for AddedNode { node, around, .. } in &enriched.added {
            // Supports of each axis that hold a node around, and whether all are held by some.
            let holders =
                |axis: usize, of: u32| holding[of as usize].iter().copied().filter(|&s| given[s].axes[axis]).collect();
            let held: [Option<Vec<Vec<usize>>>; 3] = std::array::from_fn(|axis| {
                let all: Vec<Vec<usize>> = around.iter().map(|(of, _)| holders(axis, *of)).collect();
                all.iter().all(|holders: &Vec<usize>| !holders.is_empty()).then_some(all)
            });
            // The last support with a motion counts, as in `held_displacement`.
            let motion = |axis: usize, holders: &[usize]| {
                holders.iter().rev().find_map(|&s| given[s].motion.as_ref()).map(|m| (m.displacement[axis], &m.curve))
            };
            let mut is_done: [bool; 3] =
                std::array::from_fn(|axis| holding[*node as usize].iter().any(|&support| given[support].axes[axis]));
            let is_own = is_done;
            for axis in 0..3 {
                let Some(all) = held[axis].as_ref().filter(|_| !is_done[axis]) else { continue };
                let motions: Vec<Option<(f64, &Curve)>> = all.iter().map(|holders| motion(axis, holders)).collect();
                let is_one = motions.iter().all(|other| *other == motions[0]);
                let goes_along = |&s: &usize| {
                    let fits = |k: usize| {
                        !given[s].axes[k]
                            || !is_own[k]
                                && held[k]
                                    .as_ref()
                                    .is_some_and(|all| all.iter().all(|holders| motion(k, holders) == motion(k, &[s])))
                    };
                    (0..3).all(fits)
                };
                if let Some(&support) = all.iter().flatten().find(|s| goes_along(s)).filter(|_| is_one) {
                    self.supports[support].nodes.push(*node);
                    (0..3).filter(|&k| given[support].axes[k]).for_each(|k| is_done[k] = true);
                    continue;
                }
                let name = given[all[0][0]].name.clone();
                let unit = std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
                let terms: Vec<(f64, &Curve)> = around
                    .iter()
                    .zip(&motions)
                    .filter_map(|((_, value), motion)| motion.map(|(u, curve)| (value * u, curve)))
                    .collect();
                let motion = (!terms.is_empty()).then(|| Motion { displacement: unit, curve: Curve::sum(&terms) });
                let axes = std::array::from_fn(|k| k == axis);
                match self.supports[given.len()..]
                    .iter_mut()
                    .find(|s| s.name == name && s.axes == axes && s.motion == motion)
                {
                    Some(support) => support.nodes.push(*node),
                    None => self.supports.push(Support { name, nodes: vec![*node], axes, motion }),
                }
            }
        }
        self.given = Some(enriched);
    }

    /// Where equations act on all nodes around an added node of the surface, or single forces on all nodes in the middle of its edges, it
    /// follows these nodes: what holds for the functions of the elements that the file has is not known for the one that was added.
    pub(crate) fn follow_faces(&mut self) {
        let Some(given) = &self.given else { return };
        let held = self.held_dofs();
        let dof = |node: u32, axis: usize| 3 * node as usize + axis;
        let mut is_tied = vec![false; held.len()];
        let mut is_pushed = vec![false; held.len()];
        for (node, axis, _) in self.equations.iter().flat_map(|equation| &equation.terms) {
            is_tied[dof(*node, usize::from(*axis))] = true;
        }
        for load in &self.loads {
            let Load::Force { nodes, force, .. } = load else { continue };
            for (axis, _) in force.iter().enumerate().filter(|(_, force)| **force != 0.0) {
                nodes.iter().for_each(|(node, _)| is_pushed[dof(*node, axis)] = true);
            }
        }
        let mut equations = Vec::new();
        for AddedNode { node, around, .. } in given.added.iter().filter(|added| added.place == Place::Surface) {
            // As many corners as edges.
            let middles = &around[around.len() / 2..];
            for axis in 0..3 {
                let own = dof(*node, axis);
                if held[own] || is_tied[own] || is_pushed[own] {
                    continue;
                }
                let of = |(node, _): &(u32, f64)| dof(*node, axis);
                let follows =
                    around.iter().any(|n| is_tied[of(n)]) && around.iter().all(|n| is_tied[of(n)] || held[of(n)]);
                if follows || middles.iter().all(|n| is_pushed[of(n)]) {
                    let others = around.iter().map(|&(node, value)| (node, axis as u8, -value));
                    let terms = std::iter::once((*node, axis as u8, 1.0)).chain(others).collect();
                    equations.push(LinearEquation { terms, value: Curve::ZERO });
                }
            }
        }
        self.equations.extend(equations);
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::ElementKind;
    use pneuflex_mesh::lattice::Lattice;

    use super::*;
    use crate::law::Law;
    use crate::quantity::LoadParameter;

    fn block(formulation: Formulation) -> Problem {
        let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [1; 3]).mesh_all(formulation.element_kind());
        Problem::body(mesh, formulation, Law::NeoHooke { c10: 0.1 }.into())
    }

    fn support(problem: &Problem, name: &str, axes: [bool; 3], holds: impl Fn([f64; 3]) -> bool) -> Support {
        Support { name: name.into(), nodes: problem.mesh.select_nodes(holds), axes, motion: None }
    }

    #[test]
    fn added_nodes_are_held_where_all_around_them_are() {
        for formulation in [Formulation::Hex20, Formulation::Tet10] {
            let mut problem = block(formulation);
            let floor = support(&problem, "floor", [true; 3], |x| x[2] == 0.0);
            // As a deck has them: no node is in two supports.
            let side = support(&problem, "side", [false, true, false], |x| x[1] == 0.0 && x[2] > 0.0);
            let all = support(&problem, "all", [true, false, false], |_| true);
            problem.supports = vec![floor, side, all];
            let mut rich = problem.clone().enriched();
            rich.hold_added();
            assert_eq!(Some(rich.formulation.element), formulation.element.enriched());
            let held = rich.held_dofs();
            for (node, x) in rich.mesh.nodes.iter().enumerate() {
                let expected = [true, x[1] == 0.0 || x[2] == 0.0, x[2] == 0.0];
                assert_eq!(held[3 * node..3 * node + 3], expected, "{formulation} {x:?}");
            }
            assert_eq!(rich.supports.len(), 3);
            assert_eq!(rich.given.unwrap().mesh, problem.mesh);
        }
        assert_eq!(block(Formulation::Hex8Q1p0).enriched(), block(Formulation::Hex8Q1p0));
    }

    /// A floor that is held by two supports, one of which has the added nodes of its own part, as surfaces have.
    #[test]
    fn added_nodes_are_held_by_supports_together() {
        for formulation in [Formulation::Hex20, Formulation::Tet10] {
            let mut problem = block(formulation).enriched();
            let given = problem.given.as_ref().unwrap().mesh.num_nodes() as u32;
            let floor = problem.mesh.select_nodes(|x| x[2] == 0.0);
            let (near, far): (Vec<u32>, Vec<u32>) =
                floor.iter().partition(|&&node| problem.mesh.nodes[node as usize][0] < 0.4);
            let of = |nodes: Vec<u32>| Support { name: "floor".into(), nodes, axes: [true; 3], motion: None };
            // The second one knows no added node.
            problem.supports = vec![of(near), of(far.into_iter().filter(|&node| node < given).collect())];
            problem.hold_added();
            let held = problem.held_dofs();
            for node in 0..problem.mesh.num_nodes() {
                let expected = [problem.mesh.nodes[node][2] == 0.0; 3];
                assert_eq!(held[3 * node..3 * node + 3], expected, "{formulation} {node}");
            }
            let count: usize = problem.supports.iter().map(|support| support.nodes.len()).sum();
            assert_eq!(count, floor.len(), "{formulation}: none twice");
        }
    }

    /// x is moved by 2y, node by node, at times of their own.
    #[test]
    fn added_nodes_move_as_the_functions_of_their_face() {
        for formulation in [Formulation::Hex20, Formulation::Tet10] {
            let mut problem = block(formulation);
            for node in problem.mesh.select_nodes(|x| x[2] == 0.0) {
                let y = problem.mesh.nodes[node as usize][1];
                let motion =
                    Motion { displacement: [2.0 * y, 0.0, 0.0], curve: Curve::Table(vec![[0.0, 0.0], [0.5 + y, 1.0]]) };
                let name = "floor".to_owned();
                problem.supports.push(Support { name, nodes: vec![node], axes: [true; 3], motion: Some(motion) });
            }
            let mut rich = problem.enriched();
            rich.hold_added();
            let moved = rich.held_displacement(LoadParameter(2.0));
            for node in rich.mesh.select_nodes(|x| x[2] == 0.0) {
                let y = rich.mesh.nodes[node as usize][1];
                assert!((moved[node as usize][0] - 2.0 * y).abs() < 1e-14, "{formulation} {y}");
            }
            assert!(rich.supports.iter().all(|support| support.name == "floor"));
        }
    }

    #[test]
    fn faces_follow_nodes_that_equations_tie_and_forces_push() {
        let mut problem = block(Formulation::Tet10);
        let roof = problem.mesh.select_nodes(|x| x[2] == 1.0);
        problem.loads = roof
            .iter()
            .map(|&node| Load::Force {
                nodes: vec![(node, 1.0)],
                force: [0.0, 0.0, 1.0],
                curve: Curve::Proportional(1.0),
            })
            .collect();
        let (first, rest) = roof.split_first().unwrap();
        problem.equations = (rest.iter())
            .map(|&node| LinearEquation { terms: vec![(node, 0, 1.0), (*first, 0, -1.0)], value: Curve::ZERO })
            .collect();
        let count = problem.equations.len();
        let mut rich = problem.enriched();
        rich.follow_faces();
        let added: Vec<(u32, u8)> = rich.equations[count..].iter().map(|e| (e.terms[0].0, e.terms[0].1)).collect();
        let centres = rich.mesh.select_nodes(|x| x[2] == 1.0).into_iter().filter(|node| !roof.contains(node));
        assert_eq!(added, centres.flat_map(|node| [(node, 0), (node, 2)]).collect::<Vec<_>>());
        assert_eq!(Some(ElementKind::Tet15), rich.mesh.kinds.only());
    }
}
