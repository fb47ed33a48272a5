//! Files in a zip archive.
//!
//! Apart from its reader because of WebAssembly: the library's own dependencies bind JavaScript there, for times and
//! random numbers that reading does not need, and the live page, which holds this crate for its engines, reads no
//! files. There every archive is refused.

/// What gives the bytes of one file of an archive, of a limit and one bytes at most.
pub(super) type FileReader<'a> = Box<dyn Fn(&str, u64) -> Result<Vec<u8>, String> + 'a>;

/// The files of an archive.
#[cfg(not(target_family = "wasm"))]
pub(super) fn unpacked(bytes: &[u8]) -> Result<FileReader<'_>, String> {
    use std::cell::RefCell;
    use std::io::{Cursor, Read};

    let archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let archive = RefCell::new(archive);
    Ok(Box::new(move |file, limit| {
        let mut archive = archive.borrow_mut();
        let entry = archive.by_name(file).map_err(|error| error.to_string())?;
        let mut bytes = Vec::new();
        let read = entry.take(limit.saturating_add(1)).read_to_end(&mut bytes);
        read.map_err(|error| error.to_string())?;
        Ok(bytes)
    }))
}

#[cfg(target_family = "wasm")]
pub(super) fn unpacked(_: &[u8]) -> Result<FileReader<'_>, String> {
    Err("archives are not read in WebAssembly".to_owned())
}
