//! Any bytes as a camera, cameras of other tools, a camera path, transfer function, design, machine, prices or space:
//! an answer and its use, never a panic.
#![no_main]

mod readers;

pub use readers::seeds;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::read(
    bytes,
    &[
        "camera",
        "images",
        "transforms",
        "path",
        "transfer",
        "design",
        "machine",
        "prices",
        "space"
    ]
));
