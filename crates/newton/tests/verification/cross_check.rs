//! The ladder of theory §16: element, contribution, global residual and tangent, one Newton step, load path.
//!
//! The reference differentiates scalar energies automatically and solves the dense KKT system; nothing but the mesh and the
//! problem's data is shared.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use pneuflex_assembly::{
    Assembler, ContactForces, Contribution, FollowerPressure, LocalBlock, LocalContribution, Mixed, Position,
    Prediction, Request, Solid, Totals, Unilateral,
};
use pneuflex_factor::Parallelism;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::testing::mixed;
use pneuflex_mesh::{Actuator, ElementKind, Mesh};
use pneuflex_model::{
    ContactMethod, ContactPair, Formulation, Invariant, Law, LoadParameter, Material, Pressure, Problem, Region,
    Volumetric,
};
use pneuflex_newton::{State, System};
use pneuflex_reference::pressure::{ACROSS_Y, CLOSED};
use pneuflex_reference::{AirModel, PathOptions, ReferenceSolver, SolidModel};

use crate::fixtures::{
    INVARIANTS, actuator_problem, assert_same_states, body, coarse_chambers, dense, difference, displacement, follow,
    follow_reference, noise, strict, sum, touching,
};

/// Energy, gradient and Hessian.
struct Derivatives {
    energy: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

/// Contributions put together by the production assembler.
fn assembled(contributions: &[&dyn LocalContribution], u: &[[f64; 3]]) -> Derivatives {
    let mut assembler = Assembler::new(u.len(), contributions, &[]);
    let mut totals = Totals::default();
    assembler.reset(&mut totals, Request::Tangent);
    for (index, contribution) in contributions.iter().enumerate() {
        assembler.add(index, *contribution, u, Request::Tangent, &mut totals).unwrap();
    }
    Derivatives {
        energy: totals.energy,
        gradient: DVector::from_column_slice(totals.residual.as_flattened()),
        hessian: dense(assembler.pattern(), &totals.tangent),
    }
}

/// A block's tangent, from the node pairs of its lower triangle.
fn dense_block(block: &LocalBlock) -> DMatrix<f64> {
    let n = block.residual.len();
    DMatrix::from_fn(3 * n, 3 * n, |row, column| {
        let ((a, i), (b, j)) = ((row / 3, row % 3), (column / 3, column % 3));
        if a >= b {
            block.tangent[a * (a + 1) / 2 + b][3 * j + i]
        } else {
            block.tangent[b * (b + 1) / 2 + a][3 * i + j]
        }
    })
}

/// Two skewed elements.
fn skewed(formulation: Formulation) -> Mesh {
    Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1])
        .mesh_all(formulation.element_kind())
        .map_nodes(|[x, y, z]| [x + 0.1 * y * z, y + 0.07 * x * z, z + 0.05 * x * x])
}

/// Every law with every volumetric form; one that softens at first.
fn materials() -> Vec<Material> {
    let samples = pneuflex_laws::samples();
    let isochoric = samples.iter().filter(|material| material.invariant == Invariant::Isochoric).cloned();
    let logarithmic = isochoric.map(|material| Material { volumetric: Volumetric::Logarithmic, ..material });
    let softening: Material = Law::Yeoh { c10: 0.3, c20: -0.02, c30: 0.002 }.into();
    let softening = Material { invariant: Invariant::Full, ..softening };
    logarithmic.collect::<Vec<_>>().into_iter().chain(samples).chain([softening]).collect()
}

