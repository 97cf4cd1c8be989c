"""Sources of photons."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rayweave import _core
from rayweave.optics._given import array, real


class Source:
    """Photons by number: the photon of a number is a function of the seed and the number alone. `point` and `photons` make
    sources."""

    def __init__(self, compiled: _core.PhotonSource, description: str) -> None:
        self.compiled = compiled
        self._description = description

    @property
    def count(self) -> int | None:
        """The number of photons; None for sources of any number."""
        return self.compiled.count

    def __repr__(self) -> str:
        return f"<Source: {self._description}>"


def point(position: ArrayLike, wavelength_nm: float, *, towards: ArrayLike | None = None) -> Source:
    """A point that emits unpolarised photons of one wavelength at time 0.

    Parameters
    ----------
    position
        (3,), in mm.
    wavelength_nm
        The wavelength in vacuum, in nm.
    towards
        (3,), the direction of all photons; by default all directions with equal probability.

    Examples
    --------
    >>> import rayweave.photons
    >>> rayweave.photons.point([0, 0, 0], 420, towards=[0, 0, 1])
    <Source: point, 420 nm>
    """
    wavelength = real(wavelength_nm, "wavelength_nm")
    return Source(_core.PhotonSource.point(position, wavelength, towards), f"point, {wavelength:g} nm")


def photons(
    positions: ArrayLike,
    directions: ArrayLike,
    *,
    wavelengths_nm: ArrayLike,
    polarisations: ArrayLike | None = None,
    times: ArrayLike = 0.0,
) -> Source:
    """Given photons, one for each row; arguments of one row hold for all photons.

    Parameters
    ----------
    positions
        (N, 3) or (3,), in mm.
    directions
        (N, 3) or (3,), of any length but 0.
    wavelengths_nm
        (N,) or a number: the wavelengths in vacuum, in nm.
    polarisations
        (N, 3) or (3,); only the part across the direction counts. By default a random one for each photon.
    times
        (N,) or a number, in ns.

    Examples
    --------
    >>> import numpy as np
    >>> import rayweave.photons
    >>> x = np.linspace(-1, 1, 5)
    >>> rayweave.photons.photons(np.stack([x, 0 * x, 0 * x], axis=1), [0, 0, 1], wavelengths_nm=420)
    <Source: 5 photons>
    """
    vectors: dict[str, Any] = {"positions": array(positions, "positions"), "directions": array(directions, "directions")}
    if polarisations is not None:
        vectors["polarisations"] = array(polarisations, "polarisations")
    scalars = {"wavelengths_nm": array(wavelengths_nm, "wavelengths_nm"), "times": array(times, "times")}
    for name, given in vectors.items():
        if given.ndim not in (1, 2) or given.shape[-1] != 3:
            raise _core.RayweaveError(f"{name} has shape {given.shape}: (N, 3) or (3,) is needed.")
    for name, given in scalars.items():
        if given.ndim > 1:
            raise _core.RayweaveError(f"{name} has shape {given.shape}: (N,) or a number is needed.")
    rows = [given.shape[0] for given in vectors.values() if given.ndim == 2]
    rows += [given.shape[0] for given in scalars.values() if given.ndim == 1]
    count = rows[0] if rows else 1
    full = {name: np.broadcast_to(given, (count, 3)) if given.ndim == 1 else given for name, given in vectors.items()}
    flat = {name: np.broadcast_to(given, (count,)) if given.ndim == 0 else given for name, given in scalars.items()}
    compiled = _core.PhotonSource.photons(
        full["positions"], full["directions"], flat["wavelengths_nm"], flat["times"], full.get("polarisations")
    )
    return Source(compiled, f"{count} photons")
