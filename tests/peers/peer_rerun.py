"""Rerun's own check of files in the format MCAP, over sessions: whole, long, cut out, anonymous, and of killed processes. It is a large package
(800 MB), so that it is not in requirements.txt but in requirements-large.txt: `./dev live` installs it. Without it this is left out."""

import os
import pathlib
import subprocess
import sys
import tempfile
import time

from harness import Peer

KILLED = 20


def check(rerun, home, path):
    """Exit status, and the status of each topic."""
    # Every timeline and every message is decoded. Rerun's usage reports are switched off.
    environment = dict(os.environ, HOME=str(home))
    subprocess.run([rerun, "analytics", "disable"], env=environment, check=True, capture_output=True)
    ran = subprocess.run([rerun, "mcap", "check", "--full", path], env=environment, capture_output=True, text=True)
    rows = [line.split() for line in ran.stdout.splitlines()]
    topics = {row[3].lstrip("/"): row[0] for row in rows if len(row) > 4 and row[2].isdigit()}
    return ran.returncode, topics, ran.stdout + ran.stderr


def run(nima):
    rerun = pathlib.Path(sys.executable).with_name("rerun")
    peer = Peer("rerun mcap check (sessions, finished and killed)")
    if not rerun.exists():
        return [peer.skip("rerun-sdk is not installed: ./dev live") or peer]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        whole, part, anonymous = folder / "whole.mcap", folder / "part.mcap", folder / "anonymous.mcap"
        record = [nima, "run", "--virtual", "--scene", "bimanual", "--seconds"]
        quiet = {"check": True, "stdout": subprocess.DEVNULL}
        subprocess.run([*record, "60", "--record", whole], **quiet)
        subprocess.run([nima, "export", whole, "--out", part, "--from", "20", "--to", "30"], **quiet)
        subprocess.run([nima, "export", whole, "--out", anonymous, "--anonymous"], **quiet)
        sessions = [whole, part, anonymous]
        for number in range(KILLED):
            path = folder / f"killed{number}.mcap"
            process = subprocess.Popen([*record, "3600", "--record", path], stdout=subprocess.DEVNULL)
            while not path.exists():
                time.sleep(0.001)
            time.sleep(0.1 + 0.07 * number)
            process.kill()
            process.wait()
            sessions.append(path)
        for path in sessions:
            status, topics, told = check(rerun, folder, path)
            peer.check(f"{path.stem}: accepted", status == 0, told)
            peer.check(f"{path.stem}: both arms are present", {"right/forces", "left/gates"} <= set(topics), told)
            for topic, found in topics.items():
                peer.check(f"{path.stem}: {topic}", found == "ok", told)
    return [peer]
