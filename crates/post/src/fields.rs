//! The pictures of a state: the body with its stresses, and the walls with their contact.

use std::collections::BTreeSet;

use pneuflex_mesh::Facet;
use pneuflex_model::{LoadParameter, Problem};

use crate::contact::ContactState;
use crate::error::{PostError, check};
use crate::stress::{StressField, von_mises};
use crate::surface_stress::{self, SurfaceState};
use crate::vtu::{Field, Grid};

/// The body in its reference position with `displacement` (mm), `cauchy_stress` and `von_mises` (MPa) at the nodes and
/// the hydrostatic `pressure` (MPa, compression positive) of the elements. `time` is the air pressure in kPa.
///
/// The von Mises stress is that of the tensor at the node, so that it belongs to the stress shown.
///
/// # Errors
/// Displacements of the wrong length or with a number that is not finite.
pub fn body(problem: &Problem, stress: &StressField, state: &SurfaceState<'_>) -> Result<Grid, PostError> {
    let SurfaceState { displacement, parameter: LoadParameter(time), .. } = *state;
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let nodal = surface_stress::nodal(problem, stress, state);
    let fields = vec![
        Field::vector("displacement", displacement.as_flattened().to_vec()),
        Field::scalar("von_mises", nodal.iter().map(|s| von_mises(*s)).collect()),
        Field::symmetric_tensor("cauchy_stress", nodal.as_flattened().to_vec()),
    ];
    let mut grid = at_rest(problem, time, fields);
    grid.cell_data = vec![Field::scalar("pressure", stress.element_pressures())];
    Ok(grid)
}

/// The elements' integration points in their reference position, in the order of the elements, with `cauchy_stress` and `von_mises` (MPa), the
/// largest `stretch` and the `volume` (mm³) at rest that each stands for: what peaks and quantiles are of.
pub fn points(stress: &StressField, time: f64) -> Grid {
    /// Cell type of the VTK file formats.
    const VERTEX: u8 = 1;
    let points = &stress.points;
    let mut grid = Grid { points: points.iter().map(|point| point.position).collect(), time, ..Grid::default() };
    (0..points.len() as u32).for_each(|point| grid.push_cell(VERTEX, [point]));
    let tensors: Vec<[f64; 6]> = points.iter().map(|point| point.stress).collect();
    grid.point_data = vec![
        Field::symmetric_tensor("cauchy_stress", tensors.into_flattened()),
        Field::scalar("von_mises", points.iter().map(|point| point.von_mises).collect()),
        Field::scalar("stretch", points.iter().map(|point| point.stretch).collect()),
        Field::scalar("volume", points.iter().map(|point| point.volume).collect()),
    ];
    grid
}

/// The body in its reference position with the motion `mode` at the nodes, along which it buckles at `time`.
///
/// # Errors
/// A motion of the wrong length or with a number that is not finite.
pub fn mode(problem: &Problem, mode: &[[f64; 3]], time: f64) -> Result<Grid, PostError> {
    check("mode", mode.as_flattened(), problem.num_dofs())?;
    Ok(at_rest(problem, time, vec![Field::vector("mode", mode.as_flattened().to_vec())]))
}

/// The elements of the body in its reference position, with fields at the nodes.
pub fn at_rest(problem: &Problem, time: f64, point_data: Vec<Field>) -> Grid {
    let mesh = &problem.mesh;
    let mut grid = Grid { points: mesh.nodes.clone(), point_data, time, ..Grid::default() };
    for element in 0..mesh.num_elements() {
        grid.push_cell(mesh.kind_of(element).vtk_cell_type, mesh.element(element).iter().copied());
    }
    grid
}

/// A face of [`contact_walls`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactFace {
    /// The face.
    pub facet: Facet,
    /// Number of the gap from 1; 0 for a face that only an obstacle may touch.
    pub gap: usize,
    /// Whether it is the master's.
    pub is_master: bool,
}

/// The faces of [`contact_walls`] in their order: slave and master of every pair, then those of obstacles that are not among them.
pub fn contact_faces(problem: &Problem) -> Vec<ContactFace> {
    let mut faces = Vec::new();
    for (gap, pair) in problem.numbers_of_pairs().into_iter().zip(&problem.contact_pairs) {
        let face = |is_master| move |&facet: &Facet| ContactFace { facet, gap, is_master };
        faces.extend(pair.slave.iter().map(face(false)));
        // A surface that touches itself is there once.
        faces.extend(pair.master.iter().filter(|_| !pair.is_self()).map(face(true)));
    }
    let mut seen: BTreeSet<Facet> = faces.iter().map(|face| face.facet).collect();
    for &facet in problem.obstacles.iter().flat_map(|obstacle| &obstacle.facets) {
        if seen.insert(facet) {
            faces.push(ContactFace { facet, gap: 0, is_master: false });
        }
    }
    faces
}

