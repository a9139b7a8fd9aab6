//! Eigenvalues of the stiffness at rest: rigid motions are the only motions without energy.

use nalgebra::DMatrix;
use pneuflex_assembly::{Assembler, LocalContribution, Request, Solid, Totals};
use pneuflex_factor::multiply;
use pneuflex_laws::{law_of, samples};
use pneuflex_material::Kinematics;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::testing::{angle, mixed};
use pneuflex_mesh::{ElementKind, Mesh, ReferenceBody};
use pneuflex_model::{Formulation, Invariant, Law, Material};

/// Stiffness of a body at rest with the isochoric invariant, N/mm.
fn stiffness(mesh: &Mesh, formulation: Formulation, bulk_modulus: f64) -> DMatrix<f64> {
    let material = Material { bulk_modulus, ..Material::default() };
    stiffness_at(mesh, formulation, &material, [1.0; 3])
}

/// Stiffness of a body stretched along the axes, N/mm.
fn stiffness_at(mesh: &Mesh, formulation: Formulation, material: &Material, stretches: [f64; 3]) -> DMatrix<f64> {
    let solid = Solid::new(mesh.clone(), formulation, material).unwrap();
    let stretched: Vec<[f64; 3]> =
        mesh.nodes.iter().map(|x| std::array::from_fn(|k| (stretches[k] - 1.0) * x[k])).collect();
    let mut assembler = Assembler::new(stretched.len(), &[&solid as &dyn LocalContribution], &[]);
    let mut totals = Totals::default();
    assembler.reset(&mut totals, Request::Tangent);
    assembler.add(0, &solid, &stretched, Request::Tangent, &mut totals).unwrap();
    let n = 3 * stretched.len();
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

/// One element of edge 1 mm; hexahedra as they are and slanted, the tetrahedron as one of a cube's six, the wedge as one of its two.
fn single(kind: ElementKind, is_slanted: bool) -> Mesh {
    let mut mesh = Lattice::uniform([0.0; 3], [1.0; 3], [1; 3]).mesh_all(kind);
    if kind.body != ReferenceBody::Hexahedron {
        mesh.connectivity.truncate(kind.num_nodes());
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
        // Eigenvectors of length 1 move a node the less the more there are.
        check(&format!("4 × 1 × 1 {formulation}"), &values, 0.2 / mesh.num_nodes() as f64);
    }
}

#[test]
fn a_free_body_of_several_families_has_six_zero_eigenvalues() {
    let mesh = angle(1);
    assert_eq!(mesh.families().len(), 3);
    let values = eigenvalues(stiffness(&mesh, Formulation::Hex27, 1000.0));
    check("hex27, wedge21 and tet15", &values, 0.2 / mesh.num_nodes() as f64);
}

/// Stretches of a bar that is pulled to the stretch λ with nothing on its sides; `None`: with nothing on its ends either.
fn free_stretches(material: &Material, lambda: Option<f64>) -> [f64; 3] {
    let law = law_of(material);
    let along = |lateral: f64| lambda.unwrap_or(lateral);
    let stress = |lateral: f64| {
        let diagonal = [along(lateral), lateral, lateral];
        let h = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { diagonal[i] - 1.0 } else { 0.0 }));
        let kinematics = Kinematics::new(&h).unwrap();
        law.energy_and_stress(&kinematics).1[1][1]
            + material.bulk_modulus * kinematics.jacobian_minus_1 * kinematics.cofactor[1][1]
    };
    let middle = lambda.map_or(1.0, |lambda| lambda.powf(-0.5));
    let (mut low, mut high) = (0.8 * middle, 1.2 * middle);
    assert!(stress(low) < 0.0 && stress(high) > 0.0, "{material:?}");
    for _ in 0..60 {
        let half = 0.5 * (low + high);
        *(if stress(half) < 0.0 { &mut low } else { &mut high }) = half;
    }
    [along(low), low, low]
}

/// Materials of every law and invariant, and those whose C₂₀ does not make up for the pressure that the full invariant has at rest: long
/// trilinear bricks need one that is not negative.
fn materials(formulation: Formulation) -> Vec<Material> {
    let ratios: &[f64] = if formulation.element_kind() == ElementKind::Hex8 { &[0.01] } else { &[0.05, -0.2] };
    let full = ratios.iter().map(|ratio| Material {
        invariant: Invariant::Full,
        ..Law::Yeoh { c10: 0.3, c20: 0.3 * ratio, c30: 0.01 }.into()
    });
    samples().into_iter().chain(full).collect()
}

/// With the full invariant the body is under a pressure of −2 W₁ at rest, which the elements' pressures balance: no motion may
/// release energy, on single elements, strips, sheets and cubes, whatever the law.
#[test]
fn no_motion_releases_energy_at_rest_whatever_the_law() {
    for formulation in Formulation::ALL {
        for (cells, size) in [([1, 1, 1], [1.0, 1.0, 1.0]), ([3, 1, 1], [3.0, 1.0, 1.0]), ([2, 2, 1], [6.0, 6.0, 1.0])]
        {
            let mesh = Lattice::uniform([0.0; 3], size, cells).mesh_all(formulation.element_kind());
            for material in materials(formulation) {
                for ratio in [50.0, 1844.0] {
                    let material = Material { bulk_modulus: ratio * material.shear_modulus(), ..material.clone() };
                    let rest = free_stretches(&material, None);
                    let values = eigenvalues(stiffness_at(&mesh, formulation, &material, rest));
                    let (first, seventh) = (values[0] / material.shear_modulus(), values[6] / material.shear_modulus());
                    let name = format!("{formulation} {cells:?}, {material:?}");
                    // In millimetres: of the order of (1/6)² where sheets of 6 × 6 × 1 bend, of (1/3)³ where strips do.
                    assert!(first > -1e-9 && seventh > 2e-3, "{name}: {:?}", &values[..8]);
                }
            }
        }
    }
}

