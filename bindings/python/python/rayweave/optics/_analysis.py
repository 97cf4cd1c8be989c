"""Analysis of traces: spots, irradiance, paths of light."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rayweave._core import RayweaveError
from rayweave._table import Table
from rayweave.optics._given import real, whole


@dataclass(frozen=True, eq=False, repr=False)
class Spot(Table):
    """Light on a sheet: points (N, 2) with their powers (N,), and quantities derived from them.

    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> trace = system.trace(ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> spot = trace.spot("detector")
    >>> spot.points.shape, bool(spot.rms_radius < spot.geometric_radius)
    ((100, 2), True)
    """

    _columns: ClassVar[tuple[str, ...]] = ("points", "power")

    points: NDArray[np.float64]
    """(N, 2) the points."""
    power: NDArray[np.float64]
    """(N,) the powers."""

    def _heading(self) -> str:
        return f"Spot of {len(self)} rays: RMS radius {self.rms_radius:.4g}, power {self.total:.4g}"

    @property
    def total(self) -> float:
        """The power of all rays."""
        return float(self.power.sum())

    @property
    def centroid(self) -> NDArray[np.float64]:
        """The mean of the points, weighted by power."""
        return np.asarray(self.power @ self.points / self.power.sum())

    @property
    def rms_radius(self) -> float:
        """The root of the mean square distance from the centroid, weighted by power."""
        squares = ((self.points - self.centroid) ** 2).sum(axis=1)
        return float(np.sqrt(self.power @ squares / self.power.sum()))

    @property
    def geometric_radius(self) -> float:
        """The greatest distance from the centroid."""
        return float(np.sqrt(((self.points - self.centroid) ** 2).sum(axis=1).max()))

    def encircled(self, radius: float) -> float:
        """The fraction of the power within a distance of the centroid."""
        inside = ((self.points - self.centroid) ** 2).sum(axis=1) <= real(radius, "radius") ** 2
        return float(self.power[inside].sum() / self.power.sum())


def spot_of(points: NDArray[np.float64], power: NDArray[np.float64]) -> Spot:
    if not power.sum() > 0.0:
        raise RayweaveError("no light arrives there: a spot needs at least one ray.")
    return Spot(points[:, :2], power)


def irradiance_of(
    points: NDArray[np.float64],
    power: NDArray[np.float64],
    bins: int | tuple[int, int],
    size: tuple[float, float] | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    across, up = points[:, 0], points[:, 1]
    cells = [whole(count, "bins", least=1) for count in (bins if isinstance(bins, tuple) else (bins, bins))]
    if size is not None:
        limits = [(-0.5 * length, 0.5 * length) for length in _lengths(size)]
    elif len(across) == 0:
        raise RayweaveError("no light arrives there: the map has no size. Pass size.")
    else:
        limits = [(float(values.min()), float(values.max())) for values in (across, up)]
    counts, x, y = np.histogram2d(across, up, bins=cells, range=limits, weights=power)
    areas = np.outer(np.diff(x), np.diff(y))
    return np.asarray((counts / areas).T), np.asarray(x), np.asarray(y)


def _lengths(size: Any) -> list[float]:
    if not isinstance(size, tuple | list) or len(size) != 2:
        raise TypeError(f"size is {size!r}: it must be a width and a height.")
    lengths = [real(length, "size") for length in size]
    if not all(0.0 < length < np.inf for length in lengths):
        raise RayweaveError(f"size is {size!r}: both must be positive and finite.")
    return lengths


@dataclass(frozen=True)
class Path:
    """A path of light through the system: `text`, its elements, with a `*` for each reflection and a `-` for none; the number of
    `rays` that end on it and their `power`; `reflected_at`, the surfaces of the reflections in order, by their names in
    `System.surface_names`.

    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> trace = system.trace(ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> [path.text for path in trace.paths()]
    ['lens lens detector']
    """

    text: str
    rays: int
    power: float
    reflected_at: tuple[str, ...] = ()


class PathList(list[Path]):
    """The paths of a trace, the strongest first; `print` shows them as a table. `notes` state, for each plane sheet, how many rays
    of ghosts pass beside it."""

    notes: list[str]

    def __str__(self) -> str:
        rows = [("power", "rays", "path", "reflected at")]
        rows += [(f"{path.power:.3e}", str(path.rays), path.text, ", ".join(path.reflected_at)) for path in self[:_SHOWN]]
        widths = [max(len(row[k]) for row in rows) for k in range(4)]
        lines = [f"{a:>{widths[0]}}  {b:>{widths[1]}}  {c:<{widths[2]}}  {d}".rstrip() for a, b, c, d in rows]
        if len(self) > _SHOWN:
            power = sum(path.power for path in self[_SHOWN:])
            lines.append(f"and {len(self) - _SHOWN} weaker paths with a power of {power:.3e}")
        return "\n".join(lines + self.notes)


#: The number of paths that are printed.
_SHOWN = 20


_BACK = ("reflected", "totally reflected", "scattered")


def paths_of(trace: Mapping[str, NDArray[Any]], elements: list[str], surfaces: list[str], events: list[str]) -> PathList:
    parent = trace["parent"]
    if len(parent) and (parent.max() >= len(parent) or np.any(trace["generation"][parent < 0] > 0)):
        raise RayweaveError("some segments are missing: paths need a whole trace.")
    came_back = _came_back(trace, events)
    names: list[str] = []
    reflections: list[tuple[str, ...]] = []
    numbers: dict[tuple[int, int | None, int], int] = {}
    ways = np.empty(len(parent), int)
    for row in np.argsort(trace["generation"], kind="stable"):
        before = int(ways[parent[row]]) if parent[row] >= 0 else -1
        place = int(trace["surface"][parent[row]]) if came_back[row] else None
        key = (before, place, int(trace["element"][row]))
        if key not in numbers:
            numbers[key] = len(names)
            first = "" if before < 0 else names[before] + (" " if place is None else "* ")
            names.append(first + ("-" if key[2] < 0 else elements[key[2]]))
            earlier = reflections[before] if before >= 0 else ()
            reflections.append(earlier if place is None else (*earlier, "-" if place < 0 else surfaces[place]))
        ways[row] = numbers[key]
    is_last = np.ones(len(parent), bool)
    is_last[parent[parent >= 0]] = False
    rays = np.bincount(ways[is_last], minlength=len(names))
    power = np.bincount(ways[is_last], trace["intensity"][is_last], minlength=len(names))
    found = [Path(name, int(rays[k]), float(power[k]), reflections[k]) for k, name in enumerate(names) if rays[k]]
    return PathList(sorted(found, key=lambda path: -path.power))


def ghosts_beside(
    trace: Mapping[str, NDArray[Any]], number: int, place: NDArray[np.float64], events: list[str]
) -> NDArray[np.bool_]:
    """The rows of ghosts that leave the system and cross the plane of a sheet beside it: light that was reflected where it was
    split. `number` is that of the sheet among the elements, `place` (4, 4) its place."""
    parent, event = trace["parent"], trace["event"]
    is_ghost = _came_back(trace, events) & (event[parent] == events.index("split"))
    for row in np.argsort(trace["generation"], kind="stable"):
        is_ghost[row] |= parent[row] >= 0 and is_ghost[parent[row]]
    start, tilts = (np.stack([trace[name] for name in names], axis=1) for names in (_STARTS, _TILTS))
    normal = np.cross(place[:3, 0], place[:3, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = (place[:3, 3] - start) @ normal / (tilts @ normal) > 0.0
    # light that the sheet transmits starts on it
    is_beyond = (parent >= 0) & (trace["element"][parent] == number)
    return np.asarray(is_ghost & ahead & ~is_beyond & (event == events.index("escaped")))


_STARTS, _TILTS = ("x0", "y0", "z0"), ("x_tilt", "y_tilt", "z_tilt")


def _came_back(trace: Mapping[str, NDArray[Any]], events: list[str]) -> NDArray[np.bool_]:
    """The segments that begin with a reflection. Of the two rays after a split, the reflected one stays in its medium
    and changes direction."""
    parent = trace["parent"]
    before = np.where(parent < 0, 0, parent)
    event = trace["event"][before] if len(parent) else trace["event"]
    tilts = np.stack([trace[f"{k}_tilt"] for k in "xyz"], axis=1)
    turned = (tilts != tilts[before]).any(axis=1) & (trace["index"] == trace["index"][before])
    back = np.isin(event, [events.index(name) for name in _BACK]) | ((event == events.index("split")) & turned)
    return np.asarray(back & (parent >= 0))
