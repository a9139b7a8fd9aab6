//! Every contribution: residual against the energy, tangent against the residual, in a deformed state.

use std::sync::Arc;

use pneuflex_assembly::{
    Assembler, BoundaryTerm, Couplings, FollowerPressure, LocalContribution, Mixed, Prediction, Request, Solid, Totals,
};
use pneuflex_factor::multiply;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Actuator, Mesh, MeshSize, build_actuator};
use pneuflex_model::{Formulation, Invariant, Material, Pressure, Volumetric};

/// Every law with every volumetric form.
fn materials() -> Vec<Material> {
    let samples = pneuflex_laws::samples();
    let isochoric = samples.iter().filter(|material| material.invariant == Invariant::Isochoric).cloned();
    let logarithmic = isochoric.map(|material| Material { volumetric: Volumetric::Logarithmic, ..material });
    logarithmic.collect::<Vec<_>>().into_iter().chain(samples).collect()
}

/// Two skewed elements.
fn skewed(formulation: Formulation) -> Mesh {
    Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1])
        .mesh_all(formulation.element_kind())
        .map_nodes(|x| [x[0] + 0.1 * x[1] * x[2], x[1] + 0.07 * x[0] * x[2], x[2] + 0.05 * x[0] * x[0]])
}

fn deformation(mesh: &Mesh, amount: f64) -> Vec<[f64; 3]> {
    mesh.nodes
        .iter()
        .map(|x| {
            [
                amount * (0.3 * x[0] + 0.2 * (1.3 * x[1] + x[2]).sin()),
                amount * (0.25 * (0.8 * x[0] - x[2]).cos() - 0.1 * x[1]),
                amount * (0.2 * x[2] + 0.15 * (x[0] + 0.7 * x[1]).sin()),
            ]
        })
        .collect()
}

fn totals(contribution: &dyn LocalContribution, u: &[[f64; 3]], request: Request) -> (Assembler, Totals) {
    let mut assembler = Assembler::new(u.len(), &[contribution], &[]);
    let mut totals = Totals::default();
    assembler.reset(&mut totals, request);
    assembler.add(0, contribution, u, request, &mut totals).unwrap();
    (assembler, totals)
}

/// Checks residual and tangent by central differences along every degree of freedom that `is_free`.
fn check(name: &str, contribution: &dyn LocalContribution, u: &[[f64; 3]], is_free: impl Fn(usize) -> bool) {
    let (assembler, here) = totals(contribution, u, Request::Tangent);
    let residual = here.residual.as_flattened();
    let largest = residual.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let stiffest = here.tangent.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(largest > 1e-3 && stiffest > 1e-3, "{name}: the check would be empty");
    let h = 1e-5;
    for dof in (0..3 * u.len()).filter(|&dof| is_free(dof)) {
        let shifted = |by: f64| {
            let mut moved = u.to_vec();
            moved[dof / 3][dof % 3] += by;
            totals(contribution, &moved, Request::Residual).1
        };
        let (low, high) = (shifted(-h), shifted(h));
        let slope = (high.energy - low.energy) / (2.0 * h);
        assert!(
            (slope - residual[dof]).abs() < 1e-7 * stiffest.max(largest),
            "{name} residual {dof}: {} {slope}",
            residual[dof]
        );
        let mut unit = vec![0.0; 3 * u.len()];
        unit[dof] = 1.0;
        let mut column = vec![0.0; unit.len()];
        multiply::<3>(assembler.pattern(), &here.tangent, &unit, &mut column).unwrap();
        for other in (0..column.len()).filter(|&other| is_free(other)) {
            let slope = (high.residual.as_flattened()[other] - low.residual.as_flattened()[other]) / (2.0 * h);
            assert!(
                (slope - column[other]).abs() < 1e-7 * stiffest,
                "{name} tangent {other},{dof}: {} {slope}",
                column[other]
            );
        }
    }
}

#[test]
fn solid_residual_and_tangent_are_derivatives_of_the_energy() {
    for formulation in Formulation::ALL {
        for material in materials() {
            let mesh = skewed(formulation);
            // A soft bulk keeps the difference quotient's digits.
            let material = Material { bulk_modulus: 3.0, ..material };
            let solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
            check(&format!("{formulation} {material:?}"), &solid, &deformation(&mesh, 0.8), |_| true);
        }
    }
}

