//! Stages of the other systems: view-dependent colour, surfaces, the deep channel, points, sheets and spheres.
//!
//! Each takes the subject's splats through a system's own setup, or pixels through its own blending, with operands of
//! all lengths up to the ends of their formats. A record has the operands, then the results.

use super::builtin::{BuiltinRandom, soft};
use super::record::{Words, push, record};
use super::{VectorStage, VectorSubject};
use crate::fixed::kernel_rules;
use fixed::types::{I2F30, I4F28, I32F32, U4F28};
use splatline::blend::deep::{Channel, ChannelRounding, DeepPixel, Representation, octaves};
use splatline::blend::edge::EdgeFilter;
use splatline::blend::layers::Layers;
use splatline::blend::points::Slab;
use splatline::blend::resolve::Resolve;
use splatline::blend::surface::{Accumulation, Cell, Fragment, Sample, WeightedSum, sum_fraction};
use splatline::blend::{Blend, Pixel};
use splatline::footprint::surface::{Attributes, attribute_fraction, depth_in_pixel};
use splatline::format::{Design, Widths};
use splatline::kernel::{PERSPECTIVE_ENTRIES, PerspectiveTable, Rays, fill_perspective};
use splatline::math::SoftFloat;
use splatline::rules::Rules;
use splatline::setup::harmonics::{COEFFICIENTS, Harmonics, direction};
use splatline::setup::{self, Cull, Ellipse, Index, PointFilter};
use splatline::splat::Axis;
use splatline::splat::surface::SurfaceSplat;
use splatline::splat::{SphereSplat, VolumeSplat};
use splatline::view::View;

/// Records of the stages that go through pixels.
const STEPS: u32 = 1500;
/// 1.0 of directions.
const ONE: u32 = 1 << 30;
/// A footprint behind the reason why there is none.
const PRINT: &str =
    "culled:4 depth:48 centre*2:-64 first*2:16 end*2:16 ldl*8:-32 cutoff:32.28 peak:32";

/// The fields of a pixel's word.
fn pixel_fields(widths: &Widths) -> String {
    let (a, t) = (widths.accumulator, widths.transmittance);
    format!("colour*3:32.{a} transmittance:31.{t} finished:1")
}

/// All of them, in the order of the specification.
pub fn stages<D: Design>(design: D, subject: &VectorSubject) -> Vec<VectorStage> {
    let rules = kernel_rules(&subject.rules);
    let widths = design.widths();
    vec![
        colours(&widths, subject),
        surfaces(design, subject, &rules),
        samples(&widths),
        octaves(),
        deep(),
        points(design, subject),
        gathers(&widths, &rules),
        sheets(&widths, &rules),
        spheres(design, subject, &rules),
        perspective(),
        indices(&widths, subject),
    ]
}

fn colours(widths: &Widths, subject: &VectorSubject) -> VectorStage {
    let mut stage = VectorStage::new(
        "colours",
        "view-dependent colour, one splat a record: the direction to it; that of the colour, base, coefficients, colour",
        "view*3:-32.30 direction*3:-32.30 base*3:-32.28 count:8 coefficient*72:-32.28 colour*3:32.28",
    );
    let mut random = BuiltinRandom(1);
    for (number, splat) in subject.splats.iter().enumerate() {
        let view = direction(widths, &subject.view, &splat.centre);
        // Not longer than a unit vector: along an axis, or anywhere in the cube of half of it.
        let most = |axis| match number % 4 {
            1 => u32::from(axis == number / 4 % 3) * ONE,
            _ => ONE / 2,
        };
        let other = [0, 1, 2].map(|axis| I2F30::from_bits(random.within(most(axis))));
        let direction = if number % 2 == 0 { view } else { other };
        let drop = random.up_to(12);
        let mut some =
            || [(); 3].map(|()| I4F28::from_bits(random.within(i32::MAX as u32) >> drop));
        let (base, all) = (some(), [(); COEFFICIENTS].map(|()| some()));
        let count = [0, 3, 8, 15, 24][number % 5];
        let coefficients = &all[..count];
        let colour = Harmonics { base, coefficients }.colour(direction);
        stage.add(record![view; direction; base; count as i64; all.as_flattened(); colour]);
    }
    stage
}

