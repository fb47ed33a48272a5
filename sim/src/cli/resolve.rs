//! From options to a [`Prepared`] plan: the entrance through which every command about a scene comes.
//!
//! Names are resolved, files of settings read and what contradicts itself is refused; then the scene is loaded, and what the options leave
//! open follows from it: camera, rules, thresholds.

use super::drawing_args::{DrawingOptions, WorkOptions};
use super::machine_args::{AreaOptions, EnergyOptions, MachineOptions};
use super::output::read_settings;
use super::say::{Failure, print_error, print_result};
use super::values::{
    AntialiasChoice, Backfaces, DesignName, OrbitChoice, PictureSize, TraversalChoice, VectorValue,
};
use super::view_args::{MoreScenes, PathOptions, SurfaceArgs, ViewOptions};
use crate::camera::{Camera, CameraError, NOTABLE_CORRECTION};
use crate::cameras::{self, CameraPose};
use crate::design::DesignChoice;
use crate::framing::{Ball, FramingInput, USUAL_FOV, orbited};
use crate::hybrid::{Hybrid, Points, spacing};
use crate::machine::area::Calibration;
use crate::machine::config::{self, Config};
use crate::machine::energy::EnergyTable;
use crate::machine::parts::{Part, Parts};
use crate::memory;
use crate::plan::path::{self, CameraPath};
use crate::plan::{AnyScene, DesignVariant, Engine, Look, Plan, Prepared, SceneInput, Source};
use crate::progress::ProgressMeter;
use crate::rules::{Antialias, Compositing, Kernel, Rules};
use crate::scene::Scene;
use crate::scene::points::SurfaceScene;
use crate::scene::points::height_field::is_height_field;
use crate::scene::points::orientation::Orientation;
use crate::surface::{Buffer, Style, USUAL_EDGE};
use anyhow::anyhow;
use splatline::format::Traversal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where neither a camera file nor `--size` says otherwise.
const USUAL_SIZE: PictureSize = PictureSize {
    width: 512,
    height: 512,
};

/// Light of a cloud that has no colours of its own, from above the default camera's left shoulder.
const USUAL_LIGHT: [f64; 3] = [0.4, 0.5, 1.0];

/// Depth range of gathered points, in sample spacings.
const DEPTH_RANGE: f64 = 0.5;

/// What the options of a command say about a scene and its drawing; commands that lack an option have its default here.
pub struct PlanRequest<'a> {
    view: &'a ViewOptions,
    engine: Engine,
    design: &'a DesignName,
    traversal: Option<TraversalChoice>,
    compositing: Compositing,
    points: Option<Points>,
    phase_bits: u8,
    machine: Option<&'a MachineOptions>,
    keeps_order: bool,
}

/// One picture of several, with what it is called.
pub struct NamedFrame {
    /// The scene, and the camera where there are several.
    pub name: String,
    /// Its plan.
    pub prepared: Prepared,
}

impl NamedFrame {
    /// The only picture of its scene.
    pub fn only(prepared: Prepared) -> NamedFrame {
        NamedFrame {
            name: prepared.scene.name().to_owned(),
            prepared,
        }
    }
}

