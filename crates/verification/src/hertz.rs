//! A sphere on a block.

use std::f64::consts::PI;

use pneuflex_contact::ContactModel;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Mesh, shape};
use pneuflex_model::{Contact, ContactPair, Formulation, Law, Material, Problem};

use crate::Effort;
use crate::body::{body, displacement, hold, last, material, near, prescribe};
use crate::contact_patch::joined;
use crate::row::Row;

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
A body with a spherical lower side (R = 10 mm) is pressed on a flat block; both are neo-Hookean (C20 = C30 = 0), κ = 300 MPa (ν = 0.4991), penalty \
k = 200 N/mm³; a quarter on planes of symmetry, 8 × 8 × 8 mm each, lattices graded towards the contact. The far sides come nearer by 0.06 mm. Hertz \
(Johnson 1985, *Contact Mechanics*, §4.2) with E* = 2 μ: from the measured force F, a³ = 3FR/(4E*), p₀ = 3F/(2πa²) and the approach \
δ = a²/R. The contact radius is that of the Hertzian pressure with the measured second moment, ⟨ρ²⟩ = 2a²/5 (the outermost touching points would \
be a poor measure: they touch or not); the peak pressure is the mean within 0.3 a of the axis times Hertz's ratio of the peak to that mean. What limits the agreement besides the mesh: half \
spaces are replaced by bodies ten contact radii deep, which are stiffer, of the order a/8 mm ≈ 10 % in the approach (not in a and p₀ at \
given force), and the strain a/R ≈ 8 % is not infinitesimal. Bounds on the finest mesh: 5 % for a and p₀, 15 % for the approach, chosen \
beforehand; coarser meshes show the trend. The pressures of single `tet10` \
elements oscillate (measurements.md), and with them the peak pressure from mesh to mesh.";

const RADIUS: f64 = 10.0;
const SIDE: f64 = 8.0;
const APPROACH: f64 = 0.06;
const GAP: f64 = 0.002;
const STIFFNESS: f64 = 200.0;

/// Share of the contact radius within which the pressure is averaged.
const CORE: f64 = 0.3;

/// Measured and Hertz's radius, peak pressure and approach.
type Comparison = [[f64; 2]; 3];

/// Rows of four elements; `hex8-sri` is not for slanted ones.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for (element, meshes) in [
        (Formulation::Hex8Q1p0, [8, 14]),
        (Formulation::Hex20, [6, 8]),
        (Formulation::Hex27, [6, 8]),
        (Formulation::Tet10, [6, 8]),
    ] {
        let meshes = match effort {
            // One linear and one quadratic element are enough for a quick look.
            Effort::Quick if !matches!(element, Formulation::Hex8Q1p0 | Formulation::Hex20) => continue,
            Effort::Quick => &meshes[..1],
            Effort::Full => &meshes[..],
        };
        let solved: Vec<Result<Comparison, String>> = meshes.iter().map(|&cells| compare(element, cells)).collect();
        for (which, quantity, bound) in [(0, "contact radius", 0.05), (1, "peak pressure", 0.05), (2, "approach", 0.15)]
        {
            let mut results = solved.iter();
            // The coarsest mesh is there to show the trend: twice the bound.
            let bound = if effort == Effort::Quick { 2.0 * bound } else { bound };
            let last = meshes.len() - 1;
            let mut row = Row::sequence(
                quantity,
                element,
                meshes,
                |cells| (format!("2 × {cells}³"), *cells as f64),
                None,
                bound,
                |_| Ok(results.next().cloned().unwrap_or(Err("not solved".into()))?[which]),
            );
            row.judged_from = last;
            rows.push(row.with_known_limit(element == Formulation::Tet10 && quantity == "peak pressure"));
        }
    }
    rows
}

