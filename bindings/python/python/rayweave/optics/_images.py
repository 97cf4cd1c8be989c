"""Analyses of the image of a prescription: columns with units, most with a picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave.optics._columns import Columns
from rayweave.optics._given import array, package, pair, real, whole
from rayweave.optics._plot import Plot, one_axes
from rayweave.optics._pupil import PupilMeans, PupilSample, best_shift, deviations
from rayweave.optics._system import _UNIT_NM

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Numbers = NDArray[np.float64]

_ALONG: tuple[Literal["y", "x"], ...] = ("y", "x")


def _micrometres(unit: str) -> tuple[float, str]:
    """The factor from a unit of length to micrometres with their symbol; 1 and the unit if it is not known."""
    return (_UNIT_NM[unit] / 1e3, "um") if unit in _UNIT_NM else (1.0, unit)


def _labelled(ax: Axes, across: str, up: str, *, legend: bool = True) -> Axes:
    ax.set_xlabel(across)
    ax.set_ylabel(up)
    if legend:
        ax.legend(fontsize="small")
    return ax


@dataclass(frozen=True)
class SpotSize:
    """A spot: the number of rays, the centroid (x, y), the RMS radius and its parts along x and y, and the largest
    distance from the centroid. If the points of the pupil were not given, centroid and RMS radii are means over the
    pupil by `pupil_quadrature` or, for vignetted fields, by an even grid, and `rays` counts the rays of that rule that
    arrive; otherwise rays are weighted by their power. `launched` is the number of rays before the lens, `transmitted` the
    fraction of the area of the pupil whose rays arrive, averaged over the wavelengths.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> lens.spots()["rms"].shape
    (2,)
    >>> size = lens.spots().images[0].spot()
    >>> size.rays, round(size.rms, 3), round(size.geometric, 3)
    (96, 0.074, 0.085)
    """

    rays: int
    centroid: tuple[float, float]
    rms: float
    rms_x: float
    rms_y: float
    geometric: float
    launched: int
    transmitted: float


class Rays(Columns):
    """Rays on the image, in its coordinates: its vertex is the origin, z along the axis.

    `id` is the number of the point of the pupil; `x`, `y`, `z` the position and `x_tilt`, `y_tilt`, `z_tilt` the unit
    direction; `path` the optical path from the start of the ray; `index` the refractive index in front of the image;
    `wavelength_nm`; `power`, the weight of the wavelength times the internal transmittance of the glasses along the
    ray: surfaces reflect nothing here, but glass absorbs.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> image = lens.spots().images[0]
    >>> image.rows, image.units["x"]
    (127, 'mm')
    """

    def __init__(self, compiled: _core.Arrivals, unit: str, sample: PupilSample) -> None:
        lengths = dict.fromkeys(("x", "y", "z", "path"), unit)
        super().__init__(compiled.columns(), {**lengths, "wavelength_nm": "nm"})
        self._compiled = compiled
        self._unit = unit
        self._sample = sample

    def _means(self) -> PupilMeans:
        """The rays for means over the pupil: those of a quadrature, traced on demand, or else these rays."""
        return self._sample.means()

    def moved(self, shift: float) -> Rays:
        """The same rays on a plane moved along the axis."""
        distance = real(shift, "shift")
        return Rays(self._compiled.moved(distance), self._unit, self._sample.moved(distance))

    def spot(self) -> SpotSize:
        """The size of the spot."""
        means = self._means()
        rays, centroid, radii = means.spot()
        off = np.hypot(self["x"] - centroid[0], self["y"] - centroid[1])
        return SpotSize(rays, centroid, *radii, float(off.max(initial=0.0)), means.launched, means.transmitted)

    def best_focus(self) -> float:
        """The shift of the image along the axis with the smallest RMS radius, in closed form; NaN for parallel rays.
        It is a mean over the pupil, as the RMS radius of `spot`."""
        return best_shift(self._means().focal_moments())

    def encircled_energy(self, radii: ArrayLike) -> Numbers:
        """The fraction of the power within circles about the centroid, from 4096 rays or more for each wavelength, even in the
        area of the pupil, or from the rays of the points that were given."""
        return self._sample.even().encircled_energy(_core.number_list(radii, "radii"))

    def radius_of_energy(self, fraction: float) -> float:
        """The radius of the smallest circle about the centroid with at least a fraction of the power, from the rays of
        `encircled_energy`."""
        return self._sample.even().radius_of_energy(real(fraction, "fraction"))

    def geometric_mtf(self, frequencies: ArrayLike, direction: tuple[float, float] = (0.0, 1.0)) -> Numbers:
        """The geometric modulation transfer function: the modulation of lines across a direction by frequency in cycles
        per unit of length, without diffraction. It is the modulus of the Fourier transform of the spot (W. J. Smith,
        Modern Optical Engineering, section on the modulation transfer function), a mean over the area of the pupil by
        `pupil_quadrature`, whose rings are doubled, up to 96 or more, until modulations change by less than 1e-4; with given
        points of the pupil, of the given rays."""
        along = pair(direction, "direction", "a pair of numbers along x and y")
        return self._sample.modulation(np.array(_core.number_list(frequencies, "frequencies")), along)

    #: The short name of `geometric_mtf`.
    mtf = geometric_mtf


class Spots(Columns):
    """The spots of all fields: `field`, `field_x`, `field_y`; the number of `rays` of the means, of those `launched`, and the
    fraction `transmitted` of the pupil, less than 1 with vignetting; the centroid `x`, `y`; the RMS radius `rms` with its
    parts `rms_x` and `rms_y`; the `geometric` radius. Centroid and RMS radii are means over the part of the pupil that
    transmits (by `pupil_quadrature`, or by an even grid if rays are vignetted). `images` has the rays of every field for drawings, on hexapolar rings; the
    geometric radius is the largest distance of one of them from the centroid.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> spots = lens.spots()
    >>> spots.rows, spots.units["rms"], spots["rms"].round(2)
    (2, 'mm', array([0.07, 0.05]))
    """

    images: list[Rays]
    _titles: list[str]
    _airy: float

    @classmethod
    def of(
        cls,
        images: list[Rays],
        fields: Sequence[tuple[float, float]],
        unit: str,
        *,
        titles: Sequence[str] | None = None,
        airy_radius: float = 0.0,
    ) -> Self:
        """The spots of the rays of each field; `titles` name the fields in drawings, `airy_radius` is the radius of the
        first dark ring of a lens without aberrations, which drawings show."""
        sizes = [image.spot() for image in images]
        table = cls(
            {
                "field": np.arange(len(images)),
                "field_x": [x for x, _ in fields],
                "field_y": [y for _, y in fields],
                **{name: [getattr(size, name) for size in sizes] for name in ("rays", "launched", "transmitted")},
                "x": [size.centroid[0] for size in sizes],
                "y": [size.centroid[1] for size in sizes],
                **{name: [getattr(size, name) for size in sizes] for name in ("rms", "rms_x", "rms_y", "geometric")},
            },
            dict.fromkeys(("x", "y", "rms", "rms_x", "rms_y", "geometric"), unit),
        )
        table.images = images
        table._titles = list(titles) if titles is not None else [f"field {k}" for k in range(len(images))]
        table._airy = airy_radius
        return table

    def show(self, *, axes: Sequence[Axes] | None = None) -> Plot:
        """Draws the spot diagrams about their centroids in micrometres, to one scale, coloured by wavelength, with the RMS radius as
        a dashed circle, and the Airy disk of the primary wavelength, or of the only one, on the axis, up to its first dark ring."""
        from rayweave.optics._drawing import wavelength_rgb

        plt = package("matplotlib.pyplot", "drawings")

        count = len(self.images)
        if axes is None:
            axes = list(plt.subplots(1, count, figsize=(3.2 * count + 1.4, 3.8), squeeze=False, layout="constrained")[1][0])
        scale, unit = _micrometres(self.units["rms"])
        reach = 1.1 * scale * max(float(self["geometric"].max()), self._airy) or 1.0
        for k, (ax, image) in enumerate(zip(axes, self.images, strict=False)):
            x, y = scale * (image["x"] - self["x"][k]), scale * (image["y"] - self["y"][k])
            ax.scatter(x, y, s=3.0, c=wavelength_rgb(image["wavelength_nm"]))
            circle = package("matplotlib.patches", "drawings").Circle
            if self._airy > 0.0:
                ax.add_patch(circle((0.0, 0.0), scale * self._airy, fill=False, linewidth=0.8))
            ax.add_patch(circle((0.0, 0.0), scale * self["rms"][k], fill=False, linewidth=0.8, linestyle="--"))
            ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
            ax.set_title(f"{self._titles[k]}, RMS {scale * self['rms'][k]:#.3g} {unit}", fontsize="small")
            _labelled(ax, f"x, {unit}", f"y, {unit}" if k == 0 else "", legend=False)
            ax.tick_params(labelsize="small", labelleft=k == 0)
            ax.locator_params(nbins=4)
        self._legend(list(axes)[count - 1])
        return Plot(list(axes))

    def _legend(self, ax: Axes) -> None:
        """Adds a legend of the wavelengths and the Airy disk beside the last diagram."""
        from rayweave.optics._drawing import wavelength_rgb

        handle = package("matplotlib.lines", "drawings").Line2D
        lines = np.unique(np.concatenate([image["wavelength_nm"] for image in self.images]))
        shades = zip(lines.tolist(), wavelength_rgb(lines), strict=True)
        handles = [handle([], [], marker="o", markersize=3.0, linestyle="", color=shade, label=f"{line:g} nm") for line, shade in shades]
        handles.append(handle([], [], linewidth=0.8, linestyle="--", color="black", label="RMS radius"))
        if self._airy > 0.0:
            handles.append(handle([], [], marker="o", markersize=8.0, linestyle="", color="black", fillstyle="none", label="Airy disk"))
        ax.legend(handles=handles, fontsize="small", loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0.0)


class Fans(Columns):
    """Ray fans: `field`, `wavelength_nm`, `along` (0: rays in the pupil along x, 1: along y), `pupil`, the position
    there from -1 to 1, and the transverse aberrations `error_x` and `error_y`, measured from the point where the
    ray through the centre of the paraxial entrance pupil (of the stop, if rays are aimed) hits the image, at the primary
    wavelength or at the same one.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> fans = lens.fans()
    >>> fans.units["error_y"]
    'mm'
    >>> pupil, error = fans.fan(0, lens.primary_nm, "y")
    >>> float(pupil.min()), float(pupil.max())
    (-1.0, 1.0)
    """

    _names: Sequence[str] = ()

    @classmethod
    def of(cls, found: list[tuple[int, float, int, Numbers, Numbers]], unit: str, names: Sequence[str] = ()) -> Self:
        """From single fans: field, wavelength, axis, positions in the pupil, errors (N, 2); `names` are those of the fields
        in drawings."""
        heads = np.concatenate([np.tile([fan[:3]], (len(fan[3]), 1)) for fan in found])
        errors = np.concatenate([fan[4] for fan in found])
        columns = {
            "field": heads[:, 0].astype(int),
            "wavelength_nm": heads[:, 1],
            "along": heads[:, 2].astype(int),
            "pupil": np.concatenate([fan[3] for fan in found]),
            "error_x": errors[:, 0],
            "error_y": errors[:, 1],
        }
        made = cls(columns, {"wavelength_nm": "nm", "error_x": unit, "error_y": unit})
        made._names = names
        return made

    def fan(self, field: int, wavelength_nm: float, along: Literal["x", "y"]) -> tuple[Numbers, Numbers]:
        """One fan: positions in the pupil along an axis, and the errors along the same axis."""
        number = "xy".index(along)
        wanted = (self["field"] == field) & (self["along"] == number) & (self["wavelength_nm"] == wavelength_nm)
        return self["pupil"][wanted], self[f"error_{along}"][wanted]

    def show(self, *, axes: Any = None) -> Plot:
        """Draws the fans in micrometres, field by field, coloured by wavelength: a row for each, along y and along x. `axes` is
        an array (fields, 2)."""
        from rayweave.optics._drawing import wavelength_rgb

        plt = package("matplotlib.pyplot", "drawings")

        fields = np.unique(self["field"])
        scale, unit = _micrometres(self.units["error_y"])
        if axes is None:
            size = (8.0, 2.2 * len(fields) + 0.6)
            axes = plt.subplots(len(fields), 2, sharex=True, sharey=True, figsize=size, squeeze=False, layout="constrained")[1]
        for row, field in zip(axes, fields.tolist(), strict=True):
            for ax, along in zip(row, _ALONG, strict=True):
                for line in np.unique(self["wavelength_nm"]).tolist():
                    shade = wavelength_rgb(np.array([line]))
                    pupil, error = self.fan(field, line, along)
                    ax.plot(pupil, scale * error, color=shade[0], label=f"{line:g} nm")
                ax.axhline(0.0, color="#a0a0a0", linewidth=0.6)
                name = self._names[field] if field < len(self._names) else f"field {field}"
                ax.set_title(f"{name}, along {along}", fontsize="small")
                last = field == fields[-1]
                up = f"error, {unit}" if along == "y" else ""
                _labelled(ax, "pupil" if last else "", up, legend=field == fields[0] and along == "y")
        return Plot(axes)


class Seidel(Columns):
    """The Seidel sums S_I to S_V and the chromatic sums C_I and C_II by `surface`, counted from 1: wavefront
    aberrations, twice to eight times their coefficients (W. T. Welford, Aberrations of Optical Systems, 1986, chapters
    8 and 10), in the unit of lengths, for the marginal ray of the axis and the chief ray of the last field.

    The wavefront at the rim of the pupil, at the edge of the field, is `spherical` / 8, `coma` / 2, `astigmatism` / 2,
    `petzval` / 4, `distortion` / 2, `axial_colour` / 2 and `lateral_colour`. `petzval` is S_IV = -H^2 c (1/n' - 1/n) with the
    Lagrange invariant H, for a distant object the semi-diameter of the entrance pupil times the tangent of the field angle; its
    sum is -H^2 times `FirstOrder.petzval_sum`. The colours are those between the first and the last wavelength.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> seidel = lens.seidel()
    >>> seidel.rows, round(seidel.sum["spherical"], 6)
    (2, 0.016136)
    >>> [line.split()[0] for line in str(seidel).splitlines()]
    ['surface', '1', '2', 'sum']
    """

    @classmethod
    def of(cls, sums: dict[str, Numbers], unit: str) -> Self:
        """From columns without the numbers of surfaces."""
        count = len(sums["spherical"])
        return cls({"surface": np.arange(1, count + 1), **sums}, dict.fromkeys(sums, unit))

    def __str__(self) -> str:
        return self._text({"surface": "sum", **self.sum})

    @property
    def sum(self) -> dict[str, float]:
        """The sums over all surfaces by name."""
        return {name: float(column.sum()) for name, column in self.items() if name != "surface"}

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the sums of every surface and of all of them as bars."""
        ax, names = one_axes(ax), list(self.sum)
        labels = [*map(str, self["surface"]), "sum"]
        width = 0.8 / len(names)
        for k, name in enumerate(names):
            places = np.arange(len(labels)) + (k - 0.5 * (len(names) - 1)) * width
            ax.bar(places, [*self[name], self.sum[name]], width, label=name.replace("_", " "))
        ax.set_xticks(range(len(labels)), labels)
        ax.axhline(0.0, color="#a0a0a0", linewidth=0.6)
        ax.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0.0)
        return Plot(_labelled(ax, "surface", f"Seidel sum, {self.units['spherical']}", legend=False))


