"""The parts of models."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from math import isfinite
from typing import TYPE_CHECKING, Any, TypeAlias

from rayweave import _core
from rayweave._core import Model, Solid
from rayweave._words import suggest_for, suggesting

if TYPE_CHECKING:
    from rayweave.optics._elements import Element


@dataclass(frozen=True)
class Region:
    """A solid made of a medium, as part of a model.

    >>> import rayweave as rw
    >>> rw.Region("ball", rw.sphere(1), medium="glass", colour="steelblue").medium
    'glass'
    """

    name: str
    """Its name."""
    solid: Solid
    """The space that it occupies, except where a later region has priority: `Model.solid_of` is the solid without later regions."""
    medium: str = ""
    """The name of its medium; that of the region, if it is empty."""
    colour: str = ""
    """Its colour in pictures: a name such as ``red``, or ``#rrggbb`` or ``#rrggbbaa``. Without one, that of its medium or the
    next one of a palette."""


@dataclass(frozen=True)
class Medium:
    """A material of regions.

    >>> import rayweave as rw
    >>> rw.Medium("glass", 1.5, numbers={"density": 2.5}).index
    1.5
    """

    name: str
    """Its name."""
    index: float | None = None
    """Its refractive index, if it is known."""
    colour: str | None = None
    """The colour of regions made of it."""
    numbers: dict[str, float] = field(default_factory=dict)
    """Further numbers: ``density`` in g/cm^3, ``attenuation`` per length, or any other."""


Region.__init__ = suggesting(color="colour", material="medium", shape="solid")(Region.__init__)  # type: ignore[method-assign]
Medium.__init__ = suggesting(  # type: ignore[method-assign]
    color="colour", n="index", density='numbers={"density": ...}', refractive_index="index"
)(Medium.__init__)

_QUERIES = ("hits", "crossings", "crossings_along", "nearest", "contains", "distance", "explain", "occurrence_paths", "to_mesh", "save")
suggest_for(Solid, _QUERIES)
suggest_for(Model, (*_QUERIES, "partition", "preparation"))
suggest_for(Model, ("distance",), by="regions=[...], the names of the regions,")

Regions: TypeAlias = Solid | Region | Sequence[Solid | Region] | Mapping[str, Solid | Region]
"""Regions of a model. The keys of a mapping are their names; solids without a name are numbered."""
Media: TypeAlias = Sequence[Medium] | Mapping[str, float | Medium | Mapping[str, Any]]
"""Media of a model. The values of a mapping are indices, numbers with their names, or media."""
Subject: TypeAlias = "Solid | Model | Region | Element | Sequence[Solid | Region] | Mapping[str, Solid | Region]"
"""What pictures, sections and measurements take: a solid, a model, an element of an optical system, or several solids or
regions."""

_RegionRow: TypeAlias = tuple[str, Solid, int, str]
_MediumRow: TypeAlias = tuple[str, float | None, str, list[tuple[str, float]]]


def parts(regions: Regions, media: Media | None) -> tuple[list[_RegionRow], list[_MediumRow]]:
    """Regions and media as rows: name, solid, number of the medium, colour; name, index, colour, numbers."""
    given = _regions(regions)
    table = _media(media)
    numbers = {row[0]: k for k, row in enumerate(table)}
    rows = []
    for region in given:
        medium = region.medium or region.name
        if not region.medium and medium == "world":
            raise _core.RayweaveError(
                "the region 'world' has no medium: 'world' is the medium outside of all regions. Give it another name, or a medium."
            )
        if medium not in numbers:
            if media is not None and region.medium:
                _reject_medium(region, list(numbers))
            numbers[medium] = len(table)
            table.append((medium, None, "", []))
        rows.append((region.name, region.solid, numbers[medium], region.colour))
    return rows, table


def _reject_medium(region: Region, names: list[str]) -> None:
    near = get_close_matches(region.medium, names, 1)
    hint = f" Did you mean '{near[0]}'?" if near else f" Add '{region.medium}' to media."
    raise _core.RayweaveError(
        f"the region '{region.name}' has the unknown medium '{region.medium}': the media are {', '.join(names)}.{hint}"
    )


def _regions(regions: Regions) -> list[Region]:
    """The regions, each with a name of its own."""
    if isinstance(regions, (_core.Solid, Region)):
        regions = [regions]
    if isinstance(regions, Mapping):
        for name in regions:
            if not isinstance(name, str):
                raise TypeError(f"regions has the key {name!r}: keys are the names of regions. Use a list for regions without names.")
        named = [_region(item, f"regions[{name!r}]", name) for name, item in regions.items()]
    elif isinstance(regions, Iterable):
        named = [_region(item, f"regions[{k}]", None) for k, item in enumerate(regions)]
    else:
        raise TypeError(f"regions is {type(regions).__name__}: it must be a list or a dict of solids or regions.")
    chosen = [region.name for region in named if region.name]
    for k, region in enumerate(named):
        if not region.name:
            named[k] = Region(_fresh(chosen), region.solid, region.medium, region.colour)
            chosen.append(named[k].name)
    seen: set[str] = set()
    for k, region in enumerate(named):
        if region.name in seen:
            raise _core.RayweaveError(
                f"regions[{k}] has the name '{region.name}' of an earlier region: results refer to regions by name. "
                "Give it a different name."
            )
        seen.add(region.name)
    return named


def _region(item: Any, place: str, name: str | None) -> Region:
    """The region of an entry; its name is "" if it has none."""
    if isinstance(item, Region):
        if not isinstance(item.solid, _core.Solid):
            kind = type(item.solid).__name__
            raise TypeError(f"{place}.solid is of type {kind}: it must be a Solid.")
        return item if name is None else Region(name, item.solid, item.medium, item.colour)
    if isinstance(item, _core.Solid):
        return Region(item.name or "" if name is None else name, item)
    kind = type(item).__name__
    raise TypeError(f"{place} is of type {kind}: it must be a Solid or a Region.")


def _fresh(names: list[str]) -> str:
    """A name for a solid without one."""
    number = 1
    while (name := "solid" if number == 1 else f"solid{number}") in names:
        number += 1
    return name


def _media(media: Media | None) -> list[_MediumRow]:
    """The media, that of the world first."""
    if media is None:
        given = []
    elif isinstance(media, Mapping):
        given = [_medium(str(name), value) for name, value in media.items()]
    elif isinstance(media, Iterable):
        given = list(media)
    else:
        raise TypeError(f"media is of type {type(media).__name__}: it must be a list or a dict of media.")
    rows: dict[str, _MediumRow] = {"world": ("world", None, "", [])}
    for k, medium in enumerate(given):
        if not isinstance(medium, Medium):
            kind = type(medium).__name__
            raise TypeError(f"media[{k}] is of type {kind}: it must be a Medium.")
        if medium.name in [other.name for other in given[:k]]:
            raise _core.RayweaveError(f"media[{k}] has the name '{medium.name}' of an earlier medium. Keep one of them.")
        _check_medium(medium)
        numbers = [(name, float(value)) for name, value in medium.numbers.items()]
        rows[medium.name] = (medium.name, medium.index, medium.colour or "", numbers)
    return list(rows.values())


# numbers that measurements, radiographs and GDML use
_KNOWN_NUMBERS = ("attenuation", "density", "temperature", "pressure")


def _check_medium(medium: Medium) -> None:
    if medium.index is not None and not (_is_number(medium.index, "the index", medium) and medium.index > 0):
        raise _core.RayweaveError(
            f"the index of the medium '{medium.name}' is {medium.index}: it must be finite and greater than 0."
        )
    for name, value in medium.numbers.items():
        if not _is_number(value, name, medium):
            raise _core.RayweaveError(f"{name} of the medium '{medium.name}' is {value}: it must be finite.")
        if name in ("attenuation", "density") and value < 0:
            reason = f"it must be finite and at least 0. Did you mean {-value}?"
            raise _core.RayweaveError(f"the {name} of the medium '{medium.name}' is {value}: {reason}")
        near = () if name in _KNOWN_NUMBERS else get_close_matches(name, _KNOWN_NUMBERS, 1, 0.8)
        if near:
            text = f"the key '{name}' of the medium '{medium.name}' is not used. Did you mean '{near[0]}'?"
            # the caller of `Model`
            warnings.warn(text, stacklevel=4)


def _is_number(value: Any, name: str, medium: Medium) -> bool:
    """Whether a number is finite."""
    try:
        return isfinite(value)
    except TypeError:
        hint = " The key of the colour is 'colour'." if name == "color" else ""
        raise TypeError(f"{name} of the medium '{medium.name}' is {value!r}: it must be a number.{hint}") from None


def _medium(name: str, value: float | Medium | Mapping[str, Any]) -> Medium:
    """The medium of an entry of a mapping."""
    if isinstance(value, Medium):
        return Medium(name, value.index, value.colour, value.numbers)
    if isinstance(value, Mapping):
        rest = {key: number for key, number in value.items() if key not in ("index", "colour")}
        return Medium(name, value.get("index"), value.get("colour"), rest)
    try:
        return Medium(name, float(value))
    except (TypeError, ValueError):
        kind = type(value).__name__
        raise TypeError(
            f"media['{name}'] is of type {kind}: it must be an index, a dict of numbers, or a Medium."
        ) from None
