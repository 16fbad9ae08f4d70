"""Runs the unit tests, cross-built for Windows, under wine: one program for each crate, each in the folder of its crate, as cargo does.

Reads what `cargo test --no-run --message-format=json` wrote. At the end it prints how many tests passed and failed, and which were not judged, each with
its reason. Fails when a test fails, a program does not end, or `left_out.txt` names a test that does not exist.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import time

RESULT = re.compile(r"^test (\S+)(?: - should panic)? \.\.\. (ok|FAILED|ignored)", re.MULTILINE)
TOO_BUSY = re.compile(r"not judged: (\S+)")
# In the source: the marks of a test, then its name. Marks may have brackets within, and more lines than one.
MARK = r"#\[[^\n]*(?:\n[^\n#]*?)?\]\s*"
TEST = re.compile(rf"^[ \t]*(?P<marks>(?:{MARK})*?#\[test\]\s*(?:{MARK})*)(?:pub )?fn (?P<name>\w+)", re.MULTILINE)
OF_FEATURE = re.compile(r"#\[cfg\([^\n]*feature[^\n]*\)\]\s*(?:#\[[^\n]*\]\s*)*(?:pub(?:\([^)]*\))? )?mod (\w+);")


class Program:
    """The unit tests of one crate."""

    def __init__(self, message):
        self.file = message["executable"]
        self.folder = pathlib.Path(message["manifest_path"]).parent
        # Cargo's name of the crate: `path+file:///.../src/core#nima-core@0.2.0`
        self.crate = re.sub(r".*[#/]([^#/@]+)@[^@]*$", r"\1", message["package_id"])
        self.results = {}
        self.too_busy = []
        self.trouble = None

    def names(self, *arguments):
        said = run([*wine(self.file), "--list", *arguments], self.folder, 60)[1]
        return re.findall(r"^(\S+): test\r?$", said, re.MULTILINE)

    def judge(self, left_out, limit_s):
        skips = [word for name in left_out for word in ("--skip", name)]
        status, said = run([*wine(self.file), "--exact", *skips], self.folder, limit_s)
        self.results = dict(RESULT.findall(said))
        self.too_busy = self.not_judged(said)
        if status is None:
            self.trouble = f"did not end within {limit_s:.0f} s"
        elif "\ntest result: " not in said:
            self.trouble = f"ended with {status} before its tests did"
        elif status != 0 and not self.all("FAILED"):
            self.trouble = f"ended with {status}"
        return said

    def judge_again(self, limit_s):
        """Tests for which the machine was too busy, alone and one at a time."""
        _, said = run([*wine(self.file), "--exact", "--show-output", "--test-threads", "1", *self.too_busy], self.folder, limit_s)
        self.results.update(RESULT.findall(said))
        self.too_busy = self.not_judged(said)
        return said

    def not_judged(self, said):
        return sorted({name for name in TOO_BUSY.findall(said) if self.results.get(name) == "ok"})

    def all(self, result):
        return sorted(name for name, told in self.results.items() if told == result)

    def not_built(self, names):
        """Tests of the source that this program has not: those of features that are off, and those for other systems."""
        here = {name.rsplit("::", 1)[-1] for name in names}
        root = self.folder / "src" if (self.folder / "src" / "lib.rs").exists() else self.folder
        # Programs outside the workspace are in folders of crates.
        others = [manifest.parent for manifest in root.rglob("Cargo.toml") if manifest.parent != root]
        files = [path for path in root.rglob("*.rs") if not any(path.is_relative_to(other) for other in others)]
        texts = {path.relative_to(root): path.read_text() for path in files}
        optional = [of for path, text in texts.items() for of in of_features(path, text)]
        by_feature, by_system = [], []
        for path, text in texts.items():
            module = path.with_suffix("")
            for found in TEST.finditer(text):
                if found["name"] not in here:
                    is_optional = any(module.is_relative_to(of) for of in optional) or "feature" in found["marks"]
                    (by_feature if is_optional else by_system).append(f"{self.crate} {path} {found['name']}")
        return sorted(by_feature), sorted(by_system)


def of_features(path, text):
    """The modules of this file that a feature brings, as paths without an ending."""
    folder = path.parent if path.stem in ("lib", "mod") else path.with_suffix("")
    if "\n#![cfg(feature" in text:
        yield folder
    yield from (folder / name for name in OF_FEATURE.findall(text))


def wine(program):
    return ["wine", program]


def run(command, folder, limit_s):
    """Returns the exit status of the command, or nothing after a timeout, and its output."""
    started = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
    try:
        said, status = started.communicate(timeout=limit_s)[0], started.returncode
    except subprocess.TimeoutExpired:
        # A child process may hold the pipe for longer.
        started.kill()
        try:
            said, status = started.communicate(timeout=10)[0], None
        except subprocess.TimeoutExpired as expired:
            said, status = expired.stdout or b"", None
    return status, said.decode(errors="replace").replace("\r\n", "\n")


def left_out(path):
    """Reasons with the tests that they are for: `= reason`, and below it `crate test` on each line."""
    reasons = {}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        line = line.strip()
        if line.startswith("= "):
            reason = line[2:]
            reasons[reason] = []
        elif line and not line.startswith("#"):
            words = line.split()
            if len(words) != 2 or not reasons:
                sys.exit(f"{path}:{number}: write '= reason', and below it 'crate name::of::the::test'")
            reasons[reason].append(tuple(words))
    return reasons


def say(words):
    print(f"== {words}", file=sys.stderr, flush=True)


def tell(title, lines):
    say(f"{title}: {len(lines)}")
    for line in lines:
        print(f"   {line}", file=sys.stderr, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--built", type=pathlib.Path, required=True)
    parser.add_argument("--left-out", type=pathlib.Path, required=True)
    parser.add_argument("--logs", type=pathlib.Path, required=True)
    parser.add_argument("--limit-s", type=float, default=900)
    parser.add_argument("crates", nargs="*", help="only these")
    given = parser.parse_args()
    messages = (json.loads(line) for line in given.built.read_text().splitlines() if line.startswith("{"))
    built = [Program(message) for message in messages if message.get("executable") and message["profile"]["test"] and message["target"]["test"]]
    unknown = set(given.crates) - {program.crate for program in built}
    if unknown or not built:
        sys.exit(f"no such crate with unit tests: {' '.join(sorted(unknown))}; there are {' '.join(sorted(p.crate for p in built))}")
    programs = sorted((p for p in built if not given.crates or p.crate in given.crates), key=lambda p: p.crate)
    reasons = left_out(given.left_out)
    given.logs.mkdir(parents=True, exist_ok=True)

    passed, failed, ignored, busy, by_feature, by_system, stale = 0, [], 0, [], [], [], []
    for program in programs:
        out = {name for tests in reasons.values() for crate, name in tests if crate == program.crate}
        names = set(program.names())
        begin = time.monotonic()
        said = program.judge(sorted(out), given.limit_s)
        (given.logs / f"{program.crate}.txt").write_text(said)
        if program.too_busy:
            (given.logs / f"{program.crate}-again.txt").write_text(program.judge_again(given.limit_s))
        bad = program.all("FAILED")
        unanswered = sorted(names - out - program.results.keys()) if program.trouble else []
        passed += len(program.all("ok")) - len(program.too_busy)
        ignored += len(program.all("ignored"))
        failed += [f"{program.crate} {name}" for name in bad]
        if program.trouble:
            failed.append(f"{program.crate} {program.trouble}; without an answer: {' '.join(unanswered)}")
        busy += [f"{program.crate} {name}" for name in program.too_busy]
        of_features, of_systems = program.not_built(names)
        by_feature += of_features
        by_system += of_systems
        stale += [f"{program.crate} {name}" for name in sorted(out - names)]
        say(
            f"{program.crate}: {len(program.all('ok'))} passed, {len(bad)} failed, {len(out & names)} left out, {len(program.all('ignored'))} ignored, "
            f"{time.monotonic() - begin:.0f} s{', ' + program.trouble if program.trouble else ''}"
        )

    chosen = {program.crate for program in programs}
    by_name = {reason: [f"{crate} {name}" for crate, name in tests if crate in chosen] for reason, tests in reasons.items()}
    if by_feature:
        tell("not built, of a feature with a command of its own (./dev live, h264)", by_feature)
    if by_system:
        tell("not built for Windows, by `#[cfg]`", by_system)
    for reason, tests in by_name.items():
        if tests:
            tell(f"left out, {reason}", tests)
    if busy:
        tell("not judged, the machine is too busy", busy)
    if stale:
        tell(f"named in {given.left_out.name}, but not there", stale)
    if failed:
        tell(f"FAILED (what they said: {given.logs})", failed)
    count = sum(map(len, by_name.values()))
    say(
        f"unit tests under wine: {passed} passed, {len(failed)} failed; left out: {count} by name, {len(by_system)} not built for Windows, {len(busy)} not judged; "
        f"as on Linux {ignored} are ignored and {len(by_feature)} belong to features that are off"
    )
    return 1 if failed or stale else 0


if __name__ == "__main__":
    sys.exit(main())
