//! Method of manufactured solutions: orders of convergence in L² and H¹.

use std::sync::Arc;

use pneuflex_assembly::formulation::{IntegrationPoint, displacement_gradient, reference_gradients, tabulate};
use pneuflex_assembly::{Assembler, LocalContribution, Mixed, Prediction, Request, Solid, Totals};
use pneuflex_factor::{Factor, Ordering, Parallelism, Symbolic};
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Mesh, shape, with_num_nodes};
use pneuflex_model::{Formulation, Material};

use crate::Effort;
use crate::body::{displacement, material};
use crate::row::Row;
use crate::yeoh::first_piola_kirchhoff;

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
A displacement field is chosen, the body force that it needs follows from the strong form, b = −Div P(F), and the field is imposed on the \
whole boundary (Roache 2002, *J. Fluids Eng.* 124). P comes from formulas of this crate; its divergence by central differences of fourth order. The \
body is a smoothly distorted unit cube, so that no element is a parallelepiped. Quantities are the errors \
‖u_h − u‖ and ‖∇(u_h − u)‖ over the norms of u and ∇u. *Compressible*: κ = 5 MPa and a field that changes volumes by up to a third; *nearly incompressible*: \
κ = 1000 MPa and three shears one after the other, which keep volumes. Orders in theory are k + 1 and k with polynomials of degree k.";

/// A field: position in the deformed body, deformation gradient.
type Field = fn([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]);

/// Rows of all elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for &element in effort.elements() {
        let coarsest = if element.is_second_order { 1 } else { 2 };
        // Six tetrahedra or two wedges are no mesh yet.
        let meshes = if matches!(element, Formulation::Tet15 | Formulation::Wedge21) {
            [2, 3, 4]
        } else {
            [1, 2, 4].map(|r| r * coarsest)
        };
        let degree = match element {
            Formulation::Hex20 | Formulation::Hex27 | Formulation::Tet15 | Formulation::Wedge21 => 2.0,
            _ => 1.0,
        };
        for (name, field, bulk) in [("compressible", swollen as Field, 5.0), ("nearly incompressible", sheared, 1000.0)]
        {
            // Solved once; a row for each norm.
            let mut solved: Vec<Result<[f64; 2], String>> = Vec::new();
            for &cells in effort.of(&meshes) {
                solved.push(errors(element, &material(bulk), field, cells));
            }
            for (which, norm, order) in [(0, "L²", degree + 1.0), (1, "H¹", degree)] {
                let mut results = solved.iter();
                rows.push(Row::sequence(
                    format!("{name}, {norm} error"),
                    element,
                    effort.of(&meshes),
                    |cells| (format!("{cells}³"), *cells as f64),
                    Some([order, order - 0.2]),
                    0.3,
                    |_| {
                        let errors = results.next().cloned().unwrap_or(Err("not solved".into()))?;
                        Ok([errors[which], 0.0])
                    },
                ));
            }
        }
    }
    rows
}

/// A field that changes volumes.
fn swollen([x, y, z]: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let (a, b, c) = (1.5 * y + z, 1.2 * z + x, 1.3 * x - y);
    let r = [x + 0.15 * a.sin() + 0.1 * x * x, y + 0.15 * b.cos() + 0.05 * y * z, z + 0.15 * c.sin() + 0.1 * x * z];
    let f = [
        [1.0 + 0.2 * x, 0.225 * a.cos(), 0.15 * a.cos()],
        [-0.15 * b.sin(), 1.0 + 0.05 * z, 0.05 * y - 0.18 * b.sin()],
        [0.195 * c.cos() + 0.1 * z, -0.15 * c.cos(), 1.0 + 0.1 * x],
    ];
    (r, f)
}

/// Three shears one after the other, each along one axis by an amount that does not depend on it: J = 1.
fn sheared([x, y, z]: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let x1 = x + 0.3 * (1.5 * y).sin();
    let y1 = y + 0.2 * (1.7 * x1 + z).sin();
    let z1 = z + 0.2 * (1.1 * x1 - 1.4 * y1).cos();
    let dx = [1.0, 0.45 * (1.5 * y).cos(), 0.0];
    let (p, q) = (0.2 * (1.7 * x1 + z).cos(), -0.2 * (1.1 * x1 - 1.4 * y1).sin());
    let dy: [f64; 3] = [1.7 * p * dx[0], 1.0 + 1.7 * p * dx[1], p];
    let dz = std::array::from_fn(|k| f64::from(k == 2) + q * (1.1 * dx[k] - 1.4 * dy[k]));
    ([x1, y1, z1], [dx, dy, dz])
}

