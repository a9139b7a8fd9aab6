//! How far facing walls pass through each other, measured independently of the contact's own points.
//!
//! Every slave facet is sampled at the centres of 12 × 12 equal cells of its reference square or triangle, and each
//! sample is projected on the deformed master surface. Facets that are certainly further away than the smallest gap found so far
//! are left out: the distance to a surface changes by no more than the way one moves.

use pneuflex_mesh::{FaceKind, Facet};
use pneuflex_model::{ContactPair, Problem};

use crate::error::{PostError, check};
use crate::search::{Closest, Surface};
use crate::surface::{Patch, cell_centre};
use pneuflex_mesh::vector::{norm, sub};

/// Samples along each direction of a facet.
pub const SAMPLES: usize = 12;

/// Penetration of all gaps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Penetration {
    /// Gaps in the order of the problem's contact pairs.
    pub gaps: Vec<GapPenetration>,
}

/// Penetration of one gap.
#[derive(Clone, Debug, PartialEq)]
pub struct GapPenetration {
    /// Name of the contact pair.
    pub name: String,
    /// Least signed distance between the walls, mm; negative where they pass through each other.
    pub min_gap_mm: f64,
    /// Reference area of the slave wall that lies behind the master wall, mm².
    pub penetrating_area_mm2: f64,
}

impl Penetration {
    /// Least signed distance in all gaps, mm; `None` without gaps.
    pub fn min_gap_mm(&self) -> Option<f64> {
        self.gaps.iter().map(|g| g.min_gap_mm).min_by(f64::total_cmp)
    }

    /// Largest depth in all gaps, mm; 0 if nothing passes through.
    pub fn max_penetration_mm(&self) -> f64 {
        self.min_gap_mm().map_or(0.0, |gap| (-gap).max(0.0))
    }

    /// Reference area of slave walls behind their master walls, mm².
    pub fn penetrating_area_mm2(&self) -> f64 {
        self.gaps.iter().fold(0.0, |sum, gap| sum + gap.penetrating_area_mm2)
    }

    /// Number of gaps whose walls touch: somewhere the distance is negative. Penalty contact always leaves a small depth.
    pub fn gaps_in_contact(&self) -> usize {
        self.gaps.iter().filter(|g| g.min_gap_mm < 0.0).count()
    }
}

/// Measures the penetration of every contact pair with facets; a surface that may touch itself is none: the nearest of its points is the point
/// itself.
///
/// `displacement` has three entries per node, mm.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn measure(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Penetration, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let pairs = problem.contact_pairs.iter().filter(|p| !p.slave.is_empty() && !p.master.is_empty() && !p.is_self());
    Ok(Penetration { gaps: pairs.map(|pair| gap(problem, pair, displacement)).collect() })
}

/// Reference positions of the samples of slave walls that lie behind the master wall, mm: where walls touch.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn touching(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mut found = Vec::new();
    for pair in problem.contact_pairs.iter().filter(|pair| !pair.is_self()) {
        let master = Surface::new(problem, &pair.master, displacement);
        let mut hint = None;
        for &facet in &pair.slave {
            let patch = Patch::new(&problem.mesh, facet, Some(displacement));
            let reference = Patch::new(&problem.mesh, facet, None);
            for xi in sample_points(patch.kind()) {
                let closest = master.closest(patch.at(xi).position, hint);
                hint = closest.map(|c| c.facet).or(hint);
                if closest.is_some_and(|c| c.signed_distance < 0.0) {
                    found.push(reference.at(xi).position);
                }
            }
        }
    }
    Ok(found)
}

/// Reference coordinates of a facet's samples.
fn sample_points(kind: FaceKind) -> impl Iterator<Item = [f64; 2]> {
    (0..SAMPLES).flat_map(move |i| (0..SAMPLES).map(move |j| cell_centre(kind, SAMPLES, [i, j])))
}

fn gap(problem: &Problem, pair: &ContactPair, displacement: &[[f64; 3]]) -> GapPenetration {
    let master = Surface::new(problem, &pair.master, displacement);
    let mut found = GapPenetration { name: pair.name.clone(), min_gap_mm: f64::INFINITY, penetrating_area_mm2: 0.0 };
    let mut centres: Vec<(f64, Patch, Facet, usize)> = Vec::new();
    let mut hint = None;
    for &facet in &pair.slave {
        let patch = Patch::new(&problem.mesh, facet, Some(displacement));
        if let Some(closest) = master.closest(patch.centre(), hint) {
            hint = Some(closest.facet);
            found.min_gap_mm = found.min_gap_mm.min(closest.signed_distance);
            centres.push((closest.signed_distance, patch, facet, closest.facet));
        }
    }
    // Near facets first: the others are then ruled out by their centres.
    centres.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    for (distance, patch, facet, near) in centres {
        let centre = patch.centre();
        // Bilinear faces lie within their corners' reach; quadratic ones a little beyond.
        let radius = 1.25 * patch.nodes().iter().map(|n| norm(sub(*n, centre))).fold(0.0, f64::max);
        if distance - radius > found.min_gap_mm.max(0.0) {
            continue;
        }
        sample(problem, &master, &patch, facet, near, &mut found);
    }
    found
}

