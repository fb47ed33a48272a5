//! What all charts are drawn with: axes with round numbers, and lines, marks and words as SVG.
//!
//! Colours are classes, to which [`STYLE`] gives a tone for light and for dark pages; a page includes it once, and a
//! picture that stands alone carries it with it ([`alone`]). Sizes are in pixels, y points down.

use super::html::escape;
use super::labels::Rectangle;

/// The classes of charts, each with a tone for light and for dark pages: `grid`, `leader`, `frame`, and `s0` to `s5`
/// for the curves, marks and names of series.
pub const STYLE: &str = include_str!("chart.css");

/// Series that the style tells apart; further ones begin again.
const SERIES: usize = 6;

/// Text height, as the style has it.
pub const TEXT: f64 = 13.0;
/// Mean width of a letter of a sans-serif font over its height; generous, so that labels keep apart.
const LETTER: f64 = 0.6;

/// The class of a series.
pub fn series(index: usize) -> String {
    format!("s{}", index % SERIES)
}

/// A chart as a file of its own.
pub fn alone(chart: &str) -> String {
    let head = "<svg xmlns=\"http://www.w3.org/2000/svg\" ";
    let named = chart.replacen("<svg ", head, 1);
    named.replacen('>', &format!(">\n<style>{STYLE}</style>"), 1)
}

/// About how wide a text is.
pub fn text_width(text: &str) -> f64 {
    text.chars().count() as f64 * TEXT * LETTER
}

/// Where values lie along an axis.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Values at both ends, or their decadic logarithms.
    low: f64,
    high: f64,
    logarithmic: bool,
    /// Places of the ends.
    from: f64,
    to: f64,
}

impl Axis {
    /// From one value to another, at these places.
    pub fn linear([low, high]: [f64; 2], [from, to]: [f64; 2]) -> Axis {
        let high = if high > low { high } else { low + 1.0 };
        Axis {
            low,
            high,
            logarithmic: false,
            from,
            to,
        }
    }

    /// Over values whose logarithms lie within these.
    pub fn decades([low, high]: [f64; 2], [from, to]: [f64; 2]) -> Axis {
        Axis {
            logarithmic: true,
            ..Axis::linear([low, high], [from, to])
        }
    }

    /// Over the range of the positive ones of these values, at least a factor of `least`, with a margin.
    pub fn of_values(values: impl Iterator<Item = f64>, least: f64, ends: [f64; 2]) -> Axis {
        let (low, high) = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), log| {
                (low.min(log), high.max(log))
            });
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let wanted = least.log10() - (high - low);
        let margin = wanted.max(0.0) / 2.0 + ((high - low) * 0.06).max(0.05);
        Axis::decades([low - margin, high + margin], ends)
    }

    /// The place of a value; on a logarithmic axis what is not positive lies at its lower end.
    pub fn at(&self, value: f64) -> f64 {
        let value = match self.logarithmic {
            true if value > 0.0 => value.log10(),
            true => self.low,
            false => value,
        };
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Round numbers among the values, at most about so many.
    ///
    /// On a logarithmic axis 1, 2 and 5 times powers of ten, the powers alone if that is too many, all digits if it is
    /// too few, and even steps where the range is so narrow that no round number lies in it.
    pub fn ticks(&self, room: usize) -> Vec<f64> {
        if !self.logarithmic {
            return even_steps(self.low, self.high, room);
        }
        let usual = self.multiples(&[1.0, 2.0, 5.0]);
        let all = self.multiples(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        if usual.len() > room {
            return self.multiples(&[1.0]);
        }
        if usual.len() >= 4 {
            return usual;
        }
        if (4..=room).contains(&all.len()) {
            return all;
        }
        let [low, high] = [self.low, self.high].map(|log| 10f64.powf(log));
        even_steps(low, high, room.min(7))
    }

    /// These digits times powers of ten within the range.
    fn multiples(&self, digits: &[f64]) -> Vec<f64> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        decades
            .flat_map(|decade| digits.iter().map(move |digit| digit * 10f64.powi(decade)))
            .filter(|number| (self.low..=self.high).contains(&number.log10()))
            .collect()
    }
}

