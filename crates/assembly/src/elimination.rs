//! Linear equations that are eliminated: one displacement of each, the slave, follows the others, its masters (theory §6.4).
//!
//! With u = T û, in which the slaves do not occur any more, the residual is Tᵀr and the tangent TᵀKT: exact, as definite as the body is
//! under its constraints, and solved at the cost of a sparse factor (Cook et al. 2002, *Concepts and Applications of Finite Element
//! Analysis*, §13.2). Eliminated are equations of few terms without a right-hand side, one after another by Gauss and Jordan's method;
//! where one follows from the others there is nothing to do. What is left, because it couples many nodes or prescribes a value, has a
//! multiplier ([`crate::Equations`]).

use std::collections::{BTreeMap, BTreeSet};

use pneuflex_model::{Curve, LinearEquation};

use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// A slave follows at the most so many degrees of freedom: every block at it gets their nodes, all coupled with each other.
const MOST_MASTERS: usize = 64;

/// What is rounding, relative to the largest coefficient of an equation.
const ROUNDING: f64 = 1e-12;

/// A coefficient that a slave may have, relative to the largest of its equation.
const ACCEPTED_PIVOT: f64 = 0.1;

/// Slaves and what they follow. Degrees of freedom are 3 · node + axis.
#[derive(Clone, Debug, Default)]
pub struct Elimination {
    /// Masters of every slave with their coefficients: u_s = Σ t u_m. No master is a slave.
    slaves: BTreeMap<usize, Vec<(usize, f64)>>,
    /// For every node whether it has a slave.
    has_slave: Vec<bool>,
}

impl Elimination {
    /// Eliminates what can be of some equations on a mesh of `num_nodes` nodes; `held` says for every degree of freedom whether its
    /// displacement is prescribed, and it is no slave then. The equations that are left come back.
    pub fn of(equations: &[LinearEquation], num_nodes: usize, held: &[bool]) -> (Self, Vec<LinearEquation>) {
        let mut reduction = Reduction::default();
        let is_left = |equation: &&LinearEquation| equation.value != Curve::ZERO || !reduction.take(equation, held);
        let left = equations.iter().filter(is_left).cloned().collect();
        let mut has_slave = vec![false; num_nodes];
        let mut slaves = BTreeMap::new();
        for (slave, masters) in reduction.rows {
            has_slave[slave / 3] = true;
            slaves.insert(slave, masters.into_iter().collect());
        }
        (Self { slaves, has_slave }, left)
    }

    /// Whether there is no slave.
    pub fn is_empty(&self) -> bool {
        self.slaves.is_empty()
    }

    /// The slaves.
    pub fn slaves(&self) -> impl Iterator<Item = usize> {
        self.slaves.keys().copied()
    }

    /// T: the slaves of a nodal field follow their masters.
    pub fn expand(&self, displacement: &mut [[f64; 3]]) {
        let field = displacement.as_flattened_mut();
        for (&slave, masters) in &self.slaves {
            field[slave] = masters.iter().map(|&(master, t)| t * field[master]).sum();
        }
    }

    /// Tᵀ: the masters take the forces on their slaves, 3 · node + axis.
    pub fn condense(&self, forces: &mut [f64]) {
        for (&slave, masters) in &self.slaves {
            let force = std::mem::take(&mut forces[slave]);
            masters.iter().for_each(|&(master, t)| forces[master] += t * force);
        }
    }

    /// These nodes and those that they follow; `None` if none of them follows another.
    pub fn with_masters(&self, nodes: &[u32]) -> Option<Vec<u32>> {
        if self.is_empty() || !nodes.iter().any(|&node| self.has_slave[node as usize]) {
            return None;
        }
        let mut all = nodes.to_vec();
        let mut known: BTreeSet<u32> = nodes.iter().copied().collect();
        for dof in nodes.iter().flat_map(|&node| (0..3).map(move |k| 3 * node as usize + k)) {
            for &(master, _) in self.slaves.get(&dof).into_iter().flatten() {
                let node = (master / 3) as u32;
                if known.insert(node) {
                    all.push(node);
                }
            }
        }
        Some(all)
    }
}