/// −Div P, N/mm³, by central differences of fourth order.
fn body_force(m: &Material, field: Field, x: [f64; 3]) -> [f64; 3] {
    const STEP: f64 = 2e-3;
    let mut force = [0.0; 3];
    for k in 0..3 {
        let stress = |steps: f64| {
            let mut there = x;
            there[k] += steps * STEP;
            first_piola_kirchhoff(m, &field(there).1)
        };
        let [far_low, low, high, far_high] = [-2.0, -1.0, 1.0, 2.0].map(stress);
        for (i, force) in force.iter_mut().enumerate() {
            *force -= (8.0 * (high[i][k] - low[i][k]) - (far_high[i][k] - far_low[i][k])) / (12.0 * STEP);
        }
    }
    force
}

/// Relative errors of the displacement and of its gradient.
fn errors(element: Formulation, material: &Material, field: Field, cells: usize) -> Result<[f64; 2], String> {
    let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [cells; 3]).mesh_all(element.element_kind());
    let is_boundary: Vec<bool> =
        mesh.nodes.iter().flat_map(|x| [x.iter().any(|t| *t == 0.0 || *t == 1.0); 3]).collect();
    let mesh = Arc::new(mesh.map_nodes(|[x, y, z]| {
        [x + 0.08 * (2.0 * y + z).sin(), y + 0.06 * (1.5 * z).cos() * x, z + 0.07 * (1.7 * x - y).sin()]
    }));
    let start = displacement(&mesh, |x| field(x).0);
    with_num_nodes!(element.element, N => solve::<N>(&mesh, element, material, field, start, &is_boundary))
}

/// Newton's method from the nodal values of the field, then its errors.
fn solve<const N: usize>(
    mesh: &Arc<Mesh>,
    element: Formulation,
    material: &Material,
    field: Field,
    mut u: Vec<[f64; 3]>,
    held: &[bool],
) -> Result<[f64; 2], String> {
    let points = tabulate(element.element, (element.element.fine_rule)());
    let values: Vec<Vec<f64>> = points.iter().map(|point| shape::tabulate(element.element, point.xi).0).collect();
    let mut load = vec![[0.0; 3]; mesh.num_nodes()];
    for_each_point::<N>(mesh, &points, &values, |nodes, _, volume, position, values| {
        let force = body_force(material, field, position);
        for (&node, value) in nodes.iter().zip(values) {
            (0..3).for_each(|k| load[node as usize][k] += volume * value * force[k]);
        }
    });
    // A field that keeps volumes needs the same force for every bulk modulus: from a soft one to that wanted.
    let mut bulk = material.bulk_modulus.min(5.0);
    loop {
        newton(mesh, element, &Material { bulk_modulus: bulk, ..material.clone() }, &load, held, &mut u)?;
        if bulk >= material.bulk_modulus {
            break;
        }
        bulk = (4.0 * bulk).min(material.bulk_modulus);
    }
    // Squared norms: of the errors, of the field.
    let mut sums = [[0.0; 2]; 2];
    for_each_point::<N>(mesh, &points, &values, |nodes, gradients, volume, position, values| {
        let local: [[f64; 3]; N] = std::array::from_fn(|a| u[nodes[a] as usize]);
        let (r, f) = field(position);
        let h = displacement_gradient(&local, gradients);
        for i in 0..3 {
            let found: f64 = values.iter().zip(&local).map(|(n, u)| n * u[i]).sum();
            let exact = r[i] - position[i];
            sums[0][0] += volume * (found - exact).powi(2);
            sums[1][0] += volume * exact * exact;
            for j in 0..3 {
                let exact = f[i][j] - f64::from(i == j);
                sums[0][1] += volume * (h[i][j] - exact).powi(2);
                sums[1][1] += volume * exact * exact;
            }
        }
    });
    Ok(std::array::from_fn(|k| (sums[0][k] / sums[1][k]).sqrt()))
}

