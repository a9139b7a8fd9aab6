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
A body with a spherical lower side is pressed on a flat block until the contact's radius is a ≈ 0.8 mm; the sphere has R = 16 mm (a/R ≈ 0.05) or 4 mm \
(a/R ≈ 0.2). Both are neo-Hookean (C20 = C30 = 0), κ = 300 MPa (ν = 0.4991), penalty k = 200 N/mm³; a quarter on planes of symmetry, 8 × 8 × 8 mm \
each, lattices graded towards the contact. Hertz \
(Johnson 1985, *Contact Mechanics*, §4.2) with E* = 2 μ: from the measured force F, a³ = 3FR/(4E*), p₀ = 3F/(2πa²) and the approach \
δ = a²/R. The contact radius is that of the Hertzian pressure with the measured second moment, ⟨ρ²⟩ = 2a²/5 (the outermost touching points would \
be a poor measure: they touch or not); the peak pressure is the mean within 0.3 a of the axis times Hertz's ratio of the peak to that mean. What limits the agreement besides the mesh: half \
spaces are replaced by bodies ten contact radii deep, which are stiffer, of the order a/8 mm ≈ 10 % in the approach (not in a and p₀ at \
given force), and strains of the order of a/R are not infinitesimal. Bounds on the finest mesh: 2 % for a, 3 % for p₀, 15 % for the approach, chosen \
beforehand; coarser meshes show the trend.";

/// Radius of the contact according to Hertz for the approach, mm.
const CONTACT_RADIUS: f64 = 0.8;
/// a/R.
const STEEPNESSES: [f64; 2] = [0.05, 0.2];
const SIDE: f64 = 8.0;
const GAP: f64 = 0.002;
const STIFFNESS: f64 = 200.0;

/// How much wider the bounds are for the coarsest mesh.
const COARSE: f64 = 3.0;

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
        (Formulation::Tet15, [4, 6]),
    ] {
        for steepness in STEEPNESSES {
            let meshes = match (effort, element) {
                (Effort::Full, _) => &meshes[..],
                // One linear element on the flatter sphere and a quadratic one on the other are enough for a quick look.
                (Effort::Quick, Formulation::Hex8Q1p0) if steepness == STEEPNESSES[0] => &meshes[..1],
                (Effort::Quick, Formulation::Hex20) if steepness == STEEPNESSES[1] => &meshes[..1],
                (Effort::Quick, _) => continue,
            };
            let solved: Vec<Result<Comparison, String>> =
                meshes.iter().map(|&cells| Sphere { steepness }.compare(element, cells)).collect();
            for (which, quantity, bound) in
                [(0, "contact radius", 0.02), (1, "peak pressure", 0.03), (2, "approach", 0.15)]
            {
                let mut results = solved.iter();
                // The coarsest mesh is there to show the trend.
                let bound = if effort == Effort::Quick { COARSE * bound } else { bound };
                let mut row = Row::sequence(
                    format!("{quantity}, a/R ≈ {steepness}"),
                    element,
                    meshes,
                    |cells| (format!("2 × {cells}³"), *cells as f64),
                    None,
                    bound,
                    |_| Ok(results.next().cloned().unwrap_or(Err("not solved".into()))?[which]),
                );
                row.judged_from = meshes.len() - 1;
                rows.push(row);
            }
        }
    }
    rows
}

/// The sphere by its a/R.
#[derive(Clone, Copy)]
struct Sphere {
    steepness: f64,
}

impl Sphere {
    fn radius(self) -> f64 {
        CONTACT_RADIUS / self.steepness
    }

    fn compare(self, formulation: Formulation, cells: usize) -> Result<Comparison, String> {
        let problem = self.on_block(formulation, cells);
        let (top, approach) = (SIDE + GAP, CONTACT_RADIUS * self.steepness);
        let stages = [0.2, 0.4, 0.6, 0.8, 1.0].map(|share| {
            let way = share * (approach + GAP);
            displacement(&problem.mesh, |[x, y, z]| [x, y, if near(z, top) { z - way } else { z }])
        });
        let state = last(prescribe(&problem, stages)?)?;
        let quarter: f64 =
            problem.mesh.select_nodes(|x| near(x[2], top)).iter().map(|&n| state.reaction[n as usize][2]).sum();
        let force = 4.0 * quarter.abs();
        let modulus = 2.0 * problem.material.shear_modulus();
        let radius = (0.75 * force * self.radius() / modulus).cbrt();
        let peak = 1.5 * force / (PI * radius * radius);
        let points = touching_points(&problem, &state.displacement);
        let total: f64 = points.iter().map(|p| p.traction * p.area).sum();
        let moment: f64 = points.iter().map(|p| p.traction * p.area * p.distance.powi(2)).sum();
        let near_axis = || points.iter().filter(|p| p.distance < CORE * radius);
        let area: f64 = near_axis().map(|p| p.area).sum();
        let mean = near_axis().map(|p| p.traction * p.area).sum::<f64>() / area;
        // Mean of sqrt(1 − ρ²/a²) within CORE a.
        let share = 2.0 / 3.0 * (1.0 - (1.0 - CORE * CORE).powf(1.5)) / (CORE * CORE);
        Ok([[(2.5 * moment / total).sqrt(), radius], [mean / share, peak], [approach, radius * radius / self.radius()]])
    }

    fn on_block(self, formulation: Formulation, cells: usize) -> Problem {
        let (kind, radius) = (formulation.element_kind(), self.radius());
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
            let sphere = |rho: f64| radius - (radius * radius - rho * rho).sqrt();
            let slope = CONE / (radius * radius - CONE * CONE).sqrt();
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
        let slave = model.slave(block.partner);
        let nodes = slave.face(block.slave_face);
        for point in &block.points {
            let shape = shape::evaluate_face(slave.kind(block.slave_face), point.slave_xi);
            let along =
                |k: usize| -> f64 { nodes.iter().zip(shape.values).map(|(&n, v)| v * positions[n as usize][k]).sum() };
            touching.push(Touching { distance: along(0).hypot(along(1)), traction: point.traction, area: point.area });
        }
    }
    touching
}
