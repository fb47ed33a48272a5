//! NRRD volumes: `.nrrd` with the data attached, `.nhdr` with the data in a file beside it.
//!
//! Three dimensions; 8- and 16-bit integers and f32 in both byte orders; raw or gzip. Voxel spacings come from
//! `spacings` or from the lengths of axis-aligned `space directions`, and are 1 where the header is silent. The grid's
//! axes are kept as stored (see [`super::volume`]).

mod header;
#[cfg(test)]
mod tests;

use super::error::Problem;
use super::volume::{Volume, data_file};
use anyhow::bail;
use std::path::Path;

/// Loads a volume; `folder` is where a detached header's data file is looked for.
pub(super) fn load(bytes: &[u8], folder: Option<&Path>) -> Result<Volume, Problem> {
    let (header, attached) = header::parse(bytes)?;
    let grid = header.grid;
    let values = match (&header.data_file, attached) {
        (Some(name), _) => grid.unpack(&data_file(name, folder)?, header.packing, "sizes")?,
        (None, Some(data)) => grid.unpack(data, header.packing, "sizes")?,
        (None, None) => bail!(
            "NRRD header: it ends without the blank line before the data, and names no data file; \
             add the data, or a 'data file: NAME' line"
        ),
    };
    Ok(grid.volume(values))
}
