//! The readers of the mutation suite, fed from bytes: the first byte chooses the format, the rest is the file.

#[path = "../../tests/all/hostile/readers.rs"]
mod formats;
#[path = "../../tests/all/hostile/seeds.rs"]
pub mod seeds;

use formats::FORMATS;

/// Reads `bytes` as one of the formats whose names contain one of `kinds`; the outcome does not matter.
pub fn read(bytes: &[u8], kinds: &[&str]) {
    let Some((choice, rest)) = bytes.split_first() else {
        return;
    };
    let of_kind = |name: &str| kinds.iter().any(|kind| name.contains(kind));
    let formats: Vec<_> = FORMATS.iter().filter(|(name, _)| of_kind(name)).collect();
    let Some((name, reader)) = formats.get(usize::from(*choice) % formats.len().max(1)) else {
        return;
    };
    // A folder per format: some put files beside theirs.
    let folder = std::env::temp_dir().join(format!("splatline-fuzz-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the folder for temporary files is writable");
    let path = folder.join(name);
    std::fs::write(&path, rest).expect("the folder is writable");
    let _ = reader(&path);
}
