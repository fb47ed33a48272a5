//! Tests of the NRRD reader: types, encodings, spacings, damage.

use crate::scene::damage_tests::{assert_told, gzip, survives};

use super::super::volume::Volume;
use super::*;

fn load(bytes: &[u8], folder: Option<&Path>) -> Result<Volume, Problem> {
    super::load(bytes, folder).map(|(volume, _)| volume)
}

/// A header of 2 x 1 x 2 voxels with some lines replaced or added.
fn header(kind: &str, encoding: &str, more: &str) -> String {
    format!(
        "NRRD0004\n# a comment\ntype: {kind}\ndimension: 3\nsizes: 2 1 2\nkey:=value\nencoding: {encoding}\n{more}"
    )
}

fn attached(kind: &str, encoding: &str, more: &str, data: &[u8]) -> Vec<u8> {
    [header(kind, encoding, more).as_bytes(), b"\n", data].concat()
}

fn values(bytes: &[u8]) -> Vec<f32> {
    load(bytes, None).unwrap().values
}

#[test]
fn types_and_byte_orders_are_read() {
    assert_eq!(
        values(&attached("uchar", "raw", "", &[1, 2, 3, 255])),
        [1.0, 2.0, 3.0, 255.0]
    );
    assert_eq!(
        values(&attached(
            "unsigned char",
            "gzip",
            "",
            &gzip(&[1, 2, 3, 255])
        )),
        [1.0, 2.0, 3.0, 255.0]
    );
    assert_eq!(
        values(&attached("int8", "raw", "", &[1, 2, 3, 255])),
        [1.0, 2.0, 3.0, -1.0]
    );
    let numbers = [-2i16, 300, 0, 32_767];
    let (little, big) = (
        numbers.map(i16::to_le_bytes).concat(),
        numbers.map(i16::to_be_bytes).concat(),
    );
    assert_eq!(
        values(&attached("short", "raw", "endian: little\n", &little)),
        [-2.0, 300.0, 0.0, 32_767.0]
    );
    assert_eq!(
        values(&attached("int16_t", "gz", "endian: big\n", &gzip(&big))),
        [-2.0, 300.0, 0.0, 32_767.0]
    );
    assert_eq!(
        values(&attached("uint16", "raw", "endian: big\n", &big)),
        [65_534.0, 300.0, 0.0, 32_767.0]
    );
    let floats = [0.5f32, -1.5, 1e30, 0.0];
    assert_eq!(
        values(&attached(
            "float",
            "raw",
            "endian: big\n",
            &floats.map(f32::to_be_bytes).concat()
        )),
        floats
    );
}

#[test]
fn spacings_come_from_lengths_or_directions_and_are_one_otherwise() {
    let spacings = |more: &str| {
        load(&attached("uchar", "raw", more, &[0; 4]), None)
            .unwrap()
            .spacings
    };
    assert_eq!(spacings(""), [1.0; 3]);
    assert_eq!(spacings("spacings: 3.2 3.2 1.5\n"), [3.2, 3.2, 1.5]);
    assert_eq!(spacings("spacings: nan 2 1\n"), [1.0, 2.0, 1.0]);
    assert_eq!(
        spacings("space directions: (-0.5,0,0) (0, 2,0) (0,0,1e0)\n"),
        [0.5, 2.0, 1.0]
    );
}

#[test]
fn detached_data_lie_beside_the_header() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("data.raw"), [4, 3, 2, 1]).unwrap();
    let bytes = header("uchar", "raw", "data file: data.raw\n").into_bytes();
    assert_eq!(
        load(&bytes, Some(folder.path())).unwrap().values,
        [4.0, 3.0, 2.0, 1.0]
    );
    let bytes = header("uchar", "raw", "datafile: none.raw\n").into_bytes();
    let message = load(&bytes, Some(folder.path())).unwrap_err().to_string();
    assert!(
        message.starts_with("data file 'none.raw': it cannot be read: No such file"),
        "{message}"
    );
    assert!(
        message.ends_with("put the data beside the header or correct the name"),
        "{message}"
    );
    std::fs::write(folder.path().join("none.raw.gz"), [0]).unwrap();
    let message = load(&bytes, Some(folder.path())).unwrap_err().to_string();
    let packed = "unpack 'none.raw.gz', which lies in its place (gunzip)";
    assert!(message.ends_with(packed), "{message}");
}

