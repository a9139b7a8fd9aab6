//! The whole body, of which planes of symmetry leave a half, a quarter or an eighth to be modelled.

use crate::problem::Problem;
use crate::symmetry::{NoSymmetry, SymmetryPlane};

/// What is this close to a plane, relative to the body's extent, lies in it: decks and meshes have six digits and more.
const CLOSE: f64 = 1e-6;

impl Problem {
    /// Makes the plane in which the nodes of a support are held one of symmetry.
    ///
    /// # Errors
    /// [`NoSymmetry`] if the nodes lie in no such plane, the body is not cut by it, or there is one for that axis already.
    pub fn declare_symmetry(&mut self, support: usize) -> Result<SymmetryPlane, NoSymmetry> {
        let held = self.supports.get(support).ok_or(NoSymmetry::Axes)?;
        let axes: Vec<usize> = (0..3).filter(|&axis| held.axes[axis]).collect();
        let (&[axis], None) = (&axes[..], &held.motion) else { return Err(NoSymmetry::Axes) };
        let along = |node: usize| self.mesh.nodes[node][axis];
        let (low, high) = range(held.nodes.iter().map(|&node| along(node as usize)));
        let close = CLOSE * self.mesh.extent();
        let plane = SymmetryPlane { axis, at: snapped(0.5 * (low + high), close), support };
        // Without nodes it is not flat either.
        let is_flat = high - low <= 2.0 * close;
        if !is_flat {
            return Err(NoSymmetry::NotFlat { axis: plane.axis_name(), low, high });
        }
        if let Some(other) = self.symmetry.iter().find(|other| other.axis == axis) {
            return Err(NoSymmetry::Second(other.words()));
        }
        // Nodes of no element are no part of the body.
        let mut is_body = vec![false; self.mesh.num_nodes()];
        self.mesh.connectivity.iter().for_each(|&node| is_body[node as usize] = true);
        let body = || (0..self.mesh.num_nodes()).filter(|&node| is_body[node]);
        let (least, greatest) = range(body().map(along));
        if least < plane.at - close && greatest > plane.at + close {
            return Err(NoSymmetry::BothSides(plane.words()));
        }
        let mut is_held = vec![false; self.mesh.num_nodes()];
        held.nodes.iter().for_each(|&node| is_held[node as usize] = true);
        let missing = body().filter(|&node| (along(node) - plane.at).abs() <= close && !is_held[node]).count();
        if missing > 0 {
            return Err(NoSymmetry::NotAll { plane: plane.words(), missing });
        }
        self.symmetry.push(plane);
        Ok(plane)
    }

    /// How many modelled parts make the whole body: 1, 2, 4 or 8.
    pub fn parts_of_whole(&self) -> usize {
        1 << self.symmetry.len()
    }

    /// What is modelled: `whole`, `half`, `quarter` or `eighth`.
    pub fn modelled_part(&self) -> &'static str {
        ["whole", "half", "quarter", "eighth"][self.symmetry.len().min(3)]
    }

    /// A force on the whole body from that on the modelled part: across a plane of symmetry the parts' forces cancel.
    pub fn whole_force(&self, force: [f64; 3]) -> [f64; 3] {
        self.symmetry.iter().fold(force, |force, plane| {
            let mut sum = force.map(|f| 2.0 * f);
            sum[plane.axis] = 0.0;
            sum
        })
    }
}

/// Zero for a coordinate that is zero but for rounding.
fn snapped(at: f64, close: f64) -> f64 {
    if at.abs() <= close { 0.0 } else { at }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Contact, Curve, Formulation, Material, Motion, Support};
    use pneuflex_mesh::actuator::Part;
    use pneuflex_mesh::{Actuator, MeshSize};

    fn chambers(part: Part) -> Problem {
        let actuator = Actuator { part, ..Actuator::two_chambers() };
        let (size, material) = (MeshSize::uniform(4.0), Material::default());
        Problem::from_actuator(&actuator, &size, Formulation::Hex8Sri, material, Contact::default()).unwrap()
    }

    fn support(problem: &Problem, axes: [bool; 3], holds: impl Fn([f64; 3]) -> bool) -> Support {
        Support { name: "s".into(), nodes: problem.mesh.select_nodes(holds), axes, motion: None }
    }

    #[test]
    fn a_half_knows_its_plane_and_what_the_whole_carries() {
        let half = chambers(Part::Half);
        assert_eq!(half.symmetry, [SymmetryPlane { axis: 1, at: 0.0, support: 1 }]);
        assert_eq!((half.parts_of_whole(), half.modelled_part(), &*half.symmetry[0].words()), (2, "half", "y = 0"));
        assert_eq!(half.whole_force([1.0, 2.0, 3.0]), [2.0, 0.0, 6.0]);
        let whole = chambers(Part::Whole);
        assert_eq!((whole.parts_of_whole(), whole.modelled_part()), (1, "whole"));
        assert_eq!(whole.whole_force([1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn a_plane_is_one_only_where_the_whole_body_ends_in_it() {
        let mut problem = chambers(Part::Whole);
        let y = [false, true, false];
        let wrong = [
            (support(&problem, [true, true, false], |x| x[1] < -9.9), NoSymmetry::Axes),
            (support(&problem, y, |x| x[1] < 0.0), NoSymmetry::NotFlat { axis: 'y', low: -10.0, high: 0.0 }),
            (support(&problem, y, |x| x[1] == 0.0), NoSymmetry::BothSides("y = 0".into())),
            (
                support(&problem, y, |x| x[1] == -10.0 && x[2] < 1.0),
                NoSymmetry::NotAll { plane: "y = -10".into(), missing: 0 },
            ),
        ];
        for (support, expected) in wrong {
            problem.supports.push(support);
            let error = problem.declare_symmetry(problem.supports.len() - 1).unwrap_err();
            assert_eq!(std::mem::discriminant(&error), std::mem::discriminant(&expected), "{error}");
        }
        let moved = Motion { displacement: [0.0; 3], curve: Curve::ZERO };
        let plane = support(&problem, y, |x| x[1] == -10.0);
        problem.supports.push(Support { motion: Some(moved), ..plane.clone() });
        assert_eq!(problem.declare_symmetry(problem.supports.len() - 1), Err(NoSymmetry::Axes));
        problem.supports.push(plane);
        let last = problem.supports.len() - 1;
        assert_eq!(problem.declare_symmetry(last), Ok(SymmetryPlane { axis: 1, at: -10.0, support: last }));
        assert_eq!(problem.declare_symmetry(last), Err(NoSymmetry::Second("y = -10".into())));
        assert_eq!(problem.declare_symmetry(99), Err(NoSymmetry::Axes));
    }
}
