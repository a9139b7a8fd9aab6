//! The search without boxes, tree, order, slabs and cones: the permanent check of the one that has them.

use crate::model::ContactModel;
use crate::projection::{EDGE_TOLERANCE, EXTENSION, Projection, project, unit_normal};
use crate::self_contact::{SlavePoint, are_neighbours, blocks, counts, covers};
use crate::surface::Surface;

/// A point that touches, as [`feet`] finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Slave face.
    pub slave_face: usize,
    /// Number of the point among all points of the model.
    pub number: usize,
    /// Master face.
    pub master_face: usize,
    /// Foot on it.
    pub projection: Projection,
}

/// The touching points of a surface pair of multiple-point contact without multipliers, by looking at every face for every point.
pub fn feet(model: &ContactModel, surface_pair: usize, positions: &[[f64; 3]]) -> Vec<Foot> {
    let surface_pair = model.surface_pair(surface_pair);
    let (slave, master) = (&surface_pair.slave, &surface_pair.master);
    let on = |surface: &Surface, face: usize, xi, at: &[[f64; 3]]| surface.geometry(face, xi, at);
    let mut found = Vec::new();
    for slave_face in 0..slave.num_faces() {
        for (index, &(xi, _)) in surface_pair.points.rule(slave.kind(slave_face)).iter().enumerate() {
            let [now, at_rest] = [positions, model.rest()].map(|at| on(slave, slave_face, xi, at));
            let point = SlavePoint {
                at_rest: at_rest.position,
                normal_at_rest: unit_normal(&at_rest.tangents).0,
                normal: unit_normal(&now.tangents).0,
            };
            let is_another = |m: usize| !surface_pair.is_self_contact || slave.face(slave_face) != master.face(m);
            let is_neighbour = |m: usize| are_neighbours(slave.face(slave_face), master.face(m));
            let foot_on = |m: usize| {
                let kind = master.kind(m);
                let nodes = &master.face_positions(m, positions)[..kind.num_nodes()];
                project(kind, nodes, now.position).map(|foot| (m, foot))
            };
            let all: Vec<(usize, Projection)> =
                (0..master.num_faces()).filter(|&m| is_another(m)).filter_map(foot_on).collect();
            let is_outside = |foot: &Projection| foot.excess > EDGE_TOLERANCE;
            // Rule 5 looks at the neighbours of the point's face, too.
            let is_covered = |face: usize| {
                (0..master.num_faces())
                    .filter(|&m| m != face && are_neighbours(master.face(face), master.face(m)))
                    .any(|m| foot_on(m).is_some_and(|(_, foot)| covers(&foot, surface_pair.reach)))
            };
            let nearest = (all.iter())
                .filter(|(_, foot)| foot.excess <= EXTENSION)
                .filter(|(m, foot)| {
                    !surface_pair.is_self_contact
                        || counts(&point, foot, on(master, *m, foot.xi, model.rest()).position, is_neighbour(*m))
                            && !(is_outside(foot) && is_covered(*m))
                })
                .min_by(|(_, a), (_, b)| {
                    (is_outside(a).cmp(&is_outside(b))).then(a.distance.abs().total_cmp(&b.distance.abs()))
                });
            let Some(&(master_face, projection)) = nearest else { continue };
            let depth = -projection.distance;
            let is_far_side = surface_pair.is_self_contact
                && all.iter().any(|(m, foot)| !is_neighbour(*m) && blocks(point.normal, foot, depth));
            if depth > 0.0 && depth <= surface_pair.reach && !is_far_side {
                let number = surface_pair.first_point + surface_pair.points.of_face(slave_face).start + index;
                found.push(Foot { slave_face, number, master_face, projection });
            }
        }
    }
    found
}
