//! Exploration: sweeps over designs and machines, the Pareto front, the smallest design within a budget, and what a
//! scene needs.
//!
//! ```text
//! frames, a design, a machine -> subject -> evaluator (errors, cycles, area, energy of any choice)
//! space (TOML) -> points -> sweep: all points (CSV appended) -> front (CSV, HTML)
//! limits (frames a second, LUT, error ...) -> search: descent -> answer, the cheapest point; fit, the smallest design
//! ```

pub mod answer;
pub mod answer_page;
mod answer_text;
mod bounds;
mod cache;
pub mod detail;
mod errors;
pub mod evaluator;
pub mod fit;
pub mod folder;
pub mod formats;
pub mod front;
pub mod identity;
pub mod limits;
pub mod plot;
pub mod profile;
pub mod refusal;
mod search;
pub mod space;
pub mod statistics;
pub mod subject;
pub mod sweep;
pub mod table;
