#!/usr/bin/env python3
"""What the packages' program is made of, in bytes: `sizes.py PROGRAM_WITH_SYMBOLS [--rows N]`. Its code by crate (a generic function counts to the crate
that it is named after), and its sections."""

import re
import subprocess
import sys
from collections import Counter

CRATE = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)(?:\[[0-9a-f]+\])?::")


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
        found = CRATE.search(row[3])
        (code if row[2] in "tTwW" else data)[found[1] if found else "(C, no crate)"] += int(row[1])
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
