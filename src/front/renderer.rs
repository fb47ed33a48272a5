//! The renderer: cull, set up, sort by depth, draw; the stages chained with the table that belongs to the design.

use super::packed::{KEY, fits};
use super::{
    Counts, DisplayList, Footprints, Frame, ListFull, PackedList, PixelReader, Primitive, Rejected,
    Splats, sort_by_key,
};
use crate::blend::{Blend, Pixel};
use crate::draw::{Coverage, NarrowRun, Painter, Painter32};
use crate::footprint::{Footprint, depth};
use crate::format::{Design, Traversal, Widths};
use crate::kernel::{
    FootprintTable, Kernel, PackedTable, TableSizeError, Tabled, table_4, table_16,
};
use crate::raster::Window;
use crate::rules::{Compositing, Rules};
use crate::setup::{Cull, depth_of, setup_for_spans};
use crate::target::{Target, TargetError};
use crate::view::{Pose, View};

/// Everything that is constant for a picture. Draws nearest first by spans unless told otherwise.
///
/// Where the design's words allow it ([`Micro16`](crate::Micro16)), spans are drawn nearest first by a loop of 32-bit
/// words ([`Painter32`]): the same bits from footprints of setup.
///
/// ```
/// use splatline::{BoundedList, Camera, Gaussian, Pixel, Renderer, Standard24};
///
/// // A strip of eight rows at a time: 64 x 8 pixels of memory for a picture of 64 x 48.
/// let view = Camera::look_at([0.0, 0.0, -4.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [64, 48])?.view()?;
/// let scene = [Gaussian { scales: [0.5; 3], ..Gaussian::UNIT }];
/// let renderer = Renderer::new(Standard24);
/// let mut list = BoundedList::<8>::new();
/// renderer.set_up(&view, &scene, &mut list)?;
/// let mut pixels = [Pixel::default(); 64 * 8];
/// for window in view.window().strips(8) {
///     let strip = renderer.draw(&list, window, &mut pixels)?;
///     assert_eq!(strip.rgb565(0).count(), 64 * 8); // Sent to a display here.
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Renderer<'t, D> {
    design: D,
    rules: Rules,
    table: FootprintTable<'t>,
    packed: Option<PackedTable<'static>>,
    compositing: Compositing,
    traversal: Traversal,
}

/// The design has no table for these rules: another kernel than the Gaussian, or a range that is neither 2 nor 4.
///
/// [`Renderer::with_table`] takes a table in lent memory, filled by [`fill`](crate::kernel::fill).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoTable {
    /// The rules' kernel.
    pub kernel: Kernel,
    /// The rules' range.
    pub table_range: u8,
}

/// Why a picture could not be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RenderError {
    /// The visible splats do not fit the display list.
    ListFull(ListFull),
    /// The pixels do not fit the memory lent.
    Target(TargetError),
}

impl<D: Tabled> Renderer<'static, D> {
    /// 3D Gaussian splatting ([`Rules::GAUSSIAN_3D`]) with the design's own table.
    #[inline]
    pub const fn new(design: D) -> Self {
        Renderer::of(design, Rules::GAUSSIAN_3D, table_16::<D>()).with_packed(D::PACKED_16)
    }

    /// EWA volume splatting ([`Rules::EWA`]) with the design's own table.
    #[inline]
    pub const fn ewa(design: D) -> Self {
        Renderer::of(design, Rules::EWA, table_4::<D>())
    }

    /// Any rules whose kernel is the Gaussian, with the design's own table.
    #[inline]
    pub const fn with_rules(design: D, rules: Rules) -> Result<Self, NoTable> {
        match (rules.kernel, rules.table_range) {
            (Kernel::Gaussian, 2) => Ok(Renderer::of(design, rules, table_4::<D>())),
            (Kernel::Gaussian, 4) => {
                let renderer = Renderer::of(design, rules, table_16::<D>());
                Ok(renderer.with_packed(D::PACKED_16))
            }
            (kernel, table_range) => Err(NoTable {
                kernel,
                table_range,
            }),
        }
    }
}

impl<'t, D: Design> Renderer<'t, D> {
    #[inline(always)]
    const fn of(design: D, rules: Rules, table: FootprintTable<'t>) -> Self {
        Renderer {
            design,
            rules,
            table,
            packed: None,
            compositing: Compositing::FrontToBack,
            traversal: Traversal::Spans,
        }
    }

    #[inline(always)]
    const fn with_packed(self, packed: Option<PackedTable<'static>>) -> Self {
        Renderer { packed, ..self }
    }