/// Residual of the energy, and tangent with pressures carried over from another state.
#[test]
fn elements() {
    let of_one = Formulation::ALL.into_iter().map(|formulation| (formulation, skewed(formulation)));
    // A hexahedron beside two wedges.
    let [hexahedra, wedges] = [Formulation::Hex27, Formulation::Wedge21].map(skewed);
    let several = mixed(&hexahedra, &wedges, |x| x[0] < 1.0);
    assert_eq!(several.families().len(), 2);
    for (formulation, mesh) in of_one.chain([(Formulation::Hex27, several)]) {
        // Matrix functions of dual numbers take their time: Ogden's law on elements of few points.
        let is_large = formulation.num_modes > 1;
        let is_slow = |material: &Material| is_large && matches!(material.law, Law::Ogden { .. });
        for material in materials().into_iter().filter(|material| !is_slow(material)) {
            let name = format!("{formulation} {:?} {:?} {:?}", material.law, material.volumetric, material.invariant);
            let mut solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
            let reference = SolidModel::new(&body(mesh.clone(), formulation, material)).unwrap();
            let stretched = displacement(&mesh, |[x, y, z]| [1.2 * x + 0.3 * z, y - 0.1 * x, 0.9 * z + 0.1 * y * x]);
            let u = sum(&stretched, &noise(mesh.num_nodes(), 0.02, 1));
            let correction = noise(mesh.num_nodes(), 0.01, 2);
            let modes = solid.num_modes();
            let own = solid.element_pressures(&u, None);
            // Behind an element's pressures may stand coefficients of its change of volume.
            let fields = reference.num_pressures() / solid.num_blocks();
            let all_own = reference.pressures(u.as_flattened());
            let pressures: Vec<f64> = all_own.chunks(fields).flat_map(|own| own[..modes].to_vec()).collect();
            assert!(difference(&own, &pressures) < 1e-12, "{name}");
            let carried = solid.element_pressures(&u, Some(&correction));
            assert!(difference(&carried, &own) > 1e-2, "the same pressures would show nothing");

            for is_carried in [false, true] {
                if is_carried {
                    let prediction = Prediction {
                        displacement: u.clone(),
                        correction: Some(correction.clone()),
                        ..Prediction::default()
                    };
                    let mixed = solid.mixed().unwrap();
                    mixed.predict(&Arc::new(prediction));
                    mixed.linearise();
                }
                for element in 0..solid.num_blocks() {
                    let mut block = LocalBlock::default();
                    block.reset(solid.nodes(element).len(), Request::Tangent);
                    solid.evaluate(element, &u, Request::Tangent, &mut block).unwrap();
                    let pressures = if is_carried { &carried } else { &own };
                    let mut of_element = all_own[fields * element..fields * (element + 1)].to_vec();
                    of_element[..modes].copy_from_slice(&pressures[modes * element..modes * (element + 1)]);
                    let gradient = reference.element_gradient(element, u.as_flattened());
                    let hessian = reference.element_condensed_hessian(element, u.as_flattened(), &of_element);
                    let residual = difference(block.residual.as_flattened(), gradient.as_slice());
                    let tangent = difference(dense_block(&block).as_slice(), hessian.as_slice());
                    assert!(
                        residual < 1e-12 && tangent < 1e-12,
                        "{name}, carried: {is_carried}: {residual:.1e}, {tangent:.1e}"
                    );
                }
            }
            let energy = assembled(&[&solid], &u).energy;
            assert!((energy / reference.energy(u.as_flattened()) - 1.0).abs() < 1e-12);
        }
    }
}

/// The two coarse chambers in a random state that respects the supports, the left one leaning into the right one, but by less
/// than 0.3 of the narrowest facet's width.
fn leaning(problem: &Problem) -> Vec<[f64; 3]> {
    let lean = displacement(&problem.mesh, |[x, y, z]| [if x < 8.1 { x + 0.0028 * z * z } else { x }, y, z]);
    let mut u = sum(&lean, &noise(problem.mesh.num_nodes(), 0.02, 3));
    for (value, held) in u.as_flattened_mut().iter_mut().zip(problem.held_dofs()) {
        if held {
            *value = 0.0;
        }
    }
    u
}

/// The tangent's rows and columns of free degrees of freedom.
fn free_part(matrix: &DMatrix<f64>, problem: &Problem) -> DMatrix<f64> {
    let free: Vec<usize> =
        problem.held_dofs().iter().enumerate().filter(|(_, held)| !**held).map(|(dof, _)| dof).collect();
    matrix.select_rows(&free).select_columns(&free)
}

