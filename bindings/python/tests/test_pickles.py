"""Results that are pickled: equal, also in another process."""

import pickle

import numpy as np
import pytest

import rayweave as rw


def again(thing):
    return pickle.loads(pickle.dumps(thing))


@pytest.mark.parametrize("plane", ["z=0.1", {"point": [0.1, 0.2, 0.3], "normal": [1, 2, 3]}])
def test_sections(plane):
    ring = rw.sphere(1) - rw.sphere(0.5)
    cut = rw.section(ring, plane) if isinstance(plane, str) else rw.section(ring, **plane)
    copy = again(cut)
    assert (copy.names, copy.plane, repr(copy)) == (cut.names, cut.plane, repr(cut))
    assert np.array_equal(copy.areas, cut.areas) and np.array_equal(copy.frame, cut.frame)
    ours, theirs = (own.contours("solid") for own in (cut, copy))
    assert len(ours) == 2 and all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))
    assert copy._repr_svg_() == cut._repr_svg_()


def test_explanations():
    found = rw.box(2).named("die").explain([-3, 0.1, 0], [1, 0, 0], t_max=3.5)
    copy = again(found)
    assert str(copy) == str(found)
    assert [passage.t for passage in copy.crossings] == [2.0]


def test_differences():
    found = rw.diff(rw.box(2), rw.box([2, 2, 2.5]), cells=16)
    copy = again(found)
    assert copy.is_same is False and np.array_equal(copy.thickness, found.thickness)
    assert copy.section.names == found.section.names