fn sample(problem: &Problem, master: &Surface, patch: &Patch, facet: Facet, near: usize, found: &mut GapPenetration) {
    let reference = Patch::new(&problem.mesh, facet, None);
    let cell = patch.kind().reference_area() / (SAMPLES * SAMPLES) as f64;
    let mut hint = near;
    for xi in sample_points(patch.kind()) {
        let Some(Closest { facet, signed_distance, .. }) = master.closest(patch.at(xi).position, Some(hint)) else {
            continue;
        };
        hint = facet;
        found.min_gap_mm = found.min_gap_mm.min(signed_distance);
        if signed_distance < 0.0 {
            found.penetrating_area_mm2 += cell * norm(reference.at(xi).area_vector);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers, with_formulation};
    use pneuflex_model::Formulation;

    #[test]
    fn at_rest_the_gap_is_its_width() {
        let problem = two_chambers(1.0);
        let found = measure(&problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).unwrap();
        assert_eq!(found.gaps.len(), 1);
        assert!((found.min_gap_mm().unwrap() - 2.0).abs() < 1e-12);
        assert_eq!((found.max_penetration_mm(), found.gaps_in_contact()), (0.0, 0));
    }

    #[test]
    fn a_wall_pushed_through_the_other_is_measured_where_it_is() {
        // The left wall is moved by 2.25 mm above z = 8: 0.25 mm too far, over 5 of its 9 mm of height.
        let problem = two_chambers(1.0);
        let u = displacement_of(&problem, |x| [if x[0] <= 8.0 && x[2] > 7.5 { 2.25 } else { 0.0 }, 0.0, 0.0]);
        let found = measure(&problem, &u).unwrap();
        assert!((found.max_penetration_mm() - 0.25).abs() < 1e-12, "{found:?}");
        assert_eq!(found.gaps_in_contact(), 1);
        // 10 mm × 5 mm, and the part of the slanted row between z = 7 and 8 that is beyond 2 mm: one ninth of it.
        let area = found.penetrating_area_mm2();
        assert!((area - (50.0 + 10.0 / 9.0)).abs() < 0.4, "{area}");
        // The same samples, where they are at rest: on the left wall above z = 7.
        let touching = touching(&problem, &u).unwrap();
        assert!((touching.len() as f64 / (SAMPLES * SAMPLES) as f64 - area).abs() < 1e-9);
        assert!(touching.iter().all(|x| (x[0] - 8.0).abs() < 1e-9 && x[2] > 7.0));
    }

    #[test]
    fn walls_of_triangles_are_measured_alike() {
        let problem = with_formulation(3.0, Formulation::Tet15);
        let u = displacement_of(&problem, |x| [if x[0] <= 8.0 { 2.1 } else { 0.0 }, 0.0, 0.0]);
        let found = measure(&problem, &u).unwrap();
        assert!((found.max_penetration_mm() - 0.1).abs() < 1e-12, "{found:?}");
        assert!((found.penetrating_area_mm2() - 90.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn skipping_far_facets_changes_nothing() {
        let problem = two_chambers(1.0);
        let u = displacement_of(&problem, |x| {
            let bulge = 1.9 * (1.0 - (x[1] / 10.0).powi(2)) * (x[2] / 13.0).powi(2);
            [if x[0] <= 8.0 { bulge } else { 0.6 - 0.1 * x[2] }, 0.0, 0.0]
        });
        let found = measure(&problem, &u).unwrap();
        let pair = &problem.contact_pairs[0];
        let master = Surface::new(&problem, &pair.master, &u);
        let mut all = GapPenetration { name: String::new(), min_gap_mm: f64::INFINITY, penetrating_area_mm2: 0.0 };
        for &facet in &pair.slave {
            sample(&problem, &master, &Patch::new(&problem.mesh, facet, Some(&u)), facet, 0, &mut all);
        }
        assert!(all.min_gap_mm < -0.05, "the check would be empty: {all:?}");
        assert_eq!(found.gaps[0].min_gap_mm, all.min_gap_mm);
        assert!((found.gaps[0].penetrating_area_mm2 - all.penetrating_area_mm2).abs() < 1e-9);
    }
}
