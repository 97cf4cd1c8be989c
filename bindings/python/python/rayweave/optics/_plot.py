"""Pictures of results by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rayweave._files import write_file
from rayweave.optics._given import package

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Plot:
    """A picture by matplotlib: its `figure`, and its `axes` as an array, (1,) for a single one. A plot with one Axes has
    the methods of that Axes, too, such as `set_title`; others are indexed like `axes`.

    >>> import matplotlib
    >>> matplotlib.use("agg")
    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> plot = lens.spots().show()
    >>> len(plot), plot[1].get_xlabel()
    (2, 'x, um')
    >>> plot.save("spots.png")
    >>> lens.distortion().show().get_xlabel()
    'distortion, %'
    """

    axes: NDArray[Any]
    """The Axes, an array of objects."""

    def __init__(self, axes: Any) -> None:
        self.axes = np.atleast_1d(np.asarray(axes, dtype=object))

    @property
    def figure(self) -> Figure:
        """The figure of the axes."""
        figure: Figure = self.axes.flat[0].get_figure(root=True)
        return figure

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of `axes`."""
        return self.axes.shape

    def save(self, path: str | PathLike[str], **options: Any) -> None:
        """Writes the figure to a file by `Figure.savefig`, with its options: .png, .svg, .pdf and other formats."""
        target = fspath(path)
        kind = options.get("format") or Path(target).suffix[1:]
        if not kind:
            # as savefig does
            kind = self.figure.canvas.get_default_filetype()
            target = f"{target.rstrip('.')}.{kind}"
        data = io.BytesIO()
        self.figure.savefig(data, **{"bbox_inches": "tight", **options, "format": kind})
        write_file(target, data.getvalue())

    def __len__(self) -> int:
        return len(self.axes)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.axes)

    def __getitem__(self, key: Any) -> Any:
        """An Axes, or a row of them."""
        return self.axes[key]

    def __getattr__(self, name: str) -> Any:
        """An attribute of the only Axes."""
        axes = self.__dict__.get("axes")
        if axes is None or name.startswith("__"):
            raise AttributeError(name)
        if axes.size != 1:
            raise AttributeError(f"a Plot of {axes.size} Axes has no attribute {name!r}: select one of them, as in plot[0].{name}.")
        return getattr(axes.flat[0], name)

    def __repr__(self) -> str:
        return f"<Plot of {self.axes.size} Axes>"


def one_axes(ax: Axes | Plot | None) -> Axes:
    """The Axes to draw in: the given one, that of a plot, or new ones."""
    if isinstance(ax, Plot):
        found: Axes = ax.axes.flat[0]
        return found
    plt = package("matplotlib.pyplot", "drawings")
    # the layout leaves room for legends beside the axes
    made: Axes = plt.subplots(layout="constrained")[1] if ax is None else ax
    return made
