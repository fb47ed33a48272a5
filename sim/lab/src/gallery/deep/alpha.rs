//! The deep alpha channel: the sweep with its plot and the width rule, and two deep scenes.

use super::{Group, exhibit, plot, standard24};
use crate::gallery::Exhibit;
use crate::study::deep::{
    LOG2_ALPHAS, REPRESENTATIONS, ROUNDINGS, Stack, csv, measured_width, representation_name,
    rounding_name, rule_width, sweep,
};
use splatline::blend::deep::{Channel, ChannelRounding, Representation};
use splatline_sim::camera::Camera;
use splatline_sim::fixed::{self, Options};
use splatline_sim::metrics::{CompareError, compare};
use splatline_sim::picture::Picture;
use splatline_sim::reference::compositor::ScreenSplat;
use splatline_sim::reference::float;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{self, LoadOptions, Scene, synthetic};
use std::fmt::Write;
use std::path::Path;

const EQUATION: &str = "[SWAN] 6; [EWA] eq. 4 and 5";

/// The largest error that the width rule is asked for: the gallery's bar on the bias.
const BAR: f64 = 5e-4;

/// Errors for which the rule is compared with the sweep: half a step of 8 bits, the bar, half a step of 16 bits.
const TARGETS: [f64; 3] = [1.0 / 512.0, BAR, 1.0 / 131_072.0];

/// Opacities of the table of widths, as exponents of 2.
const TABLED: [i32; 4] = [-16, -12, -8, -4];

/// Side of the pictures.
const SIZE: usize = 160;

/// What the arteries' extinction is multiplied by to make them shine through like an X-ray.
const XRAY_EXTINCTION: f64 = 1.0 / 16.0;

/// Widest word.
const WIDEST: u8 = 32;

pub fn group(data: &Path) -> Group {
    let stacks = sweep();
    let mut exhibits = vec![stacks_exhibit(&stacks)];
    exhibits.push(aneurism(data));
    exhibits.push(fog());
    let mut files = vec![("deep-alpha.csv", csv(&stacks))];
    match plot::svg(&stacks) {
        Ok(text) => files.push(("deep-alpha.svg", text)),
        Err(error) => exhibits[0]
            .caption
            .push_str(&format!("\n\nNo plot: {error}")),
    }
    Group { exhibits, files }
}

/// Error of stacks of equal layers, and the rule against it.
fn stacks_exhibit(stacks: &[Stack]) -> Exhibit {
    let caption = format!(
        "Stacks of up to 100,000 equal layers of opacity 2^-16 to 1/2, through words of 8 to 32 bits. The error is that of the \
         transmittance, the largest after any number of layers (dithered: root mean square over 16 pixels). All points: \
         [deep-alpha.csv](deep-alpha.csv).\n\n![error against width and layers](deep-alpha.svg)\n\n\
         Smallest width whose error stays at or below {BAR}, measured / by the rule of docs/systems.md:\n\n{}",
        table_of_widths(stacks)
    );
    let mut exhibit = exhibit("alpha", EQUATION, caption);
    for error in TARGETS {
        let slack = slack(stacks, error);
        let count = slack.len() as f64;
        let narrow = slack.iter().filter(|bits| **bits < 0).count();
        let total: i32 = slack.iter().sum();
        let largest = slack.iter().max().copied().unwrap_or(0);
        let least = slack.iter().min().copied().unwrap_or(0);
        let name = |what: &str| format!("error 2^{:.1}: {what}", error.log2());
        exhibit.number(name("channels and opacities compared"), count, "");
        exhibit.number(
            name("of these, the rule's word is too narrow"),
            narrow as f64,
            "",
        );
        exhibit.number(
            name("of the others, no word of up to 32 bits is wide enough"),
            unmet(stacks, error) as f64,
            "",
        );
        exhibit.number(name("rule less measured, least"), f64::from(least), "bits");
        exhibit.number(
            name("rule less measured, mean"),
            f64::from(total) / count.max(1.0),
            "bits",
        );
        exhibit.number(
            name("rule less measured, largest"),
            f64::from(largest),
            "bits",
        );
    }
    exhibit
}

