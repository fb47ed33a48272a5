//! The same drawing in soft float.
#![cfg_attr(target_os = "none", no_std, no_main)]

use splatline_firmware::float_picture::{FloatMemory, FloatOutcome, draw};

#[cfg(target_os = "none")]
mod image {
    use super::{FloatMemory, draw, report};
    use splatline_firmware::board;
    use splatline_firmware::order::Full;

    static mut MEMORY: FloatMemory = FloatMemory::EMPTY;

    #[unsafe(no_mangle)]
    fn image_main() {
        let memory = &raw mut MEMORY;
        // SAFETY: called once, on one core without interrupts.
        let memory = unsafe { &mut *memory };
        let outcome = draw(memory);
        let stack = board::stack_used();
        match outcome {
            Ok(outcome) => report(&outcome, board::print),
            Err(Full) => board::print("order_full", 1),
        }
        board::print("stack", stack);
    }
}

fn report(outcome: &FloatOutcome, mut print: impl FnMut(&str, u32)) {
    print("visible", outcome.visible);
    print("covered_box", outcome.covered[0]);
    print("covered_spans", outcome.covered[1]);
    print("sum_box", outcome.sum[0]);
    print("sum_spans", outcome.sum[1]);
}

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    use splatline_firmware::order::Full;
    let failed = |Full| std::io::Error::other("the depth order has too little room");
    let outcome = draw(&mut Box::new(FloatMemory::EMPTY)).map_err(failed)?;
    report(&outcome, |name, value| println!("{name}={value}"));
    Ok(())
}
