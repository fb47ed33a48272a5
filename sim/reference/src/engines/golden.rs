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

const SPLATS_FILE: &str = "golden_a_splats.tsv";

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
    /// The camera of the header.
    pub camera: Camera,
    /// The `3dgs` rules with the low-pass of the header.
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
        let shown = archive.display();
        let inside = || format!("in '{shown}'");
        let file = File::open(archive).with_context(inside)?;
        let mut files = ZipArchive::new(file).with_context(inside)?;
        let mut text = |file: &str| -> Result<String> {
            let found = files.by_name(file);
            let found = found.with_context(|| format!("no '{file}' in '{shown}'"))?;
            io::read_to_string(found).with_context(inside)
        };
        let mut golden =
            parse(&text(SPLATS_FILE)?).with_context(|| format!("in '{SPLATS_FILE}'"))?;
        for category in &golden.categories {
            let file = format!("golden_a_img_{category}_ma0.999.txt");
            let picture = parse_picture(&text(&file)?, &golden.camera)
                .with_context(|| format!("in '{file}'"))?;
            golden.pictures.insert(category.clone(), picture);
        }
        Ok(golden)
    }

    /// The picture of a category.
    pub fn picture(&self, category: &str) -> Result<&Picture> {
        self.pictures
            .get(category)
            .with_context(|| format!("golden_a has no category '{category}'"))
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
    pub fn measure(&self) -> Result<Vec<Deviation>> {
        self.categories
            .iter()
            .map(|category| self.measure_category(category))
            .collect()
    }

    fn measure_category(&self, category: &str) -> Result<Deviation> {
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
        let drawing = float::draw(
            &self.scene(category),
            camera,
            rules,
            Compositing::FrontToBack,
        );
        let expected = self.picture(category)?;
        let channels = drawing
            .picture
            .pixels
            .iter()
            .flatten()
            .zip(expected.pixels.iter().flatten());
        for (computed, expected) in channels {
            raise(&mut deviation.picture, (computed - expected).abs());
        }
        Ok(deviation)
    }
}

/// A pixel a line: red, green, blue, alpha.
fn parse_picture(text: &str, camera: &Camera) -> Result<Picture> {
    let pixels = data_lines(text).map(numbers).collect::<Result<Vec<_>>>()?;
    let expected = camera.width * camera.height;
    ensure!(
        pixels.len() == expected,
        "{} pixels where {expected} were expected",
        pixels.len()
    );
    Ok(Picture {
        pixels,
        ..Picture::new(camera.width, camera.height)
    })
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

fn numbers<const N: usize>(line: &str) -> Result<[f64; N]> {
    let fields: Vec<f64> = line
        .split(|c: char| c == ',' || c.is_whitespace())
        .map(|field| {
            field
                .parse()
                .with_context(|| format!("'{field}' is not a number"))
        })
        .collect::<Result<_>>()?;
    let found = fields.len();
    fields
        .try_into()
        .ok()
        .with_context(|| format!("expected {N} numbers, found {found}"))
}

/// The value of `key=value` in the comment lines; a key may hold spaces, a value may not.
fn header_value<'a>(text: &'a str, key: &str) -> Result<&'a str> {
    let wanted = format!(" {key}=");
    let comments = text.lines().filter(|line| line.starts_with('#'));
    let mut values =
        comments.filter_map(|line| line.split_once(&wanted)?.1.split_whitespace().next());
    values
        .next()
        .with_context(|| format!("the header does not give '{key}'"))
}

fn header_number(text: &str, key: &str) -> Result<f64> {
    Ok(numbers::<1>(header_value(text, key)?)?[0])
}

fn parse(text: &str) -> Result<GoldenA> {
    let camera = parse_camera(text)?;
    let rules = Rules {
        low_pass: header_number(text, "eps2d")?,
        ..Rules::GAUSSIAN_3D
    };
    let mut lines = data_lines(text);
    let names: Vec<&str> = lines
        .next()
        .context("the table is empty")?
        .split('\t')
        .collect();
    let splats: Vec<GoldenSplat> = lines
        .enumerate()
        .map(|(row, line)| {
            parse_splat(&names, line).with_context(|| format!("row {row} of the table"))
        })
        .collect::<Result<_>>()?;
    let mut categories: Vec<String> = Vec::new();
    for golden in &splats {
        if !categories.contains(&golden.category) {
            categories.push(golden.category.clone());
        }
    }
    categories.push(ALL.to_string());
    Ok(GoldenA {
        camera,
        rules,
        splats,
        categories,
        pictures: HashMap::new(),
    })
}

fn parse_camera(text: &str) -> Result<Camera> {
    let [fx, fy, cx, cy] = numbers(header_value(text, "fx,fy,cx,cy")?)?;
    let view: [f64; 16] = numbers(header_value(text, "viewmat(row-major world->cam)")?)?;
    let file = serde_json::json!({
        "width": header_value(text, "W")?.parse::<usize>()?,
        "height": header_value(text, "H")?.parse::<usize>()?,
        "fx": fx, "fy": fy, "cx": cx, "cy": cy,
        "world_to_camera": view,
        "near": header_number(text, "near")?,
        "far": header_number(text, "far")?,
    });
    Ok(Camera::from_json_str(&file.to_string())?)
}

fn parse_splat(names: &[&str], line: &str) -> Result<GoldenSplat> {
    let fields: Vec<&str> = line.split('\t').collect();
    ensure!(
        fields.len() == names.len(),
        "{} columns instead of {}",
        fields.len(),
        names.len()
    );
    let text = |name: &str| -> Result<&str> {
        let column = names.iter().position(|&n| n == name);
        column
            .map(|column| fields[column])
            .with_context(|| format!("there is no column '{name}'"))
    };
    let number = |name: &str| -> Result<f64> {
        text(name)?
            .parse()
            .with_context(|| format!("column '{name}' is not a number"))
    };
    let triple = |names: [&str; 3]| {
        Ok::<_, anyhow::Error>([number(names[0])?, number(names[1])?, number(names[2])?])
    };
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
