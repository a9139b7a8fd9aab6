//! What the contact's own points carry: how many, over which area, the tractions on both walls, the forces on obstacles.

use std::collections::BTreeMap;

use pneuflex_contact::obstacle::distance;
use pneuflex_contact::{AverageGap, ContactBlock, ContactModel, Partner, Touching, evaluate_block};
use pneuflex_mesh::Facet;
use pneuflex_model::{ContactPair, LoadParameter, Problem};

pub use pneuflex_contact::{HeldInside, deepest_held};

use crate::error::{PostError, check};
use crate::search::Surface;
use crate::surface::Patch;
use pneuflex_mesh::vector::{cross, norm, sub};

/// The contact of one state, from the points of the chosen method (theory §5).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactState {
    /// Points with a negative distance.
    pub points_active: usize,
    /// Reference area these points stand for, mm².
    pub area_mm2: f64,
    /// Energy of the penalty, ½ k Σ wᵢ dᵢ² over these points, mJ.
    pub penalty_energy_mj: f64,
    /// Force of the contact on every facet of every pair's slave and master wall, N. The second list of a surface that touches itself is
    /// empty.
    pub facet_force: Vec<[Vec<[f64; 3]>; 2]>,
    /// What the body does to every obstacle.
    pub obstacles: Vec<ObstacleForce>,
    /// Signed distance of every node of the walls from the opposite wall, and of the faces that may touch an obstacle from the nearest
    /// obstacle, mm; the smaller one where there are both, `None` elsewhere.
    pub nodal_gap: Vec<Option<f64>>,
}

/// What the modelled body does to an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleForce {
    /// Name of the obstacle.
    pub name: String,
    /// Force of the body on it, N.
    pub force: [f64; 3],
    /// Moment of that force about `about`, N·mm.
    pub moment: [f64; 3],
    /// The obstacle's centre, or the given point of a plane or an axis, where it is now, mm.
    pub about: [f64; 3],
    /// Contact points that carry traction.
    pub points_active: usize,
    /// Reference area of these points, mm².
    pub area_mm2: f64,
    /// Largest depth of a contact point, mm; 0 if none is inside.
    pub max_penetration_mm: f64,
    /// Force of the obstacle on every of its facets, N.
    pub facet_force: Vec<[f64; 3]>,
}

/// Evaluates the contact of a state without multipliers at the beginning of the load path, see [`evaluate_at`].
///
/// # Errors
/// As there.
pub fn evaluate(problem: &Problem, displacement: &[[f64; 3]]) -> Result<ContactState, PostError> {
    evaluate_at(problem, displacement, LoadParameter::default(), &[])
}

/// How deep the surfaces of every pair are in each other at rest without being meant to, mm, by the pair's number.
pub fn overlapping_pairs(problem: &Problem) -> Vec<(usize, f64)> {
    ContactModel::of(problem).overlapping_pairs()
}

