//! The fields at one pressure or time.

use pneuflex_model::Problem;
use pneuflex_post::fields::contact_faces;
use pneuflex_post::vtu::Grid;

use crate::error::ReportError;

/// Fields at the nodes of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Time of the load path: the air pressure in kPa of an actuator.
    pub time: f64,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// von Mises stress, MPa.
    pub von_mises: Vec<f64>,
    /// Cauchy stress, MPa: xx, yy, zz, xy, yz, xz.
    pub stress: Vec<[f64; 6]>,
    /// Length of the traction that the opposite wall and obstacles exert, MPa; zero elsewhere.
    pub contact_pressure: Vec<f64>,
}

impl State {
    /// The fields in the files of one step: the body's, and the contact walls' if there are any (see
    /// [`pneuflex_post::fields`]).
    ///
    /// # Errors
    /// Grids of another mesh, missing fields, fields of another kind, numbers that are not finite.
    pub fn from_grids(problem: &Problem, body: &Grid, walls: Option<&Grid>) -> Result<Self, ReportError> {
        let nodes = &problem.mesh.nodes;
        fits("the grid of points", nodes, &body.points)?;
        if !body.time.is_finite() {
            return Err(ReportError::NotFinite("TimeValue".into()));
        }
        let mut state = Self {
            time: body.time,
            displacement: field(body, "displacement", 3)?.as_chunks().0.to_vec(),
            von_mises: field(body, "von_mises", 1)?,
            stress: field(body, "cauchy_stress", 6)?.as_chunks().0.to_vec(),
            contact_pressure: vec![0.0; nodes.len()],
        };
        if let Some(walls) = walls {
            let wall_nodes = wall_nodes(problem);
            let expected: Vec<[f64; 3]> = wall_nodes.iter().map(|&n| nodes[n as usize]).collect();
            fits("the grid of the contact walls", &expected, &walls.points)?;
            let traction = field(walls, "contact_traction", 3)?;
            for (&node, t) in wall_nodes.iter().zip(traction.chunks(3)) {
                state.contact_pressure[node as usize] = t.iter().map(|x| x * x).sum::<f64>().sqrt();
            }
        }
        Ok(state)
    }
}

/// Nodes of the contact walls in the order of their file: by the faces in which they appear first.
fn wall_nodes(problem: &Problem) -> Vec<u32> {
    let mut seen = vec![false; problem.mesh.num_nodes()];
    let nodes = contact_faces(problem).into_iter().flat_map(|face| problem.mesh.facet_nodes(face.facet));
    nodes.filter(|&n| !std::mem::replace(&mut seen[n as usize], true)).collect()
}

fn fits(what: &str, expected: &[[f64; 3]], found: &[[f64; 3]]) -> Result<(), ReportError> {
    let error = |expected: String, found: String| Err(ReportError::OtherMesh { what: what.into(), expected, found });
    if expected.len() != found.len() {
        return error(format!("{} nodes", expected.len()), format!("{} nodes", found.len()));
    }
    // The mesh is built from the decimal numbers of case.toml again: equal but for rounding.
    let is_same = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-9);
    match expected.iter().zip(found).find(|(a, b)| !is_same(a, b)) {
        Some((a, b)) => error(format!("a node at {a:?} mm"), format!("one at {b:?} mm")),
        None => Ok(()),
    }
}

