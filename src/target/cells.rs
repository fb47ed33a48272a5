//! Where surfaces go: a window of the screen over cells (fragments of a pixel) that the caller lends.

use super::TargetError;
use crate::blend::surface::Cell;
use crate::raster::Window;

/// A tile or a whole frame of cells. Row `y` of the window begins at `(y - first row) * columns`.
#[derive(Debug)]
pub struct CellTarget<'a, C> {
    cells: &'a mut [C],
    window: Window,
    columns: usize,
}

impl<'a, C: Cell> CellTarget<'a, C> {
    /// A target for the pixels of `window`; `cells` needs one cell per pixel.
    pub fn new(cells: &'a mut [C], window: Window) -> Result<Self, TargetError> {
        let columns = usize::from(window.end[0].saturating_sub(window.first[0]));
        let rows = usize::from(window.end[1].saturating_sub(window.first[1]));
        let (needed, found) = (columns.saturating_mul(rows), cells.len());
        if found < needed {
            return Err(TargetError { needed, found });
        }
        Ok(CellTarget {
            cells,
            window,
            columns,
        })
    }

    /// The pixels that the target holds.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Empties every cell.
    pub fn clear(&mut self) {
        self.cells.fill(C::EMPTY);
    }

    /// Cells of the pixels `x .. x + length` of row `y`; empty if any of them lies outside the window.
    #[inline(always)]
    pub fn row(&mut self, y: u16, x: u16, length: u16) -> &mut [C] {
        let Window { first, end: last } = self.window;
        let end = u32::from(x) + u32::from(length);
        if y < first[1] || y >= last[1] || x < first[0] || end > u32::from(last[0]) {
            return &mut [];
        }
        let start = usize::from(y - first[1]) * self.columns + usize::from(x - first[0]);
        self.cells
            .get_mut(start..start + usize::from(length))
            .unwrap_or_default()
    }
}
