"""
Light through a lens
====================

A beam through a biconvex lens, its spot, and the distance with the smallest spot.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

lens = optics.biconvex_lens(50, 50, 6, aperture=25, material="N-BK7")
light = optics.beam(10, 400, wavelength_nm=587.6).translate([0, 0, -20])


def radius(z: float) -> float:
    """The RMS radius of the spot on a screen at z."""
    screen = optics.detector(20, name="screen").translate([0, 0, z])
    return optics.System([lens, screen]).trace(light).spot("screen").rms


places = np.linspace(40, 55, 16)
radii = [radius(z) for z in places]
best = places[int(np.argmin(radii))]

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
screen = optics.detector(20, name="screen").translate([0, 0, best])
optics.System([lens, screen]).trace(light).show(axis=left, rays=40)
right.plot(places, radii, ".-")
right.set(xlabel="position of the screen in mm", ylabel="RMS radius of the spot in mm")

# marginal rays focus in front of the paraxial focus, 48.9 mm behind the middle of the lens
assert 45 < best < 48.9
