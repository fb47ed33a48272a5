//! What drawing takes, system by system: a frame of each of the papers' systems on this machine, with one and with two threads.
//!
//! A frame is everything that a camera move costs: what depends on the scene alone (classification, neighbours, textures) has been done before.
//! Systems whose fixed-point drawing has no renderer of its own are drawn whole, quantisation of their scene included; the table says so.

use super::COMMAND;
use super::hardware::surface_points;
use anyhow::Result;
use splatline::blend::deep::{Channel, ChannelRounding, Representation};
use splatline::setup::{Ellipse, Index};
use splatline_lab::gallery::kernels;
use splatline_lab::results::table;
use splatline_sim::camera::Camera;
use splatline_sim::cli::Failure;
use splatline_sim::design::DesignChoice;
use splatline_sim::fast::lanes::{self, VectorLevel};
use splatline_sim::fixed;
use splatline_sim::hybrid::{self, Hybrid, Points};
use splatline_sim::metrics;
use splatline_sim::plan::draw::on_threads;
use splatline_sim::plan::{AnyScene, DesignVariant, Prepared, SplatMethod, Technique};
use splatline_sim::report::HostTimes;
use splatline_sim::rules::{Antialias, Compositing, Rules};
use splatline_sim::scene::points::SurfaceScene;
use splatline_sim::scene::{self, Scene, synthetic};
use splatline_sim::sheets::{SheetKind, SheetPlan};
use splatline_sim::surface::{Buffer, Style, USUAL_EDGE};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Frames of which the median counts; one more is drawn before.
const FRAMES: usize = 3;

/// Columns and rows of every picture.
const SIZE: usize = 512;

const LIGHT: [f64; 3] = [0.4, 0.5, 1.0];

/// Stamps are drawn from a distance, in units of k, at which every footprint is the same circle.
const STAMPS: &str = "7 stamps, from 1.94 k";
const STAMPS_FROM: f64 = 1.937;

/// One way to draw.
struct Way<'a> {
    /// Numbers of the systems, and what is drawn.
    name: &'static str,
    splats: usize,
    /// Draws a frame.
    frame: Box<dyn FnMut() -> Result<TimedFrame> + Send + 'a>,
}

/// What a frame tells of itself.
#[derive(Clone, Copy, Default)]
struct TimedFrame {
    /// Pixels that it covered, where they are counted.
    covered: Option<u64>,
    /// Seconds of setup, of lists and their order, and of pixels, where they are told apart.
    stages: Option<[f64; 3]>,
}

/// Measures every way on the demo's volume and, if it is at hand, on the scanned lion.
pub fn run(data: &Path, choice: VectorLevel) -> Result<String, Failure> {
    let design = DesignChoice::load("standard24")?;
    let volume = volume_plans(&scene::demo()?, &design);
    let lion = surface_points(data)?;
    let surfaces = match &lion {
        Some((points, camera)) => surface_plans(points, camera, &design),
        None => Vec::new(),
    };
    let mut rows = Vec::new();
    for (name, plan) in volume.iter().chain(&surfaces) {
        rows.push(measured(planned(name, plan, choice)?)?);
    }
    if let Some((_, plan)) = volume.first() {
        for way in whole(plan, choice)? {
            rows.push(measured(way)?);
        }
    }
    Ok(format!(
        "# Drawing each system on the host\n\nPrinted by `{COMMAND} --only drawing`; do not edit. {SIZE} x {SIZE} pixels, standard24, vectors of {}; medians of \
         {FRAMES} frames after one; setup, sort and raster of the last one. Covered pixels were counted by a frame of their own. Volumes are the demo's, surfaces the scanned lion{}. \"whole\": the frame includes bringing the scene into the kernel's formats. \
         Systems 3, 13 and 17 make splats or points before anything is drawn, which are then drawn as 2, 9 or 14.\n\n{}",
        lanes::name(choice),
        if lion.is_some() {
            ""
        } else {
            ", which is not at hand"
        },
        table(
            &[
                "system",
                "splats",
                "frame ms",
                "setup",
                "sort",
                "raster",
                "two threads ms",
                "gain",
                "ns a splat",
                "million covered pixels",
                "ns a covered pixel"
            ],
            &rows
        )
    ))
}

/// Named plans of the volume.
fn volume_plans(scene: &Scene, design: &DesignChoice) -> Vec<(&'static str, Prepared)> {
    let spacing = hybrid::spacing(scene);
    let usual = scene.natural_rules;
    let swan = Rules::EWA.with_antialias(Antialias::Swan(spacing));
    let mixed = |points, phase_bits| Hybrid {
        points,
        depth_range: None,
        phase_bits,
    };
    let ways = [
        (
            "1, 4, 18 volume splats",
            usual,
            Compositing::FrontToBack,
            None,
        ),
        ("5 back to front", usual, Compositing::BackToFront, None),
        ("5 X-ray", usual, Compositing::XRay, None),
        ("6 distance scaling", swan, Compositing::FrontToBack, None),
        (
            STAMPS,
            swan,
            Compositing::FrontToBack,
            Some(mixed(Points::All, Some(3))),
        ),
        (
            "14 points and splats",
            swan,
            Compositing::FrontToBack,
            Some(mixed(Points::Auto, None)),
        ),
    ];
    let plan = |(name, rules, order, points)| {
        let camera = match name {
            STAMPS => kernels::distant_camera(scene, STAMPS_FROM, SIZE),
            _ => scene.default_camera(SIZE, SIZE),
        };
        let mut prepared = Prepared::of_splats(scene.clone(), camera, rules, design.clone());
        prepared.plan.technique = Technique::Splats {
            rules,
            compositing: order,
            method: points.map_or(SplatMethod::Composited, SplatMethod::Points),
        };
        (name, prepared)
    };
    ways.map(plan).into()
}

