//! The sweep of the deep alpha channel as one SVG: error against width, and against the number of layers.
//!
//! Colour is the representation, the marker is the rounding. Both axes of error are logarithmic to base 2.

use crate::study::deep::{LAYERS, Stack, representation_name, rounding_name};
use plotters::coord::Shift;
use plotters::prelude::*;
use splatline::blend::deep::{ChannelRounding, Representation};
use splatline_sim::report::plot::{DESIGNS, INK, colour};

/// Opacity of the left panel's stacks, as an exponent of 2, and opacity and width of the right panel's.
const LEFT_LOG2_ALPHA: i32 = -12;
const RIGHT_LOG2_ALPHA: i32 = -14;
const RIGHT_WIDTH: u8 = 20;

const SIZE: (u32, u32) = (1040, 520);

/// Exponents at the lower and upper edge.
const ERRORS: (f64, f64) = (-32.0, 0.0);

type AlphaCanvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A curve: its channel and its points.
struct PlottedCurve {
    representation: Representation,
    rounding: ChannelRounding,
    points: Vec<(f64, f64)>,
}

/// The plot, or why the back end refused it.
pub fn svg(stacks: &[Stack]) -> Result<String, String> {
    let mut text = String::new();
    {
        let canvas = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        canvas.fill(&WHITE).map_err(|e| e.to_string())?;
        let (left, right) = canvas.split_horizontally(SIZE.0 / 2);
        let title = format!("largest error after any layer, opacity 2^{LEFT_LOG2_ALPHA}");
        panel(
            &left,
            &title,
            "bits of the word",
            (8.0, 32.0),
            &against_width(stacks),
            SeriesLabelPosition::LowerLeft,
        )
        .map_err(|e| e.to_string())?;
        let title = format!("error, opacity 2^{RIGHT_LOG2_ALPHA}, {RIGHT_WIDTH} bits");
        panel(
            &right,
            &title,
            "layers, 10^",
            (0.0, 5.0),
            &against_layers(stacks),
            SeriesLabelPosition::LowerRight,
        )
        .map_err(|e| e.to_string())?;
        canvas.present().map_err(|e| e.to_string())?;
    }
    Ok(text)
}

fn against_width(stacks: &[Stack]) -> Vec<PlottedCurve> {
    let chosen = stacks.iter().filter(|s| s.log2_alpha == LEFT_LOG2_ALPHA);
    let mut curves: Vec<PlottedCurve> = Vec::new();
    for stack in chosen {
        let point = (f64::from(stack.channel.width()), exponent(stack.worst));
        let (representation, rounding) = (stack.channel.representation(), stack.channel.rounding());
        match curves.last_mut() {
            Some(curve) if (curve.representation, curve.rounding) == (representation, rounding) => {
                curve.points.push(point);
            }
            _ => curves.push(PlottedCurve {
                representation,
                rounding,
                points: vec![point],
            }),
        }
    }
    curves
}

fn against_layers(stacks: &[Stack]) -> Vec<PlottedCurve> {
    let chosen = stacks.iter().filter(|stack| {
        stack.log2_alpha == RIGHT_LOG2_ALPHA && stack.channel.width() == RIGHT_WIDTH
    });
    let curve = |stack: &Stack| {
        let layers = LAYERS.iter().map(|layers| f64::from(*layers).log10());
        let errors = stack.at.iter().map(|moment| exponent(moment.rms));
        PlottedCurve {
            representation: stack.channel.representation(),
            rounding: stack.channel.rounding(),
            points: layers.zip(errors).collect(),
        }
    };
    chosen.map(curve).collect()
}

/// log2 of an error; none at all is drawn at the lower edge.
fn exponent(error: f64) -> f64 {
    error.log2().clamp(ERRORS.0, ERRORS.1)
}

type DrawingError = DrawingAreaErrorKind<std::io::Error>;

fn panel(
    canvas: &AlphaCanvas,
    title: &str,
    across: &str,
    (from, to): (f64, f64),
    curves: &[PlottedCurve],
    legend: SeriesLabelPosition,
) -> Result<(), DrawingError> {
    let ink = colour(INK);
    let text = ("sans-serif", 13).into_font().color(&ink);
    let mut chart = ChartBuilder::on(canvas)
        .margin(12)
        .caption(title, ("sans-serif", 15).into_font().color(&ink))
        .x_label_area_size(40)
        .y_label_area_size(52)
        .build_cartesian_2d(from..to, ERRORS.0..ERRORS.1)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_labels(7)
        .y_labels(9)
        .x_desc(across)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("2^{y:.0}"))
        .label_style(text.clone())
        .axis_desc_style(text.clone())
        .draw()?;
    for curve in curves {
        draw(&mut chart, curve)?;
    }
    chart
        .configure_series_labels()
        .position(legend)
        .background_style(WHITE.mix(0.85))
        .label_font(text)
        .draw()
}

type Chart<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn draw(chart: &mut Chart, curve: &PlottedCurve) -> Result<(), DrawingError> {
    let (index, line) = match curve.representation {
        Representation::Opacity => (0, 4),
        Representation::Transmittance => (3, 2),
        Representation::OpticalDepth => (2, 2),
    };
    let tone = colour(DESIGNS[index]);
    // Opacity to nearest lies under transmittance to nearest: a wide pale line shows beneath a thin one.
    let style = if line > 2 {
        tone.mix(0.45)
    } else {
        tone.mix(1.0)
    };
    let name = format!(
        "{}, {}",
        representation_name(curve.representation),
        rounding_name(curve.rounding)
    );
    let points = curve.points.iter().copied();
    chart.draw_series(LineSeries::new(points.clone(), style.stroke_width(line)))?;
    match curve.rounding {
        ChannelRounding::Nearest => {
            let marker = move |at| Circle::new(at, 4, style.filled());
            let legend = move |(x, y)| Circle::new((x + 10, y), 4, style.filled());
            chart
                .draw_series(points.map(marker))?
                .label(name)
                .legend(legend);
        }
        ChannelRounding::Truncate => {
            let marker = move |at| TriangleMarker::new(at, 5, style.filled());
            let legend = move |(x, y)| TriangleMarker::new((x + 10, y), 5, style.filled());
            chart
                .draw_series(points.map(marker))?
                .label(name)
                .legend(legend);
        }
        ChannelRounding::Dither => {
            let marker = move |at| Cross::new(at, 4, style.stroke_width(2));
            let legend = move |(x, y)| Cross::new((x + 10, y), 4, style.stroke_width(2));
            chart
                .draw_series(points.map(marker))?
                .label(name)
                .legend(legend);
        }
    }
    Ok(())
}
