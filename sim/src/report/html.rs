//! report.html: one file that a reader can open anywhere, with nothing fetched from elsewhere.
//!
//! The page holds its style, its pictures (PNG as data addresses), its plot (inline SVG) and a script (`viewer`) that
//! lays the pictures over each other and reads their pixels; without the script it still says all that it says. Its
//! policy forbids it to load anything. Every number is taken from the [`Report`], so the page never says anything that
//! report.json does not.

use super::error_map::{self, ErrorMap};
use super::facts::ReasonCounts;
use super::formats::formats_section;
use super::machine;
use super::plot::{self, Across};
use super::png::Rgb;
use super::scale::PERCENTILE;
use super::shell::Shell;
use super::table::{COLUMNS, WORD_COLUMNS, count, decibels, scientific, signed, throughput_text};
use super::viewer;
use super::{ErrorFacts, Report, ReportRow};
use crate::machine::accounts::UnitTime;
use crate::metrics::ChannelError;
use crate::picture::Picture;
use crate::scene::SortOrder;
use crate::systems::SystemVerdict;
use anyhow::Result;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// The plot twice, for wide and for narrow screens: shrinking one drawing would make its text unreadable on a phone.
const WIDE_PLOT: (f64, f64) = (1100.0, 480.0);
const NARROW_PLOT: (f64, f64) = (380.0, 420.0);
/// Pictures up to this width are enlarged pixel by pixel instead of smoothly.
const SMALL_PICTURE: usize = 256;

/// The whole page. Both pictures have the size that [`crate::metrics::compare`] has checked, and `map` is theirs.
pub fn page(report: &Report, fixed: &Picture, float: &Picture, map: &ErrorMap) -> Result<String> {
    let body = [
        pictures(report, fixed, float, map)?,
        sweep(report)?,
        systems(report),
        details(report)?,
    ];
    let name = &report.scene.name;
    let shell = Shell {
        title: &format!("{name}: splatline report"),
        product: "splatline: fixed point against float",
        heading: name,
        facts: &facts(report),
        body: &body.concat(),
        footer: &format!(
            "The same numbers for scripts: report.json ({}).",
            escape(&report.format)
        ),
        scripts: &format!(
            "<div id=\"tip\" hidden></div>\n{}",
            viewer::script(fixed, float, &report.engine, reference_name(report))?
        ),
        script_policy: "",
    };
    Ok(shell.html())
}

fn reference_name(report: &Report) -> &str {
    report.reference.as_deref().unwrap_or("float")
}

/// Below the heading: what was drawn, what is to be known about it, and the figures.
fn facts(report: &Report) -> String {
    let camera = &report.camera;
    let facts = format!(
        "{splats} splats at {width} × {height}, rules {rules}, {compositing}{order}. {subject} compared with the {reference} engine.",
        splats = count(report.scene.splats),
        width = camera.width,
        height = camera.height,
        rules = escape(report.rules.name),
        compositing = escape(&report.compositing),
        order = match report.scene.order {
            SortOrder::Depth => "",
            SortOrder::Distance => " by distance from the eye",
        },
        subject = escape(&subject(report)),
        reference = escape(report.reference.as_deref().unwrap_or("no")),
    );
    let warnings: String = report
        .warnings
        .iter()
        .map(|line| format!("<p class=\"facts\">Warning: {}</p>\n", escape(line)))
        .collect();
    format!(
        "<p class=\"facts\">{facts}</p>\n{warnings}{}",
        headline(report)
    )
}

/// What drew the picture, in words.
fn subject(report: &Report) -> String {
    match &report.traversal {
        Some(traversal) => format!("Design {} by {traversal}", report.design_name()),
        None => format!("Engine {}", report.engine),
    }
}

/// The few figures that a reader looks for first.
fn headline(report: &Report) -> String {
    let mut figures: Vec<(&str, String)> = Vec::new();
    let psnr = |psnr_db: f64| match decibels(psnr_db) {
        number if psnr_db.is_finite() => format!("{number} <small>dB</small>"),
        identical => identical,
    };
    if let Some(error) = &report.error {
        figures.push(("PSNR of RGB", psnr(error.rgb.psnr_db)));
        figures.push(("largest error", scientific(error.rgb.max_abs)));
        figures.push(("bias", signed(error.rgb.bias)));
        figures.push(("99 % within", scientific(error.rgb.percentiles.p99)));
        figures.push(("SSIM", format!("{:.5}", error.rgb.ssim)));
        figures.push(("FLIP", scientific(error.flip)));
        let covered = &error.rgb.covered;
        figures.push(("PSNR, covered pixels", psnr(covered.psnr_db)));
        figures.push(("bias, covered pixels", signed(covered.bias)));
    }
    if let Some(ratio) = report.pixels.and_then(|pixels| pixels.ratio()) {
        figures.push(("visited / covered", format!("{ratio:.2}")));
    }
    let milliseconds = report.host.total_s * 1e3;
    let time = format!("{milliseconds:.1} <small>ms</small>");
    figures.push(("host time", time));
    headline_of(&figures)
}

