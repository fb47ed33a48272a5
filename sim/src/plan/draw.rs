//! From a prepared plan to a picture through the kernel: the systems' different results become one [`Drawing`].

use super::{
    AnyScene, DesignVariant, Prepared, SplatMethod, SplatTechnique, Splats, Subject, Technique,
    with_surface_unit,
};
use crate::fast::frame::FrameFacts;
use crate::fast::lanes::VectorLevel;
use crate::fixed::surface::{QuantisedPoints, SurfaceOptions, SurfaceRenderer};
use crate::fixed::{self, HybridRenderer, QuantisedScene};
use crate::machine::config::Binning;
use crate::machine::workload::{
    InOrder, Workload, extract, extract_from, extract_in_order, extract_surface, room_for,
};
use crate::machine::{Config, Timing, simulate_alone};
use crate::picture::Picture;
use crate::reference::compositor::RowProgress as Rows;
use crate::reference::sphere::{self, Shape};
use crate::renderer::{Renderer, Settings};
use crate::report::facts::{ReasonCounts, SceneFacts, counted};
use crate::report::{HostTimes, PixelCounts};
use crate::scene::Scene;
use crate::surface::Style;
use crate::threads;
use anyhow::{Context, Error, Result, bail};
use splatline::draw::Coverage;
use splatline::footprint::Footprint;
use splatline::setup::{self as kernel, Cull};
use std::sync::Arc;
use std::time::Instant;

/// One drawn picture and what drawing it took.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    /// The picture.
    pub picture: Picture,
    /// Splats that were not drawn, by reason.
    pub culled: ReasonCounts,
    /// Splats of which a value was clamped to the kernel's formats; they are drawn.
    pub clamped: u64,
    /// Unit of the kernel's colours as a power of two.
    pub colour_log2: i32,
    /// Work of the rasterizer; nothing for engines that do not count it.
    pub pixels: Option<PixelCounts>,
    /// Pixels at which more layers met than the style keeps.
    pub merged: usize,
    /// Seconds of this run, as the engine divides them; an engine that does not tell stages apart leaves them 0. The
    /// total is measured around the engine by [`super::measure`], which puts the medians of all runs here.
    pub host: HostTimes,
    /// Setup's results in the scene's order, for a machine to be timed on; empty for engines that no machine is
    /// modelled for, and partial where nobody counts.
    pub footprints: Vec<Result<Footprint, Cull>>,
}

/// Runs `work` on so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T> {
    Ok(threads::pool(threads)
        .with_context(|| format!("cannot start {threads} threads"))?
        .install(work))
}

impl Prepared {
    /// Draws through the kernel.
    pub fn draw_fixed(&self, entry: &DesignVariant) -> Result<Drawing> {
        self.drawn(entry, true)
    }

    /// The same picture alone, of which nothing is counted.
    pub fn picture_of(&self, entry: &DesignVariant) -> Result<Picture> {
        Ok(self.drawn(entry, false)?.picture)
    }

    fn drawn(&self, entry: &DesignVariant, counts: bool) -> Result<Drawing> {
        let mut kernel = self.kernel(None, entry, None, counts)?;
        let mut drawing = kernel.draw(&|_, _| ())?;
        kernel.finish(&mut drawing);
        Ok(drawing)
    }

    /// The splats in the kernel's formats, and no longer in double precision: for a plan that is drawn once. `None`
    /// where these are needed.
    pub fn release(&mut self) -> Option<QuantisedScene> {
        let (camera, technique) = (&self.plan.camera, &self.plan.technique);
        match (Arc::get_mut(&mut self.scene)?, technique) {
            (AnyScene::Splats(scene), Technique::Splats(SplatTechnique { rules, method, .. }))
                if *method == SplatMethod::Composited =>
            {
                Some(QuantisedScene::releasing(scene, camera, rules))
            }
            _ => None,
        }
    }

