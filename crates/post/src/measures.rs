//! Numbers that describe a deformed body as a whole. Where a part of it is modelled, forces and volumes are those of the whole body (see
//! [`pneuflex_model::symmetry`]).

use std::collections::{BTreeMap, BTreeSet};

use pneuflex_assembly::FollowerPressure;
use pneuflex_mesh::{Facet, shape};
use pneuflex_model::{Cavity, Problem};

use crate::error::{PostError, check};
use crate::surface::Patch;
use pneuflex_mesh::vector::norm;

/// The bottom centreline in the deformed state: \[x, z\] in mm, ordered by the reference x from the clamp to the tip.
///
/// `displacement` has three entries per node, mm. The list is empty if the mesh has no node set `bottom_centreline`.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn centreline(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 2]>, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let deformed = |node: u32| {
        let (x, u) = (problem.mesh.nodes[node as usize], displacement[node as usize]);
        [x[0] + u[0], x[2] + u[2]]
    };
    Ok(centreline_nodes(problem).into_iter().map(deformed).collect())
}

/// Nodes of the bottom centreline from the clamp to the tip; none if the mesh has no node set `bottom_centreline`.
pub fn centreline_nodes(problem: &Problem) -> Vec<u32> {
    let mesh = &problem.mesh;
    let mut nodes = mesh.node_set("bottom_centreline").to_vec();
    nodes.sort_by(|&a, &b| mesh.nodes[a as usize][0].total_cmp(&mesh.nodes[b as usize][0]).then(a.cmp(&b)));
    nodes
}

/// Angle of the chord of a deformed centreline, degrees, positive downwards; `None` for a line without two ends.
pub fn angle_of_chord_deg(centreline: &[[f64; 2]]) -> Option<f64> {
    let [[x0, z0], .., [x1, z1]] = centreline else { return None };
    Some((z0 - z1).atan2(x1 - x0).to_degrees())
}

/// ∂/∂u of the angle of the centreline's chord, degrees per mm, one entry per node; zero without a centreline.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn chord_angle_gradient(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PostError> {
    let line = centreline(problem, displacement)?;
    let mut gradient = vec![[0.0; 3]; displacement.len()];
    if let ([first, .., last], [[x0, z0], .., [x1, z1]]) = (&centreline_nodes(problem)[..], &line[..]) {
        let (along, down) = (x1 - x0, z0 - z1);
        let by_end = [-down, 0.0, -along].map(|slope| (slope / (along * along + down * down)).to_degrees());
        gradient[*last as usize] = by_end;
        gradient[*first as usize] = by_end.map(|slope| -slope);
    }
    Ok(gradient)
}

/// Angle in degrees by which the surface `end_face` (or that of the node set of this name) is turned in the x–z plane; 0 without one.
///
/// It is the best-fit rotation (two-dimensional polar decomposition) of the surface about its centroid, by integrals over its area at rest:
/// it is the same on a half and on the whole, and does not follow the grading of the mesh. It is positive when the actuator bends **downwards**, towards −z, the side of its base: under pressure the default actuator's angle is
/// positive. Full turns are counted by following the bottom centreline from the clamp, so that the angle goes on beyond
/// 180° when the actuator curls.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn end_face_angle_deg(problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, PostError> {
    let line = centreline(problem, displacement)?;
    let facets = end_face(problem);
    if facets.is_empty() {
        return Ok(0.0);
    }
    let (mut points, mut areas) = (Vec::new(), Vec::new());
    for facet in facets {
        let [rest, deformed] = [None, Some(displacement)].map(|u| Patch::new(&problem.mesh, facet, u));
        for (xi, weight) in (rest.kind().rule)() {
            let at_rest = rest.at(xi);
            areas.push(weight * norm(at_rest.area_vector));
            points.push([at_rest.position, deformed.at(xi).position].map(|x| [x[0], x[2]]));
        }
    }
    let area: f64 = areas.iter().sum();
    let mean = |which: usize, d: usize| points.iter().zip(&areas).map(|(p, a)| a * p[which][d]).sum::<f64>() / area;
    let centres = [0, 1].map(|which| [mean(which, 0), mean(which, 1)]);
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (point, weight) in points.iter().zip(&areas) {
        let [a, b]: [[f64; 2]; 2] =
            std::array::from_fn(|which| std::array::from_fn(|d| point[which][d] - centres[which][d]));
        sine += weight * (a[0] * b[1] - a[1] * b[0]);
        cosine += weight * (a[0] * b[0] + a[1] * b[1]);
    }
    // Counter-clockwise in the x–z plane is upwards.
    let angle = -sine.atan2(cosine);
    let winding = line_rotation(&line);
    let turns = ((winding - angle) / std::f64::consts::TAU).round();
    Ok((angle + turns * std::f64::consts::TAU).to_degrees())
}

