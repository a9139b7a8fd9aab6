//! What is free, and what holds it.

use super::*;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Facet};
use pneuflex_model::load::{Curve, LinearEquation};
use pneuflex_model::{Contact, ContactPair, Formulation, Material, Obstacle, Shape, Support};

/// Cells of 1 mm in a row along x of which the given ones are solid, as large as `scale` says and far from the origin.
fn cells(solid: &'static [usize], scale: f64) -> Problem {
    let count = solid.last().unwrap() + 1;
    let lattice = Lattice::uniform([0.0; 3], [count as f64, 1.0, 1.0], [count, 1, 1]);
    let mesh = lattice.mesh(ElementKind::Hex8, |cell| solid.contains(&cell[0])).mesh;
    let mesh = mesh.map_nodes(|x| [scale * (x[0] + 3.0), scale * (x[1] - 2.0), scale * x[2]]);
    Problem::body(mesh, Formulation::Hex8Q1p0, Material::default())
}

fn hold(problem: &mut Problem, axes: [bool; 3], holds: impl Fn([f64; 3]) -> bool) {
    let nodes = problem.mesh.select_nodes(holds);
    assert!(!nodes.is_empty());
    problem.supports.push(Support { nodes, axes, ..Support::default() });
}

fn words(problem: &Problem) -> Vec<String> {
    loose_parts(problem).iter().map(|part| part.motions.to_string()).collect()
}

#[test]
fn what_supports_leave_free_is_named_whatever_the_size_of_the_body() {
    const X: [bool; 3] = [true, false, false];
    const Z: [bool; 3] = [false, false, true];
    for scale in [1e-3, 1.0, 1e4] {
        let body = || cells(&[0], scale);
        let at = |value: f64, place: f64| (value - scale * place).abs() < 1e-9 * scale;
        let [loose] = &loose_parts(&body())[..] else { panic!("one part") };
        assert_eq!((loose.motions.count(), loose.num_nodes, loose.may_be_held_by_contact), (6, 8, false));
        assert_eq!(words(&body()), ["to slide along x, y and z, and to turn about x, y and z"]);
        let mut floor = body();
        hold(&mut floor, Z, |x| x[2] == 0.0);
        assert_eq!(words(&floor), ["to slide along x and y, and to turn about z"]);
        hold(&mut floor, X, |x| at(x[0], 3.0));
        assert_eq!(words(&floor), ["to slide along y"]);
        let mut hinge = body();
        hold(&mut hinge, [true; 3], |x| x[2] == 0.0 && at(x[0], 3.0));
        let through = |x: f64| {
            let text = format!("{:.4}", x * scale);
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        assert_eq!(words(&hinge), [format!("to turn about y through ({}, {}, 0)", through(3.0), through(-1.5))]);
        let mut pinned = body();
        hold(&mut pinned, [true; 3], |x| x[2] == 0.0 && at(x[0], 3.0) && at(x[1], -2.0));
        assert_eq!(words(&pinned), ["to turn about x, y and z"]);
        // Three nodes in three, two and one directions: statically determinate.
        hold(&mut pinned, [false, true, true], |x| x[2] == 0.0 && at(x[0], 4.0) && at(x[1], -2.0));
        assert_eq!(words(&pinned), [format!("to turn about x through ({}, {}, 0)", through(3.5), through(-2.0))]);
        hold(&mut pinned, Z, |x| x[2] == 0.0 && at(x[0], 3.0) && at(x[1], -1.0));
        assert_eq!(words(&pinned), [""; 0]);
    }
}

#[test]
fn equations_hold_as_supports_do_and_say_nothing_if_they_follow_from_others() {
    let mut body = cells(&[0], 1.0);
    hold(&mut body, [false, true, true], |_| true);
    assert_eq!(words(&body), ["to slide along x"]);
    // The same displacement along x at two nodes holds nothing, a node tied to its place does.
    let tied = LinearEquation { terms: vec![(0, 0, 5.0), (1, 0, -5.0)], value: Curve::ZERO };
    body.equations.push(tied);
    assert_eq!(words(&body), ["to slide along x"]);
    body.equations.push(LinearEquation { terms: vec![(0, 0, 1e-4)], value: Curve::ZERO });
    assert_eq!(words(&body), [""; 0]);
}

#[test]
fn ties_carry_what_a_support_holds_from_part_to_part() {
    let mut body = cells(&[0, 2, 4], 1.0);
    hold(&mut body, [true; 3], |x| x[0] == 3.0);
    let free = "to slide along x, y and z, and to turn about x, y and z";
    assert_eq!(words(&body), [free, free]);
    let face = |body: &Problem, x: f64| body.mesh.select_nodes(|at| at[0] == x);
    let tie = |body: &mut Problem, a: f64, b: f64, axes: &[u8]| {
        for (a, b) in face(body, a).into_iter().zip(face(body, b)) {
            let equation =
                |&axis: &u8| LinearEquation { terms: vec![(a, axis, 1.0), (b, axis, -1.0)], value: Curve::ZERO };
            body.equations.extend(axes.iter().map(equation));
        }
    };
    tie(&mut body, 6.0, 7.0, &[0, 1, 2]);
    // The two behind move as one.
    assert_eq!(words(&body), [free, free]);
    tie(&mut body, 4.0, 5.0, &[0]);
    assert_eq!(words(&body), ["to slide along y and z, and to turn about x"; 2]);
    tie(&mut body, 4.0, 5.0, &[1, 2]);
    assert_eq!(words(&body), [""; 0]);
}

#[test]
fn parts_that_share_an_edge_are_a_hinge() {
    let lattice = Lattice::uniform([0.0; 3], [2.0, 1.0, 2.0], [2, 1, 2]);
    let mesh = lattice.mesh(ElementKind::Hex8, |cell| cell[0] == cell[2]).mesh;
    let mut body = Problem::body(mesh, Formulation::Hex8Q1p0, Material::default());
    hold(&mut body, [true; 3], |x| x[0] == 0.0);
    assert_eq!(words(&body), ["to turn about y through (1, 0.5, 1)"]);
}

#[test]
fn contact_may_hold_what_supports_do_not() {
    let mut body = cells(&[0, 2], 1.0);
    hold(&mut body, [true; 3], |x| x[0] == 3.0);
    let [slave, master] = [5.0, 4.0].map(|x| body.mesh.select_facets(|at| at[0] == x));
    body.contact_pairs.push(ContactPair::new("gap", slave, master));
    let by_contact =
        |body: &Problem| loose_parts(body).iter().map(|part| part.may_be_held_by_contact).collect::<Vec<_>>();
    // Contact is switched off.
    assert_eq!(by_contact(&body), [false]);
    body.contact = Contact::default();
    assert_eq!(by_contact(&body), [true]);
    // Nothing holds either of the two.
    body.supports.clear();
    assert_eq!(by_contact(&body), [false, false]);
    let facets: Vec<Facet> = body.mesh.select_facets(|x| x[2] == 0.0 && x[0] > 4.5);
    let shape = Shape::Plane { point: [0.0; 3], normal: [0.0, 0.0, 1.0] };
    body.obstacles.push(Obstacle {
        name: "floor".into(),
        shape,
        facets,
        stiffness: 1.0,
        motion: None,
        report_force: true,
        penetration_tolerance: None,
        interference_until: None,
    });
    assert_eq!(by_contact(&body), [true, true]);
}
