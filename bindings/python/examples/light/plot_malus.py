"""
Polarisers and a wave plate
===========================

The power behind two polarisers follows the law of Malus. With a quarter-wave plate at 45 degrees between them, the power no
longer depends on the angle of the second polariser.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

light = optics.beam(5, 100).translate([0, 0, -10])
screen = optics.detector(20, name="screen").translate([0, 0, 20])
first = optics.polariser(0, aperture=20, name="first")
plate = optics.wave_plate(90, 45, aperture=20).translate([0, 0, 5])

angles = np.arange(0, 181, 10)
powers = {"two polarisers": [], "with a quarter-wave plate": []}
for angle in angles:
    second = optics.polariser(float(angle), aperture=20, name="second").translate([0, 0, 10])
    powers["two polarisers"].append(optics.System([first, second, screen]).trace(light).balance.absorbed["screen"])
    system = optics.System([first, plate, second, screen])
    powers["with a quarter-wave plate"].append(system.trace(light).balance.absorbed["screen"])

malus = np.cos(np.radians(angles)) ** 2 / 2
assert np.allclose(powers["two polarisers"], malus) and np.allclose(powers["with a quarter-wave plate"], 0.25)

figure, axis = plt.subplots(figsize=(6, 3.4), layout="constrained")
for name, values in powers.items():
    axis.plot(angles, values, "o", ms=4, label=name)
axis.plot(angles, malus, color="gray", lw=1, label="cos²(angle) / 2")
axis.set(xlabel="angle of the second polariser in degrees", ylabel="transmitted power")
axis.legend()