/// ∂θ/∂u of [`end_face_angle_deg`], degrees per mm, one entry per node; zero without an end face.
///
/// The means drop out of sine and cosine, as ∫ a dA₀ = 0: both are linear in the deformed positions.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn end_face_angle_gradient(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mesh = &problem.mesh;
    let (mut area, mut centre) = (0.0, [0.0; 3]);
    // Weight, position at rest, nodes and their shape functions of every point.
    let mut points = Vec::new();
    for facet in end_face(problem) {
        let rest = Patch::new(mesh, facet, None);
        for (xi, weight) in (rest.kind().rule)() {
            let at = rest.at(xi);
            let weight = weight * norm(at.area_vector);
            area += weight;
            (0..3).for_each(|d| centre[d] += weight * at.position[d]);
            points.push((weight, at.position, mesh.facet_nodes(facet), shape::evaluate_face(rest.kind(), xi).values));
        }
    }
    let (mut sine, mut cosine) = (0.0, 0.0);
    // Of both by the position of every node; along y there is nothing.
    let (mut by_sine, mut by_cosine) = (vec![[0.0; 3]; displacement.len()], vec![[0.0; 3]; displacement.len()]);
    for (weight, position, nodes, values) in points {
        let a: [f64; 3] = std::array::from_fn(|d| weight * (position[d] - centre[d] / area));
        for (&node, value) in nodes.iter().zip(&values) {
            let node = node as usize;
            let b: [f64; 3] = std::array::from_fn(|d| mesh.nodes[node][d] + displacement[node][d]);
            let [along_sine, along_cosine] = [[-a[2], 0.0, a[0]], [a[0], 0.0, a[2]]].map(|v| v.map(|x| value * x));
            for d in [0, 2] {
                by_sine[node][d] += along_sine[d];
                by_cosine[node][d] += along_cosine[d];
                sine += along_sine[d] * b[d];
                cosine += along_cosine[d] * b[d];
            }
        }
    }
    let square = sine * sine + cosine * cosine;
    let slope = |(s, c): ([f64; 3], [f64; 3])| {
        std::array::from_fn(|d| if square > 0.0 { -((cosine * s[d] - sine * c[d]) / square).to_degrees() } else { 0.0 })
    };
    Ok(by_sine.into_iter().zip(by_cosine).map(slope).collect())
}

/// Faces of which [`end_face_angle_deg`] is the angle.
pub fn end_face(problem: &Problem) -> Vec<Facet> {
    problem.mesh.faces_named("end_face")
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

/// Volume of all cavities that have one, mm³: that of every cavity of the modelled part, times the number of parts.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn cavity_volume(problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, PostError> {
    let mut sum = 0.0;
    for cavity in &problem.cavities {
        sum += modelled_volume(problem, cavity, displacement)?.unwrap_or(0.0);
    }
    Ok(problem.parts_of_whole() as f64 * sum)
}

/// Volume of a cavity, mm³; `None` if it is open (see [`Problem::cavity_plane`]). A cavity beside a plane of symmetry, which does not cut
/// it, is one of two.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn volume(problem: &Problem, cavity: &Cavity, displacement: &[[f64; 3]]) -> Result<Option<f64>, PostError> {
    let parts = parts_of_cavity(problem, cavity);
    Ok(modelled_volume(problem, cavity, displacement)?.map(|volume| parts * volume))
}

/// ∂/∂u of [`cavity_volume`], mm² by node.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn cavity_volume_gradient(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PostError> {
    let mut sum = vec![[0.0; 3]; displacement.len()];
    for cavity in &problem.cavities {
        let own = modelled_volume_gradient(problem, cavity, displacement)?.unwrap_or_default();
        let factor = problem.parts_of_whole() as f64;
        sum.as_flattened_mut().iter_mut().zip(own.as_flattened()).for_each(|(sum, own)| *sum += factor * own);
    }
    Ok(sum)
}

/// ∂/∂u of [`volume`], mm² by node; `None` if the cavity is open.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn volume_gradient(
    problem: &Problem,
    cavity: &Cavity,
    displacement: &[[f64; 3]],
) -> Result<Option<Vec<[f64; 3]>>, PostError> {
    let parts = parts_of_cavity(problem, cavity);
    let gradient = modelled_volume_gradient(problem, cavity, displacement)?;
    Ok(gradient.map(|gradient| gradient.into_iter().map(|g| g.map(|x| parts * x)).collect()))
}

