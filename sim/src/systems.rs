//! The eighteen systems of the four papers: what they are, where they live, and which of them a drawing exercises.

use crate::hybrid::{Hybrid, Points};
use crate::rules::{Compositing, Kernel, Rules};
use crate::surface::{Buffer, Style};
use serde::{Deserialize, Serialize};

/// A system of the papers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct System {
    /// 1 to 18.
    pub number: u8,
    /// What it is.
    pub name: &'static str,
    /// Paper and section or equation.
    pub source: &'static str,
    /// Files that hold it: of the kernel, or of the host where they begin with `sim`.
    pub modules: &'static str,
    /// Its counterpart in double precision, in `sim/reference/src/engines`.
    pub reference: &'static str,
    /// Collection of the gallery, and exhibits with the comparisons of fixed against float in them.
    pub exhibits: (&'static str, &'static [(&'static str, &'static str)]),
}

const fn system(
    number: u8,
    name: &'static str,
    source: &'static str,
    modules: &'static str,
    reference: &'static str,
    exhibits: (&'static str, &'static [(&'static str, &'static str)]),
) -> System {
    System {
        number,
        name,
        source,
        modules,
        reference,
        exhibits,
    }
}

const SCAN: &str = "A scanned surface without holes";
const WARP: &str = "A depth image warped to two other views";

/// All of them, by number.
#[rustfmt::skip]
pub const SYSTEMS: [System; 18] = [
    system(1, "EWA volume splat", "[EWA] 6.2, 7.1", "setup/project, jacobian, covariance, shape, opacity", "jacobian, float",
        ("kernels", &[("antialias", "ewa fixed against float"), ("antialias-4-to-1", "ewa fixed against float")])),
    system(2, "EWA surface splat", "[EWA] 6.3, [SURF] 3.3, 4", "setup/surface, footprint/surface", "surface",
        ("surface", &[(SCAN, "512, colour"), (SCAN, "512, alpha"), ("Edge antialiasing", "without, colour")])),
    system(3, "flattening a volume kernel into a surface kernel", "[EWA] 6.4", "setup/surface, setup/mod", "surface, jacobian",
        ("surface", &[("Flattening a volume kernel into a surface kernel", "")])),
    system(4, "forward-differencing rasterizer", "[EWA] 7.1.2, [SURF] 4", "raster/conic, spans; kernel", "compositor",
        ("kernels", &[("antialias", "none fixed against float"), ("antialias", "ewa fixed against float")])),
    system(5, "compositing, sheet buffers, X-ray", "[EWA] 4.1, 7.1, [HYBRID] 4.1, [SWAN] 3.1", "blend, blend/sheets", "compositor, sheets",
        ("deep", &[("sheets", "axis-aligned: fixed against float, colour"), ("sheets", "image-aligned, whole kernels: fixed against float, colour"), ("sheets", "image-aligned, cut kernels: fixed against float, colour")])),
    system(6, "distance scaling", "[SWAN] 4.3", "setup/distance", "kernels",
        ("kernels", &[("antialias", "swan fixed against float"), ("antialias-4-to-1", "swan fixed against float")])),
    system(7, "hardware splat primitive: kernels, stamps", "[SWAN] 6", "kernel/shape, raster/stamp, draw/stamp", "kernels, hybrid",
        ("kernels", &[("kernels", "gaussian"), ("kernels", "cubic"), ("kernels", "quadratic"), ("kernels", "disc"), ("stamp", "8x8 phases, against the same phases in float"), ("stamp-plane", "8x8 phases, against the same phases in float")])),
    system(8, "deep alpha channel", "[SWAN] 6", "blend/deep", "deep",
        ("deep", &[("alpha-fog", "24 bits, transmittance, nearest, colour"), ("alpha-fog", "24 bits, transmittance, nearest, alpha")])),
    system(9, "accumulation buffer with normalisation", "[SURF] 4, eq. 9", "blend/surface, blend/resolve", "surface",
        ("surface", &[(SCAN, "1024, colour"), ("Edge antialiasing", "without, colour")])),
    system(10, "deferred shading", "[SURF] 4", "blend/shading", "surface",
        ("surface", &[("Deferred shading with a material table", "shaded, colour"), (SCAN, "1024 shaded, colour")])),
    system(11, "layered A-buffer", "[SURF] 6, eq. 12", "blend/layers", "surface",
        ("surface", &[("Semi-transparent surfaces in any order", "8 layers, sorted, colour"), ("Semi-transparent surfaces in any order", "8 layers, sorted, alpha")])),
    system(12, "edge antialiasing", "[SURF] 7", "blend/edge", "surface",
        ("surface", &[("Edge antialiasing", "with, colour"), ("Edge antialiasing", "with, alpha")])),
    system(13, "texture acquisition", "[SURF] 5", "sim/reference/src/texture/coefficients, solve, drape", "texture, surface",
        ("texture", &[("A magnified checkerboard", "optimised, fixed against float, colour"), ("A magnified checkerboard", "prefiltered, fixed against float, colour"), ("A height field with its photograph", "optimised, oblique, fixed against float, colour")])),
    system(14, "hybrid points and splats", "[HYBRID] 2, 4", "setup/point, blend/points, draw/hybrid", "hybrid",
        ("kernels", &[("hybrid", "near, mixed"), ("hybrid", "middle, mixed"), ("hybrid", "far, mixed")])),
    system(15, "exact ellipse of a projected sphere", "[HYBRID] 4.2, app. A", "setup/sphere", "sphere",
        ("kernels", &[("spheres", "exact ellipse in the middle, fixed against float"), ("spheres", "exact ellipse aside, fixed against float")])),
    system(16, "perspective-correct footprint index", "[HYBRID] 4.2", "kernel/perspective, kernel/ray", "sphere",
        ("kernels", &[("spheres", "corrected index in the middle, fixed against float"), ("spheres", "corrected index aside, fixed against float"), ("spheres", "index of the ray aside, fixed against float")])),
    system(17, "hybrid image warping and texture mapping", "[HYBRID] 3", "sim/reference/src/texture/warp", "warp, hybrid",
        ("texture", &[(WARP, "near, mixed, fixed against float, colour"), (WARP, "far, mixed, fixed against float, colour"), ("A texture on a plane to the horizon", "mixed, range 64, fixed against float, colour")])),
    system(18, "volume shading and classification", "[EWA] 7.1, [SWAN] 5", "sim/reference/src/scene/shade, transfer", "float",
        ("kernels", &[("hybrid", "near, all splats"), ("hybrid", "middle, all splats")])),
];

