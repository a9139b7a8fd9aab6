//! What several tests need.

use pneuflex_mesh::{Actuator, MeshSize};
use pneuflex_model::{Contact, Formulation, Material, Problem};
use serde_json::{Value, json};

/// Two chambers on a coarse mesh.
pub fn two_chambers(formulation: Formulation) -> Problem {
    let size = MeshSize::uniform(3.0);
    Problem::from_actuator(&Actuator::two_chambers(), &size, formulation, Material::default(), Contact::default())
        .unwrap()
}

/// Displacements by the reference position.
pub fn displaced(problem: &Problem, by: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    problem.mesh.nodes.iter().map(|&x| by(x)).collect()
}

/// A summary with made-up numbers at the given pressures.
pub fn summary_json(pressures: &[f64]) -> Value {
    let step = |p: &f64| {
        json!({
            "pressure_kpa": p, "converged": true, "iterations": 4, "load_steps": 1,
            "probes": {"tip": [-0.1 * p, 0.0, -0.5 * p]},
            "end_face_angle_deg": 2.0 * p, "centreline": [[0.0, 0.0], [18.0 - 0.1 * p, -0.5 * p]],
            "max_von_mises_mpa": 0.03 * p, "von_mises_p99_mpa": 0.01 * p,
            "contact": {"area_mm2": p, "max_penetration_mm": 0.0, "gaps_in_contact": 0},
            "cavity_volume_mm3": 900.0 + p
        })
    };
    json!({
        "program": "pneuflex", "version": "0.1.0", "title": "a title", "status": "converged",
        "mesh": {"nodes": 1, "elements": 1, "unknowns": 3, "element": "hex8-sri"},
        "probes": {"tip": {"node": 5, "at": [18.0, 0.0, 0.0], "distance_mm": 0.0}},
        "steps": pressures.iter().map(step).collect::<Vec<_>>(),
        "iterations_total": 4 * pressures.len(), "timing": {"total_s": 1.5}
    })
}
