//! A scene as the live page holds it: the bytes that the host writes into the page and that the page's wasm reads.
//! Compiled into both.
//!
//! Numbers of splats are single precision, which is what files hold: a page stays small, and what the page shows is
//! drawn by kernel and reference alike from the numbers after that rounding. Each number is a column of the scene, and
//! each column four planes of one byte, because columns of like bytes compress to a part of what interleaved splats do.

use crate::rules::{Kernel, Rules};
use crate::scene::{Harmonics, Scene, SortOrder, Splat};

/// What the bytes begin with; the digit is the version.
const MAGIC: &[u8; 8] = b"SPLPAGE3";
/// Numbers of a splat: centre, axes, weight, colour.
const NUMBERS: usize = 16;
/// Doubles of a camera, in the order of `camera_numbers`.
pub const CAMERA: usize = 21;

/// The scene's bytes under `rules`, whose weights it holds.
pub fn encode(scene: &Scene, rules: &Rules) -> Vec<u8> {
    let degree = scene.harmonics.as_ref().map_or(0, |h| h.degree);
    let mut bytes = MAGIC.to_vec();
    bytes.extend((scene.splats.len() as u32).to_le_bytes());
    bytes.extend(u32::from(degree).to_le_bytes());
    bytes.extend(u32::from(scene.order == SortOrder::Distance).to_le_bytes());
    each_number(&mut { *rules }, |number| {
        bytes.extend(number.to_le_bytes());
        Some(number)
    });
    let weights = scene.weights_for(rules);
    let rows: Vec<[f32; NUMBERS]> = scene
        .splats
        .iter()
        .zip(weights)
        .map(|(splat, weight)| splat_numbers(splat, weight))
        .collect();
    for column in 0..NUMBERS {
        put_column(&mut bytes, rows.iter().map(|row| row[column]));
    }
    if let Some(harmonics) = &scene.harmonics {
        let count = coefficients(degree);
        for channel in 0..3 {
            put_column(&mut bytes, harmonics.base.iter().map(|base| base[channel]));
            for place in 0..count {
                let of_splats = harmonics.coefficients.iter().skip(place).step_by(count);
                put_column(&mut bytes, of_splats.map(|rgb| rgb[channel]));
            }
        }
    }
    bytes
}

/// The scene and its rules, if the bytes are whole.
pub fn decode(bytes: &[u8]) -> Option<(Scene, Rules)> {
    let mut rest = bytes.strip_prefix(MAGIC)?;
    let count = usize::try_from(u32::from_le_bytes(*take(&mut rest)?)).ok()?;
    let degree = u8::try_from(u32::from_le_bytes(*take(&mut rest)?)).ok()?;
    let order = match u32::from_le_bytes(*take(&mut rest)?) {
        0 => SortOrder::Depth,
        1 => SortOrder::Distance,
        _ => return None,
    };
    let mut rules = Rules {
        name: "page",
        ..Rules::EWA
    };
    each_number(&mut rules, |_| Some(f64::from_le_bytes(*take(&mut rest)?)))?;
    let mut columns = Vec::with_capacity(NUMBERS);
    for _ in 0..NUMBERS {
        columns.push(take_column(&mut rest, count)?);
    }
    let splats: Vec<Splat> = (0..count).map(|i| splat_from(&columns, i)).collect();
    let harmonics = match degree {
        0 => None,
        1..=4 => Some(take_harmonics(&mut rest, count, degree)?),
        _ => return None,
    };
    let scene = Scene {
        harmonics,
        order,
        up: [0.0, 1.0, 0.0],
        ..Scene::of_splats("", rules, splats)
    };
    rest.is_empty().then_some((scene, rules))
}

