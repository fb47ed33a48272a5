//! Writers of the formats of 3D Gaussians, for the page about their precision and for nothing else.
//!
//! Every number is rounded to the nearest step of its format. Where a real converter would search for a codebook or a palette, these take
//! equal steps over the range; harmonics that only fit into a palette are not written at all.

use super::trained::{
    Trained, byte, constant_harmonics, floats, log_scales, part, range, smallest_three, step,
};
use anyhow::Result;
use image_webp::{ColorType, WebPEncoder};
use splatline_sim::scene::{Gaussian, Scene};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A format that scenes are written to.
pub(super) struct Writer {
    pub(super) name: &'static str,
    /// File name, or that of a folder.
    file: &'static str,
    /// Highest degree of harmonics that this writer writes.
    degree: u8,
    /// What the format rounds to.
    pub(super) rounding: &'static str,
    /// Said of scenes that are not written.
    pub(super) refusal: &'static str,
    save: fn(&Trained, &Path) -> Result<()>,
}

const COLOURS_CLAMPED: &str = "its bytes hold no harmonics";
pub(super) const WRITERS: [Writer; 7] = [
    Writer {
        name: ".ply",
        file: "scene.ply",
        degree: 4,
        rounding: "single precision",
        refusal: "",
        save: ply,
    },
    Writer {
        name: ".glb",
        file: "scene.glb",
        degree: 4,
        rounding: "single precision",
        refusal: "",
        save: glb,
    },
    Writer {
        name: ".ksplat, level 0",
        file: "scene.ksplat",
        degree: 3,
        rounding: "colour and opacity 1/255, clamped to 0 to 1",
        refusal: "",
        save: ksplat,
    },
    Writer {
        name: ".splat",
        file: "scene.splat",
        degree: 0,
        rounding: "colour and opacity 1/255, clamped to 0 to 1; quaternion 1/128",
        refusal: COLOURS_CLAMPED,
        save: splat,
    },
    Writer {
        name: ".spz, version 3",
        file: "scene.spz",
        degree: 4,
        rounding: "place 1/4096; log scale 1/16; opacity 1/255; colour 1/38; quaternion 1/723; harmonics 1/128",
        refusal: "",
        save: spz,
    },
    Writer {
        name: ".ply, compressed",
        file: "compressed.ply",
        degree: 4,
        rounding: "of 256 splats' range: place and log scale 1/2047 and 1/1023, colour 1/255; opacity 1/255; quaternion 1/723; harmonics 1/32",
        refusal: "",
        save: compressed,
    },
    Writer {
        name: "SOG, version 2",
        file: "sog",
        degree: 0,
        rounding: "log place 1/65535 of its range; log scale and colour 1/255 of theirs; opacity 1/255; quaternion 1/180",
        refusal: "harmonics need a palette, which this writer does not search for",
        save: sog,
    },
];

impl Writer {
    /// Writes the scene; none if the format, or this writer, cannot hold its harmonics.
    pub(super) fn write(&self, scene: &Scene, folder: &Path) -> Result<Option<PathBuf>> {
        let degree = scene
            .harmonics
            .as_ref()
            .map_or(0, |harmonics| harmonics.degree);
        if degree > self.degree {
            return Ok(None);
        }
        let path = folder.join(self.file);
        (self.save)(&Trained::of(scene), &path)?;
        Ok(Some(path))
    }
}

fn save(path: &Path, bytes: &[u8]) -> Result<()> {
    Ok(splatline_sim::atomic::write(path, bytes)?)
}

