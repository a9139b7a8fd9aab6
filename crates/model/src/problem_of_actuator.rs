//! The problem of an actuator: what its sets mean, its air, and which of its walls may touch.

use std::collections::BTreeSet;
use std::sync::Arc;

use pneuflex_mesh::{Actuator, Facet, GeometryError, Mesh, MeshSize, PerChamber, build_actuator};

use crate::case::Case;
use crate::chosen::Chooser;
use crate::formulation::Formulation;
use crate::load::{Cavity, Control, Curve};
use crate::material::Material;
use crate::options::Contact;
use crate::problem::{ContactPair, Problem, Support};
use crate::quantity::LoadParameter;
use crate::range_check::CaseError;
use crate::symmetry::SymmetryPlane;
use crate::symmetry_check::{ProblemPart, WHOLE_ACTUATOR};
use crate::units::MPA_PER_KPA;

impl Problem {
    /// Meshes the case's actuator: clamped on x = 0, held in y on the symmetry plane of a half model.
    ///
    /// The slave of every gap is its left wall, the outer wall of the chamber nearer to the clamp **(our reading: the
    /// paper does not say which wall is the slave)**.
    ///
    /// # Errors
    /// A value out of range, see [`Case::validate`].
    pub fn from_case(case: &Case) -> Result<Self, CaseError> {
        Self::from_case_on(case, &case.mesh.mesh_size(&case.actuator))
    }

    /// The same on a mesh of another size than the case's.
    ///
    /// # Errors
    /// As there.
    pub fn from_case_on(case: &Case, size: &MeshSize) -> Result<Self, CaseError> {
        case.validate()?;
        Self::from_case_with(case, build_actuator(&case.actuator, size, case.mesh.formulation().element_kind())?)
    }

    /// The same on a mesh that is there, with the sets of [`build_actuator`].
    ///
    /// # Errors
    /// As there.
    pub fn from_case_with(case: &Case, mesh: Mesh) -> Result<Self, CaseError> {
        case.validate()?;
        let (formulation, material, contact) = (case.mesh.formulation(), case.material.clone(), case.contact.clone());
        let problem = Self::of_actuator_mesh(case.actuator.chambers, mesh, formulation, material, contact);
        let mut problem = match &case.load.chamber_factor {
            None => problem.with_one_air(),
            Some(factor) => problem.with_air_of_chambers(factor),
        };
        let first = LoadParameter(case.load.pressure_kpa.first().copied().unwrap_or_default());
        let chooser = Chooser::new(Arc::clone(&problem.mesh));
        for (number, table) in case.obstacles.iter().enumerate() {
            let faces = table.faces.clone().unwrap_or_else(|| "outer".into());
            let facets = chooser.facets(&faces).map_err(|why| CaseError {
                key: format!("obstacle[{number}].faces"),
                value: faces.to_string(),
                allowed: why.to_string(),
            })?;
            problem.obstacles.extend(table.obstacle(facets, case.contact.stiffness, None, first));
        }
        for asymmetry in problem.asymmetries() {
            // Nothing else of a case file can break its plane of symmetry.
            if let (false, ProblemPart::Obstacle(number)) = (asymmetry.is_twofold, asymmetry.part) {
                let (name, at) = case.obstacles[number].position();
                return Err(asymmetry.refusal(format!("obstacle[{number}].{name}"), format!("{at:?}"), WHOLE_ACTUATOR));
            }
        }
        Ok(problem)
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
    ) -> Result<Self, GeometryError> {
        let mesh = build_actuator(actuator, size, formulation.element_kind())?;
        Ok(Self::of_actuator_mesh(actuator.chambers, mesh, formulation, material, contact).with_one_air())
    }

