//! Rigid motions of a body's parts that nothing holds, found before anything is solved (theory §15).
//!
//! A part is what faces of elements join. Each has six rigid motions, u(x) = t + ω × (x − c); supports, linear equations and nodes shared
//! with other parts (a hinge) are linear constraints on them. What is left is found part by part: constraints between parts join their
//! motions to those of a cluster, of which few are left at any time.

mod words;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{DMatrix, Matrix3xX};
use pneuflex_mesh::Mesh;
use pneuflex_model::{ContactMethod, Problem};

pub use words::{RigidMotions, Rotation};

/// A rigid motion that its constraints resist by no more than this share counts as free. A body held by a share s has s² of its stiffness
/// against that motion: below 1e-12 rounding decides.
const FREE: f64 = 1e-6;

/// Rows that are collected before they are reduced to a triangle.
const CHUNK: usize = 64;

/// A part of the body that can move without being deformed.
#[derive(Clone, Debug, PartialEq)]
pub struct LoosePart {
    /// Its elements.
    pub elements: Vec<u32>,
    /// Number of its nodes.
    pub num_nodes: usize,
    /// Centre of its nodes, mm.
    pub centre: [f64; 3],
    /// How it can move.
    pub motions: RigidMotions,
    /// Whether contact with obstacles, or with parts that are held, may hold it.
    pub may_be_held_by_contact: bool,
}

/// Parts of the body that neither supports nor equations hold.
pub fn loose_parts(problem: &Problem) -> Vec<LoosePart> {
    let parts = Parts::of(&problem.mesh);
    let mut clusters = Clusters::of(&parts, &problem.held_dofs());
    clusters.constrain(parts.hinges());
    clusters.constrain(parts.equations(problem));
    let free: Vec<DMatrix<f64>> = (0..parts.list.len()).map(|part| clusters.motions(part)).collect();
    if free.iter().all(|motions| motions.ncols() == 0) {
        return Vec::new();
    }
    clusters.constrain(parts.contacts(problem));
    let described = parts.list.iter().enumerate().filter(|(number, _)| free[*number].ncols() > 0);
    let described = described.map(|(number, part)| LoosePart {
        elements: part.elements.clone(),
        num_nodes: part.num_nodes,
        centre: part.centre,
        motions: RigidMotions::of(&free[number], part.centre, part.radius),
        may_be_held_by_contact: clusters.motions(number).ncols() == 0,
    });
    described.collect()
}

/// Elements that faces join.
struct Part {
    elements: Vec<u32>,
    num_nodes: usize,
    centre: [f64; 3],
    /// Largest distance of a node from the centre, mm.
    radius: f64,
}

/// The parts of a mesh.
struct Parts<'a> {
    mesh: &'a Mesh,
    list: Vec<Part>,
    /// A part of every node.
    of_node: Vec<usize>,
    /// Further parts of nodes: node, part.
    shared: Vec<(usize, usize)>,
    of_element: Vec<usize>,
}

/// A displacement as a linear function of the motions of some parts: t and r ω of each.
type Row = BTreeMap<usize, [f64; 6]>;

impl<'a> Parts<'a> {
    fn of(mesh: &'a Mesh) -> Self {
        let of_element = mesh.parts_by_faces();
        let count = of_element.iter().max().map_or(0, |last| last + 1);
        let mut elements: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (element, &part) in of_element.iter().enumerate() {
            elements[part].push(element as u32);
        }
        let mut of_node = vec![usize::MAX; mesh.num_nodes()];
        let mut shared = Vec::new();
        let mut list = Vec::new();
        for (number, elements) in elements.into_iter().enumerate() {
            let mut nodes: Vec<u32> = elements.iter().flat_map(|&e| mesh.element(e as usize)).copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            for &node in &nodes {
                match &mut of_node[node as usize] {
                    first if *first == usize::MAX => *first = number,
                    _ => shared.push((node as usize, number)),
                }
            }
            let positions = || nodes.iter().map(|&node| mesh.nodes[node as usize]);
            let centre = std::array::from_fn(|k| positions().map(|x| x[k]).sum::<f64>() / nodes.len() as f64);
            let distance = |x: [f64; 3]| (0..3).map(|k| (x[k] - centre[k]).powi(2)).sum::<f64>().sqrt();
            let radius = positions().map(distance).fold(f64::MIN_POSITIVE, f64::max);
            list.push(Part { elements, num_nodes: nodes.len(), centre, radius });
        }
        Self { mesh, list, of_node, shared, of_element }
    }

