//! Tables for people: columns aligned, numbers to the right.

use std::fmt::Write;

/// A column: its title, and its cell of a row.
pub(crate) type Column<'a, R> = (&'a str, &'a dyn Fn(&R) -> String);

/// A table in the making.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new<const N: usize>(titles: [&str; N]) -> Self {
        Self { rows: vec![titles.map(str::to_owned).to_vec()] }
    }

    /// A table with a row each of `rows`: titles, and what stands below them.
    pub(crate) fn of<R>(rows: impl IntoIterator<Item = R>, columns: &[Column<'_, R>]) -> String {
        let titles = columns.iter().map(|(title, _)| (*title).to_owned()).collect();
        let cells = |row: R| columns.iter().map(|(_, cell)| cell(&row)).collect();
        Self::of_rows(titles, rows.into_iter().map(cells)).to_text()
    }

    /// A table of titles and rows.
    pub(crate) fn of_rows(titles: Vec<String>, rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        Self { rows: std::iter::once(titles).chain(rows).collect() }
    }

    pub(crate) fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.to_vec());
    }

    /// The table as lines: the first column to the left, all others to the right.
    pub(crate) fn to_text(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut out = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                // Writing to a string cannot fail.
                let _ = match column {
                    0 => write!(line, "{cell:<width$}"),
                    _ => write!(line, "  {cell:>width$}"),
                };
            }
            out.push_str(line.trim_end());
            out.push('\n');
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(["joint", "mean", "max"]);
        table.row(["neck".into(), "9.5".into(), "12.0".into()]);
        table.row(["right hand é".into(), "112.5".into(), String::new()]);
        let expected = "joint          mean   max\nneck            9.5  12.0\nright hand é  112.5\n";
        assert_eq!(table.to_text(), expected);
    }
}
