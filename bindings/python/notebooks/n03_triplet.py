"""
The design of a triplet
=======================

A Cooke triplet from its prescription: first-order data, spots, optimisation, tolerances, and ghosts of the same lens as
solids.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave.optics import Prescription, Surface, goal, optimise, tolerance

# %%
# The prescription
# ----------------
# A surface is a radius, the distance to the next one, and the glass behind it.

triplet = Prescription(
    [
        Surface(22.01359, 3.25896, "N-SK16"),
        Surface(-435.76044, 6.00755),
        Surface(-22.21328, 0.99997, "F2"),
        Surface(20.29192, 4.75041),
        Surface(79.68360, 2.95208, "N-SK16"),
        Surface(-18.39533, 42.20778),
    ],
    name="triplet",
    stop=4,
    entrance_pupil_diameter=10.0,
    fields=[0, 14, 20],
    wavelengths_nm=[486.1, 587.6, 656.3],
    primary=1,
)
data = triplet.first_order()
print(f"focal length {data.focal_length:.3f} mm, f/{data.f_number:.2f}, back focus {data.back_focal_distance:.3f} mm")

figure, axis = plt.subplots(figsize=(8, 3), layout="constrained")
axis = triplet.show(ax=axis, rays=5)

# %%
# Aberrations
# -----------
# Seidel sums show which surface contributes what; large contributions cancel each other.

figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
axis = triplet.seidel().show(ax=axis)

# %%
# Spots
# -----

triplet.spots().to_pandas()[["field_y", "rms", "geometric"]]

# %%

figure, axes = plt.subplots(1, 3, figsize=(9, 3), layout="constrained")
axes = triplet.spots().show(axes=list(axes))

# %%
# Optimisation
# ------------
# Three curvatures and the image distance may change; the focal length is to stay at 50 mm. A spot contains all wavelengths
# about their common centroid, so that lateral colour counts; with `wavelength_nm` it would have one wavelength and its own
# centroid.

names = ["curvature 1", "curvature 2", "curvature 6", "thickness 6"]
goals = [
    goal("focal length", 50.0, weight=10),
    *(goal("spot", field=k) for k in range(3)),
]
found = optimise(triplet, names, goals)
before, after = triplet.spots()["rms"], found.lens.spots()["rms"]
print("RMS radii before", (before * 1e3).round(2), "um, after", (after * 1e3).round(2), "um")
assert found.after <= found.before and abs(found.lens.first_order().focal_length - 50) < 0.1
assert np.hypot.reduce(after) < np.hypot.reduce(before)

# %%
# What each goal contributes to the merit, the sum of squares:

found.goals.to_pandas()[["goal", "value_before", "value_after", "contribution_after"]]

# %%
# Tolerances
# ----------
# 200 lenses with errors of manufacture; the image is refocused for each. The fields lie on one side of the axis, and the
# tilt and the decentre break the symmetry: the fields -14 and -20 degrees are evaluated, too.

errors = {
    "radius 1": 0.02,
    "radius 3": 0.02,
    "thickness 2": ("normal", 0.01),
    "index 3": 3e-4,
    "tilt x 3-4": 0.03,
    "decentre y 3-4": 0.01,
}
trials = tolerance(found.lens, errors, "spot", trials=200, refocus=True)
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
trials.show(ax=left)
axis = trials.sensitivities.show(ax=right)

# %%
# Ghosts
# ------
# The same lens as solids. Every surface reflects; two reflections make a ghost. A star marks a reflection.

system = triplet.system()
origins, directions = triplet.rays(1, wavelength_nm=587.6)
trace = system.trace_rays(origins, directions, wavelength_nm=587.6, branches="both", threshold=1e-5)
for path in trace.paths()[:6]:
    print(f"{path.power:9.3f} {path.text}")
assert abs(trace.balance.error) < 1e-9 * trace.balance.emitted
print(f"{trace.paths()[0].power / trace.balance.emitted:.1%} of the light reaches the image without a reflection")