    /// Displacement of a point along an axis as a part moves: t + ω × (x − c), whose component i is t·e + ω·((x − c) × e).
    fn row(&self, part: usize, x: [f64; 3], axis: usize) -> [f64; 6] {
        let Part { centre, radius, .. } = &self.list[part];
        let d: [f64; 3] = std::array::from_fn(|k| (x[k] - centre[k]) / radius);
        let mut row = [0.0; 6];
        row[axis] = 1.0;
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        row[3 + next] = d[last];
        row[3 + last] = -d[next];
        row
    }

    /// Two parts move alike at a node that they share.
    fn hinges(&self) -> Vec<Row> {
        let rows = self.shared.iter().flat_map(|&(node, part)| {
            let x = self.mesh.nodes[node];
            (0..3).map(move |axis| self.alike(self.of_node[node], part, x, axis))
        });
        rows.collect()
    }

    fn alike(&self, a: usize, b: usize, x: [f64; 3], axis: usize) -> Row {
        let row = Row::from([(a, self.row(a, x, axis)), (b, self.row(b, x, axis).map(|entry| -entry))]);
        normalised(row)
    }

    /// The problem's linear equations.
    fn equations(&self, problem: &Problem) -> Vec<Row> {
        let row = |equation: &pneuflex_model::load::LinearEquation| {
            let mut row = Row::new();
            for &(node, axis, coefficient) in &equation.terms {
                let part = self.of_node[node as usize];
                let of_term = self.row(part, self.mesh.nodes[node as usize], axis.into());
                let sum = row.entry(part).or_insert([0.0; 6]);
                (0..6).for_each(|k| sum[k] += coefficient * of_term[k]);
            }
            let largest = equation.terms.iter().fold(0.0_f64, |largest, (_, _, c)| largest.max(c.abs()));
            row.values_mut().flatten().for_each(|entry| *entry /= largest);
            row
        };
        problem.equations.iter().map(row).collect()
    }

    /// As if every surface that may touch an obstacle were held, and surfaces that may touch each other were glued: what is free then no
    /// contact holds.
    fn contacts(&self, problem: &Problem) -> Vec<Row> {
        let parts_of = |facets: &[pneuflex_mesh::Facet]| -> BTreeSet<usize> {
            facets.iter().map(|facet| self.of_element[facet.element as usize]).collect()
        };
        let mut rows = Vec::new();
        for part in problem.obstacles.iter().flat_map(|obstacle| parts_of(&obstacle.facets)) {
            rows.extend((0..6).map(|k| {
                let mut row = [0.0; 6];
                row[k] = 1.0;
                Row::from([(part, row)])
            }));
        }
        for pair in &problem.contact_pairs {
            if pair.method.unwrap_or(problem.contact.method) == ContactMethod::None {
                continue;
            }
            let (slaves, masters) = (parts_of(&pair.slave), parts_of(&pair.master));
            let (Some(&slave), Some(&master)) = (slaves.first(), masters.first()) else { continue };
            let touching = slaves.iter().map(|&a| (a, master)).chain(masters.iter().map(|&b| (slave, b)));
            for (a, b) in touching.filter(|(a, b)| a != b) {
                let Part { centre, radius, .. } = self.list[a];
                for corner in [[0.0; 3], [radius, 0.0, 0.0], [0.0, radius, 0.0]] {
                    let x = std::array::from_fn(|k| centre[k] + corner[k]);
                    rows.extend((0..3).map(|axis| self.alike(a, b, x, axis)));
                }
            }
        }
        rows
    }
}

fn normalised(mut row: Row) -> Row {
    let norm = row.values().flatten().map(|entry| entry * entry).sum::<f64>().sqrt();
    row.values_mut().flatten().for_each(|entry| *entry /= norm);
    row
}

/// Parts whose motions depend on each other, and a basis of the motions that are left: six rows per part, orthonormal columns.
struct Cluster {
    parts: Vec<usize>,
    basis: DMatrix<f64>,
}

