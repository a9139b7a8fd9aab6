//! What the contact's own points carry: how many, over which area, and the tractions on both walls.

use pneuflex_mesh::quadrature;
use pneuflex_model::{ContactMethod, ContactPair, Problem};

use crate::error::{PostError, check};
use crate::search::Surface;
use crate::surface::Patch;
use crate::vector::{Vec3, dot, norm, sub};

/// The contact of one state, from the points of the chosen method (theory §5).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactState {
    /// Points with a negative distance.
    pub points_active: usize,
    /// Reference area these points stand for, mm².
    pub area_mm2: f64,
    /// Force of the contact on every node, N.
    pub nodal_force: Vec<[f64; 3]>,
    /// Signed distance of every node of the walls from the opposite wall, mm; `None` away from the walls.
    pub nodal_gap: Vec<Option<f64>>,
}

/// A contact point that carries traction.
struct Active {
    /// Reference area, mm².
    area: f64,
    /// Unit normal of the master.
    normal: Vec3,
    /// Depth δ, mm.
    depth: f64,
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
        nodal_force: vec![[0.0; 3]; problem.mesh.num_nodes()],
        nodal_gap: vec![None; problem.mesh.num_nodes()],
    };
    for pair in &problem.contact_pairs {
        gaps(problem, pair, displacement, &mut state);
        match problem.contact.method {
            ContactMethod::None => {}
            ContactMethod::SinglePoint => single_point(problem, pair, displacement, &mut state),
            ContactMethod::MultiPoint => multi_point(problem, pair, displacement, &mut state),
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

fn single_point(problem: &Problem, pair: &ContactPair, displacement: &[f64], state: &mut ContactState) {
    let centre = problem.mesh.face_kind().centre();
    for (&slave, &master) in pair.slave.iter().zip(&pair.master) {
        let reference = Patch::new(&problem.mesh, slave, None);
        let [here, there] = [slave, master].map(|f| Patch::new(&problem.mesh, f, Some(displacement)).at(centre));
        let length = norm(there.area_vector);
        let normal = there.area_vector.map(|x| x / length);
        let depth = -dot(sub(here.position, there.position), normal);
        if depth > 0.0 {
            let area = quadrature::face(problem.mesh.face_kind())
                .into_iter()
                .map(|(xi, w)| w * norm(reference.at(xi).area_vector))
                .sum();
            let faces = [(slave, centre), (master, centre)];
            state.add(problem, faces, &Active { area, normal, depth });
        }
    }
}

fn multi_point(problem: &Problem, pair: &ContactPair, displacement: &[f64], state: &mut ContactState) {
    let surface = Surface::new(problem, &pair.master, displacement);
    let rule = quadrature::contact_face(problem.mesh.face_kind());
    let mut hint = None;
    for &facet in &pair.slave {
        let reference = Patch::new(&problem.mesh, facet, None);
        let patch = Patch::new(&problem.mesh, facet, Some(displacement));
        for &(xi, weight) in &rule {
            let Some(closest) = surface.closest(patch.at(xi).position, hint) else { continue };
            hint = Some(closest.facet);
            if closest.signed_distance < 0.0 {
                let on_master = closest.projection.xi;
                let vector = surface.patch(closest.facet).at(on_master).area_vector;
                let length = norm(vector);
                let active = Active {
                    area: weight * norm(reference.at(xi).area_vector),
                    normal: vector.map(|x| x / length),
                    depth: -closest.projection.normal_distance,
                };
                let faces = [(facet, xi), (pair.master[closest.facet], on_master)];
                state.add(problem, faces, &active);
            }
        }
    }
}

impl ContactState {
    /// Adds a point: k δ along the master's normal on the slave (first of `faces`), the opposite on the master.
    fn add(&mut self, problem: &Problem, faces: [(pneuflex_mesh::Facet, [f64; 2]); 2], active: &Active) {
        self.points_active += 1;
        self.area_mm2 += active.area;
        let force = problem.contact.stiffness * active.depth * active.area;
        for ((facet, xi), sign) in faces.into_iter().zip([1.0, -1.0]) {
            let shape = pneuflex_mesh::shape::evaluate_face(problem.mesh.face_kind(), xi);
            for (value, node) in shape.values.iter().zip(problem.mesh.facet_nodes(facet)) {
                for d in 0..3 {
                    self.nodal_force[node as usize][d] += sign * value * force * active.normal[d];
                }
            }
        }
    }

    /// Contact traction at every node, MPa: the nodal force over the reference area of the walls around the node.
    pub fn nodal_traction(&self, problem: &Problem) -> Vec<[f64; 3]> {
        let kind = problem.mesh.face_kind();
        let mut area = vec![0.0; problem.mesh.num_nodes()];
        for pair in &problem.contact_pairs {
            for &facet in pair.slave.iter().chain(&pair.master) {
                let nodes = problem.mesh.facet_nodes(facet);
                let patch = Patch::new(&problem.mesh, facet, None);
                let face: f64 =
                    quadrature::face(kind).into_iter().map(|(xi, w)| w * norm(patch.at(xi).area_vector)).sum();
                // Equal shares: the corners of a serendipity face have a negative integral, useless as an area.
                for &node in &nodes {
                    area[node as usize] += face / nodes.len() as f64;
                }
            }
        }
        let divide = |(force, area): (&[f64; 3], &f64)| if *area > 0.0 { force.map(|f| f / area) } else { [0.0; 3] };
        self.nodal_force.iter().zip(&area).map(divide).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};

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
            let mut sum = [0.0; 2];
            for (node, force) in problem.mesh.nodes.iter().zip(&state.nodal_force) {
                sum[usize::from(node[0] > 9.0)] += force[0];
                assert!(force[1].abs() + force[2].abs() < 1e-12);
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
