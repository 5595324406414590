//! Studies of problems: errors over unknowns and seconds, stability, chance, multiscale bases, coupling.
//!
//! Each study is a module: what it computes, the columns of its tables, its report and its pictures.
//!
//! ```text
//! rows ─► table (columns declared once) ─► report (CSV, JSON, HDF5, text)
//!      ─► chart (SVG, PNG)
//! ```

mod error;
pub mod reference;
mod supported;
mod settings;
mod fit;
mod watch;
mod table;
mod report;
mod show;
mod chart;
pub mod convergence;
pub mod stability;
pub mod inf_sup;
pub mod stochastic;
pub mod multiscale;
pub mod coupling;

pub use error::StudyError;
pub use report::Report;
pub use settings::{Setting, settings};
pub use supported::contact_sides;
pub use watch::{Found, Watch};

/// These numbers, each once, rising.
fn distinct(numbers: impl Iterator<Item = usize>) -> Vec<usize> {
    numbers.collect::<std::collections::BTreeSet<_>>().into_iter().collect()
}

/// The median; of an even number the mean of the two in the middle; NaN of none.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 { f64::NAN } else { (values[(n - 1) / 2] + values[n / 2]) / 2.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&mut [3.0]), 3.0);
        assert_eq!(median(&mut [9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [9.0, 1.0, 2.0, 4.0]), 3.0);
        assert!(median(&mut []).is_nan());
    }
}
