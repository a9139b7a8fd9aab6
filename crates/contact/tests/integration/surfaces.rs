//! Surfaces that touch themselves, and surfaces that are slave and master in turn.

use std::f64::consts::PI;

use crate::support::{check_derivatives, total};
use pneuflex_contact::{ContactBlock, ContactModel, Partner, brute_force};
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Mesh};
use pneuflex_model::{Contact, ContactPair};

fn self_pair(mesh: &Mesh) -> ContactPair {
    ContactPair::new("itself", mesh.boundary_facets(), mesh.boundary_facets())
}

fn model(mesh: &Mesh, pair: ContactPair) -> ContactModel {
    ContactModel::new(mesh.clone(), &[pair], &Contact::default())
}

fn moved(mesh: &Mesh, map: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    mesh.nodes.iter().map(|&x| map(x)).collect()
}

/// A block of 4 × 1 × 3 mm with a slit of 0.5 mm from x = 2 to its end.
fn slit(kind: ElementKind) -> Mesh {
    let mut lattice = Lattice::uniform([0.0; 3], [4.0, 1.0, 3.0], [4, 1, 3]);
    lattice.lines[2] = vec![0.0, 1.25, 1.75, 3.0];
    lattice.mesh(kind, |cell| !(cell[0] >= 2 && cell[2] == 1)).mesh
}

/// Closes the slit beyond x = 3 by moving its upper lip down.
fn closed(mesh: &Mesh) -> Vec<[f64; 3]> {
    moved(mesh, |[x, y, z]| {
        let down = if z >= 1.75 && x > 2.0 { 0.35 * (x - 2.0) + 0.03 * (2.1 * y + x).sin() } else { 0.0 };
        [x + 0.02 * y * z, y + 0.01 * x, z - down + 0.01 * x * y]
    })
}

#[test]
fn a_closing_slit_touches_itself_as_its_two_sides_do_in_turn() {
    for kind in ElementKind::ALL {
        let mesh = slit(kind);
        let itself = model(&mesh, self_pair(&mesh));
        assert!(itself.search(&mesh.nodes).blocks.is_empty(), "nothing touches at rest");
        let positions = closed(&mesh);
        let lip = |z: f64| mesh.select_facets(|x| (x[2] - z).abs() < 1e-9 && x[0] > 1.9);
        let in_turn = ContactPair { is_two_pass: true, ..ContactPair::new("lips", lip(1.25), lip(1.75)) };
        let [found, expected] = [itself.clone(), model(&mesh, in_turn)].map(|model| total(&model, &positions));
        assert!(expected.energy > 1e-3, "{}", expected.energy);
        assert!((found.energy / expected.energy - 1.0).abs() < 1e-12, "{kind:?}");
        for (a, b) in found.gradient.iter().zip(&expected.gradient) {
            assert!((a - b).abs() < 1e-12, "{kind:?}");
        }
        if kind == ElementKind::Hex8 {
            check_derivatives(&itself, &positions, &format!("{kind:?}"));
        }
    }
}

/// A flat face pressed by δ into another carries k δ A, whoever is the slave.
#[test]
fn two_passes_share_the_stiffness() {
    for kind in ElementKind::ALL {
        let mut lattice = Lattice::uniform([0.0; 3], [1.0, 2.0, 2.0], [1, 2, 2]);
        lattice.lines[0] = vec![0.0, 1.0, 1.2, 2.2];
        let mesh = lattice.mesh(kind, |cell| cell[0] != 1).mesh;
        let side = |at: f64| mesh.select_facets(|x| (x[0] - at).abs() < 1e-12);
        let single = ContactPair { stiffness: Some(3.0), ..ContactPair::new("gap", side(1.0), side(1.2)) };
        let double = ContactPair { is_two_pass: true, ..single.clone() };
        let pressed = moved(&mesh, |[x, y, z]| [if x < 1.1 { x + 0.25 } else { x }, y, z]);
        for pair in [single, double.clone()] {
            let model = model(&mesh, pair);
            let here = total(&model, &pressed);
            assert!((here.energy - 0.5 * 3.0 * 0.05 * 0.05 * 4.0).abs() < 1e-12);
            let on_slave: f64 =
                mesh.nodes.iter().zip(here.gradient.chunks(3)).filter(|(x, _)| x[0] < 1.1).map(|(_, g)| g[0]).sum();
            assert!((on_slave - 3.0 * 0.05 * 4.0).abs() < 1e-12, "{kind:?}: {on_slave}");
            let area: f64 = model.search(&pressed).blocks.iter().flat_map(|b| &b.points).map(|p| p.area).sum();
            assert!((area - 4.0).abs() < 1e-12);
        }
        // The same whichever is named first.
        let swapped = ContactPair { slave: double.master.clone(), master: double.slave.clone(), ..double.clone() };
        let bent = moved(&mesh, |[x, y, z]| {
            let bulge = 0.1 * (1.3 * y + 0.4).sin() * (0.9 * z + 0.7).sin();
            [x + if x < 1.1 { 0.16 + bulge } else { -0.6 * bulge }, y + 0.05 * x, z]
        });
        let [a, b] = [double, swapped].map(|pair| total(&model(&mesh, pair), &bent));
        assert!(a.energy > 1e-3 && (a.energy / b.energy - 1.0).abs() < 1e-12);
        assert!(a.gradient.iter().zip(&b.gradient).all(|(a, b)| (a - b).abs() < 1e-12), "{kind:?}");
    }
}