impl<'a> PlanRequest<'a> {
    /// By one design's own traversal, front to back.
    pub fn by_design(view: &'a ViewOptions, design: &'a DesignName) -> PlanRequest<'a> {
        PlanRequest {
            view,
            engine: Engine::Fixed,
            design,
            traversal: None,
            compositing: Compositing::FrontToBack,
            points: None,
            phase_bits: 3,
            machine: None,
            keeps_order: false,
        }
    }

    /// What the commands about the kernel and the machine ask.
    pub fn work(view: &'a ViewOptions, work: &'a WorkOptions) -> PlanRequest<'a> {
        PlanRequest {
            traversal: work.traversal,
            compositing: work.compositing,
            ..PlanRequest::by_design(view, &work.design)
        }
    }

    /// What the commands that write pictures ask.
    pub fn drawing(view: &'a ViewOptions, drawing: &'a DrawingOptions) -> PlanRequest<'a> {
        PlanRequest {
            engine: drawing.engine,
            points: drawing.points,
            phase_bits: drawing.phase_bits,
            ..PlanRequest::work(view, &drawing.work)
        }
    }

    /// The same for a machine.
    pub fn on(self, machine: &'a MachineOptions) -> PlanRequest<'a> {
        PlanRequest {
            machine: Some(machine),
            ..self
        }
    }

    /// The same where lists may keep the order of the picture before.
    pub fn keeping_order(self) -> PlanRequest<'a> {
        PlanRequest {
            keeps_order: true,
            ..self
        }
    }

    /// Refuses a machine that keeps an order where no picture comes before another.
    fn check_order(&self, machine: &Config) -> Result<(), Failure> {
        if self.keeps_order {
            Ok(())
        } else {
            refuse_kept_order(machine)
        }
    }

    /// The plan with its scene, from the options or from a report.
    pub fn prepare(&self) -> Result<Prepared, Failure> {
        match &self.view.from {
            Some(report) => self.read_report(report),
            None => self.read_options(scene_of(self.view)?, None),
        }
    }

    /// A plan for every frame: of each scene, by each camera of the path.
    pub fn frames(
        &self,
        path: &PathOptions,
        more: &MoreScenes,
    ) -> Result<Vec<NamedFrame>, Failure> {
        let size = self.view.size.map(|size| [size.width, size.height]);
        let path = match &path.camera_path {
            Some(file) => {
                let loaded = path::load(file, size)?;
                for note in &loaded.notes {
                    print_error(&format!("{}: {note}\n", file.display()));
                }
                Some(loaded.path)
            }
            None => None,
        };
        if self.view.from.is_some() {
            return Ok(vec![NamedFrame::only(self.prepare()?)]);
        }
        let scenes = std::iter::once(scene_of(self.view)?).chain(&more.others);
        let mut frames = Vec::new();
        for scene in scenes {
            let prepared = self.read_options(scene, path.as_ref())?;
            let Some(path) = &path else {
                frames.push(NamedFrame::only(prepared));
                continue;
            };
            let cameras = path.cameras(prepared.scene.up(), self.path_size())?;
            let what = format!("a camera path of {} frames", cameras.len());
            memory::room_for_records(cameras.len() as u64, FRAME_BYTES, &what)?;
            for (name, camera) in cameras {
                frames.push(NamedFrame {
                    name: format!("{}, {name}", prepared.scene.name()),
                    prepared: prepared.seen_by(camera),
                });
            }
        }
        Ok(frames)
    }

    /// Of pictures whose cameras have no size of their own.
    fn path_size(&self) -> [usize; 2] {
        let PictureSize { width, height } = self.view.size.unwrap_or(USUAL_SIZE);
        [width, height]
    }

    /// A report's plan; the machine's options may change its machine, which no picture depends on.
    fn read_report(&self, report: &Path) -> Result<Prepared, Failure> {
        let progress = ProgressMeter::spinner(format!("loading what {} records", report.display()));
        let mut prepared = Prepared::from_report(report, &|what| progress.doing(what))?;
        if let Some(options) = self.machine {
            prepared.plan.machine = change_machine(options, prepared.plan.machine)?;
        }
        self.check_order(&prepared.plan.machine)?;
        Ok(prepared)
    }

    fn read_options(&self, scene: &Path, path: Option<&CameraPath>) -> Result<Prepared, Failure> {
        let view = self.view;
        let source = self.source(scene)?;
        let machine = match self.machine {
            Some(options) => machine(options)?,
            None => Config::default(),
        };
        self.check_order(&machine)?;
        let design = DesignChoice::load(&self.design.0)?;
        let entry = DesignVariant::new(design, self.traversal.map(Traversal::from));
        let progress = ProgressMeter::spinner(format!("loading {}", source.path.display()));
        let loaded = source.load(&|what| progress.doing(what))?;
        let frame = || loaded.scene.frame(view.up.map(|VectorValue(up)| up));
        let (camera, warnings) = match path {
            Some(path) => {
                let cameras = path.cameras(loaded.scene.up(), self.path_size())?;
                let first = cameras.into_iter().next();
                let (_, camera) = first.ok_or_else(|| anyhow!("the camera path is empty"))?;
                (camera, Vec::new())
            }
            None => camera(view, loaded.scene.up(), scene, frame)?,
        };
        drop(progress);
        for note in &loaded.notes {
            print_error(&format!("{}: {note}\n", loaded.scene.name()));
        }
        let look = match &loaded.scene {
            AnyScene::Splats(scene) => self.splats_look(scene)?,
            AnyScene::Surface { scene, .. } => Look::Surface(style(view, scene)),
        };
        Ok(Prepared {
            plan: Plan {
                source,
                camera,
                look,
                engine: self.engine,
                reference: None,
                entry,
                machine,
            },
            scene: Arc::new(loaded.scene),
            warnings,
            prepare_s: loaded.seconds,
        })
    }

    /// The scene asked for, if the other options have a meaning for its kind.
    fn source(&self, path: &Path) -> Result<Source, Failure> {
        let (view, surface) = (self.view, &self.view.surface);
        let path = path.to_owned();
        let taken = match surface.kind {
            None => SceneInput::Splats {
                transfer: view.transfer.clone(),
                light: view.light.map(|VectorValue(direction)| direction),
            },
            Some(_) => {
                self.refuse_volume_options()?;
                refuse_height_field_options(&path, surface)?;
                let method = surface.coefficients;
                SceneInput::Surface {
                    texture: surface
                        .texture
                        .clone()
                        .map(|photograph| (photograph, method)),
                    spacing: surface.spacing,
                }
            }
        };
        Ok(Source { path, taken })
    }

    fn refuse_volume_options(&self) -> Result<(), Failure> {
        let view = self.view;
        let refused = [
            (view.rules.is_some(), "--rules"),
            (view.transfer.is_some(), "--transfer"),
            (view.antialias.is_some(), "--antialias"),
            (view.kernel != Kernel::Gaussian, "--kernel"),
        ];
        if let Some((_, option)) = refused.iter().find(|(given, _)| *given) {
            let message = format!("{option} has no meaning with --as surface");
            return Err(Failure::Usage(message));
        }
        if self.engine == Engine::Exact {
            let message = "--engine exact has no meaning with --as surface: use fixed or float";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(())
    }

    /// Rules and blending of splats.
    ///
    /// Points and stamps need distance scaling, which tells which samples are closer together than pixels.
    fn splats_look(&self, scene: &Scene) -> Result<Look, Failure> {
        let rules = rules(self.view, scene);
        let compositing = self.compositing;
        let hybrid = self.hybrid(scene);
        if hybrid.is_some() && (rules.spacing <= 0.0 || !rules.cutoff.is_finite()) {
            let message = "--points and --traversal stamp need --rules ewa and --antialias swan";
            return Err(Failure::Usage(message.to_owned()));
        }
        if hybrid.is_some() && compositing != Compositing::FrontToBack {
            let message = "--points and --traversal stamp composite front to back only";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(Look::Splats {
            rules,
            compositing,
            hybrid,
        })
    }

    /// Points and stamps, if the options ask for them.
    fn hybrid(&self, scene: &Scene) -> Option<Hybrid> {
        let stamped = self.traversal == Some(TraversalChoice::Stamp);
        if self.points.is_none() && !stamped {
            return None;
        }
        Some(Hybrid {
            points: self.points.unwrap_or_default(),
            depth_range: self.points.map(|_| DEPTH_RANGE * spacing(scene)),
            phase_bits: stamped.then_some(self.phase_bits),
        })
    }
}

/// The scene that the options name.
pub fn scene_of(view: &ViewOptions) -> Result<&PathBuf, Failure> {
    let message = "name a scene, or a report.json that records one with --from";
    view.scene
        .as_ref()
        .ok_or_else(|| Failure::Usage(message.to_owned()))
}

fn refuse_height_field_options(path: &Path, surface: &SurfaceArgs) -> Result<(), Failure> {
    let refused = [
        (surface.texture.is_some(), "--texture"),
        (surface.spacing.is_some(), "--spacing"),
    ];
    match refused.iter().find(|(given, _)| *given) {
        Some((_, option)) if !is_height_field(path) => Err(Failure::Usage(format!(
            "{option} needs a height field: give a .csv file as scene"
        ))),
        _ => Ok(()),
    }
}

/// The rules asked for, with the kernel and the protection against aliasing asked for.
fn rules(options: &ViewOptions, scene: &Scene) -> Rules {
    let rules = options.rules.unwrap_or(scene.natural_rules);
    let rules = rules.with_kernel(options.kernel);
    match options.antialias {
        None | Some(AntialiasChoice::Ewa) => rules,
        Some(AntialiasChoice::None) => rules.with_antialias(Antialias::None),
        Some(AntialiasChoice::Swan) => rules.with_antialias(Antialias::Swan(spacing(scene))),
    }
}

/// The style that the options and the scene ask for.
fn style(view: &ViewOptions, scene: &SurfaceScene) -> Style {
    let options = &view.surface;
    let threshold = options.z_threshold.unwrap_or(scene.usual_threshold());
    Style {
        buffer: options.layers.map_or(Buffer::Accumulation, Buffer::Layers),
        edge: options.edges.then_some(USUAL_EDGE),
        light: view
            .light
            .map(|VectorValue(light)| light)
            .or((!scene.coloured).then_some(USUAL_LIGHT)),
        cull_backfaces: culls_backfaces(options, scene),
        ..Style::opaque(threshold)
    }
}

/// As the options say, or else where the cloud's normals allow it. Of a body that one can see through the backs are wanted.
fn culls_backfaces(options: &SurfaceArgs, scene: &SurfaceScene) -> bool {
    match options.backfaces() {
        Backfaces::On => true,
        Backfaces::Off => false,
        Backfaces::Auto => {
            let opaque = scene.points.iter().all(|point| point.opacity >= 1.0);
            opaque && Orientation::of(scene).is_closed_outwards()
        }
    }
}

/// Refuses lists that keep the order of the picture before.
pub fn refuse_kept_order(machine: &Config) -> Result<(), Failure> {
    match machine.sort_every {
        1 => Ok(()),
        every => Err(Failure::Usage(format!(
            "sort_every = {every}: allowed is 1 here: `simulate` with a --camera-path keeps the order of the picture before, and nothing else does"
        ))),
    }
}

/// The machine that the options describe.
pub fn machine(options: &MachineOptions) -> Result<Config, Failure> {
    change_machine(options, Config::default())
}

/// The machine that the options name, or else this one, with the changes that they ask for.
fn change_machine(options: &MachineOptions, unnamed: Config) -> Result<Config, Failure> {
    let mut config = match &options.machine {
        Some(path) => match path.to_str().and_then(Config::named) {
            Some(config) => config,
            None => config::from_file(path)?,
        },
        None => unnamed,
    };
    config
        .set_words(&options.set)
        .map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(config)
}

/// The part that the options name.
pub fn part(options: &AreaOptions) -> Result<Option<Part>, Failure> {
    let Some(name) = &options.part else {
        return Ok(None);
    };
    let mut parts = Parts::default();
    if let Some(path) = &options.parts {
        let text = read_settings(path)?;
        let file = path.display().to_string();
        parts = parts
            .and(&file, &text)
            .map_err(|problem| anyhow!(problem))?;
    }
    let found = parts.find(name).map_err(Failure::Usage)?;
    Ok(Some(found.clone()))
}

/// The prices that the options name: a file's, a part's family's, or a family's.
pub fn calibration(options: &AreaOptions) -> Result<Calibration, Failure> {
    match &options.calibration {
        None => Ok(match part(options)? {
            Some(part) => part.family.calibration(),
            None => options.family.calibration(),
        }),
        Some(path) => {
            let text = read_settings(path)?;
            Ok(Calibration::from_toml(&path.display().to_string(), &text)
                .map_err(|problem| anyhow!(problem))?)
        }
    }
}

/// The table of energies that was asked for, or the one that ships.
pub fn energy_table(options: &EnergyOptions) -> Result<EnergyTable, Failure> {
    match &options.energy {
        None => Ok(EnergyTable::default()),
        Some(path) => {
            let text = read_settings(path)?;
            Ok(EnergyTable::from_toml(&path.display().to_string(), &text)
                .map_err(|problem| anyhow!(problem))?)
        }
    }
}

/// The camera of the options, or one that shows the whole scene, and what had to be corrected. `up` is used where the options do not say.
fn camera(
    options: &ViewOptions,
    up: [f64; 3],
    scene: &Path,
    frame: impl FnOnce() -> FramingInput,
) -> Result<(Camera, Vec<String>), Failure> {
    let (camera, warnings) = match (&options.camera, options.eye, options.target) {
        (Some(path), ..) => camera_from_file(path, options)?,
        (None, Some(VectorValue(eye)), Some(VectorValue(target))) => {
            (camera_from_eye(eye, target, up, options)?, Vec::new())
        }
        _ => (framed(&frame(), scene, options)?, Vec::new()),
    };
    let camera = match options.zoom {
        Some(factor) => camera.zoomed(factor)?,
        None => camera,
    };
    Ok((camera, warnings))
}

fn camera_from_file(path: &Path, options: &ViewOptions) -> Result<(Camera, Vec<String>), Failure> {
    let size = options.size.map(|size| [size.width, size.height]);
    let pose = cameras::choose(cameras::load(path, size)?, options.image.as_deref())
        .map_err(|problem| anyhow!("camera file '{}' {problem}", path.display()))?;
    for note in &pose.notes {
        print_error(&format!("{}: {note}\n", pose.name));
    }
    let warnings = correction(path, &pose);
    let camera = match options.size {
        Some(size) => pose.camera.resized(size.width, size.height)?,
        None => pose.camera,
    };
    Ok((camera, warnings))
}

/// What to say about a rotation that was corrected.
fn correction(path: &Path, pose: &CameraPose) -> Vec<String> {
    let (change, field) = (pose.correction, pose.rotation_field);
    if change <= NOTABLE_CORRECTION {
        return Vec::new();
    }
    let file = path.display();
    vec![format!(
        "camera file '{file}': '{field}' is a rotation only nearly; the nearest one is used, which changes entries by up to {change:.1e}"
    )]
}

fn camera_from_eye(
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    options: &ViewOptions,
) -> Result<Camera, Failure> {
    let PictureSize { width, height } = options.size.unwrap_or(USUAL_SIZE);
    let up = options.up.map_or(up, |VectorValue(up)| up);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    let eye = match options.orbit {
        Some(OrbitChoice(orbit)) => orbited(eye, target, up, orbit),
        None => eye,
    };
    Camera::look_at(eye, target, up, fov, width, height).map_err(|error| {
        Failure::Usage(format!("--eye, --target and --up make no camera: {error}"))
    })
}

/// An automatic camera, unless the scene's coordinates are so large that it cannot be placed: their squares overflow beyond 1e154.
pub fn sound_camera(camera: Camera, scene: &str) -> Result<Camera, Failure> {
    if camera.is_sound() {
        Ok(camera)
    } else {
        Err(too_large(scene))
    }
}

fn too_large(scene: &str) -> Failure {
    anyhow!(
        "{scene}: its coordinates are too large or too far apart to place a camera: remove what lies far outside, or scale the scene"
    )
    .into()
}

/// Refuses a picture of which so many bytes a pixel do not fit into memory.
pub fn room_for_picture(camera: &Camera, bytes: u64) -> Result<(), Failure> {
    let (width, height) = (camera.width, camera.height);
    let bytes = bytes.saturating_mul(width as u64 * height as u64);
    let what = format!("a picture of {width}x{height}");
    memory::room_for(bytes, &what, "give a smaller --size")?;
    Ok(())
}

/// Bytes of a frame of a camera path: its plan, and what is reported of it.
const FRAME_BYTES: usize = 40_000;

/// Bytes of a pixel of each further reference picture that is kept beside those being compared.
pub const HELD_PIXEL_BYTES: u64 = 32;

/// Bytes of a pixel while a picture is drawn and written: 47 were measured, 53 for a surface.
pub const DRAWN: u64 = 64;
/// While two are compared: both, the error map and their files; 79 were measured, 138 for a surface in eight layers, whose reference
/// keeps every fragment.
pub const COMPARED: u64 = 192;

/// The whole scene, and a line that tells by which rule.
fn framed(frame: &FramingInput, scene: &Path, options: &ViewOptions) -> Result<Camera, Failure> {
    let PictureSize { width, height } = options.size.unwrap_or(USUAL_SIZE);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    let orbit = options.orbit.map(|OrbitChoice(orbit)| orbit);
    let scene = scene.display().to_string();
    let place = |frame: &FramingInput| frame.camera(orbit, fov, width, height);
    let camera = match place(frame) {
        Ok(camera) => sound_camera(camera, &scene)?,
        Err(error) => return Err(why_not_framed(error, frame, &scene, place)),
    };
    print_result(&format!("{}\n", frame.describe(fov)))?;
    Ok(camera)
}

/// Whose fault it is: of the scene if a ball of usual size can be framed, of the options otherwise.
fn why_not_framed(
    error: CameraError,
    frame: &FramingInput,
    scene: &str,
    place: impl Fn(&FramingInput) -> Result<Camera, CameraError>,
) -> Failure {
    let usual = FramingInput {
        ball: Ball {
            centre: [0.0; 3],
            radius: 1.0,
            strays: 0,
        },
        ..frame.clone()
    };
    match place(&usual) {
        Ok(_) => too_large(scene),
        Err(_) => Failure::Usage(format!("the scene cannot be framed: {error}")),
    }
}
