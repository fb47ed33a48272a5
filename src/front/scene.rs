//! Scenes that were converted once: splats in the kernel's own types, in lent memory or in flash.
//!
//! A [`Gaussian`](crate::Gaussian) given to a renderer is converted for every picture: rotation matrix, axes and
//! exponents in soft float, more than setup itself on a processor without floating point. A scene that moves its camera
//! and not its splats converts them once, in memory of 92 bytes a splat ([`Scene`]), or comes converted: 24 bytes a
//! splat, constants in flash ([`CompactScene`], written by `splatline bake`).

use crate::math::SoftFloat;
use crate::splat::{Axis, Position, VolumeSplat};
use crate::view::{Eye, Pose};
use fixed::types::U4F28;

/// Splats by number, for a renderer that asks for them in its own order.
pub trait Splats<P: Pose> {
    /// How many there are.
    fn len(&self) -> usize;

    /// Is there none?
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A splat's centre; `None` from [`len`](Splats::len) on.
    fn centre(&self, number: usize) -> Option<P::Centre>;

    /// A splat; `None` from [`len`](Splats::len) on.
    fn splat(&self, number: usize) -> Option<VolumeSplat<P::Centre>>;
}

impl<P: Pose> Splats<P> for [VolumeSplat<P::Centre>] {
    fn len(&self) -> usize {
        <[_]>::len(self)
    }

    #[inline(always)]
    fn centre(&self, number: usize) -> Option<P::Centre> {
        self.get(number).map(|splat| splat.centre)
    }

    #[inline(always)]
    fn splat(&self, number: usize) -> Option<VolumeSplat<P::Centre>> {
        self.get(number).copied()
    }
}

/// Converted splats in memory that the caller lends.
///
/// ```
/// use splatline::front::{PackedList, Scene, packed_words};
/// use splatline::splat::VolumeSplat;
/// use splatline::{Camera, Gaussian, Micro16, Pixel, Renderer};
///
/// let gaussians = [Gaussian { scales: [0.3; 3], ..Gaussian::UNIT }; 4];
/// let mut memory = [VolumeSplat::EMPTY; 4];
/// let scene = Scene::collect(&mut memory, gaussians.iter().map(Gaussian::splat))?; // Once.
///
/// let renderer = Renderer::new(Micro16);
/// let mut words = [0; 4 * packed_words(&Micro16::WIDTHS)]; // 36 bytes a footprint.
/// let mut list = PackedList::new(Micro16, &mut words);
/// let mut pixels = [Pixel::EMPTY; 64 * 8];
/// for x in [0.0, 0.5] { // For every picture.
///     let view = Camera::look_at([x, 0.0, -4.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [64, 48])?.view()?;
///     renderer.set_up_scene(&view, &scene, &mut list)?;
///     for window in view.window().strips(8) {
///         let strip = renderer.draw(&list, window, &mut pixels)?;
///         assert_eq!(strip.rgb565(0).count(), 64 * 8);
///     }
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    splats: &'a [VolumeSplat],
    invalid: u32,
}

/// The scene does not fit the memory lent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SceneFull {
    /// Splats for which there is room.
    pub capacity: usize,
    /// Splats of the scene.
    pub needed: usize,
}

impl<'a> Scene<'a> {
    /// Keeps the splats; those that are `None`, because a number of theirs is not finite, are left out and counted.
    pub fn collect(
        memory: &'a mut [VolumeSplat],
        splats: impl IntoIterator<Item = Option<VolumeSplat>>,
    ) -> Result<Self, SceneFull> {
        let (mut used, mut invalid) = (0usize, 0u32);
        for splat in splats {
            let Some(splat) = splat else {
                invalid = invalid.saturating_add(1);
                continue;
            };
            if let Some(place) = memory.get_mut(used) {
                *place = splat;
            }
            used = used.saturating_add(1);
        }
        let capacity = memory.len();
        let memory: &'a [VolumeSplat] = memory;
        match memory.get(..used) {
            Some(splats) => Ok(Scene { splats, invalid }),
            None => Err(SceneFull {
                capacity,
                needed: used,
            }),
        }
    }

    /// The splats.
    pub fn splats(&self) -> &'a [VolumeSplat] {
        self.splats
    }

    /// Splats that were left out because they were `None`.
    pub fn invalid(&self) -> u32 {
        self.invalid
    }
}

impl Splats<Eye> for Scene<'_> {
    fn len(&self) -> usize {
        self.splats.len()
    }

    #[inline(always)]
    fn centre(&self, number: usize) -> Option<Position> {
        Splats::<Eye>::centre(self.splats, number)
    }

    #[inline(always)]
    fn splat(&self, number: usize) -> Option<VolumeSplat> {
        Splats::<Eye>::splat(self.splats, number)
    }
}

/// Bytes of a splat in a [`CompactScene`].
pub const COMPACT_BYTES: usize = 24;

