//! `.spz`, versions 2 and 3: a gzip stream of a 16-byte header and one array per attribute.
//!
//! | array | bytes per Gaussian | decoding |
//! |---|---|---|
//! | position | 3 x 3 | signed 24-bit fixed point with the header's number of fractional bits |
//! | opacity | 1 | / 255 |
//! | colour | 3 | `f_dc = (byte / 255 - 0.5) / 0.15` |
//! | scale | 3 | logarithm = `byte / 16 - 10` |
//! | rotation, version 2 | 3 | x, y, z = `byte / 127.5 - 1`, w >= 0 makes the length 1 |
//! | rotation, version 3 | 4 | "smallest three": top 2 bits name the largest of x, y, z, w; the others follow, sign and 9-bit magnitude of sqrt(1/2) |
//! | harmonics | 3 per coefficient | `(byte - 128) / 128`, colour channel fastest |
//!
//! The format's axes are right, up, back, while the trainers' are right, down, front: y and z are negated here, in
//! positions, in quaternions and in the harmonics that are odd in them.

use super::Scene;
use super::bytes::{Reader, gunzip_at_most, gunzip_exact};
use super::error::Problem;
use super::gaussian::{
    Gaussian, GaussianScene, base_from_coefficient, coefficient_count, harmonic_basis,
    scale_from_log,
};

const MAGIC: &[u8; 4] = b"NGSP";
const HEADER_BYTES: usize = 16;
const COLOUR_SCALE: f64 = 0.15;
/// Flag of a file with extension records after the arrays.
const FLAG_EXTENSIONS: u8 = 2;
/// What turns right-up-back into right-down-front.
const FLIP: [f64; 3] = [1.0, -1.0, -1.0];

/// Loads a `.spz` file.
pub(super) fn load(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    if bytes.starts_with(MAGIC) {
        return Err(unsupported_version("4 or later (not gzip-packed)"));
    }
    let header = Header::parse(&gunzip_at_most(bytes, HEADER_BYTES as u64, "spz header")?)?;
    let unpacked = gunzip_exact(bytes, header.file_bytes(), "spz data")?;
    let mut reader = Reader::new(&unpacked);
    reader.take(HEADER_BYTES, "spz header")?;
    let arrays = Arrays::split(&mut reader, &header)?;
    let mut scene = GaussianScene::new(header.degree);
    let parities = harmonic_parities();
    let mut harmonics = vec![[0.0f32; 3]; coefficient_count(header.degree)];
    for index in 0..header.count as usize {
        arrays.read_harmonics(index, &parities, &mut harmonics);
        scene.push(&arrays.gaussian(index, &header, &harmonics));
    }
    scene.finish(name)
}

struct Header {
    /// Bytes of a rotation: 3 in version 2, 4 in version 3.
    rotation_bytes: usize,
    count: u32,
    degree: u8,
    fraction_bits: u8,
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Header, Problem> {
        let mut reader = Reader::new(bytes);
        let magic: [u8; 4] = reader.array("spz magic")?;
        if magic != *MAGIC {
            return Err(Problem::malformed(
                "spz magic",
                "it is not 'NGSP'",
                "check that this is a .spz file",
            ));
        }
        let rotation_bytes = match u32::from_le_bytes(reader.array("spz version")?) {
            2 => 3,
            3 => 4,
            other => return Err(unsupported_version(&other.to_string())),
        };
        let count = u32::from_le_bytes(reader.array("spz count")?);
        let [degree, fraction_bits, flags, _] = reader.array("spz header")?;
        check_header(count, degree, fraction_bits, flags)?;
        Ok(Header {
            rotation_bytes,
            count,
            degree,
            fraction_bits,
        })
    }

    /// Size of the unpacked file: the largest count times the largest record fits easily.
    fn file_bytes(&self) -> u64 {
        let record = 9 + 1 + 3 + 3 + self.rotation_bytes + 3 * coefficient_count(self.degree);
        HEADER_BYTES as u64 + u64::from(self.count) * record as u64
    }
}

fn check_header(count: u32, degree: u8, fraction_bits: u8, flags: u8) -> Result<(), Problem> {
    if count == 0 {
        return Err(Problem::malformed(
            "spz count",
            "it is 0",
            "export a scene with splats in it",
        ));
    }
    if degree > 3 {
        return Err(Problem::malformed(
            "spz harmonics degree",
            format!("it is {degree}"),
            "degrees 0 to 3 are read; export with one of these",
        ));
    }
    if fraction_bits > 23 {
        return Err(Problem::malformed(
            "spz fractional bits",
            format!("there are {fraction_bits} in a 24-bit position"),
            "at most 23 make sense; export again",
        ));
    }
    if flags & FLAG_EXTENSIONS != 0 {
        return Err(Problem::malformed(
            "spz flags",
            "the file carries extensions, which may change the meaning of its harmonics",
            "export it without extensions",
        ));
    }
    Ok(())
}

