//! The linker scripts of this folder: boards with 256 KiB of RAM; and for which processors there is a pixel loop in
//! assembly (of `Micro16`).

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(assembly)");
    let of =
        |triple: &&str| std::env::var("TARGET").is_ok_and(|target| target.starts_with(*triple));
    let other = std::env::var_os("CARGO_FEATURE_LEAN18").is_some();
    if !other && ["thumbv6m", "thumbv7em", "riscv32"].iter().any(of) {
        println!("cargo::rustc-cfg=assembly");
    }
    println!("cargo::rustc-link-search={}", env!("CARGO_MANIFEST_DIR"));
    println!("cargo::rustc-link-search={}/..", env!("CARGO_MANIFEST_DIR"));
}
