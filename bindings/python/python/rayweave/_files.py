"""Files that appear complete or not at all."""

from __future__ import annotations

import io
from os import PathLike, fspath
from typing import Any

from rayweave import _core


class AtomicFile(io.RawIOBase):
    """A binary file that appears at `finish`; without it, an existing file stays as it is. Symbolic links are followed."""

    def __init__(self, path: str | PathLike[str]) -> None:
        self._file = _core.AtomicFile(fspath(path))
        self._position = 0

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        octets = memoryview(data).tobytes()
        self._file.write(octets)
        self._position += len(octets)
        return len(octets)

    def tell(self) -> int:
        return self._position

    def finish(self) -> None:
        """Completes the file."""
        self._file.finish()

    def close(self) -> None:
        if not self.closed:
            self._file.discard()
        super().close()


def write_file(path: str | PathLike[str], data: bytes | str) -> None:
    """Writes a whole file; texts in UTF-8."""
    with AtomicFile(path) as file:
        file.write(data.encode() if isinstance(data, str) else data)
        file.finish()