fn surfaces<D: Design>(design: D, subject: &VectorSubject, rules: &Rules) -> VectorStage {
    let f = attribute_fraction(&design.widths());
    let mut stage = VectorStage::new(
        "surfaces",
        "surface splats of the splats' first two axes and the third for a normal: print, plane, attributes, depth at the box's end",
        &format!(
            "colour*3:32.28 opacity:32.28 weight*2:-32 normal*4:-32 {PRINT} plane*3:-64.32 share*4:32.{f} normal*3:-32.{f} back:1 lane:-64.32 last:32.23"
        ),
    );
    let mut random = BuiltinRandom(2);
    for splat in &subject.splats {
        let [first, second, normal] = splat.axes;
        let (centre, weight) = (splat.centre, random.weight(splat.weight));
        let normal = match random.up_to(7) {
            0 => Axis::default(),
            _ => normal,
        };
        let colour = [(); 3].map(|()| U4F28::from_bits(random.shorter(1 << 29)));
        let opacity = U4F28::from_bits(random.shorter(1 << 29));
        let splat = SurfaceSplat {
            centre,
            frame: [first, second],
            normal,
            weight,
            colour,
            opacity,
            material: 0,
        };
        let found = setup::setup_surface(design, &subject.view, rules, &splat);
        let words = found.map(|found| {
            let lane = found.depth_at(found.footprint.end[0] - 1, found.footprint.end[1] - 1);
            let plane = record![found.plane.origin; found.plane.step];
            record![found.footprint; plane; found.attributes; found.back; lane; depth_in_pixel(lane)]
        });
        let operands = record![colour; opacity; weight; normal.mantissa; normal.exponent];
        push(&mut stage, operands, words);
    }
    stage
}

fn samples(widths: &Widths) -> VectorStage {
    let (f, s) = (attribute_fraction(widths), sum_fraction(widths));
    let (a, pixel) = (widths.accumulator, pixel_fields(widths));
    let fragment = format!(
        "weight:32.{s} sum*4:32.{s} normal:-32.{s} normal_y:-32.{s} normal_z:-32.{s} near:32.23 far:32.23 of:8"
    );
    let mut stage = VectorStage::new(
        "samples",
        "a sample; what it adds to a pixel of one fragment and to one of two layers; the first divided, covered, and both resolved",
        &format!(
            "lane:-64.32 lane_depth:32.23 pixel:32 threshold:32.23 tau:32.30 alpha:32.{} rounded:32.{s} weight:32.{s} depth:32.23 share*4:32.{f} normal*3:-32.{f} \
             material:8 {fragment} {fragment} {fragment} merges:32 divided*4:32.{a} normal*3:-32.30 coverage:32.30 {pixel} {pixel}",
            widths.alpha
        ),
    );
    let mut random = BuiltinRandom(3);
    let (mut one, mut two) = (Accumulation::EMPTY, Layers::<2>::EMPTY);
    let (mut base, mut threshold) = (0, 0);
    for step in 0..STEPS {
        let pixel = step / 12;
        if step % 12 == 0 {
            (one, two) = (Accumulation::EMPTY, Layers::EMPTY);
            (base, threshold) = (random.up_to(u32::MAX), random.up_to(1 << (pixel % 30)));
        }
        let tau = random.up_to(u32::MAX);
        let (gather, edges) = (WeightedSum::new(widths, threshold), EdgeFilter::new(tau));
        let normal = [(); 3].map(|()| random.within(1 << f));
        let material = (random.bits() >> 30) as u8;
        let attributes = Attributes {
            colour: random.three(1 << f),
            opacity: random.up_to(1 << f),
            normal,
            material,
        };
        let alpha = random.up_to(1 << widths.alpha);
        let rounded = gather.weight(alpha);
        // Every eighth pixel fills its weight sums, every fourth to the last bit.
        let full = u32::from(pixel % 8 == 7) * i32::MAX as u32;
        let weight = random.up_to(full).max(rounded).max(1);
        let whole = pixel % 4 == 1;
        let weight = if whole {
            ONE >> (pixel / 4 % 3)
        } else {
            weight
        };
        let lane = i64::from(random.within(i32::MAX as u32)) << random.up_to(32);
        // Near each other, at the threshold or one beside it.
        let depth = base.saturating_add(threshold.saturating_mul(random.up_to(5)));
        let depth = depth.saturating_add(random.up_to(2)).saturating_sub(1);
        let sample = Sample {
            weight,
            depth,
            attributes: &attributes,
        };
        one.add(&gather, &sample);
        two.add(&gather, &sample);
        let of = |layers: &[Fragment], place| layers.get(place).copied().unwrap_or(Fragment::EMPTY);
        let sum = of(one.fragments(), 0);
        let divided = gather.normalise(&sum);
        let resolve = Resolve::new(widths, gather, None, edges);
        stage.add(record![
            record![lane; depth_in_pixel(lane)];
            record![pixel; threshold; tau; alpha; rounded; weight; depth; attributes; material; sum];
            record![of(two.fragments(), 0); of(two.fragments(), 1); two.merges()];
            record![divided.colour; divided.opacity; divided.normal];
            edges.map_or(ONE, |edges| edges.coverage(sum.weight, s));
            record![resolve.pixel(&one, 0, 0); resolve.pixel(&two, 0, 0)];
        ]);
    }
    stage
}