    /// What draws through the kernel again and again: the scene in its formats, of splats those that were
    /// [released](Prepared::release) if they were. Pixels are counted if `counts` asks for it.
    pub fn kernel<'a>(
        &'a self,
        released: Option<QuantisedScene>,
        entry: &'a DesignVariant,
        vectors: Option<VectorLevel>,
        counts: bool,
    ) -> Result<KernelDrawing<'a>> {
        let engine = vectors.map_or(fixed::best_engine(), fixed::PaintEngine::Vectors);
        let drawer = match self.subject()? {
            Subject::Splats(splats) => {
                Drawer::of_splats(splats, released, entry, (engine, counts))?
            }
            Subject::Surface(scene, style) => {
                let options = SurfaceOptions {
                    style,
                    design: &entry.design,
                    traversal: entry.traversal,
                    engine,
                    counts,
                };
                let camera = &self.plan.camera;
                let mut renderer = SurfaceRenderer::new(scene, camera, &options);
                Drawer::Others(Box::new(move |picture| {
                    Ok(draw_surface(&mut renderer, style, picture))
                }))
            }
        };
        let picture = Picture::default();
        Ok(KernelDrawing { drawer, picture })
    }

    /// What the kernel cannot take as it is given, for commands that make no report: the plan's own warnings and those
    /// of a setup.
    pub fn setup_warnings(&self) -> Result<Vec<String>> {
        let Subject::Splats(splats) = self.subject()? else {
            // A surface's setup clamps and culls nothing that drawing it does not tell.
            return Ok(self.warnings.clone());
        };
        let found = set_up(&splats, &self.plan.entry);
        let (clamped, colour_log2) = (found.clamped, found.colour_log2);
        let facts = SceneFacts::new(splats.scene, found.culled, clamped, colour_log2);
        let mut warnings = facts.warnings(&self.warnings);
        warnings.extend(facts.if_nothing_is_left());
        Ok(warnings)
    }

    /// The work on the machine's tiles.
    pub fn workload(&self) -> Result<Workload> {
        let machine = &self.plan.machine;
        self.check_machine(machine)?;
        self.workload_of(&self.plan.entry, [machine.tile_width, machine.tile_height])
    }

    /// The work by a design on tiles of a size.
    pub fn workload_of(&self, entry: &DesignVariant, tile: [u16; 2]) -> Result<Workload> {
        if let Subject::Surface(scene, style) = self.subject()? {
            let points = QuantisedPoints::new(scene, &self.plan.camera);
            let DesignVariant { design, traversal } = entry;
            return Ok(extract_surface(&points, style, design, *traversal, tile)?);
        }
        let splats = self.splats()?;
        let options = splats.options(entry);
        Ok(extract(splats.scene, splats.camera, &options, tile)?)
    }

    /// Refuses a machine that has no units for what is drawn.
    pub fn check_machine(&self, machine: &Config) -> Result<()> {
        let style = match self.subject()? {
            Subject::Surface(_, style) => Some(style),
            Subject::Splats(_) => self.splats().map(|_| None)?,
        };
        let wanted = with_surface_unit(machine, style);
        if wanted == *machine {
            return Ok(());
        }
        let name = self.scene.name();
        if let Err((key, value, allowed)) = wanted.check_together() {
            bail!("{name}: {key} = {value}: {allowed}");
        }
        bail!(
            "{name}: it needs a machine with surface_layers = {} and surface_light = {}",
            wanted.surface_layers,
            wanted.surface_light
        )
    }

    /// Work and picture of lists that keep the order of the picture before, or are sorted anew where there is none.
    pub fn in_order(&self, before: Option<&Workload>) -> Result<InOrder> {
        let splats = self.splats()?;
        let machine = &self.plan.machine;
        Ok(extract_in_order(
            splats.scene,
            splats.camera,
            &splats.options(&self.plan.entry),
            [machine.tile_width, machine.tile_height],
            before,
            machine.binning == Binning::Exact,
        )?)
    }

    /// Cycles on the plan's machine of the picture that was drawn; nothing for what the machine has no units for: it
    /// composites affine footprints one by one.
    pub fn cycles(&self, entry: &DesignVariant, drawing: &Drawing) -> Result<Option<Timing>> {
        let Subject::Splats(splats) = self.subject()? else {
            return Ok(None);
        };
        if !splats.are_composited() {
            return Ok(None);
        }
        let (machine, camera) = (&self.plan.machine, splats.camera);
        let tile = [machine.tile_width, machine.tile_height];
        room_for(&drawing.footprints, [camera.width, camera.height], tile)?;
        let workload = extract_from(&drawing.footprints, camera, &splats.options(entry), tile);
        Ok(Some(simulate_alone(&workload, machine)))
    }
}

