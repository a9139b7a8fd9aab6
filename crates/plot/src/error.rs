//! What cannot be drawn.

use pneuflex_post::PostError;

/// A chart or a picture that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlotError {
    /// A sheet or an image that has no size, nothing on it, or is too large.
    #[error("cannot draw {what}")]
    NotDrawable {
        /// What, and why not.
        what: String,
    },
    /// A list of the wrong length, a number that is not finite, a state that cannot be evaluated.
    #[error(transparent)]
    Data(#[from] PostError),
}
