"""The parts of models."""

from __future__ import annotations

from dataclasses import dataclass, field

from rayweave._core import Solid


@dataclass(frozen=True)
class Region:
    """A solid made of a medium, as part of a model."""

    name: str
    """What it is called."""
    solid: Solid
    """The space that it takes, except where a later region takes it."""
    medium: str
    """The name of its medium."""
    colour: str
    """Its colour in pictures, as ``#rrggbb`` or ``#rrggbbaa``."""


@dataclass(frozen=True)
class Medium:
    """What regions are made of."""

    name: str
    """What it is called."""
    index: float | None = None
    """Its refractive index, if it is known."""
    colour: str | None = None
    """The colour of regions made of it."""
    numbers: dict[str, float] = field(default_factory=dict)
    """What else the file says of it."""
