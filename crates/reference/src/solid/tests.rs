//! Tests of the solid against differences, balances and closed forms.

use pneuflex_model::Invariant;

use super::*;
use crate::testing::{INVARIANTS, block, body, check_derivatives, displacement, material, noise};

#[test]
fn derivatives_of_the_primal_energy() {
    for formulation in Formulation::ALL {
        for invariant in INVARIANTS {
            let mesh = block(formulation, [1.0, 1.2, 0.8], [2, 1, 1], 0.05);
            let model = SolidModel::new(&body(mesh, formulation, material(invariant))).unwrap();
            let u = noise(model.num_dofs(), 0.04);
            check_derivatives(|u| model.energy(u), |u| model.gradient(u), |u| model.hessian(u), &u);
        }
    }
}

#[test]
fn derivatives_of_the_saddle_energy() {
    let logarithmic = Material { volumetric: Volumetric::Logarithmic, ..material(Invariant::Isochoric) };
    let materials = [material(Invariant::Isochoric), logarithmic];
    for (formulation, material) in Formulation::ALL.into_iter().flat_map(|f| materials.clone().map(|m| (f, m))) {
        let mesh = block(formulation, [1.0, 1.2, 0.8], [1, 1, 1], 0.05);
        let model = SolidModel::new(&body(mesh, formulation, material)).unwrap();
        let n = model.num_dofs();
        let x = [noise(n, 0.04), noise(model.num_pressures(), 0.3)].concat();
        check_derivatives(
            |x| model.saddle_energy(&x[..n], &x[n..]),
            |x| model.saddle_gradient(&x[..n], &x[n..]),
            |x| model.saddle_hessian(&x[..n], &x[n..]),
            &x,
        );
    }
}

/// The volumetric energy as the module's text defines it, summed by hand.
#[test]
fn primal_energy_is_the_one_in_the_text() {
    for formulation in Formulation::ALL {
        let mut mesh = block(formulation, [1.0, 1.2, 0.8], [1, 1, 1], 0.05);
        // One element: of the cube's tetrahedra, the first.
        mesh.connectivity.truncate(mesh.kind_of(0).num_nodes());
        let stretched = displacement(&mesh, |[x, y, z]| [1.1 * x, y + 0.2 * z, 1.05 * z]);
        let u: Vec<f64> = stretched.iter().zip(noise(stretched.len(), 0.05)).map(|(a, b)| a + b).collect();
        // Both moduli are large enough for κ_f not to depend on them.
        let energy = |bulk_modulus| {
            let material = Material { bulk_modulus, ..Material::default() };
            SolidModel::new(&body(mesh.clone(), formulation, material)).unwrap().energy(&u)
        };
        // Linear in κ: the difference is the volumetric energy for Δκ.
        let volumetric = energy(5.0) - energy(3.0);
        let shape = ShapeFunctions::of_element(mesh.kind_of(0)).unwrap();
        let order = if mesh.kind_of(0).is_quadratic() { 3 } else { 2 };
        let volumes = |xi: &[f64; 3]| {
            let gradients = shape.gradients(xi);
            let determinant = |moved: f64| {
                let position = |a: usize, i: usize| {
                    mesh.nodes[mesh.connectivity[a] as usize][i] + moved * u[3 * mesh.connectivity[a] as usize + i]
                };
                Matrix3::from_fn(|i, j| (0..gradients.len()).map(|a| position(a, i) * gradients[a][j]).sum())
                    .determinant()
            };
            (determinant(0.0), determinant(1.0))
        };
        let rule = match formulation {
            Formulation::Tet10 => quadrature::collapsed(3),
            Formulation::Hex20 => quadrature::irons(),
            Formulation::Tet15 => quadrature::tetrahedron_of_degree_5(),
            Formulation::Wedge21 => quadrature::prism(&quadrature::triangle_of_degree_5()),
            _ => quadrature::tensor(order),
        };
        let sum = |f: &dyn Fn(&[f64; 3], f64, f64) -> f64| -> f64 {
            rule.iter()
                .map(|(xi, w)| {
                    let (before, after) = volumes(xi);
                    w * f(xi, before, after)
                })
                .sum()
        };
        let volume = sum(&|_, before, _| before);
        let expected = match formulation {
            Formulation::Hex8Sri => {
                let (before, after) = volumes(&[0.0; 3]);
                (after / before - 1.0).powi(2) * volume
            }
            Formulation::Hex8Q1p0 | Formulation::Tet10 => (sum(&|_, _, after| after) / volume - 1.0).powi(2) * volume,
            _ => {
                let psi = |i: usize, xi: &[f64; 3]| if i == 0 { 1.0 } else { xi[i - 1] };
                let theta = DVector::from_fn(4, |i, _| sum(&|xi, before, after| psi(i, xi) * (after - before)));
                let mass = DMatrix::from_fn(4, 4, |i, j| sum(&|xi, before, _| psi(i, xi) * psi(j, xi) * before));
                theta.dot(&mass.lu().solve(&theta).unwrap())
            }
        };
        // ½ Δκ = 1.
        assert!(expected > 1e-3, "{formulation}: {expected}");
        assert!(
            (volumetric - expected).abs() < 1e-10 * expected.max(1.0),
            "{formulation}: {volumetric} for {expected}"
        );
    }
}

#[test]
fn rigid_rotations_leave_the_isochoric_solid_without_force() {
    for formulation in Formulation::ALL {
        let mesh = block(formulation, [1.0, 1.2, 0.8], [2, 1, 1], 0.05);
        let model = SolidModel::new(&body(mesh.clone(), formulation, material(Invariant::Isochoric))).unwrap();
        for degrees in [1.0_f64, 45.0, 90.0, 180.0] {
            let (s, c) = degrees.to_radians().sin_cos();
            let u = displacement(&mesh, |[x, y, z]| [c * x - s * z + 3.0, y - 1.0, s * x + c * z]);
            assert!(model.energy(&u).abs() < 1e-12);
            let force = model.gradient(&u).amax();
            assert!(force < 1e-10, "{formulation} at {degrees}°: {force:.1e} N");
        }
    }
}

#[test]
fn full_invariant_is_stressed_at_rest() {
    // P = 2 C10·1 at G = 1: the force on a unit face of a unit cube.
    let mesh = block(Formulation::Hex8Sri, [1.0; 3], [1; 3], 0.0);
    let model = SolidModel::new(&body(mesh.clone(), Formulation::Hex8Sri, material(Invariant::Full))).unwrap();
    let force = model.gradient(&[0.0; 24]);
    let total: f64 = mesh.select_nodes(|x| x[0] > 0.5).iter().map(|&n| force[3 * n as usize]).sum();
    assert!((total - 2.0 * 0.2712).abs() < 1e-12);
}

#[test]
fn bad_meshes_are_errors() {
    let mesh = block(Formulation::Hex20, [1.0; 3], [1; 3], 0.0);
    let problem = body(mesh, Formulation::Hex8Sri, Material::default());
    assert!(matches!(SolidModel::new(&problem), Err(ReferenceError::WrongElement { .. })));
    let mesh = block(Formulation::Hex8Sri, [1.0; 3], [1; 3], 0.0).map_nodes(|[x, y, z]| [-x, y, z]);
    let problem = body(mesh, Formulation::Hex8Sri, Material::default());
    assert!(matches!(SolidModel::new(&problem), Err(ReferenceError::InvertedElement { element: 0, .. })));
}