/// What a scene and its options ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Use<'a> {
    /// Volume splats.
    Volume {
        /// The rules.
        rules: &'a Rules,
        /// Order and operator.
        compositing: Compositing,
        /// Points and stamps, if any.
        hybrid: Option<&'a Hybrid>,
        /// Was it classified from voxels?
        classified: bool,
    },
    /// Points of a surface.
    Surface {
        /// How they are drawn.
        style: &'a Style,
        /// Do the colours come from a texture?
        textured: bool,
    },
}

/// Whether a system is exercised, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SystemVerdict {
    /// 1 to 18.
    pub number: u8,
    /// What it is.
    pub name: String,
    /// Is it exercised?
    pub used: bool,
    /// Why, or what it lacks.
    pub reason: String,
}

/// One verdict per system.
pub fn exercised(asked: &Use) -> Vec<SystemVerdict> {
    let verdict = |system: &System| {
        let (used, reason) = match asked {
            Use::Volume { .. } => of_volume(system.number, asked),
            Use::Surface { style, textured } => of_surface(system.number, style, *textured),
        };
        SystemVerdict {
            number: system.number,
            name: system.name.to_owned(),
            used,
            reason,
        }
    };
    SYSTEMS.iter().map(verdict).collect()
}

fn of_volume(number: u8, asked: &Use) -> (bool, String) {
    let Use::Volume {
        rules,
        compositing,
        hybrid,
        classified,
    } = asked
    else {
        return (false, String::new());
    };
    let points = hybrid.is_some_and(|hybrid| hybrid.points != Points::None);
    let stamps = hybrid.is_some_and(|hybrid| hybrid.phase_bits.is_some());
    let said = |used: bool, yes: String, no: &str| (used, if used { yes } else { no.to_owned() });
    match number {
        1 => (
            true,
            format!("volume splats under the rules '{}'", rules.name),
        ),
        4 => (true, "every footprint is walked over its rows".to_owned()),
        5 => (
            true,
            format!(
                "{} into one pixel per place, no sheets",
                in_words(*compositing)
            ),
        ),
        6 => said(
            rules.spacing > 0.0,
            format!("samples {} apart", rules.spacing),
            "--antialias swan is not asked for",
        ),
        7 => said(
            stamps || rules.kernel != Kernel::Gaussian,
            format!(
                "{:?} footprints{}",
                rules.kernel,
                if stamps { ", stamped" } else { "" }
            ),
            "Gaussian footprints without stamps",
        ),
        14 => said(
            points,
            "samples become points by --points or --traversal stamp".to_owned(),
            "all samples stay splats",
        ),
        18 => said(
            *classified,
            "voxels are classified and shaded when loaded".to_owned(),
            "colours are stored in the file",
        ),
        2 | 3 | 9..=12 => (
            false,
            "no surface: --as surface is not asked for".to_owned(),
        ),
        8 => (
            false,
            "opacities fit the design's own transmittance".to_owned(),
        ),
        15 | 16 => (
            false,
            "splats are drawn by their affine footprints, not as spheres near the eye".to_owned(),
        ),
        _ => (false, "no texture and no depth image".to_owned()),
    }
}

