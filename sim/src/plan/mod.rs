//! One way through: what is drawn, from where, by which rules, which design and which machine, resolved once at the
//! entrance.
//!
//! ```text
//! Source -> load -> AnyScene -> Plan -> draw -> measure -> Report
//! ```
//!
//! A [`Plan`] is data, without a command line and without a scene: `report.json` records it, a plan file (TOML) states
//! it, and [`Prepared::from_file`] reads either and loads its scene, so that what a report shows can be drawn again bit
//! for bit. Its [`Technique`] is which of the papers' systems draw it. Each step sees only what the step before gave
//! it: [`load`] turns a [`Source`] into a scene of any kind, [`draw`] (the kernel) and `reference` a [`Prepared`] plan
//! into a [`Drawing`], [`measure`] repeats and compares drawings, `record` states them as a report, and [`golden`] as
//! a line of the table that every change is held against.

pub mod draw;
mod footprints;
mod exercised;
pub mod golden;
pub mod load;
pub mod measure;
pub mod path;
mod record;
mod reference;
mod technique;
mod text;

pub use draw::Drawing;
pub use footprints::FootprintLine;
pub use load::{AnyScene, Contents, LoadedScene, Source};
pub use measure::{Comparison, Effort, all_entries, compare_all};
pub use technique::{AlphaChannel, SheetBuffers, SplatMethod, SplatTechnique, Technique};

use crate::camera::Camera;
use crate::design::{DesignChoice, traversal_name};
use crate::machine::Config;
use crate::machine::area::lane::FloatLane;
use crate::machine::workload::layers_of;
use crate::reference::formats::{self, FloatFormat, RoundedStages};
use crate::rules::{Compositing, Rules};
use crate::scene::points::SurfaceScene;
use crate::scene::points::flatten::flattened;
use crate::scene::{Scene, SortOrder};
use crate::surface::Style;
use crate::{fixed, input};
use anyhow::{Context, Error, Result, bail, ensure};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use splatline::format::Traversal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why commands about cycles take no techniques; said once for all of them.
pub const COMPOSITED_ALONE: &str = "the machine has units for footprints that are composited one by one: leave out --points, \
     --traversal stamp, --sheets, --deep-alpha and --spheres";

/// Why what knows volume splats alone takes no surfaces.
pub const VOLUMES_ALONE: &str = "points of a surface are gathered by depth, in the scene's order: machines of others, lists that keep their order (sort_every) \
     and maps are of volume splats";

/// Bytes of a factor of a harmonic in the machine's memory: 16 bits, of which a reader makes the words of
/// `harmonics_unit.sv`.
const BYTES_OF_HARMONIC: u32 = 2;

/// Who draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Engine {
    /// The fixed-point kernel
    #[default]
    Fixed,
    /// EWA in double precision
    Float,
    /// The ray integral in double precision, without the affine approximation
    Exact,
    /// Single precision, every operation rounded
    Fp32,
    /// Setup in single precision, pixels in 16-bit floats, every operation rounded
    Fp16,
    /// The same with pixels in bfloat16
    Bfloat16,
    /// The same with offsets and sums in 16-bit floats, kernel and opacity in 8-bit floats (E4M3)
    Fp8Fp16,
    /// The same with kernel and opacity in the other 8-bit floats (E5M2)
    E5m2Fp16,
    /// Setup in single precision, pixels in 8-bit floats (E4M3)
    Fp8,
}

impl Engine {
    /// Of every engine in their order: its name on the command line and in reports, and the formats of the footprint's
    /// kernel and of all else at a pixel if it computes in formats of few bits.
    const TABLE: [(&str, Option<[FloatFormat; 2]>); 9] = [
        ("fixed", None),
        ("float", None),
        ("exact", None),
        ("fp32", Some([formats::FP32; 2])),
        ("fp16", Some([formats::FP16; 2])),
        ("bfloat16", Some([formats::BFLOAT16; 2])),
        ("fp8-fp16", Some([formats::FP8, formats::FP16])),
        ("e5m2-fp16", Some([formats::FP8_WIDE, formats::FP16])),
        ("fp8", Some([formats::FP8; 2])),
    ];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        Self::TABLE[self as usize].0
    }

    /// The engines that compute in a floating-point format of few bits.
    pub const FORMATS: [Engine; 6] = [
        Engine::Fp32,
        Engine::Fp16,
        Engine::Bfloat16,
        Engine::Fp8Fp16,
        Engine::E5m2Fp16,
        Engine::Fp8,
    ];

    /// The formats of the stages, of an engine that has them.
    pub fn stages(self) -> Option<RoundedStages> {
        let [kernel, others] = Self::TABLE[self as usize].1?;
        Some(RoundedStages {
            kernel,
            ..RoundedStages::pixels(others)
        })
    }

    /// The lane of an engine that computes in a floating-point format.
    pub fn lane(self) -> Option<FloatLane> {
        let stages = self.stages()?;
        Some(FloatLane {
            stages: [stages.raster, stages.kernel, stages.blend].map(FloatFormat::name),
            bits: stages.blend.bits().into(),
        })
    }
}

