//! Documents that state facts of the code are held against it.

use super::hostile::readers::FORMATS;
use super::shell::{Shell, files_below, holds};
use splatline_sim::design::DesignChoice;
use splatline_sim::explore::space::Space;
use splatline_sim::machine::config::{self, SETTINGS};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The table of widths in docs/specification.md is that of the named designs.
#[test]
fn the_specification_lists_the_designs_widths() {
    let text = include_str!("../../../docs/specification.md");
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
            "docs/specification.md lacks the row\n{row}"
        );
    }
}

/// Every key of a machine and every width of a design stands in docs/files.md.
#[test]
fn the_page_of_files_lists_every_key() {
    let text = include_str!("../../../docs/files.md");
    for section in SETTINGS.chunk_by(|a, b| a.section == b.section) {
        let keys: Vec<String> = section.iter().map(|s| format!("`{}`", s.key)).collect();
        let row = format!("| `[{}]` | {} |", section[0].section, keys.join(", "));
        assert!(text.contains(&row), "docs/files.md lacks the row\n{row}");
    }
    for (width, ..) in splatline::format::WIDTH_RANGES {
        assert!(
            text.contains(&format!("`{width}`")),
            "docs/files.md lacks {width}"
        );
    }
}

/// Words in code marks.
fn marked(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The rows of a section's table in docs/files.md, as their first column's keys and all their words, bare of brackets
/// and of the table that they lie in.
fn rows_of(section: &str) -> Vec<[BTreeSet<&'static str>; 2]> {
    let text = include_str!("../../../docs/files.md");
    let (_, rest) = text.split_once(&format!("\n## {section}")).unwrap();
    let section = rest.split("\n## ").next().unwrap();
    let bare = |word: &'static str| {
        let word = word.trim_matches(['[', ']']);
        word.rsplit('.').next().unwrap()
    };
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    rows.map(|row| {
        let first = row.split(" | ").next().unwrap();
        [first, row].map(|part| marked(part).map(bare).collect())
    })
    .collect()
}

/// What the reader of this file says of a text.
fn refusal(name: &str, text: &str) -> String {
    let shell = Shell::new();
    shell.write(name, text);
    let (_, read) = FORMATS.iter().find(|(file, _)| *file == name).expect(name);
    read(&shell.path(name)).expect_err(text)
}

/// An unknown key is answered by the keys there are, table by table; docs/files.md has them all and no others.
#[test]
fn unknown_keys_are_answered_by_those_of_the_page() {
    for (section, file, texts) in [
        ("Camera (", "camera.json", "{\"hue\": 1}"),
        (
            "Transfer",
            "transfer.toml",
            "hue = 1|[[value]]\nhue = 1|[[gradient]]\nhue = 1|[shading]\nhue = 1",
        ),
        ("Design", "design.toml", "hue = 1"),
        (
            "Energies",
            "45nm.toml",
            "hue = 1|[[adder]]\nhue = 1|[[memory]]\nhue = 1|[dram]\nhue = 1",
        ),
        ("Parts", "parts.toml", "[mine]\nhue = 1"),
        ("Camera path", "path.toml", "hue = 1|[[key]]\nhue = 1"),
    ] {
        let rows = rows_of(section);
        let all: BTreeSet<&str> = rows.iter().flat_map(|[_, words]| words.clone()).collect();
        let mut known = BTreeSet::new();
        for text in texts.split('|') {
            let printed = refusal(file, text);
            holds(&printed, &["unknown field `hue`"]);
            known.extend(
                marked(&printed)
                    .filter(|word| *word != "hue")
                    .map(str::to_owned),
            );
        }
        for key in &known {
            assert!(
                all.contains(&**key),
                "docs/files.md, {section}: lacks {key}"
            );
        }
        for key in rows.iter().flat_map(|[first, _]| first) {
            assert!(
                known.contains(*key),
                "docs/files.md, {section}: {key} is not read"
            );
        }
    }
    let space = Space::from_toml("s.toml", "hue = 1")
        .unwrap_err()
        .to_string();
    for [keys, _] in rows_of("Space") {
        assert!(keys.iter().all(|key| space.contains(key)), "{space}");
    }
    for [first, words] in rows_of("Machine") {
        let section = *first.first().unwrap();
        let printed = config::from_toml("m.toml", &format!("[{section}]\nhue = 1")).unwrap_err();
        let printed = printed.to_string();
        assert!(printed.contains(&format!("[{section}] has ")), "{printed}");
        let key = |word: &&&str| word.contains('_') || SETTINGS.iter().any(|f| f.key == **word);
        for word in words.iter().filter(key) {
            let of = |setting: &&config::Setting| setting.key == *word;
            assert!(
                SETTINGS.iter().any(|f| of(&f)),
                "docs/files.md, [{section}]: {word}"
            );
        }
    }
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All pages: the README and what lies below docs.
fn pages() -> Vec<PathBuf> {
    let mut pages = files_below(&root().join("docs"));
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md"));
    pages.push(root().join("README.md"));
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
