//! Scenes for firmware: pruned to the splats that given views show most of, in the 24 bytes of a [`CompactScene`].
//!
//! A splat contributes `sum T alpha` over the pixels of all views, T the transmittance before it: the share of the
//! light that is its own. The covariance goes into flash as its Cholesky factor, from the axes by Gram-Schmidt (V = A
//! A^T, A^T = Q R, V = R^T R), which keeps the thin axis of a needle where squaring would lose it.

use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fixed::{self, Options, QuantisedScene};
use crate::metrics::{Errors, compare};
use crate::rules::Rules;
use crate::scene::{Bounds, Scene, Splat, Weight};
use crate::vector::{Vector, dot};
use anyhow::{Context, Result, ensure};
use splatline::fixed::types as fixed_types;
use splatline::format::{Standard24, Traversal};
use splatline::front::{COMPACT_MAGIC, CompactScene, CompactSplat, Splats};
use splatline::math::SoftFloat;
use splatline::view::View;

/// Largest magnitude of a factor, of a centre's distance from the middle, and of an exponent above the scene's.
const MOST: f64 = 32_767.0;
const EXPONENTS: i32 = 31;

/// A scene in the kernel's compact form.
#[derive(Clone, Debug)]
pub struct BakedScene {
    header: CompactScene<'static>,
    splats: Vec<CompactSplat>,
}

/// Contribution of every splat to all views together, in pixels.
pub fn contributions(scene: &Scene, cameras: &[Camera], rules: &Rules) -> Vec<f64> {
    let mut sums = vec![0.0; scene.splats.len()];
    let widths = Standard24::WIDTHS;
    let table = fixed::TableMemory::new(&widths, &fixed::kernel_rules(rules));
    let order = splatline::Compositing::FrontToBack;
    let painter = table.painter(Standard24, order, Traversal::Spans);
    let one = f64::from(1u32 << widths.alpha);
    for camera in cameras {
        let design = standard();
        let options = Options::front_to_back(rules, &design);
        let footprints = fixed::footprints(scene, camera, &options);
        let mut order: Vec<usize> = (0..footprints.len()).collect();
        order.retain(|index| footprints[*index].is_ok());
        order.sort_by_key(|index| footprints[*index].map_or(0, |footprint| footprint.depth));
        let mut light = vec![1.0f64; camera.width * camera.height];
        let window = QuantisedScene::new(scene, camera, rules).view.window();
        for index in order {
            let Ok(footprint) = &footprints[index] else {
                continue;
            };
            painter.visit(footprint, &window, |x, y, alpha| {
                let light = &mut light[usize::from(y) * camera.width + usize::from(x)];
                let alpha = f64::from(alpha) / one;
                sums[index] += *light * alpha;
                *light *= 1.0 - alpha;
            });
        }
    }
    sums
}

/// Numbers of the `keep` splats that contribute most, in the scene's order; splats that contribute nothing are never
/// among them.
pub fn most_visible(contributions: &[f64], keep: usize) -> Vec<usize> {
    let mut numbers: Vec<usize> = (0..contributions.len()).collect();
    numbers.retain(|number| contributions[*number] > 0.0);
    numbers.sort_by(|a, b| contributions[*b].total_cmp(&contributions[*a]));
    numbers.truncate(keep);
    numbers.sort_unstable();
    numbers
}

/// The error of a baked scene against the one it came from, in one view, by `standard24`.
pub fn error(from: &Scene, baked: &BakedScene, camera: &Camera, rules: &Rules) -> Result<Errors> {
    let design = standard();
    let draw =
        |scene: &Scene| fixed::draw(scene, camera, &Options::front_to_back(rules, &design)).picture;
    Ok(compare(&draw(&baked.to_scene(from)), &draw(from))?)
}

fn standard() -> DesignChoice {
    DesignChoice::named("standard24").expect("a named design")
}

