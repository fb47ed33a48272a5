//! Drawing many frames of one scene fast, from a program.
//!
//! ```
//! use splatline_engine::renderer::{Renderer, Settings};
//! use splatline_engine::rules::Rules;
//! use splatline_engine::scene::synthetic;
//!
//! let scene = synthetic::random_gaussians(1000, 1, 1.0);
//! let camera = synthetic::camera(160, 120);
//! let settings = Settings::new(Rules::GAUSSIAN_3D);
//! let mut renderer = Renderer::new(&scene, &camera, settings).with_threads(2).unwrap();
//! let mut frame = vec![[0.0f32; 4]; 160 * 120];
//! for step in 1..4 {
//!     renderer.set_camera(&camera.zoomed(1.0 + 0.1 * f64::from(step)).unwrap());
//!     // The callback hears how far the frame is; `false` would cancel it.
//!     let drawn = renderer.draw_floats(&mut frame, &|_done, _of| true).unwrap();
//!     assert!(drawn.facts.times.raster > 0.0);
//! }
//! ```
//!
//! What depends on the scene alone is computed when the renderer is made, what depends on the camera when one is set,
//! and a frame allocates nothing once the first one has been drawn. Frames are the kernel's, bit for bit, whatever the
//! vectors and threads.

use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fast::TilePainter;
use crate::fast::depth_first::{BoundingSpheres, DepthFirst, SphereProjection};
use crate::fast::frame::{Cancelled, FrameFacts, FrameMemory, Progress};
use crate::fast::lanes::VectorLevel;
use crate::fast::setup::Outcome;
use crate::fixed::render::paint_with;
use crate::fixed::{Options, PaintEngine, QuantisedScene, best_engine, converter, painter};
use crate::picture::Picture;
use crate::rules::{Compositing, Rules};
use crate::scene::{self, LoadError, LoadOptions, Scene, SortOrder};
use crate::threads;
use rayon::{ThreadPool, ThreadPoolBuildError};
use splatline::blend::Pixel;
use splatline::format::Traversal;
use splatline::splat::VolumeSplat;
use std::borrow::Borrow;
use std::path::Path;
use std::time::Instant;

/// How frames are drawn.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Rules of blending.
    pub rules: Rules,
    /// Order and operator.
    pub compositing: Compositing,
    /// Widths.
    pub design: DesignChoice,
    /// Order of the pixels.
    pub traversal: Traversal,
    /// Which implementation draws; all give the same bits.
    pub engine: PaintEngine,
    /// Are visited and covered pixels counted? If not, finished ones may be left out, and splats behind them are not
    /// set up: the picture is the same, the counts are anything, and culls and outcomes lack these splats.
    pub counts: bool,
}

impl Settings {
    /// `standard24` along spans, front to back, by the best vectors of this processor.
    pub fn new(rules: Rules) -> Self {
        let Some(design) = DesignChoice::named("standard24") else {
            unreachable!("standard24 is a named design")
        };
        Settings {
            rules,
            compositing: Compositing::FrontToBack,
            traversal: design.traversal,
            design,
            engine: best_engine(),
            counts: false,
        }
    }

    fn options(&self) -> Options<'_> {
        Options {
            rules: &self.rules,
            compositing: self.compositing,
            design: &self.design,
            traversal: self.traversal,
        }
    }
}

/// Why there is no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DrawError {
    /// The caller's memory is not the camera's picture.
    #[error(
        "the frame has {pixels} pixels, but the camera's picture {columns} x {rows}: give a slice of as many"
    )]
    Size {
        /// Pixels of the slice.
        pixels: usize,
        /// Columns of the camera's picture.
        columns: usize,
        /// Its rows.
        rows: usize,
    },
    /// The callback wanted no more of it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What a frame did beside its pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Splats culled, pixels covered, and times of the stages.
    pub facts: FrameFacts,
    /// Seconds that bringing the pixels into the caller's memory took.
    pub convert: f64,
}

/// A scene, loaded and quantised, with all that its frames need. The scene may be borrowed or owned.
pub struct Renderer<S = Scene> {
    scene: S,
    settings: Settings,
    quantised: QuantisedScene,
    painter: Box<dyn TilePainter>,
    /// Where splats are left out.
    spheres: Option<BoundingSpheres>,
    memory: FrameMemory,
    /// The renderer's own threads; the caller's if it has none.
    pool: Option<ThreadPool>,
}

impl Renderer<Scene> {
    /// A scene from a file, under the rules that are natural for its kind, seen by `camera`.
    pub fn load(path: &Path, camera: &Camera) -> Result<Self, LoadError> {
        let mut scene = scene::load(path, &LoadOptions::default())?;
        let settings = Settings::new(scene.natural_rules);
        let quantised = QuantisedScene::releasing(&mut scene, camera, &settings.rules);
        Ok(Renderer::of_quantised(scene, quantised, settings))
    }
}

