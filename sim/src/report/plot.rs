//! Speed against error: host time or simulated cycles (logarithmic) across, PSNR up, so better is up and to the left.
//!
//! Colour is the design, the marker's shape is the traversal, and a thin line joins the traversals of one design.

use super::ReportRow;
use super::chart::{Anchor, Axis, Chart, TEXT, round_step, series, text_width};
use super::labels::{self, Rectangle};
use super::table;

/// Height of a line of text, for labels that keep apart.
const LINE: f64 = 1.24 * TEXT;
/// Half a marker's size in pixels.
const MARKER: f64 = 5.0;
/// Times below a microsecond are not told apart: a logarithm needs a positive number.
const SHORTEST_S: f64 = 1e-6;

/// What lies across.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// Time on this machine, milliseconds.
    HostTime,
    /// Cycles of the hardware model, millions; rows without them lie at the left edge.
    Cycles,
}

impl Across {
    fn name(self) -> &'static str {
        match self {
            Across::HostTime => "host time, ms (logarithmic)",
            Across::Cycles => "simulated cycles, millions (logarithmic)",
        }
    }

    /// A row's milliseconds or million cycles.
    fn of(self, row: &ReportRow) -> f64 {
        match self {
            Across::HostTime if row.host.total_s.is_finite() => {
                row.host.total_s.max(SHORTEST_S) * 1e3
            }
            Across::HostTime => SHORTEST_S * 1e3,
            Across::Cycles => row.cycles.unwrap_or(0).max(1) as f64 / 1e6,
        }
    }
}

/// Draws the sweep in the given size in pixels.
pub fn svg(rows: &[ReportRow], across: Across, width: f64, height: f64) -> String {
    let axes = PlotAxes::new(rows, across, width, height);
    let label = format!("{} against error", across.name());
    let mut chart = Chart::new(width, height, &label);
    axes.draw(&mut chart);
    draw_legend(&mut chart, rows, &axes);
    let designs = distinct(rows.iter().map(|row| row.design.as_str()));
    let mut places = Vec::new();
    for (index, design) in designs.iter().enumerate() {
        let own = || rows.iter().filter(|row| row.design == *design);
        let points: Vec<(f64, f64)> = own().map(|row| axes.point(row)).collect();
        chart.line(&points, &series(index));
        for (row, point) in own().zip(&points) {
            marker(&mut chart, *point, &row.traversal, &series(index));
        }
        places.push(points);
    }
    draw_labels(&mut chart, &designs, &places, &axes.frame);
    // Over every marker a circle that tells its row, for the pointer and for the page's script, which lights row and
    // marker together.
    for (index, row) in rows.iter().enumerate() {
        let attributes = format!("class=\"place\" data-row=\"{index}\" fill=\"none\"");
        let words = format!(
            "{} by {}: {}, {:.1} ms",
            row.design,
            row.traversal,
            table::psnr_text(row.error.psnr_db),
            row.host.total_s * 1e3
        );
        chart.disc(axes.point(row), 11.0, &attributes, &words);
    }
    chart.finish()
}

/// The frame and where values lie in it.
struct PlotAxes {
    frame: Rectangle,
    measure: Across,
    across: Axis,
    up: Axis,
    /// Decibels with a line and a number.
    decibels: Vec<f64>,
    /// Where identical pictures are drawn, if there are any.
    identical: Option<f64>,
}

impl PlotAxes {
    fn new(rows: &[ReportRow], measure: Across, width: f64, height: f64) -> PlotAxes {
        let frame = Rectangle::new([58.0, 34.0], [width - 74.0, height - 84.0]);
        // At least a factor of two, so that equal times do not blow noise up to the width of the picture.
        let values = rows.iter().map(|row| measure.of(row));
        let across = Axis::of_values(values, 2.0, frame.across());
        let known = || {
            rows.iter()
                .map(|row| row.error.psnr_db)
                .filter(|psnr| psnr.is_finite())
        };
        let lowest = known().reduce(f64::min).unwrap_or(0.0);
        let highest = known().reduce(f64::max).unwrap_or(50.0);
        let step = round_step((highest - lowest).max(4.0) / 7.0);
        let first = (lowest / step - 0.3).floor();
        let last = (highest / step + 0.3).ceil();
        let lines = (last - first) as usize;
        let identical = rows.iter().any(|row| row.error.identical);
        let identical = identical.then_some((last + 1.0) * step);
        let top = identical.map_or(last * step, |level| level + step / 2.0);
        PlotAxes {
            frame,
            measure,
            across,
            up: Axis::linear([first * step, top], frame.upwards()),
            decibels: (0..=lines)
                .map(|line| (first + line as f64) * step)
                .collect(),
            identical,
        }
    }

