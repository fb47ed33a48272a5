//! Clouds as laspy wrote them (`tests/files/make.py`), and what is refused.

use super::*;
#[cfg(feature = "laz")]
use crate::scene::damage_tests::assert_refused;
use crate::scene::damage_tests::{answers_at, assert_refused_at};
use crate::scene::points;
use std::path::Path;

fn bytes(name: &str) -> Vec<u8> {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files");
    std::fs::read(files.join(name)).unwrap()
}

/// The twelve points of every file.
fn expected() -> Vec<([f64; 3], [f64; 3])> {
    let point = |k: usize| {
        let place = [500_000 + k % 4, 4_500_000 + k / 4, 100].map(|part| part as f64);
        let colour = [1000 * k, 65_535 - 1000 * k, 500 * k].map(|part| part as f64 / 65_535.0);
        ([place[0], place[1], place[2] + k as f64 / 2.0], colour)
    };
    (0..12).map(point).collect()
}

fn check(name: &str) {
    let cloud = cloud(&bytes(name)).unwrap_or_else(|problem| panic!("{name}: {problem}"));
    assert_eq!(cloud.records.len(), 12, "{name}");
    for (record, (place, colour)) in cloud.records.iter().zip(expected()) {
        let apart = crate::vector::length(crate::vector::subtract(record.centre, place));
        assert!(apart < 1e-9, "{name} {record:?}");
        assert_eq!(record.colour, Some(colour), "{name}");
    }
    assert_eq!(cloud.notes, [""; 0]);
}

#[test]
fn plain_files_of_laspy_are_read() {
    check("old.las");
    check("new.las");
}

#[cfg(feature = "laz")]
#[test]
fn packed_files_of_laspy_are_read() {
    check("old.laz");
    check("new.laz");
}

#[cfg(not(feature = "laz"))]
#[test]
fn a_packed_file_names_the_feature() {
    let message = cloud(&bytes("old.laz")).unwrap_err().to_string();
    assert!(
        message.contains("build it with `cargo build --features laz`"),
        "{message}"
    );
}

/// Twice the points, so that the file that a surface is made of is read by the entrance of the command line as well.
#[test]
fn a_cloud_goes_through_the_entrance_of_the_command_line() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/new.las");
    let scene = points::load(&file).unwrap();
    assert_eq!((scene.points.len(), scene.coloured), (12, true));
    let as_splats = crate::scene::load(&file, &Default::default()).unwrap_err();
    assert!(
        as_splats
            .to_string()
            .ends_with("new.las: is a file of points; add --as surface")
    );
}

/// Cut anywhere an answer or the whole: behind the points of a packed file lies only the table that seeking needs.
#[test]
fn damaged_clouds_are_refused() {
    let names: &[&str] = if cfg!(feature = "laz") {
        &["old.las", "new.las", "old.laz", "new.laz"]
    } else {
        &["old.las", "new.las"]
    };
    for name in names {
        let whole = bytes(name);
        let sound = cloud(&whole).unwrap();
        let mut read = 0;
        for length in 0..whole.len() {
            match cloud(&whole[..length]) {
                Ok(cut) => {
                    assert_eq!(cut, sound, "{name} cut at {length}");
                    read += 1;
                }
                Err(problem) => assert!(problem.to_string().contains("; "), "{name}: {problem}"),
            }
        }
        assert!(
            read < 40 && (name.ends_with("laz") || read == 0),
            "{name}: {read}"
        );
        answers_at(&whole, 0..whole.len(), &cloud);
    }
}

#[test]
fn messages_name_the_field_and_the_fix() {
    let table = r"
        0 => 58 => magic: it is not LASF; check
        25 => 09 => version: it is 1.9; 1.0 to 1.4 are read
        104 => 0b => point format: it is 11; 0 to 10 are read
        105 => 09 00 => record length: it is 9, and format 2 has 26; write
        107 => ff ff ff ff => point records: 111669149670 bytes are needed but 312 are left
        96 => 01 00 00 00 => sizes: header 227, points at 1; the header's own
    ";
    assert_refused_at(&bytes("old.las"), table, cloud);
}

/// The description of the packing follows the header and its record's own 54 bytes; its items, after 34, have a type, a
/// size and a version.
#[cfg(feature = "laz")]
#[test]
fn sizes_of_items_beyond_sixteen_bits_are_an_error() {
    let mut whole = bytes("old.laz");
    for item in whole[227 + 54 + 34..].chunks_exact_mut(6).take(2) {
        item[2..4].fill(255);
    }
    let expected = "packed record length: 131070 bytes beside records of 26";
    assert_refused(&[(whole, expected)], cloud);
}

#[test]
fn withheld_points_are_left_out_and_told_and_a_black_cloud_has_no_colours() {
    let mut whole = bytes("old.las");
    let first = whole.len() - 12 * 26;
    whole[first + 15] |= 0x80;
    let cloud_of = |bytes: &[u8]| cloud(bytes).unwrap();
    let found = cloud_of(&whole);
    assert_eq!(found.records.len(), 11);
    assert_eq!(found.notes, ["1 withheld points are left out"]);
    for record in whole[first..].chunks_exact_mut(26) {
        record[20..26].fill(0);
    }
    assert!(
        cloud_of(&whole)
            .records
            .iter()
            .all(|record| record.colour.is_none())
    );
    // Eight bits in the place of sixteen.
    for record in whole[first..].chunks_exact_mut(26) {
        record[20] = 255;
    }
    assert_eq!(cloud_of(&whole).records[0].colour, Some([1.0, 0.0, 0.0]));
}
