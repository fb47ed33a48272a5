//! Error of the deep alpha channel against its width and the number of layers (\[SWAN\] 6), for each representation and rounding.
//!
//! A stack of equal layers is composited by the kernel's channel and by the reference; the error is that of the
//! transmittance. Dithered stacks are drawn at several pixels, and mean and root mean square are over these. What the
//! sweep is to confirm is [`rule_width`], derived in docs/systems.md.

use rayon::prelude::*;
use splatline::blend::deep::{Channel, ChannelRounding, ONE, Representation, WIDTH_RANGE, noise};
use splatline_sim::reference;
use std::fmt::Write;

/// All representations.
pub const REPRESENTATIONS: [Representation; 3] = [
    Representation::Opacity,
    Representation::Transmittance,
    Representation::OpticalDepth,
];

/// All roundings.
pub const ROUNDINGS: [ChannelRounding; 3] = [
    ChannelRounding::Nearest,
    ChannelRounding::Truncate,
    ChannelRounding::Dither,
];

/// Opacities of a layer, as exponents of 2.
pub const LOG2_ALPHAS: [i32; 9] = [-16, -14, -12, -10, -8, -6, -4, -2, -1];

/// Numbers of layers at which the error is written down; the last is the depth of the stack.
pub const LAYERS: [u32; 6] = [1, 10, 100, 1_000, 10_000, 100_000];

/// Pixels of a dithered stack.
const DITHERED_PIXELS: u16 = 16;

/// Error of the transmittance, units of 1.0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Root mean square over the pixels; the absolute error where there is one pixel.
    pub rms: f64,
    /// Mean of fixed minus float; positive is too transparent.
    pub bias: f64,
}

/// One channel and one opacity.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// The channel.
    pub channel: Channel,
    /// Opacity of a layer is 2 to this.
    pub log2_alpha: i32,
    /// Error at [`LAYERS`].
    pub at: [Moment; LAYERS.len()],
    /// Largest root mean square after any layer.
    pub worst: f64,
}

/// Name in tables.
pub fn representation_name(representation: Representation) -> &'static str {
    match representation {
        Representation::Opacity => "opacity",
        Representation::Transmittance => "transmittance",
        Representation::OpticalDepth => "optical depth",
    }
}

/// Name in tables.
pub fn rounding_name(rounding: ChannelRounding) -> &'static str {
    match rounding {
        ChannelRounding::Nearest => "nearest",
        ChannelRounding::Truncate => "truncated",
        ChannelRounding::Dither => "dithered",
    }
}

/// All representations, roundings, widths and opacities.
pub fn sweep() -> Vec<Stack> {
    let mut cases = Vec::new();
    for representation in REPRESENTATIONS {
        for rounding in ROUNDINGS {
            for width in WIDTH_RANGE.0..=WIDTH_RANGE.1 {
                let Ok(channel) = Channel::new(representation, rounding, width) else {
                    continue;
                };
                cases.extend(LOG2_ALPHAS.map(|log2_alpha| (channel, log2_alpha)));
            }
        }
    }
    cases
        .par_iter()
        .map(|(channel, log2_alpha)| stack(*channel, *log2_alpha))
        .collect()
}

/// Composites one stack; `log2_alpha` from -31 to -1.
pub fn stack(channel: Channel, log2_alpha: i32) -> Stack {
    let alpha = ONE >> log2_alpha.unsigned_abs().min(31);
    let exact_alpha = f64::from(alpha) / f64::from(ONE);
    let pixels = match channel.rounding() {
        ChannelRounding::Dither => DITHERED_PIXELS,
        _ => 1,
    };
    let mut words = vec![channel.clear(); usize::from(pixels)];
    let mut at = [Moment::default(); LAYERS.len()];
    let mut worst: f64 = 0.0;
    for layer in 1..=LAYERS[LAYERS.len() - 1] {
        let exact = reference::deep::transmittance(exact_alpha, layer);
        let mut moment = Moment::default();
        for (x, word) in (0..).zip(&mut words) {
            let noise = if pixels > 1 { noise(x, 0, layer) } else { 0 };
            *word = channel.over(*word, alpha, noise);
            let error = f64::from(channel.transmittance(*word)) / f64::from(ONE) - exact;
            moment.bias += error / f64::from(pixels);
            moment.rms += error * error / f64::from(pixels);
        }
        moment.rms = moment.rms.sqrt();
        worst = worst.max(moment.rms);
        if let Some(place) = LAYERS.iter().position(|layers| *layers == layer) {
            at[place] = moment;
        }
    }
    Stack {
        channel,
        log2_alpha,
        at,
        worst,
    }
}

