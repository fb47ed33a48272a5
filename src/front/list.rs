//! The display list: the footprints of a picture and the order in which they are drawn.
//!
//! A picture is set up once and drawn as often as it has strips, so that its footprints have to stay somewhere. Either
//! in a list of fixed room ([`BoundedList`]: a static, or a local variable), or in memory lent at run time
//! ([`LentList`]). A list that is full is an error that says how much room the picture needs; no splat is dropped for
//! want of it.

use super::order::sort_by_key;
use crate::footprint::Footprint;
use crate::raster::Window;
use crate::rules::Compositing;

/// The visible splats do not fit the display list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ListFull {
    /// Footprints for which the list has room.
    pub capacity: usize,
    /// Footprints that the picture has: all of them from a renderer, one more than there is room for from
    /// [`DisplayList::push`].
    pub needed: usize,
}

impl core::fmt::Display for ListFull {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let ListFull { capacity, needed } = self;
        write!(
            f,
            "the display list has room for {capacity} footprints, but the picture has {needed}: lend more"
        )
    }
}

impl core::error::Error for ListFull {}

/// What a renderer draws: footprints in drawing order, however they are kept.
pub trait Footprints {
    /// Do its footprints have a conic? Without, they are drawn by spans alone.
    const CONIC: bool = true;

    /// Calls `draw` with every footprint that has rows in `window`: nearest first, or farthest first for
    /// [`Compositing::BackToFront`].
    fn visit(&self, window: &Window, compositing: Compositing, draw: impl FnMut(&Footprint));
}

impl<L: DisplayList> Footprints for L {
    #[inline(always)]
    fn visit(&self, window: &Window, compositing: Compositing, mut draw: impl FnMut(&Footprint)) {
        for footprint in self.in_order(compositing) {
            // Preparing the rows of a footprint costs more than a look at its box.
            if footprint.first[1] < window.end[1] && footprint.end[1] > window.first[1] {
                draw(footprint);
            }
        }
    }
}

/// Footprints in the order in which they came, and their numbers in drawing order.
pub trait DisplayList {
    /// Forgets all footprints.
    fn clear(&mut self);

    /// Adds a footprint behind all others. A full list stays as it is.
    fn push(&mut self, footprint: &Footprint) -> Result<(), ListFull>;

    /// The footprints, in the order in which they came.
    fn footprints(&self) -> &[Footprint];

    /// Numbers of the footprints, nearest first once the list is [sorted](DisplayList::sort).
    fn order(&self) -> &[u32];

    /// Footprints, and their numbers to be put in order.
    fn parts(&mut self) -> (&[Footprint], &mut [u32]);

    /// Sorts by depth, nearest first, ties by the order in which footprints came: the order of the kernel's other front
    /// ends.
    fn sort(&mut self) {
        let (footprints, order) = self.parts();
        sort_by_key(order, |number| {
            let depth = footprints
                .get(number as usize)
                .map_or(u64::MAX, |f| f.depth);
            (depth, number)
        });
    }

    /// The footprints in drawing order: nearest first, or farthest first for [`Compositing::BackToFront`].
    fn in_order(&self, compositing: Compositing) -> impl Iterator<Item = &Footprint> {
        let backwards = compositing == Compositing::BackToFront;
        let (order, count) = (self.order(), self.order().len());
        let footprints = self.footprints();
        (0..count).filter_map(move |place| {
            let place = if backwards { count - 1 - place } else { place };
            footprints.get(*order.get(place)? as usize)
        })
    }
}

/// A display list with room for `N` footprints, 108 bytes each, of its own.
#[derive(Clone, Debug, Default)]
pub struct BoundedList<const N: usize> {
    footprints: heapless::Vec<Footprint, N>,
    order: heapless::Vec<u32, N>,
}

impl<const N: usize> BoundedList<N> {
    /// An empty list; for a static, too.
    pub const fn new() -> Self {
        BoundedList {
            footprints: heapless::Vec::new(),
            order: heapless::Vec::new(),
        }
    }
}

impl<const N: usize> DisplayList for BoundedList<N> {
    fn clear(&mut self) {
        self.footprints.clear();
        self.order.clear();
    }

    fn push(&mut self, footprint: &Footprint) -> Result<(), ListFull> {
        let number = self.footprints.len();
        let full = ListFull {
            capacity: N,
            needed: number.saturating_add(1),
        };
        let Ok(place) = u32::try_from(number) else {
            return Err(full);
        };
        // Both have the same room and the same length.
        self.footprints.push(*footprint).map_err(|_| full)?;
        self.order.push(place).map_err(|_| full)
    }

    fn footprints(&self) -> &[Footprint] {
        &self.footprints
    }

    fn order(&self) -> &[u32] {
        &self.order
    }

    fn parts(&mut self) -> (&[Footprint], &mut [u32]) {
        (&self.footprints, &mut self.order)
    }
}

/// A display list in memory that the caller lends.
#[derive(Debug)]
pub struct LentList<'a> {
    footprints: &'a mut [Footprint],
    order: &'a mut [u32],
    used: usize,
}

impl<'a> LentList<'a> {
    /// An empty list with room for as many footprints as the shorter of both has entries, at most `u32::MAX`. What the
    /// memory holds is of no account; [`Footprint::EMPTY`] fills it.
    pub fn new(footprints: &'a mut [Footprint], order: &'a mut [u32]) -> Self {
        LentList {
            footprints,
            order,
            used: 0,
        }
    }
}

impl DisplayList for LentList<'_> {
    fn clear(&mut self) {
        self.used = 0;
    }

    fn push(&mut self, footprint: &Footprint) -> Result<(), ListFull> {
        let full = ListFull {
            capacity: self.footprints.len().min(self.order.len()),
            needed: self.used.saturating_add(1),
        };
        let number = u32::try_from(self.used).map_err(|_| full)?;
        let place = self.footprints.get_mut(self.used);
        let (Some(place), Some(entry)) = (place, self.order.get_mut(self.used)) else {
            return Err(full);
        };
        *place = *footprint;
        *entry = number;
        self.used += 1;
        Ok(())
    }

    fn footprints(&self) -> &[Footprint] {
        self.footprints.get(..self.used).unwrap_or_default()
    }

    fn order(&self) -> &[u32] {
        self.order.get(..self.used).unwrap_or_default()
    }

    fn parts(&mut self) -> (&[Footprint], &mut [u32]) {
        let footprints = self.footprints.get(..self.used).unwrap_or_default();
        let order = self.order.get_mut(..self.used).unwrap_or_default();
        (footprints, order)
    }
}
