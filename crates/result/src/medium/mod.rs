//! The unbounded medium around a body: its solution, a window of it for pictures, its stored data.
//!
//! ```text
//! Scene (jumps, remote stress) ─► Transmission, or Outside of the body ─► Around ─► Window (points, displacement, stress)
//!                                                                         └─► /coupling, /VTKHDF, JSON `exterior`
//! ```

mod window;
mod cells;
pub(crate) mod store;

pub(crate) use cells::add_medium;
pub use cells::body_part;
pub use window::Window;
pub(crate) use window::window;
