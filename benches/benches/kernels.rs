//! Assembly, contact search, factorisation, solution and warp, and the Newton step made of them, for each element formulation.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pneuflex::model::Formulation;
use pneuflex::newton::System;
use pneuflex_assembly::Request;
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
        assert!(!contact.search(&touching).is_empty(), "nothing touches");
        let mut group = c.benchmark_group(format!("{formulation} {size} mm, {} unknowns", problem.num_unknowns()));
        group.sample_size(10);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut system = pool.install(|| System::new(&problem, Parallelism::Threads)).unwrap();
            group.bench_function(BenchmarkId::new("assembly", threads), |b| {
                pool.install(|| b.iter(|| system.assemble(&u, 5.0, &[], Request::Tangent).unwrap()));
            });
            group.bench_function(BenchmarkId::new("contact search", threads), |b| {
                pool.install(|| b.iter(|| contact.search(&touching)));
            });
            // A state whose tangent is positive definite: rest.
            let rest = vec![[0.0; 3]; u.len()];
            pool.install(|| system.assemble(&rest, 0.0, &[], Request::Tangent)).unwrap();
            group.bench_function(BenchmarkId::new("factorisation", threads), |b| {
                pool.install(|| b.iter(|| system.factorize().unwrap()));
            });
            // The residual of a small pressure; a correction to warp.
            pool.install(|| system.assemble(&rest, 1.0, &[], Request::Tangent)).unwrap();
            pool.install(|| system.factorize()).unwrap();
            group.bench_function(BenchmarkId::new("solution", threads), |b| {
                pool.install(|| b.iter(|| system.solve(None).unwrap()));
            });
            let correction = pool.install(|| system.solve(None)).unwrap();
            group.bench_function(BenchmarkId::new("warp", threads), |b| {
                pool.install(|| {
                    b.iter(|| {
                        let mut moved = rest.clone();
                        system.warp(&mut moved, &correction.displacement).unwrap();
                        moved
                    });
                });
            });
            group.bench_function(BenchmarkId::new("Newton step", threads), |b| {
                pool.install(|| {
                    b.iter(|| {
                        system.carry_pressures(&rest);
                        system.assemble(&rest, 0.0, &[], Request::Tangent).unwrap();
                        system.factorize().unwrap();
                        let correction = system.solve(None).unwrap();
                        let mut moved = rest.clone();
                        system.carry(&rest, &correction.displacement);
                        system.warp(&mut moved, &correction.displacement).unwrap();
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