/// Rule less measured width in bits wherever both are words of more than 8 and at most 32 bits.
fn slack(stacks: &[Stack], error: f64) -> Vec<i32> {
    let mut slack = Vec::new();
    for (representation, rounding) in kinds() {
        for log2_alpha in LOG2_ALPHAS {
            let rule = rule_width(
                representation,
                rounding,
                f64::from(-log2_alpha).exp2(),
                error,
            );
            let measured = measured_width(stacks, representation, rounding, log2_alpha, error);
            if let Some(measured) = measured.filter(|width| *width > 8 && rule <= WIDEST) {
                slack.push(i32::from(rule) - i32::from(measured));
            }
        }
    }
    slack
}

/// Channels and opacities for which the rule names a word of at most 32 bits, but none was measured to be wide enough.
fn unmet(stacks: &[Stack], error: f64) -> usize {
    let is_unmet = |representation, rounding, log2_alpha: i32| {
        let depth = f64::from(-log2_alpha).exp2();
        let measured = measured_width(stacks, representation, rounding, log2_alpha, error);
        measured.is_none() && rule_width(representation, rounding, depth, error) <= WIDEST
    };
    kinds()
        .map(|(representation, rounding)| {
            let unmet = |log2_alpha: &&i32| is_unmet(representation, rounding, **log2_alpha);
            LOG2_ALPHAS.iter().filter(unmet).count()
        })
        .sum()
}

fn kinds() -> impl Iterator<Item = (Representation, ChannelRounding)> {
    REPRESENTATIONS
        .into_iter()
        .flat_map(|representation| ROUNDINGS.map(|rounding| (representation, rounding)))
}

fn table_of_widths(stacks: &[Stack]) -> String {
    let mut table = "| channel |".to_owned();
    for log2_alpha in TABLED {
        // Writing to a String cannot fail.
        let _ = write!(table, " opacity 2^{log2_alpha} |");
    }
    table.push_str("\n|---|---|---|---|---|");
    for (representation, rounding) in kinds() {
        let _ = write!(
            table,
            "\n| {}, {} |",
            representation_name(representation),
            rounding_name(rounding)
        );
        for log2_alpha in TABLED {
            let measured = measured_width(stacks, representation, rounding, log2_alpha, BAR)
                .map_or("none".to_owned(), |width| width.to_string());
            let rule = rule_width(representation, rounding, f64::from(-log2_alpha).exp2(), BAR);
            let _ = write!(table, " {measured} / {rule} |");
        }
    }
    table
}

fn aneurism(data: &Path) -> Exhibit {
    let name = "alpha-aneurism";
    let path = data.join("volumes/aneurism.nhdr");
    let mut scene = match scene::load(&path, &LoadOptions::default()) {
        Ok(scene) => scene,
        Err(error) => {
            return exhibit(
                name,
                EQUATION,
                format!("Not drawn: {error}. Name the folder with the data by --data."),
            );
        }
    };
    for splat in &mut scene.splats {
        splat.weight *= XRAY_EXTINCTION;
    }
    let rules = Rules {
        minimum_transmittance: 0.0,
        ..Rules::EWA
    };
    let what = "Aneurism by an X-ray-like transfer function: a sixteenth of the preset's extinction, so that the arteries shine \
                through each other.";
    let camera = scene.default_camera(SIZE, SIZE);
    checked(name, what, &scene, &camera, &rules)
}

fn fog() -> Exhibit {
    let scene = synthetic::deep_stack(1);
    // No threshold on faint opacities: the channel is what is measured.
    let rules = Rules {
        alpha_min: 0.0,
        cutoff: 9.0,
        minimum_transmittance: 0.0,
        ..Rules::GAUSSIAN_3D
    };
    let what = "The deep stack: 20,000 splats of fog, cut off at three standard deviations, without a threshold on opacity.";
    checked(
        "alpha-fog",
        what,
        &scene,
        &synthetic::camera(SIZE, SIZE),
        &rules,
    )
}

fn checked(name: &str, what: &str, scene: &Scene, camera: &Camera, rules: &Rules) -> Exhibit {
    match drawn(name, what, scene, camera, rules) {
        Ok(exhibit) => exhibit,
        Err(error) => exhibit(name, EQUATION, format!("Not drawn: {error}.")),
    }
}

