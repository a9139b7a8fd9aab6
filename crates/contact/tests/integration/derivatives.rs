//! Force and tangent of touching faces against finite differences of the energy, in a state that touches.

use crate::support::{check_derivatives, total};
use pneuflex_contact::{ContactModel, Partner};
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Mesh};
use pneuflex_model::{Contact, ContactMethod, ContactPair};

/// Two blocks, 0.2 mm apart, of which the facing sides are then bent and pushed into each other.
fn touching(kind: ElementKind) -> (Mesh, Vec<ContactPair>, Vec<[f64; 3]>) {
    let mut lattice = Lattice::uniform([0.0; 3], [1.0, 2.0, 2.0], [1, 2, 2]);
    lattice.lines[0] = vec![0.0, 1.0, 1.2, 2.2];
    let mesh = lattice.mesh(kind, |cell| cell[0] != 1).mesh;
    let slave = mesh.select_facets(|x| (x[0] - 1.0).abs() < 1e-12);
    let master = mesh.select_facets(|x| (x[0] - 1.2).abs() < 1e-12);
    let positions = mesh
        .nodes
        .iter()
        .map(|x| {
            let bulge = 0.15 * (1.3 * x[1] + 0.4).sin() * (0.9 * x[2] + 0.7).sin();
            let push = if x[0] < 1.1 { 0.16 + bulge } else { -0.08 - 0.6 * bulge };
            [x[0] + push, x[1] + 0.03 * x[0] * x[2] + 0.07 * x[0], x[2] - 0.05 * x[0] * x[1]]
        })
        .collect();
    (mesh, vec![ContactPair::new("gap", slave, master)], positions)
}

#[test]
fn force_and_tangent_are_derivatives_of_the_energy() {
    for kind in ElementKind::ALL {
        for method in [ContactMethod::SinglePoint, ContactMethod::MultiPoint, ContactMethod::Mortar] {
            let (mesh, pairs, positions) = touching(kind);
            let mut model = ContactModel::new(mesh.clone(), &pairs, &Contact { method, ..Contact::default() });
            model.cut(&positions);
            check_derivatives(&model, &positions, &format!("{kind:?} {method:?}"));
        }
    }
}

#[test]
fn the_two_sides_balance_in_force_and_moment() {
    for method in [ContactMethod::SinglePoint, ContactMethod::MultiPoint, ContactMethod::Mortar] {
        let (mesh, pairs, positions) = touching(ElementKind::Hex8);
        let mut model = ContactModel::new(mesh.clone(), &pairs, &Contact { method, ..Contact::default() });
        model.cut(&positions);
        let here = total(&model, &positions);
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (x, f) in positions.iter().zip(here.gradient.chunks_exact(3)) {
            for k in 0..3 {
                let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                force[k] += f[k];
                moment[k] += x[a] * f[b] - x[b] * f[a];
            }
        }
        assert!(force.iter().chain(&moment).all(|sum| sum.abs() < 1e-12), "{method:?}: {force:?} {moment:?}");
    }
}

#[test]
fn near_pairs_cover_every_touching_pair() {
    let (mesh, pairs, positions) = touching(ElementKind::Hex20);
    let model = ContactModel::new(mesh.clone(), &pairs, &Contact::default());
    let near = model.near_face_pairs(&positions);
    let touching = model.search(&positions).blocks;
    assert!(!touching.is_empty());
    assert!(touching.iter().all(|block| near.contains(&block.nodes)));
    assert!(model.search(&mesh.nodes).blocks.is_empty(), "nothing touches at rest");
}

/// Corners couple the nodes of all faces that their averages are over.
#[test]
fn near_nodes_cover_every_average() {
    for kind in ElementKind::ALL {
        let (mesh, pairs, positions) = touching(kind);
        let contact = Contact { method: ContactMethod::Mortar, ..Contact::default() };
        let mut model = ContactModel::new(mesh.clone(), &pairs, &contact);
        model.cut(&positions);
        let near = model.near_face_pairs(&positions);
        let averages = model.search(&positions).averages;
        assert!(averages.len() > 3, "{kind:?}");
        for gap in averages {
            let is_within = |group: &Vec<u32>| gap.nodes.iter().all(|node| group.contains(node));
            assert!(near.iter().any(is_within), "{kind:?}: corner {}", gap.number);
        }
        assert!(model.search(&mesh.nodes).averages.is_empty(), "nothing touches at rest");
    }
}

/// Brute force: the closest foot over all faces, without boxes or order.
#[test]
fn the_search_finds_the_same_points_as_brute_force() {
    use pneuflex_contact::projection::{EDGE_TOLERANCE, EXTENSION, project};
    for kind in [ElementKind::Hex8, ElementKind::Hex27, ElementKind::Tet10, ElementKind::Wedge21] {
        let (mesh, pairs, positions) = touching(kind);
        let model = ContactModel::new(mesh.clone(), &pairs, &Contact::default());
        let (slave, master) = (&model.surface_pair(0).slave, &model.surface_pair(0).master);
        let mut expected = Vec::new();
        for face in 0..slave.num_faces() {
            for (xi, _) in slave.kind(face).contact_rule() {
                let point = slave.geometry(face, xi, &positions).position;
                let foot = |m: usize| {
                    let kind = master.kind(m);
                    project(kind, &master.face_positions(m, &positions)[..kind.num_nodes()], point)
                };
                let best = (0..master.num_faces())
                    .filter_map(|m| Some((m, foot(m)?)))
                    .filter(|(_, foot)| foot.excess <= EXTENSION)
                    .min_by(|(_, a), (_, b)| {
                        let outside = |e: f64| e > EDGE_TOLERANCE;
                        (outside(a.excess).cmp(&outside(b.excess))).then(a.distance.abs().total_cmp(&b.distance.abs()))
                    });
                if let Some((m, foot)) = best.filter(|(_, foot)| foot.distance < 0.0) {
                    expected.push((face, m, xi.map(f64::to_bits), foot.distance));
                }
            }
        }
        let mut found: Vec<_> = model
            .search(&positions)
            .blocks
            .iter()
            .flat_map(|b| {
                let Partner::Face { face, .. } = b.partner else { panic!("no obstacles here") };
                b.points.iter().map(move |p| (b.slave_face, face, p.slave_xi.map(f64::to_bits), p.distance))
            })
            .collect();
        expected.sort_by_key(|a| (a.0, a.2, a.1));
        found.sort_by_key(|a| (a.0, a.2, a.1));
        assert!(found.len() > 10);
        assert_eq!(found, expected, "{kind:?}");
    }
}
