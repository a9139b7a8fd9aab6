//! What touches, followed to other positions or to a model with other numbers: for derivatives, in which nothing begins or ceases to touch.
//!
//! The energy ½ k w ⟨−d⟩² has a continuous derivative, but the force of a point that comes into contact has a corner. Its derivative on the
//! side where the point touches is that of −k w d without the brackets, for the points that touch and for no others.

use pneuflex_mesh::shape;
use pneuflex_model::ContactMethod;

use crate::contact_block::{ContactBlock, ContactPoint, Partner};
use crate::model::ContactModel;
use crate::potential::{distance_gradient, evaluate_block};
use crate::projection::{cross, dot, project, sub, unit_normal};
use crate::touching::Touching;

impl ContactModel {
    /// The points of `touching`, each on the same face of this model, at other positions of the nodes (mm), whatever their distance; `None` where
    /// one has no foot there any more. Averaged gaps are left out.
    pub fn following(&self, touching: &Touching, positions: &[[f64; 3]]) -> Option<Vec<ContactBlock>> {
        let blocks = touching.blocks.iter();
        blocks
            .map(|block| {
                let points = block.points.iter().map(|point| self.following_point(block, point, positions));
                Some(ContactBlock { points: points.collect::<Option<_>>()?, ..block.clone() })
            })
            .collect()
    }

    /// Slope of m·r of a block's forces r by the positions of its nodes at rest, displacements staying what they are; `multipliers` are m, one
    /// entry per node of the block. The faces move with the positions, and the areas at rest that points stand for change.
    pub fn shape_slope(&self, block: &ContactBlock, positions: &[[f64; 3]], multipliers: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let m = multipliers.as_flattened();
        let tangent = evaluate_block(self, block, positions, true).tangent;
        let along = |row: &[f64]| row.iter().zip(m).map(|(k, m)| k * m).sum::<f64>();
        let mut slope: Vec<[f64; 3]> =
            tangent.chunks_exact(m.len()).map(along).collect::<Vec<f64>>().as_chunks().0.to_vec();
        let slave = self.slave(block.partner);
        for point in &block.points {
            let gradient = distance_gradient(self, block, point, positions);
            let work: f64 = gradient.iter().zip(m).map(|(d, m)| d * m).sum();
            let work = point.stiffness * point.area * (point.distance - point.shift) * work;
            let rest = slave.geometry(block.slave_face, point.slave_xi, self.rest()).tangents;
            let (normal, length) = unit_normal(&rest);
            let by_tangents = [cross(rest[1], normal), cross(normal, rest[0])];
            let shape = shape::evaluate_face(slave.kind(block.slave_face), point.slave_xi);
            for (slope, gradient) in slope.iter_mut().zip(&shape.gradients[..slave.kind(block.slave_face).num_nodes()])
            {
                for k in 0..3 {
                    slope[k] += work / length * (gradient[0] * by_tangents[0][k] + gradient[1] * by_tangents[1][k]);
                }
            }
        }
        slope
    }

    fn following_point(
        &self,
        block: &ContactBlock,
        point: &ContactPoint,
        positions: &[[f64; 3]],
    ) -> Option<ContactPoint> {
        let at = self.slave(block.partner).geometry(block.slave_face, point.slave_xi, positions).position;
        match block.partner {
            Partner::Face { surface_pair, face } => {
                let pair = self.surface_pairs.get(surface_pair)?;
                let area = *pair.points.areas.get(point.number - pair.first_point)?;
                let (master_xi, distance) = if pair.method == ContactMethod::SinglePoint {
                    let master = pair.master.geometry(face, point.master_xi, positions);
                    (point.master_xi, dot(sub(at, master.position), unit_normal(&master.tangents).0))
                } else {
                    let kind = pair.master.kind(face);
                    let nodes = pair.master.face_positions(face, positions);
                    let foot = project(kind, &nodes[..kind.num_nodes()], at)?;
                    (foot.xi, foot.distance)
                };
                Some(ContactPoint { area, master_xi, distance, ..*point }.with_penalty(pair.stiffness))
            }
            Partner::Obstacle(number) => {
                let rigid = self.obstacles.get(number)?;
                let area = *rigid.points.areas.get(point.number - rigid.first_point)?;
                let distance = self.distance_to_obstacle(number, at).value;
                Some(ContactPoint { area, distance, ..*point }.with_penalty(rigid.obstacle.stiffness))
            }
        }
    }
}
