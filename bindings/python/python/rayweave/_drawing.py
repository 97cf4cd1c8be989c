"""Drawings as SVG."""

from __future__ import annotations

import sys
import tempfile
import webbrowser
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from rayweave import _core
from rayweave._files import write_file


def show(picture: Any, data: bytes, ending: str) -> None:
    """Shows a picture in the notebook, or the data of its file in the browser."""
    shell = sys.modules.get("IPython")
    if shell is not None and type(shell.get_ipython()).__name__ == "ZMQInteractiveShell":
        sys.modules["IPython.display"].display(picture)
        return
    # the browser reads the file later, so that it cannot be removed here
    with tempfile.NamedTemporaryFile(prefix="rayweave-", suffix=ending, delete=False) as file:
        file.write(data)
    webbrowser.open(Path(file.name).as_uri())


@dataclass(frozen=True, repr=False)
class Drawing:
    """A drawing; a notebook shows it.

    >>> import rayweave as rw
    >>> drawing = rw.ray_timeline(rw.box(2), [-3, 0, 0], [1, 0, 0])
    >>> drawing.save("ray.svg")
    >>> drawing.svg[:4]
    '<svg'
    """

    svg: str
    """The drawing as SVG."""

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the drawing to a file (.svg)."""
        ending = Path(path).suffix.lower()
        if ending != ".svg":
            advice = "Save it as .svg."
            if ending in (".png", ".pdf", ".jpg", ".jpeg"):
                advice = f"Save it as .svg and convert it; the commands of `rayweave` that draw also write {ending}."
            raise _core.RayweaveError(
                f"cannot write {path}: Python writes drawings as .svg, not as '{ending}'. {advice}"
            )
        write_file(path, self.svg)

    def show(self) -> None:
        """Shows the drawing: in a notebook below the cell, otherwise in the browser."""
        show(self, self.svg.encode(), ".svg")

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: SVG of {len(self.svg)} characters>"

    def _repr_svg_(self) -> str:
        return self.svg