/// A strip along x, 1 mm thick.
fn strip(kind: ElementKind, length: f64, cells: usize, thickness: f64) -> Mesh {
    Lattice::uniform([0.0, 0.0, -0.5 * thickness], [length, 2.0, 0.5 * thickness], [cells, 2, 1]).mesh_all(kind)
}

/// Folded by more than half a turn, so that its legs cross: every point of the inner side beyond the other leg's inner side is found,
/// with its distance from that plane.
#[test]
fn the_legs_of_a_folded_strip_touch() {
    const TILT: f64 = 0.12;
    const RADIUS: f64 = 2.0;
    let arc = RADIUS * (PI + 2.0 * TILT);
    let leg = 14.5;
    for kind in ElementKind::ALL {
        let mesh = strip(kind, arc + 2.0 * leg, 36, 1.0);
        // The arc's centre is the origin; the fold is symmetric about the x axis and its legs go to negative x.
        let positions = moved(&mesh, |[s, y, z]| {
            let r = RADIUS - z;
            let along = s - leg;
            let (angle, beyond) = match along {
                a if a < 0.0 => (0.0, a),
                a if a > arc => (arc / RADIUS, a - arc),
                a => (a / RADIUS, 0.0),
            };
            let turn = angle - 0.5 * PI - TILT;
            let (sin, cos) = turn.sin_cos();
            [r * cos - beyond * sin, y, r * sin + beyond * cos]
        });
        let itself = model(&mesh, self_pair(&mesh));
        let found = itself.search(&positions).blocks;
        assert!(found.len() > 5, "{kind:?}");
        // The legs' inner planes are tangents of the inner circle.
        let (inner, mut area) = (RADIUS - 0.5, 0.0);
        let (sin, cos) = TILT.sin_cos();
        for block in &found {
            let surface = itself.slave(block.partner);
            let nodes = surface.face(block.slave_face);
            let is_first_leg = nodes.iter().all(|&n| mesh.nodes[n as usize][0] < leg + 0.5 * arc);
            let is_inner_side = nodes.iter().all(|&n| (mesh.nodes[n as usize][2] - 0.5).abs() < 1e-9);
            for point in &block.points {
                let values = pneuflex_mesh::shape::evaluate_face(surface.kind(block.slave_face), point.slave_xi).values;
                let at =
                    |d: usize| -> f64 { nodes.iter().zip(values).map(|(&n, v)| v * positions[n as usize][d]).sum() };
                let height = -sin * at(0) + cos * if is_first_leg { at(2) } else { -at(2) };
                let expected = inner - height;
                assert!((point.distance - expected).abs() < 1e-9, "{kind:?}: {} {expected}", point.distance);
                area += if is_inner_side { point.area } else { 0.0 };
            }
        }
        // Both inner sides beyond the axis, with half the weight each; the ends stop where feet leave the other leg.
        let crossing = (leg - inner / TILT.tan()) * 2.0;
        assert!(area > 0.6 * crossing && area < 1.05 * crossing, "{kind:?}: {area} {crossing}");
    }
}

