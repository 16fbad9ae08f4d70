"""Shared by the tests: the program whose results must be the same, and recordings."""

from __future__ import annotations

import json
import os
import re
import subprocess
import threading
from pathlib import Path
from typing import Any, Callable, Iterator

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared" / "data"


class Program:
    """The program ``nima``."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def run(self, *arguments: Any, fails: bool = False) -> str:
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert (done.returncode != 0) == fails, f"{arguments}: {done.stderr}"
        return done.stderr if fails else done.stdout

    def json(self, *arguments: Any) -> dict[str, Any]:
        return json.loads(self.run(*arguments, "--json"))


@pytest.fixture(scope="session")
def program() -> Program:
    path = Path(os.environ.get("NIMA", ROOT / "target" / "debug" / "nima"))
    if not path.exists():
        # ./dev python builds it and sets NIMA.
        assert "NIMA" not in os.environ, f"{path} not found"
        pytest.skip(f"the program {path} is not built")
    return Program(path)


def motion(samples: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (s), positions (m) and forces (N) of a hand that presses soft tissue on three axes, with noise."""
    random = np.random.default_rng(seed)
    times_s = np.arange(samples) * 1e-3
    swing = np.stack([np.sin(2 * np.pi * hz * times_s + axis) for axis, hz in enumerate((1.1, 0.7, 1.9))], axis=1)
    positions_m = swing * [0.02, 0.015, 0.008] + random.normal(0.0, 2e-6, (samples, 3))
    depth_m = np.clip(positions_m, 0.0, None)
    forces_n = 350.0 * depth_m**1.2 + random.normal(0.0, 0.01, (samples, 3))
    return times_s, positions_m, forces_n


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Writes columns as a CSV file from which the same numbers are read."""

    def of(name: str, **columns: np.ndarray) -> Path:
        path = tmp_path / name
        rows = zip(*(column.tolist() for column in columns.values()))
        lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
        path.write_text("\n".join(lines) + "\n")
        return path

    return of


def recording(write: Callable[..., Path], name: str, samples: int, seed: int = 1) -> Path:
    """Three axes as a file."""
    times_s, positions_m, forces_n = motion(samples, seed)
    axes = {f"{axis}_m": positions_m[:, i] for i, axis in enumerate("xyz")}
    forces = {f"f{axis}_n": forces_n[:, i] for i, axis in enumerate("xyz")}
    return write(name, t_s=times_s, **axes, **forces)


@pytest.fixture
def running(program: Program, tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], str, Path]]:
    """A run that a client may watch: its process, its address and its session."""
    path = tmp_path / "run.mcap"
    command = [program.path, "run", "--igtl", "127.0.0.1:0", "--record", path, "--scene", "bimanual", "--seconds", "6"]
    with subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        for line in process.stderr:
            found = re.search(r"OpenIGTLink at (\S+):", line)
            if found:
                # Later output must not fill the pipe.
                threading.Thread(target=process.stderr.read, daemon=True).start()
                yield process, found.group(1), path
                break
        else:
            pytest.fail("it ended before it listened")
        process.kill()
