//! A tile's way through its list: what finished pixels hide is left out, rows are computed for a group, and their runs
//! painted one by one.

use super::live::LiveRuns;
use super::numbers::{PathNumbers, SplatNumbers};
use super::path::PixelPath;
use super::tile::WordTile;
use crate::fast::lanes::{Lanes, prefetch};
use crate::fast::painter::{CHECK_INTERVAL, Results, Start};
use crate::fast::row_group::RowGroup;
use crate::fast::row_reals::RowReals;
use crate::fast::rows::RowBatch;
use crate::fast::tile::ROWS;
use splatline::draw::Coverage;
use splatline::raster::Window;

/// A tile to be painted, by whatever vectors. It knows a design only by its numbers, so that one compiled copy serves
/// all.
#[derive(Clone, Copy)]
pub(super) struct Painting<'a> {
    pub numbers: &'a PathNumbers,
    pub footprints: &'a Results,
    pub list: &'a [u32],
    pub start: Start,
    pub counts: bool,
}

/// Paints the footprint of this number by the kernel.
pub(super) type PaintAlone<'a, W> = dyn Fn(u32, &mut WordTile<W>) -> Coverage + 'a;

/// Painting on its way through a list. Its memory is lent: what is indexed, or seen by a function that is not inlined,
/// keeps a structure out of registers.
struct Progress<'a, 'b, L: Lanes, P: PixelPath> {
    painting: Painting<'a>,
    lanes: L,
    path: &'b P,
    scalar: &'b PaintAlone<'b, P::Word>,
    tile: &'b mut WordTile<P::Word>,
    /// The tile's first column and row.
    corner: [u16; 2],
    /// Around the pixels in work.
    window: Window,
    group: &'b mut RowGroup,
    batch: &'b mut RowBatch,
    live: &'b mut LiveRuns,
    coverage: Coverage,
}

impl Painting<'_> {
    /// Paints the tile.
    #[inline(always)]
    pub fn paint<L: Lanes, P: PixelPath>(
        self,
        lanes: L,
        path: &P,
        scalar: &PaintAlone<P::Word>,
        tile: &mut WordTile<P::Word>,
    ) -> Coverage {
        let window = tile.window();
        let mut progress = Progress {
            painting: self,
            lanes,
            path,
            scalar,
            tile,
            corner: window.first,
            window,
            group: &mut RowGroup::default(),
            batch: &mut RowBatch::new(),
            live: &mut LiveRuns::new(),
            coverage: Coverage::default(),
        };
        if self.start == Start::Resumed && !self.counts && !progress.look() {
            return progress.coverage;
        }
        for (number, part) in self.list.chunks(CHECK_INTERVAL).enumerate() {
            let next = self.list.chunks(CHECK_INTERVAL).nth(number + 1);
            progress.paint_part(part, next.unwrap_or_default());
            if !progress.look() {
                break;
            }
        }
        progress.coverage
    }
}

impl<L: Lanes, P: PixelPath> Progress<'_, '_, L, P> {
    /// Looks which pixels are in work; `false` if none is.
    #[inline(always)]
    fn look(&mut self) -> bool {
        if self.painting.counts {
            return !self.tile.is_finished();
        }
        self.tile.look(self.path);
        match self.tile.live_window() {
            Some(live) => {
                self.window = live;
                true
            }
            None => false,
        }
    }

