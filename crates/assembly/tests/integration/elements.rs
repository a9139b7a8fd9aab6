//! Patch tests and rigid motions of every element formulation.

use pneuflex_assembly::{Assembler, LocalContribution, Request, Solid, Totals};
use pneuflex_mesh::Mesh;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::testing::angle;
use pneuflex_model::{Formulation, Invariant, Material};

/// 2 × 2 × 2 elements whose inner nodes are moved; straight edges stay straight, as patch tests require.
fn patch(formulation: Formulation) -> Mesh {
    let bump = |x: [f64; 3]| -> f64 { x.iter().map(|t| 1.0 - (t - 1.0).abs()).product() };
    // Piecewise trilinear, so that mid-edge nodes stay in the middle of their edges.
    Lattice::uniform([0.0; 3], [2.0; 3], [2, 2, 2]).mesh_all(formulation.element_kind()).map_nodes(|x| {
        let b = bump(x);
        [x[0] + 0.23 * b, x[1] - 0.17 * b, x[2] + 0.11 * b]
    })
}

/// Patches of every formulation, and an angle of hexahedra, wedges and tetrahedra whose inner nodes are moved.
fn patches() -> Vec<(Formulation, Mesh)> {
    let hat = |t: f64, at: f64| (1.0 - (t - at).abs()).max(0.0);
    let inner = [[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [2.0, 1.0, 2.0]];
    let bump = |x: [f64; 3]| -> f64 { inner.iter().map(|at| (0..3).map(|d| hat(x[d], at[d])).product::<f64>()).sum() };
    let mixed = angle(1).map_nodes(|x| {
        let b = bump(x);
        [x[0] + 0.23 * b, x[1] - 0.17 * b, x[2] + 0.11 * b]
    });
    let of_one = Formulation::ALL.into_iter().map(|formulation| (formulation, patch(formulation)));
    of_one.chain([(Formulation::Hex27, mixed)]).collect()
}

fn residual(solid: &Solid, u: &[[f64; 3]]) -> Totals {
    let mut assembler = Assembler::new(u.len(), &[solid as &dyn LocalContribution], &[]);
    let mut totals = Totals::default();
    assembler.reset(&mut totals, Request::Residual);
    assembler.add(0, solid, u, Request::Residual, &mut totals).unwrap();
    totals
}

#[test]
fn an_affine_map_is_in_equilibrium_at_every_inner_node() {
    let gradient = [[0.2, 0.15, -0.1], [0.05, -0.12, 0.2], [-0.07, 0.1, 0.18]];
    for (formulation, mesh) in patches() {
        let mut is_inner = vec![true; mesh.num_nodes()];
        for facet in mesh.boundary_facets() {
            mesh.facet_nodes(facet).into_iter().for_each(|node| is_inner[node as usize] = false);
        }
        assert!(is_inner.iter().any(|is_inner| *is_inner), "{formulation}");
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let material = Material { invariant, ..Material::default() };
            let solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
            let u: Vec<[f64; 3]> = mesh
                .nodes
                .iter()
                .map(|x| std::array::from_fn(|i| (0..3).map(|j| gradient[i][j] * x[j]).sum()))
                .collect();
            let totals = residual(&solid, &u);
            let largest = totals.residual.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            assert!(largest > 1.0, "the patch must be under stress");
            for ((x, r), is_inner) in mesh.nodes.iter().zip(&totals.residual).zip(&is_inner) {
                if *is_inner {
                    assert!(r.iter().all(|f| f.abs() < 1e-12 * largest), "{formulation} {invariant:?} at {x:?}: {r:?}");
                }
            }
        }
    }
}

#[test]
fn rigid_motions_up_to_half_a_turn_leave_the_stress_at_zero() {
    for (formulation, mesh) in patches() {
        let material = Material { invariant: Invariant::Isochoric, ..Material::default() };
        let solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
        for degrees in [1.0_f64, 30.0, 90.0, 180.0] {
            let (s, c) = degrees.to_radians().sin_cos();
            let u: Vec<[f64; 3]> = mesh
                .nodes
                .iter()
                .map(|x| {
                    let turned = [c * x[0] - s * x[2] + 5.0, x[1] - 3.0, s * x[0] + c * x[2] + 1.0];
                    std::array::from_fn(|k| turned[k] - x[k])
                })
                .collect();
            let totals = residual(&solid, &u);
            assert!(totals.energy.abs() < 1e-11, "{formulation} at {degrees}°: energy {}", totals.energy);
            for r in totals.residual.as_flattened() {
                // κ = 1000 MPa times the rounding of det F.
                assert!(r.abs() < 1e-11, "{formulation} at {degrees}°: {r}");
            }
        }
    }
}

#[test]
fn forces_balance_and_the_energy_is_that_of_the_homogeneous_state() {
    let stretch = 1.3;
    for (formulation, mesh) in patches().into_iter().filter(|(_, mesh)| mesh.kinds.only().is_some()) {
        let material = Material { invariant: Invariant::Isochoric, ..Material::default() };
        let solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
        let lateral = 1.0 / f64::sqrt(stretch);
        let u: Vec<[f64; 3]> = mesh
            .nodes
            .iter()
            .map(|x| [(stretch - 1.0) * x[0], (lateral - 1.0) * x[1], (lateral - 1.0) * x[2]])
            .collect();
        let totals = residual(&solid, &u);
        let i = stretch * stretch + 2.0 / stretch - 3.0;
        let energy = 8.0 * (0.2712 * i + 0.03053 * i * i - 0.0004013 * i.powi(3));
        assert!((totals.energy - energy).abs() < 1e-11, "{formulation}: {} for {energy}", totals.energy);
        // The volume does not change, so the elements' pressure is zero: P = 2 φ′ (λ − I₁/(3 λ)) on the face x = 2.
        let slope = 0.2712 + 2.0 * 0.03053 * i - 3.0 * 0.0004013 * i * i;
        let force = 4.0 * 2.0 * slope * (stretch - (i + 3.0) / (3.0 * stretch));
        let sum = |side: f64| -> f64 {
            mesh.nodes.iter().zip(&totals.residual).filter(|(x, _)| (x[0] - side).abs() < 1e-9).map(|(_, r)| r[0]).sum()
        };
        assert!((sum(2.0) - force).abs() < 1e-10 && (sum(0.0) + force).abs() < 1e-10, "{formulation}: {}", sum(2.0));
    }
}

#[test]
fn the_assembled_system_is_the_same_for_any_number_of_threads() {
    let mesh = Lattice::uniform([0.0; 3], [4.0; 3], [9, 8, 10]).mesh_all(Formulation::Hex8Q1p0.element_kind());
    let solid = Solid::new(mesh.clone(), Formulation::Hex8Q1p0, &Material::default()).unwrap();
    let u: Vec<[f64; 3]> =
        mesh.nodes.iter().map(|x| [0.1 * (x[0] * x[1]).sin(), 0.05 * x[2].cos(), 0.07 * (x[0] + x[2]).sin()]).collect();
    let assemble = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let mut assembler = Assembler::new(u.len(), &[&solid as &dyn LocalContribution], &[]);
            let mut totals = Totals::default();
            assembler.reset(&mut totals, Request::Tangent);
            assembler.add(0, &solid, &u, Request::Tangent, &mut totals).unwrap();
            totals
        })
    };
    let serial = assemble(1);
    for threads in [2, 3, 7] {
        assert_eq!(serial, assemble(threads), "{threads} threads");
    }
}
