//! Files in a zip archive.
//!
//! Apart from its reader because of WebAssembly: the library's own dependencies bind JavaScript there, for times and random numbers that reading
//! does not need, and the live page, which holds this crate for its engines, reads no files. There every archive is refused.

#[cfg(not(target_family = "wasm"))]
pub(super) use unpacked::Archive;

#[cfg(target_family = "wasm")]
pub(super) use refused::Archive;

#[cfg(not(target_family = "wasm"))]
mod unpacked {
    use std::cell::RefCell;
    use std::io::{Cursor, Read};
    use zip::ZipArchive;

    pub struct Archive<'a>(RefCell<ZipArchive<Cursor<&'a [u8]>>>);

    impl<'a> Archive<'a> {
        pub fn open(bytes: &'a [u8]) -> Result<Self, String> {
            let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
            Ok(Archive(RefCell::new(archive)))
        }

        /// The bytes of one file, of `limit` and one bytes at most.
        pub fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, String> {
            let mut archive = self.0.borrow_mut();
            let entry = archive.by_name(file).map_err(|error| error.to_string())?;
            let mut bytes = Vec::new();
            entry
                .take(limit.saturating_add(1))
                .read_to_end(&mut bytes)
                .map_err(|error| error.to_string())?;
            Ok(bytes)
        }
    }
}

#[cfg(target_family = "wasm")]
mod refused {
    use std::marker::PhantomData;

    pub struct Archive<'a>(PhantomData<&'a [u8]>);

    impl<'a> Archive<'a> {
        pub fn open(_: &'a [u8]) -> Result<Self, String> {
            Err("archives are not read in WebAssembly".to_owned())
        }

        pub fn read(&self, _: &str, _: u64) -> Result<Vec<u8>, String> {
            Err("archives are not read in WebAssembly".to_owned())
        }
    }
}
