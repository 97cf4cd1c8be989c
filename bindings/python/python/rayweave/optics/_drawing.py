"""Layout drawings: a section of the solids with the rays, drawn with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._core import RayweaveError, Sheet, Solid
from rayweave.optics._given import package

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rayweave.optics._system import System, Trace

_AXES = {"zx": (2, 0), "zy": (2, 1), "xy": (0, 1)}
_LINES = 800
#: The sine of the angle between chord and direction below which a piece of a ray is straight.
_STRAIGHT = 1e-6
_CURVED = _core.event_names().index("curved")

# as in the layouts of the command
#: Colours of media in the order of the elements.
_MEDIA = ("#cfe4f4", "#f6e4c8", "#d3ecd6", "#e6d9ee", "#f7d9d4", "#d2eeea", "#ecebc4")
#: Light with less than this fraction of its initial power is not drawn.
_FAINTEST = 1e-4
#: Least fraction of the initial power, width relative to that of the rays, and opacity.
_WEIGHTS = ((0.3, 1.0, 1.0), (0.03, 0.75, 0.7), (3e-3, 0.55, 0.45), (0.0, 0.4, 0.3))
#: The greatest number of rays, and of their segments, that are drawn by default; and the least number of rays in the plane of the
#: picture that represent all.
_RAYS, _PIECES, _FEWEST = 200, 1500, 5
#: Light is shown up to this distance from the elements, relative to their size.
_BEYOND = 0.6


def draw(
    trace: Trace,
    view: str,
    color: str,
    ax: Axes | None,
    width: float,
    rays: int | None,
    escape: float | None,
    hidden: Sequence[str] = (),
) -> Axes:
    plt = package("matplotlib.pyplot", "drawings")
    from matplotlib.collections import LineCollection

    if view not in _AXES:
        raise RayweaveError(f"view is {view!r}: it can be {', '.join(_AXES)}.")
    is_own = ax is None
    if ax is None:
        ax = plt.subplots(figsize=(10, 5))[1]
    across, up = _AXES[view]
    starts, ends, chosen = _pieces(trace, rays, (across, up))
    limits = _limits(trace.system, starts, ends, across, up)
    length = escape if escape is not None else 0.2 * float(limits[0][1] - limits[0][0])
    tilts = np.stack([trace[f"{k}_tilt"] for k in "xyz"], axis=1)[chosen]
    ends = np.where(np.isnan(ends), starts + length * tilts, ends)
    _sections(trace.system, ax, across, up, limits, hidden)
    lines = [line[:, [across, up]] for line in _lines(trace, starts, ends, tilts, chosen)]
    shades = _colours(trace, color, chosen)
    widths, opacities = _weights(trace, chosen)
    ax.add_collection(LineCollection(lines, colors=shades, linewidths=width * widths, alpha=opacities, zorder=3))
    ax.set_aspect("equal")
    ax.set_xlabel(f"{'xyz'[across]} / {trace.system.unit}")
    ax.set_ylabel(f"{'xyz'[up]} / {trace.system.unit}")
    ax.autoscale_view()
    if is_own and escape is None:
        # light from afar or that escapes ends at the edge
        ax.set_xlim(*limits[0])
        ax.set_ylim(*limits[1])
    return ax


def _pieces(trace: Trace, rays: int | None, plane: tuple[int, int]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    is_bright = _fractions(trace) >= _FAINTEST
    ids = _default_rays(trace, is_bright, plane) if rays is None else _each_nth(np.unique(trace["id"]), rays)
    chosen = np.isin(trace["id"], ids) & is_bright
    starts = np.stack([trace[f"{k}0"] for k in "xyz"], axis=1)[chosen]
    ends = np.stack([trace[f"{k}1"] for k in "xyz"], axis=1)[chosen]
    return starts, ends, chosen


def _each_nth(ids: NDArray[Any], count: int) -> NDArray[Any]:
    """At most `count` of some rays, evenly spaced."""
    return ids[:: max(1, -(-len(ids) // count))]


def _default_rays(trace: Trace, is_bright: NDArray[Any], plane: tuple[int, int]) -> NDArray[Any]:
    """All rays or, if they are more than `_RAYS` or have more than `_PIECES` segments, those in the plane of the picture, or
    every n-th."""
    ids = np.unique(trace["id"])
    segments = int(is_bright.sum())
    if len(ids) <= _RAYS and segments <= _PIECES or not len(ids):
        return ids
    off = "xyz"[({0, 1, 2} - set(plane)).pop()]
    size = max(float(np.abs(trace[f"{axis}0"]).max(initial=0.0)) for axis in "xyz")
    leaves = (np.abs(trace[f"{off}0"]) > 1e-9 * size) | (np.abs(trace[f"{off}_tilt"]) > 1e-9)
    inside = np.setdiff1d(ids, trace["id"][leaves])
    # a few rays do not show the light
    if len(inside) >= _FEWEST:
        segments, ids = int((is_bright & np.isin(trace["id"], inside)).sum()), inside
    return _each_nth(ids, max(1, min(_RAYS, _PIECES * len(ids) // max(segments, 1))))


def _fractions(trace: Trace) -> NDArray[np.float64]:
    """The power of each segment relative to the largest power that light starts with, or has at all in a part of a trace."""
    power = trace["intensity"]
    starts = power[trace["generation"] == 0]
    largest = float(np.max(starts if len(starts) else power, initial=0.0))
    return np.asarray(power / largest if largest > 0.0 else np.ones(len(power)))


def _weights(trace: Trace, chosen: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The relative widths and the opacities of segments by their power."""
    fractions = _fractions(trace)[chosen]
    least, widths, opacities = (np.array(column) for column in zip(*_WEIGHTS, strict=True))
    weight = np.argmax(fractions[:, None] >= least, axis=1)
    return widths[weight], opacities[weight]


