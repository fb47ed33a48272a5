//! Files that are small on disk and ask for more memory than there is.
//!
//! Each goes through the program itself, which may take 4 GB of address space and a second of processor time: it must
//! end with a message that has a number and a limit, not by a signal. What a file claims is true where that can be had
//! for little (a gzip of gigabytes of zeros), so that the claim alone does not give it away.

use super::super::shell::{Shell, holds};
use super::seeds::{GAUSSIAN, gzip, ply_header, seed};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Command;

/// Kilobytes of address space, and seconds of processor time, that the program gets.
const LIMITS: &str = "ulimit -v 4000000; ulimit -t 1; exec \"$0\" \"$@\"";
const MEGABYTE: usize = 1 << 20;

/// A file's name, its bytes, and the options of the command that reads it. `FILE` stands for it.
type Bomb = (String, Vec<u8>, &'static str);

const INFO: &str = "info FILE";
const RENDER: &str = "render FILE --size 16x16 -o x.png";
const SURFACE: &str = "render FILE --as surface --size 16x16 -o x.png";
const CAMERA: &str = "render demo --camera FILE -o x.png";
const PATH: &str = "render demo --camera-path FILE -o x.png";
const DESIGN: &str = "render demo --design FILE -o x.png";
const MACHINE: &str = "model demo --machine FILE";
const SPACE: &str = "explore demo --space FILE -o sweep";
const TABLE: &str = "model --footprints FILE --size 16x16";
const TEXTURE: &str = "render grid.csv --as surface --texture FILE -o x.png";

/// So many megabytes of zeros, packed: members of a gzip stream may follow each other.
fn zeros(begin: &[u8], megabytes: usize) -> Vec<u8> {
    let member = gzip(&vec![0; MEGABYTE]);
    [gzip(begin), member.repeat(megabytes)].concat()
}

/// Rests of packed data that nobody comes to unpack.
fn rubbish(bytes: usize) -> Vec<u8> {
    (0..bytes).map(|k| (k * 31 % 251) as u8).collect()
}

fn volumes() -> Vec<Bomb> {
    let mut bombs = Vec::new();
    let packed = zeros(&[], 1024);
    let sides = [1024, 1290, 1600, 4000, 65_535, 1_000_000];
    for (index, side) in sides.into_iter().enumerate() {
        for kind in ["uchar", "short", "float"] {
            let header = format!(
                "NRRD0004\ntype: {kind}\ndimension: 3\nsizes: {side} {side} {side}\nendian: little\nencoding: gzip\n\n"
            );
            let bytes = [header.as_bytes(), &packed].concat();
            let how = if index % 2 == 0 { INFO } else { RENDER };
            bombs.push((format!("{kind}{side}.nrrd"), bytes, how));
        }
        for kind in ["MET_UCHAR", "MET_SHORT", "MET_FLOAT"] {
            let header = format!(
                "ObjectType = Image\nNDims = 3\nBinaryData = True\nCompressedData = True\nDimSize = {side} {side} {side}\n\
                 ElementType = {kind}\nElementDataFile = LOCAL\n"
            );
            let bytes = [header.as_bytes(), &rubbish(2 * MEGABYTE)].concat();
            bombs.push((format!("{kind}{side}.mha"), bytes, INFO));
        }
    }
    for side in [1024i16, 1290, 1600, 4000, 32_000] {
        for (datatype, bits) in [(2i16, 8i16), (4, 16), (16, 32)] {
            let mut header = vec![0u8; 352];
            header[..4].copy_from_slice(&348i32.to_le_bytes());
            for (k, value) in [3, side, side, side].into_iter().enumerate() {
                header[40 + 2 * k..42 + 2 * k].copy_from_slice(&value.to_le_bytes());
                header[76 + 4 * k..80 + 4 * k].copy_from_slice(&1f32.to_le_bytes());
            }
            header[70..72].copy_from_slice(&datatype.to_le_bytes());
            header[72..74].copy_from_slice(&bits.to_le_bytes());
            header[108..112].copy_from_slice(&352f32.to_le_bytes());
            header[344..348].copy_from_slice(b"n+1\0");
            bombs.push((
                format!("{datatype}of{side}.nii.gz"),
                zeros(&header, 1024),
                INFO,
            ));
        }
    }
    bombs
}

fn spz_header(version: u32, count: u32, degree: u8, streams: u8) -> Vec<u8> {
    let words = [0x5053_474eu32, version, count];
    let mut header = words.map(u32::to_le_bytes).concat();
    header.extend([degree, 12, 0, streams]);
    header
}

fn splats() -> Vec<Bomb> {
    let mut bombs = Vec::new();
    for (index, count) in [30_000_000u32, 60_000_000, 200_000_000, u32::MAX]
        .into_iter()
        .enumerate()
    {
        let how = if index % 2 == 0 { INFO } else { RENDER };
        for degree in 0..=4u8 {
            let record = 20 + 3 * (usize::from(degree + 1).pow(2) - 1);
            let megabytes = (count as usize * record / MEGABYTE + 1).min(2000);
            let bytes = zeros(&spz_header(3, count, degree, 0), megabytes);
            bombs.push((format!("packed{count}d{degree}.spz"), bytes, how));
            let mut bytes = spz_header(4, count, degree, 6);
            bytes.extend(32u32.to_le_bytes());
            bytes.resize(32, 0);
            let packed = MEGABYTE as u64 / 2;
            for size in [9u64, 1, 3, 3, 4, record as u64 - 20] {
                bytes.extend(
                    [packed, size * u64::from(count)]
                        .map(u64::to_le_bytes)
                        .concat(),
                );
            }
            bytes.extend(rubbish((count as usize / 1024 * record).min(8 * MEGABYTE)));
            bombs.push((format!("streams{count}d{degree}.spz"), bytes, how));
        }
        for kind in ["ascii", "binary_little_endian"] {
            let text = ply_header(kind, &GAUSSIAN, count as usize);
            let bytes = [text.as_bytes(), &rubbish(9999)].concat();
            bombs.push((format!("{kind}{count}.ply"), bytes, how));
        }
        let mut level = vec![0u8; 4096 + 1024];
        level[1] = 1;
        level[4..8].copy_from_slice(&1u32.to_le_bytes());
        level[16..20].copy_from_slice(&count.to_le_bytes());
        level[4096..4100].copy_from_slice(&count.to_le_bytes());
        level[4100..4104].copy_from_slice(&count.to_le_bytes());
        bombs.push((format!("level{count}.ksplat"), level, how));
        // Without the file of its buffer: the count alone is looked at.
        let json = String::from_utf8_lossy(&seed("tiny.gltf"))
            .replace("\"uri\":\"tiny.bin\",", "")
            .replace("\"count\":", &format!("\"count\":{count},\"was\":"));
        bombs.push((format!("accessors{count}.gltf"), json.into_bytes(), how));
    }
    bombs
}

/// A picture of one colour: its header is all that is looked at.
fn webp(width: u32, height: u32) -> Vec<u8> {
    let bits = (width - 1) | (height - 1) << 14;
    let mut stream = vec![0x2f];
    stream.extend(bits.to_le_bytes());
    stream.extend([0; 27]);
    let mut bytes = b"RIFF".to_vec();
    bytes.extend((12 + stream.len() as u32).to_le_bytes());
    bytes.extend(b"WEBPVP8L");
    bytes.extend((stream.len() as u32).to_le_bytes());
    bytes.extend(stream);
    bytes
}

/// The stored entries of an archive.
fn bundle(files: &[(&str, Vec<u8>)], packed: bool) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let method = if packed {
        zip::CompressionMethod::Deflated
    } else {
        zip::CompressionMethod::Stored
    };
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in files {
        archive.start_file(*name, options).expect("in memory");
        std::io::Write::write_all(&mut archive, bytes).expect("in memory");
    }
    archive.finish().expect("in memory").into_inner()
}

