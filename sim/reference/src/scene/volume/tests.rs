//! Volumes as other people's writers made them (`tests/files/make.py`), and what is refused.

#[cfg(feature = "vti")]
use super::super::damage_tests::rows;
use super::super::damage_tests::{
    assert_refused, assert_refused_at, assert_refused_with, assert_told, gzip, replaced, survives,
};
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

fn check(name: &str, loaded: Result<Volume, Problem>) {
    let volume = loaded.unwrap_or_else(|problem| panic!("{name}: {problem}"));
    assert_eq!(volume.sizes, [3, 4, 5], "{name}");
    assert_eq!(volume.spacings, [0.5, 1.0, 2.0], "{name}");
    assert_eq!(volume.values, expected(), "{name}");
}

/// By the entrance of the command line, all voxels above 0.
fn scene(name: &str) -> Scene {
    load(&file(name), &LoadOptions::default()).unwrap()
}

/// What the mutations of a reader need.
fn drawn(loaded: Result<Volume, Problem>) -> Result<Scene, Problem> {
    let transfer = super::super::Transfer::ramp(0.0, 255.0, 1.0);
    let light = super::super::shade::DEFAULT_LIGHT;
    super::super::shade::shade(&loaded?, &transfer, light, "x")
}

#[test]
fn nifti_files_of_nibabel_are_read() {
    for name in ["volume.nii", "volume.nii.gz", "second.nii", "big.nii"] {
        check(name, nifti::load(&bytes(name)));
        assert_eq!(scene(name).splats.len(), scene("volume.nii").splats.len());
    }
    // The slope is in single precision, as the values are.
    let scaled = nifti::load(&bytes("scaled.nii")).unwrap();
    for (value, whole) in scaled.values.iter().zip(expected()) {
        assert!((value - whole / 7.0).abs() < 1e-3, "{value} {whole}");
    }
    assert_eq!(scaled.notes, [TURNED]);
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
    let table = r"
        0 => 07 => sizeof_hdr: it is 263; 348 and 540 are read
        344 => 6e 69 31 00 => magic: it is not that of a single file; join header (.hdr)
        70 => 20 00 => datatype: it is 32; convert to integers of 8 to 32 bits
        40 => 02 00 => dim: it is 2 3 4 5 1 1 1 1; give one volume
        42 => 00 00 => dim: it is 3 0 4 5 1 1 1 1; give one volume
        46 => 09 00 => volume data: 216 bytes are needed but 120 are left
        80 => 00 00 c0 7f => pixdim: [NaN, 1.0, 2.0] are no distances
        108 => 00 00 00 00 => vox_offset: it is 0; the data of a single file begin
    ";
    assert_refused_at(&bytes("volume.nii"), table, nifti::load);
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
    assert_told(
        message,
        "dim: it is 4 3 4 5 2 1 1 1; give one volume of three axes",
    );
}

/// A packed file of some hundred bytes cannot ask for more than deflate could have packed into it.
#[test]
fn a_claim_beyond_the_files_size_is_refused_at_once() {
    let mut header = bytes("volume.nii")[..352].to_vec();
    for place in [42, 44, 46] {
        header[place..place + 2].copy_from_slice(&10_000i16.to_le_bytes());
    }
    let claim = "the header claims 2000000000352 bytes, but";
    assert_refused(&[(gzip(&header), claim)], nifti::load);
    let table = "3 4 5 => 30000 40000 50000 => the header claims 120000000000000 bytes, but";
    assert_refused_with(&bytes("packed.mha"), table, |bytes| {
        meta_image::load(bytes, None)
    });
}

#[test]
fn messages_of_meta_images_name_the_field_and_the_fix() {
    let whole = bytes("volume.mha");
    let table = r"
        NDims = 3 => NDims = 2 => line 2, NDims: it is '2'; give a 3D volume
        NDims = 3 => Depth = 3 => line 2, Depth: this field is not supported; remove it
        DimSize = 3 4 5 => DimSize = 3 4 => DimSize: '3 4' is not three positive whole numbers
        DimSize = 3 4 5 => DimSize = 3 4 6 => volume data: 144 bytes are needed but 120 are
        MET_SHORT => MET_LONG => ElementType: 'MET_LONG' is not supported; convert to
        ElementSpacing = 0.5 1 2 => ElementSpacing = 0 1 2 => is not three positive lengths
        BinaryData = True => BinaryData = False => BinaryData: it is 'False'; write the volume with binary
        CompressedData = False => CompressedData = True => the zlib stream is damaged or truncated
        = Image => = Mesh => line 1, ObjectType: it is 'Mesh'; give a file of an Image
        ElementDataFile = LOCAL => ElementDataFile = LIST => 'LIST' is not one file; join the slices
        ElementDataFile = LOCAL => ElementDataFile = none.raw => data file 'none.raw': it cannot be read
        NDims = 3 => NDims = 3\nNDims = 3 => NDims: it is given twice; give it once
        TransformMatrix = 1 0 0 => TransformMatrix = 1 0 => is not nine numbers; write the three axes
    ";
    assert_refused_with(&whole, table, |bytes| meta_image::load(bytes, None));
    let turned = replaced(&whole, "TransformMatrix = 1", "TransformMatrix = -1");
    assert_eq!(meta_image::load(&turned, None).unwrap().notes, [TURNED]);
}

#[cfg(feature = "vti")]
#[test]
fn messages_of_image_data_name_the_field_and_the_fix() {
    let table = r#"
        ascii => ImageData" ver => PolyData" ver => VTKFile: it is no VTKFile of type ImageData; write
        ascii => 0 3 0 4" => 0 3 0 9" => Piece: it is not the whole extent; write the volume in one
        ascii => Extent="0 2 0 3 0 4" => Extent="0 2 0 3" => WholeExtent: '0 2 0 3' is not six whole numbers
        ascii => Int16 => String => DataArray type: 'String' is not read; write integers
        ascii => 0 100 200 => 0 100 => it has 59 numbers where the extent needs 60
        ascii => 0 100 200 => 0 100 x => DataArray: a word in it is no number; write it again
        ascii => <?xml version="1.0"?> => <!DOCTYPE a [<!ENTITY b "c">]> => XML: it is not understood
        packed => vtkZLibDataCompressor => vtkLZMADataCompressor => 'vtkLZMADataCompressor' is not read
        binary => UInt32 => UInt64 => base64 data: 172 bytes are needed but 168 are left
        appended => offset="0" => offset="999" => DataArray offset: '999' beside
        appended => _eAAA => eAAA => AppendedData: it does not begin with _; write
    "#;
    for [name, from, to, expected] in rows(table) {
        let changed = replaced(&bytes(&format!("{name}.vti")), &from, &to);
        assert_refused(&[(changed, &*expected)], vti::load);
    }
}
