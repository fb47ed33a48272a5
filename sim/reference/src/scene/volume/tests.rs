//! Volumes as other people's writers made them (`tests/files/make.py`), and what is refused.

use super::super::damage_tests::{assert_told, gzip, survives};
use super::super::{LoadOptions, Scene, load};
use super::*;
use std::path::{Path, PathBuf};

/// A file that another tool wrote.
fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/files")
        .join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(file(name)).unwrap()
}

/// The volume of every file: 100 x + 10 y + z.
fn expected() -> Vec<f32> {
    let value = |index: usize| 100 * (index % 3) + 10 * (index / 3 % 4) + index / 12;
    (0..60).map(|index| value(index) as f32).collect()
}

fn check(name: &str, loaded: Result<Noted, Problem>) {
    let (volume, _) = loaded.unwrap_or_else(|problem| panic!("{name}: {problem}"));
    assert_eq!(volume.sizes, [3, 4, 5], "{name}");
    assert_eq!(volume.spacings, [0.5, 1.0, 2.0], "{name}");
    assert_eq!(volume.values, expected(), "{name}");
}

/// By the entrance of the command line, all voxels above 0.
fn scene(name: &str) -> Scene {
    load(&file(name), &LoadOptions::default()).unwrap()
}

/// What the mutations of a reader need.
fn drawn(loaded: Result<Noted, Problem>) -> Result<Scene, Problem> {
    let transfer = super::super::Transfer::ramp(0.0, 255.0, 1.0);
    let light = super::super::shade::DEFAULT_LIGHT;
    super::super::shade::shade(&loaded?.0, &transfer, light, "x")
}

/// A text with one part replaced, which must be there.
fn replaced(name: &str, from: &str, to: &str) -> Vec<u8> {
    let text: Vec<u8> = bytes(name);
    let place = text
        .windows(from.len())
        .position(|part| part == from.as_bytes());
    let place = place.unwrap_or_else(|| panic!("{name} has no {from}"));
    [&text[..place], to.as_bytes(), &text[place + from.len()..]].concat()
}

#[test]
fn nifti_files_of_nibabel_are_read() {
    for name in ["volume.nii", "volume.nii.gz", "second.nii", "big.nii"] {
        check(name, nifti::load(&bytes(name)));
        assert_eq!(scene(name).splats.len(), scene("volume.nii").splats.len());
    }
    // The slope is in single precision, as the values are.
    let (scaled, notes) = nifti::load(&bytes("scaled.nii")).unwrap();
    for (value, whole) in scaled.values.iter().zip(expected()) {
        assert!((value - whole / 7.0).abs() < 1e-3, "{value} {whole}");
    }
    assert_eq!(notes, [TURNED]);
    assert!(nifti::is_nifti(&bytes("volume.nii")) && nifti::is_nifti(&bytes("second.nii")));
}

#[test]
fn meta_images_of_simple_itk_are_read() {
    for name in ["volume.mha", "packed.mha", "volume.mhd"] {
        let folder = file(name);
        check(name, meta_image::load(&bytes(name), folder.parent()));
        assert_eq!(scene(name).splats.len(), scene("volume.nii").splats.len());
    }
}

#[cfg(feature = "vti")]
#[test]
fn image_data_of_vtk_are_read() {
    for name in ["ascii", "binary", "packed", "appended", "raw", "wide"] {
        let name = format!("{name}.vti");
        check(&name, vti::load(&bytes(&name)));
        assert_eq!(scene(&name).splats.len(), scene("volume.nii").splats.len());
    }
}

#[cfg(not(feature = "vti"))]
#[test]
fn a_format_that_was_not_built_names_its_feature() {
    let refused = load(&file("ascii.vti"), &LoadOptions::default());
    let message = refused.unwrap_err().to_string();
    assert!(
        message.ends_with("ascii.vti: .vti: this program was built without its reader; build it with `cargo build --features vti` or convert the file"),
        "{message}"
    );
}

