//! Which of the papers' eighteen systems a plan exercises, and why.

use super::{Contents, SplatMethod, SplatTechnique, Technique};
use crate::hybrid::{Hybrid, Points};
use crate::reference::sphere::{Index, Shape};
use crate::rules::{Compositing, Kernel};
use crate::surface::{Buffer, Style};
use crate::systems::{SYSTEMS, SystemVerdict};

/// One verdict per system; `classified` says whether the splats were made from voxels.
pub fn exercised(
    technique: &Technique,
    contents: &Contents,
    classified: bool,
) -> Vec<SystemVerdict> {
    let reason = |number: u8| match technique {
        Technique::Splats(technique) => match number {
            3 if contents.flattening().is_some() => {
                Ok("points drawn as volume kernels, thin along the normal".to_owned())
            }
            17 if contents.has_samples() => {
                Ok("pixels of a depth image or texels are samples in space".to_owned())
            }
            18 if classified => Ok("voxels are classified and shaded when loaded".to_owned()),
            18 => Err("colours are stored in the file"),
            _ => of_splats(number, technique),
        },
        Technique::Surface(style) => {
            let texture = match contents {
                Contents::Surface { texture, .. } => texture.as_ref(),
                _ => None,
            };
            of_surface(number, style, texture.is_some())
        }
    };
    let verdict = |system: &crate::systems::System| {
        let reason = reason(system.number);
        SystemVerdict {
            number: system.number,
            name: system.name.clone(),
            used: reason.is_ok(),
            reason: reason.unwrap_or_else(str::to_owned),
        }
    };
    SYSTEMS.iter().map(verdict).collect()
}

/// Why it is used, or why it is not.
type Reason = Result<String, &'static str>;

fn used_if(used: bool, yes: impl Into<String>, no: &'static str) -> Reason {
    if used { Ok(yes.into()) } else { Err(no) }
}

fn of_splats(number: u8, technique: &SplatTechnique) -> Reason {
    let (rules, method) = (&technique.rules, &technique.method);
    match number {
        1 => Ok(format!("volume splats under the rules '{}'", rules.name)),
        4 => Ok("every footprint is walked over its rows".to_owned()),
        5 => Ok(match method {
            SplatMethod::Sheets(sheets) => format!("sheet buffers, {}", sheets.kind.name()),
            _ => format!(
                "{} into one pixel per place, no sheets",
                in_words(technique.compositing)
            ),
        }),
        6 => used_if(
            rules.spacing > 0.0,
            format!("samples {} apart", rules.spacing),
            "--antialias swan is not asked for",
        ),
        7 => of_primitive(rules.kernel, method),
        8 => match method {
            SplatMethod::DeepAlpha(channel) => {
                Ok(format!("an alpha channel of {} bits", channel.bits))
            }
            _ => Err("opacities fit the design's own transmittance"),
        },
        14 => used_if(
            matches!(method, SplatMethod::Points(hybrid) if hybrid.points != Points::None),
            "samples become points by --points or --traversal stamp",
            "all samples stay splats",
        ),
        15 => match method {
            SplatMethod::Spheres(Shape {
                exact_ellipse: true,
                ..
            }) => Ok("the tangent cone's ellipse".to_owned()),
            _ => Err("splats are drawn by their affine footprints"),
        },
        16 => match method {
            SplatMethod::Spheres(Shape {
                index: Index::Perspective | Index::Ray,
                ..
            }) => Ok("the radial index is corrected for perspective".to_owned()),
            _ => Err("the radial index is affine"),
        },
        2 | 3 | 9..=12 => Err("no surface: --as surface is not asked for"),
        _ => Err("no texture and no depth image"),
    }
}

/// System 7: other kernels than the Gaussian, and stamps.
fn of_primitive(kernel: Kernel, method: &SplatMethod) -> Reason {
    let stamps = matches!(
        method,
        SplatMethod::Points(Hybrid {
            phase_bits: Some(_),
            ..
        })
    );
    let stamped = if stamps { ", stamped" } else { "" };
    used_if(
        stamps || kernel != Kernel::Gaussian,
        format!("{kernel:?} footprints{stamped}"),
        "Gaussian footprints without stamps",
    )
}

fn of_surface(number: u8, style: &Style, textured: bool) -> Reason {
    let layers = match style.buffer {
        Buffer::Accumulation => 0,
        Buffer::Layers(count) => count,
    };
    match number {
        2 => Ok("points of a surface".to_owned()),
        4 => Ok("footprints walked with a depth lane".to_owned()),
        9 => Ok("sums per pixel, divided by the weight sum".to_owned()),
        10 => used_if(
            style.light.is_some(),
            "a light is given",
            "unlit: colours as they are",
        ),
        11 => used_if(
            layers > 0,
            format!("{layers} layers"),
            "--layers is not asked for: one opaque surface",
        ),
        12 => used_if(style.edge.is_some(), "--edges", "--edges is not asked for"),
        13 => used_if(
            textured,
            "colours are texture coefficients",
            "colours belong to the points",
        ),
        5 => used_if(
            layers > 0,
            "fragments are composited front to back",
            "one opaque surface per pixel",
        ),
        3 => Err("points are surface splats already"),
        17 => Err("no depth image"),
        _ => Err("no volume"),
    }
}

/// The operator as the report says it.
fn in_words(compositing: Compositing) -> &'static str {
    match compositing {
        Compositing::FrontToBack => "front to back",
        Compositing::BackToFront => "back to front",
        Compositing::XRay => "summation",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::{Antialias, Rules};

    fn numbers(technique: &Technique, contents: &Contents, classified: bool) -> Vec<u8> {
        let used = exercised(technique, contents, classified);
        assert!(used.iter().all(|verdict| !verdict.reason.is_empty()));
        used.iter().filter(|v| v.used).map(|v| v.number).collect()
    }

    #[test]
    fn a_scene_exercises_what_its_options_ask_for() {
        let splats = |rules, method, classified| {
            let technique = Technique::Splats(SplatTechnique {
                rules,
                compositing: Compositing::FrontToBack,
                method,
            });
            numbers(&technique, &Contents::default(), classified)
        };
        let plain = SplatMethod::Composited;
        assert_eq!(splats(Rules::GAUSSIAN_3D, plain, false), [1, 4, 5]);
        assert_eq!(splats(Rules::EWA, plain, true), [1, 4, 5, 18]);
        let swan = Rules::EWA.with_antialias(Antialias::Swan(1.0));
        let stamped = SplatMethod::Points(Hybrid {
            phase_bits: Some(3),
            ..Hybrid::default()
        });
        assert_eq!(splats(swan, stamped, true), [1, 4, 5, 6, 7, 14, 18]);
        let spheres = SplatMethod::Spheres(Shape {
            exact_ellipse: true,
            index: Index::Ray,
        });
        assert_eq!(splats(Rules::EWA, spheres, false), [1, 4, 5, 15, 16]);
        let textured = Contents::Surface {
            texture: Some((
                "photo.png".into(),
                crate::texture::coefficients::Method::Plain,
            )),
            spacing: None,
            flatten: None,
            depth_image: None,
        };
        let surface =
            |style, contents: &Contents| numbers(&Technique::Surface(style), contents, false);
        assert_eq!(surface(Style::opaque(1.0), &Contents::default()), [2, 4, 9]);
        assert_eq!(
            surface(Style::layered(1.0, 4), &textured),
            [2, 4, 5, 9, 11, 12, 13]
        );
    }
}
