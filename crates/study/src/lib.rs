//! Studies of problems: errors over unknowns and seconds, stability, chance, multiscale bases, coupling.
//!
//! Each study is a module with its computation, the columns of its tables, its report and its pictures.
//!
//! ```text
//! rows ─► table (columns declared once) ─► report (CSV, JSON, HDF5, text)
//!      ─► chart (SVG, PNG)
//! ```
//!
//! ```
//! use steklov_study::reference::Reference;
//! use steklov_study::steklov_document::Document;
//!
//! let text = r#"
//! body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = ["floor", "right", "top", "left"] }
//! material = { young = 200, poisson = 0.3 }
//! sides.floor.contact = { gap = "0" }
//! sides.top.pressure = 3
//! "#;
//! let document = Document::parse(text, "block.toml", &[])?;
//! let scene = &document.scene;
//! let truth = Reference::new(scene, &Default::default(), &mut |_, _| Ok(()))?;
//!
//! // the block is pressed alike everywhere: J = -p² (1-ν²) A / 2E, and (|J - J*| / |J*|)^½ is an error
//! let exact = -0.5 * 9.0 * (1.0 - 0.3 * 0.3) * 2.0 / 200.0;
//! assert!((truth.own_energy / exact - 1.0).abs() < 1e-10);
//! assert!((truth.energy_error(exact * (1.0 + 1e-4)) - 1e-2).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// the crates whose types appear in the interface
pub use {steklov_document, steklov_figures, steklov_model, steklov_problem};

mod error;
pub mod reference;
mod supported;
mod settings;
mod kind;
mod fit;
mod watch;
mod table;
mod report;
mod show;
mod chart;
pub mod convergence;
pub mod stability;
pub mod inf_sup;
pub mod solvers;
pub mod stochastic;
pub mod multiscale;
pub mod coupling;
pub mod quantities;

pub use error::StudyError;
pub use kind::{Draw, Options, StudyKind};
pub use report::Report;
pub use settings::{Setting, settings};
pub use supported::contact_sides;
pub use watch::{Found, Watch};

/// These numbers, each once, rising.
fn distinct(numbers: impl Iterator<Item = usize>) -> Vec<usize> {
    numbers.collect::<std::collections::BTreeSet<_>>().into_iter().collect()
}

/// ⟨A v, v⟩ of a symmetric matrix.
fn quadratic(matrix: &faer::Mat<f64>, v: &[f64]) -> f64 {
    (0..v.len()).map(|j| v[j] * steklov_algebra::dot(matrix.col_as_slice(j), v)).sum()
}

/// The median; for an even number of values the mean of the two in the middle; NaN without values.
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
