"""
A lens and its spots
====================

A biconvex lens as a solid of glass: its focus against the formula of lens makers, its spherical aberration against the third
power of the height, and its colours.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

# %%
# The lens
# --------
# ``biconvex_lens`` intersects two spheres and a cylinder. Its centre is the origin, the axis is z.

radius, thickness = 50.0, 6.0
lens = optics.biconvex_lens(radius, radius, thickness, aperture=25, material="N-BK7")
lens

# %%
# A narrow beam
# -------------
# Rays close to the axis cross it at the paraxial focus. The formula of lens makers, for a thick lens in air, gives the focal
# length from the principal plane, which is inside the lens.

n = optics.glass("N-BK7").index(587.6)
focal_length = optics.lensmaker(radius, -radius, n, thickness)
back_focus = focal_length * (1 - (n - 1) * thickness / (n * radius)) + thickness / 2

screen = optics.detector(20, name="screen").translate([0, 0, 70])
system = optics.System([lens, screen])


def focus(heights):
    """Where rays at these heights cross the axis."""
    origins = np.column_stack([0 * heights, heights, np.full_like(heights, -20)])
    trace = system.trace_rays(origins, [0, 0, 1], 587.6)
    last = trace.at("screen")
    order = np.argsort(last["id"])
    y0, z0, dy, dz = (last[name][order] for name in ("y0", "z0", "y_tilt", "z_tilt"))
    return z0 - y0 * dz / dy


print(f"focus of a ray at 0.01 mm: {focus(np.array([0.01]))[0]:.5f} mm, formula {back_focus:.5f} mm")
assert abs(focus(np.array([0.01]))[0] - back_focus) < 1e-4

# %%
# Spherical aberration
# --------------------
# Rays far from the axis are bent too much. To lowest order their focus moves by the square of the height.

heights = np.linspace(0.5, 11, 40)
shift = focus(heights) - back_focus
coefficient = shift[5] / heights[5] ** 2

figure, axis = plt.subplots(figsize=(5.5, 3.4), layout="constrained")
axis.plot(shift, heights, label="traced")
axis.plot(coefficient * heights**2, heights, "--", label="third order")
axis.set(xlabel="shift of the focus in mm", ylabel="height of the ray in mm")
axis.legend()

# %%
# A spot
# ------
# A beam fills the lens, and the screen collects a spot. ``trace.spot`` has its size.

light = optics.beam(20, 2_000, wavelength_nm=587.6).translate([0, 0, -20])


def spot(z):
    """The spot on a screen at z."""
    moved = optics.detector(20, name="screen").translate([0, 0, z])
    return optics.System([lens, moved]).trace(light).spot("screen")


places = np.linspace(back_focus - 6, back_focus + 1, 40)
radii = np.array([spot(z).rms_radius for z in places])
best = places[radii.argmin()]
print(f"smallest spot at {best:.2f} mm, {back_focus - best:.2f} mm before the paraxial focus")
assert best < back_focus

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
left.plot(places, radii)
left.axvline(back_focus, ls=":", color="gray")
left.set(xlabel="position of the screen in mm", ylabel="RMS radius in mm")
points = spot(best).points
right.plot(points[:, 0], points[:, 1], ".", ms=2)
right.set(aspect="equal", title=f"at {best:.2f} mm", xlabel="x in mm")

# %%
# Colours
# -------
# The index of the glass falls with the wavelength, so the focal length grows.

glass = optics.glass("N-BK7")
wavelengths = np.linspace(420, 700, 15)
lengths = [optics.lensmaker(radius, -radius, glass.index(w), thickness) for w in wavelengths]
figure, axis = plt.subplots(figsize=(5.5, 3), layout="constrained")
axis.plot(wavelengths, lengths)
axis.set(xlabel="wavelength in nm", ylabel="focal length in mm")
spread = optics.lensmaker(radius, -radius, glass.index(656.3), thickness) - optics.lensmaker(
    radius, -radius, glass.index(486.1), thickness
)
print(f"between the lines F and C {spread:.3f} mm; f / V = {focal_length / glass.abbe_number():.3f} mm")