/// The same of what is modelled of it: minus the forces of a unit pressure, over the degrees of freedom that its rim does not hold.
fn modelled_volume_gradient(
    problem: &Problem,
    cavity: &Cavity,
    displacement: &[[f64; 3]],
) -> Result<Option<Vec<[f64; 3]>>, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    if problem.cavity_plane(cavity).is_err() {
        return Ok(None);
    }
    let forces = FollowerPressure::new(problem.mesh.clone(), &cavity.facets).forces_of_unit_pressure(displacement);
    Ok(Some(forces.into_iter().map(|force| force.map(|f| -f)).collect()))
}

/// How many parts like the modelled one make up a cavity: one beside a plane of symmetry, which does not cut it, is one of two.
fn parts_of_cavity(problem: &Problem, cavity: &Cavity) -> f64 {
    let cuts = problem.symmetry.iter().filter(|plane| {
        let nodes: BTreeSet<u32> = problem.supports[plane.support].nodes.iter().copied().collect();
        cavity.facets.iter().any(|&facet| problem.mesh.facet_nodes(facet).iter().any(|node| nodes.contains(node)))
    });
    f64::from(1 << cuts.count())
}

/// Volume of what is modelled of a cavity, mm³: what planes of symmetry leave of it.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
fn modelled_volume(problem: &Problem, cavity: &Cavity, displacement: &[[f64; 3]]) -> Result<Option<f64>, PostError> {
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

/// Forces of what holds a body, N.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reactions {
    /// Sum over all supports, every node once; planes of symmetry are none.
    pub total: [f64; 3],
    /// Of every support by name; what holds a node twice, counts twice. Supports beside a plane of symmetry count with their mirror images.
    pub supports: BTreeMap<String, [f64; 3]>,
    /// Force with which the part beyond holds the modelled one at every plane of symmetry, by its words (`y = 0`): that on the whole cross-section, normal
    /// to it.
    pub planes: BTreeMap<String, [f64; 3]>,
}

