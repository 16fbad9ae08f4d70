"""pylsl hears the marks of a running loop over the Lab Streaming Layer, with stamps that fit what is recorded."""

import os
import pathlib
import subprocess
import tempfile

from harness import Peer

# Only this computer: no packets on a network.
SETTINGS = "[multicast]\nResolveScope = machine\n[lab]\nKnownPeers = {127.0.0.1}\n"
CONTACT_N = 0.2


def contacts(path):
    """Times (s) of contacts of the right arm in a session, by the rule of the marks."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory as Ros2

    found, touches = [], False
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[Ros2()])
        for _, _, message, decoded in reader.iter_decoded_messages(topics=["right/forces"]):
            force = sum(number * number for number in decoded.effort[:3]) ** 0.5
            now = force >= (CONTACT_N / 2 if touches else CONTACT_N)
            if now != touches:
                found.append((message.log_time * 1e-9, f"contact {'on' if now else 'off'} right"))
            touches = now
    return found


def run(nima):
    peer = Peer("pylsl (marks of a running loop)")
    with tempfile.TemporaryDirectory() as folder:
        settings = pathlib.Path(folder) / "lsl_api.cfg"
        settings.write_text(SETTINGS)
        os.environ["LSLAPICFG"] = str(settings)
        import pylsl

        library = next((pathlib.Path(pylsl.__file__).parent / "lib").glob("liblsl.so"))
        path = pathlib.Path(folder) / "lsl.mcap"
        command = [nima, "run", "--lsl", library, "--record", path, "--scene", "peg_transfer", "--seconds", "14"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        line = process.stderr.readline()
        while line and "Lab Streaming Layer" not in line:
            line = process.stderr.readline()
        peer.check("says what it sends", "stream NIMA, type Markers" in line, line)
        streams = pylsl.resolve_byprop("name", "NIMA", timeout=5)
        peer.check("one stream is found", len(streams) == 1, len(streams))
        info = streams[0]
        peer.check("texts at an irregular rate", (info.channel_format(), info.nominal_srate()) == (pylsl.cf_string, 0.0))
        inlet = pylsl.StreamInlet(info)
        inlet.open_stream(timeout=5)
        heard = []
        while process.poll() is None:
            sample, stamp = inlet.pull_sample(timeout=0.2)
            if sample:
                heard.append((sample[0], stamp, pylsl.local_clock() - stamp))
        peer.check("the run ends well", process.returncode == 0, process.returncode)
        truth = contacts(path)
    words = [what for what, _, _ in heard]
    touches = [(what, stamp) for what, stamp, _ in heard if what.startswith("contact")]
    peer.check("contacts are marked", len(touches) >= 4, words)
    # Those before the inlet was open are not heard again.
    truth = truth[len(truth) - len(touches) :]
    peer.check("the same contacts as recorded", [what for what, _ in touches] == [what for _, what in truth], (words, truth))
    offsets = [stamp - time_s for (_, stamp), (time_s, _) in zip(touches, truth)]
    spread = (max(offsets) - min(offsets)) * 1e3
    peer.check("stamps keep the recorded times within 1 ms", spread <= 1.0, offsets)
    ages = sorted(age for _, _, age in heard if age < 1.0)
    peer.check("no mark comes before its time", ages[0] > -1e-4, ages)
    print(f"pylsl: {len(heard)} marks, stamps within {spread:.3f} ms of the recorded times, heard {ages[0] * 1e3:.2f} to {ages[-1] * 1e3:.2f} ms after them")
    return [peer]
