"""The parts of models."""

from __future__ import annotations

from dataclasses import dataclass, field

from rayweave._core import Solid


@dataclass(frozen=True)
class Region:
    """A solid made of a medium, as part of a model."""

    name: str
    """Its name."""
    solid: Solid
    """The space that it occupies, except where a later region has priority."""
    medium: str
    """The name of its medium."""
    colour: str
    """Its colour in pictures, as ``#rrggbb`` or ``#rrggbbaa``."""


@dataclass(frozen=True)
class Medium:
    """A material of regions."""

    name: str
    """Its name."""
    index: float | None = None
    """Its refractive index, if it is known."""
    colour: str | None = None
    """The colour of regions made of it."""
    numbers: dict[str, float] = field(default_factory=dict)
    """Further numbers that the file states for it."""