/// The reactions of a state. `reaction` has three entries per node, N; of every node only what acts along held axes counts.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn reactions(problem: &Problem, reaction: &[[f64; 3]]) -> Result<Reactions, PostError> {
    check("reaction", reaction.as_flattened(), problem.num_dofs())?;
    let mut found = Reactions::default();
    let mut held = vec![[false; 3]; reaction.len()];
    for (number, support) in problem.supports.iter().enumerate() {
        let mut sum = [0.0; 3];
        for &node in &support.nodes {
            for axis in (0..3).filter(|&axis| support.axes[axis]) {
                sum[axis] += reaction[node as usize][axis];
            }
        }
        if let Some(plane) = problem.symmetry.iter().find(|plane| plane.support == number) {
            // The cross-section has two parts for every other plane.
            let sections = 0.5 * problem.parts_of_whole() as f64;
            found.planes.insert(plane.words(), sum.map(|f| sections * f));
            continue;
        }
        for &node in &support.nodes {
            (0..3).for_each(|axis| held[node as usize][axis] |= support.axes[axis]);
        }
        let whole = problem.whole_force(sum);
        let of_name = found.supports.entry(support.name.clone()).or_default();
        *of_name = std::array::from_fn(|d| of_name[d] + whole[d]);
    }
    let mut total = [0.0; 3];
    for (force, held) in reaction.iter().zip(held) {
        (0..3).filter(|&axis| held[axis]).for_each(|axis| total[axis] += force[axis]);
    }
    found.total = problem.whole_force(total);
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};
    use pneuflex_mesh::{Actuator, MeshSize, Part};
    use pneuflex_model::Formulation;

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
        let at_rest = 2.0 * (2.0 * 6.0 * 9.0 * 8.0 + 16.0 + 12.0);
        let volume = cavity_volume(&problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).unwrap();
        assert!((volume - at_rest).abs() < 1e-9, "{volume}");
        let u = displacement_of(&problem, |x| [0.2 * x[0] + 0.3 * x[2], 0.1 * x[1], -0.1 * x[2] + 0.2 * x[0]]);
        let determinant = 1.1 * (1.2 * 0.9 - 0.3 * 0.2);
        let volume = cavity_volume(&problem, &u).unwrap();
        assert!((volume - determinant * at_rest).abs() < 1e-9, "{volume}");
    }

    #[test]
    fn reactions_are_those_of_the_whole_body_and_planes_of_symmetry_stand_apart() {
        let mut problem = two_chambers(2.0);
        let ones = vec![[1.0; 3]; problem.mesh.num_nodes()];
        let [clamp, plane] = [0, 1].map(|i| problem.supports[i].nodes.len() as f64);
        let half = reactions(&problem, &ones).unwrap();
        assert_eq!((half.total, half.supports.len()), ([2.0 * clamp, 0.0, 2.0 * clamp], 1));
        assert_eq!(half.supports["clamp"], half.total);
        assert_eq!(half.planes, BTreeMap::from([("y = 0".to_owned(), [0.0, plane, 0.0])]));
        // Without the plane everything is as it is; a node that is held twice counts once in the sum.
        problem.symmetry.clear();
        let part = reactions(&problem, &ones).unwrap();
        let both = problem.supports[1].nodes.iter().filter(|node| problem.supports[0].nodes.contains(node)).count();
        assert_eq!(part.total, [clamp, clamp + plane - both as f64, clamp]);
        assert_eq!((part.supports["clamp"], part.supports["symmetry"]), ([clamp; 3], [0.0, plane, 0.0]));
        assert!(part.planes.is_empty() && both > 0);
        assert!(matches!(reactions(&problem, &ones[1..]), Err(PostError::WrongLength { .. })));
    }

    #[test]
    fn the_angle_is_that_of_the_face_and_not_of_its_nodes() {
        // The face bends: turned by 0.2 in its lower, finer half, and by 0.1 above.
        let of = |part: Part, size: [f64; 3]| {
            let actuator = Actuator { part, ..Actuator::two_chambers() };
            let size = MeshSize { size, ..MeshSize::uniform(1.0) };
            let (material, contact) = Default::default();
            let problem = Problem::from_actuator(&actuator, &size, Formulation::Hex27, material, contact).unwrap();
            let u = displacement_of(&problem, |x| [0.01 * x[2] * (1.0 - 0.02 * x[1] * x[1]), 0.0, 0.002 * x[1] * x[1]]);
            end_face_angle_deg(&problem, &u).unwrap()
        };
        let whole = of(Part::Whole, [4.0, 5.0, 2.0]);
        assert!((of(Part::Half, [4.0, 5.0, 2.0]) - whole).abs() < 1e-12 && whole > 0.05, "{whole}");
        assert!((of(Part::Half, [4.0, 2.5, 1.0]) - whole).abs() < 1e-12);
        // Σ a × b / Σ a · b over the rectangle in closed form: the mean of 1 − 0.02 y² over |y| < 10 is 1/3.
        let exact = (0.01 * (1.0 / 3.0_f64)).atan().to_degrees();
        assert!((whole - exact).abs() < 1e-12, "{whole} {exact}");
    }

    #[test]
    fn gradients_are_those_of_differences() {
        let problem = two_chambers(2.0);
        let at = |t: f64| {
            let (s, c) = 2.5_f64.sin_cos();
            displacement_of(&problem, |x| {
                let bulge = (0.1 + t) * (0.9 * x[1] + 1.3 * x[2]).sin();
                // The plane of symmetry stays one.
                [
                    c * x[0] + s * x[2] - x[0] + bulge,
                    t * x[0] * x[1],
                    c * x[2] - s * x[0] - x[2] + t * (x[0] + x[1] * x[2]).cos(),
                ]
            })
        };
        let h = 1e-4;
        let [low, high] = [-h, h].map(&at);
        let chord = |u: &[[f64; 3]]| angle_of_chord_deg(&centreline(&problem, u).unwrap()).unwrap();
        for (gradient, [before, after]) in [
            (
                end_face_angle_gradient(&problem, &at(0.0)),
                [&low, &high].map(|u| end_face_angle_deg(&problem, u).unwrap()),
            ),
            (chord_angle_gradient(&problem, &at(0.0)), [&low, &high].map(|u| chord(u))),
            (
                volume_gradient(&problem, &problem.cavities[0], &at(0.0)).map(Option::unwrap),
                [&low, &high].map(|u| cavity_volume(&problem, u).unwrap()),
            ),
        ] {
            let changes = low.as_flattened().iter().zip(high.as_flattened()).map(|(low, high)| high - low);
            let along: f64 = gradient.unwrap().as_flattened().iter().zip(changes).map(|(g, change)| g * change).sum();
            let change = after - before;
            assert!((along - change).abs() < 1e-6 * along.abs() && along.abs() > 1e-4, "{along} {change}");
        }
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
