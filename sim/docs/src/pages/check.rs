//! Are the printed pages still true? A page is printed again and compared with the files in the tree, to the last
//! digit.

use super::Page;
use std::path::Path;

/// Differences that are named of each file.
const NAMED: usize = 5;

/// Where the committed files of a page differ from what is printed now.
pub fn differences(page: &Page, folder: &Path) -> Vec<String> {
    let of_file = |(name, printed): &(String, String)| {
        let committed = std::fs::read_to_string(folder.join(name)).unwrap_or_default();
        lines(&committed, printed)
            .into_iter()
            .map(|line| format!("{name}, {line}"))
            .collect::<Vec<_>>()
    };
    page.files.iter().flat_map(of_file).collect()
}

fn lines(committed: &str, printed: &str) -> Vec<String> {
    let [old, new] = [committed, printed].map(|text| text.lines().collect::<Vec<_>>());
    (0..old.len().max(new.len()))
        .filter(|at| old.get(*at) != new.get(*at))
        .map(|at| {
            let [old, new] = [&old, &new].map(|lines| lines.get(at).copied().unwrap_or_default());
            format!("line {}: '{old}', printed now: '{new}'", at + 1)
        })
        .take(NAMED)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_digit_and_every_missing_line_is_a_difference() {
        assert!(lines("a\n| 96.38 |\n", "a\n| 96.38 |\n").is_empty());
        assert_eq!(
            lines("a\n| 96.38 |\n", "a\n| 96.39 |\n"),
            ["line 2: '| 96.38 |', printed now: '| 96.39 |'"]
        );
        assert_eq!(lines("a\n", "a\nmore\n").len(), 1);
        assert_eq!(lines("", &"a\n".repeat(9)).len(), NAMED);
    }
}