fn ply(scene: &Trained, path: &Path) -> Result<()> {
    let rest = 3 * scene.coefficients();
    let mut text = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n",
        scene.records.len()
    );
    let names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"].map(str::to_owned);
    let rests = (0..rest).map(|k| format!("f_rest_{k}"));
    let others = [
        "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3",
    ];
    for name in names
        .into_iter()
        .chain(rests)
        .chain(others.map(str::to_owned))
    {
        let _ = writeln!(text, "property float {name}");
    }
    let mut bytes = (text + "end_header\n").into_bytes();
    for record in &scene.records {
        let logit = (record.opacity / (1.0 - record.opacity)).ln();
        bytes.extend(floats(
            record.centre.into_iter().chain(constant_harmonics(record)),
        ));
        bytes.extend(floats((0..3).flat_map(|channel| {
            record
                .harmonics
                .iter()
                .map(move |rgb| f64::from(rgb[channel]))
        })));
        bytes.extend(floats(
            [logit]
                .into_iter()
                .chain(log_scales(record))
                .chain(record.rotation),
        ));
    }
    save(path, &bytes)
}

fn glb(scene: &Trained, path: &Path) -> Result<()> {
    let count = scene.records.len();
    let own = |name: &str| format!("KHR_gaussian_splatting:{name}");
    let mut names = vec![
        ("POSITION".to_owned(), 3),
        (own("ROTATION"), 4),
        (own("SCALE"), 3),
        (own("OPACITY"), 1),
    ];
    for degree in 0..=scene.degree {
        let orders = 0..2 * degree + 1;
        names.extend(orders.map(|order| (own(&format!("SH_DEGREE_{degree}_COEF_{order}")), 3)));
    }
    let mut binary = Vec::new();
    let mut parts = Vec::new();
    for (index, (_, width)) in names.iter().enumerate() {
        let first = binary.len();
        for record in &scene.records {
            let [w, x, y, z] = record.rotation;
            let values: Vec<f64> = match index {
                0 => record.centre.to_vec(),
                1 => vec![x, y, z, w],
                2 => record.scales.to_vec(),
                3 => vec![record.opacity],
                4 => constant_harmonics(record).to_vec(),
                _ => record.harmonics[index - 5].map(f64::from).to_vec(),
            };
            binary.extend(floats(values));
        }
        parts.push((first, binary.len() - first, *width));
    }
    let kinds = ["", "SCALAR", "VEC2", "VEC3", "VEC4"];
    let attributes: serde_json::Map<String, serde_json::Value> = names
        .iter()
        .enumerate()
        .map(|(index, (name, _))| (name.clone(), index.into()))
        .collect();
    let extension = serde_json::json!({"KHR_gaussian_splatting": {"kernel": "ellipse", "colorSpace": "srgb_rec709_display", "sortingMethod": "zDepth"}});
    let document = serde_json::json!({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_gaussian_splatting"], "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"mode": 0, "attributes": attributes, "extensions": extension}]}],
        "accessors": parts.iter().enumerate().map(|(index, (_, _, width))| {
            serde_json::json!({"bufferView": index, "componentType": 5126, "count": count, "type": kinds[*width]})
        }).collect::<Vec<_>>(),
        "bufferViews": parts.iter().map(|(first, bytes, _)| serde_json::json!({"buffer": 0, "byteOffset": first, "byteLength": bytes})).collect::<Vec<_>>(),
        "buffers": [{"byteLength": binary.len()}]
    });
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |value: usize| (value as u32).to_le_bytes();
    let whole = [
        &b"glTF"[..],
        &word(2),
        &word(28 + json.len() + binary.len()),
        &word(json.len()),
        b"JSON",
        &json,
        &word(binary.len()),
        b"BIN\0",
        &binary,
    ];
    save(path, &whole.concat())
}

