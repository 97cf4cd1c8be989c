"""Graphics cards beside the CPU: the argument `device`. With the Cargo feature `gpu` most tests need an adapter, such as lavapipe."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import rayweave as rw
import rayweave.photons as rp

try:
    DEVICES = rw.devices()
    BUILT = True
except rw.RayweaveError:
    DEVICES = []
    BUILT = False

needs_card = pytest.mark.skipif(not DEVICES, reason="no graphics card, or built without the feature gpu")
needs_f64 = pytest.mark.skipif(
    not DEVICES or not DEVICES[0]["f64"], reason="no graphics card with double precision, or built without the feature gpu"
)
needs_none = pytest.mark.skipif(BUILT, reason="built with the feature gpu")

SOLID = (rw.box(2) - rw.cylinder(0.3, 4)) - rw.sphere(1.2)
MODEL = rw.Model([rw.Region("block", rw.box(2), medium="glass"), rw.Region("ball", rw.sphere(1.2), medium="water")])

GUIDE = Path(__file__).resolve().parents[3] / "docs/guides/photons.md"
BAR = re.search(r"^```xml\n(.*?)^```$", GUIDE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)[1]
SOURCE = rp.point([0, 0, 0], 550)


@pytest.fixture(scope="module")
def bar():
    return rp.loads(BAR)


def rays(count):
    """Rays from outside and inside, oblique and along the axes."""
    rng = np.random.default_rng(5)
    origins = rng.uniform(-3, 3, (count, 3))
    directions = rng.uniform(-1, 1, (count, 3)) - origins
    directions[::5] = [0, 0, 1]
    return origins, directions


def same(a, b):
    """Whether two answers have the same columns, bit for bit."""
    for field in ("t", "point", "normal", "surface", "enters", "ray", "before", "after", "start_inside"):
        if hasattr(b, field):
            x, y = np.asarray(getattr(a, field)), np.asarray(getattr(b, field))
            assert x.shape == y.shape and x.tobytes() == y.tobytes(), field
    return True


def test_unknown_devices_are_rejected():
    with pytest.raises(rw.RayweaveError, match="device is 'gpi': it must be one of 'cpu', 'gpu', 'auto'. Did you mean `gpu`"):
        SOLID.nearest([0, 0, -5], [0, 0, 1], device="gpi")
    with pytest.raises(rw.RayweaveError, match="evaluators are algorithms of the CPU"):
        SOLID.nearest([0, 0, -5], [0, 0, 1], device="gpu", evaluator="weave")
    with pytest.raises(TypeError, match="device is 3: it must be the name of a device"):
        rw.render(SOLID, size=(8, 8), device=3)


@needs_none
def test_without_the_feature_the_message_tells_how_to_build_with_it():
    calls = [
        rw.devices,
        lambda: SOLID.nearest([0, 0, -5], [0, 0, 1], device="gpu"),
        lambda: MODEL.crossings([0, 0, -5], [0, 0, 1], device="gpu"),
        lambda: MODEL.contains([0, 0, 0], device="gpu"),
        lambda: rw.render(SOLID, size=(8, 8), device="gpu"),
        lambda: rw.sheet(SOLID, size=(320, 240), cut="x>0", device="gpu"),
        lambda: rp.loads(BAR).simulate(SOURCE, n=10, device="gpu"),
        lambda: next(rp.loads(BAR).stream(SOURCE, n=10, device="gpu")),
    ]
    for call in calls:
        with pytest.raises(rw.RayweaveError, match="built without the Cargo feature `gpu`. Build it with `--features gpu`"):
            call()


@needs_none
def test_auto_uses_the_cpu_and_warns_once():
    solid = rw.sphere(1)
    with pytest.warns(RuntimeWarning, match="the CPU is used: the device `gpu` is not available"):
        assert solid.nearest([0, 0, -5], [0, 0, 1], device="auto").t[0] == 4
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert solid.hits([0, 0, -5], [0, 0, 1], device="auto").tolist() == [[4], [6]]


@needs_none
def test_auto_moves_photons_on_the_cpu_and_warns(bar):
    with pytest.warns(RuntimeWarning, match="the CPU is used: the device `gpu` is not available"):
        run = bar.simulate(SOURCE, n=500, seed=2, device="auto")
    assert same_run(run, bar.simulate(SOURCE, n=500, seed=2))


def test_unknown_devices_of_photons_are_rejected(bar):
    with pytest.raises(rw.RayweaveError, match="device is 'gpi': it must be one of 'cpu', 'gpu', 'auto'. Did you mean `gpu`"):
        bar.simulate(SOURCE, n=10, device="gpi")


def same_run(a, b):
    """Whether two runs have the same hits, bit for bit, and the same counts."""
    assert list(a.hits) == list(b.hits)
    for name in b.hits:
        assert np.asarray(a.hits[name]).tobytes() == np.asarray(b.hits[name]).tobytes(), name
    assert (a.photons, a.steps, a.ends) == (b.photons, b.steps, b.ends)
    return True


@needs_f64
def test_photons_have_the_bits_of_the_cpu(bar):
    ours, theirs = (bar.simulate(SOURCE, n=5000, seed=2, device=device) for device in ("gpu", "cpu"))
    assert theirs.hits.rows > 500 and same_run(ours, theirs)
    # in runs of some photons each, on one thread
    streamed = list(bar.stream(SOURCE, n=5000, chunk=1700, seed=2, device="gpu", threads=1))
    assert [run.photons for run in streamed] == [1700, 1700, 1600]
    joined = np.concatenate([run.hits["time"] for run in streamed])
    assert joined.tobytes() == np.asarray(theirs.hits["time"]).tobytes()
    with pytest.raises(rw.RayweaveError, match="histories"):
        bar.simulate(SOURCE, n=10, record="steps", device="gpu")


@needs_card
def test_devices_are_listed():
    for device in DEVICES:
        assert set(device) == {"name", "kind", "driver", "largest_table_bytes", "f64"}
        assert device["largest_table_bytes"] >= 1 << 27


@needs_card
@pytest.mark.parametrize("subject", [SOLID, MODEL], ids=["solid", "model"])
def test_queries_have_the_bits_of_the_cpu(subject):
    origins, directions = rays(3000)
    assert same(subject.nearest(origins, directions, device="gpu"), subject.nearest(origins, directions))
    assert same(subject.crossings(origins, directions, device="gpu"), subject.crossings(origins, directions))
    window = dict(t_min=-0.5, t_max=0.7)
    ours, theirs = (subject.hits(origins, directions, **window, device=device) for device in ("gpu", "cpu"))
    assert ours.tobytes() == theirs.tobytes() and np.isfinite(theirs).any()
    assert np.array_equal(subject.contains(origins, device="gpu"), subject.contains(origins))


@needs_card
def test_pictures_have_the_bits_of_the_cpu():
    for options in (dict(view="front"), dict(cut="x>0"), dict(shadows=True), dict(kind="depth"), dict(opacity=0.5)):
        ours, theirs = (rw.render(MODEL, size=(64, 48), device=device, **options) for device in ("gpu", "cpu"))
        assert ours.tobytes() == theirs.tobytes(), options


@needs_card
@pytest.mark.skipif(not DEVICES or DEVICES[0]["kind"] != "software", reason="there is a card")
def test_auto_does_not_use_a_program_on_the_processor():
    with pytest.warns(RuntimeWarning, match="is a program on the processor"):
        assert rw.sphere(1).nearest([0, 0, -5], [0, 0, 1], device="auto").t[0] == 4
