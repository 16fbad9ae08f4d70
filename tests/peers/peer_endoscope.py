"""Third-party players of motion JPEG against our emulated endoscope: ffmpeg and GStreamer, where they are installed; and the libraries of MCAP with Pillow
against a session with its pictures. The time code in the image is read here, from the player's decoded output."""

import io
import json
import pathlib
import shutil
import subprocess
import tempfile
import time

from harness import Emulator, Peer

WIDTH, HEIGHT, SQUARE, FRAMES = 1280, 720, 16, 15


def check_bits(microseconds):
    rest = 0xFFF
    for bit in reversed(range(52)):
        high = (rest >> 11 & 1) ^ (microseconds >> bit & 1)
        rest = rest << 1 & 0xFFF
        if high:
            rest ^= 0x80F
    return rest


def time_code(grey):
    """Time in the picture, s since 1970; None where the check bits are wrong."""
    word = 0
    for place in range(64):
        x, y = SQUARE * (place % 32) + SQUARE // 2, SQUARE * (place // 32) + SQUARE // 2
        word = word << 1 | (grey[WIDTH * y + x] > 128)
    return word >> 12 if check_bits(word >> 12) == word & 0xFFF else None


def ffmpeg_binary():
    try:
        import imageio_ffmpeg

        return shutil.which("ffmpeg") or imageio_ffmpeg.get_ffmpeg_exe()
    except ImportError:
        return shutil.which("ffmpeg")


def with_ffmpeg(nima):
    peer = Peer("ffmpeg (motion JPEG of the endoscope)")
    ffmpeg = ffmpeg_binary()
    if not ffmpeg:
        peer.skip("ffmpeg is not installed")
        return peer
    with Emulator(nima, "endoscope", "--set", "port=0") as emulator:
        read = [ffmpeg, "-v", "error", "-f", "mpjpeg", "-i", emulator.endpoint]
        begin = time.time()
        ran = subprocess.run(
            [*read, "-frames:v", str(FRAMES), "-f", "rawvideo", "-pix_fmt", "gray", "-"],
            capture_output=True,
            timeout=120,
        )
        end = time.time()
    size = WIDTH * HEIGHT
    peer.check("all pictures", len(ran.stdout) == FRAMES * size, ran.stderr[-500:])
    codes = [time_code(ran.stdout[size * number : size * (number + 1)]) for number in range(FRAMES)]
    peer.check("every time code is sound", None not in codes, codes)
    peer.check("they rise", codes == sorted(set(codes)), codes)
    peer.check("they are of now", begin - 1 < codes[0] / 1e6 and codes[-1] / 1e6 <= end, (begin, codes, end))
    return peer


def with_gstreamer(nima):
    peer = Peer("GStreamer (motion JPEG of the endoscope)")
    launch = shutil.which("gst-launch-1.0")
    if not launch:
        peer.skip("gst-launch-1.0 is not installed")
        return peer
    with Emulator(nima, "endoscope", "--set", "port=0") as emulator:
        line = f"souphttpsrc location={emulator.endpoint} ! multipartdemux ! jpegdec ! identity eos-after={FRAMES} ! fakesink"
        ran = subprocess.run([launch, "-q", *line.split()], capture_output=True, timeout=120)
    peer.check("it plays", ran.returncode == 0, ran.stderr[-500:])
    return peer


def in_a_session(nima):
    """Every recorded picture is decoded, and its time code compared with the time of its message."""
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory
    from PIL import Image

    peer = Peer("mcap, mcap-protobuf-support, Pillow (pictures in a session)")
    simulated = pathlib.Path(__file__).parent.parent.parent / "config" / "rigs" / "simulated.toml"
    with tempfile.TemporaryDirectory() as folder:
        rig, path = pathlib.Path(folder) / "rig.toml", pathlib.Path(folder) / "session.mcap"
        with Emulator(nima, "endoscope", "--set", "port=0") as emulator:
            rig.write_text(simulated.read_text() + f'\n[endoscope]\nurl = "{emulator.endpoint}"\n')
            ran = subprocess.run(
                [nima, "run", "--rig", rig, "--seconds", "5", "--record", path, "--json"], capture_output=True, timeout=120
            )
        peer.check("it runs", ran.returncode == 0, ran.stderr[-500:])
        told = json.loads(ran.stdout)["recorded"]
        late, figures = [], []
        with open(path, "rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            for _, channel, message, picture in reader.iter_decoded_messages(topics=["endoscope/picture"]):
                peer.check("kind", picture.format == "jpeg" and picture.frame_id == "endoscope", picture.format)
                stamp = picture.timestamp.seconds * 10**9 + picture.timestamp.nanos
                peer.check("its stamp equals the message's time", stamp == message.log_time, (stamp, message.log_time))
                image = Image.open(io.BytesIO(picture.data))
                peer.check("size", image.size == (WIDTH, HEIGHT), image.size)
                code = time_code(image.convert("L").tobytes())
                peer.check("the time code is sound", code is not None)
                late.append(message.log_time * 1e-9 - code * 1e-6)
            for _, channel, message in reader.iter_messages(topics=["endoscope/figures"]):
                figures.append(json.loads(message.data))
    peer.check("there are some", len(late) > 30, len(late))
    peer.check("as many as the run says", told["pictures"] == len(late) == len(figures), (told, len(late), len(figures)))
    peer.check("numbered", [one["number"] for one in figures] == list(range(len(figures))))
    # The clock of a session begins a moment before its loop does, so a picture seems to come that much early; a busy machine makes it late.
    late.sort()
    peer.check("at the time of its arrival", -0.5 < late[0] and late[len(late) // 2] < 0.2, (late[0], late[-1]))
    return peer


def run(nima):
    return [with_ffmpeg(nima), with_gstreamer(nima), in_a_session(nima)]