fn ksplat(scene: &Trained, path: &Path) -> Result<()> {
    let count = (scene.records.len() as u32).to_le_bytes();
    let mut bytes = vec![0u8; 4096 + 1024];
    bytes[1] = 1;
    for (place, value) in [
        (4, 1u32.to_le_bytes()),
        (8, 1u32.to_le_bytes()),
        (12, count),
        (16, count),
        (4096, count),
        (4100, count),
    ] {
        bytes[place..place + 4].copy_from_slice(&value);
    }
    bytes[4096 + 40] = scene.degree;
    for record in &scene.records {
        bytes.extend(floats(
            record
                .centre
                .into_iter()
                .chain(record.scales)
                .chain(record.rotation),
        ));
        bytes.extend(record.base.map(byte));
        bytes.push(byte(record.opacity));
        let mut first = 0;
        for degree in 1..=usize::from(scene.degree) {
            let width = 2 * degree + 1;
            let own = &record.harmonics[first..first + width];
            bytes.extend(floats((0..3).flat_map(|channel| {
                own.iter().map(move |rgb| f64::from(rgb[channel]))
            })));
            first += width;
        }
    }
    save(path, &bytes)
}

fn splat(scene: &Trained, path: &Path) -> Result<()> {
    let mut bytes = Vec::new();
    for record in &scene.records {
        bytes.extend(floats(record.centre.into_iter().chain(record.scales)));
        bytes.extend(record.base.map(byte));
        bytes.push(byte(record.opacity));
        bytes.extend(
            record
                .rotation
                .map(|part| (part * 128.0 + 128.0).round().clamp(0.0, 255.0) as u8),
        );
    }
    save(path, &bytes)
}

/// Right, up, back: y and z change signs, and with them the harmonics that are odd in them.
fn spz(scene: &Trained, path: &Path) -> Result<()> {
    let records = &scene.records;
    let mut bytes = [
        &b"NGSP"[..],
        &3u32.to_le_bytes(),
        &(records.len() as u32).to_le_bytes(),
        &[scene.degree, 12, 0, 0],
    ]
    .concat();
    for record in records {
        let [x, y, z] = record.centre;
        for place in [x, -y, -z] {
            let most = f64::from((1 << 23) - 1);
            let fixed = (place * 4096.0).round().clamp(-most, most) as i32;
            bytes.extend(&fixed.to_le_bytes()[..3]);
        }
    }
    bytes.extend(records.iter().map(|record| byte(record.opacity)));
    bytes.extend(
        records
            .iter()
            .flat_map(|record| constant_harmonics(record).map(|value| byte(0.5 + 0.15 * value))),
    );
    let log = |log: f64| ((log + 10.0) * 16.0).round().clamp(0.0, 255.0) as u8;
    bytes.extend(
        records
            .iter()
            .flat_map(|record| log_scales(record).map(log)),
    );
    for record in records {
        let [w, x, y, z] = record.rotation;
        let (largest, others) = smallest_three([x, -y, -z, w]);
        let bits = others.iter().fold(largest as u32, |bits, part| {
            let sign = u32::from(*part < 0.0);
            bits << 10 | sign << 9 | step(part.abs(), 511)
        });
        bytes.extend(bits.to_le_bytes());
    }
    for record in records {
        for (k, rgb) in record.harmonics.iter().enumerate() {
            let sign = if is_odd(k) { -1.0 } else { 1.0 };
            bytes.extend(
                rgb.map(|value| (sign * value * 128.0 + 128.0).round().clamp(0.0, 255.0) as u8),
            );
        }
    }
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(&bytes)?;
    save(path, &packed.finish()?)
}

/// Does this harmonic of degree 1 and up change its sign with y and z? Of degree l and order m it is even in z for even l + m, and
/// even in y for m of at least 0.
fn is_odd(index: usize) -> bool {
    let degree = (index + 1).isqrt();
    let order = (index + 1 - degree * degree) as i64 - degree as i64;
    let odd_in_z = (degree as i64 + order) % 2 != 0;
    odd_in_z != (order < 0)
}