/// 1, 2, 5, 10, 20, 50 ...: the first that is not smaller.
pub fn round_step(at_least: f64) -> f64 {
    let decade = 10f64.powf(at_least.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|digit| digit * decade);
    let found = steps.into_iter().find(|step| *step >= at_least);
    found.unwrap_or(10.0 * decade)
}

/// Multiples of a round step that cut a range into at most so many parts.
fn even_steps(low: f64, high: f64, parts: usize) -> Vec<f64> {
    let step = round_step((high - low) / parts.clamp(1, 100) as f64);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last.min(first + 100))
        .map(|multiple| multiple as f64 * step)
        .collect()
}

/// `20000000` as `20M`, `1250000` as `1.25M`, `0.0005` as `5e-4`.
pub fn short(value: f64) -> String {
    let digits = |value: f64| {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    match value.abs() {
        v if v >= 1e9 => format!("{}G", digits(value / 1e9)),
        v if v >= 1e6 => format!("{}M", digits(value / 1e6)),
        v if v >= 1e4 => format!("{}k", digits(value / 1e3)),
        v if v >= 0.01 || v == 0.0 => digits(value),
        _ => format!("{value:.1e}").replace(".0e", "e"),
    }
}

/// Which part of a text lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

pub struct Chart(String);

impl Chart {
    /// Empty; `label` says what it shows to those who do not see it.
    pub fn new(width: f64, height: f64, label: &str) -> Chart {
        Chart(format!(
            "<svg class=\"chart\" viewBox=\"0 0 {width} {height:.0}\" width=\"{width}\" height=\"{height:.0}\" role=\"img\" aria-label=\"{}\">\n",
            escape(label)
        ))
    }

    pub fn push(&mut self, element: &str) {
        self.0.push_str(element);
        self.0.push('\n');
    }

    pub fn line(&mut self, points: &[(f64, f64)], class: &str) {
        let points: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{x:.1} {y:.1}"))
            .collect();
        self.push(&format!(
            "<path class=\"{class}\" d=\"M{}\"/>",
            points.join("L")
        ));
    }

    /// A curve through points, with its name for the pointer.
    pub fn curve(&mut self, points: impl Iterator<Item = (f64, f64)>, class: &str, name: &str) {
        let points: Vec<String> = points.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        self.push(&format!(
            "<polyline class=\"{class}\" points=\"{}\"><title>{}</title></polyline>",
            points.join(" "),
            escape(name)
        ));
    }

    /// A rectangle with its words for the pointer; `attributes` are those of SVG.
    pub fn bar(&mut self, area: &Rectangle, attributes: &str, words: &str) {
        let (left, top) = (area.left, area.top);
        let (width, height) = (area.width, area.height);
        self.push(&format!(
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" {attributes}><title>{}</title></rect>",
            escape(words)
        ));
    }

    /// A disc with its words for the pointer.
    pub fn disc(&mut self, (x, y): (f64, f64), radius: f64, attributes: &str, words: &str) {
        self.push(&format!(
            "<circle {attributes} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"><title>{}</title></circle>",
            escape(words)
        ));
    }

    /// Words, in the middle of their height.
    pub fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, class: &str, words: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.push(&format!(
            "<text class=\"{class}\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
            y + 0.35 * TEXT,
            escape(words)
        ));
    }

    /// A line of the grid with its number for each of these values across, at the frame's lower edge.
    pub fn columns(&mut self, frame: &Rectangle, axis: &Axis, values: &[f64]) {
        let (top, bottom) = (frame.top, frame.top + frame.height);
        for value in values {
            let x = axis.at(*value);
            self.line(&[(x, top), (x, bottom)], "grid");
            self.text((x, bottom + 14.0), Anchor::Middle, "", &short(*value));
        }
    }

    /// The same upwards, at its left edge.
    pub fn rows(&mut self, frame: &Rectangle, axis: &Axis, values: &[f64]) {
        for value in values {
            self.row(frame, axis.at(*value), &short(*value));
        }
    }

    /// A line of the grid at a height, with its name.
    pub fn row(&mut self, frame: &Rectangle, y: f64, name: &str) {
        self.line(&[(frame.left, y), (frame.left + frame.width, y)], "grid");
        self.text((frame.left - 8.0, y), Anchor::End, "", name);
    }

    /// What lies across, below the numbers, and up, above them.
    pub fn names(&mut self, frame: &Rectangle, across: &str, up: &str) {
        let middle = frame.left + frame.width / 2.0;
        let below = frame.top + frame.height + 36.0;
        self.text((middle, below), Anchor::Middle, "", across);
        self.text((8.0, frame.top - 16.0), Anchor::Start, "", up);
    }

    /// Coloured squares with their words from a place on, in as many lines as it takes; how high these are.
    pub fn legend(&mut self, entries: &[(&str, &str)], frame: &Rectangle, top: f64) -> f64 {
        let (mut x, mut y) = (frame.left, top);
        for (word, colour) in entries {
            let width = 24.0 + text_width(word);
            if x > frame.left && x + width > frame.left + frame.width {
                (x, y) = (frame.left, y + LEGEND_LINE);
            }
            let square = Rectangle::new([x, y], [10.0, 10.0]);
            self.bar(&square, colour, word);
            self.text((x + 14.0, y + 5.0), Anchor::Start, "", word);
            x += width;
        }
        y + LEGEND_LINE - top
    }

    pub fn finish(self) -> String {
        self.0 + "</svg>\n"
    }
}

