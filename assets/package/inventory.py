#!/usr/bin/env python3
"""Contents of the packages' program, from the output of cargo: an SBOM (CycloneDX), the licence texts of every crate in it, and the list of crates
that is put into the program itself (the section .dep-v0, which `cargo audit bin` reads).

Fails, with the crates' names, when there is no licence text for one of them.
"""

import argparse
import hashlib
import json
import re
import sys
import uuid
import zlib
from datetime import datetime, timezone
from pathlib import Path

LICENCE_FILE = re.compile(r"(licen[cs]e|copying|copyright|notice|unlicense|ofl|ufl)", re.IGNORECASE)
# Licence texts in a folder of a crate, next to the files to which they apply, that are not in files called LICENSE.
KNOWN_FILES = {"OFL.txt": "OFL-1.1", "UFL.txt": "Ubuntu-font-1.0"}
# The only licence whose text contains no names: used for crates that offer it and have no file.
STANDARD = "Apache-2.0"


def satisfied(expression, available):
    """Whether these licences are enough for an SPDX expression."""
    tokens = re.findall(r"\(|\)|[^\s()/]+|/", expression)

    def one():
        token = tokens.pop(0)
        if token == "(":
            value = either()
            tokens.pop(0)
            return value
        if tokens and tokens[0] == "WITH":
            tokens.pop(0)
            token = f"{token} WITH {tokens.pop(0)}"
        return token in available

    def both():
        value = one()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            value = one() and value
        return value

    def either():
        value = both()
        while tokens and tokens[0] in ("OR", "/"):
            tokens.pop(0)
            value = both() or value
        return value

    return either()


def linked(metadata, tree):
    """The packages that `cargo tree` lists, as cargo describes them, sorted."""
    names = {tuple(line.split()[:2]) for line in tree.splitlines() if line.strip()}
    found = [one for one in metadata["packages"] if (one["name"], f"v{one['version']}") in names]
    missing = names - {(one["name"], f"v{one['version']}") for one in found}
    if missing:
        sys.exit(f"cargo tree lists what cargo metadata does not: {sorted(missing)}")
    return sorted(found, key=lambda one: (one["name"], one["version"]))


def licence_files(package):
    """Licence files of a crate: next to its manifest, and in its folders for the files there (fonts)."""
    folder = Path(package["manifest_path"]).parent
    files = [path for path in folder.iterdir() if path.is_file() and LICENCE_FILE.match(path.name)]
    if package.get("license_file"):
        files.append(folder / package["license_file"])
    own = bool(files)
    below = (path for path in folder.glob("*/*") if path.is_file())
    files += [path for path in below if path.suffix in (".txt", ".md", "") and
              (LICENCE_FILE.search(path.name) or path.with_suffix(".ttf").exists())]
    return own, sorted(set(files))


def licences(packages, standard_text):
    """Texts with the crates to which they belong; names the crates without a text."""
    texts, without = {}, []
    for package in packages:
        who = f"{package['name']} {package['version']}"
        own, files = licence_files(package)
        read = [path.read_text(encoding="utf-8", errors="replace") for path in files]
        if not own:
            available = {STANDARD} | {KNOWN_FILES[path.name] for path in files if path.name in KNOWN_FILES}
            if package["license"] is None or not satisfied(package["license"], available):
                without.append(f"{who} ({package['license']})")
                continue
            read.append(standard_text)
        for text in read:
            key = " ".join(text.split())
            texts.setdefault(key, (text.strip(), []))[1].append((who, package["license"]))
    return list(texts.values()), without


def told(texts, more):
    """One document: each text once, below the names of its crates."""
    parts = ["The program `nima` contains the libraries named below, each under the licence that follows its name.\n"]
    for text, whose in texts + more:
        names = "\n".join(f"{who}: {licence}" for who, licence in sorted(whose))
        parts.append(f"{'=' * 80}\n{names}\n{'-' * 80}\n\n{text}\n")
    return "\n".join(parts)


def purl(package):
    return f"pkg:cargo/{package['name']}@{package['version']}"


def edges(metadata, packages):
    """For each package, the indices of its linked packages."""
    number = {one["id"]: index for index, one in enumerate(packages)}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    result = []
    for one in packages:
        deps = nodes[one["id"]]["deps"]
        normal = [dep["pkg"] for dep in deps if any(kind["kind"] is None for kind in dep["dep_kinds"])]
        result.append(sorted({number[dep] for dep in normal if dep in number}))
    return result


