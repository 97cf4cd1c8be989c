"""Tables of measured surfaces."""

from __future__ import annotations

from os import PathLike
from typing import Any

from numpy.typing import ArrayLike

from rayweave import _core
from rayweave._recipe import recorded, reduced
from rayweave.optics._given import text


class SurfaceTables:
    """The tables of measured surfaces, which a GDML file cannot contain. Immutable: `lut`, `davis` and `dichroic` return a copy with one
    more table, for the surface of a name or for all surfaces with a finish.

    Parameters
    ----------
    folder
        The folder with the files of Geant4's data set RealSurface (G4REALSURFACEDATA), as they are (`PolishedTyvek.z`) or
        decompressed (`PolishedTyvek.dat`), for surfaces of the types dielectric_LUT and dielectric_LUTDAVIS. Only the files that a
        detector needs are read, when it is loaded.
    dichroic
        The file of the transmittance of all dichroic surfaces without a table of their own, in the format of G4DICHROICDATA.

    Examples
    --------
    >>> import rayweave.photons
    >>> tables = rayweave.photons.SurfaceTables("RealSurface2.2")
    >>> detector = rayweave.photons.load("wrapped.gdml", tables=tables)  # doctest: +SKIP
    """

    def __init__(
        self, folder: str | PathLike[str] | None = None, *, dichroic: str | PathLike[str] | None = None
    ) -> None:
        self.compiled = _core.PhotonTables(folder, dichroic)
        self._given = folder, dichroic

    def __reduce__(self) -> tuple[Any, ...]:
        # the original has the call of a method that made it
        return reduced(self) if hasattr(self, "_recipe") else (_again, self._given)

    def _with(self, compiled: _core.PhotonTables) -> SurfaceTables:
        other = SurfaceTables()
        other.compiled = compiled
        return other

    @recorded
    def lut(self, name: str, probabilities: ArrayLike) -> SurfaceTables:
        """With a distribution of the reflected direction, for a surface or a finish such as "polishedtyvekair".

        `probabilities` has the shape (37, 45, 91): phi from -90 to 90 degrees in steps of 5, theta from -90 to 86 degrees in steps of
        4, and the angle of incidence from 0 to 90 degrees. Values beyond 0 to 1 count as the nearest of these.
        """
        return self._with(self.compiled.with_lut(text(name, "name"), probabilities))

    @recorded
    def davis(self, name: str, reflectance: ArrayLike, directions: ArrayLike) -> SurfaceTables:
        """With samples of reflected and transmitted directions, for a surface or a finish such as "Rough_LUT".

        `reflectance` has the shape (90,), one value for each degree of the angle of incidence. `directions` holds at least 7,240,000
        values: pairs of an azimuth and an elevation in radians in blocks of 20,000 pairs, 91 blocks for reflection at 1, 2, ...
        degrees, then 90 blocks for transmission at 0, 1, ... degrees.
        """
        return self._with(self.compiled.with_davis(text(name, "name"), reflectance, directions))

    @recorded
    def dichroic(
        self, name: str, wavelengths_nm: ArrayLike, angles_degrees: ArrayLike, percent: ArrayLike
    ) -> SurfaceTables:
        """With the transmittance of a dichroic surface in percent, of shape (angles, wavelengths), at ascending angles of incidence
        and ascending wavelengths; bilinear between them and constant beyond."""
        compiled = self.compiled.with_dichroic(text(name, "name"), wavelengths_nm, angles_degrees, percent)
        return self._with(compiled)


def _again(folder: str | PathLike[str] | None, dichroic: str | PathLike[str] | None) -> SurfaceTables:
    """Tables from the names of their files."""
    return SurfaceTables(folder, dichroic=dichroic)