/// Between the tops of two lines of a legend.
pub const LEGEND_LINE: f64 = 18.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_label_the_data_however_narrow_their_range() {
        for (low, high) in [
            (1.1e6, 1.4e6),
            (9.1e-5, 9.3e-5),
            (1e3, 1e9),
            (4.0, 4.0),
            (2e5, 8e5),
        ] {
            let axis = Axis::of_values([low, high].into_iter(), 1.0, [0.0, 100.0]);
            let ticks = axis.ticks(12);
            assert!(
                (3..=12).contains(&ticks.len()),
                "{low} to {high}: {ticks:?}"
            );
            assert!(
                ticks
                    .iter()
                    .all(|tick| (axis.low..=axis.high).contains(&tick.log10()))
            );
            let texts: std::collections::BTreeSet<String> =
                ticks.iter().map(|tick| short(*tick)).collect();
            assert_eq!(texts.len(), ticks.len(), "{texts:?}");
        }
        assert_eq!(
            Axis::linear([-0.4, 1.1], [0.0, 1.0]).ticks(4),
            [0.0, 0.5, 1.0]
        );
    }

    #[test]
    fn a_legend_stays_within_the_picture() {
        let frame = Rectangle::new([20.0, 0.0], [300.0, 0.0]);
        let mut chart = Chart::new(340.0, 100.0, "legend");
        let words = [
            ("row generator", ""),
            ("write-back", ""),
            ("lanes", ""),
            ("memory", ""),
        ];
        let height = chart.legend(&words, &frame, 10.0);
        assert_eq!(height, 2.0 * LEGEND_LINE);
        let text = chart.finish();
        for (word, _) in words {
            let before = text.split(&format!("\">{word}</text>")).next().unwrap();
            let x = before.rsplit(" x=\"").next().unwrap();
            let x: f64 = x.split('"').next().unwrap().parse().unwrap();
            assert!(x + text_width(word) <= 320.0, "{word} at {x}");
        }
    }

    #[test]
    fn a_chart_alone_has_its_name_space_and_its_style() {
        let mut chart = Chart::new(10.0, 10.0, "a < b");
        chart.text((1.0, 1.0), Anchor::Start, "", "x & y");
        let alone = alone(&chart.finish());
        assert!(alone.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\""));
        assert!(alone.contains("a &lt; b") && alone.contains("x &amp; y"));
        assert!(alone.contains("<style>.chart text") && alone.contains("prefers-color-scheme"));
    }
}
