#!/usr/bin/env python3
"""Sizes of the parts of the packages' program, bytes: `sizes.py PROGRAM_WITH_SYMBOLS [--rows N]`. Its sections, and its code by crate. A function of the
standard library counts for the first other crate in its name, or for the standard library if its name contains no type of another crate."""

import re
import subprocess
import sys
from collections import Counter

CRATE = re.compile(r"(?<![:\w])([A-Za-z_]\w*)(?:\[[0-9a-f]+\])?::")
STANDARD = {"core", "alloc", "std"}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def sections(program):
    rows = (line.split() for line in run("size", "-A", program).splitlines())
    return {row[0]: int(row[1]) for row in rows if len(row) == 3 and row[1].isdigit() and row[2] != "0"}


def crates(program):
    """Bytes of code by crate, and of named data."""
    code, data = Counter(), Counter()
    for line in run("nm", "--demangle", "--print-size", "--radix=d", program).splitlines():
        row = line.split(maxsplit=3)
        if len(row) < 4 or row[2] not in "tTwWrRdD":
            continue
        named = CRATE.findall(row[3])
        others = [name for name in named if name not in STANDARD]
        crate = others[0] if others else "standard library" if named else "(C, no crate)"
        (code if row[2] in "tTwW" else data)[crate] += int(row[1])
    return code, data


def main():
    program, rows = sys.argv[1], int(sys.argv[sys.argv.index("--rows") + 1]) if "--rows" in sys.argv else 25
    parts = sections(program)
    total = sum(parts.values())
    print(f"{total / 1e6:.2f} MB without symbols")
    for name, size in sorted(parts.items(), key=lambda part: -part[1])[:12]:
        print(f"  {size / 1e6:8.2f} MB  {name}")
    code, data = crates(program)
    for heading, counted in [("code by crate", code), ("named data by crate", data)]:
        print(f"{heading}: {sum(counted.values()) / 1e6:.2f} MB")
        for name, size in counted.most_common(rows):
            print(f"  {size / 1e6:8.3f} MB  {name}")


if __name__ == "__main__":
    main()