/// Named plans of the surface.
fn surface_plans(
    points: &SurfaceScene,
    camera: &Camera,
    design: &DesignChoice,
) -> Vec<(&'static str, Prepared)> {
    let plain = Style::opaque(points.usual_threshold());
    let ways = [
        ("2, 9 surface", plain),
        (
            "10 shaded",
            Style {
                light: Some(LIGHT),
                ..plain
            },
        ),
        (
            "12 antialiased edges",
            Style {
                edge: Some(USUAL_EDGE),
                ..plain
            },
        ),
        (
            "11 four layers",
            Style {
                buffer: Buffer::Layers(4),
                ..plain
            },
        ),
    ];
    let empty = synthetic::random_gaussians(0, 1, 1.0);
    let plan = |(name, style)| {
        let mut prepared =
            Prepared::of_splats(empty.clone(), camera.clone(), Rules::EWA, design.clone());
        prepared.plan.technique = Technique::Surface(style);
        prepared.scene = Arc::new(AnyScene::Surface {
            scene: points.clone(),
            is_height_field: false,
        });
        (name, prepared)
    };
    ways.map(plan).into()
}

/// Drawn as every command draws it.
fn planned<'a>(name: &'static str, prepared: &'a Prepared, choice: VectorLevel) -> Result<Way<'a>> {
    let entry: &'a DesignVariant = &prepared.plan.entry;
    let counted = prepared
        .kernel(entry, Some(choice), true)?
        .draw(&|_, _| ())?;
    let covered = counted.pixels.map(|pixels| pixels.covered);
    let mut kernel = prepared.kernel(entry, Some(choice), false)?;
    let splats = match &*prepared.scene {
        AnyScene::Splats(scene) => scene.splats.len(),
        AnyScene::Surface { scene, .. } => scene.points.len(),
    };
    let frame = Box::new(move || {
        let drawing = kernel.draw(&|_, _| ())?;
        let HostTimes {
            setup_s,
            sort_s,
            raster_s,
            ..
        } = drawing.stages;
        Ok(TimedFrame {
            covered,
            stages: Some([setup_s, sort_s, raster_s]),
        })
    });
    Ok(Way {
        name,
        splats,
        frame,
    })
}

/// Systems that are drawn from the scene to the picture in one call.
fn whole(prepared: &Prepared, choice: VectorLevel) -> Result<Vec<Way<'_>>> {
    let engine = fixed::PaintEngine::Vectors(choice);
    let splats = prepared.splats()?;
    let options = move || splats.options(&prepared.plan.entry);
    let (scene, camera) = (splats.scene, splats.camera);
    let sheets = |kind| SheetPlan::new(kind, 1.0, scene, camera);
    let (axis, image) = (
        sheets(SheetKind::AxisAligned),
        sheets(SheetKind::ImageAligned),
    );
    let channel = Channel::new(Representation::Transmittance, ChannelRounding::Nearest, 24);
    let channel = channel.map_err(|_| anyhow::anyhow!("no channel has 24 bits"))?;
    let way = |name, frame| Way {
        name,
        splats: scene.splats.len(),
        frame,
    };
    Ok(vec![
        way(
            "5 axis-aligned sheets, whole",
            Box::new(move || {
                fixed::sheets::draw(scene, camera, &options(), engine, &axis);
                Ok(TimedFrame::default())
            }),
        ),
        way(
            "5 image-aligned sheets, whole",
            Box::new(move || {
                fixed::sheets::draw(scene, camera, &options(), engine, &image);
                Ok(TimedFrame::default())
            }),
        ),
        way(
            "8 deep alpha channel, whole",
            Box::new(move || {
                fixed::deep::draw(scene, camera, &options(), engine, channel);
                Ok(TimedFrame::default())
            }),
        ),
        way(
            "15, 16 spheres with corrected index, whole",
            Box::new(move || {
                let shape = (Ellipse::Exact, Index::Perspective);
                let drawing = fixed::draw_spheres(scene, camera, &options(), shape);
                Ok(TimedFrame {
                    covered: Some(drawing.coverage.covered),
                    stages: None,
                })
            }),
        ),
    ])
}

/// A row of the table.
fn measured(mut way: Way) -> Result<Vec<String>> {
    let mut last = [TimedFrame::default(); 2];
    let mut seconds = [0.0; 2];
    for ((seconds, last), threads) in seconds.iter_mut().zip(&mut last).zip([1, 2]) {
        *seconds = on_threads(threads, || -> Result<f64> {
            (way.frame)()?;
            let mut times = Vec::new();
            for _ in 0..FRAMES {
                let started = Instant::now();
                *last = (way.frame)()?;
                times.push(started.elapsed().as_secs_f64());
            }
            Ok(metrics::median(&mut times).unwrap_or(f64::NAN))
        })??;
    }
    let [one, two] = seconds;
    let [TimedFrame { covered, stages }, _] = last;
    let stage = |number: usize| stages.map(|stages| format!("{:.1}", 1e3 * stages[number]));
    let per_pixel = covered.map(|pixels| format!("{:.2}", 1e9 * one / pixels as f64));
    let millions = covered.map(|pixels| format!("{:.2}", pixels as f64 / 1e6));
    Ok(vec![
        way.name.to_owned(),
        way.splats.to_string(),
        format!("{:.1}", 1e3 * one),
        stage(0).unwrap_or_default(),
        stage(1).unwrap_or_default(),
        stage(2).unwrap_or_default(),
        format!("{:.1}", 1e3 * two),
        format!("{:.2}", one / two),
        format!("{:.0}", 1e9 * one / way.splats as f64),
        millions.unwrap_or_default(),
        per_pixel.unwrap_or_default(),
    ])
}