#[test]
fn damaged_files_are_refused() {
    for whole in [
        attached("short", "raw", "endian: little\nspacings: 1 2 3\n", &[0; 8]),
        attached("uchar", "gzip", "spacings: 1 1 1\n", &gzip(&[1, 2, 3, 4])),
    ] {
        survives(&whole, &|bytes| load(bytes, None));
    }
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let replace = |from: &str, to: &str| {
        let text = header("uchar", "raw", "") + "\n";
        assert!(text.contains(from));
        text.replace(from, to) + "\0\0\0\0"
    };
    let plain = |more: &str| header("uchar", "raw", more) + "\n\0\0\0\0";
    let cases = [
        (
            "NRRD9999\n".to_string(),
            "NRRD header line 1, magic: it is not NRRD0001 to NRRD0005; check",
        ),
        (
            replace("type: uchar", "type: block"),
            "line 3, type: 'block' is not supported; convert to uchar",
        ),
        (
            replace("type: uchar\n", ""),
            "type: the header lacks it; add it before the data",
        ),
        (
            replace("type: uchar", "type: short"),
            "endian: the header lacks it; add it before the data",
        ),
        (
            replace("dimension: 3", "dimension: 4"),
            "line 4, dimension: it is '4'; give a 3D volume",
        ),
        (
            replace("sizes: 2 1 2", "sizes: 2 0 2"),
            "line 5, sizes: '2 0 2' is not three positive whole numbers",
        ),
        (
            replace("sizes: 2 1 2", "sizes: 2 2"),
            "line 5, sizes: '2 2' is not three positive whole numbers",
        ),
        (
            replace("sizes: 2 1 2", "sizes: 10000 10000 10000"),
            "volume data: 1000000000000 bytes are needed but 4 are",
        ),
        (
            replace("sizes: 2 1 2", "sizes: 9999999999 9999999999 9999999999"),
            "sizes: 9999999999 elements of 9999999999 bytes; correct the absurd count in the header",
        ),
        (
            replace("encoding: raw", "encoding: bzip2"),
            "line 7, encoding: 'bzip2' is not supported; convert to raw or gzip",
        ),
        (
            replace("encoding: raw", "encoding: gzip"),
            "volume data: the gzip stream is damaged or truncated",
        ),
        (
            plain("endian: middle\n").replace("uchar", "short"),
            "endian: it is 'middle'; write 'little' or 'big'",
        ),
        (
            plain("spacings: 1 0 1\n"),
            "line 8, spacings: '1 0 1' is not three positive lengths",
        ),
        (
            plain("spacings: 1 inf 1\n"),
            "line 8, spacings: '1 inf 1' is not three positive lengths",
        ),
        (
            plain("space directions: (1,1,0) (0,1,0) (0,0,1)\n"),
            "is not three axis-aligned vectors; resample",
        ),
        (
            plain("space directions: none (0,1,0) (0,0,1)\n"),
            "is not three axis-aligned vectors; resample",
        ),
        (
            plain("spacings: 1 1 1\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"),
            "spacings are given as well; give one",
        ),
        (
            plain("sizes: 2 1 2\n"),
            "line 8, sizes: it is given twice; give it once",
        ),
        (
            plain("byte skip: 5\n"),
            "line 8, byte skip: this field is not supported; remove it",
        ),
        (
            plain("data file: slice%03d.raw 1 9 1\n"),
            "is not one file; join the slices into one data file",
        ),
        (
            plain("nonsense\n"),
            "line 8, header: 'nonsense' is no field; write 'field: value'",
        ),
        (
            plain("") + "\0",
            "volume data: there are 5 bytes where sizes and type need 4; correct sizes or type",
        ),
        (
            header("uchar", "raw", ""),
            "NRRD header: it ends without the blank line before the data, and names no data file",
        ),
        (
            header("uchar", "raw", "cont"),
            "line 8, header: it ends in the middle of a line; fetch the file again",
        ),
    ];
    for (text, expected) in cases {
        let found = load(text.as_bytes(), None).unwrap_err().to_string();
        assert_told(&found, expected);
    }
    let bomb = attached("uchar", "gzip", "", &gzip(&[0; 100_000]));
    let found = load(&bomb, None).unwrap_err().to_string();
    assert!(
        found.contains("volume data: more than the 4 bytes that the header justifies"),
        "{found}"
    );
}