/// Smallest width from which on no stack of this opacity errs by more than `error`; `None` beyond 32 bits.
pub fn measured_width(
    stacks: &[Stack],
    representation: Representation,
    rounding: ChannelRounding,
    log2_alpha: i32,
    error: f64,
) -> Option<u8> {
    let of_kind = stacks.iter().filter(|stack| {
        let channel = stack.channel;
        let kind = (channel.representation(), channel.rounding());
        kind == (representation, rounding) && stack.log2_alpha == log2_alpha
    });
    let failing = of_kind.filter(|stack| stack.worst > error);
    let widest = failing.map(|stack| stack.channel.width()).max();
    match widest {
        None => Some(WIDTH_RANGE.0),
        Some(width) if width < WIDTH_RANGE.1 => Some(width + 1),
        Some(_) => None,
    }
}

/// Bits of a word that keeps the error of T at or below `error`, for stacks with min(layers, 1 / opacity) at most `depth`
/// (docs/systems.md). For dithered rounding the error is the root mean square.
pub fn rule_width(
    representation: Representation,
    rounding: ChannelRounding,
    depth: f64,
    error: f64,
) -> u8 {
    let depth = depth.max(2.0).log2();
    let bits = match (representation, rounding) {
        (Representation::OpticalDepth, ChannelRounding::Nearest) => depth + 1.03,
        (Representation::OpticalDepth, ChannelRounding::Truncate) => depth + 2.03,
        (Representation::OpticalDepth, ChannelRounding::Dither) => depth / 2.0 + 1.25,
        (_, ChannelRounding::Nearest) => depth,
        (_, ChannelRounding::Truncate) => depth + 1.0,
        (_, ChannelRounding::Dither) => depth / 2.0 - 0.5,
    };
    let width = (bits - error.log2()).ceil();
    width.clamp(f64::from(WIDTH_RANGE.0), 255.0) as u8
}

/// The sweep as a table: one line per channel of even width and opacity.
pub fn csv(stacks: &[Stack]) -> String {
    let mut text = "representation,rounding,width,log2_alpha,worst".to_owned();
    for layers in LAYERS {
        // Writing to a String cannot fail.
        let _ = write!(text, ",error_{layers},bias_{layers}");
    }
    text.push('\n');
    for stack in stacks
        .iter()
        .filter(|s| s.channel.width().is_multiple_of(2))
    {
        let channel = &stack.channel;
        let _ = write!(
            text,
            "{},{},{},{},{:.2e}",
            representation_name(channel.representation()),
            rounding_name(channel.rounding()),
            channel.width(),
            stack.log2_alpha,
            stack.worst
        );
        for Moment { rms, bias } in stack.at {
            let _ = write!(text, ",{rms:.2e},{bias:.2e}");
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_wide_enough_and_not_two_bits_too_wide() {
        let error = (-11f64).exp2();
        for representation in [Representation::Transmittance, Representation::OpticalDepth] {
            for rounding in [ChannelRounding::Nearest, ChannelRounding::Truncate] {
                let width = rule_width(representation, rounding, 12f64.exp2(), error);
                let worst = |width| {
                    let channel = Channel::new(representation, rounding, width).unwrap();
                    stack(channel, -12).worst
                };
                let kind = (representation, rounding);
                assert!(
                    worst(width) <= error,
                    "{kind:?}: {} at {width}",
                    worst(width)
                );
                assert!(
                    worst(width - 3) > error,
                    "{kind:?}: {} at {width} less 3",
                    worst(width - 3)
                );
            }
        }
    }

    #[test]
    fn truncation_errs_by_its_own_sign() {
        let bias = |representation| {
            let channel = Channel::new(representation, ChannelRounding::Truncate, 16).unwrap();
            stack(channel, -8).at[2].bias
        };
        assert!(bias(Representation::Opacity) > 1e-4, "too transparent");
        assert!(bias(Representation::Transmittance) < -1e-4, "too opaque");
        assert!(bias(Representation::OpticalDepth) > 0.0, "too transparent");
    }
}
