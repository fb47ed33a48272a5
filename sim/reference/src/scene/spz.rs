//! `.spz`, versions 1 to 4: a short header and one array per attribute.
//!
//! | array | bytes per Gaussian | decoding |
//! |---|---|---|
//! | position | 3 x 3 | signed 24-bit fixed point with the header's number of fractional bits; in version 1 three half floats |
//! | opacity | 1 | / 255 |
//! | colour | 3 | `f_dc = (byte / 255 - 0.5) / 0.15` |
//! | scale | 3 | logarithm = `byte / 16 - 10` |
//! | rotation, versions 1 and 2 | 3 | x, y, z = `byte / 127.5 - 1`, w >= 0 makes the length 1 |
//! | rotation, versions 3 and 4 | 4 | "smallest three": top 2 bits name the largest of x, y, z, w; the others follow, sign and 9-bit magnitude of sqrt(1/2) |
//! | harmonics | 3 per coefficient | `(byte - 128) / 128`, colour channel fastest |
//!
//! Up to version 3 all of it is one gzip stream; version 4 has a plain header, a table of sizes and one zstd stream per
//! array.
//!
//! The format's axes are right, up, back, while the trainers' are right, down, front: y and z are negated here, in
//! positions, in quaternions and in the harmonics that are odd in them.

use super::Scene;
use super::bytes::{Reader, gunzip_at_most, gunzip_exact, little_at, nothing_left, unzstd_exact};
use super::error::Problem;
use super::gaussian::{
    Gaussian, GaussianScene, HARMONICS, MAX_DEGREE, TRAINED_ANTIALIASED, base_from_coefficient,
    coefficient_count, harmonic_basis, room_for, scale_from_log, scene_bytes,
};
use super::quaternion::smallest_three;
use anyhow::{anyhow, ensure};
use half::f16;

const MAGIC: &[u8; 4] = b"NGSP";
const HEADER_BYTES: usize = 16;
const COLOUR_SCALE: f64 = 0.15;
/// Flag of a file that was trained antialiased.
const FLAG_ANTIALIASED: u8 = 1;
/// Flag of a file with extension records after the arrays.
const FLAG_EXTENSIONS: u8 = 2;
/// What turns right-up-back into right-down-front.
const FLIP: [f64; 3] = [1.0, -1.0, -1.0];

/// Bytes of version 4's header, of which the last twelve are reserved.
const HEADER_BYTES_4: usize = 32;
/// What each array is called in messages, in the file's order.
const ARRAYS: [&str; 6] = [
    "spz positions",
    "spz opacities",
    "spz colours",
    "spz scales",
    "spz rotations",
    "spz harmonics",
];
/// Largest size of the unpacked arrays in sizes of the file, for version 4: zstd itself knows no bound. Real scenes,
/// even of one colour and rotation throughout, stay below 20; the format's own library refuses more than this as well.
const MAX_RATIO: u64 = 1024;

/// Loads a `.spz` file.
pub(super) fn load(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    if bytes.starts_with(MAGIC) {
        return load_streams(bytes, name);
    }
    let header = SpzHeader::parse(&gunzip_at_most(bytes, HEADER_BYTES as u64, "spz header")?)?;
    if header.version > 3 {
        return Err(unsupported_version(&format!("{} in gzip", header.version)));
    }
    let scene = scene_bytes(header.degree, header.count.into());
    let unpacked = gunzip_exact(bytes, header.file_bytes(), scene, "spz data")?;
    let mut reader = Reader::new(&unpacked);
    reader.take(HEADER_BYTES, "spz header")?;
    let mut arrays = [&[][..]; 6];
    for ((array, size), field) in arrays.iter_mut().zip(header.record_bytes()).zip(ARRAYS) {
        *array = reader.records(u64::from(header.count), size, field)?;
    }
    decode(&header, arrays, name)
}

