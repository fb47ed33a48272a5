//! What every reader of bytes from strangers is tested with.

use super::error::Problem;
use std::io::Write;

/// Cut at every byte the file is refused; with any byte changed there is an answer and no panic.
pub(super) fn survives<T>(whole: &[u8], load: &dyn Fn(&[u8]) -> Result<T, Problem>) {
    assert!(load(whole).is_ok(), "sound as a whole");
    for length in 0..whole.len() {
        let cut = load(&whole[..length]);
        let message = cut
            .err()
            .unwrap_or_else(|| panic!("cut at {length} was read"));
        assert!(
            message.to_string().contains("; "),
            "cut at {length}: {message} names no fix"
        );
    }
    for place in 0..whole.len() {
        for flip in [0x01, 0x10, 0x80, 0xff] {
            let mut bytes = whole.to_vec();
            bytes[place] ^= flip;
            let _ = load(&bytes);
        }
    }
}

/// A refusal says what the test expects, and both are shown where it does not.
pub(super) fn assert_told(found: impl AsRef<str>, expected: impl AsRef<str>) {
    let (found, expected) = (found.as_ref(), expected.as_ref());
    assert!(
        found.contains(expected),
        "found    {found}\nexpected {expected}"
    );
}

/// Packs as `gzip` does.
pub(super) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
