"""
A stack of sections
===================

Sections at many heights, as a slicer for 3D printing needs them, and the volume as the integral of their areas.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

solid = rw.torus(10, 4) - rw.box([40, 3, 40])
heights = np.linspace(-3.9, 3.9, 40)
cuts = rw.section(solid, "xy", at=heights, columns=128, tolerance=0.02)

figure = plt.figure(figsize=(6, 4.5), layout="constrained")
axis = figure.add_subplot(projection="3d")
for height, cut in zip(heights[::3], cuts[::3], strict=True):
    for name in cut.names:
        for contour in cut.contours(name):
            closed = np.vstack([contour, contour[:1]])
            axis.plot(closed[:, 0], closed[:, 1], height, color=plt.cm.viridis((height + 4) / 8), lw=1)
axis.set_box_aspect((2, 2, 0.8))

# midpoint rule: 40 slices of thickness 0.2
volume = sum(cut.areas.sum() for cut in cuts) * 0.2
measured = rw.measure(solid)
print(f"volume from sections {volume:.2f}, from rays {measured.volume[0]:.2f} +- {measured.volume_half_width[0]:.2f}")
assert abs(volume - measured.volume[0]) < 0.01 * volume
