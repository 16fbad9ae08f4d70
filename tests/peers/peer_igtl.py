"""pyigtl reads poses, forces and the endoscope image from a running loop over OpenIGTLink; its values must equal the recorded ones."""

import json
import pathlib
import socket
import statistics
import struct
import subprocess
import tempfile
import time

from harness import Emulator, Peer
from peer_endoscope import HEIGHT, WIDTH, time_code


def started(command):
    """The process, and the address where it listens."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    for line in process.stderr:
        if "OpenIGTLink at " in line:
            host, port = line.split("OpenIGTLink at ")[1].split(": connect")[0].rsplit(":", 1)
            return process, host, int(port)
    raise SystemExit(f"{command} ended before it listened")


def recorded(path):
    """Poses and forces of a session by side and time in ns."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory as Ros2

    found = {}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[Ros2()])
        topics = [f"{side}/{plot}" for side in ("right", "left") for plot in ("poses", "forces")]
        for _, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
            side, plot = channel.topic.split("/")
            numbers = dict(zip(decoded.name, decoded.position or decoded.effort))
            found.setdefault(message.log_time, {}).update(numbers)
    return found


def listen(host, port, seconds):
    """All that pyigtl receives, with the time of its arrival."""
    import pyigtl

    client = pyigtl.OpenIGTLinkClient(host, port)
    messages, end = [], time.time() + seconds
    while time.time() < end:
        messages += [(time.time(), message) for message in client.get_latest_messages()]
        time.sleep(0.002)
    client.stop()
    return messages


