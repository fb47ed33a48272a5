//! `render --maps`: what lies behind the picture's pixels, in files beside it. The kernel's words make them with
//! `--engine fixed`, else the reference's double precision.

use super::output::write;
use super::say::print_result;
use crate::fixed::draw_maps;
use crate::picture::{Depth, Picture, PictureFormat};
use crate::plan::{Engine, Prepared, Subject};
use crate::reference::maps::{self, MapPixel};
use crate::report::png::Rgb;
use crate::rules::Compositing;
use crate::vector;
use anyhow::{Result, anyhow};
use clap::ValueEnum;
use clap::builder::PossibleValue;
use std::path::{Path, PathBuf};

/// A map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Map {
    /// Accumulated, normalised and median.
    Depth,
    /// 1 - transmittance.
    Alpha,
    /// Of the shortest axes.
    Normal,
    /// Splats blended and looked up.
    Count,
    /// The first splat.
    First,
    /// The splat that contributes most.
    Id,
}

impl Map {
    /// `x.png` becomes `x.depth.png`.
    pub fn file(self, picture: &Path) -> PathBuf {
        let extension = picture.extension().unwrap_or_default().to_string_lossy();
        let name = self.to_possible_value();
        let name = name.as_ref().map_or("", PossibleValue::get_name);
        picture.with_extension(format!("{name}.{extension}"))
    }

    /// Four numbers: what float files hold.
    fn numbers(self, pixel: &MapPixel) -> [f64; 4] {
        let number = |index: Option<usize>| index.map_or(-1.0, |index| index as f64);
        match self {
            Map::Depth => [
                pixel.accumulated_depth,
                pixel.normalised_depth(),
                pixel.median_depth,
                pixel.alpha,
            ],
            Map::Alpha => [pixel.alpha; 4],
            Map::Normal => {
                let length = vector::length(pixel.normal);
                let unit = vector::scale(1.0 / length.max(f64::MIN_POSITIVE), pixel.normal);
                [unit[0], unit[1], unit[2], pixel.alpha]
            }
            Map::Count => [pixel.blended.into(), pixel.visited.into(), 0.0, pixel.alpha],
            Map::First => [number(pixel.first), 0.0, 0.0, pixel.alpha],
            Map::Id => [number(pixel.largest), 0.0, 0.0, pixel.alpha],
        }
    }

    /// What its numbers are, for people.
    fn words(self) -> &'static str {
        match self {
            Map::Depth => {
                "accumulated, normalised and median depth, alpha; in colours the normalised one"
            }
            Map::Alpha => "alpha",
            Map::Normal => "x, y, z in camera space, alpha",
            Map::Count => "splats blended, splats looked up; in colours those blended",
            Map::First => "number of the first splat, -1 without any",
            Map::Id => "number of the splat that contributes most, -1 without any",
        }
    }
}

/// Refuses, before anything is drawn, what has no maps.
pub fn check(prepared: &Prepared) -> Result<()> {
    match prepared.subject()? {
        Subject::Splats(splats) if !splats.are_composited() => Err(anyhow!(
            "--maps are of splats that are composited one by one: leave out --points, --traversal stamp, --sheets, --deep-alpha and --spheres"
        )),
        Subject::Splats(splats) if splats.compositing != Compositing::FrontToBack => Err(anyhow!(
            "--maps composite front to back: leave out --compositing"
        )),
        Subject::Splats(_) => Ok(()),
        Subject::Surface(..) => Err(anyhow!(
            "--maps are of volume splats: surfaces keep fragments of their own"
        )),
    }
}

/// Writes maps of what is drawn beside the picture.
pub fn write_maps(prepared: &Prepared, requested: &[Map], picture: &Path) -> Result<()> {
    let splats = prepared.splats()?;
    let (scene, camera) = (splats.scene, splats.camera);
    let pixels = match prepared.plan.engine {
        Engine::Fixed => draw_maps(scene, camera, &splats.options(&prepared.plan.entry)),
        _ => maps::draw(scene, camera, splats.rules),
    };
    let size = [splats.camera.width, splats.camera.height];
    let format = PictureFormat::of(picture).unwrap_or(PictureFormat::Png);
    for map in requested {
        let file = map.file(picture);
        let mut scale = String::new();
        let bytes = if format == PictureFormat::Png {
            let picture;
            (picture, scale) = in_colours(*map, &pixels, size);
            picture.to_png()?
        } else {
            let [width, height] = size;
            let pixels = pixels.iter().map(|pixel| map.numbers(pixel)).collect();
            let numbers = Picture {
                width,
                height,
                pixels,
            };
            numbers.encode(format, Depth::default(), Default::default())?
        };
        write(&file, bytes)?;
        print_result(&format!("{}: {}{scale}\n", file.display(), map.words()))?;
    }
    Ok(())
}

/// A map of a whole picture in false colours, and what they say.
pub fn in_colours(map: Map, pixels: &[MapPixel], size: [usize; 2]) -> (Rgb, String) {
    let numbers: Vec<[f64; 4]> = pixels.iter().map(|pixel| map.numbers(pixel)).collect();
    let value = |numbers: &[f64; 4]| {
        if map == Map::Depth {
            numbers[1]
        } else {
            numbers[0]
        }
    };
    let covered = || numbers.iter().filter(|numbers| numbers[3] > 0.0).map(value);
    let [least, most] = match map {
        Map::Alpha => [0.0, 1.0],
        _ => covered().fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[least, most], value| [least.min(value), most.max(value)],
        ),
    };
    let colour = |pixel: &[f64; 4]| match map {
        _ if pixel[3] <= 0.0 => [0; 3],
        Map::Normal => [0, 1, 2].map(|k: usize| (127.5 + 127.5 * pixel[k]).round() as u8),
        Map::First | Map::Id => of_number(pixel[0]),
        _ => ramp((value(pixel) - least) / (most - least).max(f64::MIN_POSITIVE)),
    };
    let picture = Rgb::of_pixels(size, numbers.iter().map(colour));
    let scale = match map {
        Map::Normal => ": red, green and blue are 127.5 (1 + x), (1 + y) and (1 + z)".to_owned(),
        Map::First | Map::Id => ": a colour of its own for each".to_owned(),
        _ if most < least => String::new(),
        _ => format!(
            ": {least:.4} is violet, {:.4} green, {most:.4} yellow",
            0.5 * (least + most)
        ),
    };
    (picture, scale)
}

/// From violet over blue and green to yellow.
fn ramp(part: f64) -> [u8; 3] {
    const STOPS: [[f64; 3]; 5] = [
        [68.0, 1.0, 84.0],
        [59.0, 82.0, 139.0],
        [33.0, 145.0, 140.0],
        [94.0, 201.0, 98.0],
        [253.0, 231.0, 37.0],
    ];
    let place = 4.0 * part.clamp(0.0, 1.0);
    let from = (place as usize).min(3);
    let part = place - from as f64;
    [0, 1, 2].map(|c: usize| {
        (STOPS[from][c] + part * (STOPS[from + 1][c] - STOPS[from][c])).round() as u8
    })
}

/// Bits of a number's hash, light enough to be told from black.
fn of_number(number: f64) -> [u8; 3] {
    let hash = (number as i64 as u64)
        .wrapping_add(1)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15);
    [56, 48, 40].map(|shift| 64 + (hash >> shift) as u8 % 192)
}
