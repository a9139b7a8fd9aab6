//! Numeric factorisation.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering as Atomic};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::dense::Workers;
use crate::error::{FactorError, check_length};
use crate::front::{BadPivot, Input, compute_front};
use crate::outcome::{Inertia, Method, Parallelism};
use crate::plan::{Plan, Task};
use crate::symbolic::Symbolic;

/// Numeric factorisation on a [`Symbolic`] structure.
///
/// Owns the factor and all scratch, allocated by the first factorisation and reused by the next ones. The numbers are
/// the same to the last bit whatever the number of threads.
pub struct Factor<const B: usize> {
    pub(crate) symbolic: Arc<Symbolic<B>>,
    pub(crate) panels: Vec<f64>,
    slots: Vec<f64>,
    stacks: Vec<Vec<f64>>,
    pub(crate) plan: Plan,
    pub(crate) method: Option<Method>,
    pub(crate) parallelism: Parallelism,
}

impl<const B: usize> Factor<B> {
    /// Prepares a factorisation; memory is taken when it is first computed.
    pub fn new(symbolic: Arc<Symbolic<B>>) -> Self {
        Self {
            plan: Plan::serial(&symbolic),
            symbolic,
            panels: Vec::new(),
            slots: Vec::new(),
            stacks: Vec::new(),
            method: None,
            parallelism: Parallelism::Serial,
        }
    }

    /// Moves to another structure (the pattern has changed), keeping the memory: touching fresh memory costs a quarter
    /// of a factorisation. There is nothing to solve with until the next factorisation.
    pub fn set_symbolic(&mut self, symbolic: Arc<Symbolic<B>>) {
        self.plan = Plan::serial(&symbolic);
        self.symbolic = symbolic;
        self.method = None;
    }

    /// `L Lᵀ`, or `L D Lᵀ` when a pivot is not positive.
    ///
    /// `values` holds `B·B` numbers per block of the pattern (layout: [`BlockPattern`](crate::BlockPattern)); the row
    /// and the column of every degree of freedom with `held[dof]` are replaced by those of the identity.
    ///
    /// # Errors
    /// [`FactorError::Length`] on arguments that do not fit, [`FactorError::Pivot`] on a singular matrix; there is no
    /// factorisation to solve with after an error.
    pub fn factorize(
        &mut self,
        values: &[f64],
        held: &[bool],
        parallelism: Parallelism,
    ) -> Result<Inertia, FactorError> {
        self.method = None;
        check_length("values", self.symbolic.num_blocks * B * B, values.len())?;
        check_length("held", self.symbolic.num_unknowns(), held.len())?;
        self.reserve(parallelism)?;
        let mut compute =
            |method| self.compute(Input { values, held, method }).map(|negative| Inertia { negative, method });
        let outcome = compute(Method::Cholesky).or_else(|_| compute(Method::Ldl));
        let inertia = outcome.map_err(|bad| self.singular(bad))?;
        self.method = Some(inertia.method);
        Ok(inertia)
    }

    fn singular(&self, bad: BadPivot) -> FactorError {
        FactorError::Pivot {
            node: self.symbolic.node_at(bad.front, bad.column / B),
            component: bad.column % B,
            pivot: bad.pivot,
        }
    }

    /// Makes plan and buffers fit the number of threads.
    fn reserve(&mut self, parallelism: Parallelism) -> Result<(), FactorError> {
        self.parallelism = parallelism;
        let threads = match parallelism {
            Parallelism::Serial => 1,
            Parallelism::Threads => rayon::current_num_threads(),
        };
        if self.plan.threads != threads {
            self.plan = match threads {
                1 => Plan::serial(&self.symbolic),
                _ => Plan::parallel(&self.symbolic, threads),
            };
        }
        grow(&mut self.panels, self.symbolic.panel_len())?;
        grow(&mut self.slots, self.plan.slots_len())?;
        let stacks_len = self.plan.stacks_len();
        let concurrent = threads.min(self.plan.tasks.len());
        self.stacks.resize_with(concurrent.max(self.stacks.len()), Vec::new);
        for stack in &mut self.stacks[..concurrent] {
            grow(stack, stacks_len)?;
        }
        Ok(())
    }