fn octaves() -> VectorStage {
    let mut stage = VectorStage::new(
        "octaves",
        "an opacity and its optical depth, an optical depth and what shines through it",
        "alpha:32.31 octaves:64.44 depth:32.28 through:32.31",
    );
    let mut random = BuiltinRandom(10);
    let dark = Channel::new(Representation::OpticalDepth, ChannelRounding::Nearest, 32);
    for step in 0..3 * STEPS {
        let alpha = random.up_to(1 << 31);
        let depth = random.up_to(u32::MAX >> (4 * (step % 8).min(1)));
        let through = dark.map_or(0, |dark| dark.transmittance(depth));
        stage.add(record![alpha; octaves::of_opacity(alpha); depth; through]);
    }
    stage
}

fn deep() -> VectorStage {
    let mut stage = VectorStage::new(
        "deep",
        "a layer over a pixel: opacity, transmittance or optical depth; to nearest, down or dithered; bits. What still shines through; \
         the pixel after it front to back, and back to front",
        "what:8 rounding:8 bits:8 place*2:16 layer:32 alpha:32.31 light*3:32.28 before*4:32 through:32.31 front*4:32 back*4:32",
    );
    let mut random = BuiltinRandom(4);
    use ChannelRounding::{Dither, Nearest, Truncate};
    use Representation::{Opacity, OpticalDepth, Transmittance};
    let kinds = [Opacity, Transmittance, OpticalDepth];
    let roundings = [Nearest, Truncate, Dither];
    for step in 0..2 * STEPS as usize {
        let (what, rounding, bits) = (step % 3, step / 3 % 3, 8 + random.up_to(24) as u8);
        let Ok(channel) = Channel::new(kinds[what], roundings[rounding], bits) else {
            continue;
        };
        let place = [(); 2].map(|()| random.up_to(u16::MAX.into()) as u16);
        let (layer, opacity) = (random.up_to(u32::MAX), random.shorter(1 << 31));
        let light = random.three((1 << 29) + 1);
        let most = u32::MAX >> (32 - bits);
        let (colour, half) = (random.three(most), most / 2 + 1);
        let alpha = random.up_to([half, half, most][what]);
        let before = DeepPixel { colour, alpha };
        let (mut front, mut back) = (before, before);
        front.front_to_back(&channel, opacity, &light, place, layer);
        back.back_to_front(&channel, opacity, &light, place, layer);
        let operands =
            record![what as i64; rounding as i64; bits; place; layer; opacity; light; before];
        stage.add(record![operands; channel.transmittance(before.alpha); front; back]);
    }
    stage
}

