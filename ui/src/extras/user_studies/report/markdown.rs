//! Converts tables and sentences of a report from Markdown to HTML; supports only the Markdown that those reports use.

use maud::{Markup, html};
use nima_report::html::table;

/// Renders the blocks between empty lines: a table, or sentences.
pub(super) fn markup(text: &str) -> Markup {
    html! {
        @for block in text.split("\n\n").map(str::trim).filter(|block| !block.is_empty()) {
            @let lines: Vec<&str> = block.lines().collect();
            @match lines.as_slice() {
                [head, line, rows @ ..] if head.starts_with('|') && line.starts_with("|-") => {
                    @let head: Vec<&str> = cells(head).collect();
                    @let rows: Vec<Vec<&str>> = rows.iter().map(|row| cells(row).collect()).collect();
                    (table(&head, &rows))
                }
                _ => { p { (block) } }
            }
        }
    }
}

fn cells(row: &str) -> impl Iterator<Item = &str> {
    row.trim().trim_matches('|').split('|').map(str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_and_sentences_become_markup_and_text_stays_text() {
        let page = markup("\n| a | b |\n|---|---|\n| 1 | < 0.001 |\n\nOne & two\n").into_string();
        assert!(page.contains("<th>a</th><th>b</th>") && page.contains("<td>1</td><td>&lt; 0.001</td>"), "{page}");
        assert!(page.contains("<p>One &amp; two</p>"), "{page}");
    }
}
