//! From a path on the command line to a scene.
//!
//! Besides files, `demo`, `random:COUNT[:SEED]` and `deep-stack` are scenes; `./demo` is a file of that name.

use std::path::{Path, PathBuf};

use super::error::{LoadError, Problem};
use super::file::read_file;
use super::volume::{self, Noted, Volume};
use super::{
    Scene, gaussian, gltf, ksplat, nrrd, ply, points, shade, sog, splat_file, spz, synthetic,
    transfer::Transfer,
};
use crate::input;
use crate::rules::Rules;

/// The embedded volume, see `sim/reference/assets/README.md`.
const DEMO: &[u8] = include_bytes!("../../assets/brainsmall.nrrd");
const DEMO_NAME: &str = "brainsmall.nhdr";

/// How to turn a file into splats.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// A transfer function (TOML) for a volume instead of the built-in one.
    pub transfer: Option<PathBuf>,
    /// Direction towards the light for a volume instead of [`shade::DEFAULT_LIGHT`].
    pub light: Option<[f64; 3]>,
}

/// A scene, and what its file says that is drawn otherwise here.
pub type Loaded = (Scene, Vec<String>);

/// Loads a scene file or one of the named scenes.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    load_with_notes(path, options).map(|(scene, _)| scene)
}

/// The same with notes for the user.
pub fn load_with_notes(path: &Path, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let shown = path.display().to_string();
    if let Some((iteration, file)) = trained_folder(path) {
        let (mut scene, mut notes) = load_with_notes(&file, options)?;
        let name = path.file_name().unwrap_or_default();
        scene.name = name.to_string_lossy().into_owned();
        notes.push(format!(
            "a trainer's folder, drawn as of iteration {iteration}"
        ));
        return Ok((scene, notes));
    }
    if shown == "demo" {
        return demo_with(options);
    }
    let scene = if synthetic::is_synthetic(&shown) {
        refuse_volume_options(options)
            .and_then(|()| load_synthetic(&shown))
            .map(noted)
    } else if let Some(folder) = sog_folder(path) {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        refuse_volume_options(options)
            .and_then(|()| sog::load_folder(folder, &name))
            .map(noted)
    } else {
        read_file(path).and_then(|bytes| dispatch(&bytes, path, options))
    };
    scene.map_err(|problem| problem.of(shown))
}

/// The scene, and that it was trained antialiased if it says so.
fn noted(scene: Scene) -> Loaded {
    let Rules {
        compensated,
        low_pass,
        ..
    } = scene.natural_rules;
    let note = compensated.then(|| {
        format!("trained antialiased: opacities are compensated for a low-pass filter of {low_pass} square pixels (--antialias ewa draws it without)")
    });
    (scene, note.into_iter().collect())
}

/// The last iteration of a trainer's output folder, and its file: `point_cloud/iteration_N/point_cloud.ply`.
fn trained_folder(path: &Path) -> Option<(u64, PathBuf)> {
    let entries = std::fs::read_dir(path.join("point_cloud")).ok()?;
    let iteration = |entry: std::io::Result<std::fs::DirEntry>| {
        let entry = entry.ok()?;
        let name = entry.file_name();
        let number = name.to_str()?.strip_prefix("iteration_")?.parse().ok()?;
        let file = entry.path().join("point_cloud.ply");
        file.is_file().then_some((number, file))
    };
    entries.filter_map(iteration).max()
}

/// The folder of an unpacked SOG scene, which may be named itself or by its meta.json.
fn sog_folder(path: &Path) -> Option<&Path> {
    if path.is_dir() {
        return path.join(sog::META).is_file().then_some(path);
    }
    path.parent().filter(|_| path.ends_with(sog::META))
}

/// The embedded demo volume, exactly as its file would load.
pub fn demo() -> Result<Scene, LoadError> {
    demo_with(&LoadOptions::default()).map(|(scene, _)| scene)
}