#[test]
fn pressure() {
    // Dense matrices of two chambers of quadratic elements would fill the memory.
    let mut chamber = Actuator { chambers: 1, ..Actuator::two_chambers() };
    chamber.channel.half_width = 0.0;
    for formulation in [Formulation::Hex8Q1p0, Formulation::Hex20, Formulation::Hex27, Formulation::Tet10] {
        let problem = match formulation.element_kind() {
            ElementKind::Hex8 => coarse_chambers(formulation, Invariant::Isochoric, ContactMethod::None),
            _ => {
                let size = [8.0, 9.0, 8.0];
                actuator_problem(&chamber, size, formulation, Invariant::Isochoric, ContactMethod::None)
            }
        };
        let mut pressure = FollowerPressure::new(problem.mesh.clone(), &problem.cavity_facets());
        pressure.pressure = Pressure::from_mpa(0.3);
        let u = leaning(&problem);
        let reference = AirModel::new(&problem, &problem.cavity_facets(), ACROSS_Y, 0.0).unwrap();
        let volume = reference.volume(u.as_flattened());
        assert!((pressure.volume(&u) / volume - 1.0).abs() < 1e-13);
        let found = assembled(&[&pressure], &u);
        let gradient = difference(&found.gradient, &reference.gradient(u.as_flattened(), 0.3));
        // The symmetrised tangent is the Hessian up to entries of the rim's held degrees of freedom.
        let hessian = reference.hessian(u.as_flattened(), 0.3);
        let tangent = difference(&free_part(&found.hessian, &problem), &free_part(&hessian, &problem));
        assert!(gradient < 1e-13 && tangent < 1e-13, "{formulation}: {gradient:.1e}, {tangent:.1e}");
    }
}

/// The whole surface of a skewed cell, whose faces have a node at their centre.
#[test]
fn pressure_on_tetrahedra_with_bubbles() {
    let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [1; 3]).mesh_all(Formulation::Tet15.element_kind());
    let mesh = mesh.map_nodes(|[x, y, z]| [x + 0.1 * y * z, y + 0.07 * x * z, z + 0.05 * x * x]);
    let facets = mesh.boundary_facets();
    let problem = body(mesh, Formulation::Tet15, Material::default());
    let mut pressure = FollowerPressure::new(problem.mesh.clone(), &facets);
    pressure.pressure = Pressure::from_mpa(0.3);
    let u = noise(problem.mesh.num_nodes(), 0.05, 3);
    let reference = AirModel::new(&problem, &facets, ACROSS_Y, 0.0).unwrap();
    assert!((pressure.volume(&u) / reference.volume(u.as_flattened()) - 1.0).abs() < 1e-13);
    let found = assembled(&[&pressure], &u);
    let gradient = difference(&found.gradient, &reference.gradient(u.as_flattened(), 0.3));
    let tangent = difference(&found.hessian, &reference.hessian(u.as_flattened(), 0.3));
    assert!(gradient < 1e-12 && tangent < 1e-12, "{gradient:.1e}, {tangent:.1e}");
}

/// Two blocks with facing sides x = 1 (slave) and x = 1.1 (master), cut in different places.
fn two_blocks(formulation: Formulation, method: ContactMethod) -> Problem {
    let kind = formulation.element_kind();
    let mut mesh = Lattice::uniform([0.0; 3], [1.0, 2.0, 2.0], [1, 2, 2]).mesh_all(kind);
    let right = Lattice { lines: [vec![1.1, 2.1], vec![-0.3, 0.8, 2.4], vec![-0.2, 1.3, 2.3]] }.mesh_all(kind);
    let shift = mesh.num_nodes() as u32;
    mesh.connectivity.extend(right.connectivity.iter().map(|n| n + shift));
    mesh.nodes.extend(right.nodes);
    let side = |x: f64| mesh.select_facets(|point| (point[0] - x).abs() < 1e-9);
    let pair = ContactPair::new("gap", side(1.0), side(1.1));
    let mut problem = body(mesh, formulation, Material::default());
    problem.contact.method = method;
    problem.contact_pairs = vec![pair];
    problem
}

