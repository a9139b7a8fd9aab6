//! Numbers that describe a deformed body as a whole.

use pneuflex_model::{Cavity, Problem};

use crate::error::{PostError, check};
use crate::surface::Patch;
use crate::vector::{Vec3, dot};

/// The bottom centreline in the deformed state: \[x, z\] in mm, ordered by the reference x from the clamp to the tip.
///
/// `displacement` has three entries per node, mm. The list is empty if the mesh has no node set `bottom_centreline`.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn centreline(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 2]>, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mesh = &problem.mesh;
    let mut nodes = mesh.node_set("bottom_centreline").to_vec();
    nodes.sort_by(|&a, &b| mesh.nodes[a as usize][0].total_cmp(&mesh.nodes[b as usize][0]).then(a.cmp(&b)));
    Ok(nodes
        .into_iter()
        .map(|n| {
            let (x, u) = (mesh.nodes[n as usize], displacement[n as usize]);
            [x[0] + u[0], x[2] + u[2]]
        })
        .collect())
}

/// Angle in degrees by which the node set `end_face` is turned in the x–z plane; 0 without such a set.
///
/// It is the best-fit rotation (two-dimensional polar decomposition) of the set about its centroid, positive when the
/// actuator bends **downwards**, towards −z, the side of its base: under pressure the default actuator's angle is
/// positive. Full turns are counted by following the bottom centreline from the clamp, so that the angle goes on beyond
/// 180° when the actuator curls.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn end_face_angle_deg(problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, PostError> {
    let line = centreline(problem, displacement)?;
    let mesh = &problem.mesh;
    let nodes = mesh.node_set("end_face");
    if nodes.is_empty() {
        return Ok(0.0);
    }
    let positions = |deformed: bool| -> Vec<[f64; 2]> {
        nodes
            .iter()
            .map(|&n| {
                let (x, u) = (mesh.nodes[n as usize], displacement[n as usize]);
                if deformed { [x[0] + u[0], x[2] + u[2]] } else { [x[0], x[2]] }
            })
            .collect()
    };
    let (before, after) = (centred(positions(false)), centred(positions(true)));
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (a, b) in before.iter().zip(&after) {
        sine += a[0] * b[1] - a[1] * b[0];
        cosine += a[0] * b[0] + a[1] * b[1];
    }
    // Counter-clockwise in the x–z plane is upwards.
    let angle = -sine.atan2(cosine);
    let winding = line_rotation(&line);
    let turns = ((winding - angle) / std::f64::consts::TAU).round();
    Ok((angle + turns * std::f64::consts::TAU).to_degrees())
}

fn centred(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let n = points.len() as f64;
    let centre: [f64; 2] = std::array::from_fn(|d| points.iter().map(|p| p[d]).sum::<f64>() / n);
    points.into_iter().map(|p| [p[0] - centre[0], p[1] - centre[1]]).collect()
}

/// How far the tangent of a line that starts along +x turns downwards from its start to its end, whole turns included.
fn line_rotation(line: &[[f64; 2]]) -> f64 {
    let mut direction = [1.0, 0.0];
    let mut angle = 0.0;
    for pair in line.windows(2) {
        let next = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let sine: f64 = direction[0] * next[1] - direction[1] * next[0];
        angle -= sine.atan2(direction[0] * next[0] + direction[1] * next[1]);
        direction = next;
    }
    angle
}

/// Volume of the air, mm³: −⅓ ∮ r·n dS over the deformed pressure faces, whose normals point out of the solid.
///
/// Exact if the cavity is closed, or cut only by planes through the origin such as the symmetry plane of a half model,
/// for which it is the volume of the modelled half.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn cavity_volume(problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mut sum = 0.0;
    for facet in problem.cavity_facets() {
        let patch = Patch::new(&problem.mesh, facet, Some(displacement));
        for (xi, weight) in (patch.kind().rule)() {
            let point = patch.at(xi);
            sum += weight * dot(point.position, point.area_vector);
        }
    }
    Ok(-sum / 3.0)
}

