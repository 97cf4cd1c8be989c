"""Every part of the interface as a type checker sees it: read by mypy --strict, run by test_typed_sample."""

from typing import Any, assert_type

import numpy as np
from numpy.typing import NDArray

import rayweave
from rayweave import Operation, RootRay, Solid, optics, photons, rootray, space


def hit_arrays() -> None:
    hits = rayweave.array_csg([1, 4], np.array([2, 3], np.float32), Operation.UNION, False, out=np.zeros(4))
    assert hits.shape == (4,)
    times, counts = rayweave.count_array([1, 4], [2, 3], Operation.INTERSECT)
    assert_type(counts, NDArray[np.int64])
    assert times.shape == counts.shape


def geometry() -> None:
    ball = rayweave.sphere(1)
    assert_type(rayweave.section(ball, "z=0.5", tolerance=0.01), rayweave.Section)
    stack = rayweave.section(ball, at=[0, 0.5], by="region", within=[[-1, -1, -1], [1, 1, 1]])
    assert_type(stack, list[rayweave.Section])
    assert_type(stack[0].areas, NDArray[np.float64])
    assert_type(stack[0].contours("solid"), tuple[NDArray[np.float64], ...])
    assert_type(rayweave.diff(ball, ball, by="whole", cells=8).both, NDArray[np.float64])
    report = rayweave.check(ball, cells=8, wall=0.1)
    assert_type(report.findings, tuple[rayweave.Finding, ...])
    assert_type(rayweave.thickness(ball, view="top", size=(4, 3)).lengths, NDArray[np.float64])


def regions() -> None:
    region = rayweave.from_polygons([[[0, 0], [1, 0], [0, 1]], np.zeros((1, 2))], outside=1)
    assert_type(region.area, float)
    assert_type(region.contours, tuple[NDArray[np.float64], ...])
    assert_type(region.trace([0, 0], (1, 1)), RootRay)
    assert_type(region.extrude(0, 1), Solid)
    assert (region.outside, region == region) == (1, True)
    assert len(rayweave.infill(region, 0.1, 45, phase=0.5, turn=90, alternate=True)) > 0
    assert len(rayweave.infill(rayweave.sphere(1), 1, layers=np.array([0.5]), evaluator="weave", threads=1)) > 0
    assert len(rayweave.infill(rayweave.sphere(1), 1, layer_height=0.5)) > 0


class Circle:
    """A user-defined curve."""

    def position(self, t: float) -> NDArray[np.float64]:
        return np.array([np.cos(t), np.sin(t), 0.0])

    def velocity(self, t: float) -> list[float]:
        return [-float(np.sin(t)), float(np.cos(t)), 0.0]

    def acceleration_bound(self, t0: float, t1: float) -> float:
        return 1.0


def curves() -> None:
    disc = space.ball(2, 2) | space.box([0, 0], (1, 5)) - space.quadric(2, 2, -1)
    assert_type(disc, space.Solid)
    assert_type(disc.dimension, int)
    assert_type(space.trace([0, 0], np.ones(2), disc.scale(2).rotate(0, 1, 90)), RootRay)
    assert_type(disc.crossings([[0, 0]], [1, 1], threads=1), space.PointCrossings)
    assert_type(disc.contains([0, 0]), NDArray[np.bool_])
    tower = space.union([disc.extrude(3), space.half_space(2, 3, offset=-9)]).translate([0, 0, 1])
    assert_type(space.trace_along(Circle(), tower.affine(np.eye(3)), 0, 1), RootRay)
    assert_type(rayweave.from_polygons([[[0, 0], [1, 0], [0, 1]]]).solid(4), space.Solid)
    helix = space.Helix((0, 0, 0), (0, 1, 1), (0, 0, 1), radius=2)
    assert_type(helix.position([0, 1]), NDArray[np.float64])
    found = rayweave.sphere(1.5).crossings_along([helix, Circle()], 0.0, [5.0, 6.0])
    assert_type(found, rayweave.Crossings)
    curve: space.Curve = space.Spline([0, 1, 2], np.zeros((3, 2)), ends="natural")
    follower: space.Trajectory = curve
    assert_type(disc.crossings_along(follower, 0, 2).normal, NDArray[np.float64])


