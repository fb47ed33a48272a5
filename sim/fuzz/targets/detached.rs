//! Any bytes as an NRRD header and the data file beside it: a scene or an error, never a panic.
//!
//! The first byte says which share of the rest is the header. Every `data file: NAME` that the header may give is
//! looked for in a folder that holds the rest under the name `data`.
#![no_main]

use splatline_sim::scene::{LoadOptions, load};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((share, rest)) = bytes.split_first() else {
        return;
    };
    let (header, data) = rest.split_at(rest.len() * usize::from(*share) / 256);
    let folder = std::env::temp_dir().join(format!("splatline-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the folder for temporary files is writable");
    for (name, content) in [("header.nhdr", header), ("data", data)] {
        std::fs::write(folder.join(name), content).expect("the folder is writable");
    }
    let _ = load(&folder.join("header.nhdr"), &LoadOptions::default());
});
