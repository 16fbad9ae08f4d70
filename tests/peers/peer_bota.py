"""The manufacturer's own client (`bota-driver`) against our emulated sensors, on all three transports.

Values are checked: the emulator's motion is a formula of its clock, and every frame contains the clock.
"""

import contextlib
import json
import math
import os
import socket
import tempfile

import bota_driver

from harness import Emulator, Peer

OFFSET = {"fx": 1.5, "fy": -2.25, "fz": 3.0, "tx": 0.25, "ty": -0.5, "tz": 0.125}
FRAMES = 200


@contextlib.contextmanager
def quiet():
    """Suppresses the line that the client's native code writes for every frame that it drops."""
    kept = [os.dup(stream) for stream in (1, 2)]
    with open(os.devnull, "w") as nowhere:
        for stream in (1, 2):
            os.dup2(nowhere.fileno(), stream)
    try:
        yield
    finally:
        for stream, copy in zip((1, 2), kept):
            os.dup2(copy, stream)
            os.close(copy)


def configuration(interface, parameters, operation):
    return {
        "driver_config": {
            "driver_version": "1.0",
            "product_name": "BFT-SENS-SER-M8",
            "serial_number": "SN000853",
            "communication_interface_name": interface,
            "communication_interface_params": parameters,
            "sensor_operation_params": {**operation, "wrench_offset": OFFSET},
            "driver_operation_params": {
                "runtime_verbosity": False,
                "register_with_daemon": False,
                "skip_metadata_reading": False,
            },
        }
    }


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def expected(t):
    """Force, torque, acceleration, angular rate and temperature of the emulator's slow motion at its time `t`."""
    turn = 2.0 * math.pi
    a, b = 0.5 * math.sin(turn * 0.10 * t), 0.3 * math.cos(turn * 0.07 * t)
    up = [math.sin(a) * math.cos(b), math.sin(b), math.cos(a) * math.cos(b)]
    acceleration = [9.80665 * x for x in up]
    weight = [-0.4 * x for x in acceleration]
    pull = [1.5 * math.sin(turn * 0.25 * t), math.cos(turn * 0.2 * t), 0.0]
    torque = [p + q for p, q in zip(cross([0.002, -0.001, 0.05], weight), cross([0.0, 0.0, 0.12], pull))]
    rate = [-0.3 * turn * 0.07 * math.sin(turn * 0.07 * t), 0.5 * turn * 0.10 * math.cos(turn * 0.10 * t), 0.0]
    force = [p + q + o for p, q, o in zip(weight, pull, list(OFFSET.values())[:3])]
    torque = [p + o for p, o in zip(torque, list(OFFSET.values())[3:])]
    return force, torque, acceleration, rate, 30.0 + 2.0 * math.sin(turn * 0.01 * t)


def check_frame(peer, frame, inertial):
    force, torque, acceleration, rate, temperature = expected(frame.timestamp * 1e-6)
    peer.check("status", frame.status.val == 0, frame.status.val)
    for name, got, wanted in [("force", frame.force, force), ("torque", frame.torque, torque)]:
        for axis in range(3):
            peer.near(f"{name} {axis}", got[axis], wanted[axis], 1e-4)
    for name, got, wanted in [("acceleration", frame.acceleration, acceleration), ("rate", frame.angular_rate, rate)]:
        for axis in range(3):
            peer.near(f"{name} {axis}", got[axis], wanted[axis] if inertial else 0.0, 1e-4)
    peer.near("temperature", frame.temperature, temperature, 1e-4)


def check_stream(peer, driver, emulator, hz, inertial):
    """Values, and time between frames: none missing, none twice."""
    times = []
    for k in range(FRAMES + 5):
        frame = driver.read_frame_blocking()
        if k >= 5:
            check_frame(peer, frame, inertial)
            times.append(frame.timestamp)
    steps = sorted(b - a for a, b in zip(times, times[1:]))
    # Its reader keeps the newest frame only, so a busy computer may skip some; most follow one another.
    peer.near("time between frames", steps[len(steps) // 2], 1e6 / hz, 2.0)
    peer.near("time between frames that the client expects", driver.get_expected_timestep_us(), 1e6 / hz, 2.0)
    emulator.fault("device-fault")
    flags = [driver.read_frame_blocking().status for _ in range(50)][-1]
    peer.check("the invalid flag is reported", flags.invalid and not flags.raw, flags.val)
    emulator.fault("bad-checksum")
    emulator.fault("none")
    for _ in range(20):
        frame = driver.read_frame_blocking()
    check_frame(peer, frame, inertial)


def session(name, device, interface, parameters, operation, hz, inertial):
    def run(nima):
        peer = Peer(name)
        with quiet(), Emulator(nima, device) as emulator, tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "bota.json")
            with open(path, "w") as file:
                json.dump(configuration(interface, parameters(emulator.endpoint), operation), file)
            driver = bota_driver.BotaDriver(path)
            peer.check("configures", driver.configure(), "configure")
            peer.check("activates", driver.activate(), "activate")
            check_stream(peer, driver, emulator, hz, inertial)
            peer.check("deactivates", driver.deactivate(), "deactivate")
            driver.shutdown()
        return peer

    return run


def run(nima):
    serial = lambda port: {"com_port": port, "baudrate": 460800}
    peers = [
        session("bota-driver gen0", "bota-gen0", "Bota_Binary_gen0", serial, {"sinc_length": 128}, 400, False)(nima),
        session(
            "bota-driver gen A, force and torque", "bota-gen-a", "Bota_Binary", serial, {"app_mode": 0, "app_submode": 11},
            1000, False,
        )(nima),
        session(
            "bota-driver gen A, inertial", "bota-gen-a", "Bota_Binary", serial, {"app_mode": 2, "app_submode": 8}, 400, True
        )(nima),
    ]
    name = "bota-driver socket"
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(("127.0.0.1", 23))
    except OSError as error:
        peer = Peer(name)
        peer.skip(f"the client insists on TCP port 23, which cannot be opened here ({error.strerror})")
        return [*peers, peer]
    address = lambda endpoint: {"sensor_ip_address": endpoint.split(":")[0]}
    operation = {"app_mode": 2, "app_submode": 10}
    return [*peers, session(name, "bota-socket", "Bota_Socket", address, operation, 800, True)(nima)]