class ZernikeFit(Columns):
    """A sum of Zernike polynomials: `index`, radial order `n`, azimuthal frequency `m` (negative for sines) and
    `coefficient` in waves.

    The polynomials have a mean square of 1 over the unit disk, so a coefficient is the RMS that it adds (R. J. Noll, J.
    Opt. Soc. Am. 66, 207, 1976; ANSI Z80.28). `residual_rms` is the RMS of the residual.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> fit = lens.wavefront(0).zernike(11)
    >>> fit.rows, fit["n"].tolist()
    (11, [0, 1, 1, 2, 2, 2, 3, 3, 3, 3, 4])
    """

    residual_rms: float

    def at(self, pupil: ArrayLike) -> Numbers:
        """The values of the sum at points (N, 2) of the unit disk."""
        points = array(pupil, "pupil")
        terms = zip(self["n"].tolist(), self["m"].tolist(), self["coefficient"], strict=True)
        values = [c * _core.zernike_values((n, m), points) for n, m, c in terms]
        return np.asarray(np.sum(values, axis=0), float)

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the coefficients as bars, without piston and tilts."""
        ax = one_axes(ax)
        wanted = self["n"] > 1
        ax.bar(self["index"][wanted], self["coefficient"][wanted])
        return Plot(_labelled(ax, "index", "coefficient, waves", legend=False))


class Wavefront(Columns):
    """Optical path differences: `pupil_x` and `pupil_y` in units of the pupil's semi-diameter, `waves` against a sphere
    about the point where the ray through the centre of the paraxial entrance pupil (of the stop, if rays are aimed) hits the
    image, through the paraxial exit pupil on the axis; positive where
    the light is ahead (W. T. Welford, Aberrations of Optical Systems, 1986, section 7.2).

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> front = lens.wavefront(0)
    >>> front.units["waves"], round(front.rms, 2)
    ('waves', 2.99)
    >>> front = lens.wavefront(1)  # coma tilts the wavefront
    >>> round(front.rms, 2), round(front.rms_about_chief_ray, 2)
    (2.03, 2.51)
    """

    _find_rms: Callable[[], tuple[float, float]] | None = None
    _rms: tuple[float, float] | None = None

    @classmethod
    def of(cls, pupil: Numbers, waves: Numbers, rms: Callable[[], tuple[float, float]] | None = None) -> Self:
        """From points (N, 2) and differences (N,). `rms` returns `rms` and `rms_about_chief_ray`; by default they are those of the
        points."""
        made = cls({"pupil_x": pupil[:, 0], "pupil_y": pupil[:, 1], "waves": waves}, {"waves": "waves"})
        made._find_rms = rms
        return made

    @property
    def rms(self) -> float:
        """The RMS in waves about the centroid of the image: without the mean and without the tilt that fits best, the linear
        function of the coordinates of the pupil (Noll's terms 1 to 3). A tilt moves the image and leaves its sharpness (V. N.
        Mahajan, J. Opt. Soc. Am. 72, 1258, 1982). `rms_about_chief_ray` includes it.

        It is a mean over the area of the pupil by Gaussian quadrature, from 336 rays (`pupil_quadrature(12)`), as in the goal
        and the merit "wavefront", which have 96 rays by default (`rings=6`); for a field with vignetted rays over 4096 points
        that are even in area. With given points of the pupil, it is that of the points, which count equally."""
        return self._both()[0]

    @property
    def rms_about_chief_ray(self) -> float:
        """The RMS in waves from the reference sphere about the chief ray: the standard deviation of the differences, which
        includes tilt; a mean over the pupil as `rms`."""
        return self._both()[1]

    def _both(self) -> tuple[float, float]:
        if self._rms is None:
            if self._find_rms is not None:
                self._rms = self._find_rms()
            else:
                pupil = np.stack([self["pupil_x"], self["pupil_y"]], axis=1)
                self._rms = deviations(pupil, self["waves"], np.ones(len(pupil)))
        return self._rms

    def __getstate__(self) -> dict[str, Any]:
        # the function that finds the RMS cannot be pickled
        return {**self.__dict__, "_find_rms": None, **({} if self._find_rms is None else {"_rms": self._both()})}

    @property
    def peak_to_valley(self) -> float:
        """The largest minus the smallest difference among the points, in waves."""
        return float(np.ptp(self["waves"]))

    @property
    def strehl(self) -> float:
        """The Strehl ratio, estimated as exp(-(2 pi rms)^2) from `rms`, which is without tilt; accurate above 0.1 (V. N. Mahajan,
        J. Opt. Soc. Am. 73, 860, 1983). It is that of the peak of the point spread function, wherever on the image it lies."""
        return float(np.exp(-((2.0 * np.pi * self.rms) ** 2)))

    def zernike(self, count: int = 15, *, scheme: Literal["noll", "osa"] = "noll") -> ZernikeFit:
        """The least-squares fit by the first `count` polynomials, numbered by Noll (from 1) or OSA/ANSI (from 0)."""
        first = 0 if scheme == "osa" else 1
        indices = range(first, first + whole(count, "count", least=1))
        terms = [_core.zernike_term(scheme, index) for index in indices]
        pupil = np.stack([self["pupil_x"], self["pupil_y"]], axis=1)
        coefficients, residual = _core.zernike_fit(pupil, self["waves"], terms)
        columns = {"index": list(indices), "n": [n for n, _ in terms], "m": [m for _, m in terms]}
        fit = ZernikeFit({**columns, "coefficient": coefficients}, {"coefficient": "waves"})
        fit.residual_rms = residual
        return fit

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the differences over the pupil, with tilt; the title states `rms`, which is without it."""
        ax = one_axes(ax)
        reach = float(np.abs(self["waves"]).max()) or 1.0
        x, y, waves = self["pupil_x"], self["pupil_y"], self["waves"]
        shades: dict[str, Any] = {"cmap": "RdBu_r", "vmin": -reach, "vmax": reach}
        (xs, columns), (ys, rows) = (np.unique(places, return_inverse=True) for places in (x, y))
        steps = np.concatenate([np.diff(xs), np.diff(ys)])
        if len(steps) and np.ptp(steps) < 1e-9 and len(xs) * len(ys) <= 4 * len(waves):
            # a square grid: cells without gaps at any size of the drawing
            cells = np.full((len(ys), len(xs)), np.nan)
            cells[rows, columns] = waves
            drawn: Any = ax.pcolormesh(xs, ys, cells, shading="nearest", **shades)
        else:
            drawn = ax.scatter(x, y, c=waves, s=16.0, marker="s", **shades)
        figure = ax.get_figure(root=True)
        if figure is not None:
            figure.colorbar(drawn, ax=ax, label="waves")
        ax.set_aspect("equal")
        ax.set_title(f"RMS {self.rms:.3g} waves without tilt", fontsize="small")
        return Plot(_labelled(ax, "pupil x", "pupil y", legend=False))


