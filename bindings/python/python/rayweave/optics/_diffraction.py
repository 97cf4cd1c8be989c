"""The optical transfer function with diffraction, from the wavefront by Fourier transforms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rayweave import _core

Numbers = NDArray[np.float64]

#: The change of a wavefront between neighbouring points above which the points do not resolve it: half a wave is the limit of
#: sampling, and the transform of the image reaches half of its width at a quarter.
_STEEPEST = 0.25


def pupil_cells(across: int) -> Numbers:
    """The centres (N, 2) of the cells of a square grid with `across` cells across the pupil that lie inside it."""
    at = (np.arange(across) + 0.5) / across * 2.0 - 1.0
    x, y = np.meshgrid(at, at)
    inside = x**2 + y**2 < 1.0
    return np.stack([x[inside], y[inside]], axis=1)


def slopes_of_pupil(points: Numbers, tilts: Numbers) -> Numbers:
    """The matrix (2, 2) of the best linear map from points (N, 2) of the pupil to direction cosines (N, 2) at the image.

    By the sine condition the map on the axis is linear; in the field it is nearly so, with different scales for the
    tangential and the sagittal direction."""
    known = np.column_stack([np.ones(len(points)), points])
    return np.asarray(np.linalg.lstsq(known, tilts, rcond=None)[0][1:].T)


def _cells(pupil: Numbers, across: int) -> NDArray[np.int64]:
    """The columns and rows of points (N, 2) of `pupil_cells`."""
    return np.rint((pupil + 1.0) / (2.0 / across) - 0.5).astype(np.int64).T


def steepest_step(pupil: Numbers, waves: Numbers, across: int) -> float:
    """The largest change of a wavefront between two neighbouring cells of a pupil, in waves."""
    column, row = _cells(pupil, across)
    front = np.full((across, across), np.nan)
    front[row, column] = waves
    return max(float(np.nanmax(np.abs(np.diff(front, axis=axis)), initial=0.0)) for axis in (0, 1))


def cells_for(steepest: float, across: int) -> int:
    """The number of cells across the pupil that suffices for a wavefront with this largest change between cells, with a
    tenth more, since finer cells come nearer to the rim, where wavefronts are steepest."""
    return int(np.ceil(1.1 * across * steepest / _STEEPEST)) if steepest > _STEEPEST else across


@dataclass(frozen=True)
class TransferFunction:
    """The transfer function of a pupil: `spectrum` (M, M) is the square of the modulus of the Fourier transform of the
    pupil function, the point spread function; the spacing of the pupil's points is `step`."""

    spectrum: Numbers
    step: float

    @classmethod
    def of(cls, pupil: Numbers, waves: Numbers, across: int) -> TransferFunction:
        """From optical path differences in waves, positive where the light is ahead, at the cells of a pupil where light
        arrives."""
        steepest = steepest_step(pupil, waves, across)
        if steepest > _STEEPEST:
            problem = f"across is {across}: the wavefront changes by {steepest:.3g} waves between two points of the pupil"
            needed = cells_for(steepest, across)
            raise _core.RayweaveError(f"{problem}, more than {_STEEPEST:g}. Pass across={needed} or more, or use geometric_mtf.")
        step = 2.0 / across
        column, row = _cells(pupil, across)
        function = np.zeros((2 * across, 2 * across), complex)
        function[row, column] = np.exp(-2.0j * np.pi * waves)
        return cls(np.abs(np.fft.fft2(function)) ** 2, step)

    def at(self, shifts: Numbers) -> NDArray[np.complex128]:
        """Its values at shifts (N, 2) of the pupil against itself: the autocorrelation of the pupil function over that
        without a shift, by the sum of its Fourier series, which needs no interpolation."""
        turns = 2.0j * np.pi * np.fft.fftfreq(len(self.spectrum))
        along_x, along_y = (np.exp(np.outer(shifts[:, axis] / self.step, turns)) for axis in (0, 1))
        sums = np.einsum("kj,kj->k", along_y @ self.spectrum, along_x)
        return np.asarray(np.where(np.hypot(*shifts.T) < 2.0, sums / self.spectrum.sum(), 0.0))
