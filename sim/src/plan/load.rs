//! From a source to a scene of any kind.

use crate::camera::Camera;
use crate::framing::FramingInput;
use crate::memory::{self, TooLarge};
use crate::reference;
use crate::scene::points::height_field::{self, HeightField};
use crate::scene::points::{self, SurfaceScene};
use crate::scene::{self, LoadError, LoadOptions, Scene};
use crate::surface::Style;
use crate::texture::Texture;
use crate::texture::coefficients::Method;
use crate::texture::drape::drape;
use crate::texture::warp::{DepthImage, textured_plane};
use crate::vector::Vector;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Bytes of a splat or point beside the scene's own while it is drawn: 305 were measured for splats, 240 for points.
const DRAWN_BYTES: usize = 330;

/// A file (or stdin, or a scene's name), and what its contents are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The file, from the folder in which the command ran.
    pub path: PathBuf,
    /// What its contents are.
    #[serde(default)]
    pub contents: Contents,
}

/// What the contents of a file are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Contents {
    /// 3D Gaussians, or a volume's voxels.
    Splats {
        /// Transfer function of a volume.
        transfer: Option<PathBuf>,
        /// Direction towards the light that shades a volume.
        light: Option<Vector>,
        /// Spherical harmonics of higher degrees are left out.
        #[serde(default)]
        sh_degree: Option<u8>,
    },
    /// Points of a surface: a cloud, or a height field.
    Surface {
        /// Photograph over a height field, and how points get their colours from it.
        texture: Option<(PathBuf, Method)>,
        /// Distance of neighbouring heights, in units of height.
        spacing: Option<f64>,
        /// Points become volume kernels, their axis along the normal divided by this.
        flatten: Option<f64>,
        /// Points become the pixels of a depth image that this camera takes of them.
        depth_image: Option<Camera>,
    },
    /// A photograph, whose texels are samples on a plane two units long.
    Texture,
}

impl Default for Contents {
    /// Splats, a volume by its own transfer function.
    fn default() -> Contents {
        Contents::splats(None)
    }
}

impl Contents {
    /// Splats as they are, a volume by this transfer function.
    pub fn splats(transfer: Option<PathBuf>) -> Contents {
        Contents::Splats {
            transfer,
            light: None,
            sh_degree: None,
        }
    }

    /// Points of a surface as they are.
    pub fn surface() -> Contents {
        Contents::Surface {
            texture: None,
            spacing: None,
            flatten: None,
            depth_image: None,
        }
    }

    /// By what the axis along the normal is divided, where points become volume kernels.
    pub fn flattening(&self) -> Option<f64> {
        match self {
            Contents::Surface { flatten, .. } => *flatten,
            _ => None,
        }
    }

    /// Are they pixels of a depth image or texels, which are drawn as samples in space?
    pub fn has_samples(&self) -> bool {
        match self {
            Contents::Surface { depth_image, .. } => depth_image.is_some(),
            Contents::Texture => true,
            Contents::Splats { .. } => false,
        }
    }
}

/// A scene of either kind.
pub enum AnyScene {
    /// Volume splats.
    Splats(Scene),
    /// Points of a surface.
    Surface {
        /// The points.
        scene: SurfaceScene,
        /// Do they lie on a grid, with a direction that is up?
        is_height_field: bool,
    },
}

/// What came of a source.
pub struct LoadedScene {
    /// The scene.
    pub scene: AnyScene,
    /// What its file says that is drawn otherwise here, or what had to be made up.
    pub notes: Vec<String>,
    /// Seconds it took.
    pub seconds: f64,
}

impl Source {
    /// Splats, a volume by its own transfer function.
    pub fn splats(path: PathBuf) -> Source {
        let contents = Contents::default();
        Source { path, contents }
    }

    /// Reads the scene; `doing` is told of what takes long.
    pub fn load(&self, doing: &dyn Fn(String)) -> Result<LoadedScene> {
        let started = Instant::now();
        let (scene, notes) = match &self.contents {
            Contents::Splats {
                transfer,
                light,
                sh_degree,
            } => {
                let options = LoadOptions {
                    transfer: transfer.clone(),
                    light: *light,
                };
                let mut scene = scene::load(&self.path, &options)?;
                if let Some(degree) = sh_degree {
                    scene.limit_harmonics(*degree);
                }
                let notes = scene.notes.clone();
                (AnyScene::Splats(scene), notes)
            }
            Contents::Surface {
                texture,
                spacing,
                depth_image,
                ..
            } => {
                let scene = self.load_surface(texture.as_ref(), *spacing, doing)?;
                let notes = scene.notes.clone();
                let scene = match depth_image {
                    Some(camera) => {
                        let style = Style::opaque(scene.usual_threshold());
                        let drawing = reference::surface::draw(&scene, camera, &style);
                        let image = DepthImage::of_drawing(&drawing, camera);
                        AnyScene::Splats(image.samples(&scene.name))
                    }
                    None => AnyScene::Surface {
                        scene,
                        is_height_field: height_field::is_height_field(&self.path),
                    },
                };
                (scene, notes)
            }
            Contents::Texture => (AnyScene::Splats(self.load_texture()?), Vec::new()),
        };
        scene.room_to_draw()?;
        Ok(LoadedScene {
            scene,
            notes,
            seconds: started.elapsed().as_secs_f64(),
        })
    }