    /// Any design and rules with a table in memory of the caller's, [`entries`](crate::kernel::entries) of the widths
    /// long and filled for the same widths, kernel and `table_range` by [`fill`](crate::kernel::fill).
    pub fn with_table(design: D, rules: Rules, entries: &'t [u32]) -> Result<Self, TableSizeError> {
        let table = FootprintTable::new(entries, &design.widths(), rules.table_range)?;
        Ok(Renderer::of(design, rules, table))
    }

    /// The same with another order or operator of compositing.
    #[inline]
    pub const fn with_compositing(mut self, compositing: Compositing) -> Self {
        self.compositing = compositing;
        self
    }

    /// The same with another traversal.
    #[inline]
    pub const fn with_traversal(mut self, traversal: Traversal) -> Self {
        self.traversal = traversal;
        self
    }

    /// The rules of blending.
    pub const fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Culls and sets up a scene: `list` afterwards holds its footprints, and only them, in drawing order.
    ///
    /// If they do not all fit the list is left empty, and the error says how many there are.
    pub fn set_up<P: Pose, S: Primitive<P, Footprint = Footprint>>(
        &self,
        view: &View<P>,
        scene: impl IntoIterator<Item = S>,
        list: &mut impl DisplayList,
    ) -> Result<Counts, ListFull> {
        list.clear();
        let counts = self.add(view, scene, list)?;
        list.sort();
        Ok(counts)
    }

    /// The same for a scene of several kinds of primitives: adds to what the list holds; [`DisplayList::sort`] is the
    /// caller's to call when all are added. A list that is full is left empty.
    pub fn add<P: Pose, S: Primitive<P, Footprint = Footprint>>(
        &self,
        view: &View<P>,
        scene: impl IntoIterator<Item = S>,
        list: &mut impl DisplayList,
    ) -> Result<Counts, ListFull> {
        let mut counts = Counts::default();
        let mut full: Option<ListFull> = None;
        for splat in scene {
            match splat.set_up(self.design, view, &self.rules) {
                Ok(footprint) => {
                    counts.drawn = counts.drawn.saturating_add(1);
                    match &mut full {
                        Some(full) => full.needed = full.needed.saturating_add(1),
                        None => full = list.push(&footprint).err(),
                    }
                }
                Err(reason) => counts.reject(reason),
            }
        }
        match full {
            None => Ok(counts),
            Some(full) => {
                list.clear();
                Err(full)
            }
        }
    }

    /// Culls, sorts and sets up a scene that was converted before: `list` afterwards holds its footprints, and only
    /// them, in drawing order; ties are drawn in the order of the scene. For traversal by spans: a splat whose conic
    /// has no place in a packet is not culled for it. One that an entry has no bits for, thinner than 2^-64 pixels or
    /// centred at 2^26, is culled as out of [range](crate::setup::Cull::Range).
    ///
    /// A key of 12 bytes for every splat between near and far has to fit the list's memory before the footprints take
    /// its place. If either does not fit, the list is left empty, and the error says how many footprints long a list is
    /// that has room for it: first for the keys, then for both.
    pub fn set_up_scene<P: Pose>(
        &self,
        view: &View<P>,
        scene: &(impl Splats<P> + ?Sized),
        list: &mut PackedList<D>,
    ) -> Result<Counts, ListFull> {
        list.begin(view.viewport);
        let widths = self.design.widths();
        let mut counts = Counts::default();
        let (entry, capacity) = (list.entry(), list.capacity());
        let full = |needed| ListFull { capacity, needed };
        let keys = self.sort_keys(view, scene, list, &mut counts);
        let keys = keys.map_err(|keys| full(keys.saturating_mul(KEY).div_ceil(entry)))?;
        let (mut needed, end) = (0, list.words.len());
        for rest in (0..keys).rev() {
            // Of the keys, which end with the memory, `rest` are still to come.
            let unread = end.saturating_sub(rest.saturating_mul(KEY));
            let number = list.words.get(unread.wrapping_sub(1)).copied();
            let splat = number.and_then(|number| scene.splat(number as usize));
            let Some(splat) = splat else {
                counts.reject(Rejected::Invalid);
                continue;
            };
            match setup_for_spans(self.design, view, &self.rules, &splat) {
                Err(reason) => counts.reject(Rejected::Culled(reason)),
                Ok(footprint) if !fits(&widths, &footprint) => {
                    counts.reject(Rejected::Culled(Cull::Range));
                }
                Ok(footprint) => {
                    counts.drawn = counts.drawn.saturating_add(1);
                    if needed > 0 || list.push(&footprint, unread).is_none() {
                        let keys = rest.saturating_mul(KEY).div_ceil(entry);
                        needed = needed.max(keys.saturating_add(counts.drawn as usize));
                    }
                }
            }
        }
        if needed > 0 {
            list.clear();
            return Err(full(needed));
        }
        Ok(counts)
    }

