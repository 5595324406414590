//! The unbounded medium around a body: its solution, a window of it for pictures, what is stored of it.
//!
//! ```text
//! Scene (jumps, remote stress) ─► Transmission (steklov_coupling) ─► Around ─► Window (points, displacement, stress)
//!                                                                      └─► /coupling, /VTKHDF, JSON `exterior`
//! ```

mod medium;
mod window;
pub(crate) mod store;

pub use medium::Around;
pub use window::Window;
pub(crate) use window::window;
