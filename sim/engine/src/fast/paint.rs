//! What paints a tile: vectors, or the kernel's own painter, by what processor and design allow.

use super::lanes::{VectorLevel, draws_pixels};
use super::painter::{ScalarPainter, TilePainter};
use super::words::WordPainter;
use splatline::format::{Design, Traversal};
use splatline::rules::{Compositing, Rules};

/// The fastest painter for a design and rules on such vectors: the kernel's own where vectors cannot draw.
///
/// Only where `counts` asks for it are all pixels counted; a painter that need not may leave out those that have
/// finished.
pub fn tile_painter<D: Design + Send + Sync + 'static>(
    design: D,
    rules: &Rules,
    order: Compositing,
    traversal: Traversal,
    choice: Option<VectorLevel>,
    counts: bool,
) -> Box<dyn TilePainter> {
    let vectors = choice.filter(|level| traversal == Traversal::Spans && draws_pixels(*level));
    let of_level = |choice| WordPainter::new(design, rules, order, choice, counts);
    match vectors.and_then(of_level) {
        Some(painter) => Box::new(painter),
        None => Box::new(ScalarPainter::new(design, rules, order, traversal)),
    }
}
