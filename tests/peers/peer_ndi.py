"""ndicapi and scikit-surgerynditracker against the emulated NDI tracker, over TCP and a pseudo-terminal, `TX` and `BX`."""

import math
import os
import pathlib
import tempfile
import time

from harness import Emulator, Peer

TEXT_FIRMWARE, BLOCK_FIRMWARE = "Polaris Vega 008", "Polaris Vega 014"
FRAME_HZ = 60.0


def wandering(unit_s, number):
    """The emulator's own motion: quaternion (scalar first), place in mm."""
    turn = 0.5 * unit_s + number
    place = (
        -0.3 + 0.2 * number + 0.05 * math.cos(turn),
        0.05 * math.sin(turn),
        -1.5 + 0.05 * math.sin(0.5 * turn),
    )
    roll, pitch, yaw = 0.2 * math.sin(turn), 0.2 * math.cos(turn), 0.3 * math.sin(0.7 * turn)
    cr, sr, cp, sp = math.cos(roll / 2), math.sin(roll / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    q = (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )
    return q, [1000.0 * x for x in place]


def definitions(folder):
    paths = []
    for number in range(2):
        path = pathlib.Path(folder) / f"tool{number}.rom"
        path.write_bytes(b"NDI\0" + bytes(588) + b"TOOL%d" % number + bytes(154))
        paths.append(str(path))
    return paths


def readable(frame):
    """ndicapi joins the bytes of a BX frame number as signed ones: only numbers without a high bit come out right."""
    return 0 < frame < 1 << 15


def check_pose(peer, what, got, frame, number):
    q, place = wandering(frame / FRAME_HZ, number)
    for k in range(4):
        peer.near(f"{what} q{k}", got[k], q[k], 1e-4)
    for k in range(3):
        peer.near(f"{what} t{k}", got[4 + k], place[k], 0.011)
    peer.near(f"{what} error", got[7], 0.15, 1e-4)


def track(ndicapy, peer, device, form, handles):
    """Reads frames with valid numbers; tool 0 is seen, tool 1 is missing, tool 2 was never enabled."""
    get = {name: getattr(ndicapy, f"ndiGet{form}{name}") for name in ("Transform", "Frame", "PortStatus", "SystemStatus")}
    frames = []
    end = time.time() + 5
    while len(frames) < 5 and time.time() < end:
        ndicapy.ndiCommand(device, f"{form}:0801")
        frame = get["Frame"](device, handles[0])
        if readable(frame) and frame not in frames:
            frames.append(frame)
            check_pose(peer, f"{form} tool", get["Transform"](device, handles[0]), frame, 0)
            peer.check(f"{form} port status", get["PortStatus"](device, handles[0]) == 0x31, frame)
            peer.check(f"{form} missing", get["Transform"](device, handles[1]) == "MISSING")
            peer.check(f"{form} disabled", get["Transform"](device, handles[2]) == "DISABLED")
            peer.check(f"{form} system status", get["SystemStatus"](device) == 0)
        time.sleep(0.004)
    peer.check(f"{form} frames count up", len(frames) == 5 and frames == sorted(frames), frames)


def set_up(ndicapy, peer, device, roms):
    command = lambda text: ndicapy.ndiCommand(device, text)
    peer.check("VER:0", f"Freeze Tag: {BLOCK_FIRMWARE}" in command("VER:0"))
    peer.check("APIREV", command("APIREV:") == "G.003.004")
    peer.check("BEEP", command("BEEP:2") == "1")
    peer.check("a command without a checksum", command("ECHO good morning") == "good morning")
    handles = []
    for rom in roms + roms[:1]:
        command("PHRQ:*********1****")
        handle = ndicapy.ndiGetPHRQHandle(device)
        ndicapy.ndiPVWRFromFile(device, handle, rom)
        peer.check("the definition is accepted", ndicapy.ndiGetError(device) == ndicapy.NDI_OKAY)
        command(f"PINIT:{handle:02X}")
        handles.append(handle)
    for handle in handles[:2]:
        command(f"PENA:{handle:02X}D")
    command("PHSR:04")
    listed = [ndicapy.ndiGetPHSRHandle(device, k) for k in range(ndicapy.ndiGetPHSRNumberOfHandles(device))]
    peer.check("PHSR:04", listed == handles[:2], listed)
    command("PHSR:03")
    peer.check("PHSR:03", ndicapy.ndiGetPHSRHandle(device, 0) == handles[2])
    peer.check("PHINF part number", command(f"PHINF:{handles[1]:02X}0004").startswith("TOOL1"))
    return [bytes([handle]) for handle in handles]


def refused(ndicapy, peer, device, text, code):
    try:
        ndicapy.ndiCommand(device, text)
    except OSError as error:
        peer.check(f"{text} is refused", f"0x{code:02x}" in str(error), str(error))
        return
    peer.check(f"{text} is refused", False)


def converse(ndicapy, peer, device, roms):
    ndicapy.ndiCommand(device, "INIT:")
    refused(ndicapy, peer, device, "TX:0801", 0x0C)
    refused(ndicapy, peer, device, "PINIT:0A", 0x08)
    refused(ndicapy, peer, device, "FOO:", 0x01)
    handles = set_up(ndicapy, peer, device, roms)
    ndicapy.ndiCommand(device, "TSTART:")
    refused(ndicapy, peer, device, "PHRQ:*********1****", 0x0C)
    track(ndicapy, peer, device, "TX", handles)
    track(ndicapy, peer, device, "BX", handles)
    ndicapy.ndiCommand(device, "TSTOP:")
    # Not with BX: ndicapi reads the checksum of a refused BX as a binary one, and falls over it.
    refused(ndicapy, peer, device, "TX:0801", 0x0C)


def run_ndicapi(nima, roms):
    import ndicapy

    settings = ["--set", f"firmware={BLOCK_FIRMWARE}", "--set", "missing=1"]
    network = Peer("ndicapi over TCP")
    with Emulator(nima, "ndi", *settings) as emulator:
        host, port = emulator.endpoint.rsplit(":", 1)
        device = ndicapy.ndiOpenNetwork(host, int(port))
        converse(ndicapy, network, device, roms)
        ndicapy.ndiCloseNetwork(device)
    line = Peer("ndicapi over a serial line")
    with Emulator(nima, "ndi-serial", *settings) as emulator:
        line.check("ndiProbe", ndicapy.ndiProbe(emulator.endpoint) == ndicapy.NDI_OKAY)
        device = ndicapy.ndiOpen(emulator.endpoint)
        ndicapy.ndiCommand(device, "INIT:")
        ndicapy.ndiCommand(device, "COMM:50000")
        converse(ndicapy, line, device, roms)
        ndicapy.ndiClose(device)
        time.sleep(0.5)
        line.check("ndiProbe again", ndicapy.ndiProbe(emulator.endpoint) == ndicapy.NDI_OKAY)
    return [network, line]


def run_scikit(nima, folder, roms, device, firmware):
    from sksurgerynditracker.nditracker import NDITracker

    peer = Peer(f"scikit-surgerynditracker, {device}, {firmware}")
    with Emulator(nima, device, "--set", f"firmware={firmware}", "--set", "missing=1") as emulator:
        if device == "ndi":
            # It asks `ping` first, which a machine without rights for it does not have.
            stub = pathlib.Path(folder) / "ping"
            stub.write_text("#!/bin/sh\nexit 0\n")
            stub.chmod(0o755)
            os.environ["PATH"] = f"{folder}:{os.environ['PATH']}"
            host, port = emulator.endpoint.rsplit(":", 1)
            where = {"tracker type": "vega", "ip address": host, "port": int(port)}
        else:
            where = {"tracker type": "polaris", "serial port": emulator.endpoint}
        tracker = NDITracker({**where, "romfiles": roms, "use quaternions": True})
        peer.check("the reply format fits the firmware", tracker._capture_string[:2] == ("TX" if firmware == TEXT_FIRMWARE else "BX"))
        tracker.start_tracking()
        checked, end = 0, time.time() + 5
        while checked < 5 and time.time() < end:
            _, _, frames, poses, quality = tracker.get_frame()
            if readable(frames[0]):
                checked += 1
                check_pose(peer, "tool", [*poses[0][0], quality[0]], frames[0], 0)
                peer.check("a missing tool", all(math.isnan(x) for x in poses[1][0]), poses[1])
            time.sleep(0.02)
        peer.check("frames", checked == 5, checked)
        tracker.stop_tracking()
        tracker.close()
    return peer


def run(nima):
    with tempfile.TemporaryDirectory() as folder:
        roms = definitions(folder)
        peers = run_ndicapi(nima, roms)
        for device in ("ndi", "ndi-serial"):
            for firmware in (TEXT_FIRMWARE, BLOCK_FIRMWARE):
                peers.append(run_scikit(nima, folder, roms, device, firmware))
    return peers
