//! One way through: what is drawn, from where, by which rules, which design and which machine, resolved once at the entrance.
//!
//! ```text
//! Source -> load -> AnyScene -> Plan -> draw -> measure -> Report
//! ```
//!
//! A [`Plan`] is data, without a command line and without a scene: `report.json` records it, and [`Prepared::from_report`] reads it back and
//! loads its scene, so that what a report shows can be drawn again bit for bit. Each step sees only what the step before gave it:
//! [`load`] turns a [`Source`] into a scene of any kind, [`draw`] a [`Prepared`] plan into a [`Drawing`], [`measure`] repeats and compares
//! drawings, [`record`] states them as a report. What kind of scene it is, is asked in `draw` and in `record` and nowhere else.

pub mod draw;
pub mod load;
pub mod measure;
pub mod path;
pub mod record;

pub use draw::{Drawing, FootprintLine};
pub use load::{AnyScene, LoadedSubject, SceneInput, Source};
pub use measure::{Comparison, Effort, Measured, all_entries, compare_all};

use crate::camera::Camera;
use crate::design::{DesignChoice, traversal_name};
use crate::fixed;
use crate::hybrid::Hybrid;
use crate::machine::{Config, others};
use crate::reference::formats::{self, FloatFormat};
use crate::rules::{Compositing, Rules};
use crate::scene::points::SurfaceScene;
use crate::scene::{Scene, SortOrder};
use crate::surface::Style;
use anyhow::{Result, bail};
use serde::{Deserialize, Serialize};
use splatline::format::Traversal;
use std::path::PathBuf;
use std::sync::Arc;

/// Why commands about cycles take no surfaces; said once for all of them.
pub const NO_SURFACE_UNIT: &str = "the machine has no surface unit: its units set up, walk, look up and blend volume splats, and none of \
     them gathers surfaces by depth. render, compare, footprints, fit, needs and info take surfaces; model, explore and trace take splats only";

/// Who draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// The fixed-point kernel.
    Fixed,
    /// EWA in double precision.
    Float,
    /// The ray integral in double precision, without the affine approximation.
    Exact,
    /// EWA in single precision, every operation rounded.
    Fp32,
    /// Setup in single precision, pixels in IEEE halves, every operation rounded.
    Fp16,
    /// Setup in single precision, pixels in bfloat16, every operation rounded.
    Bfloat16,
}

impl Engine {
    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Engine::Fixed => "fixed",
            Engine::Float => "float",
            Engine::Exact => "exact",
            Engine::Fp32 => "fp32",
            Engine::Fp16 => "fp16",
            Engine::Bfloat16 => "bfloat16",
        }
    }

    /// The engines that compute in a floating-point format of few bits.
    pub const FORMATS: [Engine; 3] = [Engine::Fp32, Engine::Fp16, Engine::Bfloat16];

    /// The format of the pixels, of an engine that has one.
    pub fn format(self) -> Option<FloatFormat> {
        match self {
            Engine::Fp32 => Some(formats::FP32),
            Engine::Fp16 => Some(formats::FP16),
            Engine::Bfloat16 => Some(formats::BFLOAT16),
            Engine::Fixed | Engine::Float | Engine::Exact => None,
        }
    }
}

/// One design walked by one traversal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignVariant {
    /// Widths of its datapath.
    pub design: DesignChoice,
    /// How a footprint's pixels are walked.
    #[serde(with = "crate::design::traversal_by_name")]
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

/// How a scene of its kind is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Look {
    /// Volume splats.
    Splats {
        /// Rules of blending.
        #[serde(with = "record::rules")]
        rules: Rules,
        /// Order and operator of blending.
        compositing: Compositing,
        /// Points and stamps instead of splats alone.
        hybrid: Option<Hybrid>,
    },
    /// Points of a surface.
    Surface(Style),
}

/// Everything that decides a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Where the scene comes from.
    pub source: Source,
    /// From where it is seen.
    #[serde(with = "record::camera")]
    pub camera: Camera,
    /// How it is drawn.
    pub look: Look,
    /// Who draws it.
    pub engine: Engine,
    /// Whom it is compared with; none if it is drawn alone.
    pub reference: Option<Engine>,
    /// The kernel's design and traversal.
    pub entry: DesignVariant,
    /// The machine whose cycles are counted.
    pub machine: Config,
}

