//! Tells the architecture: Rust's own settings do not distinguish Armv6-M (Cortex-M0, M0+), Armv7-M and Armv7E-M
//! (Cortex-M4).

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    for (name, triple) in [("armv6m", "thumbv6m"), ("armv7em", "thumbv7em")] {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if std::env::var("TARGET").is_ok_and(|target| target.starts_with(triple)) {
            println!("cargo::rustc-cfg={name}");
        }
    }
}