/// Version 4: header, table of packed and unpacked sizes, streams.
fn load_streams(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    let header = SpzHeader::parse(bytes)?;
    if header.version != 4 {
        return Err(unsupported_version(&format!(
            "{} without gzip",
            header.version
        )));
    }
    let mut reader = Reader::new(bytes);
    reader.take(HEADER_BYTES, "spz header")?;
    let table_at = reader.little::<u32, _>("spz table offset")? as usize;
    let mut table = Reader::new(bytes);
    table.take(table_at.max(HEADER_BYTES_4), "spz table")?;
    let streams = usize::from(header.reserved);
    let needed = if header.degree == 0 { 5 } else { 6 };
    ensure!(
        (needed..=6).contains(&streams),
        "spz streams: there are {streams}; \
         {needed} to 6 are read: positions, opacities, colours, scales, rotations, harmonics"
    );
    let claimed = header.file_bytes();
    ensure!(
        claimed <= (bytes.len() as u64).saturating_mul(MAX_RATIO),
        "spz count: {} Gaussians of {claimed} bytes cannot be in a file of {}; \
         correct the count in the header or fetch the file again",
        header.count,
        bytes.len()
    );
    room_for(header.degree, header.count.into(), claimed)?;
    let sizes = table.records(streams as u64, 16, "spz table")?;
    let mut unpacked: [Vec<u8>; 6] = Default::default();
    for (index, entry) in sizes.as_chunks::<16>().0.iter().enumerate() {
        let expected = u64::from(header.count) * header.record_bytes()[index] as u64;
        let [packed, plain]: [u64; 2] = [0, 8].map(|at| little_at(entry, at));
        ensure!(
            plain == expected,
            "{}: the table says {plain} bytes; {} Gaussians need {expected}; \
             export the scene again",
            ARRAYS[index],
            header.count
        );
        let packed = table.records(packed, 1, ARRAYS[index])?;
        unpacked[index] = unzstd_exact(packed, expected, ARRAYS[index])?;
    }
    let fix = "correct the sizes in the table or export the scene again";
    nothing_left(table.remaining(), "spz streams", "one", fix)?;
    decode(&header, unpacked.each_ref().map(Vec::as_slice), name)
}

/// A scene from its arrays, which are those of [`ARRAYS`].
fn decode(header: &SpzHeader, arrays: [&[u8]; 6], name: &str) -> Result<Scene, Problem> {
    let mut scene = GaussianScene::new(header.degree, header.count.into())?;
    if header.antialiased {
        scene.rules = TRAINED_ANTIALIASED;
    }
    let (sizes, parities) = (header.record_bytes(), harmonic_parities());
    for index in 0..header.count as usize {
        let of_array = |array: usize| &arrays[array][index * sizes[array]..][..sizes[array]];
        let parts: [&[u8]; 6] = std::array::from_fn(of_array);
        let (harmonics, _) = parts[5].as_chunks::<3>();
        for ((coefficient, bytes), parity) in
            scene.harmonics.iter_mut().zip(harmonics).zip(parities)
        {
            *coefficient = bytes.map(|byte| parity * (f32::from(byte) - 128.0) / 128.0);
        }
        scene.push(&gaussian(parts, header.fraction_bits));
    }
    scene.finish(name)
}

struct SpzHeader {
    version: u32,
    count: u32,
    degree: u8,
    fraction_bits: u8,
    /// Opacities are to be compensated for the low-pass filter.
    antialiased: bool,
    /// The number of streams in version 4, nothing before.
    reserved: u8,
}

impl SpzHeader {
    fn parse(bytes: &[u8]) -> Result<SpzHeader, Problem> {
        let mut reader = Reader::new(bytes);
        let magic: [u8; 4] = reader.array("spz magic")?;
        ensure!(
            magic == *MAGIC,
            "spz magic: it is not 'NGSP'; check that this is a .spz file"
        );
        let version: u32 = reader.little("spz version")?;
        if !(1..=4).contains(&version) {
            return Err(unsupported_version(&version.to_string()));
        }
        let count: u32 = reader.little("spz count")?;
        let [degree, fraction_bits, flags, reserved] = reader.array("spz header")?;
        ensure!(
            count != 0,
            "spz count: it is 0; export a scene with splats in it"
        );
        ensure!(
            degree <= MAX_DEGREE,
            "spz harmonics degree: it is {degree}; degrees 0 to 4 are read; export with one of these"
        );
        ensure!(
            fraction_bits <= 23,
            "spz fractional bits: there are {fraction_bits} in a 24-bit position; \
         at most 23 make sense; export again"
        );
        ensure!(
            flags & FLAG_EXTENSIONS == 0,
            "spz flags: the file carries extensions, which may change the meaning of its harmonics; \
         export it without extensions"
        );
        Ok(SpzHeader {
            version,
            count,
            degree,
            fraction_bits,
            antialiased: flags & FLAG_ANTIALIASED != 0,
            reserved,
        })
    }

