//! From options to a [`Prepared`] plan: the entrance through which every command about a scene comes.
//!
//! Names are resolved, files of settings read and what contradicts itself is refused; then the scene is loaded, and
//! what the options leave open follows from it: camera, rules, thresholds.

mod camera;
mod machine;
mod technique;

pub use camera::{pose_of, sound_camera};
pub use machine::{energy_table, machine, prices, refuse_kept_order};

use super::drawing_args::{DrawingOptions, FrameOptions, TechniqueOptions, WorkOptions};
use super::machine_args::MachineOptions;
use super::say::{print_error, usage};
use super::values::TraversalChoice;
use super::view_args::{PathOptions, ViewOptions};
use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::framing::turned_camera;
use crate::machine::Config;
use crate::memory;
use crate::plan::path::{self, CameraPath};
use crate::plan::{COMPOSITED_ALONE, DesignVariant, Engine, Plan, Prepared};
use crate::progress::ProgressMeter;
use crate::rules::Compositing;
use anyhow::{Context, Result, ensure};
use camera::{USUAL_SIZE, camera};
use machine::change_machine;
use splatline::format::Traversal;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// What the options of a command say about a scene and its drawing; commands that lack an option have its default here.
pub struct PlanRequest<'a> {
    view: &'a ViewOptions,
    more: &'a [PathBuf],
    path: Option<&'a PathOptions>,
    engine: Engine,
    design: &'a str,
    traversal: Option<TraversalChoice>,
    compositing: Compositing,
    technique: Option<&'a TechniqueOptions>,
    machine: Option<&'a MachineOptions>,
    keeps_order: bool,
    by_units: bool,
}

/// One picture of several, with what it is called.
pub struct NamedFrame {
    /// The scene, and the camera where there are several.
    pub name: String,
    /// Its plan.
    pub prepared: Prepared,
}

/// A picture of several before its plan is made: a path of 100,000 cameras is one scene and 100,000 of these.
pub struct PlannedFrame {
    /// The scene, and the camera where there are several.
    pub name: String,
    /// Of the picture that its camera took.
    pub picture: Option<String>,
    scene: Rc<Prepared>,
    /// Of a path, instead of the plan's own.
    camera: Option<Camera>,
}

const _: () = assert!(
    size_of::<PlannedFrame>() < 512,
    "a path holds 100,000 of them"
);

impl PlannedFrame {
    fn only(prepared: Prepared) -> PlannedFrame {
        PlannedFrame {
            name: prepared.scene.name().to_owned(),
            picture: None,
            scene: Rc::new(prepared),
            camera: None,
        }
    }

    /// What every frame of the scene has in common.
    pub fn plan(&self) -> &Plan {
        &self.scene.plan
    }

    /// With its plan.
    pub fn prepare(self) -> NamedFrame {
        let prepared = match self.camera {
            Some(camera) => self.scene.seen_by(camera),
            // Nobody else has the only picture of a scene.
            None => Rc::try_unwrap(self.scene)
                .unwrap_or_else(|shared| shared.seen_by(shared.plan.camera.clone())),
        };
        let name = self.name;
        NamedFrame { name, prepared }
    }
}

