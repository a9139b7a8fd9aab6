//! Elimination tree of the node graph, in postorder, with the size of every column of the factor.

use crate::pattern::Adjacency;

/// "No node" in the arrays of this module.
pub(crate) const NONE: u32 = u32::MAX;

/// Elimination forest of the node graph, relabelled by a postorder: descendants of a node are the labels just below it.
pub(crate) struct EliminationTree {
    /// `order[k]` is the caller's node with label `k`.
    pub(crate) order: Vec<u32>,
    /// Parent of each label, larger than it, or [`NONE`].
    pub(crate) parent: Vec<u32>,
    /// Number of nodes in each column of the factor, diagonal included.
    pub(crate) counts: Vec<u32>,
}

impl EliminationTree {
    /// The tree of eliminating the nodes in the sequence `order`.
    ///
    /// A postorder of the tree is an equivalent elimination order (same fill), so labels replace `order`.
    pub(crate) fn new(graph: &Adjacency, order: &[u32]) -> Self {
        let unordered_parent = elimination_parents(graph, order);
        let postorder = postorder(&unordered_parent);
        let n = order.len();
        let mut label_of_step = vec![0; n];
        for (label, &step) in postorder.iter().enumerate() {
            label_of_step[step as usize] = label as u32;
        }
        let order: Vec<u32> = postorder.iter().map(|&step| order[step as usize]).collect();
        let mut label = vec![0; n];
        for (k, &node) in order.iter().enumerate() {
            label[node as usize] = k as u32;
        }
        let parent: Vec<u32> = postorder
            .iter()
            .map(|&step| match unordered_parent[step as usize] {
                NONE => NONE,
                parent => label_of_step[parent as usize],
            })
            .collect();
        let counts = column_counts(graph, &order, &label, &parent);
        Self { order, parent, counts }
    }
}

/// Parent of each elimination step (Liu 1986): the first later step its column reaches, found with compressed paths.
fn elimination_parents(graph: &Adjacency, order: &[u32]) -> Vec<u32> {
    let n = order.len();
    let mut step_of_node = vec![0; n];
    for (step, &node) in order.iter().enumerate() {
        step_of_node[node as usize] = step as u32;
    }
    let mut parent = vec![NONE; n];
    let mut shortcut = vec![NONE; n];
    for (step, &node) in order.iter().enumerate() {
        let step = step as u32;
        for &neighbour in graph.neighbours(node) {
            let mut at = step_of_node[neighbour as usize];
            while at < step {
                let next = shortcut[at as usize];
                shortcut[at as usize] = step;
                if next == NONE {
                    parent[at as usize] = step;
                }
                at = next;
            }
        }
    }
    parent
}

/// Nodes of a forest, children (in ascending order) before their parent; without recursion, for trees can be deep.
fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let mut first_child = vec![NONE; n];
    let mut next_sibling = vec![NONE; n];
    let mut roots = Vec::new();
    for node in (0..n as u32).rev() {
        match parent[node as usize] {
            NONE => roots.push(node),
            p => {
                next_sibling[node as usize] = first_child[p as usize];
                first_child[p as usize] = node;
            }
        }
    }
    let mut order = Vec::with_capacity(n);
    let mut path = roots;
    while let Some(&node) = path.last() {
        match first_child[node as usize] {
            NONE => {
                order.push(node);
                path.pop();
            }
            child => {
                first_child[node as usize] = next_sibling[child as usize];
                path.push(child);
            }
        }
    }
    order
}

/// Column sizes in almost linear time (Gilbert, Ng & Peyton 1994).
///
/// Row `i` of the factor is a subtree of the elimination tree. A column's size is the number of row subtrees passing
/// through it: count each row once at every leaf of its subtree, take one off at the lowest common ancestor of
/// consecutive leaves and at the parent of its root, and sum over descendants.
fn column_counts(graph: &Adjacency, order: &[u32], label: &[u32], parent: &[u32]) -> Vec<u32> {
    let n = order.len();
    let mut first_descendant: Vec<u32> = (0..n as u32).collect();
    let mut change = vec![1i64; n];
    for j in 0..n {
        if parent[j] != NONE {
            let p = parent[j] as usize;
            first_descendant[p] = first_descendant[p].min(first_descendant[j]);
            change[p] = 0;
        }
    }
    let mut latest_leaf = vec![NONE; n];
    let mut ancestor: Vec<u32> = (0..n as u32).collect();
    for j in 0..n {
        if parent[j] != NONE {
            change[parent[j] as usize] -= 1;
        }
        for &neighbour in graph.neighbours(order[j]) {
            let i = label[neighbour as usize] as usize;
            if i <= j {
                continue;
            }
            let previous = latest_leaf[i];
            if previous != NONE && first_descendant[j] <= previous {
                continue;
            }
            latest_leaf[i] = j as u32;
            change[j] += 1;
            if previous != NONE {
                change[representative(&mut ancestor, previous) as usize] -= 1;
            }
        }
        if parent[j] != NONE {
            ancestor[j] = parent[j];
        }
    }
    for j in 0..n {
        if parent[j] != NONE {
            change[parent[j] as usize] += change[j];
        }
    }
    change.into_iter().map(|count| count as u32).collect()
}

/// Root of a disjoint set, halving the path to it.
fn representative(ancestor: &mut [u32], start: u32) -> u32 {
    let mut at = start as usize;
    while ancestor[at] as usize != at {
        let above = ancestor[ancestor[at] as usize];
        ancestor[at] = above;
        at = above as usize;
    }
    at as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ordering::{Ordering, order_nodes};
    use crate::pattern::BlockPattern;
    use crate::testing::{Cell, hollow_lattice, solid_lattice};

    /// Fill by the definition: eliminate on sets.
    fn brute_force(pattern: &BlockPattern, tree: &EliminationTree) -> (Vec<u32>, Vec<u32>) {
        let n = pattern.num_nodes();
        let mut label = vec![0; n];
        for (k, &node) in tree.order.iter().enumerate() {
            label[node as usize] = k as u32;
        }
        let mut columns = vec![std::collections::BTreeSet::new(); n];
        for j in 0..n {
            for &i in pattern.column(j) {
                let (a, b) = (label[j], label[i as usize]);
                columns[a.min(b) as usize].insert(a.max(b));
            }
        }
        let mut parent = vec![NONE; n];
        for k in 0..n {
            let above: Vec<u32> = columns[k].iter().copied().skip(1).collect();
            if let Some(&p) = above.first() {
                parent[k] = p;
                columns[p as usize].extend(above);
            }
        }
        let counts = columns.iter().map(|c| c.len() as u32).collect();
        (parent, counts)
    }

    #[test]
    fn matches_elimination_on_sets() -> Result<(), crate::FactorError> {
        let patterns = [
            BlockPattern::from_cliques(7, [[0u32, 3], [5, 3]].iter().map(|c| c.as_slice())),
            solid_lattice::<1>([4, 3, 5], Cell::Hex8).pattern,
            hollow_lattice::<1>([11, 5, 5], 1, Cell::Hex8).pattern,
            solid_lattice::<1>([2, 2, 3], Cell::Hex27).pattern,
        ];
        for pattern in &patterns {
            for ordering in [Ordering::Natural, Ordering::Amd, Ordering::NestedDissection] {
                let graph = pattern.adjacency()?;
                let order = order_nodes(pattern, &graph, ordering)?;
                let tree = EliminationTree::new(&graph, &order);
                let (parent, counts) = brute_force(pattern, &tree);
                assert_eq!(tree.parent, parent);
                assert_eq!(tree.counts, counts);
            }
        }
        Ok(())
    }
}