fn points<D: Design>(design: D, subject: &VectorSubject) -> VectorStage {
    let mut stage = VectorStage::new(
        "points",
        "the splats as points by the rules ewa: is it one, has the filter an area, its footprint",
        &format!(
            "spacing*2:-32 deviation*2:-32 weight*2:-32 normalised:1 minified:1 filter:1 {PRINT}"
        ),
    );
    let (mut random, widths) = (BuiltinRandom(5), design.widths());
    for (number, splat) in subject.splats.iter().enumerate() {
        let (spacing, deviation) = (random.number(-4), random.number(-4));
        let normalised = number % 2 == 0;
        let rules = Rules {
            spacing,
            normalised,
            ..Rules::EWA
        };
        let filter = PointFilter::new(&widths, &rules, deviation);
        let minified = setup::is_minified(&widths, &subject.view, &rules, splat);
        let weight = random.weight(splat.weight);
        let splat = VolumeSplat { weight, ..*splat };
        let operands =
            record![spacing; deviation; splat.weight; normalised; minified; filter.is_some()];
        let found = filter.ok_or(Cull::Degenerate);
        let found = found
            .and_then(|filter| setup::setup_point(design, &subject.view, &rules, &splat, &filter));
        push(&mut stage, operands, found.map(|print| record![print]));
    }
    stage
}

fn gathers(widths: &Widths, rules: &Rules) -> VectorStage {
    let (c, a, alpha) = (widths.colour, widths.accumulator, widths.alpha);
    let pixel = pixel_fields(widths);
    let mut stage = VectorStage::new(
        "gathers",
        "points gathered by a pixel: pixel and slab after each, and the pixel if the slab is closed then",
        &format!(
            "pixel:32 range:32.23 alpha:32.{alpha} light*3:32.{c} depth:32.23 {pixel} slab*3:32.{a} sum:32.{alpha} first:32.23 {pixel}"
        ),
    );
    let (mut random, blend) = (BuiltinRandom(6), Blend::new(widths, rules));
    let (mut pixel, mut slab) = (Pixel::clear(widths), Slab::default());
    let (mut range, mut depth, mut number) = (0, 0, 0u32);
    for step in 0..STEPS {
        if step % 16 == 0 || pixel.is_finished() {
            number += 1;
            (pixel, slab) = (Pixel::clear(widths), Slab::default());
            (range, depth) = (random.up_to(1 << 20), random.up_to(u32::MAX));
        }
        depth = depth.saturating_add(random.shorter(range) + random.up_to(2) / 2);
        // Every fourth pixel is full of what is almost opaque.
        let full = u32::from(number % 4 == 3) << alpha;
        let most = full.saturating_sub(random.up_to(1 << (alpha / 2)));
        let opacity = random.shorter(1 << alpha).max(most).max(1);
        let light = random.three(u32::MAX >> (32 - c - widths.colour_range()));
        blend.gather(&mut pixel, &mut slab, opacity, &light, depth, range);
        let mut closed = pixel;
        blend.close(&mut closed, &mut slab.clone());
        stage.add(record![number; range; opacity; light; depth; pixel; slab; closed]);
    }
    stage
}

fn sheets(widths: &Widths, rules: &Rules) -> VectorStage {
    let pixel = pixel_fields(widths);
    let about =
        "a pixel, a sheet's pixel; the first with the sheet behind it, and with the sheet over it";
    let mut stage = VectorStage::new("sheets", about, &format!("{pixel} {pixel} {pixel} {pixel}"));
    let (mut random, blend) = (BuiltinRandom(7), Blend::new(widths, rules));
    for _ in 0..STEPS {
        let [pixel, sheet] = [(); 2].map(|()| Pixel {
            colour: random.three(u32::MAX),
            transmittance: random.up_to(1 << widths.transmittance),
        });
        let (mut behind, mut over) = (pixel, pixel);
        blend.sheet_behind(&mut behind, &sheet);
        blend.sheet_over(&mut over, &sheet);
        stage.add(record![pixel; sheet; behind; over]);
    }
    stage
}