/// Newton's method under nodal forces, N, with the mixed linearisation.
fn newton(
    mesh: &Arc<Mesh>,
    element: Formulation,
    material: &Material,
    load: &[[f64; 3]],
    held: &[bool],
    u: &mut [[f64; 3]],
) -> Result<(), String> {
    let mut solid = Solid::new(Arc::clone(mesh), element, material).map_err(|e| e.to_string())?;
    let mut assembler = Assembler::new(mesh.num_nodes(), &[&solid as &dyn LocalContribution], &[]);
    let symbolic = Symbolic::analyze(assembler.pattern(), Ordering::default()).map_err(|e| e.to_string())?;
    let mut factor = Factor::<3>::new(Arc::new(symbolic));
    let mut totals = Totals::default();
    solid.predict(&Arc::new(Prediction { displacement: u.to_vec(), correction: None, ..Prediction::default() }));
    solid.linearise();
    let mut largest = f64::INFINITY;
    for _ in 0..30 {
        assembler.reset(&mut totals, Request::Tangent);
        assembler.add(0, &solid, u, Request::Tangent, &mut totals).map_err(|e| e.to_string())?;
        factor.factorize(&totals.tangent, held, Parallelism::Threads).map_err(|e| e.to_string())?;
        let residual = totals.residual.as_flattened().iter().zip(load.as_flattened());
        let mut step: Vec<f64> = residual.zip(held).map(|((r, f), held)| if *held { 0.0 } else { f - r }).collect();
        factor.solve_in_place(&mut step, 1).map_err(|e| e.to_string())?;
        let step: Vec<[f64; 3]> = step.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect();
        solid.predict(&Arc::new(Prediction {
            displacement: u.to_vec(),
            correction: Some(step.clone()),
            ..Prediction::default()
        }));
        solid.linearise();
        for (u, step) in u.as_flattened_mut().iter_mut().zip(step.as_flattened()) {
            *u += step;
        }
        largest = step.as_flattened().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        if largest < 1e-10 {
            break;
        }
    }
    if largest.is_nan() || largest >= 1e-10 {
        return Err(format!("Newton's method is left with a correction of {largest:.1e} mm"));
    }
    Ok(())
}

/// Calls `visit` with nodes, shape gradients, volume, position and shape functions at every point of every element.
fn for_each_point<const N: usize>(
    mesh: &Mesh,
    points: &[IntegrationPoint],
    values: &[Vec<f64>],
    mut visit: impl FnMut(&[u32], &[[f64; 3]; N], f64, [f64; 3], &[f64]),
) {
    for element in 0..mesh.num_elements() {
        let nodes = mesh.element(element);
        let x: [[f64; 3]; N] = std::array::from_fn(|a| mesh.nodes[nodes[a] as usize]);
        for (point, values) in points.iter().zip(values) {
            let (gradients, volume) = reference_gradients(&x, point);
            let position = std::array::from_fn(|k| values.iter().zip(&x).map(|(n, x)| n * x[k]).sum());
            visit(nodes, &gradients, volume, position, values);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_derivatives_of_the_fields() {
        let x = [0.3, 0.7, 0.6];
        for field in [swollen as Field, sheared] {
            let f = field(x).1;
            for k in 0..3 {
                let (mut low, mut high) = (x, x);
                low[k] -= 1e-5;
                high[k] += 1e-5;
                let (low, high) = (field(low).0, field(high).0);
                for i in 0..3 {
                    assert!(((high[i] - low[i]) / 2e-5 - f[i][k]).abs() < 1e-9, "{i} {k}");
                }
            }
        }
        assert!((pneuflex_mesh::mesh::determinant(&sheared(x).1) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_fine_rule_fills_the_tetrahedron() {
        let sum = |f: fn([f64; 3]) -> f64| -> f64 {
            (pneuflex_mesh::ElementKind::Tet15.fine_rule)().iter().map(|&(x, w)| w * f(x)).sum()
        };
        assert!(
            (sum(|_| 1.0) - 1.0 / 6.0).abs() < 1e-14 && (sum(|[x, y, z]| x * x * y * z) - 2.0 / 5040.0).abs() < 1e-14
        );
    }
}
