//! A sound file of every format in [`super::readers::FORMATS`], small enough that most mutations hit something that
//! matters.

use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::explore::identity::Identity;
use splatline_sim::explore::space::Space;
use splatline_sim::explore::subject::Subject;
use splatline_sim::explore::table::{heading, row_digest, to_line};
use splatline_sim::machine::area::Calibration;
use splatline_sim::machine::config::{self, Config};
use splatline_sim::plan::Prepared;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::synthetic;
use splatline_sim::vectors::{self, hard_cases};
use std::io::Write;

/// From this package's folder; that of the fuzz targets, which read these seeds as well, lies beside them.
const OTHERS: [&str; 3] = [
    "reference/tests/files",
    "machine/src/energy",
    "machine/src/parts",
];

pub const GAUSSIAN: [&str; 17] = [
    "x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
    "scale_2", "rot_0", "rot_1", "rot_2", "rot_3",
];
const RECORDS: [[f32; 17]; 2] = [
    [
        0.5, -0.5, 3.0, 0., 0., 0., 0.1, 0.2, 0.3, 1.0, -1.0, -2.0, -3.0, 1.0, 0.0, 0.0, 0.5,
    ],
    [
        -0.5, 0.5, 4.0, 0., 0., 0., 1.1, -0.2, 0.3, 3.0, -2.0, -1.0, -1.0, 0.3, 0.1, 0.9, 0.0,
    ],
];

pub fn ply_header(encoding: &str, fields: &[&str], count: usize) -> String {
    let fields: String = fields
        .iter()
        .map(|field| format!("property float {field}\n"))
        .collect();
    format!("ply\nformat {encoding} 1.0\nelement vertex {count}\n{fields}end_header\n")
}

fn line(numbers: &[f32]) -> String {
    let words: Vec<String> = numbers.iter().map(f32::to_string).collect();
    words.join(" ") + "\n"
}

fn splat() -> Vec<u8> {
    let record = |x: f32| {
        let mut bytes = [x, 0.2, 0.0, 0.1, 0.2, 0.1].map(f32::to_le_bytes).concat();
        bytes.extend([200, 100, 50, 150, 255, 128, 128, 120]);
        bytes
    };
    [-0.3, 0.0, 0.4].map(record).concat()
}

pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(bytes).expect("memory does not fail");
    packed.finish().expect("memory does not fail")
}

/// Two Gaussians with harmonics of degree 1, version 2.
fn spz() -> Vec<u8> {
    let mut bytes = [0x5053_474eu32, 2, 2].map(u32::to_le_bytes).concat();
    bytes.extend([1, 12, 0, 0]);
    for place in [4096i32, -8192, 2048, 0, 100, 900] {
        bytes.extend(&place.to_le_bytes()[..3]);
    }
    bytes.extend([51, 200]);
    bytes.extend([
        255, 0, 127, 99, 100, 101, 160, 144, 128, 120, 130, 140, 128, 120, 128, 255, 0, 128,
    ]);
    bytes.extend((0..18).map(|k| 120 + k));
    gzip(&bytes)
}

/// A volume of 3 x 3 x 3, `raw` or `gzip`.
pub fn volume(encoding: &str) -> Vec<u8> {
    let header = format!(
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 3 3 3\nspacings: 1 2 1\nendian: little\nencoding: {encoding}\n\n"
    );
    let data: Vec<u8> = (0..27i16)
        .flat_map(|value| (37 * value % 300).to_le_bytes())
        .collect();
    let data = match encoding {
        "gzip" => gzip(&data),
        _ => data,
    };
    [header.into_bytes(), data].concat()
}

fn camera() -> String {
    let camera = Camera::look_at([0.0, -5.0, -8.0], [0.0; 3], [0.0, -1.0, 0.0], 60.0, 32, 24);
    camera.expect("a sound camera").to_json()
}

/// The other file of a model of COLMAP.
pub fn beside(name: &str) -> Option<&'static str> {
    let pairs = [
        ("images.txt", "cameras.txt"),
        ("images.bin", "cameras.bin"),
        ("cameras.txt", "images.txt"),
        ("cameras.bin", "images.bin"),
    ];
    let found = pairs.into_iter().find(|(first, _)| *first == name);
    found.map(|(_, other)| other)
}

