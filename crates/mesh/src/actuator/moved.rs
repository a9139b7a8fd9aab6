//! The nodes of an actuator's mesh where other lengths put them: its elements stay what they are.

use super::lengths::Actuator;
use super::planes::Cuts;
use super::ranges::GeometryError;
use super::row::Row;
use crate::grading::Interval;
use crate::mesh::Mesh;

/// Why a mesh cannot follow to other lengths.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotMovable {
    /// Lengths that make no body.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Two planes of the body become one, or one becomes two.
    #[error(
        "the mesh has one layer of nodes for planes that part, along {axis}: another length puts a plane at the same place"
    )]
    Planes {
        /// The axis normal to the planes: x, y or z.
        axis: char,
    },
}

impl Actuator {
    /// The mesh of this actuator, made with `cuts`, with its nodes where the lengths of `other` put them: between the planes in which the
    /// shape of the body changes they move evenly. Nodes, elements and sets keep their numbers. (A mesh of its own would have other numbers
    /// of elements here and there, and results that jump.)
    ///
    /// # Errors
    /// [`NotMovable`] where the two bodies are not divided alike.
    pub fn mesh_moved_to(&self, other: &Self, cuts: &Cuts, mesh: &Mesh) -> Result<Mesh, NotMovable> {
        other.validate()?;
        let [from, to] = [self, other].map(|actuator| Row::of(actuator).intervals(cuts));
        for (axis, (from, to)) in ['x', 'y', 'z'].into_iter().zip(from.iter().zip(&to)) {
            let kind = |interval: &Interval| (interval.is_wall, interval.edges);
            if !from.iter().map(kind).eq(to.iter().map(kind)) {
                return Err(NotMovable::Planes { axis });
            }
        }
        Ok(mesh.clone().map_nodes(|x| std::array::from_fn(|d| moved(x[d], &from[d], &to[d]))))
    }
}

/// A coordinate that keeps its share of its interval.
fn moved(x: f64, from: &[Interval], to: &[Interval]) -> f64 {
    let place = from.partition_point(|interval| interval.end < x).min(from.len() - 1);
    let (from, to) = (&from[place], &to[place]);
    // The ends themselves without rounding: they are the planes of the body.
    if x == from.end {
        return to.end;
    }
    to.start + (x - from.start) / (from.end - from.start) * (to.end - to.start)
}