fn compare(formulation: Formulation, cells: usize) -> Result<Comparison, String> {
    let problem = bodies(formulation, cells);
    let top = SIDE + GAP;
    let stages = [0.2, 0.4, 0.6, 0.8, 1.0].map(|share| {
        let way = share * (APPROACH + GAP);
        displacement(&problem.mesh, |[x, y, z]| [x, y, if near(z, top) { z - way } else { z }])
    });
    let state = last(prescribe(&problem, stages)?)?;
    let quarter: f64 =
        problem.mesh.select_nodes(|x| near(x[2], top)).iter().map(|&n| state.reaction[n as usize][2]).sum();
    let force = 4.0 * quarter.abs();
    let modulus = 2.0 * problem.material.shear_modulus();
    let radius = (0.75 * force * RADIUS / modulus).cbrt();
    let peak = 1.5 * force / (PI * radius * radius);
    let points = touching_points(&problem, &state.displacement);
    let total: f64 = points.iter().map(|p| p.traction * p.area).sum();
    let moment: f64 = points.iter().map(|p| p.traction * p.area * p.distance.powi(2)).sum();
    let near_axis = || points.iter().filter(|p| p.distance < CORE * radius);
    let area: f64 = near_axis().map(|p| p.area).sum();
    let mean = near_axis().map(|p| p.traction * p.area).sum::<f64>() / area;
    // Mean of sqrt(1 − ρ²/a²) within CORE a.
    let share = 2.0 / 3.0 * (1.0 - (1.0 - CORE * CORE).powf(1.5)) / (CORE * CORE);
    Ok([[(2.5 * moment / total).sqrt(), radius], [mean / share, peak], [APPROACH, radius * radius / RADIUS]])
}

/// A contact point that touches: distance from the axis, mm; pressure, MPa; area, mm².
struct Touching {
    distance: f64,
    traction: f64,
    area: f64,
}

fn touching_points(problem: &Problem, displacement: &[[f64; 3]]) -> Vec<Touching> {
    let model = ContactModel::of(problem);
    let positions: Vec<[f64; 3]> =
        (problem.mesh.nodes.iter().zip(displacement)).map(|(x, u)| std::array::from_fn(|k| x[k] + u[k])).collect();
    let mut touching = Vec::new();
    for block in model.search(&positions).blocks {
        let nodes = &block.nodes[..block.nodes.len() / 2];
        for point in &block.points {
            let shape = shape::evaluate_face(problem.mesh.kind.face_kind(0), point.slave_xi);
            let along =
                |k: usize| -> f64 { nodes.iter().zip(shape.values).map(|(&n, v)| v * positions[n as usize][k]).sum() };
            touching.push(Touching { distance: along(0).hypot(along(1)), traction: point.traction, area: point.area });
        }
    }
    touching
}

fn bodies(formulation: Formulation, cells: usize) -> Problem {
    let kind = formulation.element_kind();
    // Cells grow towards the far sides, by a factor of about ten.
    let graded = |count: usize| -> Vec<f64> {
        (0..=count).map(|i| i as f64 / count as f64).map(|t| SIDE * (0.15 * t + 0.85 * t.powi(3))).collect()
    };
    let (across, down) = (graded(cells), graded(cells));
    let below = down.iter().rev().map(|z| -z).collect();
    let flat = Lattice { lines: [across.clone(), across.clone(), below] }.mesh_all(kind);
    let ball = Lattice { lines: [across.clone(), across, down] }.mesh_all(kind);
    let master = flat.select_facets(|x| near(x[2], 0.0));
    let mut slave = ball.select_facets(|x| near(x[2], 0.0));
    slave.iter_mut().for_each(|facet| facet.element += flat.num_elements() as u32);
    // The lower side becomes a sphere near the axis and its tangent cone further away, where nothing touches; the top stays
    // flat.
    let ball: Mesh = ball.map_nodes(|[x, y, z]| {
        const CONE: f64 = 2.0;
        let rho = x.hypot(y);
        let sphere = |rho: f64| RADIUS - (RADIUS * RADIUS - rho * rho).sqrt();
        let slope = CONE / (RADIUS * RADIUS - CONE * CONE).sqrt();
        let height = if rho < CONE { sphere(rho) } else { sphere(CONE) + slope * (rho - CONE) };
        [x, y, z + GAP + height * (1.0 - z / SIDE)]
    });
    let neo_hookean = Material { law: Law::NeoHooke { c10: 0.2712 }, ..material(300.0) };
    let mut problem = body(joined(flat, &ball), formulation, neo_hookean);
    problem.contact = Contact { stiffness: STIFFNESS, ..Contact::default() };
    problem.contact_pairs = vec![ContactPair::new("ball", slave, master)];
    hold(&mut problem, "x", [true, false, false], |x| near(x[0], 0.0));
    hold(&mut problem, "y", [false, true, false], |x| near(x[1], 0.0));
    hold(&mut problem, "far sides", [true; 3], |x| near(x[2], -SIDE) || near(x[2], SIDE + GAP));
    problem
}
