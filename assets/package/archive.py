#!/usr/bin/env python3
"""A zip file that is the same from the same files: `archive.py FOLDER FILE.zip SECONDS_SINCE_1970`."""

import sys
import time
import zipfile
from pathlib import Path

folder, out, epoch = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            entry = zipfile.ZipInfo(str(path.relative_to(folder.parent)), time.gmtime(epoch)[:6])
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, path.read_bytes())
