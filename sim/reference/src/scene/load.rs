//! From a path on the command line to a scene.
//!
//! Besides files, `demo`, `random:COUNT[:SEED]` and `deep-stack` are scenes; `./demo` is a file of that name.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::error::{LoadError, Problem, unreadable};
use super::file::read_file;
use super::volume::{self, Volume};
use super::{
    Scene, gaussian, gltf, ksplat, nrrd, ply, points, shade, sog, splat_file, spz, synthetic,
    transfer::Transfer,
};
use crate::input;
use crate::rules::Rules;
use anyhow::{Context, anyhow, bail, ensure};

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

/// Loads a scene file or one of the named scenes.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    let shown = path.display().to_string();
    if let Some((iteration, file)) = trained_folder(path) {
        let mut scene = load(&file, options)?;
        let name = path.file_name().unwrap_or_default();
        scene.name = name.to_string_lossy().into_owned();
        let note = format!("a trainer's folder, drawn as of iteration {iteration}");
        scene.notes.push(note);
        return Ok(scene);
    }
    if shown == "demo" {
        return demo_with(options);
    }
    let coloured = |scene: Result<Scene, Problem>| {
        refuse_volume_options(options)?;
        scene.map(noted)
    };
    let scene = if synthetic::is_synthetic(&shown) {
        coloured(load_synthetic(&shown))
    } else if let Some(folder) = sog_folder(path) {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        coloured(sog::load_folder(folder, &name))
    } else {
        read_file(path).and_then(|bytes| dispatch(&bytes, path, options))
    };
    scene.map_err(LoadError::about(shown))
}

/// The scene, and that it was trained antialiased if it says so.
fn noted(mut scene: Scene) -> Scene {
    let Rules {
        compensated,
        low_pass,
        ..
    } = scene.natural_rules;
    let note = compensated.then(|| {
        format!("trained antialiased: opacities are compensated for a low-pass filter of {low_pass} square pixels (--antialias ewa draws it without)")
    });
    scene.notes.extend(note);
    scene
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
    demo_with(&LoadOptions::default())
}

fn demo_with(options: &LoadOptions) -> Result<Scene, LoadError> {
    dispatch(DEMO, Path::new(DEMO_NAME), options).map_err(LoadError::about("demo"))
}

/// What reads a format.
#[derive(Clone, Copy)]
enum SceneReader {
    /// Trained Gaussians, from the file's bytes and the scene's name.
    Gaussians(fn(&[u8], &str) -> Result<Scene, Problem>),
    Gltf,
    /// From the file's bytes and the folder that it lies in.
    Grid(fn(&[u8], Option<&Path>) -> Result<Volume, Problem>),
}

use SceneReader::{Gaussians, Gltf, Grid};

/// Extensions, first bytes where they tell, and the reader.
type SceneFormat = (
    &'static [&'static str],
    &'static [&'static [u8]],
    SceneReader,
);

const FORMATS: [SceneFormat; 10] = [
    (&["ply"], &[b"ply"], Gaussians(ply::load)),
    (&["splat"], &[], Gaussians(splat_file::load)),
    (&["spz"], &[&[0x1f, 0x8b], b"NGSP"], Gaussians(spz::load)),
    (&["sog"], &[b"PK\x03\x04"], Gaussians(sog::load_bundle)),
    (&["ksplat"], &[], Gaussians(ksplat::load)),
    (&["glb", "gltf"], &[b"glTF"], Gltf),
    (&["nrrd", "nhdr"], &[b"NRRD"], Grid(nrrd::load)),
    (&["nii"], &[], NIFTI),
    (&["mhd", "mha"], &[], Grid(volume::meta_image::load)),
    (&["vti"], &[], Grid(|bytes, _| vti(bytes))),
];

const NIFTI: SceneReader = Grid(|bytes, _| volume::nifti::load(bytes));

#[cfg(feature = "vti")]
use super::volume::vti::load as vti;

#[cfg(not(feature = "vti"))]
fn vti(_: &[u8]) -> Result<Volume, Problem> {
    Err(super::error::without("vti"))
}

/// The extension decides; a file without a known one is recognised by its first bytes.
fn recognise(bytes: &[u8], path: &Path) -> Result<SceneReader, Problem> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.to_ascii_lowercase();
    let extension = match Path::new(&name).extension() {
        // A packed NIfTI file has two extensions, of which the last alone says nothing.
        _ if name.ends_with(".nii.gz") => "nii",
        extension => extension.and_then(OsStr::to_str).unwrap_or_default(),
    };
    let by_name = FORMATS
        .iter()
        .find(|(known, ..)| known.contains(&extension));
    let begins = |magic: &&[u8]| bytes.starts_with(magic);
    let by_bytes = || {
        FORMATS
            .iter()
            .find(|(_, magics, _)| magics.iter().any(begins))
    };
    match by_name.or_else(by_bytes) {
        Some((.., reader)) => Ok(*reader),
        None if volume::nifti::is_nifti(bytes) => Ok(NIFTI),
        None if points::is_cloud(path) => bail!("is a file of points; add --as surface"),
        None => bail!(UNKNOWN_FORMAT),
    }
}

/// Of what has neither a known extension nor known first bytes.
const UNKNOWN_FORMAT: &str = "is of no known format; expected .ply, .splat, .spz, .sog (or a folder with its meta.json), .ksplat, .glb, .gltf, \
     .nrrd, .nhdr, .nii, .nii.gz, .mhd, .mha or .vti, a point cloud (.ply, .xyz, .obj, .las, .laz) or a height field (.csv) with --as surface \
     (or one of 'demo', 'random:COUNT[:SEED]', 'deep-stack')";

fn dispatch(bytes: &[u8], path: &Path, options: &LoadOptions) -> Result<Scene, Problem> {
    let reader = recognise(bytes, path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if !matches!(reader, Grid(_)) {
        refuse_volume_options(options)?;
    }
    match reader {
        Gaussians(read) => read(bytes, &name).map(noted),
        Gltf => gltf::load(bytes, path.parent(), &name),
        Grid(read) => load_volume(&read(bytes, path.parent())?, path, &name, options),
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
    let light = options.light.unwrap_or(shade::DEFAULT_LIGHT);
    shade::shade(volume, &transfer, light, name)
}

fn read_transfer(file: &Path) -> Result<Transfer, Problem> {
    let text = input::text(file, input::SETTINGS).map_err(unreadable);
    let transfer = text.and_then(|text| Transfer::from_toml(&text));
    transfer.map_err(|problem| {
        let file = file.display();
        anyhow!("transfer function {file}: {problem}; give a transfer function as TOML")
    })
}

fn built_in_transfer(volume: &Volume, path: &Path) -> Result<Transfer, Problem> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if let Some(preset) = Transfer::preset(&stem) {
        return Ok(preset);
    }
    let (least, greatest) = volume.range().context(
        "volume data: no value is finite; check the type and the byte order in the header",
    )?;
    let [x, y, z] = volume.spacings;
    Ok(Transfer::ramp(least, greatest, (x * y * z).cbrt()))
}

fn refuse_volume_options(options: &LoadOptions) -> Result<(), Problem> {
    ensure!(
        options.transfer.is_none() && options.light.is_none(),
        "transfer function or light: this scene is no volume; \
         leave these options out: its colours are stored"
    );
    Ok(())
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
        _ => bail!(
            "random scene: '{arguments}' is not COUNT or COUNT:SEED; \
             write for instance random:10000:1, with at most {} splats",
            synthetic::MAX_COUNT
        ),
    }
}
