//! Materials in elements: bodies of two materials with a known answer, the frame, states that no law describes.

use pneuflex_assembly::law::ElementMaterial;
use pneuflex_assembly::{Assembler, LocalBlock, LocalContribution, Request, Solid, Totals};
use pneuflex_material::{Kinematics, volumetric};
use pneuflex_mesh::Mesh;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::{Formulation, Law, Material, OgdenTerm, Volumetric};

fn ogden() -> Material {
    let terms = vec![OgdenTerm { mu: 0.5, alpha: 1.7 }, OgdenTerm { mu: 0.1, alpha: -2.4 }];
    Material { bulk_modulus: 20.0, ..Law::Ogden { terms }.into() }
}

fn mooney_rivlin() -> Material {
    let law = Law::Polynomial { c10: 0.1, c01: 0.03, c20: 0.0, c11: 0.0, c02: 0.0 };
    Material { bulk_modulus: 5.0, volumetric: Volumetric::Logarithmic, ..law.into() }
}

fn yeoh() -> Material {
    Material { bulk_modulus: 50.0, ..Material::default() }
}

/// P₁₁ of a bar stretched along x and held across, MPa.
fn held_bar(material: &Material, formulation: Formulation, stretch: f64) -> f64 {
    let k = Kinematics::new(&[[stretch - 1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]).unwrap();
    let m = ElementMaterial::new(material, formulation);
    m.law.energy_and_stress(&k).1[0][0]
        + m.bulk_modulus * volumetric::evaluate(material.volumetric, stretch - 1.0)[1]
        + m.fluctuation_modulus * (stretch - 1.0)
}

fn residual(solid: &Solid, u: &[[f64; 3]]) -> Totals {
    let mut assembler = Assembler::new(u.len(), &[solid as &dyn LocalContribution], &[]);
    let mut totals = Totals::default();
    assembler.reset(&mut totals, Request::Residual);
    assembler.add(0, solid, u, Request::Residual, &mut totals).unwrap();
    totals
}

/// A 2 × 1 × 1 bar in two halves along an axis, the first of which has the first material.
fn halves(formulation: Formulation, axis: usize, materials: [&Material; 2]) -> (Mesh, Solid) {
    let (mut size, mut cells) = ([1.0; 3], [1; 3]);
    (size[axis], cells[axis]) = (2.0, 2);
    let mesh = Lattice::uniform([0.0; 3], size, cells).mesh_all(formulation.element_kind());
    let is_second = |element: usize| {
        let nodes = mesh.element(element);
        nodes.iter().map(|&n| mesh.nodes[n as usize][axis]).sum::<f64>() > nodes.len() as f64
    };
    let material_of: Vec<u16> = (0..mesh.num_elements()).map(|element| u16::from(is_second(element))).collect();
    assert_eq!(2 * material_of.iter().filter(|&&m| m == 1).count(), material_of.len());
    let solid = Solid::of_materials(mesh.clone(), formulation, &materials, material_of).unwrap();
    (mesh, solid)
}

/// Sum of the forces along x on nodes at a place.
fn force(mesh: &Mesh, totals: &Totals, x: f64) -> f64 {
    let at = |node: &&(&[f64; 3], &[f64; 3])| (node.0[0] - x).abs() < 1e-9;
    mesh.nodes.iter().zip(&totals.residual).collect::<Vec<_>>().iter().filter(at).map(|(_, r)| r[0]).sum()
}

/// Springs side by side: the same stretch, forces add up.
#[test]
fn materials_in_parallel_share_the_stretch() {
    let stretch = 1.4;
    for formulation in Formulation::ALL {
        for materials in [[&yeoh(), &mooney_rivlin()], [&mooney_rivlin(), &ogden()], [&ogden(), &yeoh()]] {
            let (mesh, solid) = halves(formulation, 1, materials);
            let u: Vec<[f64; 3]> = mesh.nodes.iter().map(|x| [(stretch - 1.0) * x[0], 0.0, 0.0]).collect();
            let totals = residual(&solid, &u);
            let exact: f64 = materials.iter().map(|m| held_bar(m, formulation, stretch)).sum();
            assert!(exact > 1.0);
            let found = [force(&mesh, &totals, 1.0), -force(&mesh, &totals, 0.0)];
            assert!(found.iter().all(|f| (f - exact).abs() < 1e-12 * exact), "{formulation}: {found:?} for {exact}");
        }
    }
}

/// Springs one after the other: the same stress, and the stretches that belong to it.
#[test]
fn materials_in_series_share_the_stress() {
    for formulation in Formulation::ALL {
        for materials in [[&yeoh(), &mooney_rivlin()], [&mooney_rivlin(), &ogden()], [&ogden(), &yeoh()]] {
            let first = 1.02;
            let stress = held_bar(materials[0], formulation, first);
            let (mut low, mut high) = (1.0, 3.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if held_bar(materials[1], formulation, middle) < stress { low = middle } else { high = middle }
            }
            assert!((held_bar(materials[1], formulation, low) - stress).abs() < 1e-12 && low > 1.001);
            let (mesh, solid) = halves(formulation, 0, materials);
            let moved = |x: f64| (first - 1.0) * x.min(1.0) + (low - 1.0) * (x - 1.0).max(0.0);
            let u: Vec<[f64; 3]> = mesh.nodes.iter().map(|x| [moved(x[0]), 0.0, 0.0]).collect();
            let totals = residual(&solid, &u);
            for (x, r) in mesh.nodes.iter().zip(&totals.residual) {
                let is_inner = x[0] > 1e-9 && x[0] < 2.0 - 1e-9;
                assert!(!is_inner || r[0].abs() < 1e-11 * stress, "{formulation} at {x:?}: {r:?}");
            }
            let end = force(&mesh, &totals, 2.0);
            assert!((end - stress).abs() < 1e-11 * stress, "{formulation}: {end} for {stress}");
        }
    }
}

/// A state turned as a whole has the same energy and turned forces.
#[test]
fn forces_turn_with_the_body() {
    let turned = |v: [f64; 3]| {
        [0.36 * v[0] - 0.8 * v[1] + 0.48 * v[2], 0.48 * v[0] + 0.6 * v[1] + 0.64 * v[2], -0.8 * v[0] + 0.6 * v[2]]
    };
    for formulation in Formulation::ALL {
        for material in [yeoh(), mooney_rivlin(), ogden()] {
            let mesh = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(formulation.element_kind());
            let solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
            let bent = |x: &[f64; 3]| [x[0] + 0.1 * x[1] * x[2], 0.9 * x[1] + 0.2 * x[0], x[2] - 0.15 * x[0] * x[0]];
            let forces = |at: &dyn Fn([f64; 3]) -> [f64; 3]| {
                let moved = |x: &[f64; 3]| {
                    let y = at(bent(x));
                    std::array::from_fn(|k| y[k] - x[k])
                };
                residual(&solid, &mesh.nodes.iter().map(moved).collect::<Vec<_>>())
            };
            let (before, after) = (forces(&|x| x), forces(&turned));
            let largest = before.residual.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            assert!(largest > 0.1 && (before.energy - after.energy).abs() < 1e-12 * before.energy, "{formulation}");
            for (r, s) in before.residual.iter().zip(&after.residual) {
                let r = turned(*r);
                assert!((0..3).all(|k| (r[k] - s[k]).abs() < 1e-12 * largest), "{formulation}: {r:?} {s:?}");
            }
        }
    }
}

/// Exponents of 100 at a stretch of 10⁴ overflow; a mean volume of the wrong sign has no logarithm.
#[test]
fn states_that_a_law_does_not_describe_are_errors() {
    let evaluate = |material: &Material, formulation: Formulation, stretch: f64| {
        let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [1; 3]).mesh_all(formulation.element_kind());
        let solid = Solid::new(mesh.clone(), formulation, material).unwrap();
        let u: Vec<[f64; 3]> = mesh.nodes.iter().map(|x| [(stretch - 1.0) * x[0], 0.0, 0.0]).collect();
        let mut block = LocalBlock::default();
        block.reset(mesh.element(0).len(), Request::Residual);
        solid.evaluate(0, &u, Request::Residual, &mut block)
    };
    let stiff = Material::from(Law::Ogden { terms: vec![OgdenTerm { mu: 0.5, alpha: 100.0 }] });
    for formulation in Formulation::ALL {
        assert!(evaluate(&stiff, formulation, 1.2).is_ok());
        assert!(evaluate(&stiff, formulation, 1e6).is_err(), "{formulation}");
        let locks = Material::from(Law::Gent { shear_modulus: 0.5, jm: 2.0 });
        assert!(
            evaluate(&locks, formulation, 1.5).is_ok() && evaluate(&locks, formulation, 5.0).is_err(),
            "{formulation}"
        );
        assert!(evaluate(&mooney_rivlin(), formulation, 0.1).is_ok());
        let error = evaluate(&mooney_rivlin(), formulation, -0.1).unwrap_err();
        assert!((error.jacobian + 0.1).abs() < 1e-12, "{formulation}: {error}");
    }
}
