//! What a solver needs, as plain data.

use pneuflex_mesh::{Actuator, Facet, Mesh, MeshSize, build_actuator};

use crate::case::{Case, CaseError, Contact, Formulation, Material};

/// A boundary-value problem: body, material, supports, loaded faces, facing walls.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The body.
    pub mesh: Mesh,
    /// How the volumetric energy of its elements is treated.
    pub formulation: Formulation,
    /// Material of all elements.
    pub material: Material,
    /// Held degrees of freedom.
    pub supports: Vec<Support>,
    /// Faces that feel the air pressure.
    pub pressure_facets: Vec<Facet>,
    /// Contact law.
    pub contact: Contact,
    /// Surfaces that may touch.
    pub contact_pairs: Vec<ContactPair>,
}

/// Nodes whose displacement along some axes is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    /// Name in reports.
    pub name: String,
    /// Held nodes.
    pub nodes: Vec<u32>,
    /// Held axes x, y, z.
    pub axes: [bool; 3],
}

/// Two facing surfaces. Points of the slave are kept from passing through the master.
///
/// For single-point contact the facets correspond one to one, in the order of the lists.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPair {
    /// Name in reports.
    pub name: String,
    /// Facets that carry the contact points.
    pub slave: Vec<Facet>,
    /// Facets onto which the points are projected.
    pub master: Vec<Facet>,
}

impl Problem {
    /// Meshes the case's actuator: clamped on x = 0, held in y on the symmetry plane of a half model.
    ///
    /// The slave of every gap is its left wall, the outer wall of the chamber nearer to the clamp **(our reading: the
    /// paper does not say which wall is the slave)**.
    ///
    /// # Errors
    /// A value out of range, see [`Case::validate`].
    pub fn from_case(case: &Case) -> Result<Self, CaseError> {
        case.validate()?;
        Ok(Self::from_actuator(
            &case.actuator,
            &case.mesh.mesh_size(&case.actuator),
            case.mesh.formulation(),
            case.material.clone(),
            case.contact.clone(),
        )?)
    }

    /// The same from its parts, without a case file.
    ///
    /// # Errors
    /// A length out of range, see [`Actuator::validate`].
    pub fn from_actuator(
        actuator: &Actuator,
        size: &MeshSize,
        formulation: Formulation,
        material: Material,
        contact: Contact,
    ) -> Result<Self, pneuflex_mesh::GeometryError> {
        let mesh = build_actuator(actuator, size, formulation.element_kind())?;
        let support = |name: &str, axes| Support { name: name.into(), nodes: mesh.node_set(name).to_vec(), axes };
        let mut supports = vec![support("clamp", [true; 3])];
        if !mesh.node_set("symmetry").is_empty() {
            supports.push(support("symmetry", [false, true, false]));
        }
        let contact_pairs = (1..actuator.chambers)
            .map(|i| ContactPair {
                name: format!("gap_{i}"),
                slave: mesh.facet_set(&format!("gap_{i}_left")).to_vec(),
                master: mesh.facet_set(&format!("gap_{i}_right")).to_vec(),
            })
            .collect();
        let pressure_facets = mesh.facet_set("cavity").to_vec();
        Ok(Self { mesh, formulation, material, supports, pressure_facets, contact, contact_pairs })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_of_a_gap_correspond_face_by_face() {
        let problem = Problem::from_actuator(
            &Actuator::full(),
            &MeshSize::uniform(1.0),
            Formulation::Hex8Sri,
            Material::default(),
            Contact::default(),
        )
        .unwrap();
        assert_eq!(problem.contact_pairs.len(), 7);
        for pair in &problem.contact_pairs {
            for (&slave, &master) in pair.slave.iter().zip(&pair.master) {
                let centre = |facet| -> [f64; 3] {
                    let nodes = problem.mesh.facet_nodes(facet);
                    std::array::from_fn(|d| nodes.iter().map(|&n| problem.mesh.nodes[n as usize][d]).sum::<f64>() / 4.0)
                };
                let (s, m) = (centre(slave), centre(master));
                assert!((s[1] - m[1]).abs() + (s[2] - m[2]).abs() < 1e-12 && (m[0] - s[0] - 2.0).abs() < 1e-12);
            }
        }
        // 83 × 11 × 5 nodes of the base and so on: about the paper-scale model of the design.
        assert!((24_000..28_000).contains(&problem.num_unknowns()), "{}", problem.num_unknowns());
    }
}
