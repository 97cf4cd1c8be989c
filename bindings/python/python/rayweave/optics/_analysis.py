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
    """A path of light through the system.

    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> trace = system.trace(ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> [path.text for path in trace.paths()]
    ['lens lens detector']
    """

    text: str
    rays: int
    power: float


_BACK = ("reflected", "totally reflected", "scattered")


def paths_of(trace: Mapping[str, NDArray[Any]], elements: list[str], events: list[str]) -> list[Path]:
    parent = trace["parent"]
    if len(parent) and (parent.max() >= len(parent) or np.any(trace["generation"][parent < 0] > 0)):
        raise RayweaveError("some segments are missing: paths need a whole trace.")
    came_back = _came_back(trace, events)
    names: list[str] = []
    numbers: dict[tuple[int, bool, int], int] = {}
    ways = np.empty(len(parent), int)
    for row in np.argsort(trace["generation"], kind="stable"):
        before = int(ways[parent[row]]) if parent[row] >= 0 else -1
        key = (before, bool(came_back[row]), int(trace["element"][row]))
        if key not in numbers:
            numbers[key] = len(names)
            first = "" if before < 0 else names[before] + ("* " if key[1] else " ")
            names.append(first + ("-" if key[2] < 0 else elements[key[2]]))
        ways[row] = numbers[key]
    is_last = np.ones(len(parent), bool)
    is_last[parent[parent >= 0]] = False
    rays = np.bincount(ways[is_last], minlength=len(names))
    power = np.bincount(ways[is_last], trace["intensity"][is_last], minlength=len(names))
    found = [Path(name, int(rays[k]), float(power[k])) for k, name in enumerate(names) if rays[k]]
    return sorted(found, key=lambda path: -path.power)


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