/// Along motions of all nodes at rest, by differences of the energy.
#[test]
fn configurational_forces_are_the_energys_slopes_by_the_nodes_at_rest() {
    for formulation in Formulation::ALL {
        for material in materials() {
            let (mesh, material) = (skewed(formulation), Material { bulk_modulus: 3.0, ..material });
            let u = deformation(&mesh, 0.8);
            let solid = |mesh: Mesh| Solid::new(mesh, formulation, &material).unwrap();
            let forces = solid(mesh.clone()).configurational_forces(&u).unwrap();
            for turn in 0..3 {
                let motion: Vec<[f64; 3]> = deformation(&mesh, 1.0)
                    .iter()
                    .map(|v| std::array::from_fn(|k| v[(k + turn) % 3] + 0.3 * (5.0 * v[k]).sin()))
                    .collect();
                let energy = |t: f64| {
                    let mut moved = mesh.clone();
                    let pairs = moved.nodes.as_flattened_mut().iter_mut().zip(motion.as_flattened());
                    pairs.for_each(|(x, v)| *x += t * v);
                    totals(&solid(moved), &u, Request::Energy).1.energy
                };
                let h = 1e-4;
                let slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
                let found: f64 = forces.as_flattened().iter().zip(motion.as_flattened()).map(|(f, v)| f * v).sum();
                assert!((slope - found).abs() < 1e-8 * found.abs(), "{formulation} {material:?}: {found} {slope}");
                assert!(found.abs() > 1e-3, "{formulation} {material:?}: the check would be empty");
            }
        }
    }
}

/// A brick whose edge is collapsed to a wedge's: two of its places are one node.
#[test]
fn a_brick_with_a_repeated_node_has_its_whole_tangent() {
    for formulation in [Formulation::Hex8Sri, Formulation::Hex8Q1p0] {
        let mut wedge = skewed(formulation);
        wedge.nodes =
            vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.0, 0.0], [0.0, 0.1, 1.0], [1.1, 0.0, 1.0], [0.1, 0.9, 1.2]];
        wedge.connectivity = vec![0, 1, 2, 2, 3, 4, 5, 5];
        let material = Material { bulk_modulus: 3.0, ..Material::default() };
        let solid = Solid::new(wedge.clone(), formulation, &material).unwrap();
        check(&format!("wedge, {formulation}"), &solid, &deformation(&wedge, 0.8), |_| true);
    }
}

#[test]
fn pressure_residual_and_tangent_are_derivatives_of_the_potential() {
    for formulation in Formulation::ALL {
        let size = MeshSize::uniform(9.0);
        let actuator = Actuator { chambers: 1, ..Actuator::two_chambers() };
        let mesh = build_actuator(&actuator, &size, formulation.element_kind()).unwrap();
        let mut pressure = FollowerPressure::new(mesh.clone(), mesh.facet_set("cavity"));
        pressure.pressure = Pressure::from_mpa(0.3);
        let symmetry = mesh.node_set("symmetry").to_vec();
        let mut u = deformation(&mesh, 0.5);
        for &node in &symmetry {
            u[node as usize][1] = 0.0;
        }
        let free = |dof: usize| dof % 3 != 1 || symmetry.binary_search(&((dof / 3) as u32)).is_err();
        check(&format!("{formulation}"), &pressure, &u, free);
    }
}

#[test]
fn pressure_volume_is_the_cavity_and_follows_a_rigid_motion() {
    let size = MeshSize::uniform(2.0);
    let mesh = build_actuator(&Actuator::two_chambers(), &size, Formulation::Hex20.element_kind()).unwrap();
    let pressure = FollowerPressure::new(mesh.clone(), mesh.facet_set("cavity"));
    let rest = vec![[0.0; 3]; mesh.num_nodes()];
    let air = 2.0 * 6.0 * 9.0 * 8.0 + 16.0 + 12.0;
    assert!((pressure.volume(&rest) - air).abs() < 1e-9);
    // Any motion within the symmetry plane.
    let (c, s) = (0.6, 0.8);
    let turned: Vec<_> =
        mesh.nodes.iter().map(|x| [c * x[0] - s * x[2] + 3.0 - x[0], 0.0, s * x[0] + c * x[2] - 7.0 - x[2]]).collect();
    assert!((pressure.volume(&turned) - air).abs() < 1e-9);
}