/// The facing walls of all gaps, and the other faces that may touch an obstacle, in their reference position with `displacement` (mm),
/// `contact_traction` (the traction that the opposite wall or obstacles exert, MPa) and `contact_gap` (signed distance from the opposite
/// wall or the nearest obstacle, mm; negative where they pass through each other) at the nodes, and the number of the `gap` (from 1; 0
/// for faces of no gap) and `side` (0 slave, 1 master) of the faces. `None` if the body has neither.
///
/// # Errors
/// Displacements of the wrong length or with a number that is not finite.
pub fn contact_walls(
    problem: &Problem,
    displacement: &[[f64; 3]],
    contact: &ContactState,
    time: f64,
) -> Result<Option<Grid>, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mesh = &problem.mesh;
    let mut grid = Grid { time, ..Grid::default() };
    let (mut gap, mut side) = (Vec::new(), Vec::new());
    let mut number = vec![u32::MAX; mesh.num_nodes()];
    let mut nodes = Vec::new();
    for face in contact_faces(problem) {
        let local: Vec<u32> = mesh
            .facet_nodes(face.facet)
            .into_iter()
            .map(|node| {
                let n = &mut number[node as usize];
                if *n == u32::MAX {
                    *n = nodes.len() as u32;
                    nodes.push(node as usize);
                }
                *n
            })
            .collect();
        grid.push_cell(mesh.face_kind(face.facet).vtk_cell_type, local);
        gap.push(face.gap as f64);
        side.push(f64::from(u8::from(face.is_master)));
    }
    if nodes.is_empty() {
        return Ok(None);
    }
    let traction = contact.nodal_traction(problem);
    let gaps: Vec<f64> = nodes.iter().map(|&n| contact.nodal_gap[n].unwrap_or(0.0)).collect();
    grid.points = nodes.iter().map(|&n| mesh.nodes[n]).collect();
    grid.point_data = vec![
        Field::vector("displacement", nodes.iter().flat_map(|&n| displacement[n]).collect()),
        Field::vector("contact_traction", nodes.iter().flat_map(|&n| traction[n]).collect()),
        Field::scalar("contact_gap", gaps),
    ];
    grid.cell_data = vec![Field::scalar("gap", gap), Field::scalar("side", side)];
    Ok(Some(grid))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};
    use crate::{contact, stress};
    use pneuflex_model::{Obstacle, Shape};

    #[test]
    fn grids_hold_the_whole_body_and_both_walls() {
        let problem = two_chambers(2.0);
        let u = displacement_of(&problem, |x| [if x[0] <= 8.0 { 2.1 } else { 0.0 } * x[2] / 13.0, 0.0, 0.0]);
        let stress = stress::recover(&problem, &u).unwrap();
        let contact = contact::evaluate(&problem, &u).unwrap();
        let state = SurfaceState { displacement: &u, parameter: LoadParameter(5.0), pressures: &[], contact: &contact };
        let grid = body(&problem, &stress, &state).unwrap();
        assert_eq!((grid.points.len(), grid.cell_types.len()), (problem.mesh.num_nodes(), problem.mesh.num_elements()));
        grid.to_vtu().unwrap();
        let walls = contact_walls(&problem, &u, &contact, 5.0).unwrap().unwrap();
        let pair = &problem.contact_pairs[0];
        assert_eq!(walls.cell_types.len(), pair.slave.len() + pair.master.len());
        walls.to_vtu().unwrap();
    }

    #[test]
    fn faces_of_obstacles_are_there_once_with_what_obstacles_do_to_them() {
        let mut problem = two_chambers(2.0);
        let of_pairs = contact_faces(&problem).len();
        let bottom = problem.mesh.facet_set("bottom").to_vec();
        let shape = Shape::Plane { point: [0.0, 0.0, 0.1], normal: [0.0, 0.0, 1.0] };
        let mut table = Obstacle {
            name: "a".into(),
            shape,
            facets: bottom.clone(),
            stiffness: 4.0,
            motion: None,
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        };
        problem.obstacles.push(table.clone());
        table.facets.push(problem.contact_pairs[0].slave[0]);
        problem.obstacles.push(Obstacle { name: "b".into(), ..table });
        assert_eq!(contact_faces(&problem).len(), of_pairs + bottom.len());
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let contact = contact::evaluate(&problem, &zero).unwrap();
        let walls = contact_walls(&problem, &zero, &contact, 5.0).unwrap().unwrap();
        let inner = walls.points.iter().position(|x| x[2] == 0.0 && x[0] > 1.0 && x[0] < 17.0).unwrap();
        // Two of them press with 0.1 mm × 4 N/mm³ each.
        let traction = walls.point_values("contact_traction").unwrap()[3 * inner + 2];
        let gap = walls.point_values("contact_gap").unwrap()[inner];
        assert!((traction - 0.8).abs() < 1e-9 && (gap + 0.1).abs() < 1e-12, "{traction} {gap}");
    }
}
