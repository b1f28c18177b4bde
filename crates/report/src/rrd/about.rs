//! What a page says beside pictures and curves, as Markdown.

use std::fmt::Write;

use crate::{Page, Table};

/// Settings, commands, notes and tables.
pub(super) fn markdown(page: &Page) -> String {
    let mut out = format!("# {}\n\n", plain(&page.title));
    for note in &page.notes {
        let _ = writeln!(out, "{}\n", plain(note));
    }
    for command in &page.commands {
        let _ = writeln!(out, "**{}**: `{}`\n", plain(&command.title), command.line.replace('`', "'"));
    }
    let settings = page.settings.iter().map(|line| line.clone().to_vec());
    rows(&mut out, &["setting".to_owned(), "value".to_owned()], settings);
    for Table { title, note, columns, rows: of_table, .. } in &page.tables {
        let _ = writeln!(out, "## {}\n\n{}\n", plain(title), plain(note));
        rows(
            &mut out,
            columns,
            of_table.iter().map(|row| row.iter().map(|cell| cell.text.clone()).collect()),
        );
    }
    out
}

fn rows(out: &mut String, columns: &[String], rows: impl Iterator<Item = Vec<String>>) {
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| plain(cell)).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    out.push_str(&line(columns));
    out.push_str(&format!("|{}\n", "---|".repeat(columns.len())));
    rows.for_each(|row| out.push_str(&line(&row)));
    out.push('\n');
}

/// A text in which nothing is Markdown.
fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\n' | '\r' => out.push(' '),
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '!' => out.extend(['\\', letter]),
            _ => out.push(letter),
        }
    }
    out
}
