//! A checkerboard plane to the horizon: aliasing and blur of no filter, \[SWAN\] and EWA.
//!
//! One layer of voxels, 1 apart, as volume splats. The truth is the unfiltered drawing at 64 samples per pixel (8 by 8),
//! averaged by a Gaussian pixel filter of unit variance, the low-pass of \[EWA\] 7.1; averaged over the pixel's square it keeps
//! details below two pixels that any Gaussian blurs, and the error is blur more than aliasing. Everything is summed (X-ray), as in \[SWAN\] 3.1, each sample with the mass that makes the plane equally bright from
//! everywhere, so that the error is the filter's alone: composited by "over" at a grazing angle, the nearer half of every
//! widened footprint hides the farther half, which moves the picture by a pixel whatever the filter. Beyond the distance k samples lie closer together than pixels; the error there is what a filter must remove.

use super::{errors, number, standard24};
use crate::gallery::Exhibit;
use splatline_sim::camera::Camera;
use splatline_sim::fixed;
use splatline_sim::picture::Picture;
use splatline_sim::reference::float;
use splatline_sim::rules::{Antialias, Compositing, Rules};
use splatline_sim::scene::{Scene, Skipped, SortOrder, Splat, Weight};

/// Samples per pixel and axis of the truth.
const SUPERSAMPLING: usize = 8;

/// Standard deviation of a voxel's kernel, voxels, as for volumes.
const DEVIATION: f64 = 0.82;

/// Brightness of the plane's light fields, from everywhere.
const BRIGHTNESS: f64 = 0.9;

/// A checkerboard plane and the camera above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelPlane {
    /// Columns and rows of the picture; the horizon lies at the row `horizon`.
    pub size: [usize; 2],
    /// Row of the horizon.
    pub horizon: f64,
    /// Focal length in pixels; also the distance k for a spacing of 1.
    pub focal: f64,
    /// Height of the eye over the plane.
    pub height: f64,
    /// The plane ends at this many k.
    pub reach: f64,
    /// Spacing of the samples across (x) and into the picture (z).
    pub spacing: [f64; 2],
    /// Side of a field of the checkerboard across and into the picture.
    pub field: [f64; 2],
}

impl KernelPlane {
    /// Samples one apart in both directions.
    pub const ISOTROPIC: KernelPlane = KernelPlane {
        size: [96, 96],
        horizon: 8.41,
        focal: 64.0,
        height: 256.0,
        reach: 30.0,
        spacing: [1.0, 1.0],
        field: [8.0, 8.0],
    };

    /// Kernels four times as wide across the picture as into it.
    pub const ANISOTROPIC: KernelPlane = KernelPlane {
        spacing: [4.0, 1.0],
        field: [16.0, 64.0],
        ..KernelPlane::ISOTROPIC
    };

    /// The isotropic plane with an earlier end, for what is drawn many times.
    pub const SHORT: KernelPlane = KernelPlane {
        size: [192, 192],
        reach: 10.0,
        ..KernelPlane::ISOTROPIC
    };

    /// The camera.
    pub fn camera(&self) -> Camera {
        Camera {
            width: self.size[0],
            height: self.size[1],
            fx: self.focal,
            fy: self.focal,
            // Off the grid's symmetry, where centres would fall between two phases of a stamp.
            cx: 0.5 * self.size[0] as f64 + 0.137,
            cy: self.horizon,
            rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            translation: [0.0; 3],
            near: 0.01,
            far: 1e10,
            orthographic: false,
        }
    }

    /// First and last row that show the plane beyond k (of a spacing of 1), with a pixel to spare at the horizon.
    pub fn rows_beyond_k(&self) -> [usize; 2] {
        let row = |depth: f64| self.horizon + self.focal * self.height / depth;
        [
            row(self.reach * self.focal).ceil() as usize + 1,
            (row(self.focal) as usize).min(self.size[1]),
        ]
    }
}

