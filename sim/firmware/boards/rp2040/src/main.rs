//! Splats on a Raspberry Pi Pico: `pico.rs` with the RP2040's HAL and boot loader.
#![no_std]
#![no_main]

use panic_halt as _;
use rp2040_hal as hal;

#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

#[path = "../../pico.rs"]
mod pico;

#[hal::entry]
fn main() -> ! {
    pico::run()
}
