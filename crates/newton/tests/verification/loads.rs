//! Loads as functions of time: homogeneous states whose stretches and forces are known.

use pneuflex_assembly::conservative_load::traction_forces;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::load::Load;
use pneuflex_model::{
    Clock, Contact, ContactPair, Curve, Formulation, Law, LinearEquation, Material, Motion, Problem, Solver, Support,
};
use pneuflex_newton::ConvergedState;

use crate::fixtures::{follow, resultant};

const SIDES: [f64; 3] = [2.0, 1.5, 1.0];

fn settings() -> Solver {
    Solver { first_step: 0.2, max_step: 0.5, min_step: 1e-3, ..Solver::default() }
}

/// A block on three planes of symmetry.
fn block(formulation: Formulation, bulk_modulus: f64) -> Problem {
    let mesh = Lattice::uniform([0.0; 3], SIDES, [2, 2, 1]).mesh_all(formulation.element_kind());
    let mut problem = Problem::body(mesh, formulation, Material { bulk_modulus, ..Material::default() });
    for axis in 0..3 {
        hold(&mut problem, axis, 0.0, None);
    }
    problem.clock = Clock::Steps;
    problem
}

fn hold(problem: &mut Problem, axis: usize, at: f64, motion: Option<Motion>) {
    let nodes = problem.mesh.select_nodes(|x| (x[axis] - at).abs() < 1e-9);
    let axes = std::array::from_fn(|k| k == axis);
    problem.supports.push(Support { name: "plane".into(), nodes, axes, motion });
}

fn end_faces(mesh: &Mesh) -> Vec<Facet> {
    mesh.select_facets(|x| (x[0] - SIDES[0]).abs() < 1e-9)
}

/// Largest displacement along x at the loaded end, mm.
fn elongation(problem: &Problem, state: &ConvergedState) -> f64 {
    let (node, _) = problem.mesh.nearest_node(SIDES).unwrap();
    state.displacement[node][0]
}

/// Nominal uniaxial stress of the incompressible material, MPa: 2 (λ − λ⁻²) W′(I₁ − 3).
fn nominal(material: &Material, stretch: f64) -> f64 {
    let x = stretch * stretch + 2.0 / stretch - 3.0;
    2.0 * (stretch - stretch.powi(-2)) * yeoh_slope(material, x)
}

fn yeoh_slope(material: &Material, x: f64) -> f64 {
    let Law::Yeoh { c10, c20, c30 } = material.law else { panic!("the default law is Yeoh's") };
    c10 + 2.0 * c20 * x + 3.0 * c30 * x * x
}

#[test]
fn a_moved_support_stretches_a_block() {
    for formulation in Formulation::ALL {
        let mut problem = block(formulation, 1e4);
        // Out to a stretch of 1.5, and half the way back.
        let curve = Curve::Table(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.5]]);
        let motion = Motion { displacement: [0.5 * SIDES[0], 7.0, 7.0], curve };
        hold(&mut problem, 0, SIDES[0], Some(motion));
        let states = follow(&problem, &[1.0, 2.0], &settings());
        for (state, stretch) in states.iter().zip([1.5, 1.25]) {
            assert!((elongation(&problem, state) - (stretch - 1.0) * SIDES[0]).abs() < 1e-12);
            let pull: f64 = problem.supports[3].nodes.iter().map(|&node| state.reaction[node as usize][0]).sum();
            let expected = nominal(&problem.material, stretch) * SIDES[1] * SIDES[2];
            assert!((pull / expected - 1.0).abs() < 1e-3, "{formulation}: {pull} N for {expected} N");
        }
    }
}

#[test]
fn dead_loads_find_the_stretch_whose_stress_they_are() {
    for formulation in Formulation::ALL {
        let mut problem = block(formulation, 1e4);
        let traction = nominal(&problem.material, 1.5);
        let facets = end_faces(&problem.mesh);
        // Half of it from the start, all of it at the end.
        let curve = Curve::Table(vec![[0.0, 0.5], [1.0, 1.0]]);
        problem.loads.push(Load::Traction { facets, traction: [traction, 0.0, 0.0], curve });
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        let stretch = 1.0 + elongation(&problem, &state) / SIDES[0];
        assert!((stretch - 1.5).abs() < 1e-3, "{formulation}: {stretch}");
        let [x, y, z] = resultant(&state.reaction);
        assert!((x + traction * SIDES[1] * SIDES[2]).abs() < 1e-6 && y.abs() + z.abs() < 1e-6, "{x} {y} {z}");
    }
}

