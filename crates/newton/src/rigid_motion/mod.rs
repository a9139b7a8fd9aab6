//! Rigid motions of a body's parts that nothing holds, found before anything is solved (theory §15).
//!
//! A part is what faces of elements join, or a node that belongs to no element. Each has six rigid motions, u(x) = t + ω × (x − c); supports, linear equations and nodes shared
//! with other parts (a hinge) are linear constraints on them. What is left is found part by part: constraints between parts join their
//! motions to those of a cluster, of which few are left at any time.

mod clusters;
mod words;

use std::collections::BTreeSet;

use nalgebra::DMatrix;
use pneuflex_mesh::Mesh;
use pneuflex_model::{ContactMethod, Problem};

use clusters::{Clusters, Row, Rows};
pub use words::{RigidMotions, Rotation};

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
    let mut clusters = Clusters::of(parts.supports(&problem.held_dofs()));
    clusters.constrain(parts.hinges());
    clusters.constrain(parts.equations(problem));
    clusters.constrain(parts.distances(problem));
    let motions = |(number, part): (usize, &Part)| {
        // A part without extent is refused for that, with its element.
        if part.radius > f64::MIN_POSITIVE || part.elements.is_empty() {
            clusters.motions(number)
        } else {
            DMatrix::zeros(6, 0)
        }
    };
    let free: Vec<DMatrix<f64>> = parts.list.iter().enumerate().map(motions).collect();
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
        for (node, part) in of_node.iter_mut().enumerate().filter(|(_, part)| **part == usize::MAX) {
            *part = list.len();
            list.push(Part { elements: Vec::new(), num_nodes: 1, centre: mesh.nodes[node], radius: f64::MIN_POSITIVE });
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

    /// What supports hold of every part; `held` says so for every degree of freedom.
    fn supports(&self, held: &[bool]) -> Vec<Rows> {
        let count = self.list.len();
        let mut rows: Vec<Rows> = (0..count).map(|_| Rows::new(6)).collect();
        // Single nodes do not turn.
        for (rows, _) in rows.iter_mut().zip(&self.list).filter(|(_, part)| part.elements.is_empty()) {
            (3..6).for_each(|k| rows.push(&std::array::from_fn::<f64, 6, _>(|i| f64::from(u8::from(i == k)))));
        }
        for (node, &part) in self.of_node.iter().enumerate().filter(|(_, part)| **part < count) {
            for axis in (0..3).filter(|axis| held[3 * node + axis]) {
                rows[part].push(&self.row(part, self.mesh.nodes[node], axis));
            }
        }
        rows
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

    /// Two nodes at a fixed distance move alike along the line through them.
    fn distances(&self, problem: &Problem) -> Vec<Row> {
        let row = |&[a, b]: &[u32; 2]| {
            let [from, to] = [a, b].map(|node| self.mesh.nodes[node as usize]);
            let mut row = Row::new();
            for (node, sign) in [(a, 1.0), (b, -1.0)] {
                let part = self.of_node[node as usize];
                let sum = row.entry(part).or_insert([0.0; 6]);
                for axis in 0..3 {
                    let of_axis = self.row(part, self.mesh.nodes[node as usize], axis);
                    (0..6).for_each(|k| sum[k] += sign * (from[axis] - to[axis]) * of_axis[k]);
                }
            }
            let length = (0..3).map(|k| (from[k] - to[k]).powi(2)).sum::<f64>().sqrt();
            row.values_mut().flatten().for_each(|entry| *entry /= length);
            row
        };
        problem.distances.iter().map(row).collect()
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

#[cfg(test)]
mod tests;
