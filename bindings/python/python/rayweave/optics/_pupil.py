"""Points of a pupil, and means over its area."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave.optics._given import unknown, whole

Numbers = NDArray[np.float64]

#: The default number of rings of rays.
RINGS = 6

_PUPILS = ("hexapolar", "square", "fan_x", "fan_y")


def pupil_grid(kind: Literal["hexapolar", "square", "fan_x", "fan_y"], count: int) -> Numbers:
    """Points (N, 2) of a pupil in units of its semi-diameter: rings of 6, 12, 18, ... about the middle, a square grid
    with `count` points across, or `count` points along one axis.

    >>> import rayweave.optics as ro
    >>> ro.pupil_grid("hexapolar", 2).shape
    (19, 2)
    >>> ro.pupil_grid("fan_y", 3)[:, 1].tolist()
    [-1.0, 0.0, 1.0]
    """
    if kind not in _PUPILS:
        unknown("grid of a pupil", kind, _PUPILS)
    # a grid without rings consists of the centre only
    return _core.pupil_points(kind, whole(count, "count", least=0 if kind == "hexapolar" else 1, bits=31))


def pupil_quadrature(rings: int = RINGS) -> tuple[Numbers, Numbers]:
    """Points (N, 2) of a pupil in units of its semi-diameter and weights (N,), whose sum is 1: weighted sums are means
    over the area of the pupil.

    The `rings` have 2 (rings + 2) points each; their radii and weights are those of Gaussian quadrature in the square
    of the radius (G. W. Forbes, J. Opt. Soc. Am. A 5, 1943, 1988). Sums are exact for polynomials of x and y up to the
    degree 2 rings + 3. The pupil has to be clear: at an obstruction or a vignetting edge, sums converge slowly.
    `Prescription.spots` uses other points for vignetted fields.

    >>> import rayweave.optics as ro
    >>> points, weights = ro.pupil_quadrature(3)
    >>> points.shape, round(float(weights.sum()), 12)
    ((30, 2), 1.0)
    >>> round(float(weights @ points[:, 0] ** 4), 12)  # the mean of x^4 over a disk is 1/8
    0.125
    """
    count = whole(rings, "rings", bits=31)
    if count == 0:
        return np.zeros((1, 2)), np.ones(1)
    if count > _RINGS_LIMIT:
        raise _core.RayweaveError(f"rings is {count}: it must be at most {_RINGS_LIMIT}.")
    # the roots of the Legendre polynomial by Newton's method, from their asymptotic positions (NIST Digital Library of
    # Mathematical Functions, 18.16.12); the error is squared in each step
    x = -np.cos(np.pi * (np.arange(count) + 0.75) / (count + 0.5))
    for _ in range(6):
        value, slope = _legendre(count, x)
        x -= value / slope
    slope = _legendre(count, x)[1]
    radii, shares = np.sqrt(0.5 * (1.0 + x)), 1.0 / ((1.0 - x**2) * slope**2)
    arms = 2 * (count + 2)
    angles = 2.0 * np.pi * np.arange(arms) / arms
    points = radii[:, None, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return points.reshape(-1, 2), np.repeat(shares / arms, arms)


#: The least number of points of a vignetted pupil. The RMS radius of a third of the pupil then differs by a few parts in a
#: thousand from that of a dense grid.
_EVEN_POINTS = 4096


def even_points(rings: int = RINGS) -> Numbers:
    """Points (N, 2) of equal areas of a pupil, which follow any edge inside it: a spiral by the golden angle, with radii
    whose squares are equally spaced (H. Vogel, Mathematical Biosciences 44, 179, 1979). There are 4096 points, or twice
    the number of points of `pupil_quadrature(rings)` if that is more."""
    count = max(_EVEN_POINTS, 4 * rings * (rings + 2))
    steps = np.arange(count)
    radii, angles = np.sqrt((steps + 0.5) / count), np.pi * (3.0 - np.sqrt(5.0)) * steps
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


#: The largest number of rings of `optimise` and `tolerance`, too.
_RINGS_LIMIT = 1024


def _legendre(degree: int, x: Numbers) -> tuple[Numbers, Numbers]:
    """The Legendre polynomial of a degree from 1 and its derivative (DLMF 18.9.1, 18.9.17)."""
    before, value = np.ones_like(x), x
    for n in range(1, degree):
        before, value = value, ((2 * n + 1) * x * value - n * before) / (n + 1)
    return value, degree * (before - x * value) / (1.0 - x**2)


@dataclass(frozen=True)
class PupilMeans:
    """Rays on the image with weights, for means over the pupil: `places` and `slopes` (N, 2) along x and y, `weights`
    (N,); the number of rays `launched` and the fraction `transmitted` of the pupil, averaged over the wavelengths."""

    places: Numbers
    slopes: Numbers
    weights: Numbers
    launched: int
    transmitted: float

    @classmethod
    def of(cls, columns: Mapping[str, NDArray[Any]], weights: Numbers, lines: int = 1) -> Self:
        """From the columns of rays of a number of wavelengths, whose `id` is the index of their weight."""
        places = np.stack([columns["x"], columns["y"]], axis=1)
        slopes = np.stack([columns["x_tilt"], columns["y_tilt"]], axis=1) / columns["z_tilt"][:, None]
        shares = weights[columns["id"]]
        # a sum of all weights has a rounding error
        is_clear = len(shares) == lines * len(weights)
        transmitted = 1.0 if is_clear else float(shares.sum() / (lines * weights.sum()))
        return cls(places, slopes, shares * columns["power"], lines * len(weights), transmitted)

    def moved(self, shift: float) -> Self:
        """The same rays on a plane moved along the axis."""
        return replace(self, places=self.places + shift * self.slopes)

    def spot(self) -> tuple[int, tuple[float, float], tuple[float, float, float]]:
        """The number of rays, the centroid, and the RMS radii: of both axes, along x, along y."""
        centroid = self._mean(self.places)
        x, y = np.sqrt(self._mean((self.places - centroid) ** 2)).tolist()
        return len(self.weights), (float(centroid[0]), float(centroid[1])), (float(np.hypot(x, y)), x, y)

    def focal_moments(self) -> Numbers:
        """The covariance of places and slopes, and the variance of slopes, summed over both axes: the mean square
        radius on a plane moved by s is a parabola in s with its vertex at - covariance / variance."""
        places, slopes = self.places - self._mean(self.places), self.slopes - self._mean(self.slopes)
        return np.array([self._mean(places * slopes).sum(), self._mean(slopes**2).sum()])

    def modulation(self, frequencies: Numbers, direction: tuple[float, float]) -> Numbers:
        """The geometric modulation transfer function of lines across a direction."""
        along = self.places @ np.array(direction) / np.hypot(*direction)
        along = along - self._mean(along)
        # one frequency at a time: a table of all of them would be large
        sums = [self._mean(np.exp(2.0j * np.pi * frequency * along)) for frequency in frequencies.tolist()]
        return np.asarray(np.abs(sums), float)

    def _mean(self, values: NDArray[Any]) -> NDArray[Any]:
        total = float(self.weights.sum())
        if not total > 0.0:
            raise _core.RayweaveError("no light arrives at the image: a spot needs at least one ray.")
        return np.asarray(self.weights @ values / total)


#: The change of modulations from one number of rings to its double below which they count as converged.
_MODULATION_TOLERANCE = 1e-4
#: The number of rings from which rings are not doubled any more for modulations.
_MODULATION_RINGS = 96


@dataclass(frozen=True)
class PupilSample:
    """Rays of a field that stand for its pupil.

    `trace` returns the rays through points (N, 2) of the pupil at all of the `lines` wavelengths; they are traced when they are
    needed, and only once. `is_clear` is false if rays of a field are known to be vignetted. With `given`, a number of points
    and the rays through them, these rays are the sample, and count equally. Rays are taken on a plane moved along the axis by
    `shift`."""

    trace: Callable[[Numbers], _core.Arrivals]
    lines: int
    rings: int
    is_clear: bool = True
    given: tuple[int, _core.Arrivals] | None = None
    shift: float = 0.0
    traced: dict[int, PupilMeans] = field(default_factory=dict)

    def moved(self, shift: float) -> Self:
        """The rays on a plane moved along the axis."""
        return replace(self, shift=self.shift + shift)

    def means(self, rings: int | None = None) -> PupilMeans:
        """Rays with weights: those of `pupil_quadrature` or, if some rays are vignetted, of equal areas."""
        count = self.rings if rings is None else rings
        if count not in self.traced:
            self.traced[count] = self._means(count)
        means = self.traced[count]
        return means.moved(self.shift) if self.shift else means

    def _means(self, rings: int) -> PupilMeans:
        if self.given is not None:
            count, arrivals = self.given
            return PupilMeans.of(arrivals.columns(), np.ones(count), self.lines)
        places, weights = pupil_quadrature(rings)
        columns = self.trace(places).columns()
        if rings > 0 and not (self.is_clear and len(columns["id"]) == self.lines * len(places)):
            places = even_points(rings)
            columns = self.trace(places).columns()
            weights = np.full(len(places), 1.0 / len(places))
        return PupilMeans.of(columns, weights, self.lines)

    def even(self) -> _core.Arrivals:
        """Rays of equal areas of the pupil, or the given ones."""
        if self.given is not None:
            return self.given[1].moved(self.shift)
        return self.trace(even_points(self.rings) if self.rings > 0 else np.zeros((1, 2))).moved(self.shift)

    def modulation(self, frequencies: Numbers, direction: tuple[float, float]) -> Numbers:
        """The geometric modulation transfer function: the number of rings is doubled until modulations change by less than
        1e-4."""
        rings, found = self.rings, self.means().modulation(frequencies, direction)
        while self.given is None and 0 < rings < _MODULATION_RINGS:
            rings, before = 2 * rings, found
            found = self.means(rings).modulation(frequencies, direction)
            if float(np.abs(found - before).max(initial=0.0)) <= _MODULATION_TOLERANCE:
                break
        return found


def pupil_deviations(trace: Callable[[Numbers], tuple[Numbers, Numbers]], is_clear: bool) -> tuple[float, float]:
    """The two RMS values of `deviations` over the area of the pupil: by quadrature or, if the pupil is not clear, over points of
    equal areas. `trace` returns the points (N, 2) among the given ones where light arrives, and the waves there."""
    points, weights = pupil_quadrature(_WAVEFRONT_RINGS)
    at, waves = trace(points)
    if not (is_clear and len(waves) == len(points)):
        at, waves = trace(even_points())
        weights = np.ones(len(waves))
    return deviations(at, waves, weights)


def deviations(pupil: Numbers, waves: Numbers, weights: Numbers) -> tuple[float, float]:
    """The RMS of a wavefront at points (N, 2) of the pupil without piston and tilt, and without piston; NaN without points. The
    tilt is the linear function of the coordinates of the pupil that fits best."""
    if not len(waves):
        return float("nan"), float("nan")
    shares = weights / weights.sum()
    flat = waves - shares @ waves
    roots = np.sqrt(shares)
    across = pupil - shares @ pupil
    # points on a line determine the tilt along it only: the solution of least norm
    tilts = np.linalg.lstsq(across * roots[:, None], flat * roots, rcond=1e-12)[0]
    first, second = (float(np.sqrt(shares @ off**2)) for off in (flat - across @ tilts, flat))
    return first, second


#: The number of rings of a wavefront: squares of wavefronts up to the power 13 of the pupil's radius are integrated exactly.
_WAVEFRONT_RINGS = 12


def best_shift(moments: Numbers) -> float:
    """The shift of the image to the smallest mean square radius, from `PupilMeans.focal_moments` or their sum; NaN for
    parallel rays."""
    covariance, variance = moments.tolist()
    return -covariance / variance if variance > 0.0 else float("nan")
