//! Stress at the nodes of a smooth surface, from what is known there best: how the surface itself is stretched, and what acts on it.
//!
//! Extrapolated from the points inside, a stress is least exact where it is wanted most. A surface's own deformation is not one-sided: its
//! stretch is fitted by a polynomial over the faces around a corner (Zienkiewicz & Zhu 1992, *IJNME* 33, superconvergent patches, on the
//! surface). The material is isotropic and the surface loaded by a pressure p alone, so its normal is a principal direction, and the stretch
//! λ along it is the one with n · σ n = −p:
//!
//! ```text
//! F = R U_s + λ n ⊗ N,   n · σ(F) n = −p
//! ```
//!
//! U_s being the surface's stretch and R its rotation (theory §10).

mod patch;
mod surface;

use pneuflex_assembly::law::ElementMaterial;
use pneuflex_material::{Kinematics, volumetric};
use pneuflex_model::{LoadParameter, Pressure, Problem};

use crate::contact::ContactState;
use crate::stress::{StressField, SymmetricTensor};
use patch::{Tensor, plane};
use pneuflex_mesh::vector::Vec3;
use surface::{KnownSurface, Place};

/// What acts on the surface in a state.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceState<'a> {
    /// Displacements, mm.
    pub displacement: &'a [[f64; 3]],
    /// Position on the load path.
    pub parameter: LoadParameter,
    /// Pressure in every cavity.
    pub pressures: &'a [Pressure],
    /// Its contact.
    pub contact: &'a ContactState,
}

/// Cauchy stress at every node, MPa: that of the surface itself at the nodes of smooth surfaces whose traction is known, not where something is held
/// or touched, at edges, between regions, and where single forces or linear equations act; [`StressField::at_nodes`] elsewhere.
pub fn nodal(problem: &Problem, field: &StressField, state: &SurfaceState<'_>) -> Vec<SymmetricTensor> {
    let mut nodal = field.at_nodes(problem);
    let surface = KnownSurface::of(problem, state);
    let (materials, _) = problem.materials();
    let laws: Vec<_> = materials.iter().map(|material| ElementMaterial::new(material, problem.formulation)).collect();
    for (node, stretch) in surface.stretches() {
        let place = &surface.nodes[&node];
        let turned = surface.turned_axes(node, place, plane(place.normal));
        if let Some(stress) = stress(place, stretch, turned, &laws[place.material]) {
            nodal[node as usize] = stress;
        }
    }
    nodal
}

