//! What breaks arithmetic, made from a seed: [`cases`] each push one quantity to where it breaks, [`classes`] are
//! scenes of the kinds that people have, one of them of all the hard shapes of `splats` at once.

pub mod cases;
pub mod classes;
mod splats;
