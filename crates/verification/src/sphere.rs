//! Inflation of a thick sphere.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Facet, Mesh};
use pneuflex_model::{Formulation, MPA_PER_KPA, Material, Problem};

use crate::Effort;
use crate::body::{body, hold, inflate, material, near};
use crate::row::Row;
use crate::yeoh::{integrate, slope};

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
An eighth of a sphere with radii 5 and 7 mm, follower pressure inside, κ = 10⁵ MPa; the quantity is the radial displacement of the inner \
surface on the axis x, mm, at the pressures that widen it by a tenth and by a quarter. Exact for the incompressible material: with \
r³ = R³ + a³ − A³ and λ = r/R, equilibrium dσ_r/dr = 2 (σ_θ − σ_r)/r and σ_θ − σ_r = ½ λ dW/dλ, W(λ) = W(λ⁻², λ, λ), give \
p = ∫ λ (dW/dλ) dr/r from a to b. As dr/r = dλ/(λ (1 − λ³)), that is p = ∫ (dW/dλ)/(λ³ − 1) dλ from λ_b to λ_a \
(Green & Zerna 1968, *Theoretical Elasticity*, §3.10); it is integrated over R here, where nothing is singular at λ = 1. The mesh is \
three lattices over the sides of a cube, projected onto the sphere at equal angles and joined. The errors of `tet15` change their sign between these meshes, so that \
no order can be read from them; each is below 2·10⁻³.";

pub(crate) const RADII: [f64; 2] = [5.0, 7.0];

/// Rows of all elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for &element in effort.elements() {
        // Cells along each side of the cube and through the wall.
        let meshes: [[usize; 2]; 3] = match element {
            // On its coarsest mesh hex27 is accidentally better than its order.
            Formulation::Tet15 | Formulation::Hex27 | Formulation::Wedge21 => [[2, 2], [3, 3], [4, 4]],
            _ if element.is_second_order => [[1, 1], [2, 2], [4, 4]],
            _ => [[2, 2], [4, 4], [8, 8]],
        };
        let order = match element {
            Formulation::Hex20 | Formulation::Hex27 => 4.0,
            Formulation::Wedge21 => 3.0,
            _ => 2.0,
        };
        // At a corner of three lattices serendipity elements are not parallelepipeds however fine they are.
        let least = if order > 3.0 { 3.0 } else { order - 0.2 };
        for widening in [1.1, 1.25] {
            let has_order = element != Formulation::Tet15;
            rows.push(Row::sequence(
                format!("inner displacement at a stretch of {widening}"),
                element,
                effort.of(&meshes),
                |mesh| (format!("3 × {}² × {}", mesh[0], mesh[1]), mesh[0] as f64),
                has_order.then_some([order, least]),
                if has_order { 0.1 } else { 0.002 },
                |mesh| inner_displacement(element, *mesh, widening),
            ));
        }
    }
    rows
}

/// Measured and exact displacement, mm.
fn inner_displacement(formulation: Formulation, cells: [usize; 2], widening: f64) -> Result<[f64; 2], String> {
    let material = material(1e5);
    let exact = (widening - 1.0) * RADII[0];
    let kpa = pressure(&material, exact) / MPA_PER_KPA;
    let problem = sphere(formulation, material, cells);
    let (node, _) = problem.mesh.nearest_node([RADII[0], 0.0, 0.0]).ok_or("no node")?;
    let state = inflate(&problem, kpa)?;
    Ok([state.displacement[node][0], exact])
}

/// Pressure, MPa, at a displacement of the inner surface, mm.
pub(crate) fn pressure(m: &Material, displacement: f64) -> f64 {
    let [inner, outer] = RADII;
    let growth = (inner + displacement).powi(3) - inner.powi(3);
    integrate(inner, outer, |radius| {
        let r3 = radius.powi(3) + growth;
        let l = r3.cbrt() / radius;
        let e = 2.0 * l * l + l.powi(-4) - 3.0;
        // λ dW/dλ = W′ (4 λ² − 4 λ⁻⁴), dr/r = R² dR/r³.
        slope(m, e) * (4.0 * l * l - 4.0 * l.powi(-4)) * radius * radius / r3
    })
}

/// The eighth with positive coordinates, on its three planes of symmetry, with air inside.
pub(crate) fn sphere(formulation: Formulation, material: Material, cells: [usize; 2]) -> Problem {
    let (mesh, inner) = eighth(formulation.element_kind(), cells);
    let mut problem = body(mesh, formulation, material);
    for axis in 0..3 {
        hold(&mut problem, "plane", std::array::from_fn(|k| k == axis), |x| near(x[axis], 0.0));
    }
    problem.inflate("inside", inner);
    problem
}

/// The mesh and the facets of its inner surface.
fn eighth(kind: ElementKind, [around, through]: [usize; 2]) -> (Mesh, Vec<Facet>) {
    let [inner, outer] = RADII;
    let patch = Lattice::uniform([0.0, 0.0, inner], [1.0, 1.0, outer], [around, around, through]).mesh_all(kind);
    let inside = patch.select_facets(|x| near(x[2], inner));
    let patch = patch.map_nodes(|[a, b, r]| {
        let [y, z] = [a, b].map(|t| (FRAC_PI_4 * t).tan());
        let scale = r / (1.0 + y * y + z * z).sqrt();
        [scale, scale * y, scale * z]
    });
    let mut mesh = Mesh { nodes: Vec::new(), connectivity: Vec::new(), ..patch.clone() };
    let mut facets = Vec::new();
    let mut known: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    for turn in 0..3 {
        let first = mesh.num_elements() as u32;
        facets.extend(inside.iter().map(|f| Facet { element: f.element + first, face: f.face }));
        for &node in &patch.connectivity {
            let x = patch.nodes[node as usize];
            let position: [f64; 3] = std::array::from_fn(|k| x[(k + 3 - turn) % 3]);
            // Nodes on the seams coincide up to rounding; all others are much further apart.
            let key = position.map(|t| (t * 1e6).round() as i64);
            let next = mesh.nodes.len() as u32;
            let number = *known.entry(key).or_insert(next);
            if number == next {
                mesh.nodes.push(position.map(|t| if t.abs() < 1e-12 { 0.0 } else { t }));
            }
            mesh.connectivity.push(number);
        }
    }
    (mesh, facets)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pressures_are_those_of_linear_elasticity() {
        // Lamé, incompressible: u = p A³ B³ / (4 μ (B³ − A³) A²).
        let (m, u) = (material(1e5), 1e-4);
        let [a, b] = RADII.map(|r| r.powi(3));
        let lame = u * 4.0 * m.shear_modulus() * (b - a) * RADII[0].powi(2) / (a * b);
        assert!((pressure(&m, u) / lame - 1.0).abs() < 1e-3, "{} {lame}", pressure(&m, u));
    }

    #[test]
    fn the_three_lattices_are_joined() {
        for kind in [ElementKind::Hex27, ElementKind::Tet15, ElementKind::Wedge21] {
            let (mesh, inner) = eighth(kind, [2, 1]);
            let exact = std::f64::consts::PI / 6.0 * (343.0 - 125.0);
            assert!((mesh.volume() / exact - 1.0).abs() < 2e-3, "{} {exact}", mesh.volume());
            // Inside, outside and on the three planes; nothing at the seams.
            let per_side = inner.len();
            assert_eq!(
                mesh.boundary_facets().len(),
                2 * per_side + 3 * 2 * if kind == ElementKind::Tet15 { 4 } else { 2 }
            );
        }
    }
}