/// Equations in reduced row echelon form.
#[derive(Default)]
struct Reduction {
    /// Masters of every slave.
    rows: BTreeMap<usize, BTreeMap<usize, f64>>,
    /// Slaves of every master.
    followers: BTreeMap<usize, BTreeSet<usize>>,
}

impl Reduction {
    /// Takes one more equation, unless it is too long, or lengthens another too much, or has no degree of freedom that is free.
    fn take(&mut self, equation: &LinearEquation, held: &[bool]) -> bool {
        let mut row: BTreeMap<usize, f64> = BTreeMap::new();
        for &(node, axis, c) in &equation.terms {
            let dof = 3 * node as usize + usize::from(axis);
            match self.rows.get(&dof) {
                Some(masters) => masters.iter().for_each(|(&master, t)| *row.entry(master).or_default() += c * t),
                None => *row.entry(dof).or_default() += c,
            }
        }
        let largest_given = equation.terms.iter().fold(0.0_f64, |largest, term| largest.max(term.2.abs()));
        row.retain(|_, c| c.abs() > ROUNDING * largest_given);
        if row.is_empty() {
            return true;
        }
        let largest = row.values().fold(0.0_f64, |largest, c| largest.max(c.abs()));
        let may_follow = |(dof, c): &(&usize, &f64)| !held[**dof] && c.abs() >= ACCEPTED_PIVOT * largest;
        let followers = |dof: &usize| self.followers.get(dof).map_or(0, BTreeSet::len);
        // As few other rows as can be change; a node that follows others through a shape function has the largest coefficient.
        let before = |a: &(&usize, &f64), b: &(&usize, &f64)| {
            followers(a.0).cmp(&followers(b.0)).then(b.1.abs().total_cmp(&a.1.abs()))
        };
        let pivot = row.iter().filter(may_follow).min_by(before);
        let Some((slave, pivot)) = pivot.map(|(dof, c)| (*dof, *c)) else { return false };
        row.remove(&slave);
        row.values_mut().for_each(|c| *c /= -pivot);
        let changed = self.followers.get(&slave).into_iter().flatten();
        let longest = changed.map(|other| self.rows[other].len() - 1 + row.len()).fold(row.len(), usize::max);
        if longest > MOST_MASTERS {
            return false;
        }
        for other in self.followers.remove(&slave).into_iter().flatten() {
            let Some(masters) = self.rows.get_mut(&other) else { continue };
            let Some(factor) = masters.remove(&slave) else { continue };
            for (&master, t) in &row {
                *masters.entry(master).or_default() += factor * t;
                self.followers.entry(master).or_default().insert(other);
            }
        }
        for &master in row.keys() {
            self.followers.entry(master).or_default().insert(slave);
        }
        self.rows.insert(slave, row);
        true
    }
}

/// Blocks of a contribution after the elimination: those with slaves have their masters' nodes as well, and nothing at the slaves.
pub struct CondensedBlocks<'a> {
    blocks: &'a dyn LocalContribution,
    elimination: &'a Elimination,
    /// Nodes of the blocks that change.
    nodes: BTreeMap<usize, Vec<u32>>,
}

impl<'a> CondensedBlocks<'a> {
    /// The blocks as they are now: those of contact may have other nodes at another position.
    pub fn new(blocks: &'a dyn LocalContribution, elimination: &'a Elimination) -> Self {
        let of = |block: usize| elimination.with_masters(blocks.nodes(block)).map(|nodes| (block, nodes));
        let count = if elimination.is_empty() { 0 } else { blocks.num_blocks() };
        Self { blocks, elimination, nodes: (0..count).filter_map(of).collect() }
    }

    /// Where the force on one degree of freedom of a block goes: places in the block's list of nodes, axes, and shares.
    fn targets(&self, place: usize, axis: usize, nodes: &[u32]) -> Vec<(usize, usize, f64)> {
        match self.elimination.slaves.get(&(3 * nodes[place] as usize + axis)) {
            None => vec![(place, axis, 1.0)],
            Some(masters) => {
                let target = |&(master, t): &(usize, f64)| {
                    let place = nodes.iter().position(|&node| node as usize == master / 3)?;
                    Some((place, master % 3, t))
                };
                masters.iter().filter_map(target).collect()
            }
        }
    }
}

