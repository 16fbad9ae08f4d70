"""Poses, forces and states of a running loop, over OpenIGTLink (``nima run --igtl``, ``nima console --igtl``)."""

from __future__ import annotations

import json
import socket
import struct
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Iterator

import numpy as np

from ._arrays import Floats

#: The protocol's usual port.
PORT = 18944

# Version, type, device, time (seconds and their 2^-32 parts since 1970), size of the body and its check, all big-endian.
_HEADER = struct.Struct(">H12s20sIIQQ")
# Larger than any message of the program except images, which are not requested.
_LARGEST_BODY = 1 << 20


def _table() -> list[int]:
    table = []
    for value in range(256):
        check = value << 56
        for _ in range(8):
            check = (check << 1) ^ 0x42F0E1EBA9EA3693 if check >> 63 else check << 1
            check &= 0xFFFF_FFFF_FFFF_FFFF
        table.append(check)
    return table


_TABLE = _table()


def _crc64(data: bytes) -> int:
    """CRC-64 of ECMA-182, from 0, not reflected."""
    check = 0
    for byte in data:
        check = ((check << 8) & 0xFFFF_FFFF_FFFF_FFFF) ^ _TABLE[(check >> 56) ^ byte]
    return check


def _request(kind: bytes, body: bytes = b"") -> bytes:
    return _HEADER.pack(1, kind, b"nima", 0, 0, len(body), _crc64(body)) + body


@dataclass(frozen=True)
class ArmNow:
    """An arm in one tick; frame ``world``. Unknown numbers are NaN."""

    state: str
    """State: ``Engaged``, ``Fault`` ..."""
    tip_m: Floats
    """Position of the instrument's tip, shape (3,), m."""
    leader_m: Floats
    """Commanded position of the tip, shape (3,), m."""
    measured_n: Floats
    """Force of the tissue on the tip, shape (3,), N; NaN while it is unknown."""
    rendered_n: Floats
    """Force on the hand after all gates, shape (3,), N."""


@dataclass(frozen=True)
class Now:
    """One tick of a running loop."""

    t_s: float
    """Time since the run began, s."""
    time_ns: int
    """Time of the tick, ns since 1970 (UTC), within 1 ns of the time in the session file of the same run."""
    arms: dict[str, ArmNow]
    """Arms by side: ``right``, ``left``; an arm whose devices are missing is omitted."""


class Watching:
    """The newest ticks of a running loop, one after the other; ends when the program does.

    Nothing that it sends reaches the loop. A slow reader receives fewer ticks, always the newest.

    >>> with nima.watch("127.0.0.1:18944") as watching:  # doctest: +SKIP
    ...     for now in watching:
    ...         print(now.t_s, now.arms["right"].measured_n)
    """

    def __init__(self, address: str = f"127.0.0.1:{PORT}", rate_hz: float = 60.0, timeout_s: float = 5.0) -> None:
        if not 1.0 <= rate_hz <= 100.0:
            raise ValueError(f"rate_hz is {rate_hz}: give 1 to 100 ticks a second")
        host, _, port = address.rpartition(":")
        if not host or not port.isdigit():
            raise ValueError(f'address is "{address}": give HOST:PORT, as the program prints it')
        self._address = address
        self._buffer = bytearray()
        try:
            self._line = socket.create_connection((host.strip("[]"), int(port)), timeout_s)
        except OSError as error:
            reason = error.strerror or str(error)
            raise ConnectionError(f"{address}: {reason}; start the program there with --igtl") from error
        self._line.settimeout(timeout_s)
        # The JSON message contains everything, each number with all of its digits.
        for kind in (b"STP_TRANS", b"STP_TDATA", b"STP_SENSOR"):
            self._line.sendall(_request(kind))
        self._line.sendall(_request(b"STT_STRING"))
        self._line.sendall(_request(b"STT_TDATA", struct.pack(">I32s", round(1000.0 / rate_hz), b"")))
        self._line.sendall(_request(b"STP_TDATA"))

    def __enter__(self) -> Watching:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection."""
        self._line.close()

    def __iter__(self) -> Iterator[Now]:
        while True:
            message = self._message()
            if message is None:
                return
            kind, device, stamp, body = message
            if device == b"nima" and kind == b"STRING":
                yield _now(stamp, json.loads(body[4:]))

    def _message(self) -> tuple[bytes, bytes, tuple[int, int], bytes] | None:
        head = self._take(_HEADER.size)
        if head is None:
            return None
        _, kind, device, seconds, parts, size, check = _HEADER.unpack(head)
        if size > _LARGEST_BODY:
            raise ConnectionError(f"{self._address}: received {size} bytes in one message, more than this program sends")
        body = self._take(size)
        if body is None:
            return None
        kind, device = kind.rstrip(b"\0"), device.rstrip(b"\0")
        if kind == b"STRING" and _crc64(body) != check:
            raise ConnectionError(f"{self._address}: received a damaged message (checksum)")
        return kind, device, (seconds, parts), body

    def _take(self, size: int) -> bytes | None:
        """Returns this many bytes; ``None`` if the program has ended."""
        while len(self._buffer) < size:
            try:
                more = self._line.recv(1 << 16)
            except socket.timeout as error:
                waited_s = self._line.gettimeout()
                raise TimeoutError(f"{self._address}: received nothing for {waited_s:g} s") from error
            except ConnectionResetError:
                more = b""
            if not more:
                return None
            self._buffer += more
        taken = bytes(self._buffer[:size])
        del self._buffer[:size]
        return taken


def _now(stamp: tuple[int, int], told: dict[str, Any]) -> Now:
    def vector(of: dict[str, Any], key: str, unit: float) -> Floats:
        numbers = of.get(key) or [None] * 3
        return np.array([np.nan if number is None else number for number in numbers], dtype=np.float64) * unit

    arms = {
        side: ArmNow(
            state=of["state"],
            tip_m=vector(of, "tip_mm", 1e-3),
            leader_m=vector(of, "leader_mm", 1e-3),
            measured_n=vector(of, "measured_n", 1.0),
            rendered_n=vector(of, "rendered_n", 1.0),
        )
        for side, of in told.items()
        if isinstance(of, dict)
    }
    return Now(t_s=told["t_s"], time_ns=stamp[0] * 10**9 + ((stamp[1] * 10**9 + (1 << 31)) >> 32), arms=arms)


def watch(address: str = f"127.0.0.1:{PORT}", rate_hz: float = 60.0, timeout_s: float = 5.0) -> Watching:
    """Watch a loop that was started with ``--igtl``.

    ``address`` is printed by the program; ``rate_hz`` is 1 to 100 ticks a second. Raises :class:`TimeoutError` if nothing
    arrives for ``timeout_s`` (during a trial of a blind study, or while no loop runs), and :class:`ConnectionError` if no
    program listens at the address.
    """
    return Watching(address, rate_hz, timeout_s)
