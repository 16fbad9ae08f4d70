//! The three rings of the workspace: the product depends neither on the laboratory nor on an extra, and an extra
//! depends on another one only if it says so.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use toml::{Table, Value};

/// Ring of a crate, by its folder.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Ring {
    Product,
    Lab,
    /// Ring 3, by the name of its folder.
    Extra(String),
    /// The program and the tests across crates, which combine the rings.
    Around,
}

impl Ring {
    fn of(folder: &str) -> Self {
        match folder.split('/').collect::<Vec<_>>()[..] {
            ["src", "lab", _] => Self::Lab,
            ["src", "extras", name] => Self::Extra(name.to_owned()),
            ["src", ..] | ["ui", _] => Self::Product,
            _ => Self::Around,
        }
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

fn manifest(folder: &Path) -> Table {
    std::fs::read_to_string(folder.join("Cargo.toml")).unwrap().parse().unwrap()
}

/// Kinds of dependencies, in a manifest.
const ALL: [&str; 3] = ["dependencies", "build-dependencies", "dev-dependencies"];
const WITHOUT_TESTS: [&str; 1] = ["dependencies"];

/// Returns the dependencies of these kinds in a manifest, including those for single systems.
fn named(manifest: &Table, kinds: &[&str]) -> Vec<String> {
    let mut all = Vec::new();
    for (key, value) in manifest {
        let Value::Table(value) = value else { continue };
        if kinds.contains(&key.as_str()) {
            all.extend(value.keys().cloned());
        } else if key == "target" {
            all.extend(value.values().filter_map(Value::as_table).flat_map(|system| named(system, kinds)));
        }
    }
    all
}

/// Returns why this crate must not depend on that one; `readme` belongs to an extra.
fn fault(from: &Ring, to: &Ring, readme: &str) -> Option<String> {
    match (from, to) {
        (Ring::Product, Ring::Lab | Ring::Extra(_) | Ring::Around) => Some("the product names another ring".to_owned()),
        (Ring::Extra(_), Ring::Lab | Ring::Around) => Some("an extra depends only on the product".to_owned()),
        (Ring::Extra(_), Ring::Extra(other)) => {
            let says = |line: &str| line.starts_with("| other extras |") && line.contains(&format!("`{other}`: "));
            (!readme.lines().any(says)).then(|| format!("its README does not say why it uses the extra `{other}`"))
        }
        _ => None,
    }
}

/// Returns every crate of the workspace by its name: folder and manifest.
fn crates() -> BTreeMap<String, (String, Table)> {
    let workspace = manifest(&root());
    let members = workspace["workspace"]["members"].as_array().unwrap();
    let of = |folder: &Value| {
        let folder = folder.as_str().unwrap().to_owned();
        let manifest = manifest(&root().join(&folder));
        (manifest["package"]["name"].as_str().unwrap().to_owned(), (folder, manifest))
    };
    members.iter().map(of).collect()
}

#[test]
fn no_crate_names_one_of_a_ring_that_it_must_not_know() {
    let crates = crates();
    let mut faults = Vec::new();
    let mut edges = 0;
    for (name, (folder, manifest)) in &crates {
        let ring = Ring::of(folder);
        let readme = std::fs::read_to_string(root().join(folder).join("README.md")).unwrap_or_default();
        if ring == Ring::Extra(folder.rsplit('/').next().unwrap_or_default().to_owned()) && readme.is_empty() {
            faults.push(format!("{folder} has no README.md"));
        }
        // Tests of the screen use emulated devices.
        let kinds = if folder.starts_with("ui/") { &WITHOUT_TESTS[..] } else { &ALL };
        let depends_on = named(manifest, kinds);
        for (other, (to, _)) in depends_on.iter().filter_map(|other| crates.get_key_value(other)) {
            edges += 1;
            faults.extend(fault(&ring, &Ring::of(to), &readme).map(|why| format!("{name} names {other}: {why}")));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(edges > 80, "{edges} edges among {} crates", crates.len());
}

#[test]
fn what_it_must_not_know_is_found() {
    let [score, network] = ["score", "network"].map(|name| Ring::Extra(name.to_owned()));
    let readme = "| other extras | `score`: practice goes by it |";
    for (from, to, is_wrong) in [
        (&Ring::Product, &Ring::Product, false),
        (&Ring::Product, &Ring::Lab, true),
        (&Ring::Product, &network, true),
        (&Ring::Lab, &Ring::Product, false),
        (&network, &Ring::Product, false),
        (&network, &Ring::Lab, true),
        (&network, &score, false),
        (&score, &network, true),
    ] {
        assert_eq!(fault(from, to, readme).is_some(), is_wrong, "{from:?} to {to:?}");
    }
    let table: Table =
        "[dependencies]\na.workspace = true\n[target.'cfg(unix)'.dev-dependencies]\nb = '1'".parse().unwrap();
    assert_eq!(named(&table, &ALL), ["a", "b"]);
    assert_eq!(
        [Ring::of("src/lab/study"), Ring::of("ui/panels"), Ring::of("ui")],
        [Ring::Lab, Ring::Product, Ring::Around]
    );
    assert_eq!(Ring::of("src/extras/score"), score);
}

#[test]
fn the_tests_for_daily_work_have_every_crate_of_the_product_in_src() {
    let lanes = std::fs::read_to_string(root().join("tests/lanes.sh")).unwrap();
    let listed = lanes.lines().find_map(|line| line.strip_prefix("ring1=(")?.strip_suffix(')')).unwrap();
    let mut listed: Vec<&str> = listed.split(' ').collect();
    listed.sort_unstable();
    let crates = crates();
    let is_of_product = |folder: &str| folder.starts_with("src/") && Ring::of(folder) == Ring::Product;
    let wanted: Vec<&str> =
        crates.iter().filter(|(_, (folder, _))| is_of_product(folder)).map(|(name, _)| &**name).collect();
    assert_eq!(listed, wanted);
}

/// Crates whose code runs in a tick of the loop, or in a real-time thread of a device.
const REAL_TIME: [&str; 4] = ["src/devices", "src/machine", "src/simulation", "src/extras/network"];

#[test]
fn no_crate_of_the_loop_has_a_queue_on_which_a_thread_spins_for_another() {
    for (name, (folder, manifest)) in crates() {
        if REAL_TIME.contains(&folder.as_str()) {
            assert!(!named(&manifest, &ALL).iter().any(|one| one == "crossbeam-channel"), "{name}: use `hand_over`");
        }
    }
}
