//! Splats on an STM32F429I discovery board: a frame of 240x240 in strips of eight rows, to the ILI9341 that it carries
//! at SPI5 (clock PF7, data PF9, select PC2, data or command PD13).
//!
//! The same scene and bits as the emulated image next door, whose checksum is checked there.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use embedded_hal::spi::MODE_0;
use embedded_hal_bus::spi::ExclusiveDevice;
use mipidsi::interface::SpiInterface;
use mipidsi::models::ILI9341Rgb565;
use panic_halt as _;
use splatline_boards::{halt, show};
use splatline_frame::FrameMemory;
use splatline_frame::scene::SIDE;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::spi::Spi;

#[entry]
fn main() -> ! {
    let (Some(core), Some(device)) = (cortex_m::Peripherals::take(), pac::Peripherals::take())
    else {
        halt()
    };
    let Some(memory) = cortex_m::singleton!(: FrameMemory = FrameMemory::EMPTY) else {
        halt()
    };
    let clocks = Config::hse(8.MHz()).sysclk(168.MHz());
    let mut rcc = device.RCC.freeze(clocks);
    let mut delay = core.SYST.delay(&rcc.clocks);
    let bank_c = device.GPIOC.split(&mut rcc);
    let bank_d = device.GPIOD.split(&mut rcc);
    let bank_f = device.GPIOF.split(&mut rcc);
    let pins = (Some(bank_f.pf7), Some(bank_f.pf8), Some(bank_f.pf9));
    let bus = Spi::new(device.SPI5, pins, MODE_0, 42.MHz(), &mut rcc);
    // Its pins cannot fail.
    let Ok(device) = ExclusiveDevice::new_no_delay(bus, bank_c.pc2.into_push_pull_output());
    let mut buffer = [0; 512];
    let interface = SpiInterface::new(device, bank_d.pd13.into_push_pull_output(), &mut buffer);
    let display = mipidsi::Builder::new(ILI9341Rgb565, interface)
        .display_size(SIDE, SIDE)
        .init(&mut delay);
    let Ok(mut display) = display else { halt() };
    show(&mut display, memory)
}