/// One design walked by one traversal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "text::VariantText")]
pub struct DesignVariant {
    /// Widths of its datapath.
    pub design: DesignChoice,
    /// How a footprint's pixels are walked.
    #[serde(with = "crate::design::TraversalByName")]
    pub traversal: Traversal,
}

impl DesignVariant {
    /// A design by the traversal asked for, or else by its own.
    pub fn new(design: DesignChoice, traversal: Option<Traversal>) -> DesignVariant {
        let traversal = traversal.unwrap_or(design.traversal);
        DesignVariant { design, traversal }
    }

    /// `lean18 by spans`.
    pub fn title(&self) -> String {
        format!("{} by {}", self.design.name, traversal_name(self.traversal))
    }
}

impl Default for DesignVariant {
    /// `standard24` by spans.
    fn default() -> DesignVariant {
        let usual = DesignVariant::try_from(text::VariantText::default());
        usual.expect("standard24 is a named design")
    }
}

/// Everything that decides a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Where the scene comes from.
    pub source: Source,
    /// From where it is seen.
    pub camera: Camera,
    /// How it is drawn.
    pub technique: Technique,
    /// Who draws it.
    #[serde(default)]
    pub engine: Engine,
    /// Whom it is compared with; none if it is drawn alone.
    #[serde(default)]
    pub reference: Option<Engine>,
    /// The kernel's design and traversal.
    #[serde(default)]
    pub entry: DesignVariant,
    /// The machine whose cycles are counted.
    #[serde(default)]
    pub machine: Config,
}

/// A plan with its scene loaded: all that a drawing needs.
pub struct Prepared {
    /// What is decided.
    pub plan: Plan,
    /// What was loaded; shared by all frames of a path.
    pub scene: Arc<AnyScene>,
    /// Its splats or points, also once they have been [released](Prepared::release).
    pub count: usize,
    /// Points of a surface as volume kernels, whose masses depend on the camera.
    flattened: Option<Scene>,
    /// What was changed on the way in; for reports and stderr.
    pub warnings: Vec<String>,
    /// Seconds that loading and classifying took.
    pub prepare_s: f64,
}

/// What a drawing is of: a scene and how it is drawn, which belong together.
#[derive(Clone, Copy)]
pub enum Subject<'a> {
    /// Volume splats.
    Splats(Splats<'a>),
    /// Points of a surface.
    Surface(&'a SurfaceScene, &'a Style),
}

/// Volume splats, from where and how they are drawn.
#[derive(Clone, Copy)]
pub struct Splats<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its camera.
    pub camera: &'a Camera,
    /// Rules of blending.
    pub rules: &'a Rules,
    /// Order and operator of blending.
    pub compositing: Compositing,
    /// How splats become pixels.
    pub method: &'a SplatMethod,
}

impl<'a> Splats<'a> {
    /// What the kernel is told.
    pub fn options(&self, entry: &'a DesignVariant) -> fixed::Options<'a> {
        fixed::Options {
            rules: self.rules,
            compositing: self.compositing,
            design: &entry.design,
            traversal: entry.traversal,
        }
    }

    /// Are affine footprints composited one by one? It is what the machine has units for.
    pub fn are_composited(&self) -> bool {
        matches!(self.method, SplatMethod::Composited)
    }
}

/// The machine with the layers of a pixel and the light that a style needs; splats need neither.
fn with_surface_unit(machine: &Config, style: Option<&Style>) -> Config {
    Config {
        surface_layers: style.map_or(0, layers_of),
        surface_light: style.is_some_and(|style| style.light.is_some()).into(),
        ..*machine
    }
}

impl Prepared {
    /// A plan with its scene; `seconds` is what loading took. A machine of which nobody said how many bytes of
    /// harmonics it reads reads the scene's.
    pub fn new(
        mut plan: Plan,
        scene: Arc<AnyScene>,
        warnings: Vec<String>,
        seconds: f64,
    ) -> Prepared {
        let flattened = match (&*scene, plan.source.contents.flattening()) {
            (AnyScene::Surface { scene, .. }, Some(factor)) => {
                Some(flattened(scene, &plan.camera, factor))
            }
            _ => None,
        };
        if let (AnyScene::Splats(splats), 0) = (&*scene, plan.machine.harmonics_bytes) {
            plan.machine.harmonics_bytes = splats.harmonics.as_ref().map_or(0, |harmonics| {
                let factors = (u32::from(harmonics.degree) + 1).pow(2) - 1;
                BYTES_OF_HARMONIC * 3 * factors
            });
        }
        if let Technique::Surface(style) = &plan.technique {
            let machine = with_surface_unit(&plan.machine, Some(style));
            if plan.machine.surface_layers == 0 && machine.check_together().is_ok() {
                plan.machine = machine;
            }
        }
        Prepared {
            plan,
            count: scene.len(),
            scene,
            flattened,
            warnings,
            prepare_s: seconds,
        }
    }