fn bundles() -> Vec<Bomb> {
    let mut bombs = Vec::new();
    let book = format!("{:?}", vec![0.5; 256]);
    for count in [20_000_000u64, 60_000_000, 268_000_000, 4_000_000_000] {
        let meta = format!(
            "{{\"version\":2,\"count\":{count},\"means\":{{\"mins\":[0,0,0],\"maxs\":[1,1,1],\"files\":[\"a\",\"b\"]}},\
             \"scales\":{{\"codebook\":{book},\"files\":[\"c\"]}},\"quats\":{{\"files\":[\"d\"]}},\"sh0\":{{\"codebook\":{book},\"files\":[\"e\"]}}}}"
        );
        let picture = webp(16_384, (count / 16_384 + 1).min(16_384) as u32);
        for padding in [0, 1, 6] {
            let mut files = vec![("meta.json", meta.clone().into_bytes())];
            files.extend(["a", "b", "c", "d", "e"].map(|name| (name, picture.clone())));
            files.push(("padding", rubbish(padding * MEGABYTE)));
            bombs.push((
                format!("{count}p{padding}.sog"),
                bundle(&files, false),
                INFO,
            ));
        }
    }
    for megabytes in [2, 20, 200] {
        let spaces = vec![b' '; megabytes * MEGABYTE];
        let files = [("meta.json", [spaces, b"{}".to_vec()].concat())];
        bombs.push((format!("spaces{megabytes}.sog"), bundle(&files, true), INFO));
    }
    bombs
}

