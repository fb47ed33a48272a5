//! Host side of splatline: scenes, float reference, metrics and reports around the fixed-point kernel.
//!
//! Data flows down this list and never back:
//! a [`scene`] of splats is seen by a [`camera`] under [`rules`]; the [`reference`](mod@reference)
//! draws it in double precision and [`fixed`] draws it through the kernel, both into a [`picture`];
//! [`metrics`] compares two pictures and [`report`] tells people about it.

pub mod atomic;
pub mod baseline;
pub mod camera;
pub mod cameras;
pub mod design;
pub mod difference;
pub mod digest;
pub mod explore;
pub mod fast;
pub mod fixed;
pub mod framing;
pub mod gallery;
pub mod hybrid;
pub mod input;
pub mod machine;
pub mod memory;
pub mod metrics;
pub mod picture;
pub mod reference;
pub mod report;
pub mod results;
pub mod rules;
pub mod scene;
pub mod sheets;
pub mod stability;
pub mod study;
pub mod surface;
pub mod systems;
pub mod texture;
pub mod trace;
pub mod vector;
pub mod vectors;