    /// Bytes per Gaussian of each array.
    fn record_bytes(&self) -> [usize; 6] {
        let position = if self.version == 1 { 6 } else { 9 };
        let rotation = if self.version < 3 { 3 } else { 4 };
        let harmonics = 3 * coefficient_count(self.degree);
        [position, 1, 3, 3, rotation, harmonics]
    }

    /// Size of the unpacked file: the largest count times the largest record fits easily.
    fn file_bytes(&self) -> u64 {
        let record: usize = self.record_bytes().iter().sum();
        HEADER_BYTES as u64 + u64::from(self.count) * record as u64
    }
}

fn unsupported_version(version: &str) -> Problem {
    anyhow!("spz version: it is {version}; versions 1 to 4 are read; convert to one of these")
}

/// One Gaussian from its part of each array.
fn gaussian(
    [place, opacity, colour, scale, rotation, _]: [&[u8]; 6],
    fraction_bits: u8,
) -> Gaussian {
    let [x, y, z, w] = match *rotation {
        [x, y, z] => rotation_first_three([x, y, z]),
        [b0, b1, b2, b3] => rotation_smallest_three(u32::from_le_bytes([b0, b1, b2, b3])),
        _ => [0.0; 4],
    };
    let constant = |k: usize| (f64::from(colour[k]) / 255.0 - 0.5) / COLOUR_SCALE;
    Gaussian {
        centre: position(place, fraction_bits),
        scales: [0, 1, 2].map(|k| scale_from_log(f64::from(scale[k]) / 16.0 - 10.0)),
        rotation: [w, x * FLIP[0], y * FLIP[1], z * FLIP[2]],
        opacity: f64::from(opacity[0]) / 255.0,
        base: [0, 1, 2].map(|k| base_from_coefficient(constant(k))),
    }
}

/// Three half floats, or three 24-bit integers.
fn position(stored: &[u8], fraction_bits: u8) -> [f64; 3] {
    let unit = f64::from(1u32 << fraction_bits);
    let size = stored.len() / 3;
    let place = |axis: usize| match stored[axis * size..(axis + 1) * size] {
        [low, high] => f16::from_le_bytes([low, high]).to_f64(),
        // In the top three bytes the sign is in place; the shift back is arithmetic.
        [low, middle, high] => f64::from(i32::from_le_bytes([0, low, middle, high]) >> 8) / unit,
        _ => f64::NAN,
    };
    [0, 1, 2].map(|axis| FLIP[axis] * place(axis))
}

/// Versions 1 and 2: x, y, z, w.
fn rotation_first_three(stored: [u8; 3]) -> [f64; 4] {
    let [x, y, z] = stored.map(|byte| f64::from(byte) / 127.5 - 1.0);
    [x, y, z, (1.0 - x * x - y * y - z * z).max(0.0).sqrt()]
}

/// Versions 3 and 4: x, y, z, w; from the lowest bit up the three stand the other way round.
fn rotation_smallest_three(stored: u32) -> [f64; 4] {
    let largest = 3 - (stored >> 30) as usize;
    let others = [0, 10, 20].map(|shift| {
        let magnitude = f64::from(stored >> shift & 511) / 511.0;
        let is_negative = stored >> shift & 512 != 0;
        if is_negative { -magnitude } else { magnitude }
    });
    let [w, z, y, x] = smallest_three(largest, others);
    [x, y, z, w]
}

/// Sign that each harmonic takes when y and z are negated: each is even or odd, so one direction tells.
fn harmonic_parities() -> [f32; HARMONICS] {
    let direction = [0.8, 0.5, 0.33];
    let flipped = [0, 1, 2].map(|axis| direction[axis] * FLIP[axis]);
    let (before, after) = (harmonic_basis(direction), harmonic_basis(flipped));
    std::array::from_fn(|k| {
        if before[k] * after[k] < 0.0 {
            -1.0
        } else {
            1.0
        }
    })
}

#[cfg(test)]
#[path = "spz_tests.rs"]
mod tests;
