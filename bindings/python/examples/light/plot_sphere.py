"""
An integrating sphere
=====================

Diffuse walls make light uniform. The power that leaves through a small port follows from the area of the port and the
reflectance of the wall.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
from rayweave import optics

rho, port_radius = 0.95, 10.0
shell = rw.sphere(50.05) - rw.sphere(50).named("wall") - rw.cylinder(port_radius, 20).translate([0, 0, 50]).named("port")
sphere = optics.element(shell, "absorber", name="sphere").with_finish(optics.diffuse(rho))
screen = optics.detector(130, name="screen").translate([0, 0, 51])
lamp = optics.point_source(8, 5_000, wavelength_nm=550).rotate_y(120)
trace = optics.System([sphere, screen]).trace(lamp, seed=1, threshold=1e-8)

# a share f of the light on the wall leaves at each bounce; after the first reflection all of it is diffuse
f = (1 - np.sqrt(1 - (port_radius / 50) ** 2)) / 2
exact = rho * f / (1 - rho * (1 - f))
found = trace.balance.absorbed["screen"] / trace.balance.emitted
print(f"through the port {found:.4f}, by formula {exact:.4f} for a port in the sphere")
assert abs(found - exact) < 4 * np.sqrt(exact / 5_000)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
optics.System([sphere, screen]).trace(lamp, seed=1, generation_limit=8).show(ax=left, rays=3)
irradiance, x, y = trace.irradiance("screen", 40, size=(120, 120))
right.pcolormesh(x, y, irradiance)
right.set(aspect="equal", title="irradiance behind the port")
