//! scratch
use splatline_sim::{gallery, picture::Depth};
fn main() {
    let out = std::path::Path::new("/tmp/kg");
    std::fs::create_dir_all(out).unwrap();
    for e in gallery::kernels::some(
        std::path::Path::new("/work/shared/data"),
        &std::env::args().nth(1).unwrap(),
    ) {
        println!("== {} {}\n{}", e.name, e.equation, e.caption);
        for (w, v, u) in &e.numbers {
            println!("  {w:80} {v:.6} {u}");
        }
        for (n, p) in &e.pictures {
            p.write_png(
                &out.join(format!("{}-{}.png", e.name, n.replace([' ', ','], "_"))),
                Depth::Eight,
            )
            .unwrap();
        }
    }
}
