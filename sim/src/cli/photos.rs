//! `compare --photos`: what is drawn against photographs, view by view, as trained scenes are judged.
//!
//! Views are held out as the trainers do: sorted by name, every eighth one. A lens' distortion is taken out of the
//! photograph. One of another size than its camera's decides: the camera is scaled to it (the trainers' `images_4`).
//! Its alpha channel puts it on the background; a mask multiplies photograph and pictures.

use super::args::CompareOptions;
use super::compare::against_reference;
use super::output::{Outputs, create_folder, write, write_json, write_json_if};
use super::resolve::{NamedFrame, PlanRequest};
use super::say::{print_error, print_result, usage, warn};
use super::view_args::PathOptions;
use crate::cameras;
use crate::cameras::lens::{Distortion, Lens};
use crate::design::DesignChoice;
use crate::metrics::photo_error;
use crate::picture::{Backdrop, Picture};
use crate::plan::draw::on_threads;
use crate::plan::{DesignVariant, Engine, Prepared};
use crate::progress::ProgressMeter;
use crate::report::photos::{Drawn, FILES, PhotoReport, PhotoRow, Shown, page};
use crate::texture::image::{load_photograph, undistorted};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Extensions of photographs, for names without one.
pub const EXTENSIONS: [&str; 6] = ["png", "jpg", "jpeg", "PNG", "JPG", "JPEG"];

/// Which views are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// All.
    All,
    /// Every so manieth, from the first on.
    Test(usize),
    /// All others.
    Train(usize),
}

/// The trainers' hold: every eighth view.
const HOLD: usize = 8;

impl FromStr for Split {
    type Err = String;

    fn from_str(text: &str) -> Result<Split, String> {
        match (text, text.parse()) {
            ("all", _) => Ok(Split::All),
            ("test", _) => Ok(Split::Test(HOLD)),
            ("train", _) => Ok(Split::Train(HOLD)),
            (_, Ok(every @ 1..=1_000_000)) => Ok(Split::Test(every)),
            _ => Err("expected test, train, all, or N for every Nth view".to_owned()),
        }
    }
}

impl Split {
    fn holds(self, place: usize) -> bool {
        match self {
            Split::All => true,
            Split::Test(every) => place.is_multiple_of(every),
            Split::Train(every) => !place.is_multiple_of(every),
        }
    }

    fn words(self) -> String {
        match self {
            Split::All => "all views".to_owned(),
            Split::Test(every) => format!("every view of {every} from the first on, by name"),
            Split::Train(every) => format!("all but every view of {every}, by name"),
        }
    }
}

/// A view with its photograph.
struct View {
    name: String,
    prepared: Prepared,
    photograph: Picture,
    file: PathBuf,
    mask: Option<Picture>,
}