class _ByField(Columns):
    """Rows for every field, one block after the other."""

    _names: Sequence[str] = ()

    def named(self, names: Sequence[str]) -> Self:
        """The same rows with names of the fields for drawings."""
        self._names = names
        return self

    def _name(self, field: int) -> str:
        return self._names[field] if field < len(self._names) else f"field {field}"

    def of_field(self, field: int, name: str) -> NDArray[Any]:
        """A column of one field."""
        return np.asarray(self[name][self["field"] == field])

    def _show(self, ax: Axes | Plot | None, across: str, names: dict[str, str], up: str, scale: float = 1.0) -> Axes:
        ax = one_axes(ax)
        for field in np.unique(self["field"]).tolist():
            for name, style in names.items():
                label = self._name(field) + (f", {name}" if len(names) > 1 else "")
                at = self.of_field(field, across)
                ax.plot(at, scale * self.of_field(field, name), style, color=f"C{field}", label=label)
        unit = self.units[across]
        return _labelled(ax, f"{across}, {unit}" if unit else across, up)


class Energy(_ByField):
    """The `fraction` of the power of every `field` within a `radius` about its centroid.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> energy = lens.encircled_energy([0.05, 0.08, 1.0])
    >>> energy.of_field(0, "fraction").round(2)
    array([0.12, 0.51, 1.  ])
    """

    @classmethod
    def of(cls, images: list[Rays], radii: Numbers, unit: str) -> Self:
        """From the rays of every field."""
        columns = {
            "field": np.repeat(np.arange(len(images)), len(radii)),
            "radius": np.tile(radii, len(images)),
            "fraction": np.concatenate([image.encircled_energy(radii) for image in images]),
        }
        return cls(columns, {"radius": unit})

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the fractions over the radius."""
        return Plot(self._show(ax, "radius", {"fraction": "-"}, "fraction of the power"))


class Modulation(_ByField):
    """The geometric MTF of every `field`, from rays without diffraction, by `frequency` in cycles per unit of length:
    `tangential`, `sagittal`, and the diffraction `limit` of a lens without aberrations, on the axis, for the same light.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> mtf = lens.geometric_mtf([0, 10, 20])
    >>> mtf.of_field(0, "tangential").round(2)
    array([1.  , 0.15, 0.14])
    """

    _UP = "geometric MTF (without diffraction)"

    @classmethod
    def of(
        cls,
        images: list[Rays],
        fields: Sequence[tuple[float, float]],
        frequencies: Numbers,
        limit: Numbers,
        unit: str,
    ) -> Self:
        """From the rays of every field; `limit` is the modulation of a lens without aberrations."""
        along = [field if field != (0.0, 0.0) else (0.0, 1.0) for field in fields]
        pairs = list(zip(images, along, strict=True))
        tangential = np.concatenate([image.geometric_mtf(frequencies, (x, y)) for image, (x, y) in pairs])
        sagittal = np.concatenate([image.geometric_mtf(frequencies, (y, -x)) for image, (x, y) in pairs])
        return cls.from_parts(len(images), frequencies, tangential, sagittal, limit, unit)

    @classmethod
    def from_parts(
        cls, fields: int, frequencies: Numbers, tangential: Numbers, sagittal: Numbers, limit: Numbers, unit: str
    ) -> Self:
        """From the modulations of all fields, one after the other."""
        columns = {
            "field": np.repeat(np.arange(fields), len(frequencies)),
            "frequency": np.tile(frequencies, fields),
            "tangential": tangential,
            "sagittal": sagittal,
            "limit": np.tile(limit, fields),
        }
        return cls(columns, {"frequency": f"1/{unit}"})

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the modulation over the frequency, the diffraction limit in grey."""
        ax = self._show(ax, "frequency", {"tangential": "-", "sagittal": "--"}, self._UP)
        ax.plot(self.of_field(0, "frequency"), self.of_field(0, "limit"), color="#909090", label="diffraction limit, axis")
        ax.set_xlabel(f"frequency, cycles{self.units['frequency'].removeprefix('1')}")
        ax.set_xlim(0.0, float(self["frequency"].max()) or None)
        ax.set_ylim(0.0, 1.02)
        ax.grid(color="#e0e0e0", linewidth=0.6)
        ax.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
        return Plot(ax)


