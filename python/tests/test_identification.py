"""Identification: the same as the program's to the last bit, from arrays, frames and files."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pandas
import pytest

import nima
from conftest import SHARED, Program, motion, recording
from nima._arrays import columns

SETTINGS = {"window_s": 0.2, "delay_s": 0.03, "max_degree": 4}
FLAGS = ["--window-ms", "200", "--delay-ms", "30", "--max-degree", "4"]


def trace(path: Path, column: str) -> np.ndarray:
    """A column of a trace; blanks are NaN."""
    with path.open() as file:
        return np.array([float(row[column] or "nan") for row in csv.DictReader(file)])


def same(left: np.ndarray, right: np.ndarray) -> bool:
    """To the last bit, NaN where NaN is."""
    return left.shape == right.shape and bool(np.array_equal(left, right, equal_nan=True))


def agrees(result: nima.Identification, program: Program, out: Path, *arguments: object) -> None:
    """The program's figures and trace for these arguments equal this result."""
    figures = program.json("identify", *arguments, "--out", out)
    ours = dict(result.figures)
    # Differs from run to run: the time of a tick.
    assert figures.pop("tick_us").keys() == ours.pop("tick_us").keys()
    assert ours == figures
    for axis, name in enumerate(ours["axes"]):
        assert same(result.forces_n[:, axis], trace(out, f"r{name}_n"))
        assert same(result.held_n[:, axis], trace(out, f"h{name}_n"))
    assert same(result.degrees.astype(float), trace(out, "degree"))
    assert same(result.conditions, trace(out, "condition"))
    with out.open() as file:
        assert [nima.GATES[gate] for gate in result.gates] == [row["gate"] for row in csv.DictReader(file)]


@pytest.mark.parametrize("mode", nima.MODES)
def test_every_mode_agrees_with_the_program_to_the_last_bit(mode, program, write, tmp_path):
    path = recording(write, "recording.csv", 1500)
    times_s, positions_m, forces_n = motion(1500)
    result = nima.identify(positions_m, forces_n, 1000.0, times_s=times_s, mode=mode, **SETTINGS)
    agrees(result, program, tmp_path / "trace.csv", path, "--mode", mode, *FLAGS)
    evenly = nima.identify(positions_m, forces_n, 1000.0, mode=mode, **SETTINGS)
    assert same(evenly.forces_n, result.forces_n)


def test_a_hole_another_rate_and_fewer_axes_agree_too(program, write, tmp_path):
    times_s, positions_m, forces_n = motion(1200, seed=5)
    times_s = times_s * 2.0 + np.where(np.arange(1200) >= 600, 0.5, 0.0)
    path = write("hole.csv", t_s=times_s, y_m=positions_m[:, 1], z_m=positions_m[:, 2], fy_n=forces_n[:, 1], fz_n=forces_n[:, 2])
    read = nima.read_recording(path)
    assert (read.axes, read.rate_hz) == (["y", "z"], 500.0)
    assert same(read.positions_m, positions_m[:, 1:]) and same(read.times_s, times_s)
    result = nima.identify(read, mode="anchored", cross_talk=True, **SETTINGS)
    assert result.figures["holes"] == 1
    agrees(result, program, tmp_path / "trace.csv", path, "--mode", "anchored", "--cross-talk", *FLAGS)


def test_every_reading_of_the_paper_agrees(program, write, tmp_path):
    path = recording(write, "recording.csv", 1000, seed=3)
    read = nima.read_recording(path)
    keywords = {"reading": "displacement", "choice": "next", "constant": True, "ridge": 0.003}
    flags = ["--reading", "displacement", "--choice", "next", "--constant", "--ridge", "0.003"]
    result = nima.identify(read, mode="literal", **keywords, **SETTINGS)
    agrees(result, program, tmp_path / "trace.csv", path, "--mode", "literal", *flags, *FLAGS)
    assert not same(result.forces_n, nima.identify(read, mode="literal", **SETTINGS).forces_n)