fn of_surface(number: u8, style: &Style, textured: bool) -> (bool, String) {
    let said = |used: bool, yes: &str, no: &str| (used, if used { yes } else { no }.to_owned());
    let layers = match style.buffer {
        Buffer::Accumulation => 0,
        Buffer::Layers(count) => count,
    };
    match number {
        2 => (true, "points of a surface".to_owned()),
        4 => (true, "footprints walked with a depth lane".to_owned()),
        9 => (true, "sums per pixel, divided by the weight sum".to_owned()),
        10 => said(
            style.light.is_some(),
            "a light is given",
            "unlit: colours as they are",
        ),
        11 => (
            layers > 0,
            if layers > 0 {
                format!("{layers} layers")
            } else {
                "--layers is not asked for: one opaque surface".to_owned()
            },
        ),
        12 => said(style.edge.is_some(), "--edges", "--edges is not asked for"),
        13 => said(
            textured,
            "colours are texture coefficients",
            "colours belong to the points",
        ),
        5 => said(
            layers > 0,
            "fragments are composited front to back",
            "one opaque surface per pixel",
        ),
        3 => (false, "points are surface splats already".to_owned()),
        17 => (false, "no depth image".to_owned()),
        _ => (false, "no volume".to_owned()),
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

    fn numbers(asked: &Use) -> Vec<u8> {
        let used = exercised(asked);
        assert!(used.iter().all(|verdict| !verdict.reason.is_empty()));
        used.iter().filter(|v| v.used).map(|v| v.number).collect()
    }

    #[test]
    fn a_scene_exercises_what_its_options_ask_for() {
        let plain = |rules, hybrid, classified| {
            numbers(&Use::Volume {
                rules,
                compositing: Compositing::FrontToBack,
                hybrid,
                classified,
            })
        };
        assert_eq!(plain(&Rules::GAUSSIAN_3D, None, false), [1, 4, 5]);
        assert_eq!(plain(&Rules::EWA, None, true), [1, 4, 5, 18]);
        let swan = Rules::EWA.with_antialias(crate::rules::Antialias::Swan(1.0));
        let stamped = Hybrid {
            phase_bits: Some(3),
            ..Hybrid::default()
        };
        assert_eq!(plain(&swan, Some(&stamped), true), [1, 4, 5, 6, 7, 14, 18]);
        let surface = |style: &Style, textured| numbers(&Use::Surface { style, textured });
        assert_eq!(surface(&Style::opaque(1.0), false), [2, 4, 9]);
        assert_eq!(
            surface(&Style::layered(1.0, 4), true),
            [2, 4, 5, 9, 11, 12, 13]
        );
    }

    /// A name without a folder lies in the folder of the name before: `setup/project, jacobian` are two of `setup`.
    #[test]
    fn files_of_systems_exist() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let exists = |path: &std::path::Path| path.is_dir() || path.with_extension("rs").exists();
        for system in &SYSTEMS {
            for group in system.modules.split("; ") {
                let mut folder = root.join("src");
                for name in group.split(", ") {
                    let file = if name.starts_with("sim/") {
                        root.join(name)
                    } else if name.contains('/') {
                        root.join("src").join(name)
                    } else {
                        folder.join(name)
                    };
                    assert!(exists(&file), "{}: {name}", system.number);
                    folder = file.parent().map_or(folder, |parent| parent.to_owned());
                }
            }
            for name in system.reference.split(", ") {
                let file = root.join("sim/reference/src/engines").join(name);
                assert!(exists(&file), "{}: {name}", system.number);
            }
        }
    }

    #[test]
    fn systems_are_numbered_in_order() {
        assert!(
            SYSTEMS
                .iter()
                .zip(1..)
                .all(|(system, number)| system.number == number)
        );
    }
}
