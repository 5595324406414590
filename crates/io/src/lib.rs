//! Result files: HDF5 with checksums, read back to the same bits, and VTKHDF for ParaView.
//!
//! ```text
//! create_atomically(path, |file| { save(file, "mesh", &mesh)?; save_text(file, "scene", ..)?; vtkhdf::write(file, ..) })
//! open(path) ─► load::<Mesh>(&file, "mesh")     load_dense, load_sparse, load_vector, load_points, load_text ..
//! ```
//! A type is stored by [`Persist`], as a group with the attributes `kind` and `version`. It is built on functions for
//! arrays; each dataset has the attributes `unit`, `meaning` and `axes` ([`Label`]). Arrays are row-major, indices are
//! integers of 64 bits, texts are UTF-8 of fixed length, numbers keep their bits (NaN and infinities too).
//!
//! | type | datasets of its group |
//! |---|---|
//! | `Space` | `offset` `next` `points`; degrees are differences of `offset`, bases are made anew |
//! | `Steklov` | `S` `factor` (L, above it V) `solved` (L^-1 H) `domain`; bounded at infinity `basis` `constant` |
//! | `Condensation` | `eliminated` `kept` `held` `held_values` `frame_nodes` `frames` `S` `L` `coupling` `condensed` |
//! | `Variable` | `distribution` `parameters` `interval` |
//! | `Truncation` | `modes` or `captured` |
//! | `Recurrence` | `interval` `probability` `shift` `scale` `alpha` `beta` |
//! | stochastic `CellBasis` | `axis_D/recurrence` `axis_D/rule` `points` `weights` |
//! | `StoredTensorProblem` | `stiffness` `mass` `weights` `load`; `nodes/..` once, but `gap` `slip_offset` `bound` by stochastic node |
//! | `MultiplierSpace` | `edge` `side` `degree` `span` `nodes`; `node_edge` `node_side` `parameter` `weight` `points` `normal` `tangent` `curved` `resultant` |
//! | `StabilisedForms` | `elements` `coordinates` `weights` `damping`; `trace_` `values_` `pairing_` `C_gamma_` `D_gamma_` of `n` and `t`; `B_gamma` |
//! | `InfSup` | `beta` |
//! | `Problem` | `outline` `expressions`; `condition` `displacement` `traction` `springs` `stiffness` by side; `bodies/K` `interfaces/K` |
//! | `Method` | a word or a number by the name of the key, none where it is left to the program |
//!
//! The matrices of these satisfy the formulas in their attribute `meaning`; reading demands it.
//!
//! ```
//! use steklov_io::{IoError, Label, create_atomically, load_vector, open, save_vector};
//!
//! let path = std::env::temp_dir().join(format!("steklov-io-{}.vtkhdf", std::process::id()));
//! let pressure = Label { unit: "stress", meaning: "contact pressure, positive in compression", axes: &["contact node"] };
//! create_atomically(&path, true, |file| save_vector(file, "pressure", &[0.1, f64::INFINITY], &pressure))?;
//!
//! let file = open(&path)?;
//! assert_eq!(load_vector(&file, "pressure")?, [0.1, f64::INFINITY]);
//! assert!(matches!(create_atomically(&path, false, |_| Ok::<(), IoError>(())), Err(IoError::Exists { .. })));
//! # std::fs::remove_file(&path).unwrap();
//! # Ok::<(), IoError>(())
//! ```
//!
//! *Integrity*: Fletcher-32 checksums protect arrays, in chunks; FNV-1a protects texts; the checksums of HDF5 1.10's
//! structures protect all else (extents, types, attributes, links). Fletcher-32 detects every changed byte, but not a
//! pair of zero bytes that becomes 0xffff at an even place, or the reverse. Files of other programs are read with the
//! same care: sizes are compared with what the file holds before memory is requested, and structure is checked before
//! use.
//!
//! *Size*: integers, and recurring values of sparse matrices, are shuffled and deflated if there are at least 2¹³ of
//! them, before their checksums are computed; every HDF5 library with zlib reads them, for example h5py's. A library
//! without zlib writes them plain and cannot read deflated ones: [`IoError::NoDeflate`]. All else is plain: dense
//! matrices would shrink by a quarter in several times the time of a run.
//!
//! HDF5 prints nothing; its reasons are part of [`IoError`]. One lock serialises all calls into the library.

mod error;
mod raw;
mod attribute;
mod dataset;
mod deflated;
mod persist;
mod array;
mod matrix;
mod text;
#[cfg(unix)]
mod abandoned;
mod file;
mod room;
mod foreign;
pub mod vtkhdf;
#[cfg(feature = "quadrature")]
mod quadrature;
#[cfg(any(feature = "bem-operators", feature = "msfem"))]
mod elastic;
#[cfg(feature = "bem-operators")]
mod bem_operators;
#[cfg(feature = "bem-operators")]
mod steklov;
#[cfg(feature = "contact")]
mod contact;
#[cfg(feature = "contact")]
mod multipliers;
#[cfg(feature = "stochastic")]
mod stochastic;
#[cfg(feature = "stochastic")]
mod cell_basis;
#[cfg(feature = "stochastic")]
mod tensor_problem;
#[cfg(feature = "msfem")]
mod msfem;
#[cfg(feature = "coupling")]
mod coupling;
#[cfg(feature = "problem")]
mod expressions;
#[cfg(feature = "problem")]
mod method;
#[cfg(feature = "problem")]
mod problem;
#[cfg(feature = "problem")]
mod words;

// the crates whose types appear in the interface
pub use {faer, sprs};

pub use array::{
    load_integers, load_number, load_pairs, load_points, load_vector, save_integers, save_number, save_pairs,
    save_points, save_vector,
};
pub use attribute::{read_integer_attribute, read_text_attribute, write_integer_attribute, write_text_attribute};
pub use dataset::{Label, Rows, StoredLabel, label, load_label};
pub use error::{IoError, invalid};
pub use file::{FORMAT, FORMAT_VERSION, create_atomically, is_special, open};
pub use foreign::{load_foreign_axes, load_foreign_table};
pub use hdf5::{File, Group};
pub use matrix::{load_dense, load_sparse, save_dense, save_rows, save_sparse};
pub use persist::{Persist, copy, create_group, load, open_group, save};
#[cfg(feature = "stochastic")]
pub use tensor_problem::StoredTensorProblem;
pub use text::{load_text, load_texts, save_text, save_texts};
