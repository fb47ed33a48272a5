//! Independent data to measure the reference against: 256 hard Gaussians in ten categories.
//!
//! The data set (`assets/golden_a.zip`) was computed by code that shares nothing with this project's, under the `3dgs`
//! rules: projections in double precision, conics in 60-digit arithmetic, and one 64 x 64 picture per category. The
//! tests hold the reference to it, and the lab prints the same table.

use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use zip::ZipArchive;

use super::float;
use crate::camera::Camera;
use crate::picture::Picture;
use crate::rules::{Compositing, Rules};
use crate::scene::{Scene, Splat};

/// The category whose picture holds all splats.
pub const ALL: &str = "all";

/// One splat of the data set with what others computed for it.
#[derive(Clone, Debug, PartialEq)]
pub struct GoldenSplat {
    /// What makes it hard.
    pub category: String,
    /// The splat; its weight is the opacity.
    pub splat: Splat,
    /// Centre [u, v] in the picture, pixels; infinite at depth zero.
    pub centre: [f64; 2],
    /// Camera-space z.
    pub depth: f64,
    /// sqrt(det V' / det(V' + V^h)) as gsplat computes it.
    pub compensation: f64,
    /// Conic (A, B, C) in 60-digit arithmetic, with low-pass; NaN at depth zero.
    pub exact_conic: [f64; 3],
}

/// The data set.
#[derive(Clone, Debug, PartialEq)]
pub struct GoldenA {
    /// The camera that every file's header states: 64 x 64 pixels, focal length 60, in the origin along z.
    pub camera: Camera,
    /// The `3dgs` rules.
    pub rules: Rules,
    /// All splats, in the order of the file.
    pub splats: Vec<GoldenSplat>,
    /// The categories in the order of their first splat, then [`ALL`].
    pub categories: Vec<String>,
    pictures: HashMap<String, Picture>,
}

/// Largest differences between the reference and the data set within one category.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Deviation {
    /// The category.
    pub category: String,
    /// Projections compared: all but those before the near plane.
    pub splats: usize,
    /// Largest difference of an entry of the conic over its largest entry.
    pub conic: f64,
    /// Largest difference of the centre, pixels, over the larger of 1 and the distance from the origin.
    pub centre: f64,
    /// Largest relative difference of the depth.
    pub depth: f64,
    /// Largest difference of a channel of the picture, in units of 1.0.
    pub picture: f64,
}

/// The data set of this repository; it is no part of a published crate.
pub fn archive() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/golden_a.zip")
}

impl GoldenA {
    /// Reads the archive: the table of splats and a picture of each category.
    pub fn load(archive: &Path) -> Result<GoldenA> {
        let shown = || format!("in '{}'", archive.display());
        let mut files = ZipArchive::new(File::open(archive).with_context(shown)?)?;
        let mut read = |name: &str| -> Result<String> {
            let file = files.by_name(name).with_context(|| format!("'{name}'"));
            Ok(io::read_to_string(file.with_context(shown)?)?)
        };
        let splats = parse_splats(&read("golden_a_splats.tsv")?)?;
        let mut categories: Vec<String> = Vec::new();
        for golden in &splats {
            if !categories.contains(&golden.category) {
                categories.push(golden.category.clone());
            }
        }
        categories.push(ALL.to_string());
        let camera = Camera::centred(64, 64, 60.0);
        let mut pictures = HashMap::new();
        for category in &categories {
            let text = read(&format!("golden_a_img_{category}_ma0.999.txt"))?;
            let picture = parse_picture(&text, &camera).with_context(|| category.clone())?;
            pictures.insert(category.clone(), picture);
        }
        Ok(GoldenA {
            camera,
            rules: Rules::GAUSSIAN_3D,
            splats,
            categories,
            pictures,
        })
    }

    /// The splats of a category.
    pub fn members(&self, category: &str) -> impl Iterator<Item = &GoldenSplat> {
        self.splats
            .iter()
            .filter(move |golden| category == ALL || golden.category == category)
    }

    /// The splats of a category as a scene.
    pub fn scene(&self, category: &str) -> Scene {
        let splats = self.members(category).map(|golden| golden.splat).collect();
        Scene::of_splats(format!("golden_a {category}"), self.rules, splats)
    }

    /// Measures engine `float` against the data set, category by category.
    pub fn measure(&self) -> Vec<Deviation> {
        let categories = self.categories.iter();
        categories.map(|c| self.measure_category(c)).collect()
    }