class DiffractionModulation(Modulation):
    """The MTF of every `field` with diffraction: the columns of `Modulation`.

    >>> import rayweave.optics as ro
    >>> mirror = ro.Prescription([ro.Surface(-200, -100, "mirror", conic=-1)], entrance_pupil_diameter=10)
    >>> mtf = mirror.diffraction_mtf([0, 50, 100])
    >>> mtf["tangential"].round(2), mtf["limit"].round(2)
    (array([1.  , 0.63, 0.3 ]), array([1.  , 0.63, 0.3 ]))
    """

    _UP = "diffraction MTF"


def diffraction_limit(share: Numbers) -> Numbers:
    """The transfer function of a circular pupil by frequency over its cutoff (Goodman, equation 6-31 of the second
    edition)."""
    inside = np.clip(share, 0.0, 1.0)
    return np.asarray(2.0 / np.pi * (np.arccos(inside) - inside * np.sqrt(1.0 - inside**2)))


class ThroughFocus(_ByField):
    """The `rms` radius of the spot of every `field` on planes moved along the axis by `shift`.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> sweep = lens.through_focus([-1, 0, 1])
    >>> sweep.of_field(0, "shift").tolist()
    [-1.0, 0.0, 1.0]
    """

    @classmethod
    def of(cls, images: list[Rays], shifts: Numbers, unit: str) -> Self:
        """From the rays of every field."""
        radii = [image._means().moved(shift).spot()[2][0] for image in images for shift in shifts.tolist()]
        field = np.repeat(np.arange(len(images)), len(shifts))
        columns = {"field": field, "shift": np.tile(shifts, len(images)), "rms": np.array(radii)}
        return cls(columns, {"shift": unit, "rms": unit})

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the radii in micrometres over the shift."""
        scale, unit = _micrometres(self.units["rms"])
        return Plot(self._show(ax, "shift", {"rms": "-"}, f"RMS radius, {unit}", scale))


@dataclass(frozen=True)
class Sweep:
    """Points of the field from the axis to the edge: their fractions `share` of the edge, and the units of fields and
    lengths."""

    share: Numbers
    widest: tuple[float, float]
    field_unit: str
    unit: str


class _OverField(Columns):
    """Rows from the axis to the edge of the field: `field_x` and `field_y`, and their fraction `share` of the edge."""

    @classmethod
    def _over(cls, sweep: Sweep, columns: dict[str, Numbers], units: dict[str, str], repeats: int = 1) -> Self:
        share = np.tile(sweep.share, repeats)
        x, y = sweep.widest
        places = {"share": share, "field_x": share * x, "field_y": share * y}
        own = dict.fromkeys(("field_x", "field_y"), sweep.field_unit)
        return cls({**places, **columns}, {**own, **units})

    def _height(self) -> Numbers:
        return np.asarray(np.hypot(self["field_x"], self["field_y"]))

    def _label(self) -> str:
        return f"field, {self.units['field_y']}"


class Distortion(_OverField):
    """The height of the `real` chief ray on the image, that of the `paraxial` one, and their relative difference
    `relative`, NaN on the axis.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> distortion = lens.distortion()
    >>> float(distortion["relative"][-1].round(5))
    -0.0005
    """

    @classmethod
    def of(cls, sweep: Sweep, found: Numbers) -> Self:
        """From rows whose first columns are the real and the paraxial height."""
        real, paraxial = found[:, 0], found[:, 1]
        with np.errstate(invalid="ignore", divide="ignore"):
            relative = np.where(paraxial > 0.0, (real - paraxial) / paraxial, np.nan)
        columns = {"real": real, "paraxial": paraxial, "relative": relative}
        return cls._over(sweep, columns, dict.fromkeys(("real", "paraxial"), sweep.unit))

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the relative distortion in percent against the field."""
        ax = one_axes(ax)
        # on the axis it vanishes in the limit
        ax.plot(np.where(self["share"] == 0.0, 0.0, 100.0 * self["relative"]), self._height())
        ax.axvline(0.0, color="#a0a0a0", linewidth=0.6)
        ax.set_ylim(bottom=0.0)
        return Plot(_labelled(ax, "distortion, %", self._label(), legend=False))


