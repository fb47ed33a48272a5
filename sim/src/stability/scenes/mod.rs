//! Whole scenes of the kinds that people have, each drawn by every engine and measured against double precision.
//!
//! [`classes`] makes the scenes, [`flips`] counts decisions at the smallest opacity, [`table`] writes the text. All
//! pixels count, those on a threshold too; no sample is clamped, and everything is in units of the picture's largest
//! sample (at least 1).
//!
//! | engine | what it is |
//! |---|---|
//! | `f32` | the usual formulas in single precision, in the true depth order |
//! | `f32, offset subtracted` | the same once the scene's place in the world has been subtracted in double precision |
//! | `f64, W u + d` | the reference again, its centres by W u + d instead of W (u - eye): what double precision itself loses out there |
//! | a design's name | the kernel |

pub mod flips;
pub mod table;

use super::single;
use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fixed;
use crate::picture::Picture;
use crate::reference::compositor;
use crate::reference::float::{self, Footprint};
use crate::reference::golden::conic_difference;
use crate::reference::{Culled, FloatDrawing};
use crate::rules::{Compositing, Rules};
use crate::scene::{Scene, Splat};
use crate::vector;
use rayon::prelude::*;
pub use splatline_reference::hard::classes;

use classes::{Class, Size};
use flips::{DecisionEngine, Decisions, FixedSide, Flips, double};

/// The designs that the page shows.
pub const DESIGNS: [&str; 3] = ["lean18", "standard24", "deep32"];
/// Name of single precision.
pub const SINGLE: &str = "f32";
/// Name of single precision after the offset has been subtracted.
pub const SINGLE_NEAR: &str = "f32, offset subtracted";
/// Name of the reference's other form.
pub const FROM_ORIGIN: &str = "f64, W u + d";

const RULES: Rules = Rules::GAUSSIAN_3D;

/// One line of the table: an engine in a class.
#[derive(Clone, Debug, serde::Serialize)]
pub struct SceneLine {
    /// The class.
    pub class: String,
    /// A design's name, or another of this module's.
    pub engine: String,
    /// Colour, decibels; none if no sample differs.
    pub psnr_db: Option<f64>,
    /// The same over the settled pixels: those at which nothing was decided otherwise.
    pub settled_psnr_db: Option<f64>,
    /// Settled pixels over all.
    pub settled: f64,
    /// Largest difference of any sample.
    pub max_abs: f64,
    /// Mean of the differences of colours.
    pub bias: f64,
    /// Largest relative difference of a conic, over splats that both project.
    pub conic: f64,
    /// Decisions by threshold.
    pub flips: Flips,
    /// Pairs of splat and pixel that the reference blends.
    pub blended: u64,
    /// Splats of the scene.
    pub splats: usize,
    /// Splats of which a number was clamped to its format.
    pub clamped: usize,
    /// Splats culled.
    pub culled: usize,
    /// Splats culled although the reference draws them.
    pub lost: usize,
}

/// Measures every class under every engine.
pub fn measure(size: Size, seed: u64) -> Vec<SceneLine> {
    let classes = classes::all(size, seed);
    classes.iter().flat_map(measure_class).collect()
}

