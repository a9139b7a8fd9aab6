//! Rigid obstacles: force and tangent against differences of the energy, reactions, multipliers, motion.

use crate::support::{check_derivatives, total};
use pneuflex_contact::{ContactModel, Partner};
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Mesh};
use pneuflex_model::{Contact, Curve, LoadParameter, Motion, Obstacle, Shape};

/// A block of 2 × 2 × 1 mm, bent.
fn block(kind: ElementKind) -> (Mesh, Vec<[f64; 3]>) {
    let mesh = Lattice::uniform([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0], [2, 2, 1]).mesh_all(kind);
    let bent = |&[x, y, z]: &[f64; 3]| [x + 0.05 * z * y, y - 0.04 * x * z, z + 0.1 * x * y - 0.07 * x];
    let positions = mesh.nodes.iter().map(bent).collect();
    (mesh, positions)
}

fn obstacle(mesh: &Mesh, shape: Shape) -> Obstacle {
    let facets = mesh.select_facets(|x| x[2].abs() < 1e-12);
    Obstacle {
        name: "obstacle".into(),
        shape,
        facets,
        stiffness: 3.0,
        motion: None,
        report_force: true,
        penetration_tolerance: None,
        interference_until: None,
    }
}

/// Obstacles that all stand in the way of the block's lower side.
fn shapes() -> [Shape; 6] {
    let tilted = [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]];
    [
        Shape::Plane { point: [0.0, 0.0, 0.03], normal: [0.1, -0.2, 1.0] },
        Shape::Sphere { centre: [0.2, 0.1, -1.5], radius: 1.7, is_hollow: false },
        Shape::Sphere { centre: [0.0, 0.0, 2.0], radius: 2.1, is_hollow: true },
        Shape::Cylinder { point: [0.1, 0.0, -1.0], axis: [1.0, 0.3, 0.1], radius: 1.1, is_hollow: false },
        Shape::Cylinder { point: [0.0, 0.0, 1.4], axis: [0.3, 1.0, 0.0], radius: 1.5, is_hollow: true },
        Shape::Cuboid { centre: [0.4, 0.3, -0.9], size: [1.6, 1.4, 2.0], axes: tilted, edge_radius: 0.5 },
    ]
}

/// Multipliers that keep some open points in contact and leave others as they are.
fn multipliers(model: &ContactModel) -> Vec<f64> {
    (0..model.num_points()).map(|i| 0.1 * (i % 3) as f64).collect()
}

#[test]
fn force_and_tangent_are_derivatives_of_the_energy() {
    for kind in ElementKind::ALL {
        for (shape, with_multipliers) in shapes().into_iter().flat_map(|s| [(s.clone(), false), (s, true)]) {
            let (mesh, positions) = block(kind);
            let mut model = ContactModel::new(mesh.clone(), &[], &Contact::default())
                .with_obstacles(&[obstacle(&mesh, shape.clone())], &Contact::default());
            if with_multipliers {
                model.set_multipliers(multipliers(&model));
                let open =
                    model.search(&positions).blocks.iter().flat_map(|b| &b.points).filter(|p| p.distance > 0.0).count();
                assert!(open > 0, "{kind:?} {shape:?}");
            }
            check_derivatives(&model, &positions, &format!("{kind:?} {shape:?}"));
        }
    }
}

/// A flat face pressed by δ into a plane: k δ A, wherever the plane is moved to.
#[test]
fn a_plane_that_is_moved_presses_with_k_delta() {
    for kind in ElementKind::ALL {
        let (mesh, _) = block(kind);
        let shape = Shape::Plane { point: [0.0, 0.0, -0.5], normal: [0.0, 0.0, 2.0] };
        let motion = Motion { displacement: [0.0, 0.0, 1.0], curve: Curve::Proportional(0.1) };
        let plane = Obstacle { motion: Some(motion), ..obstacle(&mesh, shape) };
        let mut model =
            ContactModel::new(mesh.clone(), &[], &Contact::default()).with_obstacles(&[plane], &Contact::default());
        assert!(model.search(&mesh.nodes).blocks.is_empty());
        model.set_parameter(LoadParameter(4.9));
        assert!(model.search(&mesh.nodes).blocks.is_empty());
        model.set_parameter(LoadParameter(5.2));
        let pressed = total(&model, &mesh.nodes);
        let sum: f64 = pressed.gradient.iter().skip(2).step_by(3).sum();
        assert!((sum + 3.0 * 0.02 * 4.0).abs() < 1e-12, "{kind:?}: {sum}");
        assert!((pressed.energy - 0.5 * 3.0 * 0.02 * 0.02 * 4.0).abs() < 1e-12);
        assert!((model.reference_point(0)[2] - 0.02).abs() < 1e-12);
    }
}

/// Far faces are left out by a bound; every point by itself finds the same.
#[test]
fn every_point_in_an_obstacle_is_found() {
    let kind = ElementKind::Hex27;
    let mesh = Lattice::uniform([-4.0, -3.0, 0.0], [4.0, 3.0, 1.0], [9, 7, 1]).mesh_all(kind);
    let bent = |&[x, y, z]: &[f64; 3]| [x, y, z + 0.1 * (1.7 * x).sin() * (1.1 * y).cos()];
    let positions: Vec<[f64; 3]> = mesh.nodes.iter().map(bent).collect();
    let rule = kind.face_kind(0).contact_rule();
    for shape in shapes() {
        let model = ContactModel::new(mesh.clone(), &[], &Contact::default())
            .with_obstacles(&[obstacle(&mesh, shape.clone())], &Contact::default());
        let surface = model.slave(Partner::Obstacle(0));
        let mut expected = Vec::new();
        for face in 0..surface.num_faces() {
            for &(xi, _) in &rule {
                let values = pneuflex_mesh::shape::evaluate_face(surface.kind(face), xi).values;
                let at =
                    |d: usize| surface.face(face).iter().zip(values).map(|(&n, v)| v * positions[n as usize][d]).sum();
                let distance = model.distance_to_obstacle(0, [at(0), at(1), at(2)]).value;
                if distance < 0.0 {
                    expected.push((face, xi));
                }
            }
        }
        let found: Vec<_> = (model.search(&positions).blocks.iter())
            .flat_map(|b| b.points.iter().map(|p| (b.slave_face, p.slave_xi)).collect::<Vec<_>>())
            .collect();
        assert!(found.len() > 10);
        assert_eq!(found, expected, "{shape:?}");
    }
}
