//! NIfTI-1 and NIfTI-2 volumes (`.nii`, `.nii.gz`): a header of 348 or 540 bytes at fixed offsets, and the numbers at
//! `vox_offset`.
//!
//! | field | NIfTI-1 | NIfTI-2 |
//! |---|---|---|
//! | `sizeof_hdr` i32, which also tells the byte order | 0: 348 | 0: 540 |
//! | `dim` | 40: 8 i16 | 16: 8 i64 |
//! | `datatype` i16 | 70 | 12 |
//! | `pixdim` | 76: 8 f32 | 104: 8 f64 |
//! | `vox_offset` | 108: f32 | 168: i64 |
//! | `scl_slope`, `scl_inter` | 112: f32 | 176: f64 |
//! | `qform_code`, `sform_code` | 252: i16 | 344: i32 |
//!
//! Own code: the crate `nifti` brings 21 crates for these offsets, and sets aside what a header claims before a byte of
//! it has been seen (docs/decisions/dependencies.md). Values are `slope stored + inter` where the slope is not 0.

use super::super::bytes::{Endian, Scalar, gunzip_at_most, gunzip_exact, truncated};
use super::super::error::Problem;
use super::{Grid, Volume, exact, is_spacing, turned};
use anyhow::{bail, ensure};

/// Bytes of the longer header.
const LONGEST_HEADER: u64 = 540;
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// Farthest begin of the numbers: behind extensions, which hold text.
const MAX_OFFSET: f64 = 1e9;

/// Where the numbers of a field begin, and their type.
type Place = (usize, Scalar);

/// Where a version keeps its fields.
struct NiftiLayout {
    dim: Place,
    datatype: Place,
    pixdim: Place,
    offset: Place,
    slope: Place,
    codes: Place,
    magic: usize,
    single: &'static [u8],
}

const FIRST: NiftiLayout = NiftiLayout {
    dim: (40, Scalar::I16),
    datatype: (70, Scalar::I16),
    pixdim: (76, Scalar::F32),
    offset: (108, Scalar::F32),
    slope: (112, Scalar::F32),
    codes: (252, Scalar::I16),
    magic: 344,
    single: b"n+1\0",
};
const SECOND: NiftiLayout = NiftiLayout {
    dim: (16, Scalar::I64),
    datatype: (12, Scalar::I16),
    pixdim: (104, Scalar::F64),
    offset: (168, Scalar::I64),
    slope: (176, Scalar::F64),
    codes: (344, Scalar::I32),
    magic: 4,
    single: b"n+2\0",
};

/// Is this a NIfTI file, not packed?
pub(in super::super) fn is_nifti(bytes: &[u8]) -> bool {
    [FIRST, SECOND].iter().any(|layout| {
        let magic = bytes.get(layout.magic..layout.magic + 4);
        magic == Some(layout.single)
    })
}

/// Loads a volume, packed or not.
pub(in super::super) fn load(bytes: &[u8]) -> Result<Volume, Problem> {
    if !bytes.starts_with(&GZIP) {
        let header = Header::read(bytes)?;
        let data = bytes.get(header.offset..).unwrap_or_default();
        let needed = header.grid.bytes("dim")?;
        return header.volume(exact(data, needed)?);
    }
    let begin = gunzip_at_most(bytes, LONGEST_HEADER, "NIfTI file")?;
    let header = Header::read(&begin)?;
    let needed = header.grid.bytes("dim")?;
    let whole = needed.saturating_add(header.offset as u64);
    let unpacked = gunzip_exact(bytes, whole, header.grid.value_bytes(), "NIfTI file")?;
    header.volume(unpacked.get(header.offset..).unwrap_or_default())
}

