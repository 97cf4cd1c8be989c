"""Comparison of two runs of photons."""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._table import Rows, Tabular
from rayweave._whole import whole
from rayweave.photons._run import Histories, Hits, Sequences

CompareRow: TypeAlias = tuple[
    tuple[str, str],
    tuple[int, int],
    bool,
    str | None,
    float,
    list[tuple[str, tuple[int, int], float, int, float, float, list[tuple[str, tuple[int, int], float]]]],
    list[str],
    tuple[int, int, float, bool, tuple[int, int, tuple[str, str]] | None] | None,
]
"""Names, numbers of photons, whether only hits are compared, the sentence about equal runs, z of their number; quantities; what is missing;
pairs."""

Sample: TypeAlias = "str | PathLike[str] | Histories | Sequences | Hits | NDArray[np.generic]"
"""A file, recorded histories, hits, or an array of Opticks."""


@dataclass(frozen=True)
class Bin:
    """A bin of a comparison.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> a, b = (detector.simulate(rp.point([0, 0, 0], 550), n=1000, seed=seed).hits for seed in (1, 2))
    >>> found = rp.compare(a, b)
    >>> sum(part.counts[0] for part in found["time"].bins) == a.rows
    True
    """

    label: str
    """A history, an end, a path or an interval."""
    counts: tuple[int, int]
    """The numbers of photons."""
    z: float
    """The difference of the fractions, first minus second run, in standard deviations."""


@dataclass(frozen=True)
class Quantity:
    """The comparison of the distributions of a quantity.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> a, b = (detector.simulate(rp.point([0, 0, 0], 550), n=1000, seed=seed).hits for seed in (1, 2))
    >>> found = rp.compare(a, b)
    >>> found["time"].name, found["time"].z < 6
    ('time', True)
    """

    name: str
    """history, end, volume, time or wavelength."""
    totals: tuple[int, int]
    """The numbers of photons that have the quantity."""
    chi2: float
    ndf: int
    """The number of degrees of freedom: that of the bins minus 1."""
    p: float
    """The probability of this chi squared or more in samples of one distribution."""
    z: float
    """The standard deviations of a normal distribution whose upper tail has the probability `p`."""
    bins: tuple[Bin, ...] = field(repr=False)

    @property
    def chi2_per_ndf(self) -> float:
        """chi squared per degree of freedom; NaN without one."""
        return self.chi2 / self.ndf if self.ndf else math.nan


@dataclass(frozen=True)
class FirstDifference:
    """The first photon with different histories.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> a, b = (detector.simulate(rp.point([0, 0, 0], 550), n=1000, seed=seed).hits for seed in (1, 2))
    >>> found = rp.compare(a, b)
    >>> found.first_difference is None
    True
    """

    photon: int
    row: int
    """The first row of its history that differs; 0 is the emission."""
    histories: tuple[str, str]


@dataclass(frozen=True, repr=False)
class Comparison(Tabular):
    """The comparison of two runs.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> a, b = (detector.simulate(rp.point([0, 0, 0], 550), n=1000, seed=seed).hits for seed in (1, 2))
    >>> found = rp.compare(a, b)
    >>> found.worst_z < 6
    True
    """

    names: tuple[str, str]
    photons: tuple[int, int]
    is_hits: bool
    """Whether only detected photons are compared."""
    hits_z: float
    """The difference of the numbers of hits in standard deviations, if only hits are compared: for equal numbers of photons, or
    as fractions of the `photons` that were given."""
    quantities: dict[str, Quantity]
    """By name: what both runs have."""
    missing: tuple[str, ...]
    """What is not compared, and why."""
    is_same_run: bool
    """Whether the photons of both runs are the same ones, by the number of equal histories."""
    equal_histories: int | None
    """The number of photons with equal histories; None where photons have no numbers or histories."""
    first_difference: FirstDifference | None
    """In runs of the same photons the first one with different histories."""
    equality: str | None
    """A sentence if all that both runs have is equal, photon by photon; else None."""

    def __getitem__(self, name: str) -> Quantity:
        return self.quantities[name]

    @property
    def worst_z(self) -> float:
        """The largest z of the quantities."""
        return max(quantity.z for quantity in self.quantities.values())

    def _rows(self) -> Rows:
        columns: dict[str, NDArray[Any]] = {"quantity": np.array(list(self.quantities), dtype=object)}
        for name in ("chi2", "ndf", "p", "z"):
            columns[name] = np.array([getattr(own, name) for own in self.quantities.values()])
        return Rows(columns, {})

    def __repr__(self) -> str:
        worst = f", worst z {self.worst_z:.2f}" if self.quantities else ""
        return f"<Comparison of {self.photons[0]} and {self.photons[1]} photons by {', '.join(self.quantities) or 'nothing'}{worst}>"

    def __str__(self) -> str:
        lines = [f"A {self.names[0]}: {self.photons[0]} photons", f"B {self.names[1]}: {self.photons[1]} photons"]
        if self.equality is not None:
            return "\n".join([*lines, self.equality])
        for own in self.quantities.values():
            p = "< 1e-300" if own.p < 1e-300 else f"{own.p:.3g}"
            lines.append(f"{own.name:10}  chi2 {own.chi2:.1f} / {own.ndf}  p {p}  z {own.z:.2f}")
        return "\n".join(lines)


