//! Converts tables and sentences of a report from Markdown to HTML; supports only the Markdown that those reports use.

use std::fmt::Write as _;

use crate::report::html::{escape, table};

/// Blocks between empty lines: a table, or sentences.
pub(super) fn html(text: &str) -> String {
    let mut out = String::new();
    for block in text.split("\n\n").map(str::trim).filter(|block| !block.is_empty()) {
        let lines: Vec<&str> = block.lines().collect();
        match lines.as_slice() {
            [head, line, rows @ ..] if head.starts_with('|') && line.starts_with("|-") => {
                let head: Vec<&str> = cells(head).collect();
                let rows: Vec<Vec<String>> = rows.iter().map(|row| cells(row).map(escape).collect()).collect();
                out.push_str(&table(
                    &head
                        .iter()
                        .map(|cell| escape(cell))
                        .collect::<Vec<_>>()
                        .iter()
                        .map(String::as_str)
                        .collect::<Vec<_>>(),
                    &rows,
                ));
            }
            // Writing to a String cannot fail.
            _ => drop(writeln!(out, "<p>{}</p>", escape(block))),
        }
    }
    out
}

fn cells(row: &str) -> impl Iterator<Item = &str> {
    row.trim().trim_matches('|').split('|').map(str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_and_sentences_become_markup_and_text_stays_text() {
        let page = html("\n| a | b |\n|---|---|\n| 1 | < 0.001 |\n\nOne & two\n");
        assert!(page.contains("<th>a</th><th>b</th>") && page.contains("<td>1</td><td>&lt; 0.001</td>"), "{page}");
        assert!(page.contains("<p>One &amp; two</p>"), "{page}");
    }
}
