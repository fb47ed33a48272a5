//! What every volume format comes down to: a regular grid of numbers, read only after the file has been seen to hold
//! all of it.
//!
//! The grid's axes are kept as stored: the data are never mirrored, turned or permuted, and what a header says of its
//! place in a patient or a room is not applied. Numbers are kept as f32, which holds every value of 8 and 16 bits
//! exactly and rounds wider ones.

pub(super) mod header;
pub(super) mod meta_image;
pub(super) mod nifti;
#[cfg(test)]
mod tests;
#[cfg(feature = "vti")]
pub(super) mod vti;

use super::bytes::{Endian, Scalar, checked_bytes, gunzip_exact, truncated, unzlib_exact};
use super::error::{Problem, shorten};
use super::file::read_file;
use crate::memory;
use anyhow::{anyhow, ensure};
use std::path::Path;
use std::str::FromStr;

/// A regular grid of numbers, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Volume {
    /// Voxels along x, y and z.
    pub(super) sizes: [usize; 3],
    /// Distance between neighbours along x, y and z, scene units.
    pub(super) spacings: [f64; 3],
    pub(super) values: Vec<f32>,
    /// What its file says that is drawn otherwise here.
    pub(super) notes: Vec<String>,
}

/// How a volume's numbers are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    None,
    Gzip,
    Zlib,
}

/// What a header says of its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    pub(super) sizes: [usize; 3],
    pub(super) spacings: [f64; 3],
    pub(super) kind: Scalar,
    pub(super) endian: Endian,
}

impl Grid {
    /// Voxels, or an error naming the field if no machine could hold them.
    pub(super) fn count(&self, field: &str) -> Result<u64, Problem> {
        let mut count = 1;
        for size in self.sizes {
            count = checked_bytes(count, size as u64, field)?;
        }
        Ok(count)
    }

    /// Bytes of all numbers as stored.
    pub(super) fn bytes(&self, field: &str) -> Result<u64, Problem> {
        checked_bytes(self.count(field)?, self.kind.size() as u64, field)
    }

    /// Bytes of the values that they become.
    pub(super) fn value_bytes(&self) -> u64 {
        let sizes = self.sizes.map(|size| size as u64).into_iter();
        sizes.fold(size_of::<f32>() as u64, u64::saturating_mul)
    }

    /// The numbers in bytes that are as many as [`Self::bytes`].
    pub(super) fn decode(&self, stored: &[u8]) -> Result<Vec<f32>, Problem> {
        let number = |stored: &[u8]| self.kind.decode(stored, self.endian) as f32;
        let mut values = memory::list((stored.len() / self.kind.size()) as u64, "the voxels")?;
        values.extend(stored.chunks_exact(self.kind.size()).map(number));
        Ok(values)
    }

    /// The numbers in bytes that may be packed; `field` is what says how many there are.
    pub(super) fn unpack(
        &self,
        data: &[u8],
        packing: Packing,
        field: &str,
    ) -> Result<Vec<f32>, Problem> {
        let needed = self.bytes(field)?;
        let unpack = match packing {
            Packing::None => return self.decode(exact(data, needed)?),
            Packing::Gzip => gunzip_exact,
            Packing::Zlib => unzlib_exact,
        };
        self.decode(&unpack(data, needed, self.value_bytes(), "volume data")?)
    }

    pub(super) fn volume(&self, values: Vec<f32>, notes: Vec<String>) -> Volume {
        Volume {
            sizes: self.sizes,
            spacings: self.spacings,
            values,
            notes,
        }
    }
}

/// Raw data must be as long as the header says: anything else is another volume's header.
pub(super) fn exact(data: &[u8], needed: u64) -> Result<&[u8], Problem> {
    let found = data.len() as u64;
    if found < needed {
        return Err(truncated("volume data", needed, data.len()));
    }
    ensure!(
        found <= needed,
        "volume data: there are {found} bytes where sizes and type need {needed}; \
         correct sizes or type in the header"
    );
    Ok(data)
}

/// Far from both ends of single precision, so that a voxel's volume neither overflows nor vanishes.
pub(super) fn is_spacing(length: f64) -> bool {
    (1e-12..=1e12).contains(&length)
}

/// So many numbers in words, and no more.
pub(super) fn numbers<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let found: Option<Vec<T>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
    found?.try_into().ok()
}

/// Three distances between voxels.
pub(super) fn three_spacings(text: &str) -> Option<[f64; 3]> {
    numbers(text).filter(|lengths: &[f64; 3]| lengths.iter().copied().all(is_spacing))
}

/// The axes of a grid that is not turned.
const UNTURNED: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// The bytes of a data file that is named in a header, in the header's folder.
pub(super) fn data_file(name: &str, folder: Option<&Path>) -> Result<Vec<u8>, Problem> {
    let path = folder.unwrap_or(Path::new("")).join(name);
    read_file(&path).map_err(|problem| {
        let mut packed = path.into_os_string();
        packed.push(".gz");
        let name = shorten(name);
        let fix = if Path::new(&packed).is_file() {
            format!("unpack '{name}.gz', which lies in its place (gunzip)")
        } else {
            "put the data beside the header or correct the name".to_owned()
        };
        anyhow!("data file '{name}': it {problem}; {fix}")
    })
}

/// What is said of a header that turns or mirrors its grid.
pub(super) fn turned(is_turned: bool) -> Vec<String> {
    is_turned.then(|| TURNED.to_owned()).into_iter().collect()
}

const TURNED: &str = "its orientation is not applied: the grid is drawn along its own axes";