def test_the_leaders_own_motion_agrees(program, write, tmp_path):
    times_s, positions_m, forces_n = motion(1500)
    leader_m = np.roll(positions_m, -20, axis=0)
    names = {f"{axis}_m": positions_m[:, i] for i, axis in enumerate("xyz")}
    names |= {f"f{axis}_n": forces_n[:, i] for i, axis in enumerate("xyz")}
    path = write("led.csv", t_s=times_s, **names, **{f"h{axis}": leader_m[:, i] * 1e3 for i, axis in enumerate("xyz")})
    mapped = {"lxyz": "hx,hy,hz*0.001"}
    read = nima.read_recording(path, map=mapped)
    assert read.leader_positions_m is not None and np.allclose(read.leader_positions_m, leader_m)
    for mode in ("anchored", "matched", "best"):
        result = nima.identify(read, mode=mode, **SETTINGS)
        agrees(result, program, tmp_path / "trace.csv", path, "--map", "lxyz=hx,hy,hz*0.001", "--mode", mode, *FLAGS)
        alone = nima.identify(positions_m, forces_n, times_s=times_s, mode=mode, **SETTINGS)
        arrays = nima.identify(positions_m, forces_n, times_s=times_s, mode=mode,
                               leader_positions_m=read.leader_positions_m, **SETTINGS)
        assert same(arrays.forces_n, result.forces_n) and not same(alone.forces_n, result.forces_n)


def test_a_real_recording_agrees_from_file_frame_and_arrays(program, tmp_path):
    path = SHARED / "tue_1dof" / "m1_question1a_foam.csv"
    if not path.exists():
        pytest.skip(f"the recording {path} is not here")
    mapped = {"x": "pos_follower_rad", "fx": "Fe_Nm", "lx": "pos_leader_rad"}
    flags = [f"--map={name}={column}" for name, column in mapped.items()]
    frame = pandas.read_csv(path, float_precision="round_trip")
    of_frame = nima.identify(frame, delay_s=0.05, map=mapped)
    agrees(of_frame, program, tmp_path / "trace.csv", path, *flags, "--delay-ms", "50")
    of_file = nima.identify(nima.read_recording(path, map=mapped), delay_s=0.05)
    assert same(of_file.forces_n, of_frame.forces_n)
    del mapped["lx"]
    result = nima.identify(frame, delay_s=0.05, map=mapped)
    assert result.errors["rendered"]["mae"] < result.errors["held"]["mae"] and result.ratio < 1.0


def test_three_lines_from_a_frame_to_the_error_table(write):
    path = recording(write, "recording.csv", 1500)
    frame = pandas.read_csv(path)
    result = nima.identify(frame, delay_s=0.05)
    table = pandas.DataFrame(result.errors)
    assert list(table.columns) == ["rendered", "held"] and list(table.index) == ["mae", "sd", "p95", "max"]
    assert 0.0 < table.loc["mae", "rendered"] < table.loc["mae", "held"]
    assert "rendered / held 0." in str(result)


def test_a_frame_takes_the_maps_of_the_program(write):
    path = recording(write, "recording.csv", 1000)
    frame = pandas.read_csv(path, float_precision="round_trip")
    plain = nima.identify(frame, **SETTINGS)
    other = frame.rename(columns={"t_s": "time", "x_m": "a", "y_m": "b", "z_m": "c"})
    mapped = nima.identify(other, map=["t=time", "xyz=a,b,c"], **SETTINGS)
    assert same(plain.forces_n, mapped.forces_n)
    scaled = nima.identify(other.assign(a=other["a"] * 2.0), map={"t": "time", "x": "a*0.5", "y": "b", "z": "c"}, **SETTINGS)
    assert same(plain.forces_n, scaled.forces_n), "a factor of two is exact"


