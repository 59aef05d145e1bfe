"""Archives and lists of parts whose bytes depend on what is in them alone: `release/make` calls it."""

import gzip
import json
import os
import sys
import tarfile
import time
import zipfile
from pathlib import Path


def archive(folder: Path, out: Path) -> None:
    """Packs a folder as a .tar.gz or a .zip, in the order of the names, all of one time and of nobody."""
    moment = int(os.environ["SOURCE_DATE_EPOCH"])
    paths = sorted((path for path in folder.rglob("*") if path.is_file()), key=lambda path: path.as_posix())
    names = [f"{folder.name}/{path.relative_to(folder).as_posix()}" for path in paths]
    modes = [0o755 if os.access(path, os.X_OK) else 0o644 for path in paths]
    if out.suffix == ".zip":
        with zipfile.ZipFile(out, "w") as file:
            for path, name, mode in zip(paths, names, modes):
                entry = zipfile.ZipInfo(name, time.gmtime(moment)[:6])
                entry.create_system, entry.external_attr = 3, (0o100000 | mode) << 16
                file.writestr(entry, path.read_bytes(), zipfile.ZIP_DEFLATED, 9)
        return
    with open(out, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=moment) as packed, tarfile.open(fileobj=packed, mode="w|") as file:
        for path, name, mode in zip(paths, names, modes):
            entry = tarfile.TarInfo(name)
            entry.size, entry.mode, entry.mtime = path.stat().st_size, mode, moment
            with open(path, "rb") as content:
                file.addfile(entry, content)


def parts(made: Path, out: Path) -> None:
    """A list of parts without the time and the random number of its making, and without the folder of the build."""
    document = json.loads(made.read_text())
    document.pop("serialNumber", None)
    document["metadata"].pop("timestamp", None)
    text = json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False)
    out.write_text(text.replace(f"file://{os.getcwd()}", "file:///stead") + "\n")


if __name__ == "__main__":
    {"archive": archive, "parts": parts}[sys.argv[1]](Path(sys.argv[2]), Path(sys.argv[3]))