/// The contact of a problem at a displacement, with the tractions there in its tangent.
fn touching_forces(problem: &Problem, u: &[[f64; 3]]) -> ContactForces {
    let mut contact = ContactForces::of(problem);
    contact.predict(&Arc::new(Prediction { displacement: u.to_vec(), correction: None, ..Prediction::default() }));
    let position =
        Position { parameter: LoadParameter::default(), displacement: u, bordered: &[], is_on_the_way: false };
    contact.set_position(position);
    contact
}

#[test]
fn contact() {
    for formulation in
        [Formulation::Hex8Q1p0, Formulation::Hex20, Formulation::Hex27, Formulation::Tet10, Formulation::Tet15]
    {
        for (method, least) in [(ContactMethod::SinglePoint, 3), (ContactMethod::MultiPoint, 40)] {
            let problem = two_blocks(formulation, method);
            let n = problem.mesh.num_nodes();
            // The left block is pushed 0.2 mm beyond the gap at z = 2, the right one bulges.
            let pushed = displacement(&problem.mesh, |[x, y, z]| {
                let bulge = 0.03 * (2.0 * y).sin() * (1.5 * z).cos();
                [if x <= 1.0 { x + 0.1 + 0.1 * z } else { x + bulge }, y + 0.03 * z, z]
            });
            let u = sum(&pushed, &noise(n, 0.02, 4));
            let contact = touching_forces(&problem, &u);
            let reference = pneuflex_reference::ContactModel::new(&problem).unwrap();
            let points = reference.points(u.as_flattened());
            let active = points.iter().filter(|point| point.gap < 0.0).count();
            assert!(active >= least && contact.num_active() == active, "{active}, {}", contact.num_active());
            assert!(points.iter().all(|point| point.gap > -0.3));

            let found = assembled(&[&contact], &u);
            let energy = found.energy / reference.energy(u.as_flattened()) - 1.0;
            let gradient = difference(&found.gradient, &reference.gradient(u.as_flattened()));
            let tangent = difference(&found.hessian, &reference.hessian(u.as_flattened()));
            assert!(
                energy.abs() < 1e-12 && gradient < 1e-12 && tangent < 1e-11,
                "{formulation} {method:?}: {energy:.1e}, {gradient:.1e}, {tangent:.1e}"
            );
        }
    }
}

#[test]
fn global_residual_and_tangent() {
    for (formulation, invariant, method) in [
        (Formulation::Hex8Sri, Invariant::Full, ContactMethod::MultiPoint),
        (Formulation::Hex8Sri, Invariant::Isochoric, ContactMethod::SinglePoint),
        (Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint),
        (Formulation::Hex8Q1p0, Invariant::Full, ContactMethod::SinglePoint),
    ] {
        let problem = coarse_chambers(formulation, invariant, method);
        let (u, p_kpa) = (leaning(&problem), 35.0);
        let parameter = LoadParameter(p_kpa);
        let solid = Solid::new(problem.mesh.clone(), formulation, &problem.material).unwrap();
        let mut pressure = FollowerPressure::new(problem.mesh.clone(), &problem.cavity_facets());
        pressure.pressure = Pressure::from_kpa(p_kpa);
        let contact = touching_forces(&problem, &u);
        let deepest =
            contact.touching().iter().flat_map(|block| &block.points).fold(0.0, |d: f64, point| d.max(-point.distance));
        assert!(contact.num_active() >= 4 && (0.05..0.3).contains(&deepest), "{} {deepest}", contact.num_active());

        let reference = ReferenceSolver::new(&problem).unwrap();
        let found = assembled(&[&solid, &pressure, &contact], &u);
        let energy = found.energy / reference.energy(u.as_flattened(), parameter) - 1.0;
        let gradient = difference(&found.gradient, &reference.gradient(u.as_flattened(), parameter));
        let hessian = reference.hessian(u.as_flattened(), parameter);
        let tangent = difference(&free_part(&found.hessian, &problem), &free_part(&hessian, &problem));
        assert!(
            energy.abs() < 1e-12 && gradient < 1e-12 && tangent < 1e-12,
            "{formulation} {invariant:?} {method:?}: {energy:.1e}, {gradient:.1e}, {tangent:.1e}"
        );

        // The same through the system that Newton's method works on.
        let mut system = System::new(&problem, Parallelism::Threads).unwrap();
        system.predict(&u, None);
        let (assembled, _) = system.tangent(&State::new(p_kpa, u, Vec::new())).unwrap();
        assert_eq!(assembled.contact_points, contact.num_active());
        let whole = difference(assembled.residual.as_flattened(), found.gradient.as_slice());
        assert!(whole < 1e-14, "{whole:.1e}");
    }
}