    /// Runs all tasks of the plan. Returns the number of negative pivots.
    fn compute(&mut self, input: Input<'_>) -> Result<usize, BadPivot> {
        let run = Run {
            symbolic: &self.symbolic,
            plan: &self.plan,
            input,
            spaces: hand_out(&self.plan, &self.symbolic, &mut self.panels, &mut self.slots),
            stacks: Mutex::new(self.stacks.iter_mut().map(Vec::as_mut_slice).collect()),
            pending: (self.plan.tasks.iter()).map(|task| AtomicUsize::new(task.num_children)).collect(),
            negative: AtomicUsize::new(0),
            give_up: AtomicBool::new(false),
            bad_pivot: Mutex::new(None),
        };
        if let [task] = &self.plan.tasks[..] {
            run.finish_task(0, task);
        } else {
            let mut leaves: Vec<usize> =
                (0..self.plan.tasks.len()).filter(|&task| self.plan.tasks[task].num_children == 0).collect();
            // Large ones first: the small ones fill the gaps at the end.
            leaves.sort_by(|&a, &b| {
                let flops = |task: usize| self.plan.tasks[task].flops;
                flops(b).total_cmp(&flops(a))
            });
            rayon::scope_fifo(|scope| {
                for &leaf in &leaves {
                    let run = &run;
                    scope.spawn_fifo(move |_| run.climb(leaf));
                }
            });
        }
        match *lock(&run.bad_pivot) {
            Some(bad) => Err(bad),
            None => Ok(run.negative.load(Atomic::Relaxed)),
        }
    }
}

/// Lengthens a buffer without copying what it held, some more than asked if it is not the first time.
///
/// # Errors
/// [`FactorError::OutOfMemory`].
fn grow(buffer: &mut Vec<f64>, len: usize) -> Result<(), FactorError> {
    if buffer.len() < len {
        let reserve = if buffer.is_empty() { 0 } else { len / 8 };
        let len = len + reserve;
        *buffer = Vec::new();
        // Asked for first, because a vector of zeros ends the program where there is no memory; what is not touched costs nothing.
        let asked = Vec::<f64>::new().try_reserve_exact(len);
        asked.map_err(|_| FactorError::OutOfMemory { bytes: len.saturating_mul(size_of::<f64>()) })?;
        *buffer = vec![0.0; len];
    }
    Ok(())
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The storage one task writes.
struct Space<'a> {
    panels: &'a mut [f64],
    slot: &'a mut [f64],
}

/// Cuts the buffers into the tasks' own parts.
fn hand_out<'a, const B: usize>(
    plan: &Plan,
    symbolic: &Symbolic<B>,
    mut panels: &'a mut [f64],
    mut slots: &'a mut [f64],
) -> Vec<Mutex<Space<'a>>> {
    plan.tasks
        .iter()
        .map(|task| {
            let len = symbolic.fronts[task.fronts.clone()].iter().map(|front| front.panel_len::<B>()).sum();
            let own_panels;
            let own_slot;
            (own_panels, panels) = std::mem::take(&mut panels).split_at_mut(len);
            (own_slot, slots) = std::mem::take(&mut slots).split_at_mut(task.slot);
            Mutex::new(Space { panels: own_panels, slot: own_slot })
        })
        .collect()
}

/// State of one factorisation, shared by the threads.
struct Run<'a, const B: usize> {
    symbolic: &'a Symbolic<B>,
    plan: &'a Plan,
    input: Input<'a>,
    /// Storage of each task. A parent locks its children's to read their update matrices, when they are done.
    spaces: Vec<Mutex<Space<'a>>>,
    /// Stacks not in use; a thread takes one for a subtree and returns it.
    stacks: Mutex<Vec<&'a mut [f64]>>,
    /// Children each task still waits for.
    pending: Vec<AtomicUsize>,
    negative: AtomicUsize,
    give_up: AtomicBool,
    /// The first (in elimination order) bad pivot found.
    bad_pivot: Mutex<Option<BadPivot>>,
}