    /// Depth and number of every splat between near and far, nearest first, at the end of the list's memory; how many
    /// there are, as an error if they do not fit.
    fn sort_keys<P: Pose>(
        &self,
        view: &View<P>,
        scene: &(impl Splats<P> + ?Sized),
        list: &mut PackedList<D>,
        counts: &mut Counts,
    ) -> Result<usize, usize> {
        let widths = self.design.widths();
        let room = list.words.as_chunks_mut::<KEY>().0.len();
        let start = list.words.len().wrapping_sub(room.wrapping_mul(KEY));
        let keys = list
            .words
            .get_mut(start..)
            .unwrap_or_default()
            .as_chunks_mut()
            .0;
        let mut used = 0usize;
        for number in 0..scene.len() {
            let Some(centre) = scene.centre(number) else {
                counts.reject(Rejected::Invalid);
                continue;
            };
            match depth_of(&widths, view, &centre) {
                Err(reason) => counts.reject(Rejected::Culled(reason)),
                Ok(depth) => {
                    let depth = depth::key(depth);
                    used = used.saturating_add(1);
                    if let Some(key) = room.checked_sub(used).and_then(|place| keys.get_mut(place))
                    {
                        *key = [(depth >> 16) as u32, depth as u32 & 0xffff, number as u32];
                    }
                }
            }
        }
        let first = room.checked_sub(used).ok_or(used)?;
        sort_by_key(
            keys.get_mut(first..).unwrap_or_default(),
            |key: [u32; KEY]| key,
        );
        Ok(used)
    }

    /// Draws the part of the picture that `window` selects into `pixels`, which need not be cleared and hold its rows
    /// without gaps afterwards. A picture is the same, bit for bit, however it is cut into windows.
    pub fn draw<'p, L: Footprints>(
        &self,
        list: &L,
        window: Window,
        pixels: &'p mut [Pixel],
    ) -> Result<Frame<'p>, TargetError> {
        self.draw_with(list, window, pixels, |painter, run| painter.paint(run))
    }

    /// [`draw`](Renderer::draw) with a pixel loop of one's own, which does with a run what [`Painter32::paint`] does,
    /// where runs of 32-bit words are drawn; elsewhere it is not called.
    pub fn draw_with<'p, L: Footprints>(
        &self,
        list: &L,
        window: Window,
        pixels: &'p mut [Pixel],
        paint: impl Fn(Painter32<'static, D>, NarrowRun),
    ) -> Result<Frame<'p>, TargetError> {
        let widths = self.design.widths();
        let needed = window.pixels();
        let found = pixels.len();
        let Some(pixels) = pixels.get_mut(..needed) else {
            return Err(TargetError { needed, found });
        };
        let mut target = Target::new(pixels, window, window.columns().into())?;
        target.clear(&widths);
        let (coverage, bounded) = match self.narrow(L::CONIC) {
            Some(painter) => {
                let mut drawn = Drawn::default();
                list.visit(&window, Compositing::FrontToBack, |footprint| {
                    drawn.note(&footprint.colour, &widths);
                    painter.draw_with(footprint, &mut target, &paint)
                });
                (None, drawn.is_bounded(&widths))
            }
            None => (Some(self.paint(list, &mut target)), false),
        };
        Ok(Frame {
            pixels,
            window,
            coverage,
            reader: PixelReader::new(&widths).where_bounded(bounded),
        })
    }

    /// The painter with the loop of 32-bit words, for rules that blend as [`Rules::GAUSSIAN_3D`] does.
    ///
    /// The loop sees those rules as constants; with others in its registers it would lose what it gains.
    #[inline(always)]
    fn narrow(&self, by_box: bool) -> Option<Painter32<'static, D>> {
        const RULES: &Rules = &Rules::GAUSSIAN_3D;
        let widths = self.design.widths();
        let by_spans = self.traversal == Traversal::Spans || !by_box;
        let alike = by_spans
            && self.compositing == Compositing::FrontToBack
            && Blend::new(&widths, &self.rules) == Blend::new(&widths, RULES);
        let packed = self.packed.filter(|_| alike)?;
        Painter32::new(self.design, RULES, packed).ok()
    }

    /// Draws the list over what the target holds, by the painter that counts what it visits.
    pub fn paint<L: Footprints>(&self, list: &L, target: &mut Target) -> Coverage {
        let Renderer {
            design,
            rules,
            table,
            compositing,
            traversal,
            ..
        } = self;
        let traversal = if L::CONIC {
            *traversal
        } else {
            Traversal::Spans
        };
        let painter = Painter::new(*design, rules, *table, *compositing, traversal);
        let window = target.window();
        let mut coverage = Coverage::default();
        list.visit(&window, *compositing, |footprint| {
            coverage += painter.draw(footprint, target)
        });
        coverage
    }

    /// [`set_up`](Renderer::set_up) and [`draw`](Renderer::draw) of the whole frame.
    pub fn render<'p, P: Pose, S: Primitive<P, Footprint = Footprint>>(
        &self,
        view: &View<P>,
        scene: impl IntoIterator<Item = S>,
        list: &mut impl DisplayList,
        pixels: &'p mut [Pixel],
    ) -> Result<(Frame<'p>, Counts), RenderError> {
        let counts = self.set_up(view, scene, list)?;
        let frame = self.draw(list, view.window(), pixels)?;
        Ok((frame, counts))
    }
}

