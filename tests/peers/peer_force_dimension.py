"""The published Python binding `forcedimension-core` on the stand-in library, against `nima emulate force-dimension`.

The binding loads a library while it is imported, so each case runs in its own process: this file again, with the case's name.
"""

import ctypes
import json
import math
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

from harness import Emulator, Peer

NAME = "forcedimension-core 1.0.0"
SETTINGS = {
    "serial": 4711, "x_m": 0.01, "y_m": -0.02, "z_m": 0.03, "radius_m": 0,
    "yaw_rad": 0.5, "gripper_rad": 0.25, "stiffness_n_m": 500, "motor_limit_n": 10,
}


def library_beside(nima):
    folder = pathlib.Path(nima).resolve().parent
    name = {"linux": "libdrd.so", "darwin": "libdrd.dylib", "win32": "drd.dll"}[sys.platform]
    return next((path for path in (folder / name, folder / "deps" / name) if path.is_file()), None)


def sdk_with(library, folder):
    """Folders of an SDK, with the replacement library where the binding searches for it."""
    within = pathlib.Path(folder, "lib", "release", f"lin-{platform.machine()}-gcc")
    within.mkdir(parents=True)
    (within / "libdrd.so.3").symlink_to(library)
    return folder


def case(name, sdk, address):
    """Runs one case in a process; returns its checks as (what, good, got)."""
    environment = {**os.environ, "FDSDK": str(sdk)}
    environment.pop("NIMA_EMULATED_HANDLE", None)
    if address:
        environment["NIMA_EMULATED_HANDLE"] = address
    done = subprocess.run(
        [sys.executable, __file__, name], env=environment, stdout=subprocess.PIPE, text=True, timeout=60
    )
    if done.returncode != 0:
        sys.exit(f"peer {NAME}: the case {name} ended with {done.returncode}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def run(nima):
    peer = Peer(NAME)
    library = library_beside(nima)
    if sys.platform != "linux":
        peer.skip("the binding searches for the library elsewhere on this system")
        return [peer]
    if library is None:
        sys.exit(f"peer {NAME}: no libdrd next to {nima}; run cargo build --workspace")
    with tempfile.TemporaryDirectory() as folder:
        sdk = sdk_with(library, folder)
        told = case("no_device", sdk, None)
        still = [f"--set={key}={value}" for key, value in SETTINGS.items()]
        with Emulator(nima, "force-dimension", *still) as emulator:
            address, _, path = emulator.endpoint.partition(" library=")
            peer.check("the endpoint contains the library's path", pathlib.Path(path).is_file(), emulator.endpoint)
            told += case("still_hand", sdk, address)
            told += case("watchdog", sdk, address)
            emulator.fault("device-fault")
            told += case("device_fault", sdk, address)
            emulator.fault("silence")
            told += case("no_device", sdk, address)
            emulator.fault("none")
        with Emulator(nima, "force-dimension", "--set=left_handed=true") as emulator:
            told += case("moving_left_hand", sdk, emulator.endpoint.split()[0])
    for what, good, got in told:
        peer.check(what, good, got)
    return [peer]


# The code below runs in the processes of the cases.


def check(what, good, got=None):
    print(json.dumps([what, bool(good), repr(got)]))


def equal(what, got, expected):
    check(what, got == expected, (got, expected))


def near(what, got, expected, within):
    check(what, all(abs(a - b) <= within for a, b in zip(got, expected)), (list(got), expected))


def status_of(fd):
    status = fd.containers.Status()
    equal("status can be read", fd.dhd.getStatus(status), 0)
    return status


def no_device():
    import forcedimension_core as fd

    equal("no device is attached", fd.dhd.getDeviceCount(), 0)
    for what, result in [("open", fd.dhd.open()), ("drd open", fd.drd.open()), ("force", fd.dhd.setForce([0.0] * 3))]:
        equal(f"{what} fails", result, -1)
        equal(f"{what}: no device found", int(fd.dhd.errorGetLast()), 5)
    position = fd.containers.Vec3([7.0, 8.0, 9.0])
    equal("position fails", fd.dhd.direct.getPosition(position), -1)
    equal("outputs stay as they were", list(position), [7.0, 8.0, 9.0])
    equal("no buttons", fd.dhd.getButtonMask(), 0)
    equal("no frequency", fd.dhd.getComFreq(), -1.0)
    equal("no device chosen", fd.dhd.getDeviceID(), -1)
    equal("no limit", fd.dhd.getMaxForce(), -1.0)
    equal("text of the error", fd.dhd.errorGetStr(5), "no device found")


def still_hand():
    import forcedimension_core as fd

    dhd = fd.dhd
    equal("version of the SDK", tuple(dhd.getSDKVersion())[:3], (3, 17, 5))
    equal("one device", (dhd.getDeviceCount(), dhd.getAvailableCount()), (1, 1))
    equal("a wrong serial number", dhd.openSerial(1), -1)
    equal("open by serial number", dhd.openSerial(4711), 0)
    equal("the device is in use", (dhd.getDeviceCount(), dhd.getAvailableCount()), (1, 0))
    equal("serial number", dhd.getSerialNumber(), 4711)
    equal("type", int(dhd.getSystemType()), 35)
    equal("name", dhd.getSystemName(), "omega.7")
    parts = (dhd.hasBase(), dhd.hasWrist(), dhd.hasActiveWrist(), dhd.hasGripper(), dhd.hasActiveGripper())
    equal("features of the device", parts, (True, True, False, True, True))
    equal("for the right hand", dhd.isLeftHanded(), False)
    check("firmware", dhd.getVersion() >= 3.0, dhd.getVersion())
    reading(fd)
    force(fd)
    equal("a function that is not emulated fails", dhd.setVibration(10.0, 1.0), -1)
    equal("as not implemented", int(dhd.errorGetLast()), 10)
    equal("close", dhd.close(), 0)
    equal("the device is free again", dhd.getAvailableCount(), 1)
    equal("a closed device does not read", dhd.getPosition([0.0] * 3), -1)


def reading(fd):
    dhd = fd.dhd
    time.sleep(0.002)
    position, matrix = [0.0] * 3, [[0.0] * 3 for _ in range(3)]
    equal("position", dhd.getPosition(position), 0)
    near("position of the hand", position, [0.01, -0.02, 0.03], 1e-6)
    # A busy machine may put a pause between two calls.
    check("an immediate second reading is marked as repeated", any(int(dhd.getPosition(position)) == 1 for _ in range(50)))
    check("frame", dhd.getOrientationFrame(matrix) in (0, 1))
    c, s = math.cos(0.5), math.sin(0.5)
    near("rotation matrix about z, row by row", sum(map(list, matrix), []), [c, -s, 0, s, c, 0, 0, 0, 1], 1e-9)
    angles = [0.0] * 3
    check("angles", dhd.getOrientationRad(angles) in (0, 1))
    near("angles of the wrist", angles, [0.0, 0.0, 0.5], 1e-9)
    opening = ctypes.c_double()
    check("gripper", dhd.getGripperAngleRad(opening) in (0, 1))
    near("opening of the gripper", [opening.value], [0.25], 1e-9)
    for _ in range(5):
        dhd.getPosition(position)
        time.sleep(0.002)
    velocity = [1.0] * 3
    check("velocity", dhd.getLinearVelocity(velocity) in (0, 1))
    near("a still hand", velocity, [0.0] * 3, 1e-3)
    equal("no button", (dhd.getButton(0), dhd.getButtonMask()), (0, 0))


def push(fd, force, seconds):
    """Sets a force repeatedly; returns the last answer and the position of the hand after it."""
    answer, position, end = None, [0.0] * 3, time.monotonic() + seconds
    while time.monotonic() < end:
        answer = fd.dhd.setForceAndTorqueAndGripperForce(force, [0.0] * 3, 1.0)
        time.sleep(0.001)
    fd.dhd.getPosition(position)
    return int(answer), position


def force(fd):
    dhd = fd.dhd
    rest = [0.01, -0.02, 0.03]
    status = status_of(fd)
    equal("brakes before force", (status.brake, status.force), (1, 0))
    near("no force without enabling", push(fd, [2.0, 0.0, 0.0], 0.1)[1], rest, 1e-6)
    equal("enable", dhd.enableForce(True), 0)
    status = status_of(fd)
    equal("force is on", (status.brake, status.force, status.idle), (0, 1, 0))
    answer, position = push(fd, [2.0, 0.0, -1.0], 0.3)
    equal("the force is accepted", answer, 0)
    near("the hand yields to the force", position, [0.014, -0.02, 0.028], 1e-4)
    check("calls per millisecond", 0.05 < dhd.getComFreq() < 4.0, dhd.getComFreq())
    answer, position = push(fd, [0.0, 20.0, 0.0], 0.3)
    equal("motors saturate", answer, 2)
    near("position at ten newtons", position, [0.01, 0.0, 0.03], 1e-4)
    equal("the force limit is set", (dhd.setMaxForce(5.0), dhd.getMaxForce()), (0, 5.0))
    answer, position = push(fd, [0.0, 20.0, 0.0], 0.3)
    equal("within the limit nothing saturates", answer, 0)
    near("position at five newtons", position, [0.01, -0.01, 0.03], 1e-4)
    equal("stop", dhd.stop(), 0)
    status = status_of(fd)
    equal("brakes after stop", (status.brake, status.force), (1, 0))
    equal("free", dhd.setBrakes(False), 0)
    status = status_of(fd)
    equal("no current", (status.brake, status.idle), (0, 1))


def watchdog():
    import forcedimension_core as fd

    equal("drd opens too", fd.drd.open(), 0)
    equal("initialised", fd.drd.isInitialized(), True)
    equal("regulation is not emulated", (fd.drd.start(), int(fd.dhd.errorGetLast())), (-1, 10))
    equal("watchdog of 20 ms", fd.dhd.expert.setWatchdog(160), 0)
    equal("enable", fd.dhd.enableForce(True), 0)
    equal("the force is accepted", push(fd, [1.0, 0.0, 0.0], 0.1)[0], 0)
    time.sleep(0.06)
    status = status_of(fd)
    equal("the watchdog has switched the force off", (status.force, status.brake, status.forceoffcause), (0, 1, 3))
    equal("close", fd.drd.close(), 0)


def device_fault():
    import forcedimension_core as fd

    equal("open", fd.dhd.open(), 0)
    equal("the error is reported", status_of(fd).error, 1)
    equal("close", fd.dhd.close(), 0)


def moving_left_hand():
    import forcedimension_core as fd

    dhd = fd.dhd
    equal("open", dhd.open(), 0)
    equal("for the left hand", (dhd.isLeftHanded(), int(dhd.getSystemType())), (True, 37))
    opening, velocity, position = ctypes.c_double(), [0.0] * 3, [0.0] * 3
    track, end = [], time.monotonic() + 0.5
    while time.monotonic() < end:
        time.sleep(0.002)
        if dhd.getPosition(position) == 0:
            track.append((time.monotonic(), list(position)))
    (begin_s, first), (end_s, last) = track[-6], track[-1]
    check("velocity", dhd.getLinearVelocity(velocity) in (0, 1))
    slope = [(b - a) / (end_s - begin_s) for a, b in zip(first, last)]
    near("velocity is the slope of the position", velocity, slope, 5e-3)
    check("the hand moves", max(map(abs, velocity)) > 0.01, velocity)
    check("gripper", dhd.getGripperAngleRad(opening) in (0, 1))
    check("the angle is negative for the left hand", opening.value < 0.0, opening.value)
    equal("close", dhd.close(), 0)


if __name__ == "__main__":
    globals()[sys.argv[1]]()
