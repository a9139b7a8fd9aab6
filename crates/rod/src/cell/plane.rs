//! Rigid motions of a plane across the actuator.

use pneuflex_model::Problem;

/// Displacement of a point of the plane under a motion, and the derivative of its x and z by the rotation.
pub fn place(at: [f64; 3], origin: [f64; 2], [x, z, turn]: [f64; 3]) -> ([f64; 3], [f64; 2]) {
    let (sine, cosine) = turn.sin_cos();
    let [dx, dz] = [at[0] - origin[0], at[2] - origin[1]];
    let moved = [x + cosine * dx + sine * dz - dx, 0.0, z - sine * dx + cosine * dz - dz];
    (moved, [-sine * dx + cosine * dz, -cosine * dx - sine * dz])
}

/// The motion of a plane across x that comes closest to that of what some of its nodes span: by integrals over their faces, so that it does
/// not follow the grading of the mesh.
pub fn best_motion(problem: &Problem, nodes: &[u32], displacement: &[[f64; 3]]) -> [f64; 3] {
    let mesh = &problem.mesh;
    let shares = mesh.shares(nodes);
    let mean = |component: usize, deformed: bool| {
        let value = |&node: &u32| {
            let (node, d) = (node as usize, component);
            mesh.nodes[node][d] + if deformed { displacement[node][d] } else { 0.0 }
        };
        nodes.iter().zip(&shares).map(|(node, share)| share * value(node)).sum::<f64>()
    };
    let (before, after) = ([mean(0, false), mean(2, false)], [mean(0, true), mean(2, true)]);
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (&node, share) in nodes.iter().zip(&shares) {
        let node = node as usize;
        let (x, u) = (mesh.nodes[node], displacement[node]);
        let a = [x[0] - before[0], x[2] - before[1]];
        let b = [x[0] + u[0] - after[0], x[2] + u[2] - after[1]];
        sine += share * (a[0] * b[1] - a[1] * b[0]);
        cosine += share * (a[0] * b[0] + a[1] * b[1]);
    }
    let turn = -sine.atan2(cosine);
    let (s, c) = turn.sin_cos();
    // The centroid's motion, less what the rotation about the bottom does to it.
    let dz = before[1];
    [after[0] - before[0] - s * dz, after[1] - before[1] - (c - 1.0) * dz, turn]
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::{Actuator, MeshSize};
    use pneuflex_model::{Contact, Formulation, Material};

    use super::*;

    #[test]
    fn a_turned_plane_does_the_work_of_its_moment() {
        let (at, origin, motion) = ([18.0, 3.0, 4.0], [18.0, 0.0], [0.1, -0.2, 0.3]);
        let (_, by_turn) = place(at, origin, motion);
        let step = 1e-6;
        let [more, less] = [step, -step].map(|h| place(at, origin, [motion[0], motion[1], motion[2] + h]).0);
        assert!(((more[0] - less[0]) / (2.0 * step) - by_turn[0]).abs() < 1e-8);
        assert!(((more[2] - less[2]) / (2.0 * step) - by_turn[1]).abs() < 1e-8);
        // Positive turns lead downwards: the top of the face goes forwards.
        assert!(place(at, origin, [0.0, 0.0, 0.1]).0[0] > 0.0);
    }

    #[test]
    fn the_motion_of_a_rigidly_moved_end_is_found() {
        let size = MeshSize::uniform(2.0);
        let problem = Problem::from_actuator(
            &Actuator::two_chambers(),
            &size,
            Formulation::Hex8Sri,
            Material::default(),
            Contact::default(),
        )
        .unwrap();
        let motion = [0.3, -0.7, 0.4];
        let u: Vec<[f64; 3]> = problem.mesh.nodes.iter().map(|&x| place(x, [18.0, 0.0], motion).0).collect();
        for (found, expected) in best_motion(&problem, problem.mesh.node_set("end_face"), &u).into_iter().zip(motion) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn the_turn_of_a_warped_end_does_not_follow_the_grading_of_the_mesh() {
        // u_x = z³/100 on the end face, by three gradings: the best turn over its area is one number.
        let turn = |edge: f64| {
            let size = MeshSize { edge, ..MeshSize::uniform(1.5) };
            let (law, contact) = (Material::default(), Contact::default());
            let actuator = Actuator::two_chambers();
            let problem = Problem::from_actuator(&actuator, &size, Formulation::Hex27, law, contact).unwrap();
            let u: Vec<[f64; 3]> = problem.mesh.nodes.iter().map(|x| [x[2].powi(3) / 100.0, 0.0, 0.0]).collect();
            best_motion(&problem, problem.mesh.node_set("end_face"), &u)[2]
        };
        let [coarse, graded, fine] = [1.5, 0.3, 0.1].map(turn);
        assert!((graded / coarse - 1.0).abs() < 2e-3 && (fine / graded - 1.0).abs() < 2e-4, "{coarse} {graded} {fine}");
    }
}
