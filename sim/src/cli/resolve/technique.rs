//! From options to a source and to the technique that draws it.
//!
//! What contradicts itself or has no meaning for the kind of scene is refused; what is left open follows from the
//! scene.

use super::{PlanRequest, pose_of};
use crate::camera::Camera;
use crate::cli::drawing_args::TechniqueOptions;
use crate::cli::say::usage;
use crate::cli::values::{AntialiasChoice, Backfaces, SceneKind};
use crate::cli::view_args::{SplatArgs, SurfaceArgs, ViewOptions};
use crate::hybrid::{Hybrid, Points, spacing};
use crate::plan::{
    AlphaChannel, AnyScene, Contents, Engine, SheetBuffers, Source, SplatMethod, SplatTechnique,
    Technique,
};
use crate::reference::sphere::Shape;
use crate::rules::{Antialias, Compositing, Kernel, Rules};
use crate::scene::Scene;
use crate::scene::points::SurfaceScene;
use crate::scene::points::flatten::flattened;
use crate::scene::points::height_field::is_height_field;
use crate::scene::points::orientation::is_closed_outwards;
use crate::surface::{Buffer, Style, USUAL_EDGE};
use crate::texture::warp;
use anyhow::{Result, ensure};
use std::path::{Path, PathBuf};

/// Light of a cloud that has no colours of its own, from above the default camera's left shoulder.
const USUAL_LIGHT: [f64; 3] = [0.4, 0.5, 1.0];

/// Depth range of gathered points of a volume, in sample spacings.
const DEPTH_RANGE: f64 = 0.5;

