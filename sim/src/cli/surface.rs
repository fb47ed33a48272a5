//! `render` and `compare` with `--as surface`: a point cloud drawn as surface splats, in fixed point and in double precision.

use super::args::{
    Backfaces, CompareOptions, DrawingOptions, Engine, KernelChoice, RenderOptions, SurfaceOptions,
    Vector, ViewOptions,
};
use super::compare::{all_entries, summary as comparison_summary};
use super::drawing::Drawing;
use super::engines::{cull_counts, reference_culled};
use super::output::write;
use super::progress::Progress;
use super::render::{if_nothing_is_seen, summary, write_picture};
use super::setup::{COMPARED, DRAWN, camera, room_for_picture};
use super::sweep::{Comparison, Entry, Manner, Measured, measure};
use super::{Failure, say, warn};
use crate::camera::Camera;
use crate::design::traversal_name;
use crate::framing::Frame;
use crate::metrics::compare;
use crate::report::error_map::ErrorMap;
use crate::report::facts::{CameraFacts, Counts, RulesFacts, SceneFacts};
use crate::report::{ErrorFacts, FORMAT, HostTimes, Pixels, Report, Row, ScaleFacts};
use crate::scene::points::height_field::{self, HeightField};
use crate::scene::points::orientation::Orientation;
use crate::scene::points::{self, SurfaceScene};
use crate::surface::{Buffer, Style, USUAL_EDGE};
use crate::systems::{Use, exercised};
use crate::texture::Texture;
use crate::texture::drape::drape;
use crate::{fixed, reference};
use anyhow::Context;
use std::time::Instant;

/// Light of a cloud that has no colours of its own, from above the default camera's left shoulder.
const USUAL_LIGHT: [f64; 3] = [0.4, 0.5, 1.0];

/// What is looked at, from where and how.
pub(super) struct SurfaceView {
    pub(super) scene: SurfaceScene,
    camera: Camera,
    pub(super) style: Style,
    textured: bool,
    warnings: Vec<String>,
    prepare_s: f64,
}

impl SurfaceView {
    pub(super) fn from_options(
        view: &ViewOptions,
        surface: &SurfaceOptions,
    ) -> Result<SurfaceView, Failure> {
        refuse_volume_options(view)?;
        let started = Instant::now();
        let progress = Progress::spinner(format!("loading {}", view.scene.display()));
        let is_height_field = height_field::is_height_field(&view.scene);
        let scene = match is_height_field {
            true => load_height_field(view, surface, &progress)?,
            false => load_cloud(view, surface)?,
        };
        let (camera, warnings) = camera(view, scene.up, || {
            Frame::of_surface(&scene, is_height_field, view.up.map(|Vector(up)| up))
        })?;
        drop(progress);
        let style = Style {
            cull_backfaces: culls_backfaces(surface, &scene),
            ..style(surface, view.light, &scene)
        };
        for note in &scene.notes {
            super::complain(&format!("{}: {note}\n", scene.name));
        }
        Ok(SurfaceView {
            scene,
            camera,
            style,
            textured: surface.texture.is_some(),
            warnings,
            prepare_s: started.elapsed().as_secs_f64(),
        })
    }
}

/// As the options say, or else where the cloud's normals allow it. Of a body that one can see through the backs are wanted.
fn culls_backfaces(options: &SurfaceOptions, scene: &SurfaceScene) -> bool {
    match options.backfaces() {
        Backfaces::On => true,
        Backfaces::Off => false,
        Backfaces::Auto => {
            let opaque = scene.points.iter().all(|point| point.opacity >= 1.0);
            opaque && Orientation::of(scene).is_closed_outwards()
        }
    }
}

fn load_cloud(view: &ViewOptions, surface: &SurfaceOptions) -> Result<SurfaceScene, Failure> {
    let refused = [
        (surface.texture.is_some(), "--texture"),
        (surface.spacing.is_some(), "--spacing"),
    ];
    if let Some((_, option)) = refused.iter().find(|(given, _)| *given) {
        return Err(Failure::Usage(format!(
            "{option} needs a height field: give a .csv file as scene"
        )));
    }
    Ok(points::load(&view.scene)?)
}

/// A height field, grey or with a photograph over it.
fn load_height_field(
    view: &ViewOptions,
    surface: &SurfaceOptions,
    progress: &Progress,
) -> Result<SurfaceScene, Failure> {
    let spacing = surface.spacing.unwrap_or(height_field::USUAL_SPACING);
    let field = HeightField::load(&view.scene, spacing)?;
    let name = view.scene.file_name().unwrap_or_default().to_string_lossy();
    let Some(photograph) = &surface.texture else {
        return Ok(field.scene(&name));
    };
    let texture = Texture::load(photograph)?;
    let method = surface.coefficients.name();
    progress.doing(format!("{method} colours from {}", photograph.display()));
    let cutoff = Style::opaque(0.0).cutoff;
    let draped = drape(&field, &name, &texture, surface.coefficients, cutoff)
        .with_context(|| photograph.display().to_string())?;
    Ok(draped.scene)
}