/// For every degree of freedom whether it is the displacement across the symmetry plane of a node on the cavity's rim.
fn is_across_rim(problem: &Problem) -> Vec<bool> {
    let mut across = vec![false; problem.num_dofs()];
    for facet in problem.cavity_facets() {
        for node in problem.mesh.facet_nodes(facet) {
            across[3 * node as usize + 1] |= problem.mesh.nodes[node as usize][1] == 0.0;
        }
    }
    across
}

/// One Newton step of the production path, sparse, condensed, constraints eliminated, is the step of the dense KKT system with
/// pressures and multipliers as unknowns; also when the linearisation carries pressures of its own and when supports
/// move.
///
/// The multipliers *across the rim* of the cavity are left out: the production tangent is symmetrised there, which is no error
/// for held displacements but leaves a part of the change of pressure out of these multipliers' linearisation. They
/// are right once the residual is that of the final state, as in the load paths below.
#[test]
fn one_newton_step() {
    for (formulation, method) in
        [(Formulation::Hex8Sri, ContactMethod::SinglePoint), (Formulation::Hex8Q1p0, ContactMethod::MultiPoint)]
    {
        let problem = coarse_chambers(formulation, Invariant::Isochoric, method);
        let (u, p_kpa) = (leaning(&problem), 35.0);
        let n = problem.mesh.num_nodes();
        let mut system = System::new(&problem, Parallelism::Threads).unwrap();
        system.predict(&u, None);
        let state = State::new(p_kpa, u.clone(), Vec::new());
        system.residual(&state).unwrap();
        // A correction that leaves the gap's walls alone, so that contact tractions are carried over as they are.
        let mut earlier = noise(n, 1e-3, 5);
        for pair in &problem.contact_pairs {
            for &facet in pair.slave.iter().chain(&pair.master) {
                for node in problem.mesh.facet_nodes(facet) {
                    earlier[node as usize] = [0.0; 3];
                }
            }
        }
        system.predict(&u, Some(&earlier));
        let solid = Solid::new(problem.mesh.clone(), formulation, &problem.material).unwrap();
        let carried = solid.element_pressures(&u, Some(&earlier));
        assert!(difference(&carried, &solid.element_pressures(&u, None)) > 1e-3);

        let reference = ReferenceSolver::new(&problem).unwrap();
        let multipliers: Vec<f64> = noise(n, 1.0, 6).as_flattened()[..reference.held().len()].to_vec();
        let across_rim = is_across_rim(&problem);
        let mut moved = noise(n, 0.1, 7);
        for (value, across) in moved.as_flattened_mut().iter_mut().zip(&across_rim) {
            if *across {
                *value = 0.0;
            }
        }
        for prescribed in [None, Some(moved)] {
            let (assembled, tangent) = system.tangent(&state).unwrap();
            assert!(assembled.contact_points >= 4);
            let correction = system.solve(&tangent, &assembled, prescribed.as_deref()).unwrap();
            let updated = system.multipliers(&tangent, &assembled, &correction).unwrap();

            let moved = prescribed.unwrap_or_else(|| vec![[0.0; 3]; n]);
            let kkt = reference.kkt_system(
                u.as_flattened(),
                &carried,
                &multipliers,
                LoadParameter(p_kpa),
                moved.as_flattened(),
            );
            let kkt = kkt.unwrap();
            let step = kkt.solve().unwrap();
            let (dofs, pressures) = (3 * n, carried.len());
            let displacements = difference(correction.displacement.as_flattened(), &step.as_slice()[..dofs]);
            let new_pressures: Vec<f64> =
                carried.iter().zip(&step.as_slice()[dofs..]).map(|(old, change)| old + change).collect();
            let pressures_differ =
                difference(&solid.element_pressures(&u, Some(&correction.displacement)), &new_pressures);
            let changes = multipliers.iter().zip(&step.as_slice()[dofs + pressures..]);
            let (found, expected): (Vec<f64>, Vec<f64>) = (reference.held().iter().zip(changes))
                .filter(|(dof, _)| !across_rim[**dof])
                .map(|(&dof, (old, change))| (updated[dof], old + change))
                .unzip();
            let reactions = difference(&found, &expected);
            println!("{formulation} {method:?}: {displacements:.1e}, {pressures_differ:.1e}, {reactions:.1e}");
            assert!(
                displacements < 1e-9 && pressures_differ < 1e-9 && reactions < 1e-9,
                "{formulation} {method:?}: {displacements:.1e}, {pressures_differ:.1e}, {reactions:.1e}"
            );
        }
    }
}

