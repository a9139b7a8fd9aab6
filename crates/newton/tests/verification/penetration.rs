//! What the two contact variants let through, by dense sampling of the deformed walls.

use pneuflex_mesh::Actuator;
use pneuflex_model::{ContactMethod, Formulation, Invariant};
use pneuflex_post::penetration::measure;

use crate::fixtures::{actuator_problem, follow, strict};

/// Theory §5, the paper's finding: on wall faces of 2 mm at 50 kPa one point per face lets the walls pass through each other,
/// 4 × 4 do not.
#[test]
fn single_points_let_walls_through_that_multiple_points_hold() {
    for (formulation, invariant) in
        [(Formulation::Hex8Sri, Invariant::Full), (Formulation::Hex8Q1p0, Invariant::Isochoric)]
    {
        let [single, multiple] = [ContactMethod::SinglePoint, ContactMethod::MultiPoint].map(|method| {
            let problem = actuator_problem(&Actuator::two_chambers(), [2.0; 3], formulation, invariant, method);
            let state = follow(&problem, &[50.0], &strict()).remove(0);
            assert!(state.contact_points > 0);
            measure(&problem, &state.displacement).unwrap().max_penetration_mm()
        });
        println!("{formulation} {invariant:?}: single-point {single:.4} mm, multi-point {multiple:.4} mm");
        assert!(single > 0.2 && single > 4.0 * multiple, "{formulation}: {single:.4} mm, {multiple:.4} mm");
    }
}
