"""The example client of the OpenIGTLink library in C++ (Debian's packages libopenigtlink-dev and openigtlink-examples) reads what a running loop sends.
`NIMA_OPENIGTLINK` names a folder that holds them instead of the system's root."""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile

from harness import Peer
from peer_igtl import started

ROOT = pathlib.Path(os.environ.get("NIMA_OPENIGTLINK", "/"))
INCLUDE = ROOT / "usr/include/openigtlink"
EXAMPLE = ROOT / "usr/share/doc/openigtlink-examples/examples/Receiver/ReceiveClient.cxx"
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"


def run(nima):
    peer = Peer("OpenIGTLink 1.11 in C++ (ReceiveClient)")
    compiler = shutil.which("g++")
    if not (compiler and INCLUDE.is_dir() and EXAMPLE.is_file()):
        peer.skip("g++, libopenigtlink-dev or openigtlink-examples is not installed: ./dev bridges installs them")
        return [peer]
    library = next(one for where in ("", "*/") for one in (ROOT / "usr/lib").glob(f"{where}libOpenIGTLink.so")).parent
    with tempfile.TemporaryDirectory() as folder:
        client = pathlib.Path(folder) / "ReceiveClient"
        subprocess.run([compiler, EXAMPLE, "-I", INCLUDE, "-L", library, "-lOpenIGTLink", "-lpthread", "-o", client], check=True)
        process, host, port = started([nima, "run", "--igtl", "127.0.0.1:0", "--scene", "bimanual", "--seconds", "6"])
        # It ends when the server does, and prints what it has read with a right checksum.
        environment = os.environ | {"LD_LIBRARY_PATH": str(library)}
        ran = subprocess.run([client, host, str(port)], capture_output=True, text=True, timeout=60, env=environment)
        told = ran.stderr + ran.stdout
        peer.check("the run ends well", process.wait() == 0, process.returncode)
    for kind, least in {"TRANSFORM": 400, "TDATA": 100, "STATUS": 4, "STRING": 100}.items():
        count = told.count(f"Receiving {kind}")
        peer.check(f"{kind} comes", count >= least, (count, told[:2000]))
    peer.check("SENSOR is ignored", told.count("Receiving : SENSOR") >= 400)
    peer.check("states", " Error Name: Engaged" in told, told[:2000])
    names = set(re.findall(r"Name *: (\S+)", told))
    peer.check("names of tools", {"right.tip", "left.tip", "right.leader", "left.leader"} <= names, names)
    peer.check("types of tools", {"3", "4"} <= set(re.findall(r"Type *: (\d+)", told)))
    # The last column of a matrix: millimetres within the workspace, and not all the same.
    row = re.compile(r"^\s*" + r",?\s+".join([NUMBER] * 4) + r",?\s*$", re.MULTILINE)
    places = [float(numbers[3]) for numbers in row.findall(told)]
    peer.check("places in millimetres", len(set(places)) > 100 and all(abs(place) < 300 for place in places), places[:12])
    return [peer]
