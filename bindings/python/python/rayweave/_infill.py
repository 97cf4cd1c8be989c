"""The traces of a tool that fill the layers of a solid, or a region of the plane."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Polygons
from rayweave._model import Subject

_TRACE = np.dtype(
    [
        ("layer", np.int64),
        ("z", np.float64),
        ("scanline", np.int64),
        ("component", np.int64),
        ("x0", np.float64),
        ("y0", np.float64),
        ("x1", np.float64),
        ("y1", np.float64),
    ]
)


def infill(
    subject: Subject | Polygons,
    spacing: float,
    angle: float = 0.0,
    phase: float = 0.0,
    layers: ArrayLike | None = None,
    layer_height: float | None = None,
    *,
    turn: float = 0.0,
    alternate: bool = False,
    evaluator: str | None = None,
    threads: int | None = None,
) -> NDArray[Any]:
    """The traces that fill the layers of a solid or a model, or a region of the plane: a structured array.

    It has one row for each trace, in the order in which a tool runs them, with the fields layer, z, scanline, component, x0, y0, x1,
    y1. Scan line k is where p . (-sin angle, cos angle) = (k + phase) spacing, in every layer; traces on
    adjacent scan lines that overlap belong to one component of their layer.

    `angle` is in degrees from +x towards +y, `phase` a fraction of the spacing from 0 to 1. A solid is cut at the heights
    `layers`, or in the middle of layers that are `layer_height` thick, from its lowest point upwards; a region is one
    layer at z = 0. The lines of each layer are rotated by `turn` degrees relative to the layer before; with `alternate`, lines with
    odd numbers run backwards.

    >>> import rayweave as rw
    >>> square = rw.from_polygons([[[0, 0], [4, 0], [4, 4], [0, 4]]])
    >>> traces = rw.infill(square, 1.0, phase=0.5)
    >>> len(traces), float(traces["x1"][0] - traces["x0"][0])
    (4, 4.0)
    """
    whole, numbers = _core.infill_columns(
        subject, spacing, angle, phase, turn, alternate, layers, layer_height, evaluator, threads
    )
    table = np.empty(len(whole[0]), _TRACE)
    for name, counts in zip(("layer", "scanline", "component"), whole, strict=True):
        table[name] = counts
    for name, lengths in zip(("z", "x0", "y0", "x1", "y1"), numbers, strict=True):
        table[name] = lengths
    return table