/// Follows the path of two chambers both ways; at 5 kPa, where all methods of contact are alike, they do not touch, later they do.
fn check_path(formulation: Formulation, invariant: Invariant, method: ContactMethod) {
    let name = format!("{formulation} {invariant:?} {method:?}");
    let problem = coarse_chambers(formulation, invariant, method);
    let pressures = if method == ContactMethod::MultiPoint { &[5.0, 20.0, 35.0][..] } else { &[20.0, 35.0] };
    let (reference, expected) = follow_reference(&problem, pressures);
    let found = follow(&problem, pressures, &strict());
    for (found, expected) in found.iter().zip(&expected) {
        let active = touching(&reference, expected);
        assert_eq!(found.contact_points, active, "{name}");
        assert_eq!(active > 0, method != ContactMethod::None && found.parameter.0 > 5.0, "{name}: {active}");
    }
    assert_same_states(&name, &found, &expected);
}

/// Every two of element, invariant and contact meet; the paper's three meet each other. What a path adds to the residuals and tangents above is
/// the way from load to load.
#[test]
fn path_without_contact() {
    check_path(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::None);
    check_path(Formulation::Hex8Sri, Invariant::Full, ContactMethod::None);
}

#[test]
fn path_with_single_point_contact() {
    check_path(Formulation::Hex8Q1p0, Invariant::Full, ContactMethod::SinglePoint);
    check_path(Formulation::Hex8Sri, Invariant::Isochoric, ContactMethod::SinglePoint);
}

#[test]
fn path_with_multi_point_contact() {
    for invariant in INVARIANTS {
        check_path(Formulation::Hex8Q1p0, invariant, ContactMethod::MultiPoint);
    }
}

/// The paper's element, invariant and contact.
#[test]
fn path_as_in_the_paper() {
    check_path(Formulation::Hex8Sri, Invariant::Full, ContactMethod::MultiPoint);
}

#[test]
fn path_of_quadratic_elements() {
    let mut actuator = Actuator { chambers: 1, ..Actuator::two_chambers() };
    actuator.channel.half_width = 0.0;
    for (formulation, invariant, size) in [
        (Formulation::Hex20, Invariant::Full, [8.0, 9.0, 8.0]),
        (Formulation::Hex20, Invariant::Isochoric, [8.0, 9.0, 8.0]),
        (Formulation::Hex27, Invariant::Full, [8.0, 9.0, 8.0]),
        (Formulation::Tet10, Invariant::Full, [8.0, 9.0, 8.0]),
        (Formulation::Tet10, Invariant::Isochoric, [8.0, 9.0, 8.0]),
    ] {
        let problem = actuator_problem(&actuator, size, formulation, invariant, ContactMethod::None);
        let pressures = [10.0, 20.0];
        let (_, expected) = follow_reference(&problem, &pressures);
        let found = follow(&problem, &pressures, &strict());
        assert_same_states(&format!("{formulation} {invariant:?}"), &found, &expected);
    }
}

