#!/usr/bin/env python3
"""Make a table of src/machine/runtime/jitter.rs from the times of the ticks of a recorded session.

usage: nima run --scheduling ordinary --seconds 60 --record S.mcap; nima export S.mcap --out S.csv; jitter_table.py S.csv

The session must be of a simulated rig, whose deadlines are whole periods. A tick is disturbed from the first one that is later
than half a period until none was for 20 ms; the rest are usual ones.
"""

import csv
import sys

LATE = 0.5
CALM_PERIODS = 20
USUAL = [0, 0.01, 0.1, 0.5, 0.9, 0.99, 0.999, 1]
DISTURBED = [0, 0.1, 0.25, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1]


def lateness(path, rate_hz=1000.0):
    """Deadline (periods) and lateness (periods) of each tick."""
    with open(path, encoding="utf-8") as file:
        rows = (line for line in file if not line.startswith("#"))
        times = [float(row["t_s"]) for row in csv.DictReader(rows)]
    ticks, last = [], None
    for t_s in times:
        period = int(t_s * rate_hz + 1e-6)
        missed = 0 if last is None else period - last - 1
        ticks.append((period, missed + t_s * rate_hz - period))
        last = period
    return ticks


def states(ticks):
    """Lateness (us at 1 kHz) in each state, and how often each is left."""
    groups, left, state, until = ([], []), [0, 0], 0, -1
    for period, late in ticks:
        if late > LATE:
            until = period + CALM_PERIODS
        now = int(period <= until)
        left[state] += now != state
        state = now
        groups[state].append(max(0.0, 1e3 * late))
    return groups, left


def main():
    ticks = lateness(sys.argv[1])
    groups, left = states(ticks)
    late = sum(late > LATE for _, late in ticks)
    missed = ticks[-1][0] - ticks[0][0] + 1 - len(ticks)
    print(f"{len(ticks)} ticks, {missed} missed; {100 * late / len(ticks):.2f} % later than {LATE} periods")
    for group, leaves, probabilities in zip(groups, left, (USUAL, DISTURBED)):
        if not group:
            continue
        group.sort()
        table = [[p, round(group[min(int(p * len(group)), len(group) - 1)])] for p in probabilities]
        print(f"leave: {leaves / len(group):.5f}, {len(group)} ticks")
        print("late_us: &[" + ", ".join(f"[{float(p)}, {float(us)}]" for p, us in table) + "],")


if __name__ == "__main__":
    main()
