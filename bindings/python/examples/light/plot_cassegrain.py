"""
A Cassegrain telescope
======================

A paraboloid and a hyperboloid focus light of the axis on one point, exactly. Off the axis coma remains.
"""

import matplotlib.pyplot as plt

from rayweave.optics import Prescription, Surface

# the primary has a focal length of 500; the secondary, 400 in front of it, sends the light 500 back: a magnification of m = 5
m = 5
telescope = Prescription(
    [
        Surface(-1000.0, -400.0, "mirror", conic=-1.0, semi_diameter=100.0, hole=22.0),
        Surface(-2 * 100 * m / (m - 1), 500.0, "mirror", conic=-(((m + 1) / (m - 1)) ** 2)),
    ],
    entrance_pupil_diameter=200.0,
    fields=[0, 0.15, 0.3],
    wavelengths_nm=[550],
)
focal_length = telescope.first_order().focal_length
spots = telescope.spots(rings=10)
print(f"focal length {focal_length:.6f}, exactly {500 * m}")
print(f"RMS radius on the axis {spots['rms'][0]:.1e} mm")
assert abs(abs(focal_length) - 500 * m) < 1e-9 and spots["rms"][0] < 1e-9

figure, axes = plt.subplots(1, 4, figsize=(11, 3.6), layout="constrained", width_ratios=(5, 1.5, 1.5, 1.5))
telescope.show(ax=axes[0], rays=6)
for k, axis in enumerate(axes[1:]):
    rays = telescope.arrivals(k, rings=14)
    x, y = rays["x"] * 1e3, rays["y"] * 1e3
    axis.plot(x - x.mean(), y - y.mean(), ".", ms=2)
    axis.set(aspect="equal", xlim=(-60, 60), ylim=(-110, 110), title=f"{telescope.fields[k][1]} degrees")
    axis.tick_params(labelsize=7)
axis.set_xlabel("um")