#[test]
fn damaged_volumes_are_refused() {
    for name in ["volume.nii", "volume.nii.gz", "second.nii"] {
        survives(&bytes(name), &|bytes| drawn(nifti::load(bytes)));
    }
    for name in ["volume.mha", "packed.mha"] {
        survives(&bytes(name), &|bytes| drawn(meta_image::load(bytes, None)));
    }
    #[cfg(feature = "vti")]
    for name in ["ascii", "binary", "packed", "appended", "raw", "wide"] {
        let whole = bytes(&format!("{name}.vti"));
        survives(whole.trim_ascii_end(), &|bytes| drawn(vti::load(bytes)));
    }
}

#[test]
fn messages_of_nifti_name_the_field_and_the_fix() {
    let with = |place: usize, stored: &[u8]| {
        let mut whole = bytes("volume.nii");
        whole[place..place + stored.len()].copy_from_slice(stored);
        nifti::load(&whole).unwrap_err().to_string()
    };
    let cases = [
        (with(0, &[7]), "sizeof_hdr: it is 263; 348 and 540 are read"),
        (
            with(344, b"ni1\0"),
            "magic: it is not that of a single file; join header (.hdr)",
        ),
        (
            with(70, &[32, 0]),
            "datatype: it is 32; convert to integers of 8 to 32 bits",
        ),
        (
            with(40, &[2, 0]),
            "dim: it is 2 3 4 5 1 1 1 1; give one volume",
        ),
        (
            with(42, &[0, 0]),
            "dim: it is 3 0 4 5 1 1 1 1; give one volume",
        ),
        (
            with(46, &[9, 0]),
            "volume data: 216 bytes are needed but 120 are left",
        ),
        (
            with(80, &f32::NAN.to_le_bytes()),
            "pixdim: [NaN, 1.0, 2.0] are no distances",
        ),
        (
            with(108, &0f32.to_le_bytes()),
            "vox_offset: it is 0; the data of a single file begin",
        ),
    ];
    for (found, expected) in cases {
        assert_told(&found, expected);
    }
}

#[test]
fn a_series_of_one_volume_is_a_volume_and_a_longer_one_is_refused() {
    let series = |count: u8| {
        let mut whole = bytes("volume.nii");
        whole[40] = 4;
        whole[48] = count;
        nifti::load(&whole)
    };
    check("a series of one", series(1));
    let message = series(2).unwrap_err().to_string();
    assert!(
        message.contains("dim: it is 4 3 4 5 2 1 1 1; give one volume of three axes"),
        "{message}"
    );
}

/// A packed file of some hundred bytes cannot ask for more than deflate could have packed into it.
#[test]
fn a_claim_beyond_the_files_size_is_refused_at_once() {
    let mut header = bytes("volume.nii")[..352].to_vec();
    for place in [42, 44, 46] {
        header[place..place + 2].copy_from_slice(&10_000i16.to_le_bytes());
    }
    let message = nifti::load(&gzip(&header)).unwrap_err().to_string();
    assert!(
        message.contains("the header claims 2000000000352 bytes, but"),
        "{message}"
    );
    let packed = replaced(
        "packed.mha",
        "DimSize = 3 4 5",
        "DimSize = 30000 40000 50000",
    );
    let message = meta_image::load(&packed, None).unwrap_err().to_string();
    assert!(
        message.contains("the header claims 120000000000000 bytes, but"),
        "{message}"
    );
}

