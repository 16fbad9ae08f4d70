"""Watching a running loop: the same as what it records."""

from __future__ import annotations

import socket

import numpy as np
import pytest

import nima


def test_ticks_are_those_of_the_session_and_end_with_the_program(running):
    process, address, path = running
    with nima.watch(address, rate_hz=100) as watching:
        seen = list(watching)
    assert process.wait(30) == 0
    assert len(seen) > 100
    session = nima.Session(path)
    for side in ("right", "left"):
        ticks = session.ticks(side)
        # By the loop's time: the mapping to UTC follows the drift of the clock.
        at = {round(t_s * 1e9): row for row, t_s in enumerate(ticks.t_s)}
        compared = 0
        for now in seen:
            row = at.get(round(now.t_s * 1e9))
            if row is None or side not in now.arms:
                continue
            compared += 1
            arm = now.arms[side]
            assert abs(now.time_ns - int(ticks.time_ns[row])) < 1_000_000
            for name in ("tip_m", "leader_m", "measured_n", "rendered_n"):
                np.testing.assert_allclose(getattr(arm, name), getattr(ticks, name)[row], rtol=1e-12, atol=1e-15)
            assert arm.state == ticks.state[row]
        assert compared > 0.9 * len(seen), (side, compared, len(seen))
    times_s = np.diff([now.t_s for now in seen])
    assert (times_s > 0).all()


def test_the_rate_is_the_one_that_was_asked_for(running):
    _, address, _ = running
    with nima.watch(address, rate_hz=20) as watching:
        times_s = [now.t_s for now, _ in zip(watching, range(40))]
    assert np.median(np.diff(times_s)) == pytest.approx(0.05, abs=0.012)


def test_nobody_silence_and_damage_are_told():
    with pytest.raises(ConnectionError, match="start the program there with --igtl"):
        nima.watch("127.0.0.1:9")
    for address in ("127.0.0.1", ":1", "127.0.0.1:x"):
        with pytest.raises(ValueError, match="HOST:PORT"):
            nima.watch(address)
    with pytest.raises(ValueError, match="1 to 100"):
        nima.watch(rate_hz=0.5)
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = "127.0.0.1:%d" % server.getsockname()[1]
        with nima.watch(address, timeout_s=0.1) as silent, pytest.raises(TimeoutError, match="received nothing"):
            next(iter(silent))
        server.accept()[0].close()
        text = b"\0\3\0\2{}"
        head = nima._watching._HEADER.pack(1, b"STRING", b"nima", 0, 0, len(text), 7)
        for sent, told in ((head + text, "checksum"), (head[:42] + b"\xff" * 16, "more than this program sends")):
            with nima.watch(address, timeout_s=5.0) as watching:
                line = server.accept()[0]
                line.sendall(sent)
                with pytest.raises(ConnectionError, match=told):
                    next(iter(watching))
                line.close()
