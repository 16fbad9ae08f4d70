//! Does nothing: cargo builds build dependencies only if there is a build script.

fn main() {}
