//! Curves in panels side by side as one SVG: what the pages plot.
//!
//! Axes are linear; who wants a logarithm gives exponents and a label that says so.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use splatline_sim::report::chart::{INK, Tone};
use std::ops::Range;

/// The light tone; one of the report's constants, so every digit is valid.
fn colour(tone: Tone) -> RGBColor {
    let part = |at: usize| {
        let hex = tone.light.get(at..at + 2);
        hex.and_then(|hex| u8::from_str_radix(hex, 16).ok())
            .unwrap_or(0)
    };
    RGBColor(part(1), part(3), part(5))
}

/// What stands at a curve's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Circle,
    /// A triangle.
    Triangle,
    /// A cross.
    Cross,
}

/// A curve.
pub struct Curve {
    /// Its name in the legend.
    pub name: String,
    /// Its colour.
    pub tone: Tone,
    /// Wide and pale, so that it shows beneath a curve that lies on it?
    pub beneath: bool,
    /// What stands at its points.
    pub marker: Marker,
    /// The points.
    pub points: Vec<(f64, f64)>,
}

/// A panel.
pub struct PlotPanel<'a> {
    /// Its title, which names what is plotted.
    pub title: &'a str,
    /// What lies across.
    pub across: &'a str,
    /// From left to right.
    pub columns: Range<f64>,
    /// From below to above.
    pub rows: Range<f64>,
    /// What is written before a number across and up.
    pub bases: [&'a str; 2],
    /// Numbers that are written across and up, at most.
    pub numbers: [usize; 2],
    /// Where the legend lies.
    pub legend: SeriesLabelPosition,
    /// The curves, drawn in this order.
    pub curves: Vec<Curve>,
}

type DrawingError = DrawingAreaErrorKind<std::io::Error>;
type PanelCanvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The panels from left to right, or why the back end refused them.
pub fn svg(size: (u32, u32), panels: &[PlotPanel]) -> Result<String, String> {
    let mut text = String::new();
    draw(&mut text, size, panels).map_err(|error| error.to_string())?;
    Ok(text)
}

fn draw(text: &mut String, size: (u32, u32), panels: &[PlotPanel]) -> Result<(), DrawingError> {
    let canvas = SVGBackend::with_string(text, size).into_drawing_area();
    canvas.fill(&WHITE)?;
    for (part, panel) in canvas.split_evenly((1, panels.len())).iter().zip(panels) {
        draw_panel(part, panel)?;
    }
    canvas.present()
}

fn draw_panel(canvas: &PanelCanvas, panel: &PlotPanel) -> Result<(), DrawingError> {
    let ink = colour(INK);
    let text = ("sans-serif", 13).into_font().color(&ink);
    let [across, up] = panel.bases;
    let mut chart = ChartBuilder::on(canvas)
        .margin(12)
        .caption(panel.title, ("sans-serif", 15).into_font().color(&ink))
        .x_label_area_size(40)
        .y_label_area_size(52)
        .build_cartesian_2d(panel.columns.clone(), panel.rows.clone())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_labels(panel.numbers[0])
        .y_labels(panel.numbers[1])
        .x_desc(panel.across)
        .x_label_formatter(&|x| format!("{across}{x:.0}"))
        .y_label_formatter(&|y| format!("{up}{y:.0}"))
        .label_style(text.clone())
        .axis_desc_style(text.clone())
        .draw()?;
    for curve in &panel.curves {
        draw_curve(&mut chart, curve)?;
    }
    chart
        .configure_series_labels()
        .position(panel.legend.clone())
        .background_style(WHITE.mix(0.85))
        .label_font(text)
        .draw()
}

fn draw_curve(chart: &mut Chart, curve: &Curve) -> Result<(), DrawingError> {
    let (width, strength) = if curve.beneath { (4, 0.45) } else { (2, 1.0) };
    let style = colour(curve.tone).mix(strength);
    let points = curve.points.iter().copied();
    chart.draw_series(LineSeries::new(points.clone(), style.stroke_width(width)))?;
    match curve.marker {
        Marker::Circle => {
            let marker = move |at| Circle::new(at, 4, style.filled());
            let legend = move |(x, y)| Circle::new((x + 10, y), 4, style.filled());
            let series = chart.draw_series(points.map(marker))?;
            series.label(&curve.name).legend(legend);
        }
        Marker::Triangle => {
            let marker = move |at| TriangleMarker::new(at, 5, style.filled());
            let legend = move |(x, y)| TriangleMarker::new((x + 10, y), 5, style.filled());
            let series = chart.draw_series(points.map(marker))?;
            series.label(&curve.name).legend(legend);
        }
        Marker::Cross => {
            let marker = move |at| Cross::new(at, 4, style.stroke_width(2));
            let legend = move |(x, y)| Cross::new((x + 10, y), 4, style.stroke_width(2));
            let series = chart.draw_series(points.map(marker))?;
            series.label(&curve.name).legend(legend);
        }
    }
    Ok(())
}