pub fn run(options: &CompareOptions, photos: &Path, outputs: Outputs) -> Result<()> {
    let drawing = &options.drawing;
    let outputs = outputs.folder(Some(&options.output), &FILES)?;
    let (views, lenses) = chosen_views(options)?;
    outputs.spare_inputs()?;
    let Backdrop::Colour(background) = drawing.backdrop() else {
        bail!("photographs are compared on a colour");
    };
    let (progress, mut notes) = (ProgressMeter::new(views.len()), BTreeSet::new());
    let mut rows = Vec::with_capacity(views.len());
    let mut shown = Vec::with_capacity(views.len());
    for (number, frame) in (1..).zip(views) {
        progress.doing(&frame.name);
        let view = with_photograph(frame, photos, options, &lenses, &mut notes)?;
        let drawn = on_threads(drawing.effort().threads, || draw(&view, options))??;
        let on_background = |picture: &Picture| seen(&picture.on(background), view.mask.as_ref());
        let photograph = on_background(&view.photograph);
        let drawn: Vec<(String, Picture)> = drawn
            .iter()
            .map(|(engine, picture)| (engine.clone(), on_background(picture)))
            .collect();
        let pictures = Shown::new(&photograph, &drawn)?;
        let folder = options.output.join(format!("view-{number:04}"));
        create_folder(&folder)?;
        for (name, bytes) in pictures.files()? {
            write(&folder.join(name), bytes)?;
        }
        let judged = |(engine, picture): &(String, Picture)| {
            let error = photo_error(picture, &photograph);
            let error = error.with_context(|| format!("'{}'", view.file.display()))?;
            let engine = engine.clone();
            Ok(Drawn { engine, error })
        };
        rows.push(PhotoRow {
            name: view.name.clone(),
            photograph: view.file.clone(),
            size: [photograph.width, photograph.height],
            folder: format!("view-{number:04}"),
            drawn: drawn.iter().map(judged).collect::<Result<_>>()?,
        });
        shown.push(pictures.small()?);
        progress.advance();
    }
    drop(progress);
    for note in notes {
        print_error(&format!("{note}\n"));
    }
    let report = PhotoReport::new(options.photographs.split.words(), rows)?;
    let [json, html] = FILES.map(|file| options.output.join(file));
    write_json(&json, &report)?;
    write_json_if(drawing.json.as_ref(), &report)?;
    write(&html, page(&report, &shown))?;
    print_result(&format!("{}{}\n", report.text(), html.display()))
}

/// The views of the split, in the order of their names.
fn chosen_views(options: &CompareOptions) -> Result<(Vec<NamedFrame>, BTreeMap<String, Lens>)> {
    let cameras = options.view.camera.file.clone();
    let path = PathOptions {
        camera_path: cameras.or_else(|| options.path.camera_path.clone()),
        turntable: None,
    };
    let Some(file) = &path.camera_path else {
        let message = "--photos needs --camera: the COLMAP folder, transforms.json or cameras.json of the photographs";
        return Err(usage(message));
    };
    // Key frames have no lenses.
    let poses = cameras::load(file, None).unwrap_or_default();
    let lenses = poses
        .into_iter()
        .filter_map(|pose| Some((pose.name, pose.lens?)));
    let request = PlanRequest::drawing(&options.view, &options.drawing).on(&options.machine);
    let mut frames = request.along(&path).frames()?;
    frames.sort_by(|a, b| a.name.cmp(&b.name));
    let views: Vec<NamedFrame> = (0..)
        .zip(frames)
        .filter(|(place, _)| options.photographs.split.holds(*place))
        .map(|(_, frame)| frame)
        .collect();
    ensure!(!views.is_empty(), "--split leaves no view");
    Ok((views, lenses.collect()))
}

/// The view with its photograph, whose size the camera takes.
fn with_photograph(
    frame: NamedFrame,
    photos: &Path,
    options: &CompareOptions,
    lenses: &BTreeMap<String, Lens>,
    notes: &mut BTreeSet<String>,
) -> Result<View> {
    let NamedFrame { name, prepared } = frame;
    let scene = format!("{}, ", prepared.scene.name());
    let name = name.strip_prefix(&scene).unwrap_or(&name).to_owned();
    let file = photograph_of(photos, &name)?;
    let loaded = load_photograph(&file)?;
    let lens = lenses.get(&name);
    let lens = lens.filter(|lens| lens.distortion != Distortion::default());
    let through_pinhole = |picture: Picture| match lens {
        Some(lens) => undistorted(&picture, lens),
        None => picture,
    };
    let mut mask = None;
    if lens.is_some() {
        notes.insert(
            "photographs are undistorted to pinholes; what they do not show counts in no picture"
                .to_owned(),
        );
        // What of the undistorted picture is there: white, or black.
        let mut shown = through_pinhole(loaded.on([0.0; 3]));
        let pixels = shown.pixels.iter_mut();
        pixels.for_each(|pixel| *pixel = [pixel[3]; 4]);
        mask = Some(shown);
    }
    let photograph = through_pinhole(loaded);
    let size = [photograph.width, photograph.height];
    let mut prepared = prepared;
    let camera = &prepared.plan.camera;
    if size != [camera.width, camera.height] {
        notes.insert(format!(
            "photographs of {}x{} decide over cameras of {}x{}: these are scaled",
            size[0], size[1], camera.width, camera.height
        ));
        let camera = camera.resized(size[0], size[1])?;
        prepared = prepared.seen_by(camera);
    }
    against_reference(&mut prepared)?;
    warn(&prepared.warnings);
    if let Some(folder) = &options.photographs.masks {
        let given = through_pinhole(load_photograph(&photograph_of(folder, &name)?)?);
        ensure!(
            [given.width, given.height] == size,
            "the mask of '{name}' has {}x{} pixels and its photograph {}x{}: scale the masks",
            given.width,
            given.height,
            size[0],
            size[1]
        );
        // Both masks, or the one there is.
        mask = Some(seen(&given, mask.as_ref()));
    }
    Ok(View {
        name,
        prepared,
        photograph,
        file,
        mask,
    })
}