/// What a setup tells of splats that are drawn by a method which keeps no counts of its own; no picture.
fn set_up(splats: &Splats, entry: &DesignVariant) -> Drawing {
    let found = fixed::footprints(splats.scene, splats.camera, &splats.options(entry));
    let quantised = QuantisedScene::new(splats.scene, splats.camera, splats.rules);
    Drawing {
        culled: cull_counts(fixed::culls(&found)),
        clamped: quantised.clamped as u64,
        colour_log2: quantised.colour_log2,
        ..Drawing::default()
    }
}

/// A scene in the kernel's formats, to be drawn again and again into a picture that is used again.
pub struct KernelDrawing<'a> {
    drawer: Drawer<'a>,
    picture: Picture,
}

/// Who draws.
enum Drawer<'a> {
    /// Splats that are composited one by one; afterwards it knows their footprints.
    Splats(Box<Renderer<&'a Scene>>),
    /// All else.
    Others(Box<Draw<'a>>),
}

/// Draws into a picture that is used again.
type Draw<'a> = dyn FnMut(&mut Picture) -> Result<Drawing> + Send + 'a;

impl<'a> Drawer<'a> {
    fn of_splats(
        splats: Splats<'a>,
        released: Option<QuantisedScene>,
        entry: &'a DesignVariant,
        (engine, counts): (fixed::PaintEngine, bool),
    ) -> Result<Drawer<'a>> {
        let Splats { scene, camera, .. } = splats;
        Ok(match splats.method {
            SplatMethod::Composited => {
                let rules = splats.rules;
                let settings = Settings {
                    rules: *rules,
                    compositing: splats.compositing,
                    design: entry.design.clone(),
                    traversal: entry.traversal,
                    engine,
                    counts,
                };
                let scene_of = || QuantisedScene::new(scene, camera, rules);
                let quantised = released.unwrap_or_else(scene_of);
                let renderer = Renderer::of_quantised(scene, quantised, settings);
                Drawer::Splats(Box::new(renderer))
            }
            SplatMethod::Points(hybrid) => {
                let options = splats.options(entry);
                let renderer =
                    HybridRenderer::new(scene, camera, options, hybrid, (engine, counts));
                let mut renderer = renderer.map_err(Error::msg)?;
                Drawer::Others(Box::new(move |picture| draw_hybrid(&mut renderer, picture)))
            }
            SplatMethod::Sheets(sheets) => {
                let plan = sheets.plan(scene, camera);
                Drawer::set_up_once(splats, entry, move |options| {
                    fixed::sheets::draw(scene, camera, options, engine, &plan)
                })
            }
            SplatMethod::DeepAlpha(channel) => {
                let channel = channel.in_kernel()?;
                Drawer::set_up_once(splats, entry, move |options| {
                    fixed::deep::draw(scene, camera, options, engine, channel)
                })
            }
            SplatMethod::Spheres(shape) => Drawer::anew(move || {
                let options = splats.options(entry);
                let drawn = fixed::draw_spheres(scene, camera, &options, in_kernel(*shape));
                Drawing {
                    culled: cull_counts(drawn.facts.culled),
                    clamped: drawn.clamped as u64,
                    colour_log2: drawn.colour_log2,
                    pixels: Some(pixels(drawn.facts.coverage)),
                    picture: drawn.picture,
                    ..Drawing::default()
                }
            }),
        })
    }

    /// By a method which keeps no counts of its own: they are those of one setup.
    fn set_up_once(
        splats: Splats<'a>,
        entry: &'a DesignVariant,
        draw: impl Fn(&fixed::Options) -> Picture + Send + 'a,
    ) -> Drawer<'a> {
        let facts = set_up(&splats, entry);
        Drawer::anew(move || Drawing {
            picture: draw(&splats.options(entry)),
            ..facts.clone()
        })
    }

    /// By a method which makes a picture of its own each time.
    fn anew(draw: impl Fn() -> Drawing + Send + 'a) -> Drawer<'a> {
        Drawer::Others(Box::new(move |picture| {
            let mut drawing = draw();
            std::mem::swap(&mut drawing.picture, picture);
            Ok(drawing)
        }))
    }
}

