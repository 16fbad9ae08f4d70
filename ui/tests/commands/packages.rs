//! Files that a package installs in addition to the program: completions, manual pages, and the texts of all licences.

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::json;

use crate::every_command::nima;

fn printed(arguments: &[&str]) -> String {
    let output = nima(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Returns every command, as the help lists them.
fn commands() -> BTreeSet<String> {
    let help = printed(&["--help"]);
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let (list, _) = list.split_once("\n\n").unwrap();
    // A line that continues a description is indented further.
    let names = list.lines().filter_map(|line| line.strip_prefix("  ")).filter(|line| !line.starts_with(' '));
    let names: BTreeSet<_> = names.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    assert!(names.len() > 20, "{names:?}");
    names
}

#[cfg(target_os = "linux")]
#[test]
fn bash_completes_commands_options_and_values() {
    let script = printed(&["completions", "bash"]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("nima");
    fs::write(&file, script).unwrap();
    // Bash passes the arguments so far; the last one is incomplete.
    let completed = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let quoted: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
        let last = words.len() - 1;
        let call = format!(
            "source '{}'; COMP_WORDS=({}); COMP_CWORD={last}; _nima nima '{}' '{}'; echo \"${{COMPREPLY[*]}}\"",
            file.display(),
            quoted.join(" "),
            words[last],
            words[last - 1]
        );
        let output = Command::new("bash").args(["--norc", "-c", &call]).output().unwrap();
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        text.split_whitespace().map(str::to_owned).collect::<BTreeSet<_>>()
    };
    let these = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<BTreeSet<_>>();
    assert_eq!(completed("nima stu"), these(&["study", "study-report"]));
    assert_eq!(completed("nima run --virt"), these(&["--virtual"]));
    assert_eq!(completed("nima study stability"), these(&["stability", "stability-map"]));
    assert_eq!(completed("nima console --role t"), these(&["technician"]));
    assert!(completed("nima ").is_superset(&commands()));
}

#[test]
fn every_shell_gets_every_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = printed(&["completions", shell]);
        for command in commands() {
            assert!(script.contains(&command), "{shell}: {command}");
        }
    }
    let refused = nima(&["completions", "sh"]);
    let report = crate::one_line(&refused);
    assert!(report.contains("zsh") && report.contains("fish"), "{report}");
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("new/man1");
    printed(&["man", folder.to_str().unwrap()]);
    let page = |name: &str| fs::read_to_string(folder.join(format!("{name}.1"))).unwrap();
    for command in commands().iter().filter(|command| *command != "help") {
        let text = page(&format!("nima-{command}"));
        assert!(text.contains(".TH") && text.contains(".SH SYNOPSIS"), "{command}");
    }
    assert!(page("nima").contains("not for clinical use"));
    assert!(page("nima-run").contains(r"\-\-virtual"));
    assert!(page("nima-study-stability-map").contains(r"\-\-out"));
    assert!(!folder.join("nima-help.1").exists());
    let before = page("nima-run");
    printed(&["man", folder.to_str().unwrap()]);
    assert_eq!(page("nima-run"), before, "the same program writes the same page");
    // An obstacle is reported as an error.
    let report = crate::one_line(&nima(&["man", folder.join("nima.1").to_str().unwrap()]));
    assert!(report.contains("nima.1"), "{report}");
}

/// Files of a crate: names and texts.
#[cfg(target_os = "linux")]
type Files = &'static [(&'static str, &'static str)];