struct Clusters {
    of_part: Vec<usize>,
    /// Emptied once they are part of another.
    list: Vec<Cluster>,
}

impl Clusters {
    /// Every part by itself, as its supports hold it.
    fn of(parts: &Parts<'_>, held: &[bool]) -> Self {
        let count = parts.list.len();
        let mut rows: Vec<Rows> = (0..count).map(|_| Rows::new(6)).collect();
        for (node, &part) in parts.of_node.iter().enumerate().filter(|(_, part)| **part < count) {
            for axis in (0..3).filter(|axis| held[3 * node + axis]) {
                rows[part].push(&parts.row(part, parts.mesh.nodes[node], axis));
            }
        }
        let list = rows.into_iter().enumerate().map(|(part, rows)| Cluster { parts: vec![part], basis: rows.kernel() });
        Self { of_part: (0..count).collect(), list: list.collect() }
    }

    /// What is left of the motions under constraints.
    fn constrain(&mut self, rows: Vec<Row>) {
        // Those of the same parts together.
        let mut groups: BTreeMap<Vec<usize>, Vec<Row>> = BTreeMap::new();
        for row in rows {
            groups.entry(row.keys().copied().collect()).or_default().push(row);
        }
        for (parts, rows) in groups {
            let cluster = self.join(&parts);
            let Cluster { parts: members, basis } = &self.list[cluster];
            if basis.ncols() == 0 {
                continue;
            }
            let place: BTreeMap<usize, usize> =
                members.iter().enumerate().map(|(place, &part)| (part, place)).collect();
            let mut reduced = Rows::new(basis.ncols());
            for row in &rows {
                let along = |motion: usize| -> f64 {
                    let entries = row.iter().flat_map(|(part, row)| {
                        let first = 6 * place[part];
                        row.iter().enumerate().map(move |(k, entry)| entry * basis[(first + k, motion)])
                    });
                    entries.sum()
                };
                reduced.push(&(0..basis.ncols()).map(along).collect::<Vec<_>>());
            }
            let basis = basis * reduced.kernel();
            self.list[cluster].basis = basis;
        }
    }

    /// The cluster that some parts are members of, after theirs were joined.
    fn join(&mut self, parts: &[usize]) -> usize {
        let numbers: BTreeSet<usize> = parts.iter().map(|&part| self.of_part[part]).collect();
        let number = numbers.first().copied().unwrap_or(0);
        if numbers.len() < 2 {
            return number;
        }
        let rows = numbers.iter().map(|&n| self.list[n].basis.nrows()).sum();
        let columns = numbers.iter().map(|&n| self.list[n].basis.ncols()).sum();
        let mut joined = Cluster { parts: Vec::new(), basis: DMatrix::zeros(rows, columns) };
        let mut corner = (0, 0);
        for other in numbers {
            let empty = Cluster { parts: Vec::new(), basis: DMatrix::zeros(0, 0) };
            let Cluster { parts, basis } = std::mem::replace(&mut self.list[other], empty);
            joined.basis.view_mut(corner, basis.shape()).copy_from(&basis);
            corner = (corner.0 + basis.nrows(), corner.1 + basis.ncols());
            parts.iter().for_each(|&part| self.of_part[part] = number);
            joined.parts.extend(parts);
        }
        self.list[number] = joined;
        number
    }

    /// Motions of a part that are left: t and r ω in six rows, orthonormal columns.
    fn motions(&self, part: usize) -> DMatrix<f64> {
        let Cluster { parts, basis } = &self.list[self.of_part[part]];
        let first = parts.iter().position(|&member| member == part).unwrap_or(0);
        if basis.ncols() == 0 {
            return DMatrix::zeros(6, 0);
        }
        let own = basis.rows(6 * first, 6).into_owned();
        let svd = own.svd(true, false);
        let u = svd.u.unwrap_or_else(|| DMatrix::zeros(6, 0));
        let kept: Vec<usize> = (0..u.ncols()).filter(|&k| svd.singular_values[k] > FREE).collect();
        u.select_columns(&kept)
    }
}

/// Rows of a linear system as they come in, reduced to a triangle.
struct Rows {
    columns: usize,
    entries: Vec<f64>,
}

impl Rows {
    fn new(columns: usize) -> Self {
        Self { columns, entries: Vec::new() }
    }

