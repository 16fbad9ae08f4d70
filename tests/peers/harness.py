"""Shared by all peer checks: an emulator as a separate process, and counted checks."""

import json
import subprocess
import sys
import time


class Emulator:
    """`nima emulate ...` for the length of a `with` block; endpoints by device name."""

    def __init__(self, nima, *arguments):
        self.command = [nima, "emulate", *arguments]
        self.endpoints = {}

    def __enter__(self):
        self.process = subprocess.Popen(
            self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{' '.join(self.command)} ended at once")
        self._take(line)
        return self

    def _take(self, line):
        told = json.loads(line)
        self.endpoints[told["device"]] = told["endpoint"]

    def more(self, count):
        """Reads `count` more endpoints."""
        for _ in range(count):
            self._take(self.process.stdout.readline())

    @property
    def endpoint(self):
        return next(iter(self.endpoints.values()))

    def fault(self, *words):
        self.process.stdin.write("fault " + " ".join(words) + "\n")
        self.process.stdin.flush()
        time.sleep(0.05)

    def __exit__(self, *_):
        self.process.stdin.close()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise SystemExit("the emulator does not end when its standard input is closed")


class Peer:
    """Counts checks of one third-party client."""

    def __init__(self, name):
        self.name, self.passed, self.skipped = name, 0, None

    def check(self, what, good, got=""):
        if not good:
            sys.exit(f"peer {self.name}: {what}: {got!r}")
        self.passed += 1

    def near(self, what, got, expected, within):
        self.check(what, abs(got - expected) <= within, (got, expected))

    def skip(self, why):
        self.skipped = why