/// What a header says.
struct Header {
    grid: Grid,
    /// Where the numbers begin.
    offset: usize,
    /// Values are the first times what is stored, plus the second.
    scale: [f64; 2],
    is_turned: bool,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Header, Problem> {
        let size: [u8; 4] = bytes
            .first_chunk()
            .copied()
            .ok_or_else(|| truncated("NIfTI header", 348, bytes.len()))?;
        let (layout, endian) = match (i32::from_le_bytes(size), i32::from_be_bytes(size)) {
            (348, _) => (&FIRST, Endian::Little),
            (_, 348) => (&FIRST, Endian::Big),
            (540, _) => (&SECOND, Endian::Little),
            (_, 540) => (&SECOND, Endian::Big),
            (other, _) => bail!(
                "NIfTI header, sizeof_hdr: it is {other}; 348 and 540 are read; \
                 check that this is a NIfTI file"
            ),
        };
        let length = if layout.magic == 4 { 540 } else { 348 };
        if bytes.len() < length {
            return Err(truncated("NIfTI header", length as u64, bytes.len()));
        }
        ensure!(
            &bytes[layout.magic..layout.magic + 4] == layout.single,
            "NIfTI header, magic: it is not that of a single file; \
             join header (.hdr) and data (.img) in one .nii file"
        );
        let number = |(place, kind): Place, index: usize| {
            let stored = bytes.get(place + index * kind.size()..);
            kind.decode(stored.unwrap_or_default(), endian)
        };
        let kind = kind(number(layout.datatype, 0) as i16)?;
        Ok(Header {
            grid: Grid {
                sizes: sizes(std::array::from_fn(|index| number(layout.dim, index)))?,
                spacings: spacings([1, 2, 3].map(|axis| number(layout.pixdim, axis).abs()))?,
                kind,
                endian,
            },
            offset: offset(number(layout.offset, 0), length)?,
            scale: [0, 1].map(|index| number(layout.slope, index)),
            is_turned: (0..2).any(|index| number(layout.codes, index) != 0.0),
        })
    }

    fn volume(&self, data: &[u8]) -> Result<Volume, Problem> {
        let [slope, inter] = self.scale;
        let mut values = self.grid.decode(data)?;
        if slope != 0.0 && slope.is_finite() && inter.is_finite() && (slope, inter) != (1.0, 0.0) {
            for value in &mut values {
                *value = (slope * f64::from(*value) + inter) as f32;
            }
        }
        Ok(self.grid.volume(values, turned(self.is_turned)))
    }
}

fn kind(code: i16) -> Result<Scalar, Problem> {
    Ok(match code {
        2 => Scalar::U8,
        4 => Scalar::I16,
        8 => Scalar::I32,
        16 => Scalar::F32,
        64 => Scalar::F64,
        256 => Scalar::I8,
        512 => Scalar::U16,
        768 => Scalar::U32,
        other => bail!(
            "NIfTI header, datatype: it is {other}; \
             convert to integers of 8 to 32 bits or to floats, one per voxel"
        ),
    })
}

/// Three axes, after their number; further ones of one entry are no axes.
fn sizes(dim: [f64; 8]) -> Result<[usize; 3], Problem> {
    let [axes, x, y, z, further @ ..] = dim;
    let further = (4..)
        .zip(further)
        .filter(|(axis, _)| f64::from(*axis) <= axes);
    let single = further.into_iter().all(|(_, size)| size == 1.0);
    // A size that a double cannot hold exactly fits no file.
    let positive = [x, y, z].iter().all(|size| (1.0..=9e15).contains(size));
    if !(3.0..=7.0).contains(&axes) || !single || !positive {
        bail!(
            "NIfTI header, dim: it is {}; give one volume of three axes; \
             take one out of a series",
            dim.map(|size| size.to_string()).join(" ")
        );
    }
    Ok([x, y, z].map(|size| size as usize))
}

fn spacings(found: [f64; 3]) -> Result<[f64; 3], Problem> {
    ensure!(
        found.into_iter().all(is_spacing),
        "NIfTI header, pixdim: {found:?} are no distances between voxels; \
         write three positive lengths"
    );
    Ok(found)
}

fn offset(found: f64, least: usize) -> Result<usize, Problem> {
    ensure!(
        (least as f64..MAX_OFFSET).contains(&found) && found.fract() == 0.0,
        "NIfTI header, vox_offset: it is {found}; \
         the data of a single file begin behind its header; export the volume again"
    );
    Ok(found as usize)
}
