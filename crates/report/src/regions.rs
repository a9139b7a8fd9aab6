//! The parts of the body that have materials of their own.

use pneuflex_model::Problem;

/// What the elements without a region are called.
const REST: &str = "everything else";

/// Parts of one material each; those without elements are left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Regions {
    /// Their names; there is at least one.
    pub names: Vec<String>,
    /// The part of every element; empty if there is but one.
    pub of_element: Vec<u16>,
}

impl Default for Regions {
    /// The whole body as one.
    fn default() -> Self {
        Self { names: vec![REST.to_owned()], of_element: Vec::new() }
    }
}

impl Regions {
    /// Those of a problem.
    pub fn of(problem: &Problem) -> Self {
        let (materials, of_element) = problem.materials();
        let mut used = vec![false; materials.len()];
        of_element.iter().for_each(|&material| used[usize::from(material)] = true);
        let all = std::iter::once(REST).chain(problem.regions.iter().map(|region| &region.name[..]));
        let names: Vec<String> = all.zip(&used).filter(|(_, used)| **used).map(|(name, _)| name.to_owned()).collect();
        match names.len() {
            0 => return Self::default(),
            1 => return Self { names, of_element: Vec::new() },
            _ => {}
        }
        let number = |material: u16| used[..usize::from(material)].iter().filter(|used| **used).count() as u16;
        Self { names, of_element: of_element.into_iter().map(number).collect() }
    }

    /// Whether there is more than one.
    pub fn are_many(&self) -> bool {
        self.names.len() > 1
    }

    /// The part of an element.
    pub fn of_element(&self, element: u32) -> u16 {
        self.of_element.get(element as usize).copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_chambers;
    use pneuflex_model::{Formulation, Region};

    #[test]
    fn parts_without_elements_do_not_count() {
        let mut problem = two_chambers(Formulation::Hex8Sri);
        assert_eq!(Regions::of(&problem), Regions::default());
        let region =
            |name: &str, elements: Vec<u32>| Region { name: name.into(), elements, material: problem.material.clone() };
        let regions = vec![region("none", Vec::new()), region("layer", vec![1, 3])];
        problem.regions = regions;
        let found = Regions::of(&problem);
        assert_eq!(found.names, [REST, "layer"]);
        assert_eq!((0..4).map(|element| found.of_element(element)).collect::<Vec<_>>(), [0, 1, 0, 1]);
        let all = (0..problem.mesh.num_elements() as u32).collect();
        problem.regions = vec![Region { elements: all, ..problem.regions[1].clone() }];
        assert_eq!(Regions::of(&problem), Regions { names: vec!["layer".into()], of_element: Vec::new() });
    }
}