    /// The texels as samples on the plane z = 0, their first row in the north.
    fn load_texture(&self) -> Result<Scene> {
        let texture = Texture::load(&self.path)?;
        let [width, height] = [texture.width, texture.height].map(|side| side as f64);
        let unit = 2.0 / width.max(height);
        let [across, down] = [width * unit, height * unit];
        let corner = [-0.5 * across, 0.5 * down, 0.0];
        let axes = [[across, 0.0, 0.0], [0.0, -down, 0.0]];
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        Ok(textured_plane(&name, &texture, corner, axes))
    }

    fn load_surface(
        &self,
        texture: Option<&(PathBuf, Method)>,
        spacing: Option<f64>,
        doing: &dyn Fn(String),
    ) -> Result<SurfaceScene> {
        if !height_field::is_height_field(&self.path) {
            return Ok(points::load(&self.path)?);
        }
        let (field, name) = load_heights(&self.path, spacing)?;
        let Some((photograph, method)) = texture else {
            return Ok(field.scene(&name));
        };
        let texture = Texture::load(photograph)?;
        let shown = photograph.display().to_string();
        doing(format!("{} colours from {shown}", method.name()));
        let cutoff = Style::opaque(0.0).cutoff;
        drape(&field, &name, &texture, *method, cutoff).context(shown)
    }
}

/// A height field and its file's name.
fn load_heights(path: &Path, spacing: Option<f64>) -> Result<(HeightField, String), LoadError> {
    let field = HeightField::load(path, spacing.unwrap_or(height_field::USUAL_SPACING))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok((field, name.into_owned()))
}

/// A height field by its name, else splats, else points of a surface; the message of the splats' reader if it is
/// neither.
pub fn recognise(path: &Path, transfer: Option<PathBuf>) -> Result<LoadedScene> {
    let surface = |scene: SurfaceScene, is_height_field| LoadedScene {
        notes: scene.notes.clone(),
        scene: AnyScene::Surface {
            scene,
            is_height_field,
        },
        seconds: 0.0,
    };
    if height_field::is_height_field(path) {
        let (field, name) = load_heights(path, None)?;
        return Ok(surface(field.scene(&name), true));
    }
    let contents = Contents::splats(transfer);
    let path = path.to_owned();
    let source = Source { path, contents };
    match source.load(&|_| ()) {
        Ok(loaded) => Ok(loaded),
        Err(error) => match points::load(&source.path) {
            Ok(cloud) => Ok(surface(cloud, false)),
            // Of a file that holds nothing but points, their reader knows more.
            Err(cloud) if points::is_cloud(&source.path) => Err(cloud.into()),
            Err(_) => Err(error),
        },
    }
}

impl AnyScene {
    /// File name without folders.
    pub fn name(&self) -> &str {
        match self {
            AnyScene::Splats(scene) => &scene.name,
            AnyScene::Surface { scene, .. } => &scene.name,
        }
    }

    /// Refuses a scene that fits into memory while what drawing makes of it does not.
    fn room_to_draw(&self) -> Result<(), TooLarge> {
        let what = match self {
            AnyScene::Splats(_) => "splats",
            AnyScene::Surface { .. } => "points",
        };
        let what = format!("drawing {} {what}", self.len());
        memory::room_for_records(self.len() as u64, DRAWN_BYTES, &what)
    }

    /// How many splats or points it has.
    pub fn len(&self) -> usize {
        match self {
            AnyScene::Splats(scene) => scene.splats.len(),
            AnyScene::Surface { scene, .. } => scene.points.len(),
        }
    }

    /// Has it none?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The direction that is up in it.
    pub fn up(&self) -> Vector {
        match self {
            AnyScene::Splats(scene) => scene.up,
            AnyScene::Surface { scene, .. } => scene.up,
        }
    }

    /// Its splats, unless it is a surface.
    pub fn splats(&self) -> Option<&Scene> {
        match self {
            AnyScene::Splats(scene) => Some(scene),
            AnyScene::Surface { .. } => None,
        }
    }

    /// How it is seen whole.
    pub fn frame(&self, up: Option<Vector>) -> FramingInput {
        match self {
            AnyScene::Splats(scene) => FramingInput::of_scene(scene, up),
            AnyScene::Surface {
                scene,
                is_height_field,
            } => FramingInput::of_surface(scene, *is_height_field, up),
        }
    }
}
