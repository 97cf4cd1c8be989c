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
    return optics.System([lens, screen]).trace(light).spot("screen").rms_radius


places = np.linspace(40, 55, 16)
radii = [radius(z) for z in places]
best = places[int(np.argmin(radii))]

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
screen = optics.detector(20, name="screen").translate([0, 0, best])
optics.System([lens, screen]).trace(light).show(ax=left, rays=40)
right.plot(places, radii, ".-")
right.set(xlabel="position of the screen in mm", ylabel="RMS radius of the spot in mm")

# the paraxial focus of a thick lens, from its middle; marginal rays focus in front of it
n, r, d = optics.Glass("N-BK7").index(587.6), 50.0, 6.0
focal_length = 1 / ((n - 1) * (2 / r - (n - 1) * d / (n * r**2)))
paraxial = focal_length * (1 - (n - 1) * d / (n * r)) + d / 2
assert paraxial - 5 < best < paraxial
