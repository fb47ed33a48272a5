//! The scene on a display: on a board under QEMU, or on the host with the picture as a PNG file.
#![cfg_attr(target_os = "none", no_std, no_main)]

use splatline_display::panel::Panel;
use splatline_display::{DisplayMemory, draw, scene, visible};

#[cfg(target_os = "none")]
mod image {
    use super::{DisplayMemory, Panel, draw, report};
    use splatline_firmware::board;

    static mut MEMORY: DisplayMemory = DisplayMemory::EMPTY;

    #[unsafe(no_mangle)]
    fn image_main() {
        let memory = &raw mut MEMORY;
        // SAFETY: called once, on one core without interrupts.
        let memory = unsafe { &mut *memory };
        let mut panel = Panel::default();
        let drawn = draw(memory, &mut panel);
        let stack = board::stack_used();
        match drawn {
            Ok(_) => report(memory, &panel, board::print),
            Err(_) => board::print("failed", 1),
        }
        board::print("stack", stack);
    }
}

fn report(memory: &DisplayMemory, panel: &Panel, mut print: impl FnMut(&str, u32)) {
    print("checksum", panel.checksum.value());
    print("pixels", panel.pixels);
    print("visible", visible(memory) as u32);
    print("splats", scene::SPLATS.into());
}

/// The same lines, and the pixels that were covered; with a file name, the picture as a PNG file, two pixels for one.
#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    use embedded_graphics::pixelcolor::Rgb565;
    use embedded_graphics::prelude::Size;
    use embedded_graphics_simulator::{OutputSettingsBuilder, SimulatorDisplay};
    use splatline_display::covered;
    let mut memory = Box::new(DisplayMemory::EMPTY);
    let mut panel = Panel::default();
    draw(&mut memory, &mut panel).map_err(|failure| format!("no picture: {failure:?}"))?;
    report(&memory, &panel, |name, value| println!("{name}={value}"));
    let view = scene::camera()?.view()?;
    println!("covered={}", covered(&mut memory, &view));
    let Some(file) = std::env::args().nth(1) else {
        return Ok(());
    };
    let [columns, rows] = scene::SIZE.map(u32::from);
    let mut display = SimulatorDisplay::<Rgb565>::new(Size::new(columns, rows));
    draw(&mut memory, &mut display).map_err(|failure| format!("no picture: {failure:?}"))?;
    let settings = OutputSettingsBuilder::new().scale(2).build();
    display.to_rgb_output_image(&settings).save_png(file)?;
    Ok(())
}