/// Every engine's line in one class.
pub fn measure_class(class: &Class) -> Vec<SceneLine> {
    let Class { scene, camera, .. } = class;
    let truth = DecisionTruth::new(scene, camera);
    let designs = DESIGNS.into_iter().filter_map(DesignChoice::named);
    let designs: Vec<DesignChoice> = designs.collect();
    let options = |design| fixed::Options::front_to_back(&RULES, design);
    let draw = |design| fixed::draw_with_footprints(scene, camera, &options(design));
    let drawings: Vec<_> = designs.iter().map(draw).collect();
    let other = in_camera_space(scene, camera);
    let other = DecisionTruth::new(&other.0, &other.1);
    let mut singles = vec![(SINGLE, SingleDrawing::new(scene, camera, &truth.order))];
    if let Some(offset) = class.offset {
        let (scene, camera) = moved(scene, camera, offset);
        let near = SingleDrawing::new(&scene, &camera, &truth.order);
        singles.push((SINGLE_NEAR, near));
    }

    let rules = &RULES;
    let mut engines = vec![DrawnClass {
        name: FROM_ORIGIN,
        picture: &other.drawing.picture,
        conics: other.conics().collect(),
        drawn: other.projected.iter().map(Result::is_ok).collect(),
        clamped: 0,
        decisions: Box::new(double(&other.projected, rules)),
    }];
    engines.extend(singles.iter().map(|(name, single)| {
        DrawnClass {
            name,
            picture: &single.picture,
            conics: (single.projected.iter())
                .map(|f| Some(f.as_ref()?.conic.map(f64::from)))
                .collect(),
            drawn: single.projected.iter().map(Option::is_some).collect(),
            clamped: 0,
            decisions: Box::new(flips::single(&single.projected, camera, rules)),
        }
    }));
    let fixed = designs.iter().zip(&drawings);
    engines.extend(fixed.map(|(design, (drawing, footprints))| DrawnClass {
        name: &design.name,
        picture: &drawing.picture,
        conics: fixed::conics(scene, camera, &options(design)),
        drawn: footprints.iter().map(Result::is_ok).collect(),
        clamped: drawing.clamped,
        decisions: Box::new(FixedSide::new(footprints, design, rules)),
    }));
    let reference = double(&truth.projected, rules);
    let line = |engine: &DrawnClass| {
        let decisions = flips::count(&reference, &*engine.decisions, &truth.order, camera);
        truth.line(class, engine, &decisions)
    };
    engines.par_iter().map(line).collect()
}

/// What an engine makes of a class.
struct DrawnClass<'a> {
    name: &'a str,
    picture: &'a Picture,
    /// Splat by splat, none where it is not drawn.
    conics: Vec<Option<[f64; 3]>>,
    drawn: Vec<bool>,
    clamped: usize,
    decisions: Box<dyn DecisionEngine + 'a>,
}

/// A scene in which every splat is another one.
fn with_splats(scene: &Scene, change: impl Fn(&Splat) -> Splat) -> Scene {
    let mut scene = scene.clone();
    for splat in &mut scene.splats {
        *splat = change(splat);
    }
    scene
}

/// The scene in camera space by W u + d, and a camera at its origin.
fn in_camera_space(scene: &Scene, camera: &Camera) -> (Scene, Camera) {
    let turn = |v| vector::transform(&camera.rotation, v);
    let scene = with_splats(scene, |splat| Splat {
        centre: vector::add(turn(splat.centre), camera.translation),
        axes: splat.axes.map(turn),
        ..*splat
    });
    let camera = Camera {
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
        ..camera.clone()
    };
    (scene, camera)
}

/// The same view after everything has been moved by `-offset` and the splats have been rounded to single precision
/// again.
fn moved(scene: &Scene, camera: &Camera, offset: [f64; 3]) -> (Scene, Camera) {
    let scene = with_splats(scene, |splat| Splat {
        centre: vector::subtract(splat.centre, offset),
        ..*splat
    });
    let turned = vector::transform(&camera.rotation, offset);
    let camera = Camera {
        translation: vector::add(camera.translation, turned),
        ..camera.clone()
    };
    (scene, camera)
}

/// What double precision makes of a scene.
struct DecisionTruth {
    projected: Vec<Result<Footprint, Culled>>,
    drawing: FloatDrawing,
    /// Splats nearest first, culled ones too.
    order: Vec<usize>,
}

