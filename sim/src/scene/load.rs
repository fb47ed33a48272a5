//! From a path on the command line to a scene.
//!
//! Besides files, `demo`, `random:COUNT[:SEED]` and `deep-stack` are scenes; `./demo` is a file of that name.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::{LoadError, Problem};
use super::{Scene, nrrd, ply, shade, splat_file, spz, synthetic, transfer::Transfer};
use crate::input;

/// The embedded volume, see `sim/assets/README.md`.
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
    if shown == "demo" {
        return demo_with(options);
    }
    let scene = if synthetic::is_synthetic(&shown) {
        refuse_volume_options(options).and_then(|()| load_synthetic(&shown))
    } else {
        read_file(path).and_then(|bytes| dispatch(&bytes, path, options))
    };
    scene.map_err(|problem| problem.of(shown))
}

/// The embedded demo volume, exactly as its file would load.
pub fn demo() -> Result<Scene, LoadError> {
    demo_with(&LoadOptions::default())
}

fn demo_with(options: &LoadOptions) -> Result<Scene, LoadError> {
    dispatch(DEMO, Path::new(DEMO_NAME), options).map_err(|problem| problem.of("demo"))
}

/// A regular file's bytes. Pipes and devices are refused: they may never end.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, Problem> {
    if !fs::metadata(path)?.is_file() {
        return Err(Problem::NotAFile);
    }
    Ok(fs::read(path)?)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Ply,
    Splat,
    Spz,
    Nrrd,
}

/// The extension decides; a file without a known one is recognised by its first bytes.
fn recognise(bytes: &[u8], path: &Path) -> Result<Format, Problem> {
    let extension = path
        .extension()
        .and_then(|extension| extension.to_str())
        .map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("ply") => Ok(Format::Ply),
        Some("splat") => Ok(Format::Splat),
        Some("spz") => Ok(Format::Spz),
        Some("nrrd" | "nhdr") => Ok(Format::Nrrd),
        _ if bytes.starts_with(b"ply") => Ok(Format::Ply),
        _ if bytes.starts_with(b"NRRD") => Ok(Format::Nrrd),
        _ if bytes.starts_with(&[0x1f, 0x8b]) => Ok(Format::Spz),
        _ => Err(Problem::UnknownFormat),
    }
}

fn dispatch(bytes: &[u8], path: &Path, options: &LoadOptions) -> Result<Scene, Problem> {
    let format = recognise(bytes, path)?;
    if format != Format::Nrrd {
        refuse_volume_options(options)?;
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match format {
        Format::Ply => ply::load(bytes, &name),
        Format::Splat => splat_file::load(bytes, &name),
        Format::Spz => spz::load(bytes, &name),
        Format::Nrrd => load_volume(bytes, path, &name, options),
    }
}

fn load_volume(
    bytes: &[u8],
    path: &Path,
    name: &str,
    options: &LoadOptions,
) -> Result<Scene, Problem> {
    let volume = nrrd::load(bytes, path.parent())?;
    let transfer = match &options.transfer {
        Some(file) => read_transfer(file)?,
        None => built_in_transfer(&volume, path)?,
    };
    shade::shade(
        &volume,
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
        .map_err(Problem::Unreadable)
        .map_err(named)?;
    Transfer::from_toml(&text).map_err(named)
}

fn built_in_transfer(volume: &nrrd::Volume, path: &Path) -> Result<Transfer, Problem> {
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
        (Some(count), Ok(seed)) => Ok(synthetic::random_gaussians(count, seed, 1.0)),
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
