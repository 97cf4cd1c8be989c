"""Optics: light through lenses, mirrors, prisms and any other solids.

The optical axis is z; lengths are in the unit of the system, angles in degrees, wavelengths in nanometres.

A `System` has elements; light of a source is traced through it, and a detector shows where it arrives:

>>> import rayweave.optics as ro
>>> lens = ro.biconvex_lens(50, 50, 5, aperture=25.0)
>>> screen = ro.detector(25.0).translate([0, 0, 49])
>>> trace = ro.System([lens, screen]).trace(ro.beam(10.0, 1000).translate([0, 0, -10]))
>>> spot = trace.spot("detector")
>>> spot.points.shape, round(spot.rms_radius, 3)
((1000, 2), 0.05)

A `Prescription` has the surfaces of a lens from front to back, and analyses its image:

>>> surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
>>> design = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
>>> round(design.first_order().focal_length, 3)
49.213
>>> design.spots().to_pandas().shape
(2, 12)

=========== ========================================================================================================
elements    `lens`, `cemented`, `parabolic_mirror`, `prism`, `thin_lens`, `grating`, ..., or any solid by `element`
faces       `polished`, `coated`, `reflecting`, `splitting`, `rough`, `diffuse`, `black`
sources     `beam`, `point_source`, `lamp`, `source_of_rays`, `source_from_file`
results     `Trace`: `Trace.spot`, `Trace.irradiance`, `Trace.paths`, `Trace.show`, `Trace.to_pandas`
lens design `Prescription`, `optimise`, `tolerance`
files       `load`, `Prescription.read_zmx`
=========== ========================================================================================================
"""

from difflib import get_close_matches as _get_close_matches

from rayweave._core import Glass, GradedMedium, Sheet, glass_names
from rayweave.optics._analysis import Path, Spot
from rayweave.optics._columns import Columns
from rayweave.optics._design import Goal, GoalTable, Optimum, Sensitivities, Trials, goal, optimise, tolerance
from rayweave.optics._elements import (
    Aperture,
    Asphere,
    Element,
    Finish,
    Material,
    aperture_stop,
    aspheric_lens,
    aspheric_mirror,
    axicon,
    baffle,
    ball_lens,
    beam_splitter_cube,
    biconvex_lens,
    black,
    cemented,
    coated,
    conic_lens,
    corner_cube,
    detector,
    diffuse,
    element,
    elliptic_mirror,
    equilateral_prism,
    fresnel_lens,
    grating,
    hyperbolic_mirror,
    lens,
    lenslet_array,
    lensmaker,
    parabolic_mirror,
    plane_mirror,
    plano_convex_lens,
    polariser,
    polished,
    prism,
    reflecting,
    rough,
    spherical_mirror,
    splitting,
    thin_lens,
    toric_lens,
    wave_plate,
)
from rayweave.optics._file import OpticalModel, load, loads
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
    SpotSize,
    ThroughFocus,
    Vignetting,
    Wavefront,
    ZernikeFit,
)
from rayweave.optics._gradient import graded
from rayweave.optics._prescription import (
    Biconic,
    CoordinateBreak,
    FirstOrder,
    Prescription,
    Pupil,
    Surface,
    Toroidal,
    XYPolynomial,
    ZernikePolynomials,
)
from rayweave.optics._pupil import pupil_grid, pupil_quadrature
from rayweave.optics._sources import (
    Source,
    Spectrum,
    beam,
    circle_of_rays,
    cone_of_rays,
    lamp,
    line_of_rays,
    point_source,
    source_from_file,
    source_of_rays,
    wedge_of_rays,
)
from rayweave.optics._stream import Stream
from rayweave.optics._system import Balance, System, Trace


def glass(name: str) -> Glass:
    """A material of the built-in catalogue, by name.

    >>> import rayweave.optics as ro
    >>> round(ro.glass("N-BK7").index(587.5618), 4)
    1.5168
    """
    return Glass(name)


__all__ = [
    "Aperture",
    "Asphere",
    "Balance",
    "Biconic",
    "Columns",
    "CoordinateBreak",
    "DiffractionModulation",
    "Distortion",
    "Element",
    "Energy",
    "Fans",
    "FieldCurvature",
    "Finish",
    "FirstOrder",
    "FocalShift",
    "Glass",
    "Goal",
    "GoalTable",
    "GradedMedium",
    "LateralColour",
    "Material",
    "Modulation",
    "OpticalModel",
    "Optimum",
    "Path",
    "Prescription",
    "Pupil",
    "Rays",
    "Seidel",
    "Sensitivities",
    "Sheet",
    "Source",
    "Spectrum",
    "Spot",
    "SpotSize",
    "Spots",
    "Stream",
    "Surface",
    "System",
    "ThroughFocus",
    "Toroidal",
    "Trace",
    "Trials",
    "Vignetting",
    "Wavefront",
    "XYPolynomial",
    "ZernikeFit",
    "ZernikePolynomials",
    "aperture_stop",
    "aspheric_lens",
    "aspheric_mirror",
    "axicon",
    "baffle",
    "ball_lens",
    "beam",
    "beam_splitter_cube",
    "biconvex_lens",
    "black",
    "cemented",
    "circle_of_rays",
    "coated",
    "cone_of_rays",
    "conic_lens",
    "corner_cube",
    "detector",
    "diffuse",
    "element",
    "elliptic_mirror",
    "equilateral_prism",
    "fresnel_lens",
    "glass",
    "glass_names",
    "goal",
    "graded",
    "grating",
    "hyperbolic_mirror",
    "lamp",
    "lens",
    "lenslet_array",
    "lensmaker",
    "line_of_rays",
    "load",
    "loads",
    "optimise",
    "parabolic_mirror",
    "plane_mirror",
    "plano_convex_lens",
    "point_source",
    "polariser",
    "polished",
    "prism",
    "pupil_grid",
    "pupil_quadrature",
    "reflecting",
    "rough",
    "source_from_file",
    "source_of_rays",
    "spherical_mirror",
    "splitting",
    "thin_lens",
    "tolerance",
    "toric_lens",
    "wave_plate",
    "wedge_of_rays",
]

#: Words of other programs and American spellings, with what to write.
_MEANT = {
    "optimize": "optimise(lens, parameters, goals)",
    "Optimizer": "optimise(lens, parameters, goals)",
    "tolerancing": "tolerance(lens, errors)",
    "polarizer": "polariser(..)",
    "read_zmx": "Prescription.read_zmx(path)",
    "Lens": "Prescription(surfaces, ..), or lens(..) for one solid",
    "operand": "goal(operand, ..)",
    "stop": "aperture_stop(..), or Prescription(.., stop=number)",
    "aperture": "aperture_stop(..), or Aperture for the outline of an element",
    "mirror": "plane_mirror(..), spherical_mirror(..) or parabolic_mirror(..)",
}


def __getattr__(name: str) -> object:
    if name in _MEANT:
        hint = f"write {_MEANT[name]}"
    else:
        near = _get_close_matches(name, __all__, 1)
        hint = f"did you mean {near[0]}?" if near else "help(rayweave.optics) lists what there is"
    raise AttributeError(f"module 'rayweave.optics' has no attribute '{name}': {hint}")