/// A plan with its scene loaded: all that a drawing needs.
pub struct Prepared {
    /// What is decided.
    pub plan: Plan,
    /// What is drawn; shared by all frames of a path.
    pub scene: Arc<AnyScene>,
    /// What was changed on the way in; for reports and stderr.
    pub warnings: Vec<String>,
    /// Seconds that loading and classifying took.
    pub prepare_s: f64,
}

/// A scene and how it is drawn, which belong together.
#[derive(Clone, Copy)]
pub enum Depiction<'a> {
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
    /// Points and stamps, if any.
    pub hybrid: Option<&'a Hybrid>,
}

impl<'a> Splats<'a> {
    /// What machines of others are compared on: they draw no points.
    pub fn without_points(&self) -> others::Splats<'a> {
        others::Splats {
            scene: self.scene,
            camera: self.camera,
            rules: self.rules,
            compositing: self.compositing,
        }
    }

    /// What the kernel is told.
    pub fn options(&self, entry: &'a DesignVariant) -> fixed::Options<'a> {
        fixed::Options {
            rules: self.rules,
            compositing: self.compositing,
            design: &entry.design,
            traversal: entry.traversal,
        }
    }
}

impl Prepared {
    /// Splats that are at hand, front to back by a design: what measures many scenes has no files of them.
    pub fn of_splats(scene: Scene, camera: Camera, rules: Rules, design: DesignChoice) -> Prepared {
        Prepared {
            plan: Plan {
                source: Source::splats(PathBuf::from(&scene.name)),
                camera,
                look: Look::Splats {
                    rules,
                    compositing: Compositing::FrontToBack,
                    hybrid: None,
                },
                engine: Engine::Fixed,
                reference: None,
                entry: DesignVariant::new(design, None),
                machine: Config::default(),
            },
            scene: Arc::new(AnyScene::Splats(scene)),
            warnings: Vec::new(),
            prepare_s: 0.0,
        }
    }

    /// The same scene seen by another camera.
    pub fn seen_by(&self, camera: Camera) -> Prepared {
        Prepared {
            plan: Plan {
                camera,
                ..self.plan.clone()
            },
            scene: Arc::clone(&self.scene),
            warnings: self.warnings.clone(),
            prepare_s: self.prepare_s,
        }
    }

    /// The scene with its look.
    pub fn subject(&self) -> Result<Depiction<'_>> {
        match (&*self.scene, &self.plan.look) {
            (
                AnyScene::Splats(scene),
                Look::Splats {
                    hybrid: Some(_), ..
                },
            ) if scene.order != SortOrder::Depth => {
                bail!(
                    "{}: it is sorted by distance, and points and stamps go by the depth: leave out --points and --traversal stamp",
                    scene.name
                )
            }
            (
                AnyScene::Splats(scene),
                Look::Splats {
                    rules,
                    compositing,
                    hybrid,
                },
            ) => Ok(Depiction::Splats(Splats {
                scene,
                camera: &self.plan.camera,
                rules,
                compositing: *compositing,
                hybrid: hybrid.as_ref(),
            })),
            (AnyScene::Surface { scene, .. }, Look::Surface(style)) => {
                Ok(Depiction::Surface(scene, style))
            }
            _ => bail!(
                "{}: the plan's look is another kind's than its scene",
                self.scene.name()
            ),
        }
    }

    /// The splats, for what the machine counts.
    pub fn splats(&self) -> Result<Splats<'_>> {
        match self.subject()? {
            Depiction::Splats(splats) if splats.hybrid.is_some() => bail!(
                "{}: the machine draws neither points nor stamps: leave out --traversal stamp",
                self.scene.name()
            ),
            Depiction::Splats(splats) => Ok(splats),
            Depiction::Surface(..) => bail!("{}: {NO_SURFACE_UNIT}", self.scene.name()),
        }
    }

    /// Does another traversal draw another picture or take other time? Points and stamps have one traversal only.
    pub fn has_traversals(&self) -> bool {
        !matches!(
            self.plan.look,
            Look::Splats {
                hybrid: Some(_),
                ..
            }
        )
    }
}
