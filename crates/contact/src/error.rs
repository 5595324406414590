//! What can go wrong in a contact problem.

/// Errors of this crate; each carries the numbers that tell what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// The parts of a problem do not fit together.
    #[error("the contact problem is inconsistent: {what}")]
    Inconsistent {
        /// What does not fit.
        what: String,
    },
}