/// The same for a bar whose ends are pulled to one and a half and to twice its length and held there.
#[test]
fn no_motion_releases_energy_in_a_pulled_bar() {
    for formulation in
        [Formulation::Hex20, Formulation::Hex27, Formulation::Tet10, Formulation::Tet15, Formulation::Wedge21]
    {
        let mesh = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(formulation.element_kind());
        let free: Vec<usize> = mesh
            .select_nodes(|x| x[0] > 1e-9 && x[0] < 2.0 - 1e-9)
            .iter()
            .flat_map(|&n| (0..3).map(move |k| 3 * n as usize + k))
            .collect();
        for law in [Law::NeoHooke { c10: 0.3 }, Law::Yeoh { c10: 0.3, c20: -0.02, c30: 0.002 }] {
            let least = [Invariant::Full, Invariant::Isochoric].map(|invariant| {
                let material = Material { invariant, ..law.clone().into() };
                [1.0, 1.5, 2.0].map(|lambda| {
                    let stretches = free_stretches(&material, Some(lambda));
                    let stiffness = stiffness_at(&mesh, formulation, &material, stretches);
                    eigenvalues(stiffness.select_rows(&free).select_columns(&free))[0]
                })
            });
            println!("{formulation} {law:?}: full {:.4?}, isochoric {:.4?} N/mm", least[0], least[1]);
            assert!(least[0].iter().zip(&least[1]).all(|(full, isochoric)| *full > 0.8 * isochoric), "{least:?}");
            assert!(least[1].iter().all(|isochoric| *isochoric > 1e-3), "{least:?}");
        }
    }
}

/// Inf-sup constants β of a cube with all of its boundary held, by the test of Chapelle & Bathe (1993, *Comput. Struct.* 47),
/// in ascending order: β² are the eigenvalues of Bᵀ M⁻¹ B u = β² A u but for the kernel of B, A being the stiffness less the
/// volumetric one, κ Bᵀ M⁻¹ B, divided by μ. As many as there are pressures, less the constant one.
fn inf_sup_constants(formulation: Formulation, cells: usize, pressures_per_element: usize) -> Vec<f64> {
    let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [cells; 3]).mesh_all(formulation.element_kind());
    inf_sup_constants_of(&mesh, formulation, pressures_per_element)
}

/// The same of any body whose boundary is held.
fn inf_sup_constants_of(mesh: &Mesh, formulation: Formulation, pressures_per_element: usize) -> Vec<f64> {
    let mut is_inner = vec![true; mesh.num_nodes()];
    for facet in mesh.boundary_facets() {
        mesh.facet_nodes(facet).into_iter().for_each(|node| is_inner[node as usize] = false);
    }
    let inner = (0..mesh.num_nodes()).filter(|&node| is_inner[node]);
    let inner: Vec<usize> = inner.flat_map(|node| (0..3).map(move |k| 3 * node + k)).collect();
    let free = |matrix: DMatrix<f64>| matrix.select_rows(&inner).select_columns(&inner);
    let [soft, stiff] = [2.0, 3.0].map(|kappa| free(stiffness(mesh, formulation, kappa)));
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

/// So do quadratic tetrahedra with bubbles: none of their pressures is spurious.
#[test]
fn tetrahedra_with_bubbles_are_inf_sup_stable() {
    let constants = [1, 2, 3].map(|cells| inf_sup_constants(Formulation::Tet15, cells, 4)[0]);
    println!("tet15: {constants:.4?}");
    assert!(constants[2] > 0.1 && constants[2] > 0.9 * constants[1], "{constants:.4?}");
}

/// And wedges with nodes in their faces and inside, alone and beside triquadratic hexahedra.
#[test]
fn wedges_are_inf_sup_stable() {
    let constants = [2, 3, 4].map(|cells| inf_sup_constants(Formulation::Wedge21, cells, 4)[0]);
    println!("wedge21: {constants:.4?}");
    assert!(constants[2] > 0.2 && constants[2] > 0.9 * constants[1], "{constants:.4?}");
    let beside = [2, 3, 4].map(|cells| {
        let lattice = Lattice::uniform([0.0; 3], [1.0; 3], [cells; 3]);
        let of_family = |kind| lattice.mesh_all(kind);
        let first = 1.0 / cells as f64;
        let mesh = mixed(&of_family(ElementKind::Hex27), &of_family(ElementKind::Wedge21), |x| x[0] < first);
        inf_sup_constants_of(&mesh, Formulation::Hex27, 4)[0]
    });
    println!("hex27 and wedge21: {beside:.4?}");
    assert!(beside[2] > 0.2 && beside[2] > 0.9 * beside[1], "{beside:.4?}");
}

/// An angle of all three, in which every element has an edge on the boundary on the coarser mesh.
#[test]
fn hexahedra_wedges_and_tetrahedra_are_inf_sup_stable_together() {
    let constants = inf_sup_constants_of(&angle(1), Formulation::Hex27, 4)[0];
    println!("hex27, wedge21 and tet15: {constants:.4}");
    assert!(constants > 0.1, "{constants:.4}");
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
