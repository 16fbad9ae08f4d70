//! The numbers of *Results in brief* against their tables. A marker in a comment follows each number:
//! `0.34 <!-- = FILE / CAPTION / ROW / COLUMN -->` is the first number in this cell of the first table below the line of
//! `docs/results/FILE` that contains CAPTION, rounded to the digits that are quoted. `ROW#3` is the third row with such a cell.

use std::path::Path;

/// A quoted number and its marker.
struct Quoted<'a> {
    number: &'a str,
    marker: &'a str,
}

fn read(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name)).unwrap()
}

fn quoted(page: &str) -> Vec<Quoted<'_>> {
    let pieces: Vec<&str> = page.split("<!-- = ").collect();
    let numbers = pieces.iter().map(|piece| piece.split_whitespace().last().unwrap_or_default());
    numbers
        .zip(&pieces[1..])
        .map(|(number, rest)| Quoted { number, marker: rest.split(" -->").next().unwrap() })
        .collect()
}

fn cells(line: &str) -> Vec<&str> {
    line.trim().trim_matches('|').split('|').map(str::trim).collect()
}

/// Returns the cell that the marker names.
fn cell<'a>(table: &'a str, caption: &str, row: &str, column: &str) -> Option<&'a str> {
    let below = table.lines().skip_while(|line| line.starts_with('|') || !line.contains(caption)).skip(1);
    let mut lines = below.skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    let at = cells(lines.next()?).iter().position(|head| *head == column)?;
    let (row, nth) = row.split_once('#').map_or((row, 1), |(row, nth)| (row, nth.parse().unwrap()));
    let found = lines.map(cells).filter(|cells| cells.contains(&row)).nth(nth - 1)?;
    found.get(at).copied()
}

/// Returns the first number in the cell, with the digits of the quoted number.
fn rounded(cell: &str, number: &str) -> Option<String> {
    let digits = number.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let first = cell.split_whitespace().find_map(|word| word.trim_matches([',', ';']).parse::<f64>().ok())?;
    Some(format!("{first:.digits$}"))
}

/// Describes the difference between the quoted number and its cell; `None` if they agree.
fn wrong(quoted: &Quoted<'_>, table: impl Fn(&str) -> String) -> Option<String> {
    let Quoted { number, marker } = quoted;
    let parts: Vec<&str> = marker.split(" / ").collect();
    let [file, caption, row, column] = parts[..] else {
        return Some(format!("{number}: the marker does not name file, caption, row and column: {marker}"));
    };
    let table = table(file);
    match cell(&table, caption, row, column).and_then(|cell| rounded(cell, number)) {
        Some(measured) if measured == *number => None,
        Some(measured) => Some(format!("{number} is {measured} in {marker}")),
        None => Some(format!("{number}: no such cell: {marker}")),
    }
}

#[test]
fn every_number_in_brief_is_that_of_its_table() {
    let page = read("results.md");
    let quoted = quoted(&page);
    assert!(quoted.len() > 30, "only {} numbers", quoted.len());
    let wrong: Vec<String> =
        quoted.iter().filter_map(|quoted| wrong(quoted, |file| read(&format!("results/{file}")))).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_number_that_is_not_in_the_table_is_found() {
    let table = "The *best* mode:\n\n| mode | 10 ms | 100 ms |\n|---|---|---|\n| best | 0.519 [0.3, 0.7] | -11.0 / 0.5 |\n| best | 2 | 3 |\n";
    let judge = |page: &str| quoted(page).iter().filter_map(|quoted| wrong(quoted, |_| table.to_owned())).count();
    assert_eq!(
        judge("0.52 <!-- = a.md / The *best* / best / 10 ms --> and -11 <!-- = a.md / The / best / 100 ms -->"),
        0
    );
    assert_eq!(judge("3 <!-- = a.md / The *best* / best#2 / 100 ms -->"), 0);
    for page in [
        "0.51 <!-- = a.md / The *best* / best / 10 ms -->",
        "0.52 <!-- = a.md / Another / best / 10 ms -->",
        "0.52 <!-- = a.md / The *best* / worst / 10 ms -->",
        "0.52 <!-- = a.md / The *best* / best / 50 ms -->",
        "0.52 <!-- = a.md -->",
    ] {
        assert_eq!(judge(page), 1, "{page}");
    }
}
