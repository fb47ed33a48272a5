//! What every reader of bytes from strangers is tested with.

use super::error::Problem;
use std::io::Write;

/// Cut at every byte the file is refused; with any byte changed there is an answer and no panic.
pub(super) fn survives<T>(whole: &[u8], load: &dyn Fn(&[u8]) -> Result<T, Problem>) {
    survives_at(whole, 0..whole.len(), load);
}

/// The same at some of its bytes.
pub(super) fn survives_at<T>(
    whole: &[u8],
    places: impl Iterator<Item = usize> + Clone,
    load: &dyn Fn(&[u8]) -> Result<T, Problem>,
) {
    assert!(load(whole).is_ok(), "sound as a whole");
    for length in places.clone() {
        let cut = load(&whole[..length]);
        let message = cut
            .err()
            .unwrap_or_else(|| panic!("cut at {length} was read"));
        assert!(
            message.to_string().contains("; "),
            "cut at {length}: {message} names no fix"
        );
    }
    answers_at(whole, places, load);
}

/// With any of these bytes changed there is an answer and no panic.
pub(super) fn answers_at<T>(
    whole: &[u8],
    places: impl Iterator<Item = usize>,
    load: &dyn Fn(&[u8]) -> Result<T, Problem>,
) {
    for place in places {
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

/// Every file is refused by what stands beside it.
pub(super) fn assert_refused<T>(
    cases: &[(impl AsRef<[u8]>, &str)],
    load: impl Fn(&[u8]) -> Result<T, Problem>,
) {
    for (bytes, expected) in cases {
        let refused = load(bytes.as_ref()).err();
        let refused = refused.unwrap_or_else(|| panic!("read, but expected {expected}"));
        assert_told(refused.to_string(), expected);
    }
}

/// The rows of a table of cases, their cells between `=>` and without the blanks around them; `\n` in a cell is a
/// newline.
pub(super) fn rows<const N: usize>(table: &str) -> impl Iterator<Item = [String; N]> {
    let lines = table.lines().filter(|line| !line.trim().is_empty());
    lines.map(|line| {
        let cells = line
            .split("=>")
            .map(|cell| cell.trim().replace("\\n", "\n"));
        let cells: Result<[String; N], _> = cells.collect::<Vec<_>>().try_into();
        cells.unwrap_or_else(|cells| panic!("{line}: {} cells", cells.len()))
    })
}

/// A text is refused when one part of it, which must be there, is replaced: a row has the part, what stands in its
/// place, and what is told.
pub(super) fn assert_refused_with<T>(
    whole: &[u8],
    table: &str,
    load: impl Fn(&[u8]) -> Result<T, Problem>,
) {
    for [from, to, expected] in rows(table) {
        assert_refused(&[(replaced(whole, &from, &to), &*expected)], &load);
    }
}

/// A file is refused when some of its bytes are others: a row has their place, the bytes in hexadecimal, and what is
/// told.
pub(super) fn assert_refused_at<T>(
    whole: &[u8],
    table: &str,
    load: impl Fn(&[u8]) -> Result<T, Problem>,
) {
    for [place, bytes, expected] in rows(table) {
        let mut changed = whole.to_vec();
        let place: usize = place.parse().unwrap();
        for (byte, digits) in changed[place..].iter_mut().zip(bytes.split(' ')) {
            *byte = u8::from_str_radix(digits, 16).unwrap();
        }
        assert_refused(&[(changed, &*expected)], &load);
    }
}

/// A text with one part replaced, which must be there.
pub(super) fn replaced(whole: &[u8], from: &str, to: &str) -> Vec<u8> {
    let mut parts = whole.windows(from.len());
    let place = parts.position(|part| part == from.as_bytes());
    let place = place.unwrap_or_else(|| panic!("there is no {from}"));
    [&whole[..place], to.as_bytes(), &whole[place + from.len()..]].concat()
}

/// Packs as `gzip` does.
pub(super) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
