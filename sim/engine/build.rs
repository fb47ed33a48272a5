//! Tells the tests what of which some of them need is there: without it these tests are ignored and say so.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // No trigger for data that come later: Cargo would rebuild everything each time while they are missing.
    println!("cargo::rerun-if-env-changed=SPLATLINE_LOOK_AGAIN");
    for (name, is_there) in [
        ("has_data", Path::new("../../../shared/data").is_dir()),
        ("has_avx512", is_native() && has_avx512()),
    ] {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if is_there {
            println!("cargo::rustc-cfg={name}");
        }
    }
}

/// Whether the tests run on the processor that builds them.
fn is_native() -> bool {
    std::env::var("HOST") == std::env::var("TARGET")
}

/// Whether this processor has what the fused and narrow cells are made of. Tests that compare their instructions with the portable model would
/// compare the model with itself where it has not.
fn has_avx512() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512cd")
        && is_x86_feature_detected!("avx512ifma");
    #[cfg(not(target_arch = "x86_64"))]
    false
}