#[test]
fn pressure_from_all_sides_only_compresses() {
    for formulation in Formulation::ALL {
        let mut problem = block(formulation, 3.0);
        let free = problem.mesh.boundary_facets().into_iter().filter(|&facet| {
            let nodes = problem.mesh.facet_nodes(facet);
            (0..3).all(|axis| nodes.iter().any(|&n| problem.mesh.nodes[n as usize][axis] != 0.0))
        });
        problem.loads.push(Load::Pressure { facets: free.collect(), curve: Curve::Proportional(0.6) });
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        // p = κ (1 − J) with J = λ³, whatever the law.
        let expected = 0.8_f64.cbrt() - 1.0;
        let strain = elongation(&problem, &state) / SIDES[0];
        assert!((strain - expected).abs() < 1e-7, "{formulation}: {strain} for {expected}");
    }
}

/// A slender bar, held at one end, is pulled by suction on the other, with fifty times the force at which it would buckle if it were
/// pushed. The forces turn with the end face, which couples its rotation to its displacement in one direction only.
#[test]
fn suction_on_a_free_end_stretches_a_slender_bar() {
    const SUCTION: f64 = 2.0;
    for formulation in Formulation::ALL {
        let mesh = Lattice::uniform([0.0; 3], [8.0, 1.0, 1.0], [8, 2, 2]).mesh_all(formulation.element_kind());
        let mut problem =
            Problem::body(mesh, formulation, Material { bulk_modulus: 1e4, ..Law::NeoHooke { c10: 1.9 }.into() });
        problem.clock = Clock::Steps;
        hold(&mut problem, 0, 0.0, None);
        let at = |y: f64| problem.mesh.select_nodes(|x| (x[0], x[1], x[2]) == (0.0, y, 0.0));
        let supports = [(at(0.0), [false, true, true]), (at(1.0), [false, false, true])];
        problem.supports.extend(supports.map(|(nodes, axes)| Support {
            name: "edge".into(),
            nodes,
            axes,
            motion: None,
        }));
        let facets = problem.mesh.select_facets(|x| (x[0] - 8.0).abs() < 1e-9);
        problem.loads.push(Load::Pressure { facets, curve: Curve::Proportional(-SUCTION) });
        let [state] = &follow(&problem, &[1.0], &settings())[..] else { panic!("one state") };
        // Cauchy stress of the incompressible bar: 2 C₁₀ (λ² − 1/λ).
        let (mut low, mut high) = (1.0, 2.0);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            if 3.8 * (middle * middle - 1.0 / middle) < SUCTION { low = middle } else { high = middle }
        }
        let (node, _) = problem.mesh.nearest_node([8.0, 1.0, 1.0]).unwrap();
        let stretch = 1.0 + state.displacement[node][0] / 8.0;
        assert!((stretch - low).abs() < 1e-4, "{formulation:?}: {stretch} {low}");
        assert!(state.iterations <= 16, "{formulation:?}: {} iterations", state.iterations);
    }
}

/// A bar of Gent's rubber is pulled until it all but locks: the first corrections lead beyond, where there is no state, and are rejected.
#[test]
fn a_bar_that_locks_is_pulled_up_to_its_end() {
    const SUCTION: f64 = 60.0;
    let (shear_modulus, jm) = (1.0, 2.0);
    for formulation in [Formulation::Hex8Q1p0, Formulation::Hex27, Formulation::Tet15] {
        let mesh = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(formulation.element_kind());
        let material = Material { bulk_modulus: 1e5, ..Law::Gent { shear_modulus, jm }.into() };
        let mut problem = Problem::body(mesh, formulation, material);
        problem.clock = Clock::Steps;
        for axis in 0..3 {
            hold(&mut problem, axis, 0.0, None);
        }
        let facets = problem.mesh.select_facets(|x| (x[0] - 2.0).abs() < 1e-9);
        problem.loads.push(Load::Pressure { facets, curve: Curve::Proportional(-SUCTION) });
        let [state] = &follow(&problem, &[1.0], &settings())[..] else { panic!("one state") };
        // Cauchy stress of the incompressible bar: μ J_m/(J_m − x) (λ² − 1/λ) with x = λ² + 2/λ − 3.
        let stress = |l: f64| {
            let left = jm - (l * l + 2.0 / l - 3.0);
            if left > 0.0 { shear_modulus * jm / left * (l * l - 1.0 / l) } else { f64::INFINITY }
        };
        let (mut low, mut high) = (1.0, 3.0);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            if stress(middle) < SUCTION { low = middle } else { high = middle }
        }
        let (node, _) = problem.mesh.nearest_node([2.0, 1.0, 1.0]).unwrap();
        let stretch = 1.0 + state.displacement[node][0] / 2.0;
        assert!((stretch - low).abs() < 1e-3 && stress(low + 0.05).is_infinite(), "{formulation:?}: {stretch} {low}");
    }
}