fn compressed(scene: &Trained, path: &Path) -> Result<()> {
    let records = &scene.records;
    let chunks = records.chunks(256);
    let mut text = format!(
        "ply\nformat binary_little_endian 1.0\nelement chunk {}\n",
        chunks.len()
    );
    for of in ["", "scale_"] {
        for bound in ["min", "max"] {
            for axis in ["x", "y", "z"] {
                let _ = writeln!(text, "property float {bound}_{of}{axis}");
            }
        }
    }
    for bound in ["min_r", "min_g", "min_b", "max_r", "max_g", "max_b"] {
        let _ = writeln!(text, "property float {bound}");
    }
    let _ = writeln!(text, "element vertex {}", records.len());
    for packed in ["position", "rotation", "scale", "color"] {
        let _ = writeln!(text, "property uint packed_{packed}");
    }
    if scene.degree > 0 {
        let _ = writeln!(text, "element sh {}", records.len());
        for k in 0..3 * scene.coefficients() {
            let _ = writeln!(text, "property uchar f_rest_{k}");
        }
    }
    let mut bytes = (text + "end_header\n").into_bytes();
    let mut words = Vec::new();
    for chunk in chunks {
        let ranges = [
            range(chunk, |record| record.centre),
            range(chunk, log_scales),
            range(chunk, |record| record.base),
        ];
        // What the reader will see.
        let ranges =
            ranges.map(|bounds| bounds.map(|three| three.map(|value| f64::from(value as f32))));
        bytes.extend(floats(ranges.as_flattened().as_flattened().iter().copied()));
        for record in chunk {
            words.extend(
                packed(record, &ranges)
                    .into_iter()
                    .flat_map(u32::to_le_bytes),
            );
        }
    }
    bytes.extend(words);
    for record in records.iter().filter(|_| scene.degree > 0) {
        let stored =
            (0..3).flat_map(|channel| record.harmonics.iter().map(move |rgb| rgb[channel]));
        bytes.extend(
            stored.map(|value| ((value / 8.0 + 0.5) * 256.0).floor().clamp(0.0, 255.0) as u8),
        );
    }
    save(path, &bytes)
}

fn packed(record: &Gaussian, [places, logs, colours]: &[[[f64; 3]; 2]; 3]) -> [u32; 4] {
    let parts = |values: [f64; 3], bounds: &[[f64; 3]; 2]| -> [f64; 3] {
        std::array::from_fn(|k| part(values[k], bounds[0][k], bounds[1][k]))
    };
    let three = |[a, b, c]: [f64; 3]| step(a, 2047) << 21 | step(b, 1023) << 11 | step(c, 2047);
    let (largest, others) = smallest_three(record.rotation);
    let rotation = others.iter().fold(largest as u32, |bits, part| {
        bits << 10 | step(0.5 * part + 0.5, 1023)
    });
    let [r, g, b] = parts(record.base, colours).map(|part| step(part, 255));
    [
        three(parts(record.centre, places)),
        rotation,
        three(parts(log_scales(record), logs)),
        r << 24 | g << 16 | b << 8 | step(record.opacity, 255),
    ]
}

/// A record's pixel in one of the pictures.
type RecordPixel<'a> = &'a dyn Fn(&Gaussian) -> [u8; 4];

