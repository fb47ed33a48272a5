//! x
fn main() {
    use splatline::format::{Lean18, Standard24};
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    for (name, widths) in [
        ("lean18", Lean18::WIDTHS),
        ("standard24", Standard24::WIDTHS),
    ] {
        std::fs::write(
            format!("{root}/{name}/splatline_pkg.sv"),
            splatline_rtl::package::text(name, &widths),
        )
        .unwrap();
    }
}
