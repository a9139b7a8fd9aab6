//! Two blocks with faces that do not match, pressed together.

use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Mesh, ReferenceBody};
use pneuflex_model::{Contact, ContactMethod, ContactPair, Formulation, Problem};
use pneuflex_post::stress;

use crate::Effort;
use crate::body::{body, displacement, hold, last, material, near, prescribe};
use crate::homogeneous::bar_stress;
use crate::row::Row;
use crate::yeoh::root;

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
Two blocks of 2 × 2 × 1 mm with different lattices across the contact (slave n × n, master (n + 1) × (n + 1) cells), on planes of symmetry, are \
pressed together by 0.2 mm (k = 20 N/mm³, κ = 1000 MPa). The exact state is homogeneous: both heights shrink to the stretch \
s at which 2 (1 − s) 1 mm + p/k is the way, p being the nominal pressure of the bar. Quantities are p, MPa, and the largest \
deviation of σ_zz from its mean over all integration points, relative to it. *Mortar* contact (averaged gaps, theory §5.9) passes to rounding on \
every element, also where the slave's faces are skewed (their middle moved by (0.2, −0.1) mm); skewed `hex8-sri` has forces of its own there: the \
one point of its volumetric part does not integrate a uniform pressure. *Points* (multiple-point contact, theory §5.4) pass to rounding on matching faces; faces that do not match pass \
in the mean only: the pressure on the slave is uniform, but the master's nodal forces are sums over the slave's 4 × 4 points, which \
do not integrate the master's shape functions exactly where they have kinks (El-Abbasi & Bathe 2001, *Comput. Struct.* 79). For one slave \
face on two quadratic master faces these sums are off by 13 to 38 % at the nodes, and the stresses next to the faces follow them. Their deviation is \
reported without a bound. The meshes of `tet15` and `wedge21` avoid \
2² on 3² with points: there the centroids of the slave's triangles, which are contact points, lie exactly on edges between master faces, whose normals \
differ once they bend, and Newton's method does not settle.";

const STIFFNESS: f64 = 20.0;
const WAY: f64 = 0.2;

/// How the blocks meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// How contact is looked for.
    pub method: ContactMethod,
    /// Cells of the slave's face along each edge.
    pub slave: usize,
    /// Cells of the master's.
    pub master: usize,
    /// How far the middle of the slave's face is moved within it, mm; needs an even number of its cells.
    pub skew: [f64; 2],
}

/// Rows of all elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for &element in effort.elements() {
        let meshes: [usize; 2] = match element {
            Formulation::Tet15 | Formulation::Wedge21 => [3, 4],
            _ if element.element_kind().is_quadratic() => [2, 4],
            _ => [4, 8],
        };
        let describe = |n: &usize, m: usize| (format!("{n}² on {m}²"), *n as f64);
        let differing = effort.of(&meshes);
        for method in [ContactMethod::MultiPoint, ContactMethod::Mortar] {
            let (name, most) = match method {
                ContactMethod::Mortar => ("mortar", 1e-6),
                _ => ("points", f64::INFINITY),
            };
            let meets = |n: usize| Meeting { method, slave: n, master: n + 1, skew: [0.0; 2] };
            let solved: Vec<_> = differing.iter().map(|&n| press(element, meets(n))).collect();
            for (quantity, bound) in [("nominal pressure", 0.01), ("largest deviation", most)] {
                let mut results = solved.iter();
                let is_pressure = quantity == "nominal pressure";
                rows.push(Row::sequence(
                    format!("{quantity}, non-matching faces, {name}"),
                    element,
                    differing,
                    |n| describe(n, n + 1),
                    None,
                    if is_pressure && method == ContactMethod::Mortar { 1e-6 } else { bound },
                    |_| {
                        let [pressure, exact, deviation] =
                            results.next().cloned().unwrap_or(Err("not solved".into()))?;
                        Ok(if is_pressure { [pressure, exact] } else { [deviation, 0.0] })
                    },
                ));
            }
        }
        let even = if meshes[0].is_multiple_of(2) { meshes[0] } else { 2 };
        let skewed = Meeting { method: ContactMethod::Mortar, slave: even, master: even + 1, skew: [0.2, -0.1] };
        rows.push(
            Row::sequence(
                "largest deviation, skewed faces, mortar",
                element,
                &[even],
                |n| describe(n, n + 1),
                None,
                1e-6,
                |_| Ok([press(element, skewed)?[2], 0.0]),
            )
            .with_known_limit(element == Formulation::Hex8Sri),
        );
        let matching =
            Meeting { method: ContactMethod::MultiPoint, slave: meshes[0], master: meshes[0], skew: [0.0; 2] };
        rows.push(Row::sequence(
            "largest deviation, matching faces, points",
            element,
            &meshes[..1],
            |n| describe(n, *n),
            None,
            1e-8,
            |_| Ok([press(element, matching)?[2], 0.0]),
        ));
    }
    rows
}

