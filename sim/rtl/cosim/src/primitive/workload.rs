//! What is drawn: tiles of footprints from scenes, and footprints made from random numbers.

use crate::order::{OrderLoad, ordered};
use crate::package::TILE;
use crate::scenes::Seen;
use anyhow::Result;
use splatline::float;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::math::SoftFloat;
use splatline::raster::Window;
use splatline::setup::{Covariance2d, ldl};
use splatline_sim::design::DesignChoice;
use splatline_sim::reference::golden;
use splatline_sim::rules::Rules;
use splatline_sim::scene::synthetic::Random;

/// A window within one block of the tile buffer, and the footprints to be drawn there, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchTile {
    /// The pixels.
    pub window: Window,
    /// Indices of footprints.
    pub list: Vec<u32>,
}

impl BenchTile {
    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [0, 1].map(|axis| usize::from(self.window.end[axis] - self.window.first[axis]))
    }
}

/// Footprints and the tiles that draw them.
pub struct BenchWorkload {
    /// Footprints.
    pub footprints: Vec<Footprint>,
    /// Tiles.
    pub tiles: Vec<BenchTile>,
}

/// The hard Gaussians of the golden set: needles, huge, near the plane, off the axis.
pub fn hard() -> Result<Seen> {
    let set = golden::GoldenA::load(&golden::archive())?;
    Ok(Seen {
        name: "hard",
        scene: set.scene(golden::ALL),
        camera: set.camera,
    })
}

/// Tiles over the whole picture of a scene.
pub fn picture(seen: &Seen, design: &DesignChoice, rules: &Rules) -> BenchWorkload {
    let (footprints, _, OrderLoad { size, lists, .. }) = ordered(seen, design, rules);
    let viewport = [seen.camera.width, seen.camera.height].map(|size| size as u16);
    let tile = |(index, list): (u16, Vec<u32>)| {
        let first = [index % size[0] * TILE[0], index / size[0] * TILE[1]];
        let end = [0, 1].map(|axis| (first[axis] + TILE[axis]).min(viewport[axis]));
        let window = Window { first, end };
        BenchTile { window, list }
    };
    let drawn = footprints.into_iter();
    let drawn = drawn.map(|found| found.unwrap_or(Footprint::EMPTY));
    BenchWorkload {
        footprints: drawn.collect(),
        tiles: (0..).zip(lists).map(tile).collect(),
    }
}

/// Random footprints over random windows: from far below a pixel to far beyond the screen, axis ratios to 2^15, every
/// colour, opacity and cut-off that a packet can hold (cut-offs up to setup's limit of 15).
pub fn random(widths: &Widths, count: usize, per_tile: usize, seed: u64) -> BenchWorkload {
    let kinds = [Kind::Any([-4.0, 20.0])];
    random_between(&kinds, widths, [count, per_tile], seed)
}

/// The same where xc has few fraction bits or leaves the fine word: half-widths of up to 2^28 pixels, the largest that
/// setup gives, and needles.
pub fn vast(widths: &Widths, count: usize, seed: u64) -> BenchWorkload {
    let kinds = [Kind::Any([12.0, 26.0]), Kind::Flat, Kind::WordAway];
    random_between(&kinds, widths, [count, 10], seed)
}

/// Columns that the fine word of xc holds: 28 bits before the point of a centre, 8 of which give way to a fraction.
const FINE_WORD: f64 = (1 << 20) as f64;

/// 1/A of a footprint whose half-width lets xc have the fine word, see `centre_fraction` of the kernel.
const FINE_SQUARED_WIDTH: f64 = (1 << 21) as f64;

/// What random footprints are like.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Every angle; the longer axis has a deviation of two to the power of something in this range, in pixels.
    Any([f64; 2]),
    /// Needles along a row: the middle moves by 2^13 columns and more from row to row, where xc has the coarse word.
    Flat,
    /// Needles whose middle lies a whole fine word from the window in its middle row: a middle that wraps would be
    /// drawn.
    WordAway,
}

impl Kind {
    /// Powers of two of the longer axis' deviation and of the axes' ratio, and the least and largest angle to the rows.
    fn ranges(self) -> [[f64; 2]; 3] {
        let all = [0.0, 3.15];
        match self {
            Kind::Any(powers) => [powers, [0.0, 15.0], all],
            Kind::Flat => [[7.0, 11.0], [14.0, 15.0], [0.0, 2f64.powi(-13)]],
            Kind::WordAway => [[18.0, 23.0], [12.0, 15.0], all],
        }
    }

    /// Is an ellipse with this 1/A, this shear and this reach along the rows of the kind?
    fn has(self, squared_width: f64, shear: f64, reach: f64) -> bool {
        let fine = squared_width < FINE_SQUARED_WIDTH;
        match self {
            Kind::Any(_) => true,
            Kind::Flat => fine && shear.abs() >= 2f64.powi(13),
            Kind::WordAway => fine && reach > FINE_WORD,
        }
    }
}

/// Random footprints over random windows, each of one of the kinds in turn.
fn random_between(
    kinds: &[Kind],
    widths: &Widths,
    [count, per_tile]: [usize; 2],
    seed: u64,
) -> BenchWorkload {
    let mut random = WorkloadRandom(Random(seed));
    let (mut footprints, mut tiles) = (Vec::with_capacity(count), Vec::new());
    while footprints.len() < count {
        let block = TILE.map(|size| size * (random.below(2000 / u32::from(size)) as u16));
        let window = random.window(block);
        let list = footprints.len() as u32..(footprints.len() + per_tile) as u32;
        while footprints.len() < list.end as usize {
            footprints.extend(random.footprint(widths, &window, kinds[tiles.len() % kinds.len()]));
        }
        let list = list.collect();
        tiles.push(BenchTile { window, list });
    }
    BenchWorkload { footprints, tiles }
}

