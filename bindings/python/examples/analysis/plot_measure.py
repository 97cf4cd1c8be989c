"""
Volumes with error bounds
=========================

Half the width of a confidence interval against the number of rays. Stratified rays give volumes whose errors fall faster
than those of independent samples.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import NullFormatter

import rayweave as rw

# Steinmetz's solid: the intersection of two cylinders has the volume 16 r^3 / 3
solid = rw.cylinder(1) & rw.cylinder(1).rotate_x(90)
exact = 16 / 3

rays, errors, widths = [], [], []
for precision in (5e-3, 1e-3, 5e-4, 2e-4):
    found = rw.measure(solid, precision=precision)
    rays.append(found.rays[0])
    errors.append(abs(found.volume[0] - exact))
    widths.append(found.volume_half_width[0])
    print(f"{rays[-1]:8} rays: {found.volume[0]:.5f} +- {widths[-1]:.5f}, exactly {exact:.5f}")
    assert errors[-1] < 3 * widths[-1]

figure, axis = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
axis.loglog(rays, widths, "o-", label="half width of the 99 % interval")
axis.loglog(rays, np.maximum(errors, 1e-7), "x", label="true error")
axis.loglog(rays, widths[0] * np.sqrt(rays[0] / np.array(rays)), ":", label="independent samples")
axis.set(xlabel="rays", ylabel="volume", xlim=(1e4, 1e6))
axis.xaxis.set_minor_formatter(NullFormatter())
axis.legend()
