//! The global assembler with contributions that know no mechanics, against their sums written down naively.

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use nalgebra::DMatrix;
use pneuflex_assembly::{Assembler, LocalBlock, LocalContribution, LocalError, Request, Totals};

use crate::mock::{BATCH, Dense, Mock, NOISE, REQUESTS, assemble, assembler_of, displacement};

/// Requires sums that are not all zero, and exactly those of the naive way.
#[track_caller]
fn check_sums(mocks: &[&Mock], num_nodes: usize) {
    let u = displacement(num_nodes);
    let expected = Dense::sum(mocks, &u);
    assert!(expected.tangent.amax() > 5.0, "the check would be empty");
    assert_eq!(assemble(&mut assembler_of(mocks, num_nodes), mocks, &u), expected);
}

fn in_pool<R: Send>(threads: usize, run: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// Aim: overlapping blocks of different sizes add up, a block of one node is a diagonal, one of none is nothing but energy.
#[test]
fn blocks_of_all_sizes_add_up() {
    let blocks: [&[u32]; 7] = [&[0, 1, 2], &[3], &[], &[1, 2, 4, 5], &[1, 2], &[3], &[0, 2, 3, 4, 5, 7]];
    check_sums(&[&Mock::of_integers(1, &blocks)], 8);
    check_sums(&[&Mock::of_integers(2, &[&[1]])], 2);
}

/// Aim: a block whose nodes do not ascend goes into the lower triangle transposed, pair by pair.
#[test]
fn nodes_in_any_order_give_the_same_matrix() {
    for nodes in [[4, 2, 1], [1, 4, 2], [2, 1, 4], [4, 1, 2]] {
        let mock = Mock::of_integers(3, &[&nodes, &[1, 2, 4]]);
        let block = DMatrix::from_fn(3, 3, |i, j| mock.tangent(0, 3 + i, j));
        assert_ne!(block, block.transpose(), "transposing would show nothing");
        check_sums(&[&mock], 5);
    }
}

/// Aim: where a node stands twice in a block, all that belongs to it is added, the coupling of its two places both ways.
#[test]
fn repeated_nodes_collect_all_their_values() {
    check_sums(&[&Mock::of_integers(4, &[&[1, 1]])], 3);
    check_sums(&[&Mock::of_integers(5, &[&[2, 0, 2, 1, 0], &[1, 1, 1], &[0, 1, 2]])], 3);
}

/// Aim: several contributions find their own blocks, also beside one that has none; without any there is nothing.
#[test]
fn contributions_without_blocks_add_nothing() {
    let first = Mock::of_integers(6, &[&[0, 2], &[5, 1]]);
    let none = Mock::of_integers(7, &[]);
    let last = Mock::of_integers(8, &[&[2, 3, 0], &[4]]);
    check_sums(&[&first, &none, &last], 6);
    let u = displacement(6);
    let mut assembler = assembler_of(&[&none], 6);
    assert_eq!((assembler.pattern().num_nodes(), assembler.pattern().num_blocks()), (6, 6));
    assert!(assembler.covers(&none));
    assert_eq!(assemble(&mut assembler, &[&none], &u), Dense::zero(6));
}

/// Aim: sums over several batches are those in block order, bit for bit, on any number of threads.
#[test]
fn threads_do_not_change_a_bit() {
    let num_nodes = 31;
    let u = displacement(num_nodes);
    for count in [1, BATCH - 1, BATCH, BATCH + 1, 2 * BATCH, 3 * BATCH + 17] {
        let mock = Mock::of_many(9, count, 4, num_nodes as u32, 0.1);
        let expected = Dense::sum(&[&mock], &u);
        if count > BATCH {
            let mut backwards = Dense::zero(num_nodes);
            (0..count).rev().for_each(|block| backwards.add(&mock, block, &u));
            assert!((&backwards.tangent - &expected.tangent).amax() < 1e-9);
            assert_ne!(backwards.bits(), expected.bits(), "another order would show nothing");
        }
        for threads in [1, 2, 3, 5] {
            let found = in_pool(threads, || assemble(&mut assembler_of(&[&mock], num_nodes), &[&mock], &u));
            assert_eq!(found.bits(), expected.bits(), "{count} blocks, {threads} threads");
        }
    }
}

/// Aim: additional groups enlarge the pattern by their pairs and nothing else, and what changes finds its place there.
#[test]
fn extra_groups_make_room_for_what_comes_later() {
    let num_nodes = 7;
    let u = displacement(num_nodes);
    let always = Mock::of_integers(10, &[&[0, 1], &[2, 1]]);
    let later = Mock::of_integers(11, &[&[6, 0, 3], &[3, 6], &[1, 2]]);
    let mut plain = assembler_of(&[&always], num_nodes);
    let mut wide = Assembler::new(num_nodes, &[&always], &[vec![3, 0, 6], vec![4]]);
    let pairs = |assembler: &Assembler| {
        let column = |j: usize| assembler.pattern().column(j).iter().map(move |&i| (i, j)).collect::<Vec<_>>();
        (0..num_nodes).flat_map(column).filter(|&(i, j)| i as usize != j).collect::<BTreeSet<_>>()
    };
    assert_eq!(pairs(&plain), BTreeSet::from([(1, 0), (2, 1)]));
    assert_eq!(pairs(&wide), BTreeSet::from([(1, 0), (2, 1), (3, 0), (6, 0), (6, 3)]));
    let expected = Dense::sum(&[&always], &u);
    for assembler in [&mut plain, &mut wide] {
        assert_eq!(assemble(assembler, &[&always], &u), expected);
    }

    assert!(wide.covers(&later) && !plain.covers(&later));
    let mut totals = Totals::default();
    wide.reset(&mut totals, Request::Tangent);
    wide.add(0, &always, &u, Request::Tangent, &mut totals).unwrap();
    wide.add_changing(&later, &u, Request::Tangent, &mut totals).unwrap();
    assert_eq!(Dense::of(wide.pattern(), &totals), Dense::sum(&[&always, &later], &u));
    // Without the tangent the pattern does not matter.
    plain.reset(&mut totals, Request::Residual);
    plain.add_changing(&later, &u, Request::Residual, &mut totals).unwrap();
    let expected = Dense::sum(&[&later], &u);
    assert_eq!((totals.energy, totals.residual), (expected.energy, expected.residual));
}

/// Aim: one missing pair, in whatever order, is noticed, and so is a node that is not there; single nodes always fit.
#[test]
fn a_missing_pair_is_not_covered() {
    let assembler = assembler_of(&[&Mock::of_integers(12, &[&[0, 1, 2], &[4, 2]])], 5);
    let covers = |blocks: &[&[u32]]| assembler.covers(&Mock::of_integers(13, blocks));
    assert!(covers(&[&[2, 0], &[2, 4], &[3], &[1, 1], &[]]));
    for missing in [&[1, 4][..], &[4, 1], &[3, 0], &[0, 1, 2, 4], &[5], &[0, 5]] {
        assert!(!covers(&[&[0, 1], missing, &[3]]), "{missing:?}");
    }
}

/// Blocks of one node, some of which cannot be evaluated.
struct Failing {
    count: usize,
    fails: Vec<usize>,
    /// Whether the first of them waits until another one has failed.
    first_waits: bool,
    /// Which have failed, in the order of time.
    failed: Mutex<Vec<usize>>,
}

impl LocalContribution for Failing {
    fn num_blocks(&self) -> usize {
        self.count
    }

    fn nodes(&self, _block: usize) -> &[u32] {
        &[0]
    }

    fn evaluate(
        &self,
        block: usize,
        _displacement: &[[f64; 3]],
        _request: Request,
        _out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        if !self.fails.contains(&block) {
            return Ok(());
        }
        if self.first_waits && block == self.fails[0] {
            // At most ten seconds: the test then says what is wrong.
            for _ in 0..10_000 {
                if !self.failed.lock().unwrap().is_empty() {
                    break;
                }
                thread::sleep(Duration::from_millis(1));
            }
        }
        self.failed.lock().unwrap().push(block);
        Err(LocalError { block, point: block % 7, jacobian: -(block as f64) })
    }
}

/// Aim: the error is that of the first block in block order, also if another thread has met a later one before it.
#[test]
fn the_first_failing_block_is_the_error() {
    for threads in [1, 2, 4] {
        for fails in [vec![0, 200], vec![40, 250, 300], vec![BATCH + 3, BATCH + 201, 3 * BATCH], vec![2 * BATCH]] {
            let first_waits = threads > 1 && fails.len() > 1;
            let failing = Failing { count: 3 * BATCH + 5, fails: fails.clone(), first_waits, failed: Mutex::default() };
            let mut totals = Totals::default();
            let mut assembler = Assembler::new(1, &[&failing], &[]);
            assembler.reset(&mut totals, Request::Tangent);
            let result = in_pool(threads, || assembler.add(0, &failing, &[[0.0; 3]], Request::Tangent, &mut totals));
            let jacobian = -(fails[0] as f64);
            assert_eq!(result, Err(LocalError { block: fails[0], point: fails[0] % 7, jacobian }));
            let failed = failing.failed.into_inner().unwrap();
            assert!(!first_waits || failed[0] == fails[1], "no thread was ahead: {failed:?}");
        }
    }
}

/// Aim: `reset` clears what a request sums, whatever stood there and in whatever size.
#[test]
fn reset_clears_dirty_totals() {
    let assembler = assembler_of(&[&Mock::of_integers(14, &[&[0, 3], &[1, 2]])], 4);
    let num_values = 9 * assembler.pattern().num_blocks();
    for (residual, tangent) in [(0, 0), (2, 5), (4, num_values), (40, num_values + 7)] {
        for request in REQUESTS {
            let mut totals =
                Totals { energy: NOISE, residual: vec![[NOISE; 3]; residual], tangent: vec![NOISE; tangent] };
            assembler.reset(&mut totals, request);
            assert_eq!((totals.energy, &totals.residual), (0.0, &vec![[0.0; 3]; 4]), "{request:?}");
            if request == Request::Tangent {
                assert_eq!(totals.tangent, vec![0.0; num_values]);
            }
        }
    }
}

/// Aim: both ways to add leave what is there and touch nothing that is not asked for.
#[test]
fn adding_adds_what_is_asked_for_to_what_is_there() {
    let num_nodes = 5;
    let u = displacement(num_nodes);
    let mock = Mock::of_integers(15, &[&[0, 3], &[4, 2, 0], &[3]]);
    let mut assembler = assembler_of(&[&mock], num_nodes);
    let num_values = 9 * assembler.pattern().num_blocks();
    let mut sums = Totals::default();
    assembler.reset(&mut sums, Request::Tangent);
    assembler.add(0, &mock, &u, Request::Tangent, &mut sums).unwrap();
    assert_eq!(Dense::of(assembler.pattern(), &sums), Dense::sum(&[&mock], &u));
    for (request, is_changing) in REQUESTS.into_iter().flat_map(|request| [(request, false), (request, true)]) {
        let mut totals =
            Totals { energy: NOISE, residual: vec![[NOISE; 3]; num_nodes], tangent: vec![NOISE; num_values] };
        let mut expected = totals.clone();
        expected.energy += sums.energy;
        if request >= Request::Residual {
            let sums = sums.residual.as_flattened();
            expected.residual.as_flattened_mut().iter_mut().zip(sums).for_each(|(value, sum)| *value += sum);
        }
        if request == Request::Tangent {
            expected.tangent.iter_mut().zip(&sums.tangent).for_each(|(value, sum)| *value += sum);
        }
        let result = match is_changing {
            false => assembler.add(0, &mock, &u, request, &mut totals),
            true => assembler.add_changing(&mock, &u, request, &mut totals),
        };
        assert_eq!((result, totals), (Ok(()), expected), "{request:?}, changing: {is_changing}");
    }
}
