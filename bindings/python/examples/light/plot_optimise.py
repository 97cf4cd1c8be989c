"""
Optimisation
============

A plane and a convex hyperboloid focus collimated light to a point if the conic constant is minus the square of the index
(Descartes, 1637). The optimiser finds this value from a sphere.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics
from rayweave.optics import Prescription, Surface, goal

singlet = Prescription(
    [Surface(np.inf, 8.0, 1.5), Surface(-30.0, 60.0)], entrance_pupil_diameter=20.0, wavelengths_nm=[587.6]
)
found = optics.optimise(singlet, ["conic 2"], [goal("spot", field=0)])
conic = found.values["conic 2"]
print(f"conic constant {conic:.9f}, exactly {-(1.5**2)}")
assert abs(conic + 1.5**2) < 1e-6

figure, axes = plt.subplots(1, 2, figsize=(9, 3), sharex=True, layout="constrained")
for axis, (name, lens) in zip(axes, {"sphere": singlet, f"k = {conic:.4f}": found.lens}.items(), strict=True):
    lens.show(ax=axis, rays=9)
    axis.set_title(f"{name}: RMS radius {lens.spots()['rms'][0] * 1e3:.3g} um")
