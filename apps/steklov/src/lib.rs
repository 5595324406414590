//! apps/steklov

pub mod expression;
pub mod scene;
pub mod picture;
pub mod triangulate;
