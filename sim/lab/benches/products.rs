//! `cargo bench -p splatline-lab --bench products`: the products of a pixel (share, rest of the transmittance, three colours, in the widths of
//! `standard24`) over a thousand pixels, by ways of writing vectors: a plain loop, this crate's vectors on arrays, AVX2 and AVX-512, and a portable crate.
//!
//! All give the same words. Those that choose instructions when they are compiled have what the build's flags allow: once more with
//! `RUSTFLAGS="-C target-cpu=native"` they have all of the processor's. docs/decisions/host-vectors.md says what follows.

use divan::Bencher;
use splatline_sim::fast::lanes::{Floats, ProductShift, VectorLevel, VectorTask, dispatch};
use wide::u32x8;

/// Pixels, few enough for the first-level cache.
const AREA: usize = 1024;

/// Right shifts: 30 bits of transmittance times 26 of opacity, and times 24 of colour to 26 of a sum.
const SHARE: u32 = 26;
const COLOUR: u32 = 28;

const COLOURS: [u32; 3] = [9_000_001, 15_000_003, 123_457];

fn main() {
    let expected = Planes::new().by(Planes::plain);
    for way in [
        Planes::by_arrays,
        Planes::by_eight,
        Planes::by_best,
        Planes::by_crate,
    ] {
        assert!(Planes::new().by(way) == expected, "a way differs");
    }
    divan::main();
}

/// Pixels, plane by plane.
#[derive(Clone, PartialEq)]
struct Planes {
    light: Vec<u32>,
    opacity: Vec<u32>,
    sums: [Vec<u32>; 3],
}

impl Planes {
    fn new() -> Self {
        let spread = |factor: usize, bits: u32| {
            let word = move |k: usize| (k.wrapping_mul(factor) as u32) >> (32 - bits);
            (0..AREA).map(word).collect()
        };
        Planes {
            light: spread(2_654_435_761, 30),
            opacity: spread(40_503_000_011, 26),
            sums: std::array::from_fn(|_| vec![0; AREA]),
        }
    }

    fn by(mut self, way: fn(&mut Planes)) -> Self {
        way(&mut self);
        self
    }

    /// The definition.
    fn plain(&mut self) {
        let product = |a: u32, b: u32, shift: u32| {
            ((u64::from(a) * u64::from(b) + (1 << (shift - 1))) >> shift) as u32
        };
        let [red, green, blue] = &mut self.sums;
        let sums = red.iter_mut().zip(green).zip(blue);
        let pixels = self.light.iter_mut().zip(&self.opacity).zip(sums);
        for ((light, opacity), ((red, green), blue)) in pixels {
            let share = product(*light, *opacity, SHARE);
            *light -= share;
            for (sum, colour) in [red, green, blue].into_iter().zip(COLOURS) {
                *sum += product(share, colour, COLOUR);
            }
        }
    }

    fn by_arrays(&mut self) {
        dispatch(VectorLevel::Portable, OnLanes(self));
    }

    fn by_eight(&mut self) {
        dispatch(VectorLevel::Avx2, OnLanes(self));
    }

    fn by_best(&mut self) {
        dispatch(VectorLevel::Best, OnLanes(self));
    }

    fn by_crate(&mut self) {
        for first in (0..AREA).step_by(8) {
            let read = |from: &[u32]| u32x8::from(&from[first..first + 8]);
            let light = read(&self.light);
            let share = wide_product(light, read(&self.opacity), SHARE);
            let rest = (light - share).to_array();
            self.light[first..first + 8].copy_from_slice(&rest);
            for (sums, colour) in self.sums.iter_mut().zip(COLOURS) {
                let sum = read(sums) + wide_product(share, u32x8::splat(colour), COLOUR);
                sums[first..first + 8].copy_from_slice(&sum.to_array());
            }
        }
    }
}

/// The crate's product of 64 bits, rounded and shifted in its two halves.
fn wide_product(a: u32x8, b: u32x8, shift: u32) -> u32x8 {
    let (low, high) = a.mul_keep_low_high(b);
    let rounded = low + u32x8::splat(1 << (shift - 1));
    // A carry is a mask of ones, which is -1.
    let high = high - rounded.simd_lt(low);
    (high << (32 - shift)) | (rounded >> shift)
}

struct OnLanes<'a>(&'a mut Planes);

impl VectorTask for OnLanes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) {
        let drop = |shift: u32| ProductShift {
            shift,
            half: 1 << (shift - 1),
            narrow: false,
        };
        let Planes {
            light,
            opacity,
            sums,
        } = self.0;
        for first in (0..AREA).step_by(L::WIDTH) {
            let before = lanes.load(&light[first..]);
            let share = lanes.product(before, lanes.load(&opacity[first..]), drop(SHARE));
            lanes.store(&mut light[first..], lanes.sub(before, share));
            for (sums, colour) in sums.iter_mut().zip(COLOURS) {
                let layer = lanes.product(share, lanes.splat(colour), drop(COLOUR));
                let sum = lanes.add(lanes.load(&sums[first..]), layer);
                lanes.store(&mut sums[first..], sum);
            }
        }
    }
}

fn over_and_over(bencher: Bencher, way: fn(&mut Planes)) {
    bencher.with_inputs(Planes::new).bench_local_refs(way);
}

#[divan::bench]
fn plain_loop(bencher: Bencher) {
    over_and_over(bencher, Planes::plain);
}

#[divan::bench]
fn lanes_arrays(bencher: Bencher) {
    over_and_over(bencher, Planes::by_arrays);
}

#[divan::bench]
fn lanes_avx2(bencher: Bencher) {
    over_and_over(bencher, Planes::by_eight);
}

#[divan::bench]
fn lanes_best(bencher: Bencher) {
    over_and_over(bencher, Planes::by_best);
}

#[divan::bench]
fn portable_crate(bencher: Bencher) {
    over_and_over(bencher, Planes::by_crate);
}