/// Intrinsics of one camera and the poses of two pictures, in binary.
fn colmap(name: &str) -> Vec<u8> {
    let mut bytes = 1u64.to_le_bytes().to_vec();
    if name == "cameras.bin" {
        bytes.extend([3i32, 1].map(i32::to_le_bytes).concat());
        bytes.extend([32u64, 24].map(u64::to_le_bytes).concat());
        bytes.extend([30.0f64, 31.0, 16.0, 12.0].map(f64::to_le_bytes).concat());
        return bytes;
    }
    bytes[0] = 2;
    for (number, name) in [(7i32, b"a.png\0"), (8, b"b.png\0")] {
        bytes.extend(number.to_le_bytes());
        let pose = [0.8f64, 0.6, 0.0, 0.0, 0.1, 0.2, 5.0].map(f64::to_le_bytes);
        bytes.extend(pose.concat());
        bytes.extend(3i32.to_le_bytes());
        bytes.extend(name);
        bytes.extend(1u64.to_le_bytes());
        bytes.extend([0; 24]);
    }
    bytes
}

const COLMAP_CAMERAS: &str = "# cameras\n3 OPENCV 32 24 30 31 16 12 0.1 -0.05 0.001 0.002\n";
const COLMAP_IMAGES: &str =
    "7 0.8 0.6 0 0 0.1 0.2 5 3 sub/a picture.png\n1 2 -1\n8 1 0 0 0 0 0 9 3 b.png\n\n";
const TRANSFORMS: &str = "{\"w\": 32, \"h\": 24, \"fl_x\": 30.0, \"fl_y\": 31.0, \"cx\": 16.0, \"cy\": 12.0, \"k1\": 0.1, \"frames\": [\
{\"file_path\": \"./images/a.png\", \"transform_matrix\": [[1, 0, 0, 0.5], [0, 0.8, -0.6, -3], [0, 0.6, 0.8, 4], [0, 0, 0, 1]]}]}";
const TRAINER: &str = "[{\"id\": 0, \"img_name\": \"a\", \"width\": 32, \"height\": 24, \"position\": [0.5, -3, -4], \
\"rotation\": [[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]], \"fx\": 30.0, \"fy\": 31.0}]";
const PATH: &str = "frames = 3\n[[key]]\neye = [0.5, -4.0, -8]\ntarget = [0, 0.5, 0]\nup = [0, -1, 0]\nfov = 50\n\
[[key]]\neye = [5, -1, -8]\ntarget = [0, 0, 1e-3]\n";
const TRANSFER: &str = "[[value]]\nat = 0\ncolour = [0.1, 0.2, 0.3]\nextinction = 0.0\n[[value]]\nat = 200\ncolour = [1, 0.5, 0.25]\nextinction = 0.8\n\
[[gradient]]\nat = 0\nmultiplier = 0.5\n[[gradient]]\nat = 90\nmultiplier = 1\n[shading]\nambient = 0.3\ndiffuse = 0.7\nspecular = 0.2\nexponent = 9\n";
const DESIGN: &str = "base = \"lean18\"\nview = 24\nmantissa = 20\nsubpixel = 8\nradial = 18\ntable = 7\ninterpolation = 6\nweight = 16\npeak = 16\n\
alpha = 14\ntransmittance = 16\ncolour = 12\naccumulator = 16\nrounding = \"truncate\"\ntraversal = \"box\"\n";
const SPACE: &str = "sample = \"grid\"\ncount = 20\nseed = 3\n[design]\nbase = [\"lean18\"]\nmantissa = { from = 14, to = 24, step = 2 }\n\
[machine]\nlanes = [1, 2, 4]\nlayout = [\"run\", \"rows\"]\nlatency = { from = 0, to = 90, step = 30 }\n";
const FOOTPRINTS: &str = "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1,cutoff,tiles\n0,8,4,1,1,0.5,1,6,2,10,6,4,0\n1,,,,,,,,,,,,\n\
2,20.5,9.25,2e1,0.125,-0.1,0.25,16,4,30,16,3.5,0 1\n";

/// The space of a sweep of three points.
pub const SWEPT: &str = "[machine]\nlanes = [1, 2, 4]\n";

/// The identity of that sweep, and its table.
fn sweep() -> String {
    let scene = synthetic::random_gaussians(3, 1, 2.0);
    let space = Space::from_toml("space.toml", SWEPT).expect("a sound space");
    let design = DesignChoice::named("lean18").expect("a named design");
    let camera = synthetic::camera(16, 16);
    let frame = Prepared::of_splats(scene, camera, Rules::GAUSSIAN_3D, design);
    let subject = Subject::new(vec![frame.into()]).expect("a sound plan");
    let identity = Identity::new(&subject, SWEPT, &[]).expect("a sound sweep");
    let rows: String = [(0, 1), (1, 2), (2, 4)]
        .map(|(point, lanes)| {
            let row = format!("{point},{lanes},,,,,,,,,900,1,2,3,0.5,0.5,0.25,100,0,60.5,16.5,16.5,16.5,1,1000,2e6,0.5,1,2,3,4,5,6,7,8,900,0.5,");
            let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
            fields.push(row_digest(&fields));
            to_line(&fields)
        })
        .concat();
    format!("{}{}{rows}", identity.to_text(), to_line(&heading(&space)))
}