/// Mooney–Rivlin with the logarithmic energy, base and walls of different stiffness.
#[test]
fn path_of_two_materials() {
    let mut actuator = Actuator { chambers: 1, ..Actuator::two_chambers() };
    actuator.channel.half_width = 0.0;
    for formulation in [Formulation::Hex8Q1p0, Formulation::Hex27] {
        let mut problem =
            actuator_problem(&actuator, [8.0, 9.0, 8.0], formulation, Invariant::Isochoric, ContactMethod::None);
        problem.material = Material {
            volumetric: Volumetric::Logarithmic,
            ..Law::Polynomial { c10: 0.2, c01: 0.07, c20: 0.0, c11: 0.0, c02: 0.0 }.into()
        };
        let mesh = &problem.mesh;
        let is_low = |&element: &u32| {
            let nodes = mesh.element(element as usize);
            nodes.iter().map(|&n| mesh.nodes[n as usize][2]).sum::<f64>() < 4.0 * nodes.len() as f64
        };
        let elements: Vec<u32> = (0..mesh.num_elements() as u32).filter(is_low).collect();
        assert!(!elements.is_empty() && elements.len() < mesh.num_elements());
        problem.regions = vec![Region { name: "base".into(), elements, material: Law::NeoHooke { c10: 0.6 }.into() }];
        let pressures = [10.0, 20.0];
        let (_, expected) = follow_reference(&problem, &pressures);
        let found = follow(&problem, &pressures, &strict());
        assert_same_states(&format!("{formulation}"), &found, &expected);
    }
}

/// The potential −p V with V = −⅓ ∮ r·n dS has the right derivatives along the symmetry plane. Across it, its gradient has an
/// extra term on the cavity's rim, δV = −∮ δr·n dS + ⅓ ∮ (r × δr)·dl, of which in the plane only δy counts: y-forces
/// that go straight into the support. Displacements and all other reactions are the same.
#[test]
fn reference_volume_by_thirds_adds_forces_on_the_rim_only() {
    let problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint);
    let across_rim = is_across_rim(&problem);
    let u = leaning(&problem);
    let facets = problem.cavity_facets();
    let [thirds, across_y] = [CLOSED, ACROSS_Y]
        .map(|weights| AirModel::new(&problem, &facets, weights, 0.0).unwrap().gradient(u.as_flattened(), 0.035));
    let extra = thirds - across_y;
    assert!(extra.amax() > 1e-2, "{:.1e} N", extra.amax());
    for (dof, force) in extra.iter().enumerate() {
        assert!(across_rim[dof] || force.abs() < 1e-13, "{force:.1e} N at degree of freedom {dof}");
    }

    let by_thirds = ReferenceSolver::with_volume_weights(&problem, CLOSED).unwrap();
    let state = by_thirds.follow_path(&[20.0], &PathOptions::default()).unwrap().remove(0);
    let reached = follow(&problem, &[20.0], &strict()).remove(0);
    assert!(difference(reached.displacement.as_flattened(), &state.displacement) < 1e-8);
    let reaction = state.reaction();
    let largest = reaction.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let mut different = 0;
    for (dof, (found, by_thirds)) in reached.reaction.as_flattened().iter().zip(&reaction).enumerate() {
        let is_same = (found - by_thirds).abs() < 1e-6 * largest;
        assert!(is_same || across_rim[dof], "degree of freedom {dof}: {found} {by_thirds}");
        different += usize::from(!is_same);
    }
    assert!(different > 5);
}
