"""Elements of optical systems: solids of a material, and sheets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Glass, GradedMedium, Sheet, Solid
from rayweave._recipe import record_all, recorded, reduced
from rayweave._table import table_of
from rayweave._words import suggesting
from rayweave.optics._given import each, finite, flag, numbers, pair, real, text, unknown, whole
from rayweave.optics._place import Placed

#: The d line of helium.
_D_NM = 587.5618

#: A glass, the name of one, a constant index (complex if it absorbs), a medium with a gradient, "mirror" or "absorber". What has an
#: extinction coefficient k above a tenth of its index n is a metal: it reflects by Fresnel's formulas and absorbs the rest. This is
#: decided once, in yellow light (587.5618 nm) or, for a glass that has no index there, in the middle of its `range_nm`.
Material = Glass | GradedMedium | str | float | complex

#: A diameter, a width and a height (negative ones for an ellipse, as in PyRayT), or a kind with its sizes:
#: ("circle", d), ("rectangle", w, h), ("ellipse", w, h).
Aperture = float | tuple[float, float] | tuple[str, float] | tuple[str, float, float]

_Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Finish:
    """The effect of a face on light; created by `polished`, `coated`, `reflecting`, `splitting`, `diffuse`, `rough`,
    `black`.

    Where faces of two elements touch, the finish of the element that light enters applies or, if that is polished, the
    finish of the element that it leaves.

    >>> import rayweave.optics as ro
    >>> ro.reflecting(0.9)
    Finish(kind='mirror', numbers=(0.9,))
    """

    kind: str
    numbers: _Numbers = ()

    def _spec(self) -> tuple[str, list[float]]:
        return self.kind, [real(number, f"a number of the finish {self.kind!r}") for number in self.numbers]


def polished() -> Finish:
    """Refraction and reflection as the two media require, by the Fresnel equations.

    >>> import rayweave.optics as ro
    >>> ro.polished()
    Finish(kind='polished', numbers=())
    """
    return Finish("polished")


def black() -> Finish:
    """Absorbs all light.

    >>> import rayweave.optics as ro
    >>> ro.black()
    Finish(kind='absorber', numbers=())
    """
    return Finish("absorber")


def reflecting(reflectance: float = 1.0) -> Finish:
    """Reflects a fraction of the power, from 0 to 1, and absorbs the rest.

    >>> import rayweave.optics as ro
    >>> ro.reflecting(0.95)
    Finish(kind='mirror', numbers=(0.95,))
    """
    return Finish("mirror", (real(reflectance, "reflectance"),))


def splitting(reflectance: float = 0.5) -> Finish:
    """Reflects a fraction of the power, from 0 to 1, and transmits the rest.

    >>> import rayweave.optics as ro
    >>> ro.splitting(0.3)
    Finish(kind='splitter', numbers=(0.3,))
    """
    return Finish("splitter", (real(reflectance, "reflectance"),))


def diffuse(reflectance: float = 1.0) -> Finish:
    """Scatters a fraction of the power back by Lambert's cosine law and absorbs the rest.

    >>> import rayweave.optics as ro
    >>> ro.diffuse(0.9)
    Finish(kind='diffuse', numbers=(0.9,))
    """
    return Finish("diffuse", (real(reflectance, "reflectance"),))


def rough(slope: float) -> Finish:
    """Polished facets whose slopes have a Gaussian distribution of this standard deviation along each axis.

    >>> import rayweave.optics as ro
    >>> ro.rough(0.05)
    Finish(kind='rough', numbers=(0.05,))
    """
    return Finish("rough", (real(slope, "slope"),))


#: A thin film: its index (complex if it absorbs) and its thickness in nanometres, or n, k and thickness as in model files.
Film = tuple[complex, float] | tuple[float, float, float] | Sequence[float]


def coated(*films: Film | Sequence[Film]) -> Finish:
    """Thin films, the outermost first: pairs of an index (complex if it absorbs) and a thickness in nanometres, or triples of
    n, k and the thickness, as in model files; one by one or as a list.

    >>> import rayweave.optics as ro
    >>> ro.coated((1.38, 100.0))
    Finish(kind='coated', numbers=(1.38, 0.0, 100.0))
    >>> ro.coated([[1.38, 0, 100.0]]) == ro.coated((1.38, 100.0))
    True
    """
    first: Any = films[0] if len(films) == 1 and isinstance(films[0], Sequence) else ()
    is_list = len(first) > 0 and all(isinstance(film, Sequence) for film in first)
    given: Any = first if is_list else films
    return Finish("coated", tuple(number for film in given for number in _film(film)))


def _film(film: Film) -> _Numbers:
    match film:
        case (n, thickness_nm):
            index = _index(n, "the index of a film")
            return index.real, index.imag, real(thickness_nm, "the thickness of a film")
        case (n, k, thickness_nm):
            extinction, thickness = real(k, "the extinction of a film"), real(thickness_nm, "the thickness of a film")
            return real(n, "the index of a film"), extinction, thickness
    needed = "a pair of its index and its thickness in nanometres, or n, k and the thickness"
    raise TypeError(f"a film is {film!r}: it must be {needed}.")


@dataclass(frozen=True, eq=False, repr=False)
class Element(Placed):
    """A part of an optical system; created by `element`, `lens`, `spherical_mirror`, `detector`, ... Immutable.

    `place` maps the coordinates in which the element was created to those of the world.

    Maps are about the origin and return a new element: `e.rotate_x(90).translate(v)` rotates first. The original
    element stays where it is.

    >>> import rayweave.optics as ro
    >>> lens = ro.biconvex_lens(50, 50, 5, aperture=25.0).named("eye").translate([0, 0, 10])
    >>> lens.name, lens.place[:3, 3].tolist()
    ('eye', [0.0, 0.0, 10.0])
    """

    name: str
    body: Solid | Sheet
    material: Material = "absorber"
    finish: Finish = field(default_factory=polished)
    faces: tuple[tuple[str, Finish], ...] = ()
    action: Finish | None = None
    place: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    #: The element as read from a model file, which contains more than the fields above.
    read: _core.ReadElement | None = None

    def __post_init__(self) -> None:
        # report invalid arguments here, where the caller passes them
        text(self.name, "name")
        if not isinstance(self.body, Solid | Sheet):
            kind = type(self.body).__name__
            raise TypeError(f"the body of {self.name!r} is of the type {kind}: it must be a Solid.")
        if self.read is None and self.action is None:
            _substance(self.material, self.finish)

    def __reduce__(self) -> tuple[Any, ...]:
        return reduced(self)

    def __repr__(self) -> str:
        kind = f"solid of {self.material!r}" if isinstance(self.body, Solid) else "sheet"
        return f"<Element {self.name!r}: {kind}>"

    def _repr_html_(self) -> str:
        kind = "solid" if isinstance(self.body, Solid) else "sheet"
        finishes = {f"finish of {face}": finish.kind for face, finish in self.faces}
        about = {"material": self.material, "finish": self.finish.kind, **finishes, "position": self.place[:3, 3]}
        return table_of(f"Element {self.name!r}, a {kind}", about)

    @recorded
    def named(self, name: str) -> Self:
        """The same element with a different name, which results use."""
        return replace(self, name=name)

    @recorded
    def with_finish(self, finish: Finish, face: str | None = None) -> Self:
        """The same element with a finish on the faces of this name ("front", "front.side", ...), or on all faces
        without their own finish.

        The function that creates an element states the names of its faces: those of a lens are `front`, `back` and the
        rim `edge`. `System.surface_names` lists them with their parts. For elements that touch, see `Finish`.
        """
        if self.action is not None:
            raise _core.RayweaveError(f"{self.name} is a sheet: it has an action, not a finish.")
        if not isinstance(finish, Finish):
            raise TypeError(f"finish is {finish!r}: it must be a Finish. Make one with black(), polished() or coated(..).")
        if face is not None:
            text(face, "face", "the name of a face")
        if self.read is not None:
            return replace(self, read=self.read.with_finish(finish._spec(), face))
        if face is None:
            return replace(self, finish=finish)
        return replace(self, faces=(*self.faces, (face, finish)))

    @recorded
    def transform(self, matrix: ArrayLike) -> Self:
        """The image under an affine map: a 4 x 4 matrix world_from_local that acts on columns."""
        body = self.body.apply(matrix) if isinstance(self.body, Sheet) else self.body.transform(matrix)
        read = None if self.read is None else self.read.apply(matrix)
        return replace(self, body=body, place=np.asarray(matrix, float) @ self.place, read=read)

    def _part(self) -> tuple[Any, ...]:
        if self.read is not None:
            return self.name, self.read
        if isinstance(self.body, Sheet):
            return self.name, self.body, (self.action or Finish("absorb"))._spec()
        kind, substance, finish = _substance(self.material, self.finish)
        faces = [(face, own._spec()) for face, own in self.faces]
        return self.name, self.body, kind, substance, finish._spec(), faces


def _medium(material: Material) -> Glass | GradedMedium | tuple[float, float]:
    if isinstance(material, Glass | GradedMedium):
        return material
    if isinstance(material, str):
        return Glass(material)
    index = _index(material, "the material")
    return index.real, index.imag


def _index(index: Any, name: str) -> complex:
    try:
        n = complex(index)
    except (TypeError, ValueError):
        needed = "a number, complex if it absorbs, or a material"
        raise TypeError(f"{name} is {index!r}: it must be {needed}.") from None
    if not (0.0 < n.real < np.inf and 0.0 <= n.imag < np.inf):
        raise _core.RayweaveError(f"{name} is {index}: n must be greater than 0, k at least 0, and both finite.")
    return n


def _substance(material: Material, finish: Finish) -> tuple[str, Any, Finish]:
    if isinstance(material, str) and material in ("mirror", "absorber"):
        shiny = material == "mirror" and finish == polished()
        return "opaque", None, reflecting() if shiny else finish
    if isinstance(material, str) and (close := get_close_matches(material, ("mirror", "absorber"), 1, 0.8)):
        raise _core.RayweaveError(f"no material is named {material!r}: it is not a glass. Did you mean {close[0]!r}?")
    medium = _medium(material)
    if isinstance(medium, GradedMedium):
        return "transparent", medium, finish
    # a metal absorbs nearly all light within a wavelength
    index, extinction = _yellow(medium) if isinstance(medium, Glass) else medium
    return "metal" if extinction > 0.1 * index else "transparent", medium, finish


def _yellow(glass: Glass) -> tuple[float, float]:
    """The index and the extinction coefficient in yellow light, or in the middle of their known range, as in model
    files."""
    low, high = glass.range_nm
    wavelength = _D_NM if low <= _D_NM <= high else 0.5 * (low + high)
    return float(glass.index(wavelength)), float(glass.extinction(wavelength))


#: Kinds of apertures with the numbers of their sizes.
_OUTLINES = {"circle": 1, "rectangle": 2, "ellipse": 2}


def _outline(aperture: Aperture) -> tuple[str, float, float]:
    def size(number: Any) -> float:
        return real(number, "the aperture", "a diameter, a width and a height, or a kind with its sizes")

    match aperture:
        case (str() as kind, *sizes) if 1 <= len(sizes) <= 2:
            if kind not in _OUTLINES:
                unknown("aperture", kind, _OUTLINES)
            if len(sizes) != _OUTLINES[kind]:
                problem = f"the aperture is {aperture!r}"
                raise _core.RayweaveError(f"{problem}: a {kind} has {'a diameter' if kind == 'circle' else 'a width and a height'}.")
            return kind, size(sizes[0]), size(sizes[-1])
        case (width, height) if size(width) < 0 and size(height) < 0:
            return "ellipse", -size(width), -size(height)
        case (width, height):
            return "rectangle", size(width), size(height)
        case diameter:
            return "circle", size(diameter), size(diameter)


def _component(
    kind: str,
    numbers: _Numbers,
    name: str,
    material: Material,
    aperture: Aperture | None = None,
    off_axis: tuple[float, float] = (0.0, 0.0),
    terms: list[tuple[list[float], list[float]]] | None = None,
) -> Element:
    outline = None if aperture is None else _outline(aperture)
    place = pair(off_axis, "off_axis", "a pair of lengths along x and y")
    (solid,) = _core.optical_component(kind, _sizes(numbers), outline, place, terms or [])
    return Element(name, solid, material)


def _sizes(numbers: _Numbers) -> list[float]:
    return [real(number, "a radius or size") for number in numbers]


def _convex(r: float, name: str, hint: str = "") -> float:
    """A radius that is given without its sign."""
    radius = real(r, name)
    if radius < 0.0:
        raise _core.RayweaveError(f"{name} is {radius:g}: the face is convex, so its radius must be positive.{hint}")
    return radius


def element(solid: Solid, material: Material, *, name: str = "element") -> Element:
    """Any solid as a part of an optical system. Its faces have the names of the faces of its shapes, "side", "top",
    "x+", ..., after the names given by `Solid.named`.

    A material with an extinction coefficient k above a tenth of its index n is a metal, which reflects according to the
    Fresnel equations and absorbs the rest; others are transparent, and absorb along the path. This is decided once, at
    587.5618 nm or, for a glass that has no index there, in the middle of its `range_nm`.

    >>> import rayweave as rw
    >>> import rayweave.optics as ro
    >>> drop = ro.element(rw.sphere(2), 1.33, name="drop")
    >>> drop.name, drop.material
    ('drop', 1.33)
    """
    return Element(name, solid, material)


@suggesting(diameter="aperture", size="aperture", glass="material", f="focal_length")
def lens(
    r1: float, r2: float, thickness: float, *, aperture: Aperture, material: Material = "N-BK7", name: str = "lens"
) -> Element:
    """A lens about the origin with its axis along z: radii of curvature are positive if the centre is on the side of
    +z, inf for a plane; the thickness is that on the axis. Faces: `front`, `back` and the rim `edge`.

    >>> import rayweave.optics as ro
    >>> ro.lens(50, -50, 5, aperture=25.0).name
    'lens'
    """
    return _component("lens", (r1, r2, thickness), name, material, aperture)


@suggesting(diameter="aperture", size="aperture", glass="material", f="focal_length")
def biconvex_lens(
    r1: float, r2: float, thickness: float, *, aperture: Aperture, material: Material = "N-BK7", name: str = "lens"
) -> Element:
    """A lens with two convex faces; both radii are positive. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> float(ro.biconvex_lens(50, 50, 5, aperture=20).body.bounds[1, 2].round(3))
    2.5
    """
    return _component("biconvex", (_convex(r1, "r1", " Use lens(..)."), _convex(r2, "r2", " Use lens(..)."), thickness), name, material, aperture)


@suggesting(diameter="aperture", size="aperture", glass="material", f="focal_length")
def plano_convex_lens(
    r: float, thickness: float, *, aperture: Aperture, material: Material = "N-BK7", name: str = "lens"
) -> Element:
    """A lens with a plane front and a convex back of radius r > 0. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.plano_convex_lens(50, 5, aperture=25).material
    'N-BK7'
    """
    return _component("plano_convex", (_convex(r, "r", " Use lens(..)."), thickness), name, material, aperture)


def conic_lens(
    r1: float,
    k1: float,
    r2: float,
    k2: float,
    thickness: float,
    *,
    aperture: Aperture,
    material: Material = "N-BK7",
    name: str = "lens",
) -> Element:
    """A lens whose faces are conics of revolution with the conic constants k (0 a sphere, -1 a paraboloid). Faces:
    `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.conic_lens(50, -1, -50, 0, 5, aperture=25, name="eyepiece").name
    'eyepiece'
    """
    return _component("conic_lens", (r1, k1, r2, k2, thickness), name, material, aperture)


@dataclass(frozen=True)
class Asphere:
    """A surface of revolution: a conic plus powers of the distance r from the axis.

    `radius` is the radius of curvature at the vertex, inf for none, and `conic` the conic constant; `even` are the
    coefficients of r^2, r^4, ..., r^16 and `odd` those of r, r^3, ..., r^15, as many as are needed; the coefficient of
    r^n has the unit of lengths to the power 1 - n. The sag is `c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2))` plus the sum of
    the terms (ISO 10110-12).

    >>> import rayweave.optics as ro
    >>> ro.Asphere(30, conic=-1, even=(0, 1e-6)).conic
    -1
    """

    radius: float = float("inf")
    conic: float = 0.0
    even: tuple[float, ...] = ()
    odd: tuple[float, ...] = ()

    def _terms(self) -> tuple[list[float], list[float]]:
        return numbers(self.even, "even"), numbers(self.odd, "odd")


def aspheric_lens(
    front: Asphere | float,
    back: Asphere | float,
    thickness: float,
    *,
    aperture: Aperture,
    material: Material = "N-BK7",
    name: str = "lens",
) -> Element:
    """A lens whose faces are aspheres, or spheres given by their radii; otherwise like `lens`, with the same names of
    faces.

    >>> import rayweave.optics as ro
    >>> ro.aspheric_lens(ro.Asphere(30, conic=-1), -60, 5, aperture=20).name
    'lens'
    """
    faces = [_asphere(front), _asphere(back)]
    sizes = (faces[0].radius, faces[0].conic, faces[1].radius, faces[1].conic, thickness)
    terms = [face._terms() for face in faces]
    return _component("aspheric_lens", sizes, name, material, aperture, terms=terms)


def aspheric_mirror(
    face: Asphere | float,
    thickness: float,
    *,
    aperture: Aperture,
    off_axis: tuple[float, float] = (0.0, 0.0),
    name: str = "mirror",
) -> Element:
    """An aspheric mirror with its vertex at the origin that faces -z; concave if the radius is negative. The rim and
    the back absorb. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.aspheric_mirror(-100, 5, aperture=20).name
    'mirror'
    """
    face = _asphere(face)
    sizes = (face.radius, face.conic, thickness)
    return _faced("aspheric_mirror", sizes, name, aperture, off_axis, [face._terms()])


def _asphere(face: Asphere | float) -> Asphere:
    return face if isinstance(face, Asphere) else Asphere(real(face, "a face", "a radius or an Asphere"))


def cemented(
    radii: ArrayLike, thicknesses: ArrayLike, materials: list[Material], *, aperture: Aperture, name: str = "cemented"
) -> list[Element]:
    """Lenses that share their inner faces: n thicknesses and n materials need n + 1 radii. Faces of each: `front`,
    `back`, `edge`. A cemented face is the back of one lens and the front of the next, either of which can have a finish
    (see `Finish`).

    >>> import rayweave.optics as ro
    >>> [part.name for part in ro.cemented([60, -45, -150], [6, 2], ["N-BK7", "N-SF5"], aperture=25)]
    ['cemented1', 'cemented2']
    """
    radii, thicknesses = numbers(radii, "radii"), numbers(thicknesses, "thicknesses")
    materials = each(materials, "materials", "materials")
    if not len(radii) - 1 == len(thicknesses) == len(materials):
        counts = f"{len(radii)} radii, {len(thicknesses)} thicknesses and {len(materials)} materials"
        raise _core.RayweaveError(f"{counts} are given: there must be n + 1, n and n.")
    sizes = [radii[0], *(x for both in zip(thicknesses, radii[1:], strict=True) for x in both)]
    solids = _core.optical_component("cemented", sizes, _outline(aperture))
    pairs = enumerate(zip(solids, materials, strict=True), start=1)
    return [Element(f"{name}{k}", solid, material) for k, (solid, material) in pairs]


def ball_lens(diameter: float, *, material: Material = "N-BK7", name: str = "ball") -> Element:
    """A ball about the origin. Its face is `ball`.

    >>> import rayweave.optics as ro
    >>> round(ro.ball_lens(10).body.volume, 3)
    523.599
    """
    return _component("ball_lens", (diameter,), name, material)


def axicon(
    cone_degrees: float, thickness: float, diameter: float, *, material: Material = "N-BK7", name: str = "axicon"
) -> Element:
    """A plane front and a conical back, inclined by an angle against the plane. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.axicon(10, 8, 25).name
    'axicon'
    """
    return _component("axicon", (cone_degrees, thickness, diameter), name, material)


def plane_mirror(
    thickness: float, *, aperture: Aperture, off_axis: tuple[float, float] = (0.0, 0.0), name: str = "mirror"
) -> Element:
    """A plane mirror in z = 0 that faces -z, its back at z = thickness. Faces: `front`, `back`, `edge`; all of them
    reflect.

    >>> import rayweave.optics as ro
    >>> ro.plane_mirror(5, aperture=25).material
    'mirror'
    """
    return _component("plane_mirror", (thickness,), name, "mirror", aperture, off_axis)


@suggesting(diameter="aperture", size="aperture", glass="material", f="focal_length")
def spherical_mirror(
    radius: float,
    thickness: float,
    *,
    aperture: Aperture,
    off_axis: tuple[float, float] = (0.0, 0.0),
    name: str = "mirror",
) -> Element:
    """A mirror with its vertex at the origin that faces -z; with a negative radius it is concave. The rim and the
    back absorb. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.spherical_mirror(100, 5, aperture=25).name
    'mirror'
    """
    return _faced("spherical_mirror", (radius, thickness), name, aperture, off_axis)


@suggesting(diameter="aperture", size="aperture", glass="material", f="focal_length")
def parabolic_mirror(
    focal_length: float,
    thickness: float,
    *,
    aperture: Aperture,
    off_axis: tuple[float, float] = (0.0, 0.0),
    name: str = "mirror",
) -> Element:
    """A mirror with its vertex at the origin that faces -z and has its focus at z = -focal_length. The rim and the back
    absorb. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.parabolic_mirror(50, 5, aperture=25, off_axis=(0, 30)).name
    'mirror'
    """
    return _faced("parabolic_mirror", (focal_length, thickness), name, aperture, off_axis)


def elliptic_mirror(
    near: float,
    far: float,
    thickness: float,
    *,
    aperture: Aperture,
    off_axis: tuple[float, float] = (0.0, 0.0),
    name: str = "mirror",
) -> Element:
    """A concave mirror with its vertex at the origin that faces -z; light from one focus, at z = -near, converges at
    the other, at z = -far. The rim and the back absorb. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.elliptic_mirror(40, 100, 5, aperture=25).name
    'mirror'
    """
    return _faced("elliptic_mirror", (near, far, thickness), name, aperture, off_axis)


def hyperbolic_mirror(
    behind: float,
    in_front: float,
    thickness: float,
    *,
    aperture: Aperture,
    off_axis: tuple[float, float] = (0.0, 0.0),
    name: str = "mirror",
) -> Element:
    """A convex mirror with its vertex at the origin that faces -z, such as the secondary of a Cassegrain telescope:
    light that converges to z = behind is focused at z = -in_front. The rim and the back absorb. Faces: `front`, `back`,
    `edge`.

    >>> import rayweave.optics as ro
    >>> ro.hyperbolic_mirror(40, 100, 5, aperture=20).name
    'mirror'
    """
    return _faced("hyperbolic_mirror", (behind, in_front, thickness), name, aperture, off_axis)


def toric_lens(
    front: tuple[float, float],
    back: tuple[float, float],
    thickness: float,
    *,
    aperture: Aperture,
    material: Material = "N-BK7",
    name: str = "lens",
) -> Element:
    """A lens whose faces have different radii of curvature along x and y. Faces: `front`, `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.toric_lens((50, 60), (-50, -50), 5, aperture=20).name
    'lens'
    """
    needed = "a pair of radii, along x and along y"
    faces = (*pair(front, "front", needed), *pair(back, "back", needed))
    return _component("toric_lens", (*faces, thickness), name, material, aperture)


def fresnel_lens(
    r: float,
    pitch: float,
    thickness: float,
    diameter: float,
    *,
    conic: float = 0.0,
    material: Material = "PMMA",
    name: str = "lens",
) -> Element:
    """A Fresnel lens: a plane front, and behind it the rings of a convex surface of radius r > 0, each `pitch` wide.
    Faces: `front`, the rings `back`, the steps between them `draft`, the rim `edge`.

    >>> import rayweave.optics as ro
    >>> ro.fresnel_lens(50, 1, 3, 20).material
    'PMMA'
    """
    return _component("fresnel_lens", (_convex(r, "r"), conic, pitch, thickness, diameter), name, material)


def lenslet_array(
    r: float,
    thickness: float,
    pitch: float,
    columns: int,
    rows: int,
    *,
    material: Material = "N-BK7",
    name: str = "array",
) -> Element:
    """A plate of plano-convex lenses, columns along x and rows along y, each `pitch` wide and high. Faces: `front`, the
    lenses `back`, `edge`.

    >>> import rayweave.optics as ro
    >>> ro.lenslet_array(5, 2, 1, 4, 4).name
    'array'
    """
    counts = whole(columns, "columns", least=1), whole(rows, "rows", least=1)
    return _component("lenslet_array", (_convex(r, "r"), thickness, pitch, *counts), name, material)


def _faced(
    kind: str,
    numbers: _Numbers,
    name: str,
    aperture: Aperture,
    off_axis: tuple[float, float],
    terms: list[tuple[list[float], list[float]]] | None = None,
) -> Element:
    mirror = _component(kind, numbers, name, "absorber", aperture, off_axis, terms)
    return mirror.with_finish(reflecting(), "front")


def equilateral_prism(
    side_length: float, width: float, *, material: Material = "N-BK7", name: str = "prism"
) -> Element:
    """A prism of three equal faces: a "dispersing" `prism` of 60 degrees, with the same names of faces.

    >>> import rayweave.optics as ro
    >>> ro.equilateral_prism(20, 10).name
    'prism'
    """
    return _component("equilateral_prism", (side_length, width), name, material)


#: Kinds of prisms with their numbers.
_PRISMS = {
    "dispersing": ("apex angle", "side", "width"),
    "right_angle": ("leg", "width"),
    "penta": ("side", "width"),
    "dove": ("height", "length", "width"),
    "amici": ("diameter",),
}


def prism(kind: str, *numbers: float, material: Material = "N-BK7", name: str = "prism") -> Element:
    """A prism: "dispersing" (apex angle, side, width), "right_angle" (leg, width), "penta" (side, width), "dove"
    (height, length, width), "amici" (diameter).

    Light along +z enters through the face `front`, and leaves

    - "dispersing": through `back`; `base` is below, the apex above;
    - "right_angle": along +y through `exit`, after `hypotenuse`;
    - "penta": along -y through `exit`, after `mirror1` and `mirror2`, where the incidence is too steep for total
      reflection: they need a mirror finish, `p.with_finish(reflecting(), "mirror1").with_finish(reflecting(),
      "mirror2")`; the fifth face is `roof`;
    - "dove": along +z through `back`, after `base`; the opposite side is `top`;
    - "amici": along +y through `exit`, after the roof `roof1` and `roof2`.

    The sides across x are `left` and `right`.

    >>> import rayweave.optics as ro
    >>> ro.prism("right_angle", 20, 20).name
    'prism'
    """
    if kind not in list(_PRISMS):
        unknown("prism", kind, _PRISMS)
    wanted = _PRISMS[kind]
    if len(numbers) != len(wanted):
        raise _core.RayweaveError(f"the prism {kind!r} is given {len(numbers)} numbers: it has {len(wanted)}: {', '.join(wanted)}.")
    return _component(f"{kind}_prism", numbers, name, material)


def corner_cube(depth: float, *, material: Material = "N-BK7", name: str = "corner") -> Element:
    """A corner of a cube that reflects light back in the direction it came from. Light along +z enters through `front`
    in z = 0. The faces that meet at z = depth are `mirror1`, `mirror2` and `mirror3`; they reflect totally if the index
    is large enough, and otherwise need a mirror finish.

    >>> import rayweave.optics as ro
    >>> ro.corner_cube(10).name
    'corner'
    """
    return _component("corner_cube", (depth,), name, material)


def beam_splitter_cube(
    side: float, *, reflectance: float = 0.5, material: Material = "N-BK7", name: str = "cube"
) -> list[Element]:
    """Two prisms that share a face, z = y, which reflects a fraction of the power of light along +z towards +y. Faces:
    `front`, `exit` and `split` of the first, `back`, `bottom` and `split` of the second.

    >>> import rayweave.optics as ro
    >>> [part.name for part in ro.beam_splitter_cube(20)]
    ['cube1', 'cube2']
    """
    first, second = _core.optical_component("beam_splitter_cube", [real(side, "side")])
    shared = splitting(reflectance)
    return [
        Element(f"{name}1", first, material),
        Element(f"{name}2", second, material).with_finish(shared, "split"),
    ]


def _sheet(name: str, action: Finish, aperture: Aperture, opening: Aperture | None = None) -> Element:
    sheet = Sheet(_outline(aperture), None if opening is None else _outline(opening))
    return Element(name, sheet, action=action)


def baffle(aperture: Aperture, *, name: str = "baffle") -> Element:
    """A sheet in the plane z = 0 that absorbs.

    >>> import rayweave.optics as ro
    >>> ro.baffle((20, 10)).name
    'baffle'
    """
    return _sheet(name, Finish("absorb"), aperture)


def aperture_stop(size: Aperture, opening: Aperture, *, name: str = "stop") -> Element:
    """A sheet in the plane z = 0 with an opening about the axis; the rest absorbs.

    >>> import rayweave.optics as ro
    >>> ro.aperture_stop(20.0, 5.0).name
    'stop'
    """
    return _sheet(name, Finish("absorb"), size, opening)


@suggesting(diameter="aperture", size="aperture", glass="material", f="focal_length")
def detector(aperture: Aperture, *, absorbs: bool = True, name: str = "detector") -> Element:
    """A sheet in the plane z = 0 that records the light that hits it, and absorbs or transmits it.

    >>> import rayweave.optics as ro
    >>> ro.detector((24, 36)).named("film").name
    'film'
    """
    return _sheet(name, Finish("absorb" if flag(absorbs, "absorbs") else "record"), aperture)


@suggesting(diameter="aperture", size="aperture", glass="material", f="focal_length")
def thin_lens(focal_length: float, *, aperture: Aperture, name: str = "thin lens") -> Element:
    """An ideal thin lens in the plane z = 0.

    >>> import rayweave.optics as ro
    >>> ro.thin_lens(100, aperture=25).name
    'thin lens'
    """
    return _sheet(name, Finish("thin_lens", (real(focal_length, "focal_length"),)), aperture)


def grating(
    lines: tuple[float, float], order: int, *, aperture: Aperture, reflects: bool = False, name: str = "grating"
) -> Element:
    """A plane grating in z = 0 that diffracts all light into one order. `lines` is a vector across the grooves; its
    length is their number per unit of length.

    >>> import rayweave.optics as ro
    >>> ro.grating((0, 600), 1, aperture=25).name
    'grating'
    """
    needed = "a vector across the grooves, a pair of numbers along x and y"
    number = whole(order, "order", least=-(2**31), bits=31)
    action = Finish("grating", (*pair(lines, "lines", needed), number, flag(reflects, "reflects")))
    return _sheet(name, action, aperture)


def polariser(degrees: float, *, aperture: Aperture, name: str = "polariser") -> Element:
    """Transmits light polarised along an axis in the plane z = 0, at an angle from +x towards +y.

    >>> import rayweave.optics as ro
    >>> ro.polariser(45, aperture=25).name
    'polariser'
    """
    angle = np.deg2rad(finite(degrees, "degrees"))
    return _sheet(name, Finish("polariser", (np.cos(angle), np.sin(angle))), aperture)


def wave_plate(retardance_degrees: float, degrees: float, *, aperture: Aperture, name: str = "plate") -> Element:
    """Retards light polarised across the fast axis, which is at an angle from +x towards +y: by 90 degrees for a
    quarter-wave plate.

    >>> import rayweave.optics as ro
    >>> ro.wave_plate(90, 45, aperture=25).name
    'plate'
    """
    angle = np.deg2rad(finite(degrees, "degrees"))
    retardance = finite(retardance_degrees, "retardance_degrees")
    return _sheet(name, Finish("retarder", (np.cos(angle), np.sin(angle), retardance)), aperture)


def lensmaker(r1: float, r2: float, n: float, thickness: float) -> float:
    """The focal length of a thick lens of index n in air: 1/f = (n - 1) (1/r1 - 1/r2 + (n - 1) d / (n r1 r2)) (Hecht,
    *Optics*, 5th edition, section 6.1).

    >>> import rayweave.optics as ro
    >>> round(ro.lensmaker(50, -50, 1.5, 5), 3)
    50.847
    """
    return _core.lensmaker(real(r1, "r1"), real(r2, "r2"), real(n, "n"), real(thickness, "thickness"))


record_all(globals(), "Element")