class Vignetting(_OverField):
    """The fraction of the pupil that is `transmitted` from each field: 1 without vignetting.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> lens.vignetting(count=3)["transmitted"]
    array([1., 1., 1.])
    """

    @classmethod
    def of(cls, sweep: Sweep, transmitted: Numbers) -> Self:
        """From fractions by field."""
        return cls._over(sweep, {"transmitted": transmitted}, {})

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the fraction in percent over the field."""
        ax = one_axes(ax)
        ax.plot(self._height(), 100.0 * self["transmitted"])
        ax.set_xlim(0.0, float(self._height().max()) or None)
        ax.set_ylim(0.0, 102.0)
        ax.grid(color="#e0e0e0", linewidth=0.6)
        return Plot(_labelled(ax, self._label(), "transmitted part of the pupil, %", legend=False))


class FieldCurvature(_OverField):
    """The `tangential` and the `sagittal` focus, as distances from the image along the axis.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> curvature = lens.field_curvature()
    >>> float(curvature["tangential"][-1].round(3)), float(curvature["sagittal"][-1].round(3))
    (0.947, 1.256)
    """

    @classmethod
    def of(cls, sweep: Sweep, found: Numbers) -> Self:
        """From rows whose last columns are the tangential and the sagittal focus."""
        columns = {"tangential": found[:, 2], "sagittal": found[:, 3]}
        return cls._over(sweep, columns, dict.fromkeys(columns, sweep.unit))

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the foci against the field."""
        ax = one_axes(ax)
        ax.plot(self["tangential"], self._height(), label="tangential")
        # short dashes, so that the line does not seem to end in a gap
        ax.plot(self["sagittal"], self._height(), dashes=(3.0, 1.0), label="sagittal")
        ax.axvline(0.0, color="#a0a0a0", linewidth=0.6)
        return Plot(_labelled(ax, f"focus, {self.units['tangential']}", self._label()))


