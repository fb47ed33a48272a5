//! Speed against error as SVG: host time or simulated cycles (logarithmic) across, PSNR up, so better is up and to the left.
//!
//! Colour is the design, the marker's shape is the traversal, and a thin line joins the traversals of one design. The
//! axes are drawn by hand on plotters' SVG back end, because its own logarithmic axis leaves narrow ranges without
//! numbers. Every colour is one of a few constants, so that a page can restyle the picture for a dark screen.

use super::ReportRow;
use super::labels::{self, Rectangle};
use super::table;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A colour of the plot on a light and on a dark page, as `#RRGGBB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tone {
    /// As drawn.
    pub light: &'static str,
    /// What a dark page replaces it with.
    pub dark: &'static str,
}

/// Text.
pub const INK: Tone = Tone {
    light: "#3A4048",
    dark: "#C4CAD2",
};
/// Grid.
pub const GRID: Tone = Tone {
    light: "#E3E6EA",
    dark: "#2B3038",
};
/// Leader lines.
pub const LEADER: Tone = Tone {
    light: "#9AA2AC",
    dark: "#6C747E",
};
/// Designs, in the order in which they first appear; further ones begin again.
pub const DESIGNS: [Tone; 6] = [
    Tone {
        light: "#B3261E",
        dark: "#FF8A80",
    },
    Tone {
        light: "#A85A00",
        dark: "#FFB74D",
    },
    Tone {
        light: "#0B7A5B",
        dark: "#6FD3A8",
    },
    Tone {
        light: "#1F55B5",
        dark: "#8AB4F8",
    },
    Tone {
        light: "#7A3FB0",
        dark: "#CBA6F7",
    },
    Tone {
        light: "#5B6470",
        dark: "#B4BCC6",
    },
];

/// Text height in pixels.
const TEXT: f64 = 13.0;
/// plotters multiplies the height of a font by this to get its line height.
const LINE_HEIGHT: f64 = 1.24;
/// Mean width of a letter of a sans-serif font over its height; generous, so that labels keep apart.
const LETTER: f64 = 0.6;
/// Half a marker's size in pixels.
const MARKER: f64 = 5.0;
/// Times below a microsecond are not told apart: a logarithm needs a positive number.
const SHORTEST_S: f64 = 1e-6;

/// Why a plot could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot draw the plot of speed against error: {0}")]
pub struct PlotError(String);

type Canvas<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

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

    /// Decadic logarithm of a row's milliseconds or million cycles.
    fn log(self, row: &ReportRow) -> f64 {
        match self {
            Across::HostTime => log_milliseconds(row),
            Across::Cycles => (row.cycles.unwrap_or(0).max(1) as f64 / 1e6).log10(),
        }
    }
}

/// Draws the sweep against host time as an SVG document of the given size in pixels.
pub fn svg(rows: &[ReportRow], width: u32, height: u32) -> Result<String, PlotError> {
    svg_across(rows, Across::HostTime, width, height)
}

/// Draws the sweep as an SVG document of the given size in pixels.
pub fn svg_across(
    rows: &[ReportRow],
    across: Across,
    width: u32,
    height: u32,
) -> Result<String, PlotError> {
    let mut text = String::new();
    {
        let canvas = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
        draw(&canvas, rows, across, f64::from(width), f64::from(height)).map_err(PlotError)?;
        canvas
            .present()
            .map_err(|error| PlotError(error.to_string()))?;
    }
    let end = text.rfind("</svg>").unwrap_or(text.len());
    let frame = frame_of(f64::from(width), f64::from(height));
    text.insert_str(end, &places(rows, across, frame));
    Ok(text)
}

/// Over every marker a circle that tells its row, for the pointer and for the page's script, which lights row and marker together.
fn places(rows: &[ReportRow], across: Across, frame: Rectangle) -> String {
    let axes = Axes::new(rows, across, frame);
    let place = |(index, row): (usize, &ReportRow)| {
        let (x, y) = axes.point(row);
        format!(
            "<circle class=\"place\" data-row=\"{index}\" fill=\"none\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"11\"><title>{} by {}: {}, {:.1} ms</title></circle>\n",
            row.design.replace('&', "&amp;").replace('<', "&lt;"),
            row.traversal,
            table::psnr_text(row.error.psnr_db),
            row.host.total_s * 1e3
        )
    };
    rows.iter().enumerate().map(place).collect()
}

/// Where the axes' frame lies in a picture.
fn frame_of(width: f64, height: f64) -> Rectangle {
    Rectangle {
        left: 58.0,
        top: 34.0,
        width: width - 74.0,
        height: height - 84.0,
    }
}

fn draw(
    canvas: &Canvas,
    rows: &[ReportRow],
    across: Across,
    width: f64,
    height: f64,
) -> Result<(), String> {
    let axes = Axes::new(rows, across, frame_of(width, height));
    draw_grid(canvas, &axes)?;
    draw_legend(canvas, rows, &axes)?;
    let designs = distinct(rows.iter().map(|row| row.design.as_str()));
    for (index, design) in designs.iter().enumerate() {
        draw_design(canvas, rows, design, tone(index), &axes)?;
    }
    draw_labels(canvas, rows, &designs, &axes)
}

/// The frame in pixels and the values at its edges.
struct Axes {
    frame: Rectangle,
    measure: Across,
    /// Decadic logarithm of milliseconds or million cycles at the left and right edge.
    across: (f64, f64),
    /// Decibels at the lower and upper edge.
    up: (f64, f64),
    /// Decibels between two lines of the grid.
    step: f64,
    /// Where identical pictures are drawn, if there are any.
    identical: Option<f64>,
}

impl Axes {
    fn new(rows: &[ReportRow], measure: Across, frame: Rectangle) -> Axes {
        let (fastest, slowest) =
            range(rows.iter().map(|row| measure.log(row))).unwrap_or((0.0, 1.0));
        // At least a factor of two, so that equal times do not blow noise up to the width of the picture.
        let margin = (0.3 - (slowest - fastest)).max(0.0) / 2.0 + 0.08;
        let (lowest, highest) =
            range(rows.iter().filter_map(|row| row.error.psnr_db)).unwrap_or((0.0, 50.0));
        let step = round_step((highest - lowest).max(4.0) / 7.0);
        let bottom = ((lowest - step * 0.3) / step).floor() * step;
        let top = ((highest + step * 0.3) / step).ceil() * step;
        let identical = rows
            .iter()
            .any(|row| row.error.identical)
            .then_some(top + step);
        let up = (bottom, identical.map_or(top, |level| level + step / 2.0));
        Axes {
            frame,
            measure,
            across: (fastest - margin, slowest + margin),
            up,
            step,
            identical,
        }
    }

    fn x(&self, log: f64) -> f64 {
        let part = (log - self.across.0) / (self.across.1 - self.across.0);
        self.frame.left + part * self.frame.width
    }

    fn y(&self, decibels: f64) -> f64 {
        let part = (decibels - self.up.0) / (self.up.1 - self.up.0);
        self.frame.top + (1.0 - part) * self.frame.height
    }

    fn point(&self, row: &ReportRow) -> (f64, f64) {
        let decibels = row.error.psnr_db.or(self.identical).unwrap_or(self.up.1);
        (self.x(self.measure.log(row)), self.y(decibels))
    }

    /// Times with a number at the axis, in milliseconds: 1, 2, 5 per decade, all nine digits where that gives too few.
    fn times(&self) -> Vec<f64> {
        let within = |digits: &[f64]| multiples(digits, self.across.0, self.across.1);
        let decades = within(&[1.0]);
        let usual = within(&[1.0, 2.0, 5.0]);
        let all = within(&[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let room = (self.frame.width / 48.0) as usize;
        if usual.len() < 3 && all.len() <= room {
            return all;
        }
        if usual.len() <= room { usual } else { decades }
    }

    /// Decibels with a line and a number.
    fn decibels(&self) -> Vec<f64> {
        let top = self.identical.map_or(self.up.1, |level| level - self.step);
        let lines = ((top - self.up.0) / self.step).round() as usize;
        (0..=lines)
            .map(|line| self.up.0 + line as f64 * self.step)
            .collect()
    }
}

/// These digits times powers of ten whose decadic logarithms lie from `low` to `high`: numbers for a logarithmic axis.
pub fn multiples(digits: &[f64], low: f64, high: f64) -> Vec<f64> {
    let decades = low.floor() as i32..=high.ceil() as i32;
    decades
        .flat_map(|decade| digits.iter().map(move |digit| digit * 10f64.powi(decade)))
        .filter(|number| (low..=high).contains(&number.log10()))
        .collect()
}

fn draw_grid(canvas: &Canvas, axes: &Axes) -> Result<(), String> {
    let Rectangle {
        left,
        top,
        width,
        height,
    } = axes.frame;
    let (right, bottom) = (left + width, top + height);
    for decibels in axes.decibels() {
        let y = axes.y(decibels);
        line(canvas, &[(left, y), (right, y)], GRID, 1)?;
        write(
            canvas,
            &format!("{decibels}"),
            (left - 8.0, y),
            INK,
            HPos::Right,
        )?;
    }
    if let Some(level) = axes.identical {
        line(
            canvas,
            &[(left, axes.y(level)), (right, axes.y(level))],
            GRID,
            1,
        )?;
        write(
            canvas,
            "equal",
            (left - 8.0, axes.y(level)),
            INK,
            HPos::Right,
        )?;
    }
    for time in axes.times() {
        let x = axes.x(time.log10());
        line(canvas, &[(x, top), (x, bottom)], GRID, 1)?;
        write(
            canvas,
            &format!("{}", (time * 1e6).round() / 1e6),
            (x, bottom + 14.0),
            INK,
            HPos::Center,
        )?;
    }
    write(
        canvas,
        axes.measure.name(),
        (left + width / 2.0, bottom + 36.0),
        INK,
        HPos::Center,
    )?;
    write(
        canvas,
        "PSNR, dB",
        (left - 44.0, top - 20.0),
        INK,
        HPos::Left,
    )
}

/// Shapes of the traversals, at the upper right.
fn draw_legend(canvas: &Canvas, rows: &[ReportRow], axes: &Axes) -> Result<(), String> {
    let traversals = distinct(rows.iter().map(|row| row.traversal.as_str()));
    let mut right = axes.frame.left + axes.frame.width;
    for traversal in traversals.iter().rev() {
        let y = axes.frame.top - 20.0;
        let start = right - text_width(traversal);
        write(canvas, traversal, (start, y), INK, HPos::Left)?;
        marker(canvas, (start - 12.0, y), traversal, INK)?;
        right = start - 34.0;
    }
    Ok(())
}

fn draw_design(
    canvas: &Canvas,
    rows: &[ReportRow],
    design: &str,
    tone: Tone,
    axes: &Axes,
) -> Result<(), String> {
    let own: Vec<&ReportRow> = rows.iter().filter(|row| row.design == design).collect();
    let points: Vec<(f64, f64)> = own.iter().map(|row| axes.point(row)).collect();
    line(canvas, &points, tone, 1)?;
    own.iter()
        .zip(&points)
        .try_for_each(|(row, &point)| marker(canvas, point, &row.traversal, tone))
}

/// One label per design, at its fastest traversal.
fn draw_labels(
    canvas: &Canvas,
    rows: &[ReportRow],
    designs: &[&str],
    axes: &Axes,
) -> Result<(), String> {
    let drawn: Vec<Rectangle> = designs
        .iter()
        .flat_map(|design| occupied(rows, design, axes))
        .collect();
    let anchors: Vec<(f64, f64)> = designs
        .iter()
        .map(|design| fastest(rows, design, axes))
        .collect();
    let sizes: Vec<(f64, f64)> = designs
        .iter()
        .map(|design| (text_width(design), TEXT * LINE_HEIGHT))
        .collect();
    let placements = labels::place(&anchors, &sizes, &drawn, &axes.frame);
    for (index, (design, placement)) in designs.iter().zip(&placements).enumerate() {
        let area = placement.area;
        let centre = (area.left + area.width / 2.0, area.top + area.height / 2.0);
        if placement.leader {
            let reach = (
                anchors[index].0.clamp(area.left, area.left + area.width),
                anchors[index].1.clamp(area.top, area.top + area.height),
            );
            line(canvas, &[anchors[index], reach], LEADER, 1)?;
        }
        write(canvas, design, centre, tone(index), HPos::Center)?;
    }
    Ok(())
}

/// What a design's markers and its joining line cover, the line as a chain of small squares.
fn occupied(rows: &[ReportRow], design: &str, axes: &Axes) -> Vec<Rectangle> {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .filter(|row| row.design == design)
        .map(|row| axes.point(row))
        .collect();
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

/// The leftmost point of a design.
fn fastest(rows: &[ReportRow], design: &str, axes: &Axes) -> (f64, f64) {
    rows.iter()
        .filter(|row| row.design == design)
        .map(|row| axes.point(row))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((axes.frame.left, axes.frame.top))
}

/// A square for `box`, a circle for `spans`, a triangle for anything else.
fn marker(canvas: &Canvas, point: (f64, f64), traversal: &str, tone: Tone) -> Result<(), String> {
    let style = colour(tone).filled();
    let (x, y) = pixel(point);
    let half = MARKER as i32;
    match traversal {
        "box" => canvas.draw(&plotters::element::Rectangle::new(
            [(x - half, y - half), (x + half, y + half)],
            style,
        )),
        "spans" => canvas.draw(&Circle::new((x, y), half + 1, style)),
        _ => canvas.draw(&TriangleMarker::new((x, y), half + 2, style)),
    }
    .map_err(|error| error.to_string())
}

fn line(canvas: &Canvas, points: &[(f64, f64)], tone: Tone, width: u32) -> Result<(), String> {
    let points: Vec<(i32, i32)> = points.iter().map(|&point| pixel(point)).collect();
    canvas
        .draw(&PathElement::new(points, colour(tone).stroke_width(width)))
        .map_err(|error| error.to_string())
}

fn write(
    canvas: &Canvas,
    text: &str,
    at: (f64, f64),
    tone: Tone,
    anchor: HPos,
) -> Result<(), String> {
    let style = ("sans-serif", TEXT * LINE_HEIGHT)
        .into_font()
        .color(&colour(tone))
        .pos(Pos::new(anchor, VPos::Center));
    canvas
        .draw(&Text::new(text.to_owned(), pixel(at), style))
        .map_err(|error| error.to_string())
}

fn pixel((x, y): (f64, f64)) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

/// The light tone; one of this file's constants, so every digit is valid.
pub fn colour(tone: Tone) -> RGBColor {
    let part = |at: usize| {
        tone.light
            .get(at..at + 2)
            .and_then(|hex| u8::from_str_radix(hex, 16).ok())
            .unwrap_or(0)
    };
    RGBColor(part(1), part(3), part(5))
}

fn tone(design: usize) -> Tone {
    DESIGNS[design % DESIGNS.len()]
}

fn text_width(text: &str) -> f64 {
    text.chars().count() as f64 * TEXT * LETTER
}

fn log_milliseconds(row: &ReportRow) -> f64 {
    let seconds = if row.host.total_s.is_finite() {
        row.host.total_s
    } else {
        0.0
    };
    (seconds.max(SHORTEST_S) * 1e3).log10()
}

/// Smallest and largest value; nothing of nothing.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((low.min(value), high.max(value))),
    })
}

/// 1, 2, 5, 10, 20, 50 ...: the first that is not smaller.
fn round_step(atleast: f64) -> f64 {
    let decade = 10f64.powi(atleast.log10().floor() as i32);
    [1.0, 2.0, 5.0]
        .iter()
        .map(|digit| digit * decade)
        .find(|&step| step >= atleast)
        .unwrap_or(10.0 * decade)
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