impl BakedScene {
    /// Packs the splats with these numbers; colours that depend on the view are those seen on average by the cameras.
    pub fn new(scene: &Scene, numbers: &[usize], cameras: &[Camera]) -> Result<BakedScene> {
        ensure!(
            scene.weight != Weight::Mass,
            "{}: a volume's splats have a mass and no peak opacity; bake a scene of Gaussians",
            scene.name
        );
        ensure!(
            !numbers.is_empty(),
            "{}: no splat is visible in the views given",
            scene.name
        );
        let chosen: Vec<Splat> = numbers
            .iter()
            .map(|number| Splat {
                colour: mean_colour(scene, *number, cameras),
                ..scene.splats[*number]
            })
            .collect();
        let factors: Vec<[Vector; 3]> = chosen.iter().map(|splat| cholesky(&splat.axes)).collect();
        let (origin, exponent) = grid(&chosen, &scene.name)?;
        let lengths = factors.iter().flatten().map(largest);
        let power = lengths.filter(|length| *length > 0.0).map(fitting);
        let (low, high) = power.fold((0, i32::MIN), |(low, high), e| {
            (if high == i32::MIN { e } else { low.min(e) }, high.max(e))
        });
        let axis_exponent = low.max(high.saturating_sub(EXPONENTS));
        let brightest = chosen
            .iter()
            .map(|splat| largest(&splat.colour))
            .fold(1.0, f64::max);
        let unit = (brightest.min(15.9) * 2f64.powi(28) / 255.0).ceil();
        let header = CompactScene {
            origin,
            exponent,
            axis_exponent,
            colour_unit: unit as u32,
            splats: &[],
        };
        let splats = chosen.iter().zip(&factors);
        let splats = splats.map(|(splat, factors)| packed(&header, splat, factors));
        Ok(BakedScene {
            header,
            splats: splats.collect(),
        })
    }

    /// The scene as the kernel sees it.
    pub fn compact(&self) -> CompactScene<'_> {
        CompactScene {
            splats: &self.splats,
            ..self.header
        }
    }

    /// The scene as the reference sees it, with the name and the rules of the one it came from.
    pub fn to_scene(&self, from: &Scene) -> Scene {
        let compact = self.compact();
        let splats = (0..self.splats.len()).filter_map(|number| compact.splat(number));
        let number = |value: SoftFloat| f64::from(value.mantissa) * 2f64.powi(value.exponent);
        let splats = splats.map(|splat| Splat {
            centre: splat.centre.map(number),
            axes: splat.axes.map(|axis| {
                axis.mantissa
                    .map(|mantissa| f64::from(mantissa) * 2f64.powi(axis.exponent))
            }),
            weight: number(splat.weight),
            colour: splat.colour.map(|channel| channel.to_num()),
        });
        Scene {
            splats: splats.collect(),
            harmonics: None,
            ..from.clone()
        }
    }

    /// The file that `CompactScene::read` reads.
    pub fn to_bytes(&self) -> Vec<u8> {
        let header = &self.header;
        let mut bytes = Vec::from(COMPACT_MAGIC);
        let words = [
            header.exponent,
            header.axis_exponent,
            header.colour_unit as i32,
            self.splats.len() as i32,
        ];
        let words = header.origin.into_iter().chain(words);
        bytes.extend(words.flat_map(i32::to_le_bytes));
        bytes.extend(self.splats.iter().flatten());
        bytes
    }

    /// The same as constants in Rust, with the views of a camera path if there are any.
    pub fn to_rust(&self, name: &str, views: &[View]) -> String {
        let CompactScene {
            origin,
            exponent,
            axis_exponent,
            colour_unit,
            ..
        } = self.header;
        let count = self.splats.len();
        let title: String = name.chars().filter(|c| !c.is_control()).collect();
        let mut text = format!(
            "//! {title}: {count} splats in 24 bytes each. Written by `splatline bake`.\n\n\
             use splatline::front::{{CompactScene, CompactSplat}};\n\n\
             /// The scene, for `Renderer::set_up_scene`.\n\
             pub static SCENE: CompactScene<'static> = CompactScene {{\n    origin: {origin:?},\n    exponent: {exponent},\n    \
             axis_exponent: {axis_exponent},\n    colour_unit: {colour_unit},\n    splats: &SPLATS,\n}};\n\n\
             #[rustfmt::skip]\nstatic SPLATS: [CompactSplat; {count}] = [\n"
        );
        for splat in &self.splats {
            text += &format!("    {splat:?},\n");
        }
        text.push_str("];\n");
        if !views.is_empty() {
            text += &format!(
                "\n/// The views of the camera path.\n#[rustfmt::skip]\npub static VIEWS: [splatline::View; {}] = {{\n    \
                 use splatline::fixed::types::{{I2F30, I32F32}};\n    use splatline::math::{{Extended, SoftFloat}};\n    \
                 use splatline::view::{{Eye, Projection, RatioLimits, View}};\n    [\n",
                views.len()
            );
            for view in views {
                text += &format!("        {},\n", rust_view(view));
            }
            text.push_str("    ]\n};\n");
        }
        text
    }
}