fn take_harmonics(rest: &mut &[u8], splats: usize, degree: u8) -> Option<Harmonics> {
    let count = coefficients(degree);
    let mut harmonics = Harmonics {
        degree,
        coefficients: vec![[0.0; 3]; splats.checked_mul(count)?],
        base: vec![[0.0; 3]; splats],
    };
    for channel in 0..3 {
        for (base, value) in harmonics.base.iter_mut().zip(take_column(rest, splats)?) {
            base[channel] = value;
        }
        for place in 0..count {
            let of_splats = harmonics.coefficients.iter_mut().skip(place).step_by(count);
            for (rgb, value) in of_splats.zip(take_column(rest, splats)?) {
                rgb[channel] = value;
            }
        }
    }
    Some(harmonics)
}

/// Coefficients per splat and channel beyond degree 0.
fn coefficients(degree: u8) -> usize {
    (usize::from(degree) + 1).pow(2) - 1
}

fn splat_numbers(splat: &Splat, weight: f64) -> [f32; NUMBERS] {
    let all = splat
        .centre
        .iter()
        .chain(splat.axes.as_flattened())
        .chain([&weight])
        .chain(&splat.colour);
    let mut numbers = [0.0; NUMBERS];
    for (number, value) in numbers.iter_mut().zip(all) {
        *number = *value as f32;
    }
    numbers
}

fn splat_from(columns: &[Vec<f32>], index: usize) -> Splat {
    let number = |place: usize| f64::from(columns[place][index]);
    let vector = |place: usize| [0, 1, 2].map(|axis| number(place + axis));
    Splat {
        centre: vector(0),
        axes: [3, 6, 9].map(vector),
        weight: number(12),
        colour: vector(13),
    }
}

const KERNELS: [Kernel; 4] = [
    Kernel::Gaussian,
    Kernel::Cubic,
    Kernel::Quadratic,
    Kernel::Disc,
];

/// Hands `number` every number that states rules and takes what it gives for it: writing and reading in one order.
fn each_number(rules: &mut Rules, mut number: impl FnMut(f64) -> Option<f64>) -> Option<()> {
    rules.normalised = number(rules.normalised.into())? != 0.0;
    rules.low_pass = number(rules.low_pass)?;
    rules.spacing = number(rules.spacing)?;
    let kernel = KERNELS.iter().position(|kernel| *kernel == rules.kernel);
    rules.kernel = *KERNELS.get(number(kernel.unwrap_or(0) as f64)? as usize)?;
    rules.cutoff = number(rules.cutoff)?;
    rules.alpha_max = number(rules.alpha_max)?;
    rules.alpha_min = number(rules.alpha_min)?;
    rules.minimum_transmittance = number(rules.minimum_transmittance)?;
    rules.omit_finishing = number(rules.omit_finishing.into())? != 0.0;
    rules.clamp_jacobian = number(rules.clamp_jacobian.into())? != 0.0;
    rules.compensated = number(rules.compensated.into())? != 0.0;
    Some(())
}

fn put_column(bytes: &mut Vec<u8>, values: impl Iterator<Item = f32> + Clone) {
    for plane in 0..4 {
        bytes.extend(values.clone().map(|value| value.to_le_bytes()[plane]));
    }
}

fn take_column(rest: &mut &[u8], count: usize) -> Option<Vec<f32>> {
    let (column, after) = rest.split_at_checked(count.checked_mul(4)?)?;
    *rest = after;
    let byte = |plane: usize, index: usize| column[plane * count + index];
    let value = |index: usize| f32::from_le_bytes([0, 1, 2, 3].map(|plane| byte(plane, index)));
    Some((0..count).map(value).collect())
}

fn take<'a, const N: usize>(rest: &mut &'a [u8]) -> Option<&'a [u8; N]> {
    let (first, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(first)
}

/// A word of the checksum over a picture's pixels, whose integers are what must agree between processors.
pub fn checksum(words: impl Iterator<Item = u32>) -> u64 {
    // FNV-1a by words.
    words.fold(0xcbf2_9ce4_8422_2325, |sum, word| {
        (sum ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
