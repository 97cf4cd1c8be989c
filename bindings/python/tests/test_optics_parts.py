"""Parts of optical systems that are made in Python: that each can be used, and does what it says."""

import pytest
from rayweave import optics

D_NM = 587.5618


def test_a_beam_splitter_cube_halves_the_power() -> None:
    for share in (0.5, 0.25):
        system = optics.System(optics.beam_splitter_cube(2, reflectance=share, material=1.5))
        for start, way in (([0.1, 0.2, -5], [0, 0, 1]), ([0.1, 5, 0.2], [0, -1, 0])):
            trace = system.trace_rays(start, way, D_NM, branches="ideal", generation_limit=20)
            along = {}
            for axis in "yz":
                for sign in (1, -1):
                    out = (trace["event"] == 0) & (sign * trace[f"{axis}_tilt"] > 0.5)
                    along[sign, axis] = trace["intensity"][out].sum()
            # light that comes along +z is reflected to +y, light that comes along -y to -z
            through, turned = ((1, "z"), (1, "y")) if way[2] else ((-1, "y"), (-1, "z"))
            assert along[through] == pytest.approx(1 - share, abs=1e-12)
            assert along[turned] == pytest.approx(share, abs=1e-12)
