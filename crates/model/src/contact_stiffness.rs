//! Penalty stiffness of contact where a file gives none.

use pneuflex_mesh::{Actuator, Facet, Mesh};

use crate::material::Material;
use crate::number::rounded;
use crate::options::Contact;
use crate::range_check::Quantity;

/// Faces of bodies of any shape: this many times the shear modulus over the faces' size.
const OF_FACES: f64 = 100.0;

/// How deep what touches may be at the requested loads of a model file, as a share of the faces' size.
const DEPTH: f64 = 0.005;

impl Contact {
    /// The default contact of an actuator, in a case file and in a model file.
    pub fn of_actuator(material: &Material, actuator: &Actuator) -> Self {
        Self { stiffness: of_actuator(material.shear_modulus(), actuator), ..Self::default() }
    }
}

/// Penalty stiffness of an actuator, N/mm³: the paper's 4 for its material and walls of 1 mm, in proportion to the shear modulus over the
/// thinnest wall's thickness. Walls pressed together by the air then sink into each other by the same share of their thickness. It does not
/// depend on the mesh, and is the same for a half and the whole.
pub(crate) fn of_actuator(shear_modulus: f64, actuator: &Actuator) -> f64 {
    let (paper, wall) = (Contact::default().stiffness, actuator.thinnest_wall());
    let is_one = |quantity: Quantity, value| (quantity.range()[0]..=quantity.range()[1]).contains(&value);
    // What is out of range itself is complained about by itself.
    if !(is_one(Quantity::Stress, 0.5 * shear_modulus) && is_one(Quantity::Length, wall)) {
        return paper;
    }
    let half = 0.5 * Material::default().shear_modulus();
    rounded(paper * (0.5 * shear_modulus) / half / wall)
}

/// Penalty stiffness of faces of any body, N/mm³, by the size of its faces: the mean length of their edges, weighted by their areas, so that
/// it is the same for a half and the whole. `None` for faces without area or stiffness.
pub(crate) fn of_faces(shear_modulus: f64, mesh: &Mesh, facets: &[Facet]) -> Option<f64> {
    let stiffness = rounded(OF_FACES * shear_modulus / mean_size(mesh, facets));
    (stiffness > 0.0 && stiffness.is_finite()).then_some(stiffness)
}

/// How deep faces of any body may be in what they touch, mm. `None` for faces without area.
pub(crate) fn tolerance_of_faces(mesh: &Mesh, facets: &[Facet]) -> Option<f64> {
    let tolerance = rounded(DEPTH * mean_size(mesh, facets));
    (tolerance > 0.0 && tolerance.is_finite()).then_some(tolerance)
}

/// Mean length of faces' edges, weighted by the faces' areas, mm.
fn mean_size(mesh: &Mesh, facets: &[Facet]) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for &facet in facets {
        let weight: f64 = mesh.face_weights(facet).iter().map(|(_, weight)| weight).sum();
        sum += weight * mean_edge(mesh, facet);
        area += weight;
    }
    sum / area
}

/// Mean distance of the corners of a face from the next ones, mm.
fn mean_edge(mesh: &Mesh, facet: Facet) -> f64 {
    let (kind, nodes) = (mesh.face_kind(facet), mesh.facet_nodes(facet));
    let length = |[a, b]: [usize; 2]| {
        let [a, b] = [a, b].map(|i| mesh.nodes[nodes[i] as usize]);
        (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
    };
    kind.edges().map(length).sum::<f64>() / kind.num_corners() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::{ElementKind, MeshSize, Part, build_actuator};

    #[test]
    fn the_papers_material_gives_the_papers_numbers_and_others_scale() {
        assert_eq!(of_actuator(0.5424, &Actuator::full()), 4.0);
        let thick =
            Actuator { top_wall: 2.0.into(), side_wall: 2.0.into(), cavity_length: 4.0.into(), ..Actuator::full() };
        assert_eq!(of_actuator(1.0848, &thick), 4.0);
    }

    #[test]
    fn a_half_and_the_whole_have_the_same_stiffness() {
        let of = |part| {
            let actuator = Actuator { part, ..Actuator::two_chambers() };
            let size = MeshSize { size: [2.0, 3.0, 4.0], ..MeshSize::uniform(1.0) };
            let mesh = build_actuator(&actuator, &size, ElementKind::Hex8).unwrap();
            of_faces(0.5, &mesh, mesh.facet_set("outer")).unwrap()
        };
        assert_eq!(of(Part::Half), of(Part::Whole));
        let mesh = build_actuator(&Actuator::two_chambers(), &MeshSize::uniform(1.0), ElementKind::Hex20).unwrap();
        assert_eq!(of_faces(0.5, &mesh, mesh.facet_set("bottom")), Some(50.0));
        assert_eq!((of_faces(0.5, &mesh, &[]), of_faces(0.0, &mesh, mesh.facet_set("bottom"))), (None, None));
    }
}