#[test]
fn carried_pressures_change_the_geometric_tangent_only() {
    let forms = [Volumetric::Quadratic, Volumetric::Logarithmic];
    for (formulation, volumetric) in Formulation::ALL.into_iter().flat_map(|f| forms.map(|form| (f, form))) {
        let mesh = skewed(formulation);
        let material = Material { volumetric, ..Material::default() };
        let mut solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
        let u = deformation(&mesh, 0.3);
        let (_, plain) = totals(&solid, &u, Request::Tangent);
        carry(&mut solid, &u, None);
        let (_, same) = totals(&solid, &u, Request::Tangent);
        assert_eq!(plain, same, "carrying the residual's own pressure changes nothing");
        let correction = deformation(&mesh, 1e-3);
        carry(&mut solid, &u, Some(&correction));
        let (_, other) = totals(&solid, &u, Request::Tangent);
        assert_eq!(plain.residual, other.residual);
        assert_ne!(plain.tangent, other.tangent);
        // p(θ) is extrapolated linearly.
        let moved: Vec<[f64; 3]> =
            u.iter().zip(&correction).map(|(a, b)| std::array::from_fn(|k| a[k] + 1e-4 * b[k])).collect();
        let small: Vec<[f64; 3]> = correction.iter().map(|b| b.map(|x| 1e-4 * x)).collect();
        let predicted = solid.element_pressures(&u, Some(&small));
        let actual = solid.element_pressures(&moved, None);
        let start = solid.element_pressures(&u, None);
        for ((p, a), s) in predicted.iter().zip(&actual).zip(&start) {
            assert!((p - a).abs() < 1e-3 * (a - s).abs().max(1e-6), "{formulation} {volumetric:?}: {s} {p} {a}");
        }
    }
}

/// Lets the next tangent carry the pressures of a state, or those predicted for a correction.
fn carry(solid: &mut Solid, displacement: &[[f64; 3]], correction: Option<&[[f64; 3]]>) {
    let (displacement, correction) = (displacement.to_vec(), correction.map(<[_]>::to_vec));
    solid.predict(&Arc::new(Prediction { displacement, correction, ..Prediction::default() }));
    solid.linearise();
}

/// Pressure on an open surface: symmetric part and rim together are the derivative of the load.
#[test]
fn pressure_on_an_open_surface() {
    for formulation in
        [Formulation::Hex8Q1p0, Formulation::Hex20, Formulation::Hex27, Formulation::Tet10, Formulation::Tet15]
    {
        let mesh = skewed(formulation);
        let facets = mesh.boundary_facets().into_iter().filter(|facet| facet.element < 3).take(3).collect::<Vec<_>>();
        let (mut pressure, rim) =
            (FollowerPressure::new(mesh.clone(), &facets), BoundaryTerm::new(mesh.clone(), &facets));
        pressure.pressure = Pressure::from_mpa(0.3);
        let u = deformation(&mesh, 0.4);
        let (assembler, here) = totals(&pressure, &u, Request::Tangent);
        let mut couplings = Couplings::default();
        rim.couple(pressure.pressure, &u, &mut couplings);
        let couplings = couplings.condensed(&vec![false; 3 * u.len()]);
        let (h, mut largest) = (1e-5, 0.0_f64);
        for dof in 0..3 * u.len() {
            let shifted = |by: f64| {
                let mut moved = u.clone();
                moved[dof / 3][dof % 3] += by;
                totals(&pressure, &moved, Request::Residual).1.residual
            };
            let (low, high) = (shifted(-h), shifted(h));
            let mut unit = vec![0.0; 3 * u.len()];
            unit[dof] = 1.0;
            let mut column = vec![0.0; 3 * u.len()];
            multiply::<3>(assembler.pattern(), &here.tangent, &unit, &mut column).unwrap();
            let mut skew = vec![0.0; 3 * u.len()];
            couplings.add_product(&unit, &mut skew);
            for (i, (a, b)) in low.as_flattened().iter().zip(high.as_flattened()).enumerate() {
                let slope = (b - a) / (2.0 * h);
                assert!(
                    (slope - column[i] - skew[i]).abs() < 1e-9,
                    "{formulation:?} {i} {dof}: {slope} {} {}",
                    column[i],
                    skew[i]
                );
                largest = largest.max(skew[i].abs());
            }
        }
        assert!(largest > 1e-2, "{formulation:?}: the check would be empty, {largest}");
        // Without free ends there is nothing to add, nor around a closed surface.
        let all = mesh.boundary_facets();
        let mut closed = Couplings::default();
        BoundaryTerm::new(mesh.clone(), &all).couple(Pressure::from_mpa(0.3), &u, &mut closed);
        assert!(closed.is_empty());
        rim.couple(Pressure::from_mpa(0.3), &u, &mut closed);
        assert!(closed.condensed(&vec![true; 3 * u.len()]).is_empty());
    }
}