impl<const B: usize> Run<'_, B> {
    /// Computes a task, and its ancestors as long as this thread is the last their children waited for.
    fn climb(&self, leaf: usize) {
        let mut index = leaf;
        loop {
            let task = &self.plan.tasks[index];
            self.finish_task(index, task);
            let Some(parent) = task.parent else { return };
            if self.pending[parent].fetch_sub(1, Atomic::AcqRel) > 1 {
                return;
            }
            index = parent;
        }
    }

    fn finish_task(&self, index: usize, task: &Task) {
        if self.give_up.load(Atomic::Relaxed) {
            return;
        }
        let outcome = if task.shared { self.shared_front(index, task) } else { self.subtree(index, task) };
        match outcome {
            Ok(negative) => {
                self.negative.fetch_add(negative, Atomic::Relaxed);
            }
            Err(bad) => {
                // Any failure ends an attempt at Cholesky. LDLᵀ goes on below other subtrees, so that the pivot
                // reported does not depend on which thread was faster.
                if self.input.method == Method::Cholesky {
                    self.give_up.store(true, Atomic::Relaxed);
                }
                let mut first = lock(&self.bad_pivot);
                if first.is_none_or(|first| bad.front < first.front) {
                    *first = Some(bad);
                }
            }
        }
    }

    fn subtree(&self, index: usize, task: &Task) -> Result<usize, BadPivot> {
        let mut space = lock(&self.spaces[index]);
        let Space { panels, slot } = &mut *space;
        let mut taken = lock(&self.stacks).pop();
        let mut spare = Vec::new();
        let stack = match &mut taken {
            Some(stack) => stack,
            None => {
                spare.resize(task.stacks.iter().sum(), 0.0);
                spare.as_mut_slice()
            }
        };
        let (even, odd) = stack.split_at_mut(task.stacks[0]);
        let mut stacks = [even, odd];
        let fronts = &self.symbolic.fronts[task.fronts.clone()];
        let origin = fronts.first().map_or(0, |front| front.panel_offset);
        let place = |front: usize| {
            let shape = &self.symbolic.fronts[front];
            let start = shape.stack_offset[shape.stack] - task.stack_base[shape.stack];
            start..start + shape.update_len::<B>()
        };
        let outcome = (|| {
            let mut negative = 0;
            for front in task.fronts.clone() {
                if self.give_up.load(Atomic::Relaxed) {
                    break;
                }
                let shape = &self.symbolic.fronts[front];
                let [even, odd] = &mut stacks;
                let (own, other): (&mut [f64], &[f64]) = match shape.stack {
                    0 => (even, odd),
                    _ => (odd, even),
                };
                let update = if front + 1 == task.fronts.end && task.parent.is_some() {
                    &mut **slot
                } else {
                    &mut own[place(front)]
                };
                let panel = shape.panel_offset - origin;
                negative += compute_front(
                    self.symbolic,
                    front,
                    self.input,
                    &mut panels[panel..panel + shape.panel_len::<B>()],
                    update,
                    |child| &other[place(child)],
                    Workers::One,
                )?;
            }
            Ok(negative)
        })();
        if let Some(stack) = taken {
            lock(&self.stacks).push(stack);
        }
        outcome
    }

    fn shared_front(&self, index: usize, task: &Task) -> Result<usize, BadPivot> {
        let front = task.fronts.start;
        let mut space = lock(&self.spaces[index]);
        let Space { panels, slot } = &mut *space;
        // Children are the tasks that end with a child front; tasks are in the order of their fronts.
        let children = self.symbolic.children(front);
        let child_spaces: Vec<MutexGuard<'_, Space<'_>>> = children
            .iter()
            .map(|&child| {
                let task = (self.plan.tasks).partition_point(|task| task.fronts.end <= child as usize);
                lock(&self.spaces[task])
            })
            .collect();
        let updates: Vec<&[f64]> = child_spaces.iter().map(|space| &*space.slot).collect();
        compute_front(
            self.symbolic,
            front,
            self.input,
            panels,
            slot,
            |child| match children.binary_search(&(child as u32)) {
                Ok(position) => updates[position],
                Err(_) => &[],
            },
            Workers::Pool,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_is_not_there_is_an_error() {
        let mut buffer = vec![1.0; 4];
        assert!(grow(&mut buffer, 3).is_ok() && buffer == [1.0; 4]);
        assert!(grow(&mut buffer, 8).is_ok() && buffer == [0.0; 9]);
        let found = grow(&mut buffer, usize::MAX / 32);
        assert!(matches!(found, Err(FactorError::OutOfMemory { .. })), "{found:?}");
    }
}