impl PlanRequest<'_> {
    /// The scene that the options name, if the other options have a meaning for its kind.
    pub(super) fn source(&self, path: &Path) -> Result<Source> {
        let contents = match self.view.surface.kind {
            None => Contents::Splats {
                transfer: self.view.splats.transfer.clone(),
                light: self.view.splats.light,
                sh_degree: self.view.splats.sh_degree,
            },
            Some(SceneKind::Surface) => self.surface(path)?,
            Some(SceneKind::Texture) => {
                refuse("--as texture", &for_surfaces(self.view))?;
                Contents::Texture
            }
        };
        let path = path.to_owned();
        Ok(Source { path, contents })
    }

    fn surface(&self, path: &Path) -> Result<Contents> {
        let options = &self.view.surface;
        if options.flatten.is_some() {
            refuse("--flatten", &for_styles(self.view))?;
        } else if options.depth_image_from.is_some() {
            refuse("--depth-image-from", &for_styles(self.view))?;
        } else {
            refuse("--as surface", &self.for_splats())?;
            ensure!(
                self.engine != Engine::Exact,
                usage("--engine exact has no meaning with --as surface: use fixed or float")
            );
        }
        let of_height_fields = [
            (options.texture.is_some(), "--texture"),
            (options.spacing.is_some(), "--spacing"),
        ];
        if !is_height_field(path)
            && let Some(option) = first_given(&of_height_fields)
        {
            let message = format!("{option} needs a height field: give a .csv file as scene");
            return Err(usage(message));
        }
        let pose = |file: &PathBuf| pose_of(file, None, None);
        let pose = options.depth_image_from.as_ref().map(pose).transpose()?;
        let photograph = options.texture.clone();
        Ok(Contents::Surface {
            texture: photograph.map(|photograph| (photograph, options.coefficients)),
            spacing: options.spacing,
            flatten: options.flatten,
            depth_image: pose.map(|pose| pose.camera),
        })
    }

    /// How the scene is drawn.
    pub(super) fn technique(
        &self,
        source: &Source,
        scene: &AnyScene,
        camera: &Camera,
    ) -> Result<Technique> {
        match (scene, source.contents.flattening()) {
            (AnyScene::Splats(scene), _) => self.splats(scene, source.contents.has_samples()),
            (AnyScene::Surface { scene, .. }, Some(factor)) => {
                self.splats(&flattened(scene, camera, factor), false)
            }
            (AnyScene::Surface { scene, .. }, None) => {
                Ok(Technique::Surface(style(self.view, scene)))
            }
        }
    }

    /// Rules and method of splats; samples of a surface become points where they are closer together than pixels.
    fn splats(&self, scene: &Scene, are_samples: bool) -> Result<Technique> {
        let spheres = self
            .technique
            .is_some_and(|options| options.spheres.is_some());
        let usual = if spheres {
            Some(AntialiasChoice::None)
        } else {
            are_samples.then_some(AntialiasChoice::Swan)
        };
        let rules = rules(
            &self.view.splats,
            scene,
            self.view.splats.antialias.or(usual),
        )?;
        let method = self.method(scene, &rules, are_samples)?;
        let compositing = self.compositing;
        let name = match method {
            SplatMethod::Points(_) => "--points and --traversal stamp",
            SplatMethod::Sheets(_) => "--sheets",
            _ => "",
        };
        ensure!(
            name.is_empty() || compositing == Compositing::FrontToBack,
            usage(format!("{name} composite front to back only"))
        );
        ensure!(
            compositing != Compositing::XRay || !matches!(method, SplatMethod::DeepAlpha(_)),
            usage("--deep-alpha composites and does not sum: leave out --compositing x-ray")
        );
        Ok(Technique::Splats(SplatTechnique {
            rules,
            compositing,
            method,
        }))
    }

    fn method(&self, scene: &Scene, rules: &Rules, are_samples: bool) -> Result<SplatMethod> {
        let Some(options) = self.technique else {
            return Ok(SplatMethod::Composited);
        };
        let points = self.points(options, scene, rules, are_samples)?;
        if let Some(kind) = options.sheets {
            let thickness = options.sheet_thickness.unwrap_or_else(|| spacing(scene));
            ensure!(
                thickness > 0.0,
                usage("--sheets needs --sheet-thickness: the scene's splats have no size")
            );
            return Ok(SplatMethod::Sheets(SheetBuffers { kind, thickness }));
        }
        if let Some(representation) = options.deep_alpha {
            return Ok(SplatMethod::DeepAlpha(AlphaChannel {
                representation,
                bits: options.alpha_bits,
                rounding: options.alpha_rounding,
            }));
        }
        if let Some(exact_ellipse) = options.spheres {
            return Ok(SplatMethod::Spheres(Shape {
                exact_ellipse,
                index: options.sphere_index,
            }));
        }
        Ok(points.map_or(SplatMethod::Composited, SplatMethod::Points))
    }

    /// Points and stamps, which need distance scaling: it tells which samples are closer together than pixels.
    fn points(
        &self,
        options: &TechniqueOptions,
        scene: &Scene,
        rules: &Rules,
        are_samples: bool,
    ) -> Result<Option<Hybrid>> {
        let stamped = self.is_stamped();
        let requested = options.points.is_some() || stamped;
        let scaled = rules.spacing > 0.0 && rules.cutoff.is_finite();
        ensure!(
            !(stamped && options.is_another_method()),
            usage("--traversal stamp draws points: leave out --sheets, --deep-alpha and --spheres")
        );
        ensure!(
            scaled || !requested,
            usage("--points and --traversal stamp need --rules ewa and --antialias swan")
        );
        let chosen = requested || are_samples && scaled;
        if !chosen {
            return Ok(None);
        }
        let range = if are_samples {
            Some(warp::DEPTH_RANGE)
        } else {
            options.points.map(|_| DEPTH_RANGE)
        };
        Ok(Some(Hybrid {
            points: options.points.unwrap_or(Points::Auto),
            depth_range: range.map(|range| range * spacing(scene)),
            phase_bits: stamped.then_some(options.phase_bits),
        }))
    }

    /// Options about splats, which points of a surface are not.
    fn for_splats(&self) -> Vec<Given> {
        let view = self.view;
        vec![
            (view.splats.rules.is_some(), "--rules"),
            (view.splats.antialias.is_some(), "--antialias"),
            (view.splats.low_pass.is_some(), "--low-pass"),
            (view.splats.sh_degree.is_some(), "--sh-degree"),
            (view.splats.kernel != Kernel::Gaussian, "--kernel"),
            (self.is_stamped(), "--traversal stamp"),
            (
                self.has_method(),
                "--points, --sheets, --deep-alpha or --spheres",
            ),
        ]
    }
}