/// A strip rolled up with windings `pitch` apart.
fn rolled(mesh: &Mesh, pitch: f64) -> Vec<[f64; 3]> {
    moved(mesh, |[s, y, z]| {
        // Archimedes' spiral; the length along it by its radius at the middle of the way is good enough.
        let angle = s / 3.0 - pitch / (2.0 * PI) * s * s / 54.0;
        let r = 3.0 + pitch * angle / (2.0 * PI) + z;
        [r * angle.cos(), y, -r * angle.sin()]
    })
}

#[test]
fn a_rolled_strip_touches_its_next_winding_and_not_the_far_side_of_it() {
    for kind in ElementKind::ALL {
        let mesh = strip(kind, 32.0, 96, 0.2);
        let itself = model(&mesh, self_pair(&mesh));
        let open = itself.search(&rolled(&mesh, 0.3)).blocks;
        assert!(open.is_empty(), "{kind:?}: {:?}", open[0]);
        let pressed = itself.search(&rolled(&mesh, 0.17)).blocks;
        let points: Vec<_> = pressed.iter().flat_map(|b| &b.points).collect();
        assert!(points.len() > 500, "{kind:?}: {}", points.len());
        assert!(points.iter().all(|p| p.distance < 0.0 && p.distance > -0.06), "{kind:?}");
    }
}

#[test]
fn the_other_side_of_a_thin_wall_is_no_contact() {
    for kind in ElementKind::ALL {
        let mesh = strip(kind, 20.0, 20, 0.3);
        let itself = model(&mesh, self_pair(&mesh));
        // Stretched threefold both ways, a ninth as thick, and bent.
        let thin = moved(&mesh, |[x, y, z]| {
            let (x, y, z) = (3.0 * x, 3.0 * y, z / 9.0);
            [x, y, z + 0.4 * (0.3 * x).sin() + 0.1 * (0.7 * y).cos()]
        });
        assert!(itself.search(&thin).blocks.is_empty(), "{kind:?} {:?}", itself.search(&thin).blocks[0]);
        // Sheared by one and a half.
        let sheared = moved(&mesh, |[x, y, z]| [x + 1.5 * z, y, z]);
        assert!(itself.search(&sheared).blocks.is_empty(), "{kind:?}");
    }
}

/// Turns a block around its edge along y through the origin: what is at the angle `from` to the x axis comes to `to`, what is at a full turn stays.
fn folded(mesh: &Mesh, from: f64, to: f64) -> Vec<[f64; 3]> {
    moved(mesh, |[x, y, z]| {
        let angle = z.atan2(x).rem_euclid(2.0 * PI);
        let angle = if angle == 0.0 && z >= 0.0 { 2.0 * PI } else { angle };
        let (sin, cos) = (2.0 * PI - (2.0 * PI - angle) * (2.0 * PI - to) / (2.0 * PI - from)).sin_cos();
        let r = x.hypot(z);
        [r * cos, y, r * sin]
    })
}

/// Two arms of an angle, one face long, that are closed by 3° more than until they meet: nothing is deep in anything but next to the edge that both share.
#[test]
fn the_faces_of_a_crease_touch_from_its_bottom_on() {
    const LENGTH: f64 = 2.0;
    for kind in ElementKind::ALL {
        let mut lattice = Lattice::uniform([-1.0, 0.0, -1.0], [LENGTH, 1.5, LENGTH], [2, 1, 2]);
        for axis in [0, 2] {
            lattice.lines[axis] = vec![-1.0, 0.0, LENGTH];
        }
        let mesh = lattice.mesh(kind, |cell| cell[0] == 0 || cell[2] == 0).mesh;
        let itself = model(&mesh, self_pair(&mesh));
        let open = itself.search(&folded(&mesh, 0.5 * PI, 0.01)).blocks;
        assert!(open.is_empty(), "{kind:?}: {:?}", open[0]);
        let by = 3.0_f64.to_radians();
        let positions = folded(&mesh, 0.5 * PI, -by);
        // Both faces with half the weight each: ½ k ∫ (s sin)² dA.
        let expected = 0.5 * Contact::default().stiffness * by.sin().powi(2) * LENGTH.powi(3) / 3.0 * 1.5;
        let found = total(&itself, &positions).energy;
        assert!((found / expected - 1.0).abs() < 1e-9, "{kind:?}: {found} {expected}");
        if kind == ElementKind::Hex8 {
            check_derivatives(&itself, &positions, "crease");
        }
    }
}