impl From<ListFull> for RenderError {
    fn from(full: ListFull) -> Self {
        RenderError::ListFull(full)
    }
}

impl From<TargetError> for RenderError {
    fn from(error: TargetError) -> Self {
        RenderError::Target(error)
    }
}

impl core::fmt::Display for NoTable {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let NoTable {
            kernel,
            table_range,
        } = self;
        write!(
            f,
            "no table of the design's own for kernel {kernel:?} and range {table_range}: lend one by Renderer::with_table"
        )
    }
}

impl core::fmt::Display for RenderError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            RenderError::ListFull(full) => full.fmt(f),
            RenderError::Target(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for NoTable {}
impl core::error::Error for RenderError {}

/// What was drawn into a frame, of which follows whether channels can exceed 1 - T.
#[derive(Clone, Copy, Default)]
struct Drawn {
    layers: u32,
    bright: bool,
}

impl Drawn {
    #[inline(always)]
    fn note(&mut self, colour: &[u32; 3], widths: &Widths) {
        self.bright |= colour.iter().any(|c| *c > 1 << widths.colour);
        self.layers = self.layers.saturating_add(1);
    }

    /// See [`PixelReader::where_bounded`].
    fn is_bounded(self, widths: &Widths) -> bool {
        widths.transmittance < 26 && !self.bright && self.layers <= bounded_layers(widths)
    }
}

/// Layers of colours up to 1 after which a channel is above 1 - T by less than half of a display's 63rd: each rounds a
/// sum up by half a unit at most, and by nothing where sums have the bits of their products.
fn bounded_layers(widths: &Widths) -> u32 {
    if widths.accumulator == widths.transmittance + widths.colour {
        return u32::MAX;
    }
    1 << widths.accumulator >> 6
}

#[test]
fn rounded_sums_are_bounded_for_so_many_layers() {
    use crate::format::{Lean18, Micro16};
    let exact = Micro16::WIDTHS;
    assert_eq!(bounded_layers(&exact), u32::MAX);
    for accumulator in [exact.accumulator - 1, exact.transmittance - exact.colour] {
        let widths = Widths {
            accumulator,
            ..exact
        };
        assert_eq!(bounded_layers(&widths), (1 << accumulator) / 64);
    }
    // Half a unit each, 63 levels, less than half a level.
    let most = bounded_layers(&Lean18::WIDTHS);
    assert!(63 * most < 1 << Lean18::WIDTHS.accumulator);

    let one = 1 << Lean18::WIDTHS.colour;
    let drawn = |layers: u32, colour: u32, transmittance: u8| {
        let widths = Widths {
            transmittance,
            ..Lean18::WIDTHS
        };
        let mut drawn = Drawn::default();
        drawn.note(&[0, colour, 1], &widths);
        for _ in 1..layers {
            drawn.note(&[one; 3], &widths);
        }
        drawn.is_bounded(&widths)
    };
    assert!(drawn(most, one, 25));
    assert!(!drawn(most + 1, one, 25));
    assert!(!drawn(1, one, 26));
    assert!(!drawn(1, one + 1, 25));
}