/// Whether an option is given, and its name.
type Given = (bool, &'static str);

/// Options about how a surface is drawn.
fn for_styles(view: &ViewOptions) -> Vec<Given> {
    let surface = &view.surface;
    vec![
        (surface.layers.is_some(), "--layers"),
        (surface.edges, "--edges"),
        (surface.z_threshold.is_some(), "--z-threshold"),
        (
            surface.cull_backfaces != Backfaces::Auto,
            "--cull-backfaces",
        ),
        (view.splats.light.is_some(), "--light"),
    ]
}

/// All options about points of a surface.
fn for_surfaces(view: &ViewOptions) -> Vec<Given> {
    let surface = &view.surface;
    let mut options = for_styles(view);
    options.extend([
        (surface.texture.is_some(), "--texture"),
        (surface.spacing.is_some(), "--spacing"),
        (surface.flatten.is_some(), "--flatten"),
        (surface.depth_image_from.is_some(), "--depth-image-from"),
    ]);
    options
}

/// Refuses options that have no meaning beside another one.
fn refuse(beside: &str, options: &[Given]) -> Result<()> {
    match first_given(options) {
        Some(option) => Err(usage(format!("{option} has no meaning with {beside}"))),
        None => Ok(()),
    }
}

fn first_given(options: &[Given]) -> Option<&'static str> {
    let given = options.iter().find(|(given, _)| *given);
    given.map(|(_, option)| *option)
}

/// The rules asked for, with the kernel and the protection against aliasing asked for, or else with that which the
/// scene was trained with.
fn rules(options: &SplatArgs, scene: &Scene, antialias: Option<AntialiasChoice>) -> Result<Rules> {
    let natural = scene.natural_rules;
    let rules = options.rules.unwrap_or(natural).with_kernel(options.kernel);
    let as_trained = natural.compensated && !rules.normalised;
    let variance = match options.low_pass {
        Some(variance) => variance,
        None if as_trained => natural.low_pass,
        None => rules.low_pass,
    };
    let usual = if as_trained {
        AntialiasChoice::Mip
    } else {
        AntialiasChoice::Ewa
    };
    let antialias = antialias.unwrap_or(usual).with(variance, || spacing(scene));
    let is_filtered = matches!(antialias, Antialias::Ewa(_) | Antialias::Mip(_));
    ensure!(
        is_filtered || options.low_pass.is_none(),
        usage("--low-pass has no meaning with --antialias none and swan: leave one of them out")
    );
    Ok(rules.with_antialias(antialias))
}

/// The style that the options and the scene ask for.
fn style(view: &ViewOptions, scene: &SurfaceScene) -> Style {
    let options = &view.surface;
    let threshold = options.z_threshold.unwrap_or(scene.usual_threshold());
    Style {
        buffer: options.layers.map_or(Buffer::Accumulation, Buffer::Layers),
        edge: options.edges.then_some(USUAL_EDGE),
        light: view
            .splats
            .light
            .or((!scene.coloured).then_some(USUAL_LIGHT)),
        cull_backfaces: culls_backfaces(options, scene),
        ..Style::opaque(threshold)
    }
}

/// As the options say, or else where the cloud's normals allow it. Of a body that one can see through the backs are
/// wanted.
fn culls_backfaces(options: &SurfaceArgs, scene: &SurfaceScene) -> bool {
    match options.cull_backfaces {
        Backfaces::On => true,
        Backfaces::Off => false,
        Backfaces::Auto => {
            let opaque = scene.points.iter().all(|point| point.opacity >= 1.0);
            opaque && is_closed_outwards(&scene.points)
        }
    }
}