/// A view as an expression of constants.
fn rust_view(view: &View) -> String {
    let entry = |value: fixed_types::I2F30| format!("I2F30::from_bits({})", value.to_bits());
    let pixels = |value: fixed_types::I32F32| format!("I32F32::from_bits({})", value.to_bits());
    let list = |items: Vec<String>| format!("[{}]", items.join(", "));
    let rows = view.rotation.map(|row| list(row.map(entry).to_vec()));
    let pair = |pair: [fixed_types::I32F32; 2]| list(pair.map(pixels).to_vec());
    format!(
        "View {{ rotation: {}, pose: {:?}, focal: {:?}, principal: {}, near: {:?}, far: {:?}, viewport: {:?}, projection: Projection::{:?}, \
         limits: RatioLimits {{ low: {}, high: {} }} }}",
        list(rows.to_vec()),
        view.pose,
        view.focal,
        pair(view.principal),
        view.near,
        view.far,
        view.viewport,
        view.projection,
        pair(view.limits.low),
        pair(view.limits.high),
    )
}

fn mean_colour(scene: &Scene, number: usize, cameras: &[Camera]) -> Vector {
    let mut mean = [0.0; 3];
    for camera in cameras {
        let colour = scene.colour(number, camera);
        for (sum, channel) in mean.iter_mut().zip(colour) {
            *sum += channel / cameras.len() as f64;
        }
    }
    mean
}

