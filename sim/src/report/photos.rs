//! Pictures against photographs: a table by engine, what each costs beside double precision, and the views side by
//! side.

use super::chart::{Anchor, Axis, Chart};
use super::error_map::ErrorMap;
use super::html::{Column, escape, table_of};
use super::labels::Rectangle;
use super::png::Rgb;
use super::shell::Shell;
use crate::metrics::PhotoError;
use crate::picture::Picture;
use anyhow::{Result, ensure};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use std::path::PathBuf;

/// What is written into the folder, beside one of pictures for each view.
pub const FILES: [&str; 2] = ["photos.json", "photos.html"];
/// Version of the report.
const FORMAT: &str = "splatline-photos/1";
/// Widest picture of the page.
const SMALL: usize = 400;

/// All views and their means.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhotoReport {
    format: &'static str,
    /// Which views, in words.
    split: String,
    /// View by view.
    views: Vec<PhotoRow>,
    /// Over the views, by engine.
    means: Vec<PhotoMean>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhotoRow {
    pub name: String,
    pub photograph: PathBuf,
    pub size: [usize; 2],
    /// The folder of its pictures.
    pub folder: String,
    /// The reference, the design, and whoever else drew it.
    pub drawn: Vec<Drawn>,
}

/// How far an engine's picture is from the photograph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drawn {
    /// Who drew: `float`, a design, or a format.
    pub engine: String,
    #[serde(flatten)]
    pub error: PhotoError,
}

/// Means of an engine, and what it costs beside the first one: negative PSNR and SSIM and positive FLIP are losses.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhotoMean {
    engine: String,
    #[serde(flatten)]
    mean: PhotoError,
    psnr_change_db: f64,
    ssim_change: f64,
    flip_change: f64,
}

impl PhotoReport {
    /// With the means of all views, all of which the same engines drew.
    pub fn new(split: String, views: Vec<PhotoRow>) -> Result<PhotoReport> {
        let engines = views.first().map_or(0, |row| row.drawn.len());
        ensure!(engines > 0, "there is no view");
        let mean = |place: usize, of: fn(&PhotoError) -> f64| {
            let sum: f64 = views.iter().map(|row| of(&row.drawn[place].error)).sum();
            sum / views.len() as f64
        };
        let means = |place: usize| PhotoError {
            psnr_db: mean(place, |error| error.psnr_db),
            ssim: mean(place, |error| error.ssim),
            flip: mean(place, |error| error.flip),
        };
        let reference = means(0);
        let line = |place: usize| {
            let mean = means(place);
            let change = change(&reference, &mean);
            PhotoMean {
                engine: views[0].drawn[place].engine.clone(),
                psnr_change_db: change.psnr_db,
                ssim_change: change.ssim,
                flip_change: change.flip,
                mean,
            }
        };
        Ok(PhotoReport {
            format: FORMAT,
            split,
            means: (0..engines).map(line).collect(),
            views,
        })
    }

    /// For a terminal: the reference and the design view by view, then the means of all.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{} views against photographs ({})\n{:<24} {:>9} {:>9} {:>9}   {:>9} {:>9} {:>9}   change of PSNR, SSIM, FLIP\n",
            self.views.len(),
            self.split,
            "",
            self.means[0].engine,
            "SSIM",
            "FLIP",
            self.means.get(1).map_or("", |mean| &mean.engine),
            "SSIM",
            "FLIP"
        );
        let numbers =
            |e: &PhotoError| format!("{:>9.3} {:>9.5} {:>9.5}", e.psnr_db, e.ssim, e.flip);
        let changed =
            |e: PhotoError| format!("{:+.4} dB {:+.1e} {:+.1e}", e.psnr_db, e.ssim, e.flip);
        let reference = self.means[0].mean;
        for PhotoRow { name, drawn, .. } in &self.views {
            let [a, b] = [0, 1].map(|place: usize| drawn[place.min(drawn.len() - 1)].error);
            let (first, second, change) = (numbers(&a), numbers(&b), changed(change(&a, &b)));
            text += &format!("{name:<24} {first}   {second}   {change}\n");
        }
        text += "mean over the views\n";
        for PhotoMean { engine, mean, .. } in &self.means {
            let (numbers, change) = (numbers(mean), changed(change(&reference, mean)));
            text += &format!("{engine:<24} {numbers}   {change}\n");
        }
        text
    }
}