/// Why a scene is not shown.
#[derive(Debug, thiserror::Error)]
enum SceneError {
    #[error(transparent)]
    Compare(#[from] CompareError),
    #[error(transparent)]
    Width(#[from] WidthProblem),
}

/// The rule asks for more than the kernel has.
#[derive(Debug, thiserror::Error)]
#[error("a channel of {0} bits is not built")]
struct WidthProblem(u8);

/// Draws a scene through every kind of channel at 12 bits, the rule's width and 24 bits.
fn drawn(
    name: &str,
    what: &str,
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
) -> Result<Exhibit, SceneError> {
    let float = float::draw(scene, camera, rules, Compositing::FrontToBack).picture;
    let layers = most_layers(scene, camera, rules);
    let mut table = "| channel | bits | colour: PSNR, dB | largest error | bias | alpha: PSNR, dB | largest error | bias |\n\
                     |---|---|---|---|---|---|---|---|"
        .to_owned();
    let mut exhibit = exhibit(name, EQUATION, String::new());
    for (representation, rounding) in kinds() {
        let rule = rule_width(representation, rounding, layers as f64, BAR);
        let mut widths = vec![12, rule, 24];
        widths.dedup();
        for width in widths {
            let picture = draw(scene, camera, rules, representation, rounding, width)?;
            let errors = compare(&picture, &float)?;
            let by = if width == rule { " (rule)" } else { "" };
            let title = format!(
                "{}, {}",
                representation_name(representation),
                rounding_name(rounding)
            );
            let _ = write!(table, "\n| {title} | {width}{by} |");
            for error in [errors.colour, errors.alpha] {
                let _ = write!(
                    table,
                    " {:.1} | {:.1e} | {:.1e} |",
                    error.psnr_db, error.max_abs, error.bias
                );
            }
            if width == 24 && rounding == ChannelRounding::Nearest {
                exhibit.errors(&format!("24 bits, {title}, colour"), &errors.colour);
                exhibit.errors(&format!("24 bits, {title}, alpha"), &errors.alpha);
            }
        }
    }
    exhibit.caption = format!(
        "{what} At most {layers} layers over one pixel; \"rule\" is the width that docs/systems.md asks for so many layers and \
         an error of {BAR}. Fixed against float:\n\n{table}"
    );
    for rounding in ROUNDINGS {
        let picture = draw(scene, camera, rules, Representation::Opacity, rounding, 8)?;
        exhibit.pictures.push((
            format!("opacity, 8 bits, {}", rounding_name(rounding)),
            picture,
        ));
    }
    for representation in [Representation::Opacity, Representation::OpticalDepth] {
        let picture = draw(
            scene,
            camera,
            rules,
            representation,
            ChannelRounding::Nearest,
            24,
        )?;
        exhibit.pictures.push((
            format!("{}, 24 bits", representation_name(representation)),
            picture,
        ));
    }
    exhibit.pictures.push(("float".to_owned(), float));
    Ok(exhibit)
}

fn draw(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    representation: Representation,
    rounding: ChannelRounding,
    width: u8,
) -> Result<Picture, WidthProblem> {
    let design = standard24();
    let options = Options {
        rules,
        compositing: Compositing::FrontToBack,
        design: &design,
        traversal: design.traversal,
    };
    let channel = Channel::new(representation, rounding, width).map_err(|_| WidthProblem(width))?;
    let engine = fixed::best_engine();
    Ok(fixed::deep::draw(scene, camera, &options, engine, channel))
}

/// Largest number of splats over one pixel.
fn most_layers(scene: &Scene, camera: &Camera, rules: &Rules) -> u32 {
    let mut layers = vec![0; camera.width * camera.height];
    for splat in float::footprints(scene, camera, rules).iter().flatten() {
        let bounds = splat.bounds();
        for y in bounds.y0..bounds.y1 {
            let (x0, x1) = splat.row_span(y as f64 + 0.5);
            for count in layers[y * camera.width..][..camera.width]
                .iter_mut()
                .take(x1)
                .skip(x0)
            {
                *count += 1;
            }
        }
    }
    layers.into_iter().max().unwrap_or(0)
}
