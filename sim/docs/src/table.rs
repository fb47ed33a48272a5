//! A table that a page shows in Markdown and keeps beside itself as CSV.

use std::iter::once;

/// Headings and rows of text; the first column names what a row is of.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Without rows; headings stand in a line with ` | ` between them, as they are printed.
    pub fn new(headings: &str) -> Table {
        Table {
            headings: headings.split(" | ").map(str::to_owned).collect(),
            rows: Vec::new(),
        }
    }

    pub fn push(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Adds a row of words and of cells behind them.
    pub fn push_behind(&mut self, words: &[&str], cells: impl IntoIterator<Item = String>) {
        let words = words.iter().map(|word| (*word).to_owned());
        self.push(words.chain(cells));
    }

    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The rows whose cell in a column is this, without that column.
    pub fn only(&self, column: usize, is: &str) -> Table {
        let without = |cells: &[String]| {
            let cells = cells
                .iter()
                .enumerate()
                .filter(|(number, _)| *number != column);
            cells.map(|(_, cell)| cell.clone()).collect()
        };
        let rows = self.rows.iter().filter(|row| row[column] == is);
        Table {
            headings: without(&self.headings),
            rows: rows.map(|row| without(row)).collect(),
        }
    }

    /// Markdown: the first column is text, all others are aligned as numbers.
    pub fn markdown(&self) -> String {
        let rule = format!("|---|{}", "--:|".repeat(self.headings.len() - 1));
        let line = |row: &Vec<String>| format!("| {} |\n", row.join(" | "));
        let rows: String = self.rows.iter().map(line).collect();
        format!("{}{rule}\n{rows}", line(&self.headings))
    }

    /// Comma-separated values; cells with commas are quoted.
    pub fn csv(&self) -> String {
        let cell = |cell: &String| {
            if cell.contains(',') {
                format!("\"{cell}\"")
            } else {
                cell.clone()
            }
        };
        let line = |row: &Vec<String>| row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
        once(&self.headings).chain(&self.rows).map(line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_laid_out_both_ways_and_some_of_its_rows_alone() {
        let mut table = Table::new("machine | scene | cycles");
        table.push(["4 lanes, rows", "guitar", "7"].map(str::to_owned));
        table.push(["1 lane", "lion", "9"].map(str::to_owned));
        assert_eq!(
            table.csv(),
            "machine,scene,cycles\n\"4 lanes, rows\",guitar,7\n1 lane,lion,9\n"
        );
        let lion = table.only(1, "lion");
        assert_eq!(
            lion.markdown(),
            "| machine | cycles |\n|---|--:|\n| 1 lane | 9 |\n"
        );
    }
}