/// A field with so many numbers at every point.
fn field(grid: &Grid, name: &str, components: usize) -> Result<Vec<f64>, ReportError> {
    let values = grid.point_values(name).ok_or_else(|| ReportError::MissingField(name.into()))?;
    let (expected, found) = (components * grid.points.len(), values.len());
    if found != expected {
        return Err(ReportError::OtherKind { name: name.into(), expected, found });
    }
    if values.iter().all(|x| x.is_finite()) { Ok(values.to_vec()) } else { Err(ReportError::NotFinite(name.into())) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displaced, two_chambers};
    use pneuflex_model::{Formulation, LoadParameter};
    use pneuflex_post::surface_stress::SurfaceState;
    use pneuflex_post::{contact, fields, stress};

    #[test]
    fn fields_come_back_at_their_nodes_and_foreign_ones_are_refused() {
        let problem = two_chambers(Formulation::Hex8Sri);
        // The first chamber leans onto the second.
        let u = displaced(&problem, |x| [if x[0] <= 8.0 { 2.1 } else { 0.0 } * x[2] / 13.0, 0.0, 0.0]);
        let (stress, contact) = (stress::recover(&problem, &u).unwrap(), contact::evaluate(&problem, &u).unwrap());
        let body = fields::body(
            &problem,
            &stress,
            &SurfaceState { displacement: &u, parameter: LoadParameter(5.0), pressures: &[], contact: &contact },
        )
        .unwrap();
        let walls = fields::contact_walls(&problem, &u, &contact, 5.0).unwrap().unwrap();
        let state = State::from_grids(&problem, &body, Some(&walls)).unwrap();
        assert_eq!((&state.displacement, state.time), (&u, 5.0));
        let pressed: Vec<usize> =
            (0..state.contact_pressure.len()).filter(|&n| state.contact_pressure[n] > 0.0).collect();
        assert!(!pressed.is_empty());
        for node in pressed {
            let x = problem.mesh.nodes[node];
            assert!(x[0] == 8.0 || x[0] == 10.0, "{x:?} is on no wall of the gap");
        }

        let other = two_chambers(Formulation::Hex27);
        let message = State::from_grids(&other, &body, None).unwrap_err().to_string();
        assert!(message.contains("does not fit the mesh"), "{message}");
        let mut moved = body.clone();
        moved.points[3][0] += 0.5;
        assert!(State::from_grids(&problem, &moved, None).unwrap_err().to_string().contains("a node at"));
        let mut without = body;
        without.point_data.remove(1);
        let missing = ReportError::MissingField("von_mises".into());
        assert_eq!(State::from_grids(&problem, &without, None).unwrap_err(), missing);
    }

    /// Fields with as many numbers as their own attributes say, but not as many as a displacement or a stress has.
    #[test]
    fn fields_of_another_kind_and_times_that_are_no_numbers_are_refused() {
        let problem = two_chambers(Formulation::Hex8Sri);
        let u = displaced(&problem, |x| [if x[0] <= 8.0 { 2.1 } else { 0.0 } * x[2] / 13.0, 0.0, 0.0]);
        let (stress, contact) = (stress::recover(&problem, &u).unwrap(), contact::evaluate(&problem, &u).unwrap());
        let body = fields::body(
            &problem,
            &stress,
            &SurfaceState { displacement: &u, parameter: LoadParameter(5.0), pressures: &[], contact: &contact },
        )
        .unwrap();
        let walls = fields::contact_walls(&problem, &u, &contact, 5.0).unwrap().unwrap();
        let refused = |body: &Grid, walls: &Grid, what: &str| {
            let message = State::from_grids(&problem, body, Some(walls)).unwrap_err().to_string();
            assert!(message.contains(what), "{message}");
        };
        for name in ["displacement", "von_mises", "contact_traction"] {
            let (mut body, mut walls) = (body.clone(), walls.clone());
            for grid in [&mut body, &mut walls] {
                let points = grid.points.len();
                for field in grid.point_data.iter_mut().filter(|field| field.name == name) {
                    let is_scalar = field.components.is_empty();
                    field.components = if is_scalar { ["X", "Y"].map(str::to_owned).into() } else { Vec::new() };
                    field.values = vec![1.0; points * field.components.len().max(1)];
                }
            }
            refused(&body, &walls, name);
        }
        for time in [f64::NAN, f64::INFINITY] {
            refused(&Grid { time, ..body.clone() }, &walls, "not finite");
        }
        let mut moved = body.clone();
        moved.points[3][0] = f64::NAN;
        refused(&moved, &walls, "a node at");
    }
}
