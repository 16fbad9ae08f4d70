//! Checks the texts of rig and scene files. They are displayed unmodified on the screen and in messages, so they must
//! be short and printable.

use nima_files::quoted;
use toml::de::{DeTable, DeValue};

/// Maximum length of a text, characters: names, addresses, ports, paths. Design choice. The text may come from a file
/// of another program, so it must not fill a page or the memory.
const MAX: usize = 512;

/// Returns key and fault of the first text that cannot be displayed.
pub(crate) fn fault(table: &DeTable<'_>) -> Option<String> {
    table.iter().find_map(|(key, value)| {
        of_value(value.get_ref()).map(|(place, fault)| format!("{}{place} {fault}", quoted(key.get_ref())))
    })
}

/// Returns the key below this value and the fault of its text.
fn of_value(value: &DeValue<'_>) -> Option<(String, String)> {
    match value {
        DeValue::String(text) => of_text(text).map(|fault| (String::new(), fault)),
        DeValue::Array(values) => values
            .iter()
            .enumerate()
            .find_map(|(k, value)| of_value(value.get_ref()).map(|(place, fault)| (format!("[{k}]{place}"), fault))),
        DeValue::Table(table) => table.iter().find_map(|(key, value)| {
            of_value(value.get_ref()).map(|(place, fault)| (format!(".{}{place}", quoted(key.get_ref())), fault))
        }),
        _ => None,
    }
}

fn of_text(text: &str) -> Option<String> {
    if text.chars().any(char::is_control) {
        return Some(format!("= \"{}\" contains a control character; use printable characters", quoted(text)));
    }
    let long = text.chars().nth(MAX).is_some();
    long.then(|| format!("= \"{}\" is too long; use at most {MAX} characters", quoted(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_cannot_be_shown_is_told_by_its_key() {
        let fault = |text: &str| fault(DeTable::parse(text).unwrap().get_ref());
        assert_eq!(fault("name = \"x\"\nn = 1\n[a]\nports = [\"/dev/ttyUSB0\"]\n"), None);
        let coloured = fault("[a]\nports = [\"x\", \"\\u001b[31m\"]\n").unwrap();
        assert!(coloured.starts_with("a.ports[1] = \"\\u{1b}[31m\" contains a control character"), "{coloured}");
        let long = fault(&format!("name = \"{}\"\n", "x".repeat(1 << 20))).unwrap();
        assert!(long.starts_with("name = \"xxx") && long.contains("at most 512") && long.len() < 300, "{long}");
    }
}