/// The samples of a plane that its camera sees.
pub fn plane(plane: &KernelPlane) -> Scene {
    let [across, into] = plane.spacing;
    let last = plane.reach * plane.focal;
    let nearest = plane.focal * plane.height / (plane.size[1] as f64 - plane.horizon) - 8.0;
    let half_width = |z: f64| 0.5 * plane.size[0] as f64 * z / plane.focal + 4.0 * across;
    let mut splats = Vec::new();
    let mut z = nearest;
    while z < last {
        let columns = (half_width(z) / across) as i64;
        for column in -columns..=columns {
            let x = column as f64 * across;
            let field = [x, z].into_iter().zip(plane.field);
            let parity: i64 = field.map(|(at, side)| (at / side).floor() as i64).sum();
            let shade = if parity.rem_euclid(2) == 0 { 1.0 } else { 0.05 };
            splats.push(Splat {
                centre: [x, plane.height, z],
                axes: [
                    [DEVIATION * across, 0.0, 0.0],
                    [0.0, DEVIATION, 0.0],
                    [0.0, 0.0, DEVIATION * into],
                ],
                weight: BRIGHTNESS * across * into * slant(plane, x, z),
                colour: [shade; 3],
            });
        }
        z += into;
    }
    Scene {
        name: "checkerboard".to_owned(),
        natural_rules: Rules::EWA,
        weight: Weight::Mass,
        splats,
        harmonics: None,
        skipped: Skipped::default(),
        order: SortOrder::Depth,
        up: [0.0, -1.0, 0.0],
    }
}

/// Sine of the angle at which the plane is seen: a sample's share of the picture shrinks by it, and so must its mass.
fn slant(plane: &KernelPlane, x: f64, z: f64) -> f64 {
    plane.height / (x * x + plane.height * plane.height + z * z).sqrt()
}

/// The filters that are compared.
const FILTERS: [(&str, Antialias); 3] = [
    ("none", Antialias::None),
    ("swan", Antialias::Swan(1.0)),
    ("ewa", Antialias::Ewa(1.0)),
];

pub fn isotropic() -> Exhibit {
    exhibit(
        "antialias",
        "A checkerboard plane to the horizon, samples 1 apart, without filter, with distance scaling and with the EWA \
         low-pass, beside the truth of 64 samples per pixel. Errors are those of the rows beyond the distance k.",
        &KernelPlane::ISOTROPIC,
    )
}

pub fn anisotropic() -> Exhibit {
    exhibit(
        "antialias-4-to-1",
        "The same with kernels and samples four times as wide across the picture. Distance scaling goes by the smaller \
         spacing and widens kernels in all directions; EWA widens them only where they are thin.",
        &KernelPlane::ANISOTROPIC,
    )
}

fn exhibit(name: &str, caption: &str, shape: &KernelPlane) -> Exhibit {
    let (scene, camera, design) = (plane(shape), shape.camera(), standard24());
    let samples = supersampled(&scene, shape);
    let truth = averaged(&samples, PixelFilter::Gaussian);
    let square = averaged(&samples, PixelFilter::Square);
    let rows = shape.rows_beyond_k();
    let mut exhibit = Exhibit {
        name: name.to_owned(),
        equation: "[SWAN] 4.3; [EWA] 5.2, 6.2.2",
        caption: caption.to_owned(),
        pictures: vec![
            ("truth".to_owned(), truth.clone()),
            ("truth, square pixels".to_owned(), square.clone()),
        ],
        numbers: vec![number("samples", scene.splats.len() as f64, "")],
    };
    let mut unfiltered = 0.0;
    for (filter, antialias) in FILTERS {
        let rules = Rules::EWA.with_antialias(antialias);
        let options = fixed::Options {
            rules: &rules,
            compositing: Compositing::XRay,
            design: &design,
            traversal: design.traversal,
        };
        let drawing = fixed::draw(&scene, &camera, &options).picture;
        let reference = float::draw(&scene, &camera, &rules, Compositing::XRay).picture;
        let error = mean_square(&drawing, &truth, rows);
        if antialias == Antialias::None {
            unfiltered = error;
        }
        let numbers = &mut exhibit.numbers;
        numbers.push(number(
            format!("{filter}: root mean square error beyond k"),
            error.sqrt(),
            "",
        ));
        numbers.push(number(
            format!("{filter}: part of the unfiltered error removed"),
            1.0 - (error / unfiltered).sqrt(),
            "",
        ));
        numbers.push(number(
            format!("{filter}: the same against square pixels, root mean square"),
            mean_square(&drawing, &square, rows).sqrt(),
            "",
        ));
        numbers.push(number(
            format!("{filter}: contrast across, relative to the truth"),
            (contrast(&drawing, rows) / contrast(&truth, rows)).sqrt(),
            "",
        ));
        numbers.extend(errors(
            &format!("{filter} fixed against float"),
            &drawing,
            &reference,
        ));
        exhibit.pictures.push((filter.to_owned(), drawing));
    }
    exhibit
}

