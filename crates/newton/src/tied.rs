//! Surfaces that are glued to each other become linear equations before anything is solved.

pub use pneuflex_contact::tie::TieError;
use pneuflex_contact::tie::{Glue, glue};
use pneuflex_model::Problem;

/// The problem with equations in the place of its ties, on the mesh that it is solved on, and what to know of them, in words.
///
/// # Errors
/// Surfaces that are not near each other, or overhang.
pub fn glued(mut problem: Problem) -> Result<(Problem, Vec<String>), TieError> {
    let held = problem.held_dofs();
    let mut notes = Vec::new();
    for tie in std::mem::take(&mut problem.ties) {
        let Glue { equations, faces: [glued, all] } = glue(&problem.mesh, &tie, &held)?;
        problem.equations.extend(equations);
        if glued < all {
            notes
                .push(format!("tie {}: {glued} of {all} faces lie on the other surface and are glued to it", tie.name));
        }
    }
    Ok((problem, notes))
}