/// Volume of a cavity, mm³, or of what planes of symmetry leave of it; `None` if it is open (see [`Problem::cavity_plane`]).
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn volume(problem: &Problem, cavity: &Cavity, displacement: &[[f64; 3]]) -> Result<Option<f64>, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let Ok(plane_y) = problem.cavity_plane(cavity) else { return Ok(None) };
    let mut sum = 0.0;
    for &facet in &cavity.facets {
        let patch = Patch::new(&problem.mesh, facet, Some(displacement));
        for (xi, weight) in (patch.kind().rule)() {
            let point = patch.at(xi);
            sum -= weight * (point.position[1] - plane_y) * point.area_vector[1];
        }
    }
    Ok(Some(sum))
}

/// Sum of the reactions over the nodes of the named support, N; zero if there is none of that name.
///
/// `reaction` has three entries per node, N. A node that belongs to two supports counts with all its components.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn reaction(problem: &Problem, reaction: &[[f64; 3]], support: &str) -> Result<[f64; 3], PostError> {
    check("reaction", reaction.as_flattened(), problem.num_dofs())?;
    let mut sum = [0.0; 3];
    for support in problem.supports.iter().filter(|s| s.name == support) {
        for &node in &support.nodes {
            let r: Vec3 = reaction[node as usize];
            for d in 0..3 {
                sum[d] += r[d];
            }
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};

    #[test]
    fn a_rigid_rotation_is_the_angle_of_the_end_face() {
        let problem = two_chambers(2.0);
        for degrees in [-120.0_f64, 0.0, 54.0, 170.0] {
            let (s, c) = degrees.to_radians().sin_cos();
            // Downwards: x towards −z.
            let u = displacement_of(&problem, |x| [c * x[0] + s * x[2] - x[0], 0.0, -s * x[0] + c * x[2] - x[2]]);
            let angle = end_face_angle_deg(&problem, &u).unwrap();
            assert!((angle - degrees).abs() < 1e-9, "{angle} for {degrees}");
        }
    }

    #[test]
    fn curling_beyond_half_a_turn_is_counted() {
        let problem = two_chambers(1.0);
        for degrees in [100.0_f64, 200.0, 400.0] {
            // Pure bending to a circle arc about an axis below the base.
            let curvature = degrees.to_radians() / 18.0;
            let u = displacement_of(&problem, |x| {
                let radius = 1.0 / curvature + x[2];
                let (s, c) = (curvature * x[0]).sin_cos();
                [radius * s - x[0], 0.0, radius * c - 1.0 / curvature - x[2]]
            });
            let angle = end_face_angle_deg(&problem, &u).unwrap();
            assert!((angle - degrees).abs() < 1e-9, "{angle} for {degrees}");
        }
    }

    #[test]
    fn air_volume_follows_an_affine_map() {
        let problem = two_chambers(1.0);
        let at_rest = 2.0 * 6.0 * 9.0 * 8.0 + 16.0 + 12.0;
        let volume = cavity_volume(&problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).unwrap();
        assert!((volume - at_rest).abs() < 1e-9, "{volume}");
        let u = displacement_of(&problem, |x| [0.2 * x[0] + 0.3 * x[2], 0.1 * x[1], -0.1 * x[2] + 0.2 * x[0]]);
        let determinant = 1.1 * (1.2 * 0.9 - 0.3 * 0.2);
        let volume = cavity_volume(&problem, &u).unwrap();
        assert!((volume - determinant * at_rest).abs() < 1e-9, "{volume}");
    }

    #[test]
    fn reactions_are_summed_over_the_named_support_only() {
        let problem = two_chambers(2.0);
        let ones = vec![[1.0; 3]; problem.mesh.num_nodes()];
        let clamp = problem.supports[0].nodes.len() as f64;
        assert_eq!(reaction(&problem, &ones, "clamp").unwrap(), [clamp; 3]);
        assert_eq!(reaction(&problem, &ones, "nothing").unwrap(), [0.0; 3]);
        assert!(matches!(reaction(&problem, &ones[1..], "clamp"), Err(PostError::WrongLength { .. })));
    }

    #[test]
    fn the_centreline_starts_at_the_clamp() {
        let problem = two_chambers(1.0);
        let line = centreline(&problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).unwrap();
        assert_eq!(line.len(), 19);
        assert_eq!((line[0], line[18]), ([0.0, 0.0], [18.0, 0.0]));
        assert!(line.windows(2).all(|w| w[0][0] < w[1][0]));
    }
}
