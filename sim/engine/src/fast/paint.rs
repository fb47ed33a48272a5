//! What paints a tile: cells of fused products, words of 64 bits, or the kernel's own painter, by what processor and design allow.

use super::cells::FusedPainter;
use super::lanes::{VectorLevel, draws_pixels};
use super::painter::{CHECK_INTERVAL, PaintScratch, ScalarPainter, TilePainter, TileWork};
use super::words::WordPainter;
use splatline::draw::Coverage;
use splatline::format::{Design, Traversal};
use splatline::rules::{Compositing, Rules};

/// The fastest painter for a design and rules on such vectors: the kernel's own where vectors cannot draw.
///
/// Only where `counts` asks for it are all pixels counted; a painter that need not may leave out those that have finished.
pub fn tile_painter<D: Design + Send + Sync + 'static>(
    design: D,
    rules: &Rules,
    order: Compositing,
    traversal: Traversal,
    choice: Option<VectorLevel>,
    counts: bool,
) -> Box<dyn TilePainter> {
    let vectors = choice.filter(|level| traversal == Traversal::Spans && draws_pixels(*level));
    let of_level = |choice| on_vectors(design, rules, order, choice, counts);
    if let Some(painter) = vectors.and_then(of_level) {
        return painter;
    }
    Box::new(ScalarPainter::new(design, rules, order, traversal))
}

/// A painter along spans; `None` where only the kernel's can. Other orders than front to back have the words alone.
fn on_vectors<D: Design + Send + Sync + 'static>(
    design: D,
    rules: &Rules,
    order: Compositing,
    choice: VectorLevel,
    counts: bool,
) -> Option<Box<dyn TilePainter>> {
    let words = WordPainter::new(design, rules, order, choice, counts);
    let cells = (order == Compositing::FrontToBack)
        .then(|| FusedPainter::new(design, rules, choice, counts))
        .flatten();
    Some(match (cells, words) {
        (Some(cells), Some(words)) => Box::new(ByLength { cells, words }),
        (Some(cells), None) => Box::new(cells),
        (None, words) => Box::new(words?),
    })
}

/// Cells where runs are long, words where they are short: a cell costs the same however little of it a run covers.
struct ByLength<D> {
    cells: FusedPainter<D>,
    words: WordPainter<D>,
}

impl<D: Design + Send + Sync> TilePainter for ByLength<D> {
    fn paint(&self, scratch: &mut PaintScratch, work: TileWork) -> Coverage {
        let first = work.list.iter().take(CHECK_INTERVAL);
        let first = first.flat_map(|index| &work.footprints[*index as usize]);
        // A footprint's longest run grows as the root of 1 / A. At 2, nine pixels by the largest cut-off, both took
        // about the same time.
        let (mut sum, mut count) = (0, 0);
        for footprint in first {
            sum += footprint.ldl.squared_width.leading().clamp(-32, 32);
            count += 1;
        }
        let painter: &dyn TilePainter = if sum < count {
            &self.words
        } else {
            &self.cells
        };
        painter.paint(scratch, work)
    }
}
