"""Third-party clients against this program: `python run.py NIMA_BINARY [NAME]`, all of them or one. Fails at the first check that does not hold.

Every module `peer_*.py` in this folder has `run(nima) -> [Peer, ...]`.
"""

import importlib
import pathlib
import sys


def main(nima, name="*"):
    here = pathlib.Path(__file__).parent
    sys.path.insert(0, str(here))
    peers = []
    for module in sorted(here.glob(f"peer_{name}.py")):
        peers += importlib.import_module(module.stem).run(nima)
    for peer in peers:
        print(f"peer {peer.name}: " + (f"SKIPPED, {peer.skipped}" if peer.skipped else f"{peer.passed} checks"))
    ran = [peer for peer in peers if not peer.skipped]
    print(f"{len(ran)} of {len(peers)} peers, {sum(peer.passed for peer in ran)} checks passed")


if __name__ == "__main__":
    main(*sys.argv[1:])
