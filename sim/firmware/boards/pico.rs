//! Splats on a Raspberry Pi Pico or Pico 2: a frame of 240x240 in strips of eight rows, to an ST7789 at SPI1 (clock
//! GP10, data GP11, select GP9, data or command GP8, reset GP12).
//!
//! Both cores draw: core 0 the even strips, core 1 the odd ones, each into memory of its own, from a list that neither
//! changes meanwhile. Core 0 sends all of them. The same scene and bits as the emulated image next door, whose checksum
//! is checked there.
//!
//! Two programs include this file, since their HALs are crates of their own that look alike: `crate::hal` is the
//! board's.

use crate::hal;
use core::cell::UnsafeCell;
use embedded_graphics_core::pixelcolor::Rgb565;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::MODE_0;
use embedded_hal_bus::spi::ExclusiveDevice;
use hal::clocks::init_clocks_and_plls;
use hal::fugit::RateExtU32;
use hal::gpio::{FunctionSpi, Pins};
use hal::multicore::{Multicore, Stack};
use hal::{Clock, Sio, Spi, Watchdog, pac};
use mipidsi::Display;
use mipidsi::interface::{Interface, InterfacePixelFormat, SpiInterface};
use mipidsi::models::{Model, ST7789};
use mipidsi::options::ColorInversion;
use splatline::front::PackedList;
use splatline::{Micro16, Pixel, Renderer};
use splatline_boards::halt;
use splatline_frame::scene::{SCENES, SIDE, view};
use splatline_frame::{BACKGROUND, STRIP, STRIP_PIXELS, WORDS};

/// Of the crystal on the board, in hertz.
const CRYSTAL: u32 = 12_000_000;

/// A core's own strip, and the same as it is sent.
struct Strip {
    pixels: [Pixel; STRIP_PIXELS],
    sent: [u16; STRIP_PIXELS],
}

/// Memory that the cores hand to each other through their FIFOs: whoever has been told last may use it.
struct Handed<T>(UnsafeCell<T>);

// SAFETY: one core at a time, or both for reading; the FIFOs order their accesses.
unsafe impl<T> Sync for Handed<T> {}

static WORDS_OF_LIST: Handed<[u32; WORDS]> = Handed(UnsafeCell::new([0; WORDS]));
static LIST: Handed<Option<PackedList<'static, Micro16>>> = Handed(UnsafeCell::new(None));
static STRIPS: [Handed<Strip>; 2] = [const {
    Handed(UnsafeCell::new(Strip {
        pixels: [Pixel::EMPTY; STRIP_PIXELS],
        sent: [0; STRIP_PIXELS],
    }))
}; 2];
static STACK: Stack<4096> = Stack::new();

/// Draws a strip into the memory of `core`.
///
/// # Safety
/// Nobody else uses that core's strip, and nobody changes the list meanwhile.
unsafe fn draw_strip(core: usize, number: usize) {
    // SAFETY: the function's own contract; both cores read the list.
    let (list, strip) = unsafe { (&*LIST.0.get(), &mut *STRIPS[core & 1].0.get()) };
    let window = view().window().strips(STRIP).nth(number);
    let (Some(list), Some(window)) = (list, window) else {
        return;
    };
    if let Ok(frame) = Renderer::new(Micro16).draw(list, window, &mut strip.pixels) {
        frame.write_rgb565(BACKGROUND, &mut strip.sent);
    }
}

/// Core 1: a strip for every word, its number, and a word back when it is drawn.
fn second_core() -> ! {
    // SAFETY: each core has FIFO registers of its own.
    let pac = unsafe { pac::Peripherals::steal() };
    let mut fifo = Sio::new(pac.SIO).fifo;
    loop {
        let number = fifo.read_blocking() as usize;
        // SAFETY: core 0 waits for the answer before it looks at this strip or changes the list.
        unsafe { draw_strip(1, number) };
        fifo.write_blocking(1);
    }
}

/// Core 0.
pub fn run() -> ! {
    let Some(mut pac) = pac::Peripherals::take() else {
        halt()
    };
    let mut watchdog = Watchdog::new(pac.WATCHDOG);
    let clocks = init_clocks_and_plls(
        CRYSTAL,
        pac.XOSC,
        pac.CLOCKS,
        pac.PLL_SYS,
        pac.PLL_USB,
        &mut pac.RESETS,
        &mut watchdog,
    );
    let Ok(clocks) = clocks else { halt() };
    let Some(core) = cortex_m::Peripherals::take() else {
        halt()
    };
    let mut delay = cortex_m::delay::Delay::new(core.SYST, clocks.system_clock.freq().to_Hz());
    let mut sio = Sio::new(pac.SIO);
    let mut multicore = Multicore::new(&mut pac.PSM, &mut pac.PPB, &mut sio.fifo);
    let [_, other] = multicore.cores() else {
        halt()
    };
    let Some(stack) = STACK.take() else { halt() };
    if other.spawn(stack, || second_core()).is_err() {
        halt()
    }
    let pins = Pins::new(
        pac.IO_BANK0,
        pac.PADS_BANK0,
        sio.gpio_bank0,
        &mut pac.RESETS,
    );
    let clock = pins.gpio10.into_function::<FunctionSpi>();
    let data = pins.gpio11.into_function::<FunctionSpi>();
    let bus = Spi::<_, _, _, 8>::new(pac.SPI1, (data, clock));
    let bus = bus.init(
        &mut pac.RESETS,
        clocks.peripheral_clock.freq(),
        62_500_000u32.Hz(),
        MODE_0,
    );
    let select = pins.gpio9.into_push_pull_output();
    // Its pins cannot fail.
    let Ok(device) = ExclusiveDevice::new_no_delay(bus, select);
    let mut buffer = [0; 512];
    let interface = SpiInterface::new(device, pins.gpio8.into_push_pull_output(), &mut buffer);
    let display = mipidsi::Builder::new(ST7789, interface)
        .display_size(SIDE, SIDE)
        .invert_colors(ColorInversion::Inverted)
        .reset_pin(pins.gpio12.into_push_pull_output())
        .init(&mut delay);
    let Ok(mut display) = display;
    // SAFETY: once, and core 1 has no strip to draw yet.
    unsafe { *LIST.0.get() = Some(PackedList::new(Micro16, &mut *WORDS_OF_LIST.0.get())) };
    loop {
        for scene in &SCENES {
            // SAFETY: core 1 is idle between frames.
            if let Some(list) = unsafe { &mut *LIST.0.get() } {
                // A list that is full is left empty, and shows as the background.
                let _ = Renderer::new(Micro16).set_up_scene(&view(), scene, list);
            }
            for pair in (0..usize::from(SIDE / STRIP)).step_by(2) {
                sio.fifo.write_blocking(pair as u32 + 1);
                // SAFETY: this is core 0's strip, and the list stays.
                unsafe { draw_strip(0, pair) };
                send(&mut display, 0, pair);
                sio.fifo.read_blocking();
                send(&mut display, 1, pair + 1);
            }
        }
    }
}

/// Sends a core's strip.
fn send<I, M, R>(display: &mut Display<I, M, R>, core: usize, number: usize)
where
    I: Interface,
    M: Model<ColorFormat = Rgb565>,
    R: OutputPin,
    Rgb565: InterfacePixelFormat<I::Word>,
{
    // SAFETY: the core has said that it is done with its strip.
    let strip = unsafe { &*STRIPS[core & 1].0.get() };
    splatline_boards::send(display, number as u16 * STRIP, &strip.sent);
}
