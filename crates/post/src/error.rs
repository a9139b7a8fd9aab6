//! What can be wrong with a state handed to post-processing.

/// A state from which nothing can be derived.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PostError {
    /// A list has not one entry per degree of freedom (or per point, per cell).
    #[error("{what} has {found} entries instead of {expected}")]
    WrongLength {
        /// Which list.
        what: String,
        /// Entries it should have.
        expected: usize,
        /// Entries it has.
        found: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} holds a number that is not finite")]
    NotFinite {
        /// Which list or value.
        what: String,
    },
    /// An element is turned inside out.
    #[error("element {element} is inverted (det F = {jacobian:.3e} at its integration point {point})")]
    Inverted {
        /// Element number.
        element: usize,
        /// Integration point.
        point: usize,
        /// det F.
        jacobian: f64,
    },
    /// A point of a wall has slid off the face opposite.
    #[error("a point between walls slides off its face")]
    NoFoot,
}

/// Checks that `values` has `expected` entries, all finite.
///
/// # Errors
/// [`PostError::WrongLength`] or [`PostError::NotFinite`], about `what`.
pub fn check(what: &str, values: &[f64], expected: usize) -> Result<(), PostError> {
    if values.len() != expected {
        return Err(PostError::WrongLength { what: what.into(), expected, found: values.len() });
    }
    if !values.iter().all(|x| x.is_finite()) {
        return Err(PostError::NotFinite { what: what.into() });
    }
    Ok(())
}