fn unsupported_version(version: &str) -> Problem {
    Problem::malformed(
        "spz version",
        format!("it is {version}"),
        "versions 2 and 3 are read; convert to one of these",
    )
}

/// The attribute arrays, each sliced per Gaussian.
struct Arrays<'a> {
    positions: &'a [[u8; 9]],
    opacities: &'a [u8],
    colours: &'a [[u8; 3]],
    scales: &'a [[u8; 3]],
    rotations: &'a [u8],
    harmonics: &'a [[u8; 3]],
}

impl<'a> Arrays<'a> {
    fn split(reader: &mut Reader<'a>, header: &Header) -> Result<Self, Problem> {
        let count = u64::from(header.count);
        Ok(Arrays {
            positions: reader.records(count, 9, "spz positions")?.as_chunks().0,
            opacities: reader.records(count, 1, "spz opacities")?,
            colours: reader.records(count, 3, "spz colours")?.as_chunks().0,
            scales: reader.records(count, 3, "spz scales")?.as_chunks().0,
            rotations: reader.records(count, header.rotation_bytes, "spz rotations")?,
            harmonics: reader
                .records(count, 3 * coefficient_count(header.degree), "spz harmonics")?
                .as_chunks()
                .0,
        })
    }

    fn gaussian<'h>(
        &self,
        index: usize,
        header: &Header,
        harmonics: &'h [[f32; 3]],
    ) -> Gaussian<'h> {
        let size = header.rotation_bytes;
        let rotation = match self.rotations[index * size..(index + 1) * size] {
            [x, y, z] => rotation_first_three([x, y, z]),
            [b0, b1, b2, b3] => rotation_smallest_three(u32::from_le_bytes([b0, b1, b2, b3])),
            _ => [0.0; 4],
        };
        let [x, y, z, w] = rotation;
        let constant =
            self.colours[index].map(|byte| (f64::from(byte) / 255.0 - 0.5) / COLOUR_SCALE);
        Gaussian {
            centre: position(self.positions[index], header.fraction_bits),
            scales: self.scales[index].map(|byte| scale_from_log(f64::from(byte) / 16.0 - 10.0)),
            rotation: [w, x * FLIP[0], y * FLIP[1], z * FLIP[2]],
            opacity: f64::from(self.opacities[index]) / 255.0,
            base: constant.map(base_from_coefficient),
            harmonics,
        }
    }

    fn read_harmonics(&self, index: usize, parities: &[f32; 15], harmonics: &mut [[f32; 3]]) {
        let first = index * harmonics.len();
        let stored = &self.harmonics[first..first + harmonics.len()];
        for ((coefficient, bytes), parity) in harmonics.iter_mut().zip(stored).zip(parities) {
            *coefficient = bytes.map(|byte| parity * (f32::from(byte) - 128.0) / 128.0);
        }
    }
}

fn position(stored: [u8; 9], fraction_bits: u8) -> [f64; 3] {
    let unit = f64::from(1u32 << fraction_bits);
    [0, 1, 2].map(|axis| {
        let bytes = [
            0,
            stored[3 * axis],
            stored[3 * axis + 1],
            stored[3 * axis + 2],
        ];
        // In the top three bytes the sign is in place; the shift back is arithmetic.
        FLIP[axis] * f64::from(i32::from_le_bytes(bytes) >> 8) / unit
    })
}

/// Version 2: x, y, z, w.
fn rotation_first_three(stored: [u8; 3]) -> [f64; 4] {
    let [x, y, z] = stored.map(|byte| f64::from(byte) / 127.5 - 1.0);
    [x, y, z, (1.0 - x * x - y * y - z * z).max(0.0).sqrt()]
}

/// Version 3: x, y, z, w.
fn rotation_smallest_three(stored: u32) -> [f64; 4] {
    let largest = (stored >> 30) as usize;
    let mut rotation = [0.0; 4];
    let mut bits = stored;
    let mut squares = 0.0;
    for part in (0..4).rev().filter(|&part| part != largest) {
        let magnitude = f64::from(bits & 511) / 511.0 * std::f64::consts::FRAC_1_SQRT_2;
        rotation[part] = if bits & 512 == 0 {
            magnitude
        } else {
            -magnitude
        };
        squares += magnitude * magnitude;
        bits >>= 10;
    }
    rotation[largest] = f64::max(0.0, 1.0 - squares).sqrt();
    rotation
}

/// Sign that each harmonic takes when y and z are negated: each is even or odd, so one direction tells.
fn harmonic_parities() -> [f32; 15] {
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
