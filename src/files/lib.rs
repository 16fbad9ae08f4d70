//! Files that a user names. They are read with checks and limits ([`read`], [`open_table`], [`open_file`]), written
//! atomically ([`write_atomically`]; [`write_private`] for keys), and quoted in messages at a bounded length
//! ([`quoted`]), addresses without the passwords in them ([`public_address`]).
//!
//! Bad input is an `io::Error` that says what is wrong and what to do; the caller adds the name of the file.

mod address;
mod input;
mod output;
mod quote;
mod settings;

pub use address::public_address;
pub use input::{CONFIG_MAX, Input, MODEL_MAX, TABLE_MAX, open_file, open_table, read, read_text};
pub use output::{check_output, copy_atomically, write_atomically, write_private};
pub use quote::{PASSAGE, QUOTE, csv_cell, quoted, shortened};
pub use settings::{Misfit, from_table, from_toml};