    fn measure_category(&self, category: &str) -> Deviation {
        let (camera, rules) = (&self.camera, &self.rules);
        let mut deviation = Deviation {
            category: category.to_string(),
            ..Deviation::default()
        };
        for golden in self.members(category) {
            // Opaque, so that a projection is compared whether or not it would leave a trace in the picture.
            let opaque = Splat {
                weight: 1.0,
                ..golden.splat
            };
            let projected = float::project_beyond_viewport(&opaque, camera, rules);
            let Ok(footprint) = projected else { continue };
            deviation.splats += 1;
            let conic = conic_difference(footprint.variance.conic(), golden.exact_conic);
            let centre = difference(footprint.centre, golden.centre, 1.0);
            let depth = (footprint.depth / golden.depth - 1.0).abs();
            raise(&mut deviation.conic, conic);
            raise(&mut deviation.centre, centre);
            raise(&mut deviation.depth, depth);
        }
        let (scene, order) = (self.scene(category), Compositing::FrontToBack);
        let drawn = float::draw(&scene, camera, rules, order).picture;
        let expected = &self.pictures[category].pixels;
        let channels = drawn.pixels.iter().flatten().zip(expected.iter().flatten());
        for (computed, expected) in channels {
            raise(&mut deviation.picture, (computed - expected).abs());
        }
        deviation
    }
}

/// A pixel a line: red, green, blue, alpha.
fn parse_picture(text: &str, camera: &Camera) -> Result<Picture> {
    let pixel = |line: &str| -> Result<[f64; 4]> {
        let channels: Result<Vec<f64>, _> = line.split(' ').map(str::parse).collect();
        let channels = channels?.try_into().ok();
        channels.with_context(|| format!("'{line}' has not four channels"))
    };
    let picture = Picture {
        width: camera.width,
        height: camera.height,
        pixels: data_lines(text).map(pixel).collect::<Result<_>>()?,
    };
    ensure!(
        picture.pixels.len() == camera.width * camera.height,
        "{} pixels are too few or too many",
        picture.pixels.len()
    );
    Ok(picture)
}

/// Largest difference of an entry over the largest entry.
pub fn conic_difference(computed: [f64; 3], exact: [f64; 3]) -> f64 {
    difference(computed, exact, 0.0)
}

/// Largest difference of an entry over the largest entry, or over `floor` where all are smaller.
fn difference<const N: usize>(computed: [f64; N], exact: [f64; N], floor: f64) -> f64 {
    let scale = exact.iter().fold(floor, |scale, e| scale.max(e.abs()));
    let mut most = 0.0;
    for (computed, exact) in computed.iter().zip(exact) {
        raise(&mut most, (computed - exact).abs() / scale);
    }
    most
}

/// Like `f64::max`, but a NaN is as bad as can be instead of ignored.
fn raise(most: &mut f64, difference: f64) {
    *most = if difference.is_nan() {
        f64::INFINITY
    } else {
        most.max(difference)
    };
}

fn data_lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter(|line| !line.starts_with('#') && !line.trim().is_empty())
}

/// A table whose first line names the columns.
fn parse_splats(text: &str) -> Result<Vec<GoldenSplat>> {
    let mut lines = data_lines(text).map(|line| line.split('\t'));
    let names: Vec<&str> = lines.next().context("the table is empty")?.collect();
    let row = |fields| names.iter().copied().zip(fields).collect();
    lines.map(|fields| parse_splat(&row(fields))).collect()
}

fn parse_splat(row: &HashMap<&str, &str>) -> Result<GoldenSplat> {
    let text = |name: &str| {
        let field = row.get(name).copied();
        field.with_context(|| format!("a row lacks the column '{name}'"))
    };
    let number = |name: &str| -> Result<f64> { Ok(text(name)?.parse()?) };
    let triple =
        |[a, b, c]: [&str; 3]| -> Result<[f64; 3]> { Ok([number(a)?, number(b)?, number(c)?]) };
    let quaternion = [number("qw")?, number("qx")?, number("qy")?, number("qz")?];
    Ok(GoldenSplat {
        category: text("cat")?.to_string(),
        splat: Splat {
            centre: triple(["mx", "my", "mz"])?,
            axes: rotated_axes(quaternion, triple(["sx", "sy", "sz"])?),
            weight: number("opac")?,
            colour: triple(["r", "g", "b"])?,
        },
        centre: [number("u")?, number("v")?],
        depth: number("depth")?,
        compensation: number("comp")?,
        exact_conic: triple(["exact_conA", "exact_conB", "exact_conC"])?,
    })
}

/// The axes of a splat: the coordinate axes, scaled, then turned by a quaternion (w, x, y, z) of any length.
pub fn rotated_axes(quaternion: [f64; 4], scales: [f64; 3]) -> [[f64; 3]; 3] {
    let [w, x, y, z] = quaternion;
    let twice = 2.0 / (w * w + x * x + y * y + z * z);
    let columns = [
        [
            1.0 - twice * (y * y + z * z),
            twice * (x * y + w * z),
            twice * (x * z - w * y),
        ],
        [
            twice * (x * y - w * z),
            1.0 - twice * (x * x + z * z),
            twice * (y * z + w * x),
        ],
        [
            twice * (x * z + w * y),
            twice * (y * z - w * x),
            1.0 - twice * (x * x + y * y),
        ],
    ];
    [0, 1, 2].map(|k| columns[k].map(|c| scales[k] * c))
}
