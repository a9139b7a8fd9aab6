#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]
use pneuflex_mesh::*;
use pneuflex_model::*;
use pneuflex_newton::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let full = a[1] == "full";
    let h: f64 = a[2].parse().unwrap();
    let f = match a[3].as_str() {
        "sri" => Formulation::Hex8Sri,
        "q1p0" => Formulation::Hex8Q1p0,
        "hex20" => Formulation::Hex20,
        _ => Formulation::Hex27,
    };
    let m = match a[4].as_str() {
        "none" => ContactMethod::None,
        "single" => ContactMethod::SinglePoint,
        _ => ContactMethod::MultiPoint,
    };
    let inv = if a[5] == "full" { Invariant::Full } else { Invariant::Isochoric };
    let act = if full { Actuator::full() } else { Actuator::two_chambers() };
    let p = Problem::from_actuator(
        &act,
        &MeshSize { size: [h; 3], wall_elements: 1 },
        f,
        Material { invariant: inv, ..Material::default() },
        Contact { method: m, stiffness: 4.0 },
    )
    .unwrap();
    println!("unknowns {}", p.num_unknowns());
    let tip = p.mesh.nearest_node([act.length(), 0.0, 0.0]).unwrap().0;
    let s = Solver::default();
    let r = follow_path(&p, &[5.0, 15.0, 25.0, 35.0, 50.0], &s, &mut |e| match e {
        Event::Iteration(r) => println!(
            "  {:3} {:2} {:7.3} {:.2e} {:.2e} {:5} {} {:.2}",
            r.step,
            r.iteration,
            r.pressure_kpa,
            r.correction,
            r.relative_residual,
            r.contact_points,
            r.negative_pivots,
            r.elapsed_s
        ),
        Event::StepRejected { cause, .. } => println!("  rejected {cause}"),
        Event::Landed(l) => {
            let clamp: [f64; 3] =
                std::array::from_fn(|k| p.supports[0].nodes.iter().map(|&n| l.reaction[3 * n as usize + k]).sum());
            println!(
                "{} kPa: tip {:?} it {} steps {} contact {} reaction {:?}",
                l.pressure_kpa,
                &l.displacement[3 * tip..3 * tip + 3],
                l.iterations,
                l.load_steps,
                l.contact_points,
                clamp
            )
        }
        _ => {}
    });
    match r {
        Ok(r) => println!("{r:?}"),
        Err((f, r)) => println!("{f} {r:?}"),
    }
}
