"""Third-party players of motion JPEG against our emulated endoscope: ffmpeg and GStreamer, where they are installed. The time code in the picture is
read here, from what the player decoded."""

import shutil
import subprocess
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


def run(nima):
    return [with_ffmpeg(nima), with_gstreamer(nima)]
