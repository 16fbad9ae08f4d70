"""Recorded sessions: the same as what the program exports."""

from __future__ import annotations

import csv
import warnings
from pathlib import Path

import numpy as np
import pytest

import nima
from conftest import Program


@pytest.fixture(scope="module")
def session(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("session") / "run.mcap"
    program.run("run", "--virtual", "--seconds", "3", "--scene", "bimanual", "--record", path)
    return path


def test_ticks_are_the_table_that_the_program_exports(program, session, tmp_path):
    table = tmp_path / "left.csv"
    program.run("export", session, "--arm", "left", "--out", table)
    ticks = nima.Session(session).ticks("left")
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(ticks.t_s) > 2900
    of_table = {"tip_m": "{}_m", "measured_n": "f{}_n", "leader_m": "leader_{}_m", "delayed_n": "delayed_{}_n",
                "asked_n": "asked_{}_n", "rendered_n": "rendered_{}_n"}
    for name, column in of_table.items():
        # An unknown value is an empty cell.
        values = np.array([[float(row[column.format(axis)] or "nan") for axis in "xyz"] for row in rows])
        assert np.array_equal(getattr(ticks, name), values, equal_nan=True), name
    assert np.array_equal(ticks.t_s, [float(row["t_s"]) for row in rows])
    assert np.array_equal(ticks.time_ns, np.array([int(row["time_ns"]) for row in rows], dtype=np.uint64))
    assert ticks.state == [row["state"] for row in rows]


def test_a_stretch_is_a_part_of_the_whole(session):
    reader = nima.Session(session)
    whole, part = reader.ticks("right"), reader.ticks("right", from_s=1.0, to_s=1.5)
    inside = (whole.t_s >= 1.0) & (whole.t_s < 1.5)
    assert len(part.t_s) == 500 and np.array_equal(part.rendered_n, whole.rendered_n[inside])


def test_every_channel_of_numbers_is_read(session):
    reader = nima.Session(session)
    assert reader.arms == ["right", "left"] or reader.arms == ["left", "right"]
    plots = [channel for channel in reader.channels if channel.schema == "sensor_msgs/msg/JointState"]
    assert len(plots) >= 9
    for channel in plots:
        numbers = reader.plot(channel.topic)
        assert all(len(column) == channel.messages for column in numbers.values()), channel
    forces, ticks = reader.plot("right/forces"), reader.ticks("right")
    assert np.array_equal(forces["right.rendered.z_n"], ticks.rendered_n[:, 2])


def test_events_metadata_and_attachments(session):
    reader = nima.Session(session)
    events = reader.events()
    assert any("engaged" in event.words.lower() for event in events) and all(event.level for event in events)
    assert [event.t_s for event in events] == sorted(event.t_s for event in events)
    assert reader.metadata["session"]["rig"] and reader.begin_ns > 0 and 2.9 < reader.end_s < 3.1
    assert reader.notes == [] and "nima" in reader.library.lower()
    attachment = reader.attachments[0]
    assert len(reader.attachment(attachment.name)) == attachment.size


def test_a_session_is_identified_as_the_program_does_it(program, session):
    figures = program.json("identify", session, "--arm", "left", "--delay-ms", "40")
    ours = dict(nima.identify(nima.Session(session).recording("left"), delay_s=0.04).figures)
    assert figures.pop("tick_us") and ours.pop("tick_us") and ours == figures


def test_what_is_wrong_is_one_clear_line(session, tmp_path):
    reader = nima.Session(session)
    for call, words in [
        (lambda: reader.ticks(), "two arms: choose one"),
        (lambda: reader.ticks("middle"), 'arm is "middle"; give "right" or "left"'),
        (lambda: reader.ticks("right", from_s=2.0, to_s=1.0), "from_s must be before to_s"),
        (lambda: reader.ticks("right", from_s=-1.0), "from_s is -1"),
        (lambda: reader.ticks("right", to_s=float("nan")), "to_s is NaN"),
        (lambda: reader.plot("right/nothing"), "has no channel"),
        (lambda: reader.plot("log"), "not named numbers"),
        (lambda: reader.attachment("nothing"), "has no attachment"),
    ]:
        with pytest.raises(ValueError, match=words) as caught:
            call()
        assert "\n" not in str(caught.value)
    with pytest.raises(OSError, match="none.mcap"):
        nima.Session(tmp_path / "none.mcap")
    (tmp_path / "foreign.mcap").write_bytes(b"no session at all")
    with pytest.raises(ValueError, match="foreign.mcap"):
        nima.Session(tmp_path / "foreign.mcap")


def test_a_session_that_was_cut_short_is_read_as_far_as_it_goes(session, tmp_path):
    cut = tmp_path / "cut.mcap"
    data = session.read_bytes()
    cut.write_bytes(data[: len(data) // 2])
    reader = nima.Session(cut)
    with pytest.warns(UserWarning, match="cut.mcap: .*was not closed"):
        ticks = reader.ticks("right")
    assert any("was not closed" in note for note in reader.notes) and 100 < len(ticks.t_s) < 2900
    with warnings.catch_warnings():
        # Only the first read warns.
        warnings.simplefilter("error")
        reader.events()
        nima.Session(session).ticks("right")
    with pytest.warns(UserWarning, match="cut.mcap: .*was not closed"):
        assert reader.recording("right").notes == reader.notes
    random = np.random.default_rng(1)
    for _ in range(40):
        broken = bytearray(data)
        for at in random.integers(0, len(data), 20):
            broken[at] ^= int(random.integers(1, 256))
        cut.write_bytes(broken)
        try:
            reader = nima.Session(cut)
            reader.ticks("right")
            reader.events()
        except (ValueError, OSError):
            pass
