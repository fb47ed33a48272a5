//! Are the printed pages still true? A page is printed again and compared with the one in the tree.
//!
//! Counts, errors, cycles and bits must be the same to the last digit. Timings differ from run to run and from machine to machine: the columns
//! that hold them (`TIMINGS`) are left out of the comparison, and pages that hold nothing else are not compared at all.

/// Headings of columns that hold timings: their last word.
const TIMINGS: [&str; 3] = ["ms", "host", "s"];

/// Where two versions of a page differ outside of timings: line, what stands there, what it should be. Nothing if they agree.
pub fn differences(committed: &str, printed: &str) -> Vec<String> {
    let (old, new) = (compared(committed), compared(printed));
    let longest = old.len().max(new.len());
    (0..longest)
        .filter_map(|at| {
            let [old, new] = [&old, &new].map(|lines| lines.get(at).map_or("", String::as_str));
            (old != new).then(|| format!("line {}: '{old}', printed now: '{new}'", at + 1))
        })
        .collect()
}

/// The lines of a page without its timings and without the padding of its tables.
fn compared(page: &str) -> Vec<String> {
    let mut timings: Vec<bool> = Vec::new();
    page.lines()
        .map(|line| {
            let Some(cells) = cells(line) else {
                timings.clear();
                return line.trim_end().to_owned();
            };
            if timings.is_empty() {
                timings = cells.iter().map(|heading| is_timing(heading)).collect();
            }
            let kept = cells
                .iter()
                .zip(timings.iter().chain(std::iter::repeat(&false)))
                .filter(|(_, timing)| !**timing)
                .map(|(cell, _)| if is_rule(cell) { "-" } else { cell });
            kept.collect::<Vec<_>>().join(" | ")
        })
        .collect()
}

/// The cells of a table's row.
fn cells(line: &str) -> Option<Vec<&str>> {
    let inner = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

fn is_timing(heading: &str) -> bool {
    let last = heading.rsplit(' ').next().unwrap_or_default();
    TIMINGS.contains(&last)
}

/// A cell of the line below the headings, whose dashes follow the width of the column.
fn is_rule(cell: &str) -> bool {
    !cell.is_empty() && cell.chars().all(|c| c == '-' || c == ':')
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# A page\n\n| design | PSNR dB | raster ms |\n|---|---:|--:|\n| lean18 | 96.38 | 46.7 |\n\nDone.\n";

    #[test]
    fn timings_and_padding_may_differ() {
        let again = PAGE
            .replace("46.7", "1046.7")
            .replace("| lean18 |", "| lean18   |")
            .replace("|---:|", "|-----:|");
        assert_eq!(differences(PAGE, &again), Vec::<String>::new());
    }

    #[test]
    fn nothing_else_may() {
        let wrong = PAGE.replace("96.38", "96.39");
        assert_eq!(
            differences(PAGE, &wrong),
            ["line 5: 'lean18 | 96.38', printed now: 'lean18 | 96.39'"]
        );
        assert_eq!(differences(PAGE, &PAGE.replace("Done", "Over")).len(), 1);
        assert_eq!(differences(PAGE, &format!("{PAGE}more\n")).len(), 1);
        assert_eq!(differences(PAGE, "").len(), 5); // Two of seven lines are empty.
    }
}