#[test]
fn messages_of_meta_images_name_the_field_and_the_fix() {
    let with = |from: &str, to: &str| {
        let changed = replaced("volume.mha", from, to);
        meta_image::load(&changed, None).unwrap_err().to_string()
    };
    let cases = [
        (
            with("NDims = 3", "NDims = 2"),
            "line 2, NDims: it is '2'; give a 3D volume",
        ),
        (
            with("NDims = 3", "Depth = 3"),
            "line 2, Depth: this field is not supported; remove it",
        ),
        (
            with("DimSize = 3 4 5", "DimSize = 3 4"),
            "DimSize: '3 4' is not three positive whole numbers",
        ),
        (
            with("DimSize = 3 4 5", "DimSize = 3 4 6"),
            "volume data: 144 bytes are needed but 120 are",
        ),
        (
            with("MET_SHORT", "MET_LONG"),
            "ElementType: 'MET_LONG' is not supported; convert to",
        ),
        (
            with("ElementSpacing = 0.5 1 2", "ElementSpacing = 0 1 2"),
            "is not three positive lengths",
        ),
        (
            with("BinaryData = True", "BinaryData = False"),
            "BinaryData: it is 'False'; write the volume with binary",
        ),
        (
            with("CompressedData = False", "CompressedData = True"),
            "the zlib stream is damaged or truncated",
        ),
        (
            with("= Image", "= Mesh"),
            "line 1, ObjectType: it is 'Mesh'; give a file of an Image",
        ),
        (
            with("ElementDataFile = LOCAL", "ElementDataFile = LIST"),
            "'LIST' is not one file; join the slices",
        ),
        (
            with("ElementDataFile = LOCAL", "ElementDataFile = none.raw"),
            "data file 'none.raw': it cannot be read",
        ),
        (
            with("NDims = 3", "NDims = 3\nNDims = 3"),
            "NDims: it is given twice; give it once",
        ),
        (
            with("TransformMatrix = 1 0 0", "TransformMatrix = 1 0"),
            "is not nine numbers; write the three axes",
        ),
    ];
    for (found, expected) in cases {
        assert_told(&found, expected);
    }
    let turned = replaced("volume.mha", "TransformMatrix = 1", "TransformMatrix = -1");
    assert_eq!(meta_image::load(&turned, None).unwrap().1, [TURNED]);
}

#[cfg(feature = "vti")]
#[test]
fn messages_of_image_data_name_the_field_and_the_fix() {
    let with = |name: &str, from: &str, to: &str| {
        vti::load(&replaced(name, from, to))
            .unwrap_err()
            .to_string()
    };
    let extents = "WholeExtent=\"0 2 0 3 0 4\"";
    let cases = [
        (
            with("ascii.vti", "ImageData\" ver", "PolyData\" ver"),
            "VTKFile: it is no VTKFile of type ImageData; write",
        ),
        (
            with("ascii.vti", extents, "WholeExtent=\"0 2 0 3 0 9\""),
            "Piece: it is not the whole extent; write the volume in one",
        ),
        (
            with("ascii.vti", extents, "WholeExtent=\"0 2 0 3\""),
            "WholeExtent: '0 2 0 3' is not six whole numbers",
        ),
        (
            with("ascii.vti", "Int16", "String"),
            "DataArray type: 'String' is not read; write integers",
        ),
        (
            with("ascii.vti", "0 100 200", "0 100"),
            "it has 59 numbers where the extent needs 60",
        ),
        (
            with("ascii.vti", "0 100 200", "0 100 x"),
            "DataArray: a word in it is no number; write it again",
        ),
        (
            with(
                "ascii.vti",
                "<?xml version=\"1.0\"?>",
                "<!DOCTYPE a [<!ENTITY b \"c\">]>",
            ),
            "XML: it is not understood",
        ),
        (
            with(
                "packed.vti",
                "vtkZLibDataCompressor",
                "vtkLZMADataCompressor",
            ),
            "'vtkLZMADataCompressor' is not read",
        ),
        (
            with("binary.vti", "UInt32", "UInt64"),
            "base64 data: 172 bytes are needed but 168 are left",
        ),
        (
            with("appended.vti", "offset=\"0\"", "offset=\"999\""),
            "DataArray offset: '999' beside",
        ),
        (
            with("appended.vti", "   _", "    "),
            "AppendedData: it does not begin with _; write",
        ),
    ];
    for (found, expected) in cases {
        assert_told(&found, expected);
    }
}
