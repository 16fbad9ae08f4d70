//! The language of the window.
//!
//! All texts of the window are in [`text`](crate::text) and `report_text`, in English and German side by side: a text without one of them
//! does not compile. Each thread has its language. The window sets the language of its thread before it draws; every other
//! thread, and therefore the command line, the files and the reports, uses English unless its language is set ([`carried`]).

use std::{
    cell::{Cell, RefCell},
    collections::HashMap,
    fmt,
};

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
pub enum Language {
    /// The default.
    #[default]
    #[serde(rename = "en")]
    #[value(name = "en")]
    English,
    #[serde(rename = "de")]
    #[value(name = "de")]
    German,
    /// English with accents and 40 % longer: a layout with room for it has room for most languages.
    #[serde(rename = "pseudo")]
    #[value(name = "pseudo", hide = true)]
    Pseudo,
}

impl Language {
    /// Languages that a user can choose.
    pub const CHOICES: [Self; 2] = [Self::English, Self::German];

    /// Returns the language's own name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::German => "Deutsch",
            Self::Pseudo => "Pseudo",
        }
    }
}

thread_local! {
    static CURRENT: Cell<Language> = const { Cell::new(Language::English) };
    static LENGTHENED: RefCell<HashMap<&'static str, &'static str>> = RefCell::default();
}

pub fn current() -> Language {
    CURRENT.get()
}

pub fn set(language: Language) {
    CURRENT.set(language);
}

/// Runs `work` in a language. Files are written in English, whatever the language of the window.
pub fn with<T>(language: Language, work: impl FnOnce() -> T) -> T {
    struct Back(Language);
    impl Drop for Back {
        fn drop(&mut self) {
            set(self.0);
        }
    }
    let _back = Back(CURRENT.replace(language));
    work()
}

/// Wraps `work` for another thread, which then uses the language of this thread.
pub fn carried<T>(work: impl FnOnce() -> T) -> impl FnOnce() -> T {
    let language = current();
    move || {
        set(language);
        work()
    }
}

/// A text in every language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text {
    english: &'static str,
    german: &'static str,
}

impl Text {
    pub const fn of(english: &'static str, german: &'static str) -> Self {
        Self { english, german }
    }

    pub const fn english(self) -> &'static str {
        self.english
    }

    /// Returns the text in the language of this thread.
    pub fn get(self) -> &'static str {
        match current() {
            Language::English => self.english,
            Language::German => self.german,
            Language::Pseudo => lengthened(self.english),
        }
    }
}

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.get())
    }
}

impl From<Text> for String {
    fn from(text: Text) -> Self {
        text.get().to_owned()
    }
}

#[cfg(feature = "egui")]
impl From<Text> for egui::WidgetText {
    fn from(text: Text) -> Self {
        text.get().into()
    }
}

#[cfg(feature = "egui")]
impl From<Text> for egui::RichText {
    fn from(text: Text) -> Self {
        text.get().into()
    }
}

/// Returns a text that is used in one place, in the language of this thread.
pub fn word(english: &'static str, german: &'static str) -> &'static str {
    Text::of(english, german).get()
}

/// A text with values: `report!("{a} of {b}", "{a} von {b}")`, with further arguments as for `format!`.
#[macro_export]
macro_rules! text_format {
    ($english:literal, $german:literal $(, $($argument:tt)*)?) => {
        if $crate::language::current() == $crate::language::Language::German {
            format!($german $(, $($argument)*)?)
        } else {
            $crate::language::plain_or_pseudo(format!($english $(, $($argument)*)?))
        }
    };
}
pub use text_format;

pub fn plain_or_pseudo(english: String) -> String {
    if current() == Language::Pseudo { pseudo(&english) } else { english }
}