/// The unfiltered drawing at 8 by 8 samples per pixel.
fn supersampled(scene: &Scene, shape: &KernelPlane) -> Picture {
    let mut fine = shape.camera();
    fine.width *= SUPERSAMPLING;
    fine.height *= SUPERSAMPLING;
    for length in [&mut fine.fx, &mut fine.fy, &mut fine.cx, &mut fine.cy] {
        *length *= SUPERSAMPLING as f64;
    }
    let rules = Rules::EWA.with_antialias(Antialias::None);
    float::draw(scene, &fine, &rules, Compositing::XRay).picture
}

/// The weights by which a pixel averages samples at a distance, in pixels.
#[derive(Clone, Copy)]
enum PixelFilter {
    /// The pixel's own square.
    Square,
    /// A Gaussian of unit variance, the low-pass filter of \[EWA\] 7.1.
    Gaussian,
}

impl PixelFilter {
    fn weight(self, distance: f64) -> f64 {
        match self {
            PixelFilter::Square => f64::from(distance.abs() < 0.5),
            PixelFilter::Gaussian => (-0.5 * distance * distance).exp(),
        }
    }

    /// Distance beyond which no sample counts.
    fn reach(self) -> f64 {
        match self {
            PixelFilter::Square => 0.5,
            PixelFilter::Gaussian => 4.0,
        }
    }
}

/// A supersampled picture brought to pixels: one pass along each axis, each transposing.
fn averaged(samples: &Picture, filter: PixelFilter) -> Picture {
    along_rows(&along_rows(samples, filter), filter)
}

/// Every row reduced to pixels and stored as a column.
fn along_rows(samples: &Picture, filter: PixelFilter) -> Picture {
    let (width, height) = (samples.width / SUPERSAMPLING, samples.height);
    let mut reduced = Picture::new(height, width);
    let position = |sample: usize| (sample as f64 + 0.5) / SUPERSAMPLING as f64;
    let reach = (filter.reach() * SUPERSAMPLING as f64) as usize;
    for x in 0..width {
        let middle = x * SUPERSAMPLING + SUPERSAMPLING / 2;
        let range = middle.saturating_sub(reach)..(middle + reach).min(samples.width);
        let weights: Vec<f64> = range
            .clone()
            .map(|sample| filter.weight(position(sample) - (x as f64 + 0.5)))
            .collect();
        let total: f64 = weights.iter().sum();
        for y in 0..height {
            let row = &samples.pixels[y * samples.width..][range.clone()];
            let out = &mut reduced.pixels[x * height + y];
            for (sample, weight) in row.iter().zip(&weights) {
                for (sum, channel) in out.iter_mut().zip(sample) {
                    *sum += weight / total * channel;
                }
            }
        }
    }
    reduced
}

/// Mean squared difference of luminance over some rows.
fn mean_square(picture: &Picture, truth: &Picture, [first, last]: [usize; 2]) -> f64 {
    let range = first * picture.width..last * picture.width;
    let count = range.len() as f64;
    let pairs = picture.pixels[range.clone()]
        .iter()
        .zip(&truth.pixels[range]);
    pairs.map(|(a, b)| (a[0] - b[0]).powi(2)).sum::<f64>() / count
}

/// Mean squared difference of neighbours along the rows: what blur takes away and aliasing adds.
fn contrast(picture: &Picture, [first, last]: [usize; 2]) -> f64 {
    let rows = picture.pixels[first * picture.width..last * picture.width].chunks(picture.width);
    rows.flat_map(|row| row.windows(2))
        .map(|pair| (pair[1][0] - pair[0][0]).powi(2))
        .sum()
}
