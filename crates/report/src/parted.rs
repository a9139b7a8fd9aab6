//! The body with a copy of every node of an interface for each region there, so that stresses and stretches, which jump from one material to
//! the next, are those of each: a mean over both would tint the softer one, and hide what the stiffer one carries.

use pneuflex_mesh::Mesh;
use pneuflex_model::Problem;
use pneuflex_post::stress::{self, SymmetricTensor};

use crate::error::ReportError;
use crate::regions::Regions;

/// The parted body; of a single region the body as it is.
#[derive(Clone, Debug)]
pub struct Parted<'a> {
    whole: &'a Problem,
    /// With the copies behind the mesh's own nodes.
    parted: Option<Problem>,
    /// The node of the mesh that each copy is of.
    pub copied: Vec<u32>,
}

impl<'a> Parted<'a> {
    /// Parts a body: a node belongs to the first of its regions, and has copies for the others.
    pub fn new(problem: &'a Problem, regions: &Regions) -> Self {
        let mut parted = Self { whole: problem, parted: None, copied: Vec::new() };
        if !regions.are_many() {
            return parted;
        }
        let mut mesh = Mesh::clone(&problem.mesh);
        // By node: the regions that it has been met in, each with its number there.
        let mut numbers: Vec<Vec<(u16, u32)>> = vec![Vec::new(); mesh.num_nodes()];
        for element in 0..mesh.num_elements() {
            let region = regions.of_element(element as u32);
            for place in mesh.kinds.range(element) {
                let node = mesh.connectivity[place];
                let known = &mut numbers[node as usize];
                mesh.connectivity[place] = match known.iter().find(|(of, _)| *of == region) {
                    Some(&(_, number)) => number,
                    None => {
                        let number = if known.is_empty() { node } else { mesh.nodes.len() as u32 };
                        known.push((region, number));
                        if number != node {
                            mesh.nodes.push(mesh.nodes[node as usize]);
                            parted.copied.push(node);
                        }
                        number
                    }
                };
            }
        }
        parted.parted = Some(Problem { mesh: mesh.into(), ..problem.clone() });
        parted
    }

    /// Its mesh: the nodes of the whole one, followed by the copies.
    pub fn mesh(&self) -> &Mesh {
        &self.parted.as_ref().unwrap_or(self.whole).mesh
    }

    /// Nodes of several regions, and their copies.
    pub fn several(&self) -> impl Iterator<Item = usize> {
        let first = self.whole.mesh.num_nodes();
        self.copied.iter().map(|&node| node as usize).chain(first..first + self.copied.len())
    }

    /// Values at the mesh's nodes, with those of the copies.
    pub fn spread<T: Copy>(&self, values: &[T]) -> Vec<T> {
        values.iter().copied().chain(self.copied.iter().map(|&node| values[node as usize])).collect()
    }

    /// Cauchy stresses, MPa: `nodal` at nodes of one region; at the others the mean over the elements of each region alone.
    ///
    /// # Errors
    /// Displacements from which no stress can be derived.
    pub fn stress(
        &self,
        nodal: &[SymmetricTensor],
        displacement: &[[f64; 3]],
    ) -> Result<Vec<SymmetricTensor>, ReportError> {
        let mut all = self.spread(nodal);
        if let Some(problem) = self.parted.as_ref().filter(|_| !self.copied.is_empty()) {
            let own = stress::recover(problem, &self.spread(displacement))?.at_nodes(problem);
            self.several().for_each(|node| all[node] = own[node]);
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displaced, two_chambers};
    use pneuflex_model::{Formulation, Material, Region};
    use pneuflex_post::stress::von_mises;

    /// Two materials stretched alike: each has its own stress, up to the interface.
    #[test]
    fn each_region_has_its_own_stress_at_an_interface() {
        for formulation in [Formulation::Hex8Sri, Formulation::Hex27] {
            let mut problem = two_chambers(formulation);
            let mesh = problem.mesh.clone();
            let is_low = |element: usize| {
                let nodes = mesh.element(element);
                nodes.iter().map(|&node| mesh.nodes[node as usize][2]).sum::<f64>() < 2.0 * nodes.len() as f64
            };
            let elements: Vec<u32> = (0..mesh.num_elements()).filter(|&e| is_low(e)).map(|e| e as u32).collect();
            assert!(!elements.is_empty() && elements.len() < mesh.num_elements());
            let stiff = Material::yeoh(100.0 * 0.2712, 0.0, 0.0);
            problem.material = Material::yeoh(0.2712, 0.0, 0.0);
            problem.regions = vec![Region { name: "layer".into(), elements, material: stiff }];
            let regions = Regions::of(&problem);
            let parted = Parted::new(&problem, &regions);
            assert!(!parted.copied.is_empty());
            assert_eq!(parted.mesh().num_nodes(), mesh.num_nodes() + parted.copied.len());
            let across = 1.0 / 1.1_f64.sqrt() - 1.0;
            let u = displaced(&problem, |x| [0.1 * x[0], across * x[1], across * x[2]]);
            let nodal = stress::recover(&problem, &u).unwrap().at_nodes(&problem);
            let own = parted.stress(&nodal, &u).unwrap();
            let expected = |shear_modulus: f64| shear_modulus * (1.1_f64.powi(2) - 1.0 / 1.1);
            for element in 0..mesh.num_elements() {
                let is_layer = regions.of_element(element as u32) == 1;
                let expected = expected(if is_layer { 2.0 * 27.12 } else { 2.0 * 0.2712 });
                for &node in parted.mesh().element(element) {
                    let found = von_mises(own[node as usize]);
                    assert!((found - expected).abs() < 1e-6 * expected, "{found} instead of {expected}");
                }
            }
            // The means of the files are none of both.
            let mixed = von_mises(nodal[parted.copied[0] as usize]);
            assert!(mixed > 1.1 * expected(2.0 * 0.2712) && mixed < 0.9 * expected(2.0 * 27.12), "{mixed}");
        }
    }

    #[test]
    fn a_body_of_one_region_stays_as_it_is() {
        let problem = two_chambers(Formulation::Hex8Sri);
        let parted = Parted::new(&problem, &Regions::of(&problem));
        assert_eq!((parted.copied.len(), parted.mesh()), (0, &*problem.mesh));
        let values = vec![1.0; problem.mesh.num_nodes()];
        assert_eq!(parted.spread(&values), values);
    }
}