def compare(
    a: Sample,
    b: Sample,
    *,
    least: float = 5,
    flags: bool = False,
    hits: bool = False,
    photons: tuple[int, int] | None = None,
) -> Comparison:
    """Compares two runs of photons: their histories, ends, volumes, times and wavelengths, as far as both have them.

    Parameters
    ----------
    a, b
        Each a file (tables of histories, steps or hits of the command `rayweave photons`, .csv or .npy, or of the script for Geant4;
        Opticks' photons (n, 4, 4) and sequences (n, 2, 2) as .npy), `run.histories` with recorded steps or sequences,
        `run.histories.sequences()`, `run.hits`, or an array of Opticks.
    least
        The expected number of photons of each run that a bin needs, at least 1. Histories with fewer are pooled by their common
        beginnings; the default is the rule of Cochran (1954).
    flags
        Compares Opticks' flags of processes rather than processes.
    hits
        Compares detected photons alone.
    photons
        The numbers of simulated photons of both runs, for `hits_z` of a comparison of hits; by default equal numbers.

    Raises
    ------
    RayweaveError
        A file is missing or damaged (with line or row, and column), a run has no photons, or the two have nothing in common.

    Examples
    --------
    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> a, b = (detector.simulate(rp.point([0, 0, 0], 550), n=1000, seed=seed).hits for seed in (1, 2))
    >>> found = rp.compare(a, b)
    >>> found.worst_z < 6
    True
    """
    with tempfile.TemporaryDirectory() as folder:
        paths = [_path(sample, Path(folder, name)) for sample, name in ((a, "a.npy"), (b, "b.npy"))]
        numbers = None if photons is None else _pair(photons)
        row: CompareRow = _core.compare_photons(paths[0], paths[1], float(least), bool(flags), bool(hits), numbers)
    _, counts, is_hits, equality, hits_z, quantities, missing, pairs = row
    given = [str(sample) if isinstance(sample, str | PathLike) else type(sample).__name__ for sample in (a, b)]
    found = {
        name: Quantity(name, totals, chi2, ndf, p, z, tuple(Bin(*own) for own in bins))
        for name, totals, chi2, ndf, p, z, bins in quantities
    }
    first = None if pairs is None or pairs[4] is None else FirstDifference(*pairs[4])
    return Comparison(
        (given[0], given[1]),
        counts,
        is_hits,
        hits_z,
        found,
        tuple(missing),
        pairs is not None and pairs[3],
        None if pairs is None else pairs[1],
        first,
        equality,
    )


def _pair(photons: tuple[int, int]) -> tuple[int, int]:
    """The numbers of photons of both runs."""
    if len(photons) != 2:
        raise _core.RayweaveError(f"photons has {len(photons)} numbers: two are needed, of run a and run b.")
    a, b = photons
    return whole(a, "photons", least=0, bits=63), whole(b, "photons", least=0, bits=63)


def _path(sample: Sample, target: Path) -> Path:
    """The file of a sample; those in memory are written to a file."""
    match sample:
        case str() | PathLike():
            return Path(sample)
        case Histories() if sample.rows == 0:
            return _path(sample.sequences(), target)
        case Sequences():
            if not sample.texts:
                reason = 'a record of counts has no histories. Simulate with record="steps" or "sequences"'
                raise _core.RayweaveError(f"the run cannot be compared: {reason}.")
            np.save(target, sample.words)
        case Histories() | Hits():
            sample.save(target)
        case np.ndarray():
            np.save(target, sample)
        case _:
            reason = "a file, run.histories, run.hits or an array of Opticks is needed"
            raise _core.RayweaveError(f"a {type(sample).__name__} cannot be compared: {reason}.")
    return target
