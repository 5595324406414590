//! Results that rounding cannot explain, and a second attempt without threads.

use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering};

use faer::Par;

/// A factor, a product or a solution that does not agree with its input.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{what} of {size} unknowns is wrong by {error:.1e} of its terms, which rounding does not explain, and on one thread too: \
     processor, memory or linear algebra of this machine cannot be trusted; run again, or on another machine"
)]
pub struct Fault {
    /// What is wrong.
    pub what: &'static str,
    /// Number of its rows.
    pub size: usize,
    /// The largest difference over the sum of the absolute values of its terms; NaN if an entry is not a number.
    pub error: f64,
}

/// Number of attempts that now run without threads.
static ALONE: AtomicUsize = AtomicUsize::new(0);

/// As parallel as `usual`, but on one thread while an attempt is repeated.
pub fn threads(usual: Par) -> Par {
    if ALONE.load(Ordering::Relaxed) > 0 { Par::Seq } else { usual }
}

/// Whether an error is a fault, or was made by one.
pub fn is_fault(error: &(dyn Error + 'static)) -> bool {
    error.is::<Fault>() || error.source().is_some_and(is_fault)
}

/// Does the work; if it ends with a fault, does it once more with the linear algebra of the process on one thread.
///
/// # Errors
/// Those of the last attempt.
pub fn once_more<T, E: Error + 'static>(mut work: impl FnMut() -> Result<T, E>) -> Result<T, E> {
    match work() {
        Err(error) if is_fault(&error) => {
            let usual = faer::get_global_parallelism();
            ALONE.fetch_add(1, Ordering::Relaxed);
            faer::set_global_parallelism(Par::Seq);
            let result = work();
            faer::set_global_parallelism(usual);
            ALONE.fetch_sub(1, Ordering::Relaxed);
            result
        }
        result => result,
    }
}
