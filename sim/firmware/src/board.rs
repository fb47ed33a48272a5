//! What a board needs: reset, output by semihosting, a gauge of the stack, and a panic handler that does not link.

use core::arch::{asm, global_asm};

// The panic handler refers to a symbol that nobody defines: the image links only if no panic path has survived.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        fn panic_path_survived() -> !;
    }
    // SAFETY: never linked.
    unsafe { panic_path_survived() }
}

unsafe extern "C" {
    static mut bss_start: u32;
    static mut bss_end: u32;
    static mut stack_top: u32;
}

#[cfg(target_arch = "arm")]
global_asm!(
    ".section .vectors, \"a\"",
    ".word stack_top",
    ".word start",
    ".word fault",
    ".word fault",
    ".text",
    ".thumb_func",
    "fault: b fault",
);

#[cfg(target_arch = "riscv32")]
global_asm!(
    ".section .start, \"ax\"",
    ".global start",
    "start: la sp, stack_top",
    "j reset",
);

/// Arm loads the stack pointer from the vector table.
#[cfg(target_arch = "arm")]
#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    reset()
}

const FRESH: u32 = 0xa5a5_a5a5;

/// Zeroes variables, paints the stack, runs the image.
#[unsafe(no_mangle)]
extern "C" fn reset() -> ! {
    unsafe extern "Rust" {
        safe fn image_main();
    }
    // SAFETY: the symbols are the linker script's; nothing lives between the end of the variables and the stack pointer
    // but what this function has itself, for which 128 bytes are left alone.
    unsafe {
        let mut word = &raw mut bss_start;
        while word < &raw mut bss_end {
            word.write_volatile(0);
            word = word.add(1);
        }
        let here = 0u32;
        let end = (&raw const here as usize - 128) as *mut u32;
        while word < end {
            word.write_volatile(FRESH);
            word = word.add(1);
        }
        image_main();
    }
    exit()
}

/// Bytes of stack used at most since reset.
pub fn stack_used() -> u32 {
    // SAFETY: the symbols are the linker script's.
    unsafe {
        let mut word = &raw mut bss_end;
        while word < &raw mut stack_top && word.read_volatile() == FRESH {
            word = word.add(1);
        }
        (&raw const stack_top as usize - word as usize) as u32
    }
}

#[cfg(target_arch = "arm")]
fn host(operation: u32, argument: u32) {
    // SAFETY: the debugger's (QEMU's) trap; it returns in r0.
    unsafe { asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument) }
}

#[cfg(target_arch = "riscv32")]
fn host(operation: u32, argument: u32) {
    // SAFETY: the three instructions are the debugger's (QEMU's) trap; it returns in a0.
    unsafe {
        asm!(
            ".option push", ".option norvc", ".balign 16",
            "slli x0, x0, 0x1f", "ebreak", "srai x0, x0, 7",
            ".option pop",
            inout("a0") operation => _, in("a1") argument,
        )
    }
}

/// Ends the emulation.
pub fn exit() -> ! {
    const ANGEL_REPORT: u32 = 0x18;
    const APPLICATION_EXIT: u32 = 0x20026;
    loop {
        host(ANGEL_REPORT, APPLICATION_EXIT);
    }
}

/// One line, `name=value` in decimal.
pub fn print(name: &str, value: u32) {
    put(name);
    put("=");
    let mut digits = [0u8; 10];
    let mut rest = value;
    let mut used = 0;
    for digit in digits.iter_mut().rev() {
        *digit = b'0' + (rest % 10) as u8;
        rest /= 10;
        used += 1;
        if rest == 0 {
            break;
        }
    }
    for digit in digits.iter().skip(10 - used) {
        put_byte(*digit);
    }
    put("\n");
}

fn put(text: &str) {
    text.bytes().for_each(put_byte);
}

fn put_byte(byte: u8) {
    const WRITE_CHARACTER: u32 = 3;
    host(WRITE_CHARACTER, &raw const byte as u32);
}