#[test]
fn weight_hangs_on_its_support() {
    for formulation in Formulation::ALL {
        let mut problem = block(formulation, 1000.0);
        problem.material.density = 1.1;
        let acceleration = [9810.0, 0.0, 0.0];
        problem.loads.push(Load::Gravity { elements: None, acceleration, curve: Curve::Proportional(20.0) });
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        let specific_weight = 20.0 * 1.1e-9 * 9810.0;
        let weight = specific_weight * SIDES.iter().product::<f64>();
        let [x, y, z] = resultant(&state.reaction);
        assert!((x / weight + 1.0).abs() < 1e-9 && y.abs() + z.abs() < 1e-9 * weight, "{x} {y} {z} for {weight}");
        // By Betti's theorem with a uniform uniaxial stress, the mean displacement of the end is ρ g L² / 2 E in linear elasticity.
        let (kappa, mu) = (problem.material.bulk_modulus, problem.material.shear_modulus());
        let young = 9.0 * kappa * mu / (3.0 * kappa + mu);
        let expected = specific_weight * SIDES[0] * SIDES[0] / (2.0 * young);
        let shares = traction_forces(&problem.mesh, &end_faces(&problem.mesh), [1.0, 0.0, 0.0]);
        let moment: f64 = shares.iter().zip(&state.displacement).map(|(share, u)| share[0] * u[0]).sum();
        let found = moment / (SIDES[1] * SIDES[2]);
        assert!((found / expected - 1.0).abs() < 2e-3, "{formulation}: {found} for {expected}");
    }
}

/// A face that equations keep plane, pulled at a single node, is a face under the mean stress.
#[test]
fn equations_tie_a_face_to_one_of_its_nodes() {
    for formulation in Formulation::ALL {
        let mut problem = block(formulation, 1e4);
        let face = problem.mesh.select_nodes(|x| (x[0] - SIDES[0]).abs() < 1e-9);
        let (leader, followers) = face.split_first().unwrap();
        for &node in followers {
            problem
                .equations
                .push(LinearEquation { terms: vec![(node, 0, 2.0), (*leader, 0, -2.0)], value: Curve::ZERO });
        }
        let force = nominal(&problem.material, 1.5) * SIDES[1] * SIDES[2];
        let curve = Curve::Proportional(1.0);
        problem.loads.push(Load::Force { nodes: vec![(*leader, 1.0)], force: [force, 0.0, 0.0], curve });
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        for &node in &face {
            let strain = state.displacement[node as usize][0] / SIDES[0];
            assert!((strain - 0.5).abs() < 1e-3, "{formulation}: {strain}");
        }
    }
}

/// Equations that are eliminated and equations with multipliers say the same, with prescribed motion at a master, a pressure whose tangent
/// is unsymmetric and gravity on the slaves; and so do equations that chain nodes or refer all of them to one.
#[test]
fn eliminated_equations_are_those_with_multipliers() {
    for formulation in [Formulation::Hex8Q1p0, Formulation::Hex27, Formulation::Tet15] {
        let mut problem = block(formulation, 50.0);
        problem.material.density = 1.1;
        let end = problem.mesh.select_nodes(|x| (x[0] - SIDES[0]).abs() < 1e-9);
        let (held, free) = end.split_first().unwrap();
        let motion = Motion { displacement: [0.3, 0.0, 0.0], curve: Curve::Proportional(1.0) };
        problem.supports.push(Support {
            name: "pull".into(),
            nodes: vec![*held],
            axes: [true, false, false],
            motion: Some(motion),
        });
        let facets = problem.mesh.select_facets(|x| (x[1] - SIDES[1]).abs() < 1e-9 && x[0] > 0.9);
        problem.loads.push(Load::Pressure { facets, curve: Curve::Proportional(0.2) });
        let (acceleration, curve) = ([0.0, 0.0, 9.81e6], Curve::Proportional(1.0));
        problem.loads.push(Load::Gravity { elements: None, acceleration, curve });
        // The end stays plane, and its nodes move along y in proportion to those along z.
        let mut solve = |pairs: &dyn Fn(usize) -> u32, value: &Curve| {
            let tie = |(i, node): (usize, &u32)| {
                let terms = vec![(*node, 0, 1.0), (pairs(i), 0, -1.0), (*node, 1, 0.3), (pairs(i), 1, -0.3)];
                LinearEquation { terms, value: value.clone() }
            };
            problem.equations = free.iter().enumerate().map(tie).collect();
            let strict = Solver { tolerance: 1e-10, ..settings() };
            follow(&problem, &[1.0], &strict).remove(0)
        };
        let zero = Curve::Table(vec![[0.0, 0.0], [1.0, 0.0]]);
        let expected = solve(&|_| *held, &zero);
        let scale = expected.displacement.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let largest = expected.reaction.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        for found in
            [solve(&|_| *held, &Curve::ZERO), solve(&|i| if i == 0 { *held } else { free[i - 1] }, &Curve::ZERO)]
        {
            let off = |a: &[[f64; 3]], b: &[[f64; 3]]| {
                a.as_flattened().iter().zip(b.as_flattened()).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()))
            };
            let displacements = off(&found.displacement, &expected.displacement) / scale;
            let reactions = off(&found.reaction, &expected.reaction) / largest;
            assert!(displacements < 1e-8 && reactions < 1e-6, "{formulation}: {displacements:.1e} {reactions:.1e}");
        }
    }
}