/// From one error to another.
fn change(from: &PhotoError, to: &PhotoError) -> PhotoError {
    PhotoError {
        psnr_db: to.psnr_db - from.psnr_db,
        ssim: to.ssim - from.ssim,
        flip: to.flip - from.flip,
    }
}

/// The pictures of a view: photograph, reference, design, and the errors of both by one scale.
pub struct Shown(Vec<(&'static str, String, Rgb)>);

impl Shown {
    /// `drawn` begins with the reference and the design.
    pub fn new(photograph: &Picture, drawn: &[(String, Picture)]) -> Result<Shown> {
        let [(reference, float), (design, fixed), ..] = drawn else {
            anyhow::bail!("a view is drawn by the reference and by a design")
        };
        let float_error = ErrorMap::new(float, photograph);
        let fixed_error = ErrorMap {
            scale: float_error.scale,
            ..ErrorMap::new(fixed, photograph)
        };
        let errors = |name: &str| format!("{name} minus photograph");
        let photograph = Rgb::on_black(photograph);
        Ok(Shown(vec![
            ("photo.png", "photograph".to_owned(), photograph),
            ("float.png", reference.clone(), Rgb::on_black(float)),
            ("fixed.png", design.clone(), Rgb::on_black(fixed)),
            ("float-error.png", errors(reference), float_error.to_rgb()),
            ("fixed-error.png", errors(design), fixed_error.to_rgb()),
        ]))
    }

    /// Their files, of the full size.
    pub fn files(&self) -> anyhow::Result<Vec<(&'static str, Vec<u8>)>> {
        let file =
            |(name, _, picture): &(&'static str, String, Rgb)| Ok((*name, picture.to_png()?));
        self.0.iter().map(file).collect()
    }

    /// For the page: names with pictures of at most 400 columns.
    pub fn small(&self) -> anyhow::Result<Vec<(String, String)>> {
        let small = |(_, name, picture): &(&'static str, String, Rgb)| {
            Ok((name.clone(), STANDARD.encode(shrunk(picture).to_png()?)))
        };
        self.0.iter().map(small).collect()
    }
}

/// Means of squares of pixels, as many as make the picture narrow enough.
fn shrunk(picture: &Rgb) -> Rgb {
    let by = picture.width.div_ceil(SMALL).max(1);
    let [width, height] = [picture.width / by, picture.height / by].map(|side| side.max(1));
    let mean = |at: usize| {
        let (x, y, channel) = (at / 3 % width, at / 3 / width, at % 3);
        let rows = by * y..(by * y + by).min(picture.height);
        let samples = rows.flat_map(|row| {
            let columns = by * x..(by * x + by).min(picture.width);
            columns.map(move |column| {
                u32::from(picture.bytes[3 * (row * picture.width + column) + channel])
            })
        });
        let (sum, count) = samples.fold((0, 0), |(sum, count), value| (sum + value, count + 1));
        (sum / u32::max(count, 1)) as u8
    };
    Rgb {
        width,
        height,
        bytes: (0..3 * width * height).map(mean).collect(),
    }
}

/// One page that stands alone; `shown` are the pictures of each view.
pub fn page(report: &PhotoReport, shown: &[Vec<(String, String)>]) -> String {
    let mut views = String::new();
    for (row, pictures) in report.views.iter().zip(shown) {
        views += &format!(
            "<h3>{}</h3>\n<p class=\"read\">{} × {}, full size in {}/.</p>\n{}\n<div class=\"pictures\">\n",
            escape(&row.name),
            row.size[0],
            row.size[1],
            escape(&row.folder),
            table(
                row.drawn
                    .iter()
                    .map(|drawn| (drawn.engine.as_str(), drawn.error))
            )
        );
        for (name, data) in pictures {
            views += &format!(
                "<figure>\n<figcaption>{0}</figcaption>\n<img alt=\"{0}\" src=\"data:image/png;base64,{data}\">\n</figure>\n",
                escape(name)
            );
        }
        views.push_str("</div>\n");
    }
    let means = report
        .means
        .iter()
        .map(|mean| (mean.engine.as_str(), mean.mean));
    let body = format!(
        "<section>\n<h2>Means</h2>\n<p class=\"read\">PSNR of red, green and blue; SSIM as the trainers measure it (window of 11 × 11 on each \
         colour, zeros around the picture); FLIP at 67 pixels per degree. What an engine costs is its difference from the first line.</p>\n\
         {}\n</section>\n<section class=\"charts\">\n{}</section>\n<section>\n<h2>View by view</h2>\n\
         <p class=\"read\">Errors of a view have one scale: <b>orange</b> is brighter than the photograph, <b>blue</b> darker.</p>\n{views}</section>\n",
        table(means),
        losses(&report.means)
    );
    let facts = format!(
        "<p class=\"facts\">{} views: {}.</p>\n",
        report.views.len(),
        escape(&report.split)
    );
    let product = "splatline: drawn against photographs";
    Shell::still(product, "Photographs", &facts, &body).html()
}

/// A line for each engine, with what it costs beside the first.
fn table<'a>(lines: impl Iterator<Item = (&'a str, PhotoError)> + Clone) -> String {
    let first = lines.clone().next().map(|(_, error)| error);
    let change = |error: &PhotoError| change(first.as_ref().unwrap_or(error), error);
    let columns: [Column<(&str, PhotoError)>; 7] = [
        ("drawn by", &|(engine, _)| escape(engine)),
        ("PSNR, dB", &|(_, error)| format!("{:.3}", error.psnr_db)),
        ("SSIM", &|(_, error)| format!("{:.5}", error.ssim)),
        ("FLIP", &|(_, error)| format!("{:.5}", error.flip)),
        ("PSNR change, dB", &|(_, e)| {
            format!("{:+.4}", change(e).psnr_db)
        }),
        ("SSIM change", &|(_, e)| format!("{:+.1e}", change(e).ssim)),
        ("FLIP change", &|(_, e)| format!("{:+.1e}", change(e).flip)),
    ];
    table_of("", &[0], &columns, lines)
}

/// Decibels that each engine loses against the photographs, fixed widths and float formats in one figure.
fn losses(means: &[PhotoMean]) -> String {
    let losses = || {
        means
            .iter()
            .skip(1)
            .map(|mean| (mean.engine.as_str(), (-mean.psnr_change_db).max(0.0)))
    };
    let frame = Rectangle::new([110.0, 34.0], [560.0, 30.0 * losses().count() as f64]);
    let most = losses().map(|(_, loss)| loss).fold(1e-4, f64::max);
    let across = Axis::linear([0.0, most], frame.across());
    let label = "PSNR lost against the photographs";
    let mut chart = Chart::new(760.0, frame.height + 90.0, label);
    chart.columns(&frame, &across, &across.ticks(6));
    chart.names(&frame, "dB lost beside double precision", "drawn by");
    for (place, (engine, loss)) in losses().enumerate() {
        let top = frame.top + 30.0 * place as f64 + 6.0;
        let end = across.at(loss);
        let bar = Rectangle::new([frame.left, top], [(end - frame.left).max(1.0), 18.0]);
        let words = format!("{engine}: {loss:.4} dB");
        chart.bar(&bar, "class=\"mark s3\"", &words);
        chart.text((frame.left - 8.0, top + 9.0), Anchor::End, "", engine);
        let words = format!("{loss:.4}");
        chart.text((end + 6.0, top + 9.0), Anchor::Start, "", &words);
    }
    chart.finish()
}
