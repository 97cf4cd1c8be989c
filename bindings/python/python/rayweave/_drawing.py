"""Drawings as SVG."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path


@dataclass(frozen=True)
class Drawing:
    """A drawing; a notebook shows it."""

    svg: str
    """The drawing as SVG."""

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the drawing to a file (.svg)."""
        Path(path).write_text(self.svg, encoding="utf-8")

    def _repr_svg_(self) -> str:
        return self.svg
