//! Whether a state that solves the equations is one of a body.

use pneuflex_material::Kinematics;
use pneuflex_mesh::with_num_nodes;
use rayon::prelude::*;

use super::Solid;
use crate::formulation::{displacement_gradient, reference_gradients};
use crate::local::LocalError;

impl Solid {
    /// Looks for an element that is turned inside out at a point of its volumetric rule. The equations take det F there as a change of
    /// volume of any sign, so that Newton's method may converge to such a state; stresses have no meaning in it. The deviatoric points need
    /// no look: their energy is not defined there.
    ///
    /// # Errors
    /// The first such element and point.
    pub(super) fn check_orientation(&self, displacement: &[[f64; 3]]) -> Result<(), LocalError> {
        if self.references.values().all(|reference| reference.shares_points) {
            return Ok(());
        }
        let check =
            |element| with_num_nodes!(self.mesh.kind_of(element), N => self.check_element::<N>(element, displacement));
        let first = (0..self.inverse_mass.len()).into_par_iter().with_min_len(64).find_map_first(check);
        first.map_or(Ok(()), Err)
    }

    fn check_element<const N: usize>(&self, element: usize, displacement: &[[f64; 3]]) -> Option<LocalError> {
        let nodes = self.mesh.element(element);
        let [x, u]: [[[f64; 3]; N]; 2] =
            [&self.mesh.nodes[..], displacement].map(|field| std::array::from_fn(|a| field[nodes[a] as usize]));
        self.reference(element).volumetric.iter().enumerate().find_map(|(index, point)| {
            let (gradients, _) = reference_gradients(&x, point);
            let inverted = Kinematics::new(&displacement_gradient(&u, &gradients)).err()?;
            Some(LocalError { block: element, point: index, jacobian: inverted.0 })
        })
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::lattice::Lattice;
    use pneuflex_mesh::{ElementKind, Mesh};
    use pneuflex_model::{Formulation, Material};

    use super::*;
    use crate::contribution::Contribution;
    use crate::local::{LocalBlock, LocalContribution, Request};

    /// A node in the middle of an edge moves along it: the energy is defined until the deviatoric points turn over, the volumetric ones do
    /// so before.
    #[test]
    fn an_element_that_the_energy_does_not_see_turn_over_is_found() {
        let mesh: Mesh = Lattice::uniform([0.0; 3], [2.0; 3], [1; 3]).mesh_all(ElementKind::Tet10);
        let middle = mesh.element(0)[4] as usize;
        let [from, to] = [0, 1].map(|corner| mesh.nodes[mesh.element(0)[corner] as usize]);
        let solid = Solid::new(mesh, Formulation::Tet10, &Material::default()).unwrap();
        let state = |share: f64| {
            let mut u = vec![[0.0; 3]; solid.mesh.num_nodes()];
            u[middle] = std::array::from_fn(|k| 0.5 * share * (to[k] - from[k]));
            u
        };
        let is_defined = |u: &[[f64; 3]]| {
            (0..solid.num_blocks())
                .all(|block| solid.evaluate(block, u, Request::Energy, &mut LocalBlock::default()).is_ok())
        };
        let last = |holds: &dyn Fn(&[[f64; 3]]) -> bool| {
            (0..200).map(f64::from).map(|k| 0.01 * k).take_while(|&s| holds(&state(s))).last()
        };
        let accepted = last(&|u| solid.check_equilibrium(u).is_ok()).unwrap();
        let defined = last(&is_defined).unwrap();
        assert!(accepted > 0.1 && accepted + 0.05 < defined, "{accepted} {defined}");
        let error = solid.check_equilibrium(&state(0.5 * (accepted + defined))).unwrap_err();
        assert!(error.jacobian <= 0.0, "{error}");
    }
}