impl<S: Borrow<Scene>> Renderer<S> {
    /// A scene seen by `camera`. Frames are drawn by the rayon pool that they are asked for in, unless the renderer is
    /// given threads of its own.
    pub fn new(scene: S, camera: &Camera, settings: Settings) -> Self {
        let quantised = QuantisedScene::new(scene.borrow(), camera, &settings.rules);
        Renderer::of_quantised(scene, quantised, settings)
    }

    /// The same of a scene that has been quantised already under these settings' rules. Where colours do not depend on
    /// the view its splats may be [released](QuantisedScene::releasing).
    pub fn of_quantised(scene: S, quantised: QuantisedScene, settings: Settings) -> Self {
        let rules = &quantised.rules;
        let hides = !settings.counts
            && settings.compositing == Compositing::FrontToBack
            && quantised.order == SortOrder::Depth;
        Renderer {
            painter: painter(rules, &settings.options(), settings.engine, settings.counts),
            spheres: (hides.then(|| BoundingSpheres::new(&quantised.splats, rules))).flatten(),
            scene,
            quantised,
            memory: FrameMemory::default(),
            pool: None,
            settings,
        }
    }

    /// The same with so many threads of its own.
    pub fn with_threads(mut self, threads: usize) -> Result<Self, ThreadPoolBuildError> {
        self.pool = Some(threads::pool(threads)?);
        Ok(self)
    }

    /// Looks from elsewhere. Only what depends on the view is computed again: the view, and colours that depend on it.
    pub fn set_camera(&mut self, camera: &Camera) {
        self.quantised.set_camera(self.scene.borrow(), camera);
    }

    /// The scene in the kernel's formats.
    pub fn quantised(&self) -> &QuantisedScene {
        &self.quantised
    }

    /// What setup made of every splat of the last frame, in the scene's order.
    pub fn outcomes(&self) -> &[Outcome] {
        self.memory.outcomes()
    }

    /// The same, to keep when the last frame has been drawn.
    pub fn into_outcomes(self) -> Vec<Outcome> {
        self.memory.into_outcomes()
    }

    /// Bytes held for splats and frames, without the scene itself.
    pub fn bytes(&self) -> usize {
        let spheres = self.spheres.as_ref().map_or(0, BoundingSpheres::bytes);
        let splats = self.quantised.splats.capacity() * size_of::<VolumeSplat>();
        self.memory.bytes() + spheres + splats
    }

    /// Draws a frame of the kernel's pixels, row by row.
    pub fn draw(&mut self, frame: &mut [Pixel], progress: &Progress) -> Result<Drawn, DrawError> {
        self.draw_as(frame, progress, |pixel| *pixel)
    }

    /// Draws a frame in single precision: red, green, blue, premultiplied, and opacity.
    pub fn draw_floats(
        &mut self,
        frame: &mut [[f32; 4]],
        progress: &Progress,
    ) -> Result<Drawn, DrawError> {
        let convert = converter(&self.settings.design.widths, self.quantised.colour_log2);
        let convert = move |pixel: &Pixel| convert(pixel).map(|value| value as f32);
        self.draw_as(frame, progress, convert)
    }

    /// Draws a picture in double precision; one of another size is replaced.
    pub fn draw_picture(
        &mut self,
        picture: &mut Picture,
        progress: &Progress,
    ) -> Result<Drawn, DrawError> {
        let [width, height] = self.quantised.view.viewport.map(usize::from);
        if [picture.width, picture.height] != [width, height] {
            *picture = Picture::new(width, height);
        }
        let convert = converter(&self.settings.design.widths, self.quantised.colour_log2);
        self.draw_as(&mut picture.pixels, progress, convert)
    }

    fn draw_as<T: Send>(
        &mut self,
        frame: &mut [T],
        progress: &Progress,
        convert: impl Fn(&Pixel) -> T + Send + Sync,
    ) -> Result<Drawn, DrawError> {
        let [columns, rows] = self.quantised.view.viewport.map(usize::from);
        let pixels = frame.len();
        if pixels != columns * rows {
            return Err(DrawError::Size {
                pixels,
                columns,
                rows,
            });
        }
        let Renderer {
            settings,
            quantised,
            painter,
            spheres,
            memory,
            pool,
            ..
        } = self;
        let (options, engine) = (settings.options(), settings.engine);
        let depth_first = spheres.as_ref().and_then(|spheres| {
            let widths = &settings.design.widths;
            Some(DepthFirst {
                spheres,
                projection: SphereProjection::new(&quantised.view, widths, spheres)?,
                vectors: engine.vectors().unwrap_or(VectorLevel::Portable),
            })
        });
        let painter = (&**painter, depth_first);
        let work = || {
            let facts = paint_with(quantised, &options, engine, painter, memory, progress)?;
            let started = Instant::now();
            memory.copy(frame, convert);
            let convert = started.elapsed().as_secs_f64();
            Ok(Drawn { facts, convert })
        };
        match pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}
