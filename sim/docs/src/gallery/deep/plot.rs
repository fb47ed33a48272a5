//! The sweep of the deep alpha channel as one SVG: error against width, and against the number of layers.
//!
//! Colour is the representation, the marker is the rounding. Both axes of error are logarithmic to base 2.

use crate::plot::{self, Curve, Marker, PlotPanel};
use crate::study::deep::{LAYERS, Stack, representation_name, rounding_name};
use plotters::prelude::SeriesLabelPosition;
use splatline::blend::deep::{ChannelRounding, Representation};
use splatline_sim::report::chart::DESIGNS;

/// Opacity of the left panel's stacks, as an exponent of 2, and opacity and width of the right panel's.
const LEFT_LOG2_ALPHA: i32 = -12;
const RIGHT_LOG2_ALPHA: i32 = -14;
const RIGHT_WIDTH: u8 = 20;

const SIZE: (u32, u32) = (1040, 520);

/// Exponents at the lower and upper edge.
const ERRORS: (f64, f64) = (-32.0, 0.0);

/// The plot, or why the back end refused it.
pub fn svg(stacks: &[Stack]) -> Result<String, String> {
    let against_width = PlotPanel {
        title: &format!("largest error after any layer, opacity 2^{LEFT_LOG2_ALPHA}"),
        across: "bits of the word",
        columns: 8.0..32.0,
        rows: ERRORS.0..ERRORS.1,
        bases: ["", "2^"],
        numbers: [7, 9],
        legend: SeriesLabelPosition::LowerLeft,
        curves: against_width(stacks),
    };
    let against_layers = PlotPanel {
        title: &format!("error, opacity 2^{RIGHT_LOG2_ALPHA}, {RIGHT_WIDTH} bits"),
        across: "layers, 10^",
        columns: 0.0..5.0,
        rows: ERRORS.0..ERRORS.1,
        bases: ["", "2^"],
        numbers: [7, 9],
        legend: SeriesLabelPosition::LowerRight,
        curves: against_layers(stacks),
    };
    plot::svg(SIZE, &[against_width, against_layers])
}

fn against_width(stacks: &[Stack]) -> Vec<Curve> {
    let chosen = stacks.iter().filter(|s| s.log2_alpha == LEFT_LOG2_ALPHA);
    let mut curves: Vec<Curve> = Vec::new();
    for stack in chosen {
        let point = (f64::from(stack.channel.width()), exponent(stack.worst));
        let curve = curve(stack, vec![point]);
        match curves.last_mut() {
            Some(last) if last.name == curve.name => last.points.push(point),
            _ => curves.push(curve),
        }
    }
    curves
}

fn against_layers(stacks: &[Stack]) -> Vec<Curve> {
    let chosen = stacks.iter().filter(|stack| {
        stack.log2_alpha == RIGHT_LOG2_ALPHA && stack.channel.width() == RIGHT_WIDTH
    });
    let over_layers = |stack: &Stack| {
        let layers = LAYERS.iter().map(|layers| f64::from(*layers).log10());
        let errors = stack.at.iter().map(|moment| exponent(moment.rms));
        curve(stack, layers.zip(errors).collect())
    };
    chosen.map(over_layers).collect()
}

/// A channel's curve. Opacity to nearest lies under transmittance to nearest.
fn curve(stack: &Stack, points: Vec<(f64, f64)>) -> Curve {
    let (representation, rounding) = (stack.channel.representation(), stack.channel.rounding());
    Curve {
        name: format!(
            "{}, {}",
            representation_name(representation),
            rounding_name(rounding)
        ),
        tone: match representation {
            Representation::Opacity => DESIGNS[0],
            Representation::Transmittance => DESIGNS[3],
            Representation::OpticalDepth => DESIGNS[2],
        },
        beneath: representation == Representation::Opacity,
        marker: match rounding {
            ChannelRounding::Nearest => Marker::Circle,
            ChannelRounding::Truncate => Marker::Triangle,
            ChannelRounding::Dither => Marker::Cross,
        },
        points,
    }
}

/// log2 of an error; none at all is drawn at the lower edge.
fn exponent(error: f64) -> f64 {
    error.log2().clamp(ERRORS.0, ERRORS.1)
}
