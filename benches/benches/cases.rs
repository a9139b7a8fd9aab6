//! Whole load paths: two chambers and the full actuator, 0 to 50 kPa with multiple-point contact.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pneuflex::model::{Formulation, Problem, Resolution, Solver};
use pneuflex::newton::follow_path;
use pneuflex_benches::{full_actuator, resolved_actuator, two_chambers};

fn run(problem: &Problem) -> usize {
    let pressures = [5.0, 15.0, 25.0, 35.0, 50.0];
    follow_path(problem, &pressures, &Solver::default(), &mut |_| {}).unwrap().iterations
}

fn cases(c: &mut Criterion) {
    let mut group = c.benchmark_group("0 to 50 kPa");
    group.sample_size(10);
    for (name, problem) in [
        ("two chambers, hex8-sri 1 mm", two_chambers(Formulation::Hex8Sri, 1.0)),
        ("full actuator, hex8-sri 1 mm", full_actuator(Formulation::Hex8Sri, 1.0)),
        ("full actuator, draft", resolved_actuator(Resolution::Draft)),
        ("full actuator, standard", resolved_actuator(Resolution::Standard)),
    ] {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            group.bench_function(BenchmarkId::new(name, threads), |b| pool.install(|| b.iter(|| run(&problem))));
        }
    }
    group.finish();
}

criterion_group!(benches, cases);
criterion_main!(benches);
