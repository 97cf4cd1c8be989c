"""Monte Carlo tolerancing and optimisation of prescriptions."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._table import aligned, short, table_of
from rayweave._words import suggesting
from rayweave.optics._columns import Columns
from rayweave.optics._given import all_of, each, flag, real, text, whole
from rayweave.optics._images import _labelled, _micrometres
from rayweave.optics._plot import Plot, one_axes
from rayweave.optics._prescription import Prescription
from rayweave.optics._pupil import RINGS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: The fractions of the quantiles that `print` shows.
_QUANTILES = (0.1, 0.5, 0.8, 0.9, 0.98)

#: The half-width of a uniform distribution, or ("uniform", half-width), ("normal", standard deviation), or the lower and the upper
#: end of a uniform distribution.
Spread = float | tuple[Literal["uniform", "normal"], float] | tuple[float, float]

Merit = Literal["spot", "wavefront", "wavefront about chief ray", "focal length", "back focal distance", "image shift", "transmitted"]
#: A merit, or a transfer function with a frequency: ("diffraction mtf", 40).
AnyMerit = Merit | tuple[Literal["geometric mtf", "diffraction mtf"], float]


class Sensitivities(Columns):
    """The effect of each `parameter` alone on the merit: `minus` and `plus`, the merits with the parameter too small
    and too large by its maximum or standard deviation `spread` (for a pair of ends at these, and `spread` is the one farther from 0); `change`, the larger of their two distances from `nominal`,
    the merit without errors; and `slope`, their difference divided by that of the parameter.

    `change` compares parameters of different units: the parameter with the largest one matters most. `slope` does not: it
    is per unit of the parameter, and 0 where an error to either side has the same effect. The rows have the order of the errors.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> found = ro.tolerance(lens, {"thickness 1": 0.1}, trials=20)
    >>> found.sensitivities["parameter"].tolist()
    ['thickness 1']
    >>> found = ro.tolerance(lens, {"thickness 1": 0.1, "index 1": 0.001}, trials=20)
    >>> alone = found.sensitivities
    >>> str(alone["parameter"][alone["change"].argmax()])
    'index 1'
    """

    def show(self, *, ax: Axes | Plot | None = None, most: int = 20) -> Plot:
        """Draws the changes of the merit as bars, for each parameter one for each side; the parameter with the largest change
        is on top. Only the `most` parameters with the largest changes are drawn. Lengths are in micrometres."""
        ax = one_axes(ax)
        factor, unit = _micrometres(self.units["change"])
        order = np.argsort(self["change"])[-whole(most, "most", least=1) :]
        ax.tick_params(axis="y", labelsize="small" if len(order) > 10 else "medium")
        places, height = np.arange(len(order)), 0.38
        for name, side in (("minus", -0.5), ("plus", 0.5)):
            change = factor * (self[name][order] - self["nominal"][order])
            ax.barh(places + side * height, change, height, label=name)
        ax.set_yticks(places, self["parameter"][order])
        # a few bars keep the width that they have beside others
        ax.set_ylim(-0.6, max(len(order), 4) - 0.4)
        ax.axvline(0.0, color="#a0a0a0", linewidth=0.6)
        ax.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0.0)
        # long numbers overlap at the default number of ticks
        ax.locator_params(axis="x", nbins=6)
        return Plot(_labelled(ax, f"change of the merit, {unit}" if unit else "change of the merit", "", legend=False))


class Trials(Columns):
    """Monte Carlo trials: the deviation of every parameter under its name, the `merit` (NaN if a field receives no
    light or a parameter leaves its range; then all rays count as lost),
    `shift`, the distance by which the image was moved to refocus it, and `lost`, the number of rays of all fields and
    wavelengths that did not arrive. `nominal` is the merit without errors, `sensitivities` the effect of each
    parameter, and `mirrored` is true if fields were evaluated on both sides of the axis.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> found = ro.tolerance(lens, {"thickness 1": 0.1}, trials=20)
    >>> found.rows
    20
    """

    nominal: float
    mirrored: bool
    sensitivities: Sensitivities

    def __str__(self) -> str:
        """The number of trials, and the merit without errors, its mean, and its quantiles."""
        unit = self.units["merit"]
        head = f"{self.rows} trials, merit in {unit}" if unit else f"{self.rows} trials"
        if self.failures:
            head += f", {self.failures} of them without a merit"
        rows = [("without errors", self.nominal)]
        if self.failures < self.rows:
            known = self["merit"][~np.isnan(self["merit"])]
            rows += [("mean", float(known.mean())), ("standard deviation", float(known.std(ddof=min(1, len(known) - 1))))]
            rows += [(f"{100 * fraction:g} % of the trials up to", self.quantile(fraction)) for fraction in _QUANTILES]
        return "\n".join([head, *aligned([[name, short(value)] for name, value in rows])])

    def quantile(self, fraction: float) -> float:
        """The merit that a fraction of the trials with a merit do not exceed; `failures` counts the others."""
        return float(np.nanquantile(self["merit"], fraction))

    @property
    def failures(self) -> int:
        """The number of trials without a merit."""
        return int(np.isnan(self["merit"]).sum())

    def show(self, *, ax: Axes | Plot | None = None, bins: int = 40) -> Plot:
        """Draws a histogram of the merits, with the merit without errors and the quantiles of 10, 50 and 90 percent. Lengths are in
        micrometres, except focal lengths and back focal distances."""
        ax = one_axes(ax)
        # focal lengths are far from micrometres
        is_short = abs(self.nominal) * _micrometres(self.units["merit"])[0] < 1e4
        factor, unit = _micrometres(self.units["merit"]) if is_short else (1.0, self.units["merit"])
        merits = factor * self["merit"][np.isfinite(self["merit"])]
        ax.hist(merits, bins=bins, color="#a8d1f0")
        ax.axvline(factor * self.nominal, color="#202020", label="without errors")
        for fraction in (0.1, 0.5, 0.9):
            at = factor * self.quantile(fraction)
            ax.axvline(at, color="#c05020", linestyle="--", label=f"{100 * fraction:g} %: {at:.4g}")
        ax.locator_params(axis="x", nbins=6)
        return Plot(_labelled(ax, f"merit, {unit}" if unit else "merit", "trials"))


def tolerance(
    lens: Prescription,
    errors: Mapping[str, Spread],
    merit: AnyMerit = "spot",
    *,
    trials: int = 1000,
    refocus: bool = False,
    vignette: bool = False,
    rings: int = RINGS,
    mirror_fields: bool | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> Trials:
    """Monte Carlo tolerancing: draws random errors of parameters and computes their effect on a merit.

    The name of a parameter is a quantity and a surface, counted from 1: "radius 2", "curvature 2", "thickness 1", "conic 1",
    "index 1", or "r^4 1", the coefficient of a power of the distance from the axis, 1 to 16. Surfaces that move as one body, about the
    vertex of the first, have "decentre x 1-2", "decentre y 3", "tilt x 1-2", "tilt y 3" (degrees).

    The deviation of a parameter, in its unit, is uniform between -d and +d for a number d, or ("uniform", d); normal with the standard
    deviation s for ("normal", s); and uniform between a and b for a pair (a, b), such as (-0.1, 0.0).

    The merits are:

    - "spot": the RMS radius of the spots. A spot contains all wavelengths about their common centroid; rays have the weight of their
      wavelength times that of their point of the pupil (`pupil_quadrature`);
    - "wavefront": the RMS of the wavefronts at the primary wavelength, in waves, without tilt, as `Wavefront.rms`;
    - "wavefront about chief ray": the same with tilt, as `Wavefront.rms_about_chief_ray`;
    - ("diffraction mtf", 40) or ("geometric mtf", 40): the modulation at a frequency in cycles per unit of length, for all
      wavelengths, the mean of tangential and sagittal lines and of all fields;
    - "transmitted": the fraction of the pupil whose rays pass all stated semi-diameters (as with `vignette`), the mean over all fields and
      wavelengths. It is exact to about one ray: take `rings=30`, say;
    - "focal length", "back focal distance";
    - "image shift": the displacement of the first field's centroid.

    Spot and wavefront merits are root mean squares over all fields of the prescription, with equal weights. Rays are traced from
    surface to surface and fill the paraxial entrance pupil in `rings` rings, regardless of the semi-diameters; with `vignette`, a ray
    ends where it hits a surface beyond its stated semi-diameter, or in its hole.

    With `mirror_fields`, each field (x, y) is also evaluated at (-x, -y), with half of its weight each. An error that decentres or tilts
    a surface can improve the fields on one side of the axis as much as it spoils those on the other; with fields on one side only, its
    effect would be underestimated. By default fields are therefore mirrored if all lie on one side, an error decentres or tilts
    surfaces, and the lens is round about one axis; `Trials.mirrored` is then true.

    With `refocus`, the image of every trial is moved to the minimum of the mean square radius of all spots. Trial k
    does not depend on the number of trials or threads, and appending parameters does not change the errors of earlier
    ones.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> found = ro.tolerance(lens, {"thickness 1": 0.1}, trials=20)
    >>> len(found["merit"])
    20
    """
    if not isinstance(errors, Mapping):
        raise TypeError(f"errors is {errors!r}: it must be a dict of parameters with their deviations.")
    spreads = {text(name, "a parameter"): _spread(name, spread) for name, spread in errors.items()}
    name, frequency = _modulation_merit(merit) if isinstance(merit, tuple) else (text(merit, "merit"), None)
    needs_rings = name in (*_RAY_OPERANDS, *_MTF_OPERANDS)
    found = _core.tolerance(
        _lens(lens),
        [(name, kind, numbers) for name, (kind, numbers) in spreads.items()],
        name,
        whole(trials, "trials", least=1),
        frequency=frequency,
        refocus=flag(refocus, "refocus"),
        vignette=flag(vignette, "vignette"),
        # without rings there is only the ray in the middle, which has a position but no spot radius
        rings=whole(rings, "rings", least=1 if needs_rings else 0, bits=31),
        mirror_fields=None if mirror_fields is None else flag(mirror_fields, "mirror_fields", "True, False or None"),
        seed=whole(seed, "seed"),
        threads=threads,
    )
    unit = "waves" if name.startswith("wavefront") else "" if name in (*_MTF_OPERANDS, "transmitted") else lens.unit
    units = {name: _unit(name, lens.unit) for name in spreads}
    columns = dict(zip(spreads, found["deviations"], strict=True))
    table = Trials(
        {**columns, "merit": found["merits"], "shift": found["shifts"], "lost": found["lost"]},
        {**units, "merit": unit, "shift": lens.unit},
    )
    table.nominal, table.mirrored = found["nominal"], found["mirrored"]
    alone: NDArray[np.float64] = np.array(found["alone"])
    minus, plus, slope = (alone[:, k] for k in range(3))
    table.sensitivities = Sensitivities(
        {
            "parameter": list(spreads),
            "spread": [max(abs(number) for number in numbers) for _, numbers in spreads.values()],
            "nominal": np.full(len(spreads), table.nominal),
            "minus": minus,
            "plus": plus,
            # NaN without light at one of the two ends
            "change": np.maximum(np.abs(plus - table.nominal), np.abs(minus - table.nominal)),
            "slope": slope,
        },
        dict.fromkeys(("nominal", "minus", "plus", "change"), unit),
    )
    return table


def _modulation_merit(merit: tuple[Any, ...]) -> tuple[str, float]:
    """The name and the frequency of a transfer function as a merit."""
    needed = 'a name such as "spot", or a pair such as ("diffraction mtf", 40)'
    if len(merit) != 2 or merit[0] not in _MTF_OPERANDS:
        raise _core.RayweaveError(f"merit is {merit!r}: it must be {needed}.")
    return str(merit[0]), _frequency(merit[1], needed)


def _frequency(value: Any, needed: str = "a frequency") -> float:
    found = real(value, "frequency", needed)
    if not 0.0 <= found < np.inf:
        raise _core.RayweaveError(f"frequency is {found:g}: it must be at least 0 and finite.")
    return found


def _lens(lens: Prescription) -> _core.CompiledPrescription:
    if not isinstance(lens, Prescription):
        raise TypeError(f"lens is {lens!r}: it must be a Prescription.")
    return lens._compiled


def _spread(name: str, spread: Spread) -> tuple[str, list[float]]:
    needed = 'a number, a pair of "uniform" or "normal" and a number, or a pair of a lower and an upper end'
    deviation = f"the deviation of {name!r}"
    match spread:
        case (str() as kind, scale):
            return kind, [real(scale, deviation, needed)]
        case (low, high):
            return "between", [real(low, deviation, needed), real(high, deviation, needed)]
        case scale:
            return "uniform", [real(scale, deviation, needed)]


def _unit(name: str, unit: str) -> str:
    kind = name.split()[0]
    if kind.startswith("r^"):
        power = int(kind[2:]) - 1
        return "" if power == 0 else f"1/{unit}" if power == 1 else f"1/{unit}^{power}"
    return {"tilt": "degrees", "conic": "", "index": "", "curvature": f"1/{unit}"}.get(kind, unit)


@dataclass(frozen=True)
class Goal:
    """An operand, its target, and the weight of its deviation; created by `goal`.

    >>> import rayweave.optics as ro
    >>> ro.goal("focal length", 50)
    Goal(operand='focal length', numbers=(), target='equal', value=50.0, weight=1.0, upper=nan)
    """

    operand: str
    numbers: tuple[float, ...]
    target: str
    value: float
    weight: float
    upper: float = float("nan")
    """The upper end of a range, whose lower end is `value`."""

    def _row(self) -> tuple[Any, ...]:
        return self.operand, list(self.numbers), self.target, self.value, self.upper, self.weight

    def _name(self) -> str:
        """The operand with its place, such as "spot, field 1, 587.6 nm"."""
        if self.operand in _MTF_OPERANDS:
            field, frequency, is_sagittal = self.numbers
            return f"{self.operand}, field {field:g}, {frequency:g}, {'sagittal' if is_sagittal else 'tangential'}"
        kinds = ("surface {:g}", "height {:g}") if self.operand == "edge" else ("field {:g}", "{:g} nm")
        return ", ".join([self.operand, *(kind.format(number) for kind, number in zip(kinds, self.numbers, strict=False))])


_RAY_OPERANDS = ("spot", "wavefront", "wavefront about chief ray")
_MTF_OPERANDS = ("geometric mtf", "diffraction mtf")
_NUMBER_OPERANDS = (
    "focal length",
    "back focal distance",
    "defocus",
    "magnification",
    "total track",
    "spherical",
    "coma",
    "astigmatism",
    "petzval",
    "distortion",
    "axial colour",
    "lateral colour",
)
_QUANTITIES = ("radius", "curvature", "thickness", "conic", "index", "r^4")
#: A parameter of a surface; the optimiser checks that the surface exists.
_PARAMETER = re.compile(r"(radius|curvature|thickness|conic|index|r\^([1-9]|1[0-6])|(decentre|tilt) [xy]) [0-9]+(-[0-9]+)?")
_OPERAND_WORDS = {
    "efl": "focal length",
    "focal_length": "focal length",
    "effl": "focal length",
    "bfl": "back focal distance",
    "rms": "spot",
    "rms spot": "spot",
    "spots": "spot",
    "opd": "wavefront",
    "axial color": "axial colour",
    "lateral color": "lateral colour",
    "edge thickness": "edge",
    "totr": "total track",
    "total_track": "total track",
    "ttl": "total track",
    "mtf": "diffraction mtf",
    "mtfa": "diffraction mtf",
    "gmtf": "geometric mtf",
    "vignetting": "clearance",
}


@suggesting(weights="weight", value="equal", target="equal")
def goal(
    operand: str,
    equal: float | None = None,
    *,
    at_least: float | None = None,
    at_most: float | None = None,
    weight: float = 1.0,
    field: int | None = None,
    wavelength_nm: float | None = None,
    surface: int | None = None,
    height: float | None = None,
    frequency: float | None = None,
    lines: Literal["tangential", "sagittal"] | None = None,
) -> Goal:
    """A goal of an optimisation; the default target is 0. With both `at_least` and `at_most` it is a range.

    Operands of one number:

    - "focal length", "back focal distance", "magnification";
    - "defocus", the distance from the image to the paraxial image; "total track", the distance from the first vertex to the image;
    - the Seidel sums "spherical", "coma", "astigmatism", "petzval", "distortion", "axial colour", "lateral colour": third-order
      aberrations of the last field;
    - "distortion" with a `field`, which is another operand: the relative distortion of its real chief ray at the primary wavelength,
      as in `Prescription.distortion`, 0 on the axis;
    - "edge", the distance from a `surface` to the next one at a `height` from the axis, by default at the larger one of their clear
      semi-diameters, which follow the rays while the lens changes;
    - "diffraction mtf" and "geometric mtf" of a `field` at a `frequency` in cycles per unit of length, of "tangential" or "sagittal"
      `lines`, for all wavelengths: values from 0 to 1, for example with `at_least=0.5`. From a lens that is far from sharp, first
      optimise spots: transfer functions then have no useful slope. Rays go over a clear pupil, without vignetting;
    - "clearance" of a `field`, the least distance of its rays through the rim of the pupil from the edges of all stated
      semi-diameters: `at_least=0` keeps the field free of vignetting;
    - a parameter by its name, such as "thickness 1".

    Operands of all rays of a `field`:

    - "spot", the RMS radius. A spot contains all wavelengths with their weights about their
      common centroid, as in `Prescription.spots` and `tolerance`; with `wavelength_nm` it has one wavelength and its own centroid,
      and lateral colour does not count;
    - "wavefront" at a wavelength, the RMS in waves, without tilt, as `Wavefront.rms` (which
      has 12 rings by default, a goal 6); "wavefront about chief ray" includes tilt, as `Wavefront.rms_about_chief_ray`.

    With target 0, each ray of these is a deviation of its own, and the sum of their squares is that of the RMS value; with any other
    target or a bound, the deviation is that of the RMS value.

    `weight` multiplies the deviation of this goal beside the others. The weights of wavelengths are those of the prescription,
    `Prescription(.., wavelengths_nm=.., weights=..)`, in goals as in `Prescription.spots`; fields have equal weights in `spots`, and in
    an optimisation the weights of their goals.

    >>> import rayweave.optics as ro
    >>> ro.goal("focal length", 50, weight=2).target
    'equal'
    >>> ro.goal("distortion", at_most=0.01, field=1).numbers
    (1.0,)
    >>> ro.goal("spot", field=0).numbers, ro.goal("spot", field=0, wavelength_nm=587.6).numbers
    ((0.0,), (0.0, 587.6))
    """
    text(operand, "operand")
    given = {"equal": equal, "least": at_least, "most": at_most}
    stated = [(kind, real(value, kind)) for kind, value in given.items() if value is not None] or [("equal", 0.0)]
    if any(np.isnan(value) for _, value in stated):
        raise _core.RayweaveError(f"the goal {operand!r} has the value NaN: it must be a number.")
    upper = float("nan")
    if [kind for kind, _ in stated] == ["least", "most"]:
        (_, least), (_, upper) = stated
        if least > upper:
            raise _core.RayweaveError(f"the goal {operand!r} has at_least {least:g} above at_most {upper:g}: exchange them.")
        stated = [("range", least)]
    if len(stated) > 1:
        raise _core.RayweaveError(f"the goal {operand!r} has {len(stated)} values: it must have equal, or at_least and at_most. Use two goals.")
    others = (*_RAY_OPERANDS, *_MTF_OPERANDS, "clearance", "edge")
    if operand not in (*others, *_NUMBER_OPERANDS) and not _PARAMETER.fullmatch(operand):
        known = [*_NUMBER_OPERANDS, *others]
        near = get_close_matches(operand, [*known, *_QUANTITIES], 1)
        suggestion = _OPERAND_WORDS.get(operand.lower()) or (near[0] if near else None)
        hint = f" Did you mean {suggestion!r}?" if suggestion else ""
        if "dist" in operand.lower():
            hint = ' goal("distortion", field=1) is that of the real chief ray of a field, goal("distortion") the third-order sum.'
        quantities = ", ".join(_QUANTITIES)
        raise _core.RayweaveError(
            f"there is no operand {operand!r}: there are {', '.join(known)}, and a parameter with the number of its surface, "
            f'such as "thickness 1": {quantities}.{hint}'
        )
    places: dict[str, Any] = {"field": field, "wavelength_nm": wavelength_nm, "surface": surface, "height": height}
    places |= {"frequency": frequency, "lines": lines}
    names: tuple[str, ...] = ()
    if operand == "edge":
        names = ("surface",) if height is None else ("surface", "height")
    if operand == "clearance" or operand == "distortion" and field is not None:
        names = ("field",)
    if operand in _MTF_OPERANDS:
        names = ("field", "frequency", "lines")
    if operand in _RAY_OPERANDS:
        # the spot of all wavelengths needs none
        names = ("field",) if operand == "spot" and wavelength_nm is None else ("field", "wavelength_nm")
    missing = [name for name in names if places[name] is None]
    allowed = ("surface", "height") if operand == "edge" else names
    extra = [name for name, value in places.items() if value is not None and name not in allowed]
    if missing:
        raise _core.RayweaveError(f"the goal {operand!r} lacks {' and '.join(missing)}: it takes {' and '.join(names)}.")
    if extra:
        takes = " and ".join(allowed) if allowed else "no field, wavelength_nm, surface, height, frequency or lines"
        raise _core.RayweaveError(f"the goal {operand!r} has {' and '.join(extra)}: it takes {takes}.")
    if lines is not None:
        if lines not in ("tangential", "sagittal"):
            raise _core.RayweaveError(f'lines is {lines!r}: it can be "tangential" or "sagittal".')
        places |= {"lines": float(lines == "sagittal"), "frequency": _frequency(frequency)}
    numbers = tuple(real(places[name], name) for name in names)
    return Goal(operand, numbers, *stated[0], real(weight, "weight"), upper)


class GoalTable(Columns):
    """The goals of an optimisation, one in each row: `goal`, the operand with its field, wavelength or surface; `target`
    ("equal", "least", "most" or "range") and `wanted`, its value, for a range the lower end with the upper end `wanted_to`; `weight`; `value_before` and `value_after`, the values of the
    operand (for spots and wavefronts the RMS); `contribution_before` and `contribution_after`, the squares of the
    weighted deviations, whose sums are the squares of `Optimum.before` and `Optimum.after`.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> goals = [ro.goal("focal length", 60), ro.goal("spot", field=1)]
    >>> best = ro.optimise(lens, ["curvature 2", "thickness 2"], goals)
    >>> best.goals["goal"].tolist()
    ['focal length', 'spot, field 1']
    >>> bool(abs(best.goals["contribution_after"].sum() - best.after**2) < 1e-12)
    True
    """

    @classmethod
    def _of(cls, goals: list[Goal], found: list[tuple[list[float], list[float]]]) -> Self:
        values, parts = (np.array([row[k] for row in found], float).reshape(-1, 2) for k in range(2))
        return cls(
            {
                "goal": [goal._name() for goal in goals],
                "target": [goal.target for goal in goals],
                "wanted": [goal.value for goal in goals],
                "wanted_to": [goal.upper for goal in goals],
                "weight": [goal.weight for goal in goals],
                "value_before": values[:, 0],
                "value_after": values[:, 1],
                "contribution_before": parts[:, 0],
                "contribution_after": parts[:, 1],
            },
            {},
        )


@dataclass(frozen=True)
class Optimum:
    """The result of an optimisation: the prescription `lens`, the `values` of its parameters, and the root of the sum
    of squares of all weighted deviations `before` and `after`. `goals` lists the goals with their values and contributions.
    `has_converged` is true if no step improves it further, and `reason` states why it ended. The goals ignore vignetting: `vignetted`
    has the fields of spots, wavefronts and transfer functions that the stated semi-diameters of `lens` vignette, each with the fraction
    of the pupil that is lost at the primary wavelength.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> best = ro.optimise(lens, ["curvature 2"], [ro.goal("focal length", 60)])
    >>> round(best.lens.first_order().focal_length, 6), best.has_converged
    (60.0, True)
    >>> best.goals["value_before"].round(3), best.goals["value_after"].round(3)
    (array([49.213]), array([60.]))
    """

    lens: Prescription
    values: dict[str, float]
    goals: GoalTable
    vignetted: dict[int, float]
    before: float
    after: float
    evaluations: int
    has_converged: bool
    reason: str

    def __str__(self) -> str:
        """The merit before and after, the values of the parameters, and the goals."""
        ended = f"{self.evaluations} evaluations: {self.reason}"
        head = f"merit {short(self.before)} -> {short(self.after)} after {ended}"
        values = aligned([[name, short(value)] for name, value in self.values.items()])
        shown = ("goal", "target", "wanted", "wanted_to", "value_before", "value_after", "contribution_after")
        has_ranges = bool(np.isfinite(self.goals["wanted_to"]).any())
        columns = {name: self.goals[name] for name in shown if has_ranges or name != "wanted_to"}
        notes = [
            f"field {field} is vignetted: {100 * lost:.2g} % of its pupil is lost, which the goals ignore"
            for field, lost in self.vignetted.items()
        ]
        return "\n".join([head, "", *values, "", str(Columns(columns)), *notes])

    def _repr_html_(self) -> str:
        merit = {"before": self.before, "after": self.after, "evaluations": self.evaluations, "ended": self.reason}
        return table_of("Optimum", merit | self.values)

    @classmethod
    def _of(cls, compiled: _core.CompiledPrescription, table: dict[str, Any], goals: list[Goal]) -> Self:
        rows = GoalTable._of(goals, table["goals"])
        return cls(Prescription._of(compiled), **(table | {"reason": _reason(table["reason"]), "goals": rows}))


#: Descriptions of the termination reasons of the crate levenberg-marquardt, by its names.
_REASONS = {
    "ResidualsZero": "all goals are met exactly",
    "Orthogonal": "no small change of the parameters is an improvement",
    "NoImprovementPossible": "rounding permits no better step",
    "LostPatience": "patience is exhausted, and further improvement is possible",
    "Numerical": "a number was not finite",
    "User": "a ray did not arrive, or a parameter left its range",
}


def _reason(termination: str) -> str:
    """The reason why an optimisation ended, in words."""
    if termination.startswith("Converged"):
        which = (("ftol: true", "the sum of squares"), ("xtol: true", "the parameters"))
        still = " and ".join(what for flag, what in which if flag in termination)
        return f"{still} changed by no more than rounding"
    return _REASONS.get(termination.split("(")[0], termination)


def optimise(
    lens: Prescription,
    parameters: Iterable[str],
    goals: Iterable[Goal],
    *,
    rings: int = RINGS,
    patience: int = 100,
    aimed: bool = False,
) -> Optimum:
    """Minimises the sum of squares of the weighted deviations from goals, starting from a prescription.

    Parameters have the names of `tolerance`, except those that move surfaces off the axis; `goal` creates goals. The algorithm is
    that of Levenberg and Marquardt in the form of J. J. Moré (1978), as in MINPACK. It finds a local minimum near the start, not the
    global one. The search ends after at most `patience * (number of parameters + 1)` evaluations of the goals, not counting those for
    derivatives.

    Spots and wavefronts are means over the pupil from 2 rings (rings + 2) rays (`pupil_quadrature`), none of which goes through the
    rim. With `aimed=True` rays go through points of the stop instead of the entrance pupil, as in `Prescription.rays`; wide fields need
    this, and each evaluation then takes several times as long. Rays count regardless of the semi-diameters: where the field of a goal is
    vignetted, `Optimum.vignetted` and `print` state it, and `goal("clearance", at_least=0, field=k)` avoids it.

    The search follows rays from surface to surface, also where surfaces cross: a `UserWarning` states that the result cannot be
    built. Bounds are goals, too: a `UserWarning` names the bounds that the result violates by more than 1 %. Increase their weight.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> best = ro.optimise(lens, ["curvature 2"], [ro.goal("focal length", 60)])
    >>> bool(best.after < best.before)
    True
    """
    given = all_of(Goal, goals, "goals", "Make one with goal(operand, ..).")
    rows = [goal._row() for goal in given]
    names = [text(name, "a parameter") for name in ([parameters] if isinstance(parameters, str) else each(parameters, "parameters", "names"))]
    needs_rings = any(row[0] in (*_RAY_OPERANDS, *_MTF_OPERANDS) for row in rows)
    count = whole(rings, "rings", least=1 if needs_rings else 0, bits=31)
    found = _core.optimise(_lens(lens), names, rows, rings=count, patience=whole(patience, "patience", least=1), aimed=aimed)
    best = Optimum._of(*found, given)
    _warn_of_crossing(lens, best.lens)
    _warn_of_bounds(given, best.goals)
    return best


def _warn_of_bounds(goals: list[Goal], table: GoalTable) -> None:
    """Warns of bounds that a result violates by more than 1 %, and by more than rounding."""
    violated = []
    for goal, value in zip(goals, table["value_after"], strict=True):
        # the bounds: a range has two
        least = goal.value if goal.target in ("least", "range") else -np.inf
        most = {"most": goal.value, "range": goal.upper}.get(goal.target, np.inf)
        for kind, bound, excess in (("least", least, least - value), ("most", most, value - most)):
            if excess > max(0.01 * abs(bound), 1e-9) and np.isfinite(bound):
                violated.append(f"{goal._name()} is {value:.4g} (at {kind} {bound:.4g}, weight {goal.weight:g})")
    if violated:
        warnings.warn(
            f"the optimised lens violates bounds: {'; '.join(violated)}. A bound competes with the other goals by its weighted "
            "violation, in the unit of its operand: increase its weight.",
            stacklevel=3,
        )


def _warn_of_crossing(start: Prescription, best: Prescription) -> None:
    """Warns if the solids of an optimised lens cannot be built although those of the start can: the residuals follow rays
    from surface to surface, also where these cross."""
    try:
        best.elements()
    except _core.RayweaveError as problem:
        try:
            start.elements()
        except _core.RayweaveError:
            return
        hint = 'Add bounds, such as goal("edge", at_least=1, surface=1, height=10) or goal("thickness 2", at_least=0.5).'
        warnings.warn(f"the optimised lens cannot be built: {str(problem).rstrip('.')}. {hint}", stacklevel=3)
