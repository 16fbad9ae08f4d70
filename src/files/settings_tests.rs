use std::collections::BTreeMap;

use serde::Deserialize;

use super::*;

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Everything {
    name: String,
    rate_hz: f64,
    seed: u64,
    count: Option<i32>,
    place_m: [f64; 3],
    kind: Kind,
    #[serde(default)]
    kinds: Vec<Kind>,
    #[serde(default)]
    named: BTreeMap<String, Inner>,
    newtype: Metres,
    by: Tagged,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Plain,
    Wrapped(f64),
    Struct { a: bool, b: char },
    Two(u8, u8),
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
enum Tagged {
    Hand { n: f64 },
    Nothing,
}

#[derive(Debug, PartialEq, Deserialize)]
struct Metres(f64);

#[derive(Debug, PartialEq, Deserialize)]
struct Inner {
    x: i8,
    pair: Option<[i8; 2]>,
}

const WHOLE: &str = r#"
name = "right \"hand\""
rate_hz = 1000
seed = 0xffff_ffff_ffff_ffff
count = -3
place_m = [0.1, 2, -3e-2]
kind = "plain"
kinds = ["plain", { wrapped = 2 }, { struct = { a = true, b = "z" } }, { two = [1, 2] }]
newtype = 0.5
by = { what = "hand", n = 3 }
[named.a]
x = 1
[named."b.c"]
x = -1
"#;

#[test]
fn every_kind_of_value_is_read() {
    let read: Everything = from_toml(WHOLE).unwrap();
    let named = [("a", 1), ("b.c", -1)].map(|(name, x)| (name.to_owned(), Inner { x, pair: None }));
    let expected = Everything {
        name: "right \"hand\"".to_owned(),
        rate_hz: 1000.0,
        seed: u64::MAX,
        count: Some(-3),
        place_m: [0.1, 2.0, -0.03],
        kind: Kind::Plain,
        kinds: vec![Kind::Plain, Kind::Wrapped(2.0), Kind::Struct { a: true, b: 'z' }, Kind::Two(1, 2)],
        named: named.into(),
        newtype: Metres(0.5),
        by: Tagged::Hand { n: 3.0 },
    };
    assert_eq!(read, expected);
}

const MISTAKES: [(&str, &str); 13] = [
    ("rate_hz = 1000", "rate_hz = \"fast\""),
    ("rate_hz = 1000", "rate_hz = 1e999"),
    ("rate_hz = 1000\n", ""),
    ("count = -3", "count = 3000000000"),
    ("count = -3", "cuont = -3"),
    ("place_m = [0.1, 2, -3e-2]", "place_m = [0.1, 2]"),
    ("kind = \"plain\"", "kind = \"plane\""),
    ("kind = \"plain\"", "kind = { plain = 1, wrapped = 2 }"),
    ("kind = \"plain\"", "kind = \"wrapped\""),
    ("x = 1\n", "x = 1000\n"),
    ("x = 1\n", "x = 1979-05-27\n"),
    ("newtype = 0.5", "newtype = ["),
    ("what = \"hand\"", "what = \"foot\""),
];

#[test]
fn each_mistake_is_told_with_its_line() {
    let report = MISTAKES.map(|(from, to)| {
        let text = WHOLE.replace(from, to);
        let misfit = from_toml::<Everything>(&text).unwrap_err();
        format!("{}: {misfit}", misfit.line(&text))
    });
    let expected = [
        "3: invalid type: string \"fast\", expected f64",
        "3: floating-point number overflowed",
        "1: missing field `rate_hz`",
        "5: invalid value: integer `3000000000`, expected i32",
        "5: unknown field `cuont`, expected one of `name`, `rate_hz`, `seed`, `count`, `place_m`, `kind`, `kinds`, `named`, `newtype`, `by`",
        "6: invalid length 2, expected an array of length 3",
        "7: unknown variant `plane`, expected one of `plain`, `wrapped`, `struct`, `two`",
        "7: wanted exactly 1 element, more than 1 element",
        "7: invalid type: unit variant, expected newtype variant",
        "12: invalid value: integer `1000`, expected i8",
        "12: invalid type: map, expected i8",
        "10: unexpected `=` in array, expected value, `]`",
        "10: unknown variant `foot`, expected `hand` or `nothing`",
    ];
    assert_eq!(report, expected);
}

#[test]
fn an_array_that_is_too_long_is_not_cut() {
    // The library's plain values cannot hold numbers beyond `i64`.
    let small = WHOLE.replace("0xffff_ffff_ffff_ffff", "7");
    for (from, to, report) in [
        ("-3e-2]", "-3e-2, 4]", "6: invalid length 4, expected fewer elements in array"),
        (
            "[named.a]\nx = 1",
            "[named.a]\nx = 1\npair = [1, 2, 3]",
            "13: invalid length 3, expected fewer elements in array",
        ),
    ] {
        let text = small.replace(from, to);
        let misfit = from_toml::<Everything>(&text).unwrap_err();
        assert_eq!(format!("{}: {misfit}", misfit.line(&text)), report);
    }
}
