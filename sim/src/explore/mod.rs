//! Exploration: sweeps over designs and machines, the Pareto front, the smallest design within a budget, and what a scene needs.
//!
//! ```text
//! space (TOML) -> points -> sweep (shared work once, CSV appended) -> front (CSV, HTML)
//! limits (frames a second, LUT, error ...) -> ask (search over designs and machines) -> the cheapest point
//! ```

pub mod ask;
pub mod fit;
pub mod folder;
pub mod front;
pub mod identity;
pub mod needs;
pub mod plot;
pub mod space;
pub mod sweep;
pub mod table;
