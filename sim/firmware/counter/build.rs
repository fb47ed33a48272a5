//! The `qemu_plugin_*` functions are those of the emulator that loads the plugin.
fn main() {
    println!("cargo:rustc-cdylib-link-arg=-Wl,--unresolved-symbols=ignore-all");
}
