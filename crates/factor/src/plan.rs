//! Which fronts are computed by one thread, one after another, and which by all threads together.

use std::ops::Range;

use crate::elimination::NONE;
use crate::symbolic::Symbolic;

/// Subtrees handed out per thread: more balance the load, fewer keep more fronts out of the shared top of the tree.
const SUBTREES_PER_THREAD: f64 = 6.0;

/// The fronts of a factorisation as a tree of tasks, children before parents.
pub(crate) struct Plan {
    pub(crate) tasks: Vec<Task>,
    /// For how many threads the plan was made.
    pub(crate) threads: usize,
}

/// Consecutive fronts: a whole subtree, or one front of the top of the tree.
pub(crate) struct Task {
    pub(crate) fronts: Range<usize>,
    /// One front worked on by all threads, rather than a subtree by one.
    pub(crate) shared: bool,
    /// Task that consumes the update matrix of the last front.
    pub(crate) parent: Option<usize>,
    pub(crate) num_children: usize,
    /// Room for that update matrix.
    pub(crate) slot: usize,
    /// Room for the two stacks of a subtree.
    pub(crate) stacks: [usize; 2],
    /// What the fronts' stack offsets are relative to.
    pub(crate) stack_base: [usize; 2],
    /// Operations.
    pub(crate) flops: f64,
}

impl Plan {
    /// Everything in one sequence.
    pub(crate) fn serial<const B: usize>(symbolic: &Symbolic<B>) -> Self {
        let task = Task {
            fronts: 0..symbolic.fronts.len(),
            shared: false,
            parent: None,
            num_children: 0,
            slot: 0,
            stacks: symbolic.stack_sizes(),
            stack_base: [0; 2],
            flops: symbolic.flops(),
        };
        Self { tasks: vec![task], threads: 1 }
    }

    /// Subtrees of comparable work for each thread, below a top that all share.
    pub(crate) fn parallel<const B: usize>(symbolic: &Symbolic<B>, threads: usize) -> Self {
        let mut subtree_flops: Vec<f64> = symbolic.fronts.iter().map(|f| f.flops).collect();
        for front in 0..subtree_flops.len() {
            let parent = symbolic.fronts[front].parent;
            if parent != NONE {
                subtree_flops[parent as usize] += subtree_flops[front];
            }
        }
        let total = symbolic.flops();
        let mut share = SUBTREES_PER_THREAD * threads as f64;
        // Each shared front keeps its update matrix in a place of its own: on a long thin tree that would add up to
        // more than it is worth.
        while share > 1.0 {
            let plan = Self::split(symbolic, &subtree_flops, total / share, threads);
            let slots: usize = plan.tasks.iter().map(|task| task.slot).sum();
            if slots <= symbolic.panel_len() / 2 {
                return plan;
            }
            share /= 2.0;
        }
        Self { threads, ..Self::serial(symbolic) }
    }

    fn split<const B: usize>(symbolic: &Symbolic<B>, subtree_flops: &[f64], threshold: f64, threads: usize) -> Self {
        let num_fronts = symbolic.fronts.len();
        let shared = |front: usize| subtree_flops[front] > threshold;
        let mut tasks: Vec<Task> = Vec::new();
        let mut task_of_last_front = vec![usize::MAX; num_fronts];
        for front in 0..num_fronts {
            let shape = &symbolic.fronts[front];
            let has_parent = shape.parent != NONE;
            let subtree_root = !shared(front) && (!has_parent || shared(shape.parent as usize));
            if !shared(front) && !subtree_root {
                continue;
            }
            let slot = if has_parent { shape.update_len::<B>() } else { 0 };
            let mut stacks = [0; 2];
            let first = if shared(front) {
                front
            } else {
                // The root's own update matrix goes to the slot: only what its children need is counted.
                let (own, other) = (shape.stack, 1 - shape.stack);
                stacks[other] = shape.stack_needed[other];
                stacks[own] = symbolic
                    .children(front)
                    .iter()
                    .map(|&child| symbolic.fronts[child as usize].stack_needed[own])
                    .max()
                    .unwrap_or(0);
                shape.first_descendant as usize
            };
            task_of_last_front[front] = tasks.len();
            tasks.push(Task {
                fronts: first..front + 1,
                shared: shared(front),
                parent: None,
                num_children: 0,
                slot,
                stacks,
                stack_base: shape.stack_offset,
                flops: if shared(front) { shape.flops } else { subtree_flops[front] },
            });
        }
        for task in 0..tasks.len() {
            let last = tasks[task].fronts.end - 1;
            let parent = symbolic.fronts[last].parent;
            if parent != NONE {
                let parent = task_of_last_front[parent as usize];
                tasks[task].parent = Some(parent);
                tasks[parent].num_children += 1;
            }
        }
        Self { tasks, threads }
    }

    /// Entries of all slots.
    pub(crate) fn slots_len(&self) -> usize {
        self.tasks.iter().map(|task| task.slot).sum()
    }

    /// Entries of the stacks one thread needs.
    pub(crate) fn stacks_len(&self) -> usize {
        let sizes = self.tasks.iter().map(|task| task.stacks.iter().sum());
        sizes.max().unwrap_or(0)
    }
}
