//! Three frames: on a board under QEMU, or on the host to see what must come out.
#![cfg_attr(target_os = "none", no_std, no_main)]

use splatline_frame::scene::SCENES;
use splatline_frame::{FrameMemory, draw};

/// Setup and drawing of each scene, for the counter of instructions.
mod phase {
    splatline_firmware::phases! {
        phase_setup_200 = 11, "Setup of 200 splats.";
        phase_draw_200 = 12, "Drawing of 200 splats.";
        phase_setup_1000 = 13, "Setup of 1000 splats.";
        phase_draw_1000 = 14, "Drawing of 1000 splats.";
        phase_setup_3000 = 15, "Setup of 3000 splats.";
        phase_draw_3000 = 16, "Drawing of 3000 splats.";
    }
}

/// Draws all scenes and prints what came out of each.
fn frames(memory: &mut FrameMemory, mut print: impl FnMut(&str, u32)) {
    let phases: [(extern "C" fn(), extern "C" fn()); 3] = [
        (phase::phase_setup_200, phase::phase_draw_200),
        (phase::phase_setup_1000, phase::phase_draw_1000),
        (phase::phase_setup_3000, phase::phase_draw_3000),
    ];
    for (scene, (set_up, paint)) in SCENES.iter().zip(phases) {
        match draw(scene, memory, set_up, paint) {
            Some(outcome) => {
                print("checksum", outcome.checksum.value());
                print("visible", outcome.visible);
            }
            None => print("failed", 1),
        }
    }
}

#[cfg(target_os = "none")]
mod image {
    use super::{FrameMemory, frames};
    use splatline_firmware::board;

    static mut MEMORY: FrameMemory = FrameMemory::EMPTY;

    #[unsafe(no_mangle)]
    fn image_main() {
        let memory = &raw mut MEMORY;
        // SAFETY: called once, on one core without interrupts.
        let memory = unsafe { &mut *memory };
        frames(memory, board::print);
        board::print("stack", board::stack_used());
    }
}

/// The same lines; fails if the kernel's general painter sends another picture. With a file name, the scenes side by
/// side as PPM.
#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    use splatline_frame::{expected, scene::SIDE};
    let mut lines = Vec::new();
    let mut memory = Box::new(FrameMemory::EMPTY);
    frames(&mut memory, |name, value| {
        lines.push(format!("{name}={value}"))
    });
    println!("{}", lines.join("\n"));
    let mut pictures = Vec::new();
    for (scene, seen) in SCENES.iter().zip(lines.chunks(2)) {
        let (outcome, covered, sent) = expected(scene);
        println!("covered={covered}");
        if seen[0] != format!("checksum={}", outcome.checksum.value()) {
            return Err(std::io::Error::other(
                "the general painter sends another picture",
            ));
        }
        pictures.push(sent);
    }
    let Some(file) = std::env::args().nth(1) else {
        return Ok(());
    };
    let side = usize::from(SIDE);
    let mut ppm = format!("P6\n{} {side}\n255\n", side * pictures.len()).into_bytes();
    for y in 0..side {
        for picture in &pictures {
            for bits in picture.iter().skip(y * side).take(side) {
                let (red, green, blue) = (bits >> 11, bits >> 5 & 63, bits & 31);
                ppm.extend([red * 255 / 31, green * 255 / 63, blue * 255 / 31].map(|c| c as u8));
            }
        }
    }
    std::fs::write(file, ppm)
}