/// A splat of a [`CompactScene`], little-endian:
///
/// | bytes | what |
/// |---|---|
/// | 0 to 5 | centre: three i16 in units of the scene's grid, from its origin |
/// | 6 to 17 | six i16: the Cholesky factor of the covariance, columns (l11, l21, l31), (l22, l32), (l33) |
/// | 18, 19 | u16: the columns' exponents above the scene's, 5 bits each, the first column's lowest |
/// | 20 to 22 | red, green, blue in units of the scene |
/// | 23 | opacity at the centre in 255ths |
pub type CompactSplat = [u8; COMPACT_BYTES];

/// A scene in 24 bytes a splat, for constants in flash: what `splatline bake` writes. For rules with peak opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompactScene<'a> {
    /// Where the grid of the centres begins, in its units.
    pub origin: [i32; 3],
    /// Power of two of the grid's unit, in scene units.
    pub exponent: i32,
    /// Power of two of a factor of the smallest columns, in scene units.
    pub axis_exponent: i32,
    /// A unit of a colour channel, UQ4.28.
    pub colour_unit: u32,
    /// The splats.
    pub splats: &'a [CompactSplat],
}

/// The first bytes of a file of a [`CompactScene`], with its version.
pub const COMPACT_MAGIC: [u8; 8] = *b"splat24\x01";

/// Bytes before the splats in a file of a [`CompactScene`]: [`COMPACT_MAGIC`], then seven little-endian words of 32
/// bits: the three of [`origin`](CompactScene::origin), [`exponent`](CompactScene::exponent),
/// [`axis_exponent`](CompactScene::axis_exponent), [`colour_unit`](CompactScene::colour_unit) and the number of splats.
pub const COMPACT_HEADER: usize = 36;

impl<'a> CompactScene<'a> {
    /// A scene in the bytes of a file (`include_bytes!`, or memory-mapped flash); `None` if they are not one, whole.
    pub fn read(bytes: &'a [u8]) -> Option<Self> {
        let (header, rest) = bytes.split_at_checked(COMPACT_HEADER)?;
        let (magic, header) = header.split_at_checked(COMPACT_MAGIC.len())?;
        if magic != COMPACT_MAGIC {
            return None;
        }
        let mut words = header
            .as_chunks()
            .0
            .iter()
            .map(|word| i32::from_le_bytes(*word));
        let mut next = || words.next().unwrap_or_default();
        let origin = [next(), next(), next()];
        let (exponent, axis_exponent, colour_unit) = (next(), next(), next() as u32);
        let count = usize::try_from(next() as u32).ok()?;
        let (splats, rest) = rest.as_chunks();
        (splats.len() == count && rest.is_empty()).then_some(CompactScene {
            origin,
            exponent,
            axis_exponent,
            colour_unit,
            splats,
        })
    }
}

impl Splats<Eye> for CompactScene<'_> {
    fn len(&self) -> usize {
        self.splats.len()
    }

    #[inline]
    fn centre(&self, number: usize) -> Option<Position> {
        let [x0, x1, y0, y1, z0, z1, ..] = *self.splats.get(number)?;
        let [x, y, z] = self.origin;
        let coordinate = |origin: i32, bytes| SoftFloat {
            mantissa: origin.wrapping_add(i16::from_le_bytes(bytes).into()),
            exponent: self.exponent,
        };
        Some([
            coordinate(x, [x0, x1]),
            coordinate(y, [y0, y1]),
            coordinate(z, [z0, z1]),
        ])
    }

    #[inline]
    fn splat(&self, number: usize) -> Option<VolumeSplat> {
        let centre = self.centre(number)?;
        let [
            ..,
            a0,
            a1,
            b0,
            b1,
            c0,
            c1,
            d0,
            d1,
            e0,
            e1,
            f0,
            f1,
            x0,
            x1,
            red,
            green,
            blue,
            opacity,
        ] = *self.splats.get(number)?;
        let factor = |low, high| i32::from(i16::from_le_bytes([low, high])) << 16;
        let exponents = u16::from_le_bytes([x0, x1]);
        let column = |mantissa: [i32; 3], place: u32| Axis {
            mantissa,
            exponent: self
                .axis_exponent
                .wrapping_sub(16)
                .wrapping_add(i32::from(exponents >> (5 * place) & 31)),
        };
        let channel = |value: u8| U4F28::from_bits(self.colour_unit.wrapping_mul(value.into()));
        Some(VolumeSplat {
            centre,
            axes: [
                column([factor(a0, a1), factor(b0, b1), factor(c0, c1)], 0),
                column([0, factor(d0, d1), factor(e0, e1)], 1),
                column([0, 0, factor(f0, f1)], 2),
            ],
            // 255ths: 2^31 / 255 has its bits in every byte.
            weight: SoftFloat::from_wide(i64::from(u32::from(opacity) * 0x0080_8080), -31, 31),
            colour: [channel(red), channel(green), channel(blue)],
        })
    }
}

impl core::fmt::Display for SceneFull {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let SceneFull { capacity, needed } = self;
        write!(
            f,
            "there is room for {capacity} splats, but the scene has {needed}: lend more"
        )
    }
}

impl core::error::Error for SceneFull {}