    fn push(&mut self, row: &[f64]) {
        self.entries.extend_from_slice(row);
        if self.entries.len() >= (CHUNK + self.columns) * self.columns {
            self.entries = self.matrix().qr().r().transpose().as_slice().to_vec();
        }
    }

    fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.entries.len() / self.columns.max(1), self.columns, &self.entries)
    }

    /// Orthonormal columns that span what the rows do not resist.
    fn kernel(&self) -> DMatrix<f64> {
        let rows = self.matrix();
        // All right singular vectors, also those that no row belongs to.
        let missing = self.columns.saturating_sub(rows.nrows());
        let square = rows.clone().insert_rows(rows.nrows(), missing, 0.0);
        let svd = square.svd(false, true);
        let vectors = svd.v_t.unwrap_or_else(|| DMatrix::zeros(0, self.columns)).transpose();
        let kept: Vec<usize> = (0..vectors.ncols()).filter(|&k| svd.singular_values[k] <= FREE).collect();
        vectors.select_columns(&kept)
    }
}

/// Columns of three rows each.
type Directions = Matrix3xX<f64>;

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::lattice::Lattice;
    use pneuflex_mesh::{ElementKind, Facet};
    use pneuflex_model::load::{Curve, LinearEquation};
    use pneuflex_model::{Contact, ContactPair, Formulation, Material, Obstacle, Shape, Support};

    /// Cells of 1 mm in a row along x of which the given ones are solid, as large as `scale` says and far from the origin.
    fn cells(solid: &'static [usize], scale: f64) -> Problem {
        let count = solid.last().unwrap() + 1;
        let lattice = Lattice::uniform([0.0; 3], [count as f64, 1.0, 1.0], [count, 1, 1]);
        let mesh = lattice.mesh(ElementKind::Hex8, |cell| solid.contains(&cell[0])).mesh;
        let mesh = mesh.map_nodes(|x| [scale * (x[0] + 3.0), scale * (x[1] - 2.0), scale * x[2]]);
        Problem::body(mesh, Formulation::Hex8Q1p0, Material::default())
    }

    fn hold(problem: &mut Problem, axes: [bool; 3], holds: impl Fn([f64; 3]) -> bool) {
        let nodes = problem.mesh.select_nodes(holds);
        assert!(!nodes.is_empty());
        problem.supports.push(Support { nodes, axes, ..Support::default() });
    }

    fn words(problem: &Problem) -> Vec<String> {
        loose_parts(problem).iter().map(|part| part.motions.to_string()).collect()
    }

    #[test]
    fn what_supports_leave_free_is_named_whatever_the_size_of_the_body() {
        const X: [bool; 3] = [true, false, false];
        const Z: [bool; 3] = [false, false, true];
        for scale in [1e-3, 1.0, 1e4] {
            let body = || cells(&[0], scale);
            let at = |value: f64, place: f64| (value - scale * place).abs() < 1e-9 * scale;
            let [loose] = &loose_parts(&body())[..] else { panic!("one part") };
            assert_eq!((loose.motions.count(), loose.num_nodes, loose.may_be_held_by_contact), (6, 8, false));
            assert_eq!(words(&body()), ["to slide along x, y and z, and to turn about x, y and z"]);
            let mut floor = body();
            hold(&mut floor, Z, |x| x[2] == 0.0);
            assert_eq!(words(&floor), ["to slide along x and y, and to turn about z"]);
            hold(&mut floor, X, |x| at(x[0], 3.0));
            assert_eq!(words(&floor), ["to slide along y"]);
            let mut hinge = body();
            hold(&mut hinge, [true; 3], |x| x[2] == 0.0 && at(x[0], 3.0));
            let through = |x: f64| {
                let text = format!("{:.4}", x * scale);
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            };
            assert_eq!(words(&hinge), [format!("to turn about y through ({}, {}, 0)", through(3.0), through(-1.5))]);
            let mut pinned = body();
            hold(&mut pinned, [true; 3], |x| x[2] == 0.0 && at(x[0], 3.0) && at(x[1], -2.0));
            assert_eq!(words(&pinned), ["to turn about x, y and z"]);
            // Three nodes in three, two and one directions: statically determinate.
            hold(&mut pinned, [false, true, true], |x| x[2] == 0.0 && at(x[0], 4.0) && at(x[1], -2.0));
            assert_eq!(words(&pinned), [format!("to turn about x through ({}, {}, 0)", through(3.5), through(-2.0))]);
            hold(&mut pinned, Z, |x| x[2] == 0.0 && at(x[0], 3.0) && at(x[1], -1.0));
            assert_eq!(words(&pinned), [""; 0]);
        }
    }

    #[test]
    fn equations_hold_as_supports_do_and_say_nothing_if_they_follow_from_others() {
        let mut body = cells(&[0], 1.0);
        hold(&mut body, [false, true, true], |_| true);
        assert_eq!(words(&body), ["to slide along x"]);
        // The same displacement along x at two nodes holds nothing, a node tied to its place does.
        let tied = LinearEquation { terms: vec![(0, 0, 5.0), (1, 0, -5.0)], value: Curve::ZERO };
        body.equations.push(tied);
        assert_eq!(words(&body), ["to slide along x"]);
        body.equations.push(LinearEquation { terms: vec![(0, 0, 1e-4)], value: Curve::ZERO });
        assert_eq!(words(&body), [""; 0]);
    }

    #[test]
    fn ties_carry_what_a_support_holds_from_part_to_part() {
        let mut body = cells(&[0, 2, 4], 1.0);
        hold(&mut body, [true; 3], |x| x[0] == 3.0);
        let free = "to slide along x, y and z, and to turn about x, y and z";
        assert_eq!(words(&body), [free, free]);
        let face = |body: &Problem, x: f64| body.mesh.select_nodes(|at| at[0] == x);
        let tie = |body: &mut Problem, a: f64, b: f64, axes: &[u8]| {
            for (a, b) in face(body, a).into_iter().zip(face(body, b)) {
                let equation =
                    |&axis: &u8| LinearEquation { terms: vec![(a, axis, 1.0), (b, axis, -1.0)], value: Curve::ZERO };
                body.equations.extend(axes.iter().map(equation));
            }
        };
        tie(&mut body, 6.0, 7.0, &[0, 1, 2]);
        // The two behind move as one.
        assert_eq!(words(&body), [free, free]);
        tie(&mut body, 4.0, 5.0, &[0]);
        assert_eq!(words(&body), ["to slide along y and z, and to turn about x"; 2]);
        tie(&mut body, 4.0, 5.0, &[1, 2]);
        assert_eq!(words(&body), [""; 0]);
    }

    #[test]
    fn parts_that_share_an_edge_are_a_hinge() {
        let lattice = Lattice::uniform([0.0; 3], [2.0, 1.0, 2.0], [2, 1, 2]);
        let mesh = lattice.mesh(ElementKind::Hex8, |cell| cell[0] == cell[2]).mesh;
        let mut body = Problem::body(mesh, Formulation::Hex8Q1p0, Material::default());
        hold(&mut body, [true; 3], |x| x[0] == 0.0);
        assert_eq!(words(&body), ["to turn about y through (1, 0.5, 1)"]);
    }

    #[test]
    fn contact_may_hold_what_supports_do_not() {
        let mut body = cells(&[0, 2], 1.0);
        hold(&mut body, [true; 3], |x| x[0] == 3.0);
        let [slave, master] = [5.0, 4.0].map(|x| body.mesh.select_facets(|at| at[0] == x));
        body.contact_pairs.push(ContactPair::new("gap", slave, master));
        let by_contact =
            |body: &Problem| loose_parts(body).iter().map(|part| part.may_be_held_by_contact).collect::<Vec<_>>();
        // Contact is switched off.
        assert_eq!(by_contact(&body), [false]);
        body.contact = Contact::default();
        assert_eq!(by_contact(&body), [true]);
        // Nothing holds either of the two.
        body.supports.clear();
        assert_eq!(by_contact(&body), [false, false]);
        let facets: Vec<Facet> = body.mesh.select_facets(|x| x[2] == 0.0 && x[0] > 4.5);
        let shape = Shape::Plane { point: [0.0; 3], normal: [0.0, 0.0, 1.0] };
        body.obstacles.push(Obstacle {
            name: "floor".into(),
            shape,
            facets,
            stiffness: 1.0,
            motion: None,
            report_force: true,
        });
        assert_eq!(by_contact(&body), [true, true]);
    }
}