/// Nominal pressure measured and exact, MPa; largest relative deviation of σ_zz.
///
/// # Errors
/// What kept the solver from converging.
pub fn press(formulation: Formulation, meeting: Meeting) -> Result<[f64; 3], String> {
    let problem = blocks(formulation, meeting);
    let stages = (1..=4).map(|i| {
        let way = 0.25 * WAY * f64::from(i);
        displacement(&problem.mesh, |[x, y, z]| [x, y, if near(z, 2.0) { z - way } else { z }])
    });
    let state = last(prescribe(&problem, stages)?)?;
    let top = problem.mesh.select_nodes(|x| near(x[2], 2.0));
    let force: f64 = top.iter().map(|&node| state.reaction[node as usize][2]).sum();
    // The way grows as the stretch falls.
    let stretch = root(0.8, 1.0, |s| WAY - 2.0 * (1.0 - s) + bar_stress(&problem.material, s) / STIFFNESS);

    let field = stress::recover(&problem, &state.displacement).map_err(|e| e.to_string())?;
    let volume: f64 = field.points.iter().map(|p| p.volume).sum();
    let mean = field.points.iter().map(|p| p.volume * p.stress[2]).sum::<f64>() / volume;
    let deviation = field.points.iter().fold(0.0, |worst: f64, p| worst.max((p.stress[2] / mean - 1.0).abs()));
    Ok([-force / 4.0, -bar_stress(&problem.material, stretch), deviation])
}

/// The slave is the upper block; both stand on planes of symmetry in x and y.
fn blocks(formulation: Formulation, Meeting { method, slave, master, skew }: Meeting) -> Problem {
    let kind = formulation.element_kind();
    // Bilinear on each quarter of the face, or linear on its triangles, so that edges stay straight.
    let skewed = |[x, y, z]: [f64; 3]| {
        let (dx, dy) = (x - 1.0, y - 1.0);
        let share = match kind.body {
            ReferenceBody::Tetrahedron | ReferenceBody::Wedge => {
                (1.0 - dx.abs().max(dy.abs()).max((dx - dy).abs())).max(0.0)
            }
            ReferenceBody::Hexahedron => (1.0 - dx.abs()) * (1.0 - dy.abs()),
        };
        [x + share * skew[0], y + share * skew[1], z]
    };
    let lower = Lattice::uniform([0.0; 3], [2.0, 2.0, 1.0], [master, master, 1]).mesh_all(kind);
    let upper = Lattice::uniform([0.0, 0.0, 1.0], [2.0, 2.0, 2.0], [slave, slave, 1]).mesh_all(kind).map_nodes(skewed);
    let shared = |mesh: &Mesh| mesh.select_facets(|x| near(x[2], 1.0));
    let (of_lower, mut of_upper) = (shared(&lower), shared(&upper));
    of_upper.iter_mut().for_each(|facet| facet.element += lower.num_elements() as u32);
    let mut problem = body(joined(lower, &upper), formulation, material(1000.0));
    problem.contact = Contact { method, stiffness: STIFFNESS, ..Contact::default() };
    problem.contact_pairs = vec![ContactPair::new("faces", of_upper, of_lower)];
    hold(&mut problem, "x", [true, false, false], |x| near(x[0], 0.0));
    hold(&mut problem, "y", [false, true, false], |x| near(x[1], 0.0));
    hold(&mut problem, "ends", [false, false, true], |x| near(x[2], 0.0) || near(x[2], 2.0));
    problem
}

/// Two meshes as one, not connected; the second one's nodes and elements come last.
pub(crate) fn joined(mut first: Mesh, second: &Mesh) -> Mesh {
    let shift = first.num_nodes() as u32;
    first.connectivity.extend(second.connectivity.iter().map(|n| n + shift));
    first.nodes.extend(&second.nodes);
    first
}
