//! Two arches that are pressed on each other, and a round die that irons a slab.

use std::f64::consts::PI;

use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::{
    Clock, Contact, ContactMethod, ContactPair, Curve, Formulation, Law, Material, Motion, Problem, Solver, Support,
};
use pneuflex_newton::{Event, follow_path};

use crate::Effort;
use crate::body::{body, displacement, hold, last, material, near, prescribe};
use crate::contact_patch::joined;
use crate::row::Row;

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
Slices in plane strain of neo-Hookean rubber (c10 = 0.25 MPa, κ = 125 MPa), whose faces do not match; multipliers keep depths below a thousandth of a \
mm. Two half-ring arches (radii 8 and 10 mm), crown on crown, are brought together by 2 mm at their feet. Exact is one of them under a \
stiff flat block, which is the plane of symmetry of both, moved by 1 mm: the force on the same mesh. Then a round die (R = 6 mm) is pressed by 0.5 mm \
into a slab of 16 × 3 mm and slides along its middle by 2 mm. Without friction the energy does not know where the die is: the \
sideways force is 0 and the pressing force stays the same, far from the slab's ends. Rows give the largest sideways force and the \
largest change of the pressing force as shares of the pressing force. Bounds: 1 % each, for the arches on the finer mesh (two elements across \
hold the coarse ones stiff). Ironing is with averaged gaps alone: points that pass an edge of the slab's faces feel its normal jump, and Newton's \
method stops there (measurements.md).";

/// Largest depth, mm.
const TOLERANCE: f64 = 1e-3;
const STIFFNESS: f64 = 20.0;
const METHODS: [(ContactMethod, &str); 2] = [(ContactMethod::MultiPoint, "points"), (ContactMethod::Mortar, "mortar")];

/// Rows of three elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for (element, arch, slab) in [
        (Formulation::Hex8Q1p0, [24, 40], [32, 64]),
        (Formulation::Hex27, [12, 20], [16, 32]),
        (Formulation::Tet15, [12, 20], [16, 32]),
    ] {
        // One element and one mesh are enough for a quick look.
        let meshes = if effort == Effort::Quick { 1 } else { 2 };
        if effort == Effort::Quick && element != Formulation::Hex8Q1p0 {
            continue;
        }
        for (method, name) in METHODS {
            let mut row = Row::sequence(
                format!("force of two arches, {name}"),
                element,
                &arch[..meshes],
                |n| (format!("{n} on {} around", n + 3), *n as f64),
                None,
                0.01 * (3 - meshes) as f64,
                |&n| Ok([arches(element, method, [n, n + 3])?, half_of_them(element, n)?]),
            );
            row.judged_from = meshes - 1;
            rows.push(row);
        }
        let solved: Vec<_> = slab[..meshes].iter().map(|&n| iron(element, n)).collect();
        for (which, quantity) in [(0, "largest sideways force"), (1, "largest change of the force")] {
            let mut results = solved.iter();
            rows.push(Row::sequence(
                format!("{quantity}, ironing, mortar"),
                element,
                &slab[..meshes],
                |n| (format!("{n} along"), *n as f64),
                None,
                0.01,
                |_| Ok([results.next().cloned().unwrap_or(Err("not solved".into()))?[which], 0.0]),
            ));
        }
    }
    rows
}

const RADII: [f64; 2] = [8.0, 10.0];
const GAP: f64 = 0.01;

/// Force between two arches with so many elements around, N.
fn arches(element: Formulation, method: ContactMethod, [lower, upper]: [usize; 2]) -> Result<f64, String> {
    let top = 2.0 * RADII[1] + GAP;
    let lower = arch(element, lower);
    let upper = arch(element, upper).moved(|[x, y, z]| [x, 1.0 - y, top - z]);
    let problem = slice(element, method, lower, upper, |[_, _, z]| near(z, 0.0) || near(z, top));
    bring_together(&problem, 2.0 + GAP, top)
}

/// Force of the lower arch on a rigid flat block that comes down half as far, N.
fn half_of_them(element: Formulation, around: usize) -> Result<f64, String> {
    let low = RADII[1] + 0.5 * GAP;
    let block = Lattice::uniform([-9.0, 0.0, low], [9.0, 1.0, low + 1.0], [9, 1, 1]).mesh_all(element.element_kind());
    let facets = block.select_facets(|x| near(x[2], low));
    let problem =
        slice(element, ContactMethod::MultiPoint, arch(element, around), Part { mesh: block, facets }, |[_, _, z]| {
            near(z, 0.0) || z > low - 1e-9
        });
    bring_together(&problem, 1.0 + 0.5 * GAP, low)
}

/// Force on everything from a height on after it has come down, N.
fn bring_together(problem: &Problem, way: f64, from: f64) -> Result<f64, String> {
    let stage = |i: usize| {
        let down = way * i as f64 / 10.0;
        displacement(&problem.mesh, |[x, y, z]| [x, y, if z > from - 1e-9 { z - down } else { z }])
    };
    let state = last(prescribe(problem, (1..=10).map(stage))?)?;
    Ok(force_on(problem, &state.reaction, from)[2].abs())
}