#[test]
fn the_sides_of_a_sharp_ridge_are_no_crease() {
    for kind in ElementKind::ALL {
        // A flat face that is bent, and a right-angled edge that is made sharper.
        let flat = Lattice::uniform([-1.0, 0.0, -0.3], [1.0, 1.0, 0.0], [2, 1, 1]).mesh_all(kind);
        let edge = Lattice::uniform([0.0, 0.0, -1.0], [1.0, 1.0, 0.0], [1, 1, 1]).mesh_all(kind);
        for (mesh, from) in [(flat, PI), (edge, 1.5 * PI)] {
            let itself = model(&mesh, self_pair(&mesh));
            for angle in [25.0_f64, 10.0] {
                let positions = folded(&mesh, from, 2.0 * PI - angle.to_radians());
                let found = itself.search(&positions).blocks;
                assert!(found.is_empty(), "{kind:?} {angle}: {:?}", found[0]);
            }
        }
    }
}

/// The upper lip of a slit ends in a tongue that hangs down past the end of the lower one: it lies behind the continuation of the lower lip's upper face, but in
/// front of its end.
#[test]
fn what_hangs_down_in_front_of_an_end_does_not_touch_the_face_above_it() {
    for kind in ElementKind::ALL {
        let mut lattice = Lattice::uniform([0.0; 3], [4.4, 1.0, 3.0], [4, 1, 3]);
        lattice.lines[0] = vec![0.0, 2.0, 4.0, 4.04, 4.4];
        lattice.lines[2] = vec![0.0, 1.25, 1.75, 3.0];
        let mesh = lattice.mesh(kind, |cell| cell[0] == 0 || cell[2] == 2 || cell[0] == 1 && cell[2] == 0).mesh;
        let itself = model(&mesh, self_pair(&mesh));
        let positions = moved(&mesh, |[x, y, z]| [x, y, if x > 4.01 { z - 0.8 } else { z }]);
        let found = itself.search(&positions).blocks;
        assert!(found.is_empty(), "{kind:?}: {:?}", found[0]);
    }
}

fn points_of(blocks: &[ContactBlock]) -> Vec<(usize, usize, u64)> {
    let mut points: Vec<_> = (blocks.iter())
        .flat_map(|b| {
            let Partner::Face { face, .. } = b.partner else { panic!("no obstacles here") };
            b.points.iter().map(move |p| (p.number, face, p.distance.to_bits()))
        })
        .collect();
    points.sort_unstable();
    points
}

/// Without boxes, order, slabs and cones.
#[test]
fn the_search_finds_what_brute_force_finds() {
    for kind in [ElementKind::Hex8, ElementKind::Hex27, ElementKind::Tet15] {
        let mesh = strip(kind, 24.0, 24, 0.2);
        let itself = model(&mesh, self_pair(&mesh));
        for wave in [0.5, 1.1, 2.3] {
            let positions: Vec<[f64; 3]> = rolled(&mesh, 0.17)
                .into_iter()
                .map(|[x, y, z]| [x + 0.05 * (wave * z).sin(), y, z + 0.05 * (wave * x + y).cos()])
                .collect();
            let found = points_of(&itself.search(&positions).blocks);
            let expected: Vec<_> = (brute_force::feet(&itself, 0, &positions).iter())
                .map(|foot| (foot.number, foot.master_face, foot.projection.distance.to_bits()))
                .collect();
            assert!(found.len() > 50, "{kind:?}: {}", found.len());
            // What only one of them finds.
            let differing: Vec<_> = (found.iter().filter(|p| !expected.contains(p)).map(|p| ("search", p)))
                .chain(expected.iter().filter(|p| !found.contains(p)).map(|p| ("brute force", p)))
                .collect();
            assert!(differing.is_empty(), "{kind:?}: {differing:?}");
        }
    }
}

#[test]
fn the_search_is_the_same_for_any_number_of_threads() {
    let mesh = strip(ElementKind::Hex27, 32.0, 96, 0.2);
    let itself = model(&mesh, self_pair(&mesh));
    let positions = rolled(&mesh, 0.17);
    let [one, two, five] = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| itself.search(&positions).blocks)
    });
    assert!(one.len() > 50 && one == two && two == five);
}
