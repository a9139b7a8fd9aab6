//! Thick tube in plane strain under inner pressure.

use std::f64::consts::FRAC_PI_2;

use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::{Formulation, Invariant, MPA_PER_KPA, Material, Problem, Support};

use crate::Effort;
use crate::body::{body, inflate, material, near};
use crate::row::Row;
use crate::yeoh::{integrate, root, slope};

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
A quarter of a tube with radii 5 and 7 mm in plane strain, follower pressure inside; the quantity is the radial displacement of the \
inner surface, mm. Exact for the incompressible material: r² = R² + a² − A², λ = r/R, and \
p = ∫ 2 W′(I₁) (λ² − λ⁻²) dr/r from a to b (Holzapfel 2000, §6.6, plane strain). κ = 10⁵ MPa leaves errors of the mesh only; rows with \
the paper's κ = 1000 MPa have a fixed bound for what compressibility changes. Quadratic hexahedra converge with order 4 (the \
displacement of a symmetric body measured at a node). The errors of `tet15` at that node, below 10⁻³, fall with order 1 to 2 between these \
coarse meshes, whose single layer of elements becomes slender, and not with the 3 of theory (which the manufactured solution has), and those of \
`wedge21` with order 0 to 2 (sphere, torsion and the manufactured solution have 3 and more): their rows have a bound, but no order.";

const RADII: [f64; 2] = [5.0, 7.0];

/// Rows of all elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for element in crate::ELEMENTS {
        let coarsest: [usize; 2] = match element {
            // Two elements around the quarter are so good that compressibility would limit the finer meshes.
            Formulation::Hex20 => [1, 1],
            _ if element.is_second_order => [1, 2],
            _ => [2, 5],
        };
        let order = match element {
            Formulation::Hex20 | Formulation::Hex27 => 4.0,
            _ => 2.0,
        };
        let meshes = [1, 2, 4].map(|r| coarsest.map(|n| r * n));
        let meshes = if matches!(element, Formulation::Tet15 | Formulation::Wedge21) {
            [[2, 4], [3, 6], [4, 8]]
        } else {
            meshes
        };
        let describe = |mesh: &[usize; 2]| (format!("{} × {}", mesh[0], mesh[1]), mesh[0] as f64);
        let has_order = !matches!(element, Formulation::Tet15 | Formulation::Wedge21);
        let orders = has_order.then_some([order, order - 0.2]);
        for kpa in [20.0, 50.0, 100.0] {
            let solve = |mesh: &[usize; 2]| inner_displacement(element, &material(1e5), *mesh, kpa);
            let name = format!("inner displacement at {kpa} kPa");
            let row = Row::sequence(
                name,
                element,
                effort.of(&meshes),
                describe,
                orders,
                if has_order { 0.1 } else { 0.001 },
                solve,
            );
            rows.push(row);
        }
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let material = Material { invariant, ..material(1000.0) };
            let solve = |mesh: &[usize; 2]| inner_displacement(element, &material, *mesh, 50.0);
            let name = format!("at 50 kPa, κ = 1000 MPa, {} invariant", format!("{invariant:?}").to_lowercase());
            rows.push(Row::sequence(name, element, &meshes[2..], describe, None, 0.01, solve));
        }
    }
    rows
}

/// Measured and exact displacement, mm.
fn inner_displacement(
    formulation: Formulation,
    material: &Material,
    cells: [usize; 2],
    kpa: f64,
) -> Result<[f64; 2], String> {
    let problem = tube(formulation, material.clone(), cells);
    let (node, _) = problem.mesh.nearest_node([RADII[0], 0.0, 0.0]).ok_or("no node")?;
    let state = inflate(&problem, kpa)?;
    Ok([state.displacement[node][0], exact(material, kpa * MPA_PER_KPA)])
}

/// A quarter, 1 mm long, with air inside.
fn tube(formulation: Formulation, material: Material, [radial, around]: [usize; 2]) -> Problem {
    let lattice = Lattice::uniform([RADII[0], 0.0, 0.0], [RADII[1], FRAC_PI_2, 1.0], [radial, around, 1]);
    let mesh = lattice.mesh_all(formulation.element_kind());
    let inner = mesh.select_facets(|[r, ..]| near(r, RADII[0]));
    let planes = [
        (0, mesh.select_nodes(|[_, angle, _]| near(angle, FRAC_PI_2))),
        (1, mesh.select_nodes(|[_, angle, _]| near(angle, 0.0))),
        (2, mesh.select_nodes(|_| true)),
    ];
    let bent = mesh.map_nodes(|[r, angle, z]| [r * angle.cos(), r * angle.sin(), z]);
    let mut problem = body(bent, formulation, material);
    problem.inflate("inside", inner);
    problem.supports = planes
        .map(|(axis, nodes)| Support {
            name: "plane".into(),
            nodes,
            axes: std::array::from_fn(|k| k == axis),
            motion: None,
        })
        .into();
    problem
}

/// Displacement of the inner surface, mm, at a pressure in MPa.
fn exact(m: &Material, pressure: f64) -> f64 {
    let [inner, outer] = RADII;
    let excess = |u: f64| {
        let growth = (inner + u).powi(2) - inner * inner;
        // dr/r = R dR/r².
        let of_wall = integrate(inner, outer, |radius| {
            let r2 = radius * radius + growth;
            let l2 = r2 / (radius * radius);
            2.0 * slope(m, l2 + 1.0 / l2 - 2.0) * (l2 - 1.0 / l2) * radius / r2
        });
        of_wall - pressure
    };
    root(0.0, 5.0, excess)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Theory §9.
    #[test]
    fn displacements_are_those_of_the_theory() {
        for (kpa, expected) in [(20.0, 0.201_636), (35.0, 0.372_862), (50.0, 0.564_624), (100.0, 1.403_463)] {
            assert!((exact(&material(1e5), kpa * MPA_PER_KPA) - expected).abs() < 1e-6);
        }
    }
}
