"""Lens prescriptions, surface by surface, and their analysis."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Glass, Sheet, Solid
from rayweave._drawing import Drawing
from rayweave._files import write_file
from rayweave._table import table_of
from rayweave._words import no_attribute, suggesting
from rayweave.optics._diffraction import TransferFunction, cells_for, pupil_cells, slopes_of_pupil, steepest_step
from rayweave.optics._elements import _D_NM, Element, Finish
from rayweave.optics._given import (
    all_of,
    array,
    each,
    flag,
    numbers,
    package,
    pair,
    real,
    text,
    unknown,
    vector,
    whole,
)
from rayweave.optics._images import (
    DiffractionModulation,
    Distortion,
    Energy,
    Fans,
    FieldCurvature,
    FocalShift,
    LateralColour,
    Modulation,
    Rays,
    Seidel,
    Spots,
    Sweep,
    ThroughFocus,
    Vignetting,
    Wavefront,
    diffraction_limit,
)
from rayweave.optics._plot import Plot
from rayweave.optics._pupil import RINGS, PupilSample, best_shift, even_points, pupil_deviations, pupil_grid, pupil_quadrature
from rayweave.optics._surface_table import prescription_text
from rayweave.optics._system import _UNIT_NM, System, Trace

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: What lies behind a surface: "air" (an index of 1, as that in which glasses are measured), "mirror", the name of a glass, a
#: `Glass`, an index, or a pair of index and Abbe number at 587.5618 nm.
Behind = str | Glass | float | tuple[float, float]

_Unit = Literal["nm", "um", "mm", "cm", "m", "in"]
_FieldKind = Literal["angle", "object height", "image height"]


@dataclass(frozen=True)
class Biconic:
    """A different radius and conic constant along x; those of the surface are along y. It has no even or odd terms.

    >>> import rayweave.optics as ro
    >>> ro.Surface(50, figure=ro.Biconic(radius_x=60)).figure
    Biconic(radius_x=60, conic_x=0.0)
    """

    radius_x: float
    conic_x: float = 0.0


@dataclass(frozen=True)
class Toroidal:
    """The radius, conic constant and even terms (of y) give a curve in the plane x = 0, which is revolved about a line
    parallel to y, at the distance `turn` from the vertex along z; inf for a cylinder.

    >>> import rayweave.optics as ro
    >>> ro.Surface(50, figure=ro.Toroidal(turn=80)).figure
    Toroidal(turn=80)
    """

    turn: float


@dataclass(frozen=True)
class XYPolynomial:
    """Coefficients, which are lengths, of x, y, x^2, x y, y^2, x^3, x^2 y, ...: degree by degree, up to 30; x and y are
    divided by `norm_radius`.

    >>> import rayweave.optics as ro
    >>> ro.Surface(50, figure=ro.XYPolynomial(10, (0, 0, 1e-3))).figure.norm_radius
    10
    """

    norm_radius: float
    coefficients: tuple[float, ...]


@dataclass(frozen=True)
class ZernikePolynomials:
    """Coefficients, which are lengths, of Zernike polynomials of x and y, divided by `norm_radius`, in order: "noll"
    (R. J. Noll, J. Opt. Soc. Am. 66 (1976) 207, from Z1, root mean square 1), "osa" (ANSI Z80.28, from 0) or "fringe"
    (from 1, value 1 at the rim).

    >>> import rayweave.optics as ro
    >>> ro.Surface(50, figure=ro.ZernikePolynomials(10, (0, 0, 0, 1e-3))).figure.order
    'noll'
    """

    norm_radius: float
    coefficients: tuple[float, ...]
    order: Literal["noll", "osa", "fringe"] = "noll"


#: The figure of a surface that is not of revolution.
Figure = Biconic | Toroidal | XYPolynomial | ZernikePolynomials


_ORDERS = ("noll", "osa", "fringe")


def _figure_row(figure: Figure | None) -> tuple[str, list[float]]:
    match figure:
        case None:
            return "round", []
        case Biconic(radius_x, conic_x):
            return "biconic", [real(radius_x, "radius_x"), real(conic_x, "conic_x")]
        case Toroidal(turn):
            return "toroidal", [real(turn, "turn")]
        case XYPolynomial(norm_radius, coefficients):
            return "polynomial", [real(norm_radius, "norm_radius"), *numbers(coefficients, "coefficients")]
        case ZernikePolynomials(norm_radius, coefficients, order):
            if text(order, "order") not in _ORDERS:
                unknown("order of Zernike polynomials", order, _ORDERS)
            return order, [real(norm_radius, "norm_radius"), *numbers(coefficients, "coefficients")]
    raise _core.RayweaveError(f"figure is {figure!r}: it can be Biconic, Toroidal, XYPolynomial, ZernikePolynomials or None.")


def _figure_of(row: tuple[str, list[float]]) -> Figure | None:
    kind, numbers = row
    match kind:
        case "round":
            return None
        case "biconic":
            return Biconic(*numbers)
        case "toroidal":
            return Toroidal(*numbers)
        case "polynomial":
            return XYPolynomial(numbers[0], tuple(numbers[1:]))
    return ZernikePolynomials(numbers[0], tuple(numbers[1:]), cast(Any, kind))


def _behind(behind: Behind) -> Behind:
    needed = '"air", "mirror", a glass or its name, a real index, or a pair of index and Abbe number'
    if isinstance(behind, str | Glass):
        return behind
    if isinstance(behind, tuple):
        return pair(behind, "behind", needed)
    return real(behind, "behind", needed)


@dataclass(frozen=True)
class Surface:
    """A surface about the axis, and what lies behind it.

    `radius` is positive if the centre lies on the side of +z, inf for a plane; `thickness` is the distance along z to
    the next surface, negative where light travels back; `conic` the conic constant (0 a sphere, -1 a paraboloid);
    `semi_diameter` the clear one, by default that of the rays of all fields plus 2 %; `hole` the semi-diameter of a
    hole in a mirror. `mechanical_semi_diameter` is that of the edge of the lens: its solid and its drawing are as wide as the greatest
    of the clear and mechanical semi-diameters of its two surfaces, and beyond the clear ones it absorbs. Mirrors have none.

    `even` are the coefficients of r^2, r^4, ..., r^16 and `odd` those of r, r^3, ..., r^15, as many as are needed; they
    add to the sag of the conic. The coefficient of r^2 adds to the curvature; that of r makes a cone around the vertex
    and does not enter first-order data.

    `figure` makes a surface that is not of revolution: `Biconic`, `Toroidal`, `XYPolynomial`, `ZernikePolynomials`.

    >>> import rayweave.optics as ro
    >>> front = ro.Surface(radius=50, thickness=5, behind="N-BK7")
    >>> front.conic, front.semi_diameter is None
    (0.0, True)
    """

    radius: float = float("inf")
    thickness: float = 0.0
    behind: Behind = "air"
    conic: float = 0.0
    semi_diameter: float | None = None
    hole: float = 0.0
    even: tuple[float, ...] = ()
    odd: tuple[float, ...] = ()
    figure: Figure | None = None
    mechanical_semi_diameter: float | None = None

    def _row(self) -> tuple[Any, ...]:
        terms = numbers(self.even, "even"), numbers(self.odd, "odd")
        figure = _figure_row(self.figure)
        radius, thickness = real(self.radius, "the radius of a surface"), real(self.thickness, "a thickness")
        conic, hole = real(self.conic, "the conic constant of a surface"), real(self.hole, "hole")
        names = ("semi_diameter", "mechanical_semi_diameter")
        sizes = tuple(None if getattr(self, name) is None else real(getattr(self, name), name) for name in names)
        return (radius, thickness, _behind(self.behind), conic, sizes, hole, *terms, figure)

    @classmethod
    def _of(cls, row: tuple[Any, ...]) -> Surface:
        radius, thickness, behind, conic, (clear, mechanical), hole, even, odd, figure = row
        return cls(radius, thickness, behind, conic, clear, hole, tuple(even), tuple(odd), _figure_of(figure), mechanical)


Surface.__init__ = suggesting(  # type: ignore[method-assign]
    glass="behind", material="behind", medium="behind", curvature="radius", distance="thickness", k="conic", aperture="semi_diameter",
    edge_diameter="mechanical_semi_diameter", mechanical_diameter="mechanical_semi_diameter",
)(Surface.__init__)


@dataclass(frozen=True)
class CoordinateBreak:
    """A change of frame for a surface and all surfaces behind it. `before` is the number of this surface, from 1; the
    image comes last.

    The frame is moved by `decentre` along x and y and then rotated by `tilt_degrees` about x, about the new y and about
    the new z, each right-handed; with `tilts_first` it is rotated about z, y and x and then moved. Alternatively
    `matrix` is a rigid 4 x 4 matrix from the coordinates behind the break to those in front of it; `decentre` and the
    tilts are then ignored.

    >>> import rayweave.optics as ro
    >>> tilt = ro.CoordinateBreak(before=2, tilt_degrees=(45, 0, 0))
    >>> tilt.before
    2
    """

    before: int
    decentre: tuple[float, float] = (0.0, 0.0)
    tilt_degrees: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tilts_first: bool = False
    matrix: tuple[tuple[float, ...], ...] | None = None

    def _row(self) -> tuple[int, list[list[float]]]:
        before = whole(self.before, "before", least=1)
        if self.matrix is not None:
            matrix = array(self.matrix, "matrix")
            if matrix.shape != (4, 4):
                raise _core.RayweaveError(f"the matrix of a coordinate break has shape {matrix.shape}: it must be (4, 4).")
            return before, matrix.tolist()
        decentre = pair(self.decentre, "decentre", "a pair of lengths along x and y")
        x, y, z = vector(self.tilt_degrees, "tilt_degrees")
        return before, _core.coordinate_break(decentre, (x, y, z), flag(self.tilts_first, "tilts_first"))


@dataclass(frozen=True)
class Pupil:
    """A pupil, the image of the stop: its position along z, with the vertex of surface 1 at 0, and its diameter; inf if
    telecentric.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> lens.first_order().entrance_pupil
    Pupil(position=0.0, diameter=10.0)
    """

    position: float
    diameter: float


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """First-order data at one wavelength, in the unit of the prescription; inf or NaN where there are none.

    Distances are along z: back distances from the last vertex, front distances from the first. `image_distance` is the
    distance from the last vertex to the paraxial image, which for a distant object is the back focal distance; it is
    not the thickness behind the last surface, which places the image surface. `total_track` is the distance from
    surface 1 to the image surface along the axis, `working_f_number` 1 / (2 n u) with the index and the slope of the
    paraxial marginal ray at the image, `image_height` the distance of the paraxial image of the outermost field from
    the axis. `angular_magnification` is the slope of the chief ray behind the last surface over that in front of the first,
    between the centres of the pupils; in an afocal system it is that of any collimated light. `print` shows them as a
    list. `matrix` maps height and
    index times slope from the first surface to the last (E. Hecht, Optics, section 6.2.1). The formulas are those of
    Born & Wolf, Principles of Optics, 7th edition, section 4.4.

    `petzval_sum` is the sum of c (1/n' - 1/n) over all surfaces with their curvatures c and the indices in front n and behind n',
    in 1 over the unit of lengths. Times the index of the image space, which is negative behind an odd number of mirrors, it is
    the curvature of the Petzval surface: negative if the image curves towards a lens of positive power, which has -1 / (n f) if
    it is thin. The Seidel sum S_IV of `Prescription.seidel` is -H^2 times it, with the Lagrange invariant H (W. T. Welford,
    Aberrations of Optical Systems, 1986, chapter 8), and thus has the opposite sign.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> first = lens.first_order()
    >>> round(first.focal_length, 3), round(first.f_number, 3)
    (49.213, 4.921)
    >>> print(first)  # doctest: +ELLIPSIS
    First-order data, lengths in mm
    focal length               49.213
    back focal distance        47.5362
    ...
    """

    matrix: NDArray[np.float64]
    focal_length: float
    back_focal_distance: float
    front_focal_distance: float
    back_principal_plane: float
    front_principal_plane: float
    entrance_pupil: Pupil
    exit_pupil: Pupil
    stop_semi_diameter: float
    f_number: float
    magnification: float
    angular_magnification: float
    image_distance: float
    petzval_sum: float
    total_track: float = float("nan")
    working_f_number: float = float("nan")
    image_height: float = float("nan")
    unit: str = ""

    def __eq__(self, other: object) -> bool:
        """By value; NaN equals NaN."""
        if not isinstance(other, FirstOrder):
            return NotImplemented
        mine, others = ([_flat(getattr(data, field.name)) for field in fields(data)] for data in (self, other))
        are_equal = all(np.array_equal(one, two, equal_nan=True) for one, two in zip(mine, others, strict=True))
        return self.unit == other.unit and are_equal

    def __hash__(self) -> int:
        # 0 and -0 are equal
        return hash((self.matrix + 0.0).tobytes())

    def __str__(self) -> str:
        lines = [f"First-order data, lengths in {self.unit}" if self.unit else "First-order data"]
        for name, value in self._data().items():
            if isinstance(value, Pupil):
                at = f"at {value.position:.6g} from surface 1" if np.isfinite(value.position) else "at infinity"
                lines.append(f"{name:<26} {at}, diameter {value.diameter:.6g}")
            elif isinstance(value, float) and not np.isnan(value):
                lines.append(f"{name:<26} {value:.6g}")
        return "\n".join(lines)

    def _data(self) -> dict[str, Any]:
        return {field.name.replace("_", " "): getattr(self, field.name) for field in fields(self) if field.name != "unit"}

    def _repr_html_(self) -> str:
        return table_of("First-order data", self._data())

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """An error with a suggestion."""
            raise AttributeError(no_attribute("FirstOrder", name, [field.name for field in fields(self)], _FIRST_ORDER_WORDS))


def _flat(value: Any) -> NDArray[np.float64]:
    """The numbers of a field of first-order data; none of its text."""
    if isinstance(value, Pupil):
        return np.array([value.position, value.diameter])
    return np.array([]) if isinstance(value, str) else np.asarray(value, float)


_FIRST_ORDER_WORDS = {
    "efl": "focal_length",
    "effective_focal_length": "focal_length",
    "effl": "focal_length",
    "bfl": "back_focal_distance",
    "bfd": "back_focal_distance",
    "ffl": "front_focal_distance",
    "ffd": "front_focal_distance",
    "epd": "entrance_pupil.diameter",
    "fno": "f_number",
    "wfno": "working_f_number",
    "ttl": "total_track",
    "refocus": "refocused() of the prescription",
    "quick_focus": "refocused() of the prescription",
    "psf": "diffraction_mtf() of the prescription",
}


_FANS: tuple[Literal["fan_x", "fan_y"], ...] = ("fan_x", "fan_y")


#: Common names of other programs for the arguments of transfer functions.
_for_frequencies = suggesting(
    max_frequency="frequencies", maximum_frequency="frequencies", max_freq="frequencies", frequency="frequencies", grid="across"
)


class Prescription:
    """A sequential lens prescription; immutable. Two are equal if all their data are.

    The axis is z, light comes from -z. Surfaces are counted from 1, fields and wavelengths from 0. The vertex of
    surface 1 is the origin; the thickness of the last surface is the distance to the image. The aperture is one of
    four: the diameter of the entrance pupil, the F-number, the numerical aperture at the object, or the semi-diameter
    of the stop.

    `fields` are numbers along y, or pairs along x and y: angles in degrees from the axis, or heights of the object or
    of the paraxial image. `stop` is the number of the surface at the aperture stop. `breaks` fold and tilt the axis;
    first-order data are those of the surfaces on one axis.

    The arguments of the constructor are attributes; of the four apertures, those that were not given are None.
    `first_order` has the others' paraxial values. `print` shows the table of surfaces.

    >>> import rayweave.optics as ro
    >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    >>> lens
    <Prescription: 2 surfaces, 2 fields>
    >>> print(lens)
    2 surfaces, entrance pupil diameter 10 mm
    fields in degrees: (0, 0), (0, 5)
    wavelengths in nm: 587.5618
    surface  radius / mm  thickness / mm  behind  semi-diameter / mm  conic  remarks
    1                 50               5  N-BK7               5.1226         stop
    2                -50              46                       5.227
    image            inf
    >>> lens.entrance_pupil_diameter, lens.stop
    (10.0, 1)
    >>> round(lens.first_order().focal_length, 3)
    49.213
    >>> lens.spots()["rms"].shape
    (2,)
    """

    @suggesting(
        epd="entrance_pupil_diameter",
        fno="f_number",
        wavelengths="wavelengths_nm",
        wavelength="wavelengths_nm",
        na="object_numerical_aperture",
        aperture="entrance_pupil_diameter",
        units="unit",
    )
    def __init__(
        self,
        surfaces: Iterable[Surface],
        *,
        name: str = "",
        notes: Iterable[str] = (),
        unit: _Unit = "mm",
        entrance_pupil_diameter: float | None = None,
        f_number: float | None = None,
        object_numerical_aperture: float | None = None,
        stop_semi_diameter: float | None = None,
        fields: Iterable[float | tuple[float, float]] = (0.0,),
        field_kind: _FieldKind = "angle",
        wavelengths_nm: Iterable[float] = (_D_NM,),
        weights: Iterable[float] | None = None,
        primary: int = 0,
        object_distance: float = float("inf"),
        stop: int = 1,
        image_radius: float = float("inf"),
        image_conic: float = 0.0,
        image_semi_diameter: float | None = None,
        breaks: Iterable[CoordinateBreak] = (),
    ) -> None:
        wavelengths = numbers(wavelengths_nm, "wavelengths_nm")
        frame = {
            "name": text(name, "name"),
            "notes": [text(note, "a note") for note in ([notes] if isinstance(notes, str) else each(notes, "notes", "texts"))],
            "unit_nm": _unit_nm(unit),
            "aperture": _aperture(
                entrance_pupil_diameter=entrance_pupil_diameter,
                f_number=f_number,
                object_numerical_aperture=object_numerical_aperture,
                stop_semi_diameter=stop_semi_diameter,
            ),
            "field_kind": text(field_kind, "field_kind"),
            "fields": [_field(field) for field in each(fields, "fields", "numbers along y or pairs along x and y")],
            "lines": _lines(wavelengths, weights),
            "primary": whole(primary, "primary"),
            "object_distance": real(object_distance, "object_distance"),
            "stop": whole(stop, "stop", least=1),
            "image": (
                real(image_radius, "image_radius"),
                real(image_conic, "image_conic"),
                None if image_semi_diameter is None else real(image_semi_diameter, "image_semi_diameter"),
            ),
            "breaks": [at._row() for at in all_of(CoordinateBreak, breaks, "breaks")],
        }
        self._compiled = _core.CompiledPrescription([surface._row() for surface in all_of(Surface, surfaces, "surfaces")], frame)
        #: What was ignored or replaced in the file from which it was read, with lines.
        self.passed_over: tuple[str, ...] = ()

    @classmethod
    def _of(cls, compiled: _core.CompiledPrescription, passed_over: Iterable[str] = ()) -> Prescription:
        made = cls.__new__(cls)
        made._compiled = compiled
        made.passed_over = tuple(passed_over)
        return made

    @classmethod
    def read_zmx(cls, path: str | Path) -> Prescription:
        """The prescription in a Zemax file.

        Everything in the file that can have an effect and is ignored or replaced, such as a glass that no catalogue has, is
        a `UserWarning` with its line; `passed_over` has the same texts."""
        _core.require_input(path)
        compiled, notes = _core.CompiledPrescription.read_zmx(Path(path).read_bytes())
        for note in notes:
            warnings.warn(f"{path}: {note}", stacklevel=2)
        return cls._of(compiled, notes)

    @classmethod
    def from_zmx(cls, text: str | bytes) -> Prescription:
        """The prescription in the text of a Zemax file, or in its bytes in UTF-8, UTF-16 or Latin-1; with the warnings of
        `read_zmx`."""
        compiled, notes = _core.CompiledPrescription.read_zmx(text.encode() if isinstance(text, str) else text)
        for note in notes:
            warnings.warn(note, stacklevel=2)
        return cls._of(compiled, notes)

    def __eq__(self, other: object) -> bool:
        """By value; `passed_over` does not count."""
        if not isinstance(other, Prescription):
            return NotImplemented
        return self.surfaces == other.surfaces and self._keywords() == other._keywords()

    def __hash__(self) -> int:
        return hash((self.surfaces, self.fields, self.wavelengths_nm))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles its surfaces and keyword arguments."""
        return _restored, (self.surfaces, self._keywords(), self.passed_over)

    def to_zmx(self) -> str:
        """The text of a Zemax file, with the makers of all glasses that are named; a `Glass` becomes a model glass of its index
        and Abbe number."""
        return self._compiled.write_zmx()

    def write_zmx(self, path: str | Path) -> None:
        """Writes a Zemax file."""
        write_file(path, self.to_zmx())

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<Prescription{name}: {len(self.surfaces)} surfaces, {len(self.fields)} fields>"

    def __str__(self) -> str:
        """The aperture, fields and wavelengths, and the surfaces as a table."""
        try:
            clear = self._compiled.semi_diameters().tolist()
        except _core.RayweaveError:
            # surfaces that cross have no solids, so that only stated semi-diameters are known
            clear = [surface.semi_diameter for surface in self.surfaces]
        return prescription_text(self, clear)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """An error with a suggestion."""
            known = [own for own in dir(type(self)) if not own.startswith("_")]
            raise AttributeError(no_attribute("Prescription", name, known, _PRESCRIPTION_WORDS))

    @property
    def name(self) -> str:
        """Its name."""
        return str(self._compiled.frame()["name"])

    @property
    def notes(self) -> tuple[str, ...]:
        """Its source, and other remarks."""
        return tuple(self._compiled.frame()["notes"])

    @property
    def unit(self) -> str:
        """The unit of lengths."""
        unit_nm = self._compiled.frame()["unit_nm"]
        return next((name for name, nm in _UNIT_NM.items() if nm == unit_nm), f"{unit_nm} nm")

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """The surfaces; the first is number 1."""
        return tuple(Surface._of(row) for row in self._compiled.rows())

    @property
    def fields(self) -> tuple[tuple[float, float], ...]:
        """The points of the field, as pairs along x and y."""
        return tuple(self._compiled.frame()["fields"])

    @property
    def field_kind(self) -> str:
        """The kind of the fields: "angle", "object height" or "image height"."""
        return str(self._compiled.frame()["field_kind"])

    @property
    def entrance_pupil_diameter(self) -> float | None:
        """The diameter of the entrance pupil, if it states the aperture; None otherwise."""
        return self._stated_aperture("entrance_pupil_diameter")

    @property
    def f_number(self) -> float | None:
        """The F-number, if it states the aperture; None otherwise. `first_order` has that of any aperture."""
        return self._stated_aperture("f_number")

    @property
    def object_numerical_aperture(self) -> float | None:
        """The numerical aperture at the object, if it states the aperture; None otherwise."""
        return self._stated_aperture("object_numerical_aperture")

    @property
    def stop_semi_diameter(self) -> float | None:
        """The semi-diameter of the stop, if it states the aperture; None otherwise."""
        return self._stated_aperture("stop_semi_diameter")

    def _stated_aperture(self, kind: str) -> float | None:
        own, size = self._aperture()
        return size if own == kind else None

    def _aperture(self) -> tuple[str, float]:
        """The argument of the constructor that states the aperture, and its value."""
        kind, size = self._compiled.frame()["aperture"]
        return str(kind), float(size)

    @property
    def stop(self) -> int:
        """The number of the surface at the aperture stop, from 1."""
        return int(self._compiled.frame()["stop"])

    @property
    def image_radius(self) -> float:
        """The radius of the image surface; inf for a plane."""
        return float(self._compiled.frame()["image"][0])

    @property
    def image_conic(self) -> float:
        """The conic constant of the image surface."""
        return float(self._compiled.frame()["image"][1])

    @property
    def image_semi_diameter(self) -> float | None:
        """The semi-diameter of the image surface, if it is stated."""
        size = self._compiled.frame()["image"][2]
        return None if size is None else float(size)

    @property
    def object_distance(self) -> float:
        """The distance from the object to the first surface; inf for distant objects."""
        return float(self._compiled.frame()["object_distance"])

    @property
    def breaks(self) -> tuple[CoordinateBreak, ...]:
        """The breaks of the axis, with matrices."""
        rows = self._compiled.frame()["breaks"]
        return tuple(CoordinateBreak(before, matrix=tuple(map(tuple, matrix))) for before, matrix in rows)

    @property
    def wavelengths_nm(self) -> tuple[float, ...]:
        """The wavelengths in nanometres."""
        return tuple(line[0] for line in self._compiled.frame()["lines"])

    @property
    def weights(self) -> tuple[float, ...]:
        """The weights of the wavelengths."""
        return tuple(line[1] for line in self._compiled.frame()["lines"])

    @property
    def primary(self) -> int:
        """The number of the primary wavelength, from 0; `primary_nm` is its value."""
        return int(self._compiled.frame()["primary"])

    @property
    def primary_nm(self) -> float:
        """The primary wavelength in nanometres."""
        return float(self._compiled.frame()["primary_nm"])

    def replace(self, surfaces: Iterable[Surface] | None = None, **changes: Any) -> Prescription:
        """The same prescription with other surfaces, or with other values of the constructor's keyword arguments."""
        keywords = self._keywords()
        if set(changes) & _APERTURES:
            keywords = {name: value for name, value in keywords.items() if name not in _APERTURES}
        if "wavelengths_nm" in changes:
            keywords["weights"] = None
        return Prescription(self.surfaces if surfaces is None else surfaces, **{**keywords, **changes})

    def _keywords(self) -> dict[str, Any]:
        """The keyword arguments of the constructor."""
        frame = self._compiled.frame()
        kind, size = frame["aperture"]
        return {
            **{name: frame[name] for name in _KEPT},
            "unit": self.unit,
            "wavelengths_nm": [line[0] for line in frame["lines"]],
            "weights": [line[1] for line in frame["lines"]],
            **dict(zip(("image_radius", "image_conic", "image_semi_diameter"), frame["image"], strict=True)),
            "breaks": self.breaks,
            kind: size,
        }

    def with_surface(self, number: int, **changes: Any) -> Prescription:
        """The same prescription with changes to one surface, counted from 1: its `radius`, `thickness`, `behind`,
        ..."""
        rows = list(self.surfaces)
        if not 1 <= whole(number, "number", least=-(2**63)) <= len(rows):
            raise _core.RayweaveError(f"there is no surface {number}: there are {len(rows)}, counted from 1.")
        rows[number - 1] = replace(rows[number - 1], **changes)
        return self.replace(rows)

    # first order

    def first_order(
        self, wavelength_nm: float | None = None, *, along: Literal["x", "y"] = "y"
    ) -> FirstOrder:
        """Focal lengths, principal planes and pupils at a wavelength, by default the primary one.

        `along` selects the meridian for surfaces that are not of revolution: the data use the curvatures at the
        vertices along it.
        """
        table = self._compiled.first_order(self._wavelength(wavelength_nm), text(along, "along", '"x" or "y"'))
        matrix = np.array(table.pop("matrix")).reshape(2, 2)
        entrance, exit_pupil = (Pupil(*table.pop(name)) for name in ("entrance_pupil", "exit_pupil"))
        found = FirstOrder(matrix=matrix, entrance_pupil=entrance, exit_pupil=exit_pupil, **table)
        aperture = self._aperture_at_image(found, found.entrance_pupil)
        return replace(
            found,
            total_track=float(sum(surface.thickness for surface in self.surfaces)),
            working_f_number=0.5 / aperture if aperture > 0.0 else float("inf"),
            image_height=self._image_height(found),
            unit=self.unit,
        )

    def seidel(self) -> Seidel:
        """The Seidel sums of every surface at the primary wavelength: wavefront aberrations in the unit of lengths, for the
        last field. `Seidel` states their definitions."""
        return Seidel.of(self._compiled.seidel(), self.unit)

    # solids

    def elements(self) -> list[Element]:
        """The lenses, mirrors, stop and image as elements of a system, to which others can be added.

        A stop in a medium is a plane sheet, `stop`, out to twice the largest clear semi-diameter, that of the image included. In a
        narrower mount, replace it by an `aperture_stop`: the sheet would absorb the light beside the mount as well.

        A stop on a lens is a ring on that face, from its clear semi-diameter (`semi_diameters`: the stated one, or the extent of the
        rays of all fields plus 2 %) to the edge of the lens. A plane `mount` around the lens blocks light beside it, except in
        systems where it could block other light (mirrors, coordinate breaks, nested lenses). If the rim of a mirror, or of the widest
        lens, is the stop, there is neither a ring nor a mount.

        >>> import rayweave.optics as ro
        >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
        >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5], stop=2)
        >>> [element.name for element in lens.elements()]
        ['lens 1-2', 'stop', 'image']
        """
        return [_element(*part) for part in self._compiled.parts()]

    def system(self) -> System:
        """The system of its solids, for light that may hit the surfaces in any order."""
        return System(self.elements(), unit=cast(_Unit, self.unit))

    def semi_diameters(self) -> NDArray[np.float64]:
        """The clear semi-diameters of the surfaces; the last is that of the image. Those that are not stated are the extent of
        the rays of all fields plus 2 %. The image among `elements` is wider, so that it catches rays out of focus."""
        found = self._compiled.semi_diameters()
        if self._compiled.frame()["image"][2] is None:
            rings = pupil_grid("hexapolar", RINGS)
            images = [self._drawn_arrivals(field, rings, line) for field in range(len(self.fields)) for line in self.wavelengths_nm]
            found[-1] = 1.02 * max(float(np.hypot(image["x"], image["y"]).max(initial=0.0)) for image in images) or found[-1]
        return found

    def _drawn_arrivals(self, field: int, pupil: NDArray[np.float64], line: float) -> Rays:
        """The rays on the image at one wavelength, aimed where this is needed."""
        return self.arrivals(field, wavelength_nm=line, pupil=pupil, aimed=self._compiled.needs_aiming(field, line))

    def rays(
        self,
        field: int = 0,
        *,
        wavelength_nm: float | None = None,
        pupil: ArrayLike | None = None,
        rings: int = RINGS,
        aimed: bool = False,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origins and directions (N, 3) of the rays of a field, for `System.trace_rays`.

        They go through the points `pupil` (N, 2) of the entrance pupil in units of its semi-diameter, by default a
        hexapolar grid; if `aimed`, through those points of the stop.
        """
        line = self._wavelength(wavelength_nm)
        return self._compiled.rays(whole(field, "field"), line, _pupil(pupil, rings), flag(aimed, "aimed"))

    # real rays

    def chief_ray_pupil_point(self, field: int = 0, *, wavelength_nm: float | None = None) -> tuple[float, float]:
        """The point of the paraxial entrance pupil, in units of its semi-diameter, through which the chief (principal)
        ray of a field goes, the ray to the centre of the stop; (0, 0) without pupil aberration."""
        return self._compiled.chief_ray_pupil_point(whole(field, "field"), self._wavelength(wavelength_nm))

    def arrivals(
        self,
        field: int = 0,
        *,
        wavelength_nm: float | None = None,
        pupil: ArrayLike | None = None,
        rings: int = RINGS,
        aimed: bool = False,
    ) -> Rays:
        """The rays of a field on the image, at one wavelength or, by default, at all of them with their weights.

        The rays go through points of the pupil, by default hexapolar rings, for drawings. The power of a ray is the
        weight of its wavelength times the internal transmittance of the glasses; surfaces reflect nothing. The result
        contains only rays that pass the surfaces in order, not those that are vignetted or lost. Rays that
        are not `aimed` at the stop are refused where the real entrance pupil of the field is far from the paraxial one.

        Without `pupil`, `Rays.spot` and `Rays.best_focus` are means over the pupil by `pupil_quadrature(rings)`, whose
        rays are traced when they are needed; with `pupil` they are means of the given rays, weighted by power. If a ray
        of the field is vignetted, the quadrature, which needs a clear pupil, is replaced by 4096 points or more that are
        even in area: RMS radii are then exact to about 1 %.
        """
        self._needs_real_object()
        line = None if wavelength_nm is None else self._wavelength(wavelength_nm)
        points, number, aims = _pupil(pupil, rings), whole(field, "field"), flag(aimed, "aimed")
        found = self._compiled.arrivals(number, line, points, aims)
        lines = len(self.wavelengths_nm) if line is None else 1
        sample = PupilSample(
            lambda places: self._compiled.arrivals(number, line, places, aims),
            lines,
            rings,
            is_clear=len(found.columns()["id"]) == lines * len(points),
            given=None if pupil is None else (len(points), found),
        )
        return Rays(found, self.unit, sample)

    def spots(
        self,
        *,
        wavelength_nm: float | None = None,
        rings: int = RINGS,
        shift: float = 0.0,
        aimed: bool = False,
    ) -> Spots:
        """The spots of all fields, with centroid, RMS and geometric radius, on the image plane moved along the axis by
        `shift`.

        Centroids and RMS radii are means over the area of the pupil, from 2 rings (rings + 2) rays per wavelength
        (`pupil_quadrature`), weighted by wavelength and internal transmittance; for a field with vignetted rays, from 4096
        or more rays that are even in area, exact to about 1 %. The column `transmitted` is the fraction of the pupil whose
        rays arrive. The points of the diagram and the
        geometric radius are those of hexapolar rings, 1 + 3 rings (rings + 1) rays per wavelength.
        """
        rays = self._images(wavelength_nm, None, aimed, rings)
        distance = real(shift, "shift")
        moved = [image.moved(distance) if distance else image for image in rays]
        cutoff = self._cutoff(wavelength_nm)
        # the first zero of the Airy pattern: 1.22 wavelengths times the F-number (Goodman, section 4.4)
        airy = 1.2196698912665045 / cutoff if cutoff > 0.0 else 0.0
        return Spots.of(moved, self.fields, self.unit, titles=self._field_names(), airy_radius=airy)

    def fans(
        self,
        *,
        wavelength_nm: float | None = None,
        count: int = 41,
        aimed: bool = False,
        reference: Literal["primary", "same"] = "primary",
    ) -> Fans:
        """Transverse ray aberrations of all fields along both axes of the pupil, at one wavelength or, by default, at
        all of them.

        They are measured from the ray through the centre of the paraxial entrance pupil or, if rays are `aimed`, of the stop,
        which is the chief ray: at the primary wavelength, as in Zemax, so that the curves of other wavelengths show lateral
        colour at the centre of the pupil; or with `reference="same"` at the wavelength of the fan, so that all curves go
        through 0."""
        self._needs_real_object()
        lines = self.wavelengths_nm if wavelength_nm is None else (self._wavelength(wavelength_nm),)
        if text(reference, "reference") not in ("primary", "same"):
            unknown("reference of ray fans", reference, ("primary", "same"))
        found = []
        for field in range(len(self.fields)):
            for line in lines:
                about = self.primary_nm if reference == "primary" else line
                for along, kind in enumerate(_FANS):
                    at, errors = self._compiled.fan(field, line, about, pupil_grid(kind, count), flag(aimed, "aimed"))
                    found.append((field, line, along, at[:, along], errors))
        return Fans.of(found, self.unit, self._field_names())

    def wavefront(
        self,
        field: int = 0,
        *,
        wavelength_nm: float | None = None,
        pupil: ArrayLike | None = None,
        across: int = 33,
        aimed: bool = False,
    ) -> Wavefront:
        """Optical path differences in waves, on a square grid with `across` points across the pupil unless points (N, 2) of
        it are given. The grid is that of the table, of drawings and of Zernike fits; `Wavefront.rms` and `strehl` do not depend
        on it: they are means over the pupil by `pupil_quadrature`, whose rays are traced when they are needed. With `pupil`
        they are those of the given points."""
        self._needs_real_object()
        points = pupil_grid("square", whole(across, "across", least=1)) if pupil is None else array(pupil, "pupil")
        number, line, aims = whole(field, "field"), self._wavelength(wavelength_nm), flag(aimed, "aimed")
        at, waves = self._compiled.wavefront(number, line, points, aims)

        def both() -> tuple[float, float]:
            is_clear = len(waves) == len(points)
            return pupil_deviations(lambda places: self._compiled.wavefront(number, line, places, aims), is_clear)

        return Wavefront.of(at, waves, both if pupil is None else None)

    def encircled_energy(
        self,
        radii: ArrayLike | None = None,
        *,
        wavelength_nm: float | None = None,
        across: int | None = None,
        aimed: bool = False,
    ) -> Energy:
        """The fraction of the power of every field within circles about its centroid, without diffraction; from 4096 rays for
        each wavelength, even in the area of the pupil, or with `across` from a square grid of that many rays across it.
        Fractions are exact to about 0.001 without vignetting."""
        rays = self._images(wavelength_nm, _square(across), aimed)
        if radii is None:
            radii = np.linspace(0.0, max(image.spot().geometric for image in rays), 101)
        return Energy.of(rays, array(radii, "radii"), self.unit).named(self._field_names())

    @_for_frequencies
    def geometric_mtf(
        self,
        frequencies: ArrayLike | None = None,
        *,
        wavelength_nm: float | None = None,
        across: int | None = None,
        aimed: bool = False,
    ) -> Modulation:
        """The geometric modulation transfer function of every field: the modulation of lines by the spots of rays
        alone, without diffraction, by frequency in cycles per unit of length: `tangential` for lines across the
        direction of the field, `sagittal` for those along it. It is a good approximation where aberrations are much
        larger than a wavelength, and too high near the diffraction limit, which a real lens cannot exceed. `limit` is
        the diffraction MTF of a lens without aberrations, on the axis, for a circular pupil and the paraxial F-number of the
        image (J. W. Goodman, Introduction to Fourier Optics, section 6.4): at the wavelength or, by default, the mean over all
        of them with their weights.

        Modulations are means over the area of the pupil by `pupil_quadrature`, whose rings are doubled, from 6 up to 96, until
        they change by less than 1e-4; for a field with vignetted rays, from 4096 rays that are even in area, exact to about
        0.01. With `across`, the rays form a square grid with that many rays across the pupil and count equally."""
        rays, cutoff = self._images(wavelength_nm, _square(across), aimed), self._cutoff(wavelength_nm)
        if frequencies is None:
            # the frequency at which the modulation of the smallest spot vanishes
            least = min(image.spot().rms for image in rays)
            frequencies = _frequencies(min(cutoff, 0.3 / least) if least > 0.0 else cutoff)
        wanted = np.atleast_1d(array(frequencies, "frequencies"))
        limit = self._limit(wanted, wavelength_nm)
        return Modulation.of(rays, self.fields, wanted, limit, self.unit).named(self._field_names())

    @_for_frequencies
    def mtf(
        self,
        frequencies: ArrayLike | None = None,
        *,
        wavelength_nm: float | None = None,
        across: int | None = None,
        aimed: bool = False,
    ) -> Modulation:
        """The short name of `geometric_mtf`, without diffraction; `diffraction_mtf` includes it."""
        return self.geometric_mtf(frequencies, wavelength_nm=wavelength_nm, across=across, aimed=aimed)

    @_for_frequencies
    def diffraction_mtf(
        self,
        frequencies: ArrayLike | None = None,
        *,
        wavelength_nm: float | None = None,
        across: int | None = None,
        aimed: bool = False,
    ) -> DiffractionModulation:
        """The modulation transfer function of every field with diffraction, by frequency in cycles per unit of length:
        `tangential` for lines across the direction of the field, `sagittal` for those along it, `limit` that of a lens
        without aberrations for the same light, as in `geometric_mtf`; at one wavelength or, by default, at all of them with
        their weights. The frequencies end at the cutoff of the limit by default, several times what most sensors
        resolve: pass, for example, `np.linspace(0, 100, 51)`.

        The optical transfer function is the autocorrelation of the pupil function, and the Fourier transform of the
        square of the modulus of its transform (J. W. Goodman, Introduction to Fourier Optics, section 6.3). The pupil
        function has the phase of `wavefront` and equal amplitudes where light arrives, on `across` cells across the
        pupil, which is mapped to direction cosines at the image by the linear map that fits the rays best. The result
        is wrong by up to about 1 / across^1.5. `across` is 96 by default, and more for each field and wavelength whose
        wavefront changes by more than a quarter of a wave between two cells, up to 2048; with fewer cells such wavefronts
        are refused. At several wavelengths the transfer functions are added with their phases, so that lateral colour
        counts. Scalar diffraction: not for numerical apertures at the image above about 0.5."""
        self._needs_real_object()
        count = None if across is None else whole(across, "across", least=2, bits=31)
        aims = flag(aimed, "aimed")
        if count is not None and count > _MOST_CELLS:
            raise _core.RayweaveError(f"across is {count}: it must be at most {_MOST_CELLS}.")
        wanted = _frequencies(self._cutoff(wavelength_nm)) if frequencies is None else np.atleast_1d(array(frequencies, "frequencies"))
        if not np.isfinite(wanted).all():
            raise _core.RayweaveError("frequencies has a number that is not finite: a frequency is in cycles per unit of length.")
        lines = [(nm, weight) for nm, weight in self._compiled.frame()["lines"]]
        lines = [(self._wavelength(wavelength_nm), 1.0)] if wavelength_nm is not None else lines
        fields = [field if field != (0.0, 0.0) else (0.0, 1.0) for field in self.fields]
        units = [np.array([x, y]) / np.hypot(x, y) for x, y in fields]
        modulations = []
        for field, (x, y) in enumerate(units):
            vectors = np.concatenate([np.outer(wanted, [x, y]), np.outer(wanted, [y, -x])])
            found = sum(weight * self._transfer(field, nm, vectors, count, aims) for nm, weight in lines)
            modulations.append(np.abs(found) / sum(weight for _, weight in lines))
        parts = [np.concatenate(part) for part in zip(*(np.split(both, 2) for both in modulations), strict=True)]
        made = DiffractionModulation.from_parts(len(self.fields), wanted, parts[0], parts[1], self._limit(wanted, wavelength_nm), self.unit)
        return made.named(self._field_names())

    def _transfer(
        self, field: int, wavelength_nm: float, frequencies: NDArray[np.float64], across: int | None, aimed: bool
    ) -> NDArray[np.complex128]:
        """The optical transfer function at frequencies (N, 2), with the phase of the place of the image; on as many cells as
        the wavefront needs if `across` is None."""
        middle = self.arrivals(field, wavelength_nm=wavelength_nm, pupil=[[0.0, 0.0]], aimed=aimed)
        rays = self.arrivals(field, wavelength_nm=wavelength_nm, pupil=(points := pupil_quadrature()[0]), aimed=aimed)
        cells, needed = 0, across or _CELLS
        # the rim decides how steep a wavefront is: finer cells need more, but ever less
        while needed > cells:
            cells = needed
            front = self.wavefront(field, wavelength_nm=wavelength_nm, pupil=pupil_cells(cells), aimed=aimed)
            pupil = np.stack([front["pupil_x"], front["pupil_y"]], axis=1)
            if across is None and front.rows:
                needed = min(cells_for(steepest_step(pupil, front["waves"], cells), cells), _MOST_CELLS)
        if not rays.rows or not front.rows:
            raise _core.RayweaveError(f"no light of the field {field} arrives at the image: it has no transfer function.")
        tilts = np.stack([rays["x_tilt"], rays["y_tilt"]], axis=1)
        slopes = slopes_of_pupil(points[rays["id"]], tilts)
        # a frequency v is a difference of direction cosines of wavelength v / index
        unit_nm = float(self._compiled.frame()["unit_nm"])
        differences = frequencies * (wavelength_nm / unit_nm / float(middle["index"][0]))
        shifts: NDArray[np.float64] = np.asarray(np.linalg.solve(slopes, differences.T).T, float)
        place = np.array([middle["x"][0], middle["y"][0]])
        turn = np.exp(-2.0j * np.pi * (frequencies @ place))
        return np.asarray(turn * TransferFunction.of(pupil, front["waves"], cells).at(shifts))

    def through_focus(
        self,
        shifts: ArrayLike | None = None,
        *,
        wavelength_nm: float | None = None,
        rings: int = RINGS,
        aimed: bool = False,
    ) -> ThroughFocus:
        """The RMS radii of the spots of all fields, as those of `spots`, on planes moved along the axis by `shifts`."""
        rays = self._images(wavelength_nm, None, aimed, rings)
        if shifts is None:
            best = np.abs([image.best_focus() for image in rays])
            reach = 2.0 * float(best[np.isfinite(best)].max(initial=0.0))
            reach = reach or 1e-3 * abs(self.first_order().focal_length)
            shifts = np.linspace(-reach, reach, 41)
        return ThroughFocus.of(rays, array(shifts, "shifts"), self.unit).named(self._field_names())

    def refocused(self, *, wavelength_nm: float | None = None, rings: int = RINGS, aimed: bool = False) -> Prescription:
        """The same prescription with the image at the best focus: the thickness of the last surface is that with the
        smallest sum of the squares of the RMS radii of `spots` over all fields, at one wavelength or, by default, at
        all of them with their weights. It is known in closed form, without a search.

        >>> import rayweave.optics as ro
        >>> lens = ro.Prescription([ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)], entrance_pupil_diameter=10)
        >>> lens.spots()["rms"].round(3), lens.refocused().spots()["rms"].round(3)
        (array([0.074]), array([0.014]))
        """
        for at in self.breaks:
            if at.before == len(self.surfaces) + 1 and at.matrix is not None and abs(at.matrix[2][2] - 1.0) > 1e-12:
                raise _core.RayweaveError(
                    "the image is tilted by a coordinate break: refocused() moves it along its normal only. "
                    'Use optimise with the parameter "thickness N" of the last surface.'
                )
        lens, rows = self, list(self.surfaces)
        # on a plane image the first step is exact; on a curved one the error shrinks by a constant factor in each
        for _ in range(1 if np.isinf(self._compiled.frame()["image"][0]) else 20):
            rays = lens._images(wavelength_nm, None, aimed, rings)
            shift = best_shift(np.sum([image._means().focal_moments() for image in rays], axis=0))
            if not np.isfinite(shift):
                raise _core.RayweaveError("the light at the image is parallel: it has no best focus.")
            rows[-1] = replace(rows[-1], thickness=rows[-1].thickness + shift)
            lens = self.replace(rows)
            if abs(shift) <= 1e-12 * abs(rows[-1].thickness):
                break
        return lens

    def distortion(self, *, wavelength_nm: float | None = None, count: int = 21) -> Distortion:
        """The heights of real and paraxial chief rays on the image, over the field from the axis to its edge. Real
        rays are aimed at the centre of the stop. The reference is the paraxial chief ray at the same wavelength on the
        image surface as it stands, in or out of focus: for a distant object in focus, the focal length times the tangent
        of the field angle (W. T. Welford, Aberrations of Optical Systems, section 7.5)."""
        return Distortion.of(*self._principal(wavelength_nm, count))

    def vignetting(self, *, wavelength_nm: float | None = None, count: int = 21, aimed: bool = False) -> Vignetting:
        """The fraction of the entrance pupil whose rays reach the image, over the field from the axis to its edge, at one
        wavelength, by default the primary one; from 4096 rays for each field, even in area, through the solids of
        `elements`: a lens is as wide as the wider one of its two surfaces. If `aimed`, it is the fraction of the stop. Losses in glass and the fall of the
        irradiance towards the edge of the field are not included."""
        lens, sweep = self._swept(count)
        pupil, line = even_points(), self._wavelength(wavelength_nm)
        rays = [lens._compiled.arrivals(k, line, pupil, flag(aimed, "aimed")).columns()["id"] for k in range(count)]
        return Vignetting.of(sweep, np.array([len(ids) / len(pupil) for ids in rays]))

    def field_curvature(self, *, wavelength_nm: float | None = None, count: int = 41) -> FieldCurvature:
        """The tangential and the sagittal focus of thin pencils about the chief ray, the one through the centre of
        the stop, over the field from the axis to its edge: distances along the axis from the image (Coddington; W. T.
        Welford, Aberrations of Optical Systems, section 9.5)."""
        return FieldCurvature.of(*self._principal(wavelength_nm, count))

    def focal_shift(self, wavelengths_nm: ArrayLike | None = None, *, height: float = 0.001) -> FocalShift:
        """Longitudinal colour: where axial rays through a height in the pupil, in units of its semi-diameter, cross the
        axis, as distances from the image; by default the paraxial focus between the shortest and the longest
        wavelength. With height = 1 it is the focus of the marginal rays."""
        on_axis = self if self.fields[0] == (0.0, 0.0) else self.replace(fields=[(0.0, 0.0), *self.fields])
        if wavelengths_nm is None:
            wavelengths_nm = np.linspace(min(self.wavelengths_nm), max(self.wavelengths_nm), 31)
        lines, part = np.atleast_1d(array(wavelengths_nm, "wavelengths_nm")), real(height, "height")
        return FocalShift.of(lines, [on_axis._compiled.axial_focus(line, part) for line in lines], self.unit)

    def lateral_colour(self, *, count: int = 21) -> LateralColour:
        """Lateral colour: the heights of the chief rays of all wavelengths on the image, minus that of the primary
        wavelength, over the field from the axis to its edge. The rays are aimed at the centre of the stop."""
        lens, sweep = self._swept(count)
        shift = lens._compiled.lateral_colour
        found = [[shift(k, line) for k in range(count)] for line in self.wavelengths_nm]
        return LateralColour.of(sweep, self.wavelengths_nm, np.array(found))

    def show(self, *, ax: Axes | Plot | None = None, rays: int = 5, **options: Any) -> Plot:
        """Draws a section of the solids with rays of all fields in the plane x = 0, coloured by field; `options` are
        those of `Trace.show`. Only rays that pass the surfaces in order reach the image; vignetted ones end where they
        are absorbed, or beside the surface that they miss."""
        *radii, image = self.semi_diameters().tolist()
        # the image of a point on the axis would be invisible
        drawn = self.replace(image_semi_diameter=max(image, 0.05 * max(radii)))
        elements = drawn.elements()
        pupil = pupil_grid("fan_y", whole(rays, "rays", least=1, bits=31))
        fields = range(len(self.fields))
        bundles = [self.rays(k, pupil=pupil, aimed=self._compiled.needs_aiming(k, self.primary_nm)) for k in fields]
        origins, directions = (np.concatenate(parts) for parts in zip(*bundles, strict=True))
        # with a distant object the lens would be tiny in the drawing
        if self.object_distance > 2.0 * sum(abs(surface.thickness) for surface in self.surfaces):
            origins = _drawn_in(elements, origins, directions)
        trace = drawn.system().trace_rays(
            origins,
            directions,
            self.primary_nm,
            source=np.repeat(np.arange(len(bundles)), rays),
            generation_limit=4 * len(self.surfaces) + 8,
        )
        arriving = [k * rays + drawn._drawn_arrivals(k, pupil, self.primary_nm)["id"] for k in fields]
        trace = _in_order(trace, np.concatenate(arriving))
        # a stop on a lens is drawn as the edges of its opening
        hidden = () if self._has_stop_in_air() else ("stop", "mount")
        ax = trace._show(ax=ax, hidden=hidden, **{"color": "source", "rays": len(origins), **options})
        ends = np.concatenate([trace["y0"], trace["y1"][np.isfinite(trace["y1"])]])
        reach = 1.1 * max(float(self.semi_diameters()[:-1].max()), float(np.abs(ends).max()))
        ax.set_ylim(-reach, reach)
        self._draw_stop(ax)
        handle = package("matplotlib.lines", "drawings").Line2D
        shades = package("matplotlib", "drawings").colormaps["tab10"]
        if options.get("color", "source") == "source":
            handles = [handle([], [], color=shades(k % 10), label=name) for k, name in enumerate(self._field_names())]
            ax.legend(handles=handles, fontsize="small", title="field", loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
        ax.set_xlabel(f"z, {self.unit}")
        ax.set_ylabel(f"y, {self.unit}")
        ax.set_title(self.name)
        return Plot(ax)

    def drawing(
        self, lens: int | Element | tuple[int, int] = 1, *, title: str = "", indications: Mapping[str, str] | None = None
    ) -> Drawing:
        """The drawing of one lens, counted from 1 in the order of the light, or given as one of `elements`, in the tabular form
        of ISO 10110-1: a section with diameter and centre thickness, and radii, clear diameters and glass. A pair of numbers is the
        first and the last of cemented lenses, which are drawn on one sheet.

        `indications` are texts of fields that a prescription does not have; without them, the fields are empty. A lens has
        tolerances behind "thickness", "diameter", "left radius" and "right radius", the fields "left chamfer", "left coating",
        "left 3/", "left 4/", "left 5/", "left 6/", the same on the "right", and "0/", "1/", "2/" of the material. Cemented lenses have
        "thickness", "diameter", "cement", "4/", "5/" and "note".

        `save` writes the drawing as .svg; the command `rayweave optics lens.zmx --drawing lens.pdf --element 2` also writes .pdf, .png
        and .jpg.

        >>> import rayweave.optics as ro
        >>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
        >>> lens = ro.Prescription(surfaces, entrance_pupil_diameter=10)
        >>> drawing = lens.drawing(1, indications={"left 3/": "2(0.5)", "thickness": "± 0.05"})
        >>> "R 50 CX" in drawing.svg, "3/ 2(0.5)" in drawing.svg
        (True, True)
        """
        first: object = lens
        last: object = lens
        if isinstance(lens, tuple):
            if len(lens) != 2:
                raise TypeError(f"lens is {lens!r}: it must be a number, or the first and the last number of cemented lenses.")
            first, last = lens
        if isinstance(lens, Element):
            lenses = [name for name, *_ in self._compiled.parts() if name.startswith("lens ")]
            if lens.name not in lenses:
                raise _core.RayweaveError(f"{lens.name!r} is no lens of the prescription: the lenses are {', '.join(lenses)}.")
            first = last = lenses.index(lens.name) + 1
        texts = [(text(name, "a field"), text(own, f"the text of {name!r}")) for name, own in (indications or {}).items()]
        numbers = whole(first, "lens", least=1), whole(last, "lens", least=1)
        return Drawing(self._compiled.drawing(*numbers, text(title, "title"), texts))

    def _has_stop_in_air(self) -> bool:
        """True if the medium is the same on both sides of the stop."""
        behind = ["air", *(surface.behind for surface in self.surfaces)]
        return behind[self.stop - 1] == behind[self.stop]

    def _draw_stop(self, ax: Axes) -> None:
        """Draws the rim of the stop as two lines away from the axis."""
        number = int(self._compiled.frame()["stop"])
        if any(at.before <= number for at in self.breaks):
            return
        rows = self.surfaces
        stated = rows[number - 1].semi_diameter
        height = self.first_order().stop_semi_diameter if stated is None else stated
        curvature, conic = 1.0 / rows[number - 1].radius, rows[number - 1].conic
        root = 1.0 - (1.0 + conic) * (curvature * height) ** 2
        if not (np.isfinite(height) and root >= 0.0):
            return
        terms = sum(term * height ** (2 * k + 2) for k, term in enumerate(rows[number - 1].even))
        place = sum(row.thickness for row in rows[: number - 1]) + curvature * height**2 / (1.0 + np.sqrt(root)) + terms
        end = 1.35 * max(height, float(self.semi_diameters()[number - 1]))
        for side in (-1.0, 1.0):
            ax.plot([place, place], [side * height, side * end], color="black", linewidth=1.6, zorder=4)
        ax.annotate("stop", (place, end), xytext=(0, 2), textcoords="offset points", ha="center", va="bottom", fontsize="small")

    def _field_names(self) -> list[str]:
        """The fields with their unit, such as "14 deg"."""
        unit = "deg" if self._compiled.frame()["field_kind"] == "angle" else self.unit
        return [f"{y:.4g} {unit}" if x == 0.0 else f"({x:.4g}, {y:.4g}) {unit}" for x, y in self.fields]

    def _wavelength(self, wavelength_nm: float | None) -> float:
        return self.primary_nm if wavelength_nm is None else real(wavelength_nm, "wavelength_nm")

    def _needs_real_object(self) -> None:
        if self.object_distance < 0.0:
            problem = f"object_distance is {self.object_distance:g}: light would start behind surface 1."
            raise _core.RayweaveError(f"{problem} Check the sign: only first_order() accepts virtual objects.")

    def _images(
        self, wavelength_nm: float | None, pupil: ArrayLike | None, aimed: bool, rings: int = RINGS
    ) -> list[Rays]:
        fields = range(len(self.fields))
        options: dict[str, Any] = {"wavelength_nm": wavelength_nm, "pupil": pupil, "rings": rings, "aimed": aimed}
        return [self.arrivals(field, **options) for field in fields]

    def _swept(self, count: int) -> tuple[Prescription, Sweep]:
        """The same prescription with fields from the axis to the edge."""
        self._needs_real_object()
        whole(count, "count", least=1, bits=31)
        x, y = max(self.fields, key=lambda field: float(np.hypot(*field)))
        share = np.linspace(0.0, 1.0, count)
        is_angle = self._compiled.frame()["field_kind"] == "angle"
        sweep = Sweep(share, (x, y), "degrees" if is_angle else self.unit, self.unit)
        return self.replace(fields=[(part * x, part * y) for part in share.tolist()]), sweep

    def _principal(self, wavelength_nm: float | None, count: int) -> tuple[Sweep, NDArray[np.float64]]:
        """Heights and foci of the chief rays, over the field."""
        lens, sweep = self._swept(count)
        line = self._wavelength(wavelength_nm)
        return sweep, np.array([lens._compiled.principal(k, line) for k in range(count)])

    def _cutoff(self, wavelength_nm: float | None) -> float:
        """The frequency, per unit of length, above which a circular pupil transmits no modulation: 2 NA / wavelength; by
        default at the primary wavelength."""
        line = self._wavelength(wavelength_nm)
        # the diameter of the pupil is that at the primary wavelength, through which all rays are traced
        aperture = self._aperture_at_image(self.first_order(line), self.first_order().entrance_pupil)
        return 2.0 * aperture * float(self._compiled.frame()["unit_nm"]) / line

    def _limit(self, frequencies: NDArray[np.float64], wavelength_nm: float | None) -> NDArray[np.float64]:
        """The modulation of a lens without aberrations on the axis at a wavelength, or the weighted mean over all of them:
        the transfer functions of a lens in focus are positive and add."""
        lines = self._compiled.frame()["lines"] if wavelength_nm is None else [(wavelength_nm, 1.0)]
        found = np.zeros(len(frequencies))
        for nm, weight in lines:
            cutoff = self._cutoff(nm)
            # without an aperture at the image there is no modulation, except at 0
            share = frequencies / cutoff if cutoff > 0.0 else np.where(frequencies > 0.0, 1.0, 0.0)
            found += weight * diffraction_limit(np.asarray(share, float))
        return np.asarray(found / sum(weight for _, weight in lines))

    def _aperture_at_image(self, first_order: FirstOrder, pupil: Pupil) -> float:
        """The paraxial numerical aperture: the index times the slope of the marginal ray behind the last surface."""
        height, slope = 0.5 * pupil.diameter, 0.0
        if np.isfinite(distance := self.object_distance):
            slope = height / (pupil.position + distance)
            height = slope * distance
        return abs(float(first_order.matrix[1] @ [height, slope]))

    def _image_height(self, first_order: FirstOrder) -> float:
        """The height of the paraxial image of the outermost field."""
        edge = max(float(np.hypot(*field)) for field in self.fields)
        kind = self._compiled.frame()["field_kind"]
        if kind == "image height":
            return edge
        if kind == "object height":
            return abs(first_order.magnification) * edge
        slope = float(np.tan(np.radians(edge)))
        if np.isfinite(distance := self.object_distance):
            return abs(first_order.magnification) * abs(distance + first_order.entrance_pupil.position) * slope
        return abs(first_order.focal_length) * slope


_PRESCRIPTION_WORDS = {
    "refocus": "refocused()",
    "quick_focus": "refocused()",
    "best_focus": "refocused()",
    "focus": "refocused()",
    "efl": "first_order().focal_length",
    "effl": "first_order().focal_length",
    "effective_focal_length": "first_order().focal_length",
    "save": "write_zmx(path)",
    "load": "Prescription.read_zmx(path)",
    "focal_length": "first_order().focal_length",
    "bfl": "first_order().back_focal_distance",
    "epd": "entrance_pupil_diameter",
    "na": "object_numerical_aperture",
    "wavelengths": "wavelengths_nm",
    "paraxial": "first_order()",
    "psf": "diffraction_mtf(), which includes diffraction, or spots(), which does not",
    "fft_psf": "diffraction_mtf()",
    "fft_mtf": "diffraction_mtf()",
    "spot": "spots()",
    "spot_diagram": "spots().show()",
    "opd": "wavefront()",
    "ray_fan": "fans()",
    "fan": "fans()",
    "draw": "show()",
    "layout": "show()",
    "plot": "show()",
    "optimise": "rayweave.optics.optimise(lens, parameters, goals)",
    "optimize": "rayweave.optics.optimise(lens, parameters, goals)",
    "tolerance": "rayweave.optics.tolerance(lens, errors)",
    "object_height": "fields",
    "lateral_color": "lateral_colour()",
}

def _restored(surfaces: tuple[Surface, ...], keywords: dict[str, Any], passed_over: tuple[str, ...]) -> Prescription:
    """A prescription from its pickle."""
    lens = Prescription(surfaces, **keywords)
    lens.passed_over = passed_over
    return lens


_KEPT = ("name", "notes", "field_kind", "fields", "primary", "object_distance", "stop")
_APERTURES = {"entrance_pupil_diameter", "f_number", "object_numerical_aperture", "stop_semi_diameter"}


def _aperture(**given: float | None) -> tuple[str, float]:
    stated = [(kind, real(size, kind)) for kind, size in given.items() if size is not None]
    if len(stated) != 1:
        found = f"is given by {', '.join(kind for kind, _ in stated)}" if stated else "is missing"
        raise _core.RayweaveError(f"the aperture {found}: pass one of {', '.join(given)}.")
    return stated[0]


def _field(field: float | tuple[float, float]) -> tuple[float, float]:
    match array(field, "a field").tolist():
        case [float() as x, float() as y]:
            return x, y
        case float() as y:
            return 0.0, y
        case other:
            raise _core.RayweaveError(f"a field is {other}: it must be a number along y or a pair along x and y.")


def _lines(wavelengths: list[float], weights: Iterable[float] | None) -> list[tuple[float, float]]:
    shares = [1.0] * len(wavelengths) if weights is None else numbers(weights, "weights")
    if len(shares) != len(wavelengths):
        counts = f"{len(wavelengths)} wavelengths and {len(shares)} weights"
        raise _core.RayweaveError(f"{counts} are given: each wavelength needs one.")
    return list(zip(wavelengths, shares, strict=True))


def _unit_nm(unit: str) -> float:
    if text(unit, "unit", ", ".join(_UNIT_NM)) not in _UNIT_NM:
        raise _core.RayweaveError(f"unit is {unit!r}: it can be {', '.join(_UNIT_NM)}.")
    return _UNIT_NM[unit]


#: The default number of cells across the pupil.
_CELLS = 96
#: The limit of cells across the pupil: 3 million rays, and Fourier transforms of 4096 x 4096 points.
_MOST_CELLS = 2048


def _frequencies(most: float) -> NDArray[np.float64]:
    """Frequencies from 0 to the next round number, with round steps."""
    scale = 10.0 ** np.floor(np.log10(most))
    top = next(part for part in (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0) if part * scale >= most * (1.0 - 1e-9))
    return np.linspace(0.0, top * scale, 51)


def _square(across: int | None) -> NDArray[np.float64] | None:
    """A square grid of the pupil; `None` for the rays that suit the analysis."""
    return None if across is None else pupil_grid("square", whole(across, "across", least=1))


def _pupil(pupil: ArrayLike | None, rings: int) -> NDArray[np.float64]:
    if pupil is None:
        return pupil_grid("hexapolar", whole(rings, "rings", bits=31))
    return array(pupil, "pupil")


def _element(name: str, body: Any, material: Any, spec: Any, faces: Any) -> Element:
    finish = Finish(spec[0], tuple(spec[1]))
    if isinstance(body, Sheet):
        return Element(name, body, action=finish, place=body.frame())
    own = tuple((face, Finish(kind, tuple(numbers))) for face, (kind, numbers) in faces)
    return Element(name, body, material, finish, own)


def _in_order(trace: Trace, arriving: NDArray[np.int64]) -> Trace:
    """The segments of rays up to the first event out of order; `arriving` are the numbers of the rays that reach the image
    in order. A ray that misses a surface ends at the height along z of the others there."""
    escaped, passed, absorbed = (_core.event_names().index(name) for name in ("escaped", "passed", "absorbed"))
    columns = {name: np.array(column) for name, column in trace.columns.items()}
    element, event, kept = columns["element"], columns["event"], np.zeros(trace.rows, bool)
    if not len(arriving):
        kept = event != escaped
        return Trace(trace.system, {name: column[kept] for name, column in columns.items()}, None)

    def chain(ray: int) -> list[int]:
        rows = np.flatnonzero(columns["id"] == ray)
        return [int(row) for row in rows[np.argsort(columns["generation"][rows], kind="stable")]]

    model = [row for row in chain(int(arriving[0])) if event[row] != escaped]
    image = element[model[-1]]
    model = [row for row in model if event[row] != passed or element[row] == image]
    for ray in np.unique(columns["id"]).tolist():
        place = 0
        for row in chain(ray):
            if place == len(model):
                break
            if element[row] == element[model[place]] and event[row] != escaped:
                place += 1
            elif event[row] != passed or element[row] == image:
                # what absorbs the ray is where it ends
                kept[row] = event[row] == absorbed or _cut(columns, row, float(columns["z1"][model[place]]))
                break
            kept[row] = True
    return Trace(trace.system, {name: column[kept] for name, column in columns.items()}, None)


def _cut(columns: dict[str, NDArray[Any]], row: int, z: float) -> bool:
    """Ends a segment at a height along z, if it is on its way there; otherwise false."""
    start, end, along = (np.array([columns[name.format(axis)][row] for axis in "xyz"]) for name in ("{}0", "{}1", "{}_tilt"))
    length = (z - start[2]) / along[2] if along[2] != 0.0 else -1.0
    # the end of a ray that escapes is NaN
    if length <= 0.0 or length > np.linalg.norm(end - start):
        return False
    for axis, place in zip("xyz", start + length * along, strict=True):
        columns[f"{axis}1"][row] = place
    return True


def _drawn_in(
    elements: list[Element], origins: NDArray[np.float64], directions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The same rays, starting slightly in front of all elements."""
    boxes = np.array([part.body.bounds for part in elements if isinstance(part.body, Solid)])
    low, high = boxes[:, 0, 2].min(), boxes[:, 1, 2].max()
    length = (low - 0.2 * (high - low) - origins[:, 2]) / directions[:, 2]
    return np.asarray(origins + length[:, None] * directions)