def test_arrays_are_read_where_they_are():
    _, positions_m, forces_n = motion(1000)
    plain = nima.identify(positions_m, forces_n, 1000.0, **SETTINGS)
    wide = np.zeros((2000, 6))
    wide[::2, 1::2] = positions_m
    views = [np.asfortranarray(positions_m), wide[::2, 1::2], positions_m[::-1].copy()[::-1]]
    for view in views:
        view.flags.writeable = False
        assert all(np.shares_memory(column, view) for column in columns("positions_m", view))
        assert same(nima.identify(view, forces_n, 1000.0, **SETTINGS).forces_n, plain.forces_n)
    packed = np.zeros(1000, dtype=np.dtype([("flag", "u1"), ("at", "3f8")]))
    packed["at"] = positions_m
    assert not packed["at"].flags.aligned
    for copied in (packed["at"], positions_m.astype(">f8"), np.ma.masked_array(positions_m), positions_m.tolist()):
        assert same(nima.identify(copied, forces_n, 1000.0, **SETTINGS).forces_n, plain.forces_n)
    single = nima.identify(positions_m.astype(np.float32), forces_n.astype(np.float32), 1000.0, **SETTINGS)
    assert single.forces_n.dtype == np.float64 and np.allclose(single.forces_n, plain.forces_n, atol=0.05, equal_nan=True)
    one = nima.identify(positions_m[:, 0], forces_n[:, 0].tolist(), 1000.0, **SETTINGS)
    assert one.forces_n.shape == (1000, 1)


def test_parcels_have_what_crosses_the_link():
    _, positions_m, forces_n = motion(1000)
    assert nima.identify(positions_m, forces_n, 1000.0).parcels is None
    parcels = nima.identify(positions_m, forces_n, 1000.0, parcels=True, **SETTINGS).parcels
    assert parcels is not None and parcels["literal_coefficients"].shape == (1000, 15, 3)
    assert parcels["anchored_motion"].shape == (1000, 9, 3) and parcels["resting"].dtype == np.bool_
    degrees = parcels["literal_degree"]
    assert degrees[0] == 0 and 1 <= degrees[-1] <= 4 and set(parcels["linear_degree"]) == {0, 1}
    for degree in range(1, 5):
        rows = parcels["literal_coefficients"][degrees == degree]
        assert not rows[:, 3 * degree :].any(), "columns beyond the degree"
        assert rows[:, : 3 * degree].any() or len(rows) == 0