fn sog(scene: &Trained, path: &Path) -> Result<()> {
    std::fs::create_dir_all(path)?;
    let symmetric = |record: &Gaussian| {
        record
            .centre
            .map(|place| place.abs().ln_1p().copysign(place))
    };
    let means = scene.range(symmetric);
    // One codebook for all three channels.
    let whole = |bounds: [[f64; 3]; 2]| {
        let [least, greatest] = bounds;
        [
            least.into_iter().fold(f64::INFINITY, f64::min),
            greatest.into_iter().fold(f64::NEG_INFINITY, f64::max),
        ]
    };
    let logs = whole(scene.range(log_scales));
    let constants = whole(scene.range(constant_harmonics));
    let book = |[least, greatest]: [f64; 2]| -> Vec<f64> {
        (0..256)
            .map(|code| least + (greatest - least) * f64::from(code) / 255.0)
            .collect()
    };
    let coded = |values: [f64; 3], [least, greatest]: [f64; 2]| {
        values.map(|value| byte(part(value, least, greatest)))
    };
    let words = |record: &Gaussian| -> [u32; 3] {
        let values = symmetric(record);
        std::array::from_fn(|axis| step(part(values[axis], means[0][axis], means[1][axis]), 65_535))
    };
    let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
    let pictures: [(&str, RecordPixel); 5] = [
        ("means_l", &|record| {
            opaque(words(record).map(|word| word as u8))
        }),
        ("means_u", &|record| {
            opaque(words(record).map(|word| (word >> 8) as u8))
        }),
        ("scales", &|record| opaque(coded(log_scales(record), logs))),
        ("quats", &|record| {
            let (largest, others) = smallest_three(record.rotation);
            let [a, b, c] = others.map(|part| byte(0.5 * part + 0.5));
            [a, b, c, 252 + largest as u8]
        }),
        ("sh0", &|record| {
            let [r, g, b] = coded(constant_harmonics(record), constants);
            [r, g, b, byte(record.opacity)]
        }),
    ];
    let width = (scene.records.len() as f64).sqrt().ceil() as usize;
    let height = scene.records.len().div_ceil(width);
    for (name, pixel) in pictures {
        let mut pixels: Vec<u8> = scene.records.iter().flat_map(pixel).collect();
        pixels.resize(4 * width * height, 0);
        let mut file = Vec::new();
        WebPEncoder::new(&mut file).encode(
            &pixels,
            width as u32,
            height as u32,
            ColorType::Rgba8,
        )?;
        save(&path.join(format!("{name}.webp")), &file)?;
    }
    let meta = serde_json::json!({
        "version": 2, "count": scene.records.len(),
        "means": {"mins": means[0], "maxs": means[1], "files": ["means_l.webp", "means_u.webp"]},
        "scales": {"codebook": book(logs), "files": ["scales.webp"]},
        "quats": {"files": ["quats.webp"]},
        "sh0": {"codebook": book(constants), "files": ["sh0.webp"]}
    });
    save(&path.join("meta.json"), meta.to_string().as_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::trained::length;
    use super::*;
    use splatline_sim::scene::{LoadOptions, load, synthetic};

    /// Every number comes back within the format's own step: a writer and a reader that agree on a wrong layout would not.
    #[test]
    fn what_is_written_is_read_back_within_the_formats_steps() {
        let scene = synthetic::random_gaussians(300, 7, 1.0);
        let folder = std::env::temp_dir().join(format!("splatline-writers-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for writer in &WRITERS {
            let path = writer.write(&scene, &folder).unwrap().unwrap();
            let again = load(&path, &LoadOptions::default()).unwrap();
            assert_eq!(again.splats.len(), 300, "{}", writer.name);
            for (a, b) in scene.splats.iter().zip(&again.splats) {
                let longest = a.axes.map(length).into_iter().fold(0.0, f64::max);
                for axis in 0..3 {
                    assert!(
                        (a.centre[axis] - b.centre[axis]).abs() < 3e-3,
                        "{} {a:?} {b:?}",
                        writer.name
                    );
                    assert!(
                        (a.colour[axis] - b.colour[axis]).abs() < 0.02,
                        "{} {a:?} {b:?}",
                        writer.name
                    );
                }
                for (a, b) in a.axes.as_flattened().iter().zip(b.axes.as_flattened()) {
                    assert!((a - b).abs() < 0.06 * longest, "{} {a} {b}", writer.name);
                }
                assert!(
                    (a.weight - b.weight).abs() < 2.1e-3,
                    "{} {a:?} {b:?}",
                    writer.name
                );
            }
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    /// The rule for the signs of harmonics against a drawing of them: in the reader of .spz it is found by evaluating each.
    #[test]
    fn harmonics_of_degree_1_and_2_that_are_odd_in_y_and_z() {
        let odd: Vec<usize> = (0..8).filter(|k| is_odd(*k)).collect();
        // y and z of degree 1; xy and xz of degree 2.
        assert_eq!(odd, [0, 1, 3, 6]);
    }
}
