//! Residual, contact search, tangent, solution and rotation update, and the Newton step made of them, for each element formulation.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pneuflex::model::Formulation;
use pneuflex::newton::{State, System};
use pneuflex_benches::{full_actuator, smooth_displacement, touching_positions};
use pneuflex_contact::ContactModel;
use pneuflex_factor::Parallelism;

const CASES: [(Formulation, f64); 4] =
    [(Formulation::Hex8Sri, 1.0), (Formulation::Hex8Q1p0, 1.0), (Formulation::Hex20, 2.0), (Formulation::Hex27, 2.0)];

fn kernels(c: &mut Criterion) {
    for (formulation, size) in CASES {
        let problem = full_actuator(formulation, size);
        let u = smooth_displacement(&problem);
        let contact = ContactModel::of(&problem);
        let touching = touching_positions(&problem);
        assert!(!contact.search(&touching).blocks.is_empty(), "nothing touches");
        let mut group = c.benchmark_group(format!("{formulation} {size} mm, {} unknowns", problem.num_unknowns()));
        group.sample_size(10);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut system = pool.install(|| System::new(&problem, Parallelism::Threads)).unwrap();
            let bent = State::new(5.0, u.clone(), Vec::new());
            group.bench_function(BenchmarkId::new("residual", threads), |b| {
                pool.install(|| b.iter(|| system.residual(&bent).unwrap()));
            });
            group.bench_function(BenchmarkId::new("contact search", threads), |b| {
                pool.install(|| b.iter(|| contact.search(&touching)));
            });
            // A state whose tangent is positive definite: rest.
            let rest = State::at_rest(u.len(), 0);
            group.bench_function(BenchmarkId::new("tangent, assembled and factorised", threads), |b| {
                pool.install(|| {
                    b.iter(|| {
                        let (_, tangent) = system.tangent(&rest).unwrap();
                        system.recycle(Some(tangent));
                    });
                });
            });
            // The residual of a small pressure; a correction to apply.
            let (assembled, tangent) = pool.install(|| system.tangent(&rest.moved_to(1.0.into()))).unwrap();
            group.bench_function(BenchmarkId::new("solution", threads), |b| {
                pool.install(|| b.iter(|| system.solve(&tangent, &assembled, None).unwrap()));
            });
            let correction = pool.install(|| system.solve(&tangent, &assembled, None)).unwrap();
            system.recycle(Some(tangent));
            group.bench_function(BenchmarkId::new("rotation update", threads), |b| {
                pool.install(|| {
                    b.iter(|| {
                        let mut moved = rest.clone();
                        system.move_by(&mut moved, &correction).unwrap();
                        moved
                    });
                });
            });
            group.bench_function(BenchmarkId::new("Newton step", threads), |b| {
                pool.install(|| {
                    b.iter(|| {
                        system.predict(&rest.displacement, None);
                        let mut moved = rest.moved_to(1.0.into());
                        let (assembled, tangent) = system.tangent(&moved).unwrap();
                        let correction = system.solve(&tangent, &assembled, None).unwrap();
                        system.apply(&mut moved, &correction).unwrap();
                        system.recycle(Some(tangent));
                        moved
                    });
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, kernels);
criterion_main!(benches);