impl<'a> PlanRequest<'a> {
    /// By one design's own traversal, front to back.
    pub fn by_design(view: &'a ViewOptions, design: &'a str) -> PlanRequest<'a> {
        PlanRequest {
            view,
            more: &[],
            path: None,
            engine: Engine::Fixed,
            design,
            traversal: None,
            compositing: Compositing::FrontToBack,
            technique: None,
            machine: None,
            keeps_order: false,
            by_units: false,
        }
    }

    /// What the commands about the kernel and the machine ask.
    pub fn work(view: &'a ViewOptions, work: &'a WorkOptions) -> PlanRequest<'a> {
        PlanRequest {
            traversal: work.traversal,
            compositing: work.compositing,
            technique: Some(&work.technique),
            ..PlanRequest::by_design(view, &work.design)
        }
    }

    /// The same of several scenes and cameras.
    pub fn of_frames(frames: &'a FrameOptions) -> PlanRequest<'a> {
        PlanRequest {
            more: &frames.more,
            ..PlanRequest::work(&frames.view, &frames.work).along(&frames.path)
        }
    }

    /// What the commands that write pictures ask.
    pub fn drawing(view: &'a ViewOptions, drawing: &'a DrawingOptions) -> PlanRequest<'a> {
        PlanRequest {
            engine: drawing.engine,
            ..PlanRequest::work(view, &drawing.work)
        }
    }

    /// The same along a path, if there is one.
    pub fn along(mut self, path: &'a PathOptions) -> PlanRequest<'a> {
        self.path = Some(path);
        self
    }

    /// The same for a machine.
    pub fn on(mut self, machine: &'a MachineOptions) -> PlanRequest<'a> {
        self.machine = Some(machine);
        self
    }

    /// The same where lists may keep the order of the picture before.
    pub fn keeping_order(mut self) -> PlanRequest<'a> {
        self.keeps_order = true;
        self
    }

    /// The same for what draws affine footprints one by one, as the machine's units do.
    pub fn by_units(mut self) -> PlanRequest<'a> {
        self.by_units = true;
        self
    }

    fn is_stamped(&self) -> bool {
        self.traversal == Some(TraversalChoice::Stamp)
    }

    /// Is a method asked for that is not that of affine footprints, other than by the traversal?
    fn has_method(&self) -> bool {
        self.technique
            .is_some_and(|options| options.points.is_some() || options.is_another_method())
    }

    /// Refuses, before anything is loaded, what the options say that no unit draws.
    fn check_units(&self) -> Result<()> {
        let is_beyond = self.is_stamped() || self.has_method();
        ensure!(!(self.by_units && is_beyond), usage(COMPOSITED_ALONE));
        Ok(())
    }

    /// Refuses a machine that keeps an order where no picture comes before another.
    fn check_order(&self, machine: &Config) -> Result<()> {
        if self.keeps_order {
            Ok(())
        } else {
            refuse_kept_order(machine)
        }
    }

    /// The plan with its scene, from the options or from a file.
    pub fn prepare(&self) -> Result<Prepared> {
        self.check_units()?;
        match &self.view.from {
            Some(file) => self.read_file(file),
            None => self.read_options(scene_of(self.view)?, None, true),
        }
    }

    /// A plan for every frame at once, for what draws all of them again and again.
    pub fn frames(&self) -> Result<Vec<NamedFrame>> {
        let planned = self.planned_frames()?;
        let what = format!("the plans of {} frames", planned.len());
        memory::room_for_records(planned.len() as u64, FRAME_BYTES, &what)?;
        Ok(planned.into_iter().map(PlannedFrame::prepare).collect())
    }

    /// Every frame, of each scene by each camera of the path, whose plan is made when its turn comes.
    pub fn planned_frames(&self) -> Result<Vec<PlannedFrame>> {
        self.check_units()?;
        let turntable = self.path.and_then(|path| path.turntable);
        let path = match self.path.and_then(|path| path.camera_path.as_ref()) {
            Some(file) => {
                let (path, notes) = path::load(file, self.view.camera.size)?;
                for note in notes {
                    print_error(&format!("{}: {note}\n", file.display()));
                }
                Some(path)
            }
            None => None,
        };
        if self.view.from.is_some() {
            return Ok(vec![PlannedFrame::only(self.prepare()?)]);
        }
        let scenes = std::iter::once(scene_of(self.view)?).chain(self.more);
        let mut frames = Vec::new();
        for scene in scenes {
            // Turned, a scene shows its other sides: there the whole of it has room.
            let prepared = self.read_options(scene, path.as_ref(), turntable.is_none())?;
            let cameras = match (&path, turntable) {
                (Some(path), _) => path.cameras(prepared.scene.up(), self.path_size())?,
                (None, Some(count)) => self.turned(&prepared, count),
                (None, None) => {
                    frames.push(PlannedFrame::only(prepared));
                    continue;
                }
            };
            let has_pictures = matches!(path, Some(CameraPath::Cameras(_)));
            let scene = Rc::new(prepared);
            frames.extend(cameras.into_iter().map(|(name, camera)| PlannedFrame {
                name: format!("{}, {name}", scene.scene.name()),
                picture: has_pictures.then_some(name),
                scene: Rc::clone(&scene),
                camera: Some(camera),
            }));
        }
        Ok(frames)
    }

    /// The plan's view, turned once around what it looks at.
    fn turned(&self, prepared: &Prepared, count: u32) -> Vec<(String, Camera)> {
        let frame = prepared.scene.frame(self.view.camera.up);
        let centre = self.view.camera.target.unwrap_or(frame.ball.centre);
        let turned = |step: u32| {
            let azimuth = 360.0 * f64::from(step) / f64::from(count);
            let camera = turned_camera(&prepared.plan.camera, centre, frame.up, azimuth);
            (format!("turned by {azimuth:.1} degrees"), camera)
        };
        (0..count).map(turned).collect()
    }

    /// Of pictures whose cameras have no size of their own.
    fn path_size(&self) -> [usize; 2] {
        self.view.camera.size.unwrap_or(USUAL_SIZE)
    }

    /// A plan's or a report's; the machine's options may change its machine, which no picture depends on.
    fn read_file(&self, file: &Path) -> Result<Prepared> {
        let progress = ProgressMeter::spinner(format!("loading what {} names", file.display()));
        let mut prepared = Prepared::from_file(file, &|what| progress.doing(what))?;
        if let Some(options) = self.machine {
            prepared.plan.machine = change_machine(options, prepared.plan.machine)?;
        }
        self.check_order(&prepared.plan.machine)?;
        Ok(prepared)
    }

    fn read_options(
        &self,
        scene: &Path,
        path: Option<&CameraPath>,
        fills: bool,
    ) -> Result<Prepared> {
        let view = self.view;
        let source = self.source(scene)?;
        let machine = match self.machine {
            Some(options) => machine(options)?,
            None => Config::default(),
        };
        self.check_order(&machine)?;
        let design = DesignChoice::load(self.design)?;
        let entry = DesignVariant::new(design, self.traversal.map(Traversal::from));
        let progress = ProgressMeter::spinner(format!("loading {}", source.path.display()));
        let loaded = source.load(&|what| progress.doing(what))?;
        let frame = || loaded.scene.frame(view.camera.up);
        let (camera, warnings) = match path {
            Some(path) => {
                let cameras = path.cameras(loaded.scene.up(), self.path_size())?;
                let (_, first) = cameras.first().context("the camera path is empty")?;
                (first.clone(), Vec::new())
            }
            None => {
                let filling = loaded.scene.splats().filter(|_| fills);
                camera(&view.camera, loaded.scene.up(), scene, frame, filling)?
            }
        };
        drop(progress);
        for note in &loaded.notes {
            print_error(&format!("{}: {note}\n", loaded.scene.name()));
        }
        let technique = self.technique(&source, &loaded.scene, &camera)?;
        let plan = Plan {
            source,
            camera,
            technique,
            engine: self.engine,
            reference: None,
            entry,
            machine,
        };
        let scene = Arc::new(loaded.scene);
        Ok(Prepared::new(plan, scene, warnings, loaded.seconds))
    }
}

/// The scene that the options name.
pub fn scene_of(view: &ViewOptions) -> Result<&PathBuf> {
    let scene = view.scene.as_ref();
    scene.ok_or_else(|| usage("name a scene, or a plan with --plan FILE"))
}

/// Bytes of a frame's plan.
const FRAME_BYTES: usize = 40_000;

/// Refuses a picture of which so many bytes a pixel do not fit into memory.
pub fn room_for_picture(camera: &Camera, bytes: u64) -> Result<()> {
    let (width, height) = (camera.width, camera.height);
    let bytes = bytes.saturating_mul(width as u64 * height as u64);
    let what = format!("a picture of {width}x{height}");
    memory::room_for(bytes, &what, "give a smaller --size")?;
    Ok(())
}

/// Bytes of a pixel of each further reference picture that is kept beside those being compared.
pub const HELD_PIXEL_BYTES: u64 = 32;

/// Bytes of a pixel while a picture is drawn and written: 47 were measured, 53 for a surface.
pub const DRAWN: u64 = 64;
/// While two are compared: both, the error map and their files; 79 were measured, 138 for a surface in eight layers,
/// whose reference keeps every fragment.
pub const COMPARED: u64 = 192;
