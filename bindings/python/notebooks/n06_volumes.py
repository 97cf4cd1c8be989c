"""
Volumes with errors
===================

How the volume, mass and centre of a part are measured by rays, what the confidence intervals mean, and how often they contain
the truth.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

# %%
# A part
# ------
# A plate with a hub, a bore and six holes: its volume is known, so that the measurement can be judged.

plate = rw.cylinder(40, 8)
hub = rw.cylinder(16, 22).translate([0, 0, 7])
holes = rw.place(rw.cylinder(3), [[30 * np.cos(a), 30 * np.sin(a), 0] for a in np.radians(np.arange(0, 360, 60))])
flange = (plate | hub) - rw.cylinder(10) - holes
exact = np.pi * (40**2 * 8 + 16**2 * 14 - 10**2 * 22 - 6 * 3**2 * 8)

figure, axis = plt.subplots(figsize=(5, 3.6), layout="constrained")
axis.imshow(rw.render(flange, size=(500, 360)))
axis.axis("off")

# %%
# The measurement
# ---------------
# ``precision`` is half the width of the interval as a fraction of the volume; rays are added until it is reached.

model = rw.Model([rw.Region("flange", flange, medium="steel")], {"steel": {"density": 7.85}})
found = rw.measure(model, precision=1e-3)
print(f"volume {found.volume[0]:.1f} +- {found.volume_half_width[0]:.1f} mm^3, exactly {exact:.1f}")
print(f"mass {found.mass[0]:.2f} +- {found.mass_half_width[0]:.2f} g after {found.rays[0]} rays")
found.to_pandas().T

# %%
# The centre of mass has a closed form as well: by symmetry it is on the axis.

moments = np.pi * ((16**2 - 10**2) * 14 * 11)
print(f"centre z {found.centre[0, 2]:.4f} +- {found.centre_half_width[0, 2]:.4f}, exactly {moments / exact:.4f}")
assert abs(found.centre[0, 2] - moments / exact) < 3 * found.centre_half_width[0, 2]

# %%
# How honest are the intervals?
# -----------------------------
# An interval at the level of 90 % should contain the truth in about 90 of 100 independent measurements. Each seed is an
# independent measurement. The first rays only determine how many rays each region needs, and the result comes from further
# rays: otherwise a region that happens to look precise would stop early, with an interval that is too short. A small region
# beside a large one, here a pin in one of the holes, is the hardest case.

pin = rw.cylinder(3, 8).translate([30, 0, 0])
exactly = np.array([exact, np.pi * 3**2 * 8])
runs = [rw.measure({"flange": flange, "pin": pin}, precision=0.05, confidence=0.9, seed=seed) for seed in range(100)]
errors = np.array([run.volume for run in runs]) / exactly - 1
widths = np.array([run.volume_half_width for run in runs]) / exactly
inside = np.sum(np.abs(errors) <= widths, axis=0)
print(f"{inside[0]} intervals of the flange and {inside[1]} of the pin contain the truth, of 100 each")

figure, axes = plt.subplots(2, figsize=(8, 4), layout="constrained", sharex=True)
for axis, name, error, width in zip(axes, ("flange", "pin"), errors.T, widths.T, strict=True):
    axis.errorbar(np.arange(100), 100 * error, 100 * width, fmt=".", ms=3, lw=0.8)
    axis.axhline(0, color="black", lw=0.8)
    axis.set(ylabel=f"error of the {name} in %")
axes[1].set(xlabel="seed")
assert (inside >= 80).all()

# %%
# Rays and precision
# ------------------
# Stratified rays converge faster than independent ones: four times as many rays more than halve the error.

rays, halves = [], []
for precision in (5e-3, 2e-3, 1e-3, 5e-4):
    run = rw.measure(flange, precision=precision)
    rays.append(int(run.rays[0]))
    halves.append(float(run.volume_half_width[0] / run.volume[0]))
figure, axis = plt.subplots(figsize=(5, 3.2), layout="constrained")
axis.loglog(rays, halves, "o-", label="measured")
axis.loglog(rays, halves[0] * np.sqrt(rays[0] / np.array(rays)), ":", label="independent rays")
axis.set(xlabel="rays", ylabel="relative half width")
axis.legend()

# %%
# Without chance
# --------------
# Three other ways give the same volume: sections, a mesh, and the formula of a single shape.

heights = np.linspace(-4 + 0.1, 18 - 0.1, 110)
cuts = rw.section(flange, "xy", at=heights, columns=64, tolerance=0.05)
sections = sum(cut.areas.sum() for cut in cuts) * 0.2
mesh = flange.to_mesh(0.02).volume
print(f"sections {sections:.1f}, mesh {mesh:.1f}, formula {exact:.1f}; plate alone {rw.cylinder(40, 8).volume:.4f}")
assert abs(sections - exact) < 3e-3 * exact and abs(mesh - exact) < 5e-3 * exact
