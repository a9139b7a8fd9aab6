//! Where walls pass through each other, and where they are nearest.

use pneuflex_model::Problem;

use pneuflex_post::check;

use crate::error::PlotError;
use pneuflex_mesh::vector::{Vec3, norm, sub};
use pneuflex_post::penetration::SAMPLES;
use pneuflex_post::search::Surface;
use pneuflex_post::surface::{Patch, SurfacePoint, cell_centre};

use super::view::unit;

/// The place of a gap where its walls are nearest, or deepest in each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Index of its contact pair, from 0.
    pub gap: usize,
    /// Deformed position on the slave wall, mm.
    pub position: [f64; 3],
    /// Signed distance of the walls there, mm; negative behind the opposite wall.
    pub distance_mm: f64,
}

/// For every gap the place where its walls are nearest, by the sampling of [`pneuflex_post::penetration`].
///
/// # Errors
/// A list of the wrong length or with a number that is not finite.
pub fn nearest(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<Nearest>, PlotError> {
    let samples = sample(problem, displacement, f64::INFINITY)?;
    let least = |found: Vec<Sample>| found.into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
    Ok(samples
        .into_iter()
        .filter_map(|(gap, found)| least(found).map(|s| Nearest { gap, position: s.position, distance_mm: s.distance }))
        .collect())
}

/// For every gap the deformed positions on its slave wall that are deeper than `depth` (mm) behind the master wall, and
/// about those opposite.
pub(crate) fn deeper_than(
    problem: &Problem,
    displacement: &[[f64; 3]],
    depth: f64,
) -> Result<Vec<Vec<Vec3>>, PlotError> {
    let samples = sample(problem, displacement, -depth)?;
    Ok(samples
        .into_iter()
        .map(|(_, found)| found.into_iter().flat_map(|s| [s.position, s.opposite]).collect())
        .collect())
}

/// A point of a slave wall.
struct Sample {
    /// Signed distance from the master wall, mm.
    distance: f64,
    position: Vec3,
    /// As far from it along its own wall's normal, forwards or back: about on the master wall.
    opposite: Vec3,
}

/// Samples whose signed distance is below `limit`, and those that may be the nearest of their gap.
fn sample(problem: &Problem, displacement: &[[f64; 3]], limit: f64) -> Result<Vec<(usize, Vec<Sample>)>, PlotError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mut all = Vec::new();
    for (gap, pair) in problem.contact_pairs.iter().enumerate().filter(|(_, pair)| !pair.is_self()) {
        let master = Surface::new(problem, &pair.master, displacement);
        let mut found = Vec::new();
        let mut centres = Vec::new();
        let mut hint = None;
        for &facet in &pair.slave {
            let patch = Patch::new(&problem.mesh, facet, Some(displacement));
            let centre = patch.centre();
            if let Some(closest) = master.closest(centre, hint) {
                hint = Some(closest.facet);
                let reach = 1.25 * patch.nodes().iter().map(|n| norm(sub(*n, centre))).fold(0.0, f64::max);
                centres.push((closest.signed_distance - reach, closest, patch));
            }
        }
        // The distance changes by no more than the way one moves: faces further away than this hold nothing wanted.
        let nearest = centres.iter().map(|c| c.1.signed_distance).fold(f64::INFINITY, f64::min);
        let bound = limit.min(nearest.max(0.0));
        for (least, closest, patch) in centres {
            if least > bound {
                continue;
            }
            let mut hint = closest.facet;
            for i in 0..SAMPLES {
                for j in 0..SAMPLES {
                    let xi = cell_centre(patch.kind(), SAMPLES, [i, j]);
                    let SurfacePoint { position, area_vector } = patch.at(xi);
                    if let Some(here) = master.closest(position, Some(hint)) {
                        hint = here.facet;
                        if here.signed_distance < limit {
                            let (distance, normal) = (here.signed_distance, unit(area_vector));
                            let opposite = std::array::from_fn(|d| position[d] + distance * normal[d]);
                            found.push(Sample { distance, position, opposite });
                        }
                    }
                }
            }
        }
        all.push((gap, found));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};

    #[test]
    fn the_deepest_place_is_where_the_wall_went() {
        let problem = two_chambers(1.0);
        let u = displacement_of(&problem, |x| {
            let bulge = 2.3 * (-0.1 * (x[1] * x[1] + (x[2] - 10.0).powi(2))).exp();
            [if (x[0] - 8.0).abs() < 1e-9 { bulge } else { 0.0 }, 0.0, 0.0]
        });
        let found = nearest(&problem, &u).unwrap();
        assert_eq!(found.len(), 1);
        assert!((found[0].distance_mm + 0.3).abs() < 0.05, "{found:?}");
        assert!(found[0].position[1] < 0.2 && (found[0].position[2] - 10.0).abs() < 0.2, "{found:?}");
        let deep = deeper_than(&problem, &u, 0.1).unwrap();
        assert!(deep[0].len() > 20);
        assert!(deep[0].iter().step_by(2).all(|p| p[0] > 10.09), "{deep:?}");
        assert!(deeper_than(&problem, &u, 0.5).unwrap()[0].is_empty());
        // In agreement with the measure of the summary.
        let measured = pneuflex_post::penetration::measure(&problem, &u).unwrap();
        assert_eq!(measured.max_penetration_mm(), -found[0].distance_mm);
    }
}
