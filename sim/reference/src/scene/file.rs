//! The bytes of a scene's files: regular files, or stdin, if they fit into memory.

use super::error::{Problem, unreadable};
use crate::{input, memory};
use anyhow::ensure;
use std::fs;
use std::io::Read;
use std::path::Path;

/// Bytes of stdin that are read at once.
const PART: u64 = 1 << 24;

/// A regular file's bytes, or all of stdin for `-`. Other pipes and devices are refused: they may never end.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, Problem> {
    if path == Path::new("-") {
        return read_stream(std::io::stdin().lock());
    }
    let metadata = fs::metadata(path).map_err(unreadable)?;
    ensure!(
        metadata.is_file(),
        "is not a regular file; name a scene file"
    );
    input::note(path);
    let mut bytes = memory::list(metadata.len(), "the file's bytes")?;
    // It may have grown since.
    let file = fs::File::open(path).map_err(unreadable)?;
    let read = file.take(metadata.len()).read_to_end(&mut bytes);
    read.map_err(unreadable)?;
    Ok(bytes)
}

/// Its length is known at its end only, so there must be room whenever the list of bytes grows.
fn read_stream(mut stream: impl Read) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    loop {
        let length = bytes.len() as u64;
        memory::room_for(length + PART, "what stdin brings", memory::FIX)?;
        let part = stream.by_ref().take(PART).read_to_end(&mut bytes);
        if part.map_err(unreadable)? == 0 {
            return Ok(bytes);
        }
    }
}