/// Evaluates the contact of a state.
///
/// `displacement` has one entry per node, mm; `parameter` tells where obstacles are; `multipliers` (MPa) are those of the contact's
/// points, or none.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn evaluate_at(
    problem: &Problem,
    displacement: &[[f64; 3]],
    parameter: LoadParameter,
    multipliers: &[f64],
) -> Result<ContactState, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mut model = ContactModel::of(problem);
    if !multipliers.is_empty() {
        check("contact multipliers", multipliers, model.num_points())?;
    }
    model.set_multipliers(multipliers.to_vec());
    model.set_parameter(parameter);
    let mut state = ContactState {
        points_active: 0,
        area_mm2: 0.0,
        penalty_energy_mj: 0.0,
        facet_force: (problem.contact_pairs.iter())
            .map(|pair| {
                let masters = if pair.is_self() { 0 } else { pair.master.len() };
                [pair.slave.len(), masters].map(|facets| vec![[0.0; 3]; facets])
            })
            .collect(),
        obstacles: (problem.obstacles.iter().enumerate())
            .map(|(number, obstacle)| ObstacleForce {
                name: obstacle.name.clone(),
                force: [0.0; 3],
                moment: [0.0; 3],
                about: model.reference_point(number),
                points_active: 0,
                area_mm2: 0.0,
                max_penetration_mm: 0.0,
                facet_force: vec![[0.0; 3]; obstacle.facets.len()],
            })
            .collect(),
        nodal_gap: vec![None; problem.mesh.num_nodes()],
    };
    for pair in problem.contact_pairs.iter().filter(|pair| !pair.is_self()) {
        gaps(problem, pair, displacement, &mut state);
    }
    let positions: Vec<[f64; 3]> =
        (problem.mesh.nodes.iter().zip(displacement)).map(|(x, u)| std::array::from_fn(|d| x[d] + u[d])).collect();
    for obstacle in &problem.obstacles {
        let offset = obstacle.offset(parameter);
        for node in obstacle.facets.iter().flat_map(|&facet| problem.mesh.facet_nodes(facet)) {
            let found = distance(&obstacle.shape, offset, positions[node as usize]).value;
            let gap = &mut state.nodal_gap[node as usize];
            *gap = Some(gap.map_or(found, |gap| gap.min(found)));
        }
    }
    model.cut(&positions);
    let Touching { blocks, averages } = model.search(&positions);
    state.penalty_energy_mj += averages.iter().map(AverageGap::energy).sum::<f64>();
    for block in blocks {
        let area = block.points.iter().map(|p| p.area).sum::<f64>();
        let evaluated = evaluate_block(&model, &block, &positions, false);
        state.penalty_energy_mj += evaluated.energy;
        if let Partner::Obstacle(number) = block.partner {
            state.obstacles[number].add(&block, area, &evaluated.residual, &positions);
            continue;
        }
        state.points_active += block.points.len();
        state.area_mm2 += area;
        // The force is the negative gradient of the contact's energy.
        let gradient = evaluated.residual;
        let per_face = gradient.len() / 2;
        let Partner::Face { surface_pair, face: master_face } = block.partner else { continue };
        let surface_pair = model.surface_pair(surface_pair);
        for (which, face) in [block.slave_face, master_face].into_iter().enumerate() {
            let is_second =
                (which == 1) != surface_pair.is_reversed && !problem.contact_pairs[surface_pair.pair].is_self();
            let side = usize::from(is_second);
            let force = &mut state.facet_force[surface_pair.pair][side][face];
            for g in gradient[which * per_face..(which + 1) * per_face].chunks(3) {
                for d in 0..3 {
                    force[d] -= g[d];
                }
            }
        }
    }
    Ok(state)
}

impl ObstacleForce {
    /// Adds the points of a facet; `gradient` is that of their energy, the force of the body's nodes on the obstacle.
    fn add(&mut self, block: &ContactBlock, area: f64, gradient: &[f64], positions: &[[f64; 3]]) {
        self.points_active += block.points.len();
        self.area_mm2 += area;
        self.max_penetration_mm = block.points.iter().fold(self.max_penetration_mm, |a, p| a.max(-p.distance));
        for (&node, force) in block.nodes.iter().zip(gradient.chunks_exact(3)) {
            let arm = sub(positions[node as usize], self.about);
            let moment = cross(arm, [force[0], force[1], force[2]]);
            for d in 0..3 {
                self.force[d] += force[d];
                self.moment[d] += moment[d];
                self.facet_force[block.slave_face][d] -= force[d];
            }
        }
    }
}

fn gaps(problem: &Problem, pair: &ContactPair, displacement: &[[f64; 3]], state: &mut ContactState) {
    for (wall, opposite) in [(&pair.slave, &pair.master), (&pair.master, &pair.slave)] {
        let surface = Surface::new(problem, opposite, displacement);
        let mut hint = None;
        for &facet in wall {
            let patch = Patch::new(&problem.mesh, facet, Some(displacement));
            for (&node, &position) in problem.mesh.facet_nodes(facet).iter().zip(patch.nodes()) {
                let gap = &mut state.nodal_gap[node as usize];
                if gap.is_none() {
                    *gap = surface.closest(position, hint).map(|closest| {
                        hint = Some(closest.facet);
                        closest.signed_distance
                    });
                }
            }
        }
    }
}

impl ContactState {
    /// Contact traction at every node, MPa: the mean tractions of the facets around the node, weighted by their
    /// reference areas.
    pub fn nodal_traction(&self, problem: &Problem) -> Vec<[f64; 3]> {
        let mut traction = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let mut area = vec![0.0; problem.mesh.num_nodes()];
        let of_pairs = problem.contact_pairs.iter().zip(&self.facet_force);
        let walls = of_pairs.flat_map(|(pair, [slave, master])| [(&pair.slave, slave), (&pair.master, master)]);
        let of_obstacles =
            problem.obstacles.iter().zip(&self.obstacles).map(|(o, found)| (&o.facets, &found.facet_force));
        // A facet may belong to several of them: it has one area, and what any of them does to it adds up.
        let mut by_facet: BTreeMap<Facet, [f64; 3]> = BTreeMap::new();
        for (facets, forces) in walls.chain(of_obstacles) {
            for (&facet, force) in facets.iter().zip(forces) {
                let sum = by_facet.entry(facet).or_default();
                *sum = std::array::from_fn(|d| sum[d] + force[d]);
            }
        }
        for (facet, force) in by_facet {
            let patch = Patch::new(&problem.mesh, facet, None);
            let face: f64 = (patch.kind().rule)().into_iter().map(|(xi, w)| w * norm(patch.at(xi).area_vector)).sum();
            for node in problem.mesh.facet_nodes(facet) {
                area[node as usize] += face;
                for d in 0..3 {
                    traction[node as usize][d] += force[d];
                }
            }
        }
        let divide = |(sum, area): (&[f64; 3], &f64)| if *area > 0.0 { sum.map(|t| t / area) } else { [0.0; 3] };
        traction.iter().zip(&area).map(divide).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};
    use pneuflex_model::load::Motion;
    use pneuflex_model::{ContactMethod, Curve, Obstacle, Shape};