impl KernelDrawing<'_> {
    /// Draws once. The drawing lacks its picture and footprints until it is [finished](KernelDrawing::finish).
    pub fn draw(&mut self, progress: Rows) -> Result<Drawing> {
        match &mut self.drawer {
            Drawer::Splats(renderer) => {
                let going_on = |done, of| {
                    progress(done, of);
                    true
                };
                let drawn = renderer.draw_picture(&mut self.picture, &going_on)?;
                Ok(of_frame(drawn.facts, renderer.quantised(), drawn.convert))
            }
            Drawer::Others(draw) => draw(&mut self.picture),
        }
    }

    /// Gives the last drawing what was kept for the next one.
    pub fn finish(self, drawing: &mut Drawing) {
        drawing.picture = self.picture;
        if let Drawer::Splats(renderer) = self.drawer {
            drawing.footprints = renderer.into_outcomes();
        }
    }
}

/// The kernel's names for a sphere's shape.
fn in_kernel(shape: Shape) -> (kernel::Ellipse, kernel::Index) {
    let ellipse = if shape.exact_ellipse {
        kernel::Ellipse::Exact
    } else {
        kernel::Ellipse::Approximate
    };
    let index = match shape.index {
        sphere::Index::Affine => kernel::Index::Affine,
        sphere::Index::Perspective => kernel::Index::Perspective,
        sphere::Index::Ray => kernel::Index::Ray,
    };
    (ellipse, index)
}

/// What a frame's facts say; the picture comes when all frames have been drawn.
fn of_frame(facts: FrameFacts, quantised: &QuantisedScene, convert_s: f64) -> Drawing {
    let mut culled = cull_counts(facts.culled);
    if facts.left_out > 0 {
        culled.insert("hidden_or_outside".to_owned(), facts.left_out as u64);
    }
    Drawing {
        culled,
        clamped: quantised.clamped as u64,
        colour_log2: quantised.colour_log2,
        pixels: Some(pixels(facts.coverage)),
        host: HostTimes {
            setup_s: facts.times.setup,
            sort_s: facts.times.sort,
            raster_s: facts.times.raster,
            convert_s,
            ..HostTimes::default()
        },
        ..Drawing::default()
    }
}

fn draw_hybrid(renderer: &mut HybridRenderer, picture: &mut Picture) -> Result<Drawing> {
    let started = Instant::now();
    let facts = renderer.draw_picture(picture).map_err(Error::msg)?.frame;
    let times = facts.times;
    let drawn_s = times.setup + times.sort + times.raster;
    let convert_s = started.elapsed().as_secs_f64() - drawn_s;
    Ok(of_frame(facts, renderer.quantised(), convert_s))
}

fn draw_surface(renderer: &mut SurfaceRenderer, style: &Style, picture: &mut Picture) -> Drawing {
    let facts = renderer.draw_picture(picture);
    let culled = cull_counts(facts.culled);
    let [setup_s, sort_s, raster_s] = facts.times;
    Drawing {
        culled: with_backfaces(culled, style, facts.backfaces),
        clamped: renderer.clamped() as u64,
        pixels: Some(pixels(facts.coverage)),
        merged: facts.merged,
        host: HostTimes {
            setup_s,
            sort_s,
            raster_s,
            ..HostTimes::default()
        },
        ..Drawing::default()
    }
}

fn pixels(of: Coverage) -> PixelCounts {
    let (covered, visited) = (of.covered, of.visited);
    PixelCounts { covered, visited }
}

/// The reports' name of a reason for culling.
pub fn cull_name(reason: Cull) -> &'static str {
    match reason {
        Cull::Near => "near",
        Cull::Far => "far",
        Cull::Range => "out_of_range",
        Cull::Degenerate => "degenerate",
        Cull::Transparent => "transparent",
        Cull::Outside => "outside",
    }
}

/// The kernel's counts in the order of [`Cull::ALL`].
fn cull_counts(culled: [usize; Cull::ALL.len()]) -> ReasonCounts {
    counted(Cull::ALL.map(cull_name).into_iter().zip(culled))
}

/// Backs among the reasons for culling, where they are left out.
pub(super) fn with_backfaces(
    mut culled: ReasonCounts,
    style: &Style,
    backfaces: usize,
) -> ReasonCounts {
    if style.cull_backfaces {
        culled.insert("backface".to_owned(), backfaces as u64);
    }
    culled
}
