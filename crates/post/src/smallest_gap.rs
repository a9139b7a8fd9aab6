//! A smooth measure of the smallest gap between walls.
//!
//! With the signed distances dᵢ of the contact's points from the walls opposite, d = −w ln Σ exp(−dᵢ/w): at most the smallest of them, and less by
//! w ln n where n points are as near. A limit to it is safe. Points that are more than some w further away than the nearest one do not count.

use pneuflex_contact::{ContactBlock, ContactModel, Partner, Touching, distance_gradient};
use pneuflex_model::Problem;

use crate::error::{PostError, check};

/// Points count up to so many widths beyond the nearest one: what is left out is e⁻³⁰ of it.
const MOST_WIDTHS: f64 = 30.0;

/// The points between walls that are nearest in a state, to be followed to states and problems near by.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallestGap {
    touching: Touching,
    width: f64,
}

impl SmallestGap {
    /// The points in a state; `None` where no walls face each other within reach, or gaps are averaged. `width` is w, `displacement` has one entry per
    /// node, mm.
    pub fn at(problem: &Problem, displacement: &[[f64; 3]], width: f64) -> Option<Self> {
        let model = ContactModel::of(problem);
        // As far as walls are looked for at all.
        let reach = model.surface_pairs().iter().map(|pair| pair.reach.max(pair.rest_distance)).fold(0.0, f64::max);
        let kept = vec![2.0 * reach; model.num_points()];
        let mut touching = model.search_keeping(&problem.mesh.deformed(displacement), &kept);
        let is_of_walls = |block: &ContactBlock| {
            matches!(block.partner, Partner::Face { .. }) && model.averaging(block.partner).is_none()
        };
        touching.blocks.retain(is_of_walls);
        let distances = touching.blocks.iter().flat_map(|block| &block.points).map(|point| point.distance);
        let nearest = distances.reduce(f64::min)?;
        for block in &mut touching.blocks {
            block.points.retain(|point| point.distance <= nearest + MOST_WIDTHS * width);
        }
        touching.blocks.retain(|block| !block.points.is_empty());
        Some(Self { touching, width })
    }

    /// Its value in a problem with as many faces at displacements, mm.
    ///
    /// # Errors
    /// A list of the wrong length or with a number that is not finite; a point that has no foot on its face any more.
    pub fn value(&self, problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, PostError> {
        let positions = problem.mesh.deformed(displacement);
        Ok(self.of(&self.followed(problem, &ContactModel::of(problem), displacement, &positions)?).0)
    }

    /// Its slope by the displacements, one entry per node.
    ///
    /// # Errors
    /// As [`Self::value`].
    pub fn gradient(&self, problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PostError> {
        let (model, positions) = (ContactModel::of(problem), problem.mesh.deformed(displacement));
        let blocks = self.followed(problem, &model, displacement, &positions)?;
        let mut weights = self.of(&blocks).1.into_iter();
        let mut gradient = vec![[0.0; 3]; displacement.len()];
        for block in &blocks {
            for (point, weight) in block.points.iter().zip(weights.by_ref()) {
                let slope = distance_gradient(&model, block, point, &positions);
                for (&node, slope) in block.nodes.iter().zip(slope.as_chunks::<3>().0) {
                    (0..3).for_each(|k| gradient[node as usize][k] += weight * slope[k]);
                }
            }
        }
        Ok(gradient)
    }

    fn followed(
        &self,
        problem: &Problem,
        model: &ContactModel,
        displacement: &[[f64; 3]],
        positions: &[[f64; 3]],
    ) -> Result<Vec<ContactBlock>, PostError> {
        check("displacement", displacement.as_flattened(), problem.num_dofs())?;
        model.following(&self.touching, positions).ok_or(PostError::NoFoot)
    }

    /// The value, and the slopes by the distances of all points.
    fn of(&self, blocks: &[ContactBlock]) -> (f64, Vec<f64>) {
        let distances: Vec<f64> = blocks.iter().flat_map(|block| &block.points).map(|point| point.distance).collect();
        let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let shares: Vec<f64> = distances.iter().map(|distance| ((nearest - distance) / self.width).exp()).collect();
        let sum: f64 = shares.iter().sum();
        (nearest - self.width * sum.ln(), shares.into_iter().map(|share| share / sum).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::penetration;
    use crate::testing::{displacement_of, two_chambers};

    /// The walls of two chambers, 2 mm apart at rest, turned towards each other.
    #[test]
    fn it_is_the_smallest_distance_and_has_the_slope_of_differences() {
        let problem = two_chambers(4.5);
        let bent = |angle: f64| displacement_of(&problem, |[x, _, z]| [-angle * (x - 9.0) * z, 0.0, 0.01 * x * z]);
        let width = 0.02;
        let u = bent(0.01);
        let gap = SmallestGap::at(&problem, &u, width).unwrap();
        let points: usize = gap.touching.blocks.iter().map(|block| block.points.len()).sum();
        let value = gap.value(&problem, &u).unwrap();
        let sampled = penetration::measure(&problem, &u).unwrap().min_gap_mm().unwrap();
        // Points lie within faces, samples also on their edges.
        assert!(value > sampled - width * (points as f64).ln() && value < 2.0, "{value} {sampled}");
        let step = 1e-4;
        let along =
            bent(0.011).iter().zip(&u).map(|(a, b)| std::array::from_fn(|k| a[k] - b[k])).collect::<Vec<[f64; 3]>>();
        let at = |step: f64| {
            let moved = u.iter().zip(&along).map(|(u, d)| std::array::from_fn(|k| u[k] + step * d[k]));
            gap.value(&problem, &moved.collect::<Vec<[f64; 3]>>()).unwrap()
        };
        let differences = (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
        let gradient = gap.gradient(&problem, &u).unwrap();
        let exact: f64 = gradient.as_flattened().iter().zip(along.as_flattened()).map(|(g, d)| g * d).sum();
        assert!(exact.abs() > 1e-3 && (exact - differences).abs() < 1e-7 * exact.abs(), "{exact} {differences}");
    }
}