fn spheres<D: Design>(design: D, subject: &VectorSubject, rules: &Rules) -> VectorStage {
    let mut stage = VectorStage::new(
        "spheres",
        "the splats as spheres: exact or approximate; affine, perspective or by rays; the footprint and what corrects its index",
        &format!(
            "deviation*2:-32 weight*2:-32 ellipse:8 index:8 {PRINT} spread:32.32 slant*2:-32 corrected_end:32.28"
        ),
    );
    let mut random = BuiltinRandom(8);
    for (number, splat) in subject.splats.iter().enumerate() {
        let mut deviation = random.number(2 - (number % 8) as i32);
        let (ellipse, index) = (number % 2, number / 2 % 3);
        let ellipses = [Ellipse::Exact, Ellipse::Approximate];
        let indices = [Index::Affine, Index::Perspective, Index::Ray];
        let choice = (ellipses[ellipse], indices[index]);
        // Every tenth is hardly above 1/255, so that it ends near its middle.
        let hardly = soft(1_077_952_576 + random.up_to(1 << 28) as i32, -38);
        let weight = match number % 10 {
            9 => hardly,
            _ => random.weight(splat.weight),
        };
        let centre = splat.centre;
        let found = |deviation| {
            let splat = SphereSplat {
                centre,
                deviation,
                weight,
                colour: splat.colour,
            };
            setup::setup_sphere(design, &subject.view, rules, &splat, choice)
        };
        if number % 5 == 4 {
            // The largest sphere that does not reach the eye, more or less exactly, or the smallest that does.
            deviation = soft(0, -27);
            for bit in (random.up_to(12)..31).rev() {
                let mantissa = deviation.mantissa | 1 << bit;
                if found(soft(mantissa, -27)) != Err(Cull::Near) {
                    deviation.mantissa = mantissa;
                }
            }
            let more = (number / 5 % 4 / 3) as i32;
            deviation.mantissa = deviation.mantissa.saturating_add(more);
        }
        let words = found(deviation).map(|found| {
            let slant = found.slant.unwrap_or(soft(0, 0));
            record![found.footprint; found.spread; slant; found.end]
        });
        let operands = record![deviation; weight; ellipse as i64; index as i64];
        push(&mut stage, operands, words);
    }
    stage
}

fn perspective_entries() -> [u32; PERSPECTIVE_ENTRIES] {
    let mut entries = [0; PERSPECTIVE_ENTRIES];
    fill_perspective(&mut entries);
    entries
}

fn perspective() -> VectorStage {
    let about = "entries of the two-index table, row by row of the spread";
    let entries = perspective_entries();
    VectorStage::of("perspective", about, "entry:32.28", &entries)
}

fn indices(widths: &Widths, subject: &VectorSubject) -> VectorStage {
    let bits = widths.radial;
    let mut stage = VectorStage::new(
        "indices",
        "a sphere's radial index; a spread and what it makes of it; a pixel, L, the squared length of its ray and what they make of it",
        &format!(
            "radial:64.{bits} spread:32.32 by_spread:64.{bits} pixel*2:16 focal*4:-32 principal*2:-64.32 slant*2:-32 squared:-64.28 by_ray:64.{bits}"
        ),
    );
    let entries = perspective_entries();
    let table = PerspectiveTable::new(&entries);
    let mut random = BuiltinRandom(9);
    for step in 0..4 * STEPS {
        let radial = (u128::from(random.up_to(u32::MAX)) << bits >> 28) as u64 >> (2 * (step % 2));
        let spread = random.up_to(u32::MAX) >> (4 * (step / 2 % 2));
        let pixel = [(); 2].map(|()| random.up_to(u16::MAX.into()) as u16);
        let focal = [(); 2].map(|()| random.number(2 + (step % 16) as i32));
        let principal = [(); 2].map(|()| i64::from(random.within(i32::MAX as u32)) << 6);
        let rays = Rays::new(&View {
            focal,
            principal: principal.map(I32F32::from_bits),
            ..subject.view
        });
        let slant = (ONE + random.up_to(ONE - 1)).into();
        let slant = SoftFloat::from_wide(slant, random.up_to(16) as i32 - 30, 31);
        let by_spread = table.index(spread, bits.into()).correct(radial);
        let by_ray = rays.correct(pixel, radial, slant);
        stage.add(
            record![radial; spread; by_spread; pixel; focal; principal; slant; rays.squared(pixel); by_ray],
        );
    }
    stage
}
