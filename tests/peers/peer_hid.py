"""Third-party readers of six-axis caps against our emulators: pyspacemouse on the reports, libspnav on the daemon's socket."""

import ctypes
import ctypes.util
import os
import socket
import time

from harness import Emulator, Peer

HELD = {"x": 0.4, "y": -0.2, "z": 0.6, "rx": -0.5, "ry": 0.3, "rz": 1.0}
# One count is 1/350.
WITHIN = 0.002


def settings(**more):
    return [word for key, value in {**HELD, **more}.items() for word in ("--set", f"{key}={value}")]


class Node:
    """An open device for pyspacemouse that reads reports from the emulator's socket."""

    product_string, manufacturer_string, release_number, serial_number = "emulated", "", 0, ""

    def __init__(self, endpoint):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.settimeout(2)
        self.socket.connect(endpoint.removeprefix("emulated:"))
        self.hello = self.socket.recv(256).decode()
        self.lengths = set()

    def open(self):
        pass

    def close(self):
        self.socket.close()

    def read(self, count):
        report = self.socket.recv(64)
        self.lengths.add((report[0], len(report)))
        return report[:count]

    def write(self, report):
        self.socket.send(bytes(report))


def pyspacemouse_peer(nima, model, spec_name, ids, lengths):
    from pyspacemouse.config_helpers import apply_axis_convention
    from pyspacemouse.device import SpaceMouseDevice
    from pyspacemouse.loader import get_device_specs
    from pyspacemouse.types import AxisConvention

    peer = Peer(f"pyspacemouse 2.1.0 ({model})")
    spec = get_device_specs()[spec_name]
    peer.check("the ids are in the client's table", f"{spec.vendor_id:04x}:{spec.product_id:04x}" == ids, ids)
    with Emulator(nima, "spacemouse", "--set", f"model={model}", *settings()) as emulator:
        node = Node(emulator.endpoint)
        peer.check("the greeting names the ids", ids in node.hello, node.hello)
        device = SpaceMouseDevice(spec, node)
        device.open()
        begin, reads = time.monotonic(), 0
        while time.monotonic() - begin < 1.0:
            state = device.read()
            reads += 1
        peer.check("the lengths match the model", node.lengths == lengths, node.lengths)
        expected_hz = 125 if model == "split" else 62.5
        peer.check("the rate is the device's", 0.6 * expected_hz < reads < 1.3 * expected_hz, reads)
        # In its old convention: x, -y, -z of the device, pitch -Rx, roll -Ry, yaw +Rz, the device being turned half around x from us.
        peer.near("x", state.x, HELD["x"], WITHIN)
        peer.near("y", state.y, HELD["y"], WITHIN)
        peer.near("z", state.z, HELD["z"], WITHIN)
        peer.near("pitch", state.pitch, -HELD["rx"], WITHIN)
        peer.near("roll", state.roll, HELD["ry"], WITHIN)
        peer.near("yaw", state.yaw, -HELD["rz"], WITHIN)
        upright = SpaceMouseDevice(apply_axis_convention(spec, AxisConvention.HID_Z_UP), node)
        for _ in range(4):
            state = upright.read()
        for name, key in [("x", "x"), ("y", "y"), ("z", "z"), ("roll", "rx"), ("pitch", "ry"), ("yaw", "rz")]:
            peer.near(f"{name}, HID with z up", getattr(state, name), HELD[key], WITHIN)
        device.set_led(True)
        device.close()
    return peer


def buttons_peer(nima):
    """Without fixed axes the first button is pressed at the start of every cycle; a client that connects in time sees it."""
    from pyspacemouse.device import SpaceMouseDevice
    from pyspacemouse.loader import get_device_specs

    peer = Peer("pyspacemouse 2.1.0 (buttons)")
    with Emulator(nima, "spacemouse") as emulator:
        device = SpaceMouseDevice(get_device_specs()["SpaceNavigator"], Node(emulator.endpoint))
        device.open()
        seen, xs = set(), set()
        end = time.monotonic() + 9.5
        while time.monotonic() < end and len(seen) < 2:
            try:
                state = device.read()
            except TimeoutError:
                continue
            seen.add(tuple(state.buttons))
            xs.add(round(state.x, 3))
        peer.check("press and release are reported", (1, 0) in seen and (0, 0) in seen, seen)
        peer.check("the cap moves", len(xs) > 10, xs)
        device.close()
    return peer


class Motion(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int) for name in ("type", "x", "y", "z", "rx", "ry", "rz")] + [
        ("period", ctypes.c_uint),
        ("data", ctypes.c_void_p),
    ]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("motion", Motion), ("room", ctypes.c_byte * 128)]


def libspnav_peer(nima):
    peer = Peer("libspnav")
    library = ctypes.util.find_library("spnav")
    if not library:
        peer.skip("libspnav0 is not installed")
        return peer
    spnav = ctypes.CDLL(library)
    with Emulator(nima, "spacenavd", *settings()) as emulator:
        os.environ["SPNAV_SOCKET"] = emulator.endpoint.removeprefix("spacenavd:")
        peer.check("the client connects", spnav.spnav_open() != -1)
        event, count = Event(), 0
        end = time.monotonic() + 2
        while time.monotonic() < end and count < 20:
            if spnav.spnav_poll_event(ctypes.byref(event)) and event.type == 1:
                count += 1
            time.sleep(0.002)
        peer.check("motion arrives", count == 20, count)
        # The daemon's axes: x right, y up, z away.
        for name, key in [("x", "x"), ("y", "z"), ("z", "y"), ("rx", "rx"), ("ry", "rz"), ("rz", "ry")]:
            peer.near(name, getattr(event.motion, name) / 350, HELD[key], WITHIN)
        spnav.spnav_close()
    return peer


def run(nima):
    return [
        pyspacemouse_peer(nima, "split", "SpaceNavigator", "046d:c626", {(1, 7), (2, 7)}),
        pyspacemouse_peer(nima, "combined", "SpaceMouseWireless", "256f:c62e", {(1, 13)}),
        buttons_peer(nima),
        libspnav_peer(nima),
    ]