class FocalShift(Columns):
    """The `focus` by `wavelength_nm`: where rays of the axial field point cross the axis, as a distance from the
    image.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> shift = lens.focal_shift([486.1, 656.3])
    >>> bool(shift["focus"][0] < shift["focus"][-1])
    True
    """

    @classmethod
    def of(cls, lines: Numbers, foci: list[float], unit: str) -> Self:
        """From wavelengths and foci."""
        return cls({"wavelength_nm": lines, "focus": foci}, {"wavelength_nm": "nm", "focus": unit})

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the focus against the wavelength."""
        ax = one_axes(ax)
        ax.plot(self["focus"], self["wavelength_nm"])
        return Plot(_labelled(ax, f"focus, {self.units['focus']}", "wavelength, nm", legend=False))


class LateralColour(_OverField):
    """The `shift` of the chief ray on the image relative to that of the primary wavelength, by `wavelength_nm` and
    field.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> lines = lens.replace(wavelengths_nm=[486.1, 656.3], primary=0)
    >>> colour = lines.lateral_colour()
    >>> sorted(set(colour["wavelength_nm"].tolist()))
    [486.1, 656.3]
    """

    @classmethod
    def of(cls, sweep: Sweep, lines: Sequence[float], found: Numbers) -> Self:
        """From shifts (wavelengths, fields)."""
        columns = {"wavelength_nm": np.repeat(lines, len(sweep.share)), "shift": found.ravel()}
        return cls._over(sweep, columns, {"wavelength_nm": "nm", "shift": sweep.unit}, len(lines))

    def show(self, *, ax: Axes | Plot | None = None) -> Plot:
        """Draws the shifts in micrometres against the field, coloured by wavelength."""
        from rayweave.optics._drawing import wavelength_rgb

        scale, unit = _micrometres(self.units["shift"])
        ax = one_axes(ax)
        for line in np.unique(self["wavelength_nm"]).tolist():
            wanted = self["wavelength_nm"] == line
            shade = wavelength_rgb(np.array([line]))[0]
            ax.plot(scale * self["shift"][wanted], self._height()[wanted], color=shade, label=f"{line:g} nm")
        ax.locator_params(axis="x", nbins=6)
        ax.set_ylim(bottom=0.0)
        return Plot(_labelled(ax, f"lateral colour, {unit}", self._label()))
