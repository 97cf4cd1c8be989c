"""Transforms of elements and sources."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave.optics._given import real, vector


class Placed(ABC):
    """An object that can be moved; maps are about the origin and return a new object."""

    @abstractmethod
    def transform(self, matrix: ArrayLike) -> Self:
        """The image under an affine map: a 4 x 4 matrix world_from_local that acts on columns."""

    def translate(self, v: ArrayLike, y: float | None = None, z: float | None = None) -> Self:
        """Moved by a vector (3,), or by its components x, y and z."""
        matrix = np.eye(4)
        matrix[:3, 3] = vector(v, "v") if y is None and z is None else [real(x, "v") for x in (v, y, z)]
        return self.transform(matrix)

    def rotate_x(self, degrees: float) -> Self:
        """Turned about the x axis, +y towards +z."""
        return self.transform(_turn(0, degrees))

    def rotate_y(self, degrees: float) -> Self:
        """Turned about the y axis, +z towards +x."""
        return self.transform(_turn(1, degrees))

    def rotate_z(self, degrees: float) -> Self:
        """Turned about the z axis, +x towards +y."""
        return self.transform(_turn(2, degrees))


def _turn(axis: int, degrees: float) -> NDArray[np.float64]:
    angle = np.deg2rad(real(degrees, "the angle"))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix
