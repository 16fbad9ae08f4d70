"""Connects your own handle, arm or force sensor to NIMA Console: one datagram in each direction per period (protocol 1).

    device = Device(HANDLE, "127.0.0.1", 47200, product="my handle", serial="1")
    while True:                                  # about 1000 times a second
        command = device.exchange(handle(position_m=(x, y, z), on=command.on))
        ...                                      # execute it; it is off and zero while NIMA Console is silent

Requires only the standard library. Wire format and rules: docs/external-device.md. Licence: MIT OR Apache-2.0. Research use only.
"""

import socket
import struct
import time
import zlib
from os import urandom
from typing import NamedTuple

HANDLE, ARM, SENSOR = 1, 2, 3
ON, FAULT, THROTTLED, OVERRANGE, INVALID, RAW = (1 << bit for bit in range(6))
HAS_ORIENTATION, HAS_VELOCITY, HAS_GRIPPER, HAS_ACCELERATION, HAS_ANGULAR_VELOCITY = (1 << bit for bit in range(8, 13))
# Default number of an arm's joints.
JOINTS = 7
# The device switches off after this time without a command, s.
WATCHDOG_S = 0.020

_VERSION = 1
_HEADER = struct.Struct("<4sBBHIIQQIHHII")
_NAMES = struct.Struct("<24s16s")
_COMMANDS = {HANDLE: 4, SENSOR: 0}
_READINGS = {HANDLE: 11, SENSOR: 13}
_READS_MAX = 64


class Reading(NamedTuple):
    """Measurements of a device; created by `handle`, `arm` or `sensor`."""

    kind: int
    numbers: tuple
    status: int = 0
    fault: int = 0
    buttons: int = 0


class Command(NamedTuple):
    """Command to a device: all zero unless `on`."""

    heard: bool
    on: bool
    # Handle: force on the hand (x, y, z) and on the gripper, N. Arm: joint angles, rad.
    numbers: tuple
    round_trip_s: float

    @property
    def force_n(self):
        return self.numbers[:3]

    @property
    def target_rad(self):
        return self.numbers


def _bits(fault, **bits):
    return sum(bit for bit in bits.values() if bit) | (FAULT if fault else 0)


def handle(position_m, *, on, orientation_wxyz=None, velocity_m_s=None, gripper_rad=None, buttons=0, fault=0):
    """A handle's reading, m and m/s in its own frame. `on`: its force is on."""
    status = (on and ON) | _bits(
        fault,
        turn=orientation_wxyz is not None and HAS_ORIENTATION,
        speed=velocity_m_s is not None and HAS_VELOCITY,
        grip=gripper_rad is not None and HAS_GRIPPER,
    )
    numbers = (*position_m, *(orientation_wxyz or (0,) * 4), *(velocity_m_s or (0,) * 3), gripper_rad or 0.0)
    return Reading(HANDLE, numbers, status, fault, buttons)


def arm(joint_rad, *, on, joint_rad_s=None, joint_nm=None, fault=0):
    """An arm's reading; angles continue beyond a turn. `on`: it follows the commanded angles."""
    still = (0.0,) * len(joint_rad)
    return Reading(ARM, (*joint_rad, *(joint_rad_s or still), *(joint_nm or still)), (on and ON) | _bits(fault), fault)


def sensor(
    force_n, torque_nm=(0.0,) * 3, *, acceleration_m_s2=None, angular_velocity_rad_s=None, temperature_c=25.0, status=0, fault=0
):
    """A force sensor's reading, N and Nm in its own frame. `status`: THROTTLED, OVERRANGE, INVALID, RAW."""
    status |= _bits(
        fault,
        up=acceleration_m_s2 is not None and HAS_ACCELERATION,
        turn=angular_velocity_rad_s is not None and HAS_ANGULAR_VELOCITY,
    )
    inertial = (*(acceleration_m_s2 or (0,) * 3), *(angular_velocity_rad_s or (0,) * 3))
    return Reading(SENSOR, (*force_n, *torque_nm, *inertial, temperature_c), status, fault)


class Device:
    """One device; `joints` is 6 or 7 for an arm, and unused otherwise.

    Counts `sent` datagrams, `taken` commands, outdated or repeated ones (`stale`), `damaged` datagrams, and `silences`.
    """

    def __init__(self, kind, address, port, *, product, serial, joints=JOINTS):
        self.kind = kind
        self._names = _NAMES.pack(product.encode("ascii"), serial.encode("ascii"))
        commands = joints if kind == ARM else _COMMANDS[kind]
        self._reading = struct.Struct(f"<{3 * joints if kind == ARM else _READINGS[kind]}d")
        self._numbers = struct.Struct(f"<{commands}d")
        self._off = Command(False, False, (0.0,) * commands, -1.0)
        self._command = self._off
        self._session = int.from_bytes(urandom(4), "little")
        self._sequence = self._peer_sequence = self._peer_us = self._heard_us = 0
        self._watchdog_us = int(WATCHDOG_S * 1e6)
        self.sent = self.taken = self.stale = self.damaged = self.silences = 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        # From now on, only datagrams from this address are received.
        self._socket.connect((address, port))

    def exchange(self, reading):
        """Reads the received commands, sends this reading, and returns the newest command."""
        now_us = time.monotonic_ns() // 1000 + 1
        for _ in range(_READS_MAX):
            try:
                self._take(self._socket.recv(512), now_us)
            except BlockingIOError:
                break
            except OSError:
                break  # no program receives yet
        if self._command.heard and now_us - self._heard_us > self._watchdog_us:
            self.silences += 1
            self._peer_us, self._command = 0, self._off
        self._send(reading)
        return self._command

    def close(self):
        self._socket.close()

    def _send(self, reading):
        self._sequence = (self._sequence + 1) & 0xFFFFFFFF
        numbers = self._reading.pack(*reading.numbers)
        body = (
            _HEADER.pack(
                b"NIMX", _VERSION, self.kind, len(self._names) + len(numbers), self._session, self._sequence,
                time.monotonic_ns() // 1000 + 1, self._peer_us, int(WATCHDOG_S * 1e6), reading.status, reading.fault,
                reading.buttons, 0,
            )
            + self._names
            + numbers
        )
        try:
            self._socket.send(body + zlib.crc32(body).to_bytes(4, "little"))
            self.sent += 1
        except OSError:
            pass  # no program receives yet: the next datagram tries again

    def _take(self, wire, now_us):
        body = wire[:-4]
        if (
            len(wire) != _HEADER.size + self._numbers.size + 4
            or zlib.crc32(body) != int.from_bytes(wire[-4:], "little")
        ):
            self.damaged += 1
            return
        magic, version, kind, _, session, sequence, time_us, echo_us, watchdog_us, status, *_ = _HEADER.unpack_from(body)
        if magic != b"NIMX" or version != _VERSION or kind != 0x80 | self.kind:
            self.damaged += 1
            return
        ahead = (sequence - self._peer_sequence) & 0xFFFFFFFF
        # Refuse commands for another program, repeated or reordered commands, and answers to an outdated reading.
        if (
            session != self._session
            or (self._command.heard and not 0 < ahead < 0x80000000)
            or now_us - echo_us > self._watchdog_us
        ):
            self.stale += 1
            return
        self._peer_sequence, self._peer_us, self._heard_us = sequence, time_us, now_us
        self._watchdog_us = min(watchdog_us or self._watchdog_us, int(WATCHDOG_S * 1e6))
        on = bool(status & ON)
        numbers = self._numbers.unpack_from(body, _HEADER.size) if on else self._off.numbers
        self._command = Command(True, on, numbers, (now_us - echo_us) * 1e-6)
        self.taken += 1


def every(period_s, seconds=float("inf")):
    """Yields the time since the beginning, s, once per period; missed periods are skipped."""
    begin = due = time.monotonic()
    while (now := time.monotonic()) - begin < seconds:
        yield now - begin
        due += period_s
        while due <= time.monotonic():
            due += period_s
        time.sleep(max(0.0, due - time.monotonic()))