    fn point(&self, row: &ReportRow) -> (f64, f64) {
        let top = self.decibels.last().copied().unwrap_or_default();
        let decibels = Some(row.error.psnr_db)
            .filter(|psnr| psnr.is_finite())
            .or(self.identical)
            .unwrap_or(top);
        (self.across.at(self.measure.of(row)), self.up.at(decibels))
    }

    fn draw(&self, chart: &mut Chart) {
        let frame = &self.frame;
        chart.rows(frame, &self.up, &self.decibels);
        if let Some(level) = self.identical {
            chart.row(frame, self.up.at(level), "equal");
        }
        let room = (frame.width / 48.0) as usize;
        chart.columns(frame, &self.across, &self.across.ticks(room));
        chart.names(frame, self.measure.name(), "PSNR, dB");
    }
}

/// Shapes of the traversals, at the upper right.
fn draw_legend(chart: &mut Chart, rows: &[ReportRow], axes: &PlotAxes) {
    let traversals = distinct(rows.iter().map(|row| row.traversal.as_str()));
    let mut right = axes.frame.left + axes.frame.width;
    for traversal in traversals.iter().rev() {
        let y = axes.frame.top - 18.0;
        let start = right - text_width(traversal);
        chart.text((start, y), Anchor::Start, "", traversal);
        marker(chart, (start - 12.0, y), traversal, &series(5));
        right = start - 34.0;
    }
}

/// One label per design, at its fastest traversal.
fn draw_labels(chart: &mut Chart, designs: &[&str], places: &[Vec<(f64, f64)>], frame: &Rectangle) {
    let drawn: Vec<Rectangle> = places.iter().flat_map(|points| occupied(points)).collect();
    let leftmost = |points: &Vec<(f64, f64)>| {
        let points = points.iter().copied();
        points.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let anchors: Vec<(f64, f64)> = places.iter().filter_map(leftmost).collect();
    let sizes = designs.iter().map(|design| (text_width(design), LINE));
    let sizes: Vec<(f64, f64)> = sizes.collect();
    let placements = labels::place(&anchors, &sizes, &drawn, frame);
    for (index, (design, placement)) in designs.iter().zip(&placements).enumerate() {
        let area = placement.area;
        if placement.leader {
            let (x, y) = anchors[index];
            let reach = (
                x.clamp(area.left, area.left + area.width),
                y.clamp(area.top, area.top + area.height),
            );
            chart.line(&[(x, y), reach], "leader");
        }
        let centre = (area.left + area.width / 2.0, area.top + area.height / 2.0);
        chart.text(centre, Anchor::Middle, &series(index), design);
    }
}

/// What a design's markers and its joining line cover, the line as a chain of small squares.
fn occupied(points: &[(f64, f64)]) -> Vec<Rectangle> {
    let markers = points
        .iter()
        .map(|&point| Rectangle::around(point, MARKER + 2.0));
    let lines = points.windows(2).flat_map(|ends| {
        let ((x0, y0), (x1, y1)) = (ends[0], ends[1]);
        let steps = ((x1 - x0).hypot(y1 - y0) / 6.0).ceil().clamp(1.0, 400.0);
        (0..=steps as usize).map(move |step| {
            let part = step as f64 / steps;
            Rectangle::around((x0 + (x1 - x0) * part, y0 + (y1 - y0) * part), 3.0)
        })
    });
    markers.chain(lines).collect()
}

/// A square for `box`, a circle for `spans`, a triangle for anything else.
fn marker(chart: &mut Chart, (x, y): (f64, f64), traversal: &str, class: &str) {
    let class = format!("mark {class}");
    match traversal {
        "box" => chart.push(&format!(
            "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"10\" height=\"10\"/>",
            x - MARKER,
            y - MARKER
        )),
        "spans" => chart.push(&format!(
            "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\"/>"
        )),
        _ => chart.push(&format!(
            "<polygon class=\"{class}\" points=\"{:.1},{:.1} {:.1},{:.1} {x:.1},{:.1}\"/>",
            x - 7.0,
            y + 6.0,
            x + 7.0,
            y + 6.0,
            y - 7.0
        )),
    }
}

/// Names in the order in which they first appear.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    names.fold(Vec::new(), |mut seen, name| {
        if !seen.contains(&name) {
            seen.push(name);
        }
        seen
    })
}