/// A mesh with the faces that touch.
struct Part {
    mesh: Mesh,
    facets: Vec<Facet>,
}

impl Part {
    fn moved(self, to: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        Self { mesh: self.mesh.map_nodes(to), facets: self.facets }
    }
}

/// A half ring on its feet; the quarter around its crown may touch.
fn arch(element: Formulation, around: usize) -> Part {
    let lattice = Lattice::uniform([0.0, 0.0, RADII[0]], [PI, 1.0, RADII[1]], [around, 1, 2]);
    let mesh = lattice.mesh_all(element.element_kind());
    let facets = mesh.select_facets(|x| near(x[2], RADII[1]) && (x[0] - 0.5 * PI).abs() < 0.25 * PI);
    Part { mesh, facets }.moved(|[angle, y, r]| [-r * angle.cos(), y, r * angle.sin()])
}

/// Two parts in plane strain, held where `is_held`.
fn slice(
    element: Formulation,
    method: ContactMethod,
    master: Part,
    slave: Part,
    is_held: impl Fn([f64; 3]) -> bool,
) -> Problem {
    let shift = master.mesh.num_elements() as u32;
    let of_slave = slave.facets.iter().map(|facet| Facet { element: facet.element + shift, ..*facet }).collect();
    let rubber = Material { law: Law::NeoHooke { c10: 0.25 }, ..material(125.0) };
    let mut problem = body(joined(master.mesh, &slave.mesh), element, rubber);
    problem.contact =
        Contact { method, stiffness: STIFFNESS, penetration_tolerance: Some(TOLERANCE), ..Contact::default() };
    problem.contact_pairs = vec![ContactPair::new("faces", of_slave, master.facets)];
    hold(&mut problem, "sides", [false, true, false], |_| true);
    hold(&mut problem, "ends", [true; 3], is_held);
    problem
}

/// Sum of reactions (N, one entry per node) from a height on.
fn force_on(problem: &Problem, reaction: &[[f64; 3]], height: f64) -> [f64; 3] {
    let nodes = problem.mesh.select_nodes(|x| x[2] > height - 1e-9);
    std::array::from_fn(|axis| nodes.iter().map(|&n| reaction[n as usize][axis]).sum())
}

/// Largest sideways force and largest change of the pressing force along the slab, as shares of the mean pressing force.
fn iron(element: Formulation, along: usize) -> Result<[f64; 2], String> {
    const DIE: [f64; 2] = [2.0, 2.0];
    const RADIUS: f64 = 6.0;
    const STAGES: usize = 40;
    let kind = element.element_kind();
    let slab = Lattice::uniform([-8.0, 0.0, -3.0], [8.0, 1.0, 0.0], [along, 1, along * 3 / 16]).mesh_all(kind);
    let die =
        Lattice::uniform([-DIE[0], 0.0, 0.0], [DIE[0], 1.0, DIE[1]], [along / 4 + 1, 1, along / 8]).mesh_all(kind);
    let master = Part { facets: slab.select_facets(|x| near(x[2], 0.0)), mesh: slab };
    let slave = Part { facets: die.select_facets(|x| near(x[2], 0.0)), mesh: die }.moved(|[x, y, z]| {
        let height = RADIUS - (RADIUS * RADIUS - x * x).sqrt();
        [x - 1.0, y, z + GAP + height * (1.0 - z / DIE[1])]
    });
    let top = DIE[1] + GAP;
    let mut problem = slice(element, ContactMethod::Mortar, master, slave, |[_, _, z]| near(z, -3.0));
    problem.clock = Clock::Steps;
    let nodes = problem.mesh.select_nodes(|x| near(x[2], top));
    for (axis, way, curve) in
        [(2, -0.5 - GAP, vec![[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]), (0, 2.0, vec![[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]])]
    {
        let along = |value: f64| std::array::from_fn(|k| if k == axis { value } else { 0.0 });
        problem.supports.push(Support {
            name: "die".into(),
            nodes: nodes.clone(),
            axes: std::array::from_fn(|k| k == axis),
            motion: Some(Motion { displacement: along(way), curve: Curve::Table(curve) }),
        });
    }
    let mut forces = Vec::new();
    let mut observer = |event: Event<'_>| {
        if let Event::Converged(state) = event {
            forces.push(force_on(&problem, &state.reaction, top));
        }
    };
    let times: Vec<f64> = (0..=STAGES).map(|i| 1.0 + i as f64 / STAGES as f64).collect();
    let settings = Solver { first_step: 0.05, max_step: 0.1, min_step: 1e-4, ..Solver::default() };
    follow_path(&problem, &times, &settings, &mut observer).map_err(|ended| ended.0.to_string())?;
    let mean = forces.iter().map(|force| force[2]).sum::<f64>() / forces.len() as f64;
    let largest = |of: &dyn Fn(&[f64; 3]) -> f64| forces.iter().map(of).fold(0.0_f64, |a, b| a.max(b.abs()));
    Ok([largest(&|force| force[0] / mean), largest(&|force| force[2] / mean - 1.0)])
}
