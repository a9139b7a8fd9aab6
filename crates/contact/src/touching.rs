//! All that touches at some positions.

use std::ops::Range;

use crate::average_gap::{AverageGap, carry};
use crate::contact_block::ContactBlock;
use crate::model::ContactModel;

/// All that touches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touching {
    /// Touching points by faces.
    pub blocks: Vec<ContactBlock>,
    /// Corners whose gaps are closed on the mean, in the order of their numbers; none without averaged contact.
    pub averages: Vec<AverageGap>,
}

impl Touching {
    /// Number of points and corners that are kept apart.
    pub fn num_active(&self, model: &ContactModel) -> usize {
        let own = self.blocks.iter().filter(|block| model.averaging(block.partner).is_none());
        own.map(|block| block.points.len()).sum::<usize>() + self.averages.len()
    }

    /// Traction and distance of every point and corner that is kept apart, with its number: λ − k d (MPa), d (mm).
    pub fn tractions<'a>(&'a self, model: &'a ContactModel) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
        let own = self.blocks.iter().filter(|block| model.averaging(block.partner).is_none());
        let of_points = own.flat_map(|block| &block.points).map(|point| (point.number, point.traction, point.distance));
        of_points.chain(self.averages.iter().map(|gap| (gap.number, gap.traction, gap.distance)))
    }

    /// Numbers, surface pairs first, of the surfaces and obstacles of which nothing touches, although the linear system predicts tractions there
    /// (MPa, one entry per point or corner of the model): without any contact a soft body swings away.
    pub fn let_go(&self, model: &ContactModel, tractions: &[f64]) -> Vec<usize> {
        let mut touches = vec![false; tractions.len()];
        self.tractions(model).for_each(|(point, ..)| touches[point] = true);
        let is_let_go = |points: Range<usize>| {
            points.clone().any(|point| tractions[point] > 0.0) && !points.clone().any(|point| touches[point])
        };
        let all = model.partners().enumerate();
        all.filter(|(_, (points, _))| is_let_go(points.clone())).map(|(number, _)| number).collect()
    }

    /// Tractions (MPa, one entry per point or corner of the model) take the place of their own in the tangent's geometric term.
    pub fn carry(&mut self, model: &ContactModel, tractions: &[f64]) {
        for block in &mut self.blocks {
            match model.averaging(block.partner) {
                Some((averaging, first)) => carry(averaging, first, block, tractions),
                None => block.points.iter_mut().for_each(|point| point.carried = tractions[point.number]),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::lattice::Lattice;
    use pneuflex_model::{Formulation, Law, Obstacle, Problem, Shape};

    use super::*;

    /// A cube of shear modulus 1 above a table whose penalty is four times as stiff as it.
    fn above(gap: f64) -> ContactModel {
        let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [1; 3]).mesh_all(Formulation::Hex8Q1p0.element_kind());
        let facets = mesh.select_facets(|x| x[2] < 1e-9);
        let stiffness = 4.0 / mesh.mean_node_spacing();
        let mut problem = Problem::body(mesh, Formulation::Hex8Q1p0, Law::NeoHooke { c10: 0.5 }.into());
        problem.obstacles = vec![Obstacle {
            name: "table".into(),
            shape: Shape::Plane { point: [0.0, 0.0, -gap], normal: [0.0, 0.0, 1.0] },
            facets,
            stiffness,
            motion: None,
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        }];
        ContactModel::of(&problem)
    }

    #[test]
    fn what_is_let_go_of_altogether_is_kept_under_a_soft_penalty_too() {
        let model = above(0.01);
        let tractions = vec![0.04; model.num_points()];
        let found = model.search(model.rest());
        assert_eq!(found.num_active(&model), 0);
        assert_eq!(found.let_go(&model, &tractions), [0]);
        assert!(model.kept_distances(&tractions, &[]).iter().all(|&kept| kept == 0.0));
        // t/c − t/k with c = 1/h and k = 4/h.
        let kept = model.kept_distances(&tractions, &[0]);
        let expected = 0.03 * model.mesh.mean_node_spacing();
        assert!(kept.iter().all(|&kept| (kept - expected).abs() < 1e-12 && kept > 0.01), "{kept:?}");
        let kept = model.search_keeping(model.rest(), &kept);
        assert_eq!(kept.num_active(&model), tractions.len());
        // Where no traction is predicted, and where something touches.
        assert!(found.let_go(&model, &vec![0.0; tractions.len()]).is_empty());
        let touching = above(-0.01);
        assert!(touching.search(touching.rest()).let_go(&touching, &tractions).is_empty());
    }
}
