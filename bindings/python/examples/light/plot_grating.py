"""
Orders of a grating
===================

A transmission grating of 600 lines per millimetre sends each order into the direction of the grating equation.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

figure, axis = plt.subplots(figsize=(6.5, 4), layout="constrained")
for order in (-1, 0, 1, 2):
    grating = optics.grating((0, 600), order, aperture=10)
    light = optics.line_of_rays(0.5, 3, wavelength_nm={450: 1, 550: 1, 650: 1}).translate([0, -0.5, -10])
    trace = optics.System([grating]).trace(light)
    trace.show(ax=axis, escape=25)
    after = trace["generation"] == 1
    sine = order * 600 * trace["wavelength_nm"][after] * 1e-6
    assert np.allclose(np.abs(trace["y_tilt"][after]), np.abs(sine))
    for wavelength in (450, 650):
        found = trace["y_tilt"][after & (trace["wavelength_nm"] == wavelength)][0]
        print(f"order {order:2}, {wavelength} nm: sin = {found:+.4f}, order * lines * wavelength = {order * 600 * wavelength * 1e-6:+.4f}")
axis.set_title("orders -1, 0, 1, 2 of 600 lines/mm")
