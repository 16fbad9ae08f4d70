//! Quoting text of other origin inside our messages.

use std::fmt::Write as _;

/// Maximum number of characters of a file, a name or a device's answer that a message repeats.
pub const QUOTE: usize = 80;
/// Maximum number of characters of longer text, such as a list of columns or a parser's message.
pub const PASSAGE: usize = 300;

/// Returns a text in the form in which a message may repeat it: at most [`QUOTE`] characters, control characters
/// escaped.
pub fn quoted(text: &str) -> String {
    shortened(text, QUOTE)
}

/// Returns the same with another limit. The rest is replaced by `...` and the size of the whole text.
pub fn shortened(text: &str, max: usize) -> String {
    let mut short = String::new();
    // Reads at most `max` characters: the text may be a whole file.
    for character in text.chars().take(max) {
        match character {
            '"' | '\'' | '\\' => short.push(character),
            // Escapes what a terminal would interpret (colours, line breaks, changes of direction).
            _ => short.extend(character.escape_debug()),
        }
    }
    if text.chars().nth(max).is_some() {
        // Writing into a String cannot fail.
        write!(short, "... ({} bytes)", text.len()).ok();
    }
    short
}

/// Returns a CSV cell, quoted if necessary. A text that a spreadsheet would execute as a formula begins with an
/// apostrophe.
pub fn csv_cell(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        return csv_cell(&format!("'{text}"));
    }
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_quoted_and_never_a_formula() {
        assert_eq!(["a", "a,b", "a\"b"].map(csv_cell), ["a", "\"a,b\"", "\"a\"\"b\""]);
        assert_eq!(["=1+1", "@x", "-2", "+3", "=A,B"].map(csv_cell), ["'=1+1", "'@x", "'-2", "'+3", "\"'=A,B\""]);
    }

    #[test]
    fn what_fits_is_left_as_it_is_and_what_does_not_is_cut() {
        assert_eq!(quoted("fx_n \"Kraft\" größer 力 \\"), "fx_n \"Kraft\" größer 力 \\");
        assert_eq!(quoted("a\nb\u{1b}[31m\0\u{202e}"), "a\\nb\\u{1b}[31m\\0\\u{202e}");
        assert_eq!(quoted(&"x".repeat(QUOTE)), "x".repeat(QUOTE));
        assert_eq!(quoted(&"x".repeat(15_000_000)), format!("{}... (15000000 bytes)", "x".repeat(QUOTE)));
    }
}