/// Largest magnitude of three numbers.
fn largest(vector: &Vector) -> f64 {
    vector.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// The power of two of the finest unit in which a length has at most 15 bits.
fn fitting(length: f64) -> i32 {
    (length / MOST).log2().ceil() as i32
}

/// Origin and unit of the grid of centres: the middle of the scene, and the finest power of two.
fn grid(splats: &[Splat], name: &str) -> Result<([i32; 3], i32)> {
    let bounds = Bounds::around(splats.iter().map(|splat| splat.centre), 0.0);
    let bounds = bounds.context("there is no splat")?;
    let middle = bounds.centre();
    let span = largest(&bounds.extents()) / 2.0;
    // Of a scene that is a point, and of one far from the origin for its size, the origin decides.
    let far = largest(&middle) / f64::from(1 << 30);
    let exponent = fitting(span * 1.001).max(far.max(2f64.powi(-60)).log2().ceil() as i32);
    ensure!(
        exponent < 400,
        "{name}: its splats are too far apart for a grid"
    );
    Ok((
        middle.map(|m| (m / 2f64.powi(exponent)).round() as i32),
        exponent,
    ))
}

/// Columns of the Cholesky factor of `sum_k a_k a_k^T`.
fn cholesky(axes: &[Vector; 3]) -> [Vector; 3] {
    // Rows of A.
    let rows = [0, 1, 2].map(|i| axes.map(|axis| axis[i]));
    let mut factor = [[0.0; 3]; 3];
    let mut basis: [Vector; 3] = [[0.0; 3]; 3];
    for (row, start) in rows.into_iter().enumerate() {
        let mut rest = start;
        for column in 0..row {
            let part = dot(rest, basis[column]);
            factor[column][row] = part;
            for (value, along) in rest.iter_mut().zip(basis[column]) {
                *value -= part * along;
            }
        }
        let length = dot(rest, rest).sqrt();
        factor[row][row] = length;
        if length > 0.0 {
            basis[row] = rest.map(|value| value / length);
        }
    }
    factor
}

fn packed(header: &CompactScene, splat: &Splat, factors: &[Vector; 3]) -> CompactSplat {
    let mut words = [0i16; 10];
    for (axis, word) in words.iter_mut().take(3).enumerate() {
        let steps = splat.centre[axis] / 2f64.powi(header.exponent);
        *word = (steps.round() - f64::from(header.origin[axis])).clamp(-MOST, MOST) as i16;
    }
    let mut exponents = 0;
    let mut factor = words.iter_mut().skip(3);
    for (place, column) in factors.iter().enumerate() {
        let length = largest(column);
        let power = if length > 0.0 {
            fitting(length)
        } else {
            header.axis_exponent
        };
        let above = (power - header.axis_exponent).clamp(0, EXPONENTS);
        exponents |= (above as u16) << (5 * place);
        let unit = 2f64.powi(header.axis_exponent + above);
        for (value, word) in column[place..].iter().zip(&mut factor) {
            *word = (value / unit).round().clamp(-MOST, MOST) as i16;
        }
    }
    words[9] = exponents as i16;
    let mut bytes = [0; 24];
    for (pair, word) in bytes.chunks_exact_mut(2).zip(words) {
        pair.copy_from_slice(&word.to_le_bytes());
    }
    let unit = f64::from(header.colour_unit) / 2f64.powi(28);
    let channels = splat.colour.map(|channel| (channel / unit).round() as u8);
    bytes[20..23].copy_from_slice(&channels);
    bytes[23] = (255.0 * splat.weight).round() as u8;
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::synthetic;

    /// Through the file and the kernel's reader: centres, covariances, opacities and colours within their units.
    #[test]
    fn a_baked_scene_is_the_scene() {
        let scene = synthetic::random_gaussians(300, 3, 2.0);
        let camera = scene.default_camera(160, 120);
        let all: Vec<usize> = (0..300).collect();
        let baked = BakedScene::new(&scene, &all, std::slice::from_ref(&camera)).unwrap();
        let bytes = baked.to_bytes();
        assert_eq!(CompactScene::read(&bytes), Some(baked.compact()));
        let covariance = |axes: &[Vector; 3], i: usize, j: usize| -> f64 {
            axes.iter().map(|axis| axis[i] * axis[j]).sum()
        };
        for (is, was) in baked.to_scene(&scene).splats.iter().zip(&scene.splats) {
            for i in 0..3 {
                assert!((is.centre[i] - was.centre[i]).abs() < 1e-3);
                assert!((is.colour[i] - was.colour[i]).abs() < 0.5 / 255.0 * 1.6);
                for j in 0..3 {
                    let size = (covariance(&was.axes, i, i) * covariance(&was.axes, j, j)).sqrt();
                    let [is, was] = [&is.axes, &was.axes].map(|axes| covariance(axes, i, j));
                    assert!((is - was).abs() <= 2e-4 * size, "{is} {was}");
                }
            }
            assert!((is.weight - was.weight).abs() < 0.51 / 255.0);
        }
        let errors = error(&scene, &baked, &camera, &Rules::GAUSSIAN_3D).unwrap();
        assert!(errors.colour.psnr_db > 45.0, "{}", errors.colour.psnr_db);
    }

    /// What a splat contributes is the alpha channel's: the sum over all splats is that of the picture.
    #[test]
    fn contributions_sum_to_the_pictures_alpha() {
        let scene = synthetic::random_gaussians(200, 5, 2.0);
        let camera = scene.default_camera(96, 96);
        let rules = Rules::GAUSSIAN_3D;
        let sums = contributions(&scene, std::slice::from_ref(&camera), &rules);
        let picture = fixed::draw(
            &scene,
            &camera,
            &Options::front_to_back(&rules, &standard()),
        )
        .picture;
        let alpha: f64 = picture.pixels.iter().map(|pixel| pixel[3]).sum();
        let sum: f64 = sums.iter().sum();
        assert!((sum - alpha).abs() < 2e-3 * alpha, "{sum} {alpha}");
        let kept = most_visible(&sums, 50);
        let least = kept.iter().map(|n| sums[*n]).fold(f64::INFINITY, f64::min);
        let left_out = (0..sums.len()).filter(|n| !kept.contains(n));
        assert!(kept.len() == 50 && left_out.map(|n| sums[n]).all(|sum| sum <= least));
    }
}