/// The file of a view: by its name, with the usual extensions, and by the last part of its name.
fn photograph_of(folder: &Path, name: &str) -> Result<PathBuf> {
    let last = Path::new(name).file_name().map(PathBuf::from);
    let names = [Some(PathBuf::from(name)), last];
    for name in names.into_iter().flatten() {
        let given = folder.join(&name);
        let with = |extension: &&str| folder.join(format!("{}.{extension}", name.display()));
        let others = EXTENSIONS
            .iter()
            .flat_map(|extension| [with(extension), given.with_extension(extension)]);
        let mut found = std::iter::once(given.clone()).chain(others);
        if let Some(file) = found.find(|file| file.is_file()) {
            return Ok(file);
        }
    }
    let message = format!(
        "'{}' holds no picture of the view '{name}' (.png, .jpg): give the folder of the photographs that belong to --camera",
        folder.display()
    );
    Err(anyhow!(message))
}

/// By whom a view is drawn: the reference, the design, the other named designs, and the formats.
fn draw(view: &View, options: &CompareOptions) -> Result<Vec<(String, Picture)>> {
    let prepared = &view.prepared;
    let reference = prepared.plan.reference.unwrap_or(Engine::Float);
    let by = |engine: Engine| -> Result<(String, Picture)> {
        let drawing = prepared.draw_reference(engine, &|_, _| ())?;
        Ok((engine.name().to_owned(), drawing.picture))
    };
    let fixed = |entry: &DesignVariant| -> Result<(String, Picture)> {
        let picture = prepared.draw_fixed(entry)?.picture;
        Ok((entry.design.name.clone(), picture))
    };
    let chosen = &prepared.plan.entry;
    let mut drawn = vec![by(reference)?, fixed(chosen)?];
    let others = DesignChoice::all().into_iter();
    for design in others.filter(|design| !options.only && *design != chosen.design) {
        drawn.push(fixed(&DesignVariant::new(design, None))?);
    }
    if options.formats {
        for engine in Engine::FORMATS {
            drawn.push(by(engine)?);
        }
    }
    Ok(drawn)
}

/// The picture times the mask, which is its red channel.
fn seen(picture: &Picture, mask: Option<&Picture>) -> Picture {
    let mut picture = picture.clone();
    let masks = mask.iter().flat_map(|mask| &mask.pixels);
    for (pixel, mask) in picture.pixels.iter_mut().zip(masks) {
        for channel in &mut pixel[..3] {
            *channel *= mask[0];
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_are_the_trainers() {
        let split: Split = "test".parse().unwrap();
        let held: Vec<usize> = (0..20).filter(|place| split.holds(*place)).collect();
        assert_eq!(held, [0, 8, 16]);
        let train: Split = "train".parse().unwrap();
        assert!((0..20).all(|place| split.holds(place) != train.holds(place)));
        assert_eq!("4".parse(), Ok(Split::Test(4)));
        assert!("0".parse::<Split>().is_err() && "most".parse::<Split>().is_err());
    }
}