/// Returns the script that lists the content of the program, for crates in `folder`: their names, licences, and licence
/// files.
#[cfg(target_os = "linux")]
fn inventory(folder: &Path, crates: &[(&str, &str, Files)]) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut packages = vec![json!({"id": "nima-console", "name": "nima-console", "version": "1.0.0", "source": null,
        "license": "MIT", "license_file": null, "description": null, "repository": null, "manifest_path": "/none"})];
    let mut nodes = Vec::new();
    let mut tree = String::from("nima-console v1.0.0 (/none)\n");
    for (name, licence, files) in crates {
        let own = folder.join(name);
        for (file, text) in *files {
            let path = own.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        fs::create_dir_all(&own).unwrap();
        packages.push(json!({"id": name, "name": name, "version": "1.0.0", "source": "registry", "license": licence,
            "license_file": null, "description": "a crate", "repository": null, "manifest_path": own.join("Cargo.toml")}));
        nodes.push(json!({"id": name, "deps": []}));
        tree.extend([*name, " v1.0.0\n"]);
    }
    let deps: Vec<_> = crates.iter().map(|(name, ..)| json!({"pkg": name, "dep_kinds": [{"kind": null}]})).collect();
    nodes.push(json!({"id": "nima-console", "deps": deps}));
    let metadata = json!({"packages": packages, "resolve": {"nodes": nodes}});
    fs::write(folder.join("metadata.json"), metadata.to_string()).unwrap();
    fs::write(folder.join("tree.txt"), tree).unwrap();
    fs::write(folder.join("lock"), "[[package]]\nname = \"a\"\nversion = \"1.0.0\"\nchecksum = \"ab12\"\n").unwrap();
    Command::new("python3")
        .arg(root.join("assets/package/inventory.py"))
        .args(["--metadata", "metadata.json", "--tree", "tree.txt", "--lock", "lock", "--epoch", "0", "--out", "out"])
        .arg("--standard")
        .arg(root.join("LICENSE-APACHE").canonicalize().unwrap())
        .current_dir(folder)
        .output()
        .unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_crate_without_a_licence_text_fails_the_packages() {
    let own: Files = &[("LICENSE-MIT", "Text of a.")];
    let font: Files = &[("fonts/OFL.txt", "Text of the font.")];
    let cases: [(&str, Files, bool); 7] = [
        ("MIT", own, true),
        ("MIT", &[], false),
        // This licence has a standard text, so no file is needed.
        ("MIT OR Apache-2.0", &[], true),
        ("MIT/Apache-2.0", &[], true),
        ("(MIT OR Apache-2.0) AND OFL-1.1", &[], false),
        ("(MIT OR Apache-2.0) AND OFL-1.1", font, true),
        ("Apache-2.0 AND MIT", &[], false),
    ];
    for (licence, files, good) in cases {
        let folder = tempfile::tempdir().unwrap();
        let output = inventory(folder.path(), &[("a", licence, files)]);
        let report = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.success(), good, "{licence}, {files:?}: {report}");
        if good {
            let texts = fs::read_to_string(folder.path().join("out/third-party.txt")).unwrap();
            assert!(texts.contains("a 1.0.0: ") && files.iter().all(|(_, text)| texts.contains(text)), "{texts}");
        } else {
            assert!(report.contains("no licence text for: a 1.0.0"), "{report}");
            assert!(!folder.path().join("out/third-party.txt").exists());
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_list_of_what_is_inside_names_every_crate_with_its_checksum() {
    let folder = tempfile::tempdir().unwrap();
    let text: Files = &[("LICENSE", "One text.")];
    assert!(inventory(folder.path(), &[("a", "MIT", text), ("b", "Zlib", text)]).status.success());
    let read = || fs::read_to_string(folder.path().join("out/sbom.cdx.json")).unwrap();
    let bom: serde_json::Value = serde_json::from_str(&read()).unwrap();
    assert_eq!((&bom["bomFormat"], &bom["specVersion"]), (&"CycloneDX".into(), &"1.5".into()));
    assert_eq!(bom["metadata"]["component"]["name"], "nima-console");
    assert_eq!(bom["components"][0]["purl"], "pkg:cargo/a@1.0.0");
    assert_eq!(bom["components"][0]["hashes"][0]["content"], "ab12");
    let whole = bom["dependencies"].as_array().unwrap().iter().find(|one| one["ref"] == "pkg:cargo/nima-console@1.0.0");
    assert_eq!(whole.unwrap()["dependsOn"], json!(["pkg:cargo/a@1.0.0", "pkg:cargo/b@1.0.0"]));
    // A text used by two crates appears only once.
    let texts = fs::read_to_string(folder.path().join("out/third-party.txt")).unwrap();
    assert_eq!(texts.matches("One text.").count(), 1);
    let before = read();
    assert!(inventory(folder.path(), &[("a", "MIT", text), ("b", "Zlib", text)]).status.success());
    assert_eq!(read(), before, "the same crates give the same list");
}