    /// The plan of a file, a plan's or a report's, with its scene loaded; `doing` is told of what takes long.
    pub fn from_file(path: &Path, doing: &dyn Fn(String)) -> Result<Prepared> {
        let shown = path.display();
        let text =
            input::text(path, input::TABLE).with_context(|| format!("cannot read '{shown}'"))?;
        let is_plan = path.extension().is_some_and(|name| name == "toml");
        let plan = if is_plan {
            toml::from_str(&text).map_err(Error::from)
        } else {
            Plan::from_report(&text)
        };
        Prepared::load(plan.with_context(|| format!("'{shown}'"))?, doing)
    }

    /// A plan with its scene loaded.
    pub fn load(plan: Plan, doing: &dyn Fn(String)) -> Result<Prepared> {
        let loaded = plan.source.load(doing)?;
        let scene = Arc::new(loaded.scene);
        Ok(Prepared::new(plan, scene, Vec::new(), loaded.seconds))
    }

    /// Splats that are at hand, front to back by a design: what measures many scenes has no files of them.
    pub fn of_splats(scene: Scene, camera: Camera, rules: Rules, design: DesignChoice) -> Prepared {
        let plan = Plan {
            source: Source::splats(PathBuf::from(&scene.name)),
            camera,
            technique: Technique::Splats(SplatTechnique {
                rules,
                compositing: Compositing::FrontToBack,
                method: SplatMethod::Composited,
            }),
            engine: Engine::Fixed,
            reference: None,
            entry: DesignVariant::new(design, None),
            machine: Config::default(),
        };
        let scene = Arc::new(AnyScene::Splats(scene));
        Prepared::new(plan, scene, Vec::new(), 0.0)
    }

    /// The same scene seen by another camera.
    pub fn seen_by(&self, camera: Camera) -> Prepared {
        let plan = Plan {
            camera,
            ..self.plan.clone()
        };
        let (scene, warnings) = (Arc::clone(&self.scene), self.warnings.clone());
        Prepared::new(plan, scene, warnings, self.prepare_s)
    }

    /// The scene as splats, if it is drawn as such.
    fn splat_scene(&self) -> Option<&Scene> {
        match (&self.flattened, &*self.scene) {
            (Some(flattened), _) => Some(flattened),
            (None, AnyScene::Splats(scene)) => Some(scene),
            (None, AnyScene::Surface { .. }) => None,
        }
    }

    /// The scene with the technique that draws it.
    pub fn subject(&self) -> Result<Subject<'_>> {
        match (self.splat_scene(), &*self.scene, &self.plan.technique) {
            (Some(scene), _, Technique::Splats(technique)) => {
                let (rules, method) = (&technique.rules, &technique.method);
                let splats = Splats {
                    scene,
                    camera: &self.plan.camera,
                    rules,
                    compositing: technique.compositing,
                    method,
                };
                ensure!(
                    scene.order == SortOrder::Depth || splats.are_composited(),
                    "{}: it is sorted by distance, and points, stamps, sheets, deep alpha and spheres go by the depth: leave out \
                         --points, --traversal stamp, --sheets, --deep-alpha and --spheres",
                    scene.name
                );
                ensure!(
                    !(rules.compensated && (rules.normalised || rules.spacing > 0.0)),
                    "{}: --antialias mip compensates opacities for the low-pass filter: it takes rules 3dgs or inria without distance scaling; \
                         normalised kernels (rules ewa) keep their volume by themselves",
                    scene.name
                );
                let is_filtered = rules.low_pass > 0.0 || rules.spacing > 0.0;
                ensure!(
                    !(is_filtered && matches!(method, SplatMethod::Spheres(_))),
                    "{}: projected spheres have exact outlines and no protection against aliasing: leave out --antialias, or set \
                         low_pass and spacing to 0",
                    scene.name
                );
                Ok(Subject::Splats(splats))
            }
            (None, AnyScene::Surface { scene, .. }, Technique::Surface(style)) => {
                Ok(Subject::Surface(scene, style))
            }
            _ => bail!(
                "{}: the plan's technique draws another kind of scene: splats for splats, surface for points of a surface",
                self.scene.name()
            ),
        }
    }

    /// The splats, for what the machine counts.
    pub fn splats(&self) -> Result<Splats<'_>> {
        match self.subject()? {
            Subject::Splats(splats) if splats.are_composited() => Ok(splats),
            Subject::Splats(_) => bail!("{}: {COMPOSITED_ALONE}", self.scene.name()),
            Subject::Surface(..) => bail!("{}: {VOLUMES_ALONE}", self.scene.name()),
        }
    }

    /// Does another traversal draw another picture or take other time?
    pub fn has_traversals(&self) -> bool {
        match &self.plan.technique {
            Technique::Splats(splats) => splats.method.has_traversals(),
            Technique::Surface(_) => true,
        }
    }
}
