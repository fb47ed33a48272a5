//! The committed header is what cbindgen makes of the sources.
//!
//! After a change of the interface: `SPLATLINE_WRITE_HEADER=1 cargo test -p splatline-capi --test header`.

use std::path::Path;

fn generated() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    let files = [
        "status", "versions", "types", "design", "setup", "packet", "spans", "draw", "front",
    ];
    let builder = files.iter().fold(
        cbindgen::Builder::new().with_config(config),
        |builder, file| builder.with_src(root.join(format!("src/{file}.rs"))),
    );
    let mut header = Vec::new();
    builder.generate().unwrap().write(&mut header);
    // Rustdoc's heading of a contract means nothing to a reader of C.
    String::from_utf8(header)
        .unwrap()
        .replace("// # Safety\n", "// Memory:\n")
}

#[test]
fn the_committed_header_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/splatline.h");
    let generated = generated();
    if std::env::var_os("SPLATLINE_WRITE_HEADER").is_some() {
        std::fs::write(&path, &generated).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == generated,
        "include/splatline.h is not what cbindgen makes of src/: run \
         SPLATLINE_WRITE_HEADER=1 cargo test -p splatline-capi --test header and commit the result"
    );
}
