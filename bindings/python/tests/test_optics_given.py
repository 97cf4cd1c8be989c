"""Invalid arguments: each is rejected where it is passed, with an error that uses the caller's name of it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from rayweave import RayweaveError, optics, sphere

o: Any = optics
Wrong = tuple[type[Exception], str, Callable[[], object]]


def refuses(given: list[Wrong]) -> None:
    for kind, message, make in given:
        with pytest.raises(kind, match=message) as caught:
            make()
        # neither internal names nor Python's own messages
        said = str(caught.value)
        assert not any(word in said for word in ("failed to extract", "could not convert", "iterable", "enum ")), said
        assert type(caught.value) is kind, said


def prescription(**changes: Any) -> Any:
    surfaces = [o.Surface(50, 5, "N-BK7"), o.Surface(-50, 45)]
    return o.Prescription(surfaces, **{"entrance_pupil_diameter": 10.0, **changes})


def test_parts() -> None:
    lens = {"aperture": 5}
    refuses(
        [
            (TypeError, r"order is 1\.5: it must be a whole number", lambda: o.grating((600, 0), 1.5, **lens)),
            (TypeError, r"lines is 600: it must be a vector across the grooves", lambda: o.grating(600, 1, **lens)),
            (TypeError, "reflects is 2", lambda: o.grating((600, 0), 1, reflects=2, **lens)),
            (TypeError, r"columns is 2\.5: it must be a whole number", lambda: o.lenslet_array(20, 3, 4, 2.5, 2)),
            (RayweaveError, "rows is 0", lambda: o.lenslet_array(20, 3, 4, 2, 0)),
            (RayweaveError, r"r is -20: the face is convex", lambda: o.lenslet_array(-20, 3, 4, 2, 2)),
            (RayweaveError, r"r is -50: the face is convex", lambda: o.fresnel_lens(-50, 2, 2, 20)),
            (RayweaveError, r"r1 is -5: .* lens\(..\)", lambda: o.biconvex_lens(-5, 5, 1, aperture=1)),
            (RayweaveError, "r2 is -5", lambda: o.biconvex_lens(5, -5, 1, aperture=1)),
            (RayweaveError, "r is -5", lambda: o.plano_convex_lens(-5, 1, aperture=1)),
            (RayweaveError, "retardance_degrees is inf", lambda: o.wave_plate(np.inf, 0, **lens)),
            (RayweaveError, "degrees is nan", lambda: o.wave_plate(90, np.nan, **lens)),
            (TypeError, "degrees is 'x'", lambda: o.polariser("x", **lens)),
            (TypeError, "focal_length is 'x'", lambda: o.thin_lens("x", **lens)),
            (TypeError, "front is 5: it must be a pair of radii", lambda: o.toric_lens(5, -5, 1, **lens)),
            (TypeError, "side is 'a'", lambda: o.beam_splitter_cube("a")),
            (TypeError, r"a face is 'x': it must be a radius or an Asphere", lambda: o.aspheric_lens("x", 5, 1, **lens)),
            (TypeError, "even has dtype", lambda: o.aspheric_lens(o.Asphere(5, 0, ("a",)), 5, 1, **lens)),
            (TypeError, r"the body of 'element' is of the type str: it must be a Solid", lambda: o.element("x", 1.5)),
            (TypeError, "is of the type Element: it must be a Solid", lambda: o.element(o.ball_lens(1), 1.5)),
            (TypeError, "materials is 1.5", lambda: o.cemented([1, 2], [1], 1.5, **lens)),
            (TypeError, "absorbs is 3", lambda: o.detector(5, absorbs=3)),
            (TypeError, "the prism is 3: it can be dispersing, ", lambda: o.prism(3, 5)),
            (TypeError, "name is 5", lambda: o.element(sphere(1), 1.5, name=5)),
            (TypeError, "name is 5", lambda: o.detector(3).named(5)),
            (TypeError, "face is 5", lambda: o.ball_lens(1).with_finish(o.black(), 5)),
            (TypeError, "reflectance is 'a'", lambda: o.reflecting("a")),
            (TypeError, "off_axis is 3", lambda: o.plane_mirror(3, off_axis=3, **lens)),
            (RayweaveError, "Did you mean 'circle'", lambda: o.baffle(("circl", 5))),
            (RayweaveError, r"\('rectangle', 5\): a rectangle has a width", lambda: o.baffle(("rectangle", 5))),
            (TypeError, "r1 is 'a'", lambda: o.lensmaker("a", 1, 1.5, 1)),
            (RayweaveError, "no prism 'wedge': there are dispersing, right_angle, penta", lambda: o.prism("wedge", 3, 10)),
            (RayweaveError, "Did you mean 'penta'", lambda: o.prism("pentar", 3, 10)),
            (RayweaveError, "'penta' is given 1 numbers: it has 2: side, width", lambda: o.prism("penta", 5)),
            (TypeError, "a number of the law 'selfoc' is 'a'", lambda: o.graded(1.5, "selfoc", "a")),
            (TypeError, "law is 3", lambda: o.graded(1.5, 3, 1.0)),
        ]
    )


def test_sources() -> None:
    needed = r'it must be a number, or a pair of "total" and a number'
    refuses(
        [
            (TypeError, rf"power is \('tot', 3\): {needed}", lambda: o.beam(1, 5, power=("tot", 3))),
            (TypeError, rf"power is \('total',\): {needed}", lambda: o.beam(1, 5, power=("total",))),
            (TypeError, "power is 'a'", lambda: o.beam(1, 5, power=("total", "a"))),
            (TypeError, r"power is \('tot', 3\): ", lambda: o.source_of_rays([[0, 0, 0]], [[0, 0, 1]], power=("tot", 3))),
            (RayweaveError, "Did you mean 'black body'", lambda: o.beam(1, 5, wavelength_nm=("blackbody", 3000, 400, 700))),
            (RayweaveError, "it has 3: kelvin, lowest", lambda: o.beam(1, 5, wavelength_nm=("black body", 3000))),
            (RayweaveError, "pairs of wavelength and weight", lambda: o.beam(1, 5, wavelength_nm=("table", 400, 1, 500))),
            (TypeError, "spectrum 'uniform' is 'a'", lambda: o.beam(1, 5, wavelength_nm=("uniform", "a", 5))),
            (TypeError, "sampling is 3", lambda: o.beam(1, 3, sampling=3)),
            (TypeError, "q is 'a'", lambda: o.beam(1, 5).polarised(1, "a", 0, 0)),
        ]
    )
    # a tuple of powers is one for each ray
    rays = o.source_of_rays([[0, 0, 0], [1, 0, 0]], [[0, 0, 1]] * 2, power=(1.0, 3.0)).rays()
    np.testing.assert_array_equal(rays[3], [1.0, 3.0])


def test_traces() -> None:
    system, light = o.System(o.ball_lens(1)), o.beam(1, 3).translate([0, 0, -3])

    def rays(**settings: Any) -> object:
        return system.trace_rays([0, 0, -3], [0, 0, 1], **settings)

    refuses(
        [
            (RayweaveError, r"source\[0\] is -1: it must be a whole number", lambda: rays(source=[-1])),
            (RayweaveError, r"source\[0\] is 1.5", lambda: rays(source=[1.5])),
            (RayweaveError, r"source\[0\] is nan", lambda: rays(source=np.nan)),
            (TypeError, "power is 'a'", lambda: rays(power="a")),
            (TypeError, r"origins is \['a'", lambda: system.trace_rays(["a"], [0, 0, 1])),
            (TypeError, "generation_limit is 1.5", lambda: rays(generation_limit=1.5)),
            (TypeError, "generation_limit is 'a'", lambda: system.trace(light, generation_limit="a")),
            (RayweaveError, r"generation_limit is 4294967296: .* below 2\^32", lambda: rays(generation_limit=2**32)),
            (TypeError, r'branches is None: it must be "ideal"', lambda: system.trace(light, branches=None)),
            (TypeError, r"polarised is 'yes': it must be True, False or None", lambda: system.stream(light, polarised="yes")),
            (TypeError, "keep_escaped is 1", lambda: rays(keep_escaped=1)),
            (TypeError, "threshold is 'a'", lambda: rays(threshold="a")),
            (TypeError, "phases is 3", lambda: rays(phases=3)),
            (TypeError, r"unit is \[\]", lambda: o.System(o.ball_lens(1), unit=[])),
            (TypeError, "the element is 3", lambda: system.trace(light).at(3)),
            (RayweaveError, "rays is 0", lambda: system.trace(light).show(rays=0)),
            (RayweaveError, "threshold is nan", lambda: rays(threshold=np.nan)),
        ]
    )
    assert system.trace_rays([[0, 0, -3]] * 2, [0, 0, 1], source=[0.0, 7.0])["source"].max() == 7


def test_prescriptions() -> None:
    lens = prescription()
    surface = o.Surface
    refuses(
        [
            (TypeError, "stop is 1.5", lambda: prescription(stop=1.5)),
            (RayweaveError, "primary is -1", lambda: prescription(primary=-1)),
            (TypeError, "name is 5", lambda: prescription(name=5)),
            (TypeError, "a note is 5", lambda: prescription(notes=[5])),
            (TypeError, "notes is 5", lambda: prescription(notes=5)),
            (TypeError, "fields is 5", lambda: prescription(fields=5)),
            (TypeError, "along is 3", lambda: lens.first_order(along=3)),
            (TypeError, r"direction is \(1,\)", lambda: lens.arrivals().mtf([1], (1,))),
            (TypeError, "field_kind is 3", lambda: prescription(field_kind=3)),
            (TypeError, "image_radius is 'a'", lambda: prescription(image_radius="a")),
            (TypeError, "entrance_pupil_diameter is 'a'", lambda: prescription(entrance_pupil_diameter="a")),
            (TypeError, "a field is 'a'", lambda: prescription(fields=["a"])),
            (TypeError, "object_distance is 'a'", lambda: prescription(object_distance="a")),
            (RayweaveError, r"matrix .* has shape \(3, 3\)", lambda: prescription(breaks=[o.CoordinateBreak(1, matrix=np.eye(3))])),
            (TypeError, "before is 1.5", lambda: prescription(breaks=[o.CoordinateBreak(1.5)])),
            (TypeError, "decentre is 3", lambda: prescription(breaks=[o.CoordinateBreak(1, 3)])),
            (TypeError, r'behind is None: it must be "air", "mirror"', lambda: o.Prescription([surface(50, 5, None)], f_number=2)),
            (TypeError, r"behind is \(1.5\+1j\)", lambda: o.Prescription([surface(50, 5, 1.5 + 1j)], f_number=2)),
            (TypeError, "hole is 'a'", lambda: lens.with_surface(1, hole="a")),
            (TypeError, "conic constant of a surface is 'a'", lambda: lens.with_surface(1, conic="a")),
            (TypeError, "turn is 'a'", lambda: lens.with_surface(1, figure=o.Toroidal("a"))),
            (RayweaveError, "no order of Zernike polynomials 'nol'", lambda: lens.with_surface(1, figure=o.ZernikePolynomials(1, (), "nol"))),
            (RayweaveError, "field is -1", lambda: lens.arrivals(-1)),
            (RayweaveError, "rings is -1", lambda: lens.spots(rings=-1)),
            (TypeError, "rings is 1.5", lambda: lens.arrivals(rings=1.5)),
            (TypeError, "wavelength_nm is 'a'", lambda: lens.arrivals(wavelength_nm="a")),
            (TypeError, "pupil is 'a'", lambda: lens.rays(pupil="a")),
            (TypeError, "aimed is 2", lambda: lens.rays(aimed=2)),
            (RayweaveError, "count is -3", lambda: o.pupil_grid("square", -3)),
            (RayweaveError, "count is 0", lambda: o.pupil_grid("fan_x", 0)),
            (RayweaveError, "Did you mean 'square'", lambda: o.pupil_grid("sqare", 3)),
            (RayweaveError, "count is -3", lambda: lens.field_curvature(count=-3)),
            (RayweaveError, "count is 0", lambda: lens.lateral_colour(count=0)),
            (RayweaveError, "count is 0", lambda: lens.fans(count=0)),
            (RayweaveError, "across is 0", lambda: lens.wavefront(across=0)),
            (RayweaveError, "rays is 0", lambda: lens.show(rays=0)),
            (TypeError, "shift is 'a'", lambda: lens.spots(shift="a")),
            (TypeError, "radii is 'a'", lambda: lens.encircled_energy("a")),
        ]
    )


def test_virtual_objects_have_first_order_data_alone() -> None:
    lens = prescription(object_distance=-200)
    assert np.isfinite(lens.first_order().image_distance)
    for ask in (lens.spots, lens.fans, lens.wavefront, lens.distortion, lens.arrivals, lens.mtf, lens.lateral_colour):
        with pytest.raises(RayweaveError, match="object_distance is -200: .* Check the sign"):
            ask()


def test_optimisation_and_tolerances() -> None:
    lens = prescription()
    errors = {"radius 1": 0.1}
    goals = [o.goal("focal length", 50)]
    refuses(
        [
            (TypeError, "the deviation of 'radius 1' is 'a'", lambda: o.tolerance(lens, {"radius 1": "a"})),
            (TypeError, "the deviation of 'radius 1' is 'a'", lambda: o.tolerance(lens, {"radius 1": ("normal", "a")})),
            (TypeError, "errors is 3", lambda: o.tolerance(lens, 3)),
            (TypeError, "a parameter is 3", lambda: o.tolerance(lens, {3: 0.1})),
            (TypeError, r"lens is 3: it must be a Prescription", lambda: o.tolerance(3, errors)),
            (RayweaveError, "trials is 0", lambda: o.tolerance(lens, errors, trials=0)),
            (RayweaveError, "trials is -1", lambda: o.tolerance(lens, errors, trials=-1)),
            (RayweaveError, "rings is 0", lambda: o.tolerance(lens, errors, rings=0)),
            (RayweaveError, "rings is -1", lambda: o.tolerance(lens, errors, "focal length", rings=-1)),
            (TypeError, "rings is 1.5", lambda: o.tolerance(lens, errors, rings=1.5)),
            (TypeError, "merit is 3", lambda: o.tolerance(lens, errors, 3)),
            (TypeError, "refocus is 1", lambda: o.tolerance(lens, errors, refocus=1)),
            (RayweaveError, "rings is 0", lambda: o.optimise(lens, ["radius 1"], [o.goal("spot", field=0, wavelength_nm=500)], rings=0)),
            (RayweaveError, "patience is 0", lambda: o.optimise(lens, ["radius 1"], goals, patience=0)),
            (TypeError, r"goals\[0\] is of the type str: it must be a Goal", lambda: o.optimise(lens, ["radius 1"], ["spot"])),
            (TypeError, "operand is 3", lambda: o.goal(3)),
            (TypeError, "parameters is 3", lambda: o.optimise(lens, 3, goals)),
            (TypeError, "weight is 'a'", lambda: o.goal("focal length", 50, weight="a")),
        ]
    )
