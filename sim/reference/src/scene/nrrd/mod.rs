//! NRRD volumes: `.nrrd` with the data attached, `.nhdr` with the data in a file beside it.
//!
//! Three dimensions; 8- and 16-bit integers and f32 in both byte orders; raw or gzip. Voxel spacings come from
//! `spacings` or from the lengths of axis-aligned `space directions`, and are 1 where the header is silent. The grid's
//! axes are kept as stored: the data are never mirrored or permuted. Numbers are kept as f32, which holds every value
//! of these types exactly.

mod header;
#[cfg(test)]
mod tests;

use std::path::Path;

use super::bytes::{checked_bytes, gunzip_exact, truncated};
use super::error::Problem;
use super::read_file;
use header::{Encoding, NrrdHeader};

/// A regular grid of numbers, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Volume {
    /// Voxels along x, y and z.
    pub(super) sizes: [usize; 3],
    /// Distance between neighbours along x, y and z, scene units.
    pub(super) spacings: [f64; 3],
    pub(super) values: Vec<f32>,
}

/// Loads a volume; `folder` is where a detached header's data file is looked for.
pub(super) fn load(bytes: &[u8], folder: Option<&Path>) -> Result<Volume, Problem> {
    let (header, attached) = header::parse(bytes)?;
    let needed = data_bytes(&header)?;
    let values = match (&header.data_file, attached) {
        (Some(data_file), _) => {
            let path = folder.unwrap_or(Path::new("")).join(data_file);
            let data = read_file(&path).map_err(|problem| unreadable(data_file, &problem))?;
            decode(&header, &data, needed)?
        }
        (None, Some(data)) => decode(&header, data, needed)?,
        (None, None) => {
            return Err(Problem::malformed(
                "NRRD header",
                "it ends without the blank line before the data, and names no data file",
                "add the data, or a 'data file: NAME' line",
            ));
        }
    };
    Ok(Volume {
        sizes: header.sizes,
        spacings: header.spacings,
        values,
    })
}

fn data_bytes(header: &NrrdHeader) -> Result<u64, Problem> {
    let mut bytes = header.kind.size() as u64;
    for size in header.sizes {
        bytes = checked_bytes(bytes, size as u64, "sizes")?;
    }
    Ok(bytes)
}

fn decode(header: &NrrdHeader, data: &[u8], needed: u64) -> Result<Vec<f32>, Problem> {
    let number = |stored: &[u8]| header.kind.decode(stored, header.endian) as f32;
    let unpacked;
    let bytes = match header.encoding {
        Encoding::Raw => exact(data, needed)?,
        Encoding::Gzip => {
            unpacked = gunzip_exact(data, needed, "volume data")?;
            &unpacked
        }
    };
    Ok(bytes.chunks_exact(header.kind.size()).map(number).collect())
}

/// Raw data must be as long as the header says: anything else is another volume's header.
fn exact(data: &[u8], needed: u64) -> Result<&[u8], Problem> {
    let found = data.len() as u64;
    if found < needed {
        return Err(truncated("volume data", needed, data.len()));
    }
    if found > needed {
        return Err(Problem::malformed(
            "volume data",
            format!("there are {found} bytes where sizes and type need {needed}"),
            "correct sizes or type in the header",
        ));
    }
    Ok(data)
}

fn unreadable(data_file: &str, problem: &Problem) -> Problem {
    Problem::malformed(
        format!("data file '{data_file}'"),
        format!("it {problem}"),
        "put the data beside the header or correct the name",
    )
}