/// The farthest centre that is tried, in pixels.
const FARTHEST: f64 = 1e8;

/// Setup keeps the middle of a row nearer than 2^30 pixels. Beyond 2^31 it leaves its word, and circuit and kernel
/// differ.
const FARTHEST_MIDDLE: f64 = 1e9;

struct WorkloadRandom(Random);

impl WorkloadRandom {
    fn bits(&mut self, count: u8) -> u32 {
        (self.0.next() >> (64 - u32::from(count))) as u32
    }

    fn below(&mut self, end: u32) -> u32 {
        ((u64::from(self.bits(32)) * u64::from(end)) >> 32) as u32
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.bits(32)) / 2f64.powi(32)
    }

    /// A part of a block from its first column and row on; in half of the cases all of it.
    fn window(&mut self, block: [u16; 2]) -> Window {
        let whole = self.below(2) != 0;
        let end = [0, 1].map(|axis| {
            if whole {
                block[axis] + TILE[axis]
            } else {
                block[axis] + self.below(TILE[axis].into()) as u16 + 1
            }
        });
        Window { first: block, end }
    }

    /// A footprint that touches the window, or nothing if this one cannot be had.
    fn footprint(&mut self, widths: &Widths, window: &Window, kind: Kind) -> Option<Footprint> {
        let [long, ratio, angle] = kind.ranges().map(|[low, high]| self.between(low, high));
        let (long, short) = ((2.0 * long).exp2(), (2.0 * (long - ratio)).exp2());
        let (sine, cosine) = angle.sin_cos();
        let mantissa = widths.mantissa.into();
        // As setup has them, of the design's mantissa: longer ones have no place in the words of `ldl`.
        let rounded = |number: f64| {
            let exact = float::scaled(number);
            SoftFloat::from_wide(exact.mantissa.into(), exact.exponent, mantissa)
        };
        let variance = Covariance2d {
            xx: rounded(long * cosine * cosine + short * sine * sine),
            xy: rounded((long - short) * sine * cosine),
            yy: rounded(long * sine * sine + short * cosine * cosine),
            determinant: rounded(long * short),
        };
        let peak = self.bits(4 + widths.peak) >> self.below(8);
        let cutoff = (self.bits(32) >> self.below(5)).min(15 << 28);
        let radius = f64::from(cutoff).sqrt() / f64::from(1 << 14);
        let slim = (short / long).sqrt();
        let reach = [cosine.hypot(sine * slim), sine.hypot(cosine * slim)];
        let reach = reach.map(|part| part * long.sqrt() * radius);
        let row_variance = long * sine * sine + short * cosine * cosine;
        let shear = (long - short) * sine * cosine / row_variance;
        if !kind.has(long * short / row_variance, shear, reach[0]) {
            return None;
        }
        let colour_bits = widths.colour_range() + widths.colour;
        let mut footprint = Footprint {
            depth: u64::from(self.bits(32)) << 16,
            ldl: ldl(widths, &variance)?,
            cutoff,
            opacity: peak,
            colour: [(); 3].map(|()| self.bits(colour_bits) >> self.below(8)),
            ..Footprint::EMPTY
        };
        // In half of the cases the window lies on the ellipse's rim, which for large ones it would hardly meet by
        // chance.
        let rim = self.below(2) == 0;
        let (along, across) = self.between(0.0, 6.3).sin_cos();
        let (along, across) = (along * long.sqrt() * radius, across * short.sqrt() * radius);
        let point = [
            along * cosine - across * sine,
            along * sine + across * cosine,
        ];
        let mut centres = [0.0; 2];
        for axis in 0..2 {
            let middle = f64::from(window.first[axis] + window.end[axis]) / 2.0;
            let size = f64::from(TILE[axis]);
            let spot = self.between(-1.0, 1.0);
            let offset = match kind {
                // Such a needle meets one row, beside whose sample points it passes.
                Kind::Flat if axis == 1 => middle.floor() - middle + 0.5 + spot * reach[1],
                // The middle of the window's middle row is the centre's column and `away`, and the window a word before
                // it.
                Kind::WordAway => {
                    let away = 0.75 * reach[0];
                    [FINE_WORD - away, -away / shear][axis]
                }
                _ if rim => point[axis] + spot * size / 2.0,
                _ => spot * (reach[axis] + size / 2.0),
            };
            // A packet's centre has 28 bits before the point.
            let centre = (middle + offset).clamp(-FARTHEST, FARTHEST);
            centres[axis] = centre;
            footprint.centre[axis] = (centre * f64::from(widths.subpixel).exp2()) as i64;
            // `as` saturates: boxes are clipped to the widest viewport.
            footprint.first[axis] = (centre - reach[axis] - 0.5).ceil() as u16;
            footprint.end[axis] = (centre + reach[axis] + 0.5) as u16;
            if footprint.end[axis] <= footprint.first[axis] {
                return None;
            }
        }
        // How far the middle of a visible row can lie from the first column.
        let rows = (f64::from(window.first[1]) - centres[1]).abs() + f64::from(TILE[1]);
        if centres[0].abs() + (shear * rows).abs() > FARTHEST_MIDDLE {
            return None;
        }
        Some(footprint)
    }
}
