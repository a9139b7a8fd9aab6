//! Eigenvalues of the stiffness at rest: rigid motions are the only motions without energy.

use nalgebra::DMatrix;
use pneuflex_assembly::{Assembler, LocalContribution, Request, Solid, Totals};
use pneuflex_factor::multiply;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Mesh};
use pneuflex_model::{Formulation, Material};

/// Stiffness of a body at rest, N/mm.
fn stiffness(mesh: &Mesh, formulation: Formulation, bulk_modulus: f64) -> DMatrix<f64> {
    let material = Material { bulk_modulus, ..Material::default() };
    let solid = Solid::new(mesh.clone(), formulation, &material).unwrap();
    let rest = vec![[0.0; 3]; mesh.num_nodes()];
    let mut assembler = Assembler::new(rest.len(), &[&solid as &dyn LocalContribution], &[]);
    let mut totals = Totals::default();
    assembler.reset(&mut totals, Request::Tangent);
    assembler.add(0, &solid, &rest, Request::Tangent, &mut totals).unwrap();
    let n = 3 * rest.len();
    let mut stiffness = DMatrix::zeros(n, n);
    for column in 0..n {
        let mut unit = vec![0.0; n];
        unit[column] = 1.0;
        let mut product = vec![0.0; n];
        multiply::<3>(assembler.pattern(), &totals.tangent, &unit, &mut product).unwrap();
        stiffness.column_mut(column).copy_from_slice(&product);
    }
    assert!((&stiffness - stiffness.transpose()).amax() < 1e-12 * stiffness.amax());
    stiffness
}

/// Eigenvalues in ascending order.
fn eigenvalues(matrix: DMatrix<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Six eigenvalues are zero, and the seventh is above `least` (N/mm).
#[track_caller]
fn check(name: &str, values: &[f64], least: f64) {
    let largest = values[values.len() - 1];
    let of_rigid_motions = values[..6].iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    println!("{name}: six of {of_rigid_motions:.1e}, then {:.4} … {largest:.1} N/mm", values[6]);
    assert!(of_rigid_motions < 1e-12 * largest, "{name}: {:?}", &values[..8]);
    assert!(values[6] > least, "{name}: {:?}", &values[..8]);
}

/// One element of edge 1 mm; hexahedra as they are and slanted, the tetrahedron as one of a cube's six.
fn single(kind: ElementKind, is_slanted: bool) -> Mesh {
    let mut mesh = Lattice::uniform([0.0; 3], [1.0; 3], [1; 3]).mesh_all(kind);
    if kind == ElementKind::Tet10 {
        mesh.connectivity.truncate(10);
        let mut used = mesh.connectivity.clone();
        used.sort_unstable();
        mesh.nodes = used.iter().map(|&n| mesh.nodes[n as usize]).collect();
        for node in &mut mesh.connectivity {
            *node = used.binary_search(node).unwrap() as u32;
        }
    }
    let slant = if is_slanted { 0.2 } else { 0.0 };
    mesh.map_nodes(|[x, y, z]| [x + slant * y, y + 0.5 * slant * x * z, z - slant * x])
}

#[test]
fn a_free_element_has_six_zero_eigenvalues() {
    for formulation in Formulation::ALL {
        for is_slanted in [false, true] {
            for bulk_modulus in [1.0, 1000.0] {
                let mesh = single(formulation.element_kind(), is_slanted);
                let values = eigenvalues(stiffness(&mesh, formulation, bulk_modulus));
                // A hundredth of μ = 2 C10 times the edge.
                check(&format!("{formulation}, κ = {bulk_modulus}, slanted: {is_slanted}"), &values, 5e-3);
            }
        }
    }
}

/// Softest motions of a free strip are its bendings: the more elements, the softer, but never without energy.
#[test]
fn a_free_strip_has_six_zero_eigenvalues() {
    for formulation in Formulation::ALL {
        let mesh = Lattice::uniform([0.0; 3], [4.0, 1.0, 1.0], [4, 1, 1]).mesh_all(formulation.element_kind());
        let values = eigenvalues(stiffness(&mesh, formulation, 1000.0));
        check(&format!("4 × 1 × 1 {formulation}"), &values, 5e-3);
    }
}

/// Inf-sup constants β of a cube with all of its boundary held, by the test of Chapelle & Bathe (1993, *Comput. Struct.* 47),
/// in ascending order: β² are the eigenvalues of Bᵀ M⁻¹ B u = β² A u but for the kernel of B, A being the stiffness less the
/// volumetric one, κ Bᵀ M⁻¹ B, divided by μ. As many as there are pressures, less the constant one.
fn inf_sup_constants(formulation: Formulation, cells: usize, pressures_per_element: usize) -> Vec<f64> {
    let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [cells; 3]).mesh_all(formulation.element_kind());
    let is_inner = |x: [f64; 3]| x.iter().all(|t| *t > 1e-9 && *t < 1.0 - 1e-9);
    let inner: Vec<usize> =
        mesh.select_nodes(is_inner).iter().flat_map(|&n| (0..3).map(move |k| 3 * n as usize + k)).collect();
    let free = |matrix: DMatrix<f64>| matrix.select_rows(&inner).select_columns(&inner);
    let [soft, stiff] = [2.0, 3.0].map(|kappa| free(stiffness(&mesh, formulation, kappa)));
    let volumetric = &stiff - &soft;
    let mu = Material::default().shear_modulus();
    let factor = ((soft - 2.0 * &volumetric) / mu).cholesky().unwrap().l();
    let half = factor.solve_lower_triangular(&volumetric).unwrap();
    let pencil = factor.solve_lower_triangular(&half.transpose()).unwrap();
    let values = eigenvalues(pencil);
    let pressures = pressures_per_element * mesh.num_elements() - 1;
    values[values.len() - pressures..].iter().map(|squared| squared.max(0.0).sqrt()).collect()
}

/// The triquadratic hexahedron with a linear pressure keeps its inf-sup constant under refinement.
#[test]
fn triquadratic_hexahedra_are_inf_sup_stable() {
    let constants = [2, 3, 4].map(|cells| inf_sup_constants(Formulation::Hex27, cells, 4)[0]);
    println!("hex27: {constants:.4?}");
    assert!(constants[2] > 0.3 && constants[2] > 0.9 * constants[1], "{constants:.4?}");
}

/// The serendipity hexahedron lacks the nodes at the centres of faces: on a cube with all of its boundary held, a share of
/// the pressures is not controlled at all.
#[test]
fn serendipity_hexahedra_have_spurious_pressures() {
    for cells in [3, 4, 5] {
        let constants = inf_sup_constants(Formulation::Hex20, cells, 4);
        let spurious = constants.iter().filter(|beta| **beta < 1e-6).count();
        println!("hex20, {cells} cells: {spurious} of {}, then {:.4}", constants.len(), constants[spurious]);
        assert!(spurious > 0 && spurious < constants.len() / 3);
    }
}

/// The inf-sup constant of P2–P0 on Kuhn's tetrahedra falls like h, not faster; three pressures live in corners of which all
/// displacements but one are held.
#[test]
fn tetrahedra_are_inf_sup_stable_up_to_a_factor_h() {
    for cells in [2, 3, 4] {
        let constants = inf_sup_constants(Formulation::Tet10, cells, 1);
        println!("tet10, {cells} cells: {:.4?}", &constants[..6]);
        assert!(constants[2] < 1e-6 && constants[3] > 0.15 / cells as f64, "{:.4?}", &constants[..6]);
    }
}