/// Cauchy stress, MPa, at a node; `None` where no stretch along the normal has the traction, or the patch no positive stretches.
///
/// `turned` are the tangent plane's axes as the surface turns them.
fn stress(place: &Place, stretch: Tensor, turned: [Vec3; 2], law: &ElementMaterial) -> Option<SymmetricTensor> {
    let axes = plane(place.normal);
    let along = |i: usize, j: usize| {
        (0..3).map(|k| axes[i][k] * (0..3).map(|l| stretch[k][l] * axes[j][l]).sum::<f64>()).sum::<f64>()
    };
    let (xx, yy, xy) = (along(0, 0), along(1, 1), along(0, 1));
    let area = (xx * yy - xy * xy).sqrt();
    if !(area > 0.0 && xx > 0.0) {
        return None;
    }
    let trace = (xx + yy + 2.0 * area).sqrt();
    let root = [[(xx + area) / trace, xy / trace], [xy / trace, (yy + area) / trace]];
    let n = place.deformed_normal;
    let gradient = |lambda: f64| -> Tensor {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let own = f64::from(u8::from(i == j));
                lambda * n[i] * place.normal[j] - own
                    + (0..2)
                        .flat_map(|p| (0..2).map(move |q| (p, q)))
                        .map(|(p, q)| root[p][q] * turned[p][i] * axes[q][j])
                        .sum::<f64>()
            })
        })
    };
    let stress = |lambda: f64| -> Option<(f64, Tensor)> {
        let kinematics = Kinematics::new(&gradient(lambda)).ok()?;
        let mut stress = law.law.cauchy_stress(&kinematics);
        let excess = kinematics.jacobian_minus_1;
        let p = law.bulk_modulus * volumetric::evaluate(law.volumetric, excess)[1] + law.fluctuation_modulus * excess;
        (0..3).for_each(|d| stress[d][d] += p);
        let along: f64 = (0..3).map(|i| n[i] * (0..3).map(|j| stress[i][j] * n[j]).sum::<f64>()).sum();
        (along.is_finite()).then_some((along + place.pressure, stress))
    };
    // A patch may reach beyond what the law's chains can be stretched to, where the elements' points do not.
    let guess = Kinematics::new(&gradient(1.0 / area)).ok()?;
    if !law.law.energy_and_stress(&guess).0.is_finite() {
        return None;
    }
    // By the secant method; the surface keeps its volume but for the little that a pressure changes.
    let kappa = law.bulk_modulus + law.fluctuation_modulus;
    let (mut last, mut lambda) = (1.0 / area, 1.0 / area);
    let (mut before, _) = stress(last)?;
    lambda *= 1.0 - (before / (2.0 * kappa)).clamp(-0.1, 0.1);
    for _ in 0..50 {
        let (now, s) = stress(lambda)?;
        let step = if now == 0.0 { 0.0 } else { -now * (lambda - last) / (now - before) };
        if step.abs() < 1e-14 * lambda {
            return Some([s[0][0], s[1][1], s[2][2], s[0][1], s[1][2], s[0][2]]);
        }
        (last, before) = (lambda, now);
        lambda += step.clamp(-0.1 * lambda, 0.1 * lambda);
    }
    None
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::lattice::Lattice;
    use pneuflex_model::load::Load;
    use pneuflex_model::{Control, Curve, Formulation, Law, Material, Region, Support};

    use super::*;
    use crate::{contact, stress};

    const C10: f64 = 0.3;

    fn material() -> Material {
        Material { bulk_modulus: 1e7, ..Law::Polynomial { c10: C10, c01: 0.0, c20: 0.0, c11: 0.0, c02: 0.0 }.into() }
    }

    /// A plate of 3 × 3 × 1 mm, held all around, with air of 0.02 MPa on its upper face, one unit cell in each element.
    fn plate(formulation: Formulation) -> Problem {
        let lattice = Lattice::uniform([0.0; 3], [3.0, 3.0, 1.0], [3, 3, 2]);
        let mesh = lattice.mesh_all(formulation.element_kind());
        let upper = mesh.select_facets(|x| (x[2] - 1.0).abs() < 1e-9);
        let around = mesh.select_nodes(|x| x[..2].iter().any(|x| x.abs() < 1e-9 || (x - 3.0).abs() < 1e-9));
        let mut problem = Problem::body(mesh, formulation, material());
        problem.inflate("above", upper);
        problem.supports = vec![Support { name: "rim".into(), nodes: around, axes: [true; 3], motion: None }];
        problem
    }

    fn nodal_of(problem: &Problem, displacement: &[[f64; 3]]) -> [Vec<SymmetricTensor>; 2] {
        let field = stress::recover(problem, displacement).unwrap();
        let contact = contact::evaluate(problem, displacement).unwrap();
        let pressures = [Pressure::from_mpa(0.02)];
        let state =
            SurfaceState { displacement, parameter: LoadParameter(20.0), pressures: &pressures, contact: &contact };
        [nodal(problem, &field, &state), field.at_nodes(problem)]
    }

    /// x ↦ Q diag(F₂, 1/det F₂) x, Q turning about (0, 1, 1).
    fn map() -> [[f64; 3]; 3] {
        let f = [[1.3, 0.4, 0.0], [-0.1, 0.9, 0.0], [0.0, 0.0, 1.0 / 1.21]];
        let (s, c) = (0.8_f64.sin(), 0.8_f64.cos());
        let h = 0.5_f64.sqrt();
        let q = [[c, -h * s, h * s], [h * s, 0.5 + 0.5 * c, 0.5 - 0.5 * c], [-h * s, 0.5 - 0.5 * c, 0.5 + 0.5 * c]];
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| q[i][k] * f[k][j]).sum()))
    }

    /// σ = 2 C₁₀ (F Fᵀ − λ² 1) − p 1 of a neo-Hookean plate, λ being its stretch across: whatever its inside is said to do.
    #[test]
    fn a_stretched_and_turned_plate_has_its_exact_stress_at_its_faces() {
        let f = map();
        for formulation in Formulation::ALL {
            let problem = plate(formulation);
            let mesh = &problem.mesh;
            let mut displacement: Vec<[f64; 3]> = mesh
                .nodes
                .iter()
                .map(|x| std::array::from_fn(|i| (0..3).map(|j| f[i][j] * x[j]).sum::<f64>() - x[i]))
                .collect();
            let is_face = |x: [f64; 3]| x[2].abs() < 1e-9 || (x[2] - 1.0).abs() < 1e-9;
            for (number, (u, &x)) in displacement.iter_mut().zip(&mesh.nodes).enumerate() {
                if !is_face(x) {
                    u[number % 3] += 0.02;
                }
            }
            let [found, inside] = nodal_of(&problem, &displacement);
            let (mut checked, mut different) = (0, 0.0_f64);
            for (node, x) in mesh.nodes.iter().enumerate() {
                let is_rim = problem.supports[0].nodes.contains(&(node as u32));
                if is_rim || !is_face(*x) {
                    assert_eq!(found[node], inside[node], "{formulation:?} {x:?}");
                    continue;
                }
                let pressure = if x[2] > 0.5 { 0.02 } else { 0.0 };
                let exact = |i: usize, j: usize| {
                    let own = f64::from(u8::from(i == j));
                    let b: f64 = (0..3).map(|k| f[i][k] * f[j][k]).sum();
                    2.0 * C10 * (b - own / (1.21 * 1.21)) - pressure * own
                };
                let exact = [exact(0, 0), exact(1, 1), exact(2, 2), exact(0, 1), exact(1, 2), exact(0, 2)];
                for c in 0..6 {
                    assert!(
                        (found[node][c] - exact[c]).abs() < 1e-6,
                        "{formulation:?} {x:?}: {:?}, {exact:?}",
                        found[node]
                    );
                    different = different.max((inside[node][c] - exact[c]).abs());
                }
                checked += 1;
            }
            assert!(checked >= 8 && different > 0.1, "{formulation:?}: the check would be empty");
        }
    }

    /// Gent's law ends at I₁ − 3 = J_m, here at an equibiaxial stretch of 1.46.
    #[test]
    fn beyond_the_end_of_a_law_there_is_no_stress() {
        let gent: Material = Law::Gent { shear_modulus: 2.0 * C10, jm: 1.5 }.into();
        let law = ElementMaterial::new(&gent, Formulation::Hex27);
        let normal = [0.0, 0.0, 1.0];
        let place = Place {
            faces: Vec::new(),
            planes: [false; 3],
            normal,
            deformed_normal: normal,
            pressure: 0.0,
            material: 0,
        };
        let stretched =
            |by: f64| stress(&place, [[by * by, 0.0, 0.0], [0.0, by * by, 0.0], [0.0; 3]], plane(normal), &law);
        assert!(stretched(1.4).is_some_and(|stress| stress[0] > 1.0 && stress[2].abs() < 1e-9));
        assert_eq!(stretched(1.6), None);
    }

    /// Where something else acts than a pressure, nodes have the stress of the elements.
    #[test]
    fn where_the_traction_is_not_known_nothing_is_replaced() {
        let f = map();
        let is_known = |change: &dyn Fn(&mut Problem)| {
            let mut problem = plate(Formulation::Hex27);
            change(&mut problem);
            let displacement: Vec<[f64; 3]> = (problem.mesh.nodes.iter().enumerate())
                .map(|(n, x)| {
                    let shift = if x[2] == 0.5 && n % 2 == 0 { 0.02 } else { 0.0 };
                    std::array::from_fn(|i| (0..3).map(|j| f[i][j] * x[j]).sum::<f64>() - x[i] + shift)
                })
                .collect();
            let [found, inside] = nodal_of(&problem, &displacement);
            let (node, _) = problem.mesh.nearest_node([1.0, 1.0, 0.0]).unwrap();
            found[node] != inside[node]
        };
        let node = |problem: &Problem| problem.mesh.nearest_node([1.0, 1.0, 0.0]).unwrap().0 as u32;
        let lower = |problem: &Problem| problem.mesh.select_facets(|x| x[2].abs() < 1e-9);
        assert!(is_known(&|_| {}));
        assert!(is_known(&|problem| {
            let facets = lower(problem);
            problem.loads.push(Load::Pressure { facets, curve: Curve::constant(0.01) });
        }));
        assert!(!is_known(&|problem| {
            let nodes = vec![(node(problem), 1.0)];
            problem.loads.push(Load::Force { nodes, force: [0.0, 0.0, 1.0], curve: Curve::constant(0.01) });
        }));
        assert!(!is_known(&|problem| {
            let facets = lower(problem);
            problem.loads.push(Load::Traction { facets, traction: [0.0, 0.0, 1.0], curve: Curve::constant(0.01) });
        }));
        assert!(!is_known(&|problem| {
            let support =
                Support { name: "pin".into(), nodes: vec![node(problem)], axes: [true, false, false], motion: None };
            problem.supports.push(support);
        }));
        assert!(!is_known(&|problem| {
            let region = Region { name: "corner".into(), elements: vec![0], material: material() };
            problem.regions.push(region);
        }));
        assert!(!is_known(&|problem| {
            // Air on a part of the face.
            let facets = lower(problem)[..1].to_vec();
            let control = Control::Pressure(Curve::constant(0.01));
            problem.cavities.insert(0, pneuflex_model::Cavity { name: "below".into(), facets, control });
        }));
    }
}