fn texts() -> Vec<Bomb> {
    let mut bombs: Vec<Bomb> = Vec::new();
    for thousands in [9_000, 12_000] {
        let line = "1,".repeat(thousands * 1000) + "1\n";
        bombs.push((
            format!("wide{thousands}.csv"),
            line.repeat(2).into(),
            SURFACE,
        ));
    }
    for (name, open) in [
        ("lists", "["),
        ("objects", "{\"a\":"),
        ("frames", "{\"frames\":["),
    ] {
        for depth in [200, 100_000, 1_000_000] {
            let text = open.repeat(depth).into_bytes();
            bombs.push((format!("{name}{depth}.json"), text.clone(), CAMERA));
            bombs.push((format!("{name}{depth}.gltf"), text.clone(), INFO));
            bombs.push((format!("{name}{depth}p.json"), text, PATH));
        }
    }
    for depth in [1000, 100_000] {
        for (name, how) in [("d", DESIGN), ("m", MACHINE), ("s", SPACE), ("p", PATH)] {
            let text = format!("a = {}", "[".repeat(depth)).into_bytes();
            bombs.push((format!("{name}{depth}.toml"), text, how));
            let text = format!("a = {}", "{b=".repeat(depth)).into_bytes();
            bombs.push((format!("{name}{depth}t.toml"), text, how));
            let text = "a.".repeat(depth) + "a = 1\n";
            bombs.push((format!("{name}{depth}k.toml"), text.into_bytes(), how));
        }
    }
    for number in ["4294967295", "18446744073709551615", "1000000000000"] {
        let text = format!("[machine]\nlanes = {{ from = 1, to = {number}, step = 1 }}\n");
        bombs.push((format!("space{number}.toml"), text.into(), SPACE));
        let text = format!("frames = {number}\n[[key]]\neye = [0,0,1]\ntarget = [0,0,0]\n");
        bombs.push((format!("path{number}.toml"), text.into(), PATH));
        for setting in ["tile_width", "lanes", "row_fifo", "raster_units"] {
            let text = format!("{setting} = {number}\n");
            bombs.push((format!("{setting}{number}.toml"), text.into(), MACHINE));
        }
        let text = format!(
            "u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1\n1,1,1,1,0,1,0,0,{number},{number}\n"
        );
        bombs.push((format!("box{number}.csv"), text.into(), TABLE));
        let text = format!("{{\"width\": {number}, \"height\": {number}}}");
        bombs.push((format!("size{number}.json"), text.into(), CAMERA));
    }
    bombs
}

fn pictures() -> Vec<Bomb> {
    let mut bombs: Vec<Bomb> = Vec::new();
    for side in [9_000u32, 60_000, 1_000_000, u32::MAX >> 1] {
        let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        bytes.extend([side, side].map(u32::to_be_bytes).concat());
        bytes.extend([16, 6, 0, 0, 0]);
        // The sum over the header is not looked at before its sizes.
        bytes.extend([0; 4]);
        bombs.push((format!("texture{side}.png"), bytes, TEXTURE));
    }
    for side in [9_000u16, 30_000, 65_535] {
        let mut bytes = vec![0xff, 0xd8, 0xff, 0xc0, 0, 17, 8];
        bytes.extend([side, side].map(u16::to_be_bytes).concat());
        bytes.extend([3, 1, 0x22, 0, 2, 0x11, 1, 3, 0x11, 1, 0xff, 0xda]);
        bombs.push((format!("texture{side}.jpg"), bytes, TEXTURE));
    }
    bombs
}

/// What became of it, if it is not a message with a number.
fn failure(folder: &Path, (name, bytes, options): &Bomb) -> Option<String> {
    std::fs::write(folder.join(name), bytes).unwrap();
    let output = Command::new("sh")
        .args(["-c", LIMITS, env!("CARGO_BIN_EXE_splatline")])
        .args(options.replace("FILE", name).split(' '))
        .current_dir(folder)
        .output()
        .unwrap();
    std::fs::remove_file(folder.join(name)).unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    let shown: String = stderr.chars().take(300).collect();
    if let Some(signal) = output.status.signal() {
        return Some(format!("{name} ended by signal {signal}: {shown}"));
    }
    let code = output.status.code();
    if !matches!(code, Some(1 | 2)) || !stderr.contains(|c: char| c.is_ascii_digit()) {
        return Some(format!("{name} ended with {code:?}: {shown}"));
    }
    if stderr.contains("out of memory") || stderr.len() > 10_000 {
        return Some(format!(
            "{name} is refused in {} bytes: {shown}",
            stderr.len()
        ));
    }
    None
}

#[test]
fn bombs_are_refused_with_a_number() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    std::fs::write(folder.path().join("grid.csv"), seed("grid.csv")).unwrap();
    let (mut tried, mut failures) = (0, Vec::new());
    // Kind by kind, so that few are in memory at once.
    for kind in [volumes, splats, bundles, texts, pictures] {
        for bomb in kind() {
            tried += 1;
            failures.extend(failure(folder.path(), &bomb));
        }
    }
    println!("{tried} bombs");
    assert!(
        failures.is_empty(),
        "{} of {tried}:\n{}",
        failures.len(),
        failures.join("\n")
    );
    assert!(tried >= 200, "{tried}");
}

/// What fits is drawn, what does not is refused, at the user's word.
#[test]
fn the_users_limit_is_kept() {
    let shell = Shell::new();
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 90 90 90\nencoding: raw\n\n";
    let bytes = [header.as_bytes(), &rubbish(90 * 90 * 90)].concat();
    shell.write("scene.nrrd", bytes);
    let render = "render scene.nrrd --size 16x16 -o x.png --memory";
    let refusal = shell.refused(1, &format!("{render} 40"), "MB are available");
    holds(&refusal, &["--memory"]);
    shell.succeed(&format!("{render} 2000"));
}