/// Figures with their names, both as HTML.
pub fn headline_of(figures: &[(&str, String)]) -> String {
    let items: String = figures
        .iter()
        .map(|(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"))
        .collect();
    format!("<dl class=\"headline\">\n{items}</dl>\n")
}

fn pictures(report: &Report, fixed: &Picture, float: &Picture, map: &ErrorMap) -> Result<String> {
    let reference = reference_name(report);
    let drawn_by = match &report.traversal {
        Some(traversal) => format!("{}, {traversal}", report.design_name()),
        None => "double precision".to_owned(),
    };
    let fixed_note = format!("<b>{}</b> {}", escape(&report.engine), escape(&drawn_by));
    let float_note = format!("<b>{}</b> double precision", escape(reference));
    let map_note = match map.magnification() {
        Some(factor) => {
            format!(
                "<b>error</b> fixed minus {}, magnified ×{}",
                escape(reference),
                magnified(factor)
            )
        }
        None => "<b>error</b> none: the pictures are identical".to_owned(),
    };
    let [fixed, float] = [fixed, float].map(Rgb::on_black);
    let layers = [
        ("fixed", fixed_note, fixed, "the fixed-point picture"),
        ("float", float_note, float, "the reference picture"),
        ("error", map_note, map.to_rgb(), "map of signed errors"),
    ];
    let mut figures = String::new();
    for (layer, note, picture, alternative) in layers {
        let below = match layer {
            "error" => scale_bar(map),
            _ => String::new(),
        };
        let class = if picture.width <= SMALL_PICTURE {
            " class=\"small\""
        } else {
            ""
        };
        figures += &format!(
            "<figure>\n<figcaption>{note}</figcaption>\n<div class=\"view\" data-layer=\"{layer}\" tabindex=\"0\"><img{class} width=\"{width}\" height=\"{height}\" alt=\"{alternative}\" \
             src=\"data:image/png;base64,{data}\"><i hidden></i></div>\n{below}</figure>\n",
            width = picture.width,
            height = picture.height,
            data = STANDARD.encode(picture.to_png()?),
        );
    }
    Ok(format!(
        "<section>\n<h2>Pictures</h2>\n<p class=\"read\">{text}</p>\n{controls}<div class=\"pictures\" id=\"side\">\n{figures}</div>\n{readings}</section>\n",
        controls = viewer::CONTROLS,
        readings = viewer::readings(map),
        text = pictures_text(map),
    ))
}

fn pictures_text(map: &ErrorMap) -> String {
    let shown = "The pictures show linear values on black, as stored, without gamma.";
    if map.scale.limit == 0.0 {
        return shown.to_owned();
    }
    format!(
        "{shown} In the map each pixel is its worst colour channel: <b>orange</b> where fixed point is brighter, <b>blue</b> \
         where it is darker, dark where both agree. Full colour is {limit}, or {steps} steps of an 8-bit picture: {percentile} % of the pixels that differ \
         do so by no more, and {outliers} do by more, at most {largest}. Towards its ends the scale is logarithmic: \
         read colours by the numbers under the bar.",
        limit = scientific(map.scale.limit),
        steps = eight_bit_steps(map.scale.limit),
        percentile = PERCENTILE,
        outliers = plural(map.scale.outliers, "pixel", ""),
        largest = scientific(map.scale.largest),
    )
}

/// An error in steps of an 8-bit picture.
fn eight_bit_steps(error: f64) -> String {
    let steps = error * 255.0;
    if steps < 0.01 {
        scientific(steps)
    } else {
        format!("{steps:.2}")
    }
}

/// Two significant digits, without an exponent where that is short.
fn magnified(factor: f64) -> String {
    if factor < 10.0 {
        return format!("{factor:.1}");
    }
    if factor >= 1e7 {
        return format!("{factor:.1e}");
    }
    let unit = 10f64.powi(factor.log10().floor() as i32 - 1);
    count(((factor / unit).round() * unit) as u64)
}

/// The colour scale with numbers; nothing if there is no error.
fn scale_bar(map: &ErrorMap) -> String {
    if map.scale.limit == 0.0 {
        return String::new();
    }
    let stops: Vec<String> = (0..=40)
        .map(|step| error_map::colour(f64::from(step) / 20.0 - 1.0))
        .map(|[red, green, blue]| format!("rgb({red},{green},{blue})"))
        .collect();
    let ticks: String = [-1.0, -0.5, 0.0, 0.5, 1.0]
        .map(|position| format!("<span>{}</span>", signed(map.scale.difference_at(position))))
        .concat();
    format!(
        "<div class=\"bar\" role=\"img\" aria-label=\"colour scale\" style=\"background:linear-gradient(to right,{})\"></div>\n\
         <div class=\"ticks\">{ticks}</div>\n<div class=\"ticks ends\"><span>darker</span><span>brighter</span></div>\n",
        stops.join(","),
    )
}

fn sweep(report: &Report) -> Result<String> {
    let errors = report.error.as_ref().map(error_table).unwrap_or_default();
    if report.table.is_empty() {
        return Ok(errors);
    }
    Ok(format!(
        "{errors}{plots}\
         <section>\n<h2>All designs</h2>\n<p class=\"read\">Errors are those of red, green and blue in units of 1.0 (one step of \
         an 8-bit picture is 3.9e-3). Bias is the mean of fixed minus float: negative means darker. p99: 99 % of the samples differ by no more. FLIP: mean difference that an eye sees. PSNR, bias and SSIM come twice, over the whole picture and \
         (cov) over the pixels that either picture covers. Visited counts each \
         pixel that a traversal steps over, once per splat; vis/cov divides it by the pixels inside the footprints, and 1 \
         is the best possible.</p>\n<div class=\"scroll\">{table}</div>\n</section>\n{formats}{machine}",
        plots = plots(report),
        table = sweep_table(report),
        formats = formats_section(report),
        machine = machine_section(report),
    ))
}

/// Time and cycles against error; nothing of a single row, whose dot would say no more than the row.
fn plots(report: &Report) -> String {
    if report.table.len() < 2 {
        return String::new();
    }
    format!(
        "<section>\n<h2>Speed against error</h2>\n<p class=\"read\">Up is nearer to the reference, left is faster: the \
         best corner is the upper left. A colour is a design, a shape is a traversal, and a line joins the two traversals \
         of one design. Time is that of the bit-exact model on this machine ({repeat}, {threads}); it orders the designs' \
         work, it is not the time of a chip. Point at a mark for its row.</p>\n{time}{cycles}</section>\n",
        repeat = runs(report),
        threads = plural(report.host.threads, "thread", ""),
        time = in_both_sizes(report, Across::HostTime),
        cycles = cycles_plot(report),
    )
}

/// The same designs against cycles of the hardware model, if it was run.
fn cycles_plot(report: &Report) -> String {
    if report.table.iter().all(|row| row.cycles.is_none()) {
        return String::new();
    }
    format!(
        "<p class=\"read\">The same designs in clock cycles of the hardware model: one raster unit of one lane unless a machine \
         was given. Widths hardly change cycles, the traversal does.</p>\n{}",
        in_both_sizes(report, Across::Cycles)
    )
}

/// A plot of the designs for wide and for narrow screens, of which the style shows one.
fn in_both_sizes(report: &Report, across: Across) -> String {
    let plot = |(width, height)| plot::svg(&report.table, across, width, height);
    format!(
        "<div class=\"plot\">\n<div class=\"wide\">{}</div>\n<div class=\"narrow\">{}</div>\n</div>\n",
        plot(WIDE_PLOT),
        plot(NARROW_PLOT)
    )
}

/// The accounts of the machine's units for the chosen design.
fn machine_section(report: &Report) -> String {
    let Some(cycles) = &report.cycles else {
        return String::new();
    };
    type Unit<'a> = (&'a &'static str, &'a UnitTime);
    let causes = |(_, unit): &Unit| {
        let stalled = unit.stalled.iter();
        let causes = stalled
            .map(|(cause, cycles)| format!("{} {}", cause.replace('_', " "), count(*cycles)));
        escape(&causes.collect::<Vec<_>>().join(", "))
    };
    let columns: [Column<Unit>; 6] = [
        ("unit", &|(name, _)| escape(&name.replace('_', " "))),
        ("number", &|(_, unit)| count(unit.instances)),
        ("busy", &|(_, unit)| count(unit.busy)),
        ("busy %", &|(_, unit)| {
            format!("{:.1}", 100.0 * unit.utilisation)
        }),
        ("idle", &|(_, unit)| count(unit.idle)),
        ("stalled by", &causes),
    ];
    let table = table_of("", &[0, 5], &columns, &cycles.units);
    let pace = escape(throughput_text(report).trim_end());
    format!(
        "<section>\n<h2>Cycles of the machine</h2>\n<p class=\"read\">{pace}</p>\n<p class=\"read\">{} For every unit busy, \
         stalled and idle cycles add up to its number times the total; utilisation is the busy part.</p>\n{table}\n</section>\n",
        machine::phases(cycles),
    )
}

/// How often the designs were drawn.
fn runs(report: &Report) -> String {
    let runs = || report.table.iter().map(|row| row.host.repeat);
    match (runs().min(), runs().max()) {
        (Some(least), Some(most)) if least < most => format!("medians of {least} to {most} runs"),
        _ => plural(report.host.repeat, "run", "median of "),
    }
}

/// `1 run`, `median of 5 runs`.
fn plural(count: usize, noun: &str, many: &str) -> String {
    if count == 1 {
        format!("1 {noun}")
    } else {
        format!("{many}{count} {noun}s")
    }
}

/// Which systems of the papers were at work, each with the error of the picture that they made together.
fn systems(report: &Report) -> String {
    if report.systems.is_empty() {
        return String::new();
    }
    let of = |verdict: &SystemVerdict, show: fn(&ChannelError) -> String| {
        let error = report.error.filter(|_| verdict.used);
        error.map_or_else(String::new, |error| show(&error.rgb))
    };
    let in_picture = |verdict: &&SystemVerdict| {
        let used = if verdict.used {
            "used"
        } else {
            "not exercised"
        };
        format!("{used}: {}", escape(&verdict.reason))
    };
    let columns: [Column<&SystemVerdict>; 6] = [
        ("#", &|verdict| verdict.number.to_string()),
        ("system", &|verdict| escape(&verdict.name)),
        ("in this picture", &in_picture),
        ("PSNR dB", &|verdict| {
            of(verdict, |error| decibels(error.psnr_db))
        }),
        ("max error", &|verdict| {
            of(verdict, |error| scientific(error.max_abs))
        }),
        ("bias", &|verdict| of(verdict, |error| signed(error.bias))),
    ];
    format!(
        "<section>\n<h2>Systems of the papers</h2>\n<p class=\"read\">Which systems this picture exercises. The error is that of the picture, \
         which those in use made together; each system by itself is measured in docs/results/systems.md.</p>\n{}\n</section>\n",
        table_of("", &[1, 2], &columns, &report.systems)
    )
}

/// Errors of the chosen design per channel group.
fn error_table(error: &ErrorFacts) -> String {
    type Channels<'a> = (&'a str, &'a ChannelError);
    let place = |(_, of): &Channels| {
        let channel = ["R", "G", "B", "A"].get(of.max_at.channel);
        format!(
            "({}, {}) {}",
            of.max_at.x,
            of.max_at.y,
            channel.unwrap_or(&"?")
        )
    };
    let columns: [Column<Channels>; 12] = [
        ("channels", &|(name, _)| (*name).to_owned()),
        ("PSNR dB", &|(_, of)| decibels(of.psnr_db)),
        ("max error", &|(_, of)| scientific(of.max_abs)),
        ("at pixel", &place),
        ("p95", &|(_, of)| scientific(of.percentiles.p95)),
        ("p99", &|(_, of)| scientific(of.percentiles.p99)),
        ("bias", &|(_, of)| signed(of.bias)),
        ("SSIM", &|(_, of)| format!("{:.6}", of.ssim)),
        ("covered pixels", &|(_, of)| count(of.covered.pixels as u64)),
        ("PSNR cov", &|(_, of)| decibels(of.covered.psnr_db)),
        ("bias cov", &|(_, of)| signed(of.covered.bias)),
        ("SSIM cov", &|(_, of)| format!("{:.6}", of.covered.ssim)),
    ];
    let lines = [("RGB", &error.rgb), ("alpha", &error.alpha)];
    format!(
        "<section>\n<h2>Errors of the picture</h2>\n<p class=\"read\">p95 and p99: so many percent of the samples differ by no more. FLIP is the mean \
         difference that an eye sees of colours in sRGB (HPG 2020), at {:.1} pixels per degree: {}.</p>\n{}\n</section>\n",
        error.flip_pixels_per_degree,
        scientific(error.flip),
        table_of(" class=\"short\"", &[0], &columns, lines)
    )
}

fn sweep_table(report: &Report) -> String {
    let words: Vec<usize> = (0..WORD_COLUMNS).collect();
    let line = |(index, row): (usize, &ReportRow)| {
        let chosen =
            row.design == report.design_name() && Some(&row.traversal) == report.traversal.as_ref();
        let mark = if chosen { " class=\"chosen\"" } else { "" };
        let cells = COLUMNS.map(|(_, cell)| escape(&cell(row)));
        html_row(
            &format!("{mark} data-row=\"{index}\""),
            "td",
            &words,
            &cells,
        )
    };
    let lines: String = report.table.iter().enumerate().map(line).collect();
    let headings = html_row("", "th", &words, &COLUMNS.map(|(heading, _)| heading));
    format!("<table id=\"designs\">\n{headings}{lines}</table>")
}

/// A column of a table: its heading, and its cell of a row, both as HTML.
pub type Column<'a, T> = (&'a str, &'a dyn Fn(&T) -> String);

/// A table that scrolls where it is too wide; `words` are the columns of words.
pub fn table_of<T>(
    attributes: &str,
    words: &[usize],
    columns: &[Column<T>],
    rows: impl IntoIterator<Item = T>,
) -> String {
    let headings: Vec<&str> = columns.iter().map(|(heading, _)| *heading).collect();
    let cells = |row: T| columns.iter().map(|(_, cell)| cell(&row)).collect();
    html_table(attributes, words, &headings, rows.into_iter().map(cells))
}

/// The same of rows that are there. Headings and cells are HTML.
pub fn html_table(
    attributes: &str,
    words: &[usize],
    headings: &[&str],
    rows: impl Iterator<Item = Vec<String>>,
) -> String {
    let headings = html_row("", "th", words, headings);
    let rows: String = rows.map(|row| html_row("", "td", words, &row)).collect();
    format!("<div class=\"scroll\"><table{attributes}>\n{headings}{rows}</table></div>")
}

fn html_row(attributes: &str, tag: &str, words: &[usize], cells: &[impl AsRef<str>]) -> String {
    let mut text = format!("<tr{attributes}>");
    for (column, cell) in cells.iter().enumerate() {
        let is_word = words.contains(&column);
        let class = if is_word { " class=\"word\"" } else { "" };
        text += &format!("<{tag}{class}>{}</{tag}>", cell.as_ref());
    }
    text + "</tr>\n"
}

fn details(report: &Report) -> Result<String> {
    #[derive(Serialize)]
    struct LeftOut<'a> {
        #[serde(rename = "skipped when loading")]
        skipped: &'a ReasonCounts,
        #[serde(rename = "culled by this camera")]
        culled: &'a ReasonCounts,
        #[serde(rename = "clamped to the kernel's formats, but drawn")]
        clamped: u64,
    }
    let left_out = LeftOut {
        skipped: &report.scene.skipped,
        culled: &report.scene.culled,
        clamped: report.scene.clamped,
    };
    let folds = [
        fold("Splats left out or clamped", &left_out)?,
        fold("The design, fully resolved", &report.design)?,
        fold("Camera", &report.camera)?,
        fold("Rules of blending", &report.rules)?,
    ];
    Ok(section("Details", &folds.concat()))
}

/// A part of a page.
pub fn section(title: &str, body: &str) -> String {
    let title = escape(title);
    format!("<section>\n<h2>{title}</h2>\n{body}\n</section>\n")
}

fn fold(title: &str, facts: &impl Serialize) -> Result<String> {
    Ok(format!(
        "<details><summary>{title}</summary><pre>{}</pre></details>\n",
        escape(&serde_json::to_string_pretty(facts)?)
    ))
}

/// Text as HTML; names come from files of strangers.
pub fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    let text = text.replace('>', "&gt;").replace('"', "&quot;");
    text.replace('\'', "&#39;")
}