    /// The same from the mesh of an actuator with a number of chambers, and without air.
    pub fn of_actuator_mesh(
        chambers: usize,
        mesh: Mesh,
        formulation: Formulation,
        material: Material,
        contact: Contact,
    ) -> Self {
        let support = |name: &str, axes| {
            let nodes = mesh.node_set(name).to_vec();
            Support { name: name.into(), nodes, axes, motion: None }
        };
        let (mut supports, mut symmetry) = (vec![support("clamp", [true; 3])], Vec::new());
        if !mesh.node_set("symmetry").is_empty() {
            symmetry.push(SymmetryPlane { axis: 1, at: 0.0, support: supports.len() });
            supports.push(support("symmetry", [false, true, false]));
        }
        let mut contact_pairs: Vec<ContactPair> = (1..chambers)
            .map(|i| {
                let [left, right] = ["left", "right"].map(|side| mesh.facet_set(&format!("gap_{i}_{side}")).to_vec());
                (i, left, right)
            })
            // Chambers without a gap share a wall.
            .filter(|(_, left, right)| !(left.is_empty() && right.is_empty()))
            .map(|(i, left, right)| ContactPair {
                is_two_pass: contact.two_pass,
                ..ContactPair::new(format!("gap_{i}"), left, right)
            })
            .collect();
        if contact.self_contact {
            contact_pairs.push(outer_surface(&mesh, &contact_pairs));
        }
        Self { supports, symmetry, contact, contact_pairs, ..Self::body(mesh, formulation, material) }
    }

    /// The same with one air in all chambers, whose pressure in kPa is the load parameter.
    fn with_one_air(mut self) -> Self {
        let cavity = self.mesh.facet_set("cavity").to_vec();
        self.inflate("cavity", cavity);
        self
    }

    /// The same with air of its own in every chamber, whose pressure is that many times the load parameter.
    fn with_air_of_chambers(mut self, factor: &PerChamber) -> Self {
        let chambers: Vec<(String, Vec<Facet>)> = (1..)
            .map(|i| format!("cavity_{i}"))
            .map_while(|name| self.mesh.facet_sets.get(&name).cloned().map(|facets| (name, facets)))
            .collect();
        self.cavities.extend(chambers.into_iter().enumerate().map(|(i, (name, facets))| {
            let control = Control::Pressure(Curve::Proportional(factor.at(i) * MPA_PER_KPA));
            Cavity { name, facets, control }
        }));
        self
    }
}

/// An actuator's outer surface against itself, without the walls of the gaps: these face each other, and nothing else gets between them.
fn outer_surface(mesh: &Mesh, gaps: &[ContactPair]) -> ContactPair {
    let walls: BTreeSet<Facet> = gaps.iter().flat_map(|gap| gap.slave.iter().chain(&gap.master)).copied().collect();
    let outer: Vec<Facet> = mesh.facet_set("outer").iter().filter(|facet| !walls.contains(facet)).copied().collect();
    ContactPair::new("outer", outer.clone(), outer)
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

    #[test]
    fn pairs_keep_the_numbers_of_their_gaps() {
        let numbers = |gap: PerChamber, self_contact| {
            let actuator = Actuator { chambers: 4, gap, ..Actuator::two_chambers() };
            let contact = Contact { self_contact, ..Contact::default() };
            let size = MeshSize::uniform(4.0);
            let problem =
                Problem::from_actuator(&actuator, &size, Formulation::Hex8Sri, Material::default(), contact).unwrap();
            let names: Vec<String> = problem.contact_pairs.iter().map(|pair| pair.name.clone()).collect();
            (names.join(" "), problem.numbers_of_pairs())
        };
        assert_eq!(numbers(2.0.into(), true), ("gap_1 gap_2 gap_3 outer".into(), vec![1, 2, 3, 4]));
        assert_eq!(numbers([0.0, 2.0, 1.0].into(), true), ("gap_2 gap_3 outer".into(), vec![2, 3, 4]));
        assert_eq!(numbers([2.0, 0.0, 0.0].into(), false), ("gap_1".into(), vec![1]));
    }
}
