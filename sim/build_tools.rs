// For the build scripts of this folder's crates: is a tool there, and if it is not, look again as soon as it may have
// come.
//
// Cargo runs a build script again only when what it named has changed. A script that found no Verilator and named
// nothing kept its answer for ever; so what is named is the tool itself where there is one, and else all folders that
// it could be installed into.

/// Whether a program of this name is on the path (or is a path itself).
#[allow(dead_code)]
pub fn has_tool(name: &str) -> bool {
    println!("cargo::rerun-if-env-changed=PATH");
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<std::path::PathBuf> = std::env::split_paths(&path).collect();
    // Joining an absolute path gives that path.
    let found = folders
        .iter()
        .map(|folder| folder.join(name))
        .find(|file| file.is_file());
    match &found {
        Some(file) => println!("cargo::rerun-if-changed={}", file.display()),
        None => {
            for folder in folders.iter().filter(|folder| folder.is_dir()) {
                println!("cargo::rerun-if-changed={}", folder.display());
            }
        }
    }
    found.is_some()
}

/// `cfg(name)` if `holds`; tests without what they need are ignored by it.
#[allow(dead_code)]
pub fn cfg(name: &str, holds: bool) {
    println!("cargo::rustc-check-cfg=cfg({name})");
    if holds {
        println!("cargo::rustc-cfg={name}");
    }
}
