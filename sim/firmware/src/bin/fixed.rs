//! The scene through the kernel: on a board under QEMU, or on the host to see what must come out.
#![cfg_attr(target_os = "none", no_std, no_main)]

use splatline_firmware::fixed_picture::{Memory, Outcome, draw};

#[cfg(target_os = "none")]
mod image {
    use super::{Memory, Outcome, draw, report};
    use core::cell::UnsafeCell;
    use splatline_firmware::board;

    struct Lent(UnsafeCell<Memory>);
    // SAFETY: one core, no interrupts.
    unsafe impl Sync for Lent {}
    static MEMORY: Lent = Lent(UnsafeCell::new(Memory::new()));

    #[unsafe(no_mangle)]
    fn image_main() {
        // SAFETY: called once.
        let memory = unsafe { &mut *MEMORY.0.get() };
        let outcome: Outcome = draw(memory, |_| ());
        let stack = board::stack_used();
        report(&outcome, board::print);
        board::print("stack", stack);
    }
}

fn report(outcome: &Outcome, mut print: impl FnMut(&str, u32)) {
    print("checksum", outcome.checksum.value());
    print("visible", outcome.visible);
    print("covered", outcome.covered as u32);
    print("visited", outcome.visited as u32);
}

/// On the host: the same lines; with a file name, the picture as PPM too.
#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    use splatline_firmware::scene::{COLUMNS, ROWS};
    let mut memory = Box::new(Memory::new());
    let mut picture = format!("P6\n{COLUMNS} {ROWS}\n255\n").into_bytes();
    let outcome = draw(&mut memory, |strip| {
        let bytes = strip.iter().flat_map(|pixel| pixel.colour);
        picture.extend(bytes.map(|c| (c * 255 >> 16).min(255) as u8));
    });
    report(&outcome, |name, value| println!("{name}={value}"));
    match std::env::args().nth(1) {
        Some(file) => std::fs::write(file, picture),
        None => Ok(()),
    }
}
