"""
Dispersion of a prism
=====================

White light through an equilateral prism of dense flint at the angle of minimum deviation of yellow light.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

glass = optics.glass("N-SF11")
prism = optics.equilateral_prism(30, 30, material=glass)
n = glass.index(587.6)
# symmetric passage: the ray in the glass is parallel to the base
incidence = np.degrees(np.arcsin(n * np.sin(np.radians(30))))
minimum = 2 * incidence - 60

figure, axis = plt.subplots(figsize=(7, 4), layout="constrained")
turned = prism.rotate_x(incidence - 30)
wavelengths = np.array([430, 480, 530, 587.6, 630, 680])
origins = np.tile([0.0, 0.0, -40.0], (len(wavelengths), 1))
trace = optics.System([turned]).trace_rays(origins, [0, 0, 1], wavelengths)
trace.show(ax=axis, escape=60)

last = trace["generation"] == 2
deviation = np.degrees(np.arccos(trace["z_tilt"][last]))
for wavelength, angle in zip(trace["wavelength_nm"][last], deviation, strict=True):
    print(f"{wavelength:5.1f} nm: {angle:.4f} degrees")
yellow = deviation[trace["wavelength_nm"][last] == 587.6][0]
print(f"minimum deviation by formula: {minimum:.4f} degrees")
assert abs(yellow - minimum) < 1e-9
