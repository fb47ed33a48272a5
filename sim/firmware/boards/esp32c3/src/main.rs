//! Splats on an ESP32-C3: a frame of 240x240 in strips of eight rows, to an ST7789 at SPI2 (clock GPIO6, data GPIO7,
//! select GPIO10, data or command GPIO4, reset GPIO5).
//!
//! The same scene and bits as the emulated image next door, whose checksum is checked there.
#![no_std]
#![no_main]

use embedded_hal_bus::spi::ExclusiveDevice;
use esp_hal::clock::CpuClock;
use esp_hal::delay::Delay;
use esp_hal::gpio::{AnyPin, Level, Output, OutputConfig};
use esp_hal::spi::Mode;
use esp_hal::spi::master::{Config, Spi};
use esp_hal::time::Rate;
use mipidsi::interface::SpiInterface;
use mipidsi::models::ST7789;
use mipidsi::options::ColorInversion;
use panic_halt as _;
use splatline_boards::{halt, show};
use splatline_frame::FrameMemory;
use splatline_frame::scene::SIDE;

esp_bootloader_esp_idf::esp_app_desc!();

static mut MEMORY: FrameMemory = FrameMemory::EMPTY;

#[esp_hal::main]
fn main() -> ! {
    let device = esp_hal::init(esp_hal::Config::default().with_cpu_clock(CpuClock::max()));
    let settings = Config::default()
        .with_frequency(Rate::from_mhz(40))
        .with_mode(Mode::_0);
    let Ok(bus) = Spi::new(device.SPI2, settings) else {
        halt()
    };
    let bus = bus.with_sck(device.GPIO6).with_mosi(device.GPIO7);
    let high = |pin: AnyPin<'static>| Output::new(pin, Level::High, OutputConfig::default());
    // Its pins cannot fail.
    let Ok(bus) = ExclusiveDevice::new(bus, high(device.GPIO10.into()), Delay::new());
    let mut buffer = [0; 512];
    let interface = SpiInterface::new(bus, high(device.GPIO4.into()), &mut buffer);
    let display = mipidsi::Builder::new(ST7789, interface)
        .display_size(SIDE, SIDE)
        .invert_colors(ColorInversion::Inverted)
        .reset_pin(high(device.GPIO5.into()))
        .init(&mut Delay::new());
    let Ok(mut display) = display else { halt() };
    // SAFETY: once, in a function that is called once.
    let memory = unsafe { &mut *&raw mut MEMORY };
    show(&mut display, memory)
}
