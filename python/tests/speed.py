"""Time of an identification from Python as a multiple of the same in Rust: medians of runs that take turns.

python tests/speed.py RUST_EXAMPLE [SAMPLES [RUNS]]
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

import numpy as np

import nima


def main() -> None:
    example = sys.argv[1]
    samples = int(sys.argv[2]) if len(sys.argv) > 2 else 1_000_000
    runs = int(sys.argv[3]) if len(sys.argv) > 3 else 3
    times_s = np.arange(samples) * 1e-3
    positions_m = np.stack(
        [0.02 * np.sin(7.0 * times_s), 0.015 * np.cos(4.4 * times_s), 0.008 * np.sin(12.0 * times_s)], axis=1
    )
    forces_n = 350.0 * np.clip(positions_m, 0.0, None)
    rust_s, python_s = [], []
    for _ in range(runs):
        told = subprocess.run([example, str(samples), "1"], capture_output=True, text=True, check=True).stdout.split()
        rust_s.append(float(told[0]))
        begin = time.perf_counter()
        result = nima.identify(positions_m, forces_n, 1000.0, 0.05)
        python_s.append(time.perf_counter() - begin)
        # numpy's sine differs in the last bit from Rust's.
        assert abs(result.figures["error"]["mae"] / float(told[1]) - 1.0) < 1e-3
    rust, python = statistics.median(rust_s), statistics.median(python_s)
    print(f"{samples} samples, {runs} runs each: Rust {rust:.2f} s, Python {python:.2f} s, ratio {python / rust:.3f}")
    if python > 1.3 * rust:
        sys.exit("Python takes more than 1.3 times as long")


if __name__ == "__main__":
    main()