impl LocalContribution for CondensedBlocks<'_> {
    fn num_blocks(&self) -> usize {
        self.blocks.num_blocks()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        self.nodes.get(&block).map_or_else(|| self.blocks.nodes(block), Vec::as_slice)
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let Some(nodes) = self.nodes.get(&block) else {
            return self.blocks.evaluate(block, displacement, request, out);
        };
        let own = self.blocks.nodes(block).len();
        let mut inner = LocalBlock::default();
        inner.reset(own, request);
        self.blocks.evaluate(block, displacement, request, &mut inner)?;
        out.energy += inner.energy;
        let targets: Vec<_> = (0..own)
            .flat_map(|place| (0..3).map(move |k| (place, k)))
            .map(|(p, k)| self.targets(p, k, nodes))
            .collect();
        for (force, targets) in inner.residual.as_flattened().iter().zip(&targets) {
            for &(place, axis, t) in targets {
                out.residual[place][axis] += t * force;
            }
        }
        let mut add = |rows: &[(usize, usize, f64)], columns: &[(usize, usize, f64)], value: f64| {
            for &(a, i, t) in rows {
                for &(b, j, s) in columns.iter().filter(|column| column.0 <= a) {
                    out.tangent[a * (a + 1) / 2 + b][3 * j + i] += t * s * value;
                }
            }
        };
        let mut pairs = inner.tangent.iter();
        for a in 0..own {
            for (b, values) in (0..=a).zip(&mut pairs) {
                for (k, &value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                    let (row, column) = (&targets[3 * a + k % 3], &targets[3 * b + k / 3]);
                    add(row, column, value);
                    if a != b {
                        add(column, row, value);
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Assembler, Totals};

    fn equation(terms: &[(u32, u8, f64)]) -> LinearEquation {
        LinearEquation { terms: terms.to_vec(), value: Curve::ZERO }
    }

    /// Six nodes: a chain of equations, one of them said twice, one with a repeated term, one of held nodes, one with a value.
    fn some() -> (Elimination, Vec<LinearEquation>, Vec<LinearEquation>) {
        let equations = vec![
            equation(&[(0, 0, 1.0), (1, 0, -1.0), (2, 0, -1.0), (3, 0, 1.0)]),
            equation(&[(2, 0, 1.0), (3, 0, -1.0), (4, 0, -2.0), (5, 0, 2.0)]),
            equation(&[(0, 0, 2.0), (1, 0, -2.0), (4, 0, -4.0), (5, 0, 4.0)]),
            equation(&[(1, 1, 0.5), (1, 1, 0.5), (2, 2, 3.0), (5, 1, 0.1)]),
            equation(&[(4, 2, 1.0), (5, 2, -1.0)]),
            LinearEquation { terms: vec![(3, 1, 1.0)], value: Curve::Proportional(1.0) },
        ];
        let mut held = vec![false; 18];
        held[14] = true;
        held[17] = true;
        let (elimination, left) = Elimination::of(&equations, 6, &held);
        (elimination, left, equations)
    }

    #[test]
    fn slaves_satisfy_their_equations() {
        let (elimination, left, equations) = some();
        assert_eq!(left, equations[4..]);
        assert_eq!(elimination.slaves().count(), 3);
        assert!(elimination.slaves.values().flatten().all(|(master, _)| !elimination.slaves.contains_key(master)));
        let mut u: Vec<[f64; 3]> = (0..6).map(|n| std::array::from_fn(|k| (1.3 * n as f64 + k as f64).sin())).collect();
        elimination.expand(&mut u);
        for LinearEquation { terms, .. } in &equations[..4] {
            let sum: f64 = terms.iter().map(|&(node, axis, c)| c * u[node as usize][axis as usize]).sum();
            assert!(sum.abs() < 1e-14, "{terms:?}: {sum}");
        }
    }

    /// A long equation is left, and so is one that would make another long: its one free displacement is a master in the first.
    #[test]
    fn long_equations_are_left() {
        let sum = |nodes: std::ops::Range<u32>| nodes.map(|node| (node, 0, 1.0)).collect::<Vec<_>>();
        let equations =
            [equation(&sum(0..60)), equation(&sum(58..90)), equation(&sum(90..190)), equation(&sum(88..90))];
        let mut held = [false; 600];
        (0..200).filter(|node| ![0, 58].contains(node) && *node < 90).for_each(|node| held[3 * node] = true);
        let (elimination, left) = Elimination::of(&equations, 200, &held);
        // The last one has held displacements only.
        assert_eq!((elimination.slaves().collect::<Vec<_>>(), left), (vec![0], equations[1..].to_vec()));
    }

    /// Every pair of nodes, coupled by an energy that is quadratic in all of their displacements.
    struct Pairs(Vec<[u32; 2]>);

    fn coefficient(p: usize, q: usize) -> f64 {
        ((p * q) as f64).cos() + ((p + q) as f64).sin()
    }

    impl LocalContribution for Pairs {
        fn num_blocks(&self) -> usize {
            self.0.len()
        }

        fn nodes(&self, block: usize) -> &[u32] {
            &self.0[block]
        }

        fn evaluate(&self, block: usize, u: &[[f64; 3]], _: Request, out: &mut LocalBlock) -> Result<(), LocalError> {
            let dofs: Vec<usize> =
                self.0[block].iter().flat_map(|&node| (0..3).map(move |k| 3 * node as usize + k)).collect();
            for (p, &row) in dofs.iter().enumerate() {
                for (q, &column) in dofs.iter().enumerate() {
                    let (a, b) = (p / 3, q / 3);
                    let value = coefficient(row, column);
                    out.residual[a][p % 3] += value * u.as_flattened()[column];
                    if a >= b {
                        out.tangent[a * (a + 1) / 2 + b][3 * (q % 3) + p % 3] += value;
                    }
                }
            }
            Ok(())
        }
    }

    /// Condensed blocks assemble to TᵀKT and Tᵀr, for slaves that share blocks with their masters and for those that do not.
    #[test]
    fn condensed_blocks_are_a_congruence() {
        let (elimination, ..) = some();
        let pairs = Pairs((0..6).flat_map(|a| (0..a).map(move |b| [a, b])).chain([[2, 0], [1, 5]]).collect());
        let assemble = |blocks: &dyn LocalContribution, u: &[[f64; 3]]| {
            let mut assembler = Assembler::new(6, &[blocks], &[]);
            let mut totals = Totals::default();
            assembler.reset(&mut totals, Request::Tangent);
            assembler.add(0, blocks, u, Request::Tangent, &mut totals).unwrap();
            (assembler, totals)
        };
        let product = |(assembler, totals): &(Assembler, Totals), u: &[[f64; 3]]| {
            let mut product = vec![0.0; 18];
            pneuflex_factor::multiply::<3>(assembler.pattern(), &totals.tangent, u.as_flattened(), &mut product)
                .unwrap();
            product
        };
        let mut u: Vec<[f64; 3]> = (0..6).map(|n| std::array::from_fn(|k| (0.7 * n as f64 - k as f64).cos())).collect();
        elimination.expand(&mut u);
        let (plain, condensed) = (assemble(&pairs, &u), assemble(&CondensedBlocks::new(&pairs, &elimination), &u));
        // K̂ û, of what is left at the masters alone.
        let mut masters = u.clone();
        elimination.slaves().for_each(|slave| masters.as_flattened_mut()[slave] = 0.0);
        let found = product(&condensed, &masters);
        let mut expected = product(&plain, &u);
        elimination.condense(&mut expected);
        let mut residual = plain.1.residual.clone();
        elimination.condense(residual.as_flattened_mut());
        let largest = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(largest > 1.0, "the check would be empty");
        for dof in 0..18 {
            assert!((found[dof] - expected[dof]).abs() < 1e-12 * largest, "{dof}: {} {}", found[dof], expected[dof]);
            let [a, b] = [condensed.1.residual.as_flattened()[dof], residual.as_flattened()[dof]];
            assert!((a - b).abs() < 1e-12 * largest, "{dof}: {a} {b}");
        }
    }
}