/// The right-hand side of an equation moves what it ties: the mean of the end's displacements is prescribed.
#[test]
fn equations_prescribe_means() {
    let mut problem = block(Formulation::Hex27, 1e4);
    let face = problem.mesh.select_nodes(|x| (x[0] - SIDES[0]).abs() < 1e-9);
    let share = 1.0 / face.len() as f64;
    let terms: Vec<(u32, u8, f64)> = face.iter().map(|&node| (node, 0, share)).collect();
    problem.equations.push(LinearEquation { terms, value: Curve::Proportional(0.4) });
    let states = follow(&problem, &[0.5, 1.0], &settings());
    for (state, expected) in states.iter().zip([0.2, 0.4]) {
        let mean: f64 = face.iter().map(|&node| share * state.displacement[node as usize][0]).sum();
        assert!((mean - expected).abs() < 1e-9, "{mean}");
        let [x, ..] = resultant(&state.reaction);
        assert!(x < -0.01, "the equation pulls: {x}");
    }
}

/// Nothing but the contact holds the upper block: it starts in touch, without pressure.
#[test]
fn a_block_rests_on_another() {
    for formulation in [Formulation::Hex8Q1p0, Formulation::Hex27, Formulation::Tet15] {
        let side =
            |z: f64| Lattice::uniform([0.0, 0.0, z], [1.0, 1.0, z + 1.0], [2; 3]).mesh_all(formulation.element_kind());
        let (mut mesh, upper) = (side(0.0), side(1.0));
        let [nodes, elements] = [mesh.num_nodes() as u32, mesh.num_elements() as u32];
        let between = |mesh: &Mesh| mesh.select_facets(|x| (x[2] - 1.0).abs() < 1e-9);
        let (below, above) = (between(&mesh), between(&upper));
        mesh.nodes.extend(&upper.nodes);
        mesh.connectivity.extend(upper.connectivity.iter().map(|node| node + nodes));
        let shifted = |facets: Vec<Facet>| {
            facets.into_iter().map(|facet| Facet { element: facet.element + elements, ..facet }).collect::<Vec<_>>()
        };
        let top = shifted(upper.select_facets(|x| (x[2] - 2.0).abs() < 1e-9));
        let mut problem = Problem::body(mesh, formulation, Material::default());
        problem.clock = Clock::Steps;
        for axis in 0..3 {
            hold(&mut problem, axis, 0.0, None);
        }
        let stiffness = 50.0;
        problem.contact = Contact { stiffness, ..Contact::default() };
        problem.contact_pairs.push(ContactPair::new("between", shifted(above), below));
        let pressure = 0.02;
        problem.loads.push(Load::Pressure { facets: top, curve: Curve::Proportional(pressure) });
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        let at = |z: f64, first: u32| {
            let is_it = |n: &u32| *n >= first && problem.mesh.nodes[*n as usize] == [0.0, 0.0, z];
            let node = (0..problem.mesh.num_nodes() as u32).find(is_it).unwrap() as usize;
            z + state.displacement[node][2]
        };
        let depth = at(1.0, 0) - at(1.0, nodes);
        assert!((depth * stiffness / pressure - 1.0).abs() < 0.05, "{formulation}: {depth} mm");
        let [.., z] = resultant(&state.reaction);
        assert!((z / pressure - 1.0).abs() < 0.05, "{formulation}: {z} N");
    }
}