impl DecisionTruth {
    fn new(scene: &Scene, camera: &Camera) -> DecisionTruth {
        let projected = float::footprints(scene, camera, &RULES);
        let order = Compositing::FrontToBack;
        let drawing = compositor::draw(&projected, camera, &RULES, order, &|_, _| ());
        let depths = scene.splats.iter().map(|s| camera.to_camera(s.centre)[2]);
        let depths: Vec<f64> = depths.collect();
        let mut order: Vec<usize> = (0..depths.len()).collect();
        order.sort_by(|a, b| depths[*a].total_cmp(&depths[*b]));
        DecisionTruth {
            projected,
            drawing,
            order,
        }
    }

    fn conics(&self) -> impl Iterator<Item = Option<[f64; 3]>> {
        let all = self.projected.iter();
        all.map(|f| Some(f.as_ref().ok()?.variance.conic()))
    }

    /// An engine's line.
    fn line(&self, class: &Class, engine: &DrawnClass, decisions: &Decisions) -> SceneLine {
        let (picture, expected) = (engine.picture, &self.drawing.picture);
        let unit = self.unit();
        let pairs = || picture.pixels.iter().zip(&expected.pixels);
        let differences = |channels: std::ops::Range<usize>| {
            pairs().flat_map(move |(a, b)| channels.clone().map(move |c| (a[c] - b[c]) * unit))
        };
        let conics = self.conics().zip(&engine.conics);
        let conics = conics.filter_map(|(truth, own)| Some(conic_difference((*own)?, truth?)));
        let lost = self.projected.iter().zip(&engine.drawn);
        let lost = lost.filter(|(truth, drawn)| truth.is_ok() && !**drawn);
        let flipped = decisions.pixels.iter().filter(|flipped| **flipped).count();
        SceneLine {
            class: class.name.clone(),
            engine: engine.name.to_owned(),
            psnr_db: self.psnr_where(picture, |_| true),
            settled_psnr_db: self.psnr_where(picture, |pixel| !decisions.pixels[pixel]),
            settled: 1.0 - flipped as f64 / decisions.pixels.len() as f64,
            max_abs: differences(0..4).fold(0.0, |most: f64, d| most.max(d.abs())),
            bias: differences(0..3).sum::<f64>() / (3.0 * expected.pixels.len() as f64),
            conic: conics.fold(0.0, f64::max),
            flips: decisions.flips,
            blended: self.drawing.counts.covered_pixels,
            splats: class.scene.splats.len(),
            clamped: engine.clamped,
            culled: engine.drawn.iter().filter(|drawn| !**drawn).count(),
            lost: lost.count(),
        }
    }

    /// One over the largest sample, or over 1.
    fn unit(&self) -> f64 {
        let samples = self.drawing.picture.pixels.iter().flatten();
        1.0 / samples.fold(1.0, |most: f64, s| most.max(*s))
    }

    /// Colour over some of the pixels; none if no sample differs.
    fn psnr_where(&self, picture: &Picture, counts: impl Fn(usize) -> bool) -> Option<f64> {
        let expected = &self.drawing.picture.pixels;
        let (mut squares, mut samples) = (0.0, 0);
        for (pixel, (a, b)) in picture.pixels.iter().zip(expected).enumerate() {
            if counts(pixel) {
                samples += 3;
                squares += (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>();
            }
        }
        let mean = squares * self.unit().powi(2) / f64::from(samples.max(1));
        (squares > 0.0).then(|| -10.0 * mean.log10())
    }
}

/// What single precision makes of a scene, composited in the true order.
struct SingleDrawing {
    projected: Vec<Option<single::SingleFootprint>>,
    picture: Picture,
}

impl SingleDrawing {
    fn new(scene: &Scene, camera: &Camera, order: &[usize]) -> SingleDrawing {
        let splats = scene.splats.iter().zip(scene.weights_for(&RULES));
        let weighted = splats.map(|(splat, weight)| Splat { weight, ..*splat });
        let projected = weighted.map(|splat| single::project(&splat, camera, &RULES));
        let projected: Vec<_> = projected.collect();
        let colours = scene.colours(camera);
        let picture = single::picture(&projected, &colours, order, camera, &RULES);
        SingleDrawing { projected, picture }
    }
}
