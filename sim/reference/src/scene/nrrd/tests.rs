//! Tests of the NRRD reader: types, encodings, spacings, damage.

use crate::scene::damage_tests::{assert_refused, assert_refused_with, gzip, rows, survives};

use super::*;

/// A header of 2 x 1 x 2 voxels with some lines replaced or added.
fn header(kind: &str, encoding: &str, more: &str) -> String {
    format!(
        "NRRD0004\n# a comment\ntype: {kind}\ndimension: 3\nsizes: 2 1 2\nkey:=value\nencoding: {encoding}\n{more}"
    )
}

fn attached(kind: &str, encoding: &str, more: &str, data: &[u8]) -> Vec<u8> {
    [header(kind, encoding, more).as_bytes(), b"\n", data].concat()
}

#[test]
fn types_and_byte_orders_are_read() {
    let bytes = [1, 2, 3, 255];
    let numbers = [-2i16, 300, 0, 32_767];
    let [little, big] =
        [i16::to_le_bytes, i16::to_be_bytes].map(|order| numbers.map(order).concat());
    let floats = [0.5f32, -1.5, 1e30, 0.0];
    let big_floats = floats.map(f32::to_be_bytes).concat();
    let (unsigned, signed) = ([1.0, 2.0, 3.0, 255.0], [-2.0, 300.0, 0.0, 32_767.0]);
    for (kind, encoding, endian, data, expected) in [
        ("uchar", "raw", "", bytes.to_vec(), unsigned),
        ("unsigned char", "gzip", "", gzip(&bytes), unsigned),
        ("int8", "raw", "", bytes.to_vec(), [1.0, 2.0, 3.0, -1.0]),
        ("short", "raw", "endian: little\n", little, signed),
        ("int16_t", "gz", "endian: big\n", gzip(&big), signed),
        (
            "uint16",
            "raw",
            "endian: big\n",
            big,
            [65_534.0, 300.0, 0.0, 32_767.0],
        ),
        ("float", "raw", "endian: big\n", big_floats, floats),
    ] {
        let file = attached(kind, encoding, endian, &data);
        assert_eq!(load(&file, None).unwrap().values, expected, "{kind}");
    }
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
    let load = |bytes: &[u8]| load(bytes, None);
    let replaced = r"
        NRRD0004 => NRRD9999 => NRRD header line 1, magic: it is not NRRD0001 to NRRD0005; check
        type: uchar => type: block => line 3, type: 'block' is not supported; convert to uchar
        type: uchar\n => => type: the header lacks it; add it before the data
        type: uchar => type: short => endian: the header lacks it; add it before the data
        dimension: 3 => dimension: 4 => line 4, dimension: it is '4'; give a 3D volume
        sizes: 2 1 2 => sizes: 2 0 2 => line 5, sizes: '2 0 2' is not three positive whole numbers
        sizes: 2 1 2 => sizes: 2 2 => line 5, sizes: '2 2' is not three positive whole numbers
        2 1 2 => 9999999999 9999999999 9999999999 => sizes: 9999999999 elements of 9999999999 bytes; correct the absurd
        uchar => short\nendian: middle => endian: it is 'middle'; write 'little' or 'big'
        2 1 2 => 10000 10000 10000 => volume data: 1000000000000 bytes are needed but 4 are
        encoding: raw => encoding: bzip2 => line 7, encoding: 'bzip2' is not supported; convert to raw or gzip
        encoding: raw => encoding: gzip => volume data: the gzip stream is damaged or truncated
    ";
    assert_refused_with(&attached("uchar", "raw", "", &[0; 4]), replaced, load);
    let added = r"
        spacings: 1 0 1 => line 8, spacings: '1 0 1' is not three positive lengths
        spacings: 1 inf 1 => line 8, spacings: '1 inf 1' is not three positive lengths
        space directions: (1,1,0) (0,1,0) (0,0,1) => is not three axis-aligned vectors; resample
        space directions: none (0,1,0) (0,0,1) => is not three axis-aligned vectors; resample
        spacings: 1 1 1\nspace directions: (1,0,0) (0,1,0) (0,0,1) => spacings are given as well; give one
        sizes: 2 1 2 => line 8, sizes: it is given twice; give it once
        byte skip: 5 => line 8, byte skip: this field is not supported; remove it
        data file: slice%03d.raw 1 9 1 => is not one file; join the slices into one data file
        nonsense => line 8, header: 'nonsense' is no field; write 'field: value'
    ";
    for [line, expected] in rows(added) {
        let bytes = attached("uchar", "raw", &(line + "\n"), &[0; 4]);
        assert_refused(&[(bytes, &*expected)], load);
    }
    let cases = [
        (
            attached("uchar", "raw", "", &[0; 5]),
            "volume data: there are 5 bytes where sizes and type need 4; correct sizes or type",
        ),
        (
            header("uchar", "raw", "").into_bytes(),
            "NRRD header: it ends without the blank line before the data, and names no data file",
        ),
        (
            header("uchar", "raw", "cont").into_bytes(),
            "line 8, header: it ends in the middle of a line; fetch the file again",
        ),
        (
            attached("uchar", "gzip", "", &gzip(&[0; 100_000])),
            "volume data: more than the 4 bytes that the header justifies",
        ),
    ];
    assert_refused(&cases, load);
}