fn demo_with(options: &LoadOptions) -> Result<Loaded, LoadError> {
    dispatch(DEMO, Path::new(DEMO_NAME), options).map_err(|problem| problem.of("demo"))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SceneFormat {
    Ply,
    Splat,
    Spz,
    Sog,
    Ksplat,
    Gltf,
    Volume(VolumeFormat),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum VolumeFormat {
    Nrrd,
    Nifti,
    MetaImage,
    Vti,
}

/// A packed NIfTI file has two extensions, of which the last alone says nothing.
fn is_packed_nifti(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.to_ascii_lowercase().ends_with(".nii.gz")
}

/// The extension decides; a file without a known one is recognised by its first bytes.
fn recognise(bytes: &[u8], path: &Path) -> Result<SceneFormat, Problem> {
    let extension = path
        .extension()
        .and_then(|extension| extension.to_str())
        .map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("ply") => Ok(SceneFormat::Ply),
        Some("splat") => Ok(SceneFormat::Splat),
        Some("spz") => Ok(SceneFormat::Spz),
        Some("sog") => Ok(SceneFormat::Sog),
        Some("ksplat") => Ok(SceneFormat::Ksplat),
        Some("glb" | "gltf") => Ok(SceneFormat::Gltf),
        Some("nrrd" | "nhdr") => Ok(SceneFormat::Volume(VolumeFormat::Nrrd)),
        Some("nii") => Ok(SceneFormat::Volume(VolumeFormat::Nifti)),
        Some("mhd" | "mha") => Ok(SceneFormat::Volume(VolumeFormat::MetaImage)),
        Some("vti") => Ok(SceneFormat::Volume(VolumeFormat::Vti)),
        _ if is_packed_nifti(path) => Ok(SceneFormat::Volume(VolumeFormat::Nifti)),
        _ if bytes.starts_with(b"ply") => Ok(SceneFormat::Ply),
        _ if bytes.starts_with(b"NRRD") => Ok(SceneFormat::Volume(VolumeFormat::Nrrd)),
        _ if volume::nifti::is_nifti(bytes) => Ok(SceneFormat::Volume(VolumeFormat::Nifti)),
        _ if bytes.starts_with(&[0x1f, 0x8b]) || bytes.starts_with(b"NGSP") => Ok(SceneFormat::Spz),
        _ if bytes.starts_with(b"PK\x03\x04") => Ok(SceneFormat::Sog),
        _ if bytes.starts_with(b"glTF") => Ok(SceneFormat::Gltf),
        _ if points::is_cloud(path) => {
            Err(Problem("is a file of points; add --as surface".to_owned()))
        }
        _ => Err(Problem(UNKNOWN_FORMAT.to_owned())),
    }
}

/// Of what has neither a known extension nor known first bytes.
const UNKNOWN_FORMAT: &str = "is of no known format; expected .ply, .splat, .spz, .sog (or a folder with its meta.json), .ksplat, .glb, .gltf, \
     .nrrd, .nhdr, .nii, .nii.gz, .mhd, .mha or .vti, a point cloud (.ply, .xyz, .obj, .las, .laz) or a height field (.csv) with --as surface \
     (or one of 'demo', 'random:COUNT[:SEED]', 'deep-stack')";

fn dispatch(bytes: &[u8], path: &Path, options: &LoadOptions) -> Result<Loaded, Problem> {
    let format = recognise(bytes, path)?;
    if !matches!(format, SceneFormat::Volume(_)) {
        refuse_volume_options(options)?;
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let scene = match format {
        SceneFormat::Gltf => return gltf::load(bytes, path.parent(), &name),
        SceneFormat::Ply => ply::load(bytes, &name),
        SceneFormat::Splat => splat_file::load(bytes, &name),
        SceneFormat::Spz => spz::load(bytes, &name),
        SceneFormat::Sog => sog::load_bundle(bytes, &name),
        SceneFormat::Ksplat => ksplat::load(bytes, &name),
        SceneFormat::Volume(format) => {
            let (volume, notes) = read_volume(format, bytes, path)?;
            return Ok((load_volume(&volume, path, &name, options)?, notes));
        }
    };
    scene.map(noted)
}

fn read_volume(format: VolumeFormat, bytes: &[u8], path: &Path) -> Result<Noted, Problem> {
    match format {
        VolumeFormat::Nrrd => Ok((nrrd::load(bytes, path.parent())?, Vec::new())),
        VolumeFormat::Nifti => volume::nifti::load(bytes),
        VolumeFormat::MetaImage => volume::meta_image::load(bytes, path.parent()),
        #[cfg(feature = "vti")]
        VolumeFormat::Vti => volume::vti::load(bytes),
        #[cfg(not(feature = "vti"))]
        VolumeFormat::Vti => Err(Problem::without("vti")),
    }
}

fn load_volume(
    volume: &Volume,
    path: &Path,
    name: &str,
    options: &LoadOptions,
) -> Result<Scene, Problem> {
    let transfer = match &options.transfer {
        Some(file) => read_transfer(file)?,
        None => built_in_transfer(volume, path)?,
    };
    shade::shade(
        volume,
        &transfer,
        options.light.unwrap_or(shade::DEFAULT_LIGHT),
        name,
    )
}

fn read_transfer(file: &Path) -> Result<Transfer, Problem> {
    let named = |problem: Problem| {
        let fix = "give a transfer function as TOML";
        Problem::malformed(
            format!("transfer function {}", file.display()),
            problem.to_string(),
            fix,
        )
    };
    let text = input::text(file, input::SETTINGS)
        .map_err(Problem::from)
        .map_err(named)?;
    Transfer::from_toml(&text).map_err(named)
}

fn built_in_transfer(volume: &Volume, path: &Path) -> Result<Transfer, Problem> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if let Some(preset) = Transfer::preset(&stem) {
        return Ok(preset);
    }
    let (least, greatest) = volume.range().ok_or_else(|| {
        Problem::malformed(
            "volume data",
            "no value is finite",
            "check the type and the byte order in the header",
        )
    })?;
    let [x, y, z] = volume.spacings;
    Ok(Transfer::ramp(least, greatest, (x * y * z).cbrt()))
}

fn refuse_volume_options(options: &LoadOptions) -> Result<(), Problem> {
    match options {
        LoadOptions {
            transfer: None,
            light: None,
        } => Ok(()),
        _ => Err(Problem::malformed(
            "transfer function or light",
            "this scene is no volume",
            "leave these options out: its colours are stored",
        )),
    }
}

/// `random:COUNT[:SEED]` or `deep-stack`.
fn load_synthetic(name: &str) -> Result<Scene, Problem> {
    let Some(arguments) = name.strip_prefix("random:") else {
        return Ok(synthetic::deep_stack(1));
    };
    let (count, seed) = arguments.split_once(':').unwrap_or((arguments, "1"));
    let count = count
        .parse()
        .ok()
        .filter(|count| (1..=synthetic::MAX_COUNT).contains(count));
    match (count, seed.parse()) {
        (Some(count), Ok(seed)) => {
            gaussian::room_for(0, count as u64, 0)?;
            Ok(synthetic::random_gaussians(count, seed, 1.0))
        }
        _ => Err(Problem::malformed(
            "random scene",
            format!("'{arguments}' is not COUNT or COUNT:SEED"),
            format!(
                "write for instance random:10000:1, with at most {} splats",
                synthetic::MAX_COUNT
            ),
        )),
    }
}
