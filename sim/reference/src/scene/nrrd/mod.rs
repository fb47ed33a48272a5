//! NRRD volumes: `.nrrd` with the data attached, `.nhdr` with the data in a file beside it.
//!
//! Three dimensions; 8- and 16-bit integers and f32 in both byte orders; raw or gzip. Voxel spacings come from
//! `spacings` or from the lengths of axis-aligned `space directions`, and are 1 where the header is silent. The grid's
//! axes are kept as stored (see [`super::volume`]).

mod header;
#[cfg(test)]
mod tests;

use std::path::Path;

use super::bytes::gunzip_exact;
use super::error::Problem;
use super::file::read_file;
use super::volume::{Volume, exact, unreadable};
use header::{Encoding, NrrdHeader};

/// Loads a volume; `folder` is where a detached header's data file is looked for.
pub(super) fn load(bytes: &[u8], folder: Option<&Path>) -> Result<Volume, Problem> {
    let (header, attached) = header::parse(bytes)?;
    let needed = header.grid.bytes("sizes")?;
    let values = match (&header.data_file, attached) {
        (Some(data_file), _) => {
            let path = folder.unwrap_or(Path::new("")).join(data_file);
            let data =
                read_file(&path).map_err(|problem| unreadable(data_file, &path, &problem))?;
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
    Ok(header.grid.volume(values))
}

fn decode(header: &NrrdHeader, data: &[u8], needed: u64) -> Result<Vec<f32>, Problem> {
    match header.encoding {
        Encoding::Raw => header.grid.decode(exact(data, needed)?),
        Encoding::Gzip => {
            let unpacked = gunzip_exact(data, needed, header.grid.value_bytes(), "volume data")?;
            header.grid.decode(&unpacked)
        }
    }
}