/// Vectors of two splats.
pub fn few_vectors(size: [u16; 2]) -> vectors::VectorSubject {
    let (view, splats) = hard_cases(2, size, 3);
    vectors::VectorSubject {
        design: DesignChoice::named("lean18").expect("a named design"),
        rules: Rules::GAUSSIAN_3D,
        compositing: Compositing::FrontToBack,
        view,
        splats,
        systems: false,
    }
}

fn manifest() -> Vec<u8> {
    let folder = std::env::temp_dir().join(format!("splatline-seed-{}", std::process::id()));
    vectors::export(&folder, &few_vectors([4, 4]))
        .expect("the folder for temporary files is writable");
    let manifest = std::fs::read(folder.join("manifest.json"));
    std::fs::remove_dir_all(&folder).expect("it was made here");
    manifest.expect("it was written here")
}

/// A file of the reference's tests; most were written by other tools (reference/tests/files/make.py).
fn from_others(name: &str) -> Vec<u8> {
    let package = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = [package, &package.join("..")];
    let files = folders.map(|from| OTHERS.map(|folder| from.join(folder).join(name)));
    let found = files
        .iter()
        .flatten()
        .find_map(|file| std::fs::read(file).ok());
    found.unwrap_or_else(|| panic!("no seed {name}"))
}

/// The two parts of `tiny.glb`: its JSON, naming `tiny.bin` as its buffer, and that buffer.
pub fn apart() -> [Vec<u8>; 2] {
    let whole = from_others("tiny.glb");
    let length = |at: usize| {
        let bytes = whole[at..].first_chunk().expect("a chunk's length");
        u32::from_le_bytes(*bytes) as usize
    };
    let json = &whole[20..20 + length(12)];
    let rest = 20 + json.len();
    let binary = whole[rest + 8..rest + 8 + length(rest)].to_vec();
    let named = "\"buffers\":[{\"uri\":\"tiny.bin\",";
    let json = String::from_utf8_lossy(json).replace("\"buffers\":[{", named);
    [json.into_bytes(), binary]
}

/// The sound file of that name.
pub fn seed(name: &str) -> Vec<u8> {
    let cloud = "0 0 5 0 0 1\n1 0 5 0 0 1\n0 1 5 0 0 1\n1 1 5 0 0 1\n";
    match name {
        "gaussian.ply" => (ply_header("ascii", &GAUSSIAN, 2)
            + &RECORDS.map(|record| line(&record)).concat())
            .into_bytes(),
        "binary.ply" => {
            let records = RECORDS
                .as_flattened()
                .iter()
                .flat_map(|value| value.to_le_bytes());
            let header = ply_header("binary_little_endian", &GAUSSIAN, 2);
            header.into_bytes().into_iter().chain(records).collect()
        }
        "tiny.gltf" => apart()[0].clone(),
        "scene.splat" => splat(),
        "scene.spz" => spz(),
        "raw.nrrd" => volume("raw"),
        "gzip.nrrd" => volume("gzip"),
        "detached.nhdr" => {
            b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 10\nencoding: raw\ndata file: data\n"
                .to_vec()
        }
        "cloud.ply" => {
            (ply_header("ascii", &["x", "y", "z", "nx", "ny", "nz"], 4) + cloud).into_bytes()
        }
        "cloud.xyz" => cloud.into(),
        "grid.csv" => b"0.1,0.2,0.3\n0.2,0.5,0.1\n0.3,0.2,0.1\n".to_vec(),
        "camera.json" => camera().into_bytes(),
        "images.txt" => COLMAP_IMAGES.into(),
        "cameras.txt" => COLMAP_CAMERAS.into(),
        "images.bin" | "cameras.bin" => colmap(name),
        "transforms.json" => TRANSFORMS.into(),
        "cameras.json" => TRAINER.into(),
        "path.toml" => PATH.into(),
        "transfer.toml" => TRANSFER.into(),
        "design.toml" => DESIGN.into(),
        "machine.toml" => config::to_toml(&Config::default()).into_bytes(),
        "prices.toml" => toml_of_prices().into_bytes(),
        "space.toml" => SPACE.into(),
        "footprints.csv" => FOOTPRINTS.into(),
        "sweep.json" => sweep().into_bytes(),
        "manifest.json" => manifest(),
        other => from_others(other),
    }
}

/// Through JSON, whose numbers and lists TOML shares.
fn toml_of_prices() -> String {
    toml::to_string(&Calibration::default()).expect("prices have a TOML form")
}