def loop_peer(nima, folder):
    peer = Peer("pyigtl (poses and forces of two arms, 60 Hz)")
    path = pathlib.Path(folder) / "igtl.mcap"
    command = [nima, "run", "--igtl", "127.0.0.1:0", "--record", path, "--scene", "bimanual", "--seconds", "12"]
    process, host, port = started(command)
    messages = listen(host, port, 8)
    peer.check("the run ends well", process.wait() == 0, process.returncode)
    truth = recorded(path)
    times = sorted(truth)

    def nearest(stamp_s):
        # The stamp of this protocol has a resolution of 0.23 ns, pyigtl's number one of 0.24 us.
        return min(times, key=lambda time_ns: abs(time_ns - stamp_s * 1e9))

    for side in ("right", "left"):
        for what in ("tip", "leader"):
            of = [one for _, one in messages if one.message_type == "TRANSFORM" and one.device_name == f"{side}.{what}"]
            peer.check(f"{side}.{what} comes", len(of) > 50, len(of))
            for one in of[::20]:
                row = truth[nearest(one.timestamp)]
                for axis in range(3):
                    metres = row[f"{side}.{what}." + "xyz"[axis] + "_m"]
                    peer.near(f"{side}.{what} in mm", one.matrix[axis, 3], metres * 1e3, abs(metres) * 1e-4 + 1e-4)
                turn = one.matrix[:3, :3]
                peer.check("a rotation", abs(turn.T @ turn - [[1, 0, 0], [0, 1, 0], [0, 0, 1]]).max() < 1e-5, turn)
    texts = [one for _, one in messages if one.message_type == "STRING" and one.device_name == "nima"]
    peer.check("forces come as text", len(texts) > 50, len(texts))
    told = [(one.timestamp, json.loads(one.string)) for one in texts]
    peer.check("the arms are engaged", told[-1][1]["right"]["state"] == "Engaged", told[-1])
    for stamp, one in told[::20]:
        row = truth[nearest(stamp)]
        for axis in range(3):
            name = "xyz"[axis] + "_n"
            peer.near("measured, N", one["right"]["measured_n"][axis], row[f"right.measured.{name}"], 1e-12)
            peer.near("rendered, N", one["left"]["rendered_n"][axis], row[f"left.rendered.{name}"], 1e-12)
    tips = [(at, one.timestamp) for at, one in messages if one.message_type == "TRANSFORM" and one.device_name == "right.tip"]
    between = [(second[1] - first[1]) * 1e3 for first, second in zip(tips, tips[1:])]
    peer.check("60 Hz, by the stamps", 16 <= statistics.median(between) <= 17.1, statistics.median(between))
    # The stamps' clock begins with the recording, a moment before the loop: lateness is counted from the least.
    ages = sorted(at - stamp for at, stamp in tips)
    late = [(age - ages[0]) * 1e3 for age in ages]
    p50, p99 = late[len(late) // 2], late[len(late) * 99 // 100]
    print(f"pyigtl: {len(tips)} poses in 8 s, later than the first of them by {p50:.1f} ms (p50), {p99:.1f} ms (p99)")
    return peer


def raw_peer(nima):
    peer = Peer("pyigtl's checksum (every kind of message)")
    from pyigtl.messages import CRC64

    process, host, port = started([nima, "run", "--igtl", "127.0.0.1:0", "--seconds", "5"])
    kinds = {}
    with socket.create_connection((host, port), timeout=10) as stream:
        file = stream.makefile("rb")
        # Version, type, device, seconds, fraction, length of the body, checksum.
        ask = struct.pack(">H12s20sIIQQ", 1, b"GET_CAPABIL", b"", 0, 0, 0, 0)
        stream.sendall(ask)
        for _ in range(200):
            version, kind, device, _, _, length, crc = struct.unpack(">H12s20sIIQQ", file.read(58))
            body = file.read(length)
            peer.check("checksum", CRC64(body) == crc and version == 1, (kind, device))
            kinds.setdefault(kind.rstrip(b"\0").decode(), []).append(body)
    expected = {"TRANSFORM", "TDATA", "SENSOR", "STRING", "STATUS", "CAPABILITY"}
    peer.check("kinds", set(kinds) == expected, sorted(kinds))
    peer.check("a sensor's length fits its values", all(len(body) == 10 + 8 * body[0] for body in kinds["SENSOR"]))
    peer.check("newton", all(body[2:10].hex() == "02c4000000000000" for body in kinds["SENSOR"]))
    peer.check("a bundle has whole tools", all(len(body) % 70 == 0 for body in kinds["TDATA"]))
    peer.check("the run ends well", process.wait() == 0, process.returncode)
    return peer


def picture_peer(nima, folder):
    peer = Peer("pyigtl (the endoscope image on request)")
    import pyigtl

    simulated = pathlib.Path(__file__).parent.parent.parent / "config" / "rigs" / "simulated.toml"
    rig = pathlib.Path(folder) / "rig.toml"
    with Emulator(nima, "endoscope", "--set", "port=0") as emulator:
        rig.write_text(simulated.read_text() + f'\n[endoscope]\nurl = "{emulator.endpoint}"\n')
        process, host, port = started([nima, "run", "--rig", rig, "--igtl", "127.0.0.1:0", "--seconds", "30"])
        client = pyigtl.OpenIGTLinkClient(host, port)
        images, end = [], time.time() + 25
        while len(images) < 3 and time.time() < end:
            if client.is_connected() and client.socket is not None:
                client.socket.sendall(struct.pack(">H12s20sIIQQ", 1, b"GET_IMAGE", b"", 0, 0, 0, 0))
            image = client.wait_for_message("endoscope", timeout=5)
            images += [image] if image is not None else []
        client.stop()
        process.terminate()
        process.wait()
    peer.check("pictures come", len(images) == 3, len(images))
    for image in images:
        peer.check("one slice in colours", image.image.shape == (1, HEIGHT, WIDTH, 3), image.image.shape)
        code = time_code(image.image[0].mean(axis=2).flatten())
        peer.check("the time code is sound", code is not None)
        # The stamp is the time of its arrival.
        peer.check("at the time of its arrival", -0.05 < image.timestamp - code * 1e-6 < 5, (image.timestamp, code))
    peer.check("each is another one", len({image.timestamp for image in images}) == 3)
    return peer


def run(nima):
    with tempfile.TemporaryDirectory() as folder:
        return [loop_peer(nima, folder), raw_peer(nima), picture_peer(nima, folder)]