def root_rays() -> None:
    ray = RootRay("outside", [1, 2]) | ~RootRay(-1, np.array([3.0]))
    assert_type(ray.roots, list[float])
    assert_type(ray.clip(t_min=0).weld(), RootRay)
    assert_type(rootray.union(ray, (1, [2.0])), RootRay)
    assert_type(rootray.union((1, [1.0]), (1, (2.0, 3.0))), tuple[int, list[float]])
    assert_type(rootray.validate(ray), list[str])
    start, roots = rootray.complement((1, [1.0]))
    assert (start, roots) == (-1, [1.0])


def solids() -> Solid:
    ball = rayweave.sphere(2).translate([0, 0, 1]).named("ball")
    shapes = [rayweave.box([1, 2, 3]), rayweave.cylinder(1), rayweave.torus(major=3, minor=np.float64(1))]
    solid = (ball | rayweave.union(shapes)) - ~rayweave.half_space((0, 0, 1), 5) & rayweave.universe()
    assert_type(solid, Solid)
    placed = rayweave.place(solid.rotate([0, 0, 1], 45).scale(2.0).mirror([1, 0, 0]), np.zeros((1, 3)))
    return placed.transform(np.eye(4))


def questions(solid: Solid) -> None:
    ray = np.array([0.0, 0.0, -50.0]), (0, 0, 1)
    hits = solid.hits(*ray, 0.0, 100.0, out=np.empty((20, 1)), threads=1)
    assert_type(hits, NDArray[np.float64])
    times, surfaces = solid.hits(*ray, return_surfaces=True)
    solid.hits(*ray, return_surfaces=True, out=(times, surfaces))
    solid.hits(*ray, out=times)
    assert_type(surfaces, NDArray[np.int32])
    assert times.shape == surfaces.shape
    crossings = solid.crossings(*ray, evaluator="reference")
    assert_type(crossings, rayweave.Crossings)
    assert_type(crossings.surface_names, tuple[str, ...])
    assert_type(solid.nearest(*ray).enters, NDArray[np.bool_])
    assert_type(solid.contains([0, 0, 0]), NDArray[np.bool_])
    assert_type(solid.bounds, NDArray[np.float64])
    explanation = solid.explain(*ray, 0.0)
    assert_type(explanation, rayweave.Explanation)
    assert_type(explanation.questions, tuple[rayweave.Question, ...])
    assert_type(explanation.questions[0].entries[0].operands, tuple[rayweave.Operand, ...])
    assert_type(explanation.crossings, tuple[rayweave.Passage, ...])
    assert_type(explanation.story(lines=None), str)


def models() -> None:
    model = rayweave.loads("rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n", {})
    assert_type(model.solids["a"], Solid)
    assert_type(model.regions[0].medium, str)
    assert_type(model.media[0].index, float | None)
    crossings = model.crossings([0, 0, -5], [0, 0, 1])
    assert_type(crossings.medium_after, NDArray[np.int32])
    assert_type(model.partition([0, 0, -5], [0, 0, 1]).t_end, NDArray[np.float64])
    assert_type(model.to_toml(), str)


def built() -> None:
    solid = rayweave.box(2)
    part = rayweave.Region("part", solid, medium="glass", colour="red")
    model = rayweave.Model([part, solid], {"glass": 1.5, "air": {"index": 1.0}}, unit="cm")
    assert_type(rayweave.Model({"a": solid, "b": part}), rayweave.Model)
    assert_type(model["part"], rayweave.Region)
    assert_type([region.medium for region in model], list[str])
    assert_type(solid.to_mesh(0.1), rayweave.Mesh)
    assert_type((solid.volume, solid.centroid), tuple[float, NDArray[np.float64]])
    found = model.crossings([0, 0, 0], [0, 0, 1])
    assert_type(found["t"], NDArray[Any])
    assert_type(found[0], dict[str, Any])
    assert_type(found[1:], rayweave.Rows)
    assert_type(rayweave.union(solid, solid), Solid)
    assert_type(rayweave.measure([solid, solid]).volume, NDArray[np.float64])


