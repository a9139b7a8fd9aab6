//! The tangent's pattern has room for everything that is in contact.

use pneuflex_assembly::{ContactForces, Contribution, Position};
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Facet};
use pneuflex_model::{Contact, ContactPair, Formulation, Law, LoadParameter, Problem};

/// Stiff contact keeps points on the way, further apart than what counts as near: a first guess of a curled actuator ended there.
#[test]
fn points_that_are_kept_in_contact_have_room() {
    let gap = 0.05;
    let lattice = Lattice { lines: [vec![0.0, 1.0, 1.0 + gap, 2.0 + gap], vec![0.0, 1.0], vec![0.0, 1.0]] };
    let mesh = lattice.mesh(ElementKind::Hex8, |cell| cell[0] != 1).mesh;
    let wall = |at: f64| -> Vec<Facet> { mesh.select_facets(|x| (x[0] - at).abs() < 1e-9) };
    let pair = ContactPair::new("gap", wall(1.0), wall(1.0 + gap));
    let problem = Problem {
        contact: Contact { stiffness: 1e4, ..Contact::default() },
        contact_pairs: vec![pair],
        ..Problem::body(mesh, Formulation::Hex8Q1p0, Law::NeoHooke { c10: 0.1 }.into())
    };
    let mut contact = ContactForces::of(&problem);
    let at_rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
    let position =
        Position { parameter: LoadParameter::default(), displacement: &at_rest, bordered: &[], is_on_the_way: true };
    contact.set_position(position);
    assert!(contact.touching().is_empty());
    let tractions = vec![10.0; contact.unilateral().unwrap().num_points()];
    contact.mixed().unwrap().restore(&tractions);
    contact.set_position(position);
    assert_eq!(contact.touching().len(), 1, "the points are kept");
    let near = contact.unilateral().unwrap().near_nodes();
    assert!(contact.touching().iter().all(|block| near.contains(&block.nodes)), "{near:?}");
}