    /// Paints a part of the list, and asks for the memory of the next one.
    #[inline(always)]
    fn paint_part(&mut self, part: &[u32], next: &[u32]) {
        let (seen, count) = self.seen(part);
        let mut ahead = next.iter();
        let each = next.len().div_ceil(count.max(1));
        for indices in seen[..count].chunks(L::WIDE) {
            for (k, (index, rows)) in indices.iter().enumerate() {
                if let Ok(footprint) = &self.painting.footprints[*index as usize] {
                    self.group.read(k, footprint, &rows.intersect(&self.window));
                }
            }
            let widths = self.painting.numbers.rows.widths();
            let together = self.group.compute(self.lanes, &widths, self.corner[0]);
            for (k, (index, _)) in indices.iter().enumerate() {
                // A few at a time: many at once wait for each other.
                for index in ahead.by_ref().take(each) {
                    prefetch(&self.painting.footprints[*index as usize]);
                }
                if !self.group.member(k).is_empty()
                    && let Some((splat, first, second)) = self.fill(&together, k, *index)
                {
                    if self.painting.counts {
                        self.paint_rows::<true>(&splat, first, second);
                    } else {
                        self.paint_rows::<false>(&splat, first, second);
                    }
                }
            }
        }
    }

    /// Those of a part that finished pixels do not hide, with the rows between which these do not, and how many:
    /// nothing is computed of the others.
    #[inline(always)]
    fn seen(&self, part: &[u32]) -> ([(u32, Window); CHECK_INTERVAL], usize) {
        let (mut seen, mut count) = ([(0, self.window); CHECK_INTERVAL], 0);
        for index in part {
            if let Ok(footprint) = &self.painting.footprints[*index as usize]
                && let Some(rows) = self.tile.live_rows(&Window::of(footprint))
            {
                // A part has no more than so many.
                seen[count % CHECK_INTERVAL] = (*index, rows);
                count += 1;
            }
        }
        (seen, count)
    }

    /// Computes the rows of a group's footprint `k`, which has this number: its pixels' numbers, first row and second
    /// difference; `None` if nothing is left to paint of it.
    #[inline(always)]
    fn fill(
        &mut self,
        together: &RowReals<L>,
        k: usize,
        index: u32,
    ) -> Option<(SplatNumbers, u16, i64)> {
        let Painting {
            numbers,
            footprints,
            ..
        } = self.painting;
        // A copy: whoever is called gets no reference into this structure.
        let (left, window) = (self.corner[0], self.window);
        let footprint = footprints[index as usize].as_ref().ok()?;
        let of_group = (together, &*self.group, k);
        if let Some(splat) = numbers.splat(footprint)
            && self.path.fits(&splat)
            && let Some((first, second)) =
                (self.batch).fill(&numbers.rows, of_group, footprint, (&window, left))
        {
            return Some((splat, first, second));
        }
        self.coverage += (self.scalar)(index, self.tile);
        None
    }

    /// Paints the rows of the batch, of which the first has this number and all this second difference.
    #[inline(always)]
    fn paint_rows<const COUNTS: bool>(&mut self, splat: &SplatNumbers, first: u16, second: i64) {
        let [left, top] = self.corner;
        let splat = self.path.splat(splat, second);
        let (first, count) = (usize::from(first.wrapping_sub(top)), self.batch.rows());
        for block in self.batch.touched() {
            let runs = self.batch.block(block);
            let live = (&*self.tile, first);
            let [mut left_over, long] = self.live.find(self.lanes, (runs, count), live, left);
            let rows = self.tile.rows();
            // If all runs are short; a choice row by row is foreseen by no branch. The tile's last row has none behind
            // it.
            if P::TAKES_TWO && !COUNTS && long == 0 {
                let mut alone = 0;
                while left_over != 0 {
                    let row = left_over.trailing_zeros() as usize;
                    if let Some(rows) = rows[(first + row) % ROWS..].first_chunk_mut() {
                        self.path.paint_two(&splat, &self.live.two(runs, row), rows);
                    } else {
                        alone = 1 << row;
                    }
                    left_over &= !(3 << row);
                }
                left_over = alone;
            }
            while left_over != 0 {
                let row = left_over.trailing_zeros() as usize;
                left_over &= left_over - 1;
                let run = self.live.run(runs, row);
                let pixels = &mut rows[(first + row) % ROWS];
                if COUNTS {
                    self.coverage.visited += run.length as u64;
                }
                (self.path).paint::<COUNTS>(&splat, &run, pixels, &mut self.coverage);
            }
        }
    }
}
