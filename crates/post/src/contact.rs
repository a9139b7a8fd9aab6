//! What the contact's own points carry: how many, over which area, and the tractions on both walls.

use pneuflex_contact::{ContactModel, evaluate_block};
use pneuflex_mesh::quadrature;
use pneuflex_model::{ContactPair, Problem};

use crate::error::{PostError, check};
use crate::search::Surface;
use crate::surface::Patch;
use crate::vector::norm;

/// The contact of one state, from the points of the chosen method (theory §5).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactState {
    /// Points with a negative distance.
    pub points_active: usize,
    /// Reference area these points stand for, mm².
    pub area_mm2: f64,
    /// Energy of the penalty, ½ k Σ wᵢ dᵢ² over these points, mJ.
    pub penalty_energy_mj: f64,
    /// Force of the contact on every facet of every pair's slave and master wall, N.
    pub facet_force: Vec<[Vec<[f64; 3]>; 2]>,
    /// Signed distance of every node of the walls from the opposite wall, mm; `None` away from the walls.
    pub nodal_gap: Vec<Option<f64>>,
}

/// Evaluates the contact of a state.
///
/// `displacement` has three entries per node, mm.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn evaluate(problem: &Problem, displacement: &[f64]) -> Result<ContactState, PostError> {
    check("displacement", displacement, problem.num_dofs())?;
    let mut state = ContactState {
        points_active: 0,
        area_mm2: 0.0,
        penalty_energy_mj: 0.0,
        facet_force: (problem.contact_pairs.iter())
            .map(|pair| [&pair.slave, &pair.master].map(|wall| vec![[0.0; 3]; wall.len()]))
            .collect(),
        nodal_gap: vec![None; problem.mesh.num_nodes()],
    };
    for pair in &problem.contact_pairs {
        gaps(problem, pair, displacement, &mut state);
    }
    let model = ContactModel::new(&problem.mesh, &problem.contact_pairs, &problem.contact);
    let positions: Vec<[f64; 3]> = (problem.mesh.nodes.iter().zip(displacement.chunks(3)))
        .map(|(x, u)| std::array::from_fn(|d| x[d] + u[d]))
        .collect();
    for block in model.search(&positions) {
        state.points_active += block.points.len();
        state.area_mm2 += block.points.iter().map(|p| p.area).sum::<f64>();
        let evaluated = evaluate_block(&model, &block, &positions, false);
        state.penalty_energy_mj += evaluated.energy;
        // The force is the negative gradient of the contact's energy.
        let gradient = evaluated.residual;
        let per_face = gradient.len() / 2;
        for (side, face) in [block.slave_face, block.master_face].into_iter().enumerate() {
            let force = &mut state.facet_force[block.pair][side][face];
            for g in gradient[side * per_face..(side + 1) * per_face].chunks(3) {
                for d in 0..3 {
                    force[d] -= g[d];
                }
            }
        }
    }
    Ok(state)
}

fn gaps(problem: &Problem, pair: &ContactPair, displacement: &[f64], state: &mut ContactState) {
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
        let rule = quadrature::face(problem.mesh.face_kind());
        let mut traction = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let mut area = vec![0.0; problem.mesh.num_nodes()];
        for (pair, forces) in problem.contact_pairs.iter().zip(&self.facet_force) {
            for (wall, forces) in [&pair.slave, &pair.master].into_iter().zip(forces) {
                for (&facet, force) in wall.iter().zip(forces) {
                    let patch = Patch::new(&problem.mesh, facet, None);
                    let face: f64 = rule.iter().map(|&(xi, w)| w * norm(patch.at(xi).area_vector)).sum();
                    for node in problem.mesh.facet_nodes(facet) {
                        area[node as usize] += face;
                        for d in 0..3 {
                            traction[node as usize][d] += force[d];
                        }
                    }
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
    use pneuflex_model::ContactMethod;

    fn pushed(problem: &Problem) -> Vec<f64> {
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
    fn no_contact_has_gaps_but_no_forces() {
        let mut problem = two_chambers(2.0);
        problem.contact.method = ContactMethod::None;
        let state = evaluate(&problem, &pushed(&problem)).unwrap();
        assert_eq!((state.points_active, state.area_mm2), (0, 0.0));
        assert!(state.nodal_gap.iter().flatten().all(|gap| (gap + 0.1).abs() < 1e-12 || *gap > -0.1));
    }
}