def pictures(solid: Solid) -> None:
    camera = rayweave.Camera(position=(9, 9, 9), field_of_view=20)
    assert_type(rayweave.render(solid, size=(8, 6), camera=camera), rayweave.Picture)
    assert_type(rayweave.render(solid, size=(8, 6), kind="depth", view="top"), NDArray[np.float64])
    assert_type(rayweave.render(solid, size=(8, 6), kind="id", threads=1), NDArray[np.int32])
    drawing = rayweave.timeline({"A": (1, 4), "B": RootRay(1, [2]), "C": np.array([1.0, 2.0])}, count=False)
    assert_type(drawing.svg, str)
    assert_type(rayweave.ray_timeline(solid, [0, 0, 0], [0, 0, 1]), rayweave.Timeline)


def light() -> None:
    lens = optics.biconvex_lens(50, 50, 8, aperture=25, material="N-BK7")
    assert_type(lens.translate([0, 0, 1]).rotate_x(5), optics.Element)
    system = optics.System([lens, optics.detector(40, name="screen").translate([0, 0, 46])])
    source = optics.line_of_rays(20, 11, wavelength_nm={486.1: 1, 656.3: 1}).translate([0, 0, -20])
    trace = system.trace(source, branches="both", threshold=1e-3)
    assert_type(trace.at("screen").points(), NDArray[np.float64])
    assert_type(trace.balance.error, float)
    assert_type(system.trace(source, polarised=None), optics.Trace)
    assert_type(source.polarised(1, 1, 0, 0).is_polarised, bool)
    assert_type(optics.glass("N-SF5").index(550.0), float)
    assert_type(optics.lensmaker(50, -50, 1.5, 8), float)


GLASS = """<gdml><define><matrix name="GLASS" coldim="2" values="1*eV 1.5 10*eV 1.5"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Medium"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="GLASS"/></material></materials>
<solids><box name="WorldBox" x="9" y="9" z="9" lunit="mm"/></solids>
<structure><volume name="World"><materialref ref="Medium"/><solidref ref="WorldBox"/></volume></structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"""


def detectors() -> None:
    detector = photons.loads(GLASS)
    index = detector.material("Medium").refractive_index
    assert index is not None
    assert_type(index.at(400), NDArray[np.float64])
    source = photons.point([0, 0, 0], 420, towards=[0, 0, 1])
    run = detector.simulate(source, n=10, range=(2, 5), record="steps")
    assert_type(run.ends, dict[str, int])
    assert_type(run.hits.position, NDArray[np.float64])
    assert_type(run.hits.to_opticks(), NDArray[np.float32])
    assert_type(run.histories.sequences().words, NDArray[np.uint64])
    assert_type(run.hits.plot(), rayweave.Drawing)
    given = photons.photons(np.zeros((4, 3)), [1, 0, 0], wavelengths_nm=420)
    pulse = photons.disc([0, 0, 0], 5, ("uniform", 400, 500), towards=[0, 0, 1], cone_degrees=5, time=(0, 1), time_decay=2)
    assert_type(pulse.notes, list[str])
    assert_type(photons.volume(detector, "World", 420, polarisation=[1, 0, 0]), photons.Source)
    assert_type(photons.surface(detector, "World", 420), photons.Source)
    assert_type(photons.line([0, 0, 0], [1, 0, 0], 420), photons.Source)
    assert_type(photons.from_optics(optics.point_source(20, 10), 5), photons.Source)
    assert_type(photons.SurfaceTables("folder").lut("S", np.ones((37, 45, 91))), photons.SurfaceTables)
    assert_type(detector.check(), photons.Findings)
    assert_type(detector.check_source(pulse), str | None)
    for part in detector.stream(given, chunk=3):
        assert_type(part, photons.Run)


def main() -> None:
    hit_arrays()
    geometry()
    regions()
    curves()
    root_rays()
    solid = solids()
    questions(solid)
    models()
    built()
    pictures(solid)
    light()
    detectors()