/// The style that the options and the scene ask for.
fn style(options: &SurfaceOptions, light: Option<Vector>, scene: &SurfaceScene) -> Style {
    let threshold = options.z_threshold.unwrap_or(scene.usual_threshold());
    Style {
        buffer: options.layers.map_or(Buffer::Accumulation, Buffer::Layers),
        edge: options.edges.then_some(USUAL_EDGE),
        light: light
            .map(|Vector(light)| light)
            .or((!scene.coloured).then_some(USUAL_LIGHT)),
        ..Style::opaque(threshold)
    }
}

fn refuse_volume_options(view: &ViewOptions) -> Result<(), Failure> {
    let refused = [
        (view.rules.is_some(), "--rules"),
        (view.transfer.is_some(), "--transfer"),
        (view.antialias.is_some(), "--antialias"),
        (view.kernel != KernelChoice::Gaussian, "--kernel"),
    ];
    match refused.iter().find(|(given, _)| *given) {
        Some((_, option)) => Err(Failure::Usage(format!(
            "{option} has no meaning with --as surface"
        ))),
        None => Ok(()),
    }
}

/// `render --as surface`.
pub fn render(options: &RenderOptions) -> Result<(), Failure> {
    let drawing = &options.drawing;
    if drawing.engine == Engine::Exact {
        return Err(no_exact());
    }
    let view = SurfaceView::from_options(&options.view, &options.surface)?;
    let bytes = match drawing.engine {
        Engine::Fixed => DRAWN,
        Engine::Float | Engine::Exact => COMPARED,
    };
    room_for_picture(&view.camera, bytes)?;
    let manner = Manner::without_points(drawing);
    let progress = Progress::new(1);
    progress.doing(format!("drawing {}", view.scene.name));
    let (measured, report) = match drawing.engine {
        Engine::Fixed => {
            let entry = Entry::from_options(drawing)?;
            let measured = draw_fixed(&view, &manner, &entry, &progress)?;
            let report = report_of_entry(&view, &entry, &measured)?;
            (measured, report)
        }
        Engine::Float | Engine::Exact => {
            let measured = draw_float(&view, &manner, &progress)?;
            let report = report(&view, Engine::Float, &measured);
            (measured, report)
        }
    };
    write_picture(&measured.drawing.picture, options)?;
    write_json(drawing, &report)?;
    drop(progress);
    warn(&report.warnings);
    super::complain(&if_nothing_is_seen(&measured.drawing.picture, &report));
    say(&summary(&report))?;
    Ok(())
}

/// `compare --as surface`.
pub fn compare_with_float(options: &CompareOptions) -> Result<(), Failure> {
    let drawing = &options.drawing;
    if drawing.engine == Engine::Exact {
        return Err(no_exact());
    }
    let view = SurfaceView::from_options(&options.view, &options.surface)?;
    room_for_picture(&view.camera, COMPARED)?;
    let manner = Manner::without_points(drawing);
    let chosen = Entry::from_options(drawing)?;
    let mut entries = if options.only {
        Vec::new()
    } else {
        all_entries(&chosen.design)
    };
    if !entries.contains(&chosen) {
        entries.push(chosen.clone());
    }
    let comparison = sweep(&view, &manner, &chosen, &entries)?;
    comparison.write(&options.output, drawing)?;
    write_json(drawing, &comparison.report)?;
    warn(&comparison.report.warnings);
    super::complain(&if_nothing_is_seen(&comparison.fixed, &comparison.report));
    say(&comparison_summary(&comparison.report, &options.output))?;
    Ok(())
}

/// Draws all entries against the reference and keeps the chosen one's picture.
fn sweep(
    view: &SurfaceView,
    manner: &Manner,
    chosen: &Entry,
    entries: &[Entry],
) -> Result<Comparison, Failure> {
    let progress = Progress::new(entries.len() + 1);
    progress.doing("float reference".to_owned());
    let float = draw_float(view, manner, &progress)?.drawing.picture;
    progress.advance();
    let mut table = Vec::new();
    let mut kept = None;
    for entry in entries {
        let (design, traversal) = (&entry.design.name, traversal_name(entry.traversal));
        progress.doing(format!("{design} by {traversal}"));
        let measured = draw_fixed(view, manner, entry, &progress)?;
        let errors = compare(&measured.drawing.picture, &float)
            .with_context(|| format!("design {design} by {traversal} cannot be compared"))?;
        let pixels = measured.drawing.pixels.unwrap_or_default();
        table.push(Row::new(design, traversal, &errors, pixels, measured.host));
        if entry == chosen {
            kept = Some((measured, errors));
        }
        progress.advance();
    }
    let (measured, errors) = kept.context("the chosen design was not drawn")?;
    let map = ErrorMap::new(&measured.drawing.picture, &float);
    let report = Report {
        error_map: Some(ScaleFacts::from(&map)),
        reference: Some(Engine::Float.name().to_owned()),
        error: Some(ErrorFacts::from(&errors)),
        table,
        ..report_of_entry(view, chosen, &measured)?
    };
    Ok(Comparison {
        fixed: measured.drawing.picture,
        float,
        map,
        report,
    })
}

