//! Splats on a Raspberry Pi Pico 2: `pico.rs` with the RP2350's HAL and its image's definition.
#![no_std]
#![no_main]

use panic_halt as _;
use rp235x_hal as hal;

/// What the boot ROM looks for: a secure image for the Arm cores.
#[unsafe(link_section = ".start_block")]
#[used]
static IMAGE: hal::block::ImageDef = hal::block::ImageDef::secure_exe();

#[path = "../../pico.rs"]
mod pico;

#[hal::entry]
fn main() -> ! {
    pico::run()
}
