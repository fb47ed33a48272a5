//! A program in C, compiled and run: its pictures equal Rust's, word for word.

use fixed::types::{I2F30, I32F32, U4F28};
use splatline::blend::Pixel;
use splatline::format::{Classic8, Deep32, Design, Lean18, Micro16, Standard24, Traversal};
use splatline::kernel::{entries, fill_gaussian};
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, RatioLimits, View};
use splatline::{BoundedList, Camera, Gaussian, Renderer};
use std::path::Path;
use std::process::Command;

const SIZE: [u16; 2] = [96, 64];
const PIXELS: usize = 96 * 64;

/// The generator of `examples/picture.c`.
struct Random(u32);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }
}

fn splats() -> Vec<VolumeSplat> {
    let mut random = Random(1);
    let mut splat = || VolumeSplat {
        centre: [(); 3].map(|()| SoftFloat {
            mantissa: ((random.bits() >> 8) as i32 - (1 << 23)) * 4,
            exponent: -24,
        }),
        axes: [(); 3].map(|()| Axis {
            mantissa: [(); 3].map(|()| (random.bits() >> 1) as i32 - (1 << 30)),
            exponent: -32 - (random.bits() >> 30) as i32,
        }),
        weight: SoftFloat {
            mantissa: (random.bits() >> 2) as i32,
            exponent: -30,
        },
        colour: [(); 3].map(|()| U4F28::from_bits(random.bits() >> 4)),
    };
    (0..200).map(|_| splat()).collect()
}

fn view() -> View {
    let (zero, one) = (I2F30::ZERO, I2F30::ONE);
    let limit = I32F32::from_bits(3_435_973_837);
    let focal = SoftFloat {
        mantissa: 80 << 24,
        exponent: -24,
    };
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: Eye {
            position: [0, 0, -4],
            ..Eye::ORIGIN
        },
        focal: [focal; 2],
        principal: SIZE.map(|size| I32F32::from_num(size / 2)),
        near: Extended {
            value: 180_143_985_094_820,
            exponent: -54,
        },
        far: Extended {
            value: 200,
            exponent: 0,
        },
        viewport: SIZE,
        projection: Projection::Perspective,
        limits: RatioLimits {
            low: [-limit; 2],
            high: [limit; 2],
        },
    }
}

fn picture<D: Design>(design: D, traversal: Traversal) -> Vec<Pixel> {
    let (widths, rules) = (design.widths(), Rules::GAUSSIAN_3D);
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, rules.table_range);
    let renderer = Renderer::with_table(design, rules, &memory).unwrap();
    let renderer = renderer.with_traversal(traversal);
    let mut list = BoundedList::<200>::new();
    let mut pixels = vec![Pixel::EMPTY; PIXELS];
    let drawn = renderer.render(&view(), splats(), &mut list, &mut pixels);
    drawn.unwrap();
    pixels
}

/// What the C program writes: designs, in them both traversals.
fn expected() -> Vec<u8> {
    let both = [Traversal::Box, Traversal::Spans];
    let pictures = [
        both.map(|t| picture(Classic8, t)),
        both.map(|t| picture(Lean18, t)),
        both.map(|t| picture(Standard24, t)),
        both.map(|t| picture(Deep32, t)),
    ];
    let words = |p: &Pixel| [p.colour[0], p.colour[1], p.colour[2], p.transmittance];
    let pixels = pictures.iter().flatten().flatten();
    pixels.flat_map(words).flat_map(u32::to_ne_bytes).collect()
}

/// Compiles examples with the library, which cargo leaves beside this test, and runs the program; what it writes.
fn written(name: &str, sources: &[&str]) -> Vec<u8> {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let library = std::env::current_exe().unwrap();
    let flags = "-std=c99 -O1 -Wall -Wextra -Werror -pedantic";
    let compiled = Command::new(&compiler)
        .args(flags.split(' '))
        .arg("-I")
        .arg(here.join("include"))
        .args(
            sources
                .iter()
                .map(|source| here.join("examples").join(source)),
        )
        .arg(library.with_file_name("libsplatline_capi.a"))
        .args(["-lpthread", "-ldl", "-lm", "-o"])
        .arg(&program)
        .status();
    assert!(compiled.unwrap().success());
    let output = program.with_extension("written");
    let ran = Command::new(&program).arg(&output).status();
    assert!(ran.unwrap().success());
    std::fs::read(output).unwrap()
}

#[test]
#[cfg_attr(not(has_cc), ignore = "no C compiler: install one or name it in CC")]
fn a_program_in_c_draws_the_same_picture() {
    let (got, expected) = (written("picture", &["main.c", "picture.c"]), expected());
    assert_eq!(got.len(), expected.len());
    let differing = got.iter().zip(&expected).position(|(g, e)| g != e);
    assert_eq!(differing, None, "first differing byte");
    let covered = expected
        .chunks(16)
        .filter(|pixel| pixel[..4] != [0; 4])
        .count();
    assert!(covered > 8 * PIXELS / 2, "the picture is not empty");
}

/// The example of 40 lines sends a display what the front door of Rust does.
#[test]
#[cfg_attr(not(has_cc), ignore = "no C compiler: install one or name it in CC")]
fn the_front_door_in_c_sends_what_rusts_does() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/display.c");
    let lines = std::fs::read_to_string(&source).unwrap().lines().count();
    assert!(lines <= 45, "the example of 40 lines has {lines}");
    let sent = written("display", &["display.c"]);
    let size = [160, 128];
    let eye = [0.0, -1.0, -4.0];
    let camera = Camera::look_at(eye, [0.0; 3], [0.0, -1.0, 0.0], 40.0, size).unwrap();
    let gaussian = |mean, scales, colour| Gaussian {
        mean,
        scales,
        colour,
        opacity: 0.9,
        ..Gaussian::UNIT
    };
    let scene = [
        gaussian([0.0; 3], [0.4; 3], [1.0, 0.5, 0.1]),
        gaussian([0.8, 0.0, 0.5], [0.1, 0.6, 0.1], [0.1, 0.4, 1.0]),
        gaussian([-0.7, 0.2, -0.4], [0.5, 0.02, 0.3], [0.3, 1.0, 0.4]),
    ];
    let mut list = BoundedList::<3>::new();
    let mut pixels = vec![Pixel::EMPTY; 160 * 128];
    let view = camera.view().unwrap();
    let drawn = Renderer::new(Micro16).render(&view, scene, &mut list, &mut pixels);
    let (frame, counts) = drawn.unwrap();
    assert_eq!(counts.drawn, 3);
    let expected: Vec<u8> = frame.rgb565(0x0883).flat_map(u16::to_ne_bytes).collect();
    assert!(sent == expected);
}