def checksums(lock):
    """SHA-256 of every crate, from Cargo.lock."""
    found = {}
    for block in lock.split("[[package]]")[1:]:
        field = dict(re.findall(r'^(\w+) = "([^"]*)"$', block, re.MULTILINE))
        if "checksum" in field:
            found[field["name"], field["version"]] = field["checksum"]
    return found


def component(package, sums):
    one = {"type": "library", "bom-ref": purl(package), "name": package["name"], "version": package["version"]}
    if package["description"]:
        one["description"] = " ".join(package["description"].split())
    if package["license"]:
        one["licenses"] = [{"expression": package["license"].replace("/", " OR ")}]
    checksum = sums.get((package["name"], package["version"]))
    if checksum:
        one["hashes"] = [{"alg": "SHA-256", "content": checksum}]
        one["purl"] = purl(package)
    if package["repository"]:
        one["externalReferences"] = [{"type": "vcs", "url": package["repository"]}]
    return one


def sbom(metadata, packages, sums, program, epoch):
    """CycloneDX 1.5. Its serial number is computed from its list, so that the same program has the same number."""
    root = next(one for one in packages if one["name"] == program)
    whole = {"type": "application", "bom-ref": purl(root), "name": program, "version": root["version"],
             "licenses": [{"expression": root["license"]}]}
    others = [component(one, sums) for one in packages if one is not root]
    dependencies = [{"ref": purl(one), "dependsOn": [purl(packages[index]) for index in of]}
                    for one, of in zip(packages, edges(metadata, packages))]
    listed = json.dumps([whole, others], sort_keys=True)
    when = datetime.fromtimestamp(epoch, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, hashlib.sha256(listed.encode()).hexdigest())}",
        "version": 1,
        "metadata": {"timestamp": when, "component": whole},
        "components": others,
        "dependencies": dependencies,
    }


def auditable(metadata, packages, program):
    """The list of crates as cargo-auditable writes it."""
    listed = []
    for one, of in zip(packages, edges(metadata, packages)):
        entry = {"name": one["name"], "version": one["version"],
                 "source": "crates.io" if one["source"] else "local"}
        if of:
            entry["dependencies"] = of
        if one["name"] == program:
            entry["root"] = True
        listed.append(entry)
    return zlib.compress(json.dumps({"packages": listed}, separators=(",", ":")).encode(), 9)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--metadata", type=Path, required=True, help="what `cargo metadata` printed")
    parser.add_argument("--tree", type=Path, required=True, help="what `cargo tree --prefix none` printed")
    parser.add_argument("--lock", type=Path, required=True, help="Cargo.lock")
    parser.add_argument("--standard", type=Path, required=True, help=f"text of {STANDARD}")
    parser.add_argument("--also", action="append", default=[], metavar="NAME|LICENCE|FILE",
                        help="something that is no crate and becomes a part of the program")
    parser.add_argument("--program", default="nima-console")
    parser.add_argument("--epoch", type=int, required=True, help="time of the packages, s since 1970")
    parser.add_argument("--out", type=Path, required=True, help="folder")
    given = parser.parse_args()
    metadata = json.loads(given.metadata.read_text())
    packages = linked(metadata, given.tree.read_text())
    others = [one for one in packages if one["source"]]
    texts, without = licences(others, given.standard.read_text())
    if without:
        sys.exit("no licence text for: " + ", ".join(without) + ". Ask its authors for one, or leave the crate out")
    more = []
    for also in given.also:
        name, licence, file = also.split("|")
        more.append((Path(file).read_text(encoding="utf-8", errors="replace").strip(), [(name, licence)]))
    given.out.mkdir(parents=True, exist_ok=True)
    (given.out / "third-party.txt").write_text(told(texts, more))
    bom = sbom(metadata, packages, checksums(given.lock.read_text()), given.program, given.epoch)
    (given.out / "sbom.cdx.json").write_text(json.dumps(bom, indent=1) + "\n")
    (given.out / "dep-v0").write_bytes(auditable(metadata, packages, given.program))
    own = len(packages) - len(others)
    print(f"{len(others)} crates of others and {own} of ours, {len(texts) + len(more)} different licence texts")


if __name__ == "__main__":
    main()