    fn pushed(problem: &Problem) -> Vec<[f64; 3]> {
        displacement_of(problem, |x| [if x[0] <= 8.0 { 2.1 } else { 0.0 }, 0.0, 0.0])
    }

    #[test]
    fn a_wall_pushed_flat_into_the_other_carries_k_delta_everywhere() {
        for (method, points) in [(ContactMethod::SinglePoint, 90), (ContactMethod::MultiPoint, 90 * 16)] {
            let mut problem = two_chambers(1.0);
            problem.contact.method = method;
            let state = evaluate(&problem, &pushed(&problem)).unwrap();
            assert_eq!(state.points_active, points, "{method:?}");
            assert!((state.area_mm2 - 90.0).abs() < 1e-9);
            // ½ k δ² A.
            assert!((state.penalty_energy_mj - 0.5 * 4.0 * 0.01 * 90.0).abs() < 1e-9);
            let mut sum = [0.0; 2];
            for side in 0..2 {
                for force in &state.facet_force[0][side] {
                    sum[side] += force[0];
                    assert!(force[1].abs() + force[2].abs() < 1e-12);
                }
            }
            // k δ A on the slave against its outward normal, the same on the master.
            assert!((sum[0] + 4.0 * 0.1 * 90.0).abs() < 1e-9 && (sum[1] - 36.0).abs() < 1e-9, "{sum:?}");
            let traction = state.nodal_traction(&problem);
            let inner = problem.mesh.nearest_node([8.0, 5.0, 8.0]).unwrap().0;
            assert!((traction[inner][0] + 0.4).abs() < 1e-12, "{:?}", traction[inner]);
            assert!((state.nodal_gap[inner].unwrap() + 0.1).abs() < 1e-12);
        }
    }

    #[test]
    fn nodes_know_how_far_they_are_from_the_nearest_obstacle_where_it_is_now() {
        let mut problem = two_chambers(2.0);
        let curve = Curve::Proportional(1.0);
        let table = |name: &str, z: f64, motion| Obstacle {
            name: name.into(),
            shape: Shape::Plane { point: [0.0, 0.0, z], normal: [0.0, 0.0, 1.0] },
            facets: problem.mesh.facet_set("bottom").to_vec(),
            stiffness: 4.0,
            motion,
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        };
        let rising = Motion { displacement: [0.0, 0.0, 1.0], curve };
        let obstacles = vec![table("still", -2.0, None), table("rising", -5.0, Some(rising))];
        problem.obstacles = obstacles;
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let bottom = problem.mesh.nearest_node([9.0, 4.0, 0.0]).unwrap().0;
        for (time, expected) in [(0.0, 2.0), (3.0, 2.0), (4.0, 1.0), (5.1, -0.1)] {
            let state = evaluate_at(&problem, &zero, LoadParameter(time), &[]).unwrap();
            assert!((state.nodal_gap[bottom].unwrap() - expected).abs() < 1e-12, "{time}");
            // k d, upwards, on the face and so at its nodes.
            let pressure = state.nodal_traction(&problem)[bottom][2];
            assert!((pressure - 4.0 * f64::max(-expected, 0.0)).abs() < 1e-9, "{time}: {pressure}");
        }
    }

    #[test]
    fn no_contact_has_gaps_but_no_forces() {
        let mut problem = two_chambers(2.0);
        problem.contact.method = ContactMethod::None;
        let state = evaluate(&problem, &pushed(&problem)).unwrap();
        assert_eq!((state.points_active, state.area_mm2), (0, 0.0));
        assert!(state.nodal_gap.iter().flatten().all(|gap| (gap + 0.1).abs() < 1e-12 || *gap > -0.1));
    }
}