FEW = np.linspace(0.0, 1.0, 500)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "rate_hz and times_s are missing"),
        ({"rate_hz": 1000.0, "mode": "smith"}, 'unknown mode "smith": use one of literal'),
        ({"rate_hz": 1000.0, "delay_s": 5.0}, "the delay of 5 s is out of range: use 0 to 1 s"),
        ({"rate_hz": 1000.0, "delay_s": float("nan")}, "the delay of NaN s is out of range"),
        ({"rate_hz": 1000.0, "delay_s": 1e-4}, "less than half a sample"),
        ({"rate_hz": 1.0}, "the sampling rate of 1 Hz is out of range"),
        ({"rate_hz": 1000.0, "window_s": 0.0, "mode": "literal"}, "the window of 0 s"),
        ({"rate_hz": 1000.0, "window_s": 0.6}, "has 500 samples; a window of 600 ms"),
        ({"rate_hz": 1000.0, "max_degree": 9}, "the highest degree 9 is out of range"),
        ({"rate_hz": 1000.0, "ridge": -1.0}, "the ridge parameter -1 is out of range"),
        ({"rate_hz": 1000.0, "reading": "sideways"}, "reading: unknown variant `sideways`"),
        ({"rate_hz": 1000.0, "choice": "best"}, "choice: unknown variant `best`"),
        ({"times_s": np.zeros(500)}, "times_s, row 1: time does not increase (0 s, then 0 s)"),
        ({"times_s": np.arange(7.0)}, "times_s has 7 rows, positions_m has 500"),
        ({"rate_hz": 1000.0, "positions_m": np.zeros((500, 4)), "forces_n": np.zeros((500, 4))}, "positions_m has 4 axes"),
        ({"rate_hz": 1000.0, "positions_m": np.zeros((500, 0)), "forces_n": np.zeros((500, 0))}, "positions_m has 0 axes"),
        ({"rate_hz": 1000.0, "positions_m": np.zeros((500, 2))}, "positions_m has the shape (500, 2), forces_n has (500, 1)"),
        ({"rate_hz": 1000.0, "positions_m": np.zeros((5, 5, 5))}, "positions_m has 3 dimensions"),
        ({"rate_hz": 1000.0, "positions_m": ["a"] * 500}, "positions_m: the values are not numbers"),
        ({"rate_hz": 1000.0, "forces_n": np.where(FEW == FEW[70], np.nan, FEW)}, "forces_n, row 70: NaN is not a finite number"),
        ({"rate_hz": 1000.0, "forces_n": np.where(FEW == FEW[9], -np.inf, FEW)}, "forces_n, row 9: -inf"),
        ({"rate_hz": 1000.0, "forces_n": None}, "forces_n is missing"),
        ({"rate_hz": 1000.0, "leader_positions_m": FEW[1:]}, "leader_positions_m has the shape (499, 1), positions_m has (500, 1)"),
        ({"rate_hz": 1000.0, "map": ["x=a"]}, "map names columns of a frame"),
        ({"positions_m": pandas.DataFrame({"x_m": FEW}), "forces_n": None}, 'the frame has no column "t_s"; its columns are x_m'),
        ({"positions_m": pandas.DataFrame({"t_s": FEW, "x_m": FEW}), "forces_n": None}, 'no column "fx_n"'),
        ({"positions_m": pandas.DataFrame({"t_s": FEW}), "forces_n": None, "map": ["w=a"]}, 'no quantity "w"'),
        ({"positions_m": pandas.DataFrame({"t_s": FEW}), "forces_n": None, "map": ["xyz=a,b"]}, "takes 3 columns, not 2"),
    ],
)
def test_what_cannot_be_used_is_one_clear_line(arguments, words):
    with pytest.raises(ValueError) as caught:
        nima.identify(**{"positions_m": FEW, "forces_n": FEW, **arguments})
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_files_that_cannot_be_read_are_told_apart(tmp_path, write):
    with pytest.raises(OSError, match="cannot read recording .*none.csv: No such file"):
        nima.read_recording(tmp_path / "none.csv")
    path = write("nan.csv", t_s=np.arange(5.0), x_m=np.array([0.0, 1.0, np.nan, 3.0, 4.0]), fx_n=np.arange(5.0))
    with pytest.raises(ValueError, match='line 4, column "x_m": "nan" is not a finite number'):
        nima.read_recording(path)
    with pytest.raises(ValueError, match="is a table; omit arm"):
        nima.read_recording(path, arm="right")
    with pytest.raises(ValueError, match='map names columns of a table, and .*s.mcap is a session'):
        nima.read_recording(tmp_path / "s.mcap", map=["x=a"])


def test_no_shape_and_no_number_makes_more_than_a_value_error():
    random = np.random.default_rng(2)
    special = np.array([0.0, -0.0, 1e-320, 1e308, -1e308, np.inf, -np.inf, np.nan, 1.0])
    refused = 0
    for _ in range(200):
        rows, axes = int(random.integers(0, 400)), int(random.integers(0, 5))
        positions_m = random.choice(special, (rows, axes)) if random.random() < 0.5 else random.normal(0.0, 1.0, (rows, axes))
        forces_n = random.normal(0.0, 10.0 ** random.integers(-300, 300), (rows, axes))
        try:
            result = nima.identify(
                positions_m, forces_n, float(random.choice([20.0, 1000.0, 1e4, np.nan])), float(random.choice([0.0, 0.1, 1.0])),
                mode=str(random.choice(nima.MODES)), window_s=float(random.choice([0.01, 0.1, 1.0])), parcels=True,
            )
            assert result.forces_n.shape == (rows, axes)
        except ValueError:
            refused += 1
    assert 0 < refused < 200