def _lines(
    trace: Trace, starts: NDArray[Any], ends: NDArray[Any], tilts: NDArray[Any], chosen: NDArray[Any]
) -> list[NDArray[np.float64]]:
    """Points (M, 3) of every piece of a ray: its ends or, for a piece of a curve, points of the cubic through its ends
    with its directions there. The direction of such a piece is that at its end."""
    lines = list(np.stack([starts, ends], axis=1))
    chords = ends - starts
    lengths = np.linalg.norm(chords, axis=1)
    chords /= np.where(lengths > 0, lengths, 1.0)[:, None]
    bent = np.linalg.norm(np.cross(chords, tilts), axis=1) > _STRAIGHT
    # the start direction: the end direction of the previous piece or, at the start of the curve,
    # that of a parabola
    parents = trace["parent"][chosen]
    # in a part of a trace the previous rows may be missing
    known = (parents >= 0) & (parents < trace.rows)
    parents = np.where(known, parents, 0)
    meets = np.stack([trace[f"{k}1"] for k in "xyz"], axis=1)[parents] == starts
    curved = known & (trace["event"][parents] == _CURVED) & meets.all(axis=1)
    before = np.stack([trace[f"{k}_tilt"] for k in "xyz"], axis=1)[parents]
    parabola = 2.0 * (chords * tilts).sum(axis=1)[:, None] * chords - tilts
    first = np.where(curved[:, None], before, parabola)
    t = np.linspace(0.0, 1.0, 9)[:, None]
    for k in np.flatnonzero(bent):
        inner = starts[k] + lengths[k] / 3 * first[k], ends[k] - lengths[k] / 3 * tilts[k]
        points = starts[k], *inner, ends[k]
        weights = (1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3
        lines[k] = np.sum([weight * point for weight, point in zip(weights, points, strict=True)], axis=0)
    return lines


def _bodies(system: System) -> list[tuple[Solid, bool]]:
    """The bodies to cut: solids, and the surfaces of sheets with their trims."""
    found = []
    for part in system.elements:
        if isinstance(part.body, Sheet):
            surface, trim = part.body.solids()
            found += [(surface & trim, True), (trim - surface, True)]
        else:
            found.append((part.body, False))
    return found


def _limits(
    system: System, starts: NDArray[Any], ends: NDArray[Any], across: int, up: int
) -> list[tuple[float, float]]:
    light = np.concatenate([starts, ends[~np.isnan(ends).any(axis=1)]])
    boxes = [np.asarray(body.bounds) for body, _ in _bodies(system)]
    boxes = [bounds for bounds in boxes if np.isfinite(bounds).all()]
    if boxes:
        elements = np.concatenate(boxes)[:, [across, up]]
        reach = _BEYOND * float((elements.max(axis=0) - elements.min(axis=0)).max())
        if reach > 0.0:
            light[:, [across, up]] = np.clip(
                light[:, [across, up]], elements.min(axis=0) - reach, elements.max(axis=0) + reach
            )
    cloud = np.concatenate([light, *boxes])
    limits = []
    for k in (across, up):
        lo, hi = float(cloud[:, k].min()), float(cloud[:, k].max())
        margin = 0.05 * (hi - lo) or 1.0
        limits.append((lo - margin, hi + margin))
    return limits


def _sections(
    system: System, ax: Axes, across: int, up: int, limits: list[tuple[float, float]], hidden: Sequence[str]
) -> None:
    """Draws every solid along lines in the plane of the section, filled between entry and exit."""
    from matplotlib.collections import LineCollection

    (left, right), (low, high) = limits
    at = np.linspace(left, right, _LINES)
    spacing = at[1] - at[0]
    media: dict[str, str] = {}
    rows = np.linspace(low, high, _LINES)
    for body in system.elements:
        if body.name in hidden:
            continue
        if isinstance(body.body, Sheet):
            surface, trim = body.body.solids()
            _outline(ax, surface & trim, trim - surface, across, up, limits)
            continue
        segments = _cuts(body.body, at, across, up, (low, high))
        shade = _shade(body.material, media)
        ax.add_collection(
            LineCollection(segments, colors=shade, linewidths=_points(ax, spacing, right - left), zorder=1)
        )
        outlines = _outlines(body.body, across, up, limits)
        for outline in outlines:
            ax.plot(*outline.T, linewidth=0.9, color="#30506a", zorder=2, solid_joinstyle="round")
        if outlines:
            continue
        # a shape without simple outlines: cuts along the picture find the flat parts, cuts across it the steep ones
        steep = [ends[:, ::-1] for ends in _cuts(body.body, rows, up, across, (left, right))]
        if segments or steep:
            ends = np.concatenate(segments + steep)
            ax.plot(ends[:, 0], ends[:, 1], ".", markersize=1.0, color="#30506a", zorder=2)


def _shade(material: Any, media: dict[str, str]) -> str:
    """The colour of a material; each medium has one of its own, in the order in which they come."""
    if isinstance(material, str) and material in ("mirror", "absorber"):
        return "#9aa0a6"
    return media.setdefault(str(material), _MEDIA[len(media) % len(_MEDIA)])


def _cuts(
    solid: Solid, at: NDArray[np.float64], across: int, up: int, height: tuple[float, float]
) -> list[NDArray[np.float64]]:
    origins = np.zeros((len(at), 3))
    origins[:, across] = at
    direction = np.zeros(3)
    direction[up] = 1.0
    hits = np.clip(solid.hits(origins, direction), *height)
    pieces = []
    for low, high in zip(hits[0::2], hits[1::2], strict=True):
        inside = low < high
        for x, a, b in zip(at[inside], low[inside], high[inside], strict=True):
            pieces.append(np.array([[x, a], [x, b]]))
    return pieces


def _outlines(
    solid: Solid, across: int, up: int, limits: list[tuple[float, float]]
) -> list[NDArray[np.float64]]:
    """Closed outlines (N, 2) of a section in which every line along the picture meets a part at most once, as it does with
    lenses and mirrors; none for other shapes."""
    bounds = np.asarray(solid.bounds)[:, up]
    low, high = np.clip(bounds, *limits[1])
    if not low < high:
        return []
    # rows inside the rims, and as close to them as the picture can show
    inset = 1e-6 * (high - low)
    rows = np.linspace(low + inset, high - inset, _LINES)
    origins, direction = np.zeros((len(rows), 3)), np.zeros(3)
    origins[:, up], direction[across] = rows, 1.0
    hits = np.clip(solid.hits(origins, direction), *limits[0])
    # hits are padded with NaN
    is_span = np.isfinite(hits[0::2]) & (hits[0::2] < hits[1::2])
    counts = is_span.sum(axis=0)
    if len(hits) == 0 or counts.max() != 1:
        return []
    first = np.argmax(is_span, axis=0)
    places = np.arange(len(rows))
    starts, ends = hits[2 * first, places], hits[2 * first + 1, places]
    found = []
    for run in np.split(places, np.flatnonzero(np.diff(counts)) + 1):
        if counts[run[0]] == 1:
            sides = np.column_stack([starts[run], rows[run]]), np.column_stack([ends[run], rows[run]])[::-1]
            found.append(np.concatenate([*sides, sides[0][:1]]))
    return found


def _points(ax: Axes, spacing: float, extent: float) -> float:
    """The width of a line, in points: slightly more than the spacing of the cuts in the picture."""
    figure = ax.get_figure(root=True)
    inches = 10.0 if figure is None else float(figure.get_size_inches()[0])
    return 1.3 * spacing / extent * inches * 72.0


def _outline(
    ax: Axes, inner: Solid, outer: Solid, across: int, up: int, limits: list[tuple[float, float]]
) -> None:
    """Draws a sheet: the points where lines across the picture pass from one of its sides to the other."""
    (left, right), (low, high) = limits
    at = np.linspace(low, high, _LINES)
    ends = []
    for solid in (inner, outer):
        origins = np.zeros((len(at), 3))
        origins[:, up] = at
        direction = np.zeros(3)
        direction[across] = 1.0
        ends.append(solid.hits(origins, direction))
    for first in ends[0]:
        for second in ends[1]:
            both = np.isfinite(first) & np.isfinite(second)
            both[both] = np.abs(first[both] - second[both]) < 1e-9 * (right - left)
            ax.plot(first[both], at[both], ".", markersize=1.2, color="#202020", zorder=4)


def _colours(trace: Trace, color: str, chosen: NDArray[Any]) -> Any:
    if color == "wavelength":
        return wavelength_rgb(trace["wavelength_nm"][chosen])
    if color == "source":
        return package("matplotlib", "drawings").colormaps["tab10"](trace["source"][chosen] % 10)
    if not package("matplotlib.colors", "drawings").is_color_like(color):
        raise RayweaveError(f'color is {color!r}: it can be "wavelength", "source" or a colour of matplotlib.')
    return color


def wavelength_rgb(wavelength_nm: NDArray[Any]) -> NDArray[np.float64]:
    """Colours (N, 3) of wavelengths in nanometres: the colour matching functions of CIE 1931 by the fit of Wyman, Sloan
    & Shirley (JCGT 2, 1, 2013), in sRGB, as bright as the channels allow; grey for invisible light."""

    def lobe(wavelength: NDArray[Any], mean: float, left: float, right: float) -> NDArray[np.float64]:
        width = np.where(wavelength < mean, left, right)
        return np.asarray(np.exp(-0.5 * ((wavelength - mean) * width) ** 2))

    w = np.asarray(wavelength_nm, float)
    x = (
        0.362 * lobe(w, 442.0, 0.0624, 0.0374)
        + 1.056 * lobe(w, 599.8, 0.0264, 0.0323)
        - 0.065 * lobe(w, 501.1, 0.0490, 0.0382)
    )
    y = 0.821 * lobe(w, 568.8, 0.0213, 0.0247) + 0.286 * lobe(w, 530.9, 0.0613, 0.0322)
    z = 1.217 * lobe(w, 437.0, 0.0845, 0.0278) + 0.681 * lobe(w, 459.0, 0.0385, 0.0725)
    # IEC 61966-2-1: from XYZ to linear sRGB
    matrix = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
    linear = np.clip(np.stack([x, y, z], axis=-1) @ matrix.T, 0.0, None)
    brightest = linear.max(axis=-1, keepdims=True)
    visible = np.where(brightest > 1e-3, linear / np.maximum(brightest, 1e-3), 0.4)
    return np.asarray(np.where(visible <= 0.0031308, 12.92 * visible, 1.055 * visible ** (1 / 2.4) - 0.055))
