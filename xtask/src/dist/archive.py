"""Archives and checksums. The same files give the same bytes: entries are sorted, and without times, users and groups.

Usage: archive.py pack FOLDER ARCHIVE | unpack ARCHIVE FOLDER | sums FOLDER FILE | verify FOLDER FILE
"""

import gzip
import hashlib
import io
import sys
import tarfile
import zipfile
from pathlib import Path

# 1980-01-01, the first time that a ZIP archive can store
TIME = 315532800


def files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def mode(path: Path) -> int:
    return 0o755 if path.stat().st_mode & 0o100 else 0o644


def pack(folder: Path, archive: Path) -> None:
    """Packs a folder, with its own name as the first part of all paths."""
    names = [(path, path.relative_to(folder.parent).as_posix()) for path in files(folder)]
    if archive.suffix == ".zip":
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
            for path, name in names:
                entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.external_attr = mode(path) << 16
                packed.writestr(entry, path.read_bytes())
        return
    with (
        open(archive, "wb") as raw,
        gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=TIME) as stream,
        # the format that pip and `tar` read alike; PAX headers appear for long names only
        tarfile.open(fileobj=stream, mode="w", format=tarfile.PAX_FORMAT) as packed,
    ):
        for path, name in names:
            content = path.read_bytes()
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime, entry.mode = len(content), TIME, mode(path)
            packed.addfile(entry, io.BytesIO(content))


def unpack(archive: Path, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    if archive.name.endswith(".tar.gz"):
        with tarfile.open(archive) as packed:
            packed.extractall(folder, filter="data")
        return
    with zipfile.ZipFile(archive) as packed:
        for entry in packed.infolist():
            path = Path(packed.extract(entry, folder))
            if entry.external_attr >> 16 & 0o100:
                path.chmod(0o755)


def digests(folder: Path) -> str:
    """The SHA-256 of all files in the folder and below, in the form of `sha256sum`."""
    paths = [path for path in files(folder) if not path.name.startswith("SHA256SUMS")]
    entries = [(hashlib.sha256(path.read_bytes()).hexdigest(), path.relative_to(folder).as_posix()) for path in paths]
    return "".join(f"{digest}  {name}\n" for digest, name in entries)


def sums(folder: Path, target: Path) -> None:
    target.write_text(digests(folder), encoding="utf-8", newline="\n")


def verify(folder: Path, target: Path) -> None:
    if target.read_text(encoding="utf-8") != digests(folder):
        sys.exit(f"{target}: the checksums are not those of the files.")


if __name__ == "__main__":
    {"pack": pack, "unpack": unpack, "sums": sums, "verify": verify}[sys.argv[1]](*map(Path, sys.argv[2:]))