/// Each constant text is lengthened once per thread and stays in memory.
fn lengthened(english: &'static str) -> &'static str {
    LENGTHENED.with_borrow_mut(|known| *known.entry(english).or_insert_with(|| pseudo(english).leak()))
}

/// Adds accents and 40 % length. Text that is already lengthened stays unchanged, because a text may be part of another text.
pub fn pseudo(english: &str) -> String {
    let lines: Vec<String> = english.split('\n').map(pseudo_line).collect();
    lines.join("\n")
}

fn pseudo_line(line: &str) -> String {
    // Words with accents have already been lengthened.
    let is_plain = |word: &&str| word.chars().all(|letter| letter.is_ascii() || !letter.is_alphabetic());
    let plain = line.split_whitespace().filter(is_plain);
    let letters = plain.flat_map(str::chars).filter(char::is_ascii_alphabetic).count();
    let mut longer: String = line.chars().map(accented).collect();
    let one_word = !line.trim().contains(' ');
    // Adds words of usual length, so that lines break as in other languages.
    for (i, letter) in
        "\u{e5}\u{f1}\u{f0}\u{f8}\u{fe}\u{eb}".chars().cycle().take((2 * letters).div_ceil(5)).enumerate()
    {
        if i % 6 == 0 && !one_word {
            longer.push(' ');
        }
        longer.push(letter);
    }
    longer
}

/// Returns a letter of similar look and width.
const fn accented(letter: char) -> char {
    match letter {
        'A' => '\u{c5}',
        'C' => '\u{c7}',
        'D' => '\u{d0}',
        'E' => '\u{c9}',
        'I' => '\u{ce}',
        'N' => '\u{d1}',
        'O' => '\u{d6}',
        'U' => '\u{db}',
        'Y' => '\u{dd}',
        'a' => '\u{e5}',
        'c' => '\u{e7}',
        'd' => '\u{f0}',
        'e' => '\u{e9}',
        'i' => '\u{ee}',
        'n' => '\u{f1}',
        'o' => '\u{f6}',
        'u' => '\u{fb}',
        'y' => '\u{fd}',
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAUSE: Text = Text::of("Pause", "Anhalten");

    #[test]
    fn a_text_is_in_the_language_of_its_thread_and_another_thread_is_english() {
        assert_eq!((PAUSE.get(), word("of", "von")), ("Pause", "of"));
        let a = 1;
        let b = 2;
        let report = with(Language::German, || {
            let there = std::thread::spawn(|| PAUSE.get()).join().unwrap();
            let carried = std::thread::spawn(carried(|| PAUSE.get())).join().unwrap();
            (PAUSE.to_string(), text_format!("{a} of {}", "{a} von {}", b), there, carried)
        });
        assert_eq!(report, ("Anhalten".to_owned(), "1 von 2".to_owned(), "Pause", "Anhalten"));
        assert_eq!((current(), text_format!("{a} of {b}", "{a} von {b}")), (Language::English, "1 of 2".to_owned()));
    }

    #[test]
    fn a_panic_leaves_the_language_as_it_was() {
        let panics = std::panic::catch_unwind(|| with(Language::German, || panic!("on purpose")));
        assert!(panics.is_err());
        assert_eq!(current(), Language::English);
    }

    #[test]
    fn pseudo_is_longer_by_two_fifths_and_lengthens_nothing_twice() {
        let english = "The control loop has stopped sending data";
        let letters = |text: &str| text.chars().filter(|letter| letter.is_alphabetic()).count();
        let once = pseudo(english);
        let ratio = letters(&once) as f64 / letters(english) as f64;
        assert!((1.4..1.45).contains(&ratio), "{ratio}: {once}");
        let within = with(Language::Pseudo, || text_format!("{once}: {}", "{once}: {}", 12.5));
        assert_eq!(within, format!("{once}: 12.5"));
        assert!(with(Language::Pseudo, || std::ptr::eq(PAUSE.get(), PAUSE.get())), "it stays where it is");
        assert_eq!(pseudo("0.5 \u{2026}"), "0.5 \u{2026}");
    }
}
