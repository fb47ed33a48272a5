//! Documents that state facts of the code are held against it.

use splatline_sim::design::DesignChoice;
use splatline_sim::machine::config::FIELDS;
use std::path::{Path, PathBuf};

/// The table of widths in docs/number-formats.md is that of the named designs.
#[test]
fn number_formats_list_the_designs_widths() {
    let text = include_str!("../../../docs/number-formats.md");
    for design in DesignChoice::all() {
        let numbers: Vec<String> = design.widths.numbers().iter().map(u8::to_string).collect();
        let rounding = design.resolved().rounding;
        let row = format!(
            "| `{}` | {} | {rounding} |",
            design.name,
            numbers.join(" | ")
        );
        assert!(
            text.contains(&row),
            "docs/number-formats.md lacks the row\n{row}"
        );
    }
}

/// Every key of a machine and every width of a design stands in docs/files.md.
#[test]
fn the_page_of_files_lists_every_key() {
    let text = include_str!("../../../docs/files.md");
    for field in FIELDS {
        let row = text
            .lines()
            .find(|line| line.starts_with(&format!("| `[{}]` |", field.section)));
        let row =
            row.unwrap_or_else(|| panic!("docs/files.md lacks the section {}", field.section));
        assert!(
            row.contains(&format!("`{}`", field.key)),
            "docs/files.md lacks {}",
            field.path()
        );
    }
    for (width, ..) in splatline::format::WIDTH_RANGES {
        assert!(
            text.contains(&format!("`{width}`")),
            "docs/files.md lacks {width}"
        );
    }
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All pages: the README and what lies below docs.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![root().join("README.md")];
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                pages.push(path);
            }
        }
    }
    pages
}

/// Links between pages lead somewhere, and so do paths in code marks: a moved file takes its mentions with it.
#[test]
fn links_and_paths_in_documents_exist() {
    let mut missing = Vec::new();
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        let beside = page.parent().unwrap();
        let links = text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next());
        for link in links.filter(|link| !link.contains("://") && !link.starts_with('#')) {
            let file = link.split('#').next().unwrap();
            if !beside.join(file).exists() {
                missing.push(format!("{}: link to {link}", page.display()));
            }
        }
        for code in text.split('`').skip(1).step_by(2) {
            let ours = ["src/", "sim/", "docs/", "tests/", ".ci/"];
            let plain = !code.contains(|c: char| c.is_whitespace() || "*{}<>:=,".contains(c));
            let rust = ["", ".rs"]
                .iter()
                .any(|end| root().join(format!("{code}{end}")).exists());
            if plain && ours.iter().any(|start| code.starts_with(start)) && !rust {
                missing.push(format!("{}: `{code}`", page.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}