fn draw_fixed(
    view: &SurfaceView,
    manner: &Manner,
    entry: &Entry,
    progress: &Progress,
) -> anyhow::Result<Measured> {
    let SurfaceView {
        scene,
        camera,
        style,
        ..
    } = view;
    measure(manner, progress, || {
        let drawing = fixed::surface::draw(scene, camera, style, &entry.design, entry.traversal);
        if drawing.merged > 0 {
            let count = drawing.merged;
            super::complain(&format!(
                "{count} pixels had more layers than --layers keeps\n"
            ));
        }
        let [setup_s, raster_s] = drawing.times;
        Ok(Drawing {
            picture: drawing.picture,
            culled: with_backfaces(cull_counts(drawing.culled), style, drawing.backfaces),
            clamped: drawing.clamped as u64,
            colour_log2: 0,
            pixels: Some(Pixels {
                covered: drawing.coverage.covered,
                visited: drawing.coverage.visited,
            }),
            stages: HostTimes {
                setup_s,
                raster_s,
                ..HostTimes::default()
            },
            footprints: Vec::new(),
        })
    })
}

fn draw_float(
    view: &SurfaceView,
    manner: &Manner,
    progress: &Progress,
) -> anyhow::Result<Measured> {
    measure(manner, progress, || {
        let drawing = reference::surface::draw(&view.scene, &view.camera, &view.style);
        Ok(Drawing {
            picture: drawing.picture,
            culled: with_backfaces(
                reference_culled(&drawing.counts),
                &view.style,
                drawing.counts.backfaces,
            ),
            clamped: 0,
            colour_log2: 0,
            pixels: None,
            stages: HostTimes::default(),
            footprints: Vec::new(),
        })
    })
}

/// Backs among the reasons for culling, where they are left out.
fn with_backfaces(mut culled: Counts, style: &Style, backfaces: usize) -> Counts {
    if style.cull_backfaces {
        culled.insert("backface".to_owned(), backfaces as u64);
    }
    culled
}

fn report_of_entry(
    view: &SurfaceView,
    entry: &Entry,
    measured: &Measured,
) -> anyhow::Result<Report> {
    Ok(Report {
        design: serde_json::to_value(entry.design.resolved())?,
        traversal: Some(traversal_name(entry.traversal).to_owned()),
        ..report(view, Engine::Fixed, measured)
    })
}

fn report(view: &SurfaceView, engine: Engine, measured: &Measured) -> Report {
    let SurfaceView {
        scene,
        camera,
        style,
        ..
    } = view;
    let skipped = (scene.skipped > 0).then(|| ("unusable".to_owned(), scene.skipped as u64));
    let facts = SceneFacts {
        name: scene.name.clone(),
        splats: scene.points.len() as u64,
        skipped: skipped.into_iter().collect(),
        culled: measured.drawing.culled.clone(),
        clamped: measured.drawing.clamped,
        colour_log2: 0,
    };
    Report {
        format: FORMAT.to_owned(),
        engine: engine.name().to_owned(),
        reference: None,
        design: serde_json::Value::Null,
        traversal: None,
        warnings: facts.warnings(&view.warnings),
        scene: facts,
        camera: CameraFacts::from(camera),
        rules: RulesFacts {
            name: "surf".to_owned(),
            normalised: false,
            low_pass: style.low_pass,
            spacing: 0.0,
            kernel: "gaussian".to_owned(),
            cutoff: Some(style.cutoff),
            alpha_max: 1.0,
            alpha_min: 0.0,
            stop: 0.0,
            stop_before: false,
            clamp_jacobian: false,
        },
        compositing: match style.buffer {
            Buffer::Accumulation => "accumulation".to_owned(),
            Buffer::Layers(count) => format!("{count} layers"),
        },
        error: None,
        systems: exercised(&Use::Surface {
            style,
            textured: view.textured,
        }),
        error_map: None,
        cycles: None,
        pixels: measured.drawing.pixels,
        host: HostTimes {
            prepare_s: view.prepare_s,
            ..measured.host
        },
        table: Vec::new(),
    }
}

fn write_json(drawing: &DrawingOptions, report: &Report) -> Result<(), Failure> {
    match &drawing.json {
        Some(path) => write(path, report.to_json()?.as_bytes()),
        None => Ok(()),
    }
}

fn no_exact() -> Failure {
    Failure::Usage("--engine exact has no meaning with --as surface: use fixed or float".to_owned())
}
