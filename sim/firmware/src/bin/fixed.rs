//! The scene through the kernel: on a board under QEMU, or on the host to see what must come out.
#![cfg_attr(target_os = "none", no_std, no_main)]

use splatline_firmware::fixed_picture::{FixedMemory, FixedOutcome, draw};

#[cfg(target_os = "none")]
mod image {
    use super::{FixedMemory, draw, report};
    use splatline_firmware::board;
    use splatline_firmware::order::Full;

    static mut MEMORY: FixedMemory = FixedMemory::EMPTY;

    #[unsafe(no_mangle)]
    fn image_main() {
        let memory = &raw mut MEMORY;
        // SAFETY: called once, on one core without interrupts.
        let memory = unsafe { &mut *memory };
        let outcome = draw(memory, |_, _| ());
        let stack = board::stack_used();
        match outcome {
            Ok(outcome) => report(&outcome, board::print),
            Err(Full) => board::print("order_full", 1),
        }
        board::print("stack", stack);
    }
}

fn report(outcome: &FixedOutcome, mut print: impl FnMut(&str, u32)) {
    print("checksum", outcome.checksum.value());
    print("visible", outcome.visible);
}

/// On the host: the same lines, and the pixels that were covered; with a file name, the picture as PPM too. With
/// `design`, only the design's widths, as a file for `splatline --design`.
///
/// Every strip is drawn a second time by the kernel's general painter and must be the same.
#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    use splatline::draw::Coverage;
    use splatline_firmware::general::draw_strip;
    use splatline_firmware::order::Full;
    use splatline_firmware::scene::{COLUMNS, ROWS};
    let argument = std::env::args().nth(1);
    if argument.as_deref() == Some("design") {
        print_design();
        return Ok(());
    }
    let mut memory = Box::new(FixedMemory::EMPTY);
    let mut picture = format!("P6\n{COLUMNS} {ROWS}\n255\n").into_bytes();
    let mut coverage = Coverage::default();
    let mut differing = 0;
    let outcome = draw(&mut memory, |memory, first_row| {
        let (expected, covered) = draw_strip(memory, first_row);
        coverage += covered;
        let pairs = memory.strip.iter().zip(&expected);
        differing += pairs.filter(|(got, expected)| got != expected).count();
        let bytes = memory.strip.iter().flat_map(|pixel| pixel.colour);
        picture.extend(bytes.map(|c| (c >> 18).min(255) as u8));
    });
    let failed = |Full| std::io::Error::other("the depth order has too little room");
    let outcome = outcome.map_err(failed)?;
    report(&outcome, |name, value| println!("{name}={value}"));
    println!("covered={}", coverage.covered);
    println!("visited={}", coverage.visited);
    if differing > 0 {
        return Err(std::io::Error::other(format!(
            "{differing} pixels differ from the general painter's"
        )));
    }
    match argument {
        Some(file) => std::fs::write(file, picture),
        None => Ok(()),
    }
}

#[cfg(not(target_os = "none"))]
fn print_design() {
    use splatline::format::WIDTH_RANGES;
    use splatline_firmware::design::Firmware16;
    println!("base = \"micro16\"");
    for ((name, ..), width) in WIDTH_RANGES.iter().zip(Firmware16::WIDTHS.numbers()) {
        println!("{name} = {width}");
    }
}
